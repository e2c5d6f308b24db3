//! Voxel sets as grids, random crossings, and a slow exact judge of meshes.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DVec3, IVec3};
use meshwright::contour::{
    Collapsed, Contour, ContourOptions, Crossing, Ground, LatticeEdge, Merge, collapse_same_voxel, contour,
};
use meshwright::lattice::{Bricks, DistanceField, Grid, Lattice, brick_of, index_in_brick};
use meshwright::mesh::{Plane, TriMesh, ValidateOptions, validate};
use meshwright::progress::Progress;

/// A set of inside voxels in an otherwise empty lattice.
pub struct Case {
    pub lattice: Lattice,
    pub distance: DistanceField,
    pub seed: u64,
    /// Share of the crossings that lie at the very ends of their edge; the next share has none.
    pub extreme: f64,
    pub interpolated: f64,
}

/// A number in 0..1 that depends on the arguments alone.
pub fn noise(seed: u64, v: IVec3, channel: u32) -> f64 {
    let mut x = seed ^ (channel as u64) << 56;
    for c in v.to_array() {
        x = (x ^ c as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        x ^= x >> 29;
        x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x ^= x >> 32;
    }
    (x >> 11) as f64 / (1u64 << 53) as f64
}

impl Case {
    /// The voxels of 0..dims for which `inside` holds. Only bricks with a change of sign are active.
    pub fn new(dims: IVec3, seed: u64, inside: impl Fn(IVec3) -> bool) -> Self {
        let lattice = Lattice { origin: DVec3::new(-0.37, 1.21, 0.083), h: 0.1, dims };
        let inside = |v: IVec3| v.cmpge(IVec3::ZERO).all() && v.cmplt(dims).all() && inside(v);
        let voxels = |low: IVec3, high: IVec3| {
            (low.z..high.z)
                .flat_map(move |z| (low.y..high.y).flat_map(move |y| (low.x..high.x).map(move |x| IVec3::new(x, y, z))))
        };
        let mut active = BTreeSet::new();
        for v in voxels(IVec3::splat(-1), dims) {
            for step in IVec3::AXES {
                if inside(v) != inside(v + step) {
                    active.extend([brick_of(v), brick_of(v + step)].map(|b| b.to_array()));
                }
            }
        }
        let mut bricks = Bricks::new(active.iter().map(|&b| IVec3::from_array(b)));
        for b in voxels(IVec3::ZERO, brick_of(dims) + 1) {
            if inside(b * 8) {
                bricks.set_inside(b);
            }
        }
        let mut distance = Grid::filled(Arc::new(bricks), 0.0, -2.0, 2.0);
        for (n, &b) in distance.bricks.clone().active().iter().enumerate() {
            for v in voxels(b * 8, b * 8 + 8) {
                let d = (0.02 + 1.5 * noise(seed, v, 7)) as f32;
                distance.values[n][index_in_brick(v)] = if inside(v) { -d } else { d };
            }
        }
        let distance = DistanceField::in_voxels(lattice, distance);
        Self { lattice, distance, seed, extreme: 0.3, interpolated: 0.2 }
    }

    /// A crossing for most edges: some extreme, some absent. Each has its own source triangle.
    pub fn crossing(&self, edge: LatticeEdge) -> Option<Crossing> {
        let [kind, t] = [0, 1].map(|k| noise(self.seed, edge.voxel, 8 * k + u32::from(edge.axis)));
        let triangle = (noise(self.seed, edge.voxel, 32 + u32::from(edge.axis)) * 1000.0) as u32;
        let t = if kind < self.extreme { t.round() } else { t };
        (kind < 1.0 - self.interpolated).then_some(Crossing { t, triangle: Some(triangle) })
    }

    pub fn contour(&self) -> Contour {
        let crossing = |edge| self.crossing(edge);
        contour(&self.distance, &crossing, &ContourOptions::default(), &Progress::none()).unwrap()
    }
}

impl Case {
    /// A contour after the collapse, with planes that have nothing to do with the surface.
    pub fn collapsed(&self, raw: Contour) -> Collapsed {
        let planes = |ground: Ground| {
            let Ground::Triangle(triangle) = ground else { return None };
            let n = [0, 1, 2, 3].map(|k| noise(self.seed, IVec3::splat(triangle as i32), 64 + k));
            let normal = (DVec3::new(n[0], n[1], n[2]) - 0.5).try_normalize()?;
            let centre = self.lattice.to_model(self.lattice.dims.as_dvec3() * n[3]);
            (!triangle.is_multiple_of(5)).then_some(Plane { normal, offset: normal.dot(centre) })
        };
        collapse_same_voxel(raw, &self.lattice, &planes, Merge::All, &Progress::none()).unwrap()
    }
}

/// What is wrong with a mesh that should be valid, with every coordinate exactly an `f32`.
pub fn fault(mesh: &TriMesh) -> Option<String> {
    let validity = validate(mesh, &ValidateOptions::default(), &Progress::none()).unwrap();
    let sound = mesh.triangles.is_empty() || validity.is_valid() && validity.unused_vertices == 0;
    let rounded = mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p);
    (!sound || !rounded).then(|| format!("all f32: {rounded}, {validity:?}"))
}

/// Volume enclosed, model units.
pub fn enclosed(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}
