//! An order of operands that does not depend on how they were given: where two surfaces lie on each other, the one that
//! comes first leaves its triangles, and `a | b` shall be what `b | a` is.

use std::cmp::Ordering;

use glam::DVec3;

use super::{BooleanError, Operand, Outcome, TriangleSource};
use crate::arrange::ArrangeError;
use crate::ldi::Expression;
use crate::mesh::TriMesh;
use crate::orient::OrientReport;

/// Operands in an order of their own, and the way back.
pub(super) struct Ordered<'a> {
    pub operands: Vec<Operand<'a>>,
    pub expression: Expression,
    /// For each place the number of the operand as given.
    given: Vec<usize>,
}

impl<'a> Ordered<'a> {
    pub(super) fn new(operands: Vec<Operand<'a>>, expression: &Expression) -> Self {
        let mut given: Vec<usize> = (0..operands.len()).collect();
        given.sort_by(|&a, &b| compare(operands[a].mesh, operands[b].mesh));
        let mut place_of = vec![0; given.len()];
        given.iter().enumerate().for_each(|(place, &given)| place_of[given] = place);
        let expression = renumbered(expression, &place_of);
        Self { operands: given.iter().map(|&given| operands[given]).collect(), expression, given }
    }

    /// An outcome in terms of the order given.
    pub(super) fn back(&self, mut outcome: Outcome) -> Outcome {
        for source in &mut outcome.sources {
            if let TriangleSource::Operand { operand, .. } | TriangleSource::Lid { operand, .. } = source {
                *operand = self.given.get(*operand as usize).map_or(*operand, |&given| given as u32);
            }
        }
        for hole in &mut outcome.report.holes {
            hole.operand = self.given.get(hole.operand).copied().unwrap_or(hole.operand);
        }
        outcome.report.holes.sort_by_key(|hole| (hole.operand, hole.number));
        let reports = &mut outcome.report.orient;
        if reports.len() == self.given.len() {
            let mut of_places = std::mem::take(reports);
            *reports = vec![OrientReport::default(); of_places.len()];
            self.given.iter().zip(&mut of_places).for_each(|(&given, report)| reports[given] = std::mem::take(report));
        }
        outcome
    }

    /// An error in terms of the order given.
    pub(super) fn error(&self, error: BooleanError) -> BooleanError {
        match error {
            BooleanError::Empty { operand } => {
                BooleanError::Empty { operand: self.given.get(operand).copied().unwrap_or(operand) }
            }
            BooleanError::NotFinite { operand, triangle } => {
                BooleanError::NotFinite { operand: self.given.get(operand).copied().unwrap_or(operand), triangle }
            }
            BooleanError::Index { operand, error } => {
                BooleanError::Index { operand: self.given.get(operand).copied().unwrap_or(operand), error }
            }
            BooleanError::NotExact(error) => BooleanError::NotExact(self.not_exact(error)),
            other => other,
        }
    }

    fn not_exact(&self, error: ArrangeError) -> ArrangeError {
        let ArrangeError::Open { edges, mut first, closed: of_places, cut, rims_cut } = error else { return error };
        let mut closed = of_places.clone();
        for (&given, &is_closed) in self.given.iter().zip(&of_places) {
            closed[given] = is_closed;
        }
        first.operand = self.given.get(first.operand).copied().unwrap_or(first.operand);
        ArrangeError::Open { edges, first, closed, cut, rims_cut }
    }
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
