//! A model file: unit, objects, build.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec3};
use quick_xml::events::{BytesStart, Event};

use super::super::colour::Rgba;
use super::super::error::FileProblem;
use super::super::text::{Words, integer, number, quoted, single};
use super::extensions::Extensions;
use super::roles::Role;
use super::xml::{Xml, XmlError, attribute, text};
use crate::io::Unit;

/// The number of an image, and places on it.
pub(super) type Places = (u32, Vec<[f32; 2]>);

/// A model file as read.
pub(super) struct Model {
    /// Its name in the package.
    pub(super) name: String,
    pub(super) unit: Unit,
    pub(super) objects: BTreeMap<u32, Object>,
    /// Groups of colours and of base materials: the colours of their entries.
    pub(super) groups: BTreeMap<u32, Vec<Rgba>>,
    /// The names of the entries of groups of base materials.
    pub(super) names: BTreeMap<u32, Vec<String>>,
    /// The files of images.
    pub(super) textures: BTreeMap<u32, String>,
    /// Groups of places on an image: the image, and the places of their entries.
    pub(super) places: BTreeMap<u32, Places>,
    /// What the build places.
    pub(super) items: Vec<Placed>,
    pub(super) extensions: Extensions,
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
pub(super) struct Object {
    pub(super) name: String,
    pub(super) vertices: Vec<DVec3>,
    /// Indices into `vertices`, in range.
    pub(super) triangles: Vec<[u32; 3]>,
    /// What the triangles have of their own; triangles after the last have nothing.
    pub(super) properties: Vec<Option<Property>>,
    /// What the triangles that have nothing of their own get.
    pub(super) default: Option<Property>,
    pub(super) components: Vec<Placed>,
    /// What the object is for, by its type and its settings.
    pub(super) role: Role,
    /// Whether triangles have something that is not read, as slicers paint it on them.
    pub(super) is_painted: bool,
    /// Whether the mesh has something beside vertices and triangles.
    pub(super) has_more: bool,
}

impl Object {
    fn add_triangle(&mut self, element: &BytesStart<'_>) -> Result<(), FileProblem> {
        let triangle = triangle(element, self.vertices.len())?;
        if let Some(property) = property(element, self.default, &mut self.is_painted)? {
            self.properties.resize(self.triangles.len(), None);
            self.properties.push(Some(property));
        }
        self.triangles.push(triangle);
        Ok(())
    }
}

/// Entries of a group, for the three corners of a triangle. The group may be of another kind than colours, or absent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Property {
    pub(super) group: u32,
    pub(super) entries: [u32; 3],
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
    let mut model = Model {
        name: name.to_owned(),
        unit: Unit::Millimetre,
        objects: BTreeMap::new(),
        groups: BTreeMap::new(),
        names: BTreeMap::new(),
        textures: BTreeMap::new(),
        places: BTreeMap::new(),
        items: Vec::new(),
        extensions: Extensions::default(),
    };
    let mut object: Option<(u32, Object)> = None;
    let mut group: Option<(u32, Vec<Rgba>)> = None;
    let mut places: Option<(u32, Places)> = None;
    let mut in_mesh = false;
    let mut whole = false;
    let mut setting = None;
    loop {
        match xml.event()? {
            Event::Eof if whole => return Ok(model),
            Event::Eof => return Err(FileProblem::truncated("`</model>`", "the file ends").into()),
            Event::Start(e) => match (e.local_name().as_ref(), &mut object) {
                (b"vertex", Some((_, object))) if in_mesh => object.vertices.push(vertex(&e)?),
                (b"triangle", Some((_, object))) if in_mesh => object.add_triangle(&e)?,
                (name, object) => {
                    model.extensions.meet(&e);
                    match (name, object) {
                        (b"model", _) => model.unit = unit(&e)?,
                        (b"object", object) => *object = Some((id(&e, b"id")?, new_object(&e)?)),
                        (b"basematerials" | b"colorgroup", _) => group = Some((id(&e, b"id")?, Vec::new())),
                        (b"texture2d", _) => {
                            model.textures.insert(id(&e, b"id")?, text(&needed(&e, b"path")?));
                        }
                        (b"texture2dgroup", _) => places = Some((id(&e, b"id")?, (id(&e, b"texid")?, Vec::new()))),
                        (b"tex2coord", _) => {
                            if let Some((_, (_, places))) = &mut places {
                                places.push([
                                    single(needed(&e, b"u")?.trim_ascii()),
                                    single(needed(&e, b"v")?.trim_ascii()),
                                ]);
                            }
                        }
                        (b"mesh", Some(_)) => in_mesh = true,
                        (name, Some((_, object))) if in_mesh => {
                            object.has_more |= !matches!(name, b"vertices" | b"triangles");
                        }
                        (b"metadata", Some(_)) => setting = attribute(&e, b"name").and_then(|n| Role::of_cura(&n)),
                        (b"component", Some((_, object))) => object.components.push(placed(&e)?),
                        (b"item", None) => model.items.push(placed(&e)?),
                        (kind @ (b"base" | b"color"), _) => {
                            if let Some((_, colours)) = &mut group {
                                colours.push(colour(&e, if kind == b"base" { b"displaycolor" } else { b"color" })?);
                            }
                            if let (b"base", Some((id, _))) = (kind, &group) {
                                model.names.entry(*id).or_default().push(name_of(&e));
                            }
                        }
                        _ => {}
                    }
                }
            },
            Event::Text(value) => {
                let on = [b"true".as_slice(), b"1"].iter().any(|on| value.trim_ascii().eq_ignore_ascii_case(on));
                if let (Some(role), Some((_, object))) = (setting.take().filter(|_| on), &mut object) {
                    object.role = role;
                }
            }
            Event::End(e) => match e.local_name().as_ref() {
                b"mesh" => in_mesh = false,
                b"object" => {
                    if let Some((id, object)) = object.take() {
                        model.objects.insert(id, object);
                    }
                }
                b"texture2dgroup" => model.places.extend(places.take()),
                b"basematerials" | b"colorgroup" => model.groups.extend(group.take()),
                b"model" => whole = true,
                _ => {}
            },
            _ => {}
        }
    }
}

fn needed<'a>(element: &'a BytesStart<'_>, name: &[u8]) -> Result<Cow<'a, [u8]>, FileProblem> {
    let place = String::from_utf8_lossy(element.local_name().into_inner()).into_owned();
    attribute(element, name).ok_or_else(|| {
        let expected = format!("an attribute `{}` of `{place}`", String::from_utf8_lossy(name));
        FileProblem::syntax(expected, "none")
    })
}

fn name_of(element: &BytesStart<'_>) -> String {
    attribute(element, b"name").map(|value| text(&value)).unwrap_or_default()
}

fn unit(element: &BytesStart<'_>) -> Result<Unit, FileProblem> {
    match attribute(element, b"unit") {
        None => Ok(Unit::Millimetre),
        Some(value) => {
            text(&value).parse().map_err(|_| FileProblem::syntax("a unit such as `millimeter`", quoted(&value)))
        }
    }
}

fn id(element: &BytesStart<'_>, name: &[u8]) -> Result<u32, FileProblem> {
    whole(&needed(element, name)?, "the number of an object")
}

fn whole(value: &[u8], expected: &str) -> Result<u32, FileProblem> {
    let found = integer(value.trim_ascii()).and_then(|number| u32::try_from(number).ok());
    found.ok_or_else(|| FileProblem::syntax(expected, quoted(value)))
}

fn new_object(element: &BytesStart<'_>) -> Result<Object, FileProblem> {
    let number = |name| attribute(element, name).map(|value| whole(&value, "the number of a property")).transpose();
    let entry = number(b"pindex")?.unwrap_or_default();
    let default = number(b"pid")?.map(|group| Property { group, entries: [entry; 3] });
    Ok(Object {
        name: name_of(element),
        vertices: Vec::new(),
        triangles: Vec::new(),
        properties: Vec::new(),
        default,
        components: Vec::new(),
        role: attribute(element, b"type").map_or(Role::Part, |kind| Role::of_type(kind.trim_ascii())),
        is_painted: false,
        has_more: false,
    })
}

/// What a triangle has of its own: an entry for each corner, or one for all, of a group that the object names if the triangle
/// does not. `is_painted` is set where there is more than that.
fn property(
    element: &BytesStart<'_>,
    default: Option<Property>,
    is_painted: &mut bool,
) -> Result<Option<Property>, FileProblem> {
    let mut group = default.map(|property| property.group);
    let mut entries = [None; 3];
    let mut attributes = element.attributes();
    for attribute in attributes.with_checks(false).flatten() {
        let number = || whole(&attribute.value, "the number of a property");
        match attribute.key.local_name().as_ref() {
            b"pid" => group = Some(number()?),
            b"p1" => entries[0] = Some(number()?),
            b"p2" => entries[1] = Some(number()?),
            b"p3" => entries[2] = Some(number()?),
            b"v1" | b"v2" | b"v3" => {}
            _ => *is_painted = true,
        }
    }
    Ok(match (group, entries) {
        (Some(group), [Some(a), Some(b), Some(c)]) => Some(Property { group, entries: [a, b, c] }),
        (Some(group), [Some(a), ..]) => Some(Property { group, entries: [a; 3] }),
        _ => None,
    })
}

/// `#RRGGBB` or `#RRGGBBAA`.
fn colour(element: &BytesStart<'_>, name: &[u8]) -> Result<Rgba, FileProblem> {
    let value = needed(element, name)?;
    let fail = || FileProblem::syntax("a colour such as `#FF8000` or `#FF8000FF`", quoted(&value));
    let digits = value.trim_ascii().strip_prefix(b"#").filter(|d| matches!(d.len(), 6 | 8)).ok_or_else(fail)?;
    let mut rgba = [255; 4];
    for (channel, pair) in rgba.iter_mut().zip(digits.chunks_exact(2)) {
        let [high, low] = [pair[0], pair[1]].map(|digit| char::from(digit).to_digit(16));
        *channel = (16 * high.ok_or_else(fail)? + low.ok_or_else(fail)?) as u8;
    }
    Ok(rgba)
}

fn coordinate(value: &[u8]) -> Result<f64, FileProblem> {
    number(value.trim_ascii()).ok_or_else(|| FileProblem::syntax("a coordinate", quoted(value)))
}

fn finite(value: &[u8]) -> Result<f64, FileProblem> {
    let found = coordinate(value)?;
    if found.is_finite() { Ok(found) } else { Err(FileProblem::NotFinite { found: quoted(value) }) }
}

fn vertex(element: &BytesStart<'_>) -> Result<DVec3, FileProblem> {
    let mut p = DVec3::ZERO;
    for (k, name) in [b"x", b"y", b"z"].into_iter().enumerate() {
        p[k] = coordinate(&needed(element, name)?)?;
    }
    Ok(p)
}

fn triangle(element: &BytesStart<'_>, count: usize) -> Result<[u32; 3], FileProblem> {
    let mut t = [0; 3];
    for (v, name) in t.iter_mut().zip([b"v1", b"v2", b"v3"]) {
        let value = needed(element, name)?;
        let index =
            integer(value.trim_ascii()).ok_or_else(|| FileProblem::syntax("a vertex number", quoted(&value)))?;
        let in_range = u32::try_from(index).ok().filter(|&v| (v as usize) < count);
        *v = in_range.ok_or_else(|| FileProblem::vertex(index, count))?;
    }
    Ok(t)
}

fn placed(element: &BytesStart<'_>) -> Result<Placed, FileProblem> {
    let transform = match attribute(element, b"transform") {
        Some(value) => transform(&value)?,
        None => DAffine3::IDENTITY,
    };
    let path = attribute(element, b"path").map(|value| text(&value));
    Ok(Placed { object: id(element, b"objectid")?, path, transform })
}

/// Twelve numbers: the images of the three axes, then of the origin.
fn transform(value: &[u8]) -> Result<DAffine3, FileProblem> {
    let numbers = Words::new(value).map(finite).collect::<Result<Vec<_>, _>>()?;
    let numbers: [f64; 12] =
        numbers.try_into().map_err(|_| FileProblem::syntax("twelve numbers of a transform", quoted(value)))?;
    Ok(DAffine3::from_cols_array(&numbers))
}
