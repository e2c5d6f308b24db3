//! A solid shelled out: a cavity that keeps a wall of one thickness, and drains into it.

use std::f64::consts::TAU;

use glam::DVec3;
use serde::Serialize;

use super::morphology::{Voxels, plan_offsets, with_voxels};
use super::offsets::{usable, volume};
use super::plan::Offsets;
use super::stages::Stages;
use super::{
    BooleanError, Changed, LatticeError, MorphologyError, MorphologyOptions, Plan, Report, SurfaceOptions,
    TriangleSource, boolean, sizing,
};
use crate::ldi::{Expression, Operands};
use crate::mesh::{ClosestTree, Pseudonormals, Solid, TriMesh};
use crate::morphology::Operation;
use crate::progress::{Progress, Stage, Stopped};
use crate::shells::{Shell, bodies, shells};

/// Walls are at least this many voxels thick.
const LEAST_WALL: f64 = 2.0;

/// Drains are at least this many voxels wide.
const LEAST_DRAIN: f64 = 4.0;

/// Cavities of less than so many voxels, by volume, are not made: nothing is saved by them.
const LEAST_CAVITY: f64 = 64.0;

/// Sides of the prism that a drain is.
const SIDES: usize = 48;

/// Options of [`hollow`].
#[derive(Debug, Clone, PartialEq)]
pub struct HollowOptions {
    /// Thickness of the wall, model units; at least two voxels.
    pub wall: f64,
    /// Holes through the wall.
    pub drains: Vec<Drain>,
    /// How the new surface is made.
    pub surface: SurfaceOptions,
}

/// A round hole from the surface into a cavity, across the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drain {
    /// Its diameter, model units; at least four voxels.
    pub diameter: f64,
    /// A point on the surface or near it: the hole begins at the nearest place.
    pub at: DVec3,
}

/// What was hollowed.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HollowReport {
    /// Thickness of the wall, model units.
    pub wall: f64,
    /// Volume of the solid before, cubic model units.
    pub volume_before: f64,
    /// Volume after.
    pub volume_after: f64,
    /// Cavities made.
    pub cavities: usize,
    /// Cavities of less than 64 voxels that were not made.
    pub left_out: usize,
    /// The drains.
    pub drains: Vec<DrainReport>,
}

/// A drain as it was made; model units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DrainReport {
    /// Where it begins, on the surface.
    pub at: [f64; 3],
    /// Its direction, inwards.
    pub direction: [f64; 3],
    /// Its diameter.
    pub diameter: f64,
    /// How long it is, from the surface to the cavity.
    pub depth: f64,
}

/// Why a solid could not be hollowed. Lengths are in model units.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum HollowError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// Walls or drains are too thin for the voxels.
    #[error("{what} of {} need a voxel of at most {}, and it is {}", short(*length), short(0.99 * length / voxels), short(*voxel))]
    TooThin {
        /// `walls` or `drains`.
        what: &'static str,
        /// Their thickness or diameter.
        length: f64,
        /// How many voxels that has to be at least.
        voxels: f64,
        /// The voxel.
        voxel: f64,
    },
    /// The solid is nowhere thick enough.
    #[error(
        "nothing would be hollow: with walls of {}, the solid is nowhere thick enough for a cavity of 64 voxels; \
         use a thinner wall",
        short(*wall)
    )]
    NoCavity {
        /// Thickness of the wall.
        wall: f64,
    },
    /// A drain leads nowhere.
    #[error("drain {number} at {} leads into no cavity: {why}", place(*at))]
    Drain {
        /// Its number, from 1.
        number: usize,
        /// The point that was given for it.
        at: DVec3,
        /// One sentence.
        why: String,
    },
    /// The erosion that makes the cavity failed.
    #[error(transparent)]
    Erosion(MorphologyError),
    /// Taking the cavity and the drains away failed.
    #[error(transparent)]
    Difference(#[from] BooleanError),
}

/// Makes a cavity in a solid that stays the thickness of a wall away from the surface, which stays as it is but for the drains.
///
/// # Errors
/// See [`HollowError`].
pub fn hollow(solid: &Solid, options: &HollowOptions, progress: &Progress) -> Result<Changed, HollowError> {
    let wall = usable(options.wall)?;
    let bounds = sizing::bounds([solid.mesh()]).map_err(|_| HollowError::NoCavity { wall })?;
    let h = sizing::spacing(&bounds, options.surface.voxel)?;
    check_sizes(options, h)?;
    let surface = options.surface.with_voxel(h);
    let mut stages = Stages::new(progress);
    stages.begin(Stage::Hollow)?;
    let shrink = MorphologyOptions { operation: Operation::Erode, radius: wall, sharp: None, surface };
    let eroded = match with_voxels(solid, &shrink, Voxels::OfRadius, progress) {
        Ok(changed) => changed.solid,
        Err(MorphologyError::NothingLeft { .. } | MorphologyError::AllTooThin { .. }) => {
            return Err(HollowError::NoCavity { wall });
        }
        Err(error) => return Err(error.into()),
    };
    let (cavity, cavities, left_out) = without_crumbs(&eroded, LEAST_CAVITY * h.powi(3), progress)?;
    if cavities == 0 {
        return Err(HollowError::NoCavity { wall });
    }
    let drills = drills(solid, &cavity, &options.drains, h)?;
    stages.begin(Stage::Subtract)?;
    let operands = [solid.mesh(), &cavity].into_iter().chain(drills.iter().map(|drill| &drill.0));
    let made = boolean(operands, &Expression::difference(2 + drills.len()), &surface.into(), progress)?;
    let own = |source: &TriangleSource| match *source {
        TriangleSource::Operand { operand: 0, triangle } => Some(triangle),
        _ => None,
    };
    let account = HollowReport {
        wall,
        volume_before: volume(solid),
        volume_after: volume(&made.solid),
        cavities,
        left_out,
        drains: drills.iter().map(|drill| drill.1).collect(),
    };
    let report =
        Report { hollow: Some(account), warnings: made.report.warnings, stages: stages.finish(), ..Report::default() };
    Ok(Changed { own: made.sources.iter().map(own).collect(), solid: made.solid, lattice: made.lattice, report })
}

/// What [`hollow`] would cost for a solid that is about where `mesh` is.
///
/// # Errors
/// Those of [`hollow`] that come before anything is made.
pub fn plan_hollow(mesh: &TriMesh, options: &HollowOptions) -> Result<Plan, HollowError> {
    let radius = usable(options.wall)?;
    Ok(plan_offsets(mesh, &options.surface, Offsets { count: 1, radius, thin: false })?)
}

fn check_sizes(options: &HollowOptions, h: f64) -> Result<(), HollowError> {
    let too_thin = |what: &'static str, length, voxels| Err(HollowError::TooThin { what, length, voxels, voxel: h });
    if options.wall < LEAST_WALL * h {
        return too_thin("walls", options.wall, LEAST_WALL);
    }
    for drain in &options.drains {
        if usable(drain.diameter)? < LEAST_DRAIN * h {
            return too_thin("drains", drain.diameter, LEAST_DRAIN);
        }
    }
    Ok(())
}

impl From<MorphologyError> for HollowError {
    fn from(error: MorphologyError) -> Self {
        match error {
            MorphologyError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Erosion(other),
        }
    }
}

impl From<LatticeError> for HollowError {
    fn from(error: LatticeError) -> Self {
        Self::Erosion(error.into())
    }
}

/// The bodies of at least some volume, how many these are, and how many others there were.
fn without_crumbs(mesh: &TriMesh, least: f64, progress: &Progress) -> Result<(TriMesh, usize, usize), Stopped> {
    let shells = shells(mesh, &Operands::new([mesh.triangles.len()]));
    let all = bodies(mesh, &shells, progress)?;
    let count = all.len();
    let volume = |body: &[usize]| body.iter().map(|&n| shells.list[n].volume).sum::<f64>();
    let large: Vec<Vec<usize>> = all.into_iter().filter(|body| volume(body) >= least).collect();
    let kept: Vec<&Shell> = large.iter().flatten().map(|&n| &shells.list[n]).collect();
    let mut triangles: Vec<u32> = kept.iter().flat_map(|shell| shell.triangles.iter().copied()).collect();
    triangles.sort_unstable();
    let part = TriMesh {
        positions: mesh.positions.clone(),
        triangles: triangles.iter().map(|&t| mesh.triangles[t as usize]).collect(),
    };
    Ok((part.welded(), large.len(), count - large.len()))
}

/// A prism to take away for each drain, and what it is.
fn drills(
    solid: &TriMesh,
    cavity: &TriMesh,
    drains: &[Drain],
    h: f64,
) -> Result<Vec<(TriMesh, DrainReport)>, HollowError> {
    if drains.is_empty() {
        return Ok(Vec::new());
    }
    let (tree, normals) = (ClosestTree::of_mesh(solid), Pseudonormals::of(solid));
    let drill = |(number, drain): (usize, &Drain)| {
        let refused = |why: String| HollowError::Drain { number: number + 1, at: drain.at, why };
        let nearest = tree.nearest(drain.at).ok_or_else(|| refused("there is no surface".into()))?;
        let out = normals.at(&nearest);
        let Some(across) = out.try_normalize() else { return Err(refused("the surface has no side there".into())) };
        let shaft = Shaft { foot: nearest.point, out: across, radius: drain.diameter / 2.0, solid, cavity, h };
        let (depth, from, to) = shaft.reach().map_err(refused)?;
        let report = DrainReport {
            at: nearest.point.to_array(),
            direction: (-across).to_array(),
            diameter: drain.diameter,
            depth,
        };
        Ok((shaft.prism(from, to), report))
    };
    drains.iter().enumerate().map(drill).collect()
}

/// The way of a drain: heights are along `out`, from the foot.
struct Shaft<'a> {
    /// On the surface.
    foot: DVec3,
    /// Unit normal of the surface there.
    out: DVec3,
    radius: f64,
    solid: &'a TriMesh,
    cavity: &'a TriMesh,
    h: f64,
}

impl Shaft<'_> {
    /// The depth of the cavity below the foot, and from which height to which the shaft goes: it begins outside of the solid and
    /// ends within the cavity, all around as far as there is room.
    fn reach(&self) -> Result<(f64, f64, f64), String> {
        let below = |mesh| -> Vec<f64> {
            let mut heights = crossings(mesh, self.foot, self.out);
            heights.retain(|&height| height < -1e-9 * self.radius);
            heights.sort_by(|a, b| b.total_cmp(a));
            heights
        };
        let (cavity, through) = (below(self.cavity), below(self.solid));
        let through = through.iter().find(|&&height| height < -self.h / 16.0);
        let enters = match (cavity.first(), through) {
            (Some(&enters), through) if through.is_none_or(|&through| enters > through) => enters,
            (_, Some(&through)) => {
                return Err(format!(
                    "across the wall, along {}, it comes out again after {} without meeting one",
                    place(-self.out),
                    short(-through)
                ));
            }
            _ => return Err(format!("there is none along {}", place(-self.out))),
        };
        let leaves = cavity.get(1).copied().unwrap_or(enters - 2.0 * self.radius);
        let lowest = leaves + (enters - leaves) / 4.0;
        let (mut top, mut bottom) = (self.h, enters - self.h);
        for offset in self.rim() {
            // From within the wall, outwards to the surface and inwards to the cavity.
            let from = self.foot + offset + self.out * (enters / 2.0);
            let ahead = |mesh, way: DVec3| crossings(mesh, from, way).into_iter().filter(|&s| s > 0.0).reduce(f64::min);
            if let Some(up) = ahead(self.solid, self.out).filter(|&up| up < 2.0 * self.radius - enters) {
                top = f64::max(top, enters / 2.0 + up + self.h);
            }
            if let Some(down) = ahead(self.cavity, -self.out).filter(|&down| down < 2.0 * self.radius - enters) {
                bottom = f64::min(bottom, enters / 2.0 - down - self.h);
            }
        }
        // What lies opposite of the foot, across a gap, is not drilled.
        let opposite = crossings(self.solid, self.foot, self.out).into_iter().filter(|&s| s > self.h / 16.0);
        let room = opposite.reduce(f64::min).map_or(f64::INFINITY, |gap| gap / 2.0);
        Ok((-enters, top.min(room), bottom.max(lowest)))
    }

    fn rim(&self) -> [DVec3; SIDES] {
        let (u, v) = self.out.any_orthonormal_pair();
        std::array::from_fn(|k| {
            let (sin, cos) = (TAU * k as f64 / SIDES as f64).sin_cos();
            (u * cos + v * sin) * self.radius
        })
    }

    fn prism(&self, from: f64, to: f64) -> TriMesh {
        let rim = self.rim();
        let ring = |height: f64| rim.iter().map(move |&offset| self.foot + offset + self.out * height);
        let ends = [to, from].map(|height| self.foot + self.out * height);
        let positions = ring(to).chain(ring(from)).chain(ends).collect();
        let n = SIDES as u32;
        let side = |k: u32| {
            let next = (k + 1) % n;
            [[k, next, n + next], [k, n + next, n + k], [2 * n, next, k], [2 * n + 1, n + k, n + next]]
        };
        TriMesh { positions, triangles: (0..n).flat_map(side).collect() }
    }
}

fn place(p: DVec3) -> String {
    p.to_array().map(short).join(" ")
}

/// Four significant digits.
fn short(x: f64) -> String {
    format!("{x:.3e}").parse::<f64>().map_or_else(|_| x.to_string(), |x| x.to_string())
}

/// How far along a line from `from` it crosses the triangles of a mesh, in no order.
fn crossings(mesh: &TriMesh, from: DVec3, along: DVec3) -> Vec<f64> {
    let crossing = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let (u, v) = (b - a, c - a);
        let across = along.cross(v);
        let turn = u.dot(across);
        if turn == 0.0 {
            return None;
        }
        let off = from - a;
        let s = off.dot(across) / turn;
        let other = off.cross(u);
        let t = along.dot(other) / turn;
        (s >= 0.0 && t >= 0.0 && s + t <= 1.0).then(|| v.dot(other) / turn)
    };
    (0..mesh.triangles.len()).filter_map(crossing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ValidateOptions, validate};

    #[test]
    fn a_drill_is_a_closed_prism_that_faces_outwards() {
        let nothing = TriMesh::default();
        let out = DVec3::new(0.6, 0.0, 0.8);
        let shaft = Shaft { foot: DVec3::ONE, out, radius: 2.0, solid: &nothing, cavity: &nothing, h: 0.1 };
        let state = validate(&shaft.prism(1.0, -4.0), &ValidateOptions::default(), &Progress::none());
        let state = state.expect("not stopped");
        let circle = SIDES as f64 / 2.0 * (TAU / SIDES as f64).sin() * 4.0;
        assert!(state.is_valid() && (state.volume / (5.0 * circle) - 1.0).abs() < 1e-12, "{state:?}");
    }
}
