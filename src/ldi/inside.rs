//! What counts as inside of an operand, by how often its surface winds around a point.

use serde::{Deserialize, Serialize};

/// Which winding numbers are inside. The number of an operand at a point says how often its surface runs around the point: once more for each
/// closed shell around it that faces outwards, and once less for each that faces inwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Inside {
    /// At least 1: shells that overlap fuse, and a shell that faces inwards takes away what lies in it.
    #[default]
    Positive,
    /// Any but 0: a shell encloses what lies in it whichever way it faces, and takes away only where another one is around it that
    /// faces the other way.
    Nonzero,
    /// An odd number: each shell swaps inside and outside, whichever way it faces.
    Odd,
}

impl Inside {
    /// Whether a point with this winding number is inside.
    #[inline]
    pub fn holds(self, winding: i32) -> bool {
        match self {
            Self::Positive => winding >= 1,
            Self::Nonzero => winding != 0,
            Self::Odd => winding & 1 == 1,
        }
    }

    /// The same for the generalised winding number of an open surface: the whole number nearest to it counts, of two the lower one.
    #[inline]
    pub fn holds_near(self, winding: f64) -> bool {
        self.holds(nearest(winding))
    }

    /// The same for a number that may err by as much as `error`; `None` where it depends on the error.
    #[inline]
    pub(crate) fn holds_within(self, winding: f64, error: f64) -> Option<bool> {
        let (low, high) = (nearest(winding - error), nearest(winding + error));
        let sure = match self {
            Self::Positive => self.holds(low) == self.holds(high),
            Self::Nonzero => low == high || low > 0 || high < 0,
            Self::Odd => low == high,
        };
        sure.then(|| self.holds(low))
    }

    /// Whether a number below zero says that a surface faces the wrong way: else it is as good as one above.
    pub fn needs_outward(self) -> bool {
        self == Self::Positive
    }
}

/// The whole number nearest to `winding`, of two the lower one.
#[inline]
fn nearest(winding: f64) -> i32 {
    (winding - 0.5).ceil() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Inside; 3] = [Inside::Positive, Inside::Nonzero, Inside::Odd];

    #[test]
    fn each_rule_has_its_winding_numbers() {
        let held = |inside: Inside| (-3..=3).filter(|&n| inside.holds(n)).collect::<Vec<i32>>();
        assert_eq!(ALL.map(held), [vec![1, 2, 3], vec![-3, -2, -1, 1, 2, 3], vec![-3, -1, 1, 3]]);
        assert_eq!(Inside::default(), Inside::Positive);
    }

    #[test]
    fn between_whole_numbers_the_nearest_counts_and_on_the_middle_the_lower() {
        for (winding, held) in [
            (0.5, [false, false, false]),
            (0.51, [true, true, true]),
            (1.5, [true, true, true]),
            (1.51, [true, true, false]),
            (-0.49, [false, false, false]),
            (-0.51, [false, true, true]),
            (-1.51, [false, true, false]),
        ] {
            assert_eq!(ALL.map(|inside| inside.holds_near(winding)), held, "{winding}");
        }
    }

    #[test]
    fn a_rough_number_decides_only_where_every_number_within_the_error_says_the_same() {
        for inside in ALL {
            for (winding, error) in
                (-30..=30).flat_map(|k| (0..12).map(move |e| (f64::from(k) / 10.0, f64::from(e) / 5.0)))
            {
                let within = |k: i32| inside.holds_near(winding + error * f64::from(k) / 40.0);
                let all: Vec<bool> = (-40..=40).map(within).collect();
                let same = all.iter().all(|&one| one == all[0]);
                assert_eq!(inside.holds_within(winding, error), same.then_some(all[0]), "{inside:?} {winding} {error}");
            }
        }
    }
}
