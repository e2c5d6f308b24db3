//! Planes through a field, and how a picture shows them.

use glam::{DVec2, DVec3};

use crate::mesh::Bounds;

/// The axis that a plane is perpendicular to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// A picture shows y to the right and z up; where y points up, z to the left and y up.
    X,
    /// A picture shows x to the right and z up; where y points up, x to the right and z down.
    Y,
    /// A picture shows x to the right and y up.
    Z,
}

impl Axis {
    /// The number of the axis: 0, 1 or 2 for x, y or z.
    pub fn number(self) -> usize {
        self as usize
    }

    /// The name of the axis: x, y or z.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self.number()]
    }
}

/// An axis on a picture: its number, and whether it runs to the left or down.
pub(super) type Side = (usize, bool);

/// A rectangle in a plane perpendicular to an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlicePlane {
    /// The axis that the plane is perpendicular to.
    pub axis: Axis,
    /// Where on this axis the plane lies, model units.
    pub at: f64,
    /// The smallest coordinates of the two axes of the picture, of the one that is across first, model units.
    pub min: DVec2,
    /// The largest ones.
    pub max: DVec2,
    /// Whether the y axis of the model points up, not z.
    pub y_up: bool,
}

impl SlicePlane {
    /// The piece of the plane that lies in a box.
    pub fn through(bounds: &Bounds, axis: Axis, at: f64, y_up: bool) -> Self {
        let sides = sides(axis, y_up);
        let [min, max] = [bounds.min, bounds.max].map(|p| DVec2::from(sides.map(|(k, _)| p[k])));
        Self { axis, at, min, max, y_up }
    }

    /// The axes of the picture: across and upwards.
    pub(super) fn sides(&self) -> [Side; 2] {
        sides(self.axis, self.y_up)
    }

    /// The position, model units, of a place on the picture: 0 to 1 from the left and from below.
    pub(super) fn position(&self, place: DVec2) -> DVec3 {
        let mut p = DVec3::splat(self.at);
        for (n, (k, reversed)) in self.sides().into_iter().enumerate() {
            let share = if reversed { 1.0 - place[n] } else { place[n] };
            p[k] = self.min[n] + (self.max[n] - self.min[n]) * share;
        }
        p
    }

    /// Grown along one side, so that model units are squares on `size` pixels.
    pub(super) fn grown(&self, size: DVec2) -> Self {
        let extent = (self.max - self.min).max(DVec2::splat(f64::MIN_POSITIVE));
        let pixel = (extent / size).max_element();
        let (middle, half) = ((self.min + self.max) / 2.0, size * pixel / 2.0);
        Self { min: middle - half, max: middle + half, ..*self }
    }
}

fn sides(axis: Axis, y_up: bool) -> [Side; 2] {
    match (axis, y_up) {
        (Axis::X, false) => [(1, false), (2, false)],
        (Axis::Y, false) => [(0, false), (2, false)],
        (Axis::X, true) => [(2, true), (1, false)],
        (Axis::Y, true) => [(0, false), (2, true)],
        (Axis::Z, _) => [(0, false), (1, false)],
    }
}
