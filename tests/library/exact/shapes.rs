//! Closed meshes that are hard in one way or another, and distances by looking at all triangles.

use glam::{DQuat, DVec3};
use meshwright::lattice::{Lattice, voxel_in_brick};
use meshwright::mesh::TriMesh;

use crate::common::shapes::{cuboid, torus};

/// An octahedron whose sides are cut in four `times` times, with vertices at radius `radius(direction)`.
pub fn ball(times: u32, radius: impl Fn(DVec3) -> f64) -> TriMesh {
    let mut triangles = Vec::new();
    for n in 0..8 {
        let axis = |k: usize| DVec3::AXES[k] * if n >> k & 1 == 0 { 1.0 } else { -1.0 };
        let [a, b, c] = [axis(0), axis(1), axis(2)];
        let odd = (n as u32).count_ones() % 2 == 1;
        triangles.push(if odd { [a, c, b] } else { [a, b, c] });
    }
    for _ in 0..times {
        let half = |p: DVec3, q: DVec3| (p + q).normalize();
        let cut = |[a, b, c]: [DVec3; 3]| {
            let (d, e, f) = (half(a, b), half(b, c), half(c, a));
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    let positions = triangles.iter().flatten().map(|&p| p * radius(p)).collect();
    let triangles = (0..triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    TriMesh { positions, triangles }.welded()
}

/// The mesh turned, so that nothing lies along an axis.
pub fn turned(mut mesh: TriMesh, angle: f64) -> TriMesh {
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, 0.0, 0.8), angle);
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p);
    mesh
}

/// A box with one corner cut into ever smaller triangles, as deep as `depth` halvings.
fn fine_corner(depth: u32) -> TriMesh {
    let mut mesh = cuboid(DVec3::ZERO, DVec3::ONE);
    for _ in 0..depth {
        // Cut every triangle at the origin's corner in four, and its neighbours to fit: all edges of the corner's
        // triangles are cut at the middle.
        let at_corner = |p: DVec3| p.length() < 1e-12;
        let triangles: Vec<[DVec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
        let cut_edges: Vec<(DVec3, DVec3)> = triangles
            .iter()
            .filter(|t| t.iter().any(|&p| at_corner(p)))
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .collect();
        let middle = |a: DVec3, b: DVec3| {
            let cut = cut_edges.iter().any(|&(p, q)| (p, q) == (a, b) || (q, p) == (a, b));
            cut.then(|| (a + b) / 2.0)
        };
        let pieces =
            triangles.iter().flat_map(|&[a, b, c]| split([a, b, c], [middle(a, b), middle(b, c), middle(c, a)]));
        let corners: Vec<[DVec3; 3]> = pieces.collect();
        let count = corners.len() as u32;
        mesh = TriMesh {
            positions: corners.into_iter().flatten().collect(),
            triangles: (0..count).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(),
        }
        .welded();
    }
    mesh
}

/// A triangle cut at the points given on its sides (from corner k to the next).
fn split([a, b, c]: [DVec3; 3], on: [Option<DVec3>; 3]) -> Vec<[DVec3; 3]> {
    match on {
        [None, None, None] => vec![[a, b, c]],
        [Some(d), None, None] => vec![[a, d, c], [d, b, c]],
        [None, Some(_), None] => split([b, c, a], [on[1], on[2], on[0]]),
        [None, None, Some(_)] => split([c, a, b], [on[2], on[0], on[1]]),
        [Some(d), Some(e), None] => vec![[d, b, e], [a, d, e], [a, e, c]],
        [None, Some(_), Some(_)] => split([b, c, a], [on[1], on[2], on[0]]),
        [Some(_), None, Some(_)] => split([c, a, b], [on[2], on[0], on[1]]),
        [Some(d), Some(e), Some(f)] => vec![[a, d, f], [d, b, e], [f, e, c], [d, e, f]],
    }
}

/// Closed meshes about 1 in size, without self-intersections.
pub fn closed() -> Vec<(&'static str, TriMesh)> {
    let mut sheets = cuboid(DVec3::new(-0.5, -0.5, 0.0), DVec3::new(0.5, 0.4, 1e-7));
    sheets.append(&cuboid(DVec3::new(-0.5, -0.5, 2e-7), DVec3::new(0.5, 0.4, 0.01)));
    let saddles = |p: DVec3| 0.5 + 0.06 * (14.0 * p.x).sin() * (13.0 * p.y).sin() * (12.0 * p.z).cos();
    let spikes = |p: DVec3| 0.2 + 0.3 * (9.0 * p.x).sin().powi(2) * (8.0 * p.y + 5.0 * p.z).cos().powi(2);
    vec![
        ("box", turned(cuboid(DVec3::ZERO, DVec3::new(1.0, 0.7, 0.4)), 0.7)),
        ("box along the axes", cuboid(DVec3::splat(-0.4), DVec3::splat(0.4))),
        ("torus", turned(torus(32, 16), 0.3)),
        ("saddles", ball(5, saddles)),
        ("spikes", ball(4, spikes)),
        ("sheets back to back", turned(sheets.clone(), 1.1)),
        ("sheets along the axes", sheets),
        ("tiny and huge triangles", turned(fine_corner(24), 0.2)),
        ("coarse ball", ball(1, |_| 0.5)),
    ]
}

/// A lattice of spacing `h` around the mesh and `room` (h) beyond.
pub fn lattice(mesh: &TriMesh, h: f64, room: i32) -> Lattice {
    let mut lattice = Lattice::around(&mesh.bounds().expect("triangles"), h);
    lattice.origin -= DVec3::splat(f64::from(room) * h);
    lattice.dims += 2 * room;
    lattice
}

/// Voxel number `n` of brick `brick`.
pub fn voxel(brick: glam::IVec3, n: usize) -> glam::IVec3 {
    brick * 8 + voxel_in_brick(n)
}

/// Distance from a triangle, by its plane and its three sides.
pub fn distance_to(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_side = |a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(if t.is_finite() { a.lerp(b, t) } else { a })
    };
    let normal = (b - a).cross(c - a);
    let over = [(a, b), (b, c), (c, a)].iter().all(|&(from, to)| normal.cross(to - from).dot(p - from) >= 0.0);
    let to_plane = (p - a).dot(normal.normalize_or_zero()).abs();
    let sides = to_side(a, b).min(to_side(b, c)).min(to_side(c, a));
    if over && normal != DVec3::ZERO { to_plane.min(sides) } else { sides }
}

/// How often the surface winds around `p`, by the solid angles of all triangles.
pub fn winding(mesh: &TriMesh, p: DVec3) -> f64 {
    let solid_angle = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|q| q - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    (0..mesh.triangles.len()).map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// The distance by looking at all triangles, and the side by the winding number.
pub fn by_looking(mesh: &TriMesh, p: DVec3) -> f64 {
    let distance = (0..mesh.triangles.len()).map(|t| distance_to(p, mesh.corners(t))).fold(f64::INFINITY, f64::min);
    if winding(mesh, p) > 0.5 { -distance } else { distance }
}

/// Points spread over a box, always the same.
pub fn spread(low: DVec3, high: DVec3, count: usize) -> Vec<DVec3> {
    // The additive sequence of the cube's golden ratio fills space evenly.
    let step = DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3);
    (1..=count).map(|n| low + (high - low) * (step * n as f64 + 0.5).fract()).collect()
}
