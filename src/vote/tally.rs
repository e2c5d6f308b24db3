//! The votes of all directions on the voxels of one brick.

use glam::IVec3;

use super::VoteRule;
use crate::lattice::{BRICK, BRICK_VOXELS};
use crate::ldi::{Expression, Hit, Operands, Spans};

/// Below this many valid votes the half-rays decide ([`VoteRule::HalfRays`]), and a voxel is
/// doubtful.
pub const FEW: u8 = 5;

/// What the directions say of one voxel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Votes {
    /// Directions that say inside.
    pub inside: u8,
    /// Directions that say anything.
    pub valid: u8,
    /// The decision.
    pub is_inside: bool,
}

impl Votes {
    /// Few valid votes, or a minority of more than a quarter of them.
    #[inline]
    pub fn doubtful(self) -> bool {
        self.valid < FEW || 4 * self.inside.min(self.valid - self.inside) > self.valid
    }

    /// All 13 directions say the same.
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
}

/// Rays of a brick along u or v, at most: 8 voxels and a shear of 7.
const WIDE: usize = (2 * BRICK - 1) as usize;
/// In [`RayMasks`]: the ray has a say.
const VALID: u16 = 1 << 8;

/// For each ray through a brick: bit `t` is set where depth `t` within the brick is inside, and
/// [`VALID`].
type RayMasks = [[u16; WIDE]; WIDE];

impl Jury<'_> {
    /// The votes on the voxels of brick `brick`.
    pub fn brick(&self, brick: IVec3) -> Box<[Votes; BRICK_VOXELS]> {
        let base = brick * BRICK;
        let mut votes = Box::new([Votes::default(); BRICK_VOXELS]);
        let mut masks: RayMasks = [[0; WIDE]; WIDE];
        for spans in self.spans {
            self.read_rays(spans, base, &mut masks);
            count(spans, &masks, &mut votes);
        }
        for (n, votes) in votes.iter_mut().enumerate() {
            votes.is_inside = self.decide(*votes, base + voxel_in_brick(n));
        }
        votes
    }

    /// Fills the masks of the rays of one direction.
    fn read_rays(&self, spans: &Spans, base: IVec3, masks: &mut RayMasks) {
        let layers = &spans.layers;
        let direction = layers.direction;
        let first = first_ray(spans, base);
        let (wide_u, wide_v) = (7 * direction.shear_u.unsigned_abs() + 8, 7 * direction.shear_v.unsigned_abs() + 8);
        let depth = base[direction.main] as f64;
        let factor = layers.factor as i32;
        for j in 0..wide_v as usize {
            for i in 0..wide_u as usize {
                let ray = layers.ray((first[0] + i as i32) * factor, (first[1] + j as i32) * factor);
                masks[j][i] = match ray {
                    None => VALID,
                    Some(ray) if spans.is_silent(ray) => 0,
                    Some(ray) => VALID | depths_inside(layers.of(ray), depth),
                };
            }
        }
    }

    fn decide(&self, votes: Votes, voxel: IVec3) -> bool {
        match self.rule {
            VoteRule::Paper => 2 * votes.inside > 13,
            VoteRule::HalfRays if votes.valid < FEW => self.ask_half_rays(votes, voxel),
            _ => 2 * votes.inside > votes.valid,
        }
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
        let mut counters = vec![0i32; self.operands.count()];
        for hit in half {
            counters[self.operands.of(hit.triangle())] += if hit.entering() { entering } else { -entering };
        }
        let inside: Vec<bool> = counters.iter().map(|&c| c >= 1).collect();
        self.expression.evaluate(&inside)
    }
}

/// Lattice offset of voxel number `n` of a brick.
#[inline]
pub fn voxel_in_brick(n: usize) -> IVec3 {
    IVec3::new((n & 7) as i32, (n >> 3 & 7) as i32, (n >> 6) as i32)
}

/// (u, v), in voxels, of the first ray that meets the brick at `base`.
fn first_ray(spans: &Spans, base: IVec3) -> [i32; 2] {
    let direction = spans.layers.direction;
    let s = direction.shear(base);
    [s.x - 7 * direction.shear_u.max(0), s.y - 7 * direction.shear_v.max(0)]
}

/// Bit `t` of the result: whether depth `base + t`, `t` < 8, lies between an entry and an exit.
#[inline]
fn depths_inside(hits: &[Hit], base: f64) -> u16 {
    let mut mask = 0u16;
    for span in hits.chunks_exact(2) {
        // voxel at depth t is inside when entry < t <= exit
        let from = (span[0].depth.floor() + 1.0 - base).clamp(0.0, 8.0) as u32;
        let to = (span[1].depth.floor() + 1.0 - base).clamp(0.0, 8.0) as u32;
        mask |= ((1 << to) - 1) & !((1u16 << from) - 1);
    }
    mask
}

/// Adds one direction's votes to those of the brick's voxels.
fn count(spans: &Spans, masks: &RayMasks, votes: &mut [Votes; BRICK_VOXELS]) {
    let direction = spans.layers.direction;
    let stride = [1usize, 8, 64];
    let [a, b, c] = direction.axes();
    let shift_u = 7 * direction.shear_u.max(0);
    let shift_v = 7 * direction.shear_v.max(0);
    for t in 0..BRICK {
        let u0 = (shift_u - direction.shear_u * t) as usize;
        for q in 0..BRICK {
            let row = &masks[(shift_v - direction.shear_v * t + q) as usize][u0..u0 + 8];
            let start = t as usize * stride[c] + q as usize * stride[b];
            for (p, mask) in row.iter().enumerate() {
                let votes = &mut votes[start + p * stride[a]];
                votes.inside += (mask >> t & 1) as u8;
                votes.valid += (mask >> 8) as u8;
            }
        }
    }
}
