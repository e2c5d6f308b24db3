//! The distance to a mesh as a field.

use std::cell::RefCell;

use glam::{DVec3, IVec3};

use super::{Ball, Extent, Field, Range, Sample, SourceTriangle};
use crate::lattice::Lattice;
use crate::mesh::{Bounds, TriMesh};
use crate::progress::Progress;
use crate::sdf::exact::{Band, ExactDistance, ExactOptions, Nearest, PointSign, Sign, exact};

thread_local! {
    /// Room for the nearest points of a packet.
    static NEAREST: RefCell<Vec<Nearest>> = const { RefCell::new(Vec::new()) };
}

/// More than rounding adds to a distance, over it.
const ROUNDING: f64 = 1e-9;

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

    /// The triangles that may be nearest to a point of a ball, with their vertices: around a feature that may be, there are all
    /// of them.
    fn around(mesh: &TriMesh, centre: DVec3, within: f64) -> TriMesh {
        let mut numbers = vec![u32::MAX; mesh.positions.len()];
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
            let nearest = centre.clamp(a.min(b).min(c), a.max(b).max(c));
            if nearest.distance_squared(centre) > within * within {
                continue;
            }
            triangles.push(triangle.map(|v| {
                let number = &mut numbers[v as usize];
                if *number == u32::MAX {
                    *number = positions.len() as u32;
                    positions.push(mesh.positions[v as usize]);
                }
                *number
            }));
        }
        TriMesh { positions, triangles }
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

    fn over(&self, lattice: &Lattice) -> Option<Vec<f32>> {
        let mesh = self.mesh.as_ref()?;
        let last = (lattice.dims - 1).as_dvec3();
        let (centre, radius) = (lattice.to_model(last / 2.0), last.length() / 2.0 * lattice.h);
        // A point of the lattice is as far as its centre is and its radius at most, from there once more.
        let within = self.value(centre).abs() + 2.0 * (radius + lattice.h);
        let near = Self::around(mesh, centre, within * (1.0 + ROUNDING));
        let options = ExactOptions { band: Band::Full, max_memory: None };
        let found = exact(&near, lattice, Sign::Pseudonormal, &options, &Progress::none()).ok()?.into_model_units();
        let dims = lattice.dims;
        let voxels = (0..dims.element_product())
            .map(|n| IVec3::new(n % dims.x, n / dims.x % dims.y, n / dims.x / dims.y))
            .map(|voxel| found.grid.get(voxel));
        Some(voxels.collect())
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
