//! Sharp edges of one mesh, looked for in the other.

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::surface::Frame;
use crate::mesh::edges::Edges;
use crate::mesh::{ClosestTree, TriMesh};
use crate::progress::{Progress, Stopped};

/// Edges whose two triangles' normals are farther apart than this are sharp, degrees.
const SHARP: f64 = 30.0;

/// Points that one thread searches before it looks whether it should stop.
const CHUNK: usize = 1 << 12;

/// How the sharp edges agree: those with exactly two triangles whose normals are over 30 degrees apart, vertices of
/// equal coordinates taken as one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SharpEdges {
    /// A point is found when an edge of the other mesh is at most this far, model units.
    pub tolerance: f64,
    /// Length of A's sharp edges, model units.
    pub length_a: f64,
    /// Length of B's sharp edges, model units.
    pub length_b: f64,
    /// Share of A's sharp edges that are found in B, 0 to 1; `None` where A has none.
    pub recall: Option<f64>,
    /// Share of B's sharp edges that are found in A, 0 to 1; `None` where B has none.
    pub precision: Option<f64>,
}

/// Compares the sharp edges of A and B at `count` samples along those of each. The meshes and `tolerance` are scaled.
pub(super) fn compare(
    meshes: [&TriMesh; 2],
    frame: &Frame,
    tolerance: f64,
    count: usize,
    progress: &Progress,
) -> Result<SharpEdges, Stopped> {
    let [a, b] = meshes.map(Creases::of);
    progress.check()?;
    let [tree_a, tree_b] = [&a, &b].map(|creases| ClosestTree::new(creases.segments.clone()));
    Ok(SharpEdges {
        tolerance: tolerance / frame.scale,
        length_a: a.length() / frame.scale,
        length_b: b.length() / frame.scale,
        recall: a.found_in(&tree_b, tolerance, count, progress)?,
        precision: b.found_in(&tree_a, tolerance, count, progress)?,
    })
}

/// The sharp edges of a mesh.
struct Creases {
    segments: Vec<[DVec3; 2]>,
    /// Length of each segment and all before it.
    lengths: Vec<f64>,
}

impl Creases {
    fn of(mesh: &TriMesh) -> Self {
        let mut mesh = mesh.welded();
        let cross = |mesh: &TriMesh, t: usize| {
            let [a, b, c] = mesh.corners(t);
            (b - a).cross(c - a)
        };
        let kept: Vec<usize> = (0..mesh.triangles.len()).filter(|&t| cross(&mesh, t).length() > 0.0).collect();
        let normals: Vec<DVec3> = kept.iter().map(|&t| cross(&mesh, t)).map(|n| n / n.length()).collect();
        mesh.triangles = kept.iter().map(|&t| mesh.triangles[t]).collect();
        let edges = Edges::new(&mesh.triangles, mesh.positions.len());
        let limit = SHARP.to_radians().cos();
        let mut segments = Vec::new();
        edges.each(|edge| {
            let mut halves = edge.halves();
            let (Some(left), Some(right), None) = (halves.next(), halves.next(), halves.next()) else { return };
            let cosine = normals[left as usize / 3].dot(normals[right as usize / 3]);
            // Neighbours that face opposite ways: one of the normals is the wrong one.
            let same_way = edges.runs_up(left) == edges.runs_up(right);
            if (if same_way { -cosine } else { cosine }) < limit {
                segments.push(edge.ends.map(|v| mesh.positions[v as usize]));
            }
        });
        let mut total = 0.0;
        let lengths = segments.iter().map(|[a, b]| {
            total += a.distance(*b);
            total
        });
        Self { lengths: lengths.collect(), segments }
    }

    fn length(&self) -> f64 {
        self.lengths.last().copied().unwrap_or(0.0)
    }

    /// Share of these edges within `tolerance` of those in `other`; `None` without edges.
    fn found_in(
        &self,
        other: &ClosestTree<[DVec3; 2]>,
        tolerance: f64,
        count: usize,
        progress: &Progress,
    ) -> Result<Option<f64>, Stopped> {
        if self.length() <= 0.0 {
            return Ok(None);
        }
        let found = (0..count).into_par_iter().map(|k| {
            if k.is_multiple_of(CHUNK) {
                progress.check()?;
            }
            let near = other.nearest_within(self.sample(k, count), tolerance).is_some();
            Ok(usize::from(near))
        });
        let found = found.try_reduce(|| 0, |a, b| Ok(a + b))?;
        Ok(Some(found as f64 / count as f64))
    }

    /// Sample `k` of `count` at even steps along all edges, one after another.
    fn sample(&self, k: usize, count: usize) -> DVec3 {
        let at = (k as f64 + 0.5) / count as f64 * self.length();
        let edge = self.lengths.partition_point(|&length| length < at).min(self.segments.len() - 1);
        let before = if edge > 0 { self.lengths[edge - 1] } else { 0.0 };
        let [a, b] = self.segments[edge];
        let own = self.lengths[edge] - before;
        a.lerp(b, if own > 0.0 { ((at - before) / own).clamp(0.0, 1.0) } else { 0.0 })
    }
}
