//! A mesh in camera space.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::camera::Camera;
use super::line::{Line, Style};
use super::options::{EdgeDrawing, Painted, RenderOptions};
use crate::arrange::{ArrangeError, crossing_curves};
use crate::io::{Colours, Rgba, linear_from_srgb};
use crate::mesh::edges::{Edge, Edges, copies};
use crate::mesh::weld::{has_repeated_index, welded_triangles};
use crate::mesh::{TriMesh, intersecting_triangles};
use crate::progress::{Progress, Stopped};

/// Cosine of the angle from which on an edge is sharp and normals are not averaged over it: 30 degrees.
const CREASE: f32 = 0.866_025_4;

/// What drawing needs of a mesh. Positions and lengths are pixels (y down, z towards the viewer); normals are unit
/// vectors with y up.
pub(super) struct Scene {
    /// The corners of each triangle.
    pub(super) corners: Vec<[Vec3; 3]>,
    /// The normal of each triangle as it is oriented, zero for degenerate ones.
    pub(super) flat: Vec<Vec3>,
    /// The normal at each corner, averaged over the triangles around that are less than a crease away.
    pub(super) smooth: Vec<[Vec3; 3]>,
    /// Whether each triangle is marked as intersecting another.
    pub(super) marked: Vec<bool>,
    /// The colours of the front side at the corners of each triangle, linear light; empty for grey.
    pub(super) paint: Vec<[Vec3; 3]>,
    /// The triangles that can hide something: those with an area, each of several copies once.
    pub(super) obstacles: Vec<u32>,
    /// The lines to draw, in the order in which they cover each other.
    pub(super) lines: Vec<Line>,
}

impl Scene {
    pub(super) fn new(
        Painted { mesh, colours }: Painted<'_>,
        camera: &Camera,
        options: &RenderOptions,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        let seen: Vec<Vec3> = mesh.positions.par_iter().map(|&p| camera.project(p)).collect();
        let corners: Vec<[Vec3; 3]> = mesh.triangles.par_iter().map(|t| t.map(|v| seen[v as usize])).collect();
        let flat: Vec<Vec3> = corners.par_iter().map(|&c| normal(c)).collect();
        let welded = welded_triangles(mesh);
        let smooth = smooth_normals(&welded, mesh.positions.len(), &corners, &flat);
        let mut marked = vec![false; corners.len()];
        if options.defects {
            intersecting_triangles(mesh, progress)?.iter().for_each(|&t| marked[t as usize] = true);
        }
        progress.check()?;
        let copies: Vec<u32> = copies(&welded, mesh.positions.len()).iter().map(|&[copy, _]| copy).collect();
        let counts = |&t: &u32| flat[t as usize] != Vec3::ZERO && copies.binary_search(&t).is_err();
        let obstacles = (0..corners.len() as u32).filter(counts).collect();
        let mut lines = lines(&welded, &seen, &flat, options);
        if marked.contains(&true) {
            lines.extend(crossings(mesh, camera, progress)?);
            lines.sort_by_key(|line| line.style.rank());
        }
        let linear = |colour: Rgba| Vec3::from_array([0, 1, 2].map(|k| linear_from_srgb(colour[k]) as f32));
        let paint = |colours: &Colours| {
            (0..mesh.triangles.len()).into_par_iter().map(|t| colours.corners(mesh, t).map(linear)).collect()
        };
        let paint = colours.map_or_else(Vec::new, paint);
        Ok(Self { corners, flat, smooth, marked, paint, obstacles, lines })
    }
}

/// The unit normal, with y up again.
fn normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    // In pixels y points down, which mirrors the triangle.
    let n = (c - a).as_dvec3().cross((b - a).as_dvec3());
    let n = n.normalize_or_zero().as_vec3();
    Vec3::new(n.x, -n.y, n.z)
}

fn smooth_normals(triangles: &[[u32; 3]], vertices: usize, corners: &[[Vec3; 3]], flat: &[Vec3]) -> Vec<[Vec3; 3]> {
    let mut start = vec![0u32; vertices + 1];
    triangles.iter().flatten().for_each(|&v| start[v as usize + 1] += 1);
    for v in 0..vertices {
        start[v + 1] += start[v];
    }
    let mut next = start.clone();
    let mut around = vec![0u32; 3 * triangles.len()];
    for (t, triangle) in (0u32..).zip(triangles) {
        for (k, &v) in (0u32..).zip(triangle) {
            around[next[v as usize] as usize] = 3 * t + k;
            next[v as usize] += 1;
        }
    }
    let at_corner = |t: usize, v: u32| {
        // A fan of thousands of triangles averages well with fewer of them, in bounded time.
        let fan = &around[start[v as usize] as usize..start[v as usize + 1] as usize];
        let step = fan.len().div_ceil(64).max(1);
        let near = fan.iter().step_by(step).map(|&c| (c as usize / 3, c as usize % 3));
        let sum: Vec3 =
            near.filter(|&(n, _)| flat[n].dot(flat[t]) > CREASE).map(|(n, k)| flat[n] * angle(&corners[n], k)).sum();
        sum.try_normalize().unwrap_or(flat[t])
    };
    triangles.par_iter().enumerate().map(|(t, &vertices)| vertices.map(|v| at_corner(t, v))).collect()
}

/// The angle at corner `k`.
fn angle(corners: &[Vec3; 3], k: usize) -> f32 {
    let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
    let cosine = u.normalize_or_zero().dot(v.normalize_or_zero());
    cosine.clamp(-1.0, 1.0).acos()
}

/// The lines to draw, in the order in which they cover each other.
fn lines(triangles: &[[u32; 3]], seen: &[Vec3], flat: &[Vec3], options: &RenderOptions) -> Vec<Line> {
    let mut lines = Vec::new();
    if options.edges == EdgeDrawing::None && !options.defects {
        return lines;
    }
    let edges = Edges::new(triangles, seen.len());
    edges.each(|edge| {
        let ends = edge.ends.map(|v| seen[v as usize]);
        let style = match edge.count() {
            1 if options.defects => Some(Style::Open),
            3.. if options.defects => Some(Style::Crowded),
            _ if options.edges == EdgeDrawing::None => None,
            _ => {
                let plain = if options.edges == EdgeDrawing::All { strength(&edge, triangles, seen) } else { 0.0 };
                match sharpness(&edges, &edge, flat) {
                    sharp if sharp > 0.0 => Some(Style::Sharp { strength: sharp }),
                    _ => Some(Style::Plain { strength: plain }),
                }
            }
        };
        lines.extend(style.map(|style| Line { ends, style }));
    });
    lines.retain(|line| !matches!(line.style, Style::Plain { strength } if strength <= 0.0));
    lines.sort_by_key(|line| line.style.rank());
    lines
}

/// The lines along which triangles cross; none where they cross in more places than can be cut.
fn crossings(mesh: &TriMesh, camera: &Camera, progress: &Progress) -> Result<Vec<Line>, Stopped> {
    match crossing_curves(mesh, progress) {
        Ok(curves) => {
            let line = |ends: [DVec3; 2]| Line { ends: ends.map(|p| camera.project(p)), style: Style::Crossing };
            Ok(curves.into_iter().map(line).collect())
        }
        Err(ArrangeError::Stopped(stopped)) => Err(stopped),
        Err(_) => Ok(Vec::new()),
    }
}

/// How much of a sharp edge is drawn: nothing at 30 degrees, all of it from 60 degrees on, and of edges without exactly two
/// triangles.
fn sharpness(edges: &Edges<'_>, edge: &Edge<'_>, flat: &[Vec3]) -> f32 {
    let halves: Vec<u32> = edge.halves().take(3).collect();
    let &[a, b] = halves.as_slice() else { return 1.0 };
    let cosine = flat[a as usize / 3].dot(flat[b as usize / 3]);
    // Triangles that run along the edge the same way face opposite ways.
    let cosine = if edges.runs_up(a) == edges.runs_up(b) { -cosine } else { cosine };
    ((CREASE - cosine) / (CREASE - 0.5)).clamp(0.0, 1.0)
}

/// How much of a plain edge is drawn, by the size of its triangles: where they are a few pixels wide, lines would only
/// make the mesh black.
fn strength(edge: &Edge<'_>, triangles: &[[u32; 3]], seen: &[Vec3]) -> f32 {
    let width = |half: u32| {
        let t = triangles[half as usize / 3];
        if has_repeated_index(t) {
            return 0.0;
        }
        let [a, b, c] = t.map(|v| seen[v as usize]);
        (b - a).cross(c - a).length().sqrt()
    };
    let width = edge.halves().map(width).fold(0.0, f32::max);
    ((width - 4.0) / 12.0).clamp(0.0, 1.0)
}
