//! Pictures of surfaces, and their captions.

use std::borrow::Cow;
use std::path::Path;

use super::RenderArgs;
use super::choices::ViewChoice;
use crate::cli::choices::{BackgroundChoice, EdgeChoice, ProjectionChoice};
use crate::cli::exit::Failure;
use crate::cli::input::{self, Input};
use crate::cli::page::regions;
use crate::cli::session::Session;
use crate::cli::slice::failure;
use crate::cli::{streams, words, written};
use crate::io::{Colours, LegendEntry, shown_colours};
use crate::mesh::{Bounds, defects};
use crate::page::{Cluster, Lines, clusters};
use crate::picture::{
    Background, Caption, Clip, DefectCounts, EdgeDrawing, Image, Painted, Projection, RenderOptions, Subject, View,
    defect_legend, render_views, turntable,
};

/// Pictures of surfaces, and what is to be said of them.
pub(super) struct Surfaces {
    pub(super) images: Vec<Image>,
    pub(super) columns: usize,
    pub(super) legend: Vec<LegendEntry>,
    pub(super) notes: Vec<String>,
}

/// The smallest part of the mesh's diagonal that fills a picture.
const LEAST_FOCUS: f64 = 0.02;

/// One mesh, or two by one camera, from one side or several; or one while it turns.
pub(super) fn surfaces(meshes: &[&Input], args: &RenderArgs, session: &Session) -> Result<Surfaces, Failure> {
    let set = Set::new(meshes, args, session)?;
    let colours: Vec<_> = meshes.iter().map(|input| shown(input)).collect();
    let subjects = set.subjects(&colours, session)?;
    let views: Vec<View> = match args.views.is_empty() {
        true => vec![set.options.view],
        false => args.views.iter().map(|view| turned_up(view, args)).collect(),
    };
    let captions = set.captions(&subjects);
    let images = match (args.turntable, subjects.as_slice()) {
        (Some(frames), [subject]) => {
            turntable(subject, usize::from(frames), &set.options, captions.first(), &session.progress)
        }
        _ => render_views(&subjects, &views, &set.options, &captions, &session.progress),
    };
    let images = images.map_err(failure)?;
    let columns = match (meshes.len(), views.len()) {
        (1, views) => (views as f64).sqrt().ceil() as usize,
        (meshes, 1) => meshes,
        (_, views) => views,
    };
    Ok(Surfaces { legend: set.legend(&subjects), images, columns, notes: set.notes })
}

/// Meshes that are drawn by one camera.
struct Set<'a> {
    meshes: &'a [&'a Input],
    args: &'a RenderArgs,
    options: RenderOptions,
    regions: Vec<Lines>,
    notes: Vec<String>,
}

impl<'a> Set<'a> {
    fn new(meshes: &'a [&'a Input], args: &'a RenderArgs, session: &Session) -> Result<Self, Failure> {
        let mut notes = Vec::new();
        let mut options = options(args);
        let bounds = meshes.iter().filter_map(|input| input.loaded.mesh.bounds()).reduce(|a, b| a.union(&b));
        if let (Some(clip), Some(bounds)) = (&args.clip, &bounds) {
            let unit = meshes.iter().find_map(|input| input.loaded.unit);
            options.clip = Some(Clip { axis: clip.axis(), at: clip.resolve("--clip", bounds, unit)? });
        }
        if args.zoom.is_some() {
            options.focus = focus(meshes, session)?;
            if options.focus.is_none() {
                notes.push("there are no defects to zoom to, and all of the mesh is drawn".into());
            }
        }
        let regions = match &args.regions {
            Some(path) => regions_of(path, session)?,
            None => Vec::new(),
        };
        if args.regions.is_some() && regions.is_empty() {
            notes.push("the report tells of no thin or doubtful regions".into());
        }
        Ok(Self { meshes, args, options, regions, notes })
    }

    fn subjects(
        &self,
        colours: &'a [Option<Cow<'a, Colours>>],
        session: &Session,
    ) -> Result<Vec<Subject<'a>>, Failure> {
        let subject = |(input, colours): (&&'a Input, &'a Option<Cow<'a, Colours>>)| {
            let loaded = &input.loaded;
            let is_map = !loaded.legend.is_empty() || loaded.scale.is_some();
            let painted = Painted { mesh: &loaded.mesh, colours: colours.as_deref(), is_map };
            let lines = self.regions.iter().flat_map(|lines| lines.segments.iter().map(|&ends| (ends, lines.colour)));
            Ok(Subject::new(painted, self.options.defects, &session.progress)?.with_lines(lines))
        };
        self.meshes.iter().zip(colours).map(subject).collect()
    }

    /// A caption for each picture: the views of the first mesh, then those of the next.
    fn captions(&self, subjects: &[Subject<'_>]) -> Vec<Caption> {
        if self.args.plain {
            return Vec::new();
        }
        let views: Vec<Option<&ViewChoice>> = match self.args.views.is_empty() {
            true => vec![None],
            false => self.args.views.iter().map(Some).collect(),
        };
        let mut captions = Vec::new();
        for (n, (input, subject)) in self.meshes.iter().zip(subjects).enumerate() {
            for view in &views {
                let own = self.args.title.get(captions.len()).cloned();
                captions.push(Caption {
                    title: own.unwrap_or_else(|| self.title(n, *view)),
                    legend: self.legend_of(input, subject),
                    scale: input.loaded.scale.clone(),
                    unit: input.loaded.unit.map_or(String::new(), |unit| unit.to_string()),
                });
            }
        }
        captions
    }

    fn title(&self, n: usize, view: Option<&ViewChoice>) -> String {
        let name = words::file_name(&self.meshes[n].label);
        let when = match (self.meshes.len(), n) {
            (1, _) => "",
            (_, 0) => "Before: ",
            _ => "After: ",
        };
        format!("{when}{name}{}", view.map_or(String::new(), |view| format!(", {view}")))
    }

    fn legend_of(&self, input: &Input, subject: &Subject<'_>) -> Vec<LegendEntry> {
        let found = subject.defects();
        // On a mesh of its own colours, grey does not stand for what is right.
        let told = self.options.defects && (found != DefectCounts::default() || !subject.has_colours());
        let mut legend = if told { defect_legend(&found) } else { Vec::new() };
        if input.loaded.scale.is_none() {
            legend.extend(input.loaded.legend.iter().cloned());
        }
        legend.extend(self.region_legend());
        legend
    }

    fn region_legend(&self) -> impl Iterator<Item = LegendEntry> + '_ {
        // A box has twelve edges.
        let text =
            |lines: &Lines| format!("{}: {}", lines.name.to_lowercase(), words::count(lines.segments.len() / 12));
        self.regions.iter().map(move |lines| LegendEntry { colour: lines.colour, text: text(lines) })
    }

    /// What the colours of defects of all meshes mean, each once, without the numbers of those that several have.
    fn legend(&self, subjects: &[Subject<'_>]) -> Vec<LegendEntry> {
        let mut all: Vec<LegendEntry> = Vec::new();
        for entry in
            subjects.iter().filter(|_| self.options.defects).flat_map(|subject| defect_legend(&subject.defects()))
        {
            match all.iter_mut().find(|known| known.colour == entry.colour) {
                Some(known) if known.text != entry.text => known.text = format!("{}, then {}", known.text, entry.text),
                Some(_) => {}
                None => all.push(entry),
            }
        }
        all.extend(self.region_legend());
        all
    }
}

/// The largest group of defects of the first mesh that has any: of those that are not all over the mesh, if there are such.
fn focus(meshes: &[&Input], session: &Session) -> Result<Option<Bounds>, Failure> {
    for input in meshes {
        let mesh = &input.loaded.mesh;
        let options = input.loaded.validate_options();
        let found = defects(mesh, &options, &session.progress)?;
        let Some(diagonal) = mesh.bounds().map(|bounds| bounds.diagonal()) else { continue };
        let around = |group: &Cluster| {
            let corners = group.triangles.iter().flat_map(|&t| mesh.triangles[t as usize]);
            let bounds = Bounds::of(corners.map(|v| mesh.positions[v as usize]))?;
            let room = 0.1 * bounds.diagonal() + LEAST_FOCUS / 2.0 * diagonal;
            Some(Bounds { min: bounds.min - room, max: bounds.max + room })
        };
        let groups = clusters(mesh, &found, options.weld);
        let groups: Vec<(usize, Bounds)> =
            groups.iter().filter_map(|group| Some((group.count, around(group)?))).collect();
        let here = |&&(_, bounds): &&(usize, Bounds)| bounds.diagonal() < diagonal / 2.0;
        let largest = |list: &mut dyn Iterator<Item = &(usize, Bounds)>| {
            list.reduce(|a, b| if b.0 > a.0 { b } else { a }).copied()
        };
        let group = largest(&mut groups.iter().filter(here)).or_else(|| largest(&mut groups.iter()));
        if let Some((_, bounds)) = group {
            return Ok(Some(bounds));
        }
    }
    Ok(None)
}

/// The regions that a report tells of.
fn regions_of(path: &Path, session: &Session) -> Result<Vec<Lines>, Failure> {
    let label = streams::label(path);
    let bytes = input::bytes_of(path, &session.progress)?;
    let json: serde_json::Value = serde_json::from_slice(&bytes)
        .map_err(|error| Failure::input(format!("{label} is no report: it is no JSON ({error})")))?;
    let told = written::read(&json, &label)?;
    Ok(told.pipeline().map_or(Vec::new(), regions))
}

/// The colours that the mesh shows without its images.
fn shown(input: &Input) -> Option<Cow<'_, Colours>> {
    shown_colours(input.loaded.colours.as_ref(), input.loaded.texture.as_ref())
}

fn turned_up(view: &ViewChoice, args: &RenderArgs) -> View {
    if args.y_up { view.view().y_up() } else { view.view() }
}

fn options(args: &RenderArgs) -> RenderOptions {
    RenderOptions {
        width: args.width,
        height: args.height,
        view: turned_up(&args.view, args),
        projection: match args.projection {
            ProjectionChoice::Orthographic => Projection::Orthographic,
            ProjectionChoice::Perspective => Projection::Perspective,
        },
        opacity: args.opacity,
        edges: match args.edges {
            EdgeChoice::None => EdgeDrawing::None,
            EdgeChoice::Sharp => EdgeDrawing::Sharp,
            EdgeChoice::All => EdgeDrawing::All,
        },
        defects: !args.no_defects,
        background: match args.background {
            BackgroundChoice::Gradient => Background::Gradient,
            BackgroundChoice::White => Background::White,
            BackgroundChoice::Transparent => Background::Transparent,
        },
        ..RenderOptions::default()
    }
}
