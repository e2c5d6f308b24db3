//! Parts of a lattice that are worked through one after another.

use glam::IVec3;

use crate::lattice::BRICK;
use crate::sdf::exact::Scope;

/// Voxels along a side of a block, at least, to begin with.
const LEAST: i32 = 32;
/// At most so many blocks along an axis to begin with.
const MOST_BLOCKS: i32 = 128;

/// Blocks of a lattice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Region {
    /// First voxel.
    pub base: IVec3,
    /// Blocks along each axis.
    pub across: IVec3,
    /// Voxels along a side of a block: a power of two, at least that of a brick.
    pub size: i32,
}

impl Region {
    /// The whole lattice, in blocks about as large as the band.
    pub fn whole(scope: &Scope) -> Self {
        let longest = scope.end.max_element();
        let mut size = LEAST;
        while size < longest && (f64::from(size) < scope.band || longest / size >= MOST_BLOCKS) {
            size *= 2;
        }
        Self { base: IVec3::ZERO, across: (scope.end + size - 1) / size, size }
    }

    /// The number of blocks.
    pub fn blocks(&self) -> u64 {
        self.across.as_i64vec3().element_product() as u64
    }

    /// The first voxel and the last.
    pub fn voxels(&self) -> [IVec3; 2] {
        [self.base, self.base + self.size * self.across - 1]
    }

    /// Two halves, or the blocks of half the size where there is but one; `None` for a single brick.
    pub fn halves(&self) -> Option<Vec<Self>> {
        let longest = self.across.max_element();
        if longest == 1 {
            let size = self.size / 2;
            return (size >= BRICK).then(|| vec![Self { base: self.base, across: IVec3::splat(2), size }]);
        }
        let axis = (0..3).find(|&k| self.across[k] == longest)?;
        let (mut a, mut b) = (*self, *self);
        a.across[axis] = longest / 2;
        b.across[axis] -= a.across[axis];
        b.base[axis] += a.across[axis] * self.size;
        Some(vec![a, b])
    }

    /// At least `count` parts of about the same size, if there are as many blocks.
    pub fn parts(self, count: usize) -> Vec<Self> {
        let mut parts = vec![self];
        while parts.len() < count {
            let halved = parts.iter().filter(|part| part.blocks() > 1).count();
            if halved == 0 {
                break;
            }
            let split = |part: Self| part.halves().filter(|_| part.blocks() > 1).unwrap_or_else(|| vec![part]);
            parts = parts.into_iter().flat_map(split).collect();
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_and_halves_hold_every_brick_once() {
        let whole = Region::whole(&Scope { end: IVec3::new(200, 72, 104), band: 40.0, planes: [0, 104] });
        assert_eq!((whole.size, whole.across), (64, IVec3::new(4, 2, 2)));
        let mut rest = whole.parts(3);
        assert_eq!(rest.len(), 4);
        let mut seen = std::collections::BTreeSet::new();
        while let Some(region) = rest.pop() {
            match region.halves() {
                Some(halves) => rest.extend(halves),
                None => assert!(region.size == BRICK && seen.insert((region.base / BRICK).to_array())),
            }
        }
        assert_eq!(seen.len(), 32 * 16 * 16);
    }
}
