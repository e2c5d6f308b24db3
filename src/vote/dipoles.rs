//! Dipoles: the winding number of a soup summed over a tree (Barill et al. 2018).

use glam::DVec3;

use super::expansion::Expansion;
use crate::mesh::{Bounds, TriMesh};
use crate::progress::{Progress, Stopped};

/// Nodes of so many triangles take long enough to look whether to stop.
const CHECK_FROM: usize = 1 << 14;
/// Triangles in a leaf, at most.
const LEAF: usize = 8;
/// A node stands for its triangles from this many of its radii on. Seen from the inside of a bumpy
/// sphere, where all errors have one sign, 3 leaves errors up to 0.02; 2 roughened lids.
const FAR: f64 = 3.0;
/// Where only the nearest whole number is looked for, [`FAR`] times the root of this serves.
const NEAREST: f64 = 0.25;
/// And where one value serves a block of voxels: two radii...
const ROUGH: f64 = 4.0 / 9.0;
/// ...of the node, and of the block.
const APART: f64 = 2.0;
/// The error then, as a share of the sum of the far dipoles' sizes. Measured: up to 0.12 near the
/// surfaces of lion, beetle and camelhead, where errors reach 0.107.
const ERROR: f64 = 0.13;
/// And where dipoles cancel.
const LEAST_ERROR: f64 = 0.02;
/// Triangles longer than this part of the bounding box's diagonal are cut. A box takes a few
/// thousand pieces; files of slivers get ten times faster.
const PIECES: f64 = 48.0;
/// Cutting adds at most so many pieces (136 bytes each): a file of many slivers as long as the whole
/// would take hundreds of times its own size. What is left whole is exact too, only slower.
const MOST_PIECES: usize = 1 << 20;
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

impl Node {
    const NONE: Self = Self { centre: DVec3::ZERO, dipole: DVec3::ZERO, near: 0.0, first: 0, count: 0, children: 0 };
}

/// The winding number of one operand at any point, by a tree over its triangles: groups of triangles far from the point
/// count as one dipole.
#[derive(Debug, Clone)]
pub struct WindingTree {
    nodes: Vec<Node>,
    /// The triangles, in the order of the leaves.
    faces: Vec<Face>,
}

/// One triangle.
#[derive(Debug, Clone, Copy)]
struct Face {
    corners: [DVec3; 3],
    centre: DVec3,
    /// The area vector.
    dipole: DVec3,
    /// As in [`Node`].
    near: f64,
}

impl Face {
    fn new(corners: [DVec3; 3]) -> Self {
        let centre = (corners[0] + corners[1] + corners[2]) / 3.0;
        let radius = corners.iter().map(|&p| p.distance_squared(centre)).fold(0.0, f64::max);
        let dipole = (corners[1] - corners[0]).cross(corners[2] - corners[0]) / 2.0;
        Self { corners, centre, dipole, near: FAR * FAR * radius }
    }

    #[inline]
    fn solid_angle(&self, p: DVec3) -> f64 {
        let away = self.centre - p;
        let squared = away.length_squared();
        if squared > self.near {
            return self.dipole.dot(away) / (squared * squared.sqrt());
        }
        solid_angle_of(&self.corners, p)
    }
}

impl WindingTree {
    /// The tree over the triangles `range` of `mesh`; points are in the mesh's own space.
    pub fn new(mesh: &TriMesh, range: std::ops::Range<usize>, progress: &Progress) -> Result<Self, Stopped> {
        Self::made(mesh, range, Threads::All, progress)
    }

    /// The same made by the calling thread alone.
    pub(super) fn on_one_thread(
        mesh: &TriMesh,
        range: std::ops::Range<usize>,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        Self::made(mesh, range, Threads::One, progress)
    }

    fn made(
        mesh: &TriMesh,
        range: std::ops::Range<usize>,
        threads: Threads,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        let bounds = Bounds::of(range.clone().flat_map(|t| mesh.corners(t)));
        let longest = bounds.map_or(0.0, |b| b.diagonal()) / PIECES;
        let mut faces = Vec::with_capacity(range.len());
        let mut spare = MOST_PIECES;
        range.for_each(|t| cut(mesh.corners(t), longest, &mut spare, |piece| faces.push(Face::new(piece))));
        let nodes = branch(&mut faces, 0, threads, progress)?.flattened();
        Ok(Self { nodes, faces })
    }

    /// The triangles of a node.
    fn faces_of(&self, node: &Node) -> &[Face] {
        &self.faces[node.first as usize..(node.first + node.count) as usize]
    }

    /// Prepares for many points within `radius` of `centre`: what is far from all of them becomes a
    /// polynomial of second degree.
    pub(super) fn around(&self, centre: DVec3, radius: f64) -> Dipoles<'_> {
        let mut dipoles = Dipoles { far: Expansion::about(centre), size: 0.0, near: Vec::new() };
        let apart = (APART * radius).powi(2);
        let is_far = |at: DVec3, near: f64| at.distance_squared(centre) > (ROUGH * near).max(apart);
        let mut stack = vec![0u32];
        while let Some(n) = stack.pop() {
            let node = &self.nodes[n as usize];
            if is_far(node.centre, node.near) {
                dipoles.add(node.centre, node.dipole);
            } else if node.children == 0 {
                for face in self.faces_of(node) {
                    if is_far(face.centre, face.near) {
                        dipoles.add(face.centre, face.dipole);
                    } else {
                        dipoles.near.push(face);
                    }
                }
            } else {
                stack.extend([node.children + 1, node.children]);
            }
        }
        dipoles
    }

    /// How often the surface winds around `p`: 1 inside of a closed mesh, 0 outside, in between
    /// near holes.
    pub fn winding(&self, p: DVec3) -> f64 {
        self.sum(p, 1.0)
    }

    /// The winding number at `p`, given how much it is over ½ but for a whole number.
    pub(super) fn complete(&self, above: f64, p: DVec3) -> f64 {
        let rough = self.sum(p, NEAREST);
        let w = complete(above, rough);
        if (w - rough).abs() < 0.2 { w } else { complete(above, self.winding(p)) }
    }

    /// The sum with nodes that stand for their triangles from a share of [`FAR`] on, given squared.
    fn sum(&self, p: DVec3, share: f64) -> f64 {
        let mut solid_angle = 0.0;
        let mut stack = [0u32; 64];
        let mut depth = 1;
        while depth > 0 {
            depth -= 1;
            let node = &self.nodes[stack[depth] as usize];
            let away = node.centre - p;
            let squared = away.length_squared();
            if squared > share * node.near {
                solid_angle += node.dipole.dot(away) / (squared * squared.sqrt());
            } else if node.children == 0 {
                solid_angle += self.faces_of(node).iter().map(|face| face.solid_angle(p)).sum::<f64>();
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

/// The number nearest to `rough` that is `above` over ½ but for a whole number.
pub(super) fn complete(above: f64, rough: f64) -> f64 {
    let w = above + 0.5;
    w + (rough - w).round()
}

/// Who makes a tree.
#[derive(Debug, Clone, Copy)]
enum Threads {
    One,
    All,
}

/// Part of a tree in the making.
enum Branch {
    /// All of it: the root first, children by their place in the list.
    Whole(Vec<Node>),
    /// A node and what is under it.
    Fork(Node, Box<[Self; 2]>),
}

/// The tree over `faces`, which are sorted for it; they begin at number `first` of all. Parts of many are made side by side.
fn branch(faces: &mut [Face], first: usize, threads: Threads, progress: &Progress) -> Result<Branch, Stopped> {
    if faces.len() < CHECK_FROM {
        return Ok(Branch::Whole(subtree(faces, first)));
    }
    progress.check()?;
    let root = node(faces, first);
    let (low, high) = halved(faces);
    let middle = first + low.len();
    let (mut low, mut high) = (|| branch(low, first, threads, progress), || branch(high, middle, threads, progress));
    let (low, high) = match threads {
        Threads::All => rayon::join(low, high),
        Threads::One => (low(), high()),
    };
    Ok(Branch::Fork(root, Box::new([low?, high?])))
}

/// The same of few.
fn subtree(faces: &mut [Face], first: usize) -> Vec<Node> {
    let mut nodes = vec![node(faces, first)];
    let mut stack = vec![0];
    while let Some(at) = stack.pop() {
        let (start, count) = (nodes[at].first as usize - first, nodes[at].count as usize);
        if count <= LEAF {
            continue;
        }
        let (low, high) = halved(&mut faces[start..start + count]);
        let children = nodes.len();
        nodes[at].children = children as u32;
        nodes.extend([node(low, first + start), node(high, first + start + low.len())]);
        stack.extend([children, children + 1]);
    }
    nodes
}

/// Faces in two halves along their longest axis.
fn halved(faces: &mut [Face]) -> (&mut [Face], &mut [Face]) {
    let axis = longest_axis(faces);
    let middle = faces.len() / 2;
    faces.select_nth_unstable_by(middle, |a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    faces.split_at_mut(middle)
}

impl Branch {
    /// All nodes, the root first.
    fn flattened(self) -> Vec<Node> {
        let mut nodes = vec![Node::NONE];
        self.put(&mut nodes, 0);
        nodes
    }

    /// Puts the root at a place of the list, and all others at its end.
    fn put(self, nodes: &mut Vec<Node>, at: usize) {
        match self {
            Self::Whole(own) => {
                // What was at place 1 comes next.
                let shift = nodes.len() as u32 - 1;
                let moved =
                    |node: Node| Node { children: if node.children == 0 { 0 } else { node.children + shift }, ..node };
                let mut own = own.into_iter().map(moved);
                nodes[at] = own.next().unwrap_or(Node::NONE);
                nodes.extend(own);
            }
            Self::Fork(node, children) => {
                let place = nodes.len();
                nodes[at] = Node { children: place as u32, ..node };
                nodes.extend([Node::NONE; 2]);
                children.into_iter().zip(place..).for_each(|(child, at)| child.put(nodes, at));
            }
        }
    }
}

fn longest_axis(faces: &[Face]) -> usize {
    let (min, max) = faces
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), f| (min.min(f.centre), max.max(f.centre)));
    let size = max - min;
    (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0)
}

fn node(faces: &[Face], first: usize) -> Node {
    let (mut weighted, mut area, mut dipole) = (DVec3::ZERO, 0.0, DVec3::ZERO);
    for face in faces {
        let size = face.dipole.length();
        dipole += face.dipole;
        weighted += face.centre * size;
        area += size;
    }
    let centre = if area > 0.0 { weighted / area } else { faces.first().map_or(DVec3::ZERO, |f| f.centre) };
    let radius = faces.iter().flat_map(|f| f.corners).map(|p| p.distance_squared(centre)).fold(0.0, f64::max);
    Node { centre, dipole, near: FAR * FAR * radius, first: first as u32, count: faces.len() as u32, children: 0 }
}

/// The surface near one place.
pub(super) struct Dipoles<'t> {
    far: Expansion,
    /// Σ |D|/r² of what is far.
    size: f64,
    near: Vec<&'t Face>,
}

impl Dipoles<'_> {
    fn add(&mut self, at: DVec3, dipole: DVec3) {
        self.far.add_dipole(at, dipole);
        self.size += dipole.length() / at.distance_squared(self.far.centre);
    }

    /// By about how much [`Self::winding`] may err.
    pub(super) fn error(&self) -> f64 {
        LEAST_ERROR + ERROR * self.size / FOUR_PI
    }

    pub(super) fn winding(&self, p: DVec3) -> f64 {
        (self.far.at(p) + self.near.iter().map(|face| face.solid_angle(p)).sum::<f64>()) / FOUR_PI
    }
}

/// Cuts triangles that are long beside the whole at their longest edge, so that dipoles stand for
/// them at shorter distances. Each cut takes one of the `spare` pieces, until there are none.
pub(super) fn cut(corners: [DVec3; 3], longest: f64, spare: &mut usize, mut piece: impl FnMut([DVec3; 3])) {
    let mut stack = vec![corners];
    while let Some([a, b, c]) = stack.pop() {
        let lengths = [a.distance_squared(b), b.distance_squared(c), c.distance_squared(a)];
        let turn = (0..3).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j])).unwrap_or(0);
        if lengths[turn] <= longest * longest || *spare == 0 {
            piece([a, b, c]);
            continue;
        }
        *spare -= 1;
        let [a, b, c] = [[a, b, c], [b, c, a], [c, a, b]][turn];
        let middle = (a + b) / 2.0;
        stack.extend([[middle, b, c], [a, middle, c]]);
    }
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
pub(super) mod tests {
    use super::*;

    /// A bumpy sphere of 2 × `n` × `n` triangles, less `missing` of them.
    pub(in crate::vote) fn sphere(n: u32, missing: usize) -> TriMesh {
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

    /// The winding number, summed over all triangles.
    pub(in crate::vote) fn sum_of_all(mesh: &TriMesh, p: DVec3) -> f64 {
        (0..mesh.triangles.len()).map(|t| solid_angle_of(&mesh.corners(t), p)).sum::<f64>() / FOUR_PI
    }

    /// Points in and around a sphere.
    pub(in crate::vote) fn places(count: usize) -> impl Iterator<Item = DVec3> {
        let at = |k: f64| DVec3::new((k * 0.37).sin(), (k * 0.73).sin(), (k * 1.13).sin()) * 1.4;
        (0..count).map(move |k| at(k as f64))
    }

    /// The largest error measured is 0.020.
    const ALLOWED: f64 = 0.022;

    #[test]
    fn the_tree_agrees_with_the_sum_over_all_triangles() {
        for missing in [0, 300] {
            let mesh = sphere(40, missing);
            let tree = WindingTree::new(&mesh, 0..mesh.triangles.len(), &Progress::none()).expect("not stopped");
            for p in places(500) {
                let all = sum_of_all(&mesh, p);
                let got = tree.winding(p);
                let above = all - 0.5 - (all - 0.5).round();
                let dipoles = tree.around(p + DVec3::new(0.02, -0.03, 0.01), 0.05);
                let error = (dipoles.winding(p) - all).abs();
                assert!(error < dipoles.error() && dipoles.error() < 0.4, "{error} at {p}");
                assert!((tree.complete(above, p) - all).abs() < 1e-12, "{all} at {p}");
                assert!((got - all).abs() < ALLOWED, "{got} for {all} at {p}");
                if missing == 0 && (p.length() < 0.85 || p.length() > 1.15) {
                    assert!((got - if p.length() < 1.0 { 1.0 } else { 0.0 }).abs() < ALLOWED);
                }
            }
        }
    }

    #[test]
    fn long_triangles_are_cut_into_a_bounded_number_of_pieces_and_the_sum_stays() {
        let sliver = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 1e-3, 0.0)];
        let (mut spare, mut faces) = (100, Vec::new());
        cut(sliver, 1.0 / 1024.0, &mut spare, |piece| faces.push(Face::new(piece)));
        assert_eq!((spare, faces.len()), (0, 101));
        let p = DVec3::new(0.3, 0.2, 0.01);
        let sum: f64 = faces.iter().map(|face| solid_angle_of(&face.corners, p)).sum();
        assert!((sum - solid_angle_of(&sliver, p)).abs() < 1e-12);
        // Where halving no longer makes anything shorter, the bound ends it.
        let far = sliver.map(|p| p + 1e15);
        cut(far, 1e-3, &mut 1000, |piece| faces.push(Face::new(piece)));
        assert!(faces.len() <= 101 + 1001);
    }
}
