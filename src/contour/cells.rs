//! The triangles: each mixed cell turns its loops into triangles that do not fold.

use glam::DVec3;
use rayon::prelude::*;
use robust::{Coord, orient2d};

use super::signs::{Brick, Crossed, Neighbour, Signs};
use super::table::{LOOPS, Loop, MOST_VERTICES, edge_ends};
use super::vertices::{TASK, Vertices, bits, locate, value};
use crate::lattice::{Grid, trilinear};
use crate::mesh::triangles_intersect;
use crate::progress::{Progress, Stopped};

/// The triangles, and how many loops had no triangulation that is free of folds.
pub(super) type Triangles = (Vec<[u32; 3]>, usize);

/// What the cells look things up in.
pub(super) struct Tables<'a> {
    pub signs: &'a Signs,
    pub crossed: &'a [Crossed],
    /// Number of each brick's first vertex.
    pub first: &'a [u32],
    pub vertices: &'a Vertices,
    pub distance: &'a Grid<f32>,
}

/// A loop of one cell, with its vertices looked up.
struct Polygon<'a> {
    shape: &'a Loop,
    ids: [u32; MOST_VERTICES],
    points: [DVec3; MOST_VERTICES],
}

impl Polygon<'_> {
    fn len(&self) -> usize {
        self.shape.edges.len()
    }
}

/// One cell: its lower voxel within the brick.
struct Cell<'a> {
    brick: &'a Brick,
    at: [usize; 3],
}

/// Goes through all mixed cells, in the order of bricks and voxels.
pub(super) fn triangles(tables: &Tables<'_>, progress: &Progress) -> Result<Triangles, Stopped> {
    let loops = &**LOOPS;
    let parts: Vec<Triangles> = tables
        .signs
        .bricks
        .par_chunks(TASK)
        .map(|bricks| {
            progress.check()?;
            let mut part = (Vec::new(), 0);
            for brick in bricks {
                for z in 0..8 {
                    let planes: [u64; 8] =
                        std::array::from_fn(|k| tables.signs.shifted_plane(brick, k & 3, z + (k >> 2)));
                    let any = planes.iter().fold(0, |a, p| a | p);
                    let all = planes.iter().fold(u64::MAX, |a, p| a & p);
                    for k in bits(any & !all) {
                        let pattern = planes.iter().rev().fold(0, |p, plane| p << 1 | (plane >> k & 1) as usize);
                        tables.cell(&Cell { brick, at: [k & 7, k >> 3, z] }, &loops[pattern], &mut part);
                    }
                }
            }
            Ok(part)
        })
        .collect::<Result<_, Stopped>>()?;
    let mut all = (Vec::with_capacity(parts.iter().map(|p| p.0.len()).sum()), 0);
    for (triangles, folded) in parts {
        all.0.extend(triangles);
        all.1 += folded;
    }
    Ok(all)
}

impl Tables<'_> {
    /// Adds the triangles of one cell.
    fn cell(&self, cell: &Cell<'_>, loops: &[Loop], out: &mut Triangles) {
        let first = out.0.len();
        for shape in loops {
            let Some(polygon) = self.polygon(cell, shape) else { continue };
            let before = out.0.len();
            let chosen = if let [only] = &shape.triangulations[..] {
                let faults = if polygon.len() == 3 && before == first { 0 } else { faults(&polygon, 0, &[], self) };
                out.1 += usize::from(faults > 0);
                only
            } else {
                let others = out.0[first..before].to_vec();
                let (index, faults) = self.choose(cell, &polygon, &others);
                out.1 += usize::from(faults > 0);
                &shape.triangulations[index]
            };
            out.0.extend(chosen.triangles.iter().map(|t| t.map(|k| polygon.ids[k as usize])));
        }
    }

    /// Looks the vertices of a loop up. `None` only where the distances break the promise that a
    /// change of sign lies between active bricks, so that nobody made a vertex there.
    fn polygon<'a>(&self, cell: &Cell<'_>, shape: &'a Loop) -> Option<Polygon<'a>> {
        let mut polygon = Polygon { shape, ids: [0; MOST_VERTICES], points: [DVec3::ZERO; MOST_VERTICES] };
        for (i, &edge) in shape.edges.iter().enumerate() {
            let low = edge_ends(edge).0 as usize;
            let [x, y, z] = [0, 1, 2].map(|axis| cell.at[axis] + (low >> axis & 1));
            let (Neighbour::Visited(owner), index) = locate(cell.brick, x, y, z) else { return None };
            let crossed = &self.crossed[owner as usize];
            let local = crossed.number(edge as usize / 4, index as u32 & 63, index >> 6);
            polygon.ids[i] = self.first[owner as usize] + local;
            polygon.points[i] = *self.vertices.positions.get(polygon.ids[i] as usize)?;
        }
        Some(polygon)
    }

    /// The best triangulation of the loop and how many faults it has: the one without faults whose
    /// diagonals stay closest to the zero of the field; if all have faults, one with the fewest.
    fn choose(&self, cell: &Cell<'_>, polygon: &Polygon<'_>, others: &[[u32; 3]]) -> (usize, usize) {
        let shape = polygon.shape;
        let mut deviations = [0.0; 14];
        let corners = self.corner_values(cell);
        let places: [DVec3; MOST_VERTICES] = std::array::from_fn(|i| {
            let Some(&edge) = shape.edges.get(i) else { return DVec3::ZERO };
            let low = edge_ends(edge).0;
            let mut p = DVec3::from_array([0, 1, 2].map(|axis| f64::from(low >> axis & 1)));
            p[edge as usize / 4] = self.vertices.places[polygon.ids[i] as usize];
            p
        });
        for (deviation, &[a, b]) in deviations.iter_mut().zip(&shape.diagonals) {
            *deviation = trilinear(&corners, (places[a as usize] + places[b as usize]) * 0.5).abs();
        }
        let score =
            |index: usize| -> f64 { bits(shape.triangulations[index].diagonals.into()).map(|k| deviations[k]).sum() };
        let mut order: Vec<(f64, usize)> = (0..shape.triangulations.len()).map(|i| (score(i), i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut best = (order[0].1, usize::MAX);
        for (_, index) in order {
            let faults = faults(polygon, index, others, self);
            if faults < best.1 {
                best = (index, faults);
            }
            if faults == 0 {
                break;
            }
        }
        best
    }

    fn corner_values(&self, cell: &Cell<'_>) -> [f64; 8] {
        let [x, y, z] = cell.at;
        std::array::from_fn(|k| {
            let (neighbour, index) = locate(cell.brick, x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
            value(self.signs, self.distance, neighbour, index)
        })
    }
}

/// How many pairs of triangles meet where they should not, with the triangles of the cell's other
/// loops, plus how many are degenerate.
fn faults(polygon: &Polygon<'_>, index: usize, others: &[[u32; 3]], tables: &Tables<'_>) -> usize {
    let local = &polygon.shape.triangulations[index].triangles;
    if others.is_empty() && is_flat_enough(&polygon.points[..polygon.len()], local) {
        return 0;
    }
    let corners = |t: &[u32; 3]| t.map(|v| tables.vertices.positions[v as usize]);
    let others: Vec<_> = others.iter().map(corners).collect();
    let triangles: Vec<_> = local.iter().map(|t| t.map(|k| polygon.points[k as usize])).collect();
    let mut count = triangles.iter().filter(|t| is_degenerate(t)).count();
    for (i, a) in triangles.iter().enumerate() {
        count += triangles[..i].iter().chain(&others).filter(|b| triangles_intersect(a, b)).count();
    }
    count
}

/// Whether the corners lie exactly on one line.
fn is_degenerate(corners: &[DVec3; 3]) -> bool {
    (0..3).all(|axis| {
        let [a, b, c] = corners.map(|p| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] });
        orient2d(a, b, c) == 0.0
    })
}

/// A cheap proof, in floating point with a margin, that the triangles do not fold: seen along an
/// axis all of them turn the same way, and the loop goes around its centre once.
fn is_flat_enough(points: &[DVec3], triangles: &[[u8; 3]]) -> bool {
    let o = points[0];
    let normal: DVec3 = points.windows(2).map(|w| (w[0] - o).cross(w[1] - o)).sum();
    let size = normal.abs();
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
    let sign = normal[axis].signum();
    // far above the rounding of differences of coordinates that are exactly f32
    let least = 1e-9 * size[axis];
    let flat: [(f64, f64); MOST_VERTICES] = std::array::from_fn(|i| {
        let p = points.get(i).copied().unwrap_or(o) - o;
        (p[(axis + 1) % 3], p[(axis + 2) % 3] * sign)
    });
    let area = |a: (f64, f64), b: (f64, f64), c: (f64, f64)| (b.0 - a.0) * (c.1 - a.1) - (b.1 - a.1) * (c.0 - a.0);
    if !triangles.iter().all(|t| {
        let [a, b, c] = t.map(|k| flat[k as usize]);
        area(a, b, c) > least
    }) {
        return false;
    }
    let n = points.len();
    if n <= 4 {
        return true;
    }
    let centre = flat[..n].iter().fold((0.0, 0.0), |c, p| (c.0 + p.0 / n as f64, c.1 + p.1 / n as f64));
    let mut turns = 0;
    for i in 0..n {
        let (a, b) = (flat[i], flat[(i + 1) % n]);
        if area(centre, a, b) <= least {
            return false;
        }
        turns += usize::from(a.1 < centre.1 && b.1 >= centre.1);
    }
    turns == 1
}
