//! glTF 2.0, as JSON and in one binary file. The document and the way through it are those of the `gltf` crate; every index, range and
//! transform is checked here, because its types promise none of them and its traversal panics where one is wrong (see `checked`).

mod accessor;
mod apart;
mod buffers;
mod changed;
mod checked;
mod compact;
mod content;
mod fresh;
mod instancing;
mod material;
mod pack;
mod patch;
mod scene;
mod texture;
mod write;

use std::path::Path;

use gltf::Document;
use gltf::json;

use self::buffers::Buffers;
use self::instancing::Instancing;
use super::error::{FileError, FileProblem};
use super::scene::Unplaced;
use super::soup::Expansion;
use super::{Format, Loaded, Unit};

pub(super) use fresh::write_fresh;
pub(super) use patch::write_patched;
pub(super) use write::{write_glb, write_json};

const MAGIC: &[u8] = b"glTF";
const JSON_CHUNK: &[u8] = b"JSON";
const BINARY_CHUNK: &[u8] = b"BIN\0";

/// Extensions that are read.
const READ: [&str; 2] = [instancing::NAME, "KHR_mesh_quantization"];
/// Extensions that begin so say how a surface looks and leave its shape alone.
const OF_LOOKS: [&str; 7] =
    ["KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_", "EXT_lights_", "MSFT_texture_", "EXT_materials_"];

/// Reads a glTF file in JSON.
pub(super) fn read_json(bytes: &[u8], path: Option<&Path>) -> Result<Loaded, FileError> {
    Opened::new(bytes, Format::Gltf, path)?.read(path)
}

/// Reads a binary glTF file: a header and chunks, the JSON first.
pub(super) fn read_glb(bytes: &[u8], path: Option<&Path>) -> Result<Loaded, FileError> {
    Opened::new(bytes, Format::Glb, path)?.read(path)
}

/// Reads the meshes of a file in one of the two formats, each once, and where they are placed.
pub(super) fn read_apart(bytes: &[u8], format: Format, path: Option<&Path>) -> Result<Unplaced, FileError> {
    apart::read(Opened::new(bytes, format, path)?, path)
}

/// The JSON of a binary file, and the bytes of its buffer.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), FileError> {
    let word = |at: usize| bytes.get(at..at + 4).and_then(|w| w.try_into().ok()).map(u32::from_le_bytes);
    let truncated = |expected: &str| {
        let found = format!("the file ends after {} bytes", bytes.len());
        FileError::byte(bytes.len(), FileProblem::truncated(expected, found))
    };
    if !bytes.starts_with(MAGIC) {
        let found = super::text::quoted(&bytes[..bytes.len().min(4)]);
        return Err(FileError::byte(0, FileProblem::syntax("`glTF`", found)));
    }
    let version = word(4).ok_or_else(|| truncated("a version"))?;
    if version != 2 {
        return Err(FileError::byte(4, other_version(&format!("version {version}"))));
    }
    let length = word(8).ok_or_else(|| truncated("a length"))? as usize;
    let whole = bytes.get(..length).ok_or_else(|| truncated(&format!("{length} bytes (bytes 8 to 11 say so)")))?;
    let mut chunks = [None; 2];
    let mut rest = whole.get(12..).unwrap_or_default();
    while let Some((head, tail)) = rest.split_at_checked(8) {
        let size = u32::from_le_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let (body, after) = tail.split_at_checked(size).ok_or_else(|| truncated("a whole chunk"))?;
        let slot = if &head[4..] == JSON_CHUNK { Some(0) } else { (&head[4..] == BINARY_CHUNK).then_some(1) };
        if let Some(slot) = slot {
            chunks[slot] = chunks[slot].or(Some(body));
        }
        rest = after;
    }
    let json = chunks[0].ok_or_else(|| FileError::byte(12, FileProblem::syntax("a JSON chunk", "none")))?;
    Ok((json, chunks[1]))
}

/// A document that can be read, and its buffers.
struct Opened<'a> {
    format: Format,
    text: &'a [u8],
    document: Document,
    /// What it requires and is left out.
    looks: Option<String>,
    instancing: Instancing,
    buffers: Buffers<'a>,
    allowance: Expansion,
}

impl<'a> Opened<'a> {
    fn new(bytes: &'a [u8], format: Format, path: Option<&Path>) -> Result<Self, FileError> {
        let (text, binary) = match format {
            Format::Glb => chunks(bytes)?,
            _ => (bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), None),
        };
        // An empty object, two bytes, becomes hundreds of bytes in memory; in real files each has members.
        let (objects, limit) = (text.iter().filter(|&&b| b == b'{').count(), 1024 + text.len() / 8);
        if objects > limit {
            return Err(FileProblem::TooLarge { what: "JSON objects", limit: limit as u64 }.into());
        }
        check_version(text)?;
        let root: json::Root = json::deserialize::from_slice(text).map_err(|e| not_gltf(&e))?;
        let document = Document::from_json_without_validation(root);
        let looks = check_required(&document)?;
        let instancing = Instancing::read(&document, text).map_err(|e| not_gltf(&e))?;
        let buffers = Buffers::load(&document, binary, path)?;
        let allowance = Expansion::for_input(bytes.len().max(buffers.bytes()) as u64);
        Ok(Self { format, text, document, looks, instancing, buffers, allowance })
    }

    fn read(mut self, path: Option<&Path>) -> Result<Loaded, FileError> {
        let mut soup = scene::read(&self.document, &self.instancing, &self.buffers, &mut self.allowance, path)?;
        soup.warnings.extend(self.looks.take());
        soup.finish(self.format, Some(unit(&self.document, self.text)))
    }
}

/// The version that a document states.
#[derive(serde::Deserialize)]
struct Stated {
    asset: Option<StatedAsset>,
}

#[derive(serde::Deserialize)]
struct StatedAsset {
    version: Option<serde_json::Value>,
}

/// Refuses documents of version 1, which are laid out otherwise throughout.
fn check_version(text: &[u8]) -> Result<(), FileError> {
    // What is no JSON at all is told by the reader of the whole.
    let Ok(stated) = serde_json::from_slice::<Stated>(text) else { return Ok(()) };
    let version = match stated.asset.and_then(|asset| asset.version) {
        Some(serde_json::Value::String(version)) => format!("version {version}"),
        Some(serde_json::Value::Number(version)) => format!("version {version}"),
        _ => "a document without a version, as version 1.0 has it,".to_owned(),
    };
    if version.starts_with("version 2") { Ok(()) } else { Err(FileError::item("asset", other_version(&version))) }
}

fn other_version(found: &str) -> FileProblem {
    FileProblem::Unsupported(format!(
        "glTF {found} is not read here, only version 2.0; convert it to glTF 2.0 or GLB, or export it again"
    ))
}

/// Refuses a document that requires an extension that is not read. Returns a sentence on those that concern looks alone.
fn check_required(document: &Document) -> Result<Option<String>, FileError> {
    let unread = |name: &&str| !READ.contains(name);
    let of_looks = |name: &str| OF_LOOKS.iter().any(|start| name.starts_with(start));
    let unread: Vec<&str> = document.extensions_required().filter(unread).collect();
    if let Some(name) = unread.iter().find(|name| !of_looks(name)) {
        let compressed = name.contains("compression");
        let why = if compressed { "its mesh data is compressed and" } else { "it" };
        let problem = FileProblem::Unsupported(format!(
            "{why} requires the extension {}, which is not read here; export without it",
            super::text::quoted(name.as_bytes())
        ));
        return Err(FileError::item("extensionsRequired", problem));
    }
    Ok((!unread.is_empty()).then(|| format!("required extensions on looks left out: {}", unread.join(", "))))
}

fn not_gltf(error: &json::Error) -> FileError {
    let found = error.to_string();
    match error.line() {
        0 => FileError::new(FileProblem::syntax("glTF in JSON", found)),
        line => FileError::line(line, FileProblem::syntax("glTF in JSON", found)),
    }
}

/// The note that the writer of earlier versions left in `asset.extras`, with the numbers in that unit.
#[derive(serde::Deserialize)]
struct Noted {
    asset: NotedAsset,
}

#[derive(serde::Deserialize)]
struct NotedAsset {
    extras: Note,
}

#[derive(serde::Deserialize)]
struct Note {
    unit: String,
}

/// Metres, as the specification says, unless an earlier version of this program has noted otherwise.
fn unit(document: &Document, text: &[u8]) -> Unit {
    let own = document.as_json().asset.generator.as_deref() == Some(env!("CARGO_PKG_NAME"));
    let noted = own.then(|| serde_json::from_slice::<Noted>(text).ok()).flatten();
    noted.and_then(|noted| noted.asset.extras.unit.parse().ok()).unwrap_or(Unit::Metre)
}
