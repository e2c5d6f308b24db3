//! The archive's header, the grids in it and their metadata.

use super::super::format::VDB_MAGIC as MAGIC;
use super::super::numbers::Kind;
use super::cursor::Cursor;
use super::{HALF, TREES};
use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

/// The versions whose layout is known here.
const VERSIONS: std::ops::RangeInclusive<u32> = 222..=224;
/// Characters of the identifier that every file has.
const UUID: usize = 36;

/// A grid in a file, as far as its descriptor and metadata tell.
pub(super) struct Grid<'a> {
    pub(super) name: String,
    /// How a number is stored outside the buffers of values.
    pub(super) number: Kind,
    /// How a number is stored within them.
    pub(super) stored: Kind,
    /// Flags of compression.
    pub(super) compression: u32,
    pub(super) metadata: Metadata<'a>,
    /// After the metadata: the transform.
    pub(super) rest: Cursor<'a>,
    /// Where the buffers begin; `None` in a stream, where they follow the topology.
    pub(super) buffers: Option<Cursor<'a>>,
}

/// Names, types and values.
pub(super) struct Metadata<'a>(Vec<(String, String, &'a [u8])>);

impl Metadata<'_> {
    fn value(&self, name: &str, kind: &str) -> Option<&[u8]> {
        self.0.iter().find(|(n, k, _)| n == name && k == kind).map(|(.., value)| *value)
    }

    pub(super) fn text(&self, name: &str) -> Option<String> {
        self.value(name, "string").map(|value| String::from_utf8_lossy(value).into_owned())
    }

    pub(super) fn double(&self, name: &str) -> Option<f64> {
        Some(f64::from_le_bytes(self.value(name, "double")?.try_into().ok()?))
    }

    pub(super) fn voxel(&self, name: &str) -> Option<[i32; 3]> {
        let words = self.value(name, "vec3i")?.as_chunks::<4>().0;
        words.iter().map(|word| i32::from_le_bytes(*word)).collect::<Vec<_>>().try_into().ok()
    }
}

/// A descriptor.
struct Descriptor {
    name: String,
    tree: String,
    parent: String,
    places: [i64; 3],
}

/// The grid to read, and the names of the others.
pub(super) fn grid(bytes: &[u8]) -> Result<(Grid<'_>, Vec<String>), FileError> {
    let mut cursor = Cursor::new(bytes);
    let (count, places) = archive(&mut cursor)?;
    let (mut found, mut others): (Option<Grid<'_>>, Vec<String>) = (None, Vec::new());
    for _ in 0..count {
        let descriptor = descriptor(&mut cursor)?;
        let name = plain_name(&descriptor.name);
        if !places {
            // Without places there is no way past a grid that is not understood: the first must do.
            if count > 1 {
                others.push("whatever follows in the stream".to_owned());
            }
            return described(&descriptor, cursor.clone(), None).map(|grid| (grid, others));
        }
        let start = cursor.moved(descriptor.places[0], "the grid")?;
        let end = cursor.moved(descriptor.places[2], "the end of the grid")?;
        if kinds(&descriptor.tree).is_some() && descriptor.parent.is_empty() {
            let buffers = cursor.moved(descriptor.places[1], "the values")?;
            let grid = described(&descriptor, start, Some(buffers))?;
            let better = |old: &Grid<'_>| !is_level_set(old) && is_level_set(&grid);
            if found.as_ref().is_none_or(better) {
                others.extend(found.replace(grid).map(|old| old.name));
            } else {
                others.push(name);
            }
        } else {
            others.push(name);
        }
        if end.at() <= cursor.at() {
            return Err(cursor.wrong("the end of the grid after its beginning", end.at().to_string()));
        }
        cursor = end;
    }
    let none = || {
        let text = format!(
            "it has no grid of floats: {}",
            if others.is_empty() { "none at all".into() } else { others.join(", ") }
        );
        FileProblem::Unsupported(text).at_item("grids")
    };
    Ok((found.ok_or_else(none)?, others))
}

/// Reads up to the first descriptor: the number of grids, and whether descriptors say where they are.
fn archive(cursor: &mut Cursor<'_>) -> Result<(u32, bool), FileError> {
    cursor.take(MAGIC.len(), "the beginning of an OpenVDB file")?;
    let version = cursor.u32("the version")?;
    if !VERSIONS.contains(&version) {
        let (first, last) = (VERSIONS.start(), VERSIONS.end());
        let text =
            format!("version {version} of the format is not read here, {first} to {last} are: save it with OpenVDB 10");
        return Err(FileProblem::Unsupported(text).at_byte(MAGIC.len()));
    }
    cursor.take(8, "the version of the library")?;
    let places = cursor.u8("whether the file has places")? != 0;
    cursor.take(UUID, "the identifier of the file")?;
    metadata(cursor)?;
    Ok((cursor.u32("the number of grids")?, places))
}

fn descriptor(cursor: &mut Cursor<'_>) -> Result<Descriptor, FileError> {
    let name = cursor.text("the name of a grid")?;
    let tree = cursor.text("the type of a grid")?;
    let parent = cursor.text("the name of a grid's parent")?;
    let mut place = || cursor.i64("a place of a grid");
    Ok(Descriptor { name, tree, parent, places: [place()?, place()?, place()?] })
}

fn described<'a>(
    descriptor: &Descriptor,
    mut cursor: Cursor<'a>,
    buffers: Option<Cursor<'a>>,
) -> Result<Grid<'a>, FileError> {
    let wrong = || cursor.wrong("a tree of floats of nodes 5, 4 and 3", quoted(descriptor.tree.as_bytes()));
    let (number, stored) = kinds(&descriptor.tree).ok_or_else(wrong)?;
    let compression = cursor.u32("the flags of compression")?;
    let metadata = metadata(&mut cursor)?;
    let name = plain_name(&descriptor.name);
    Ok(Grid { name, number, stored, compression, metadata, rest: cursor, buffers })
}

fn metadata<'a>(cursor: &mut Cursor<'a>) -> Result<Metadata<'a>, FileError> {
    const WHAT: &str = "metadata";
    let count = cursor.u32(WHAT)?;
    let mut pairs = Vec::new();
    for _ in 0..count {
        let (name, kind) = (cursor.text(WHAT)?, cursor.text(WHAT)?);
        let size = cursor.u32(WHAT)? as usize;
        pairs.push((name, kind, cursor.take(size, WHAT)?));
    }
    Ok(Metadata(pairs))
}

/// How a tree of this type stores a number outside and within buffers; `None` for other trees.
fn kinds(tree: &str) -> Option<(Kind, Kind)> {
    let (plain, half) = tree.strip_suffix(HALF).map_or((tree, false), |plain| (plain, true));
    let number = [Kind::F32, Kind::F64].into_iter().zip(TREES).find(|(_, name)| *name == plain)?.0;
    Some((number, if half { Kind::F16 } else { number }))
}

pub(super) fn is_level_set(grid: &Grid<'_>) -> bool {
    grid.metadata.text("class").is_some_and(|class| class == "level set")
}

/// Grids of one name are told apart by a number after this character.
fn plain_name(name: &str) -> String {
    name.split('\u{1e}').next().unwrap_or_default().to_owned()
}
