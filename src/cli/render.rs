//! `render IN [AFTER] -o PNG`.

use clap::Args;
use std::borrow::Cow;
use std::path::Path;
use std::path::PathBuf;

use glam::DVec3;
use serde_json::json;

use super::choices::EdgeChoice;
use super::entries::{OutputEntry, SliceEntry};
use super::epilogue;
use super::exit::{Exit, Failure};
use super::given::{Given, Which};
use super::input::Input;
use super::length::parse_size;
use super::output::in_memory;
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::shared_args::{CommonArgs, InputArgs};
use super::side::write_side;
use super::slice::{self, Field, SliceChoice, failure};
use super::streams::{self, is_stream};
use crate::io::{Colours, LegendEntry, shown_colours};
use crate::picture::{EdgeDrawing, Image, Painted, RenderOptions, View, draw_legend, render, render_pair};
use crate::progress::Stage;

/// `render IN [AFTER] -o PNG`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The mesh to draw, or the grid (VTI, NRRD, NPY, VDB) of which to draw a slice
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// A second mesh or grid, drawn beside the first: meshes from the same point of view, slices of the same plane
    #[arg(value_name = "AFTER")]
    pub after: Option<PathBuf>,
    /// Where to write the PNG
    #[arg(short, long, value_name = "PNG")]
    pub output: PathBuf,
    /// Width of the picture (of each, for two), pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 1200, value_parser = clap::value_parser!(u32).range(16..=16384))]
    pub width: u32,
    /// Height, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 900, value_parser = clap::value_parser!(u32).range(16..=16384))]
    pub height: u32,
    /// From where: iso, front, back, left, right, top, bottom, or the direction to the viewer as X,Y,Z
    #[arg(long, value_name = "VIEW", default_value = "iso", value_parser = parse_view, allow_hyphen_values = true)]
    pub view: ViewChoice,
    /// The y axis points up, not z
    #[arg(long)]
    pub y_up: bool,
    /// Draw a slice: z (through the middle), x=50%, y=1.5 or z=2mm; of meshes, where no grid is given, through their
    /// signed distance [default: z, for grids]
    #[arg(long, value_name = "AXIS[=AT]", allow_hyphen_values = true)]
    pub slice: Option<SliceChoice>,
    /// Which edges of triangles are drawn
    #[arg(long, value_enum, default_value_t = EdgeChoice::Sharp)]
    pub edges: EdgeChoice,
    /// Do not colour defects
    #[arg(long)]
    pub no_defects: bool,
    /// Refuse grids that would take more memory (500M, 2G)
    #[arg(long, value_name = "SIZE", value_parser = parse_size)]
    pub max_memory: Option<u64>,
    /// Write over an input file
    #[arg(long)]
    pub force: bool,
    /// How the input is read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// Draws one mesh or slice, or two on one sheet.
pub fn run(args: &RenderArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    super::target::check_extension(&args.output, "png")?;
    let paths: Vec<&Path> = std::iter::once(&args.input).chain(&args.after).map(AsRef::as_ref).collect();
    let mut inputs = report.timed(Stage::Read, |report| {
        Given::read(&paths, &args.reading, args.max_memory, session, &mut report.warnings)
    })?;
    // What shares one camera, or one plane, must share one unit.
    inputs.common_unit(&args.reading, &mut report.warnings);
    inputs.describe(report);
    let inputs = Inputs(inputs);
    let options = options(args);
    let choice = args.slice.unwrap_or_default();
    let slices = inputs.slices(args);
    report.options = json!({
        "width": args.width, "height": args.height, "view": args.view.to_string(), "y_up": args.y_up,
        "edges": format!("{:?}", args.edges).to_lowercase(), "defects": options.defects,
        "slice": slices.then(|| choice.to_string()),
    });
    session.progress.stage(Stage::Draw)?;
    let (images, drawn) = report.timed(Stage::Draw, |_| inputs.draw(&options, slices.then_some(&choice), session))?;
    let image = match <[Image; 1]>::try_from(images) {
        Ok([image]) => image,
        Err(images) => Image::beside(&images),
    };
    if let Some(desk) = session.desk_for(&args.output) {
        desk.lay_picture(image);
        report.result = Some(RunResult::Picture { slices: drawn, output: in_memory(None) });
        return Ok(epilogue::measured(session, report, args.max_memory));
    }
    let png = image.to_png().map_err(|e| Failure::internal(format!("the picture cannot be encoded: {e}")))?;
    session.progress.check()?;
    write_side(&args.output, &png, session)?;
    let label = if is_stream(&args.output) { "standard output".into() } else { args.output.display().to_string() };
    session.clear_bar();
    session.say(&format!("{label}: {} x {} pixels", image.width, image.height));
    if options.defects && drawn.len() < inputs.0.order.len() {
        session.say(
            "open edges red, edges of more than two triangles magenta, intersecting triangles yellow and where they cross blue, inner sides rust red",
        );
    }
    for input in inputs.0.meshes.iter().filter(|input| !input.loaded.legend.is_empty()) {
        let entry = |LegendEntry { colour: [r, g, b], text }: &LegendEntry| format!("#{r:02X}{g:02X}{b:02X} {text}");
        let entries: Vec<String> = input.loaded.legend.iter().map(entry).collect();
        session.say(&format!("{}: {}", input.label, entries.join("; ")));
    }
    for slice in &drawn {
        session.say(&slice.words(inputs.0.unit_of(&slice.path).as_deref()));
    }
    let output = OutputEntry {
        path: label,
        format: "png".into(),
        bytes: png.len() as u64,
        sha256: streams::sha256(&png),
        unit: None,
        validity: None,
    };
    report.result = Some(RunResult::Picture { slices: drawn, output });
    Ok(epilogue::measured(session, report, args.max_memory))
}

/// What is drawn.
struct Inputs(Given);

impl Inputs {
    /// Whether slices are drawn: of the grids, or else of the meshes where that was asked for.
    fn slices(&self, args: &RenderArgs) -> bool {
        !self.0.grids.is_empty() || args.slice.is_some()
    }

    /// The images in the order of the inputs, and what is to be said of slices.
    fn draw(
        &self,
        options: &RenderOptions,
        choice: Option<&SliceChoice>,
        session: &Session,
    ) -> Result<(Vec<Image>, Vec<SliceEntry>), Failure> {
        let Some(choice) = choice else {
            return Ok((surfaces(&self.0.meshes.iter().collect::<Vec<_>>(), options, session)?, Vec::new()));
        };
        let sliced: Vec<Which> = match self.0.grids.is_empty() {
            true => self.0.order.clone(),
            false => self.0.order.iter().copied().filter(|which| matches!(which, Which::Grid(_))).collect(),
        };
        let field = |which: &Which| match *which {
            Which::Mesh(n) => Field::of_mesh(&self.0.meshes[n], session),
            Which::Grid(n) => Ok(Field::of_grid(&self.0.grids[n])),
        };
        let fields: Vec<Field<'_>> = sliced.iter().map(field).collect::<Result<_, _>>()?;
        let size = [options.width, options.height];
        let slices = slice::draw(&fields, choice, size, session)?;
        let mut slices = slices.into_iter();
        let (mut images, mut drawn) = (Vec::new(), Vec::new());
        for which in &self.0.order {
            match (sliced.contains(which).then(|| slices.next()).flatten(), *which) {
                (Some((image, entry)), _) => {
                    images.push(image);
                    drawn.push(entry);
                }
                (None, Which::Mesh(n)) => images.extend(surfaces(&[&self.0.meshes[n]], options, session)?),
                (None, Which::Grid(_)) => return Err(Failure::internal("a grid was not drawn")),
            }
        }
        Ok((images, drawn))
    }
}

/// One mesh, or two by one camera, each with the legend of its file.
fn surfaces(meshes: &[&Input], options: &RenderOptions, session: &Session) -> Result<Vec<Image>, Failure> {
    let with_legend = |(mut image, input): (Image, &&Input)| {
        draw_legend(&mut image, &input.loaded.legend);
        image
    };
    let colours: Vec<_> = meshes.iter().map(|input| shown(input)).collect();
    let painted = |n: usize| Painted { mesh: &meshes[n].loaded.mesh, colours: colours[n].as_deref() };
    let drawn = match meshes {
        [_, _, ..] => render_pair(painted(0), painted(1), options, &session.progress).map(|images| images.to_vec()),
        [_] => render(painted(0), options, &session.progress).map(|image| vec![image]),
        [] => Ok(Vec::new()),
    };
    let images = drawn.map_err(failure)?;
    Ok(images.into_iter().zip(meshes).map(with_legend).collect())
}

/// The colours that the mesh shows without its images.
fn shown(input: &Input) -> Option<Cow<'_, Colours>> {
    shown_colours(input.loaded.colours.as_ref(), input.loaded.texture.as_ref())
}

fn options(args: &RenderArgs) -> RenderOptions {
    let view = args.view.view();
    RenderOptions {
        width: args.width,
        height: args.height,
        view: if args.y_up { view.y_up() } else { view },
        edges: match args.edges {
            EdgeChoice::None => EdgeDrawing::None,
            EdgeChoice::Sharp => EdgeDrawing::Sharp,
            EdgeChoice::All => EdgeDrawing::All,
        },
        defects: !args.no_defects,
        ..RenderOptions::default()
    }
}

/// `--view`: a name, or the direction to the viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ViewChoice {
    /// One of the names that the library knows.
    Named(&'static str, View),
    /// From the mesh to the viewer.
    From(DVec3),
}

impl ViewChoice {
    fn view(&self) -> View {
        match *self {
            Self::Named(_, view) => view,
            // Seen along z, up cannot be z.
            Self::From(from) if from.x == 0.0 && from.y == 0.0 => View { from, up: DVec3::Y },
            Self::From(from) => View { from, up: DVec3::Z },
        }
    }
}

impl std::fmt::Display for ViewChoice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Named(name, _) => f.write_str(name),
            Self::From(from) => write!(f, "{},{},{}", from.x, from.y, from.z),
        }
    }
}

/// Reads `--view`.
pub fn parse_view(text: &str) -> Result<ViewChoice, String> {
    let name = View::NAMES.into_iter().find(|name| *name == text);
    if let Some((name, view)) = name.and_then(|name| Some((name, View::named(name)?))) {
        return Ok(ViewChoice::Named(name, view));
    }
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match numbers.as_slice() {
        &[x, y, z] if text.matches(',').count() == 2 && DVec3::new(x, y, z).is_finite() && [x, y, z] != [0.0; 3] => {
            Ok(ViewChoice::From(DVec3::new(x, y, z)))
        }
        _ => Err(format!("wanted one of {}, or the direction to the viewer, such as 1,-1,0.5", View::NAMES.join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_by_name_and_by_direction() {
        for name in View::NAMES {
            assert_eq!(parse_view(name).map(|view| view.to_string()), Ok(name.to_string()));
        }
        assert_eq!(parse_view("1,-2,0.5"), Ok(ViewChoice::From(DVec3::new(1.0, -2.0, 0.5))));
        assert_eq!(parse_view("0,0,2").map(|view| view.view().up), Ok(DVec3::Y));
        for text in ["", "above", "1,2", "1,2,3,4", "0,0,0", "nan,0,1", "1,x,2,3"] {
            assert!(parse_view(text).is_err(), "{text}");
        }
    }
}
