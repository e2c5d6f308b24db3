//! Integers of a fixed greatest width, as sign and magnitude: what the exact predicates compute with.
//!
//! The bit lengths of all quantities are known beforehand (see the table in `docs/algorithms/arrangement.md`), so that nothing is allocated.
//! A product costs what the lengths of its factors ask for: most are of two limbs.

use std::cmp::Ordering;

/// Limbs of the widest number: 768 bits. The longest quantity, the orientation of three points of three planes each, has 601.
const LIMBS: usize = 12;

/// Limbs of a number that is kept: 256 bits. Coordinates of a point of three planes have 209.
const KEPT: usize = 4;

/// An integer of at most 768 bits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wide {
    limbs: [u64; LIMBS],
    /// Limbs in use: the highest of them is not zero.
    len: usize,
    negative: bool,
}

/// An integer of at most 256 bits, as it is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Kept {
    limbs: [u64; KEPT],
    negative: bool,
}

impl Kept {
    /// The number as one to compute with.
    #[inline]
    pub(crate) fn wide(&self) -> Wide {
        let mut limbs = [0; LIMBS];
        limbs[..KEPT].copy_from_slice(&self.limbs);
        Wide { limbs, len: used(&self.limbs), negative: self.negative }
    }
}

impl From<i64> for Kept {
    #[inline]
    fn from(n: i64) -> Self {
        Self { limbs: [n.unsigned_abs(), 0, 0, 0], negative: n < 0 }
    }
}

impl From<i64> for Wide {
    #[inline]
    fn from(n: i64) -> Self {
        let mut limbs = [0; LIMBS];
        limbs[0] = n.unsigned_abs();
        Self { limbs, len: usize::from(n != 0), negative: n < 0 }
    }
}

impl From<i128> for Wide {
    #[inline]
    fn from(n: i128) -> Self {
        let size = n.unsigned_abs();
        let mut limbs = [0; LIMBS];
        (limbs[0], limbs[1]) = (size as u64, (size >> 64) as u64);
        Self { limbs, len: used(&limbs[..2]), negative: n < 0 }
    }
}

#[inline]
fn used(limbs: &[u64]) -> usize {
    limbs.iter().rposition(|&limb| limb != 0).map_or(0, |last| last + 1)
}

impl Wide {
    pub(crate) const ZERO: Self = Self { limbs: [0; LIMBS], len: 0, negative: false };

    /// -1, 0 or 1.
    #[inline]
    pub(crate) fn sign(&self) -> i32 {
        match (self.len, self.negative) {
            (0, _) => 0,
            (_, true) => -1,
            (_, false) => 1,
        }
    }

    /// The number as it is kept; it must fit.
    #[inline]
    pub(crate) fn kept(&self) -> Kept {
        debug_assert!(self.len <= KEPT);
        let mut limbs = [0; KEPT];
        limbs.copy_from_slice(&self.limbs[..KEPT]);
        Kept { limbs, negative: self.negative && self.len > 0 }
    }

    #[inline]
    pub(crate) fn neg(mut self) -> Self {
        self.negative = !self.negative;
        self
    }

    #[inline]
    fn in_use(&self) -> &[u64] {
        &self.limbs[..self.len]
    }

    pub(crate) fn mul(&self, other: &Self) -> Self {
        debug_assert!(self.len + other.len <= LIMBS);
        let mut limbs = [0; LIMBS];
        for (i, &a) in self.in_use().iter().enumerate() {
            let mut carry = 0u128;
            for (j, &b) in other.in_use().iter().enumerate() {
                let sum = u128::from(a) * u128::from(b) + u128::from(limbs[i + j]) + carry;
                limbs[i + j] = sum as u64;
                carry = sum >> 64;
            }
            if carry != 0 {
                limbs[i + other.len] = carry as u64;
            }
        }
        let len = used(&limbs[..(self.len + other.len).min(LIMBS)]);
        Self { limbs, len, negative: self.negative != other.negative }
    }

    pub(crate) fn add(&self, other: &Self) -> Self {
        if self.negative == other.negative {
            return self.plus(other);
        }
        match self.compare_size(other) {
            Ordering::Equal => Self::ZERO,
            Ordering::Greater => self.minus(other),
            Ordering::Less => other.minus(self),
        }
    }

    #[inline]
    pub(crate) fn sub(&self, other: &Self) -> Self {
        self.add(&other.neg())
    }

    /// The sum of the sizes, with the sign of `self`.
    fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        let mut carry = false;
        let most = self.len.max(other.len);
        for i in 0..most {
            let (part, over) = self.limbs[i].overflowing_add(other.limbs[i]);
            let (part, again) = part.overflowing_add(u64::from(carry));
            (sum.limbs[i], carry) = (part, over || again);
        }
        sum.len = most;
        if carry {
            sum.limbs[most] = 1;
            sum.len += 1;
        }
        sum
    }

    /// The difference of the sizes, of which that of `self` is the larger, with the sign of `self`.
    fn minus(&self, other: &Self) -> Self {
        let mut rest = *self;
        let mut borrow = false;
        for i in 0..self.len {
            let (part, under) = self.limbs[i].overflowing_sub(other.limbs[i]);
            let (part, again) = part.overflowing_sub(u64::from(borrow));
            (rest.limbs[i], borrow) = (part, under || again);
        }
        rest.len = used(&rest.limbs[..self.len]);
        rest
    }

    fn compare_size(&self, other: &Self) -> Ordering {
        self.len.cmp(&other.len).then_with(|| self.in_use().iter().rev().cmp(other.in_use().iter().rev()))
    }

    pub(crate) fn compare(&self, other: &Self) -> Ordering {
        self.sub(other).sign().cmp(&0)
    }

    /// The number to within 2⁻⁵² of itself.
    pub(crate) fn to_f64(self) -> f64 {
        let top = self.len.saturating_sub(2);
        let size = self.in_use()[top..].iter().rev().fold(0.0, |sum, &limb| sum * 2f64.powi(64) + limb as f64);
        let size = size * 2f64.powi(64 * top as i32);
        if self.negative { -size } else { size }
    }

    /// The number modulo [`PRIME`].
    pub(crate) fn residue(&self) -> u64 {
        let size = self.in_use().iter().rev().fold(0u64, |rest, &limb| {
            // 2^64 is 8 modulo 2^61 - 1.
            let limb = (limb >> 61) + (limb & PRIME);
            times(rest, 8) + limb
        });
        let size = size % PRIME;
        if self.negative && size != 0 { PRIME - size } else { size }
    }
}

#[cfg(test)]
impl Wide {
    /// The limbs in use, the lowest first, and whether the number is negative.
    pub(crate) fn parts(&self) -> (&[u64], bool) {
        (self.in_use(), self.negative)
    }
}

/// The sign of the determinant of three rows.
pub(crate) fn sign_of_determinant([a, b, c]: &[[Wide; 3]; 3]) -> i32 {
    let minor = |i: usize, j: usize| b[i].mul(&c[j]).sub(&b[j].mul(&c[i]));
    a[0].mul(&minor(1, 2)).add(&a[1].mul(&minor(2, 0))).add(&a[2].mul(&minor(0, 1))).sign()
}

/// A Mersenne prime: points are found again by their coordinates modulo it.
pub(crate) const PRIME: u64 = (1 << 61) - 1;

/// The product modulo [`PRIME`].
#[inline]
pub(crate) fn times(a: u64, b: u64) -> u64 {
    let product = u128::from(a) * u128::from(b);
    let sum = (product as u64 & PRIME) + (product >> 61) as u64;
    if sum >= PRIME { sum - PRIME } else { sum }
}

/// The inverse modulo [`PRIME`]; zero for zero.
pub(crate) fn inverse(a: u64) -> u64 {
    // By Fermat: the power PRIME - 2, whose bits are all ones but the second.
    let mut power = a;
    let mut product = 1;
    for bit in 0..61 {
        if bit != 1 {
            product = times(product, power);
        }
        power = times(power, power);
    }
    product
}
