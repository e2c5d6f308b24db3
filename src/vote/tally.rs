//! The votes of all directions on the voxels of one brick.

use glam::IVec3;

use super::{VoteRule, Winding};
use crate::lattice::{BRICK, BRICK_VOXELS, DIRECTIONS, Direction, Domain, index_in_brick, voxel_in_brick};
use crate::ldi::{Expression, Hit, Operands, Spans};
use crate::progress::Stopped;

/// Below this many valid votes the half-rays decide ([`VoteRule::HalfRays`]), and a voxel is
/// doubtful.
pub(super) const FEW: u8 = 5;
/// With this many valid votes that all agree, a voxel needs no winding number
/// ([`VoteRule::Winding`]).
const ENOUGH: u8 = 10;

/// What the directions say of one voxel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Votes {
    /// Number of directions that say inside.
    pub inside: u8,
    /// Number of directions that say anything at all.
    pub valid: u8,
    /// Whether the voxel is inside, as the rule decided by these votes.
    pub is_inside: bool,
}

impl Votes {
    /// Whether the votes are too few, or the minority of more than a quarter too large, for the decision to be trusted.
    #[inline]
    pub fn doubtful(self) -> bool {
        self.valid < FEW || 4 * self.inside.min(self.valid - self.inside) > self.valid
    }

    /// At least ten directions speak, and all say the same.
    #[inline]
    fn clear(self) -> bool {
        self.valid >= ENOUGH && (self.inside == 0 || self.inside == self.valid)
    }

    /// Whether all 13 directions say the same.
    #[inline]
    pub fn unanimous(self) -> bool {
        self.valid == 13 && (self.inside == 0 || self.inside == 13)
    }
}

/// Everything a brick's vote needs to know.
pub struct Jury<'a> {
    /// The spans of the 13 directions.
    pub spans: &'a [Spans],
    /// Operand of each triangle, for the crossings of silent rays.
    pub operands: &'a Operands,
    /// The expression, for the half-rays.
    pub expression: &'a Expression,
    /// How votes become a decision.
    pub rule: VoteRule,
    /// The winding numbers of the operands.
    pub winding: &'a Winding<'a>,
    /// Where voxels may be inside.
    pub domain: &'a Domain,
}

/// Rays of a brick along u or v, at most: 8 voxels and a shear of 7; and one to make it even.
const WIDE: usize = 2 * BRICK as usize;
/// The lowest bit of each byte.
const ONES: u64 = 0x0101_0101_0101_0101;

/// One byte a ray through a brick, in rows of rays that follow each other along x: bit `t` of
/// `inside` is set where depth `t` within the brick is inside; `valid` is 1 where the ray speaks.
struct RayMasks {
    inside: [[u8; WIDE]; WIDE],
    valid: [[u8; WIDE]; WIDE],
}

/// One byte a voxel of a brick, a row of eight along x in each number.
struct Counts {
    inside: [u64; 64],
    valid: [u64; 64],
}

impl Jury<'_> {
    /// The votes on the voxels of brick `brick`. Stops only while the winding numbers are prepared.
    pub fn brick(&self, brick: IVec3) -> Result<Box<[Votes; BRICK_VOXELS]>, Stopped> {
        if !self.domain.holds(brick) {
            return Ok(Box::new([Votes { valid: DIRECTIONS.len() as u8, ..Votes::default() }; BRICK_VOXELS]));
        }
        let base = brick * BRICK;
        let mut masks = RayMasks { inside: [[0; WIDE]; WIDE], valid: [[0; WIDE]; WIDE] };
        let mut counts = Counts { inside: [0; 64], valid: [0; 64] };
        for spans in self.spans {
            read_rays(spans, base, &mut masks);
            count(spans.layers.direction, &masks, &mut counts);
        }
        let mut votes = Box::new([Votes::default(); BRICK_VOXELS]);
        for (row, votes) in votes.chunks_exact_mut(8).enumerate() {
            let (inside, valid) = (counts.inside[row].to_le_bytes(), counts.valid[row].to_le_bytes());
            for (x, votes) in votes.iter_mut().enumerate() {
                *votes = Votes { inside: inside[x], valid: valid[x], is_inside: false };
                let voxel = base + voxel_in_brick(8 * row + x);
                votes.is_inside = self.holds(voxel) && self.decide(*votes, voxel);
            }
        }
        if self.rule == VoteRule::Winding {
            self.ask_winding(base, &mut votes)?;
        }
        Ok(votes)
    }

    /// The votes on the voxels of a brick that lies inside as far as the lattice goes, by the word of the bricks around it.
    pub(super) fn inside(&self, brick: IVec3) -> Box<[Votes; BRICK_VOXELS]> {
        let all = DIRECTIONS.len() as u8;
        Box::new(std::array::from_fn(|n| {
            let is_inside = self.holds(brick * BRICK + voxel_in_brick(n));
            Votes { inside: if is_inside { all } else { 0 }, valid: all, is_inside }
        }))
    }

    /// Whether a voxel of a brick that the domain holds is one of the lattice's: all others are outside.
    fn holds(&self, voxel: IVec3) -> bool {
        voxel.cmpge(IVec3::ZERO).all() && voxel.cmplt(self.winding.dims()).all()
    }

    fn decide(&self, votes: Votes, voxel: IVec3) -> bool {
        match self.rule {
            VoteRule::Paper => 2 * votes.inside > 13,
            VoteRule::HalfRays if votes.valid < FEW => self.ask_half_rays(votes, voxel),
            _ => 2 * votes.inside > votes.valid,
        }
    }

    /// Decides the voxels that are not clear, a block of 4³ at a time.
    fn ask_winding(&self, base: IVec3, votes: &mut [Votes; BRICK_VOXELS]) -> Result<(), Stopped> {
        for block in 0..8 {
            let first = IVec3::new(block & 1, block >> 1 & 1, block >> 2) * 4;
            let offsets = (0..64).map(|n| IVec3::new(n & 3, n >> 2 & 3, n >> 4));
            let is_unclear = |&k: &IVec3| !votes[index_in_brick(first + k)].clear() && self.holds(base + first + k);
            let unclear: Vec<IVec3> = offsets.filter(is_unclear).collect();
            if !unclear.is_empty() {
                self.winding.decide(base + first, &unclear, self.expression, |k, inside| {
                    votes[index_in_brick(first + k)].is_inside = inside;
                })?;
            }
        }
        Ok(())
    }

    /// The half-rays of silent rays, behind and ahead of the voxel, say what their own counters
    /// say; a valid direction speaks for both of its half-rays.
    fn ask_half_rays(&self, votes: Votes, voxel: IVec3) -> bool {
        let (mut inside, mut asked) = (2 * votes.inside as i32, 2 * votes.valid as i32);
        for spans in self.spans {
            let s = spans.layers.direction.shear(voxel);
            let factor = spans.layers.factor as i32;
            let Some(ray) = spans.layers.ray(s.x * factor, s.y * factor).filter(|&ray| spans.is_silent(ray)) else {
                continue;
            };
            let hits = spans.layers.of(ray);
            let split = hits.partition_point(|hit| hit.depth < s.z as f64);
            for (half, entering) in [(&hits[..split], 1), (&hits[split..], -1)] {
                inside += self.half_ray_inside(half, entering) as i32;
                asked += 1;
            }
        }
        2 * inside > asked
    }

    fn half_ray_inside(&self, half: &[Hit], entering: i32) -> bool {
        let signed = |hit: &Hit| if hit.entering() { entering } else { -entering };
        if self.operands.count() == 1 {
            return self.expression.evaluate(&[self.operands.inside.holds(half.iter().map(signed).sum())]);
        }
        let mut counters = vec![0i32; self.operands.count()];
        for hit in half {
            counters[self.operands.of(hit.triangle())] += signed(hit);
        }
        let inside: Vec<bool> = counters.iter().map(|&counter| self.operands.inside.holds(counter)).collect();
        self.expression.evaluate(&inside)
    }
}

/// Fills the masks of the rays of one direction that meet the brick at `base`.
fn read_rays(spans: &Spans, base: IVec3, masks: &mut RayMasks) {
    let layers = &spans.layers;
    let direction = layers.direction;
    let factor = layers.factor as i32;
    let s = direction.shear(base);
    let first = [s.x - 7 * direction.shear_u.max(0), s.y - 7 * direction.shear_v.max(0)];
    let wide = [7 * direction.shear_u.abs() + 8, 7 * direction.shear_v.abs() + 8];
    let along_x = row_axis(direction);
    for j in 0..wide[1] {
        for i in 0..wide[0] {
            let (inside, valid) = match layers.ray((first[0] + i) * factor, (first[1] + j) * factor) {
                None => (0, 1),
                Some(ray) if spans.is_silent(ray) => (0, 0),
                Some(ray) => (depths_inside(layers.of(ray), s.z), 1),
            };
            let [row, place] = if along_x == 0 { [j, i] } else { [i, j] };
            masks.inside[row as usize][place as usize] = inside;
            masks.valid[row as usize][place as usize] = valid;
        }
    }
}

/// Which of u (0) and v (1) runs along x; for the direction along x itself it does not matter.
fn row_axis(direction: Direction) -> usize {
    if direction.main == 1 { 1 } else { 0 }
}

/// Bit `t` of the result: whether depth `base + t`, `t` < 8, lies between an entry and an exit.
#[inline]
fn depths_inside(hits: &[Hit], base: i32) -> u8 {
    let mut mask = 0u16;
    for span in hits.chunks_exact(2) {
        // The voxel at depth t is inside when entry < t <= exit. Cut off at -1, depths that are negative round down, too.
        let after = |depth: f64| (depth.max(-1.0) + 1.0) as i32;
        let from = (after(span[0].depth) - base).clamp(0, 8);
        let to = (after(span[1].depth) - base).clamp(0, 8);
        mask |= ((1 << to) - 1) & !((1u16 << from) - 1);
    }
    mask as u8
}

/// Adds one direction's votes to those of the brick's voxels, eight at a time.
fn count(direction: Direction, masks: &RayMasks, counts: &mut Counts) {
    if direction.main == 0 {
        // Bit t of a mask belongs to byte t of a row; rows follow y, then z, as u and v do.
        for (row, (inside, valid)) in counts.inside.iter_mut().zip(&mut counts.valid).enumerate() {
            *inside += spread(masks.inside[row >> 3][row & 7]);
            *valid += masks.valid[row >> 3][row & 7] as u64 * ONES;
        }
        return;
    }
    // The shears along x and along the third axis, and the strides, in rows, of that axis and of
    // the main one.
    let (shear_x, shear_other) = match row_axis(direction) {
        0 => (direction.shear_u, direction.shear_v),
        _ => (direction.shear_v, direction.shear_u),
    };
    let (stride_other, stride_main) = if direction.main == 2 { (1, 8) } else { (8, 1) };
    for t in 0..BRICK {
        let from_x = (7 * shear_x.max(0) - shear_x * t) as usize;
        for q in 0..BRICK {
            let row = (7 * shear_other.max(0) - shear_other * t + q) as usize;
            let at = (t * stride_main + q * stride_other) as usize;
            counts.inside[at] += (eight(&masks.inside[row], from_x) >> t) & ONES;
            counts.valid[at] += eight(&masks.valid[row], from_x);
        }
    }
}

/// Eight bytes of a row from `start`, the first lowest.
#[inline]
fn eight(row: &[u8; WIDE], start: usize) -> u64 {
    let mut bytes = [0; 8];
    bytes.copy_from_slice(&row[start..start + 8]);
    u64::from_le_bytes(bytes)
}

/// Bit t of `mask` as byte t.
#[inline]
fn spread(mask: u8) -> u64 {
    // Byte t keeps bit t alone; adding 127 carries it to the byte's highest bit.
    let kept = (mask as u64 * ONES) & 0x8040_2010_0804_0201;
    (((kept + 0x7f7f_7f7f_7f7f_7f7f) | kept) >> 7) & ONES
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spread_puts_bits_into_bytes() {
        for mask in 0..=255u8 {
            let expected: u64 = (0..8).map(|t| (mask as u64 >> t & 1) << (8 * t)).sum();
            assert_eq!(spread(mask), expected, "{mask:08b}");
        }
    }

    #[test]
    fn a_voxel_on_the_entry_is_outside_and_one_on_the_exit_inside() {
        let hits =
            [Hit::new(9.0, 0, true), Hit::new(11.0, 1, false), Hit::new(14.5, 2, true), Hit::new(30.0, 3, false)];
        assert_eq!(depths_inside(&hits, 8), 0b1000_1100);
    }
}
