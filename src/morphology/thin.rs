//! Walls thinner than a length: the middles between their two sides.

use glam::DVec3;
use rayon::prelude::*;

use super::Body;
use super::closed::samples_of;
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

/// A ball smaller than this, h, is no wall but an edge of the surface.
const SMALLEST: f64 = 1e-3;

/// Triangles of the middle are not longer than this many times the pieces of surface that they belong to, and one voxel.
const TORN: f64 = 2.0;

/// The middles of the walls of `body` that are thinner than `least`, as triangles that bound nothing: for each piece of the
/// surface, no larger than `h`, the centres of the largest balls that touch its corners from inside, where they touch the
/// surface on the other side, too; where only one that touches its centre does, a very small triangle there. All in model
/// units; empty where no wall is as thin.
pub fn middles(body: &Body<'_>, least: f64, h: f64, progress: &Progress) -> Result<TriMesh, Stopped> {
    let walls = Walls { body, radius: least / 2.0, h };
    let of = |t: usize| {
        if t.is_multiple_of(1024) {
            progress.check()?;
        }
        Ok(walls.behind(t))
    };
    let found: Vec<Vec<[DVec3; 3]>> =
        (0..body.mesh.triangles.len()).into_par_iter().map(of).collect::<Result<_, Stopped>>()?;
    let positions: Vec<DVec3> = found.into_iter().flatten().flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Ok(TriMesh { positions, triangles })
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
    body: &'a Body<'a>,
    radius: f64,
    h: f64,
}

impl Walls<'_> {
    /// The middles behind one triangle.
    fn behind(&self, t: usize) -> Vec<[DVec3; 3]> {
        let corners = self.body.mesh.corners(t);
        let normal = Plane::through(corners).normal;
        let (points, pieces) = samples_of(corners, self.h);
        let behind: Vec<Behind> = points.iter().map(|&p| self.at(p, normal)).collect();
        let middle = |piece: &[u32; 3]| {
            let ends = piece.map(|n| behind[n as usize]);
            if ends == [Behind::Thick; 3] {
                return None;
            }
            let [p, q, r] = piece.map(|n| points[n as usize]);
            if let [Behind::Wall(a), Behind::Wall(b), Behind::Wall(c)] = ends
                && longest([a, b, c]) <= TORN * (longest([p, q, r]) + self.h)
            {
                return Some([a, b, c]);
            }
            let Behind::Wall(centre) = self.at((p + q + r) / 3.0, normal) else { return None };
            let (u, v) = normal.any_orthonormal_pair();
            Some([centre, centre + u * SMALLEST * self.h, centre + v * SMALLEST * self.h])
        };
        pieces.iter().filter_map(middle).collect()
    }

    /// The largest ball, up to the radius, that touches the surface at `p` from inside.
    fn at(&self, p: DVec3, normal: DVec3) -> Behind {
        // Of a wall as thick as the ball, the other side is only seen by one that is this much larger.
        let mut r = self.radius / (1.0 - WITHIN / 2.0);
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
}

fn longest([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).length().max((c - b).length()).max((a - c).length())
}
