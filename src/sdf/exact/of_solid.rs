//! The distance to a solid at points: the simplest question there is to ask of one.

use glam::DVec3;
use rayon::prelude::*;

use super::{ExactDistance, PointSign};
use crate::mesh::Solid;

/// The exact signed distance to a [`Solid`], at any point. Made by [`Solid::distance`], which builds a tree over the triangles; a question
/// takes about a microsecond.
pub struct SolidDistance {
    exact: ExactDistance,
}

impl Solid {
    /// The exact signed distance to the surface, to be asked at points.
    pub fn distance(&self) -> SolidDistance {
        SolidDistance { exact: ExactDistance::of(self, PointSign::Pseudonormal) }
    }
}

impl SolidDistance {
    /// The distance at a point, model units; negative inside. A point whose coordinates are no numbers is infinitely far.
    pub fn at(&self, p: DVec3) -> f64 {
        self.exact.at(p).map_or(f64::INFINITY, |nearest| nearest.signed)
    }

    /// The distances at many points, on all threads, in the order of the points.
    pub fn at_all(&self, points: &[DVec3]) -> Vec<f64> {
        points.par_iter().map(|&p| self.at(p)).collect()
    }

    /// Whether a point lies inside; points of the surface do not.
    pub fn contains(&self, p: DVec3) -> bool {
        self.at(p) < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::cuboid;

    #[test]
    fn points_in_and_around_a_box_have_their_distance() {
        let solid = Solid::try_from(cuboid(DVec3::ZERO, DVec3::splat(2.0))).expect("a box");
        let distance = solid.distance();
        let asked = [DVec3::ONE, DVec3::new(3.0, 1.0, 1.0), DVec3::new(3.0, 3.0, 1.0), DVec3::new(2.0, 1.0, 1.0)];
        let expected = [-1.0, 1.0, 2f64.sqrt(), 0.0];
        assert_eq!(distance.at_all(&asked), expected);
        assert_eq!(asked.map(|p| distance.contains(p)), [true, false, false, false]);
        assert_eq!(distance.at(DVec3::splat(f64::NAN)), f64::INFINITY);
    }
}
