//! Far from the origin: the pipelines work near it, and the results go back.

use std::borrow::Cow;

use glam::DVec3;

use super::{Precision, Report, SurfaceOptions};
use crate::field::{Placement, Shared, placed};
use crate::lattice::Lattice;
use crate::mesh::{Bounds, TriMesh};
use crate::vote::VoteReport;

/// Operands farther away than so many times their longest side are far. Nearer ones stay where they are: there single precision still
/// resolves half a millionth of them, and what is made has coordinates that STL holds.
const FAR: f64 = 16.0;

/// Steps of single precision in a voxel, at least, where a result in these numbers is made: 256 put what is fitted off by at most
/// 0.002 h.
const LEAST_STEPS: f64 = 256.0;

/// Where the pipelines' origin lies, model units. Along an axis on which the operands lie far away, it is moved beside them. There, taking it off a coordinate and adding it again is exact in `f64`: the two are within a
/// factor of two of each other (Sterbenz). Along the others single precision resolves the operands as they are.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Frame {
    origin: DVec3,
}

impl Frame {
    /// The frame of operands in a box.
    pub(super) fn around(bounds: &Bounds) -> Self {
        // A multiple of a power of two, so that most sums with it are exact, too.
        let longest = bounds.size().max_element();
        let unit = 2f64.powi(longest.max(f64::MIN_POSITIVE).log2().floor() as i32);
        let origin = |low: f64, high: f64| {
            let (near, far) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
            let is_within = |c: f64| near >= c.abs() / 2.0 && far <= 2.0 * c.abs();
            let middle = low / 2.0 + high / 2.0;
            let round = (middle / unit).round() * unit;
            let is_far = low.signum() == high.signum() && far > FAR * longest && far < f64::MAX;
            [round, middle].into_iter().find(|&c| is_far && is_within(c)).unwrap_or(0.0)
        };
        let (low, high) = (bounds.min, bounds.max);
        Self { origin: DVec3::new(origin(low.x, high.x), origin(low.y, high.y), origin(low.z, high.z)) }
    }

    /// The frame of several operands, whatever is wrong with them.
    pub(super) fn of(operands: &[&TriMesh], options: &SurfaceOptions) -> Self {
        let bounds = operands.iter().filter_map(|mesh| mesh.bounds()).reduce(|a, b| a.union(&b));
        bounds.map_or(Self::default(), |bounds| Self::of_box(&bounds, options))
    }

    /// The frame of operands in a box. A result in single precision is made where it will be as long as there are enough steps to a
    /// voxel: then it is valid in these numbers, while one that is moved there is rounded again.
    pub(super) fn of_box(bounds: &Bounds, options: &SurfaceOptions) -> Self {
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element();
        let step = farthest * f64::from(f32::EPSILON);
        let h = options.voxel.spacing(bounds.size().max_element());
        let stays = options.precision == Precision::Single && step * LEAST_STEPS <= h;
        if stays { Self::default() } else { Self::around(bounds) }
    }

    /// A box as the pipelines see it.
    pub(super) fn local_bounds(&self, bounds: &Bounds) -> Bounds {
        Bounds { min: bounds.min - self.origin, max: bounds.max - self.origin }
    }

    /// An operand as the pipelines see it.
    pub(super) fn local<'a>(&self, mesh: &'a TriMesh) -> Cow<'a, TriMesh> {
        if self.origin == DVec3::ZERO {
            return Cow::Borrowed(mesh);
        }
        Cow::Owned(TriMesh {
            positions: mesh.positions.iter().map(|&p| p - self.origin).collect(),
            triangles: mesh.triangles.clone(),
        })
    }

    /// A field as the pipelines see it.
    pub(super) fn local_field(&self, field: &Shared) -> Shared {
        if self.origin == DVec3::ZERO { field.clone() } else { placed(field.clone(), Placement::moved(-self.origin)) }
    }

    /// Moves a mesh to where the operands are.
    pub(super) fn mesh(&self, mesh: &mut TriMesh) {
        if self.origin != DVec3::ZERO {
            mesh.positions.iter_mut().for_each(|p| *p += self.origin);
        }
    }

    /// A lattice where the operands are.
    pub(super) fn global_lattice(&self, lattice: Lattice) -> Lattice {
        Lattice { origin: lattice.origin + self.origin, ..lattice }
    }

    /// The places of votes where the operands are.
    pub(super) fn votes(&self, vote: &mut VoteReport) {
        for region in &mut vote.doubtful_regions {
            self.place(&mut region.min);
            self.place(&mut region.max);
        }
    }

    /// Moves a place to where the operands are.
    pub(super) fn place(&self, p: &mut [f64; 3]) {
        *p = (DVec3::from_array(*p) + self.origin).to_array();
    }

    /// Moves the places of a report to where the operands are.
    pub(super) fn report(&self, report: &mut Report) {
        self.votes(&mut report.vote);
        for region in &mut report.thin.regions {
            self.place(&mut region.min);
            self.place(&mut region.max);
        }
        report.holes.iter_mut().for_each(|hole| self.place(&mut hole.centre));
        if let Some(topology) = &mut report.topology {
            topology.lost.iter_mut().for_each(|lost| self.place(&mut lost.at));
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn there_and_back_is_exact_and_what_is_far_comes_near(
            centre in prop::array::uniform3(prop_oneof![-1e7f64..1e7, -10f64..10.0, Just(0.0)]),
            size in 1e-3f64..1e3, share in prop::collection::vec(prop::array::uniform3(0.0f64..1.0), 2..20)
        ) {
            let centre = DVec3::from_array(centre);
            let at = |s: &[f64; 3]| centre + size * DVec3::from_array(*s);
            let positions: Vec<DVec3> = share.iter().map(at).collect();
            let bounds = Bounds::of(positions.iter().copied()).unwrap();
            let frame = Frame::around(&bounds);
            for p in &positions {
                prop_assert_eq!((*p - frame.origin) + frame.origin, *p);
            }
            let local = frame.local_bounds(&bounds);
            // Whatever the axis, what is left is not far.
            let longest = bounds.size().max_element();
            let farthest = local.min.abs().max(local.max.abs()).max_element();
            prop_assert!(farthest <= FAR * longest, "{farthest} of {longest}");
        }
    }
}
