//! The numbers, predicates and triangulations of the arrangement against integers of any length.

mod numbers;
mod planar;
mod predicates;

use num_bigint::{BigInt, Sign};
use proptest::prelude::*;

use super::plane::Plane;
use super::point::Exact;
use super::wide::Wide;

/// The number as an integer of any length.
pub(super) fn big(wide: &Wide) -> BigInt {
    let (limbs, negative) = wide.parts();
    let sum = limbs.iter().rev().fold(BigInt::ZERO, |sum, &limb| (sum << 64) + limb);
    if negative { -sum } else { sum }
}

/// -1, 0 or 1.
pub(super) fn sign(number: &BigInt) -> i32 {
    match number.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

/// A point by its coordinates, divided by `w`.
#[derive(Debug, Clone)]
pub(super) struct Ratio {
    pub(super) at: [BigInt; 3],
    pub(super) w: BigInt,
}

impl Ratio {
    pub(super) fn of(exact: &Exact) -> Self {
        Self { at: exact.at.map(|x| big(&x.wide())), w: big(&exact.w.wide()) }
    }

    pub(super) fn lattice(at: [i32; 3]) -> Self {
        Self { at: at.map(BigInt::from), w: BigInt::from(1) }
    }

    /// Six times the signed volume between the point and a triangle, times `w`, which is positive: positive in front of it.
    pub(super) fn volume(&self, [a, b, c]: [[i32; 3]; 3]) -> BigInt {
        let from_a = |p: [i32; 3]| [0, 1, 2].map(|k| BigInt::from(p[k]) - a[k]);
        let (u, v) = (from_a(b), from_a(c));
        let p = [0, 1, 2].map(|k| &self.at[k] - &self.w * a[k]);
        let part = |i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
        &p[0] * part(1, 2) + &p[1] * part(2, 0) + &p[2] * part(0, 1)
    }

    /// Whether all coordinates are at most 2³⁰ in size.
    fn is_near(&self) -> bool {
        self.at.iter().all(|x| x.magnitude() <= &(self.w.magnitude() << 30))
    }
}

/// A coordinate on the fine lattice, often one at its ends or near another.
pub(super) fn coordinate() -> impl Strategy<Value = i32> {
    const END: i32 = 1 << 30;
    prop_oneof![
        4 => -END..=END,
        1 => Just(END),
        1 => Just(-END),
        1 => END - 2..=END,
        2 => -3..=3,
    ]
    .boxed()
}

pub(super) fn place() -> impl Strategy<Value = [i32; 3]> {
    prop::array::uniform3(coordinate())
}

/// A triangle with an area, its plane.
pub(super) fn triangle() -> impl Strategy<Value = ([[i32; 3]; 3], Plane)> {
    let with_plane = |corners| (corners, Plane::through(corners));
    prop::array::uniform3(place()).prop_map(with_plane).prop_filter("no area", |(_, plane)| plane.normal != [0; 3])
}
