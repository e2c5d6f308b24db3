//! Points of an arrangement: vertices on the fine lattice, and exact crossings as homogeneous integers.

use std::cmp::Ordering;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::fine::ERROR;
use super::plane::Plane;
use super::wide::{Kept, PRIME, Wide, inverse, sign_of_determinant, times};

/// A point by its exact coordinates: those of `at`, divided by `w`, which is positive.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Exact {
    pub(crate) at: [Kept; 3],
    pub(crate) w: Kept,
}

impl Exact {
    pub(crate) fn lattice(at: [i32; 3]) -> Self {
        Self { at: at.map(|x| Kept::from(i64::from(x))), w: Kept::from(1) }
    }

    fn new(at: [Wide; 3], w: Wide) -> Self {
        let turn = |x: Wide| if w.sign() < 0 { x.neg() } else { x };
        Self { at: at.map(|x| turn(x).kept()), w: turn(w).kept() }
    }

    /// Where the line from `a` to `b` meets a plane on whose sides the two have the values `side_a` and `side_b`.
    pub(crate) fn on_line([a, b]: [[i32; 3]; 2], side_a: i128, side_b: i128) -> Self {
        let along = |k: usize| Wide::from(i128::from(b[k]) * side_a - i128::from(a[k]) * side_b);
        Self::new([along(0), along(1), along(2)], Wide::from(side_a - side_b))
    }

    /// Where three planes meet; `None` if they have no single point in common.
    pub(crate) fn of_planes([p, q, r]: [&Plane; 3]) -> Option<Self> {
        let normal = |plane: &Plane| plane.normal.map(Wide::from);
        let normals = [normal(p), normal(q), normal(r)];
        let crosses =
            [cross(&normals[1], &normals[2]), cross(&normals[2], &normals[0]), cross(&normals[0], &normals[1])];
        let w = dot(&normals[0], &crosses[0]);
        let offsets = [p, q, r].map(|plane| Wide::from(plane.offset));
        let coordinate =
            |k: usize| (0..3).fold(Wide::ZERO, |sum, plane| sum.add(&offsets[plane].mul(&crosses[plane][k])));
        (w.sign() != 0).then(|| Self::new([coordinate(0), coordinate(1), coordinate(2)], w))
    }

    /// The coordinates to within [`ERROR`].
    pub(crate) fn approximate(&self) -> DVec3 {
        let w = self.w.wide().to_f64();
        DVec3::from_array(self.at.map(|x| x.wide().to_f64() / w))
    }

    /// The vertex of the lattice that the point is, if it is one.
    fn as_lattice(&self, approximate: DVec3) -> Option<[i32; 3]> {
        let nearest = approximate.to_array().map(f64::round);
        if (0..3).any(|k| (approximate[k] - nearest[k]).abs() > ERROR) {
            return None;
        }
        let w = self.w.wide();
        let is_whole = |k: usize| w.mul(&Wide::from(nearest[k] as i64)).compare(&self.at[k].wide()).is_eq();
        (0..3).all(is_whole).then(|| nearest.map(|x| x as i32))
    }

    /// The same number however the point was made; `None` where `w` is a multiple of [`PRIME`], which happens at the ends of the lattice.
    fn hash(&self) -> Option<u64> {
        let w = self.w.wide().residue();
        let [x, y, z] = self.at.map(|x| x.wide().residue());
        // Multipliers without a pattern mix the coordinates.
        let sum = (x + times(y, 0x9e37_79b9_7f4a_7c15 & PRIME)) % PRIME + times(z, 0xc2b2_ae3d_27d4_eb4f & PRIME);
        (w != 0).then(|| times(sum % PRIME, inverse(w)))
    }

    fn equals(&self, other: &Self) -> bool {
        let (w, v) = (self.w.wide(), other.w.wide());
        (0..3).all(|k| self.at[k].wide().mul(&v).compare(&other.at[k].wide().mul(&w)).is_eq())
    }

    /// The exact side of a plane that the point lies on: 1 where its normal points to, 0 on it.
    pub(crate) fn side_of(&self, plane: &Plane) -> i32 {
        let terms = (0..3).map(|k| Wide::from(plane.normal[k]).mul(&self.at[k].wide()));
        let sum = terms.fold(Wide::ZERO, |sum, term| sum.add(&term));
        sum.sub(&Wide::from(plane.offset).mul(&self.w.wide())).sign()
    }

    /// How the coordinates along an axis compare.
    pub(crate) fn compare_along(&self, other: &Self, axis: usize) -> Ordering {
        self.at[axis].wide().mul(&other.w.wide()).compare(&other.at[axis].wide().mul(&self.w.wide()))
    }
}

fn dot(a: &[Wide; 3], b: &[Wide; 3]) -> Wide {
    a[0].mul(&b[0]).add(&a[1].mul(&b[1])).add(&a[2].mul(&b[2]))
}

fn cross(a: &[Wide; 3], b: &[Wide; 3]) -> [Wide; 3] {
    let part = |i: usize, j: usize| a[i].mul(&b[j]).sub(&a[j].mul(&b[i]));
    [part(1, 2), part(2, 0), part(0, 1)]
}

/// A point that has been made, ready to be given a number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Made {
    exact: Exact,
    pub(crate) approximate: DVec3,
    lattice: Option<[i32; 3]>,
    hash: Option<u64>,
}

impl Made {
    pub(crate) fn new(exact: Exact) -> Self {
        let approximate = exact.approximate();
        let lattice = exact.as_lattice(approximate);
        let hash = if lattice.is_some() { None } else { exact.hash() };
        Self { exact, approximate, lattice, hash }
    }

    pub(crate) fn exact(&self) -> Exact {
        self.exact
    }
}

/// The points of an arrangement by number: first the vertices, then what was made. A point has one number, however it was made.
#[derive(Debug, Default)]
pub(crate) struct Points {
    vertices: Vec<[i32; 3]>,
    made: Vec<Exact>,
    approximate: Vec<DVec3>,
    by_hash: FxHashMap<u64, Vec<u32>>,
    /// The points that have no hash as they were made first.
    without_hash: Vec<u32>,
    by_place: FxHashMap<[i32; 3], u32>,
}

impl Points {
    /// Vertices, each at a place of its own.
    pub(crate) fn new(vertices: Vec<[i32; 3]>) -> Self {
        let approximate = vertices.iter().map(|v| DVec3::from_array(v.map(f64::from))).collect();
        Self { vertices, approximate, ..Self::default() }
    }

    /// Makes these vertices ones that points which are made may turn out to be.
    pub(crate) fn expect(&mut self, vertices: impl Iterator<Item = u32>) {
        for v in vertices {
            self.by_place.insert(self.vertices[v as usize], v);
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.approximate.len()
    }

    /// The number of a point.
    pub(crate) fn number(&mut self, point: &Made) -> u32 {
        if let Some(&v) = point.lattice.as_ref().and_then(|at| self.by_place.get(at)) {
            return v;
        }
        let new = self.approximate.len() as u32;
        if let Some(at) = point.lattice {
            self.by_place.insert(at, new);
        } else {
            let first = self.vertices.len();
            let equals = |id: &u32| self.made[*id as usize - first].equals(&point.exact);
            let same = point.hash.and_then(|hash| self.by_hash.get(&hash));
            if let Some(&id) = same.into_iter().flatten().chain(&self.without_hash).find(|id| equals(id)) {
                return id;
            }
            match point.hash {
                Some(hash) => self.by_hash.entry(hash).or_default().push(new),
                None => {
                    // It may have been made in another way before.
                    if let Some(id) = (first as u32..new).find(equals) {
                        return id;
                    }
                    self.without_hash.push(new);
                }
            }
        }
        self.made.push(point.exact);
        self.approximate.push(point.approximate);
        new
    }

    /// The place of a point on the lattice, if it is a vertex.
    pub(crate) fn vertex(&self, point: u32) -> Option<[i32; 3]> {
        self.vertices.get(point as usize).copied()
    }

    pub(crate) fn approximate(&self, point: u32) -> DVec3 {
        self.approximate[point as usize]
    }

    pub(crate) fn exact(&self, point: u32) -> Exact {
        match self.vertices.get(point as usize) {
            Some(&at) => Exact::lattice(at),
            None => self.made[point as usize - self.vertices.len()],
        }
    }

    /// How two points compare along an axis.
    pub(crate) fn compare_along(&self, a: u32, b: u32, axis: usize) -> Ordering {
        let (x, y) = (self.approximate[a as usize][axis], self.approximate[b as usize][axis]);
        match a == b {
            true => Ordering::Equal,
            false if (x - y).abs() > 2.0 * ERROR => x.total_cmp(&y),
            false => self.exact(a).compare_along(&self.exact(b), axis),
        }
    }

    /// An axis along which two different points differ, the longest as far as floating point can tell.
    pub(crate) fn longest_axis(&self, a: u32, b: u32) -> usize {
        let size = (self.approximate(b) - self.approximate(a)).abs();
        let mut axes = [0, 1, 2];
        axes.sort_by(|&i, &j| size[j].total_cmp(&size[i]));
        axes.into_iter().find(|&axis| self.compare_along(a, b, axis).is_ne()).unwrap_or(axes[0])
    }

    /// Whether three points lie on one line.
    pub(crate) fn are_in_line(&self, a: u32, b: u32, c: u32) -> bool {
        let [p, q, r] = [a, b, c].map(|point| self.approximate(point));
        let size = (q - p).abs().max_element() + (r - p).abs().max_element();
        if (q - p).cross(r - p).abs().max_element() > 64.0 * ERROR * size + 1e-14 * size * size {
            return false;
        }
        let [p, q, r] = [a, b, c].map(|point| self.exact(point));
        let rows = [p, q, r].map(|point| (point.at.map(|x| x.wide()), point.w.wide()));
        (0..3).all(|axis| sign_of_determinant(&rows.map(|(at, w)| [at[(axis + 1) % 3], at[(axis + 2) % 3], w])) == 0)
    }

    /// On which side of a plane a point lies: 1 where its normal points to, 0 on it.
    pub(crate) fn side(&self, plane: &Plane, point: u32) -> i32 {
        let clear = plane.clear_side(self.approximate[point as usize]);
        if clear != 0 {
            return clear;
        }
        match self.vertices.get(point as usize) {
            Some(&at) => plane.value(at).signum() as i32,
            None => self.made[point as usize - self.vertices.len()].side_of(plane),
        }
    }
}
