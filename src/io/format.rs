//! The formats of meshes and their names.

use std::ffi::OsStr;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Format {
    /// Stereolithography, binary or ASCII.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// Polygon file format, ASCII or binary of either byte order.
    Ply,
    /// Object file format of Geomview, ASCII.
    Off,
    /// glTF 2.0 in one binary file.
    Glb,
    /// glTF 2.0 as JSON.
    Gltf,
    /// 3D Manufacturing Format.
    ThreeMf,
}

impl Format {
    /// Whether coordinates are stored in single precision (STL, GLB and glTF); the other formats hold `f64`.
    pub fn is_single(self) -> bool {
        matches!(self, Self::Stl | Self::Glb | Self::Gltf)
    }

    /// Whether files of the format repeat a vertex for its triangles, so that vertices at equal positions mean the same place: STL
    /// has no indices at all, and glTF splits vertices where normals, colours or texture coordinates differ. Before such a mesh is judged or
    /// taken apart along its edges, its vertices must be merged ([`TriMesh::welded`](crate::mesh::TriMesh::welded)); in the other formats
    /// two vertices at one place are two, because the file says so.
    pub fn repeats_vertices(self) -> bool {
        matches!(self, Self::Stl | Self::Glb | Self::Gltf)
    }

    /// Whether a file of the format may hold several objects ([`read_scene`](crate::io::read_scene)).
    pub fn has_objects(self) -> bool {
        matches!(self, Self::Obj | Self::Glb | Self::Gltf | Self::ThreeMf)
    }

    /// Every format.
    pub const ALL: [Self; 7] = [Self::Stl, Self::Obj, Self::Ply, Self::Off, Self::Glb, Self::Gltf, Self::ThreeMf];

    /// The name, which is also the usual extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Off => "off",
            Self::Glb => "glb",
            Self::Gltf => "gltf",
            Self::ThreeMf => "3mf",
        }
    }

    /// The format that the extension of `path` names, in any case of letters.
    pub fn from_path(path: impl AsRef<Path>) -> Option<Self> {
        path.as_ref().extension().and_then(OsStr::to_str)?.parse().ok()
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A word that names no format of meshes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is no mesh format known here; use stl, obj, ply, off, glb, gltf or 3mf")]
pub struct UnknownFormat(pub String);

impl FromStr for Format {
    type Err = UnknownFormat;

    fn from_str(text: &str) -> Result<Self, UnknownFormat> {
        Self::ALL
            .into_iter()
            .find(|format| format.name().eq_ignore_ascii_case(text))
            .ok_or_else(|| UnknownFormat(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        for format in Format::ALL {
            assert_eq!(format.to_string().parse(), Ok(format));
            assert_eq!(Format::from_path(Path::new(&format!("a.b/c.{}", format.name().to_uppercase()))), Some(format));
        }
        assert_eq!(Format::from_path(Path::new("3mf")), None);
    }
}
