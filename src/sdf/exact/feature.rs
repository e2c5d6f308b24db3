//! Faces, edges and vertices of a mesh, each with the half-spaces that hold its Voronoi region: the
//! points that can have it as their nearest.

use glam::DVec3;
use rayon::prelude::*;

use crate::lattice::Lattice;
use crate::mesh::edges::{self as mesh, Edges};
use crate::mesh::weld::welded_triangles;
use crate::mesh::{Pseudonormals, TriMesh};

/// Half-spaces a vertex keeps, at most; leaving some out makes its region larger, which costs time only.
pub(super) const MOST_SIDES: usize = 8;
/// A triangle lower than this, in h, has no face of its own: its edges are as near.
const LOWEST: f64 = 1e-5;
/// An edge whose region is narrower than this, in h, at the end of the band lies within what counts as over its faces, see
/// [`ROUNDING`]; with more, a voxel over the gap between them would have neither.
const NARROWEST: f64 = 1e-10;

/// The open side of a triangle. Lattice coordinates, as everything here.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaceFeature {
    pub corners: [DVec3; 3],
    /// Unit normal.
    pub normal: DVec3,
    /// For the side from each corner to the next the unit vector in the plane that points inwards.
    pub inner: [DVec3; 3],
}

/// An edge between two vertices.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeFeature {
    pub start: DVec3,
    /// Unit vector to the other end.
    pub along: DVec3,
    pub length: f64,
    /// Unit pseudonormal, or zero where the normals of the faces cancel.
    pub normal: DVec3,
    /// Unit vectors into two of its faces, square to the edge; zero where there is none.
    pub sides: [DVec3; 2],
}

/// A vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VertexFeature {
    pub at: DVec3,
    /// Unit pseudonormal, or zero.
    pub normal: DVec3,
    /// Unit vectors along its edges; zero where there are fewer.
    pub sides: [DVec3; MOST_SIDES],
}

/// A point this far, in h, past the end of a face or an edge still counts as beside it.
const ROUNDING: f64 = 1e-9;

/// The square of a distance in h, and on which side of the surface the point is: negative inside.
pub(crate) type Measured = (f64, f64);

impl FaceFeature {
    /// `None` where the foot of the perpendicular from `p` is not on the face.
    pub(crate) fn measure(&self, p: DVec3) -> Option<Measured> {
        let over = (0..3).all(|k| self.inner[k].dot(p - self.corners[k]) >= -ROUNDING);
        let side = self.normal.dot(p - self.corners[0]);
        over.then_some((side * side, side))
    }
}

impl EdgeFeature {
    /// Whether the pseudonormal says nothing.
    pub(crate) fn is_blind(&self) -> bool {
        self.normal == DVec3::ZERO
    }

    /// Two unit vectors square to the edge and to each other, the first along the pseudonormal where that says anything.
    pub(crate) fn across(&self) -> [DVec3; 2] {
        let first = if self.is_blind() { self.along.any_orthonormal_vector() } else { self.normal };
        // The pseudonormal is square to the edge but for rounding.
        let first = (first - self.along * first.dot(self.along)).normalize_or_zero();
        [first, self.along.cross(first)]
    }

    pub(crate) fn measure(&self, p: DVec3) -> Option<Measured> {
        let from = p - self.start;
        let along = self.along.dot(from);
        let between = along >= -ROUNDING && along <= self.length + ROUNDING;
        between.then(|| ((from - self.along * along).length_squared(), self.normal.dot(from)))
    }
}

impl VertexFeature {
    pub(crate) fn measure(&self, p: DVec3) -> Option<Measured> {
        let from = p - self.at;
        Some((from.length_squared(), self.normal.dot(from)))
    }
}

/// All that can be nearest to a point within the band.
#[derive(Debug, Default)]
pub(crate) struct Features {
    pub faces: Vec<FaceFeature>,
    pub edges: Vec<EdgeFeature>,
    pub vertices: Vec<VertexFeature>,
}

impl Features {
    /// Of `mesh`, in the coordinates of `lattice`, as far as they matter within `reach` (h).
    pub(crate) fn of(mesh: &TriMesh, lattice: &Lattice, reach: f64) -> Self {
        let triangles = welded_triangles(mesh);
        let all_edges = Edges::new(&triangles, mesh.positions.len());
        let normals = &Pseudonormals::over(mesh, &triangles, &all_edges);
        let positions: Vec<DVec3> = mesh.positions.par_iter().map(|&p| lattice.to_lattice(p)).collect();
        let faces: Vec<Option<FaceFeature>> =
            triangles.par_iter().map(|t| face(t.map(|v| positions[v as usize]))).collect();
        let raw = all_edges.map(|edge| RawEdge::new(&edge, &faces));
        let (edges, ends): (Vec<Option<EdgeFeature>>, Vec<Option<End>>) =
            raw.par_iter().map(|raw| raw.edge(&positions, &faces, normals, reach)).unzip();
        let edges = edges.into_par_iter().flatten_iter().collect();
        let ends: Vec<End> = ends.into_par_iter().flatten_iter().collect();
        let vertices = vertices(&triangles, &positions, normals, &ends);
        Self { faces: faces.into_par_iter().flatten_iter().collect(), edges, vertices }
    }

    /// The signed distance of `p` in h from the nearest of some features, given by their numbers.
    pub(crate) fn signed(
        &self,
        p: DVec3,
        faces: impl Iterator<Item = u32>,
        edges: impl Iterator<Item = u32>,
        vertices: impl Iterator<Item = u32>,
    ) -> Option<f64> {
        let faces = faces.filter_map(|id| self.faces[id as usize].measure(p));
        let edges = edges.filter_map(|id| self.edges[id as usize].measure(p));
        let vertices = vertices.filter_map(|id| self.vertices[id as usize].measure(p));
        let (square, side) = faces.chain(edges).chain(vertices).min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(if side < 0.0 { -square.sqrt() } else { square.sqrt() })
    }
}

fn face(corners: [DVec3; 3]) -> Option<FaceFeature> {
    let [a, b, c] = corners;
    let sides = [b - a, c - b, a - c];
    let longest = sides.iter().map(|side| side.length()).fold(0.0, f64::max);
    let double = (b - a).cross(c - a);
    let normal = double.try_normalize().filter(|_| double.length() > LOWEST * longest)?;
    let mut inner = [DVec3::ZERO; 3];
    for (inner, side) in inner.iter_mut().zip(sides) {
        *inner = normal.cross(side).try_normalize()?;
    }
    Some(FaceFeature { corners, normal, inner })
}

/// An edge by numbers.
struct RawEdge {
    ends: [u32; 2],
    /// One half-edge of it, and up to two on triangles that have a face.
    half: u32,
    sides: [Option<u32>; 2],
    count: usize,
}

/// The ends of an edge, its direction from the first to the second, and whether it is flat.
type End = ([u32; 2], DVec3, bool);

impl RawEdge {
    fn new(edge: &mesh::Edge<'_>, faces: &[Option<FaceFeature>]) -> Self {
        let mut sides = edge.halves().filter(|&half| faces[half as usize / 3].is_some());
        let sides = [sides.next(), sides.next()];
        Self { ends: edge.ends, half: edge.halves().next().unwrap_or_default(), sides, count: edge.count() }
    }

    /// The feature, unless it is flat, and its ends, unless they are one.
    fn edge(
        &self,
        positions: &[DVec3],
        faces: &[Option<FaceFeature>],
        normals: &Pseudonormals,
        reach: f64,
    ) -> (Option<EdgeFeature>, Option<End>) {
        let [start, end] = self.ends.map(|v| positions[v as usize]);
        let length = start.distance(end);
        if length == 0.0 {
            return (None, None);
        }
        let inner = |half: u32| faces[half as usize / 3].map(|face| face.inner[half as usize % 3]);
        let sides = self.sides.map(|half| half.and_then(inner).unwrap_or_default());
        let flat = self.count == 2 && sides[0] != DVec3::ZERO && (sides[0] + sides[1]).length() * reach < NARROWEST;
        let along = (end - start) / length;
        let normal = normals.of_edge(self.half as usize / 3, self.half as usize % 3).normalize_or_zero();
        let edge = (!flat).then_some(EdgeFeature { start, along, length, normal, sides });
        (edge, Some((self.ends, along, flat)))
    }
}

fn vertices(triangles: &[[u32; 3]], positions: &[DVec3], normals: &Pseudonormals, ends: &[End]) -> Vec<VertexFeature> {
    let count = positions.len();
    let mut corner_of = vec![u32::MAX; count];
    for (corner, &v) in triangles.iter().flatten().enumerate() {
        corner_of[v as usize] = corner_of[v as usize].min(corner as u32);
    }
    // The edges at each vertex, by counting.
    let mut starts = vec![0u32; count + 1];
    ends.iter().flat_map(|(ends, ..)| ends).for_each(|&v| starts[v as usize + 1] += 1);
    (0..count).for_each(|v| starts[v + 1] += starts[v]);
    let mut fill = starts.clone();
    let mut around = vec![0u32; 2 * ends.len()];
    for (n, (ends, ..)) in ends.iter().enumerate() {
        for &v in ends {
            around[fill[v as usize] as usize] = n as u32;
            fill[v as usize] += 1;
        }
    }
    let vertex = |v: usize| {
        let edges = &around[starts[v] as usize..starts[v + 1] as usize];
        // Amid a flat part there is nothing that its faces do not cover.
        if corner_of[v] == u32::MAX || edges.iter().all(|&n| ends[n as usize].2) && !edges.is_empty() {
            return None;
        }
        let direction = |&n: &u32| {
            let ([low, _], along, _) = ends[n as usize];
            if low as usize == v { along } else { -along }
        };
        let corner = corner_of[v] as usize;
        let normal = normals.of_corner(corner / 3, corner % 3).normalize_or_zero();
        Some(VertexFeature { at: positions[v], normal, sides: spread(edges.iter().map(direction)) })
    };
    (0..count).into_par_iter().filter_map(vertex).collect()
}

/// All directions, or of many those that are farthest apart.
fn spread(directions: impl ExactSizeIterator<Item = DVec3> + Clone) -> [DVec3; MOST_SIDES] {
    let mut chosen = [DVec3::ZERO; MOST_SIDES];
    if directions.len() <= MOST_SIDES {
        chosen.iter_mut().zip(directions).for_each(|(chosen, direction)| *chosen = direction);
        return chosen;
    }
    let mut nearest: Vec<(f64, DVec3)> = directions.map(|direction| (-2.0, direction)).collect();
    for chosen in &mut chosen {
        let Some(&(_, next)) = nearest.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        *chosen = next;
        nearest.iter_mut().for_each(|(cosine, direction)| *cosine = cosine.max(direction.dot(next)));
    }
    chosen
}
