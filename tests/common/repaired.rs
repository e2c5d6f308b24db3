//! Pipelines one after another, as the command line has them: a repair, and what is done to the solid.

use meshwright::mesh::TriMesh;
use meshwright::pipeline::{
    BooleanError, CanalError, CanalOptions, CanalReport, Changed, HollowError, HollowOptions, MorphologyError,
    MorphologyOptions, Options, Outcome, SurfaceOptions, ThickenError, ThickenOptions, canals, hollow, morphology,
    repair, thicken,
};
use meshwright::progress::Progress;

fn repaired(mesh: &TriMesh, surface: &SurfaceOptions) -> Outcome {
    repair(mesh, &Options::from(*surface), &Progress::none()).expect("a solid")
}

fn followed(outcome: Outcome, changed: Changed, mesh: &TriMesh) -> Outcome {
    outcome.followed_by(changed, [mesh], &Progress::none()).expect("not stopped")
}

pub fn morphed(mesh: &TriMesh, options: &MorphologyOptions) -> Result<Outcome, MorphologyError> {
    let outcome = repaired(mesh, &options.surface);
    let changed = morphology(&outcome.solid, options, &Progress::none())?;
    Ok(followed(outcome, changed, mesh))
}

pub fn hollowed(mesh: &TriMesh, options: &HollowOptions) -> Result<Outcome, HollowError> {
    let outcome = repaired(mesh, &options.surface);
    let changed = hollow(&outcome.solid, options, &Progress::none())?;
    Ok(followed(outcome, changed, mesh))
}

pub fn thickened(mesh: &TriMesh, options: &ThickenOptions) -> Result<Outcome, ThickenError> {
    let made = match repair(mesh, &Options::from(options.surface), &Progress::none()) {
        Ok(outcome) => Some(outcome),
        Err(BooleanError::Nothing(_)) => None,
        Err(error) => panic!("{error}"),
    };
    let solid = made.as_ref().map(|outcome| &outcome.solid);
    let changed = thicken(solid, mesh, options, &Progress::none())?;
    Ok(match made {
        Some(outcome) => followed(outcome, changed, mesh),
        None => changed.into(),
    })
}

/// The solid, without the canals that were to be filled, and the list.
pub fn without_canals(mesh: &TriMesh, options: &CanalOptions) -> Result<(Outcome, CanalReport), CanalError> {
    let outcome = repaired(mesh, &options.surface);
    let found = canals(&outcome.solid, options, &Progress::none())?;
    let outcome = match found.filled {
        Some(changed) => followed(outcome, changed, mesh),
        None => outcome,
    };
    Ok((outcome, found.report))
}
