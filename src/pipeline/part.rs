//! A part of space in which surface is made anew, while all beyond it stays as it is.

use glam::{DVec3, IVec3, Vec3Swizzles};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::plan;
use crate::fit::{Kept, Seams, Surface};
use crate::lattice::{BRICK, Domain, Lattice, brick_of};
use crate::mesh::{Bounds, Shape, TriMesh};
use crate::survey::Survey;

/// What is made keeps so many voxels away from the border, along which the contour is closed.
pub(super) const CLEAR: f64 = 3.0;

/// Bricks around places where triangles that stay end: room for more of them to go where the two do not fit.
const ROOM: i32 = 2;
/// Around an open rim the part reaches so far beyond its box, of its diagonal, since a surface over it bulges.
const BULGE: f64 = 0.25;
/// Voxels are looked at along the part's border and where surface is in it: that is worth while if there are no more bricks than so many times those that
/// the area of all of the surface fills, of which voxels are in half as many again.
const MOST: f64 = 0.75;
/// Boxes of more bricks than this are not stored brick by brick.
const LARGE: f64 = 512.0;
/// And more than so many bricks for each of them are not looked at.
const MOST_LOOKS: f64 = 64.0;

/// Where surface is made anew.
#[derive(Debug, Clone)]
pub(super) enum Part {
    /// In a box, model units, of a lattice that holds nothing else.
    Box(Bounds),
    /// In some bricks of a lattice that holds everything.
    Bricks(Lattice, Domain),
}

impl Part {
    /// Whether a point, model units, is beyond it or at its border.
    pub(super) fn is_beyond(&self, p: DVec3) -> bool {
        match self {
            Self::Box(Bounds { min, max }) => (p.cmplt(*min) | p.cmpgt(*max)).any(),
            Self::Bricks(lattice, domain) => !domain.holds_around(lattice.to_lattice(p), CLEAR),
        }
    }

    /// Whether a triangle, model units, is not all within it.
    fn is_left_by(&self, corners: [DVec3; 3]) -> bool {
        match self {
            Self::Box(_) => corners.into_iter().any(|p| self.is_beyond(p)),
            Self::Bricks(lattice, domain) => touched(&corners, lattice).any(|brick| !domain.holds(brick)),
        }
    }

    /// Whether all triangles of a source that are not all within the part are triangles of a surface, once each, and nothing else of the surface leaves it.
    pub(super) fn stays_beyond(&self, surface: &Surface, source: &TriMesh) -> bool {
        let own: Vec<Option<u32>> =
            (0..surface.mesh.triangles.len() as u32).map(|t| surface.source_triangle(t)).collect();
        let made_stays = |(t, own): (usize, &Option<u32>)| own.is_some() || !self.is_left_by(surface.mesh.corners(t));
        if !own.par_iter().enumerate().all(made_stays) {
            return false;
        }
        let mut times = vec![0u32; source.triangles.len()];
        own.iter().flatten().for_each(|&t| times[t as usize] += 1);
        times.par_iter().enumerate().all(|(t, &times)| times == 1 || !self.is_left_by(source.corners(t)))
    }

    /// The bricks around all places where triangles that are kept end, of the survey's lattice, and their share of what all of the surface would cost; `None` where that is
    /// not worth while.
    pub(super) fn around_seams(survey: &Survey, kept: &Kept) -> Option<(Self, f64)> {
        let lattice = survey.lattice;
        let surface = plan::area(&survey.soup.mesh) / (f64::from(BRICK) * lattice.h).powi(2);
        let Seams { others, edges, rims } = kept.seams();
        let mut taken = Taken { lattice, bricks: FxHashSet::default(), looks: (MOST_LOOKS * surface) as i64 };
        others.iter().try_for_each(|triangle| taken.touched_by(triangle))?;
        edges.iter().try_for_each(|edge| taken.touched_by(edge))?;
        let boxes: Vec<[IVec3; 2]> = rims.iter().map(|rim| around(rim, &lattice)).collect();
        let room = MOST * surface - boxes.iter().map(|&sides| skin(sides)).sum::<f64>();
        if room < 0.0 {
            return None;
        }
        let mut bricks = grown(&taken.bricks, room as usize)?;
        let share = MOST - (room - bricks.len() as f64) / surface;
        let (large, small): (Vec<_>, Vec<_>) = boxes.into_iter().partition(|&[low, high]| volume(low, high) > LARGE);
        small.into_iter().for_each(|[low, high]| bricks.extend(all_between(low, high)));
        Some((Self::Bricks(lattice, Domain::of(&lattice).within(bricks, large)), share))
    }
}

/// The bricks around an open rim, the lowest and the highest, and room for a surface over it.
fn around(rim: &Bounds, lattice: &Lattice) -> [IVec3; 2] {
    let room = BULGE * rim.diagonal() + f64::from(ROOM * BRICK) * lattice.h;
    [rim.min - room, rim.max + room].map(|p| brick_at(lattice, p))
}

/// The bricks of a box.
fn volume(low: IVec3, high: IVec3) -> f64 {
    (high - low + 1).as_dvec3().element_product()
}

/// Those along the faces of a box of which about half lies inside the solid.
fn skin([low, high]: [IVec3; 2]) -> f64 {
    let size = (high - low + 1).as_dvec3();
    (size * size.yzx()).element_sum()
}

/// The brick that a point, model units, lies in.
fn brick_at(lattice: &Lattice, p: DVec3) -> IVec3 {
    brick_of(lattice.to_lattice(p).floor().as_ivec3())
}

fn all_between(low: IVec3, high: IVec3) -> impl Iterator<Item = IVec3> {
    (low.z..=high.z)
        .flat_map(move |z| (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z))))
}

/// The bricks that a shape touches, and perhaps some that it only comes near to.
fn touched<'a, S: Shape>(shape: &'a S, lattice: &'a Lattice) -> impl Iterator<Item = IVec3> + 'a {
    let bounds = shape.bounds();
    let [low, high] = [bounds.min, bounds.max].map(|p| brick_at(lattice, p));
    let is_small = (high - low).max_element() <= 1;
    let side = f64::from(BRICK);
    // Half of a brick's diagonal, and what rounding may take.
    let reach = (0.5 * 3f64.sqrt() + 1e-6) * side * lattice.h;
    let touches = move |&brick: &IVec3| {
        let centre = lattice.to_model((brick.as_dvec3() + 0.5) * side);
        is_small || shape.nearest(centre).0.distance(centre) <= reach
    };
    all_between(low, high).filter(touches)
}

/// Bricks that shapes touch, as long as there are not too many to look at.
struct Taken {
    lattice: Lattice,
    bricks: FxHashSet<IVec3>,
    looks: i64,
}

impl Taken {
    fn touched_by<S: Shape>(&mut self, shape: &S) -> Option<()> {
        let bounds = shape.bounds();
        let [low, high] = [bounds.min, bounds.max].map(|p| brick_at(&self.lattice, p));
        self.looks = self.looks.saturating_sub((high - low + 1).as_i64vec3().element_product());
        (self.looks >= 0).then(|| self.bricks.extend(touched(shape, &self.lattice)))
    }
}

/// Bricks and all within [`ROOM`] of them, unless they are more than `most`.
fn grown(bricks: &FxHashSet<IVec3>, most: usize) -> Option<FxHashSet<IVec3>> {
    let mut grown = bricks.clone();
    for axis in IVec3::AXES {
        let before: Vec<IVec3> = grown.iter().copied().collect();
        for brick in before {
            grown.extend((-ROOM..=ROOM).map(|k| brick + k * axis));
        }
        if grown.len() > most {
            return None;
        }
    }
    Some(grown)
}
