//! The generalised winding number of a soup (Jacobson et al. 2013), summed over a tree of dipoles
//! (Barill et al. 2018). It decides the voxels that the rays are not sure of: over a flat hole its
//! level ½ is the flat lid, and it does not mind stray triangles.

use std::sync::OnceLock;

use glam::{DVec3, IVec3};

use crate::lattice::Lattice;
use crate::ldi::{Expression, Operands};
use crate::mesh::TriMesh;

/// Triangles in a leaf, at most.
const LEAF: usize = 8;
/// A node stands for its triangles from this many of its radii on. 2 leaves errors to 0.02, enough
/// to roughen a lid; 3 stays under 0.005.
const FAR: f64 = 3.0;
const FOUR_PI: f64 = 4.0 * std::f64::consts::PI;

#[derive(Debug, Clone, Copy)]
struct Node {
    /// Mean position of the triangles, weighted by area.
    centre: DVec3,
    /// Sum of the area vectors.
    dipole: DVec3,
    /// Square of [`FAR`] times the distance of the farthest corner from the centre.
    near: f64,
    /// First triangle, and their number; a leaf has children at 0.
    first: u32,
    count: u32,
    /// The first of two children that follow each other, or 0.
    children: u32,
}

/// The winding numbers of all operands at voxels. The trees are made when they are first needed:
/// the voxels of a closed mesh need none.
pub struct Winding<'a> {
    soup: &'a TriMesh,
    operands: &'a Operands,
    lattice: Lattice,
    trees: OnceLock<Vec<WindingTree>>,
}

impl<'a> Winding<'a> {
    /// Of the operands of `soup`, at the voxels of `lattice`.
    pub fn new(soup: &'a TriMesh, operands: &'a Operands, lattice: &Lattice) -> Self {
        Self { soup, operands, lattice: *lattice, trees: OnceLock::new() }
    }

    /// Whether `voxel` is inside the result, when an operand is inside from a winding number of ½.
    pub fn is_inside(&self, voxel: IVec3, expression: &Expression) -> bool {
        let p = self.lattice.to_model(voxel.as_dvec3());
        let inside = |tree: &WindingTree| tree.winding(p) > 0.5;
        match self.trees() {
            [one] => expression.evaluate(&[inside(one)]),
            trees => expression.evaluate(&trees.iter().map(inside).collect::<Vec<bool>>()),
        }
    }

    fn trees(&self) -> &[WindingTree] {
        self.trees.get_or_init(|| {
            // Without rayon: a thread that waits for others here could be handed a brick that waits for it.
            let all = 0..self.operands.count();
            all.map(|operand| WindingTree::new(self.soup, self.operands.range(operand))).collect()
        })
    }
}

/// A tree over the triangles of one operand.
#[derive(Debug, Clone)]
pub struct WindingTree {
    nodes: Vec<Node>,
    /// Corners of the triangles, in the order of the leaves.
    corners: Vec<[DVec3; 3]>,
}

impl WindingTree {
    /// The tree over the triangles `range` of `mesh`; points are in the mesh's own space.
    pub fn new(mesh: &TriMesh, range: std::ops::Range<usize>) -> Self {
        let mut corners: Vec<[DVec3; 3]> = range.map(|t| mesh.corners(t)).collect();
        let mut tree = Self { nodes: Vec::with_capacity(corners.len() / 2 + 2), corners: Vec::new() };
        tree.nodes.push(node(&corners, 0));
        tree.split(0, &mut corners);
        tree.corners = corners;
        tree
    }

    fn split(&mut self, at: usize, corners: &mut [[DVec3; 3]]) {
        let mut stack = vec![at];
        while let Some(at) = stack.pop() {
            let (first, count) = (self.nodes[at].first as usize, self.nodes[at].count as usize);
            if count <= LEAF {
                continue;
            }
            let mine = &mut corners[first..first + count];
            let axis = longest_axis(mine);
            let middle = count / 2;
            mine.select_nth_unstable_by(middle, |a, b| centre(a)[axis].total_cmp(&centre(b)[axis]));
            let children = self.nodes.len();
            self.nodes[at].children = children as u32;
            let (low, high) = mine.split_at(middle);
            self.nodes.push(node(low, first));
            self.nodes.push(node(high, first + middle));
            stack.extend([children, children + 1]);
        }
    }

    /// How often the surface winds around `p`: 1 inside of a closed mesh, 0 outside, in between
    /// near holes.
    pub fn winding(&self, p: DVec3) -> f64 {
        let mut solid_angle = 0.0;
        let mut stack = [0u32; 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let node = &self.nodes[stack[depth] as usize];
            let away = node.centre - p;
            let squared = away.length_squared();
            if squared > node.near {
                solid_angle += node.dipole.dot(away) / (squared * squared.sqrt());
            } else if node.children == 0 {
                let own = node.first as usize..(node.first + node.count) as usize;
                solid_angle += self.corners[own].iter().map(|t| solid_angle_of(t, p)).sum::<f64>();
            } else {
                // Halving keeps the tree under 32 levels, one pending sibling each.
                stack[depth] = node.children + 1;
                stack[depth + 1] = node.children;
                depth += 2;
            }
        }
        solid_angle / FOUR_PI
    }
}

fn centre(t: &[DVec3; 3]) -> DVec3 {
    t[0] + t[1] + t[2]
}

fn longest_axis(corners: &[[DVec3; 3]]) -> usize {
    let (min, max) = corners.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), t| {
        let c = centre(t);
        (min.min(c), max.max(c))
    });
    let size = max - min;
    (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0)
}

fn node(corners: &[[DVec3; 3]], first: usize) -> Node {
    let (mut weighted, mut area, mut dipole) = (DVec3::ZERO, 0.0, DVec3::ZERO);
    for t in corners {
        let vector = (t[1] - t[0]).cross(t[2] - t[0]) / 2.0;
        let size = vector.length();
        dipole += vector;
        weighted += centre(t) * (size / 3.0);
        area += size;
    }
    let centre = if area > 0.0 { weighted / area } else { corners.first().map_or(DVec3::ZERO, |t| t[0]) };
    let radius = corners.iter().flatten().map(|&p| p.distance_squared(centre)).fold(0.0, f64::max);
    Node { centre, dipole, near: FAR * FAR * radius, first: first as u32, count: corners.len() as u32, children: 0 }
}

/// Signed solid angle of a triangle seen from `p` (van Oosterom & Strackee 1983); positive seen
/// from its inner side.
fn solid_angle_of(t: &[DVec3; 3], p: DVec3) -> f64 {
    let [a, b, c] = t.map(|q| q - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let volume = a.dot(b.cross(c));
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * volume.atan2(denominator)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bumpy sphere of 2 × `n` × `n` triangles, less `missing` of them.
    fn sphere(n: u32, missing: usize) -> TriMesh {
        let at = |i: u32, j: u32| {
            let (a, b) =
                (std::f64::consts::TAU * (i % n) as f64 / n as f64, std::f64::consts::PI * j as f64 / n as f64);
            DVec3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos()) * (1.0 + 0.1 * (3.0 * a).sin() * b.sin())
        };
        let mut mesh = TriMesh::default();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let k = mesh.positions.len() as u32;
            mesh.positions.extend([at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
            mesh.triangles.extend([[k, k + 1, k + 2], [k, k + 2, k + 3]]);
        }
        mesh.triangles.truncate(mesh.triangles.len() - missing);
        mesh
    }

    #[test]
    fn the_tree_agrees_with_the_sum_over_all_triangles() {
        for missing in [0, 300] {
            let mesh = sphere(40, missing);
            let tree = WindingTree::new(&mesh, 0..mesh.triangles.len());
            for k in 0..500 {
                let p = DVec3::new((k as f64 * 0.37).sin(), (k as f64 * 0.73).sin(), (k as f64 * 1.13).sin()) * 1.4;
                let all = (0..mesh.triangles.len()).map(|t| solid_angle_of(&mesh.corners(t), p)).sum::<f64>() / FOUR_PI;
                let got = tree.winding(p);
                assert!((got - all).abs() < 0.005, "{got} for {all} at {p}");
                if missing == 0 && (p.length() < 0.85 || p.length() > 1.15) {
                    assert!((got - if p.length() < 1.0 { 1.0 } else { 0.0 }).abs() < 0.005);
                }
            }
        }
    }
}
