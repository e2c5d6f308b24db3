//! How large voxels are, and the lattices that they make.

use super::frame::Frame;
use crate::digits;
use crate::lattice::Lattice;
use crate::ldi::MAX_VOXELS;
use crate::mesh::{Bounds, TriMesh};

/// Coordinates beyond this cannot be meant, in any unit; their squares still fit an `f32`.
const LARGEST_COORDINATE: f64 = 1e15;
/// The voxel size must be this many times the spacing of `f32` numbers at the farthest coordinate.
const F32_STEPS: f64 = 64.0;

/// The most voxels along the longest side of a box: what the rays can number, less room around it.
pub const MAX_RESOLUTION: u32 = MAX_VOXELS as u32 - 16;

/// A voxel that is suggested is this much larger than the finest, so that it can be rounded to two digits and still be typed.
pub(super) const TYPED: f64 = 1.1;

/// The voxel size of a pipeline. There is no default: it decides what is kept.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VoxelSize {
    /// This many voxels along the longest side of the operands' common bounding box.
    Along(u32),
    /// This spacing, model units.
    Length(f64),
}

impl VoxelSize {
    /// The spacing, model units, for operands whose common bounding box has this longest side.
    pub fn spacing(self, longest: f64) -> f64 {
        match self {
            Self::Along(count) => longest / f64::from(count),
            Self::Length(h) => h,
        }
    }
}

/// Why there can be no lattice. Lengths are in model units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The voxel is no positive number.
    #[error("a voxel of {voxel} cannot be used; its size must be above zero")]
    NotPositive {
        /// The voxel that was asked for.
        voxel: f64,
    },
    /// The voxel is finer than rays can be numbered, or than single precision can tell apart at these coordinates.
    #[error(
        "a voxel of {} makes {} voxels along the longest side of the model ({}), and {} are possible: use a voxel of at least {}",
        digits::number(*voxel), digits::count((longest / voxel) as usize), digits::number(*longest),
        digits::count((longest / finest) as usize), digits::rounded_up(*finest)
    )]
    TooFine {
        /// The voxel that was asked for.
        voxel: f64,
        /// The longest side of the operands' box.
        longest: f64,
        /// The finest voxel that is possible.
        finest: f64,
    },
    /// The coordinates are out of all reason.
    #[error(
        "coordinates reach {farthest:.3e}, which cannot be meant in any unit: look for damaged vertices, or make the model smaller"
    )]
    TooFar {
        /// The largest coordinate.
        farthest: f64,
    },
    /// The band around the surface makes too many voxels.
    #[error(
        "a band of {band} around the mesh makes a lattice of {} voxels along a side, and at most {} are possible: \
         use a narrower band,{or} or a larger voxel",
        digits::number(*along), digits::count(MAX_VOXELS as usize)
    )]
    WideBand {
        /// The band in words: a length, or voxels.
        band: String,
        /// Voxels along the longest side.
        along: f64,
        /// Another thing to try, as a part of the sentence.
        or: &'static str,
    },
}

/// The finest voxel that a lattice around `bounds` can have, model units.
pub(super) fn finest(bounds: &Bounds) -> f64 {
    let near = Frame::around(bounds).local_bounds(bounds);
    let farthest = near.min.abs().max(near.max.abs()).max_element();
    let numbered = bounds.size().max_element() / f64::from(MAX_RESOLUTION);
    numbered.max(F32_STEPS * farthest * f64::from(f32::EPSILON))
}

/// The voxel spacing for operands in `bounds`, model units, or why it is none.
pub(super) fn spacing(bounds: &Bounds, voxel: VoxelSize) -> Result<f64, LatticeError> {
    let h = voxel.spacing(bounds.size().max_element());
    if h > 0.0 && h.is_finite() { Ok(h) } else { Err(LatticeError::NotPositive { voxel: h }) }
}

/// The lattice for operands in `bounds`, or why there is none.
pub(super) fn lattice(bounds: &Bounds, voxel: VoxelSize) -> Result<Lattice, LatticeError> {
    let longest = bounds.size().max_element();
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    if farthest > LARGEST_COORDINATE {
        return Err(LatticeError::TooFar { farthest });
    }
    let h = spacing(bounds, voxel)?;
    let finest = finest(bounds);
    // A resolution that is allowed must not fail by the rounding of its division.
    if h < finest * (1.0 - 1e-12) {
        return Err(LatticeError::TooFine { voxel: h, longest, finest });
    }
    Ok(Lattice::around(bounds, h))
}

/// The box around all operands; `Err` with the number of the first that has no triangles.
pub(super) fn bounds<'a>(operands: impl IntoIterator<Item = &'a TriMesh>) -> Result<Bounds, usize> {
    let mut all: Option<Bounds> = None;
    for (operand, mesh) in operands.into_iter().enumerate() {
        let bounds = mesh.bounds().ok_or(operand)?;
        all = Some(all.map_or(bounds, |all| all.union(&bounds)));
    }
    all.filter(|b| b.size().max_element() > 0.0).ok_or(0)
}
