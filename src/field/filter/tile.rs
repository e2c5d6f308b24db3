//! A cube of space in which a field is interpolated between the points of a lattice.

use glam::{DVec3, IVec3};

use crate::field::Sample;

/// Cells along the side of a tile: with the points at both ends and one beyond each, 32 points, a whole number of bricks.
pub(super) const CELLS: i32 = 29;
const POINTS: usize = CELLS as usize + 1;
/// The part of the second differences that is taken away from the values: see [`Tile`].
const PART: f32 = 1.0 / 12.0;

/// Values at the points of a lattice, less a twelfth of their second differences along the axes. Between points, linear
/// interpolation is ½ t (1 − t) of the second difference too high, a twelfth of it in the mean: with the values so
/// changed the mean over a cell is right, in smooth parts and across creases alike, and means are what a filter takes.
pub(super) struct Tile {
    values: Vec<f32>,
}

impl Tile {
    /// The tile of the values of a cube.
    pub fn new(given: &[f32]) -> Option<Self> {
        let side = POINTS + 2;
        let steps = [1, side, side * side];
        let mut values = Vec::with_capacity(POINTS.pow(3));
        for n in 0..POINTS.pow(3) {
            let at = (n % POINTS + 1) + side * ((n / POINTS % POINTS + 1) + side * (n / POINTS.pow(2) + 1));
            let own = *given.get(at)?;
            let second = steps.map(|step| given[at - step] - 2.0 * own + given[at + step]);
            values.push(own - PART * (second[0] + second[1] + second[2]));
        }
        Some(Self { values })
    }

    /// Bytes of memory that one takes.
    pub const MEMORY: usize = size_of::<Self>() + POINTS.pow(3) * size_of::<f32>();

    /// The values at the corners of the cell that holds a place, given in cells, and where in the cell that is.
    #[inline]
    fn cell(&self, at: DVec3) -> ([f32; 8], [f32; 3]) {
        let low = at.as_ivec3().clamp(IVec3::ZERO, IVec3::splat(CELLS - 1));
        let first = low.x as usize + POINTS * (low.y as usize + POINTS * low.z as usize);
        let value = |k: usize| self.values[first + (k & 1) + POINTS * (k >> 1 & 1) + POINTS * POINTS * (k >> 2)];
        (std::array::from_fn(value), (at - low.as_dvec3()).as_vec3().to_array())
    }

    /// The value, model units, at a place in the tile, given in cells.
    #[inline]
    pub fn value(&self, at: DVec3) -> f64 {
        let (v, [x, y, z]) = self.cell(at);
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let [low, high] = [0, 4].map(|k| mix(mix(v[k], v[k + 1], x), mix(v[k + 2], v[k + 3], x), y));
        f64::from(mix(low, high, z))
    }

    /// Value and gradient there, where the cells have this edge, model units.
    pub fn sample(&self, at: DVec3, edge: f64) -> Sample {
        let (v, place) = self.cell(at);
        let (v, [x, y, z]) = (v.map(f64::from), place.map(f64::from));
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let along = |k: usize, step: usize| v[k + step] - v[k];
        let face = |of: [f64; 4], s: f64, t: f64| mix(mix(of[0], of[1], s), mix(of[2], of[3], s), t);
        let gradient = DVec3::new(
            face([0, 2, 4, 6].map(|k| along(k, 1)), y, z),
            face([0, 1, 4, 5].map(|k| along(k, 2)), x, z),
            face([0, 1, 2, 3].map(|k| along(k, 4)), x, y),
        );
        Sample { value: self.value(at), gradient: gradient / edge }
    }
}
