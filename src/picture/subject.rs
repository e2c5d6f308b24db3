//! What is known of a mesh before it is seen from anywhere: normals, edges, defects.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::line::{DrawnEdge, Style};
use super::options::Painted;
use super::specks::without_specks;
use crate::arrange::{ArrangeError, crossing_curves};
use crate::mesh::edges::{Edges, copies};
use crate::mesh::weld::welded_triangles;
use crate::mesh::{Bounds, MassProperties, TriMesh, intersecting_triangles};
use crate::progress::{Progress, Stopped};

/// Cosine of the angle from which on an edge is sharp and normals are not averaged over it: 30 degrees.
const CREASE: f32 = 0.866_025_4;

/// A mesh made ready to be drawn from any side.
pub struct Subject<'a> {
    pub(super) painted: Painted<'a>,
    /// Its triangles over vertices of which equal ones are one.
    pub(super) welded: Vec<[u32; 3]>,
    /// The normal of each triangle as it is oriented, zero for degenerate ones.
    pub(super) flat: Vec<Vec3>,
    /// The normal at each corner, averaged over the triangles around that are less than a crease away.
    pub(super) smooth: Vec<[Vec3; 3]>,
    /// Whether each triangle is marked as intersecting another.
    pub(super) marked: Vec<bool>,
    /// The triangles that are not copies of another.
    pub(super) single: Vec<u32>,
    /// Edges with what they stand for; plain ones with how many triangles they have at least half of.
    pub(super) edges: Vec<DrawnEdge>,
    /// Lines along which triangles cross, model units.
    pub(super) crossings: Vec<[DVec3; 2]>,
    /// More lines, model units, with their colours.
    pub(super) lines: Vec<([DVec3; 2], [u8; 3])>,
    /// What was found.
    found: DefectCounts,
}

/// What is wrong with a mesh that is drawn, vertices of equal coordinates taken for one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DefectCounts {
    /// Edges with one triangle.
    pub open_edges: usize,
    /// Edges with more than two triangles.
    pub crowded_edges: usize,
    /// Triangles that intersect others.
    pub crossing_triangles: usize,
    /// Whether the inner side of a surface may be seen: it has open or crowded edges, neighbours that face opposite ways, or is inside out.
    pub shows_inside: bool,
}

impl<'a> Subject<'a> {
    /// Looks at a mesh. Triangles that cross are looked for where `defects` are to be drawn.
    ///
    /// # Errors
    /// A stop.
    pub fn new(painted: impl Into<Painted<'a>>, defects: bool, progress: &Progress) -> Result<Self, Stopped> {
        let painted = painted.into();
        let mesh = painted.mesh;
        let vertices = mesh.positions.len();
        let welded = welded_triangles(mesh);
        let scaled = scaled(mesh);
        let flat: Vec<Vec3> = mesh.triangles.par_iter().map(|&t| normal(t.map(|v| scaled[v as usize]))).collect();
        let smooth = smooth_normals(&welded, vertices, &mesh.triangles, &scaled, &flat);
        progress.check()?;
        let mut found = DefectCounts::default();
        let mut marked = vec![false; welded.len()];
        if defects {
            let crossing = intersecting_triangles(mesh, progress)?;
            found.crossing_triangles = crossing.len();
            crossing.iter().for_each(|&t| marked[t as usize] = true);
        }
        let crossings = if found.crossing_triangles > 0 { crossings(mesh, progress)? } else { Vec::new() };
        progress.check()?;
        let copies: Vec<u32> = copies(&welded, vertices).iter().map(|&[copy, _]| copy).collect();
        let single = (0..welded.len() as u32).filter(|t| copies.binary_search(t).is_err()).collect();
        let edges = styled_edges(&welded, vertices, &flat, &mut found);
        let edges = without_specks(edges, &scaled);
        found.shows_inside |= MassProperties::of(mesh).is_some_and(|mass| mass.volume < 0.0);
        Ok(Self { painted, welded, flat, smooth, marked, single, edges, crossings, lines: Vec::new(), found })
    }

    /// The same with more lines: their ends, model units, and their colours.
    #[must_use]
    pub fn with_lines(mut self, lines: impl IntoIterator<Item = ([DVec3; 2], [u8; 3])>) -> Self {
        self.lines.extend(lines);
        self
    }

    /// What is wrong with the mesh.
    pub fn defects(&self) -> DefectCounts {
        self.found
    }

    /// Whether its outer sides have colours of their own.
    pub fn has_colours(&self) -> bool {
        self.painted.colours.is_some()
    }

    /// Whether a surface bounds an inside that a cut can show.
    pub(super) fn is_closed(&self) -> bool {
        !self.found.shows_inside
    }
}

/// The vertices at about unit size, so that no size overflows.
fn scaled(mesh: &TriMesh) -> Vec<DVec3> {
    let Some(Bounds { min, max }) = mesh.bounds() else { return Vec::new() };
    let half = (max / 2.0 - min / 2.0).max_element();
    let shrink = if half > 0.0 { (1.0 / half).min(f64::MAX) } else { 1.0 };
    let centre = min / 2.0 + max / 2.0;
    mesh.positions.par_iter().map(|&p| (p - centre) * shrink).collect()
}

fn normal([a, b, c]: [DVec3; 3]) -> Vec3 {
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// The angle at corner `k`.
fn angle(corners: [DVec3; 3], k: usize) -> f32 {
    let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
    u.normalize_or_zero().dot(v.normalize_or_zero()).clamp(-1.0, 1.0).acos() as f32
}

fn smooth_normals(
    welded: &[[u32; 3]],
    vertices: usize,
    triangles: &[[u32; 3]],
    positions: &[DVec3],
    flat: &[Vec3],
) -> Vec<[Vec3; 3]> {
    let mut start = vec![0u32; vertices + 1];
    welded.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
    for v in 0..vertices {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut around = vec![0u32; 3 * welded.len()];
    for (t, triangle) in (0u32..).zip(welded) {
        for (k, &v) in (0u32..).zip(triangle) {
            around[next[v as usize] as usize] = 3 * t + k;
            next[v as usize] += 1;
        }
    }
    let corners = |t: usize| triangles[t].map(|v| positions[v as usize]);
    let at_corner = |t: usize, v: u32| {
        // A fan of thousands of triangles averages well with fewer of them, in bounded time.
        let fan = &around[start[v as usize] as usize..start[v as usize + 1] as usize];
        let step = fan.len().div_ceil(64).max(1);
        let near = fan.iter().step_by(step).map(|&c| (c as usize / 3, c as usize % 3));
        let sum: Vec3 =
            near.filter(|&(n, _)| flat[n].dot(flat[t]) > CREASE).map(|(n, k)| flat[n] * angle(corners(n), k)).sum();
        sum.try_normalize().unwrap_or(flat[t])
    };
    welded.par_iter().enumerate().map(|(t, &vertices)| vertices.map(|v| at_corner(t, v))).collect()
}

/// The edges that may be drawn; what is wrong with them is counted.
fn styled_edges(triangles: &[[u32; 3]], vertices: usize, flat: &[Vec3], found: &mut DefectCounts) -> Vec<DrawnEdge> {
    let mut drawn = Vec::new();
    let edges = Edges::new(triangles, vertices);
    edges.each(|edge| {
        let halves: Vec<u32> = edge.halves().take(3).collect();
        let sides = [halves[0], *halves.last().unwrap_or(&halves[0])].map(|half| half / 3);
        let style = match halves.as_slice() {
            [_] => {
                found.open_edges += 1;
                Style::Open
            }
            &[a, b] => {
                let agree = edges.runs_up(a) != edges.runs_up(b);
                found.shows_inside |= !agree;
                match sharpness(sides.map(|t| flat[t as usize]), agree) {
                    sharp if sharp > 0.0 => Style::Sharp { strength: sharp },
                    _ => Style::Plain { strength: 1.0 },
                }
            }
            _ => {
                found.crowded_edges += 1;
                Style::Crowded
            }
        };
        drawn.push(DrawnEdge { ends: edge.ends, style, triangles: sides });
    });
    found.shows_inside |= found.open_edges + found.crowded_edges > 0;
    drawn
}

/// How much of a sharp edge between triangles of these normals is drawn: nothing at 30 degrees, all of it from 60 degrees on. Those that do not `agree`, because they run
/// along the edge the same way, face opposite ways.
fn sharpness([a, b]: [Vec3; 2], agree: bool) -> f32 {
    let cosine = if agree { a.dot(b) } else { -a.dot(b) };
    ((CREASE - cosine) / (CREASE - 0.5)).clamp(0.0, 1.0)
}

/// The lines along which triangles cross; none where they cross in more places than can be cut.
fn crossings(mesh: &TriMesh, progress: &Progress) -> Result<Vec<[DVec3; 2]>, Stopped> {
    match crossing_curves(mesh, progress) {
        Ok(curves) => Ok(curves),
        Err(ArrangeError::Stopped(stopped)) => Err(stopped),
        Err(_) => Ok(Vec::new()),
    }
}
