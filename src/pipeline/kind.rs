//! What became of a surface: which triangles of a result are the input's, which are made anew, and which are made up.

use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

use super::{Operand, Outcome, TriangleSource};
use crate::mesh::TriMesh;

/// What a triangle of a result is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TriangleKind {
    /// A triangle of an operand, with the same three corners.
    Kept,
    /// It lies on the surface of an operand, but is made anew: cut, moved, simplified, or from voxels.
    Rebuilt,
    /// No surface of an operand is there.
    MadeUp,
}

impl TriangleKind {
    /// Every kind; its place here is its number in a map.
    pub const ALL: [Self; 3] = [Self::Kept, Self::Rebuilt, Self::MadeUp];

    /// The word for it, the same in summaries, legends and reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Rebuilt => "rebuilt",
            Self::MadeUp => "made up",
        }
    }
}

/// How many triangles of a result are of each kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TriangleCounts {
    /// Triangles of operands, with the same corners.
    pub kept: usize,
    /// Triangles on the surface of operands, but made anew.
    pub rebuilt: usize,
    /// Triangles where no operand has a surface.
    pub made_up: usize,
}

impl TriangleCounts {
    /// The numbers of each of these kinds.
    pub fn of(kinds: &[TriangleKind]) -> Self {
        let [kept, rebuilt, made_up] = TriangleKind::ALL.map(|kind| kinds.iter().filter(|k| **k == kind).count());
        Self { kept, rebuilt, made_up }
    }

    /// How many are of a kind.
    pub fn count(&self, kind: TriangleKind) -> usize {
        match kind {
            TriangleKind::Kept => self.kept,
            TriangleKind::Rebuilt => self.rebuilt,
            TriangleKind::MadeUp => self.made_up,
        }
    }
}

/// The kind of each triangle of a result, told by its corners and those of the operand's triangle that it lies on. Corners are the same also
/// after rounding to single precision, and when the triangle was turned over.
pub fn kinds<'a>(outcome: &Outcome, operands: impl IntoIterator<Item: Into<Operand<'a>>>) -> Vec<TriangleKind> {
    let operands: Vec<&TriMesh> = operands.into_iter().map(|operand| operand.into().mesh).collect();
    kinds_of(&outcome.solid, &outcome.sources, &operands)
}

/// The same of a result that is not judged yet.
pub(super) fn kinds_of(mesh: &TriMesh, sources: &[TriangleSource], operands: &[&TriMesh]) -> Vec<TriangleKind> {
    let kind = |(t, source): (usize, &TriangleSource)| match *source {
        TriangleSource::Closed => TriangleKind::MadeUp,
        TriangleSource::Operand { operand, triangle } => match own(operands, operand, triangle) {
            Some(own) if same(mesh.corners(t), own).is_some() => TriangleKind::Kept,
            _ => TriangleKind::Rebuilt,
        },
    };
    sources.par_iter().enumerate().map(kind).collect()
}

fn own(operands: &[&TriMesh], operand: u32, triangle: u32) -> Option<[DVec3; 3]> {
    let mesh = operands.get(operand as usize)?;
    ((triangle as usize) < mesh.triangles.len()).then(|| mesh.corners(triangle as usize))
}

/// For each corner of `made` the number of the corner of `own` at the same place, if there is a different one for each.
pub(super) fn same(made: [DVec3; 3], own: [DVec3; 3]) -> Option<[usize; 3]> {
    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    ORDERS.into_iter().find(|order| (0..3).all(|k| is_at(made[k], own[order[k]])))
}

/// Whether `made` is `own`, or that in single precision.
fn is_at(made: DVec3, own: DVec3) -> bool {
    // Half a step of single precision.
    const HALF_STEP: f64 = 1.0 / (1u32 << 24) as f64;
    made == own || (made - own).abs().cmple(own.abs() * HALF_STEP).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_the_same_in_any_order_and_in_single_precision() {
        let own = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.7, 0.0, -3.3), DVec3::new(5.0, 1e-9, 0.7)];
        for order in [[0, 1, 2], [1, 2, 0], [0, 2, 1]] {
            assert_eq!(same(order.map(|k| own[k]), own), Some(order));
            assert_eq!(same(order.map(|k| own[k].as_vec3().as_dvec3()), own), Some(order));
        }
        assert_eq!(same([own[0], own[1], own[1]], own), None);
        assert_eq!(same([own[0], own[1], own[2] * (1.0 + 1e-6)], own), None);
    }
}
