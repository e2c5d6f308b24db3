//! The boundary of a soup as a chain: the directed edges of all its triangles, of which those that
//! run both ways cancel. What is left are the rims of holes, each as closed loops.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::mesh::TriMesh;
use crate::mesh::edges::Buckets;
use crate::progress::{Progress, Stopped};

/// Closed polygons, model units. A soup's loops run as its triangles do: the surface is on their left.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Loops {
    points: Vec<DVec3>,
    /// One past the last point of each loop.
    ends: Vec<u32>,
}

impl Loops {
    /// The boundary of the triangles `range` of `mesh`. Vertices are the same where their
    /// coordinates are.
    pub(super) fn around(mesh: &TriMesh, range: std::ops::Range<usize>, progress: &Progress) -> Result<Self, Stopped> {
        progress.check()?;
        let mut edges = uncancelled(&mesh.triangles[range]);
        progress.check()?;
        // Nearly all edges are gone by now, so that merging vertices costs little.
        let mut points = Vec::new();
        let mut ids = FxHashMap::default();
        for v in edges.iter_mut().flatten() {
            let p = mesh.positions[*v as usize] + 0.0;
            *v = *ids.entry(p.to_array().map(f64::to_bits)).or_insert_with(|| {
                points.push(p);
                points.len() as u32 - 1
            });
        }
        let edges = cancel(edges);
        progress.check()?;
        Ok(Self::of(&edges, &points))
    }

    /// Cuts a closed chain of edges into loops that visit no point twice.
    fn of(edges: &[[u32; 2]], points: &[DVec3]) -> Self {
        let mut loops = Self::default();
        let from = Buckets::on_one_thread(points.len(), edges.len(), |n| Some((edges[n][0], u64::from(edges[n][1]))));
        let mut used = vec![0; points.len()];
        let mut place = vec![None; points.len()];
        let mut path: Vec<u32> = Vec::new();
        for start in 0..points.len() as u32 {
            let mut at = start;
            while let Some(&next) = from.get(at as usize).get(used[at as usize]) {
                used[at as usize] += 1;
                place[at as usize] = Some(path.len());
                path.push(at);
                at = next as u32;
                if let Some(first) = place[at as usize] {
                    path[first..].iter().for_each(|&v| place[v as usize] = None);
                    path.drain(first..).for_each(|v| loops.push(points[v as usize]));
                    loops.close();
                }
            }
        }
        loops
    }

    /// Adds a point to the last loop.
    pub(super) fn push(&mut self, point: DVec3) {
        self.points.push(point);
    }

    /// Ends the last loop.
    pub(super) fn close(&mut self) {
        self.ends.push(self.points.len() as u32);
    }

    /// Number of edges, which is that of the points.
    pub(super) fn edges(&self) -> usize {
        self.points.len()
    }

    /// The points of each loop.
    pub(super) fn each(&self) -> impl Iterator<Item = &[DVec3]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.points[start as usize..end as usize])
    }
}

/// The directed edges of `triangles` by index, less those that run both ways equally often.
fn uncancelled(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let vertices = || triangles.iter().flatten().copied();
    let (Some(low), Some(high)) = (vertices().min(), vertices().max()) else { return Vec::new() };
    // The smaller vertex is the key; the larger one and the edge's way are the payload.
    let item = |n: usize| {
        let (a, b) = (triangles[n / 3][n % 3], triangles[n / 3][(n + 1) % 3]);
        (a != b).then(|| if a < b { (a - low, u64::from(b) << 1) } else { (b - low, u64::from(a) << 1 | 1) })
    };
    let buckets = Buckets::on_one_thread((high - low) as usize + 1, 3 * triangles.len(), item);
    let mut left = Vec::new();
    for key in 0..buckets.keys() {
        for same in buckets.get(key).chunk_by(|a, b| a >> 1 == b >> 1) {
            let (a, b) = (key as u32 + low, (same[0] >> 1) as u32);
            let down = same.iter().filter(|&&way| way & 1 == 1).count();
            let up = same.len() - down;
            let edge = if up > down { [a, b] } else { [b, a] };
            left.extend(std::iter::repeat_n(edge, up.abs_diff(down)));
        }
    }
    left
}

/// The same for a few edges.
fn cancel(mut edges: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    let undirected = |&[a, b]: &[u32; 2]| [a.min(b), a.max(b)];
    edges.retain(|[a, b]| a != b);
    edges.sort_unstable_by_key(|edge| (undirected(edge), *edge));
    let mut left = Vec::new();
    for same in edges.chunk_by(|a, b| undirected(a) == undirected(b)) {
        // Sorted, so that the edges of one way come first and those of the other last.
        let first = same.iter().filter(|&edge| *edge == same[0]).count();
        let last = same.len() - first;
        let edge = if first > last { same[0] } else { same[same.len() - 1] };
        left.extend(std::iter::repeat_n(edge, first.abs_diff(last)));
    }
    left
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::{cuboid, taken_apart};

    /// The unit cube without some sides; with `apart`, no two triangles share a vertex.
    fn cube(missing: &[usize], apart: bool) -> TriMesh {
        let mut mesh = cuboid(DVec3::ZERO, DVec3::ONE);
        let sides = mesh.triangles.chunks(2).enumerate().filter(|(side, _)| !missing.contains(side));
        mesh.triangles = sides.flat_map(|(_, pair)| pair.to_vec()).collect();
        if apart { taken_apart(&mesh) } else { mesh }
    }

    fn loops(mesh: &TriMesh) -> Loops {
        Loops::around(mesh, 0..mesh.triangles.len(), &Progress::none()).expect("not stopped")
    }

    #[test]
    fn a_closed_soup_has_no_boundary_whether_its_triangles_share_vertices_or_not() {
        for apart in [false, true] {
            assert_eq!(loops(&cube(&[], apart)), Loops::default());
        }
    }

    #[test]
    fn each_missing_side_leaves_a_loop_that_runs_against_it() {
        for apart in [false, true] {
            let found = loops(&cube(&[0, 1], apart));
            assert_eq!((found.edges(), found.each().count()), (8, 2));
            for points in found.each() {
                let area: DVec3 = (0..4).map(|k| points[k].cross(points[(k + 1) % 4]) / 2.0).sum();
                // The rim of a hole seen from outside runs clockwise.
                assert_eq!(area, if points[0].z == 0.0 { DVec3::Z } else { DVec3::NEG_Z });
            }
        }
    }

    #[test]
    fn loops_visit_no_point_twice_and_keep_multiple_edges() {
        // Two triangles that touch in a vertex, the first of them three times.
        let corners = cuboid(DVec3::ZERO, DVec3::ONE).positions;
        let positions = (0..5).map(|n| corners[n] + DVec3::splat(n as f64)).collect();
        let first = [0, 1, 2];
        let mesh = TriMesh { positions, triangles: vec![first, [2, 3, 4], first, first] };
        let found = loops(&mesh);
        assert_eq!((found.edges(), found.each().count()), (12, 4));
        assert!(found.each().all(|points| points.len() == 3));
        // A triangle and its reverse cancel.
        let both = TriMesh { triangles: vec![first, [1, 0, 2]], ..mesh };
        assert_eq!(loops(&both).edges(), 0);
    }

    #[test]
    fn only_the_triangles_of_the_range_count() {
        let mut mesh = cube(&[], false);
        mesh.append(&cube(&[3], true));
        let found = Loops::around(&mesh, 12..22, &Progress::none()).expect("not stopped");
        assert_eq!(found.edges(), 4);
        assert_eq!(Loops::around(&mesh, 5..5, &Progress::none()), Ok(Loops::default()));
    }
}
