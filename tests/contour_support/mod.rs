//! Voxel sets as grids, random crossings, and a slow exact judge of meshes.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{DVec3, IVec3};
use meshwright::contour::{Collapsed, Contour, ContourOptions, Crossing, Edge, collapse_same_voxel, contour};
use meshwright::lattice::{Bricks, Grid, Lattice, brick_of, index_in_brick};
use meshwright::mesh::{TriMesh, ValidateOptions, validate};
use meshwright::progress::Progress;

/// A set of inside voxels in an otherwise empty lattice.
pub struct Case {
    pub lattice: Lattice,
    pub distance: Grid<f32>,
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
        Self { lattice, distance, seed, extreme: 0.3, interpolated: 0.2 }
    }

    /// A crossing for most edges: some extreme, some absent. Each has its own source triangle.
    pub fn crossing(&self, edge: Edge) -> Option<Crossing> {
        let [kind, t] = [0, 1].map(|k| noise(self.seed, edge.voxel, 8 * k + u32::from(edge.axis)));
        let triangle = (noise(self.seed, edge.voxel, 32 + u32::from(edge.axis)) * 1000.0) as u32;
        let t = if kind < self.extreme { t.round() } else { t };
        (kind < 1.0 - self.interpolated).then_some(Crossing { t, triangle })
    }

    pub fn contour(&self) -> Contour {
        let crossing = |edge| self.crossing(edge);
        contour(&self.lattice, &self.distance, &crossing, &ContourOptions::default(), &Progress::none()).unwrap()
    }
}

impl Case {
    /// A contour after the collapse, with planes that have nothing to do with the surface.
    pub fn collapsed(&self, raw: Contour) -> Collapsed {
        let planes = |triangle: u32| {
            let n = [0, 1, 2, 3].map(|k| noise(self.seed, IVec3::splat(triangle as i32), 64 + k));
            let normal = (DVec3::new(n[0], n[1], n[2]) - 0.5).try_normalize()?;
            let centre = self.lattice.to_model(self.lattice.dims.as_dvec3() * n[3]);
            (!triangle.is_multiple_of(5)).then_some((normal, normal.dot(centre)))
        };
        collapse_same_voxel(raw, &self.lattice, &planes, &Progress::none()).unwrap()
    }
}

/// What is wrong with a mesh that should be valid, with every coordinate exactly an `f32`.
pub fn fault(mesh: &TriMesh) -> Option<String> {
<<<<<<< HEAD
    let mut next: BTreeMap<u32, BTreeMap<u32, u32>> = BTreeMap::new();
    for (id, t) in mesh.triangles.iter().enumerate() {
        for k in 0..3 {
            let (v, from, to) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
            if v == from || next.entry(v).or_default().insert(from, to).is_some() {
                return Some(format!("triangle {id}: an edge is used twice in one direction"));
            }
        }
    }
    if next.len() != mesh.positions.len() {
        return Some("unused vertices".into());
    }
    for (v, ring) in &next {
        let (start, mut at, mut steps) = (ring.keys().next()?, ring.keys().next()?, 0);
        loop {
            let Some(to) = ring.get(at) else { return Some(format!("vertex {v}: open fan")) };
            (at, steps) = (to, steps + 1);
            if at == start {
                break;
            }
        }
        if steps != ring.len() || steps < 3 {
            return Some(format!("vertex {v}: more than one fan"));
        }
    }
    if let Some(p) = mesh.positions.iter().find(|p| p.as_vec3().as_dvec3() != **p) {
        return Some(format!("{p} is not f32"));
    }
    (0..mesh.triangles.len())
        .find(|&t| view(mesh.corners(t)).is_none())
        .map(|t| format!("triangle {t} is degenerate"))
        .or_else(|| intersecting(mesh).first().map(|[a, b]| format!("triangles {a} and {b} intersect")))
}

/// All intersecting pairs, by comparing all with all.
pub fn intersecting(mesh: &TriMesh) -> Vec<[u32; 2]> {
    let corners: Vec<[DVec3; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
    let boxes: Vec<(DVec3, DVec3)> = corners.iter().map(|[a, b, c]| (a.min(*b).min(*c), a.max(*b).max(*c))).collect();
    let mut found = Vec::new();
    for i in 0..corners.len() {
        for j in 0..i {
            let apart = boxes[i].0.cmpgt(boxes[j].1) | boxes[j].0.cmpgt(boxes[i].1);
            if !apart.any() && meet(mesh, i, j) {
                found.push([j as u32, i as u32]);
            }
        }
    }
    found
}

fn volume(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let p = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(p(a), p(b), p(c), p(d))
}

fn area(axis: usize, a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let p = |p: DVec3| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
    orient2d(p(a), p(b), p(c))
}

fn view(t: [DVec3; 3]) -> Option<usize> {
    (0..3).find(|&axis| area(axis, t[0], t[1], t[2]) != 0.0)
}

/// Triangles meet where they should not when a side of one meets the other in a point that is not
/// on a shared vertex: sides that contain shared vertices are tested by their direction from there.
fn meet(mesh: &TriMesh, i: usize, j: usize) -> bool {
    let (a, b) = (mesh.triangles[i], mesh.triangles[j]);
    let (p, q) = (mesh.corners(i), mesh.corners(j));
    let shared: Vec<(usize, usize)> =
        (0..3).filter_map(|k| b.iter().position(|&v| v == a[k]).map(|l| (k, l))).collect();
    let side = |s: [DVec3; 3], t: [DVec3; 3], k: usize| hits(s[k], s[(k + 1) % 3], t);
    match shared[..] {
        [] => (0..3).any(|k| side(p, q, k) || side(q, p, k)),
        [(k, l)] => side(p, q, (k + 1) % 3) || side(q, p, (l + 1) % 3),
        [(k, l), (m, n)] => {
            let (tip, other) = (p[3 - k - m], q[3 - l - n]);
            let axis = view(p).unwrap_or(0);
            volume(p[0], p[1], p[2], other) == 0.0
                && (area(axis, p[k], p[m], tip) > 0.0) == (area(axis, p[k], p[m], other) > 0.0)
        }
        _ => true,
    }
}

/// Whether the closed segment meets the closed triangle.
fn hits(p: DVec3, q: DVec3, t: [DVec3; 3]) -> bool {
    let (above, below) = (volume(t[0], t[1], t[2], p), volume(t[0], t[1], t[2], q));
    let same_sign = |s: [f64; 3]| s.iter().all(|&x| x >= 0.0) || s.iter().all(|&x| x <= 0.0);
    if above == 0.0 && below == 0.0 {
        let Some(axis) = view(t) else { return true };
        let within = |x| same_sign([0, 1, 2].map(|k| area(axis, t[k], t[(k + 1) % 3], x)));
        let crossed = |k: usize| {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            area(axis, a, b, p) * area(axis, a, b, q) < 0.0 && area(axis, p, q, a) * area(axis, p, q, b) <= 0.0
        };
        return within(p) || within(q) || (0..3).any(crossed);
    }
    above.signum() * above.abs().min(1.0).ceil() != below.signum() * below.abs().min(1.0).ceil()
        && same_sign([0, 1, 2].map(|k| volume(p, q, t[k], t[(k + 1) % 3])))
=======
    let validity = validate(mesh, &ValidateOptions::default(), &Progress::none()).unwrap();
    let sound = mesh.triangles.is_empty() || validity.is_valid() && validity.unused_vertices == 0;
    let rounded = mesh.positions.iter().all(|p| p.as_vec3().as_dvec3() == *p);
    (!sound || !rounded).then(|| format!("all f32: {rounded}, {validity:?}"))
>>>>>>> 188f3bf0881a8000dee85ca83359a413ddd394f2
}

/// Volume enclosed, model units.
pub fn enclosed(mesh: &TriMesh) -> f64 {
    (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}
