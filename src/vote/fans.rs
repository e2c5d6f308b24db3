//! Long boundaries: each loop spanned by triangles, and a tree over them.
//!
//! Any surface over the loops has the soup's winding number but for a whole number. A tree over a
//! small one is faster and errs less than one over the soup, because the soup's closed parts have
//! no share in it.

use glam::{DMat3, DVec2, DVec3};

use super::boundary::Loops;
use super::dipoles::{Face, WindingTree};
use super::rim::{Phase, Product, Sight, Span};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// A group stands for its triangles from this many of its radii on: errors up to 0.0007 where a third
/// of a sphere's triangles are missing; 6 leaves 0.0015, and 4 0.005.
const FAR: f64 = 8.0;

/// Triangles with a given boundary.
#[derive(Debug, Clone)]
pub(super) struct Fans {
    tree: WindingTree,
    /// For each node of the tree, Σ ½(A sᵀ + s Aᵀ) over its triangles of area vector A, s from the
    /// node's centre.
    quadrupoles: Vec<DMat3>,
}

/// What is far is summed in groups.
#[derive(Debug, Clone)]
pub(super) struct Nearby<'f> {
    far: Vec<Group>,
    near: Vec<&'f Face>,
}

#[derive(Debug, Clone, Copy)]
struct Group {
    centre: DVec3,
    dipole: DVec3,
    quadrupole: DMat3,
}

impl Fans {
    pub(super) fn new(loops: &Loops, progress: &Progress) -> Result<Self, Stopped> {
        let mut mesh = TriMesh::default();
        for points in loops.each() {
            span(points, &mut mesh);
        }
        let tree = WindingTree::new(&mesh, 0..mesh.triangles.len(), progress)?;
        progress.check()?;
        let quadrupoles = tree.nodes.iter().map(|node| quadrupole(tree.faces_of(node), node.centre)).collect();
        Ok(Self { tree, quadrupoles })
    }

    /// For points within `radius` of `centre`.
    pub(super) fn around(&self, centre: DVec3, radius: f64) -> Nearby<'_> {
        let mut nearby = Nearby { far: Vec::new(), near: Vec::new() };
        let is_far = |at: DVec3, extent: f64| at.distance(centre) - radius > FAR * extent;
        let mut stack = vec![0u32];
        while let Some(n) = stack.pop() {
            let node = &self.tree.nodes[n as usize];
            if is_far(node.centre, node.radius()) {
                let quadrupole = self.quadrupoles[n as usize];
                nearby.far.push(Group { centre: node.centre, dipole: node.dipole, quadrupole });
            } else if node.children == 0 {
                for face in self.tree.faces_of(node) {
                    if is_far(face.centre, face.radius()) {
                        // About its own centre a triangle has no quadrupole.
                        let quadrupole = DMat3::ZERO;
                        nearby.far.push(Group { centre: face.centre, dipole: face.dipole, quadrupole });
                    } else {
                        nearby.near.push(face);
                    }
                }
            } else {
                stack.extend([node.children + 1, node.children]);
            }
        }
        nearby
    }
}

impl Nearby<'_> {
    /// The winding number at `p` but for a whole number.
    pub(super) fn at(&self, p: DVec3) -> Phase {
        let (mut turn, mut currents) = (Product::ONE, DVec3::ZERO);
        for face in &self.near {
            let [a, b, c] = face.corners.map(|corner| Sight::new(p, corner));
            let spans = [Span::new(a, b), Span::new(b, c), Span::new(c, a)];
            turn.times(spans[1].turn(a.way));
            turn.shorten();
            currents += spans.iter().map(Span::current).sum::<DVec3>();
        }
        let mut solid_angle = 0.0;
        for group in &self.far {
            let (angle, gradient) = group.solid_angle(p);
            solid_angle += angle;
            currents += gradient;
        }
        turn.times(DVec2::from_angle(0.5 * solid_angle));
        Phase::new(turn.direction(), currents)
    }
}

impl Group {
    /// The solid angle seen from `p` and its gradient.
    fn solid_angle(&self, p: DVec3) -> (f64, DVec3) {
        let r = self.centre - p;
        let second = 1.0 / r.length_squared();
        let third = second * second.sqrt();
        let (along, bent) = (self.dipole.dot(r), self.quadrupole * r);
        let trace = self.quadrupole.x_axis.x + self.quadrupole.y_axis.y + self.quadrupole.z_axis.z;
        let twice = 3.0 * r.dot(bent) * second;
        let angle = (along + trace - twice) * third;
        let rise = self.dipole - bent * (6.0 * second) - r * ((3.0 * (along + trace) - 5.0 * twice) * second);
        (angle, rise * -third)
    }
}

/// Spans a loop by triangles, halving it again and again, so that most of them are small.
fn span(points: &[DVec3], mesh: &mut TriMesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend_from_slice(points);
    let mut stack = vec![[first, first + points.len() as u32 - 1]];
    while let Some([from, to]) = stack.pop() {
        if to - from >= 2 {
            let middle = from + (to - from) / 2;
            mesh.triangles.push([from, middle, to]);
            stack.extend([[from, middle], [middle, to]]);
        }
    }
}

fn quadrupole(faces: &[Face], centre: DVec3) -> DMat3 {
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let sum = faces.iter().fold(DMat3::ZERO, |sum, face| sum + outer(face.dipole, face.centre - centre));
    (sum + sum.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vote::dipoles::tests::{places, sphere, sum_of_all};
    use crate::vote::rim::tests::by_differences;

    fn fans(mesh: &TriMesh) -> Fans {
        let loops = Loops::around(mesh, 0..mesh.triangles.len(), &Progress::none()).expect("not stopped");
        Fans::new(&loops, &Progress::none()).expect("not stopped")
    }

    #[test]
    fn a_torn_sphere_is_summed_to_a_thousandth() {
        let mut mesh = sphere(60, 100);
        mesh.triangles = mesh.triangles.into_iter().enumerate().filter(|(n, _)| n % 3 != 0).map(|(_, t)| t).collect();
        let fans = fans(&mesh);
        let mut largest = (0.0f64, 0.0f64);
        for p in places(500) {
            let nearby = fans.around(p + DVec3::new(0.01, 0.0, -0.01), 0.02);
            let (all, phase) = (sum_of_all(&mesh, p), nearby.at(p));
            largest.0 = largest.0.max((phase.complete(all) - all).abs());
            let gradient = by_differences(|q| nearby.at(q).above, p, 1e-6);
            largest.1 = largest.1.max(phase.gradient.distance(gradient) / (1.0 + gradient.length()));
        }
        println!("DBG {largest:?}");
        assert!(largest.0 < 1e-3 && largest.1 < 1e-5, "{largest:?}");
    }

    #[test]
    fn a_loop_of_many_points_is_spanned_to_the_last_triangle() {
        for count in 3..40u32 {
            let around = |k| DVec3::new((k as f64).cos(), (k as f64).sin(), (3.0 * k as f64).sin());
            let points: Vec<DVec3> = (0..count).map(|k| around(k as f64 / count as f64 * 6.0)).collect();
            let mut mesh = TriMesh::default();
            span(&points, &mut mesh);
            assert_eq!(mesh.triangles.len(), points.len() - 2);
            let rim = Loops::around(&mesh, 0..mesh.triangles.len(), &Progress::none()).expect("not stopped");
            assert_eq!(rim.each().collect::<Vec<_>>(), [&points[..]]);
        }
    }
}
