//! Which format bytes are of: by content first, then by extension.

use std::path::Path;

use super::format::Format;
use super::text::{Lines, Words, number};
use super::{off, stl};

impl Format {
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

#[cfg(test)]
mod tests {
    use super::*;

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
