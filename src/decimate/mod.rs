//! Fewer triangles for the same solid: by number, by ratio, or as far as the surface may move.
//!
//! Edges are collapsed in the order of what they cost, the cheapest first. The cost is the sum of the squared distances of the new
//! vertex from the planes of the triangles around the edge, weighted by their area, and from the sharp edges there (`cost`);
//! the vertex goes where that is least (Garland and Heckbert 1997). The planes are those of the surface as it is
//! by then, not those of the beginning (Lindstrom and Turk 1998): the mean error is half as large for it. A collapse that would
//! turn a triangle over, or make the surface no manifold, is not done (`collapse`).
//!
//! Triangles that meet are rare, so the end result is looked at; where some do, it is done again, and every collapse near there is
//! looked at before it is done (`guard`). With a bound for the deviation, vertices go only into one another, and how far the
//! surface moves is added up, both ways, for every triangle.

mod bound;
mod collapse;
mod cost;
mod guard;
mod work;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::fit::rounded;
use crate::mesh::{NotManifold, Solid, SolidError, TriMesh, ValidateOptions, Validity, validate};
use crate::progress::{Progress, Stopped};
use collapse::Limits;
use guard::Zone;
use work::Work;

/// Options of [`decimate`], which goes on until one of the limits is reached; without any limit it goes on as long as the
/// solid stays valid.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DecimateOptions {
    /// Stop when there are no more triangles than this.
    pub triangles: Option<usize>,
    /// How far the surface may move, model units: no point of the old surface is farther from the new one, nor of the new from the
    /// old.
    pub max_deviation: Option<f64>,
    /// Whether all coordinates, those of the input as well, are `f32` ones, for formats that hold no more.
    pub single: bool,
}

/// What [`decimate`] did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DecimateReport {
    /// Triangles before.
    pub before: usize,
    /// Triangles after.
    pub after: usize,
    /// The number asked for, if one was.
    pub asked: Option<usize>,
    /// Whether the number asked for was reached; also false where the deviation ended it before.
    pub reached: bool,
    /// The bound for the deviation, model units, if one was given.
    pub max_deviation: Option<f64>,
    /// How often the decimation was done again because triangles would have met.
    pub repeats: usize,
}

/// A decimated solid.
#[derive(Debug, Clone, PartialEq)]
pub struct Decimated {
    /// The solid of fewer triangles.
    pub solid: Solid,
    /// For each triangle of the decimated solid the triangle of the input that it grew out of.
    pub origins: Vec<u32>,
    /// The account of what was done.
    pub report: DecimateReport,
}

/// Why [`decimate`] has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DecimateError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// Vertices of the input lie at one place, and the format that the result is for takes them for one: it would hold no valid solid.
    #[error("only a valid solid can be decimated, and this is none: {}", .0.problems().join(" "))]
    Invalid(Box<Validity>),
    /// The input is no closed manifold.
    #[error(transparent)]
    NotManifold(#[from] NotManifold),
    /// The deviation is no length.
    #[error("a deviation of {0} cannot be used; it must be a positive length")]
    Deviation(f64),
}

/// Times it is done again before all of the surface is looked at.
const MOST_REPEATS: usize = 6;

/// Takes triangles away from a solid so that it stays one, with as many bodies and tunnels as before. Vertices that stay keep their
/// coordinates. `classes`: a number for each triangle, or nothing; edges between different numbers (colours, for instance) are kept as sharp ones
/// are.
///
/// # Errors
/// See [`DecimateError`].
pub fn decimate(
    solid: &Solid,
    classes: &[u32],
    options: &DecimateOptions,
    progress: &Progress,
) -> Result<Decimated, DecimateError> {
    let mesh = solid.mesh();
    if let Some(length) = options.max_deviation.filter(|length| !(length.is_finite() && *length > 0.0)) {
        return Err(DecimateError::Deviation(length));
    }
    let look = ValidateOptions { self_intersections: true, weld: options.single };
    let before = solid.validity();
    if options.single {
        let welded = validate(mesh, &look, progress)?;
        if !welded.is_valid() {
            return Err(DecimateError::Invalid(Box::new(welded)));
        }
    }
    let scale = scale_of(mesh);
    let limits = Limits {
        triangles: options.triangles.unwrap_or(0),
        deviation: options.max_deviation.map(|length| length * scale),
        single: options.single.then_some(scale),
    };
    let count = mesh.triangles.len();
    let mut report = DecimateReport {
        before: count,
        after: count,
        asked: options.triangles,
        reached: options.triangles.is_none_or(|asked| count <= asked),
        max_deviation: options.max_deviation,
        repeats: 0,
    };
    let as_it_is =
        |report: DecimateReport| Decimated { solid: solid.clone(), origins: (0..count as u32).collect(), report };
    if report.reached && options.triangles.is_some() {
        return Ok(as_it_is(report));
    }
    let mut zone = Zone::nothing(cell_size(before, options, scale));
    loop {
        let mut work = Work::new(mesh, scale, classes)?;
        collapse::run(&mut work, &zone, &limits, progress)?;
        let (made, origins) = work.finish(mesh, scale);
        let state = validate(&made, &look, progress)?;
        if state.is_valid() {
            report.after = made.triangles.len();
            report.reached = options.triangles.is_none_or(|asked| report.after <= asked);
            match Solid::check(made, progress) {
                Ok(solid) => return Ok(Decimated { solid, origins, report }),
                Err(SolidError::Stopped(stopped)) => return Err(stopped.into()),
                // Only vertices that were taken for one kept it together.
                Err(_) => return Ok(as_it_is(DecimateReport { after: count, reached: false, ..report })),
            }
        }
        if zone.is_everything() {
            return Ok(as_it_is(report));
        }
        report.repeats += 1;
        if report.repeats > MOST_REPEATS || state.self_intersecting_triangles == Some(0) {
            zone = Zone::everything(zone.size());
        } else {
            zone.add_meetings(&made, scale, progress)?;
        }
    }
}

/// The power of two that brings the size of a mesh near to 1: products of lengths then neither overflow nor vanish.
fn scale_of(mesh: &TriMesh) -> f64 {
    let size = mesh.bounds().map_or(1.0, |bounds| bounds.diagonal());
    2f64.powi(-(size.max(1e-300).log2().floor() as i32).clamp(-900, 900))
}

/// Edge of the cells in which triangles that may meet are found: about an edge length of the result.
fn cell_size(before: &Validity, options: &DecimateOptions, scale: f64) -> f64 {
    let expected = options.triangles.unwrap_or(before.triangles / 8).max(4) as f64;
    1.5 * (before.area / expected).sqrt() * scale
}

/// A place as the numbers of the result may have it; `scale` is given where these are `f32`.
fn placed(p: DVec3, scale: Option<f64>) -> DVec3 {
    scale.map_or(p, |scale| rounded(p / scale) * scale)
}
