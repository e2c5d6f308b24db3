//! Where a field is zero on the lattice edges whose ends differ in sign.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::Field;
use crate::contour::LatticeEdge;
use crate::lattice::{BRICK, BRICK_VOXELS, Bricks, DistanceField, Slot, brick_of, index_in_brick, voxel_in_brick};
use crate::progress::{Progress, Stopped};

/// A point whose value is nearer to zero than this, h, is on the level.
const AT_LEVEL: f64 = 1e-6;
/// Steps towards the points of the level.
const MOST_STEPS: usize = 60;
/// Edges whose next points are asked for together.
const PACKET: usize = 64;

/// The passages of all edges that begin in a stored brick.
pub(super) struct Passages<'a> {
    bricks: &'a Bricks,
    /// For each stored brick the number of its edges, 3 times the voxel's and the axis, and where on them the field is zero.
    of_bricks: Vec<Vec<(u16, f64)>>,
    /// Those of edges that begin in a brick that is not stored and end in one that is.
    others: Vec<(IVec3, u8, f64)>,
}

/// An edge on the way to its passage: regula falsi with the Illinois rule, by which the end that stays counts half.
struct Search {
    ends: [DVec3; 2],
    low: (f64, f64),
    high: (f64, f64),
    found: Option<f64>,
}

impl Search {
    fn next(&mut self) -> DVec3 {
        let (t, low, high) = (self.place(), self.low.0, self.high.0);
        let within = t > low && t < high && high - low > 1e-12;
        if !within {
            self.found = Some(t.clamp(low, high));
        }
        self.ends[0].lerp(self.ends[1], t)
    }

    /// Where the straight line between the ends is zero.
    fn place(&self) -> f64 {
        let (low, high) = (self.low, self.high);
        low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1))
    }

    fn take(&mut self, value: f64, near: f64) {
        let t = self.place();
        if value.abs() <= near {
            self.found = Some(t);
        } else if (value < 0.0) == (self.low.1 < 0.0) {
            (self.low, self.high.1) = ((t, value), self.high.1 / 2.0);
        } else {
            (self.high, self.low.1) = ((t, value), self.low.1 / 2.0);
        }
    }
}

impl<'a> Passages<'a> {
    /// The passages of `field`, whose values at voxels are `values`.
    pub(super) fn of(field: &dyn Field, values: &'a DistanceField, progress: &Progress) -> Result<Self, Stopped> {
        let bricks = values.grid.bricks.active();
        let found = bricks.par_iter().map(|&brick| {
            progress.check()?;
            let edges = edges(values, brick);
            let mut searches: Vec<Search> = edges.iter().map(|edge| search(values, edge)).collect();
            searches.chunks_mut(PACKET).for_each(|packet| pass(field, packet, AT_LEVEL * values.lattice.h));
            let place = |s: &Search| s.found.unwrap_or((s.low.0 + s.high.0) / 2.0);
            Ok(edges.into_iter().zip(searches.iter().map(place)).collect::<Vec<_>>())
        });
        let found = found.collect::<Result<Vec<_>, Stopped>>()?;
        let mut others = Vec::new();
        let mut of_bricks = Vec::with_capacity(found.len());
        for (edges, &brick) in found.into_iter().zip(bricks) {
            let (own, before): (Vec<_>, Vec<_>) = edges.into_iter().partition(|(e, _)| brick_of(e.voxel) == brick);
            others.extend(before.into_iter().map(|(edge, t)| (edge.voxel, edge.axis, t)));
            of_bricks.push(own.into_iter().map(|(edge, t)| (number(&edge), t)).collect());
        }
        others.sort_by_key(|(voxel, axis, _)| (voxel.z, voxel.y, voxel.x, *axis));
        Ok(Self { bricks: &values.grid.bricks, of_bricks, others })
    }

    /// Where on `edge` the field is zero: 0 at its lower voxel, 1 at its upper one.
    pub(super) fn at(&self, edge: LatticeEdge) -> Option<f64> {
        if let Slot::Active(n) = self.bricks.slot(brick_of(edge.voxel)) {
            let list = &self.of_bricks[n as usize];
            return list.binary_search_by_key(&number(&edge), |(number, _)| *number).ok().map(|at| list[at].1);
        }
        let key = |voxel: IVec3, axis: u8| (voxel.z, voxel.y, voxel.x, axis);
        let wanted = key(edge.voxel, edge.axis);
        let found = self.others.binary_search_by_key(&wanted, |(voxel, axis, _)| key(*voxel, *axis));
        found.ok().map(|at| self.others[at].2)
    }
}

fn number(edge: &LatticeEdge) -> u16 {
    3 * index_in_brick(edge.voxel) as u16 + u16::from(edge.axis)
}

/// The edges with a passage that begin in a brick, in order, and those that end in it and begin in one that is not stored.
fn edges(values: &DistanceField, brick: IVec3) -> Vec<LatticeEdge> {
    let DistanceField { lattice, grid, .. } = values;
    let mut edges = Vec::new();
    let inside = |voxel: IVec3| {
        let held = voxel.cmpge(IVec3::ZERO).all() && voxel.cmplt(lattice.dims).all();
        held && grid.get(voxel) < 0.0
    };
    for n in 0..BRICK_VOXELS {
        let voxel = BRICK * brick + voxel_in_brick(n);
        let own = inside(voxel);
        for axis in 0..3u8 {
            let step = IVec3::AXES[axis as usize];
            if own != inside(voxel + step) {
                edges.push(LatticeEdge { voxel, axis });
            }
            let before = voxel - step;
            let first = brick_of(before) != brick && !matches!(grid.bricks.slot(brick_of(before)), Slot::Active(_));
            if first && own != inside(before) {
                edges.push(LatticeEdge { voxel: before, axis });
            }
        }
    }
    edges
}

fn search(values: &DistanceField, edge: &LatticeEdge) -> Search {
    let ends = [edge.voxel, edge.voxel + IVec3::AXES[edge.axis as usize]];
    let [low, high] = ends.map(|voxel| values.length(values.grid.get(voxel)));
    let ends = ends.map(|voxel| values.lattice.to_model(voxel.as_dvec3()));
    // At the border of the lattice both ends may be inside: there the surface is cut off half-way.
    let found = ((low < 0.0) == (high < 0.0)).then_some(0.5);
    Search { ends, low: (0.0, low), high: (1.0, high), found }
}

/// Brings all searches to their ends, step by step together.
fn pass(field: &dyn Field, searches: &mut [Search], near: f64) {
    let (mut points, mut values, mut open) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..MOST_STEPS {
        points.clear();
        open.clear();
        for (k, search) in searches.iter_mut().enumerate().filter(|(_, search)| search.found.is_none()) {
            let next = search.next();
            if search.found.is_none() {
                points.push(next);
                open.push(k);
            }
        }
        if points.is_empty() {
            return;
        }
        values.resize(points.len(), 0.0);
        field.values(&points, &mut values);
        open.iter().zip(&values).for_each(|(&k, &value)| searches[k].take(value, near));
    }
}
