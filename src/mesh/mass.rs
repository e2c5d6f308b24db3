//! What a solid of even density would weigh, where its centre of mass is, and how it resists being turned.

use glam::DVec3;
use nalgebra::{Matrix3, SymmetricEigen};
use serde::{Deserialize, Serialize};

use super::TriMesh;

/// Integrals over a solid of density 1, so that its mass is its volume. Model units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MassProperties {
    /// The volume.
    pub volume: f64,
    /// The centre of mass.
    pub centre: [f64; 3],
    /// The inertia tensor about the centre of mass, rows along x, y and z.
    pub inertia: [[f64; 3]; 3],
    /// Its principal moments, the smallest first.
    pub moments: [f64; 3],
    /// The unit axis of each principal moment; together they are right-handed.
    pub axes: [[f64; 3]; 3],
}

impl MassProperties {
    /// The properties of the solid that a closed, oriented mesh bounds; voids count as empty. `None` when it has no positive volume.
    pub fn of(mesh: &TriMesh) -> Option<Self> {
        // Near the middle of the mesh no digits are lost, however far from the origin it is.
        let bounds = mesh.bounds()?;
        let middle = bounds.min.midpoint(bounds.max);
        let (mut volume, mut first, mut second) = (0.0, DVec3::ZERO, Matrix3::<f64>::zeros());
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t).map(|p| p - middle);
            let [a, b, c] = corners;
            // Six times the volume of the tetrahedron to the middle.
            let six = a.dot(b.cross(c));
            let sum = a + b + c;
            volume += six / 6.0;
            first += sum * (six / 24.0);
            // The integral of p pᵀ over a tetrahedron with one corner at the origin.
            let outer = |p: DVec3| column(p) * column(p).transpose();
            let squares = corners.iter().fold(outer(sum), |all, &p| all + outer(p));
            second += squares * (six / 120.0);
        }
        if volume.is_nan() || volume <= 0.0 {
            return None;
        }
        let centre = first / volume;
        let second = second - column(centre) * column(centre).transpose() * volume;
        let inertia = Matrix3::identity() * second.trace() - second;
        let eigen = SymmetricEigen::new(inertia);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let axis = |k: usize| {
            let v = eigen.eigenvectors.column(order[k]);
            let v = DVec3::new(v[0], v[1], v[2]).normalize_or_zero();
            // Which way it points means nothing; the largest coordinate is positive.
            let largest = v.to_array().into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(1.0);
            v * largest.signum()
        };
        let (x, y) = (axis(0), axis(1));
        Some(Self {
            volume,
            centre: (centre + middle).to_array(),
            inertia: [0, 1, 2].map(|row| [0, 1, 2].map(|k| inertia[(row, k)])),
            moments: order.map(|k| eigen.eigenvalues[k]),
            axes: [x, y, x.cross(y)].map(|v| v.to_array()),
        })
    }
}

fn column(p: DVec3) -> nalgebra::Vector3<f64> {
    nalgebra::Vector3::new(p.x, p.y, p.z)
}

/// How much of a surface hangs over, when it is printed as it stands, z up.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Overhang {
    /// The angle from the vertical beyond which a surface that faces down hangs over, degrees.
    pub degrees: f64,
    /// Area that hangs over, square model units.
    pub area: f64,
    /// Area at the lowest height, facing down: it rests on the plate and does not hang over.
    pub resting: f64,
}

/// What lies nearer than this to the lowest height, in parts of the height, rests on the plate.
const RESTS: f64 = 1e-6;

impl Overhang {
    /// Measures a mesh whose triangles face outwards, for an angle of 0 to 90 degrees.
    pub fn of(mesh: &TriMesh, degrees: f64) -> Self {
        let (low, high) = mesh.bounds().map_or((0.0, 0.0), |bounds| (bounds.min.z, bounds.max.z));
        let plate = low + RESTS * (high - low);
        let steep = degrees.to_radians().sin();
        let mut overhang = Self { degrees, area: 0.0, resting: 0.0 };
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t);
            let [a, b, c] = corners;
            let normal = (b - a).cross(c - a);
            let twice = normal.length();
            // A surface at the very angle does not hang over, however it is rounded.
            if -normal.z > (steep + 1e-9) * twice {
                let rests = corners.iter().all(|p| p.z <= plate);
                *(if rests { &mut overhang.resting } else { &mut overhang.area }) += twice / 2.0;
            }
        }
        overhang
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::cuboid;

    /// A box from `min` to `max` turned by `turn`.
    fn turned_box(min: DVec3, max: DVec3, turn: glam::DQuat) -> TriMesh {
        let mut mesh = cuboid(min, max);
        mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
        mesh
    }

    #[test]
    fn a_box_has_the_moments_of_a_box_however_it_lies() {
        let (min, max) = (DVec3::new(1e6, -3.0, 2.0), DVec3::new(1e6 + 2.0, 1.0, 8.0));
        let size = max - min;
        let mass = size.x * size.y * size.z;
        let moment = |a: f64, b: f64| mass * (a * a + b * b) / 12.0;
        let expected = [moment(size.x, size.y), moment(size.x, size.z), moment(size.y, size.z)];
        for turn in [glam::DQuat::IDENTITY, glam::DQuat::from_rotation_arc(DVec3::Z, DVec3::new(0.6, 0.0, 0.8))] {
            let found = MassProperties::of(&turned_box(min, max, turn)).expect("a volume");
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-8;
            assert!(near(found.volume, mass), "{found:?}");
            let centre = turn * min.midpoint(max);
            assert!(DVec3::from_array(found.centre).distance(centre) < 1e-8, "{found:?} instead of {centre}");
            let mut sorted = expected;
            sorted.sort_by(f64::total_cmp);
            assert!(found.moments.iter().zip(sorted).all(|(&a, b)| near(a, b)), "{found:?} instead of {sorted:?}");
            // Each axis is an eigenvector of the tensor.
            for (moment, axis) in found.moments.iter().zip(found.axes) {
                let turned = found.inertia.map(|row| DVec3::from_array(row).dot(DVec3::from_array(axis)));
                assert!(DVec3::from_array(turned).distance(DVec3::from_array(axis) * *moment) < 1e-6 * moment);
            }
        }
        let thin = TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] };
        assert_eq!(MassProperties::of(&thin), None);
    }

    #[test]
    fn what_rests_on_the_plate_does_not_hang_over() {
        let flat = cuboid(DVec3::ZERO, DVec3::new(2.0, 3.0, 4.0));
        let found = Overhang::of(&flat, 45.0);
        assert_eq!((found.area, found.resting), (0.0, 6.0));
        // Turned by 30° about x, the lower side (2 x 3) hangs over by 60° from the vertical, the other (2 x 4) by 30°.
        let turned =
            turned_box(DVec3::ZERO, DVec3::new(2.0, 3.0, 4.0), glam::DQuat::from_rotation_x(30f64.to_radians()));
        let area = |degrees: f64| Overhang::of(&turned, degrees).area;
        assert!((area(45.0) - 6.0).abs() < 1e-12 && (area(20.0) - 14.0).abs() < 1e-12, "{} {}", area(45.0), area(20.0));
        assert_eq!(area(60.0), 0.0);
    }
}
