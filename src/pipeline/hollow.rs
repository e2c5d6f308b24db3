//! A solid shelled out: a cavity that keeps a wall of one thickness, and drains into it.

use std::f64::consts::TAU;

use glam::DVec3;
use serde::Serialize;

use super::kind::counted;
use super::morphology::{Voxels, usable, volume, with_voxels};
use super::{Error, MorphologyOptions, Options, Outcome, TriangleSource, VoxelSize, boolean, prepare, stages};
use crate::ldi::{Expression, Operands};
use crate::mesh::{ClosestTree, Pseudonormals, TriMesh};
use crate::morphology::Operation;
use crate::progress::{Progress, Stage};
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
    /// How the operand becomes a solid first, and the voxel size.
    pub solid: Options,
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

/// Repairs `input` and makes a cavity in it that stays the thickness of a wall away from the surface, which stays as it is but for the
/// drains.
///
/// # Errors
/// Those of [`boolean`]; [`Error::VoxelSize`] for a wall that the lattice cannot hold; [`Error::NothingEnclosed`] where the
/// solid is nowhere thick enough; [`Error::Drain`] for a drain that leads into no cavity.
pub fn hollow(input: &TriMesh, options: &HollowOptions, progress: &Progress) -> Result<Outcome, Error> {
    let wall = usable(options.wall)?;
    let h = prepare::spacing(&prepare::bounds(std::slice::from_ref(input))?, options.solid.voxel)?;
    check_sizes(options, h)?;
    let fixed = Options { voxel: VoxelSize::Length(h), ..options.solid.clone() };
    let solid = boolean(std::slice::from_ref(input), &Expression::Operand(0), &fixed, progress)?;
    let mut stages = stages::Stages::new(progress);
    stages.begin(Stage::Hollow)?;
    let bare = Options { classes: Vec::new(), ..fixed };
    let shrink = MorphologyOptions { operation: Operation::Erode, radius: wall, mitre: None, solid: bare.clone() };
    let nothing = || Error::NothingEnclosed {
        reason: format!(
            "nothing would be hollow: with walls of {}, the solid is nowhere thick enough for a cavity of 64 voxels; \
             use a thinner wall",
            short(wall)
        ),
    };
    let eroded = match with_voxels(&solid.mesh, &shrink, Voxels::OfRadius, progress) {
        Ok(outcome) => outcome.mesh,
        Err(Error::NothingEnclosed { .. }) => return Err(nothing()),
        Err(error) => return Err(error),
    };
    let (cavity, cavities, left_out) = without_crumbs(&eroded, LEAST_CAVITY * h.powi(3), progress)?;
    if cavities == 0 {
        return Err(nothing());
    }
    let drills = drills(&solid.mesh, &cavity, &options.drains, h)?;
    stages.begin(Stage::Subtract)?;
    let count = 2 + drills.len();
    let mut operands = vec![solid.mesh.clone(), cavity];
    operands.extend(drills.iter().map(|drill| drill.0.clone()));
    let made = boolean(&operands, &Expression::difference(count), &bare, progress)?;
    let source = |source: &TriangleSource| match *source {
        TriangleSource::Operand { operand: 0, triangle } => solid.sources[triangle as usize],
        _ => TriangleSource::Closed,
    };
    let sources: Vec<TriangleSource> = made.sources.iter().map(source).collect();
    let mut report = solid.report.clone();
    report.closed_triangles = sources.iter().filter(|source| **source == TriangleSource::Closed).count();
    report.hollow = Some(HollowReport {
        wall,
        volume_before: volume(&solid.mesh),
        volume_after: volume(&made.mesh),
        cavities,
        left_out,
        drains: drills.iter().map(|drill| drill.1).collect(),
    });
    report.warnings.extend(made.report.warnings.iter().cloned());
    report.stages.extend(stages.finish());
    let outcome = Outcome { mesh: made.mesh, sources, lattice: made.lattice, report };
    Ok(counted(outcome, std::slice::from_ref(input)))
}

fn check_sizes(options: &HollowOptions, h: f64) -> Result<(), Error> {
    let too_fine = |what: &str, length: f64, voxels: f64| {
        let (length, fits) = (short(length), short(0.99 * length / voxels));
        let reason = format!("{what} of {length} need a voxel of at most {fits}, and it is {}", short(h));
        Err(Error::VoxelSize { reason })
    };
    if options.wall < LEAST_WALL * h {
        return too_fine("walls", options.wall, LEAST_WALL);
    }
    for drain in &options.drains {
        if usable(drain.diameter)? < LEAST_DRAIN * h {
            return too_fine("drains", drain.diameter, LEAST_DRAIN);
        }
    }
    Ok(())
}

/// The bodies of at least some volume, how many these are, and how many others there were.
fn without_crumbs(mesh: &TriMesh, least: f64, progress: &Progress) -> Result<(TriMesh, usize, usize), Error> {
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
fn drills(solid: &TriMesh, cavity: &TriMesh, drains: &[Drain], h: f64) -> Result<Vec<(TriMesh, DrainReport)>, Error> {
    if drains.is_empty() {
        return Ok(Vec::new());
    }
    let (tree, normals) = (ClosestTree::of_mesh(solid), Pseudonormals::of(solid));
    let drill = |(number, drain): (usize, &Drain)| {
        let refused = |why: String| {
            let at = place(drain.at);
            Error::Drain { reason: format!("drain {} at {at} leads into no cavity: {why}", number + 1) }
        };
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
