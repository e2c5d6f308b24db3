//! From operands to a common soup on a lattice.

use rayon::prelude::*;

use super::frame::Frame;
use super::{Error, VoxelSize};
use crate::digits;
use crate::lattice::Lattice;
use crate::ldi::{Layers, MAX_VOXELS, Operands};
use crate::mesh::{Bounds, Plane, TriMesh};
use crate::orient::{OrientMode, OrientReport, clean, orient_patches, orient_sides};
use crate::progress::{Progress, Stopped};

/// Coordinates beyond this cannot be meant, in any unit; their squares still fit an `f32`.
const LARGEST_COORDINATE: f64 = 1e15;
/// The voxel size must be this many times the spacing of `f32` numbers at the farthest coordinate.
const F32_STEPS: f64 = 64.0;

/// The most voxels along the longest side of a box: what the rays can number, less room around it.
pub const MAX_RESOLUTION: u32 = MAX_VOXELS as u32 - 16;

/// A voxel that is suggested is this much larger than the finest, so that it can be rounded to two digits and still be typed.
pub(super) const TYPED: f64 = 1.1;

/// The finest voxel that a lattice around `bounds` can have, model units.
pub(super) fn finest(bounds: &Bounds) -> f64 {
    let near = Frame::around(bounds).local_bounds(bounds);
    let farthest = near.min.abs().max(near.max.abs()).max_element();
    let numbered = bounds.size().max_element() / f64::from(MAX_RESOLUTION);
    numbered.max(F32_STEPS * farthest * f64::from(f32::EPSILON))
}

/// The operands, cleaned, made consistent, and put one after another.
#[derive(Clone)]
pub(super) struct Soup {
    pub mesh: TriMesh,
    pub operands: Operands,
    /// Patch of each triangle; patches are numbered through all operands.
    pub patch_of: Vec<u32>,
    pub patch_count: usize,
    pub reports: Vec<OrientReport>,
    /// For each triangle, its number in the operand as given.
    pub source: Vec<u32>,
}

impl Soup {
    /// Lets the rays decide the side of each patch, and turns patches over in the crossings and in
    /// the soup.
    pub(super) fn turn_patches(
        &mut self,
        layers: &mut [Layers],
        mode: OrientMode,
        progress: &Progress,
    ) -> Result<(), Stopped> {
        if mode == OrientMode::Keep {
            return Ok(());
        }
        let turned = orient_sides(layers, &self.patch_of, self.patch_count, &self.operands, progress)?;
        let mut seen = vec![false; turned.len()];
        for (n, triangle) in self.mesh.triangles.iter_mut().enumerate() {
            let patch = self.patch_of[n] as usize;
            if turned[patch] {
                triangle.swap(1, 2);
                let report = &mut self.reports[self.operands.of(n as u32)];
                report.flipped_by_rays += 1;
                report.flipped_patches += !std::mem::replace(&mut seen[patch], true) as usize;
            }
        }
        Ok(())
    }

    /// The numbers that keep triangles apart, for the triangles of the soup; none when no operand has any.
    pub(super) fn classes(&self, of_operands: &[Vec<u32>]) -> Vec<u32> {
        if of_operands.iter().all(Vec::is_empty) {
            return Vec::new();
        }
        let class = |t: usize| {
            let given = of_operands.get(self.operands.of(t as u32));
            given.and_then(|list| list.get(self.source[t] as usize)).copied().unwrap_or(0)
        };
        (0..self.mesh.triangles.len()).map(class).collect()
    }

    /// The planes of the triangles, lattice coordinates.
    pub(super) fn planes(&self, lattice: &Lattice) -> Vec<Plane> {
        let corners = |t: usize| self.mesh.corners(t).map(|p| lattice.to_lattice(p));
        (0..self.mesh.triangles.len()).into_par_iter().map(|t| Plane::through(corners(t))).collect()
    }
}

/// Cleans and orients the patches of each operand.
pub(super) fn prepare(inputs: &[TriMesh], mode: OrientMode, progress: &Progress) -> Result<Soup, Error> {
    let mut soup = Soup {
        mesh: TriMesh::default(),
        operands: Operands::new([]),
        patch_of: Vec::new(),
        patch_count: 0,
        reports: Vec::new(),
        source: Vec::new(),
    };
    let mut counts = Vec::new();
    for (operand, input) in inputs.iter().enumerate() {
        progress.check()?;
        let mut cleaned = clean(input);
        progress.check()?;
        if cleaned.mesh.triangles.is_empty() {
            return Err(Error::Empty { operand });
        }
        let mut patches = orient_patches(&mut cleaned.mesh.triangles, &cleaned.unoriented, mode);
        counts.push(cleaned.mesh.triangles.len());
        soup.mesh.append(&cleaned.mesh);
        soup.source.append(&mut cleaned.source);
        soup.patch_of.extend(patches.of.drain(..).map(|patch| patch + soup.patch_count as u32));
        soup.patch_count += patches.count;
        soup.reports.push(OrientReport {
            degenerate_dropped: cleaned.degenerate,
            duplicates_dropped: cleaned.duplicates,
            both_sided: cleaned.both_sided,
            patches: patches.count,
            flipped_in_patches: patches.flipped,
            ..OrientReport::default()
        });
    }
    soup.operands = Operands::new(counts);
    Ok(soup)
}

/// The voxel spacing for operands in `bounds`, model units, or why it is none.
pub(super) fn spacing(bounds: &Bounds, voxel: VoxelSize) -> Result<f64, Error> {
    let h = voxel.spacing(bounds.size().max_element());
    if h > 0.0 && h.is_finite() {
        return Ok(h);
    }
    Err(Error::VoxelSize { reason: format!("a voxel of {h} cannot be used; its size must be above zero") })
}

/// The lattice for operands in `bounds`, or why there is none.
pub(super) fn lattice(bounds: &Bounds, voxel: VoxelSize) -> Result<Lattice, Error> {
    let longest = bounds.size().max_element();
    let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
    let refuse = |reason: String| Err(Error::VoxelSize { reason });
    if farthest > LARGEST_COORDINATE {
        return refuse(format!(
            "coordinates reach {farthest:.3e}, which cannot be meant in any unit: \
             look for damaged vertices, or make the model smaller"
        ));
    }
    let h = spacing(bounds, voxel)?;
    let finest = finest(bounds);
    // A resolution that is allowed must not fail by the rounding of its division.
    if h < finest * (1.0 - 1e-12) {
        let (asked, least) = (digits::number(h), digits::rounded_up(finest));
        let [sides, most] = [longest / h, longest / finest].map(|count| digits::count(count as usize));
        return refuse(format!(
            "a voxel of {asked} makes {sides} voxels along the longest side of the model ({}), and {most} are possible: \
             use a voxel of at least {least}",
            digits::number(longest),
        ));
    }
    Ok(Lattice::around(bounds, h))
}

/// The box around all operands.
pub(super) fn bounds(inputs: &[TriMesh]) -> Result<Bounds, Error> {
    let mut all: Option<Bounds> = None;
    for (operand, input) in inputs.iter().enumerate() {
        let bounds = input.bounds().ok_or(Error::Empty { operand })?;
        all = Some(all.map_or(bounds, |all| all.union(&bounds)));
    }
    all.filter(|b| b.size().max_element() > 0.0).ok_or(Error::Empty { operand: 0 })
}
