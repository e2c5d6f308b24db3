//! The repair of one object of several.

use super::exit::{Exit, Failure};
use super::input::Input;
use super::length::Scale;
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::site::Site;
use super::solid::{self, Job};
use super::{change::Changed, limits};
use crate::io::{Colours, TextureMap};
use crate::ldi::Expression;
use crate::mesh::{Solid, TriMesh, Validity};
use crate::pipeline::{self, Advice, Operand, Options, Report, StageTime};

/// What became of an object.
pub enum Done {
    /// It was a solid already, and keeps all of its triangles. The mesh is there where its numbers, its vertices or its format are others.
    Kept(Option<Mesh>),
    /// It has another mesh.
    Repaired(Mesh),
    /// It stays as it is, for this reason.
    Left(String),
}

/// A mesh and what it looks like.
pub struct Mesh {
    /// The mesh.
    pub mesh: TriMesh,
    /// Its colours.
    pub colours: Option<Colours>,
    /// Its textures.
    pub texture: Option<TextureMap>,
}

/// An object after its repair.
pub struct Repaired {
    /// What became of it.
    pub done: Done,
    /// What was found and done.
    pub pipeline: Option<Box<Report>>,
    /// How long the stages took.
    pub stages: Vec<StageTime>,
    /// Sentences a user should read.
    pub warnings: Vec<String>,
    /// Whether the result is what the object describes, and no guess.
    pub is_whole: bool,
}

/// Repairs an object. What encloses nothing, or would be mostly lost, is left as it is. `is_kept`: whether the file keeps the mesh of an object
/// that needs nothing.
pub fn repaired(
    job: &Job<'_>,
    input: &Input,
    (options, scale): (&Options, &Scale),
    is_kept: bool,
    session: &Session,
) -> Result<Repaired, Failure> {
    let args = job.args;
    let was_solid = input.entry.validity.as_ref().is_some_and(Validity::is_valid);
    let operands = [Operand::from(&input.loaded)];
    let failed = |e: &dyn Advice| solid::failure(&e, std::slice::from_ref(input), scale.unit, args);
    let (surface, progress) = (&options.surface(), &session.progress);
    let site = Site { operands: &operands, surface, scale, failed: &failed, progress };
    let mut report = RunReport::new("repair");
    let made = solid::made(job, &Expression::Operand(0), options, &site, &mut report);
    let mut outcome = match made {
        Ok(Changed { outcome, .. }) => outcome,
        Err(failure) => return left(failure),
    };
    if let Some(volume) = args.drop_smaller {
        let least = volume.resolve(scale)?;
        match pipeline::drop_smaller(outcome, operands, least, progress) {
            Ok((smaller, _)) => outcome = smaller,
            Err(error) => return left(failed(&error)),
        }
    }
    let stages = std::mem::take(&mut outcome.report.stages);
    let mut warnings: Vec<String> = outcome.report.warnings.iter().map(ToString::to_string).collect();
    report.result = Some(RunResult::solid(outcome.report.clone()));
    let lost = limits::lost(&report);
    let pipeline = Some(Box::new(outcome.report));
    if !lost.is_empty() && !args.keeps_partial() {
        let why = format!("{}; --keep-partial writes this result all the same", lost.join("; "));
        return Ok(Repaired { done: Done::Left(why), pipeline, stages, warnings, is_whole: false });
    }
    let guessed = limits::guessed(&report);
    let is_whole = lost.is_empty() && guessed.is_none();
    warnings.extend(lost.into_iter().chain(guessed));
    let is_same = is_same(&outcome.solid, &input.loaded.mesh);
    let keeps_all = was_solid && pipeline.as_ref().is_some_and(|pipeline| pipeline.kept_all());
    let keeps_all = keeps_all && outcome.solid.triangles.len() == input.loaded.mesh.triangles.len();
    let (colours, texture) = (outcome.colours, outcome.texture);
    let mesh = Mesh { mesh: outcome.solid.into_mesh(), colours, texture };
    let done = match (is_same, keeps_all) {
        (true, _) if is_kept => Done::Kept(None),
        (true, _) | (_, true) => Done::Kept(Some(mesh)),
        _ => Done::Repaired(mesh),
    };
    Ok(Repaired { done, pipeline, stages, warnings, is_whole })
}

/// An object that cannot be repaired; what ends the whole run stays an error.
fn left(failure: Failure) -> Result<Repaired, Failure> {
    match failure.exit {
        Exit::Input | Exit::Limit | Exit::Usage => {
            let hint = failure.hint.map_or(String::new(), |hint| format!(" ({hint})"));
            let done = Done::Left(failure.message + &hint);
            Ok(Repaired { done, pipeline: None, stages: Vec::new(), warnings: Vec::new(), is_whole: false })
        }
        _ => Err(failure),
    }
}

/// Whether a solid has exactly the triangles of a mesh, in any order.
fn is_same(solid: &Solid, mesh: &TriMesh) -> bool {
    if solid.triangles.len() != mesh.triangles.len() {
        return false;
    }
    let keys = |mesh: &TriMesh| {
        let key = |t: usize| {
            // Adding zero turns −0 into 0.
            let corners = mesh.corners(t).map(|p| (p + 0.0).to_array().map(f64::to_bits));
            let first = (0..3).min_by_key(|&k| corners[k]).unwrap_or(0);
            [corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]]
        };
        let mut keys: Vec<_> = (0..mesh.triangles.len()).map(key).collect();
        keys.sort_unstable();
        keys
    };
    keys(solid) == keys(mesh)
}
