//! `split IN -o OUT`: the bodies of a file, each in a file of its own.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::choices::AnyFormat;
use super::convert::{check_close, losses, state};
use super::entries::OutputEntry;
use super::exit::{Exit, Failure};
use super::files::{self, Made};
use super::input::{self, Input};
use super::meant;
use super::output::write_verified;
use super::paint::{self, Arranged};
use super::report::RunReport;
use super::result::RunResult;
use super::session::Session;
use super::shared_args::{CommonArgs, InputArgs, OutputArgs};
use super::streams::is_stream;
use super::summary;
use super::table::{self, Row};
use super::target::{self, MESH_ENDINGS, Target};
use super::words::{self, UnitName};
use crate::io::{Colours, Format, Loaded, Paint, Part, Unit, WriteOptions};
use crate::ldi::Operands;
use crate::mesh::{Submesh, ValidateOptions, validate};
use crate::progress::Stage;
use crate::shells::{bodies, shells};

/// The name of files in a folder, before their numbers.
const STEM: &str = "part";

/// Digits of the numbers, at least.
const DIGITS: usize = 3;

/// Bodies that the summary lists.
const LISTED: usize = 12;

/// `split IN -o OUT`.
#[derive(Debug, Args)]
pub struct SplitArgs {
    /// The mesh to take apart
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// A folder, for part_001.stl and so on in it (it is made if need be), or a name such as bolt.ply, for bolt_001.ply and so on
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// How the input is read.
    #[command(flatten)]
    pub reading: InputArgs,
    /// How the output is written.
    #[command(flatten)]
    pub writing: OutputArgs,
    /// Flags of every verb.
    #[command(flatten)]
    pub common: CommonArgs,
}

/// A body, taken out of its file.
struct Piece {
    loaded: Loaded,
    voids: usize,
    /// Absolute volume of its shells, voids taken off, and their area: what bodies are ordered by.
    volume: f64,
    area: f64,
}

/// Writes every body of one file into a file of its own, the largest first.
pub fn run(args: &SplitArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let names = Names::new(args)?;
    let mut inputs = report
        .timed(Stage::Read, |report| input::read_all(&[&args.input], &args.reading, session, &mut report.warnings))?;
    let unit = input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    let Some(input) = inputs.pop() else { return Err(Failure::internal("nothing was read")) };
    let format = names.format(args, input.loaded.format);
    let look = ValidateOptions { self_intersections: false, ..input.loaded.validate_options() };
    report.inputs[0].validity = Some(validate(&input.loaded.mesh, &look, &session.progress)?);
    let pieces = report.timed(Stage::Split, |_| pieces(&input, session))?;
    let options = WriteOptions { format, ascii: args.writing.ascii, unit };
    let targets: Vec<Target> =
        (0..pieces.len()).map(|n| Target { path: names.path(n, pieces.len(), format), options }).collect();
    report.options = json!({
        "unit": unit.map(|unit| unit.to_string()),
        "ascii": args.writing.ascii,
        "out_format": format.to_string(),
        "bodies": pieces.len(),
        "voids": pieces.iter().map(|piece| piece.voids).sum::<usize>(),
    });
    if let Some(folder) = names.folder_to_make() {
        session.make_folder(folder)?;
    }
    let made: Vec<Made> =
        targets.iter().map(|t| Made { flag: "-o", path: t.path.clone(), force: args.writing.force }).collect();
    files::check(&[&args.input], &made)?;
    files::prepare(&made)?;
    let (outputs, lost) = report.timed(Stage::WriteAndVerify, |report| write(&pieces, &targets, session, report))?;
    session.clear_bar();
    say(session, report, (&pieces, &outputs), unit);
    report.result = Some(RunResult::Bodies { outputs });
    Ok(if lost { Exit::Limit } else { Exit::Done })
}

/// Where the files go.
struct Names {
    /// A folder, or `None`.
    folder: Option<PathBuf>,
    /// Without a folder, the name into which numbers are put.
    name: PathBuf,
}

impl Names {
    fn new(args: &SplitArgs) -> Result<Self, Failure> {
        let path = &args.output;
        if is_stream(path) {
            return Err(Failure::usage("several files cannot go to standard output")
                .hint("a folder after -o, or a name such as part.stl"));
        }
        let text = path.as_os_str().to_string_lossy();
        let is_folder = path.is_dir() || text.ends_with(std::path::MAIN_SEPARATOR) || path.extension().is_none();
        if !is_folder && args.writing.out_format.is_none() && Format::from_path(path).is_none() {
            let endings = format!("{MESH_ENDINGS}, or give --out-format; or name a folder");
            return Err(target::untold(path, &meant::mesh_formats(), &endings));
        }
        Ok(Self { folder: is_folder.then(|| path.clone()), name: path.clone() })
    }

    /// The folder, if there is none yet.
    fn folder_to_make(&self) -> Option<&Path> {
        self.folder.as_deref().filter(|folder| !folder.exists())
    }

    fn format(&self, args: &SplitArgs, of_input: Format) -> Format {
        let named = Format::from_path(&self.name).filter(|_| self.folder.is_none());
        let asked = match args.writing.out_format {
            Some(AnyFormat::Mesh(format)) => Some(format),
            _ => None,
        };
        asked.or(named).unwrap_or(of_input)
    }

    /// The path of body number `n`, from 0.
    fn path(&self, n: usize, count: usize, format: Format) -> PathBuf {
        let digits = count.to_string().len().max(DIGITS);
        let number = n + 1;
        match &self.folder {
            Some(folder) => folder.join(format!("{STEM}_{number:0digits$}.{format}")),
            None => {
                let stem = self.name.file_stem().unwrap_or_default().to_string_lossy();
                let extension = self.name.extension().unwrap_or_default().to_string_lossy();
                self.name.with_file_name(format!("{stem}_{number:0digits$}.{extension}"))
            }
        }
    }
}

/// The bodies, the largest first.
fn pieces(input: &Input, session: &Session) -> Result<Vec<Piece>, Failure> {
    session.progress.stage(Stage::Split)?;
    let loaded = &input.loaded;
    let mesh = &loaded.mesh;
    // Shared places make one surface where the format cannot say it otherwise.
    let welded = if loaded.format.repeats_vertices() { mesh.welded() } else { mesh.clone() };
    let shells = shells(&welded, &Operands::new([welded.triangles.len()]));
    let mut pieces = Vec::new();
    for body in bodies(&welded, &shells, &session.progress)? {
        session.progress.check()?;
        let mut triangles: Vec<u32> = body.iter().flat_map(|&n| shells.list[n].triangles.iter().copied()).collect();
        triangles.sort_unstable();
        let volume: f64 = body.iter().map(|&n| shells.list[n].volume).sum();
        let area = body.iter().map(|&n| shells.list[n].area).sum();
        let loaded = part_of(loaded, &triangles);
        pieces.push(Piece { loaded, voids: body.len() - 1, volume: volume.abs(), area });
    }
    pieces.sort_by(|a, b| b.volume.total_cmp(&a.volume).then(b.area.total_cmp(&a.area)));
    Ok(pieces)
}

/// Some triangles of a file, in their order, with their colours.
fn part_of(loaded: &Loaded, triangles: &[u32]) -> Loaded {
    let mesh = &loaded.mesh;
    let Submesh { mesh: part, vertices } = mesh.submesh(triangles);
    let colours = loaded.colours.as_ref().map(|colours| match colours {
        Colours::Faces(_) => Colours::Faces(triangles.iter().map(|&t| colours.corners(mesh, t as usize)[0]).collect()),
        Colours::Vertices(list) => {
            Colours::Vertices(vertices.iter().map(|&v| list.get(v as usize).copied().unwrap_or([255; 4])).collect())
        }
        Colours::Corners(_) => Colours::Corners(triangles.iter().map(|&t| colours.corners(mesh, t as usize)).collect()),
    });
    let first = triangles.first().map_or(0, |&t| t as usize);
    let name = loaded.parts.iter().find(|part| part.triangles.contains(&first)).map_or("", |part| part.name.as_str());
    Loaded {
        parts: vec![Part { name: name.to_owned(), triangles: 0..part.triangles.len() }],
        mesh: part,
        colours,
        format: loaded.format,
        unit: loaded.unit,
        texture: loaded.texture.as_ref().map(|texture| texture.picked(triangles)),
        negative: None,
        legend: Vec::new(),
        scale: None,
        warnings: Vec::new(),
    }
}

fn paint_of(loaded: &Loaded) -> Paint<'_> {
    Paint { colours: loaded.colours.as_ref(), texture: loaded.texture.as_ref(), beside: None }
}

/// Writes and verifies all files; also, whether rounding to the numbers of the format has lost something.
fn write(
    pieces: &[Piece],
    targets: &[Target],
    session: &Session,
    report: &mut RunReport,
) -> Result<(Vec<OutputEntry>, bool), Failure> {
    let (mut outputs, mut lost) = (Vec::new(), Vec::new());
    for (n, (piece, target)) in pieces.iter().zip(targets).enumerate() {
        let loaded = &piece.loaded;
        let before = state(&loaded.mesh, session)?;
        let arranged = Arranged::new(&loaded.mesh, &paint_of(loaded), target.options.format);
        let (entry, after) = write_verified(target, &arranged.mesh, arranged.paint(), session, |read| {
            check_close(read, &arranged.mesh, target.options.factor())?;
            paint::check_colours(read, &arranged.mesh, &arranged.paint())?;
            state(&read.mesh, session)
        })?;
        let path = &entry.path;
        lost.extend(losses(&before, &after).into_iter().map(|sentence| format!("{path}: {sentence}")));
        outputs.push(OutputEntry { validity: Some(after), ..entry });
        session.progress.share((n + 1) as f32 / pieces.len() as f32);
    }
    if let (Some(Piece { loaded, .. }), Some(target)) = (pieces.first(), targets.first()) {
        report.warnings.extend(paint::lost(&loaded.mesh, &paint_of(loaded), target));
        report.warnings.extend(target.unit_note());
    }
    report.warnings.extend(lost.iter().cloned());
    Ok((outputs, !lost.is_empty()))
}

fn say(session: &Session, report: &RunReport, (pieces, outputs): (&[Piece], &[OutputEntry]), unit: Option<Unit>) {
    let unit = unit.map(|unit| unit.to_string());
    let unit: UnitName<'_> = unit.as_deref();
    let mut rows: Vec<Row> = summary::input_rows(report).into_iter().filter(|(label, _)| *label == "input").collect();
    let voids: usize = pieces.iter().map(|piece| piece.voids).sum();
    let with_voids = match voids {
        0 => String::new(),
        n => format!(", with {} inside", words::plural(n, "void")),
    };
    rows.push(("done", format!("{}{with_voids}", words::plural(pieces.len(), "body"))));
    for (piece, output) in pieces.iter().zip(outputs).take(LISTED) {
        let triangles = words::plural(piece.loaded.mesh.triangles.len(), "triangle");
        let closed = output.validity.as_ref().is_some_and(|state| state.is_closed());
        let size = match closed {
            true => format!("volume {}", words::volume(piece.volume, unit)),
            false => format!("open, area {}", words::area(piece.area, unit)),
        };
        rows.push(("result", format!("{}: {triangles}, {size}", output.path)));
    }
    if pieces.len() > LISTED {
        rows.push(("result", format!("and {} more", words::count(pieces.len() - LISTED))));
    }
    rows.push(summary::time(report));
    session.say(table::table(&rows).trim_end());
}
