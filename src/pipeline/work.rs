//! How much there is to do, and how long each stage of it may take.

use super::plan::Input;
use super::{LatticeError, Options, StageTime, sizing};
use crate::fit::FitOptions;
use crate::mesh::TriMesh;
use crate::progress::Stage;

/// Seconds per triangle of the input. Like all that follows for one core, measured on the Stanford bunny at 256 voxels; a bar that
/// shows how far a run is needs their ratios only.
const PER_TRIANGLE: [(Stage, f64); 3] = [(Stage::Orient, 0.4e-6), (Stage::Shells, 0.4e-6), (Stage::Arrange, 0.8e-6)];
/// Seconds per cell of surface.
const PER_CELL: [(Stage, f64); 6] = [
    (Stage::Ldi, 0.39e-6),
    (Stage::Spans, 0.07e-6),
    (Stage::Vote, 0.72e-6),
    (Stage::Sdf, 0.53e-6),
    (Stage::Contour, 0.33e-6),
    (Stage::Collapse, 0.79e-6),
];
/// The same of the fit: where triangles are kept, and where the surface is built anew.
const FIT: [f64; 2] = [2.5e-6, 14e-6];
/// Triangles of a surface that is built anew, per cell.
const MADE: f64 = 2.2;

/// What the time of a run depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Work {
    /// Triangles of the operands.
    pub triangles: usize,
    /// Their surface, in squares of the voxel.
    pub cells: f64,
}

impl Work {
    /// Of a run over `operands`; a look at sizes only, which costs next to nothing.
    ///
    /// # Errors
    /// [`LatticeError`]: there is no lattice with this voxel.
    pub fn of(operands: &[&TriMesh], options: &Options) -> Result<Self, LatticeError> {
        let triangles = operands.iter().map(|mesh| mesh.triangles.len()).sum();
        let Some(bounds) = operands.iter().filter_map(|mesh| mesh.bounds()).reduce(|a, b| a.union(&b)) else {
            return Ok(Self { triangles, cells: 0.0 });
        };
        let lattice = sizing::lattice(&bounds, options.voxel)?;
        Ok(Self { triangles, cells: Input::of(operands).cells(&lattice) })
    }

    /// The stages that make a solid, in order, with the seconds that each may take.
    pub fn stages(&self, fit: Option<&FitOptions>) -> Vec<StageTime> {
        let of = |rates: &[(Stage, f64)], count: f64| -> Vec<StageTime> {
            rates.iter().map(|&(stage, rate)| StageTime { stage, seconds: rate * count }).collect()
        };
        let fit = fit.map(|fit| StageTime { stage: Stage::Fit, seconds: FIT[usize::from(fit.rebuild)] * self.cells });
        of(&PER_TRIANGLE, self.triangles as f64).into_iter().chain(of(&PER_CELL, self.cells)).chain(fit).collect()
    }

    /// About how many triangles the result has.
    pub fn made(&self, fit: Option<&FitOptions>) -> f64 {
        if fit.is_some_and(|fit| !fit.rebuild) { self.triangles as f64 } else { MADE * self.cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::VoxelSize;

    #[test]
    fn more_triangles_and_smaller_voxels_take_longer_and_a_fit_is_a_stage() {
        let tetrahedron = TriMesh {
            positions: [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(glam::DVec3::from_array)
                .to_vec(),
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        };
        let operands = [&tetrahedron];
        let work = |n| Work::of(&operands, &Options::new(VoxelSize::Along(n))).expect("a lattice");
        let seconds = |work: Work, fit: Option<&FitOptions>| work.stages(fit).iter().map(|s| s.seconds).sum::<f64>();
        let (keeping, rebuilding) = (FitOptions::default(), FitOptions { rebuild: true, ..FitOptions::default() });
        let rising = [
            seconds(work(16), None),
            seconds(work(64), None),
            seconds(work(64), Some(&keeping)),
            seconds(work(64), Some(&rebuilding)),
            seconds(Work { triangles: 1_000_000, ..work(64) }, Some(&rebuilding)),
        ];
        assert!(rising.is_sorted_by(|a, b| a < b), "{rising:?}");
        assert_eq!(work(64).stages(Some(&keeping)).last().map(|time| time.stage), Some(Stage::Fit));
        assert!(work(64).stages(None).iter().all(|time| time.stage != Stage::Fit));
        assert_eq!(work(16).made(Some(&keeping)), 4.0);
        assert!(work(64).made(None) > 100.0);
    }
}
