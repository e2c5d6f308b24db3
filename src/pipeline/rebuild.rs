//! What rays and voxels make of the shells that do not stand by themselves.

use super::account::{refuse_scattered, why_nothing};
use super::apart::{Standing, touch};
use super::crumbs::without_crumbs;
use super::stages::Stages;
use super::{BooleanError, Draft, NothingEnclosed, Options, Report, VoxelSize, Warning, plan, refine, sizing};
use crate::contour::{ContourOptions, contour};
use crate::fit::{Facets, fit};
use crate::lattice::Lattice;
use crate::ldi::Expression;
use crate::mesh::{Bounds, TriMesh};
use crate::progress::{Progress, Stage};
use crate::sdf;
use crate::survey::{Cast, CastOptions, Soup, Survey};

/// What is asked for.
pub(super) struct Job<'a> {
    pub expression: &'a Expression,
    pub options: &'a Options,
    /// For each operand a number for each of its triangles, or nothing: what has different numbers is kept apart.
    pub classes: &'a [Vec<u32>],
    /// The voxel size of the options, model units.
    pub h: f64,
    pub progress: &'a Progress,
}

/// Where voxels are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ground {
    pub lattice: Lattice,
    /// The finest voxel that a lattice around the whole soup can have, model units.
    pub finest: f64,
    /// Where surface is to be made, model units, if the lattice does not hold the whole soup: all of it beyond that must stay.
    pub window: Option<Bounds>,
}

/// Where what is made runs into what stands, the gap between them is too thin for the voxels: they are halved this often.
const MOST_HALVINGS: u32 = 3;
/// But only while there are no more than so many of them on the surface, a gigabyte's worth.
const MOST_CELLS: f64 = 1e6;

impl Job<'_> {
    /// The result made of what stands and of what voxels make of the rest; `None` where the two touch, however small the voxels.
    pub(super) fn beside(
        &self,
        rest: &Soup,
        standing: Standing,
        stages: &mut Stages<'_>,
    ) -> Result<Option<Draft>, BooleanError> {
        if standing.mesh.triangles.is_empty() {
            return self.alone(rest.clone(), self.h, stages).map(Some);
        }
        let cells = plan::area(&rest.mesh) / (self.h * self.h);
        let finest = rest.mesh.bounds().map_or(0.0, |bounds| sizing::finest(&bounds));
        for halvings in 0..=MOST_HALVINGS {
            let finer = f64::from(1 << halvings);
            if halvings > 0 && (cells * finer * finer > MOST_CELLS || self.h / finer < finest) {
                break;
            }
            let made = self.if_any(rest, self.h / finer, stages)?;
            if made.mesh.triangles.is_empty() && standing.mesh.triangles.is_empty() {
                return Err(NothingEnclosed::NoCommonPart.into());
            }
            if !touch(&made.mesh, &standing.mesh, self.progress)? {
                return Ok(Some(joined(standing, made)));
            }
        }
        Ok(None)
    }

    /// What voxels of size `h` make of a soup, be it nothing.
    fn if_any(&self, rest: &Soup, h: f64, stages: &mut Stages<'_>) -> Result<Draft, BooleanError> {
        match self.alone(rest.clone(), h, stages) {
            Err(BooleanError::Nothing(why)) => {
                let mut nothing = Draft::without_voxels(h).cleaned(rest);
                nothing.report.warnings.push(Warning::NothingMore(why));
                Ok(nothing)
            }
            other => other,
        }
    }

    /// What stands, where nothing else is to be done.
    pub(super) fn nothing_beside(&self, rest: &Soup, standing: Standing) -> Result<Draft, BooleanError> {
        match standing.mesh.triangles.is_empty() {
            true => Err(NothingEnclosed::NoCommonPart.into()),
            false => Ok(joined(standing, Draft::without_voxels(self.h).cleaned(rest))),
        }
    }

    /// What voxels of size `h`, model units, make of a soup.
    pub(super) fn alone(&self, soup: Soup, h: f64, stages: &mut Stages<'_>) -> Result<Draft, BooleanError> {
        let bounds = soup.mesh.bounds().ok_or(BooleanError::Empty { operand: 0 })?;
        let lattice = sizing::lattice(&bounds, VoxelSize::Length(h))?;
        self.on(&Ground { lattice, finest: sizing::finest(&bounds), window: None }, soup, stages)
    }

    /// What voxels make of a soup: the drawing in the crate's documentation, from rays to fit.
    pub(super) fn on(&self, ground: &Ground, soup: Soup, stages: &mut Stages<'_>) -> Result<Draft, BooleanError> {
        let Self { expression, options, progress, .. } = *self;
        let Ground { lattice, finest, window } = *ground;
        let h = lattice.h;
        plan::check_limits(&[&soup.mesh], &lattice, &options.surface(), plan::Offsets::default())?;
        stages.begin(Stage::Ldi)?;
        let rays = self.rays(&soup.mesh, &lattice);
        let cast = Cast::of(soup, &lattice, &rays, progress)?;
        let made_by = cast.made_by.clone();
        stages.begin(Stage::Spans)?;
        let survey = Survey::of(cast, expression, progress)?;
        refuse_scattered(&survey)?;
        stages.begin(Stage::Vote)?;
        let winding = survey.winding(progress);
        let votes = survey.votes(options.vote, &winding, progress)?;
        stages.begin(Stage::Sdf)?;
        let planes = survey.planes();
        let distance = sdf::robust(&survey.spans, &planes, (&votes, &lattice), &options.robust(), progress)?;
        stages.begin(Stage::Contour)?;
        let crossing = refine::crossings(&survey, &winding, &distance);
        let mut raw = contour(&distance, &crossing, &ContourOptions::default(), progress)?;
        if raw.mesh.triangles.is_empty() {
            return Err(why_nothing(&survey, finest).into());
        }
        let lids = refine::lids(&mut raw, &survey, &winding, progress)?;
        stages.begin(Stage::Collapse)?;
        let facets =
            Facets::new(&survey.soup.mesh, lids).with_classes(survey.soup.classes(self.classes)).with_window(window);
        let mut surface = refine::merged(raw, &facets, &lattice, &options.surface(), progress)?;
        let mut report = Report::surveyed(&survey, &votes, made_by, finest);
        if let Some(options) = &options.fit {
            stages.begin(Stage::Fit)?;
            let (fitted, account) = fit(&surface, &facets, &survey.evidence, h, options, progress)?;
            (surface, report.fit) = (fitted, Some(account));
        }
        let sources = refine::sources(&surface, &facets, &survey.soup);
        report.of_surface(&survey, &planes, &surface, &sources);
        let mesh = refine::with_own_numbers(surface, &survey.soup.mesh, options.precision, progress)?;
        let mut made = Draft { mesh, sources, lattice, report };
        without_crumbs(&mut made, &survey.soup, h);
        Ok(made)
    }

    fn rays(&self, mesh: &TriMesh, lattice: &Lattice) -> CastOptions {
        let crossings = plan::crossings(&[mesh], lattice);
        CastOptions { orient: self.options.orient, backend: self.options.backend, crossings }
    }
}

/// What stands, and after it what was made.
pub(super) fn joined(standing: Standing, made: Draft) -> Draft {
    let Standing { mut mesh, mut sources } = standing;
    mesh.append(&made.mesh);
    sources.extend(made.sources);
    Draft { mesh, sources, ..made }
}
