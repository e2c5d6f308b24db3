//! The whole way from operands to a result.

use glam::DVec3;

use super::again::touching;
use super::cells::{Cells, Gap, Ring, gaps};
use super::draft::Kind;
use super::extract::extract;
use super::facets::Facets;
use super::fine::Fine;
use super::merge::merge;
use super::refine::{Refined, refine};
use super::round::{Rounded, round};
use super::surface::Surface;
use super::turn::Turned;
use super::{ArrangeError, ArrangeOptions, ArrangeReport, Opening};
use crate::ldi::{Expression, Operands};
use crate::mesh::TriMesh;
use crate::mesh::edges::Edges;
use crate::orient::OrientMode;
use crate::progress::Progress;

/// An exact result, with rounded vertices.
#[derive(Debug, Clone, Default)]
pub struct Arranged {
    /// The surface; nothing if nothing is inside.
    pub mesh: TriMesh,
    /// For each triangle the number of one of the input that it lies on.
    pub sources: Vec<u32>,
    /// What was found and done.
    pub report: ArrangeReport,
}

/// At most so many pairs of triangles that touch are cut: some gigabytes.
const MOST_PAIRS: usize = 4_000_000;

/// Evaluates a boolean expression over operands that lie one after another in `mesh`, exactly: each has to be closed once everything is cut where
/// it crosses.
///
/// Vertices of the input keep their coordinates in the result, made single precision if that is asked for.
///
/// # Errors
/// [`ArrangeError::Open`] where an operand has holes; see there for others.
pub fn arrange(
    mesh: &TriMesh,
    operands: &Operands,
    options: &ArrangeOptions<'_>,
    progress: &Progress,
) -> Result<Arranged, ArrangeError> {
    match attempted(mesh, operands, options, progress) {
        // On the lattice more triangles may touch than where they were looked at: then only one of two neighbours is cut at their edge.
        Err(ArrangeError::Open { cut: 1.., .. }) if options.suspects.contains(&false) => {
            attempted(mesh, operands, &ArrangeOptions { suspects: &[], ..*options }, progress)
        }
        result => result,
    }
}

/// [`arrange`], with only the suspects looked at.
fn attempted(
    mesh: &TriMesh,
    operands: &Operands,
    options: &ArrangeOptions<'_>,
    progress: &Progress,
) -> Result<Arranged, ArrangeError> {
    let input: Vec<DVec3> = match options.single {
        true => mesh.positions.iter().map(|p| p.as_vec3().as_dvec3()).collect(),
        false => mesh.positions.clone(),
    };
    let fine = Fine::around(mesh, options.single);
    let (refined, kinds, pairs) = refined(mesh, &fine, options.suspects, progress)?;
    let owner = Turned::none(operands, mesh.triangles.len());
    let corners = refined.corners();
    let edges = Edges::new(&corners, refined.points.len());
    let open = gaps(&refined, &edges, &owner, &Ring::default());
    if !open.is_empty() {
        return Err(opened(&refined, &open, &fine, operands.count()));
    }
    let cells = Cells::of(&refined, &edges, &Ring::default(), progress)?;
    let Some(winding) = cells.winding(&refined, operands.count(), &owner) else {
        return Err(opened(&refined, &[], &fine, operands.count()));
    };
    let (owner, winding) = match options.orient == OrientMode::Auto && operands.inside.needs_outward() {
        true => Turned::outward(mesh, operands, (&refined, &cells), winding),
        false => (owner, winding),
    };
    let inside = inside(&winding, operands, options.expression);
    let class = |t: u32| options.classes.get(t as usize).copied().unwrap_or(0);
    let found = extract(&refined, &cells, &inside);
    let faces = merge(&refined, found, &class, progress)?;
    let (turned, turned_triangles) = owner.counts();
    let mut report = ArrangeReport {
        triangles: mesh.triangles.len(),
        pairs,
        cut: refined.cut(),
        points: refined.points.len() - refined.facets.vertices.len(),
        curves: refined.curves.len(),
        cells: cells.count,
        turned,
        turned_triangles,
        ..ArrangeReport::default()
    };
    if faces.is_empty() {
        return Ok(Arranged { report, ..Arranged::default() });
    }
    let surface = Surface { refined: &refined, faces: &faces, kinds: &kinds, fine: &fine, input: &input, options };
    let Rounded { mesh, sources, rounds, separated, volume_error } =
        round(&surface, progress)?.ok_or(ArrangeError::Rounding)?;
    (report.rounds, report.separated, report.volume_error) = (rounds as usize, separated, volume_error);
    Ok(Arranged { mesh, sources, report })
}

/// The triangles on the lattice, cut where they touch; what each vertex is; and how many pairs touch.
fn refined(
    mesh: &TriMesh,
    fine: &Fine,
    suspects: &[bool],
    progress: &Progress,
) -> Result<(Refined, Vec<Kind>, usize), ArrangeError> {
    let places: Vec<[i32; 3]> = mesh.positions.iter().map(|&p| fine.place(p)).collect();
    let (facets, numbers) = Facets::new(&places, &mesh.triangles);
    let mut kinds = vec![Kind::Moved; facets.vertices.len()];
    for (v, &n) in numbers.iter().enumerate().rev() {
        kinds[n as usize] = Kind::Own(v as u32);
    }
    let may_touch = |f: u32| suspects.is_empty() || facets.covers(f).iter().any(|c| suspects[c.triangle as usize]);
    let pairs = touching(&facets, may_touch, progress)?;
    if pairs.len() > MOST_PAIRS {
        return Err(ArrangeError::Crowded { pairs: pairs.len(), most: MOST_PAIRS });
    }
    Ok((refine(facets, &pairs, progress)?, kinds, pairs.len()))
}

/// Why there is no exact result: what is open.
fn opened(refined: &Refined, open: &[Gap], fine: &Fine, operands: usize) -> ArrangeError {
    let mut closed = vec![true; operands];
    open.iter().for_each(|gap| closed[gap.operand as usize] = false);
    let ends = |gap: &Gap| gap.ends.map(|p| (refined.points.approximate(p) * fine.step).to_array());
    let first = open.first().map(|gap| Opening { operand: gap.operand as usize, ends: ends(gap) });
    let first = first.unwrap_or(Opening { operand: 0, ends: [[0.0; 3]; 2] });
    let is_made = |p: &u32| refined.points.vertex(*p).is_none();
    let rims_cut = open.iter().filter(|gap| gap.ends.iter().any(is_made)).count();
    ArrangeError::Open { edges: open.len(), first, closed, cut: refined.cut(), rims_cut }
}

/// For each cell whether it is inside of the result.
fn inside(winding: &[i32], operands: &Operands, expression: &Expression) -> Vec<bool> {
    let mut of_operands = vec![false; operands.count()];
    let cell = |winding: &[i32]| {
        of_operands.iter_mut().zip(winding).for_each(|(inside, &w)| *inside = operands.inside.holds(w));
        expression.evaluate(&of_operands)
    };
    winding.chunks(operands.count()).map(cell).collect()
}

/// A surface cut where its triangles cross each other, whether or not it closes.
#[derive(Debug, Clone, Default)]
pub struct Cut {
    /// The pieces. Where several triangles lie over one another, there is a piece for each.
    pub mesh: TriMesh,
    /// For each piece the triangle of the input that it is one of.
    pub sources: Vec<u32>,
    /// How many triangles were cut.
    pub cut: usize,
}

/// Cuts the triangles of a mesh where they cross each other. The pieces meet only at common edges and vertices, but for what rounding does to
/// the points that are made.
///
/// # Errors
/// [`ArrangeError::Crowded`] where there are too many, and a stop.
pub fn cut(mesh: &TriMesh, single: bool, progress: &Progress) -> Result<Cut, ArrangeError> {
    let fine = Fine::around(mesh, single);
    let (refined, kinds, _) = refined(mesh, &fine, &[], progress)?;
    let position = |p: usize| match kinds.get(p) {
        Some(&Kind::Own(v)) => mesh.positions[v as usize],
        _ => fine.point(fine.settled(refined.points.approximate(p as u32))),
    };
    let mut pieces = Cut { cut: refined.cut(), ..Cut::default() };
    pieces.mesh.positions = (0..refined.points.len()).map(position).collect();
    for piece in &refined.pieces {
        for cover in refined.covers(piece) {
            let [a, b, c] = piece.corners;
            pieces.mesh.triangles.push(if cover.reversed { [a, c, b] } else { [a, b, c] });
            pieces.sources.push(cover.triangle);
        }
    }
    Ok(pieces)
}

/// The segments along which triangles of a mesh cross each other, model units: where a boolean would cut.
///
/// # Errors
/// [`ArrangeError::Crowded`] where there are too many, and a stop.
pub fn crossing_curves(mesh: &TriMesh, progress: &Progress) -> Result<Vec<[DVec3; 2]>, ArrangeError> {
    let fine = Fine::around(mesh, false);
    let (refined, _, _) = refined(mesh, &fine, &[], progress)?;
    let point = |p: u32| refined.points.approximate(p) * fine.step;
    Ok(refined.curves.iter().map(|curve| curve.map(point)).collect())
}
