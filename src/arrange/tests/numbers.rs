//! [`Wide`] and the arithmetic modulo its prime.

use num_bigint::BigInt;
use proptest::prelude::*;

use super::super::wide::{PRIME, Wide, inverse, times};
use super::{big, sign};

/// A number of at most so many limbs of 64 bits; carries run through many of them.
fn number(limbs: usize) -> impl Strategy<Value = BigInt> {
    let limb = prop_oneof![3 => any::<u64>(), 1 => Just(0), 2 => Just(u64::MAX), 1 => Just(1), 1 => Just(1 << 63)];
    (prop::collection::vec(limb, 0..=limbs), any::<bool>()).prop_map(|(limbs, negative)| {
        let size = limbs.into_iter().fold(BigInt::ZERO, |sum, limb: u64| (sum << 64) + limb);
        if negative { -size } else { size }
    })
}

/// The number, made of its limbs.
fn wide(number: &BigInt) -> Wide {
    let (_, limbs) = number.to_u64_digits();
    let shift = Wide::from(1i128 << 64);
    let add = |sum: Wide, &limb: &u64| sum.mul(&shift).add(&Wide::from(i128::from(limb)));
    let size = limbs[..].iter().rev().fold(Wide::ZERO, add);
    if sign(number) < 0 { size.neg() } else { size }
}

/// A finite number of floating point that is whole.
fn whole(x: f64) -> BigInt {
    let (bits, exponent) = (x.to_bits(), (x.to_bits() >> 52 & 0x7ff) as i64 - 1075);
    let size = BigInt::from(bits & ((1 << 52) - 1) | 1 << 52);
    let size = if exponent >= 0 { size << exponent } else { size >> -exponent };
    match x {
        0.0 => BigInt::ZERO,
        _ if x < 0.0 => -size,
        _ => size,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn sums_and_differences(a in number(11), b in number(11)) {
        let (x, y) = (wide(&a), wide(&b));
        prop_assert_eq!(big(&x), a.clone());
        prop_assert_eq!(big(&x.add(&y)), &a + &b);
        prop_assert_eq!(big(&x.sub(&y)), &a - &b);
        prop_assert_eq!(big(&x.sub(&x)), BigInt::ZERO);
        prop_assert_eq!(big(&x.neg()), -&a);
        prop_assert_eq!(x.compare(&y), a.cmp(&b));
        prop_assert_eq!(x.sign(), sign(&a));
        prop_assert_eq!(x.neg().sign(), -sign(&a));
    }

    #[test]
    fn products(a in number(6), b in number(6), c in number(3)) {
        prop_assert_eq!(big(&wide(&a).mul(&wide(&b))), &a * &b);
        let square = wide(&c).mul(&wide(&c));
        prop_assert_eq!(big(&square.mul(&square)), c.pow(4));
    }

    #[test]
    fn kept_numbers_come_back(a in number(4), n: i64, m: i128) {
        let kept = wide(&a).kept();
        prop_assert_eq!(big(&kept.wide()), a);
        // Zero is one number, however it came about.
        prop_assert_eq!(wide(&BigInt::from(n)).kept(), n.into());
        prop_assert_eq!(wide(&BigInt::ZERO).neg().kept(), 0.into());
        prop_assert_eq!(big(&Wide::from(n)), BigInt::from(n));
        prop_assert_eq!(big(&Wide::from(m)), BigInt::from(m));
    }

    #[test]
    fn floating_point_is_near(a in number(11)) {
        let off: BigInt = (whole(wide(&a).to_f64()) - &a) << 52;
        prop_assert!(off.magnitude() <= a.magnitude());
    }

    #[test]
    fn residues(a in number(11), x in 0..PRIME, y in 0..PRIME) {
        let prime = BigInt::from(PRIME);
        let rest = ((&a % &prime) + &prime) % &prime;
        prop_assert_eq!(BigInt::from(wide(&a).residue()), rest);
        prop_assert_eq!(u128::from(times(x, y)), u128::from(x) * u128::from(y) % u128::from(PRIME));
        prop_assert_eq!(times(x, inverse(x)), u64::from(x != 0));
    }
}

#[test]
fn the_ends_of_the_built_in_numbers() {
    for n in [i64::MIN, i64::MAX, 0, -1, 1] {
        assert_eq!(big(&Wide::from(n)), BigInt::from(n));
        assert_eq!(big(&Wide::from(i128::from(n))), BigInt::from(n));
    }
    for n in [i128::MIN, i128::MAX] {
        assert_eq!(big(&Wide::from(n)), BigInt::from(n));
        assert_eq!(big(&Wide::from(n).mul(&Wide::from(n))), BigInt::from(n) * n);
    }
    assert_eq!(times(PRIME - 1, PRIME - 1), 1);
    assert_eq!(Wide::from(PRIME as i64).residue(), 0);
    assert_eq!(Wide::from(-(PRIME as i64)).residue(), 0);
}
