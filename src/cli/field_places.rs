//! Where the results of `field` go: one file, or one for each frame.

use std::path::{Path, PathBuf};

use super::choices::AnyFormat;
use super::exit::Failure;
use super::field_args::FieldArgs;
use super::files::Made;
use super::meant;
use super::streams::is_stream;
use super::target::{self, MESH_ENDINGS, Target, check_extension};
use crate::io::GridFormat;

/// Where one result goes.
pub enum Place {
    /// A mesh.
    Mesh(Target),
    /// Values over a lattice.
    Grid(PathBuf, GridFormat),
}

impl Place {
    /// Its path.
    pub fn path(&self) -> &Path {
        match self {
            Self::Mesh(target) => &target.path,
            Self::Grid(path, _) => path,
        }
    }
}

/// The files that will be made.
pub fn made(args: &FieldArgs) -> Vec<Made> {
    let frames = args.frames.unwrap_or(1);
    let made = |number| Made { flag: "-o", path: frame_path(args, number, frames), force: args.writing.force };
    (0..frames).map(made).collect()
}

fn frame_path(args: &FieldArgs, number: u32, frames: u32) -> PathBuf {
    match frames > 1 && !is_stream(&args.output) {
        true => numbered(&args.output, number, frames),
        false => args.output.clone(),
    }
}

/// A place for each frame; what can be known of their formats before the work begins is checked.
pub fn targets(args: &FieldArgs) -> Result<Vec<Place>, Failure> {
    let frames = args.frames.unwrap_or(1);
    if frames > 1 && is_stream(&args.output) {
        return Err(
            Failure::usage("a sequence cannot go to standard output").hint("a name after -o, such as morph.ply")
        );
    }
    let place = |number: u32| {
        let path = frame_path(args, number, frames);
        let of_grid = match args.writing.out_format.or_else(|| AnyFormat::from_path(&path)) {
            Some(AnyFormat::Grid(format)) => {
                check_extension(&path, format.name())?;
                Some(format)
            }
            _ => None,
        };
        match of_grid {
            Some(_) if args.paint.is_some() => {
                Err(Failure::usage("--paint colours the vertices of a mesh, and a lattice has none")
                    .hint("the values themselves: the expression of --paint in the place of EXPR"))
            }
            Some(_) if args.no_fit || args.no_collapse || args.simplify.is_some() => Err(Failure::usage(
                "--no-fit, --no-collapse and --simplify are about the triangles of a mesh, and a lattice has none",
            )),
            None if args.band.is_some() => {
                Err(Failure::usage("--band is about the values over a lattice, and a mesh has none")
                    .hint("a name after -o that ends in .vti, .nrrd, .npy or .vdb"))
            }
            Some(format) => Ok(Place::Grid(path, format)),
            None if args.writing.out_format.is_none() && AnyFormat::from_path(&path).is_none() && !is_stream(&path) => {
                let endings = format!("{MESH_ENDINGS}, or for a lattice in .vti, .nrrd, .npy or .vdb");
                Err(target::untold(&path, &meant::all_formats(), &endings))
            }
            None => Target::new(&path, &args.writing).map(Place::Mesh),
        }
    };
    (0..frames).map(place).collect()
}

/// `morph.ply` as `morph_03.ply`, with as many digits as the last number has.
fn numbered(path: &Path, number: u32, frames: u32) -> PathBuf {
    let digits = (frames - 1).to_string().len();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or(String::new(), |extension| format!(".{}", extension.to_string_lossy()));
    path.with_file_name(format!("{stem}_{number:0digits$}{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_get_numbers_of_one_length_before_the_extension() {
        let at = |path: &str, number, frames| numbered(Path::new(path), number, frames).display().to_string();
        assert_eq!(at("out/morph.ply", 3, 10), "out/morph_3.ply");
        assert_eq!(at("morph.ply", 3, 11), "morph_03.ply");
        assert_eq!(at("a.b.vti", 24, 101), "a.b_024.vti");
        assert_eq!(at("plain", 0, 2), "plain_0");
    }
}
