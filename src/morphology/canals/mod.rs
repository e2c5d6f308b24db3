//! Canals: what a closing would fill, place by place, with the widest ball that passes.
//!
//! The voxels that the closing fills fall into connected parts. Each part meets the solid, and where the ball comes near,
//! the open: its mouths. Filling one changes the solid's handles by what its voxels' Euler number says, which tells
//! tunnels from the rounding of inner edges; a part with one mouth is a pit if it is half again deeper than wide.

mod fill;
mod passage;
mod topology;

use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::closed::{BESIDE, samples};
use super::{Balls, Centres, Gauge, OffsetError, Region};
use crate::lattice::{Grid, Lattice};
use crate::mesh::{Plane, TriMesh};
use crate::progress::Progress;
use fill::{Fill, FilledPart};

/// Where a canal leads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum CanalKind {
    /// The canal leads through the solid: filling it takes handles away.
    Tunnel,
    /// The canal ends blindly, half again deeper than wide: a narrow hole, a groove, a crack.
    Pit,
    /// The canal lies between two bodies, which filling it joins.
    Gap,
    /// The canal leads into a wide chamber, which filling it shuts.
    Neck,
    /// The space is shut already.
    Cavity,
}

impl std::fmt::Display for CanalKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Tunnel => "tunnel",
            Self::Pit => "pit",
            Self::Gap => "gap",
            Self::Neck => "neck",
            Self::Cavity => "cavity",
        })
    }
}

/// One canal. All its measures are in model units.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Canal {
    /// The number of the canal, counted from 1; the widest has the lowest.
    pub number: u32,
    /// Where the canal leads, which decides what filling it does.
    pub kind: CanalKind,
    /// Diameter of the largest ball that passes (that goes halfway in, for a pit; that fits, for a cavity).
    pub diameter: f64,
    /// Length of the way through the filled part, or to its farthest point.
    pub length: f64,
    /// A point where it is narrowest.
    pub position: [f64; 3],
    /// Volume that would be filled, counted in voxels.
    pub volume: f64,
    /// Handles of the solid that filling takes away: by how much the genus shrinks.
    pub handles: u32,
}

/// The canals of a solid.
pub struct Canals {
    /// All canals in the order of their numbers, the widest first.
    pub list: Vec<Canal>,
    /// Number of shallow places that the closing rounds: inner edges and dents.
    pub roundings: usize,
    /// For each voxel the number of the canal that it belongs to, or that it borders on; 0: none.
    of: Grid<u32>,
}

impl Canals {
    /// The voxels of the canals that are `chosen` by their numbers.
    pub fn region(&self, chosen: impl Fn(u32) -> bool) -> Region<'_> {
        let chosen = (0..=self.list.len() as u32).map(|number| number > 0 && chosen(number)).collect();
        Region { of: &self.of, chosen }
    }

    /// For each triangle of the solid the number of the canal that most of it is a wall of; 0: none.
    pub fn walls(&self, solid: &TriMesh, lattice: &Lattice) -> Vec<u32> {
        let over = |t: usize| {
            let corners = solid.corners(t);
            let up = Plane::through(corners).normal * BESIDE;
            let number = |p: DVec3| self.of.get((lattice.to_lattice(p) + up).round().as_ivec3());
            // Triangles around a mouth have some points beside it.
            let mut numbers: Vec<u32> = samples(corners, lattice.h).into_iter().map(number).collect();
            let middle = numbers.len() / 2;
            *numbers.select_nth_unstable(middle).1
        };
        (0..solid.triangles.len()).into_par_iter().map(over).collect()
    }
}

/// The canals that a closing of the solid `original` by these balls fills.
///
/// # Errors
/// Those of [`crate::sdf::exact::exact`], and a stop.
pub fn canals(
    original: &Gauge<'_>,
    (balls, centres): (&Balls<'_>, &Centres),
    lattice: &Lattice,
    progress: &Progress,
) -> Result<Canals, OffsetError> {
    let fill = Fill::new(original, balls, lattice, progress)?;
    let shells = [&topology::shells(original.mesh), &centres.spaces];
    let parts = fill.parts();
    let judge = |part: &FilledPart| {
        progress.check()?;
        let changes = topology::changes(part, &fill, [original, &balls.centres], shells, lattice);
        let canal = passage::measure(part, &changes, original.distance(), lattice);
        // Where a ball passes halfway in all the same, only the edges of a wide place are rounded.
        Ok(canal.filter(|canal| canal.diameter < 2.0 * balls.radius))
    };
    let judged: Vec<Option<Canal>> = parts.par_iter().map(judge).collect::<Result<_, OffsetError>>()?;
    let roundings = judged.iter().filter(|canal| canal.is_none()).count();
    let mut found: Vec<(Canal, &FilledPart)> =
        judged.into_iter().zip(&parts).filter_map(|(canal, part)| Some((canal?, part))).collect();
    found.sort_by(|a, b| b.0.diameter.total_cmp(&a.0.diameter));
    (1..).zip(&mut found).for_each(|(number, (canal, _))| canal.number = number);
    let of = fill.numbered(found.iter().map(|(_, part)| *part));
    Ok(Canals { list: found.into_iter().map(|(canal, _)| canal).collect(), roundings, of })
}
