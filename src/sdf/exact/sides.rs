//! On which side voxels lie: beyond the band, in bricks that are not stored, and by votes, winding numbers and levels.

use std::sync::Arc;

use glam::IVec3;
use rayon::prelude::*;

use super::{ExactDistance, ExactError, PointSign, Raw, Sign};
use crate::lattice::{BRICK, BRICK_VOXELS, Bricks, Grid, Lattice, Slot};
use crate::ldi::Expression;
use crate::mesh::{Bounds, TriMesh};
use crate::progress::{Progress, Stopped};
use crate::sdf::Levels;
use crate::vote::{Votes, Winding};

type Values = [f32; BRICK_VOXELS];

/// Gives every voxel its side.
pub(super) fn settle(
    raw: &mut Raw,
    mesh: &TriMesh,
    lattice: &Lattice,
    sign: Sign<'_>,
    progress: &Progress,
) -> Result<(), ExactError> {
    match sign {
        Sign::Pseudonormal => {
            let bounds = mesh.bounds().ok_or(ExactError::Empty)?;
            let sides = PointQuery { mesh, bounds, lattice, point: std::cell::OnceCell::new() };
            let band = raw.band;
            raw.grid.values.par_iter_mut().for_each(|values| spread(values, band));
            sides.classes(raw);
        }
        Sign::Votes(votes) => {
            let (bricks, band) = (raw.grid.bricks.clone(), raw.band);
            let all = raw.grid.values.par_iter_mut().zip(bricks.active());
            all.for_each(|(values, &brick)| by_votes(values, votes, brick, band));
            settle_rest(raw, |brick, values| {
                let slot = votes.bricks.slot(brick);
                if let Slot::Active(_) = slot {
                    by_votes(values, votes, brick, band);
                    return Ok(None);
                }
                Ok(Some(slot == Slot::Inside))
            })?;
        }
        Sign::Levels(levels) => {
            let (bricks, band) = (raw.grid.bricks.clone(), raw.band);
            let all = raw.grid.values.par_iter_mut().zip(bricks.active());
            all.for_each(|(values, &brick)| by_levels(values, levels, brick, band));
            settle_rest(raw, |brick, values| {
                let rows = levels.brick(brick);
                let same = rows.iter().all(|&row| row == rows[0]) && matches!(rows[0], 0 | u8::MAX);
                if !same {
                    by_levels(values, levels, brick, band);
                }
                Ok(same.then_some(rows[0] != 0))
            })?;
        }
        Sign::Winding(winding, expression) => {
            let (bricks, band) = (raw.grid.bricks.clone(), raw.band);
            let all = raw.grid.values.par_iter_mut().zip(bricks.active());
            all.try_for_each(|(values, &brick)| {
                progress.check()?;
                by_winding(values, winding, expression, brick, band)
            })?;
            settle_rest(raw, |brick, values| {
                progress.check()?;
                let side = corners(winding, expression, brick)?;
                if side.is_none() {
                    by_winding(values, winding, expression, brick, band)?;
                }
                Ok(side)
            })?;
        }
    }
    Ok(())
}

/// The point query, made when it is first needed.
struct PointQuery<'a> {
    mesh: &'a TriMesh,
    bounds: Bounds,
    lattice: &'a Lattice,
    point: std::cell::OnceCell<ExactDistance>,
}

impl PointQuery<'_> {
    fn point(&self) -> &ExactDistance {
        self.point.get_or_init(|| ExactDistance::of(self.mesh, PointSign::Pseudonormal))
    }

    /// Gives inactive bricks their class. Behind an active brick it is that of its last voxels, which the surface does
    /// not come near; where none comes before, of the first active one's first voxels; in rows without any, one is asked.
    fn classes(&self, raw: &mut Raw) {
        let grid = &raw.grid;
        let last = |n: usize| grid.values[n][7] < 0.0;
        let number = |brick: IVec3| match grid.bricks.slot(brick) {
            Slot::Active(n) => Some(n as usize),
            _ => None,
        };
        let active = grid.bricks.active().to_vec();
        let mut bricks = Bricks::with_classes(active.iter().copied(), |brick| number(brick).is_some_and(last));
        let counts = raw.end / BRICK;
        let mut next = active.iter().enumerate().peekable();
        for row in 0..counts.y * counts.z {
            let (y, z) = (row % counts.y, row / counts.y);
            let wanted = (raw.planes[0]..raw.planes[1]).contains(&(z * BRICK));
            let of_row = |b: &IVec3| b.y == y && b.z == z;
            let first = next.peek().filter(|(_, b)| of_row(b)).map(|&(n, b)| (n, b.x));
            let (inside, until) = match first {
                Some((_, 0)) => (false, 0),
                Some((n, x)) => (grid.values[n][0] < 0.0, x),
                None => (wanted && self.is_inside(IVec3::new(0, y, z) * BRICK), counts.x),
            };
            if inside && wanted {
                (0..until).for_each(|x| bricks.set_inside(IVec3::new(x, y, z)));
            }
            while next.next_if(|(_, b)| of_row(b)).is_some() {}
        }
        raw.grid.bricks = Arc::new(bricks);
    }

    fn is_inside(&self, voxel: IVec3) -> bool {
        let p = self.lattice.to_model(voxel.as_dvec3());
        // Outside of the box around a closed mesh nothing is inside.
        let within = p.cmpge(self.bounds.min).all() && p.cmple(self.bounds.max).all();
        within && self.point().at(p).is_some_and(|nearest| nearest.signed < 0.0)
    }
}

/// One bit a voxel of a brick: plane z, bit x + 8 y.
type Bits = [u64; 8];

/// The voxels x = 0 of a plane.
const COLUMN: u64 = 0x0101_0101_0101_0101;

/// Lets the voxels beyond the band take the side of those next to them, step by step. Between two neighbours of which
/// one is more than 1 h from the surface there is no surface.
fn spread(values: &mut Values, band: f32) {
    if values.iter().all(|value| value.is_finite()) {
        return;
    }
    let bits = |is: fn(f32) -> bool| -> Bits {
        std::array::from_fn(|z| (0..64).fold(0, |bits, n| bits | u64::from(is(values[64 * z + n])) << n))
    };
    let (mut known, mut inside) = (bits(f32::is_finite), bits(|value| value < 0.0));
    let beyond = known.map(|plane| !plane);
    // A brick is 8 voxels wide: 21 steps lead anywhere.
    while known != [u64::MAX; 8] {
        let (more, inner) = (grown(&known), grown(&inside));
        if more == known {
            break;
        }
        for z in 0..8 {
            inside[z] |= inner[z] & more[z] & !known[z];
        }
        known = more;
    }
    for (n, value) in values.iter_mut().enumerate().filter(|(n, _)| beyond[n / 64] >> (n % 64) & 1 == 1) {
        *value = if inside[n / 64] >> (n % 64) & 1 == 1 { -band } else { band };
    }
}

/// The voxels themselves and their six neighbours.
fn grown(bits: &Bits) -> Bits {
    std::array::from_fn(|z| {
        let plane = bits[z];
        let along_x = (plane << 1) & !COLUMN | (plane >> 1) & !(COLUMN << 7);
        let along_z = if z > 0 { bits[z - 1] } else { 0 } | if z < 7 { bits[z + 1] } else { 0 };
        plane | along_x | plane << 8 | plane >> 8 | along_z
    })
}

fn by_votes(values: &mut Values, votes: &Grid<Votes>, brick: IVec3, band: f32) {
    let set = |value: &mut f32, inside: bool| {
        let distance = value.abs().min(band);
        *value = if inside { -distance } else { distance };
    };
    match votes.bricks.slot(brick) {
        Slot::Active(n) => {
            let votes = &votes.values[n as usize];
            values.iter_mut().zip(votes).for_each(|(value, votes)| set(value, votes.is_inside));
        }
        class => values.iter_mut().for_each(|value| set(value, class == Slot::Inside)),
    }
}

fn by_levels(values: &mut Values, levels: &Levels, brick: IVec3, band: f32) {
    for (row, values) in levels.brick(brick).into_iter().zip(values.chunks_mut(BRICK as usize)) {
        for (n, value) in values.iter_mut().enumerate() {
            let distance = value.abs().min(band);
            *value = if row >> n & 1 == 1 { -distance } else { distance };
        }
    }
}

fn by_winding(
    values: &mut Values,
    winding: &Winding<'_>,
    expression: &Expression,
    brick: IVec3,
    band: f32,
) -> Result<(), Stopped> {
    let wanted: Vec<IVec3> = (0..64).map(|n| IVec3::new(n & 3, n >> 2 & 3, n >> 4)).collect();
    for block in 0..8 {
        let first = IVec3::new(block & 1, block >> 1 & 1, block >> 2) * 4;
        winding.decide(brick * BRICK + first, &wanted, expression, |k, inside| {
            let value = &mut values[crate::lattice::index_in_brick(first + k)];
            let distance = value.abs().min(band);
            *value = if inside { -distance } else { distance };
        })?;
    }
    Ok(())
}

/// The side of a brick, if all its corners have the same.
fn corners(winding: &Winding<'_>, expression: &Expression, brick: IVec3) -> Result<Option<bool>, Stopped> {
    let mut inside = 0;
    for n in 0..8 {
        let corner = IVec3::new(n & 1, n >> 1 & 1, n >> 2) * (BRICK - 1);
        // The voxel is the outermost of its block of 4³.
        let block = corner.min(IVec3::splat(BRICK / 2));
        winding.decide(brick * BRICK + block, &[corner - block], expression, |_, is| inside += u32::from(is))?;
    }
    Ok(match inside {
        0 => Some(false),
        8 => Some(true),
        _ => None,
    })
}

/// Lets `side` tell the side of every brick of the lattice that is not stored, or set it voxel by voxel. Where all
/// voxels have the same it is the class of the brick; where what closes a hole passes through the brick, far from any
/// triangle, the brick is stored.
fn settle_rest(
    raw: &mut Raw,
    side: impl Fn(IVec3, &mut Values) -> Result<Option<bool>, Stopped> + Sync,
) -> Result<(), Stopped> {
    let (old, band) = (raw.grid.bricks.clone(), raw.band);
    let [x, y, z] = (raw.end / BRICK).to_array().map(|count| count as usize);
    let settled = |values: &mut Values, n: usize| {
        let brick = IVec3::from([n % x, n / x % y, n / (x * y)].map(|k| k as i32));
        let wanted = (raw.planes[0]..raw.planes[1]).contains(&(brick.z * BRICK));
        if !wanted || matches!(old.slot(brick), Slot::Active(_)) {
            return Ok(None);
        }
        values.fill(band);
        let inside = match side(brick, values)? {
            Some(inside) => usize::from(inside) * BRICK_VOXELS,
            None => values.iter().filter(|value| **value < 0.0).count(),
        };
        Ok((inside > 0).then(|| (brick, (inside < BRICK_VOXELS).then(|| Box::new(*values)))))
    };
    let rest = (0..x * y * z).into_par_iter().map_init(|| [0.0; BRICK_VOXELS], settled);
    let rest: Vec<_> = rest.filter_map(Result::transpose).collect::<Result<_, Stopped>>()?;
    let (mixed, inside): (Vec<_>, Vec<_>) = rest.into_iter().partition(|(_, values)| values.is_some());
    if !mixed.is_empty() {
        let stored = std::mem::take(&mut raw.grid.values).into_iter();
        let mut all: Vec<(IVec3, Values)> = old.active().iter().copied().zip(stored).collect();
        all.extend(mixed.into_iter().filter_map(|(brick, values)| Some((brick, *values?))));
        all.sort_unstable_by_key(|(brick, _)| (brick.z, brick.y, brick.x));
        raw.grid.bricks = Arc::new(Bricks::new(all.iter().map(|(brick, _)| *brick)));
        raw.grid.values = all.into_iter().map(|(_, values)| values).collect();
    }
    let mut bricks = Bricks::new(raw.grid.bricks.active().iter().copied());
    inside.into_iter().for_each(|(brick, _)| bricks.set_inside(brick));
    raw.grid.bricks = Arc::new(bricks);
    Ok(())
}
