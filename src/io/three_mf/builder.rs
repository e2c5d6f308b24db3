//! Placing objects: meshes under their transforms, each by its role.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec3};

use super::super::colour::{Rgba, WHITE};
use super::super::error::{FileError, FileProblem, Location};
use super::super::soup::{Expansion, Soup, too_many_vertices};
use super::super::text::{counted, quoted};
use super::apart::Apart;
use super::model::{Object, Placed};
use super::models::{Inherited, Models};
use super::roles::{Role, Roles};
use super::texture::Textures;

use crate::mesh::Bounds;

/// Components within components deeper than this are not followed.
const DEEPEST: usize = 256;

/// Names of left out pieces that a sentence lists.
const LISTED: usize = 4;

/// An object that has been added and whose components are being added.
struct Open {
    model: usize,
    object: u32,
    transform: DAffine3,
    /// The name for components that have none.
    name: String,
    /// The property for components that have none.
    default: Option<Inherited>,
    /// What the object is for; of what is no material all components are the same.
    role: Role,
    /// The next component.
    next: usize,
}

/// What the build places, piece by piece.
pub(super) struct Builder<'a> {
    models: Models<'a>,
    /// The model that has the build.
    root: usize,
    roles: Roles,
    soup: Soup,
    negative: Soup,
    /// For each item of the build, the boxes around its material and around what is taken away from it.
    boxes: Vec<[Option<Bounds>; 2]>,
    allowance: Option<Expansion>,
    placed: BTreeSet<(usize, u32)>,
    textures: Textures,
    /// Triangles whose material has no colour that is read here.
    colourless: usize,
    /// Names of pieces that were left out, by what they are.
    helpers: BTreeMap<&'static str, Vec<String>>,
    /// Where every object is added once, in its own coordinates: what there is to know of each.
    apart: Option<Apart>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(models: Models<'a>, root: usize, roles: Roles, warnings: Vec<String>) -> Self {
        let mut soup = Soup::new();
        soup.warnings = warnings;
        Self {
            models,
            root,
            roles,
            soup,
            negative: Soup::new(),
            boxes: Vec::new(),
            allowance: None,
            placed: BTreeSet::new(),
            textures: Textures::default(),
            colourless: 0,
            helpers: BTreeMap::new(),
            apart: None,
        }
    }

    /// The same where every object is added once, in its own coordinates.
    pub(super) fn apart(self) -> Self {
        Self { apart: Some(Apart::default()), textures: Textures::of_all(), ..self }
    }

    /// Adds an item of the build: an object and all its components, depth first and in order.
    pub(super) fn place(&mut self, item: &Placed) -> Result<(), FileError> {
        let outermost = Open {
            model: self.root,
            object: item.object,
            transform: DAffine3::IDENTITY,
            name: String::new(),
            default: None,
            role: Role::Part,
            next: 0,
        };
        let before = [self.soup.positions.len(), self.negative.positions.len()];
        let mut stack = vec![self.open(item, &outermost)?];
        while let Some(top) = stack.last_mut() {
            let object = self.models.loaded[top.model].objects.get(&top.object);
            let Some(component) = object.and_then(|object| object.components.get(top.next)).cloned() else {
                stack.pop();
                continue;
            };
            top.next += 1;
            let open = self.open(&component, top)?;
            if stack.iter().any(|outer| (outer.model, outer.object) == (open.model, open.object)) {
                let problem = FileProblem::syntax("components that end", "an object within itself");
                return Err(self.fail(open.model, open.object, problem));
            }
            if stack.len() == DEEPEST {
                let reason =
                    format!("components within components more than {DEEPEST} deep are not read; flatten the assembly");
                return Err(self.fail(open.model, open.object, FileProblem::Unsupported(reason)));
            }
            stack.push(open);
        }
        let finite = |points: &[DVec3]| Bounds::of(points.iter().copied().filter(|p| p.is_finite()));
        self.boxes.push([finite(&self.soup.positions[before[0]..]), finite(&self.negative.positions[before[1]..])]);
        Ok(())
    }

    /// Adds the own mesh of an object within `outer`.
    fn open(&mut self, item: &Placed, outer: &Open) -> Result<Open, FileError> {
        let model = match &item.path {
            Some(path) => self.models.load(path)?,
            None => outer.model,
        };
        let Some(object) = self.models.loaded[model].objects.get(&item.object) else {
            let problem = FileProblem::syntax(format!("an object with the id {}", item.object), "none");
            return Err(self.fail(model, item.object, problem));
        };
        let said = (outer.model == self.root).then(|| self.roles.component(outer.object, item.object)).flatten();
        // What a slicer says counts for more: some write `other` as the type of all that is no material.
        let role = match outer.role {
            Role::Part => said.map_or(object.role, |(_, role)| *role),
            other => other,
        };
        let names = [object.name.as_str(), said.map_or("", |(name, _)| name), &outer.name];
        let name = names.into_iter().find(|name| !name.is_empty()).unwrap_or_default().to_owned();
        // The specification gives objects of components no property; programs write it and mean the components.
        let default = object.default.map(|property| Inherited { model, property }).or(outer.default);
        let transform = outer.transform * item.transform;
        // An empty object and the name count too, so that steps and memory are bounded.
        let adds_again = self.apart.is_none() || !self.placed.contains(&(model, item.object));
        let content = if adds_again { object.vertices.len() + object.triangles.len() } else { 0 };
        let cost = 4 + name.len() / 16 + content;
        let read = self.models.package.bytes_read();
        let allowance = self.allowance.get_or_insert_with(|| Expansion::for_input(read));
        let spent = allowance.spend(cost as u64);
        let open = Open { model, object: item.object, transform, name, default, role, next: 0 };
        self.placed.insert((model, item.object));
        spent.map_err(FileError::from).and_then(|()| self.add(&open)).map_err(|error| match error.location {
            None => self.fail(model, item.object, *error.problem),
            Some(_) => error,
        })?;
        Ok(open)
    }

    /// Adds the mesh of an object, in pieces where its triangles have roles of their own.
    fn add(&mut self, open: &Open) -> Result<(), FileError> {
        let Some(object) = self.models.loaded[open.model].objects.get(&open.object) else { return Ok(()) };
        if object.triangles.is_empty() {
            return Ok(());
        }
        let volumes = if open.model == self.root { self.roles.volumes(open.object) } else { &[] };
        if volumes.is_empty() || open.role != Role::Part {
            let all = Piece { name: &open.name, number: None, triangles: None };
            return match self.target(open.role, &open.name) {
                Some(negative) => self.add_piece(open, all, negative),
                None => Ok(()),
            };
        }
        let volumes = volumes.to_vec();
        let count = object.triangles.len();
        let mut taken = vec![false; count];
        let mut pieces = Vec::new();
        for (number, volume) in volumes.iter().enumerate() {
            let numbers = volume.triangles.clone().take_while(|t| *t < count);
            let triangles: Vec<usize> = numbers.filter(|&t| !std::mem::replace(&mut taken[t], true)).collect();
            if let Some(negative) = self.target(volume.role, &volume.name)
                && !triangles.is_empty()
            {
                pieces.push((&volume.name, number, triangles, negative));
            }
        }
        let rest: Vec<usize> = (0..count).filter(|&t| !taken[t]).collect();
        if !rest.is_empty() {
            pieces.push((&open.name, volumes.len(), rest, false));
        }
        pieces.into_iter().try_for_each(|(name, number, triangles, negative)| {
            let name = if name.is_empty() { &open.name } else { name };
            self.add_piece(open, Piece { name, number: Some(number), triangles: Some(triangles) }, negative)
        })
    }

    /// Whether a piece of this role is taken away; `None` when it is left out, which is noted.
    fn target(&mut self, role: Role, name: &str) -> Option<bool> {
        if let Some(apart) = &mut self.apart {
            apart.leave(role, name);
        }
        match role {
            Role::Part => Some(false),
            Role::Negative if self.apart.is_some() => None,
            Role::Negative => Some(true),
            Role::Helper(what) => {
                self.helpers.entry(what).or_default().push(name.to_owned());
                None
            }
        }
    }

    fn add_piece(&mut self, open: &Open, piece: Piece<'_>, negative: bool) -> Result<(), FileError> {
        let Some(object) = self.models.loaded[open.model].objects.get(&open.object) else { return Ok(()) };
        let soup = if negative { &mut self.negative } else { &mut self.soup };
        let numbers = piece.triangles.unwrap_or_else(|| (0..object.triangles.len()).collect());
        if let Some(apart) = &mut self.apart {
            let model = &self.models.loaded[open.model].name;
            let Some(number) = apart.place((model, open.object, piece.number), object, piece.name, open.transform)
            else {
                return Ok(());
            };
            add_mesh(soup, object, &number.to_string(), &numbers, &DAffine3::IDENTITY)?;
            let corners = self.textures.cover(soup, &self.models, (object, open.model), &numbers, open.default);
            soup.colours.paint(soup.triangles.len() - numbers.len(), corners);
            return Ok(());
        }
        add_mesh(soup, object, piece.name, &numbers, &open.transform)?;
        if !negative && (open.default.is_some() || !object.properties.is_empty()) {
            let own = |t: usize| object.properties.get(t).copied().flatten();
            let property = |t: usize| own(t).map(|property| Inherited { model: open.model, property }).or(open.default);
            self.colourless += paint(soup, &self.models, &numbers, property, &open.transform);
            self.textures.hang(soup, &self.models, &numbers, property, is_mirroring(&open.transform));
        }
        Ok(())
    }

    fn fail(&self, model: usize, object: u32, problem: FileProblem) -> FileError {
        let name = &self.models.loaded[model].name;
        FileError::at(Location::Item(format!("{name}, object {object}")), problem)
    }

    /// What is there, each object once, and what there is to know of each.
    pub(super) fn finish_apart(mut self) -> (Soup, Apart) {
        let mut apart = self.apart.take().unwrap_or_default();
        let mut soup = std::mem::replace(&mut self.soup, Soup::new());
        apart.materials = self.textures.finish(&mut self.models, &mut soup);
        // What stays as it is in a file of the same kind is told by name.
        (self.textures, self.helpers) = (Textures::default(), BTreeMap::new());
        let images = std::mem::take(&mut soup.warnings);
        let (mut rest, _) = self.finish();
        apart.lost_elsewhere.append(&mut rest.warnings);
        apart.lost_elsewhere.extend(images);
        (soup, apart)
    }

    /// What is there, and what is taken away from it.
    pub(super) fn finish(mut self) -> (Soup, Soup) {
        let unplaced = (self.models.loaded.iter().enumerate())
            .flat_map(|(i, model)| model.objects.iter().map(move |(id, object)| ((i, *id), object)))
            .filter(|(key, object)| !object.triangles.is_empty() && !self.placed.contains(key))
            .count();
        let mut sentences = std::mem::take(&mut self.roles.warnings);
        self.textures.finish(&mut self.models, &mut self.soup);
        for (what, names) in &self.helpers {
            sentences.push(format!("{}{} left out", counted(names.len(), what), listed(names)));
        }
        let extensions: BTreeSet<String> =
            self.models.loaded.iter().flat_map(|model| model.extensions.unread_used()).collect();
        for extension in extensions {
            sentences.push(format!("the extension {extension} is not read; what it describes is left out"));
        }
        if unplaced > 0 {
            sentences.push(format!("{} that the build does not place left out", counted(unplaced, "object")));
        }
        if self.colourless > 0 {
            let triangles = counted(self.colourless, "triangle");
            sentences.push(format!("{triangles} with a texture or a material that has no colour; left out"));
        }
        if self.reaches_over() {
            sentences.push(
                "a negative part reaches into another object, from which a slicer takes nothing away; here it does"
                    .into(),
            );
        }
        self.soup.warnings.extend(sentences);
        (self.soup, self.negative)
    }

    /// Whether what is taken away from one item of the build may meet the material of another.
    fn reaches_over(&self) -> bool {
        let meet = |a: &Bounds, b: &Bounds| a.min.cmplt(b.max).all() && b.min.cmplt(a.max).all();
        self.boxes.iter().enumerate().any(|(i, [_, negative])| {
            let others =
                self.boxes.iter().enumerate().filter(|(j, _)| i != *j).filter_map(|(_, [own, _])| own.as_ref());
            negative.as_ref().is_some_and(|negative| others.into_iter().any(|other| meet(negative, other)))
        })
    }
}

/// The first of these names in brackets, if any is a name.
fn listed(names: &[String]) -> String {
    let named: Vec<String> = names.iter().filter(|name| !name.is_empty()).map(|name| quoted(name.as_bytes())).collect();
    let more = if named.len() > LISTED { ", …" } else { "" };
    match named.is_empty() {
        true => String::new(),
        false => format!(" ({}{more})", named[..named.len().min(LISTED)].join(", ")),
    }
}

/// Some of the triangles of an object, or all.
struct Piece<'a> {
    name: &'a str,
    /// Which of the volumes of a slicer it is; one after the last for what is in none.
    number: Option<usize>,
    triangles: Option<Vec<usize>>,
}

/// Adds the triangles of these numbers with their vertices.
fn add_mesh(
    soup: &mut Soup,
    object: &Object,
    name: &str,
    numbers: &[usize],
    transform: &DAffine3,
) -> Result<(), FileError> {
    let first = soup.positions.len();
    if first + object.vertices.len() > u32::MAX as usize {
        return Err(too_many_vertices());
    }
    soup.begin_part(name.as_bytes());
    // Of a piece of an object only its own vertices.
    let mut wanted = vec![numbers.len() == object.triangles.len(); object.vertices.len()];
    numbers.iter().flat_map(|&t| object.triangles[t]).for_each(|v| wanted[v as usize] = true);
    let mut places = Vec::with_capacity(wanted.len());
    // Multiplied by one, −0 would become 0.
    let in_place = *transform == DAffine3::IDENTITY;
    for (&vertex, &wanted) in object.vertices.iter().zip(&wanted) {
        places.push(soup.positions.len() as u32);
        if wanted {
            soup.positions.push(if in_place { vertex } else { transform.transform_point3(vertex) });
        }
    }
    let mirrored = is_mirroring(transform);
    soup.triangles.extend(numbers.iter().map(|&t| {
        let [a, b, c] = object.triangles[t].map(|v| places[v as usize]);
        if mirrored { [a, c, b] } else { [a, b, c] }
    }));
    Ok(())
}

/// Colours the last triangles, which have these numbers in their object, if any has a colour. Returns how many have a
/// property that is none.
fn paint(
    soup: &mut Soup,
    models: &Models<'_>,
    numbers: &[usize],
    property: impl Fn(usize) -> Option<Inherited>,
    transform: &DAffine3,
) -> usize {
    let mirrored = is_mirroring(transform);
    let (mut coloured, mut colourless) = (0, 0);
    let corners: Vec<[Rgba; 3]> = (numbers.iter())
        .map(|&triangle| {
            let colours = property(triangle).map(|property| models.colours(property));
            coloured += usize::from(colours.flatten().is_some());
            let is_place = || property(triangle).is_some_and(|property| models.places(property).is_some());
            colourless += usize::from(colours == Some(None) && !is_place());
            let [a, b, c] = colours.flatten().unwrap_or([WHITE; 3]);
            if mirrored { [a, c, b] } else { [a, b, c] }
        })
        .collect();
    if coloured > 0 {
        soup.colours.paint(soup.triangles.len() - numbers.len(), corners);
    }
    colourless
}

/// A mirroring transform turns every triangle over; they are turned back.
fn is_mirroring(transform: &DAffine3) -> bool {
    transform.matrix3.determinant() < 0.0
}
