//! Why a result has no inside.

use serde::Serialize;

use super::ThinReport;
use crate::digits;

/// Why nothing is enclosed. The sentence of each says what to try. Lengths are in model units.
#[derive(Debug, Clone, PartialEq, Serialize, thiserror::Error)]
#[serde(tag = "reason", rename_all = "kebab-case")]
pub enum NothingEnclosed {
    /// Nearly all rays meet open sheets, and voting would fill the volume with noise.
    #[error("the surface encloses nothing: {:.0} % of the rays that meet it pass an open sheet; close or thicken it first", 100.0 * share)]
    Scattered {
        /// Their share of the rays that meet anything, 0 to 1.
        share: f64,
    },
    /// Most rays meet open sheets.
    #[error("the surface encloses nothing: most rays that meet it pass an open sheet; close or thicken it first")]
    OpenSheet,
    /// Walls are there, but no voxel lies in them.
    #[error("no voxel lies inside: the walls are thinner than a voxel of {}{}", digits::number(*voxel), keeping_voxel(thin))]
    ThinnerThanVoxel {
        /// The voxel.
        voxel: f64,
        /// How thin the walls are.
        thin: ThinReport,
    },
    /// Nothing is inside by any measure.
    #[error("the surface encloses nothing")]
    Nothing,
    /// The expression leaves nothing of the operands.
    #[error("the result is empty: the operands have no such part in common")]
    NoCommonPart,
    /// Every surface encloses less than the caller wants.
    #[error(
        "all {surfaces} closed surfaces enclose less than {least}, the largest {largest}; a smaller limit leaves something"
    )]
    AllSmaller {
        /// How many there are.
        surfaces: usize,
        /// The limit, cubic model units.
        least: f64,
        /// What the largest encloses.
        largest: f64,
    },
}

/// The voxel that would hold thin walls, as the end of a sentence.
pub(super) fn keeping_voxel(thin: &ThinReport) -> String {
    match (thin.thinnest, thin.voxel_that_keeps) {
        (Some(thinnest), Some(voxel)) => {
            let [thinnest, voxel] = [digits::number(thinnest), digits::rounded_down(voxel)];
            format!("; the thinnest 1 % are at most {thinnest} thick: a voxel of {voxel} would hold them")
        }
        (Some(thinnest), None) if thin.thin_spans > 0 => {
            format!("; the thinnest 1 % are at most {} thick, too thin for any voxel", digits::number(thinnest))
        }
        _ => String::new(),
    }
}
