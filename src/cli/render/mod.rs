//! `render IN [AFTER] -o PICTURE`.

mod choices;
mod draw;
mod surfaces;

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::choices::{BackgroundChoice, EdgeChoice, ProjectionChoice, ZoomChoice};
use super::entries::OutputEntry;
use super::epilogue;
use super::exit::{Exit, Failure};
use super::given::Given;
use super::length::parse_size;
use super::output::in_memory;
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::shared_args::{CommonArgs, InputArgs};
use super::side::write_side;
use super::slice::SliceChoice;
use super::streams::{self, is_stream};
use crate::io::LegendEntry;
use crate::picture::Image;
use crate::progress::Stage;
use choices::{ViewChoice, parse_named, parse_opacity, parse_view};
use draw::Inputs;

/// `render IN [AFTER] -o PICTURE`.
#[derive(Debug, Args)]
pub struct RenderArgs {
    /// The mesh to draw, or the grid (VTI, NRRD, NPY, VDB) of which to draw a slice
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// A second mesh or grid, drawn beside the first: meshes from the same point of view, slices of the same plane
    #[arg(value_name = "AFTER")]
    pub after: Option<PathBuf>,
    /// Where to write the picture: PNG, or JPEG where the name ends in .jpg
    #[arg(short, long, value_name = "PICTURE")]
    pub output: PathBuf,
    /// Width of the picture (of each, for several), pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 1200, value_parser = clap::value_parser!(u32).range(16..=16384))]
    pub width: u32,
    /// Height, pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 900, value_parser = clap::value_parser!(u32).range(16..=16384))]
    pub height: u32,
    /// From where: iso, front, back, left, right, top, bottom, or the direction to the viewer as X,Y,Z
    #[arg(long, value_name = "VIEW", default_value = "iso", value_parser = parse_view, allow_hyphen_values = true)]
    pub view: ViewChoice,
    /// Several views on one sheet, in one scale: iso,front,top,right
    #[arg(long, value_name = "VIEW,...", value_parser = parse_named, value_delimiter = ',', conflicts_with = "view")]
    pub views: Vec<ViewChoice>,
    /// How depth shows
    #[arg(long, value_enum, default_value_t = ProjectionChoice::Orthographic)]
    pub projection: ProjectionChoice,
    /// The y axis points up, not z; in slices, too
    #[arg(long)]
    pub y_up: bool,
    /// Draw a slice: z (through the middle), x=50%, y=1.5 or z=2mm; of meshes, where no grid is given, through their
    /// signed distance [default: z, for grids]
    #[arg(long, value_name = "AXIS[=AT]", allow_hyphen_values = true)]
    pub slice: Option<SliceChoice>,
    /// Cut away what is in front of a plane: z=50%, x=1.5 or y=2mm; the inside of closed meshes is hatched
    #[arg(long, value_name = "AXIS[=AT]", allow_hyphen_values = true)]
    pub clip: Option<SliceChoice>,
    /// How much a surface hides of what is behind it: 0.3, or 30%
    #[arg(long, value_name = "SHARE", default_value = "1", value_parser = parse_opacity)]
    pub opacity: f32,
    /// Fill the picture with this: the largest group of defects
    #[arg(long, value_enum, value_name = "WHAT")]
    pub zoom: Option<ZoomChoice>,
    /// Draw the thin and doubtful regions that the report of a run tells of
    #[arg(long, value_name = "RUN.json")]
    pub regions: Option<PathBuf>,
    /// Turn the mesh once, in so many pictures, as an animated PNG
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..=360), conflicts_with_all = ["views", "slice", "after"])]
    pub turntable: Option<u16>,
    /// Which edges of triangles are drawn
    #[arg(long, value_enum, default_value_t = EdgeChoice::Sharp)]
    pub edges: EdgeChoice,
    /// Do not colour defects
    #[arg(long)]
    pub no_defects: bool,
    /// What is behind the mesh
    #[arg(long, value_enum, default_value_t = BackgroundChoice::Gradient)]
    pub background: BackgroundChoice,
    /// The words above the picture; once for each, for several [default: the names of the files]
    #[arg(long, value_name = "TEXT", conflicts_with = "plain")]
    pub title: Vec<String>,
    /// No title, axes, scale and legend: the mesh alone
    #[arg(long)]
    pub plain: bool,
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

/// As what the picture is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FileKind {
    Png,
    Jpeg,
}

impl FileKind {
    /// By the name of the file, which must not say something else.
    fn of(path: &Path) -> Result<Self, Failure> {
        let jpeg = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("jpg") || e.eq_ignore_ascii_case("jpeg"));
        if jpeg && !is_stream(path) {
            return Ok(Self::Jpeg);
        }
        super::target::check_extension(path, "png").map(|()| Self::Png)
    }

    fn name(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Jpeg => "jpeg",
        }
    }
}

/// Pictures of a turn that are shown in a second.
const RATE: u16 = 20;

/// Draws one mesh or slice, or several on one sheet.
pub fn run(args: &RenderArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let kind = FileKind::of(&args.output)?;
    check(args, kind, session)?;
    let paths: Vec<&Path> = std::iter::once(&args.input).chain(&args.after).map(AsRef::as_ref).collect();
    let mut inputs = report.timed(Stage::Read, |report| {
        Given::read(&paths, &args.reading, args.max_memory, session, &mut report.warnings)
    })?;
    // What shares one camera, or one plane, must share one unit.
    inputs.common_unit(&args.reading, &mut report.warnings);
    inputs.describe(report);
    let inputs = Inputs { given: inputs, args };
    report.options = options(args, inputs.slices());
    session.progress.stage(Stage::Draw)?;
    let drawn = report.timed(Stage::Draw, |_| inputs.draw(session))?;
    report.warnings.extend(drawn.notes);
    let first = drawn.images.first().ok_or_else(|| Failure::internal("nothing was drawn"))?;
    let sheet = match args.turntable {
        Some(_) => first.clone(),
        None => Image::sheet(&drawn.images, drawn.columns),
    };
    if let Some(desk) = session.desk_for(&args.output) {
        desk.lay_picture(sheet);
        report.result = Some(RunResult::Picture { slices: drawn.slices, output: in_memory(None) });
        return Ok(epilogue::measured(session, report, args.max_memory));
    }
    let bytes = match (args.turntable, kind) {
        (Some(_), _) => crate::picture::to_animated_png(&drawn.images, RATE),
        (None, FileKind::Png) => sheet.to_png(),
        (None, FileKind::Jpeg) => sheet.to_jpeg(),
    };
    let bytes = bytes.map_err(|e| Failure::internal(format!("the picture cannot be encoded: {e}")))?;
    session.progress.check()?;
    write_side(&args.output, &bytes, session)?;
    let label = if is_stream(&args.output) { "standard output".into() } else { args.output.display().to_string() };
    session.clear_bar();
    let frames = args.turntable.map_or(String::new(), |frames| format!(", {frames} of them"));
    session.say(&format!("{label}: {} x {} pixels{frames}", sheet.width, sheet.height));
    say_colours(&inputs, &drawn.legend, session);
    for slice in &drawn.slices {
        session.say(&slice.words(inputs.given.unit_of(&slice.path).as_deref()));
    }
    let output = OutputEntry {
        path: label,
        format: kind.name().into(),
        bytes: bytes.len() as u64,
        sha256: streams::sha256(&bytes),
        unit: None,
        validity: None,
    };
    report.result = Some(RunResult::Picture { slices: drawn.slices, output });
    Ok(epilogue::measured(session, report, args.max_memory))
}

/// Refuses what does not go together.
fn check(args: &RenderArgs, kind: FileKind, session: &Session) -> Result<(), Failure> {
    if args.turntable.is_some() && kind == FileKind::Jpeg {
        return Err(Failure::usage("a JPEG file holds no animation").hint("a name that ends in .png"));
    }
    if args.turntable.is_some() && session.desk_for(&args.output).is_some() {
        return Err(Failure::usage("an animation is written to a file").hint("`output`, a name that ends in .png"));
    }
    Ok(())
}

fn options(args: &RenderArgs, slices: bool) -> serde_json::Value {
    let names = |views: &[ViewChoice]| views.iter().map(ViewChoice::to_string).collect::<Vec<_>>();
    let word = |value: &dyn std::fmt::Debug| format!("{value:?}").to_lowercase();
    json!({
        "width": args.width, "height": args.height, "view": args.view.to_string(), "views": names(&args.views),
        "projection": word(&args.projection), "y_up": args.y_up, "edges": word(&args.edges), "defects": !args.no_defects,
        "slice": slices.then(|| args.slice.unwrap_or_default().to_string()),
        "clip": args.clip.map(|clip| clip.to_string()), "opacity": args.opacity,
        "zoom": args.zoom.as_ref().map(|zoom| word(zoom)), "turntable": args.turntable, "background": word(&args.background),
    })
}

/// What colours mean, in words.
fn say_colours(inputs: &Inputs<'_>, defects: &[LegendEntry], session: &Session) {
    let entry = |LegendEntry { colour: [r, g, b], text }: &LegendEntry| format!("#{r:02X}{g:02X}{b:02X} {text}");
    if !defects.is_empty() {
        session.say(&defects.iter().map(entry).collect::<Vec<_>>().join("; "));
    }
    for input in inputs.given.meshes.iter().filter(|input| !input.loaded.legend.is_empty()) {
        let entries: Vec<String> = input.loaded.legend.iter().map(entry).collect();
        session.say(&format!("{}: {}", input.label, entries.join("; ")));
    }
}
