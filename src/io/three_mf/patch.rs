//! Writing a scene of 3MF: the package as it is, with other triangles in the objects that were replaced.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Cursor, Write};
use std::ops::Range;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use super::super::error::WriteError;
use super::super::scene::{MaterialOrigin, Origin, Scene, SceneObject};
use super::super::text::TextOut;
use super::object::{Look, Written};
use super::package::Package;
use super::roles::{Roles, Volume};
use super::splice::{Found, Splices, scan, tag};
use super::write::write_vertices;
use super::xml::attribute;

/// The name space of groups of colours and of places on images.
const MATERIALS: &[u8] = b"http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

/// The replaced objects of a model, by number: the pieces with their numbers.
type Edits<'a> = BTreeMap<u32, Vec<(Option<usize>, &'a SceneObject)>>;

/// The first and the last triangle of each volume of an object; nothing where it has none.
type OwnRanges = Vec<Option<(usize, usize)>>;

/// New ranges of the volumes of objects, by the number of the object.
type Ranges = BTreeMap<u32, OwnRanges>;

/// Writes the package of a scene with the objects that were replaced.
pub(in crate::io) fn write_patched(scene: &Scene, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut models: BTreeMap<&str, Edits<'_>> = BTreeMap::new();
    for object in scene.objects.iter().filter(|object| object.is_replaced) {
        let Origin::Object { model, id, piece } = &object.origin else { continue };
        models.entry(model).or_default().entry(*id).or_default().push((*piece, object));
    }
    let mut package = Package::open(&scene.bytes).map_err(io::Error::other)?;
    let root = package.root_model().map_err(io::Error::other)?;
    let roles = Roles::read(&mut package);
    let mut changed: BTreeMap<usize, Vec<u8>> = BTreeMap::new();
    let mut ranges = Ranges::new();
    for (name, edits) in &models {
        let number = package.find(name).ok_or_else(|| io::Error::other("the package has changed"))?;
        let text = package.read_bytes(name).map_err(io::Error::other)?;
        let no_volumes = Roles::default();
        let roles = if *name == root { &roles } else { &no_volumes };
        let patch = ModelPatch { scene, text: &text, edits, roles };
        changed.insert(number, patch.applied(&mut ranges)?);
    }
    if !ranges.is_empty() {
        let mut met = BTreeMap::new();
        for name in Roles::files(&package) {
            let (Some(number), Ok(text)) = (package.find(&name), package.read_bytes(&name)) else { continue };
            if let Some(text) = with_ranges(&text, &ranges, &mut met).map_err(io::Error::other)? {
                changed.insert(number, text);
            }
        }
    }
    copy(&scene.bytes, &changed, out)
}

/// Copies a package with other content of some files.
fn copy(bytes: &[u8], changed: &BTreeMap<usize, Vec<u8>>, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(io::Error::from)?;
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default());
    for number in 0..archive.len() {
        let file = archive.by_index_raw(number).map_err(io::Error::from)?;
        let Some(text) = changed.get(&number) else {
            zip.raw_copy_file(file).map_err(io::Error::from)?;
            continue;
        };
        let name = file.name().to_owned();
        drop(file);
        zip.start_file(name, options.large_file(text.len() > u32::MAX as usize)).map_err(io::Error::from)?;
        zip.write_all(text)?;
    }
    let bytes = zip.finish().map_err(io::Error::from)?.into_inner();
    Ok(out.write_all(&bytes)?)
}

/// A model that is being changed.
struct ModelPatch<'a> {
    scene: &'a Scene,
    text: &'a [u8],
    edits: &'a Edits<'a>,
    roles: &'a Roles,
}

/// Where an object stands in its model.
#[derive(Default)]
struct Place {
    /// Its start tag.
    start: Range<usize>,
    /// What stands before the names of elements: nothing, or `c:`.
    prefix: String,
    /// What is within the tags of its mesh.
    content: Range<usize>,
    vertices: Vec<Range<usize>>,
    triangles: Vec<Range<usize>>,
}

/// What is found in a model.
#[derive(Default)]
struct Survey {
    /// The start tag of the model.
    root: Range<usize>,
    /// Whether the prefix `m` is that of materials, or free.
    m: Option<bool>,
    largest: u32,
    /// The objects that are to change; of several with one number the last.
    objects: BTreeMap<u32, Place>,
}

impl ModelPatch<'_> {
    fn survey(&self) -> Result<Survey, quick_xml::Error> {
        let mut survey = Survey::default();
        let mut open: Option<(u32, Place)> = None;
        let mut in_mesh = false;
        scan(self.text, |found, range| match found {
            Found::Start(element, is_empty) => match (element.local_name().as_ref(), &mut open) {
                (b"vertex", Some((_, place))) if in_mesh => place.vertices.push(range),
                (b"triangle", Some((_, place))) if in_mesh => place.triangles.push(range),
                (b"vertex" | b"triangle", _) => {}
                (b"mesh", Some((_, place))) if !is_empty => {
                    in_mesh = true;
                    place.content = range.end..range.end;
                    let prefix = element.name().prefix().map(|prefix| prefix.as_ref().to_vec()).unwrap_or_default();
                    place.prefix = String::from_utf8_lossy(&prefix).into_owned();
                    if !place.prefix.is_empty() {
                        place.prefix.push(':');
                    }
                }
                (name, _) => {
                    if name == b"model" && survey.root.is_empty() {
                        survey.root = range.clone();
                        survey.m = attribute_of(element, b"xmlns:m").map(|address| *address == *MATERIALS);
                    }
                    let id =
                        attribute(element, b"id").and_then(|id| std::str::from_utf8(&id).ok()?.trim().parse().ok());
                    survey.largest = survey.largest.max(id.unwrap_or(0));
                    if let (b"object", Some(id)) = (name, id.filter(|id| self.edits.contains_key(id)))
                        && !is_empty
                    {
                        open = Some((id, Place { start: range, ..Place::default() }));
                    }
                }
            },
            Found::End(name) => match (name.as_slice(), &mut open) {
                (b"mesh", Some((_, place))) => {
                    in_mesh = false;
                    place.content.end = range.start;
                }
                (b"object", _) => survey.objects.extend(open.take()),
                _ => {}
            },
            Found::Other => {}
        })?;
        Ok(survey)
    }

    /// The model with the new meshes. `ranges` gets the new ranges of volumes.
    fn applied(&self, ranges: &mut Ranges) -> io::Result<Vec<u8>> {
        let survey = self.survey().map_err(io::Error::other)?;
        let mut splices = Splices::default();
        let mut next = survey.largest.saturating_add(1);
        let mut needs_m = false;
        for (&id, pieces) in self.edits {
            let place = survey.objects.get(&id).ok_or_else(|| io::Error::other("the package has changed"))?;
            let written = pieces.iter().map(|&(piece, object)| {
                (piece, object, Written::new(object, |t| look(self.scene, object, t), &mut next))
            });
            let written: Vec<_> = written.collect();
            let mut groups = Vec::new();
            let mut text = TextOut::new(&mut groups);
            written.iter().try_for_each(|(_, _, written)| written.write_groups(&mut text))?;
            text.finish()?;
            needs_m |= written.iter().any(|(_, _, written)| written.has_groups());
            if !groups.is_empty() {
                splices.put(place.start.start..place.start.start, groups);
            }
            let volumes = self.roles.volumes(id);
            let (content, own) = self.content(place, volumes, &written)?;
            splices.put(place.content.clone(), content);
            if !volumes.is_empty() {
                ranges.insert(id, own);
            }
        }
        if needs_m && survey.m != Some(true) {
            // The prefix may stand for something else in a part of the model; the groups are right before objects.
            let address = String::from_utf8_lossy(MATERIALS).into_owned();
            splices.put(survey.root.clone(), self.changed_tag(&survey.root, &[("xmlns:m", address)])?);
        }
        Ok(splices.applied_to(self.text))
    }

    /// The start tag at a place with other attributes.
    fn changed_tag(&self, range: &Range<usize>, changes: &[(&str, String)]) -> io::Result<Vec<u8>> {
        let mut changed = None;
        let piece = self.text.get(range.clone()).unwrap_or_default();
        // Alone, a start tag has no end; it comes before the reader misses that.
        let _ = scan(piece, |found, _| {
            if let Found::Start(element, is_empty) = found {
                changed = Some(tag(element, *is_empty, changes));
            }
        });
        changed.ok_or_else(|| io::Error::other("the package has changed"))
    }

    /// What is within the tags of a mesh, and the new ranges of its volumes.
    fn content(
        &self,
        place: &Place,
        volumes: &[Volume],
        written: &[(Option<usize>, &SceneObject, Written<'_>)],
    ) -> io::Result<(Vec<u8>, OwnRanges)> {
        let count = place.triangles.len();
        let mut taken = vec![false; count];
        let mut given: Vec<Vec<usize>> = volumes
            .iter()
            .map(|volume| {
                let numbers = volume.triangles.clone().take_while(|t| *t < count);
                numbers.filter(|&t| !std::mem::replace(&mut taken[t], true)).collect()
            })
            .collect();
        given.push((0..count).filter(|&t| !taken[t]).collect());
        let new = |piece: usize| {
            written.iter().find(|(own, ..)| own.is_none_or(|own| own == piece)).map(|(_, object, new)| (*object, new))
        };
        let raw = self.raw(place, given.iter().enumerate().filter(|(piece, _)| new(*piece).is_none()))?;
        let p = place.prefix.as_str();
        let mut content = Vec::new();
        let mut text = TextOut::new(&mut content);
        text.text(&format!("\n<{p}vertices>\n"));
        let (mut first, mut firsts) = (0, Vec::new());
        for piece in 0..given.len() {
            firsts.push(first);
            if let Some((object, _)) = new(piece) {
                write_vertices(&object.mesh, p, &mut text)?;
                first += object.mesh.positions.len();
            }
        }
        raw.write_vertices(self.text, place, &mut text)?;
        text.text(&format!("</{p}vertices>\n<{p}triangles>\n"));
        let (mut at, mut ranges) = (0, Vec::new());
        for (piece, numbers) in given.iter().enumerate() {
            let count = match new(piece) {
                Some((object, new)) => {
                    new.write_triangles(firsts[piece], p, &mut text)?;
                    object.mesh.triangles.len()
                }
                None => {
                    raw.write_triangles(self.text, place, first, numbers, &mut text)?;
                    numbers.len()
                }
            };
            ranges.push((count > 0).then(|| (at, at + count - 1)));
            at += count;
        }
        text.text(&format!("</{p}triangles>\n"));
        text.finish()?;
        ranges.truncate(volumes.len());
        Ok((content, ranges))
    }

    /// The triangles that stay as they are, and their vertices.
    fn raw<'b>(&self, place: &Place, pieces: impl Iterator<Item = (usize, &'b Vec<usize>)>) -> io::Result<Raw> {
        let mut corners = BTreeMap::new();
        for &t in pieces.flat_map(|(_, numbers)| numbers) {
            let piece = self.text.get(place.triangles[t].clone()).unwrap_or_default();
            let mut own = None;
            let _ = scan(piece, |found, _| {
                if let Found::Start(element, _) = found {
                    let corner =
                        |name: &[u8]| std::str::from_utf8(&attribute(element, name)?).ok()?.trim().parse().ok();
                    own = Some([corner(b"v1"), corner(b"v2"), corner(b"v3")]);
                }
            });
            let Some([Some(a), Some(b), Some(c)]) = own else {
                return Err(io::Error::other("the package has changed"));
            };
            corners.insert(t, [a, b, c]);
        }
        let vertices: BTreeSet<usize> = corners.values().flatten().copied().collect();
        let numbers = vertices.iter().enumerate().map(|(n, &vertex)| (vertex, n)).collect();
        Ok(Raw { corners, numbers })
    }
}

/// Triangles that stay as they are.
struct Raw {
    /// Their old vertices, by their old numbers.
    corners: BTreeMap<usize, [usize; 3]>,
    /// New numbers of vertices among those that stay, by the old ones.
    numbers: BTreeMap<usize, usize>,
}

impl Raw {
    fn write_vertices(&self, old: &[u8], place: &Place, text: &mut TextOut<'_>) -> io::Result<()> {
        for &vertex in self.numbers.keys() {
            let range = place.vertices.get(vertex).cloned().unwrap_or_default();
            write_element(old, range, &[], text);
            text.pass_on()?;
        }
        Ok(())
    }

    fn write_triangles(
        &self,
        old: &[u8],
        place: &Place,
        first: usize,
        numbers: &[usize],
        text: &mut TextOut<'_>,
    ) -> io::Result<()> {
        for t in numbers {
            let Some(corners) = self.corners.get(t) else { continue };
            let [a, b, c] = corners.map(|v| (first + self.numbers.get(&v).copied().unwrap_or_default()).to_string());
            write_element(old, place.triangles[*t].clone(), &[("v1", a), ("v2", b), ("v3", c)], text);
            text.pass_on()?;
        }
        Ok(())
    }
}

/// Writes an element that has no content, with other attributes.
fn write_element(old: &[u8], range: Range<usize>, changes: &[(&str, String)], text: &mut TextOut<'_>) {
    let _ = scan(old.get(range).unwrap_or_default(), |found, _| {
        if let Found::Start(element, _) = found {
            text.text(&String::from_utf8_lossy(&tag(element, true, changes)));
            text.text("\n");
        }
    });
}

fn attribute_of<'a>(element: &'a quick_xml::events::BytesStart<'_>, name: &[u8]) -> Option<std::borrow::Cow<'a, [u8]>> {
    let mut attributes = element.attributes();
    attributes.with_checks(false).flatten().find(|attribute| attribute.key.as_ref() == name).map(|found| found.value)
}

/// What a triangle has in the model.
fn look(scene: &Scene, object: &SceneObject, triangle: usize) -> Look {
    match scene.material_of(object, triangle).map(|(_, material)| material.origin) {
        Some(MaterialOrigin::Entry { group, entry }) => Look::Entry { group, entry },
        Some(MaterialOrigin::Picture(image)) => Look::Picture(image),
        Some(MaterialOrigin::Blend) if object.colours.is_some() => Look::Colours,
        _ => Look::Inherited,
    }
}

/// A file of a slicer with the new ranges of volumes; `None` where there is nothing to change. `met`: how many volumes of each object came
/// before.
fn with_ranges(
    text: &[u8],
    ranges: &Ranges,
    met: &mut BTreeMap<u32, usize>,
) -> Result<Option<Vec<u8>>, quick_xml::Error> {
    let mut splices = Splices::default();
    let mut object = None;
    let mut any = false;
    scan(text, |found, range| match found {
        Found::Start(element, is_empty) => match element.local_name().as_ref() {
            b"object" => {
                object = attribute(element, b"id").and_then(|id| std::str::from_utf8(&id).ok()?.trim().parse().ok());
            }
            b"volume" | b"part"
                if attribute(element, b"firstid").is_some() && attribute(element, b"lastid").is_some() =>
            {
                let Some(own) = object.and_then(|id: u32| Some((id, ranges.get(&id)?))) else { return };
                let number = met.entry(own.0).or_insert(0);
                if let Some((first, last)) = own.1.get(*number).copied().flatten() {
                    let changes = [("firstid", first.to_string()), ("lastid", last.to_string())];
                    splices.put(range, tag(element, *is_empty, &changes));
                    any = true;
                }
                *number += 1;
            }
            _ => {}
        },
        Found::End(name) if name == b"object" => object = None,
        _ => {}
    })?;
    Ok(any.then(|| splices.applied_to(text)))
}
