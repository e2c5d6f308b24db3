//! Where a mesh goes, and whether its name says what is written to it.

use std::path::{Path, PathBuf};

use super::choices::AnyFormat;
use super::exit::Failure;
use super::meant;
use super::shared_args::OutputArgs;
use super::streams::{is_direct, is_stream};
use super::words;
use crate::io::{Format, Unit, WriteOptions};
use crate::nearest::nearest;

/// What to do with a name that tells no format of meshes.
pub const MESH_ENDINGS: &str = "end it in .stl, .obj, .ply, .off, .glb, .gltf or .3mf";
/// And with one that tells none of lattices.
pub const GRID_ENDINGS: &str = "end it in .vti, .nrrd, .npy or .vdb";

/// Where a mesh goes, and how it is encoded.
pub struct Target {
    /// The path as given.
    pub path: PathBuf,
    /// Encoding.
    pub options: WriteOptions,
}

impl Target {
    /// What can be known of the encoding before the work begins.
    pub fn new(path: &Path, args: &OutputArgs) -> Result<Self, Failure> {
        let format = match args.out_format.or_else(|| AnyFormat::from_path(path)) {
            Some(AnyFormat::Mesh(format)) => {
                check_extension(path, format.name())?;
                format
            }
            Some(AnyFormat::Grid(format)) => {
                return Err(Failure::usage(format!("{format} holds values over a lattice, and the result is a mesh"))
                    .hint("stl, obj, ply, off, glb, gltf and 3mf hold meshes; `sdf` and `field` make lattices"));
            }
            None if is_stream(path) => {
                return Err(Failure::usage("standard output has no name that tells its format")
                    .hint("--out-format says it, for example --out-format stl"));
            }
            None => {
                return Err(untold(path, &meant::mesh_formats(), &format!("{MESH_ENDINGS}, or give --out-format")));
            }
        };
        Ok(Self { path: path.to_path_buf(), options: WriteOptions { format, ascii: args.ascii, unit: None } })
    }

    /// The unit of the mesh that will be written.
    pub fn set_unit(&mut self, unit: Option<Unit>) {
        self.options.unit = unit;
    }

    /// What a user should know of the unit in the file.
    pub fn unit_note(&self) -> Option<String> {
        let format = self.options.format;
        match (format, self.options.unit) {
            (Format::Glb | Format::Gltf, None) => Some(format!(
                "{format} is in metres, and the unit of the model is not known: its numbers were written as they are, so 1 reads \
                 as 1 m; --unit mm, for example, says what they are"
            )),
            (Format::Glb | Format::Gltf, Some(unit)) if unit != Unit::Metre => {
                let factor = words::factor(self.options.factor());
                Some(format!("{format} is in metres: lengths in {} were written times {factor}", words::several(unit)))
            }
            (Format::ThreeMf, None) => Some(
                "3MF states a unit, and that of the model is not known: its numbers were written as they are and read as millimetres; \
                 --unit says otherwise"
                    .into(),
            ),
            (Format::Stl | Format::Obj | Format::Ply | Format::Off, Some(unit)) if unit != Unit::Millimetre => Some(format!(
                "{format} has no place for a unit: its numbers are {}, and most programs will take them for millimetres",
                words::several(unit)
            )),
            _ => None,
        }
    }
}

/// A name that tells none of `formats`; `endings` says what would.
pub fn untold(path: &Path, formats: &[&str], endings: &str) -> Failure {
    let extension = path.extension().map_or(String::new(), |extension| extension.to_string_lossy().into_owned());
    let failure = Failure::usage(format!("the name {} does not tell its format", path.display()));
    failure.hint(match nearest(&extension, formats.iter().copied()) {
        Some(near) => format!("did you mean {}? {endings}", path.with_extension(near).display()),
        None => endings.to_string(),
    })
}

/// Extensions that say what is in a file, beside those of the formats for meshes and lattices.
const KNOWN: [&str; 28] = [
    "png", "jpg", "jpeg", "gif", "bmp", "tif", "tiff", "webp", "svg", "pdf", "json", "html", "xml", "zip", "step",
    "stp", "iges", "igs", "dxf", "dwg", "fbx", "dae", "3ds", "blend", "amf", "x3d", "wrl", "usd",
];

/// Refuses a name that says something else than what is written to it.
pub fn check_extension(path: &Path, format: &str) -> Result<(), Failure> {
    let extension = path.extension().map_or(String::new(), |extension| extension.to_string_lossy().to_lowercase());
    let says_something = AnyFormat::from_path(path).is_some() || KNOWN.contains(&extension.as_str());
    if is_direct(path) || extension == format || !says_something {
        return Ok(());
    }
    let name = path.display();
    Err(Failure::usage(format!("{name} is named as {extension}, and {format} would be written to it"))
        .hint(format!("a name that ends in .{format}, such as {}", path.with_extension(format).display())))
}
