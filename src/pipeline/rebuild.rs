//! What rays and voxels make of the shells that do not stand by themselves.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::apart::{Standing, touch};
use super::crumbs::without_crumbs;
use super::prepare::Soup;
use super::stages::Stages;
use super::{Error, Options, Outcome, Report, TriangleSource, backend, plan, prepare, refine, solid};
use crate::contour::{ContourOptions, contour};
use crate::fit::{Facets, fit};
use crate::lattice::Lattice;
use crate::ldi::{Evidence, Expression, Spans, spans};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stage, Stopped};
use crate::sdf;
use crate::vote::{Jury, Winding, vote_near_surface};

/// What is asked for.
pub(super) struct Job<'a> {
    pub expression: &'a Expression,
    pub options: &'a Options,
    /// The voxel size of the options, model units.
    pub h: f64,
    pub progress: &'a Progress,
}

/// Where what is made runs into what stands, the gap between them is too thin for the voxels: they are halved this often.
const MOST_HALVINGS: u32 = 3;
/// But only while there are no more than so many of them on the surface, a gigabyte's worth.
const MOST_CELLS: f64 = 1e6;

impl Job<'_> {
    /// The result made of what stands and of what voxels make of the rest; `None` where the two touch, however small the voxels.
    pub(super) fn beside(
        &self,
        rest: Soup,
        standing: Standing,
        stages: &mut Stages<'_>,
    ) -> Result<Option<Outcome>, Error> {
        let cells = plan::area(&rest.mesh) / (self.h * self.h);
        let finest = rest.mesh.bounds().map_or(0.0, |bounds| prepare::finest(&bounds));
        for halvings in 0..=MOST_HALVINGS {
            let finer = f64::from(1 << halvings);
            if halvings > 0 && (cells * finer * finer > MOST_CELLS || self.h / finer < finest) {
                break;
            }
            let made = self.if_any(&rest, self.h / finer, stages)?;
            if made.mesh.triangles.is_empty() && standing.mesh.triangles.is_empty() {
                let reason = "the result is empty: the operands have no such part in common".into();
                return Err(Error::NothingEnclosed { reason });
            }
            if !touch(&made.mesh, &standing.mesh, self.progress)? {
                return Ok(Some(joined(standing, made)));
            }
        }
        Ok(None)
    }

    /// What voxels of size `h` make of a soup, be it nothing.
    fn if_any(&self, rest: &Soup, h: f64, stages: &mut Stages<'_>) -> Result<Outcome, Error> {
        let nothing = |warnings| {
            let lattice = Lattice { origin: DVec3::ZERO, h, dims: IVec3::ZERO };
            let report = Report { voxel: h, orient: rest.reports.clone(), warnings, ..Report::default() };
            Outcome { mesh: TriMesh::default(), sources: Vec::new(), lattice, report }
        };
        if rest.mesh.triangles.is_empty() {
            return Ok(nothing(Vec::new()));
        }
        match self.alone(rest.clone(), h, stages) {
            Err(Error::NothingEnclosed { reason }) => {
                Ok(nothing(vec![format!("beside what stays as it is, nothing more is enclosed: {reason}")]))
            }
            other => other,
        }
    }

    /// What voxels of size `h`, model units, make of a soup.
    pub(super) fn alone(&self, mut soup: Soup, h: f64, stages: &mut Stages<'_>) -> Result<Outcome, Error> {
        let Self { expression, options, progress, .. } = *self;
        let bounds = soup.mesh.bounds().ok_or(Error::Empty { operand: 0 })?;
        let lattice = prepare::lattice(&bounds, super::VoxelSize::Length(h))?;
        let operands = std::slice::from_ref(&soup.mesh);
        plan::check_limits(operands, &lattice, options, plan::Offsets::default())?;
        stages.begin(Stage::Ldi)?;
        let crossings = plan::crossings(operands, &lattice);
        let (mut layers, made_by) = backend::layers(&soup.mesh, &lattice, options.backend, crossings, progress)?;
        soup.turn_patches(&mut layers, options.orient, progress)?;
        let hits = solid::count(&layers);
        stages.begin(Stage::Spans)?;
        let mut evidence = Evidence::new(&layers, soup.mesh.triangles.len());
        let walk = |layers| progress.check().map(|()| spans(layers, &soup.operands, expression));
        let spans: Vec<Spans> = layers.into_par_iter().map(walk).collect::<Result<_, Stopped>>()?;
        evidence.add(&spans);
        solid::refuse_scattered(&spans, hits)?;
        stages.begin(Stage::Vote)?;
        let winding = Winding::new(&soup.mesh, &soup.operands, &lattice, progress);
        let jury = Jury { spans: &spans, operands: &soup.operands, expression, rule: options.rule, winding: &winding };
        let votes = vote_near_surface(&jury, progress)?;
        stages.begin(Stage::Sdf)?;
        let planes = soup.planes(&lattice);
        let distance = sdf::robust(&spans, &planes, &votes, &options.robust, progress)?;
        stages.begin(Stage::Contour)?;
        let lid = |inside, outside| refine::lid(&winding, expression, inside, outside);
        let crossing = solid::crossings(&spans, &distance, lid);
        let mut raw = contour(&lattice, &distance, &crossing, &ContourOptions::default(), progress)?;
        if raw.mesh.triangles.is_empty() {
            return Err(Error::NothingEnclosed {
                reason: solid::why_nothing(&spans, [h, prepare::finest(&bounds)], hits, soup.operands.count()),
            });
        }
        let lids = refine::lids(&mut raw, (&soup, &lattice), &winding, expression, progress)?;
        stages.begin(Stage::Collapse)?;
        let facets = Facets::new(&soup.mesh, lids).with_classes(soup.classes(&options.classes));
        let mut surface = refine::merged(raw, &facets, &lattice, options, progress)?;
        let mut report = solid::report(&lattice, prepare::finest(&bounds), &spans, hits, &votes);
        if let Some(options) = &options.fit {
            stages.begin(Stage::Fit)?;
            let (fit, account) = fit(&surface, &facets, &evidence, lattice.h, options, progress)?;
            surface = fit;
            report.fit = Some(account);
        }
        let sources = refine::sources(&surface, &facets, &soup);
        report.orient = std::mem::take(&mut soup.reports);
        report.lattice = true;
        report.thin.regions = solid::thin_regions(&spans, &planes, &surface, &lattice);
        report.closed_triangles = sources.iter().filter(|source| **source == TriangleSource::Closed).count();
        report.ldi.made_by = made_by;
        let mesh = refine::with_own_numbers(surface, &soup.mesh, options.precision, progress)?;
        let mut made = Outcome { mesh, sources, lattice, report };
        without_crumbs(&mut made, &soup, h);
        Ok(made)
    }
}

/// What stands, and after it what was made.
fn joined(standing: Standing, made: Outcome) -> Outcome {
    let Standing { mut mesh, mut sources } = standing;
    mesh.append(&made.mesh);
    sources.extend(made.sources);
    Outcome { mesh, sources, ..made }
}
