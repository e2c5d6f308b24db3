//! A block under an open sheet: terrain and reliefs, with walls down from their rims to a flat base.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::assembled::Assembled;
use super::{BlockReport, BooleanError, Operand, Options, Outcome, Plan, TriangleSource, boolean, plan};
use crate::digits;
use crate::fill::region;
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::mesh::edges::Edges;
use crate::orient::OrientMode;
use crate::picture::Axis;
use crate::progress::{Progress, Stage, Stopped};
use crate::survey::{Soup, SoupError};

/// A patch stands upright when what it covers, seen along the axis, is less than this part of its area.
const UPRIGHT: f64 = 1e-9;

/// Where the base of a block lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Base {
    /// So far, model units, below the lowest point of a sheet that faces up or down, or behind the rearmost one of a sheet that faces sideways. A sheet faces along the axis
    /// along which it covers most.
    Below(f64),
    /// In a plane across an axis. The sheet has to lie on one side of it.
    Plane {
        /// The axis.
        axis: Axis,
        /// Where on the axis, model units.
        at: f64,
    },
}

/// Why there is no block under a sheet. Lengths and places are in model units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// The depth is no positive number.
    #[error("a base {depth} below the sheet cannot be used; the depth must be above zero")]
    Depth {
        /// The depth that was asked for.
        depth: f64,
    },
    /// The surface has no open edge.
    #[error(
        "the surface has no open edge, so it is no sheet from whose rim walls could go down: `repair` makes a solid of it"
    )]
    Closed,
    /// The sheet does not lie on one side of the base.
    #[error(
        "the sheet lies on both sides of its base {} = {}: it reaches from {} to {}, and goes through it at {}; choose a base below {} or above {}",
        name(*axis), digits::number(*at), digits::number(*low), digits::number(*high), place(*through), digits::number(*low), digits::number(*high)
    )]
    Through {
        /// The axis across which the base lies.
        axis: Axis,
        /// Where on it.
        at: f64,
        /// The lowest point of the sheet on that axis.
        low: f64,
        /// The highest.
        high: f64,
        /// A place near the base where the sheet goes from one side to the other.
        through: DVec3,
    },
    /// A part of the sheet covers nothing of the base.
    #[error("a part of the sheet, at {}, stands upright along {}: it covers nothing of a base across that axis", place(*at), name(*axis))]
    Upright {
        /// The axis across which the base lies.
        axis: Axis,
        /// A corner of that part.
        at: DVec3,
    },
    /// The block is no solid.
    #[error(transparent)]
    Boolean(#[from] BooleanError),
}

fn name(axis: Axis) -> &'static str {
    ["x", "y", "z"][axis.number()]
}

fn place(p: DVec3) -> String {
    p.to_array().map(digits::number).join(" ")
}

impl From<Stopped> for BlockError {
    fn from(stopped: Stopped) -> Self {
        Self::Boolean(stopped.into())
    }
}

impl From<SoupError> for BlockError {
    fn from(error: SoupError) -> Self {
        Self::Boolean(error.into())
    }
}

/// Makes a block of an open sheet: its triangles stay as they are, walls of two triangles an edge go from its rims to the base, and the base is flat. Holes of the sheet go through the block. Several
/// sheets stand on one base; closed surfaces of the operand become part of the block. Where walls and sheets cross, as under an overhang at a rim, they are cut exactly.
///
/// Which way the sheet's triangles face does not matter. [`Options::orient`] has a say about the operand's closed surfaces only.
///
/// # Errors
/// See [`BlockError`].
pub fn block<'a>(
    operand: impl Into<Operand<'a>>,
    base: Base,
    options: &Options,
    progress: &Progress,
) -> Result<Outcome, BlockError> {
    let operand: Operand<'a> = operand.into();
    progress.stage(Stage::Orient)?;
    let Built { assembled, soup, orient, mut report } = Built::new(operand.mesh, base, options, progress)?;
    let given = Operand { negative: operand.negative, ..Operand::from(&assembled.mesh) };
    let made = boolean([given], &Expression::Operand(0), &Options { orient, ..*options }, progress)?;
    let (operands, _) = Operand::with_negatives([operand], &Expression::Operand(0));
    let mut outcome = assembled.told(made, &operands);
    report.volume = outcome.solid.validity().volume;
    if let Some(own) = outcome.report.orient.first_mut() {
        *own = soup.reports[0].clone();
        own.flipped_patches = report.turned;
    }
    outcome.report.block = Some(report);
    Ok(outcome)
}

/// What [`block`] would cost.
///
/// # Errors
/// Those of [`block`] that come before it is judged.
pub fn plan_block(mesh: &TriMesh, base: Base, options: &Options) -> Result<Plan, BlockError> {
    let built = Built::new(mesh, base, options, &Progress::none())?;
    Ok(plan([&built.assembled.mesh], &Options { orient: built.orient, ..*options })?)
}

/// A block before it is judged.
struct Built {
    assembled: Assembled,
    soup: Soup,
    /// Whether surfaces may still be turned over.
    orient: OrientMode,
    report: BlockReport,
}

/// The base as seen by the sheet.
#[derive(Clone, Copy)]
struct Ground {
    axis: Axis,
    at: f64,
    /// Whether the sheet lies at larger numbers.
    above: bool,
}

impl Ground {
    /// Across which axis the base lies, where, and on which side of it the sheet is.
    fn new(soup: &Soup, base: Base) -> Result<Self, BlockError> {
        let corners = || soup.mesh.triangles.iter().flatten().map(|&v| soup.mesh.positions[v as usize]);
        let ends = |axis: Axis| {
            let along = || corners().map(|p| p[axis.number()]);
            [along().fold(f64::MAX, f64::min), along().fold(f64::MIN, f64::max)]
        };
        match base {
            Base::Below(depth) if !(depth > 0.0 && depth.is_finite()) => Err(BlockError::Depth { depth }),
            Base::Below(depth) => {
                let (axis, faces_up) = facing(soup);
                let [low, high] = ends(axis);
                // Terrain stands on what is below it, whichever way its triangles face.
                let above = axis == Axis::Z || faces_up;
                Ok(Self { axis, at: if above { low - depth } else { high + depth }, above })
            }
            Base::Plane { axis, at } => {
                let [low, high] = ends(axis);
                if at <= low || at >= high {
                    return Ok(Self { axis, at, above: at <= low });
                }
                let sides = |t: &usize| soup.mesh.corners(*t).map(|p| p[axis.number()] < at);
                let through = |t: &usize| sides(t).contains(&true) && sides(t).contains(&false);
                let triangle = (0..soup.mesh.triangles.len()).find(through).unwrap_or(0);
                let through = soup.mesh.corners(triangle).iter().sum::<DVec3>() / 3.0;
                Err(BlockError::Through { axis, at, low, high, through })
            }
        }
    }

    /// A point of the sheet as seen from its side, so that what runs counter-clockwise there does here.
    fn seen(self, p: DVec3) -> DVec2 {
        let axis = self.axis.number();
        let [u, v] = [p[(axis + 1) % 3], p[(axis + 2) % 3]];
        // No difference between 0 and -0.
        (if self.above { DVec2::new(u, v) } else { DVec2::new(v, u) }) + DVec2::ZERO
    }

    /// The point of the base below one of the sheet.
    fn under(self, mut p: DVec3) -> DVec3 {
        p[self.axis.number()] = self.at;
        p
    }
}

/// The areas of the patches of a soup, as vectors.
fn areas(soup: &Soup) -> Vec<DVec3> {
    let mut areas = vec![DVec3::ZERO; soup.patch_count];
    for (t, patch) in soup.patch_of.iter().enumerate() {
        let [a, b, c] = soup.mesh.corners(t);
        areas[patch.index()] += (b - a).cross(c - a) / 2.0;
    }
    areas
}

/// The axis along which the patches cover most, whichever way they face, and whether they face to larger numbers on the whole.
fn facing(soup: &Soup) -> (Axis, bool) {
    let areas = areas(soup);
    let covered: DVec3 = areas.iter().map(|area| area.abs()).sum();
    let first = if covered.x >= covered.y { Axis::X } else { Axis::Y };
    let axis = if covered.z >= covered[first.number()] { Axis::Z } else { first };
    (axis, areas.iter().map(|area| area[axis.number()]).sum::<f64>() > 0.0)
}

/// The open edges of triangles, each in the direction in which these run, as often as more do than the other way.
fn open_edges(mesh: &TriMesh) -> Vec<u32> {
    let edges = Edges::new(&mesh.triangles, mesh.positions.len());
    let mut open = Vec::new();
    edges.each(|edge| {
        let up = edge.halves().filter(|&half| edges.runs_up(half)).count();
        let down = edge.count() - up;
        let more = edge.halves().filter(|&half| edges.runs_up(half) == (up > down));
        open.extend(more.take(up.abs_diff(down)));
    });
    open.sort_unstable();
    open
}

impl Built {
    fn new(mesh: &TriMesh, base: Base, options: &Options, progress: &Progress) -> Result<Self, BlockError> {
        BooleanError::check(0, mesh)?;
        let mut soup = Soup::of(&[mesh], OrientMode::Auto, progress)?;
        let ground = Ground::new(&soup, base)?;
        let (turned, sheets) = turn(&mut soup, ground)?;
        progress.check()?;
        let open = open_edges(&soup.mesh);
        let own = soup.source.iter().map(|&triangle| TriangleSource::Operand { operand: 0, triangle }).collect();
        let mut assembled = Assembled { own, mesh: soup.mesh.clone(), holes: 0 };
        let (walls, lid) = enclose(&mut assembled.mesh, &open, ground);
        assembled.own.resize(assembled.mesh.triangles.len(), TriangleSource::Closed);
        // Sheets face away from the base now, whatever rays say; closed surfaces may face anywhere.
        let orient = if sheets == soup.patch_count { OrientMode::Keep } else { options.orient };
        let report = BlockReport {
            axis: name(ground.axis).to_string(),
            base: ground.at,
            sheets,
            turned,
            edges: open.len(),
            wall_triangles: walls,
            base_triangles: lid,
            volume: 0.0,
        };
        Ok(Self { assembled, soup, orient, report })
    }
}

/// Turns patches with rims so that they face away from the base. The number of those that were turned, and of all.
fn turn(soup: &mut Soup, ground: Ground) -> Result<(usize, usize), BlockError> {
    let axis = ground.axis.number();
    let mut has_rim = vec![false; soup.patch_count];
    let edges = Edges::new(&soup.mesh.triangles, soup.mesh.positions.len());
    edges.each(|edge| {
        if edge.count() != 2 {
            edge.halves().for_each(|half| has_rim[soup.patch_of[half as usize / 3].index()] = true);
        }
    });
    if !has_rim.contains(&true) {
        return Err(BlockError::Closed);
    }
    let mut size = vec![0.0; soup.patch_count];
    for (t, patch) in soup.patch_of.iter().enumerate() {
        let [a, b, c] = soup.mesh.corners(t);
        size[patch.index()] += (b - a).cross(c - a).length() / 2.0;
    }
    let covers: Vec<f64> = areas(soup).iter().map(|area| area[axis]).collect();
    if let Some(upright) = (0..covers.len()).find(|&n| has_rim[n] && covers[n].abs() <= UPRIGHT * size[n]) {
        let of_it = soup.patch_of.iter().position(|patch| patch.index() == upright).unwrap_or(0);
        return Err(BlockError::Upright { axis: ground.axis, at: soup.mesh.corners(of_it)[0] });
    }
    let over = |patch: usize| has_rim[patch] && (covers[patch] > 0.0) != ground.above;
    for (corners, patch) in soup.mesh.triangles.iter_mut().zip(&soup.patch_of) {
        if over(patch.index()) {
            corners.swap(1, 2);
        }
    }
    let count = |of: &dyn Fn(usize) -> bool| (0..covers.len()).filter(|&patch| of(patch)).count();
    Ok((count(&over), count(&|patch| has_rim[patch])))
}

/// Adds walls under the open edges of a mesh, and the base: how many triangles each has.
fn enclose(mesh: &mut TriMesh, open: &[u32], ground: Ground) -> (usize, usize) {
    let ends = |half: u32| {
        let corners = mesh.triangles[half as usize / 3];
        [corners[half as usize % 3], corners[(half as usize % 3 + 1) % 3]]
    };
    let rim: Vec<[u32; 2]> = open.iter().map(|&half| ends(half)).collect();
    // The vertices of the base: what lies above one another there is one, and what lies on the base already is its own.
    let mut at: FxHashMap<[u64; 2], u32> = FxHashMap::default();
    let (mut points, mut numbers): (Vec<DVec2>, Vec<u32>) = (Vec::new(), Vec::new());
    let mut below = |mesh: &mut TriMesh, v: u32| {
        let p = mesh.positions[v as usize];
        let seen = ground.seen(p);
        let foot = *at.entry(seen.to_array().map(f64::to_bits)).or_insert_with(|| {
            points.push(seen);
            numbers.push(u32::MAX);
            points.len() as u32 - 1
        });
        let number = &mut numbers[foot as usize];
        if *number == u32::MAX {
            *number = if ground.under(p) == p { v } else { mesh.positions.len() as u32 };
            if *number != v {
                mesh.positions.push(ground.under(p));
            }
        }
        foot
    };
    let feet: Vec<[u32; 2]> = rim.iter().map(|edge| edge.map(|v| below(mesh, v))).collect();
    let before = mesh.triangles.len();
    for (&[a, b], feet) in rim.iter().zip(&feet) {
        let [under_a, under_b] = feet.map(|foot| numbers[foot as usize]);
        let wall = [[b, a, under_a], [b, under_a, under_b]];
        // Of an upright edge nothing has an area.
        mesh.triangles.extend(wall.iter().filter(|t| under_a != under_b && t[0] != t[2] && t[1] != t[2]));
    }
    let walls = mesh.triangles.len() - before;
    let feet = balanced(feet);
    let lid = region(&points, &feet).unwrap_or_else(|| fan(&points, &feet));
    mesh.triangles.extend(lid.iter().map(|&[a, b, c]| [a, c, b].map(|foot| numbers[foot as usize])));
    (walls, lid.len())
}

/// The same edges without those that run there and back, or nowhere.
fn balanced(mut edges: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    let mut count: FxHashMap<[u32; 2], i64> = FxHashMap::default();
    for [a, b] in &edges {
        *count.entry([*a.min(b), *a.max(b)]).or_default() += if a < b { 1 } else { -1 };
    }
    edges.retain(|&[a, b]| {
        let left = count.entry([a.min(b), a.max(b)]).or_default();
        let direction = if a < b { 1 } else { -1 };
        let stays = a != b && *left * direction > 0;
        *left -= if stays { direction } else { 0 };
        stays
    });
    edges
}

/// Triangles over edges of which as many arrive at each vertex as leave it, from the first vertex of each of their ways. They may cross and lie over one another: how
/// often they cover a place is how often the edges run around it.
fn fan(points: &[DVec2], edges: &[[u32; 2]]) -> Vec<[u32; 3]> {
    let mut leaving: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    edges.iter().rev().for_each(|&[a, b]| leaving.entry(a).or_default().push(b));
    let mut triangles = Vec::new();
    for &[first, _] in edges {
        let mut at = first;
        while let Some(next) = leaving.get_mut(&at).and_then(Vec::pop) {
            let [a, b, c] = [first, at, next].map(|v| points[v as usize]);
            if (b - a).perp_dot(c - a) != 0.0 {
                triangles.push([first, at, next]);
            }
            at = next;
        }
    }
    triangles
}
