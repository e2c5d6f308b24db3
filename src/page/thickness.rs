//! How thick the walls of a solid are, measured along rays.

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use rayon::prelude::*;

use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// Triangles that one thread looks at before it asks whether to stop.
const CHUNK: usize = 1 << 12;

/// For each triangle of a closed mesh how far it is from its middle inwards, across the wall, to the surface on the other side, model
/// units; what is not a number where no surface is met. In single precision.
pub fn wall_thickness(mesh: &TriMesh, progress: &Progress) -> Result<Vec<f64>, Stopped> {
    let Some(bounds) = mesh.bounds() else { return Ok(Vec::new()) };
    let (middle, scale) = ((bounds.min + bounds.max) / 2.0, bounds.diagonal().max(f64::MIN_POSITIVE));
    let corner = |p: glam::DVec3| Vec3A::from(((p - middle) / scale).as_vec3());
    let triangle = |t: usize| {
        let [v0, v1, v2] = mesh.corners(t).map(corner);
        Triangle { v0, v1, v2 }
    };
    let triangles: Vec<Triangle> = (0..mesh.triangles.len()).map(triangle).collect();
    let tree = build_cwbvh_from_tris(&triangles, BvhBuildParams::fast_build(), &mut std::time::Duration::default());
    progress.check()?;
    let thickness = |t: usize| {
        if t.is_multiple_of(CHUNK) {
            progress.check()?;
        }
        let own = &triangles[t];
        let normal = (own.v1 - own.v0).cross(own.v2 - own.v0);
        let length = normal.length();
        if length.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return Ok(f64::NAN);
        }
        // Adding zero turns −0 into 0: the tree takes the two for opposite directions, and misses everything.
        let inwards = -normal / length + Vec3A::ZERO;
        let from = (own.v0 + own.v1 + own.v2) / 3.0;
        // Past the triangle itself, by a little more than single precision.
        let ray = Ray::new(from, inwards, 2e-6, 4.0);
        let mut hit = RayHit::none();
        tree.ray_traverse(ray, &mut hit, |ray, index| triangles[tree.primitive_indices[index] as usize].intersect(ray));
        Ok(if hit.t < 4.0 { f64::from(hit.t) * scale } else { f64::NAN })
    };
    (0..triangles.len()).into_par_iter().map(thickness).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes;
    use glam::DVec3;

    #[test]
    fn a_box_is_as_thick_as_its_sides() {
        let mesh = shapes::cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        let found = wall_thickness(&mesh, &Progress::none()).expect("nothing stops it");
        assert_eq!(found.len(), 12);
        for side in [1.0, 2.0, 3.0] {
            let count = found.iter().filter(|length| (*length - side).abs() < 1e-5).count();
            assert_eq!(count, 4, "{side}: {found:?}");
        }
    }
}
