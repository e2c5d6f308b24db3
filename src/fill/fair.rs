//! A lid that continues the curvature of what is around.
//!
//! Botsch and Kobbelt (An intuitive framework for real-time freeform modeling, 2004) shape a part of a mesh by a boundary problem: its inner points move until the
//! energy of a thin plate is least, the integral of the square of the Laplacian. With the rim and the ring of vertices outside it held, the plate
//! meets the rim without a bend. The discrete Laplacian has the weights of cotangents, and areas as Meyer and others define them (Discrete differential-geometry operators, 2003). Liepa
//! (Filling holes in meshes, 2003) closes with the same energy.
//!
//! A thin plate is flatter or steeper than what is around: a sphere is none. So the plate gets a rest shape: the Laplacian of positions is twice the mean curvature
//! along the normal, the mean curvature is known at the ring outside the rim, and over the lid it is interpolated by a harmonic function (the idea of Schneider
//! and Kobbelt, Geometric fairing of irregular meshes, 2001). The energy is then the square of the difference from that Laplacian. Normals and weights are those of the lid
//! as it is, so that this is repeated a few times. Spheres and cylinders are continued as such.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::creases::is_sharp;
use super::sheet::Sheet;
use super::skyline::{Factor, Order};
use super::{Rim, Surroundings};

/// How often the plate is solved for at most.
pub(super) const STEPS: usize = 6;

/// The lid is done when no vertex moves farther than this share of the rim's diameter.
const STILL: f64 = 2e-4;

/// It is also done when a step is larger than this share of the one before: what still moves then slides within the surface.
const SLIDES: f64 = 0.7;

/// How often curvatures are averaged along the rim.
const SMOOTHINGS: usize = 2;

/// The lid with the surface around it.
struct Surface {
    /// The vertices of the sheet, then those outside.
    points: Vec<DVec3>,
    /// Triangles outside.
    outside: Vec<[u32; 3]>,
    /// How many vertices the rim has.
    rim: usize,
    /// The number of the first vertex that moves: those between the rim and it stay, but nothing is known of the surface there.
    first: usize,
    /// The number of the first vertex outside.
    end: usize,
    /// For each vertex of the rim whether a sharp edge ends there.
    at_crease: Vec<bool>,
    /// For each vertex from `end` on whether it lies on a sharp edge.
    sharp: Vec<bool>,
}

/// The discrete Laplacian of a surface.
struct Laplacian {
    /// For each vertex its neighbours with their weights.
    rows: Vec<Vec<(u32, f64)>>,
    /// For each vertex its share of the area.
    areas: Vec<f64>,
    /// For each vertex the sum of its triangles' normals by area.
    normals: Vec<DVec3>,
    /// Whether a vertex has triangles all around.
    closed: Vec<bool>,
}

/// Moves the inner vertices of a lid, in so many steps at most.
pub(super) fn fair(sheet: &mut Sheet<'_>, around: &Surroundings<'_>, rim: &Rim, scale: f64, steps: usize) {
    let mut surface = Surface::new(sheet, around, rim, scale);
    if surface.free().is_empty() {
        return;
    }
    let diameter = rim.diameter * scale;
    let mut last = f64::INFINITY;
    for step in 0..steps {
        let laplacian = Laplacian::new(&surface.points, surface.all(sheet));
        let order = surface.order(&laplacian);
        let bent = (step > 0).then(|| surface.rest(&laplacian, &order, diameter)).flatten();
        let Some(moved) = surface.solve(&laplacian, &order, bent.as_deref()) else { return };
        let far = |(v, p): (usize, &DVec3)| p.distance(surface.points[v]);
        let most = surface.free().zip(&moved).map(far).fold(0.0, f64::max);
        for (v, p) in surface.free().zip(moved) {
            surface.points[v] = p;
            sheet.points[v] = p;
        }
        if most < STILL * diameter || (step > 2 && most > SLIDES * last) {
            return;
        }
        last = most;
        if step < 2 {
            sheet.turn_edges();
        }
    }
}

impl Surface {
    fn new(sheet: &Sheet<'_>, around: &Surroundings<'_>, rim: &Rim, scale: f64) -> Self {
        let mesh = around.mesh();
        let star = |vertices: &mut dyn Iterator<Item = u32>| {
            let mut found: Vec<u32> = vertices.flat_map(|v| around.of(v)).copied().collect();
            found.sort_unstable();
            found.dedup();
            found
        };
        let near = star(&mut rim.vertices.iter().copied());
        let mut all = star(&mut near.iter().flat_map(|&t| mesh.triangles[t as usize]));
        // In an order that does not depend on the numbers of triangles, so that sums do not.
        let place = |t: u32| mesh.corners(t as usize).map(|p| p.to_array());
        all.sort_by(|&a, &b| place(a).partial_cmp(&place(b)).unwrap_or(std::cmp::Ordering::Equal));
        let mut points = sheet.points.clone();
        let mut sharp = Vec::new();
        let mut number: FxHashMap<u32, u32> = rim.vertices.iter().copied().zip(0u32..).collect();
        let mut local = |v: u32| {
            *number.entry(v).or_insert_with(|| {
                points.push(mesh.positions[v as usize] * scale);
                sharp.push(is_sharp(around, v));
                points.len() as u32 - 1
            })
        };
        let outside = all.iter().map(|&t| mesh.triangles[t as usize].map(&mut local)).collect();
        let at_crease = rim.vertices.iter().map(|&v| is_sharp(around, v)).collect();
        let rim = rim.vertices.len();
        Self { at_crease, points, outside, rim, first: rim + 1 + sheet.held, end: sheet.points.len(), sharp }
    }

    /// The vertices that move.
    fn free(&self) -> std::ops::Range<usize> {
        self.first..self.end
    }

    /// The number of a vertex among those that move.
    fn unknown(&self, v: u32) -> Option<u32> {
        self.free().contains(&(v as usize)).then(|| v - self.first as u32)
    }

    /// All triangles.
    fn all(&self, sheet: &Sheet<'_>) -> Vec<[u32; 3]> {
        let mut all = sheet.triangles();
        all.extend(&self.outside);
        all
    }

    fn order(&self, laplacian: &Laplacian) -> Order {
        let near = |v: usize| laplacian.rows[v].iter().filter_map(|&(w, _)| self.unknown(w)).collect();
        Order::new(&self.free().map(near).collect::<Vec<_>>())
    }

    /// The Laplacian that the plate has at rest, for the vertices of rim and lid; `None` where the curvature around is not known.
    fn rest(&self, laplacian: &Laplacian, order: &Order, diameter: f64) -> Option<Vec<DVec3>> {
        let rim = self.rim_curvature(laplacian, diameter)?;
        let mut entries = Vec::new();
        let mut right = vec![0.0; self.free().len()];
        for v in self.free() {
            let row = self.unknown(v as u32)?;
            for &(w, weight) in &laplacian.rows[v] {
                // A sharp edge parts two surfaces with a curvature each.
                if (self.rim..self.first).contains(&(w as usize)) {
                    continue;
                }
                // Weights below zero would give values beyond those of the rim.
                let weight = weight.max(1e-3);
                entries.push((row, row, weight));
                match self.unknown(w) {
                    Some(column) if column < row => entries.push((row, column, -weight)),
                    Some(_) => {}
                    None => right[row as usize] += weight * rim[w as usize],
                }
            }
        }
        let inner = Factor::new(order, &entries)?.solve(&right);
        let between = std::iter::repeat_n(0.0, self.first - self.rim);
        let all = rim.into_iter().chain(between).chain(inner);
        Some(all.enumerate().map(|(v, value)| laplacian.normals[v].normalize_or_zero() * value).collect())
    }

    /// At each vertex of the rim the mean of the curvature (along the normal, as the Laplacian has it) of its neighbours outside.
    fn rim_curvature(&self, laplacian: &Laplacian, diameter: f64) -> Option<Vec<f64>> {
        let curvature = |v: usize| {
            let sum: DVec3 =
                laplacian.rows[v].iter().map(|&(w, weight)| weight * (self.points[w as usize] - self.points[v])).sum();
            // No cap that is higher than half a sphere over the rim.
            (sum / laplacian.areas[v])
                .dot(laplacian.normals[v].normalize_or_zero())
                .clamp(-4.0 / diameter, 4.0 / diameter)
        };
        let known = |v: usize| {
            let outside = laplacian.rows[v].iter().map(|&(w, _)| w as usize);
            let whole = outside.filter(|&w| {
                w >= self.end && !self.sharp[w - self.end] && laplacian.closed[w] && laplacian.areas[w] > 0.0
            });
            let values: Vec<f64> = whole.map(curvature).filter(|value| value.is_finite()).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        let mut values: Vec<Option<f64>> = (0..self.rim).map(known).collect();
        let sum: f64 = values.iter().flatten().sum();
        let mean = sum / values.iter().flatten().count() as f64;
        if !mean.is_finite() {
            return None;
        }
        for _ in 0..SMOOTHINGS {
            let at = |k: usize| values[k % self.rim].unwrap_or(mean);
            values = (0..self.rim).map(|k| Some((at(k + self.rim - 1) + 2.0 * at(k) + at(k + 1)) / 4.0)).collect();
        }
        Some(values.into_iter().flatten().collect())
    }

    /// Where the vertices of the lid go.
    fn solve(&self, laplacian: &Laplacian, order: &Order, bent: Option<&[DVec3]>) -> Option<Vec<DVec3>> {
        let mut entries = Vec::new();
        let mut right = vec![DVec3::ZERO; self.free().len()];
        let smooth = |v: &usize| laplacian.closed[*v] && !self.at_crease[*v];
        for v in (0..self.rim).filter(smooth).chain(self.free()) {
            let area = laplacian.areas[v];
            let mut row: Vec<(u32, f64)> = laplacian.rows[v].clone();
            row.push((v as u32, -row.iter().map(|(_, weight)| weight).sum::<f64>()));
            let held = row.iter().filter(|(w, _)| self.unknown(*w).is_none());
            let known = held.map(|&(w, weight)| weight * self.points[w as usize]).sum::<DVec3>() / area;
            let known = bent.map_or(known, |bent| known - bent[v]);
            let free: Vec<(u32, f64)> = row.iter().filter_map(|&(w, x)| Some((self.unknown(w)?, x))).collect();
            for (k, &(a, x)) in free.iter().enumerate() {
                right[a as usize] -= x * known;
                entries.extend(free[..=k].iter().map(|&(b, y)| (a, b, x * y / area)));
            }
        }
        let factor = Factor::new(order, &entries)?;
        let axis = |k: usize| factor.solve(&right.iter().map(|p| p[k]).collect::<Vec<_>>());
        let [x, y, z] = [0, 1, 2].map(axis);
        let moved: Vec<DVec3> = (0..x.len()).map(|k| DVec3::new(x[k], y[k], z[k])).collect();
        moved.iter().all(|p| p.is_finite()).then_some(moved)
    }
}

impl Laplacian {
    fn new(points: &[DVec3], triangles: Vec<[u32; 3]>) -> Self {
        let mut areas = vec![0.0; points.len()];
        let mut normals = vec![DVec3::ZERO; points.len()];
        let mut count = vec![0u32; points.len()];
        let mut entries: Vec<(u32, u32, f64)> = Vec::with_capacity(6 * triangles.len());
        for t in &triangles {
            let corners = t.map(|v| points[v as usize]);
            let (cotangents, shares) = measures(corners);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            for k in 0..3 {
                let (a, b) = (t[(k + 1) % 3], t[(k + 2) % 3]);
                entries.extend([(a, b, cotangents[k] / 2.0), (b, a, cotangents[k] / 2.0)]);
                areas[t[k] as usize] += shares[k];
                normals[t[k] as usize] += normal;
                count[t[k] as usize] += 1;
            }
        }
        entries.sort_by_key(|&(a, b, _)| (a, b));
        let mut rows = vec![Vec::new(); points.len()];
        for same in entries.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            rows[same[0].0 as usize].push((same[0].1, same.iter().map(|entry| entry.2).sum()));
        }
        let closed = rows.iter().zip(&count).map(|(row, &count)| row.len() == count as usize && count > 2).collect();
        Self { rows, areas, normals, closed }
    }
}

/// The cotangents of a triangle's angles, and how much of its area is nearest to each corner, or said to be where it is obtuse. A triangle that is almost a line counts as
/// equilateral, with the area of its longest edge's square over a million.
fn measures(corners: [DVec3; 3]) -> ([f64; 3], [f64; 3]) {
    let edge = |k: usize| corners[(k + 2) % 3] - corners[(k + 1) % 3];
    let squares = [0, 1, 2].map(|k| edge(k).length_squared());
    let longest = squares[0].max(squares[1]).max(squares[2]);
    let twice = edge(0).cross(edge(1)).length();
    if twice <= 1e-6 * longest {
        return ([1.0 / 3f64.sqrt(); 3], [longest.max(f64::MIN_POSITIVE) * 1e-6; 3]);
    }
    let cotangents = [0, 1, 2].map(|k| -edge((k + 1) % 3).dot(edge((k + 2) % 3)) / twice);
    let shares = match cotangents.iter().position(|&c| c < 0.0) {
        Some(obtuse) => [0, 1, 2].map(|k| twice / if k == obtuse { 4.0 } else { 8.0 }),
        None => [0, 1, 2].map(|k| {
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            (cotangents[next] * squares[next] + cotangents[last] * squares[last]) / 8.0
        }),
    };
    (cotangents, shares)
}
