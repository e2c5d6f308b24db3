//! The convolution filter that keeps the surface (Sanchez et al. 2015 §4, §5).
//!
//! g(p) = ∫ f(p − s h(p)) w(s) ds with a kernel w whose size h(p) is 0 on the surface and 1 from the distance f_c on: the zero
//! level stays exactly, and elsewhere creases of the distance go. With the bump kernel and b ≤ 8 f_c / 9 no sample lies beyond
//! the surface (7), so that no other zero level can arise.

mod around;
mod convolved;
mod kernel;
mod local;
mod stored;
mod tile;

use std::sync::Arc;

use around::Around;
use convolved::Filtered;
pub(in crate::field) use kernel::uniform;
pub use kernel::{Kernel, Sampling};
pub use local::{SmoothOptions, smooth};
use stored::Stored;

use super::Shared;

/// The bump's width over the cap must not be more (7).
pub const WIDEST: f64 = 8.0 / 9.0;

/// Options of [`filtered`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilterOptions {
    /// The paper's f_c, model units, more than 0: from this distance on the kernel has its full size.
    pub cap: f64,
    /// The kernel.
    pub kernel: Kernel,
    /// Where the field is sampled.
    pub sampling: Sampling,
    /// Whether fewer samples are taken where they are enough, for drawn ones.
    pub adaptive: Option<Adaptive>,
    /// Whether the unsigned distance is filtered and the sign put back (§4.3): it allows any kernel without other zero
    /// levels, but makes creases of its own where the kernel reaches beyond the surface.
    pub sign_safe: bool,
    /// Where the values of the field at the samples come from.
    pub distances: Distances,
}

/// Where a filter has the values from that it takes the mean of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Distances {
    /// The field is asked for each sample.
    Asked,
    /// Farther from the surface than half of the cap, values are interpolated between the points of a lattice, if the
    /// field has a quick way to tell them there ([`Field::over`](super::Field::over)); nearer, and where it has none, it is
    /// asked for each sample, so that the surface stays where it is. For fields over a lattice: at few scattered points,
    /// [`Distances::Asked`] is quicker.
    Interpolated {
        /// Cells along the cap, at least 1. With 24 the filtered value is within a thousandth of the cap of that by
        /// [`Distances::Asked`] (docs/accuracy.md); twice as many quarter the error.
        cells: u32,
        /// Bytes of memory for the values. Where they do not suffice, values are found again: that takes time and changes
        /// nothing else.
        memory: u64,
    },
}

impl Default for Distances {
    /// 24 cells and 256 MiB.
    fn default() -> Self {
        Self::interpolated(24)
    }
}

impl Distances {
    /// With so many cells along the cap and 256 MiB; asked for where there are none.
    pub fn interpolated(cells: u32) -> Self {
        if cells == 0 { Self::Asked } else { Self::Interpolated { cells, memory: 256 << 20 } }
    }
}

impl FilterOptions {
    /// The widest bump that keeps the zero level for this cap (model units), 64 samples, as many everywhere, distances
    /// interpolated.
    pub fn new(cap: f64) -> Self {
        let sampling = Sampling::Drawn { count: 64, seed: 0, mirrored: true };
        Self {
            cap,
            kernel: Kernel::Bump { width: WIDEST * cap },
            sampling,
            adaptive: None,
            sign_safe: false,
            distances: Distances::default(),
        }
    }
}

/// How the number of samples follows the need (§5.2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adaptive {
    /// Samples where neither the surface nor the medial axis is near, at least 2; at most all there are.
    pub least: usize,
}

/// Why a field cannot be filtered.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// A length is not positive.
    #[error("a filter with a cap of {cap} and a kernel {width} wide is none: both must be positive lengths")]
    Size {
        /// The cap, model units.
        cap: f64,
        /// The width, model units.
        width: f64,
    },
    /// The kernel could reach beyond the surface.
    #[error("a kernel {width} wide reaches beyond the surface under a cap of {cap}, and could make surfaces of its own: \
        a width of at most {most}, or a cap of at least {least}", most = WIDEST * cap, least = width / WIDEST)]
    Wide {
        /// The width, model units.
        width: f64,
        /// The cap, model units.
        cap: f64,
    },
    /// The Gaussian has no end.
    #[error(
        "a Gaussian kernel has no end and could make surfaces of its own: the bump kernel, or the sign-safe filter"
    )]
    Endless,
    /// There are no cells to interpolate in.
    #[error("distances cannot be interpolated in no cells along the cap: at least 1, or ask for each")]
    Cells,
}

/// `field` filtered: the same zero level, smooth elsewhere.
///
/// # Errors
/// See [`FilterError`].
pub fn filtered(field: Shared, options: &FilterOptions) -> Result<Shared, FilterError> {
    let (cap, width) = (options.cap, options.kernel.width());
    if !(cap > 0.0 && width > 0.0 && cap.is_finite() && width.is_finite()) {
        return Err(FilterError::Size { cap, width });
    }
    match options.kernel {
        _ if options.sign_safe => {}
        Kernel::Gaussian { .. } => return Err(FilterError::Endless),
        Kernel::Bump { width } if width > WIDEST * cap * (1.0 + 1e-12) => return Err(FilterError::Wide { width, cap }),
        Kernel::Bump { .. } => {}
    }
    let stored = match options.distances {
        Distances::Asked => None,
        Distances::Interpolated { cells: 0, .. } => return Err(FilterError::Cells),
        Distances::Interpolated { cells, memory } => Stored::new(&field, cap / f64::from(cells), memory),
    };
    Ok(Arc::new(Filtered { inner: field, stored, around: Around::new(options), cap, sign_safe: options.sign_safe }))
}

/// 3 t² − 2 t³ between 0 and 1 (4), and how it grows.
fn smoothstep(t: f64) -> (f64, f64) {
    let t = t.clamp(0.0, 1.0);
    (t * t * (3.0 - 2.0 * t), 6.0 * t * (1.0 - t))
}
