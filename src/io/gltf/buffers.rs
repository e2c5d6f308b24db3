//! The bytes behind a document: the binary chunk, data URIs and files beside it.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf::Document;

use super::super::error::{FileError, FileProblem};
use super::super::text::quoted;
use super::super::texture::{MOST_BESIDE, file_beside, read_beside};
use super::checked;

const BASE64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// Every buffer, whole.
pub(super) struct Buffers<'a> {
    /// Different contents: a file that several buffers name is read once.
    contents: Vec<Cow<'a, [u8]>>,
    /// For each buffer, its content and how much of it belongs to the buffer.
    buffers: Vec<(usize, usize)>,
}

impl<'a> Buffers<'a> {
    pub(super) fn load(document: &Document, binary: Option<&'a [u8]>, path: Option<&Path>) -> Result<Self, FileError> {
        let declared = &document.as_json().buffers;
        let mut contents = vec![Cow::Borrowed(binary.unwrap_or_default())];
        let mut buffers = Vec::with_capacity(declared.len());
        let mut known = BTreeMap::new();
        let mut left = MOST_BESIDE;
        for (i, buffer) in declared.iter().enumerate() {
            let place = |problem| FileError::item(format!("buffers[{i}]"), problem);
            let content = match &buffer.uri {
                None if i == 0 => 0,
                // Without a URI only the first buffer has bytes; extensions use such buffers.
                None => {
                    contents.push(Cow::Borrowed(&[]));
                    contents.len() - 1
                }
                Some(uri) => match known.get(uri.as_str()) {
                    Some(&content) => content,
                    None => {
                        let same = |other: &&gltf::json::Buffer| other.uri.as_deref() == Some(uri.as_str());
                        let wanted = declared.iter().filter(same).map(|other| other.byte_length.0).max();
                        let content = fetch(uri, path, wanted.unwrap_or_default(), &mut left).map_err(place)?;
                        contents.push(Cow::Owned(content));
                        known.insert(uri.as_str(), contents.len() - 1);
                        contents.len() - 1
                    }
                },
            };
            let length = usize::try_from(buffer.byte_length.0).unwrap_or(usize::MAX);
            buffers.push((content, length.min(contents[content].len())));
        }
        Ok(Self { contents, buffers })
    }

    /// Bytes of all different contents.
    pub(super) fn bytes(&self) -> usize {
        self.contents.iter().map(|content| content.len()).sum()
    }

    /// The bytes of every buffer, in order.
    pub(super) fn all(&self) -> impl Iterator<Item = &[u8]> {
        self.buffers.iter().map(|&(content, length)| &self.contents[content][..length])
    }

    /// The bytes of the buffer view of this number, and its stride.
    pub(super) fn view(&self, document: &Document, index: usize) -> Result<(&[u8], Option<usize>), FileError> {
        let fail = |problem| FileError::item(format!("bufferViews[{index}]"), problem);
        let view = checked::view(document, index).map_err(fail)?;
        let buffer = view.buffer().index();
        let &(content, length) =
            self.buffers.get(buffer).ok_or_else(|| fail(checked::missing(buffer, self.buffers.len(), "buffers")))?;
        let range = view.offset()..view.offset().saturating_add(view.length());
        let bytes = self.contents[content][..length].get(range).ok_or_else(|| {
            let expected = format!("{} bytes from byte {} of buffer {buffer}", view.length(), view.offset());
            fail(FileProblem::truncated(expected, format!("there are {length}")))
        })?;
        // A stride of zero is an error, which the crate takes for none.
        let stride = document.as_json().buffer_views.get(index).and_then(|view| view.byte_stride);
        Ok((bytes, stride.map(|stride| stride.0)))
    }
}

/// What `uri` leads to: of a file at most the first `wanted` bytes, which are taken from those that are `left`.
fn fetch(uri: &str, path: Option<&Path>, wanted: u64, left: &mut u64) -> Result<Vec<u8>, FileProblem> {
    if let Some(data) = uri.strip_prefix("data:") {
        return decoded_data(data);
    }
    let base = path.ok_or_else(|| {
        let uri = quoted(uri.as_bytes());
        FileProblem::Unsupported(format!(
            "the buffer {uri} lies in another file, which a stream does not give; read it from its place, or use GLB"
        ))
    })?;
    let elsewhere = || {
        let uri = quoted(uri.as_bytes());
        FileProblem::Unsupported(format!(
            "the buffer {uri} is not a file in the folder of the glTF file, and is not read"
        ))
    };
    let decoded = String::from_utf8(percent_decoded(uri)).map_err(|_| elsewhere())?;
    let file = file_beside(&decoded, base).ok_or_else(elsewhere)?;
    let failed = |e: std::io::Error| {
        FileProblem::Io(std::io::Error::new(e.kind(), format!("{}: {}", file.display(), plain(&e))))
    };
    // Links are followed to where they lead, and must not lead out of the folder.
    let cap = wanted.min(*left);
    let bytes = read_beside(&file, base, cap).map_err(failed)?.ok_or_else(elsewhere)?;
    if wanted > cap && bytes.len() as u64 == cap {
        return Err(FileProblem::TooLarge { what: "bytes of the files beside the document", limit: MOST_BESIDE });
    }
    *left -= bytes.len() as u64;
    Ok(bytes)
}

/// What follows `data:` in a URI.
pub(super) fn decoded_data(data: &str) -> Result<Vec<u8>, FileProblem> {
    let (kind, data) =
        data.split_once(',').ok_or_else(|| FileProblem::syntax("a comma in a data URI", quoted(data.as_bytes())))?;
    match kind.ends_with(";base64") {
        true => BASE64.decode(data).map_err(|e| FileProblem::syntax("base64 data", e.to_string())),
        false => Ok(percent_decoded(data)),
    }
}

/// "No such file or directory" without "(os error 2)".
fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_owned()
}

pub(super) fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut i = 0;
    while let Some(&byte) = bytes.get(i) {
        let hex = || u8::from_str_radix(std::str::from_utf8(bytes.get(i + 1..i + 3)?).ok()?, 16).ok();
        match (byte == b'%').then(hex).flatten() {
            Some(value) => {
                out.push(value);
                i += 3;
            }
            None => {
                out.push(byte);
                i += 1;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_of_files_are_decoded_before_they_are_judged() {
        let decoded = |uri: &str| String::from_utf8(percent_decoded(uri)).unwrap();
        let base = Path::new("models/a.gltf");
        assert_eq!(file_beside(&decoded("my%20mesh.bin"), base), Some("models/my mesh.bin".into()));
        for uri in ["%2e%2e/b.bin", "%2Fetc/passwd", "sub/%2e%2E/../b.bin", "a%00b"] {
            assert_eq!(file_beside(&decoded(uri), base), None, "{uri}");
        }
        assert_eq!(decoded_data("image/png;base64,AAEC").unwrap(), [0, 1, 2]);
        assert_eq!(decoded_data(",a%20b").unwrap(), b"a b");
        assert!(decoded_data("image/png;base64").is_err() && decoded_data(";base64,!").is_err());
    }
}
