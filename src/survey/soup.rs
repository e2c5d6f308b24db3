//! From operands to one soup: cleaned, oriented patch by patch, one operand after another.

use rayon::prelude::*;

use crate::lattice::Lattice;
use crate::ldi::{Inside, Layers, Operands};
use crate::mesh::{Plane, TriMesh};
use crate::orient::{OrientMode, OrientReport, PatchId, clean, orient_patches, orient_sides};
use crate::progress::{Progress, Stopped};

/// The operands, cleaned, made consistent within each patch, and put one after another. Model units.
#[derive(Debug, Clone)]
pub struct Soup {
    /// All triangles.
    pub mesh: TriMesh,
    /// Which triangles belong to which operand.
    pub operands: Operands,
    /// The patch of each triangle; patches are numbered through all operands.
    pub patch_of: Vec<PatchId>,
    /// The number of patches.
    pub patch_count: usize,
    /// What cleaning and orientation did, for each operand.
    pub reports: Vec<OrientReport>,
    /// The number of each triangle in its operand as given.
    pub source: Vec<u32>,
}

/// Why there is no soup.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SoupError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// An operand has no triangles with area.
    #[error("operand {operand} has no triangle with an area")]
    Empty {
        /// Number of the operand, from 0.
        operand: usize,
    },
}

impl Soup {
    /// Cleans the operands and orients their patches; which side of a patch is outside is open still.
    ///
    /// # Errors
    /// [`SoupError::Empty`] for an operand of which nothing is left.
    pub fn of(operands: &[&TriMesh], mode: OrientMode, progress: &Progress) -> Result<Self, SoupError> {
        let mut soup = Self {
            mesh: TriMesh::default(),
            operands: Operands::new([]),
            patch_of: Vec::new(),
            patch_count: 0,
            reports: Vec::new(),
            source: Vec::new(),
        };
        let mut counts = Vec::new();
        for (operand, input) in operands.iter().enumerate() {
            progress.check()?;
            let mut cleaned = clean(input);
            progress.check()?;
            if cleaned.mesh.triangles.is_empty() {
                return Err(SoupError::Empty { operand });
            }
            let mut patches = orient_patches(&mut cleaned.mesh.triangles, &cleaned.unoriented, mode);
            counts.push(cleaned.mesh.triangles.len());
            soup.mesh.append(&cleaned.mesh);
            soup.source.append(&mut cleaned.source);
            soup.patch_of.extend(patches.of.drain(..).map(|patch| patch.after(soup.patch_count)));
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

    /// The same with other winding numbers inside.
    pub fn with_inside(mut self, inside: Inside) -> Self {
        self.operands.inside = inside;
        self
    }

    /// One operand that is taken as it is: its triangles keep their numbers and sides.
    pub fn as_it_is(mesh: TriMesh) -> Self {
        let count = mesh.triangles.len();
        Self {
            operands: Operands::new([count]),
            patch_of: vec![PatchId::FIRST; count],
            patch_count: usize::from(count > 0),
            reports: vec![OrientReport::default()],
            source: (0..count as u32).collect(),
            mesh,
        }
    }

    /// Lets the rays decide the side of each patch, and turns patches over in the crossings and in the soup.
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
            let patch = self.patch_of[n].index();
            if turned[patch] {
                triangle.swap(1, 2);
                let report = &mut self.reports[self.operands.of(n as u32)];
                report.flipped_by_rays += 1;
                report.flipped_patches += !std::mem::replace(&mut seen[patch], true) as usize;
            }
        }
        Ok(())
    }

    /// Numbers that keep triangles apart, from those of the operands' triangles; none when no operand has any.
    pub fn classes(&self, of_operands: &[Vec<u32>]) -> Vec<u32> {
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
    pub fn planes(&self, lattice: &Lattice) -> Vec<Plane> {
        let corners = |t: usize| self.mesh.corners(t).map(|p| lattice.to_lattice(p));
        (0..self.mesh.triangles.len()).into_par_iter().map(|t| Plane::through(corners(t))).collect()
    }
}
