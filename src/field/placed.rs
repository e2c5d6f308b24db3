//! A field elsewhere, larger or turned.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::cubes::Scaled;
use super::{Ball, Cubes, Extent, Field, Range, Sample, Shared};
use crate::mesh::Bounds;

/// A similarity: turned about the origin, made larger, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// The turn, a rotation.
    pub turn: DMat3,
    /// How many times as large, more than 0.
    pub scale: f64,
    /// By how much it is moved, model units.
    pub shift: DVec3,
}

impl Placement {
    /// A shift without turning or scaling.
    pub fn moved(shift: DVec3) -> Self {
        Self { turn: DMat3::IDENTITY, scale: 1.0, shift }
    }

    /// A scaling by `scale` about `centre`.
    pub fn scaled(scale: f64, centre: DVec3) -> Self {
        Self { turn: DMat3::IDENTITY, scale, shift: centre * (1.0 - scale) }
    }

    /// A turn by `angle`, radians, counterclockwise seen against coordinate axis `axis` through `centre`.
    pub fn turned(axis: usize, angle: f64, centre: DVec3) -> Self {
        let turn = DMat3::from_axis_angle(DVec3::AXES[axis % 3], angle);
        Self { turn, scale: 1.0, shift: centre - turn * centre }
    }

    /// The scaling and shift by which the centre and the longest side of the box `from` become those of `to`.
    pub fn fitted(from: &Bounds, to: &Bounds) -> Self {
        let scale = to.size().max_element() / from.size().max_element();
        let [from, to] = [from, to].map(|b| (b.min + b.max) / 2.0);
        Self { turn: DMat3::IDENTITY, scale, shift: to - from * scale }
    }

    fn back(&self, p: DVec3) -> DVec3 {
        self.turn.transpose() * (p - self.shift) / self.scale
    }

    fn forth(&self, p: DVec3) -> DVec3 {
        self.turn * (p * self.scale) + self.shift
    }
}

/// `field` where `placement` brings it. Values are lengths and grow with it.
pub fn placed(field: Shared, placement: Placement) -> Shared {
    Arc::new(Placed { field, placement })
}

struct Placed {
    field: Shared,
    placement: Placement,
}

impl Placed {
    fn places(&self, points: &[DVec3]) -> Vec<DVec3> {
        points.iter().map(|&p| self.placement.back(p)).collect()
    }
}

impl Field for Placed {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        self.field.values(&self.places(points), values);
        values.iter_mut().for_each(|value| *value *= self.placement.scale);
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        self.field.samples(&self.places(points), samples);
        for sample in samples {
            *sample =
                Sample { value: sample.value * self.placement.scale, gradient: self.placement.turn * sample.gradient };
        }
    }

    fn range(&self, ball: &Ball) -> Range {
        let (centre, radius) = (self.placement.back(ball.centre), ball.radius / self.placement.scale);
        self.field.range(&Ball { centre, radius }).times(self.placement.scale)
    }

    fn over(&self, origin: DVec3, h: f64) -> Option<Arc<dyn Cubes>> {
        // A turned lattice is none.
        if self.placement.turn != DMat3::IDENTITY {
            return None;
        }
        let scale = self.placement.scale;
        Some(Arc::new(Scaled { cubes: self.field.over(self.placement.back(origin), h / scale)?, scale }))
    }

    fn lipschitz(&self) -> f64 {
        self.field.lipschitz()
    }

    fn extent(&self) -> Extent {
        let Extent::Within(bounds) = self.field.extent() else { return self.field.extent() };
        let corner =
            |k: u32| DVec3::from([0, 1, 2].map(|axis| [bounds.min, bounds.max][(k >> axis & 1) as usize][axis]));
        Extent::of(Bounds::of((0..8).map(|k| self.placement.forth(corner(k)))))
    }
}
