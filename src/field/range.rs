//! Intervals of values, balls and boxes that bound them.

use glam::DVec3;

use crate::mesh::Bounds;

/// A ball in which a field is bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// The centre of the ball, model units.
    pub centre: DVec3,
    /// The radius of the ball, model units.
    pub radius: f64,
}

/// All values from the least to the most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The least value.
    pub min: f64,
    /// The greatest value.
    pub max: f64,
}

impl Range {
    /// Any value at all.
    pub const ALL: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY };

    /// The values around `value` that are not farther off than `by`.
    pub fn around(value: f64, by: f64) -> Self {
        Self { min: value - by, max: value + by }
    }

    /// The least range with these values.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let none = Self { min: f64::INFINITY, max: f64::NEG_INFINITY };
        values.into_iter().fold(none, |range, v| Self { min: range.min.min(v), max: range.max.max(v) })
    }

    /// The values that both ranges have.
    pub fn and(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The least range that has the values of both.
    pub fn or(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The range of absolute values.
    pub fn abs(self) -> Self {
        let most = self.min.abs().max(self.max.abs());
        Self { min: self.min.max(-self.max).max(0.0), max: most }
    }

    /// The range after a function that never falls.
    pub fn rising(self, function: impl Fn(f64) -> f64) -> Self {
        Self { min: function(self.min), max: function(self.max) }
    }

    /// The range times a number.
    pub fn times(self, factor: f64) -> Self {
        let ends = self.rising(|v| v * factor);
        if factor < 0.0 { Self { min: ends.max, max: ends.min } } else { ends }
    }

    /// The range of the sums.
    pub fn plus(self, other: Self) -> Self {
        Self { min: self.min + other.min, max: self.max + other.max }
    }
}

/// Where a field may be zero or less.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Extent {
    /// The field is positive everywhere.
    Empty,
    /// The field is positive outside of this box, model units.
    Within(Bounds),
    /// Nothing bounds where the field may be negative.
    Unbounded,
}

impl Extent {
    /// The box around `mesh` points, or nothing.
    pub fn of(bounds: Option<Bounds>) -> Self {
        bounds.map_or(Self::Empty, Self::Within)
    }

    /// The box, if there is one that holds anything.
    pub fn bounds(self) -> Option<Bounds> {
        let Self::Within(bounds) = self else { return None };
        bounds.min.cmple(bounds.max).all().then_some(bounds)
    }

    /// Where one of two fields may be zero or less.
    pub fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::Unbounded, _) | (_, Self::Unbounded) => Self::Unbounded,
            (Self::Empty, extent) | (extent, Self::Empty) => extent,
            (Self::Within(a), Self::Within(b)) => Self::Within(a.union(&b)),
        }
    }

    /// Where both of two fields may be zero or less. Boxes apart from each other give one whose least corner is beyond its greatest: it holds nothing,
    /// but grown it may.
    pub fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Empty, _) | (_, Self::Empty) => Self::Empty,
            (Self::Unbounded, extent) | (extent, Self::Unbounded) => extent,
            (Self::Within(a), Self::Within(b)) => Self::Within(Bounds { min: a.min.max(b.min), max: a.max.min(b.max) }),
        }
    }

    /// The box larger by `by` on all sides, model units.
    pub fn grown(self, by: f64) -> Self {
        let Self::Within(bounds) = self else { return self };
        Self::Within(Bounds { min: bounds.min - by, max: bounds.max + by })
    }
}
