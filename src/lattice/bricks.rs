//! Sparse storage: 8³ bricks of voxels near the surface, one class for each brick elsewhere.

use std::sync::Arc;

use glam::IVec3;
use rustc_hash::FxHashMap;

/// Voxels along one side of a brick.
pub const BRICK: i32 = 8;
/// Voxels in a brick; voxel (x,y,z) of it has index `x + 8 y + 64 z`.
pub const BRICK_VOXELS: usize = (BRICK * BRICK * BRICK) as usize;

/// What is known of one brick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// Stored voxel by voxel, as number `n` of the active bricks.
    Active(u32),
    /// All its voxels lie inside the solid.
    Inside,
    /// All its voxels lie outside the solid.
    Outside,
}

/// Which bricks are active, in a fixed order, and the class of the others. Brick `b` holds the
/// voxels `8 b .. 8 b + 8`. An inactive brick has the class that was set for it, else the class
/// that follows the last active brick before it along x, else it is outside.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bricks {
    active: Vec<IVec3>,
    slots: FxHashMap<IVec3, Slot>,
    /// For each active brick, whether inactive bricks that follow it along x are inside.
    inside_after: Vec<bool>,
}

/// Brick that holds `voxel`.
#[inline]
pub fn brick_of(voxel: IVec3) -> IVec3 {
    IVec3::new(voxel.x >> 3, voxel.y >> 3, voxel.z >> 3)
}

/// Index of `voxel` within its brick.
#[inline]
pub fn index_in_brick(voxel: IVec3) -> usize {
    ((voxel.x & 7) | (voxel.y & 7) << 3 | (voxel.z & 7) << 6) as usize
}

/// The voxel with index `n` of a brick, seen from the brick's first voxel: the inverse of [`index_in_brick`].
#[inline]
pub fn voxel_in_brick(n: usize) -> IVec3 {
    IVec3::new((n & 7) as i32, (n >> 3 & 7) as i32, (n >> 6) as i32)
}

/// The order of active bricks.
#[inline]
fn order(brick: &IVec3) -> (i32, i32, i32) {
    (brick.z, brick.y, brick.x)
}

impl Bricks {
    /// Bricks of which the given ones are active, sorted by (z, y, x) and without repetition; all others lie outside.
    pub fn new(active: impl IntoIterator<Item = IVec3>) -> Self {
        Self::with_classes(active, |_| false)
    }

    /// Bricks of which the given ones are active, sorted by (z, y, x) and without repetition. `inside_after` says of an active
    /// brick whether the inactive bricks that follow it along x are inside.
    pub fn with_classes(active: impl IntoIterator<Item = IVec3>, inside_after: impl Fn(IVec3) -> bool) -> Self {
        let mut active: Vec<IVec3> = active.into_iter().collect();
        active.sort_unstable_by_key(order);
        active.dedup();
        let slots = active.iter().enumerate().map(|(n, &b)| (b, Slot::Active(n as u32))).collect();
        let inside_after = active.iter().map(|&b| inside_after(b)).collect();
        Self { active, slots, inside_after }
    }

    /// Notes that the inactive brick `brick` lies inside. An active brick stays as it is.
    pub fn set_inside(&mut self, brick: IVec3) {
        self.slots.entry(brick).or_insert(Slot::Inside);
    }

    /// The same bricks, each from `from` on counted from there.
    pub fn counted_from(&self, from: IVec3) -> Self {
        Self {
            active: self.active.iter().map(|&brick| brick - from).collect(),
            slots: self.slots.iter().map(|(&brick, &slot)| (brick - from, slot)).collect(),
            inside_after: self.inside_after.clone(),
        }
    }

    /// What is known of brick `brick`.
    #[inline]
    pub fn slot(&self, brick: IVec3) -> Slot {
        self.slots.get(&brick).copied().unwrap_or_else(|| self.inactive_slot(brick))
    }

    /// The number of a brick among the active ones, if it is one.
    #[inline]
    pub fn number(&self, brick: IVec3) -> Option<u32> {
        match self.slots.get(&brick) {
            Some(&Slot::Active(n)) => Some(n),
            _ => None,
        }
    }

    fn inactive_slot(&self, brick: IVec3) -> Slot {
        let before = self.active.partition_point(|b| order(b) < order(&brick));
        let inside = before
            .checked_sub(1)
            .is_some_and(|n| self.inside_after[n] && self.active[n].z == brick.z && self.active[n].y == brick.y);
        if inside { Slot::Inside } else { Slot::Outside }
    }

    /// Coordinates of the active bricks, sorted by (z, y, x).
    pub fn active(&self) -> &[IVec3] {
        &self.active
    }

    /// Number of active bricks.
    pub fn len(&self) -> usize {
        self.active.len()
    }

    /// Whether no brick is active.
    pub fn is_empty(&self) -> bool {
        self.active.is_empty()
    }
}

/// A value for each voxel of the active bricks, and one value each for inside and outside.
#[derive(Debug, Clone)]
pub struct Grid<T> {
    /// Which voxels are stored.
    pub bricks: Arc<Bricks>,
    /// The values, brick by brick in the order of [`Bricks::active`].
    pub values: Vec<[T; BRICK_VOXELS]>,
    /// The value of voxels of bricks that lie inside.
    pub inside: T,
    /// The value of voxels of bricks that lie outside.
    pub outside: T,
}

impl<T: Copy> Grid<T> {
    /// A grid whose active voxels all have the value `value`.
    pub fn filled(bricks: Arc<Bricks>, value: T, inside: T, outside: T) -> Self {
        let values = vec![[value; BRICK_VOXELS]; bricks.len()];
        Self { bricks, values, inside, outside }
    }

    /// The value of `voxel`, wherever it lies. It costs a look-up in a hash table, so loops over many voxels go brick by brick
    /// instead.
    #[inline]
    pub fn get(&self, voxel: IVec3) -> T {
        match self.bricks.slot(brick_of(voxel)) {
            Slot::Active(n) => self.values[n as usize][index_in_brick(voxel)],
            Slot::Inside => self.inside,
            Slot::Outside => self.outside,
        }
    }
}
