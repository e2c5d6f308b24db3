//! The objects of a file: what follows an `o` line; and in a file without such lines its groups, where those that share an edge are one object.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use glam::DAffine3;
use rustc_hash::FxHashMap;

use super::super::colour::Colours;
use super::super::error::FileError;
use super::super::loaded::{Loaded, Part};
use super::super::scene::{Origin, Placement, Source, Unplaced};
use super::super::text::counted;
use super::{Reader, read_all};

/// What follows an `o` or `g` line: its name, and the number and the name of the object that it is within, if the file has objects.
#[derive(Clone, Default)]
pub(super) struct Section {
    pub(super) name: String,
    pub(super) object: Option<(usize, Arc<str>)>,
}

impl Section {
    /// The one after `self` that begins with a line of this name.
    pub(super) fn next(&self, is_object: bool, name: String) -> Self {
        let object = match is_object {
            true => Some((self.object.as_ref().map_or(0, |(number, _)| number + 1), Arc::from(name.as_str()))),
            false => self.object.clone(),
        };
        Self { name, object }
    }
}

/// Reads the objects of the file at `path`.
pub(in crate::io) fn read_apart(bytes: &[u8], path: Option<&Path>) -> Result<Unplaced, FileError> {
    let mut reader = Reader { sections: Some(Vec::new()), ..Reader::default() };
    read_all(bytes, &mut reader)?;
    let all = reader.sections.take().unwrap_or_default();
    let mut loaded = reader.finish(path)?;
    // What stands before the first line has no name.
    let section = |part: &Part| part.name.parse::<usize>().ok().and_then(|n| all.get(n).cloned()).unwrap_or_default();
    let sections: Vec<Section> = loaded.parts.iter().map(section).collect();
    let has_objects = sections.iter().any(|section| section.object.is_some());
    let object_of = match has_objects {
        true => by_object(&sections),
        false => by_edges(&loaded, &sections),
    };
    let count = object_of.iter().max().map_or(0, |last| last + 1);
    if !has_objects && count < sections.len() {
        let (groups, objects) = (counted(sections.len(), "group"), counted(count, "object"));
        loaded.warnings.push(format!("{groups}, some of which share edges or a name: taken as {objects}"));
    }
    let mut sources: Vec<Source> = Vec::new();
    for (section, &object) in sections.iter().zip(&object_of) {
        if object == sources.len() {
            let name = section.object.as_ref().map_or(section.name.as_str(), |(_, name)| name).to_owned();
            sources.push(Source { name, origin: Some(Origin::Group), loses: Vec::new() });
        }
    }
    let parts = sections.into_iter().map(|section| section.name).zip(object_of.iter().copied()).collect();
    regroup(&mut loaded, &object_of, count);
    let place = |(object, source): (usize, &Source)| {
        let name = source.name.clone();
        Placement { object, name, transform: DAffine3::IDENTITY }
    };
    let placements = sources.iter().enumerate().map(place).collect();
    let (materials, aside, lost_elsewhere) = (BTreeMap::new(), Vec::new(), Vec::new());
    Ok(Unplaced { loaded, sources, placements, parts, materials, aside, lost_elsewhere })
}

/// Numbers from 0 in the order of first use.
fn numbered<T: Ord>(keys: impl Iterator<Item = T>) -> Vec<usize> {
    let mut known = BTreeMap::new();
    let number = |key: T| {
        let next = known.len();
        *known.entry(key).or_insert(next)
    };
    keys.map(number).collect()
}

/// The object of each part, by the `o` lines.
fn by_object(sections: &[Section]) -> Vec<usize> {
    numbered(sections.iter().map(|section| section.object.as_ref().map(|(number, _)| *number)))
}

/// The object of each part: groups of one name, and such that share an edge, are one.
fn by_edges(loaded: &Loaded, sections: &[Section]) -> Vec<usize> {
    let mut above: Vec<usize> = (0..sections.len()).collect();
    fn top(above: &mut [usize], mut n: usize) -> usize {
        while above[n] != n {
            above[n] = above[above[n]];
            n = above[n];
        }
        n
    }
    let mut join = |a: usize, b: usize| {
        let (a, b) = (top(&mut above, a), top(&mut above, b));
        above[a.max(b)] = a.min(b);
    };
    let mut names: BTreeMap<&str, usize> = BTreeMap::new();
    for (n, section) in sections.iter().enumerate().filter(|(_, section)| !section.name.is_empty()) {
        join(*names.entry(&section.name).or_insert(n), n);
    }
    let mut edges: FxHashMap<[u32; 2], usize> = FxHashMap::default();
    for (n, part) in loaded.parts.iter().enumerate().filter(|_| sections.len() > 1) {
        for &[a, b, c] in &loaded.mesh.triangles[part.triangles.clone()] {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let first = *edges.entry([from.min(to), from.max(to)]).or_insert(n);
                if first != n {
                    join(first, n);
                }
            }
        }
    }
    let tops: Vec<usize> = (0..sections.len()).map(|n| top(&mut above, n)).collect();
    numbered(tops.into_iter())
}

/// Brings the triangles of each object together; the parts become the objects, named by their numbers.
fn regroup(loaded: &mut Loaded, object_of: &[usize], count: usize) {
    let mut of_object: Vec<Vec<u32>> = vec![Vec::new(); count];
    for (part, &object) in loaded.parts.iter().zip(object_of) {
        of_object[object].extend(part.triangles.clone().map(|t| t as u32));
    }
    let mut first = 0;
    loaded.parts = (of_object.iter().enumerate())
        .map(|(n, triangles)| {
            let range = first..first + triangles.len();
            first = range.end;
            Part { name: n.to_string(), triangles: range }
        })
        .collect();
    let order = of_object.concat();
    if order.iter().enumerate().all(|(n, &t)| n == t as usize) {
        return;
    }
    loaded.mesh.triangles = order.iter().map(|&t| loaded.mesh.triangles[t as usize]).collect();
    loaded.colours = loaded.colours.take().map(|colours| match colours {
        Colours::Vertices(_) => colours,
        Colours::Faces(list) => Colours::Faces(order.iter().map(|&t| list[t as usize]).collect()),
        Colours::Corners(list) => Colours::Corners(order.iter().map(|&t| list[t as usize]).collect()),
    });
    loaded.texture = loaded.texture.take().map(|texture| texture.picked(&order));
}
