//! Long boundaries: a tree of loops.
//!
//! A loop is the sum of a triangle and two shorter loops, and so on: those that are far are summed
//! as one dipole and quadrupole, in the way of Barill et al. 2018 but over the boundary in place of
//! the surface. So the closed parts of the soup, and its size, have no share in time and error. Around one place the sum of all that is not
//! quite near is a polynomial: how smooth it is depends on how far the edges are, not on how large the loops are.

use glam::{DMat3, DVec2, DVec3};

use super::boundary::Loops;
use super::dipoles;
use super::expansion::Expansion;
use super::phase::Phase;
use crate::mesh::{Bounds, Shape};
use crate::progress::{Progress, Stopped};

/// Loops whose edges all pass a place at more than this many of its radii are a polynomial of second degree there, which errs
/// by less than 0.0005 for each.
const BESIDE: f64 = 5.0;
/// Single triangles longer than this part of the bounding box's diagonal are cut: large ones are near from everywhere. A soup of 8,000 that lie apart takes a tenth of the time.
const PIECES: f64 = 48.0;
/// Cutting adds at most so many pieces.
const MOST_PIECES: usize = 1 << 18;
/// Nodes of so many points take long enough to look whether to stop.
const CHECK_FROM: usize = 1 << 14;

/// Loops as a tree. A node has several loops, which its children share, or is one: the points of a
/// range and the edge from the last to the first; then it is a triangle and what its children are.
#[derive(Debug, Clone)]
pub(super) struct LoopTree {
    points: Vec<DVec3>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    group: FarLoops,
    /// Distance of the farthest point from the centre.
    radius: f64,
    /// Of a single loop: its first, middle and last point.
    triangle: Option<[u32; 3]>,
    /// 0 for none.
    children: [u32; 2],
}

/// Any surface over loops, seen from afar.
#[derive(Debug, Clone, Copy)]
pub(super) struct FarLoops {
    pub(super) centre: DVec3,
    /// The area vector.
    pub(super) dipole: DVec3,
    /// Σ ½(A sᵀ + s Aᵀ) over triangles of area vector A, s from the centre.
    quadrupole: DMat3,
}

/// Loops as seen from near one place: what passes at a distance as a polynomial, and what is near.
#[derive(Debug, Clone)]
pub(super) struct Nearby {
    far: Expansion,
    near: Loops,
}

impl LoopTree {
    pub(super) fn new(loops: &Loops, progress: &Progress) -> Result<Self, Stopped> {
        let loops: Vec<&[DVec3]> = loops.each().collect();
        let mut builder = Builder { loops: Vec::new(), points: Vec::new(), nodes: Vec::new(), ranges: Vec::new() };
        builder.split(loops, progress)?;
        progress.check()?;
        builder.halve();
        progress.check()?;
        builder.measure(progress)?;
        Ok(Self { points: builder.points, nodes: builder.nodes })
    }

    /// For points within `radius` of `centre`. What is `apart` radii away, its own and this one together, counts as a dipole and quadrupole.
    pub(super) fn around(&self, centre: DVec3, radius: f64, apart: f64) -> Nearby {
        let mut far = Expansion::about(centre);
        let loops = self.visit(centre, radius, apart, |group| {
            far.add_dipole(group.centre, group.dipole);
            far.add(group.quadrupole_angle(centre));
        });
        if radius == 0.0 {
            return Nearby { far, near: loops };
        }
        let (mut near, mut beside) = (Loops::default(), Loops::default());
        for points in loops.each() {
            let passes = passes_within(points, centre, BESIDE * radius);
            let list = if passes { &mut near } else { &mut beside };
            points.iter().for_each(|&p| list.push(p));
            list.close();
        }
        far.add_bent(beside.solid_angle(centre));
        Nearby { far, near }
    }

    /// Calls `far` with what is far from all points within `radius` of `centre`: nodes at least `apart`
    /// times as far from the centre as both radii together. Returns the rest: loops on which edges stand
    /// for the parts that are far.
    fn visit<'t>(&'t self, centre: DVec3, radius: f64, apart: f64, mut far: impl FnMut(&'t FarLoops)) -> Loops {
        let mut is_far = |node: &'t Node| {
            let is_far = node.group.centre.distance(centre) > apart * (radius + node.radius);
            if is_far {
                far(&node.group);
            }
            is_far
        };
        let mut near = Loops::default();
        let mut stack = vec![0];
        while let Some(n) = stack.pop() {
            let node = &self.nodes[n as usize];
            match node.triangle {
                _ if is_far(node) => {}
                None => stack.extend(node.children),
                Some(corners) => self.follow(node, corners, &mut is_far, &mut near),
            }
        }
        near
    }

    /// Adds a loop whose node is not far.
    fn follow<'t>(
        &'t self,
        node: &'t Node,
        [first, middle, last]: [u32; 3],
        is_far: &mut impl FnMut(&'t Node) -> bool,
        near: &mut Loops,
    ) {
        near.push(self.points[first as usize]);
        // Children, and where they end; 0 is a single edge.
        let mut parts = vec![(node.children[1], last), (node.children[0], middle)];
        while let Some((child, end)) = parts.pop() {
            let node = &self.nodes[child as usize];
            match node.triangle {
                Some([_, middle, _]) if child > 0 && !is_far(node) => {
                    parts.extend([(node.children[1], end), (node.children[0], middle)]);
                }
                _ => near.push(self.points[end as usize]),
            }
        }
        near.close();
    }
}

impl Nearby {
    /// The winding number at `p` but for a whole number.
    pub(super) fn at(&self, p: DVec3) -> Phase {
        let (mut turn, currents) = self.near.turn_and_currents(p);
        turn.times(DVec2::from_angle(0.5 * self.far.at(p)));
        Phase::new(turn, currents + self.far.gradient(p))
    }

    /// [`Phase::above`] alone.
    pub(super) fn above(&self, p: DVec3) -> f64 {
        let mut turn = self.near.turn(p);
        turn.times(DVec2::from_angle(0.5 * self.far.at(p)));
        turn.above()
    }
}

/// Whether an edge of a loop passes a point at less than `reach`.
fn passes_within(points: &[DVec3], p: DVec3, reach: f64) -> bool {
    let before = points.iter().cycle().skip(points.len() - 1);
    before.zip(points).any(|(&a, &b)| [a, b].nearest(p).0.distance_squared(p) < reach * reach)
}

/// The loops with long triangles cut in two, and again, across their longest side.
pub(super) fn cut(loops: &Loops) -> Loops {
    let longest = Bounds::of(loops.each().flatten().copied()).map_or(0.0, |bounds| bounds.diagonal()) / PIECES;
    let (mut pieces, mut spare) = (Loops::default(), MOST_PIECES);
    for points in loops.each() {
        let Ok(triangle) = <[DVec3; 3]>::try_from(points) else {
            points.iter().for_each(|&p| pieces.push(p));
            pieces.close();
            continue;
        };
        dipoles::cut(triangle, longest, &mut spare, |piece| {
            piece.into_iter().for_each(|p| pieces.push(p));
            pieces.close();
        });
    }
    pieces
}

impl FarLoops {
    /// The quadrupole's share of the solid angle seen from `p`, and its gradient.
    pub(super) fn quadrupole_angle(&self, p: DVec3) -> (f64, DVec3) {
        let r = self.centre - p;
        let second = 1.0 / r.length_squared();
        let third = second * second.sqrt();
        let bent = self.quadrupole * r;
        let trace = self.quadrupole.x_axis.x + self.quadrupole.y_axis.y + self.quadrupole.z_axis.z;
        let twice = 3.0 * r.dot(bent) * second;
        let gradient = bent * (6.0 * second) + r * ((3.0 * trace - 5.0 * twice) * second);
        ((trace - twice) * third, gradient * third)
    }

    /// Adds triangles of area vector `dipole` about `centre`.
    fn add(&mut self, centre: DVec3, dipole: DVec3) {
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let away = centre - self.centre;
        self.dipole += dipole;
        self.quadrupole += (outer(dipole, away) + outer(away, dipole)) * 0.5;
    }
}

/// The tree while it is made.
struct Builder<'l> {
    /// In the order of the tree.
    loops: Vec<&'l [DVec3]>,
    /// Those of the loops, one after another.
    points: Vec<DVec3>,
    nodes: Vec<Node>,
    /// For each node its first point and one past its last; at first the same of loops.
    ranges: Vec<[usize; 2]>,
}

impl<'l> Builder<'l> {
    fn node(&mut self, range: [usize; 2]) -> u32 {
        let group = FarLoops { centre: DVec3::ZERO, dipole: DVec3::ZERO, quadrupole: DMat3::ZERO };
        self.nodes.push(Node { group, radius: 0.0, triangle: None, children: [0; 2] });
        self.ranges.push(range);
        self.nodes.len() as u32 - 1
    }

    /// Splits the loops in two by place until each is alone.
    fn split(&mut self, loops: Vec<&'l [DVec3]>, progress: &Progress) -> Result<(), Stopped> {
        let mean = |points: &'l [DVec3]| points.iter().sum::<DVec3>() / points.len() as f64;
        let mut placed: Vec<(DVec3, &[DVec3])> = loops.into_iter().map(|points| (mean(points), points)).collect();
        let mut stack = vec![self.node([0, placed.len()])];
        while let Some(n) = stack.pop() {
            let [first, end] = self.ranges[n as usize];
            let mine = &mut placed[first..end];
            if mine.len() < 2 {
                continue;
            }
            if mine.len() >= CHECK_FROM {
                progress.check()?;
            }
            let size = Bounds::of(mine.iter().map(|(place, _)| *place)).map_or(DVec3::ZERO, |bounds| bounds.size());
            let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
            let middle = mine.len() / 2;
            mine.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
            let children = [[first, first + middle], [first + middle, end]].map(|range| self.node(range));
            self.nodes[n as usize].children = children;
            stack.extend(children);
        }
        self.loops = placed.into_iter().map(|(_, points)| points).collect();
        Ok(())
    }

    /// Halves each loop until it is a triangle.
    fn halve(&mut self) {
        let mut ends = vec![0];
        for points in &self.loops {
            self.points.extend_from_slice(points);
            ends.push(self.points.len());
        }
        self.ranges.iter_mut().flatten().for_each(|at| *at = ends[*at]);
        let is_loop = |node: &Node| node.children == [0; 2];
        let mut stack: Vec<u32> = (0..self.nodes.len() as u32).filter(|&n| is_loop(&self.nodes[n as usize])).collect();
        while let Some(n) = stack.pop() {
            let [first, end] = self.ranges[n as usize];
            let middle = (first + end - 1) / 2;
            self.nodes[n as usize].triangle = Some([first, middle, end - 1].map(|v| v as u32));
            for (k, range) in [[first, middle + 1], [middle, end]].into_iter().enumerate() {
                if range[1] - range[0] > 2 {
                    let child = self.node(range);
                    self.nodes[n as usize].children[k] = child;
                    stack.push(child);
                }
            }
        }
    }

    /// Sums the nodes. Children come after their parents.
    fn measure(&mut self, progress: &Progress) -> Result<(), Stopped> {
        for n in (0..self.nodes.len()).rev() {
            let points = &self.points[self.ranges[n][0]..self.ranges[n][1]];
            if points.len() >= CHECK_FROM {
                progress.check()?;
            }
            let bounds = Bounds::of(points.iter().copied());
            let centre = bounds.map_or(DVec3::ZERO, |bounds| (bounds.min + bounds.max) / 2.0);
            let mut node = self.nodes[n];
            node.group.centre = centre;
            node.radius = points.iter().map(|p| p.distance_squared(centre)).fold(0.0, f64::max).sqrt();
            for child in node.children.into_iter().filter(|&child| child > 0) {
                let child = self.nodes[child as usize].group;
                node.group.add(child.centre, child.dipole);
                node.group.quadrupole += child.quadrupole;
            }
            if let Some([a, b, c]) = node.triangle.map(|t| t.map(|v| self.points[v as usize])) {
                // About its own centre a triangle has no quadrupole.
                node.group.add((a + b + c) / 3.0, (b - a).cross(c - a) / 2.0);
            }
            self.nodes[n] = node;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::TriMesh;
    use crate::vote::dipoles::complete;
    use crate::vote::dipoles::tests::{places, sphere, sum_of_all};
    use crate::vote::phase::tests::by_differences;

    fn tree(mesh: &TriMesh) -> LoopTree {
        let loops = Loops::around(mesh, 0..mesh.triangles.len(), &Progress::none()).expect("not stopped");
        LoopTree::new(&loops, &Progress::none()).expect("not stopped")
    }

    #[test]
    fn a_torn_sphere_is_summed_to_a_thousandth() {
        let mut mesh = sphere(60, 100);
        mesh.triangles = mesh.triangles.into_iter().enumerate().filter(|(n, _)| n % 3 != 0).map(|(_, t)| t).collect();
        let tree = tree(&mesh);
        let mut largest = (0.0f64, 0.0f64);
        for p in places(500) {
            let nearby = tree.around(p + DVec3::new(0.01, 0.0, -0.01), 0.02, 5.0);
            let (all, phase) = (sum_of_all(&mesh, p), nearby.at(p));
            largest.0 = largest.0.max((complete(phase.above, all) - all).abs());
            let gradient = by_differences(|q| nearby.at(q).above, p, 1e-6);
            largest.1 = largest.1.max(phase.gradient.distance(gradient) / (1.0 + gradient.length()));
        }
        assert!(largest.0 < 1e-3 && largest.1 < 1e-5, "{largest:?}");
    }
}
