//! Closed shapes made here.

use glam::{DQuat, DVec3};
use meshwright::mesh::TriMesh;

/// Shape number `which` (0 to 3) and its name.
pub fn closed(which: usize) -> (&'static str, TriMesh) {
    match which {
        0 => ("box", cuboid(DVec3::ZERO, DVec3::new(1.0, 0.7, 0.4))),
        1 => ("torus", torus(64, 32)),
        2 => ("thin torus", torus_of(48, 6, 1.0, 0.02)),
        _ => {
            let mut two = cuboid(DVec3::ZERO, DVec3::ONE);
            two.append(&torus_of(20, 10, 1.1, 0.3));
            ("overlapping shells", two)
        }
    }
}

/// An axis-aligned box of 12 triangles.
pub fn cuboid(min: DVec3, max: DVec3) -> TriMesh {
    let corner = |n: usize| {
        let pick = |bit: usize, low: f64, high: f64| if n >> bit & 1 == 1 { high } else { low };
        DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriMesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect(),
    }
}

/// A torus around z of radii 1 and 0.35.
pub fn torus(around: u32, tube: u32) -> TriMesh {
    torus_of(around, tube, 1.0, 0.35)
}

/// A torus around z.
pub fn torus_of(around: u32, tube: u32, radius: f64, tube_radius: f64) -> TriMesh {
    let turn = std::f64::consts::TAU;
    let vertex = |n: u32| {
        let (a, t) = (turn * (n / tube) as f64 / around as f64, turn * (n % tube) as f64 / tube as f64);
        let r = radius + tube_radius * t.cos();
        DVec3::new(r * a.cos(), r * a.sin(), tube_radius * t.sin())
    };
    closed_tube(around, tube, vertex)
}

/// A tube that ends where it begins: `around` rings of `tube` vertices each, ring after ring.
fn closed_tube(around: u32, tube: u32, vertex: impl Fn(u32) -> DVec3) -> TriMesh {
    let index = |i: u32, j: u32| (i % around) * tube + j % tube;
    let quad = |n: u32| {
        let (i, j) = (n / tube, n % tube);
        let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    TriMesh {
        positions: (0..around * tube).map(vertex).collect(),
        triangles: (0..around * tube).flat_map(quad).collect(),
    }
}

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

/// Closed meshes about 1 in size, each hard in its own way, without self-intersections.
pub fn hard() -> Vec<(&'static str, TriMesh)> {
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

/// A tube of radius 0.4 along a trefoil, `around` x `tube` quads: it bends everywhere and passes itself three times.
pub fn knot(around: u32, tube: u32) -> TriMesh {
    let turn = std::f64::consts::TAU;
    let ring = |t: f64| DVec3::new((2.0 * t).cos(), (2.0 * t).sin(), 0.0);
    // The curve winds around a torus of radii 2 and 1, and the torus's own normal gives the tube a frame.
    let normal = |t: f64| ring(t) * (3.0 * t).cos() + DVec3::Z * (3.0 * t).sin();
    let middle = |t: f64| ring(t) * 2.0 + normal(t);
    let vertex = |n: u32| {
        let (t, u) = (turn * f64::from(n / tube) / f64::from(around), turn * f64::from(n % tube) / f64::from(tube));
        let along = (middle(t + 1e-4) - middle(t - 1e-4)).normalize();
        middle(t) + 0.4 * (normal(t) * u.cos() + normal(t).cross(along).normalize() * u.sin())
    };
    closed_tube(around, tube, vertex)
}

/// A gear wheel with a bore: long thin triangles, sharp edges that bend inwards and outwards.
pub fn gear(teeth: u32) -> TriMesh {
    let count = 4 * teeth;
    let ring = |bore: bool, z: f64| {
        (0..count).map(move |k| {
            let part = [0.0, 0.4, 0.5, 0.9][k as usize % 4] + f64::from(k / 4);
            let angle = std::f64::consts::TAU * part / f64::from(teeth);
            let radius = if bore { 0.4 } else { [1.0, 1.0, 0.8, 0.8][k as usize % 4] };
            DVec3::new(radius * angle.cos(), radius * angle.sin(), z)
        })
    };
    let positions = [(false, 0.0), (false, 0.3), (true, 0.3), (true, 0.0)].into_iter().flat_map(|(b, z)| ring(b, z));
    let quad = |n: u32| {
        // Outside, top, bore and bottom, in turn.
        let (side, k) = (n / count, n % count);
        let at = |side: u32, k: u32| side % 4 * count + k % count;
        let [a, b, c, d] = [at(side, k), at(side, k + 1), at(side + 1, k + 1), at(side + 1, k)];
        [[a, b, c], [a, c, d]]
    };
    TriMesh { positions: positions.collect(), triangles: (0..4 * count).flat_map(quad).collect() }
}

/// Eight gear wheels above each other, `gap` apart, tilted so that nothing lies along an axis.
pub fn stack(gap: f64) -> TriMesh {
    let mut all = TriMesh::default();
    for n in 0..8 {
        let mut wheel = gear(12);
        wheel.positions.iter_mut().for_each(|p| p.z += f64::from(n) * (0.3 + gap));
        all.append(&wheel);
    }
    turned(all, 0.5)
}

/// What a scanner leaves: a rough ball of 32,768 triangles with 40 holes.
pub fn scan() -> TriMesh {
    let mut scan = ball(6, |p| 1.0 + 0.02 * (31.0 * p.x).sin() * (29.0 * p.y).cos() + 0.1 * (4.0 * p.z).sin());
    let holes: Vec<DVec3> = scan.positions.iter().step_by(scan.positions.len() / 40).copied().collect();
    let kept: Vec<usize> = (0..scan.triangles.len())
        .filter(|&t| holes.iter().all(|hole| scan.corners(t)[0].distance(*hole) > 0.04))
        .collect();
    scan.triangles = kept.into_iter().map(|t| scan.triangles[t]).collect();
    scan
}
