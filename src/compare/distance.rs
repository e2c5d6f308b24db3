//! Distances from one surface to another.

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::surface::{Frame, ScaledFaces};
use crate::mesh::ClosestTree;
use crate::progress::{Progress, Stopped};

/// Points that one thread searches before it looks whether it should stop.
const CHUNK: usize = 1 << 12;

/// Distances from points of one mesh to the nearest points of the other, model units. Mean, RMS and p99 are over
/// area-uniform samples, the largest over these and all vertices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Distances {
    /// The mean distance.
    pub mean: f64,
    /// The root of the mean square of the distances.
    pub rms: f64,
    /// What 99 of 100 samples do not exceed.
    pub p99: f64,
    /// The largest distance.
    pub max: f64,
    /// The place of the largest distance, on the mesh it is measured from.
    pub max_at: [f64; 3],
    /// The mean, RMS, p99 and largest distance relative to the diagonal of A's bounding box.
    pub relative: Relative,
}

/// Distances both ways, model units: the mean of the means, the root of the mean of the mean squares, and the larger
/// of each p99 and maximum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Symmetric {
    /// The mean distance.
    pub mean: f64,
    /// The root of the mean square of the distances.
    pub rms: f64,
    /// The larger of both p99.
    pub p99: f64,
    /// The largest distance of all: the Hausdorff distance, as far as samples and vertices can tell it.
    pub max: f64,
    /// All four, relative to the diagonal of A's bounding box.
    pub relative: Relative,
}

/// Distances relative to the diagonal of A's bounding box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Relative {
    /// The mean distance.
    pub mean: f64,
    /// The root of the mean square of the distances.
    pub rms: f64,
    /// What 99 of 100 samples do not exceed.
    pub p99: f64,
    /// The largest distance.
    pub max: f64,
}

impl Relative {
    fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self { mean: change(self.mean), rms: change(self.rms), p99: change(self.p99), max: change(self.max) }
    }
}

impl Symmetric {
    pub(super) fn of(forward: &Distances, backward: &Distances) -> Self {
        let both = |pick: fn(&Distances) -> Relative| {
            let (f, b) = (pick(forward), pick(backward));
            Relative {
                mean: (f.mean + b.mean) / 2.0,
                rms: f.rms.hypot(b.rms) / std::f64::consts::SQRT_2,
                p99: f.p99.max(b.p99),
                max: f.max.max(b.max),
            }
        };
        let Relative { mean, rms, p99, max } = both(|d| Relative { mean: d.mean, rms: d.rms, p99: d.p99, max: d.max });
        Self { mean, rms, p99, max, relative: both(|d| d.relative) }
    }
}

/// What [`measure`] finds, scaled.
pub(super) struct Measured {
    pub(super) distances: Scaled,
    /// For each sample its own face and the nearest one of the other surface.
    pub(super) pairs: Vec<[u32; 2]>,
}

/// Distances in the scaled space.
pub(super) struct Scaled {
    values: Relative,
    max_at: DVec3,
}

impl Scaled {
    pub(super) fn in_units(&self, frame: &Frame, diagonal: f64) -> Distances {
        let Relative { mean, rms, p99, max } = self.values.map(|d| d / frame.scale);
        let relative = self.values.map(|d| d / diagonal);
        Distances { mean, rms, p99, max, max_at: (self.max_at / frame.scale).to_array(), relative }
    }
}

/// The distances from `count` samples and all vertices of `from` to the surface in `to`.
pub(super) fn measure(
    from: &ScaledFaces,
    to: &ClosestTree<[DVec3; 3]>,
    count: usize,
    progress: &Progress,
) -> Result<Measured, Stopped> {
    let nearest = |p: DVec3| {
        to.nearest(p).map_or((f64::INFINITY, 0), |found| {
            (if found.distance <= from.rounding { 0.0 } else { found.distance }, found.id)
        })
    };
    let checked = |k: usize| if k.is_multiple_of(CHUNK) { progress.check() } else { Ok(()) };
    let found: Vec<(f64, DVec3, [u32; 2])> = from
        .samples(count)
        .enumerate()
        .map(|(k, (p, face))| {
            checked(k)?;
            let (distance, other) = nearest(p);
            Ok((distance, p, [face, other]))
        })
        .collect::<Result<_, Stopped>>()?;
    let at_vertices: Vec<f64> = from
        .vertices
        .par_iter()
        .enumerate()
        .map(|(k, &p)| checked(k).map(|()| nearest(p).0))
        .collect::<Result<_, Stopped>>()?;
    // Summed in order, so that the number of threads does not matter.
    let count = count as f64;
    let (sum, squares) = found.iter().fold((0.0, 0.0), |(sum, squares), (d, ..)| (sum + d, squares + d * d));
    let vertices = at_vertices.iter().copied().zip(from.vertices.iter().copied());
    let samples = found.iter().map(|&(d, p, _)| (d, p));
    let (max, max_at) = samples.chain(vertices).fold((0.0, None), |(max, at), (d, p)| match at {
        Some(_) if d <= max => (max, at),
        _ => (d, Some(p)),
    });
    let mut sorted: Vec<f64> = found.iter().map(|(d, ..)| *d).collect();
    sorted.par_sort_unstable_by(f64::total_cmp);
    let values = Relative { mean: sum / count, rms: (squares / count).sqrt(), p99: percentile(&sorted, 0.99), max };
    let distances = Scaled { values, max_at: max_at.unwrap_or(DVec3::ZERO) };
    Ok(Measured { distances, pairs: found.into_iter().map(|(.., pair)| pair).collect() })
}

/// The value below which `share` (0 to 1) of the ascending values lie, linear in between.
pub(super) fn percentile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    let at = share * last as f64;
    let low = at.floor() as usize;
    let (a, b) = (sorted[low], sorted[(low + 1).min(last)]);
    a + (b - a) * at.fract()
}
