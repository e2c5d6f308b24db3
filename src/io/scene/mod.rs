//! Files of several objects: each object in its own coordinates, and the places that it has, for programs that work on objects one by one.
//! [`read`](crate::io::read) makes one mesh of all instead.

mod suit;
mod types;
mod write;

use std::path::Path;

use super::error::{FileError, FileProblem};
use super::format::Format;
use super::{gltf, obj, reading, three_mf};

pub use types::{Aside, Placement, Scene, SceneMaterial, SceneObject, ScenePart};
pub(super) use types::{MaterialOrigin, Origin, Source, Unplaced};
pub use write::{Flattened, encode_scene, flattened};

/// Reads the objects of a file in 3MF, glTF or OBJ, each once, and where they are placed. `format` and `path` are as for
/// [`read_bytes`](crate::io::read_bytes).
///
/// # Errors
/// As [`read_bytes`](crate::io::read_bytes); and [`FileProblem::Unsupported`] for formats that have no objects.
pub fn read_scene(bytes: &[u8], format: Option<Format>, path: Option<&Path>) -> Result<Scene, FileError> {
    let plain = reading::plain(bytes);
    let bytes = plain.as_ref();
    let found = reading::recognised(bytes, format, path)?;
    let read = match found {
        Format::Obj => obj::read_apart(bytes, path),
        Format::Glb | Format::Gltf => gltf::read_apart(bytes, found, path),
        Format::ThreeMf => three_mf::read_apart(bytes),
        Format::Stl | Format::Ply | Format::Off => Err(FileProblem::Unsupported(format!(
            "{found} holds one mesh and no objects; 3MF, glTF and OBJ hold objects"
        ))
        .into()),
    };
    let read = read.map_err(|error| error.in_file(path, Some(found)))?;
    Ok(Scene::of(read, bytes, path.map(Path::to_owned)))
}
