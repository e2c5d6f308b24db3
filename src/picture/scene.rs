//! A mesh as it is seen.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::camera::{Camera, Cut};
use super::line::{DrawnEdge, Line, Style};
use super::options::{EdgeDrawing, RenderOptions};
use super::rgb::Rgb;
use super::subject::Subject;
use crate::io::{Colours, Rgba, linear_from_srgb};
use crate::progress::{Progress, Stopped};

/// What drawing needs of a mesh. Positions and lengths are pixels (y down, z towards the viewer); normals are unit
/// vectors with y up.
pub(super) struct Scene {
    pub(super) camera: Camera,
    /// The corners of each triangle.
    pub(super) corners: Vec<[Vec3; 3]>,
    /// The normal of each triangle as it is oriented, zero for degenerate ones.
    pub(super) flat: Vec<Vec3>,
    /// How steep each triangle is on the image: pixels towards the viewer for each across.
    pub(super) slope: Vec<f32>,
    /// Whether each triangle shows its front.
    pub(super) facing: Vec<bool>,
    /// The normal at each corner, averaged over the triangles around that are less than a crease away.
    pub(super) smooth: Vec<[Vec3; 3]>,
    /// Whether each triangle is marked as intersecting another.
    pub(super) marked: Vec<bool>,
    /// The colours of the front side at the corners of each triangle, linear light; empty for grey.
    pub(super) paint: Vec<[Vec3; 3]>,
    /// Whether these colours mean something, so that shade must not change them much.
    pub(super) paint_is_a_map: bool,
    /// The triangles that can hide something: those with an area, each of several copies once.
    pub(super) obstacles: Vec<u32>,
    /// The lines to draw, in the order in which they cover each other.
    pub(super) lines: Vec<Line>,
    /// What is cut away.
    pub(super) cut: Option<Cut>,
    /// Whether the inside of the mesh is hatched where it is cut.
    pub(super) hatched: bool,
    /// Whether inner sides look like outer ones: in clear bodies that have both.
    pub(super) two_sided: bool,
}

impl Scene {
    pub(super) fn new(
        subject: &Subject<'_>,
        camera: &Camera,
        options: &RenderOptions,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        let mesh = subject.painted.mesh;
        let seen: Vec<Vec3> = mesh.positions.par_iter().map(|&p| camera.project(p)).collect();
        let corners: Vec<[Vec3; 3]> = mesh.triangles.par_iter().map(|t| t.map(|v| seen[v as usize])).collect();
        let turn = camera.turn();
        let flat: Vec<Vec3> = subject.flat.par_iter().map(|&n| turn * n).collect();
        let smooth = subject.smooth.par_iter().map(|n| n.map(|n| turn * n)).collect();
        let across: Vec<Vec3> = corners.par_iter().map(upright).collect();
        let slope = across.par_iter().map(|n| Vec2::new(n.x, n.y).length() / n.z.abs().max(0.12)).collect();
        let facing = across.par_iter().map(|n| n.z >= 0.0).collect();
        progress.check()?;
        let counts = |&t: &u32| across[t as usize] != Vec3::ZERO && subject.flat[t as usize] != Vec3::ZERO;
        let obstacles = subject.single.iter().copied().filter(counts).collect();
        let cut = options.clip.map(|clip| camera.cut(clip.axis.number(), clip.at));
        let mut lines = lines(subject, &seen, camera, options);
        if let Some(cut) = &cut {
            lines = lines.into_iter().filter_map(|line| Some(Line { ends: cut.clipped(line.ends)?, ..line })).collect();
        }
        let linear = |colour: Rgba| Vec3::from_array([0, 1, 2].map(|k| linear_from_srgb(colour[k]) as f32));
        let paint = |colours: &Colours| {
            (0..mesh.triangles.len()).into_par_iter().map(|t| colours.corners(mesh, t).map(linear)).collect()
        };
        Ok(Self {
            camera: *camera,
            corners,
            flat,
            slope,
            facing,
            smooth,
            marked: subject.marked.clone(),
            paint: subject.painted.colours.map_or_else(Vec::new, paint),
            paint_is_a_map: subject.painted.is_map,
            obstacles,
            lines,
            cut,
            hatched: subject.is_closed(),
            two_sided: options.opacity < 1.0 && subject.is_closed(),
        })
    }
}

/// The unit normal on the image, with y up again.
fn upright([a, b, c]: &[Vec3; 3]) -> Vec3 {
    // In pixels y points down, which mirrors the triangle.
    let n = (c - a).as_dvec3().cross((b - a).as_dvec3());
    let n = n.normalize_or_zero().as_vec3();
    Vec3::new(n.x, -n.y, n.z)
}

/// The lines to draw, in the order in which they cover each other.
fn lines(subject: &Subject<'_>, seen: &[Vec3], camera: &Camera, options: &RenderOptions) -> Vec<Line> {
    let with_edges = options.edges != EdgeDrawing::None;
    let plain = options.edges == EdgeDrawing::All;
    let style = |edge: &DrawnEdge| match edge.style {
        Style::Open | Style::Crowded if options.defects => Some(edge.style),
        Style::Open | Style::Crowded => with_edges.then_some(Style::Sharp { strength: 1.0 }),
        Style::Plain { .. } => {
            let strength = if plain { strength(edge, &subject.welded, seen) } else { 0.0 };
            (strength > 0.0).then_some(Style::Plain { strength })
        }
        style => with_edges.then_some(style),
    };
    let edge = |edge: &DrawnEdge| Some(Line { ends: edge.ends.map(|v| seen[v as usize]), style: style(edge)? });
    let mut lines: Vec<Line> = subject.edges.par_iter().filter_map(edge).collect();
    let placed = |ends: [glam::DVec3; 2], style| Line { ends: ends.map(|p| camera.project(p)), style };
    lines.extend(subject.crossings.iter().map(|&ends| placed(ends, Style::Crossing)));
    let marked = |colour: [u8; 3]| {
        let [r, g, b] = colour.map(|c| linear_from_srgb(c) as f32);
        Style::Marked { colour: Rgb::new(r, g, b) }
    };
    lines.extend(subject.lines.iter().map(|&(ends, colour)| placed(ends, marked(colour))));
    lines.sort_by_key(|line| line.style.rank());
    lines
}

/// How much of a plain edge is drawn, by the size of its triangles: where they are a few pixels wide, lines would only
/// make the mesh black.
fn strength(edge: &DrawnEdge, triangles: &[[u32; 3]], seen: &[Vec3]) -> f32 {
    let width = |t: u32| {
        let [a, b, c] = triangles[t as usize].map(|v| seen[v as usize]);
        (b - a).cross(c - a).length().sqrt()
    };
    let width = edge.triangles.map(width).into_iter().fold(0.0, f32::max);
    ((width - 4.0) / 12.0).clamp(0.0, 1.0)
}
