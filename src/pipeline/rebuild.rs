//! What rays and voxels make of the shells that do not stand by themselves.

use super::account::{refuse_scattered, why_nothing};
use super::apart::{Standing, touch};
use super::crumbs::without_crumbs;
use super::part::Part;
use super::stages::Stages;
use super::{
    BooleanError, Draft, NothingEnclosed, Options, Report, TriangleSource, VoxelSize, Warning, plan, refine, sizing,
};
use crate::backend::BackendReport;
use crate::contour::{ContourOptions, contour};
use crate::fit::{Facets, Kept, Surface, fit};
use crate::lattice::{Domain, Lattice};
use crate::ldi::Expression;
use crate::mesh::TriMesh;
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

/// What the rays of a lattice say of a soup.
pub(super) struct Surveyed {
    survey: Survey,
    /// The triangles that may stay as they are.
    kept: Kept,
    made_by: BackendReport,
}

/// A surface that was fitted, and what there is to say of it.
struct Fitted {
    surface: Surface,
    sources: Vec<TriangleSource>,
    report: Report,
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
        let mut cast = self.surveyed(soup, &lattice, stages)?;
        let finest = sizing::finest(&bounds);
        let check = |cast: &Surveyed, share| {
            plan::check_share(&[&cast.survey.soup.mesh], &lattice, &self.options.surface(), share)
        };
        if let Some((part, share)) = self.part(&cast) {
            check(&cast, share)?;
            if let Some(made) = self.within(&part, &mut cast, finest, stages)? {
                return Ok(made);
            }
            cast.survey.domain = Domain::of(&lattice);
        }
        check(&cast, 1.0)?;
        let fitted = self.fitted(&cast, finest, None, stages)?;
        self.finished(&cast.survey, fitted)
    }

    /// Where surface is made anew, if most stays as it is, and which share of it that is.
    fn part(&self, surveyed: &Surveyed) -> Option<(Part, f64)> {
        self.options.keeps().then(|| Part::around_seams(&surveyed.survey, &surveyed.kept)).flatten()
    }

    /// What voxels make of a part of space alone; `None` where not all of the surface beyond it stays as it is.
    pub(super) fn within(
        &self,
        part: &Part,
        surveyed: &mut Surveyed,
        finest: f64,
        stages: &mut Stages<'_>,
    ) -> Result<Option<Draft>, BooleanError> {
        if let Part::Bricks(_, domain) = part {
            surveyed.survey.domain = domain.clone();
        }
        let fitted = match self.fitted(surveyed, finest, Some(part), stages) {
            Ok(fitted) => fitted,
            Err(BooleanError::Stopped(stopped)) => return Err(stopped.into()),
            // Whatever there is to say of it is said of the whole.
            Err(_) => return Ok(None),
        };
        let stays = part.stays_beyond(&fitted.surface, &surveyed.survey.soup.mesh);
        stays.then(|| self.finished(&surveyed.survey, fitted)).transpose()
    }

    /// What the rays of a lattice say of a soup, and which of its triangles may stay by their word.
    pub(super) fn surveyed(
        &self,
        soup: Soup,
        lattice: &Lattice,
        stages: &mut Stages<'_>,
    ) -> Result<Surveyed, BooleanError> {
        let Self { expression, options, progress, .. } = *self;
        let share = if options.keeps() { 0.0 } else { 1.0 };
        plan::check_share(&[&soup.mesh], lattice, &options.surface(), share)?;
        stages.begin(Stage::Ldi)?;
        let rays = self.rays(&soup.mesh, lattice);
        let cast = Cast::of(soup, lattice, &rays, progress)?;
        let made_by = cast.made_by.clone();
        stages.begin(Stage::Spans)?;
        let survey = Survey::of(cast, expression, progress)?;
        refuse_scattered(&survey)?;
        let kept = match options.keeps() {
            true => Kept::of(&survey.soup.mesh, &survey.evidence, lattice.h, progress)?,
            false => Kept::default(),
        };
        Ok(Surveyed { survey, kept, made_by })
    }

    /// From votes to fit: the drawing in the crate's documentation, from where the rays were cast. With a part of space, the surface is right in there only.
    fn fitted(
        &self,
        surveyed: &Surveyed,
        finest: f64,
        part: Option<&Part>,
        stages: &mut Stages<'_>,
    ) -> Result<Fitted, BooleanError> {
        let Self { options, progress, .. } = *self;
        let Surveyed { survey, kept, made_by } = surveyed;
        let lattice = &survey.lattice;
        stages.begin(Stage::Vote)?;
        let winding = survey.winding(progress);
        let votes = survey.votes(options.vote, &winding, progress)?;
        stages.begin(Stage::Sdf)?;
        let planes = survey.planes();
        let distance = sdf::robust(&survey.spans, &planes, (&votes, lattice), &options.robust(), progress)?;
        stages.begin(Stage::Contour)?;
        let crossing = refine::crossings(survey, &winding, &distance);
        let mut raw = contour(&distance, &crossing, &ContourOptions::default(), progress)?;
        if raw.mesh.triangles.is_empty() {
            return Err(why_nothing(survey, finest).into());
        }
        let lids = refine::lids(&mut raw, survey, &winding, progress)?;
        stages.begin(Stage::Collapse)?;
        let is_beyond = |p| part.is_some_and(|part| part.is_beyond(p));
        let facets = Facets::new(&survey.soup.mesh, lids)
            .with_classes(survey.soup.classes(self.classes))
            .with_beyond(part.is_some().then_some(&is_beyond));
        let mut surface = refine::merged(raw, &facets, lattice, &options.surface(), progress)?;
        let mut report = Report::surveyed(survey, &votes, made_by.clone(), finest);
        if let Some(options) = &options.fit {
            stages.begin(Stage::Fit)?;
            let (fitted, account) = fit(&surface, &facets, kept, lattice.h, options, progress)?;
            (surface, report.fit) = (fitted, Some(account));
        }
        let sources = refine::sources(&surface, &facets, &survey.soup);
        report.of_surface(survey, &planes, &surface, &sources);
        Ok(Fitted { surface, sources, report })
    }

    /// With the numbers of the source where they may be had, and without crumbs.
    fn finished(&self, survey: &Survey, fitted: Fitted) -> Result<Draft, BooleanError> {
        let Fitted { surface, sources, report } = fitted;
        let mesh = refine::with_own_numbers(surface, &survey.soup.mesh, self.options.precision, self.progress)?;
        let mut made = Draft { mesh, sources, lattice: survey.lattice, report };
        without_crumbs(&mut made, &survey.soup, survey.lattice.h);
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::pipeline::VoxelSize;

    /// A ball of radius 1 with triangles that face outwards, but for those that `is_left_out` says by their middles.
    fn ball(is_left_out: impl Fn(DVec3) -> bool) -> TriMesh {
        let (rows, columns) = (80u32, 160u32);
        let at = |row: u32, column: u32| {
            let turn = std::f64::consts::PI;
            let (s, c) = (turn * f64::from(row) / f64::from(rows)).sin_cos();
            let (y, x) = (2.0 * turn * f64::from(column) / f64::from(columns)).sin_cos();
            DVec3::new(s * x, s * y, c)
        };
        let mut mesh = TriMesh { positions: vec![DVec3::Z, -DVec3::Z], triangles: Vec::new() };
        (1..rows).for_each(|row| mesh.positions.extend((0..columns).map(|column| at(row, column))));
        let number = |row: u32, column: u32| match row {
            0 => 0,
            row if row == rows => 1,
            row => 2 + (row - 1) * columns + column % columns,
        };
        for row in 0..rows {
            for column in 0..columns {
                let [a, b, c, d] = [(row, column), (row + 1, column), (row + 1, column + 1), (row, column + 1)]
                    .map(|(r, c)| number(r, c));
                mesh.triangles.extend(
                    [[a, b, c], [a, c, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]),
                );
            }
        }
        let middle = |t: &[u32; 3]| t.iter().map(|&v| mesh.positions[v as usize]).sum::<DVec3>() / 3.0;
        mesh.triangles = mesh.triangles.iter().copied().filter(|t| !is_left_out(middle(t))).collect();
        mesh
    }

    const H: f64 = 1.0 / 160.0;

    /// Calls `check` with a job and what the rays say of a mesh.
    fn with_job(mesh: &TriMesh, check: impl FnOnce(&Job<'_>, Surveyed, &mut Stages<'_>)) {
        let options = Options::new(VoxelSize::Length(H));
        let (progress, expression) = (Progress::none(), Expression::Operand(0));
        let job = Job { expression: &expression, options: &options, classes: &[], h: H, progress: &progress };
        let soup = Soup::of(&[mesh], options.orient, &progress).expect("triangles");
        let lattice = sizing::lattice(&mesh.bounds().expect("vertices"), options.voxel).expect("a size");
        let stages = &mut Stages::new(&progress);
        let surveyed = job.surveyed(soup, &lattice, stages).expect("little memory");
        check(&job, surveyed, stages);
    }

    const HOLES: [DVec3; 2] = [DVec3::new(0.95, 0.0, 0.31), DVec3::new(-0.55, 0.81, -0.2)];

    fn is_at(hole: DVec3, p: DVec3) -> bool {
        hole.normalize().distance(p) < 0.08
    }

    #[test]
    fn what_is_made_around_the_seams_alone_is_what_is_made_of_everything() {
        let mut mesh = ball(|p| HOLES.iter().any(|&hole| is_at(hole, p)));
        // A plate through the wall.
        let first = mesh.positions.len() as u32;
        let plate = [DVec3::new(0.02, -0.95, 0.01), DVec3::new(0.0, -1.05, 0.03), DVec3::new(0.08, -1.02, 0.05)];
        mesh.positions.extend(plate);
        mesh.triangles.push([first, first + 1, first + 2]);
        with_job(&mesh, |job, mut surveyed, stages| {
            let (part, share) = job.part(&surveyed).expect("most stays");
            assert!(share < 0.5, "{share}");
            let made = job.within(&part, &mut surveyed, 0.0, stages).expect("not stopped").expect("all beyond stays");
            surveyed.survey.domain = Domain::of(&surveyed.survey.lattice);
            let whole = job.fitted(&surveyed, 0.0, None, stages).expect("a solid");
            let whole = job.finished(&surveyed.survey, whole).expect("a solid");
            assert_eq!(made.mesh, whole.mesh);
            assert_eq!(made.sources, whole.sources);
            assert!(made.report.vote.voxels < whole.report.vote.voxels / 2);
            assert!(made.report.closed_triangles > 0 && made.report.fit.is_some_and(|fit| fit.kept > 20_000));
        });
    }

    #[test]
    fn a_part_that_does_not_hold_all_seams_makes_nothing() {
        let one = ball(|p| is_at(HOLES[0], p));
        let both = ball(|p| HOLES.iter().any(|&hole| is_at(hole, p)));
        with_job(&one, |job, surveyed, _| {
            let (part, _) = job.part(&surveyed).expect("most stays");
            with_job(&both, |job, mut surveyed, stages| {
                assert!(job.within(&part, &mut surveyed, 0.0, stages).expect("not stopped").is_none());
            });
        });
    }

    #[test]
    fn where_much_is_to_be_made_all_of_it_is_made_together() {
        with_job(&ball(|p| p.z.abs() < 0.05), |job, surveyed, _| assert!(job.part(&surveyed).is_none()));
    }
}
