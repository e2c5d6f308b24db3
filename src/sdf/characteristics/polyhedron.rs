//! Towers, wedges and cones as half-spaces, and what a slice, a row and a line of voxels see of them.
//!
//! The half-spaces are reduced axis by axis (Fourier–Motzkin): each that bounds x from below with each that bounds it
//! from above gives one in y and z alone, and those of y give intervals of z. So no slice and no row is visited that the
//! polyhedron does not meet. Every step adds non-negative multiples of half-spaces, which keeps the margin they have larger than
//! what is rounded off.

use glam::{DVec3, IVec3};

use crate::sdf::exact::{EdgeFeature, FaceFeature, MARGIN, Measured, Region, VertexFeature};

/// A side this steep, or less, along an axis does not bound it.
const LEVEL: f64 = 1e-100;

/// The points `q` with `normal · q ≥ least`.
#[derive(Debug, Clone, Copy)]
pub(super) struct HalfSpace {
    normal: DVec3,
    least: f64,
}

/// A feature with the polyhedron that holds its region within the band.
pub(super) trait Solid: Region {
    /// A point of the feature.
    fn place(&self) -> DVec3;
    /// The half-spaces; points are given from [`Self::place`].
    fn sides(&self, band: f64, add: &mut dyn FnMut(DVec3, f64));
    /// Distance and side of a point of the polyhedron; `None` where the region was left.
    fn distance(&self, p: DVec3) -> Option<Measured>;
}

impl Solid for FaceFeature {
    fn place(&self) -> DVec3 {
        self.corners[0]
    }

    /// The tower: three sides, and a lid at either end.
    fn sides(&self, band: f64, add: &mut dyn FnMut(DVec3, f64)) {
        for (&inner, corner) in self.inner.iter().zip(self.corners) {
            add(inner, inner.dot(corner - self.corners[0]));
        }
        add(self.normal, -band);
        add(-self.normal, -band);
    }

    fn distance(&self, p: DVec3) -> Option<Measured> {
        self.measure(p)
    }
}

impl Solid for EdgeFeature {
    fn place(&self) -> DVec3 {
        self.start
    }

    /// The wedge: its two ends, the sides it shares with towers, and the back.
    fn sides(&self, band: f64, add: &mut dyn FnMut(DVec3, f64)) {
        add(self.along, 0.0);
        add(-self.along, -self.length);
        beyond(&self.sides, band, add);
        within(self.bounds(band), self.start, add);
    }

    fn distance(&self, p: DVec3) -> Option<Measured> {
        self.measure(p)
    }
}

impl Solid for VertexFeature {
    fn place(&self) -> DVec3 {
        self.at
    }

    /// The cone, which is none at a saddle: what lies beyond the ends of all edges.
    fn sides(&self, band: f64, add: &mut dyn FnMut(DVec3, f64)) {
        beyond(&self.sides, band, add);
        within(self.bounds(band), self.at, add);
    }

    fn distance(&self, p: DVec3) -> Option<Measured> {
        self.measure(p)
    }
}

/// What none of the directions leads to, and a lid across the middle of that. Where the lid lies does not matter for what
/// is right: nothing within the band is farther along any direction.
fn beyond(directions: &[DVec3], band: f64, add: &mut dyn FnMut(DVec3, f64)) {
    for &direction in directions.iter().filter(|&&direction| direction != DVec3::ZERO) {
        add(-direction, 0.0);
    }
    if let Some(middle) = directions.iter().sum::<DVec3>().try_normalize() {
        add(middle, -band);
    }
}

fn within([low, high]: [DVec3; 2], place: DVec3, add: &mut dyn FnMut(DVec3, f64)) {
    for (k, axis) in DVec3::AXES.into_iter().enumerate() {
        add(axis, (low - place)[k]);
        add(-axis, (place - high)[k]);
    }
}

/// A side as seen along an axis: there it lies at `at + slope · rest`, with the other coordinates in `rest`.
#[derive(Debug, Clone, Copy)]
struct Wall {
    at: f64,
    slope: DVec3,
}

/// What bounds one coordinate, given those that come later in the order x, y, z.
#[derive(Debug, Default)]
struct Walls {
    low: Vec<Wall>,
    high: Vec<Wall>,
}

impl Walls {
    /// Moves those of `sides` that bound `axis` here.
    fn take(&mut self, axis: usize, sides: &mut Vec<HalfSpace>) {
        self.low.clear();
        self.high.clear();
        sides.retain_mut(|side| {
            let steepness = std::mem::take(&mut side.normal[axis]);
            if steepness.abs() <= LEVEL {
                return true;
            }
            let wall = Wall { at: side.least / steepness, slope: side.normal / -steepness };
            if steepness > 0.0 {
                self.low.push(wall)
            } else {
                self.high.push(wall)
            }
            false
        });
    }

    /// Adds what the other coordinates must fulfil to leave room between the walls.
    fn combine(&self, sides: &mut Vec<HalfSpace>) {
        for low in &self.low {
            let with = |high: &Wall| HalfSpace { normal: high.slope - low.slope, least: low.at - high.at };
            sides.extend(self.high.iter().map(with));
        }
    }

    /// The coordinates between the walls at `rest`.
    #[inline]
    fn interval(&self, rest: DVec3) -> [f64; 2] {
        let place = |wall: &Wall| wall.at + wall.slope.dot(rest);
        let low = self.low.iter().map(place).fold(f64::NEG_INFINITY, f64::max);
        [low, self.high.iter().map(place).fold(f64::INFINITY, f64::min)]
    }
}

/// One polyhedron after the other, in the same memory.
#[derive(Debug, Default)]
pub(super) struct Polyhedron {
    /// The voxel that coordinates are counted from.
    origin: IVec3,
    sides: Vec<HalfSpace>,
    x: Walls,
    y: Walls,
    z: Walls,
}

impl Polyhedron {
    /// Takes the polyhedron of `solid`. Then [`Self::rows`] and [`Self::line`] can be asked.
    pub(super) fn set(&mut self, solid: &impl Solid, band: f64) {
        let place = solid.place();
        self.origin = place.round().as_ivec3();
        let place = place - self.origin.as_dvec3();
        self.sides.clear();
        solid.sides(band, &mut |normal, least| {
            self.sides.push(HalfSpace { normal, least: least + normal.dot(place) - MARGIN });
        });
        self.x.take(0, &mut self.sides);
        self.x.combine(&mut self.sides);
        self.y.take(1, &mut self.sides);
    }

    /// The slices along z that it meets, of those `of`; the first is past the last where there are none.
    pub(super) fn slices(&mut self, of: [i32; 2]) -> [i32; 2] {
        self.y.combine(&mut self.sides);
        self.z.take(2, &mut self.sides);
        self.z.combine(&mut self.sides);
        if self.sides.iter().any(|side| side.least > 0.0) {
            return NOTHING;
        }
        voxels(self.z.interval(DVec3::ZERO), self.origin.z, of)
    }

    /// The rows of slice `z` that it meets.
    pub(super) fn rows(&self, z: i32, of: [i32; 2]) -> [i32; 2] {
        voxels(self.y.interval(DVec3::new(0.0, 0.0, f64::from(z - self.origin.z))), self.origin.y, of)
    }

    /// The voxels of row `y` of slice `z` that it holds.
    #[inline]
    pub(super) fn line(&self, y: i32, z: i32, of: [i32; 2]) -> [i32; 2] {
        let [y, z] = [f64::from(y - self.origin.y), f64::from(z - self.origin.z)];
        voxels(self.x.interval(DVec3::new(0.0, y, z)), self.origin.x, of)
    }
}

/// No voxels.
const NOTHING: [i32; 2] = [0, -1];

/// The first and the last voxel of an interval, of those from the first to the last in `of`.
#[inline]
fn voxels([low, high]: [f64; 2], origin: i32, of: [i32; 2]) -> [i32; 2] {
    let origin = f64::from(origin);
    let low = (low + origin).ceil().max(f64::from(of[0]));
    let high = (high + origin).floor().min(f64::from(of[1]));
    if low <= high { [low as i32, high as i32] } else { NOTHING }
}
