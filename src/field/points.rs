//! The distance to a cloud of points.

use glam::DVec3;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;

use super::filter::uniform;
use super::{Ball, Extent, Field, Range, Sample};
use crate::mesh::{Bounds, ClosestTree};

/// The distance to the nearest of some points: never negative, so that it has an inside only once it is offset.
pub struct PointField {
    tree: ClosestTree<[DVec3; 2]>,
}

impl PointField {
    /// The distance to `points`, model units.
    pub fn new(points: &[DVec3]) -> Self {
        Self { tree: ClosestTree::new(points.iter().map(|&p| [p, p]).collect()) }
    }
}

/// `count` points in `bounds`, each place as likely as any other; the same for the same `seed` always.
pub fn scattered(count: usize, seed: u64, bounds: &Bounds) -> Vec<DVec3> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut place = || DVec3::from_array(std::array::from_fn(|_| uniform(&mut random)));
    (0..count).map(|_| bounds.min + bounds.size() * place()).collect()
}

impl Field for PointField {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        let mut found = Vec::with_capacity(points.len());
        self.tree.nearest_all(points, &mut found);
        values.fill(f64::INFINITY);
        values.iter_mut().zip(&found).for_each(|(value, closest)| *value = closest.distance);
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        let mut found = Vec::with_capacity(points.len());
        self.tree.nearest_all(points, &mut found);
        samples.fill(Sample { value: f64::INFINITY, gradient: DVec3::ZERO });
        samples.iter_mut().zip(points).zip(&found).for_each(|((sample, p), closest)| {
            *sample = Sample { value: closest.distance, gradient: (p - closest.point).normalize_or_zero() };
        });
    }

    fn range(&self, ball: &Ball) -> Range {
        let range = Range::around(self.value(ball.centre), ball.radius);
        Range { min: range.min.max(0.0), ..range }
    }

    fn lipschitz(&self) -> f64 {
        1.0
    }

    fn extent(&self) -> Extent {
        // The points themselves, where the value is 0: offsets grow from them.
        Extent::of(self.tree.bounds())
    }
}
