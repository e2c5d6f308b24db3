//! Where triangles of a result come from.

use crate::survey::Soup;

/// Where a triangle of the result comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TriangleSource {
    /// It lies on a triangle of an operand.
    Operand {
        /// Number of the operand, from 0.
        operand: u32,
        /// Number of the triangle in it.
        triangle: u32,
    },
    /// It is one of the lid over a hole, made from the rim alone.
    Lid {
        /// Number of the operand, from 0.
        operand: u32,
        /// Number of the hole among those of the operand, from 1: see [`HoleReport::number`](super::HoleReport::number).
        hole: u32,
    },
    /// It closes a hole with surface made from voxels, or morphology has made it: no triangle of an operand is there.
    Closed,
}

impl TriangleSource {
    /// Whether no triangle of an operand is there.
    pub fn is_made_up(self) -> bool {
        !matches!(self, Self::Operand { .. })
    }

    /// Where a triangle of a soup comes from.
    pub(super) fn in_soup(soup: &Soup, triangle: u32) -> Self {
        match (soup.given(triangle), soup.hole(triangle)) {
            (Some((operand, triangle)), _) => Self::Operand { operand: operand as u32, triangle },
            (None, Some(hole)) => Self::Lid { operand: 0, hole },
            (None, None) => Self::Closed,
        }
    }

    /// The same of operand `operand`, which was the only one before.
    pub(super) fn of_operand(self, operand: u32) -> Self {
        match self {
            Self::Operand { triangle, .. } => Self::Operand { operand, triangle },
            Self::Lid { hole, .. } => Self::Lid { operand, hole },
            Self::Closed => Self::Closed,
        }
    }
}
