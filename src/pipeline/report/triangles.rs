//! What became of triangles and surfaces.

use serde::{Deserialize, Serialize};

/// Shells of the operands that stayed as they are, without any voxel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StandingReport {
    /// Shells that are part of the result as they are.
    pub shells: usize,
    /// Their triangles.
    pub triangles: usize,
    /// Shells that were left out because both of their sides lie inside the result, or both outside.
    pub left_out: usize,
    /// Shells that were inside out and were turned over.
    pub turned: usize,
}

/// What a triangle of a result is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TriangleKind {
    /// A triangle of an operand, with the same three corners.
    Kept,
    /// It lies on the surface of an operand, but is made anew: moved, simplified, or from voxels.
    Rebuilt,
    /// No surface of an operand is there.
    MadeUp,
    /// It lies in the plane of a triangle of an operand, and has other corners: a piece of it, or of several in one plane.
    Cut,
}

impl TriangleKind {
    /// Every kind; its place here is its number in a map.
    pub const ALL: [Self; 4] = [Self::Kept, Self::Rebuilt, Self::MadeUp, Self::Cut];

    /// Every kind, from what is least changed to what is most.
    pub const BY_CHANGE: [Self; 4] = [Self::Kept, Self::Cut, Self::Rebuilt, Self::MadeUp];

    /// The word for it, the same in summaries, legends and reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Rebuilt => "rebuilt",
            Self::MadeUp => "made up",
            Self::Cut => "cut",
        }
    }
}

/// How many triangles of a result are of each kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriangleCounts {
    /// Triangles of operands, with the same corners.
    pub kept: usize,
    /// Triangles in the planes of operands' triangles, with other corners.
    pub cut: usize,
    /// Triangles on the surface of operands, but made anew.
    pub rebuilt: usize,
    /// Triangles where no operand has a surface.
    pub made_up: usize,
}

impl TriangleCounts {
    /// The numbers of each of these kinds.
    pub fn of(kinds: &[TriangleKind]) -> Self {
        let [kept, rebuilt, made_up, cut] = TriangleKind::ALL.map(|kind| kinds.iter().filter(|k| **k == kind).count());
        Self { kept, cut, rebuilt, made_up }
    }

    /// How many are of a kind.
    pub fn count(&self, kind: TriangleKind) -> usize {
        match kind {
            TriangleKind::Kept => self.kept,
            TriangleKind::Cut => self.cut,
            TriangleKind::Rebuilt => self.rebuilt,
            TriangleKind::MadeUp => self.made_up,
        }
    }
}

/// Closed surfaces that were dropped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Dropped {
    /// How many.
    pub surfaces: usize,
    /// Their triangles.
    pub triangles: usize,
    /// What they enclosed, together, cubic model units.
    pub volume: f64,
}

impl Dropped {
    /// Both together.
    pub fn and(self, other: Self) -> Self {
        Self {
            surfaces: self.surfaces + other.surfaces,
            triangles: self.triangles + other.triangles,
            volume: self.volume + other.volume,
        }
    }
}
