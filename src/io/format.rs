//! The formats, told by content first, then by extension.

use std::ffi::OsStr;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

use super::text::{Lines, Words, number};
use super::{off, stl};

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
    pub fn from_path(path: &Path) -> Option<Self> {
        path.extension().and_then(OsStr::to_str)?.parse().ok()
    }

    /// The format of `bytes` by what they hold; if that tells nothing, by the extension of `path`.
    pub fn detect(bytes: &[u8], path: Option<&Path>) -> Option<Self> {
        let named = path.and_then(Self::from_path);
        Self::from_content(bytes).or(named).or_else(|| stl::looks_binary(bytes).then_some(Self::Stl))
    }

    /// The format of `bytes` by what they hold.
    pub(super) fn from_content(bytes: &[u8]) -> Option<Self> {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        if bytes.starts_with(b"glTF") {
            Some(Self::Glb)
        } else if bytes.starts_with(b"PK\x03\x04") {
            Some(Self::ThreeMf)
        } else if matches!(bytes, [b'p', b'l', b'y', b'\n' | b'\r' | b' ', ..]) {
            Some(Self::Ply)
        } else if stl::is_exactly_binary(bytes) || stl::looks_ascii(bytes) {
            Some(Self::Stl)
        } else if off::has_keyword(bytes) {
            Some(Self::Off)
        } else if text.starts_with(b"{") && contains(&text[..text.len().min(1 << 16)], b"\"asset\"") {
            Some(Self::Gltf)
        } else {
            looks_like_obj(bytes).then_some(Self::Obj)
        }
    }
}

/// A vertex line before anything that OBJ does not know, within the first lines.
fn looks_like_obj(bytes: &[u8]) -> bool {
    for (_, line) in Lines::new(&bytes[..bytes.len().min(1 << 16)]).take(1000) {
        let mut words = Words::new(line);
        match words.next() {
            None => {}
            Some(b"v") => return words.by_ref().take(3).filter_map(number).count() == 3,
            Some(word) if word.starts_with(b"#") => {}
            Some(b"vn" | b"vt" | b"vp" | b"o" | b"g" | b"s" | b"mtllib" | b"usemtl" | b"mg") => {}
            Some(_) => return false,
        }
    }
    false
}

fn contains(haystack: &[u8], needle: &[u8]) -> bool {
    haystack.windows(needle.len()).any(|window| window == needle)
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is no format.
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

    #[test]
    fn content_wins_over_the_extension() {
        let lies = Some(Path::new("lies.stl"));
        assert_eq!(Format::detect(b"# x\no cube\nv 0 0 0\n", lies), Some(Format::Obj));
        assert_eq!(Format::detect(b"ply\nformat ascii 1.0\n", lies), Some(Format::Ply));
        assert_eq!(Format::detect(b"# c\nCOFF\n", lies), Some(Format::Off));
        assert_eq!(Format::detect(b"{\"asset\":{}}", lies), Some(Format::Gltf));
        assert_eq!(Format::detect(b"solid a\nfacet normal 0 0 1\n", Some(Path::new("x.obj"))), Some(Format::Stl));
        assert_eq!(Format::detect(b"who knows", lies), Some(Format::Stl));
        assert_eq!(Format::detect(b"who knows", None), None);
        assert_eq!(Format::detect(b"", Some(Path::new("a.off"))), Some(Format::Off));
    }
}
