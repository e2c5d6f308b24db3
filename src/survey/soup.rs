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
    /// The number of each triangle in its operand as given. Triangles beyond these are lids over holes of the one operand, see [`Soup::with_lids`].
    pub source: Vec<u32>,
    /// The number of the hole that each lid's triangle closes.
    pub lids: Vec<u32>,
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
            lids: Vec::new(),
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
            lids: Vec::new(),
            mesh,
        }
    }

    /// The same with lids over holes of the one operand, whose triangles come last and have no source. `lids`: new vertices, numbered after those of the soup, and
    /// triangles; `of`: for each triangle the number of its hole, and a vertex of the patch that it closes.
    ///
    /// # Panics
    /// Where there are several operands.
    pub fn with_lids(&self, lids: &TriMesh, of: &[(u32, u32)]) -> Self {
        assert_eq!(self.operands.count(), 1, "lids are those of one operand");
        let mut closed = self.clone();
        let mut patch_at = vec![PatchId::FIRST; self.mesh.positions.len()];
        for (triangle, &patch) in self.mesh.triangles.iter().zip(&self.patch_of) {
            triangle.iter().for_each(|&v| patch_at[v as usize] = patch);
        }
        closed.mesh.positions.extend_from_slice(&lids.positions);
        closed.mesh.triangles.extend_from_slice(&lids.triangles);
        closed.patch_of.extend(of.iter().map(|&(_, v)| patch_at[v as usize]));
        closed.lids.extend(of.iter().map(|&(hole, _)| hole));
        closed.operands = Operands::new([closed.mesh.triangles.len()]).with_inside(self.operands.inside);
        closed
    }

    /// The same with some of the triangles of the operands alone; vertices and patches keep their numbers.
    pub fn only(&self, keep: impl Fn(usize) -> bool) -> Self {
        let left: Vec<usize> = (0..self.source.len()).filter(|&t| keep(t)).collect();
        let mut counts = vec![0; self.operands.count()];
        left.iter().for_each(|&t| counts[self.operands.of(t as u32)] += 1);
        let triangles = left.iter().map(|&t| self.mesh.triangles[t]).collect();
        Self {
            mesh: TriMesh { positions: self.mesh.positions.clone(), triangles },
            operands: Operands::new(counts).with_inside(self.operands.inside),
            patch_of: left.iter().map(|&t| self.patch_of[t]).collect(),
            patch_count: self.patch_count,
            reports: self.reports.clone(),
            source: left.iter().map(|&t| self.source[t]).collect(),
            lids: Vec::new(),
        }
    }

    /// Where a triangle comes from: its operand and its number there. `None` for that of a lid.
    pub fn given(&self, triangle: u32) -> Option<(usize, u32)> {
        let source = self.source.get(triangle as usize)?;
        Some((self.operands.of(triangle), *source))
    }

    /// The number of the hole that a triangle closes. `None` for one of an operand.
    pub fn hole(&self, triangle: u32) -> Option<u32> {
        self.lids.get((triangle as usize).checked_sub(self.source.len())?).copied()
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
            let (operand, source) = self.given(t as u32)?;
            of_operands.get(operand)?.get(source as usize).copied()
        };
        (0..self.mesh.triangles.len()).map(|t| class(t).unwrap_or(0)).collect()
    }

    /// The planes of the triangles, lattice coordinates.
    pub fn planes(&self, lattice: &Lattice) -> Vec<Plane> {
        let corners = |t: usize| self.mesh.corners(t).map(|p| lattice.to_lattice(p));
        (0..self.mesh.triangles.len()).into_par_iter().map(|t| Plane::through(corners(t))).collect()
    }
}
