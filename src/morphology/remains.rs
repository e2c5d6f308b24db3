//! What a level of the distance encloses between the voxels, where no voxel shows it.
//!
//! Between two plates a little farther apart than a ball is wide, the ball's centre can be on a sheet that may be thinner than any
//! voxel. The distance itself knows it: along the ridge where two parts of the surface are as near, it is as large as anywhere
//! around. So in every cell of the lattice whose corners all lie on the other side of the level, and in which the distance
//! bends as it does at a ridge, the ridge is climbed.

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{Gauge, corners};
use crate::lattice::{BRICK, Grid, Lattice, voxel_in_brick};
use crate::progress::{Progress, Stopped};

/// Half the diagonal of a cell of side 1.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;

/// A cell has a ridge when a corner's value is lower by this, h, than the slope at the centre would have it. Away from ridges
/// the distance bends upwards only, or by h / 8 r at most.
const BENT: f64 = 0.1;

/// Points on a level of radius r that lie δ apart miss the ball around them by δ² / 4 r; they are so near that this
/// is at most this part of a voxel.
const MISSED: f64 = 0.05;

/// Points along the side of a cell, at most.
const MOST_ALONG: u32 = 5;

/// Directions whose cosine is less than this are two: the nearest point has changed.
const SAME: f64 = 0.999;

/// Halvings towards a ridge: to a thousandth of the way, and where that decides, to its last digits.
const HALVINGS: usize = 10;
const MOST_HALVINGS: usize = 40;

/// A level is reached when less than this part of it is missing: a ball that just fits passes.
const JUST: f64 = 1e-7;

/// Ways up and along a ridge, at most.
const CLIMBS: usize = 5;

/// Two slopes that face each other more than this leave no way along the ridge between them.
const FACING: f64 = 0.2;

/// A piece of a level around something too thin for any voxel to lie in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Remain {
    /// A point of the level, model units.
    pub point: DVec3,
    /// How thick it is there, model units.
    pub thickness: f64,
    /// How much of the level it stands for, square model units.
    pub area: f64,
}

/// A level whose thin parts are looked for.
pub(super) struct Search<'a> {
    /// What the distance is to.
    pub body: &'a Gauge<'a>,
    /// The level, model units.
    pub level: f64,
    /// 1: of what is above the level, −1: of what is below it.
    pub side: f64,
    /// Where the voxels are.
    pub lattice: &'a Lattice,
    /// The distance less the level, h, at the voxels.
    pub field: &'a Grid<f32>,
}

/// A value and its slope, upwards into what is looked for.
struct Here {
    /// How far over the level, model units.
    over: f64,
    up: DVec3,
}

impl Here {
    /// The point of the level straight below `p`, where this is, and a ridge is so far over the level.
    fn below(&self, p: DVec3, ridge: f64) -> At {
        At { point: p - self.up * self.over, up: self.up, thickness: 2.0 * ridge.max(0.0) }
    }
}

/// A point of the level, and the slope there.
struct At {
    point: DVec3,
    up: DVec3,
    /// From there to the other side of the ridge, model units.
    thickness: f64,
}

impl Search<'_> {
    /// What of the level's side lies between voxels, in the order of the bricks.
    pub(super) fn remains(&self, progress: &Progress) -> Result<Vec<Remain>, Stopped> {
        let of_brick = |&brick: &IVec3| {
            progress.check()?;
            let voxels = (0..crate::lattice::BRICK_VOXELS).map(|n| BRICK * brick + voxel_in_brick(n));
            Ok(voxels.filter(|&voxel| self.is_bare(voxel)).flat_map(|voxel| self.in_cell(voxel)).collect::<Vec<_>>())
        };
        let found: Vec<Vec<At>> =
            self.field.bricks.active().par_iter().map(of_brick).collect::<Result<_, Stopped>>()?;
        let side = self.lattice.h / f64::from(self.along()) / 2.0;
        let mut taken = FxHashSet::default();
        let mut fresh =
            |at: &At| taken.insert(((at.point / side).floor().as_ivec3(), (at.up * 1.5).round().as_ivec3()));
        let area = (2.0 * side).powi(2);
        let remain = |at: At| Remain { point: at.point, thickness: at.thickness, area };
        Ok(found.into_iter().flatten().filter(|at| fresh(at)).map(remain).collect())
    }

    fn at_voxel(&self, voxel: IVec3) -> f64 {
        self.side * f64::from(self.field.get(voxel))
    }

    /// Whether all corners of the cell over `voxel` lie on the other side, and one so near that there may be something between.
    fn is_bare(&self, voxel: IVec3) -> bool {
        let first = self.at_voxel(voxel);
        if !(-3.0 * HALF_DIAGONAL..0.0).contains(&first) {
            return false;
        }
        let corners = corners().map(|corner| self.at_voxel(voxel + corner));
        let nearest = corners.fold(f64::NEG_INFINITY, f64::max);
        (-HALF_DIAGONAL..0.0).contains(&nearest)
    }

    fn in_cell(&self, voxel: IVec3) -> Vec<At> {
        let h = self.lattice.h;
        let middle = voxel.as_dvec3() + 0.5;
        let here = self.at(self.lattice.to_model(middle));
        if here.over < -HALF_DIAGONAL * h {
            return Vec::new();
        }
        let short = |corner: IVec3| {
            let expected = here.over / h + here.up.dot(corner.as_dvec3() - 0.5);
            expected - self.at_voxel(voxel + corner)
        };
        if here.over < 0.0 && corners().map(short).all(|short| short < BENT) {
            return Vec::new();
        }
        let along = self.along();
        let part = 1.0 / f64::from(along);
        let parts = (0..along.pow(3)).map(|n| {
            let place = DVec3::new(f64::from(n % along), f64::from(n / along % along), f64::from(n / along.pow(2)));
            self.lattice.to_model(voxel.as_dvec3() + (place + 0.5) * part)
        });
        parts.flat_map(|start| self.climb(start, part * h)).flatten().collect()
    }

    /// Points along the side of a cell.
    fn along(&self) -> u32 {
        let reach = (self.level.abs() / self.lattice.h).max(1.0);
        (1.0 / (4.0 * MISSED * reach).sqrt()).ceil().clamp(1.0, f64::from(MOST_ALONG)) as u32
    }

    fn at(&self, p: DVec3) -> Here {
        let (value, gradient) = self.body.at(p, self.level.abs() + 2.0 * self.lattice.h);
        Here { over: self.side * (value - self.level), up: self.side * gradient }
    }

    /// From `start` up to the ridge and along it, as far as a cube of side `room` around goes: the points of the level on
    /// either side of a point over it.
    fn climb(&self, start: DVec3, room: f64) -> [Option<At>; 2] {
        let nothing = [None, None];
        let mut p = start;
        let mut here = self.at(p);
        if here.over < -HALF_DIAGONAL * room {
            return nothing;
        }
        for _ in 0..CLIMBS {
            let (before, after) = match self.ridge(p, &here, 2.0 * room) {
                Some(found) => found,
                // It is so wide that the other side lies in another cell.
                None if here.over >= 0.0 => return [Some(here.below(p, here.over)), None],
                None => return nothing,
            };
            let beyond = p + here.up * after;
            let other = self.at(beyond);
            let over = here.over + before;
            if over >= -JUST * self.level.abs() {
                return [Some(here.below(p, over)), Some(other.below(beyond, over))];
            }
            let between = here.up + other.up;
            if between.length() < FACING {
                return nothing;
            }
            let way = between.normalize();
            let step = (-over / way.dot(here.up)).min(room);
            p += here.up * before + way * step;
            if p.distance(start) > 2.0 * room {
                return nothing;
            }
            here = self.at(p);
        }
        nothing
    }

    /// How far from `p`, on the way up, the slope changes: the last place before and the first after it.
    fn ridge(&self, p: DVec3, here: &Here, room: f64) -> Option<(f64, f64)> {
        let is_same = |t: f64| self.at(p + here.up * t).up.dot(here.up) > SAME;
        if is_same(room) {
            return None;
        }
        let (mut before, mut after) = (0.0, room);
        for halvings in 0..MOST_HALVINGS {
            let decides = here.over + before < 0.0 && here.over + after >= 0.0;
            if halvings >= HALVINGS && !decides {
                break;
            }
            let middle = (before + after) / 2.0;
            *if is_same(middle) { &mut before } else { &mut after } = middle;
        }
        Some((before, after))
    }
}
