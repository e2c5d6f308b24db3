//! A model file: unit, objects, build.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec3};
use quick_xml::events::{BytesStart, Event};

use super::super::error::ReadProblem;
use super::super::text::{Words, integer, number, quoted};
use super::package::{Xml, XmlError};
use crate::io::Unit;

/// A model file as read.
pub(super) struct Model {
    /// Its name in the package.
    pub(super) name: String,
    pub(super) unit: Unit,
    pub(super) objects: BTreeMap<u32, Object>,
    /// What the build places.
    pub(super) items: Vec<Placed>,
}

impl Model {
    /// The objects that are no component of another, as they stand.
    pub(super) fn free_objects(&self) -> Vec<Placed> {
        let components = self.objects.values().flat_map(|object| &object.components);
        let used: BTreeSet<u32> = components.filter(|c| c.path.is_none()).map(|c| c.object).collect();
        let free = self.objects.keys().filter(|id| !used.contains(id));
        free.map(|&object| Placed { object, path: None, transform: DAffine3::IDENTITY }).collect()
    }
}

/// A mesh, or components, or both.
#[derive(Default)]
pub(super) struct Object {
    pub(super) name: String,
    pub(super) vertices: Vec<DVec3>,
    /// Indices into `vertices`, in range.
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) components: Vec<Placed>,
}

/// An object under a transform.
#[derive(Clone)]
pub(super) struct Placed {
    pub(super) object: u32,
    /// The model file that has the object, if it is another one.
    pub(super) path: Option<String>,
    pub(super) transform: DAffine3,
}

/// Reads the model file `name`.
pub(super) fn parse(xml: &mut Xml<'_>, name: &str) -> Result<Model, XmlError> {
    let mut model =
        Model { name: name.to_owned(), unit: Unit::Millimetre, objects: BTreeMap::new(), items: Vec::new() };
    let mut object: Option<(u32, Object)> = None;
    let mut in_mesh = false;
    let mut whole = false;
    loop {
        match xml.event()? {
            Event::Eof if whole => return Ok(model),
            Event::Eof => return Err(ReadProblem::truncated("`</model>`", "the file ends").into()),
            Event::Start(e) => match (e.local_name().as_ref(), &mut object) {
                (b"model", _) => model.unit = unit(&e)?,
                (b"object", _) => object = Some((id(&e, b"id")?, Object { name: name_of(&e), ..Object::default() })),
                (b"mesh", Some(_)) => in_mesh = true,
                (b"vertex", Some((_, object))) if in_mesh => object.vertices.push(vertex(&e)?),
                (b"triangle", Some((_, object))) if in_mesh => {
                    let triangle = triangle(&e, object.vertices.len())?;
                    object.triangles.push(triangle);
                }
                (b"component", Some((_, object))) => object.components.push(placed(&e)?),
                (b"item", None) => model.items.push(placed(&e)?),
                _ => {}
            },
            Event::End(e) => match e.local_name().as_ref() {
                b"mesh" => in_mesh = false,
                b"object" => {
                    if let Some((id, object)) = object.take() {
                        model.objects.insert(id, object);
                    }
                }
                b"model" => whole = true,
                _ => {}
            },
            _ => {}
        }
    }
}

/// The raw value of an attribute, by its name without a prefix.
pub(super) fn attribute<'a>(element: &'a BytesStart<'_>, name: &[u8]) -> Option<Cow<'a, [u8]>> {
    let mut attributes = element.attributes();
    // The check for repeated names takes time that grows with the square of their number.
    let found = attributes.with_checks(false).flatten().find(|a| a.key.local_name().as_ref() == name);
    found.map(|a| a.value)
}

/// An attribute's value with its entities replaced, where it has none that are unknown.
pub(super) fn text(value: &[u8]) -> String {
    let raw = String::from_utf8_lossy(value);
    quick_xml::escape::unescape(&raw).map(Cow::into_owned).unwrap_or_else(|_| raw.clone().into_owned())
}

fn needed<'a>(element: &'a BytesStart<'_>, name: &[u8]) -> Result<Cow<'a, [u8]>, ReadProblem> {
    let place = String::from_utf8_lossy(element.local_name().into_inner()).into_owned();
    attribute(element, name).ok_or_else(|| {
        let expected = format!("an attribute `{}` of `{place}`", String::from_utf8_lossy(name));
        ReadProblem::syntax(expected, "none")
    })
}

fn name_of(element: &BytesStart<'_>) -> String {
    attribute(element, b"name").map(|value| text(&value)).unwrap_or_default()
}

fn unit(element: &BytesStart<'_>) -> Result<Unit, ReadProblem> {
    match attribute(element, b"unit") {
        None => Ok(Unit::Millimetre),
        Some(value) => {
            text(&value).parse().map_err(|_| ReadProblem::syntax("a unit such as `millimeter`", quoted(&value)))
        }
    }
}

fn id(element: &BytesStart<'_>, name: &[u8]) -> Result<u32, ReadProblem> {
    let value = needed(element, name)?;
    let id = integer(value.trim_ascii()).and_then(|id| u32::try_from(id).ok());
    id.ok_or_else(|| ReadProblem::syntax("the number of an object", quoted(&value)))
}

fn coordinate(value: &[u8]) -> Result<f64, ReadProblem> {
    let found = number(value.trim_ascii()).ok_or_else(|| ReadProblem::syntax("a coordinate", quoted(value)))?;
    if found.is_finite() { Ok(found) } else { Err(ReadProblem::NotFinite { found: quoted(value) }) }
}

fn vertex(element: &BytesStart<'_>) -> Result<DVec3, ReadProblem> {
    let mut p = DVec3::ZERO;
    for (k, name) in [b"x", b"y", b"z"].into_iter().enumerate() {
        p[k] = coordinate(&needed(element, name)?)?;
    }
    Ok(p)
}

fn triangle(element: &BytesStart<'_>, count: usize) -> Result<[u32; 3], ReadProblem> {
    let mut t = [0; 3];
    for (v, name) in t.iter_mut().zip([b"v1", b"v2", b"v3"]) {
        let value = needed(element, name)?;
        let index =
            integer(value.trim_ascii()).ok_or_else(|| ReadProblem::syntax("a vertex number", quoted(&value)))?;
        let in_range = u32::try_from(index).ok().filter(|&v| (v as usize) < count);
        *v = in_range.ok_or_else(|| ReadProblem::vertex(index, count))?;
    }
    Ok(t)
}

fn placed(element: &BytesStart<'_>) -> Result<Placed, ReadProblem> {
    let transform = match attribute(element, b"transform") {
        Some(value) => transform(&value)?,
        None => DAffine3::IDENTITY,
    };
    let path = attribute(element, b"path").map(|value| text(&value));
    Ok(Placed { object: id(element, b"objectid")?, path, transform })
}

/// Twelve numbers: the images of the three axes, then of the origin.
fn transform(value: &[u8]) -> Result<DAffine3, ReadProblem> {
    let numbers = Words::new(value).map(coordinate).collect::<Result<Vec<_>, _>>()?;
    let numbers: [f64; 12] =
        numbers.try_into().map_err(|_| ReadProblem::syntax("twelve numbers of a transform", quoted(value)))?;
    Ok(DAffine3::from_cols_array(&numbers))
}
