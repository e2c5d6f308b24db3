//! `render IN [AFTER] -o PNG`.

use std::path::Path;

use glam::DVec3;
use serde_json::json;

use super::args::RenderArgs;
use super::choices::EdgeChoice;
use super::exit::{Exit, Failure};
use super::input::{self, Input, is_stream};
use super::output::{check_overwrite, write_stream};
use super::report::{OutputEntry, RunReport};
use super::session::Session;
use crate::io;
use crate::picture::{EdgeDrawing, Image, Painted, RenderError, RenderOptions, View, render, render_pair};

/// Draws one mesh, or two on one sheet.
pub fn run(args: &RenderArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let paths: Vec<&Path> = std::iter::once(&args.input).chain(&args.after).map(AsRef::as_ref).collect();
    check_overwrite(&args.output, args.force, &paths)?;
    let mut inputs = report.timed("read", |_| input::read_all(&paths, &args.reading, session))?;
    // Two meshes share one camera, so they must share one unit.
    input::common_unit(&mut inputs, &args.reading, &mut report.warnings);
    report.inputs = inputs.iter().map(|input| input.entry.clone()).collect();
    let options = options(args);
    report.options = json!({
        "width": args.width, "height": args.height, "view": args.view.to_string(), "y_up": args.y_up,
        "edges": format!("{:?}", args.edges).to_lowercase(), "defects": options.defects,
    });
    session.progress.stage("draw")?;
    let image = report.timed("draw", |_| match inputs.as_slice() {
        [before, after, ..] => render_pair(painted(before), painted(after), &options, &session.progress)
            .map(|images| Image::beside(&images)),
        [one] => render(painted(one), &options, &session.progress),
        [] => Err(RenderError::Empty),
    });
    let image = image.map_err(failure)?;
    let png = image.to_png().map_err(|e| Failure::internal(format!("the picture cannot be encoded: {e}")))?;
    session.finish(|| write(&args.output, &png))?;
    let label = if is_stream(&args.output) { "standard output".into() } else { args.output.display().to_string() };
    session.clear_bar();
    session.say(&format!("{label}: {} x {} pixels", image.width, image.height));
    if options.defects {
        session.say(
            "open edges red, edges of more than two triangles magenta, intersecting triangles yellow, inner sides rust red",
        );
    }
    for warning in &report.warnings {
        session.say(&format!("note: {warning}"));
    }
    report.output = Some(OutputEntry {
        path: label,
        format: "png".into(),
        bytes: png.len() as u64,
        sha256: input::sha256(&png),
        unit: None,
        validity: None,
    });
    Ok(Exit::Done)
}

fn painted(input: &Input) -> Painted<'_> {
    Painted { mesh: &input.loaded.mesh, colours: input.loaded.colours.as_ref() }
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

fn failure(error: RenderError) -> Failure {
    match error {
        RenderError::Stopped(stopped) => stopped.into(),
        RenderError::Empty => Failure::input(error.to_string()),
        RenderError::Size { .. } => Failure::usage(error.to_string()).hint("a smaller --width or --height"),
    }
}

fn write(path: &Path, png: &[u8]) -> Result<(), Failure> {
    if is_stream(path) {
        return write_stream(png);
    }
    io::save_bytes(path, |out| out.write_all(png)).map_err(|e| Failure::internal(e.to_string()))
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
