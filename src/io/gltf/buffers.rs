//! The bytes behind a document: the binary chunk, data URIs and files beside it.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use gltf_json::{Index, Root, buffer::View};

use super::super::error::{FileError, FileProblem};
use super::super::text::quoted;
use super::super::texture::{MOST_BESIDE, file_beside, read_beside};

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
    pub(super) fn load(root: &Root, binary: Option<&'a [u8]>, path: Option<&Path>) -> Result<Self, FileError> {
        let mut contents = vec![Cow::Borrowed(binary.unwrap_or_default())];
        let mut buffers = Vec::with_capacity(root.buffers.len());
        let mut known = BTreeMap::new();
        let mut left = MOST_BESIDE;
        for (i, buffer) in root.buffers.iter().enumerate() {
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
                        let same = |other: &&gltf_json::Buffer| other.uri.as_deref() == Some(uri.as_str());
                        let wanted = root.buffers.iter().filter(same).map(|other| other.byte_length.0).max();
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

    /// The bytes of a buffer view and its stride.
    pub(super) fn view(&self, root: &Root, view: Index<View>) -> Result<(&[u8], Option<usize>), FileError> {
        let item = format!("bufferViews[{}]", view.value());
        let fail = |problem| FileError::item(item.clone(), problem);
        let view =
            root.get(view).ok_or_else(|| fail(missing(view.value(), root.buffer_views.len(), "buffer views")))?;
        let buffer = view.buffer.value();
        let &(content, length) =
            self.buffers.get(buffer).ok_or_else(|| fail(missing(buffer, self.buffers.len(), "buffers")))?;
        let start = view.byte_offset.unwrap_or_default().0;
        let range = start.checked_add(view.byte_length.0).and_then(|end| {
            Some(usize::try_from(start).ok()?..usize::try_from(end).ok().filter(|&end| end <= length)?)
        });
        let bytes = range.and_then(|range| self.contents[content].get(range)).ok_or_else(|| {
            let expected = format!("{} bytes from byte {start} of buffer {buffer}", view.byte_length.0);
            fail(FileProblem::truncated(expected, format!("there are {length}")))
        })?;
        Ok((bytes, view.byte_stride.map(|stride| stride.0)))
    }
}

/// The problem of an index that leads nowhere.
pub(super) fn missing(index: usize, count: usize, what: &'static str) -> FileProblem {
    FileProblem::IndexOutOfRange { index: index as i64, count, what }
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
