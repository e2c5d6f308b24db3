//! How far two meshes are from each other: distances both ways, volume, area, normals, sharp edges.
//!
//! Distances are taken at samples spread evenly over the area, and, for the largest, at all vertices too. Samples
//! follow a fixed sequence, so that the same meshes give the same numbers. The definitions (area-uniform samples,
//! maxima over samples and vertices, the nearest triangle for normals, samples along sharp edges) are given field by
//! field in [`Comparison`]. [`deviation_map`] says and colours where on the surface the difference is.

mod deviation;
mod distance;
mod sample;
mod sharp;
mod surface;

use serde::{Deserialize, Serialize};

use crate::mesh::{TriMesh, ValidateOptions, Validity, validate};
use crate::progress::{Progress, Stage, Stopped};

pub use deviation::{DeviationMap, deviation_map};
pub use distance::{Distances, Relative, Symmetric};
pub use sharp::SharpEdges;
use surface::{Frame, ScaledFaces};

/// Parts of the longest side of A's box that the edge tolerance is a quarter of, where none is given.
const GRID: f64 = 256.0;

/// Normals farther apart than this count as wrong, degrees.
const WRONG_NORMAL: f64 = 10.0;

/// Options of [`compare`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompareOptions {
    /// Samples on each mesh; half as many along the sharp edges of each. At least one is taken.
    pub samples: usize,
    /// How near a sharp edge of the other mesh must be to count as found, model units. `None`: a quarter of 1/256 of
    /// the longest side of A's bounding box.
    pub edge_tolerance: Option<f64>,
}

impl Default for CompareOptions {
    /// 100,000 samples.
    fn default() -> Self {
        Self { samples: 100_000, edge_tolerance: None }
    }
}

/// What [`compare`] finds. A is the reference. Triangles without area take no part, except that they count in
/// `triangles`. A measure is `None` where there is nothing to measure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Comparison {
    /// The measures of A.
    pub a: Measures,
    /// The measures of B.
    pub b: Measures,
    /// The number of samples taken on each mesh.
    pub samples: usize,
    /// Diagonal of A's bounding box, model units; what relative distances are parts of.
    pub diagonal: f64,
    /// From A to the nearest point of B. `None` unless both meshes have an area; so with the two below.
    pub a_to_b: Option<Distances>,
    /// From B to the nearest point of A.
    pub b_to_a: Option<Distances>,
    /// The distances both ways taken together.
    pub symmetric: Option<Symmetric>,
    /// (volume of B − volume of A) / |volume of A|; `None` unless A is closed.
    pub volume_difference: Option<f64>,
    /// (area of B − area of A) / area of A.
    pub area_difference: Option<f64>,
    /// Normals of A's samples against those of the nearest triangles of B.
    pub normals: Option<Normals>,
    /// How the sharp edges of both agree.
    pub sharp: SharpEdges,
}

/// Measures of one mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measures {
    /// All triangles, also those without area.
    pub triangles: usize,
    /// Whether every edge has at least two triangles; vertices of equal coordinates count as one.
    pub closed: bool,
    /// Signed volume, cubic model units. Means little where the mesh is not closed.
    pub volume: f64,
    /// Area, square model units.
    pub area: f64,
}

impl Measures {
    fn of(validity: &Validity) -> Self {
        Self {
            triangles: validity.triangles,
            closed: validity.is_closed(),
            volume: validity.volume,
            area: validity.area,
        }
    }
}

/// How the normals differ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Normals {
    /// Whether the side counts. Where neighbours in A disagree about the outside it does not: a normal and its
    /// opposite are then the same.
    pub oriented: bool,
    /// Mean angle, degrees.
    pub mean_degrees: f64,
    /// Share of the samples where the angle is over 10 degrees, 0 to 1.
    pub share_over_10_degrees: f64,
}

/// Compares `b` with the reference `a`.
pub fn compare(a: &TriMesh, b: &TriMesh, options: &CompareOptions, progress: &Progress) -> Result<Comparison, Stopped> {
    progress.stage(Stage::Compare)?;
    let counts = ValidateOptions { self_intersections: false, weld: true };
    let [state_a, state_b] = [validate(a, &counts, progress)?, validate(b, &counts, progress)?];
    let samples = options.samples.max(1);
    let frame = Frame::around(a, b);
    let [a, b] = [frame.scaled(a), frame.scaled(b)];
    let [on_a, on_b] = [ScaledFaces::new(&a, &frame), ScaledFaces::new(&b, &frame)];
    let unit = on_a.longest_side() / GRID;
    let tolerance = options.edge_tolerance.map_or(0.25 * unit, |given| given * frame.scale);
    let mut comparison = Comparison {
        a: Measures::of(&state_a),
        b: Measures::of(&state_b),
        samples,
        diagonal: on_a.diagonal() / frame.scale,
        a_to_b: None,
        b_to_a: None,
        symmetric: None,
        volume_difference: (state_a.is_closed() && state_a.volume != 0.0)
            .then(|| (state_b.volume - state_a.volume) / state_a.volume.abs()),
        area_difference: (state_a.area > 0.0).then(|| (state_b.area - state_a.area) / state_a.area),
        normals: None,
        sharp: sharp::compare([&a, &b], &frame, tolerance, (samples / 2).max(1), progress)?,
    };
    progress.share(0.3);
    let [Some(tree_a), Some(tree_b)] = [on_a.tree(), on_b.tree()] else { return Ok(comparison) };
    let forward = distance::measure(&on_a, &tree_b, samples, progress)?;
    progress.share(0.7);
    let backward = distance::measure(&on_b, &tree_a, samples, progress)?;
    comparison.normals = Some(normals(&forward.pairs, &on_a, &on_b, state_a.inconsistent_edges == 0));
    let forward = forward.distances.in_units(&frame, on_a.diagonal());
    let backward = backward.distances.in_units(&frame, on_a.diagonal());
    comparison.symmetric = Some(Symmetric::of(&forward, &backward));
    (comparison.a_to_b, comparison.b_to_a) = (Some(forward), Some(backward));
    Ok(comparison)
}

/// The angles between the normals of paired faces of A and B.
fn normals(pairs: &[[u32; 2]], a: &ScaledFaces, b: &ScaledFaces, oriented: bool) -> Normals {
    let angle = |&[own, other]: &[u32; 2]| {
        let cosine = a.normal(own).dot(b.normal(other));
        let cosine = if oriented { cosine } else { cosine.abs() };
        cosine.clamp(-1.0, 1.0).acos().to_degrees()
    };
    let (sum, wrong) = pairs
        .iter()
        .map(angle)
        .fold((0.0, 0usize), |(sum, wrong), degrees| (sum + degrees, wrong + usize::from(degrees > WRONG_NORMAL)));
    let count = pairs.len().max(1) as f64;
    Normals { oriented, mean_degrees: sum / count, share_over_10_degrees: wrong as f64 / count }
}
