//! Sharp edges back, few triangles, and a guarantee: the contour's surface is fitted to the facets of its
//! source.
//!
//! The vertices of the contour lie on source triangles already; what a lattice rounds off is what
//! lies between them. Where two neighbours lie on different smooth pieces, the crease between them is known
//! exactly: it is where the planes of their facets meet (Bærentzen §5 after Hoppe 1993 moves all vertices
//! by least squares towards points; here few vertices move, and each to where it belongs).
//!
//! [`fit`] first puts source triangles that bound the solid as they are in the contour's place (`keep`). What is left
//! of the contour is fitted: it moves vertices beside a crease onto it (`snap`), cuts the triangles that reach over one
//! (`cut`), mends what that turned over (`mend`), takes back what made the surface meet itself
//! (`safeguard`, `fitting`), and collapses what is flat (`simplify`). Every step leaves a valid surface.

mod crease;
mod cut;
mod deviation;
mod facets;
mod fitting;
mod keep;
mod mend;
mod quadric;
mod safeguard;
mod sharpen;
mod simplify;
mod snap;
mod source;
mod surface;
mod zone;

pub use facets::{Beyond, FacetId, Facets, Side, Sides, TargetDistance};
pub use keep::{Kept, Seams};
pub use source::{SimpleSource, simplified_source};
pub use surface::Surface;
pub(crate) use surface::rounded;

use crate::progress::{Progress, Stopped};
use sharpen::Sharp;
use simplify::Simple;

/// Options of [`fit`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Whether all of the surface is built anew from the contour; else source triangles that bound the solid as they are stay as
    /// they are.
    pub rebuild: bool,
    /// A bend of less than 20° that lies nearer to the surface than this, h, is left out. Fandisk at 256: 0.02
    /// gives a mean error of 0.00048 h, 0.015 of 0.00045; on the bunny 0.012 takes twice the time.
    pub sag: f64,
    /// How far simplification may take the surface away, h; 0 keeps all triangles. Fandisk at 256: 0.002 leaves
    /// 73,000 triangles, 0.003 64,000 with a mean error 0.00003 h larger.
    pub simplify: f64,
    /// How far simplification may take vertices of the source away that were kept, h; 0 keeps all of them.
    pub simplify_kept: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self { rebuild: false, sag: 0.02, simplify: 0.002, simplify_kept: 0.0 }
    }
}

/// What [`fit`] did.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FitReport {
    /// Triangles of the source that were kept as they are, before simplification.
    pub kept: usize,
    /// Triangles that the source has, after cleaning.
    pub of: usize,
    /// Vertices moved onto a crease or corner.
    pub moved: usize,
    /// Points inserted on creases.
    pub inserted: usize,
    /// Triangles of the contour over a crease that was left rounded, because the surface would have met itself.
    pub given_up: usize,
}

/// Places given up are tried again when they are fewer than one in so many: on parts that brings back
/// all but a few, on scans it costs a third of the time for nothing measurable.
const WORTH_RETRYING: usize = 100;

/// Fits a surface to its facets: creases and corners come back, and what is flat gets few triangles.
/// `kept` are triangles of the source that may take the contour's place; `h` is the voxel spacing, model units. `initial` must be a valid solid with coordinates in `f32`; the result
/// is one, too, and `initial` itself if nothing else can be.
pub fn fit(
    initial: &Surface,
    facets: &Facets<'_>,
    kept: &Kept,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<(Surface, FitReport), Stopped> {
    if !options.rebuild {
        let (joined, kept) = keep::keep(initial, facets, kept, h, progress)?;
        if kept == 0 && facets.has_beyond() {
            // A part without the rest is nothing that a fit would help.
            return Ok((joined, FitReport { of: facets.triangles(), ..FitReport::default() }));
        }
        if let Some((surface, report)) = refined(&joined, facets, h, options, progress)? {
            return Ok((surface, FitReport { kept, of: facets.triangles(), ..report }));
        }
    }
    let all = initial.mesh.triangles.len();
    let as_it_was = || (initial.clone(), FitReport { given_up: all, ..FitReport::default() });
    let (surface, report) = refined(initial, facets, h, options, progress)?.unwrap_or_else(as_it_was);
    Ok((surface, FitReport { of: facets.triangles(), ..report }))
}

/// Creases put back and flat parts simplified; `None` when the surface is then no valid solid.
fn refined(
    initial: &Surface,
    facets: &Facets<'_>,
    h: f64,
    options: &FitOptions,
    progress: &Progress,
) -> Result<Option<(Surface, FitReport)>, Stopped> {
    let Sharp { surface, mut report, .. } = sharpen::sharpen(initial, facets, h, options, progress)?;
    let untouched = vec![0.0; surface.mesh.triangles.len()];
    let simple = simplify::simplified((&surface, &untouched), facets, h, options, progress)?;
    let Some(Simple { mut surface, off, .. }) = simple else { return Ok(None) };
    if report.given_up > 0 && report.given_up * WORTH_RETRYING < report.inserted + report.moved {
        // Simplification has cleared away what was in the way.
        let again = FitOptions { sag: f64::INFINITY, ..*options };
        let sharper = sharpen::sharpen(&surface, facets, h, &again, progress)?;
        let more = sharper.report;
        let off: Vec<f32> = sharper.origin.iter().map(|&t| off[t as usize]).collect();
        if more.inserted + more.moved > 0
            && let Some(simple) = simplify::simplified((&sharper.surface, &off), facets, h, options, progress)?
        {
            surface = simple.surface;
            report = FitReport {
                moved: report.moved + more.moved,
                inserted: report.inserted + more.inserted,
                given_up: more.given_up,
                ..report
            };
        }
    }
    Ok(Some((surface, report)))
}
