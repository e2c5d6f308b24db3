//! The first stages, for tests of the later ones.

use meshwright::lattice::{Grid, Lattice};
use meshwright::ldi::{Expression, Operands, Spans, ldis, spans};
use meshwright::mesh::{Plane, TriMesh};
use meshwright::progress::Progress;
use meshwright::vote::{Jury, VoteRule, Votes, Winding, vote_near_surface};

/// Lattice with `resolution` voxels along the longest side.
pub fn lattice_of(mesh: &TriMesh, resolution: u32) -> Lattice {
    let bounds = mesh.bounds().expect("triangles");
    Lattice::around(&bounds, bounds.size().max_element() / resolution as f64)
}

/// The spans of one operand, in all 13 directions.
pub fn spans_of(mesh: &TriMesh, lattice: &Lattice) -> Vec<Spans> {
    let operands = Operands::new([mesh.triangles.len()]);
    let layers = ldis(mesh, lattice, 1, &Progress::none()).expect("not stopped");
    layers.into_iter().map(|layers| spans(layers, &operands, &Expression::Operand(0))).collect()
}

/// Calls `judge` with the jury of one operand.
pub fn with_jury<T>(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule, judge: impl FnOnce(&Jury<'_>) -> T) -> T {
    let operands = Operands::new([mesh.triangles.len()]);
    let spans = spans_of(mesh, lattice);
    let winding = Winding::new(mesh, &operands, lattice, &Progress::none());
    let expression = Expression::Operand(0);
    judge(&Jury { spans: &spans, operands: &operands, expression: &expression, rule, winding: &winding })
}

/// The votes near the surface of one operand.
pub fn votes_of(mesh: &TriMesh, lattice: &Lattice, rule: VoteRule) -> Grid<Votes> {
    with_jury(mesh, lattice, rule, |jury| vote_near_surface(jury, &Progress::none()).expect("not stopped"))
}

/// The planes of a mesh's triangles, lattice coordinates.
pub fn planes_of(mesh: &TriMesh, lattice: &Lattice) -> Vec<Plane> {
    (0..mesh.triangles.len()).map(|t| Plane::through(mesh.corners(t).map(|p| lattice.to_lattice(p)))).collect()
}
