//! 3MF: a zip package of XML models. Objects hold a mesh or components (other objects under a
//! transform); the build places objects.

mod model;
mod package;
mod write;

use std::collections::{BTreeMap, BTreeSet};

use glam::DAffine3;

use self::model::{Model, Object, Placed, Property};
use self::package::Package;
use super::colour::{Rgba, WHITE};
use super::error::{Place, ReadError, ReadProblem};
use super::soup::{Expansion, Soup, counted, too_many_vertices};
use super::{Format, Loaded};

pub(super) use write::write;

/// Components within components deeper than this are taken for a circle.
const DEEPEST: usize = 256;

pub(super) fn read(bytes: &[u8]) -> Result<Loaded, ReadError> {
    let mut package = Package::open(bytes)?;
    let root = package.root_model()?;
    let mut models = Models { package, loaded: Vec::new(), known: BTreeMap::new() };
    let root = models.load(&root)?;
    let unit = models.loaded[root].unit;
    // A copy, because placing objects may load further models.
    let mut items = models.loaded[root].items.clone();
    let mut soup = Soup::new();
    if items.is_empty() {
        items = models.loaded[root].free_objects();
        if !items.is_empty() {
            soup.warnings.push("the build is empty; every object that is no component of another is read".into());
        }
    }
    let mut builder = Builder { models, soup, allowance: None, placed: BTreeSet::new(), colourless: 0 };
    for item in &items {
        builder.place(root, item)?;
    }
    builder.finish()?.finish(Format::ThreeMf, Some(unit))
}

/// The models of a package, read when first asked for.
struct Models<'a> {
    package: Package<'a>,
    loaded: Vec<Model>,
    known: BTreeMap<String, usize>,
}

impl Models<'_> {
    fn load(&mut self, name: &str) -> Result<usize, ReadError> {
        if let Some(&known) = self.known.get(name) {
            return Ok(known);
        }
        self.loaded.push(self.package.read_model(name)?);
        self.known.insert(name.to_owned(), self.loaded.len() - 1);
        Ok(self.loaded.len() - 1)
    }

    /// The colours of a property, if it is colours.
    fn colours(&self, property: Inherited) -> Option<[Rgba; 3]> {
        let Inherited { model, property } = property;
        let entries = self.loaded[model].groups.get(&property.group)?;
        let colour = |entry: u32| entries.get(entry as usize).copied();
        let [a, b, c] = property.entries.map(colour);
        Some([a?, b?, c?])
    }
}

/// A property and the model that has its group.
#[derive(Clone, Copy)]
struct Inherited {
    model: usize,
    property: Property,
}

/// An object that has been added and whose components are being added.
struct Open {
    model: usize,
    object: u32,
    transform: DAffine3,
    /// The name for components that have none.
    name: String,
    /// The property for components that have none.
    default: Option<Inherited>,
    /// The next component.
    next: usize,
}

struct Builder<'a> {
    models: Models<'a>,
    soup: Soup,
    allowance: Option<Expansion>,
    placed: BTreeSet<(usize, u32)>,
    /// Triangles whose material has no colour that is read here.
    colourless: usize,
}

impl Builder<'_> {
    /// Adds an object and all its components, depth first and in order.
    fn place(&mut self, model: usize, item: &Placed) -> Result<(), ReadError> {
        let outermost = Open {
            model,
            object: item.object,
            transform: DAffine3::IDENTITY,
            name: String::new(),
            default: None,
            next: 0,
        };
        let mut stack = vec![self.open(item, &outermost)?];
        while let Some(top) = stack.last_mut() {
            let object = self.models.loaded[top.model].objects.get(&top.object);
            match object.and_then(|object| object.components.get(top.next)).cloned() {
                None => {
                    stack.pop();
                }
                Some(component) => {
                    top.next += 1;
                    let open = self.open(&component, top)?;
                    if stack.len() == DEEPEST {
                        let problem = ReadProblem::syntax("components that end", "an object within itself");
                        return Err(self.fail(open.model, open.object, problem));
                    }
                    stack.push(open);
                }
            }
        }
        Ok(())
    }

    /// Adds the own mesh of an object within `outer`.
    fn open(&mut self, item: &Placed, outer: &Open) -> Result<Open, ReadError> {
        let model = match &item.path {
            Some(path) => self.models.load(path)?,
            None => outer.model,
        };
        let Some(object) = self.models.loaded[model].objects.get(&item.object) else {
            let problem = ReadProblem::syntax(format!("an object with the id {}", item.object), "none");
            return Err(self.fail(model, item.object, problem));
        };
        let name = if object.name.is_empty() { &outer.name } else { &object.name };
        // The specification gives objects of components no property; programs write it and mean the components.
        let default = object.default.map(|property| Inherited { model, property }).or(outer.default);
        // An empty object and the name count too, so that steps and memory are bounded.
        let cost = 4 + name.len() / 16 + object.vertices.len() + object.triangles.len();
        let read = self.models.package.bytes_read();
        let allowance = self.allowance.get_or_insert_with(|| Expansion::for_input(read));
        let transform = outer.transform * item.transform;
        let added = allowance
            .spend(cost as u64)
            .map_err(ReadError::from)
            .and_then(|()| add_mesh(&mut self.soup, object, name, &transform));
        if added.is_ok() {
            let own =
                |t: usize| object.properties.get(t).copied().flatten().map(|property| Inherited { model, property });
            let property = |t: usize| own(t).or(default);
            if default.is_some() || !object.properties.is_empty() {
                self.colourless += paint(&mut self.soup, &self.models, object.triangles.len(), property, &transform);
            }
        }
        let name = name.to_owned();
        self.placed.insert((model, item.object));
        added.map_err(|error| self.fail(model, item.object, *error.problem))?;
        Ok(Open { model, object: item.object, transform, name, default, next: 0 })
    }

    fn fail(&self, model: usize, object: u32, problem: ReadProblem) -> ReadError {
        let name = &self.models.loaded[model].name;
        ReadError::at(Place::Item(format!("{name}, object {object}")), problem)
    }

    fn finish(mut self) -> Result<Soup, ReadError> {
        let unplaced = (self.models.loaded.iter().enumerate())
            .flat_map(|(i, model)| model.objects.iter().map(move |(id, object)| ((i, *id), object)))
            .filter(|(key, object)| !object.triangles.is_empty() && !self.placed.contains(key))
            .count();
        if unplaced > 0 {
            self.soup.warnings.push(format!("{} that the build does not place left out", counted(unplaced, "object")));
        }
        if self.colourless > 0 {
            let triangles = counted(self.colourless, "triangle");
            self.soup.warnings.push(format!("{triangles} with a texture or a material that has no colour; left out"));
        }
        Ok(self.soup)
    }
}

fn add_mesh(soup: &mut Soup, object: &Object, name: &str, transform: &DAffine3) -> Result<(), ReadError> {
    let first = soup.positions.len();
    if object.triangles.is_empty() {
        return Ok(());
    }
    if first + object.vertices.len() > u32::MAX as usize {
        return Err(too_many_vertices());
    }
    soup.begin_part(name.as_bytes());
    soup.positions.reserve(object.vertices.len());
    for &vertex in &object.vertices {
        let p = transform.transform_point3(vertex);
        if !p.is_finite() {
            return Err(ReadProblem::NotFinite { found: format!("{p} (in the file: {vertex})") }.into());
        }
        soup.positions.push(p);
    }
    let mirrored = is_mirroring(transform);
    soup.triangles.extend(object.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| v + first as u32);
        if mirrored { [a, c, b] } else { [a, b, c] }
    }));
    Ok(())
}

/// Colours the last `count` triangles, if any has a colour. Returns how many have a property that is none.
fn paint(
    soup: &mut Soup,
    models: &Models<'_>,
    count: usize,
    property: impl Fn(usize) -> Option<Inherited>,
    transform: &DAffine3,
) -> usize {
    let mirrored = is_mirroring(transform);
    let (mut coloured, mut colourless) = (0, 0);
    let corners: Vec<[Rgba; 3]> = (0..count)
        .map(|triangle| {
            let colours = property(triangle).map(|property| models.colours(property));
            coloured += usize::from(colours.flatten().is_some());
            colourless += usize::from(colours == Some(None));
            let [a, b, c] = colours.flatten().unwrap_or([WHITE; 3]);
            if mirrored { [a, c, b] } else { [a, b, c] }
        })
        .collect();
    if coloured > 0 {
        soup.colours.paint(soup.triangles.len() - count, corners);
    }
    colourless
}

/// A mirroring transform turns every triangle over; they are turned back.
fn is_mirroring(transform: &DAffine3) -> bool {
    transform.matrix3.determinant() < 0.0
}
