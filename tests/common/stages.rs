//! The first stages, for tests of the later ones.

use meshwright::lattice::{Grid, Lattice};
use meshwright::ldi::Spans;
use meshwright::mesh::{Plane, TriMesh};
use meshwright::progress::Progress;
use meshwright::survey::Survey;
use meshwright::vote::{Jury, VoteRule, Votes};

/// Lattice with `resolution` voxels along the longest side.
pub fn lattice_of(mesh: &TriMesh, resolution: u32) -> Lattice {
    let bounds = mesh.bounds().expect("triangles");
    Lattice::around(&bounds, bounds.size().max_element() / resolution as f64)
}

fn survey(mesh: &TriMesh, lattice: &Lattice) -> Survey {
    Survey::of_mesh(mesh, lattice, &Progress::none()).expect("not stopped")
}

/// The spans of one operand, in all 13 directions.
pub fn spans_of(mesh: &TriMesh, lattice: &Lattice) -> Vec<Spans> {
    survey(mesh, lattice).spans
}

/// Calls `judge` with the jury of one operand.
pub fn with_jury<T>(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule, judge: impl FnOnce(&Jury<'_>) -> T) -> T {
    let survey = survey(mesh, lattice);
    let winding = survey.winding(&Progress::none());
    judge(&survey.jury(rule, &winding))
}

/// The votes near the surface of one operand.
pub fn votes_of(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule) -> Grid<Votes> {
    let survey = survey(mesh, lattice);
    survey.votes(rule, &survey.winding(&Progress::none()), &Progress::none()).expect("not stopped")
}

/// The planes of a mesh's triangles, lattice coordinates.
pub fn planes_of(mesh: &TriMesh, lattice: &Lattice) -> Vec<Plane> {
    survey(mesh, lattice).planes()
}
