//! What of a surface will have to be made, told from its triangles alone: lids over its holes, and bends.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::mesh::TriMesh;
use crate::mesh::edges::Union;
use crate::mesh::weld::welded_triangles;

/// Beside an edge that bends, a rebuilt surface cannot be simplified within about this distance, h, on either side
/// (of four values the one with which plans come nearest to peaks).
const BEND_REACH: f64 = 0.15;

/// The cosine of the angle from which on neighbours do not lie in one plane.
const STRAIGHT: f64 = 0.9999;

/// A rim is flat when its vertices lie no farther from its plane than this part of the root of its area.
const PLANE: f64 = 1e-3;

/// What was found, square model units where it says no other.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Outlook {
    /// What closes the holes: for each rim the area that it encloses.
    pub lids: f64,
    /// The part of it that lies in no plane: flat lids take few triangles.
    pub curved_lids: f64,
    /// For each triangle with an edge that bends its area, and the length of these edges, model units.
    bends: Vec<(f64, f64)>,
}

/// An edge of a triangle, from the vertex with the lower number; `forwards`: as the triangle has it.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    ends: [u32; 2],
    triangle: u32,
    forwards: bool,
}

impl Outlook {
    /// Of one mesh; vertices of equal coordinates are one.
    pub(super) fn of(mesh: &TriMesh) -> Self {
        let triangles = welded_triangles(mesh);
        let mut sides: Vec<Side> = (0u32..).zip(&triangles).flat_map(|(n, &triangle)| sides(n, triangle)).collect();
        sides.par_sort_unstable();
        let at = |v: u32| mesh.positions[v as usize];
        let vectors: Vec<DVec3> =
            triangles.par_iter().map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)) / 2.0).collect();
        let mut rims = Rims::new(mesh.positions.len());
        let mut bent = vec![0.0; triangles.len()];
        for shared in sides.chunk_by(|a, b| a.ends == b.ends) {
            let length = at(shared[0].ends[0]).distance(at(shared[0].ends[1]));
            match shared {
                [alone] => rims.add(alone),
                [a, b] if flat(vectors[a.triangle as usize], vectors[b.triangle as usize]) => {}
                _ => shared.iter().for_each(|side| bent[side.triangle as usize] += length),
            }
        }
        let bends = bent.iter().zip(&vectors).filter(|(length, _)| **length > 0.0);
        let (lids, curved_lids) = rims.areas(at);
        Self { lids, curved_lids, bends: bends.map(|(&length, vector)| (vector.length(), length)).collect() }
    }

    /// Of several.
    pub(super) fn of_all(meshes: &[&TriMesh]) -> Self {
        meshes.iter().map(|mesh| Self::of(mesh)).fold(Self::default(), |mut all, mut one| {
            all.lids += one.lids;
            all.curved_lids += one.curved_lids;
            all.bends.append(&mut one.bends);
            all
        })
    }

    /// Of what lies beside bends, h², for a voxel of `h`.
    pub(super) fn bent_cells(&self, h: f64) -> f64 {
        self.bends.iter().map(|&(area, length)| area.min(BEND_REACH * h * length)).sum::<f64>() / (h * h)
    }
}

fn sides(triangle: u32, [a, b, c]: [u32; 3]) -> impl Iterator<Item = Side> {
    let side = move |[a, b]: [u32; 2]| Side { ends: [a.min(b), a.max(b)], triangle, forwards: a < b };
    [[a, b], [b, c], [c, a]].into_iter().filter(|[a, b]| a != b).map(side)
}

/// Whether two triangles, by their area vectors, lie in one plane, whichever way they face.
fn flat(a: DVec3, b: DVec3) -> bool {
    a.dot(b).abs() >= STRAIGHT * a.length() * b.length()
}

/// Edges of one triangle each, joined where they share a vertex.
struct Rims {
    vertices: Union,
    edges: Vec<[u32; 2]>,
}

impl Rims {
    fn new(vertices: usize) -> Self {
        Self { vertices: Union::new(vertices), edges: Vec::new() }
    }

    fn add(&mut self, side: &Side) {
        let [a, b] = side.ends;
        self.vertices.join(a, b);
        self.edges.push(if side.forwards { [a, b] } else { [b, a] });
    }

    /// The sizes of the rims' area vectors, added up: of all, and of those that lie in no plane.
    fn areas(mut self, at: impl Fn(u32) -> DVec3) -> (f64, f64) {
        let mut vectors: FxHashMap<u32, DVec3> = FxHashMap::default();
        let edges = std::mem::take(&mut self.edges);
        for &[a, b] in &edges {
            let root = self.vertices.root(a);
            // Seen from a vertex of the rim itself, so that far from the origin nothing is lost.
            let from = at(root);
            *vectors.entry(root).or_default() += (at(a) - from).cross(at(b) - from) / 2.0;
        }
        let mut curved: FxHashSet<u32> = FxHashSet::default();
        for [a, _] in edges {
            let root = self.vertices.root(a);
            let vector = vectors[&root];
            if (at(a) - at(root)).dot(vector.normalize_or_zero()).abs() > PLANE * vector.length().sqrt() {
                curved.insert(root);
            }
        }
        let sum = |keep: &dyn Fn(&u32) -> bool| {
            let kept = vectors.iter().filter(|(root, _)| keep(root));
            let mut sizes: Vec<f64> = kept.map(|(_, vector)| vector.length()).collect();
            // The order of a hash table must not show, not even in the last bit.
            sizes.sort_unstable_by(f64::total_cmp);
            sizes.iter().sum()
        };
        (sum(&|_| true), sum(&|root| curved.contains(root)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The box from the origin to `size`.
    fn cuboid(size: DVec3) -> TriMesh {
        let positions =
            (0..8).map(|n| DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64) * size).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh { positions, triangles }
    }

    #[test]
    fn lids_are_as_large_as_the_holes() {
        let mut mesh = cuboid(DVec3::new(2.0, 3.0, 5.0));
        assert_eq!(Outlook::of(&mesh).lids, 0.0);
        // Without its last side, 3 by 5, it is open; corners of their own for each triangle change nothing.
        mesh.triangles.truncate(10);
        assert!((Outlook::of(&mesh).lids - 15.0).abs() < 1e-9);
        let soup = TriMesh {
            positions: mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect(),
            triangles: (0..10).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        };
        assert!((Outlook::of(&soup).lids - 15.0).abs() < 1e-9);
        assert_eq!(Outlook::of(&soup).curved_lids, 0.0);
        mesh.triangles.drain(0..2);
        // With the one beside it, 2 by 3, both are one hole, which is closed by less than both sides.
        let both = Outlook::of(&mesh);
        assert!((both.lids - 15f64.hypot(6.0)).abs() < 1e-9 && both.curved_lids == both.lids);
    }

    #[test]
    fn only_what_lies_beside_bends_is_bent() {
        let outlook = Outlook::of(&cuboid(DVec3::splat(10.0)));
        // Twelve edges of ten, each beside two triangles; the diagonals are flat.
        assert!((outlook.bent_cells(1.0) - 0.15 * 240.0).abs() < 1e-9);
        // No more than there is.
        assert!((outlook.bent_cells(50.0) - 600.0 / 2500.0).abs() < 1e-9);
        let two = Outlook::of_all(&[&cuboid(DVec3::ONE), &cuboid(DVec3::ONE)]);
        assert!((two.bent_cells(0.1) - 2.0 * 0.15 * 24.0 / 0.1).abs() < 1e-9);
    }
}
