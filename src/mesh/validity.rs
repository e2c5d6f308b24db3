//! What is wrong with a mesh, counted.

use std::cmp::Ordering;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::TriMesh;
use super::edges::{Edges, copies};
use super::predicates::{Face, scale_of_mesh};
use super::self_intersection::intersecting_triangles;
use super::weld::{first_of_equal, has_repeated_index};
use crate::progress::{Progress, Stopped};

/// What [`validate`] and [`defects`](super::defects) look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ValidateOptions {
    /// Whether intersecting triangles are searched: by far the longest part.
    pub self_intersections: bool,
    /// Whether vertices of exactly equal coordinates (−0 equals 0) count as one. For soups without indices, such as
    /// STL files, where all edges would be open otherwise. Intersections are always judged that way.
    pub weld: bool,
}

impl Default for ValidateOptions {
    /// Everything, with the vertices as indexed.
    fn default() -> Self {
        Self { self_intersections: true, weld: false }
    }
}

/// Counts and measures of a mesh. Triangles with a repeated index count as degenerate and take no part in anything
/// else; triangles without an area count as degenerate too, but do take part in the topology.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Validity {
    /// Vertices, used or not.
    pub vertices: usize,
    /// Vertices that no triangle uses.
    pub unused_vertices: usize,
    /// All triangles, also degenerate ones.
    pub triangles: usize,
    /// Edges with one triangle.
    pub open_edges: usize,
    /// Edges with more than two triangles.
    pub nonmanifold_edges: usize,
    /// Vertices whose triangles form more than one fan.
    pub nonmanifold_vertices: usize,
    /// Edges with an even number of triangles of which not exactly half run each way.
    pub inconsistent_edges: usize,
    /// Triangles with a repeated index, or whose corners are exactly collinear.
    pub degenerate_triangles: usize,
    /// Triangles that repeat an earlier one: the same vertices in any order.
    pub duplicate_triangles: usize,
    /// Triangles that intersect another one, see [`triangles_intersect`](super::triangles_intersect); `None`: not checked.
    pub self_intersecting_triangles: Option<usize>,
    /// Edge-connected shells. An inner void is a shell of its own.
    pub bodies: usize,
    /// Handles of all shells together; `None` unless the mesh is a closed, oriented manifold.
    pub genus: Option<i64>,
    /// Signed volume, cubic model units: positive when the triangles face outwards. Means little for open meshes.
    pub volume: f64,
    /// Surface area, square model units.
    pub area: f64,
    /// The smallest and the largest coordinates of the used vertices, model units; `None` without triangles.
    pub bounds: Option<[[f64; 3]; 2]>,
}

impl Validity {
    /// Whether there are triangles and every edge has at least two.
    pub fn is_closed(&self) -> bool {
        self.bodies > 0 && self.open_edges == 0
    }

    /// Whether the mesh is closed, a 2-manifold at edges and vertices, and consistently oriented.
    pub fn is_oriented_manifold(&self) -> bool {
        self.is_closed()
            && self.nonmanifold_edges == 0
            && self.nonmanifold_vertices == 0
            && self.inconsistent_edges == 0
    }

    /// Whether the mesh bounds a solid: an oriented manifold of positive volume without degenerate, duplicate or
    /// intersecting triangles. False when intersections were not checked.
    pub fn is_valid(&self) -> bool {
        self.is_oriented_manifold()
            && self.degenerate_triangles == 0
            && self.duplicate_triangles == 0
            && self.self_intersecting_triangles == Some(0)
            && self.volume > 0.0
    }

    /// Everything that keeps the mesh from being valid, one sentence each, the gravest first. Empty exactly for valid meshes.
    pub fn problems(&self) -> Vec<String> {
        if self.bodies == 0 {
            return vec!["There are no triangles that span an area.".to_string()];
        }
        let counted = [
            (self.open_edges, "edge is open (has one triangle)", "edges are open (have one triangle)"),
            (self.nonmanifold_edges, "edge has more than two triangles", "edges have more than two triangles"),
            (
                self.inconsistent_edges,
                "edge joins triangles that face opposite ways",
                "edges join triangles that face opposite ways",
            ),
            (
                self.nonmanifold_vertices,
                "vertex joins surfaces that touch only there",
                "vertices join surfaces that touch only there",
            ),
            (
                self.self_intersecting_triangles.unwrap_or(0),
                "triangle intersects another",
                "triangles intersect others",
            ),
            (self.duplicate_triangles, "triangle repeats another", "triangles repeat others"),
            (self.degenerate_triangles, "triangle has no area", "triangles have no area"),
        ];
        let sentence = |&(count, one, many): &(usize, &str, &str)| match count {
            0 => None,
            1 => Some(format!("1 {one}.")),
            n => Some(format!("{n} {many}.")),
        };
        let mut problems: Vec<String> = counted.iter().filter_map(sentence).collect();
        if self.self_intersecting_triangles.is_none() {
            problems.push("Self-intersections were not checked.".to_string());
        }
        if self.is_oriented_manifold() {
            match self.volume.partial_cmp(&0.0) {
                Some(Ordering::Greater) => {}
                Some(Ordering::Less) => problems.push("The surface is inside out: its volume is negative.".to_string()),
                _ => problems.push("The surface encloses no volume.".to_string()),
            }
        }
        problems
    }
}

/// Counts what is wrong with `mesh` and measures it.
pub fn validate(mesh: &TriMesh, options: &ValidateOptions, progress: &Progress) -> Result<Validity, Stopped> {
    progress.check()?;
    let intersecting = || match options.self_intersections {
        true => intersecting_triangles(mesh, progress).map(|list| Some(list.len())),
        false => Ok(None),
    };
    let (mut validity, intersecting) = rayon::join(|| without_intersections(mesh, options.weld), intersecting);
    validity.self_intersecting_triangles = intersecting?;
    Ok(validity)
}

fn without_intersections(mesh: &TriMesh, weld: bool) -> Validity {
    let topology = Indexed::new(mesh, weld);
    let edges = Edges::new(&topology.triangles, mesh.positions.len());
    let (mut open, mut nonmanifold, mut inconsistent, mut all) = (0, 0, 0, 0i64);
    edges.each(|edge| {
        all += 1;
        open += usize::from(edge.count() == 1);
        nonmanifold += usize::from(edge.count() > 2);
        inconsistent += usize::from(is_inconsistent(&edges, &edge));
    });
    let connectivity = edges.connectivity();
    let used = connectivity.fans.iter().filter(|&&fans| fans > 0).count();
    let repeated = topology.triangles.iter().filter(|t| has_repeated_index(**t)).count();
    let euler = used as i64 - all + (mesh.triangles.len() - repeated) as i64;
    let (volume, area) = measures(mesh);
    let mut validity = Validity {
        vertices: topology.vertices,
        unused_vertices: topology.vertices - used,
        triangles: mesh.triangles.len(),
        open_edges: open,
        nonmanifold_edges: nonmanifold,
        nonmanifold_vertices: connectivity.fans.iter().filter(|&&fans| fans > 1).count(),
        inconsistent_edges: inconsistent,
        degenerate_triangles: degenerate(mesh, &topology.triangles).count(),
        duplicate_triangles: copies(&topology.triangles, mesh.positions.len()).len(),
        self_intersecting_triangles: None,
        bodies: connectivity.shells,
        genus: None,
        volume,
        area,
        bounds: mesh.bounds().map(|b| [b.min.to_array(), b.max.to_array()]),
    };
    if validity.is_oriented_manifold() {
        validity.genus = Some(connectivity.shells as i64 - euler / 2);
    }
    validity
}

/// Whether an edge has an even number of triangles that do not run half one way and half the other.
pub(super) fn is_inconsistent(edges: &Edges<'_>, edge: &super::edges::Edge<'_>) -> bool {
    let up = edge.halves().filter(|&half| edges.runs_up(half)).count();
    edge.count().is_multiple_of(2) && 2 * up != edge.count()
}

/// The triangles as the topology sees them.
pub(super) struct Indexed {
    /// Indices into the mesh's positions.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Vertices, without those that others stand for.
    pub(super) vertices: usize,
}

impl Indexed {
    pub(super) fn new(mesh: &TriMesh, weld: bool) -> Self {
        if !weld {
            return Self { triangles: mesh.triangles.clone(), vertices: mesh.positions.len() };
        }
        let first = first_of_equal(&mesh.positions);
        let vertices = (0u32..).zip(&first).filter(|&(v, &first)| v == first).count();
        Self { triangles: mesh.triangles.iter().map(|t| t.map(|v| first[v as usize])).collect(), vertices }
    }
}

/// Ids of the triangles with a repeated index or with exactly collinear corners, ascending.
pub(super) fn degenerate(mesh: &TriMesh, triangles: &[[u32; 3]]) -> impl Iterator<Item = u32> {
    let scale = scale_of_mesh(mesh);
    let flat = move |id: usize| Face::new(mesh.corners(id).map(|p| p * scale)).is_none();
    (0..triangles.len()).filter(move |&id| has_repeated_index(triangles[id]) || flat(id)).map(|id| id as u32)
}

/// Ids of the triangles whose corners are exactly collinear or at one place, ascending.
pub(crate) fn flat_triangles(mesh: &TriMesh) -> Vec<u32> {
    degenerate(mesh, &mesh.triangles).collect()
}

/// Signed volume and area, summed in the order of the triangles.
fn measures(mesh: &TriMesh) -> (f64, f64) {
    // Seen from the mean corner, far-away meshes lose no digits and open ones have a volume that does not depend on
    // where they are.
    let corners = 3.0 * mesh.triangles.len().max(1) as f64;
    let centre =
        mesh.triangles.iter().flatten().fold(DVec3::ZERO, |sum, &v| sum + mesh.positions[v as usize] / corners);
    let (volume, area) = (0..mesh.triangles.len()).fold((0.0, 0.0), |(volume, area), id| {
        let [a, b, c] = mesh.corners(id).map(|p| p - centre);
        (volume + a.dot(b.cross(c)), area + (b - a).cross(c - a).length())
    });
    (volume / 6.0, area / 2.0)
}
