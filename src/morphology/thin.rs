//! Walls thinner than a length: the middles between their two sides.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::Gauge;
use crate::mesh::edges::Union;
use crate::mesh::{Plane, TriMesh};
use crate::progress::{Progress, Stopped};

/// A ball that touches the surface at two points lies in a wall when they are seen from its centre under an angle of which
/// this is the cosine, at most: 120°. In the edge of a box they are 90° apart.
const FACING: f64 = -0.5;

/// Steps of shrinking one ball; each takes it off a point of the surface that lies within.
const MOST_STEPS: usize = 40;

/// A point is within a ball only if it is by more than this part of the radius: beside a convex edge of up to 25°, as a round
/// surface is made of, balls may look out a little.
const WITHIN: f64 = 0.1;

/// Of balls that touch the surface at one point, each this many times larger than the one before, every point that is within a
/// ball between them is within one of them by more than [`WITHIN`], too, if it lies ahead.
const LADDER: f64 = 8.0;

/// A ball smaller than this, h, is no wall but an edge of the surface.
const SMALLEST: f64 = 1e-3;

/// Connected pieces of surface with less area than this, h², have no walls behind them, but what a fit leaves of places that
/// it had to give up.
const LEAST_AREA: f64 = 2.0;

/// Triangles of the middle are not longer than this many times the pieces of surface that they belong to, and one voxel.
const TORN: f64 = 2.0;

/// The middles of the walls of `body` that are thinner than `least`, as triangles that bound nothing: for each piece of the
/// surface, no larger than `h`, the centres of the largest balls that touch its corners from inside, where they touch the
/// surface on the other side, too; where only one that touches its centre does, a very small triangle there. All in model
/// units; empty where no wall is as thin. The second number is the area of the surface with these behind it.
pub fn middles(body: &Gauge<'_>, least: f64, h: f64, progress: &Progress) -> Result<(TriMesh, f64), Stopped> {
    let walls = Walls { body, radius: least / 2.0, h };
    let of = |t: usize| {
        if t.is_multiple_of(1024) {
            progress.check()?;
        }
        Ok(walls.behind(t))
    };
    let found: Vec<Behinds> = (0..body.mesh.triangles.len()).into_par_iter().map(of).collect::<Result<_, Stopped>>()?;
    let thin = || found.iter().zip(&body.mesh.triangles).filter(|(behind, _)| behind.area > 0.0);
    let mut whole = Union::of_triangles(body.mesh.positions.len(), thin().map(|(_, &triangle)| triangle));
    let mut areas = vec![0.0; body.mesh.positions.len()];
    thin().for_each(|(behind, &[a, ..])| areas[whole.root(a) as usize] += behind.area);
    let (mut positions, mut area) = (Vec::new(), 0.0);
    for (behind, &[a, ..]) in thin() {
        if areas[whole.root(a) as usize] > LEAST_AREA * h * h {
            area += behind.area;
            positions.extend(behind.middles.iter().flatten());
        }
    }
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Ok((TriMesh { positions, triangles }, area))
}

/// What is behind one triangle.
#[derive(Default)]
struct Behinds {
    middles: Vec<[DVec3; 3]>,
    area: f64,
}

/// What is behind a point of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Behind {
    /// Enough.
    Thick,
    /// The middle of a thin wall.
    Wall(DVec3),
    /// Another side of the same edge.
    Edge,
}

struct Walls<'a> {
    body: &'a Gauge<'a>,
    radius: f64,
    h: f64,
}

impl Walls<'_> {
    /// The middles behind one triangle.
    fn behind(&self, t: usize) -> Behinds {
        let corners = self.body.mesh.corners(t);
        let normal = Plane::through(corners).normal;
        let (points, pieces) = pieces(corners, self.h);
        let ends: Vec<Behind> = points.iter().map(|&p| self.at(p, normal)).collect();
        let mut behind = Behinds::default();
        for piece in pieces {
            let [p, q, r] = piece.map(|n| points[n as usize]);
            if let Some(middle) = self.middle([p, q, r], piece.map(|n| ends[n as usize]), normal) {
                behind.middles.push(middle);
                behind.area += (q - p).cross(r - p).length() / 2.0;
            }
        }
        behind
    }

    /// The middle behind one piece, with what is behind its corners.
    fn middle(&self, piece: [DVec3; 3], ends: [Behind; 3], normal: DVec3) -> Option<[DVec3; 3]> {
        if ends == [Behind::Thick; 3] {
            return None;
        }
        if let [Behind::Wall(a), Behind::Wall(b), Behind::Wall(c)] = ends
            && longest([a, b, c]) <= TORN * (longest(piece) + self.h)
        {
            return Some([a, b, c]);
        }
        let Behind::Wall(centre) = self.at(piece.iter().sum::<DVec3>() / 3.0, normal) else { return None };
        let (u, v) = normal.any_orthonormal_pair();
        Some([centre, centre + u * SMALLEST * self.h, centre + v * SMALLEST * self.h])
    }

    /// The largest ball, up to the radius, that touches the surface at `p` from inside.
    fn at(&self, p: DVec3, normal: DVec3) -> Behind {
        let Some(mut r) = self.first(p, normal) else { return Behind::Thick };
        let mut other = None;
        for _ in 0..MOST_STEPS {
            let Some(near) = self.body.distance().within(p - normal * r, r * (1.0 - WITHIN)) else { break };
            let way = p - near.point;
            let along = way.dot(normal);
            // The surface turns away from the ball, or around it: no ball fits.
            if along <= 0.0 || r < SMALLEST * self.h {
                return Behind::Edge;
            }
            r = r.min(way.length_squared() / (2.0 * along));
            other = Some(near.point);
        }
        let Some(other) = other.filter(|_| r < self.radius) else { return Behind::Thick };
        let centre = p - normal * r;
        let faces = normal.dot((other - centre).normalize_or_zero()) < FACING;
        if faces && r > SMALLEST * self.h { Behind::Wall(centre) } else { Behind::Edge }
    }

    /// The radius of the smallest ball of the ladder that touches the surface at `p` and has more of it within. A much larger
    /// one would not see the other side of a thin wall: it comes out on that side, and there touches the wall all but at `p`.
    fn first(&self, p: DVec3, normal: DVec3) -> Option<f64> {
        // Of a wall as thick as the ball, the other side is only seen by one that is this much larger.
        let largest = self.radius / (1.0 - WITHIN / 2.0);
        let steps = (largest / (SMALLEST * self.h)).log(LADDER).ceil().max(0.0) as i32;
        let mut radii = (0..=steps).rev().map(|k| largest / LADDER.powi(k));
        radii.find(|r| self.body.distance().within(p - normal * *r, r * (1.0 - WITHIN)).is_some())
    }
}

fn longest([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).length().max((c - b).length()).max((a - c).length())
}

/// A triangle cut at the middles of its longest edges until none is longer than `most`: points, and the pieces between them.
fn pieces(corners: [DVec3; 3], most: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points = corners.to_vec();
    let mut middles: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let (mut rest, mut done) = (vec![[0, 1, 2]], Vec::new());
    while let Some(piece) = rest.pop() {
        let length = |k: usize| points[piece[k] as usize].distance(points[piece[(k + 1) % 3] as usize]);
        // Of two as long the one between the smaller numbers, so that the pieces on its sides cut the same one.
        let ends = |k: usize| [piece[k].min(piece[(k + 1) % 3]), piece[k].max(piece[(k + 1) % 3])];
        let longest = (0..3).max_by(|&a, &b| length(a).total_cmp(&length(b)).then(ends(b).cmp(&ends(a)))).unwrap_or(0);
        if length(longest) <= most {
            done.push(piece);
            continue;
        }
        let [a, b, c] = [0, 1, 2].map(|k| piece[(longest + k) % 3]);
        let middle = *middles.entry(ends(longest)).or_insert_with(|| {
            points.push((points[a as usize] + points[b as usize]) / 2.0);
            points.len() as u32 - 1
        });
        rest.extend([[a, middle, c], [middle, b, c]]);
    }
    (points, done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_cover_a_triangle_once_and_slivers_make_few() {
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
        for (corners, most) in [
            ([DVec3::ZERO, DVec3::X, DVec3::Y], 0.1),
            ([DVec3::ZERO, DVec3::new(100.0, 0.0, 1.0), DVec3::new(50.0, 0.02, 0.0)], 1.0),
            ([DVec3::ZERO, DVec3::X, DVec3::Y], 9.0),
        ] {
            let (points, pieces) = pieces(corners, most);
            let of = |piece: [u32; 3]| piece.map(|n| points[n as usize]);
            assert!(pieces.iter().all(|&piece| longest(of(piece)) <= most));
            let total: f64 = pieces.iter().map(|&piece| area(of(piece))).sum();
            assert!((total / area(corners) - 1.0).abs() < 1e-9);
            assert!(pieces.len() < 1500, "{}", pieces.len());
        }
    }
}
