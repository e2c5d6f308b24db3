//! Which bricks of a lattice are looked at.

use std::sync::Arc;

use glam::{DVec3, IVec3};
use rustc_hash::FxHashSet;

use super::{BRICK, Lattice, brick_of};

/// The bricks in which voxels are voted on. All other voxels count as outside, so that a contour is closed along the border.
#[derive(Debug, Clone)]
pub struct Domain {
    /// Bricks of the lattice along each axis.
    count: IVec3,
    /// Those of them that are held, if not all.
    held: Option<Arc<Held>>,
}

#[derive(Debug)]
struct Held {
    bricks: FxHashSet<IVec3>,
    /// Lowest and highest bricks of boxes.
    boxes: Vec<[IVec3; 2]>,
}

impl Held {
    fn has(&self, brick: IVec3) -> bool {
        let is_in = |[low, high]: &[IVec3; 2]| (brick.cmpge(*low) & brick.cmple(*high)).all();
        self.bricks.contains(&brick) || self.boxes.iter().any(is_in)
    }
}

impl Domain {
    /// All bricks that have voxels of a lattice.
    pub fn of(lattice: &Lattice) -> Self {
        Self { count: (lattice.dims + BRICK - 1) / BRICK, held: None }
    }

    /// Those of them that are among `bricks`, or in one of some boxes, each from its lowest to its highest brick.
    pub fn within(self, bricks: FxHashSet<IVec3>, boxes: Vec<[IVec3; 2]>) -> Self {
        Self { held: Some(Arc::new(Held { bricks, boxes })), ..self }
    }

    /// Whether a brick has voxels of the lattice.
    fn is_in_lattice(&self, brick: IVec3) -> bool {
        brick.cmpge(IVec3::ZERO).all() && brick.cmplt(self.count).all()
    }

    /// Whether a brick is held.
    #[inline]
    pub fn holds(&self, brick: IVec3) -> bool {
        self.is_in_lattice(brick) && self.held.as_ref().is_none_or(|held| held.has(brick))
    }

    /// The held bricks along the border of the lattice.
    pub fn at_lattice_border(&self) -> impl Iterator<Item = IVec3> {
        let d = self.count;
        let all = (0..d.z).flat_map(move |z| (0..d.y).flat_map(move |y| (0..d.x).map(move |x| IVec3::new(x, y, z))));
        all.filter(|&brick| self.is_at_lattice_border(brick))
    }

    /// Whether a brick is held and lies along the border of the lattice.
    pub fn is_at_lattice_border(&self, brick: IVec3) -> bool {
        self.holds(brick) && (brick.cmpeq(IVec3::ZERO) | brick.cmpeq(self.count - 1)).any()
    }

    /// Whether a brick is held, and one across a face of it is in the lattice and is not.
    pub fn is_at_inner_border(&self, brick: IVec3) -> bool {
        let ends = |other| self.is_in_lattice(other) && !self.holds(other);
        self.held.is_some() && self.holds(brick) && IVec3::AXES.iter().any(|&k| ends(brick + k) || ends(brick - k))
    }

    /// Whether all voxels of the lattice within `reach`, voxels up to a brick's side, of a point, lattice coordinates, are held, each axis by itself.
    pub fn holds_around(&self, p: DVec3, reach: f64) -> bool {
        let [low, high] = [p - reach, p + reach].map(|p| brick_of(p.floor().as_ivec3()));
        let free = |brick| !self.is_in_lattice(brick) || self.holds(brick);
        let corner = |n: i32| IVec3::select(IVec3::new(n & 1, n & 2, n & 4).cmpeq(IVec3::ZERO), low, high);
        if low == high { free(low) } else { (0..8).all(|n| free(corner(n))) }
    }
}
