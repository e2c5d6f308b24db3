//! Lids over holes, made from the rim alone.
//!
//! [`rims`] finds the loops of open edges of a mesh, and [`lid`] closes one: with the triangles of least weight over its vertices, which are then left as they are
//! or refined to the density of the rim and shaped so that they continue the curvature of what is around; [`level_lid`] closes along the level of a number that is known in space. Nothing else is looked at: whether a lid meets other parts of the mesh, and whether it
//! separates the inside from the outside, is for the caller to judge.
//!
//! # Which lid
//!
//! [`Style::Auto`] closes flat
//!
//! - a rim of three vertices: its triangle;
//! - a rim that lies in a plane to within 2 % of its diameter, where the surface beside it leaves that plane: the triangles beside the rim are, in the mean over its length, turned by more than 60° against it. Such are
//!   the base of a scan, the end of a tube, a missing face of a box;
//! - a rim that lies in a plane to within 0.1 % with all triangles beside it in that plane (within 2°): a hole in a flat face;
//! - a rim beside which the triangles lie in a few planes that meet in a line or a point: the lid goes on with these planes, up to the line or point. Such are missing pieces at an edge or a corner of a box;
//! - a rim of at most five vertices over which the triangles of least bend are bent by less than 10°, against each other and across the rim: missing triangles.
//!
//! Everything else it closes smoothly. Where edges that are bent by more than 15°, much more than what is beside them, run into the hole and out of it, they are continued through the lid.

mod band;
mod boundary;
mod creases;
mod fair;
mod flat;
mod level;
mod minimal;
mod polygon;
mod refine;
mod region;
mod rims;
mod sheet;
mod skyline;
#[cfg(test)]
mod tests;

use glam::DVec3;
use serde::Serialize;

pub use band::band;
pub use level::level_lid;
pub(crate) use region::region;
pub use rims::{Rim, rims};

use self::boundary::{Boundary, normal, on_a_line};
use self::flat::Cover;
use self::sheet::Sheet;
use crate::mesh::around::Around;
use crate::mesh::{TriMesh, intersecting_triangles};
use crate::progress::Progress;

/// How far from its plane a rim may lie, as a share of its diameter, to be closed flat where the surface beside leaves the plane.
const FLAT: f64 = 0.02;

/// The same where the surface beside lies in the plane.
const IN_PLANE: f64 = 1e-3;

/// Cosine of 60°: the mean turn against the plane from which the surface beside a rim leaves it.
const LEAVES: f64 = 0.5;

/// Cosine of 2°: triangles beside a rim that are turned less lie in its plane.
const LEVEL: f64 = 0.99939;

/// Rims of at most so many vertices get no more when their triangles are bent by less than [`SLIGHT`].
const FEW: usize = 5;

/// Cosine of 10°.
const SLIGHT: f64 = 0.98481;

/// Whether a smooth lid crosses itself is asked over rims of up to so many vertices: beyond, the answer takes longer than the lid.
const ASKED: usize = 4000;

/// How a rim is closed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Style {
    /// Flat or smooth, by what the rim and the surface beside it look like; see [the rule](self#which-lid).
    #[default]
    Auto,
    /// With few triangles and no more vertices than needed: in the plane of the rim, in the planes of what is beside, or with the triangles of least bend.
    Flat,
    /// With triangles as dense as the rim, which continue the curvature of what is around.
    Smooth,
}

/// How [`lid`] closes a rim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FillOptions {
    /// The shape of the lid.
    pub style: Style,
    /// How many vertices a smooth lid may add. Where the density of the rim asks for more, the lid is coarser.
    pub most_vertices: usize,
}

impl Default for FillOptions {
    /// By the rule, with up to 3,000 vertices.
    fn default() -> Self {
        Self { style: Style::Auto, most_vertices: 3000 }
    }
}

/// What closes a rim.
#[derive(Debug, Clone, PartialEq)]
pub struct Lid {
    /// New vertices, numbered after those of the mesh.
    pub positions: Vec<DVec3>,
    /// Triangles, in the direction of those around. Numbers below that of the mesh's vertices are these, the others are new.
    pub triangles: Vec<[u32; 3]>,
    /// What [`Style::Auto`] came to; otherwise what was asked for.
    pub style: Style,
    /// The sum of the areas of the triangles.
    pub area: f64,
}

impl Lid {
    /// The triangles where a mesh of `known` vertices has got `others` more since, and the lid's come after these.
    pub fn triangles_after(&self, known: usize, others: usize) -> impl Iterator<Item = [u32; 3]> + '_ {
        let number = move |v: u32| if (v as usize) < known { v } else { v + others as u32 };
        self.triangles.iter().map(move |corners| corners.map(number))
    }
}

/// Why a rim cannot be closed by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoLid {
    /// What was given is no rim of the mesh.
    #[error(
        "the vertices are no rim of this mesh: each must be there once, with an open edge to the next; find the rims of the mesh again"
    )]
    NoLoop,
    /// All ways to close the rim repeat a triangle or an edge that the mesh has.
    #[error("every lid over the rim repeats an edge or a triangle of the mesh; close it together with what is around")]
    Folded,
    /// The rim lies on a line.
    #[error("the rim encloses no area: its vertices lie on a line; merge what faces each other along it")]
    NoArea,
}

/// A mesh with the triangles around each of its vertices.
pub struct Surroundings<'a> {
    mesh: &'a TriMesh,
    around: Around,
}

impl<'a> Surroundings<'a> {
    /// Collects the triangles around the vertices of a mesh.
    pub fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh, around: Around::new(mesh) }
    }

    /// The mesh.
    pub fn mesh(&self) -> &'a TriMesh {
        self.mesh
    }

    /// The triangles around a vertex.
    fn of(&self, vertex: u32) -> &[u32] {
        self.around.of(vertex)
    }
}

/// Closes a rim.
///
/// The lid has the direction of the triangles around it, meets the rim edge by edge, has no triangle without an area, and repeats no edge of the mesh. It may
/// meet other parts of the mesh, or itself where the rim is knotted; a smooth lid that would meet itself or what is beside is shaped less (asked over rims of up to 4,000 vertices). Coordinates alone decide: other numbers for the same vertices and triangles give the same lid.
///
/// # Errors
/// [`NoLid`] where the rim is none of this mesh, lies on a line, or can only be closed over edges that are there already.
pub fn lid(around: &Surroundings<'_>, rim: &Rim, options: &FillOptions) -> Result<Lid, NoLid> {
    let boundary = Boundary::new(around, rim)?;
    let diameter = rim.diameter * boundary.scale;
    if rim.vertices.len() == 3 {
        return of_three(around, &boundary, rim, options.style);
    }
    let (style, cover) = match options.style {
        Style::Smooth => (Style::Smooth, None),
        style => match flat_cover(&boundary, rim, diameter, style) {
            Some(cover) => (Style::Flat, Some(cover)),
            None if style == Style::Flat => (Style::Flat, None),
            None => (Style::Smooth, None),
        },
    };
    if style == Style::Flat {
        // What lies in planes does not know which edges the mesh has.
        let made = finished(&boundary, rim, around, cover.unwrap_or_else(|| least(&boundary, rim)), style);
        return made.or_else(|_| finished(&boundary, rim, around, of_least_bend(&boundary), style)).map(|(lid, _)| lid);
    }
    smooth(&boundary, rim, around, options.most_vertices)
}

/// The lid that [`Style::Auto`] makes where that is flat; `None` where it would be smooth, or where there is none.
pub(crate) fn flat_lid(around: &Surroundings<'_>, rim: &Rim) -> Option<Lid> {
    let boundary = Boundary::new(around, rim).ok().filter(|boundary| boundary.len() > 3)?;
    let cover = flat_cover(&boundary, rim, rim.diameter * boundary.scale, Style::Auto)?;
    finished(&boundary, rim, around, cover, Style::Flat).ok().map(|(lid, _)| lid)
}

/// The smooth lid. It is divided along sharp edges that run through the hole. What crosses itself is shaped less, or not at all.
fn smooth(boundary: &Boundary, rim: &Rim, around: &Surroundings<'_>, most: usize) -> Result<Lid, NoLid> {
    let style = Style::Smooth;
    let divided = creases::along_creases(boundary, around, rim);
    let covers = divided.into_iter().chain(in_one_plane(boundary, rim));
    let covers = covers.chain(std::iter::once_with(|| of_least_bend(boundary)));
    let mut last = Err(NoLid::Folded);
    for cover in covers {
        let (plain, mut sheet) = match finished(boundary, rim, around, cover, style) {
            Ok(made) => made,
            Err(error) => {
                last = last.or(Err(error));
                continue;
            }
        };
        if crosses(around, rim, &plain) {
            last = Ok(plain);
            continue;
        }
        refine::refine(&mut sheet, most, 1.0);
        for steps in [fair::STEPS, 1, 0] {
            let mut shaped = sheet.clone();
            fair::fair(&mut shaped, around, rim, boundary.scale, steps);
            let lid = of_sheet(boundary, rim, around, &shaped, style);
            if let Some(lid) = lid.ok().filter(|lid| !crosses(around, rim, lid)) {
                return Ok(lid);
            }
        }
        last = Ok(plain);
    }
    last
}

/// Whether triangles of a lid meet each other, or those beside the rim, elsewhere than in what they share. Not asked over very long rims.
fn crosses(around: &Surroundings<'_>, rim: &Rim, lid: &Lid) -> bool {
    if rim.vertices.len() > ASKED {
        return false;
    }
    let mesh = around.mesh();
    let mut beside: Vec<u32> = rim.vertices.iter().flat_map(|&v| around.of(v)).copied().collect();
    beside.sort_unstable();
    beside.dedup();
    let triangles = lid.triangles.iter().chain(beside.iter().map(|&t| &mesh.triangles[t as usize]));
    let added = |v: u32| lid.positions[v as usize - mesh.positions.len()];
    let at = |v: u32| mesh.positions.get(v as usize).copied().unwrap_or_else(|| added(v));
    let positions: Vec<DVec3> = triangles.flatten().map(|&v| at(v)).collect();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    // Nothing stops a search without a deadline; what is not known counts as crossing.
    let found = intersecting_triangles(&TriMesh { positions, triangles }, &Progress::default());
    found.map_or(true, |found| found.iter().any(|&t| (t as usize) < lid.triangles.len()))
}

/// The lid over three vertices.
fn of_three(around: &Surroundings<'_>, boundary: &Boundary, rim: &Rim, style: Style) -> Result<Lid, NoLid> {
    let corners = [boundary.points[0], boundary.points[1], boundary.points[2]];
    let triangle = [rim.vertices[0], rim.vertices[1], rim.vertices[2]];
    let there = |t: &u32| around.mesh().triangles[*t as usize].iter().all(|v| triangle.contains(v));
    if on_a_line(corners) {
        return Err(NoLid::NoArea);
    }
    if around.of(triangle[0]).iter().any(there) {
        return Err(NoLid::Folded);
    }
    let area = refine::area(triangle.map(|v| around.mesh().positions[v as usize]));
    let style = if style == Style::Auto { Style::Flat } else { style };
    Ok(Lid { positions: Vec::new(), triangles: vec![triangle], style, area })
}

/// Whether a rim of few vertices lies in one plane with a triangle beside it that goes on there: then a piece of a flat side is missing, whatever is open elsewhere.
pub(crate) fn is_gap_in_plane(around: &Surroundings<'_>, rim: &Rim) -> bool {
    let few = rim.vertices.len() <= FEW && rim.flatness <= IN_PLANE * rim.diameter;
    few && Boundary::new(around, rim)
        .is_ok_and(|boundary| (0..boundary.len()).any(|k| boundary.normal_beside(k).dot(rim.plane.normal) > LEVEL))
}

/// The flat lid where the rim has one; with [`Style::Auto`] only where the rule asks for it.
fn flat_cover(boundary: &Boundary, rim: &Rim, diameter: f64, style: Style) -> Option<Cover> {
    let normal = rim.plane.normal;
    let flatness = rim.flatness / rim.diameter;
    let mut mean = [0.0; 2];
    let mut level = true;
    for (edge, [a, b]) in rims::each_edge(&boundary.points).enumerate() {
        let along = boundary.normal_beside(edge).dot(normal);
        mean[0] += along.abs() * a.distance(b);
        mean[1] += a.distance(b);
        level &= along > LEVEL;
    }
    let leaves = mean[0] < LEAVES * mean[1];
    let numbers: Vec<u32> = (0..boundary.len() as u32).collect();
    let in_plane = || {
        let triangles = flat::polygon(&boundary.points, &numbers, normal)?;
        Some(Cover { triangles, added: Vec::new() })
    };
    let is_flat = flatness <= FLAT && leaves || flatness <= IN_PLANE && (level || style == Style::Flat);
    if is_flat && let Some(cover) = in_plane() {
        return Some(cover);
    }
    if let Some(cover) = flat::by_planes(boundary, diameter) {
        return Some(cover);
    }
    if style == Style::Flat && flatness <= FLAT {
        return in_plane();
    }
    if boundary.len() > FEW {
        return None;
    }
    let triangles = minimal::triangulate(boundary);
    is_slight(boundary, &triangles).then_some(Cover { triangles, added: Vec::new() })
}

/// Whether no two triangles are bent much against each other, nor against those beside the rim.
fn is_slight(boundary: &Boundary, triangles: &[[u32; 3]]) -> bool {
    let mut across: rustc_hash::FxHashMap<[u32; 2], DVec3> = rustc_hash::FxHashMap::default();
    let count = boundary.len() as u32;
    across.extend((0..count).map(|k| ([(k + 1) % count, k], boundary.normal_beside(k as usize))));
    let normals: Vec<DVec3> = triangles.iter().map(|t| normal(t.map(|v| boundary.points[v as usize]))).collect();
    let each = || triangles.iter().zip(&normals).flat_map(|(t, &n)| (0..3).map(move |k| ([t[k], t[(k + 1) % 3]], n)));
    across.extend(each());
    each().all(|([a, b], n)| across.get(&[b, a]).is_some_and(|other| n.dot(*other) > SLIGHT))
}

/// The triangles of least weight. Long rims that are flat are triangulated in their plane.
fn least(boundary: &Boundary, rim: &Rim) -> Cover {
    in_one_plane(boundary, rim).unwrap_or_else(|| of_least_bend(boundary))
}

/// The triangles in the plane of a long rim that is flat.
fn in_one_plane(boundary: &Boundary, rim: &Rim) -> Option<Cover> {
    let numbers: Vec<u32> = (0..boundary.len() as u32).collect();
    let long = boundary.len() > minimal::AT_ONCE && rim.flatness <= 0.1 * rim.diameter;
    let triangles = long.then(|| flat::polygon(&boundary.points, &numbers, rim.plane.normal)).flatten()?;
    Some(Cover { triangles, added: Vec::new() })
}

/// The triangles of least weight, however long the rim is.
fn of_least_bend(boundary: &Boundary) -> Cover {
    Cover { triangles: minimal::triangulate(boundary), added: Vec::new() }
}

/// The lid of these triangles after their edges have been turned, and the sheet that it was made from.
fn finished<'b>(
    boundary: &'b Boundary,
    rim: &Rim,
    around: &Surroundings<'_>,
    cover: Cover,
    style: Style,
) -> Result<(Lid, Sheet<'b>), NoLid> {
    let mut sheet = Sheet::new(boundary, &cover.triangles, &cover.added)?;
    sheet.turn_edges();
    of_sheet(boundary, rim, around, &sheet, style).map(|lid| (lid, sheet))
}

/// The lid in the numbers of the mesh.
fn of_sheet(
    boundary: &Boundary,
    rim: &Rim,
    around: &Surroundings<'_>,
    sheet: &Sheet<'_>,
    style: Style,
) -> Result<Lid, NoLid> {
    let mesh = around.mesh();
    let count = boundary.len();
    let triangles = sheet.triangles();
    let joined = |t: &[u32; 3]| (0..3).any(|k| boundary.is_joined(t[k], t[(k + 1) % 3]));
    if triangles.iter().any(joined) {
        return Err(NoLid::Folded);
    }
    let positions: Vec<DVec3> = sheet.points[count + 1..].iter().map(|&p| p / boundary.scale).collect();
    let first = mesh.positions.len() as u32;
    let number = |v: u32| rim.vertices.get(v as usize).copied().unwrap_or_else(|| first + v - count as u32 - 1);
    if triangles.iter().any(|&t| on_a_line(sheet.corners(t))) {
        return Err(NoLid::NoArea);
    }
    let area: f64 = triangles.iter().map(|&t| refine::area(sheet.corners(t))).sum();
    let triangles = triangles.into_iter().map(|t| t.map(number)).collect();
    Ok(Lid { positions, triangles, style, area: area / boundary.scale / boundary.scale })
}
