//! An order of operands that does not depend on how they were given: where two surfaces lie on each other, the one that
//! comes first leaves its triangles, and `a | b` shall be what `b | a` is.

use std::cmp::Ordering;

use glam::DVec3;

use super::{Error, Options, Outcome, TriangleSource};
use crate::ldi::Expression;
use crate::mesh::TriMesh;

/// Calls `evaluate` with the operands in an order of their own, and gives back its result in terms of the order given.
pub(super) fn in_order(
    operands: &[TriMesh],
    expression: &Expression,
    options: &Options,
    evaluate: impl FnOnce(&[TriMesh], &Expression, &Options) -> Result<Outcome, Error>,
) -> Result<Outcome, Error> {
    let mut order: Vec<usize> = (0..operands.len()).collect();
    order.sort_by(|&a, &b| compare(&operands[a], &operands[b]));
    if order.is_sorted() {
        return evaluate(operands, expression, options);
    }
    let mut place_of = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &given)| place_of[given] = place);
    let sorted: Vec<TriMesh> = order.iter().map(|&given| operands[given].clone()).collect();
    let classes = match options.classes.is_empty() {
        true => Vec::new(),
        false => order.iter().map(|&given| options.classes.get(given).cloned().unwrap_or_default()).collect(),
    };
    let options = Options { classes, ..options.clone() };
    let mut outcome = evaluate(&sorted, &renumbered(expression, &place_of), &options).map_err(|error| match error {
        Error::Empty { operand } => Error::Empty { operand: order.get(operand).copied().unwrap_or(operand) },
        other => other,
    })?;
    for source in &mut outcome.sources {
        if let TriangleSource::Operand { operand, .. } = source {
            *operand = order.get(*operand as usize).map_or(*operand, |&given| given as u32);
        }
    }
    if outcome.report.orient.len() == place_of.len() {
        outcome.report.orient = place_of.iter().map(|&place| outcome.report.orient[place].clone()).collect();
    }
    Ok(outcome)
}

/// By the place of the box, then by the triangles.
fn compare(a: &TriMesh, b: &TriMesh) -> Ordering {
    let ends = |mesh: &TriMesh| mesh.bounds().map(|bounds| [bounds.min, bounds.max]);
    let boxes = match (ends(a), ends(b)) {
        (Some(a), Some(b)) => a.iter().zip(&b).map(|(a, b)| by_place(*a, *b)).find(|order| order.is_ne()),
        (a, b) => Some(a.is_some().cmp(&b.is_some())),
    };
    let corners = |mesh: &TriMesh, t: usize| mesh.corners(t);
    boxes.unwrap_or(Ordering::Equal).then_with(|| a.triangles.len().cmp(&b.triangles.len())).then_with(|| {
        let pairs = (0..a.triangles.len()).flat_map(|t| std::iter::zip(corners(a, t), corners(b, t)));
        pairs.map(|(a, b)| by_place(a, b)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    })
}

fn by_place(a: DVec3, b: DVec3) -> Ordering {
    a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z))
}

/// The expression over operands that have other places.
fn renumbered(expression: &Expression, place_of: &[usize]) -> Expression {
    let one = |part: &Expression| Box::new(renumbered(part, place_of));
    let all = |parts: &[Expression]| parts.iter().map(|part| renumbered(part, place_of)).collect();
    match expression {
        Expression::Operand(n) => Expression::Operand(place_of.get(*n).copied().unwrap_or(*n)),
        Expression::Union(parts) => Expression::Union(all(parts)),
        Expression::Intersection(parts) => Expression::Intersection(all(parts)),
        Expression::Difference(a, b) => Expression::Difference(one(a), one(b)),
        Expression::SymmetricDifference(a, b) => Expression::SymmetricDifference(one(a), one(b)),
    }
}
