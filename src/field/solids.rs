//! Bodies with a formula.

use glam::DVec3;

use super::{Ball, Extent, Field, Range, Sample};
use crate::mesh::Bounds;

/// A body about the origin; its axis, where it has one, is z. Lengths are model units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solid {
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A box with sides along the axes.
    Box {
        /// Its edges.
        size: DVec3,
    },
    /// A cylinder around z.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// From bottom to top.
        height: f64,
    },
    /// A torus around z.
    Torus {
        /// From the axis to the middle of the tube.
        major: f64,
        /// Radius of the tube.
        minor: f64,
    },
    /// All that lies below the plane z = 0.
    HalfSpace,
}

/// A body where it stands: its exact distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// The shape of the body.
    pub solid: Solid,
    /// Where the centre of the body is, model units.
    pub centre: DVec3,
    /// The coordinate axis along which the z-axis of the shape lies: 0, 1 or 2 for x, y or z.
    pub axis: usize,
}

impl Body {
    /// Into the body's own coordinates: the axis becomes z, by turning the coordinates around.
    fn own(&self, p: DVec3) -> DVec3 {
        let p = p - self.centre;
        DVec3::new(p[(self.axis + 1) % 3], p[(self.axis + 2) % 3], p[self.axis % 3])
    }

    /// A direction from the body's own coordinates.
    fn back(&self, own: DVec3) -> DVec3 {
        let mut direction = DVec3::ZERO;
        for k in 0..3 {
            direction[(self.axis + 1 + k) % 3] = own[k];
        }
        direction
    }

    fn at(&self, p: DVec3) -> Sample {
        let sample = self.solid.at(self.own(p));
        Sample { gradient: self.back(sample.gradient), ..sample }
    }
}

/// The distance to a box, in two or three dimensions, of which `off` says how far out the point is along each axis.
fn corner(off: DVec3, towards: DVec3) -> Sample {
    let out = off.max(DVec3::ZERO);
    if out != DVec3::ZERO {
        return Sample { value: out.length(), gradient: out.normalize() * towards };
    }
    let axis = (0..3).max_by(|&a, &b| off[a].total_cmp(&off[b])).unwrap_or(0);
    Sample { value: off[axis], gradient: DVec3::AXES[axis] * towards }
}

impl Solid {
    fn at(&self, p: DVec3) -> Sample {
        let round = DVec3::new(p.x, p.y, 0.0);
        match *self {
            Self::Sphere { radius } => {
                Sample { value: p.length() - radius, gradient: p.try_normalize().unwrap_or(DVec3::Z) }
            }
            Self::Box { size } => corner(p.abs() - size / 2.0, p.signum()),
            Self::Cylinder { radius, height } => {
                let away = round.try_normalize().unwrap_or(DVec3::X);
                let off = DVec3::new(round.length() - radius, f64::NEG_INFINITY, p.z.abs() - height / 2.0);
                let flat = corner(off, DVec3::ONE);
                let up = DVec3::Z * p.z.signum();
                Sample { gradient: away * flat.gradient.x + up * flat.gradient.z, ..flat }
            }
            Self::Torus { major, minor } => {
                let ring = round.try_normalize().unwrap_or(DVec3::X) * major;
                let from = p - ring;
                Sample { value: from.length() - minor, gradient: from.try_normalize().unwrap_or(DVec3::Z) }
            }
            Self::HalfSpace => Sample { value: p.z, gradient: DVec3::Z },
        }
    }

    /// Half of the box around it, own coordinates; `None` without an end.
    fn half(&self) -> Option<DVec3> {
        match *self {
            Self::Sphere { radius } => Some(DVec3::splat(radius)),
            Self::Box { size } => Some(size / 2.0),
            Self::Cylinder { radius, height } => Some(DVec3::new(radius, radius, height / 2.0)),
            Self::Torus { major, minor } => Some(DVec3::new(major + minor, major + minor, minor)),
            Self::HalfSpace => None,
        }
    }
}

impl Field for Body {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        values.iter_mut().zip(points).for_each(|(value, &p)| *value = self.at(p).value);
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        samples.iter_mut().zip(points).for_each(|(sample, &p)| *sample = self.at(p));
    }

    fn range(&self, ball: &Ball) -> Range {
        Range::around(self.at(ball.centre).value, ball.radius)
    }

    fn lipschitz(&self) -> f64 {
        1.0
    }

    fn extent(&self) -> Extent {
        let Some(half) = self.solid.half() else { return Extent::Unbounded };
        let half = self.back(half);
        Extent::Within(Bounds { min: self.centre - half, max: self.centre + half })
    }
}
