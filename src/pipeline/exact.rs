//! The exact way: shells that touch, cut where they cross and decided by winding numbers, without rays and voxels.

use super::apart::{Apart, Standing, touch};
use super::rebuild::{Job, joined};
use super::stages::Stages;
use super::{BooleanError, Draft, Method, NothingEnclosed, Precision, TriangleSource};
use crate::arrange::{ArrangeError, ArrangeOptions, Arranged, arrange};
use crate::ldi::Operands;
use crate::mesh::edges::Edges;
use crate::mesh::{TriMesh, intersections_with};
use crate::progress::{Progress, Stage, Stopped};
use crate::survey::Soup;

/// What came of the exact way.
pub(super) enum Exact {
    /// The result.
    Done(Box<Draft>),
    /// There is none, because operands have holes.
    Open {
        /// For each operand whether it is closed.
        closed: Vec<bool>,
        /// Whether triangles may cross each other besides, away from rims.
        crosses: bool,
    },
    /// It is not to be gone, or leads nowhere.
    None,
}

/// Triangles of several operands, one operand after another, with where they come from.
#[derive(Debug, Clone, Default)]
pub(super) struct Pile {
    pub mesh: TriMesh,
    pub counts: Vec<usize>,
    pub sources: Vec<TriangleSource>,
    /// For each triangle whether it may touch another one; empty where that is not known.
    pub suspects: Vec<bool>,
}

impl Pile {
    /// Adds triangles of a mesh as the next operand, each with where it comes from.
    pub(super) fn add(&mut self, mesh: &TriMesh, of: impl Iterator<Item = (u32, TriangleSource)>) {
        let first = self.mesh.positions.len() as u32;
        self.mesh.positions.extend_from_slice(&mesh.positions);
        let before = self.mesh.triangles.len();
        for (t, source) in of {
            self.mesh.triangles.push(mesh.triangles[t as usize].map(|v| v + first));
            self.sources.push(source);
        }
        self.counts.push(self.mesh.triangles.len() - before);
    }

    /// The triangles of operands as they were given, without those of shells that are decided already.
    fn given(operands: &[&TriMesh], apart: &Apart) -> Self {
        let mut pile = Self::default();
        for (operand, mesh) in (0u32..).zip(operands) {
            let open = (0..mesh.triangles.len() as u32).filter(|&t| apart.is_open(operand, t));
            pile.add(mesh, open.clone().map(|triangle| (triangle, TriangleSource::Operand { operand, triangle })));
            pile.suspects.extend(open.map(|t| apart.may_touch(operand, t)));
        }
        pile
    }

    /// The triangles of a soup: cleaned, and turned so that neighbours agree.
    fn oriented(soup: &Soup) -> Self {
        let mut pile = Self::default();
        for n in 0..soup.operands.count() {
            let source = |t: usize| TriangleSource::Operand { operand: n as u32, triangle: soup.source[t] };
            pile.add(&soup.mesh, soup.operands.range(n).map(|t| (t as u32, source(t))));
        }
        pile
    }
}

/// What there is to say of a soup with a rim at which a triangle touches nothing: cuts do not close that. It is not looked for crossings elsewhere.
/// `None` where there is no such rim.
fn surely_open(rest: &Soup, apart: &Apart, progress: &Progress) -> Result<Option<Exact>, Stopped> {
    let mesh = &rest.mesh;
    let mut at_rim = vec![false; mesh.triangles.len()];
    Edges::new(&mesh.triangles, mesh.positions.len()).each(|edge| {
        if edge.count() == 1 {
            edge.halves().for_each(|half| at_rim[half as usize / 3] = true);
        }
    });
    if !at_rim.contains(&true) {
        return Ok(None);
    }
    let mut free = at_rim.clone();
    let touching = intersections_with(mesh, &at_rim, progress)?;
    touching.iter().flatten().for_each(|&t| free[t as usize] = false);
    let closed = (0..rest.operands.count()).map(|operand| apart.balances(operand));
    let open = Exact::Open { closed: closed.collect(), crosses: free == at_rim };
    Ok(free.contains(&true).then_some(open))
}

impl Job<'_> {
    /// The exact result made of what stands and of the shells that touch.
    pub(super) fn exact(
        &self,
        operands: &[&TriMesh],
        (rest, apart): (&Soup, &Apart),
        standing: &Standing,
        stages: &mut Stages<'_>,
    ) -> Result<Exact, BooleanError> {
        let method = self.options.method;
        if method == Method::Voxel || !self.options.keeps() {
            return Ok(Exact::None);
        }
        stages.begin(Stage::Arrange)?;
        // Neighbours that face opposite ways, or copies, may be all that is wrong.
        let changed = rest.reports.iter().any(|r| r.flipped_in_patches + r.duplicates_dropped + r.both_sided > 0);
        if !changed
            && method == Method::Auto
            && let Some(open) = surely_open(rest, apart, self.progress)?
        {
            return Ok(open);
        }
        let mut tried = self.arranged(&Pile::given(operands, apart));
        if changed && matches!(tried, Err(ArrangeError::Open { .. })) {
            tried = self.arranged(&Pile::oriented(rest));
        }
        match tried {
            Ok(draft) => self.beside_standing(self.simplified(draft.cleaned(rest))?, standing),
            Err(ArrangeError::Stopped(stopped)) => Err(stopped.into()),
            Err(refused) if method == Method::Exact => Err(BooleanError::NotExact(refused)),
            Err(ArrangeError::Open { closed, cut, rims_cut, .. }) => {
                // Rims that run into other surfaces are cracks that overlap: cut, they would leave flaps.
                Ok(Exact::Open { closed, crosses: cut > 0 && rims_cut == 0 })
            }
            Err(_) => Ok(Exact::None),
        }
    }

    /// The exact result of closed operands.
    pub(super) fn arranged(&self, pile: &Pile) -> Result<Draft, ArrangeError> {
        let Self { expression, options, progress, .. } = *self;
        let classes = self.classes_of(&pile.sources);
        let asked = ArrangeOptions {
            expression,
            orient: options.orient,
            single: options.precision == Precision::Single,
            suspects: &pile.suspects,
            classes: &classes,
        };
        let operands = Operands::new(pile.counts.iter().copied()).with_inside(options.inside);
        let Arranged { mesh, sources, report } = arrange(&pile.mesh, &operands, &asked, progress)?;
        let sources = sources.into_iter().map(|t| pile.sources[t as usize]).collect();
        let mut draft = Draft { mesh, sources, ..Draft::without_voxels(self.h) };
        draft.report.exact = Some(report);
        Ok(draft)
    }

    /// The numbers of the operands' triangles that others lie on; nothing where there are none.
    fn classes_of(&self, sources: &[TriangleSource]) -> Vec<u32> {
        let class = |source: &TriangleSource| match *source {
            TriangleSource::Operand { operand, triangle } => {
                self.classes.get(operand as usize).and_then(|list| list.get(triangle as usize)).copied().unwrap_or(0)
            }
            TriangleSource::Lid { .. } | TriangleSource::Closed => 0,
        };
        let any = self.classes.iter().any(|list| !list.is_empty());
        if any { sources.iter().map(class).collect() } else { Vec::new() }
    }

    /// The same with flat parts simplified, where that is asked for of what is right already.
    pub(super) fn simplified(&self, draft: Draft) -> Result<Draft, BooleanError> {
        let Some(fit) = self.options.fit.filter(|fit| fit.simplify_kept > 0.0) else { return Ok(draft) };
        let classes = self.classes_of(&draft.sources);
        let Draft { mesh, sources, lattice, report } = draft;
        let Standing { mesh, sources } = Standing { mesh, sources }.simplified(classes, &fit, self.h, self.progress)?;
        Ok(Draft { mesh, sources, lattice, report })
    }

    /// What stands with what was cut beside it, unless rounding made the two touch.
    pub(super) fn beside_standing(&self, draft: Draft, standing: &Standing) -> Result<Exact, BooleanError> {
        if draft.mesh.triangles.is_empty() && standing.mesh.triangles.is_empty() {
            let alone = self.expression.operand_count() == 1;
            let why = if alone { NothingEnclosed::Nothing } else { NothingEnclosed::NoCommonPart };
            return Err(why.into());
        }
        if touch(&draft.mesh, &standing.mesh, self.progress)? {
            return match self.options.method {
                Method::Exact => Err(BooleanError::NotExact(ArrangeError::Rounding)),
                _ => Ok(Exact::None),
            };
        }
        Ok(Exact::Done(Box::new(joined(standing.clone(), draft))))
    }
}
