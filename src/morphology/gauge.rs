//! What the distance to a solid or a sheet is measured with.

use glam::DVec3;

use crate::mesh::around::Around;
use crate::mesh::{Feature, Plane, TriMesh};
use crate::sdf::exact::{ExactDistance, Nearest, PointSign};

/// A point whose value is nearer to the level than this, h, is at it.
const AT_LEVEL: f64 = 1e-7;

/// Steps towards one point of the level; the second half of them halve what is left.
const MOST_STEPS: usize = 60;

/// Measures the distance to a solid or to a sheet, or the distance whose levels keep the edges sharp.
pub struct Gauge<'a> {
    pub(super) mesh: &'a TriMesh,
    distance: ExactDistance,
    around: Around,
    /// How many times the offset a sharp edge may reach, at most; `None`: edges become round.
    pub(super) mitre: Option<f64>,
    /// Whether it encloses nothing: all its points are outside.
    pub(super) sheet: bool,
}

impl<'a> Gauge<'a> {
    /// The solid bounded by `mesh`, a closed, oriented manifold. With `mitre`, edges that an offset would make round stay
    /// sharp as far as this many times the offset from where they were, at least 1.
    pub fn new(mesh: &'a TriMesh, mitre: Option<f64>) -> Self {
        let distance = ExactDistance::of(mesh, PointSign::Pseudonormal);
        Self { mesh, distance, around: Around::new(mesh), mitre: mitre.map(|limit| limit.max(1.0)), sheet: false }
    }

    /// A sheet without an inside, whatever its triangles are; only positive levels have a surface.
    pub fn sheet(mesh: &'a TriMesh) -> Self {
        let distance = ExactDistance::of(mesh, PointSign::Unsigned);
        Self { mesh, distance, around: Around::new(mesh), mitre: None, sheet: true }
    }

    /// The distance itself, edges rounded.
    pub fn distance(&self) -> &ExactDistance {
        &self.distance
    }

    /// The value at `p` whose levels are offsets, model units, and its gradient; infinite for an empty solid. It is found
    /// soonest if the surface is nearer than `likely`, model units.
    pub fn at(&self, p: DVec3, likely: f64) -> (f64, DVec3) {
        match self.distance.within(p, likely).or_else(|| self.distance.at(p)) {
            Some(nearest) => self.mitred(p, &nearest),
            None => (f64::INFINITY, DVec3::ZERO),
        }
    }

    /// Where the value is `level` between `ends` (model units), where it is `values`; `None` where these lie on one side
    /// of the level. Newton's method, held between the points known to lie on either side.
    pub(super) fn passage(&self, ends: [DVec3; 2], values: [f64; 2], level: f64) -> Option<f64> {
        let way = ends[1] - ends[0];
        let mut low = (0.0, values[0] - level);
        let mut high = (1.0, values[1] - level);
        if (low.1 < 0.0) == (high.1 < 0.0) {
            return None;
        }
        let between = |low: (f64, f64), high: (f64, f64)| low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
        let mut t = between(low, high);
        for step in 0..MOST_STEPS {
            let (value, gradient) = self.at(ends[0] + way * t, level.abs() + 2.0 * way.length());
            let off = value - level;
            if off.abs() < AT_LEVEL * way.length() {
                break;
            }
            let end = if (off < 0.0) == (low.1 < 0.0) { &mut low } else { &mut high };
            *end = (t, off);
            let newton = t - off / gradient.dot(way);
            let within = newton > low.0 && newton < high.0;
            t = if within && step < MOST_STEPS / 2 { newton } else { (low.0 + high.0) / 2.0 };
        }
        Some(t)
    }

    /// Over an edge or a corner the farthest of its faces' planes counts, so that they go on until they meet.
    fn mitred(&self, p: DVec3, nearest: &Nearest) -> (f64, DVec3) {
        let plain = (nearest.signed, nearest.gradient);
        let Some(limit) = self.mitre.filter(|_| nearest.feature != Feature::Inside) else { return plain };
        let corners = self.mesh.triangles[nearest.triangle as usize];
        let ends = match nearest.feature {
            Feature::Edge(k) => [corners[usize::from(k)], corners[(usize::from(k) + 1) % 3]],
            Feature::Corner(k) => [corners[usize::from(k)]; 2],
            Feature::Inside => return plain,
        };
        let sign = nearest.signed.signum();
        let faces = self.around.of(ends[0]).iter().filter(|&&t| self.mesh.triangles[t as usize].contains(&ends[1]));
        let planes = faces.map(|&t| Plane::through(self.mesh.corners(t as usize)));
        let farthest = planes
            .map(|plane| (sign * plane.distance(p), plane.normal))
            .filter(|(far, _)| far.is_finite())
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((far, normal)) = farthest else { return plain };
        let least = nearest.signed.abs() / limit;
        if far < least { (sign * least, nearest.gradient) } else { (sign * far, normal) }
    }
}
