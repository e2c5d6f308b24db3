//! The canals of a solid: which there are, and the solid without them.

use serde::Serialize;

use super::frame::Frame;
use super::morphology::{Run, checked_voxel, usable};
use super::plan::Offsets;
use super::{Error, MorphologyOptions, Options, Outcome, boolean, kind, stages};
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::morphology::{self, Balls, Body, Canal, Operation};
use crate::progress::{Progress, Stage};

/// Options of [`canals`].
#[derive(Debug, Clone, PartialEq)]
pub struct CanalOptions {
    /// Canals through which no ball of this diameter passes, model units, are listed.
    pub max_diameter: f64,
    /// Which of them are filled.
    pub remove: Remove,
    /// How the operand becomes a solid first, and the voxel size.
    pub solid: Options,
}

/// Which canals are filled.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Remove {
    /// None: they are only listed.
    None,
    /// All.
    All,
    /// Those with these numbers.
    These(Vec<u32>),
}

/// What was found of canals.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CanalReport {
    /// The diameter that was asked for, model units.
    pub max_diameter: f64,
    /// The canals, the widest first.
    pub canals: Vec<Canal>,
    /// Shallow places that a closing would round besides: inner edges and dents.
    pub roundings: usize,
    /// Numbers of the canals that were filled.
    pub removed: Vec<u32>,
}

/// The solid, without the canals that were to be filled, and what there is to say of its canals.
#[derive(Debug, Clone)]
pub struct CanalOutcome {
    /// The solid; its report has the list.
    pub outcome: Outcome,
    /// For each triangle of the solid the number of the canal that it bounds, 0 for none; after a removal all 0.
    pub canal_of: Vec<u32>,
}

/// Repairs `input` and lists the canals that a closing would fill; fills those that were asked for, and leaves the rest of
/// the surface as it was.
///
/// # Errors
/// Those of [`boolean`]; [`Error::VoxelSize`] for a diameter that the lattice cannot hold; [`Error::MissingCanal`].
pub fn canals(input: &TriMesh, options: &CanalOptions, progress: &Progress) -> Result<CanalOutcome, Error> {
    let radius = usable(options.max_diameter / 2.0)?;
    let frame = Frame::of(std::slice::from_ref(input), &options.solid);
    let input = &frame.local(std::slice::from_ref(input))[0];
    let h = checked_voxel(input, &options.solid, Offsets { count: 2, radius, thin: false })?;
    let solid = boolean(std::slice::from_ref(input), &Expression::Operand(0), &options.solid, progress)?;
    let closing = MorphologyOptions { operation: Operation::Close, radius, mitre: None, solid: options.solid.clone() };
    let mut stages = stages::Stages::new(progress);
    let run = Run { solid: &solid.mesh, h, options: &closing, progress };

    let body = Body::new(&solid.mesh, None);
    let centres = run.there(&body, radius, &mut stages)?;
    let balls = Balls::new(&centres, radius);
    stages.begin(Stage::Canals)?;
    let lattice = run.lattice(0.0)?;
    let canals = morphology::canals(&body, (&balls, &centres), &lattice, progress).map_err(|e| run.error(e))?;
    let removed = chosen(&options.remove, canals.list.len() as u32)?;
    let (mut outcome, canal_of) = if removed.is_empty() {
        let canal_of = canals.walls(&solid.mesh, &lattice);
        let mut outcome = solid.clone();
        outcome.report.stages.extend(stages.finish());
        (outcome, canal_of)
    } else {
        let region = canals.region(|number| removed.contains(&number));
        let made = run.back(&body, &balls, radius, Some(&region), &mut stages)?;
        let outcome = run.finish(&solid, made, stages);
        let canal_of = vec![0; outcome.mesh.triangles.len()];
        (outcome, canal_of)
    };
    outcome.report.canals = Some(CanalReport {
        max_diameter: options.max_diameter,
        canals: canals.list,
        roundings: canals.roundings,
        removed,
    });
    Ok(CanalOutcome { outcome: frame.global(kind::counted(outcome, std::slice::from_ref(input))), canal_of })
}

/// The numbers that are meant, of `count`.
fn chosen(remove: &Remove, count: u32) -> Result<Vec<u32>, Error> {
    match remove {
        Remove::None => Ok(Vec::new()),
        Remove::All => Ok((1..=count).collect()),
        Remove::These(numbers) => match numbers.iter().find(|&&number| number == 0 || number > count) {
            Some(&number) => Err(Error::MissingCanal { number, count }),
            None => Ok((1..=count).filter(|number| numbers.contains(number)).collect()),
        },
    }
}
