//! The distance to a mesh as a field.

use std::cell::RefCell;
use std::sync::Arc;

use glam::DVec3;

use super::cubes::Scaled;
use super::{Ball, Cubes, Extent, Field, Range, Sample, SourceTriangle};
use crate::mesh::{Bounds, TriMesh};
use crate::sdf::exact::{BlockDistance, ExactDistance, Nearest, PointSign};

thread_local! {
    /// Room for the nearest points of a packet.
    static NEAREST: RefCell<Vec<Nearest>> = const { RefCell::new(Vec::new()) };
}

/// The exact signed distance to a mesh.
pub struct MeshField {
    distance: ExactDistance,
    bounds: Option<Bounds>,
    source: u32,
    /// The mesh, where its pseudonormals tell the side.
    mesh: Option<TriMesh>,
}

impl MeshField {
    /// The distance to `mesh`, which is number `source` of the meshes that a field is made of.
    pub fn new(mesh: &TriMesh, sign: PointSign, source: u32) -> Self {
        let kept = matches!(sign, PointSign::Pseudonormal).then(|| mesh.clone());
        Self { distance: ExactDistance::of(mesh, sign), bounds: mesh.bounds(), source, mesh: kept }
    }

    fn each(&self, points: &[DVec3], mut take: impl FnMut(usize, Option<&Nearest>)) {
        NEAREST.with_borrow_mut(|nearest| {
            self.distance.packet(points, nearest);
            (0..points.len()).for_each(|k| take(k, nearest.get(k)));
        });
    }
}

impl Field for MeshField {
    fn values(&self, points: &[DVec3], values: &mut [f64]) {
        self.each(points, |k, nearest| values[k] = nearest.map_or(f64::INFINITY, |nearest| nearest.signed));
    }

    fn samples(&self, points: &[DVec3], samples: &mut [Sample]) {
        let nothing = Sample { value: f64::INFINITY, gradient: DVec3::ZERO };
        let of = |nearest: &Nearest| Sample { value: nearest.signed, gradient: nearest.gradient };
        self.each(points, |k, nearest| samples[k] = nearest.map_or(nothing, of));
    }

    fn range(&self, ball: &Ball) -> Range {
        Range::around(self.value(ball.centre), ball.radius)
    }

    fn over(&self, origin: DVec3, h: f64) -> Option<Arc<dyn Cubes>> {
        let cubes = Arc::new(BlockDistance::of(self.mesh.as_ref()?, origin, h)?);
        Some(Arc::new(Scaled { cubes, scale: h }))
    }

    fn lipschitz(&self) -> f64 {
        1.0
    }

    fn extent(&self) -> Extent {
        Extent::of(self.bounds)
    }

    fn source_triangle(&self, p: DVec3, within: f64) -> Option<SourceTriangle> {
        let nearest = self.distance.within(p, within)?;
        Some(SourceTriangle { source: self.source, triangle: nearest.triangle })
    }
}
