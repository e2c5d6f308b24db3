//! The convex hull of points, exactly, and its largest face.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::TriMesh;
use super::predicates::{scale_of, side_of_plane};

/// Hull triangles whose normals are nearer than this (one minus the cosine, 0.06°) are one face.
const SAME: f64 = 5e-7;

/// A triangle of the growing hull.
struct Face {
    /// Counter-clockwise seen from outside.
    corners: [u32; 3],
    /// Points in front of it that no other face has.
    outside: Vec<u32>,
    live: bool,
}

/// A convex hull while points are added.
struct Hull<'a> {
    points: &'a [DVec3],
    faces: Vec<Face>,
    /// The face to the left of each directed edge.
    left: FxHashMap<[u32; 2], u32>,
}

/// The triangles of the convex hull of `points`, counter-clockwise seen from outside; `None` when all points lie in one plane.
pub fn convex_hull(points: &[DVec3]) -> Option<Vec<[u32; 3]>> {
    let largest = points.iter().fold(0f64, |most, p| most.max(p.abs().max_element()));
    let scale = scale_of(largest);
    let scaled: Vec<DVec3> = points.iter().map(|&p| p * scale).collect();
    let mut hull = Hull::first(&scaled)?;
    let mut open: Vec<u32> = (0..4).collect();
    while let Some(face) = open.pop() {
        if hull.faces[face as usize].live && !hull.faces[face as usize].outside.is_empty() {
            open.extend(hull.grow(face));
        }
    }
    Some(hull.faces.iter().filter(|face| face.live).map(|face| face.corners).collect())
}

impl<'a> Hull<'a> {
    /// A tetrahedron of points that lie far apart.
    fn first(points: &'a [DVec3]) -> Option<Self> {
        let all = || 0..points.len() as u32;
        let at = |v: u32| points[v as usize];
        let farthest = |off: &dyn Fn(DVec3) -> f64| all().max_by(|&a, &b| off(at(a)).total_cmp(&off(at(b))));
        let a = farthest(&|p| -p.x)?;
        let b = farthest(&|p| p.distance(at(a)))?;
        let along = (at(b) - at(a)).try_normalize()?;
        let c = farthest(&|p| (p - at(a)).reject_from_normalized(along).length())?;
        let normal = (at(b) - at(a)).normalize_or_zero().cross((at(c) - at(a)).normalize_or_zero()).try_normalize()?;
        let side = |d: u32| side_of_plane(&[at(a), at(b), at(c)], at(d));
        let d = all().filter(|&d| side(d) != 0.0).max_by(|&p, &q| {
            let off = |v: u32| (at(v) - at(a)).dot(normal).abs();
            off(p).total_cmp(&off(q))
        })?;
        let (b, c) = if side(d) > 0.0 { (c, b) } else { (b, c) };
        let mut hull = Self { points, faces: Vec::new(), left: FxHashMap::default() };
        for corners in [[a, b, c], [a, d, b], [b, d, c], [c, d, a]] {
            hull.add(corners);
        }
        hull.share(0, all().collect());
        Some(hull)
    }

    fn add(&mut self, corners: [u32; 3]) {
        let face = self.faces.len() as u32;
        for k in 0..3 {
            self.left.insert([corners[k], corners[(k + 1) % 3]], face);
        }
        self.faces.push(Face { corners, outside: Vec::new(), live: true });
    }

    /// Whether a point is strictly in front of a face.
    fn sees(&self, point: u32, face: u32) -> bool {
        let corners = self.faces[face as usize].corners.map(|v| self.points[v as usize]);
        side_of_plane(&corners, self.points[point as usize]) > 0.0
    }

    /// Gives each point to the first face from number `from` on that it is in front of.
    fn share(&mut self, from: usize, points: Vec<u32>) {
        for point in points {
            if let Some(face) = (from..self.faces.len()).find(|&face| self.sees(point, face as u32)) {
                self.faces[face].outside.push(point);
            }
        }
    }

    /// Adds the farthest point in front of a face; returns the faces that this makes.
    fn grow(&mut self, face: u32) -> std::ops::Range<u32> {
        let [a, b, c] = self.faces[face as usize].corners.map(|v| self.points[v as usize]);
        let normal = (b - a).normalize_or_zero().cross((c - a).normalize_or_zero());
        let off = |v: u32| (self.points[v as usize] - a).dot(normal);
        let outside = self.faces[face as usize].outside.iter().copied();
        let first = self.faces.len() as u32;
        let Some(tip) = outside.max_by(|&p, &q| off(p).total_cmp(&off(q))) else { return first..first };
        // All faces that the point sees hang together.
        let (mut seen, mut horizon) = (vec![face], Vec::new());
        self.faces[face as usize].live = false;
        let mut next = 0;
        while next < seen.len() {
            let corners = self.faces[seen[next] as usize].corners;
            next += 1;
            for k in 0..3 {
                let (from, to) = (corners[k], corners[(k + 1) % 3]);
                let Some(&other) = self.left.get(&[to, from]) else { continue };
                if !self.faces[other as usize].live {
                    continue;
                }
                if self.sees(tip, other) {
                    self.faces[other as usize].live = false;
                    seen.push(other);
                } else {
                    horizon.push((from, to));
                }
            }
        }
        let mut loose = Vec::new();
        for face in seen {
            loose.append(&mut self.faces[face as usize].outside);
        }
        for (from, to) in horizon {
            self.add([from, to, tip]);
        }
        loose.retain(|&point| point != tip);
        self.share(first as usize, loose);
        first..self.faces.len() as u32
    }
}

/// The largest flat face of the convex hull of a mesh: its unit normal, outwards, and its area. Triangles of the hull that differ by
/// less than 0.06° count as one face; of equally large ones the one that faces down most is it. `None` for a flat mesh.
pub fn largest_hull_face(mesh: &TriMesh) -> Option<(DVec3, f64)> {
    let mut used = vec![false; mesh.positions.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let points: Vec<DVec3> = mesh.positions.iter().zip(used).filter(|(_, used)| *used).map(|(&p, _)| p).collect();
    let faces = convex_hull(&points)?;
    let size = mesh.bounds()?.diagonal();
    let vector = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|v| points[v as usize] / size);
        (b - a).cross(c - a) / 2.0
    };
    let vectors: Vec<DVec3> = faces.iter().map(vector).collect();
    let mut left: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    for (n, face) in (0..).zip(&faces) {
        left.extend((0..3).map(|k| ([face[k], face[(k + 1) % 3]], n)));
    }
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.sort_by(|&a, &b| vectors[b].length_squared().total_cmp(&vectors[a].length_squared()).then(a.cmp(&b)));
    let mut taken = vec![false; faces.len()];
    let mut found: Vec<DVec3> = Vec::new();
    for seed in order {
        if taken[seed] {
            continue;
        }
        taken[seed] = true;
        let normal = vectors[seed].normalize_or_zero();
        let (mut group, mut next, mut sum) = (vec![seed], 0, DVec3::ZERO);
        while let Some(&n) = group.get(next) {
            next += 1;
            sum += vectors[n];
            for k in 0..3 {
                let Some(&other) = left.get(&[faces[n][(k + 1) % 3], faces[n][k]]) else { continue };
                let other = other as usize;
                if !taken[other] && vectors[other].normalize_or_zero().dot(normal) > 1.0 - SAME {
                    taken[other] = true;
                    group.push(other);
                }
            }
        }
        found.push(sum);
    }
    let most = found.iter().map(|sum| sum.length()).fold(0.0, f64::max);
    let largest = found.into_iter().filter(|sum| sum.length() > most * (1.0 - 1e-9));
    let best = largest.min_by(|a, b| a.normalize_or_zero().z.total_cmp(&b.normalize_or_zero().z))?;
    Some((best.try_normalize()?, best.length() * size * size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Progress;
    use rand_xoshiro::Xoshiro256PlusPlus;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};

    fn random(rng: &mut Xoshiro256PlusPlus) -> f64 {
        (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn check(points: &[DVec3]) -> TriMesh {
        let triangles = convex_hull(points).expect("not flat");
        let mesh = TriMesh { positions: points.to_vec(), triangles };
        let options = crate::mesh::ValidateOptions { self_intersections: false, weld: true };
        let state = crate::mesh::validate(&mesh, &options, &Progress::none()).expect("not stopped");
        assert!(state.is_oriented_manifold() && state.genus == Some(0) && state.volume > 0.0, "{state:?}");
        for t in 0..mesh.triangles.len() {
            let corners = mesh.corners(t);
            assert!(points.iter().all(|&p| side_of_plane(&corners, p) <= 0.0), "a point is outside");
        }
        mesh
    }

    #[test]
    fn no_point_is_outside_and_the_hull_is_closed() {
        let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
        for round in 0..20 {
            let point = |_| DVec3::new(random(&mut rng), random(&mut rng), random(&mut rng));
            let mut points: Vec<DVec3> = (0..60).map(point).collect();
            if round % 2 == 1 {
                // Many points in common planes and on common lines.
                points.iter_mut().for_each(|p| *p = (*p * 3.0).round());
            }
            check(&points);
        }
        assert_eq!(convex_hull(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)]), None);
        assert_eq!(convex_hull(&[]), None);
    }

    #[test]
    fn the_largest_face_of_a_box_is_found_and_of_two_the_lower() {
        let corner = |n: u32| DVec3::new(f64::from(n & 1) * 2.0, f64::from(n >> 1 & 1) * 3.0, f64::from(n >> 2) * 4.0);
        let points: Vec<DVec3> = (0..8).map(corner).collect();
        let mesh = check(&points);
        let (normal, area) = largest_hull_face(&mesh).expect("a face");
        assert!((area - 12.0).abs() < 1e-12 && normal.x.abs() > 1.0 - 1e-12, "{normal} {area}");
        let turned = TriMesh { positions: points.iter().map(|p| DVec3::new(p.z, p.y, p.x)).collect(), ..mesh };
        let flipped = TriMesh { triangles: turned.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..turned };
        let lower = largest_hull_face(&flipped).expect("a face").0;
        assert!(lower.distance(DVec3::NEG_Z) < 1e-12, "{lower}");
    }
}
