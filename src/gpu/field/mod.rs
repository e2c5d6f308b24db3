//! The exact signed distance over a lattice, by compute passes: the twin on the graphics processor of [`crate::sdf::exact`].
//!
//! Features (faces, edges and vertices, each with the half-spaces of its region) are sorted into blocks of voxels, which are halved down to
//! blocks of 4³. On every level a workgroup a block finds which of its features can be nearest in which of its eight children: counted, scanned and
//! scattered on the device, so that the main processor only learns how many there are. A workgroup a block then measures what is left at its 64
//! voxels, and the bricks come down while the next part of the lattice is on its way.

mod bricks;
mod levels;
mod region;
mod rows;

use std::sync::{Arc, Mutex, PoisonError};

use super::run::Run;
use super::{Device, GpuError, GpuMethod, GpuReport};
use crate::lattice::{BRICK_VOXELS, DistanceField, Lattice};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use crate::sdf::exact::{self, ExactOptions, Features, Filled, Scope, Sign};
use bricks::{Counts, OnTheirWay};
use levels::{Descent, Found, Loaded};
use region::Region;
use rows::{Picked, Placed};

/// Limits below those of the adapter, of what is worked on at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FieldLimits {
    /// Bricks of 8³ voxels.
    pub bricks: u64,
    /// Numbers of features in the lists of all blocks of a level.
    pub entries: u64,
    /// Words of a buffer.
    pub words: u64,
}

impl Default for FieldLimits {
    /// Two to the power of 15, 26 and 31: parts of 64 MB to send back, lists of 256 MB, and what the adapter can.
    fn default() -> Self {
        Self { bricks: 1 << 15, entries: 1 << 26, words: 1 << 31 }
    }
}

impl FieldLimits {
    /// These, or those of the adapter where they are lower.
    fn of(self, device: &Device) -> Self {
        let entry = device.entry();
        let words = (entry.binding_bytes.min(entry.buffer_bytes) / 4).min(self.words);
        // Beside the values there are the places of the bricks and the times.
        let bricks = (entry.buffer_bytes / 4).min(words) / (BRICK_VOXELS as u64 + 64);
        Self { bricks: self.bricks.min(bricks), entries: self.entries.min(words), words }
    }
}

/// Options of [`distances`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct FieldOptions {
    /// Limits below those of the adapter.
    pub limits: FieldLimits,
    /// Whether passes are timed, where the adapter can.
    pub timings: bool,
}

/// A field, and how it came about.
#[derive(Debug, Clone)]
pub struct GpuField {
    /// The signed distance, in h.
    pub field: DistanceField,
    /// What was moved, and how long it took.
    pub report: GpuReport,
    /// Voxels within the band.
    pub measured: u64,
    /// Voxels of these whose side single precision does not tell, so that the main processor measured them again.
    pub doubtful: u64,
}

/// The signed distance to `mesh` at the voxels of `lattice`, counted in voxels, negative inside: what [`crate::sdf::exact::exact`] gives, to 1e-4 h
/// and 5e-7 of the distance, with the same sides. The same device gives the same bits each time. The device holds the features and
/// one part of the lattice at a time, as its buffers and `limits` allow.
///
/// # Errors
/// [`GpuError::Far`] where a part of the mesh is too far from the lattice, [`GpuError::Crowded`] where the features of one brick are more than a
/// buffer holds, [`GpuError::Field`] where there is no such field, and what the device reports.
pub fn distances(
    device: &Device,
    mesh: &TriMesh,
    lattice: &Lattice,
    sign: Sign<'_>,
    (exact, options): (&ExactOptions, &FieldOptions),
    progress: &Progress,
) -> Result<GpuField, GpuError> {
    device.check_can(GpuMethod::Scatter)?;
    let cost = exact::cost(mesh, lattice, exact.band);
    let limits = options.limits.of(device);
    let staging = 4 * cost.voxels.min(2 * BRICK_VOXELS as u64 * limits.bricks);
    let mut run = Run::new(device, options.timings, progress);
    let counts = Counts::default();
    let field = exact::whole(mesh, lattice, sign, exact, cost.memory + staging, progress, |scope| {
        let features = Features::of(mesh, lattice, scope.band);
        progress.check()?;
        let work = Work { features: &features, scope, limits, parts: parts(cost.voxels), counts: &counts };
        work.bricks(&mut run)
    })?;
    let report = run.report();
    let [measured, doubtful] = [counts.measured, counts.doubtful].map(std::sync::atomic::AtomicU64::into_inner);
    Ok(GpuField { field, report, measured, doubtful })
}

/// In how many parts a field of so many voxels is made, so that one is read while the next is made.
fn parts(voxels: u64) -> usize {
    const VOXELS: u64 = 4 << 20;
    const MOST: u64 = 16;
    voxels.div_ceil(VOXELS).clamp(1, MOST) as usize
}

/// A job, as all its parts share it.
struct Work<'a> {
    features: &'a Features,
    scope: &'a Scope,
    limits: FieldLimits,
    parts: usize,
    counts: &'a Counts,
}

impl Work<'_> {
    /// All bricks that have voxels in the band.
    fn bricks(&self, run: &mut Run<'_>) -> Result<Vec<Filled>, GpuError> {
        let placed = Placed::new(self.features, self.scope)?;
        let mut rest = vec![Region::whole(self.scope)];
        let mut filled = Vec::new();
        while let Some(region) = rest.pop() {
            let picked = placed.pick(&region);
            if picked.len() == 0 {
                continue;
            }
            let [.., rows] = picked.rows();
            if 4 * rows as u64 > self.limits.words {
                rest.extend(region.halves().ok_or_else(|| self.crowded(picked.len() as u64))?);
                continue;
            }
            let loaded = Loaded::new(run, &placed, &picked, self.scope);
            filled.extend(self.of_region(run, &loaded, region, &Arc::new(picked))?);
        }
        Ok(filled)
    }

    fn crowded(&self, features: u64) -> GpuError {
        GpuError::Crowded { features, most: self.limits.entries }
    }

    /// The bricks of a region whose features are on the device. The processor takes over those of one part while the device measures the next.
    fn of_region(
        &self,
        run: &mut Run<'_>,
        loaded: &Loaded,
        region: Region,
        picked: &Arc<Picked>,
    ) -> Result<Vec<Filled>, GpuError> {
        let programs = run.device.field();
        let found = Mutex::new(Vec::new());
        let found = &found;
        rayon::in_place_scope(|scope| {
            let take = |run: &mut Run<'_>, sent: OnTheirWay| {
                let arrived = sent.take(run, programs, picked)?;
                let (features, counts) = (self.features, self.counts);
                scope.spawn(move |_| {
                    let bricks = arrived.filled(features, counts);
                    found.lock().unwrap_or_else(PoisonError::into_inner).extend(bricks);
                });
                Ok::<(), GpuError>(())
            };
            let mut rest = region.parts(self.parts);
            let mut before: Option<OnTheirWay> = None;
            while let Some(region) = rest.pop() {
                let descent = Descent { programs, loaded, region, limits: self.limits };
                let octants = match descent.bricks(run)? {
                    Found::Fits(bricks) if bricks.count == 0 => continue,
                    Found::Fits(bricks) => match descent.octants(run, &bricks)? {
                        Found::Fits(octants) => Some((bricks, octants)),
                        Found::TooMuch => None,
                    },
                    Found::TooMuch => None,
                };
                let Some((bricks, octants)) = octants else {
                    rest.extend(region.halves().ok_or_else(|| self.crowded(picked.len() as u64))?);
                    continue;
                };
                let sent = descent.measure(run, &bricks, octants)?;
                // Finding these bricks has waited for all that was sent before.
                if let Some(before) = before.replace(sent) {
                    take(run, before)?;
                }
            }
            if let Some(last) = before {
                run.device.wait()?;
                take(run, last)?;
            }
            Ok::<(), GpuError>(())
        })?;
        Ok(std::mem::take(&mut *found.lock().unwrap_or_else(PoisonError::into_inner)))
    }
}
