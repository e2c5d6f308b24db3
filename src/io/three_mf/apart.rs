//! What there is to know of the objects of a package where each is read once, in its own coordinates.

use std::collections::BTreeMap;

use glam::DAffine3;

use super::super::loaded::Loaded;
use super::super::scene::{Aside, MaterialOrigin, Origin, Placement, Source, Unplaced};
use super::model::Object;
use super::roles::Role;

/// The objects so far.
#[derive(Default)]
pub(super) struct Apart {
    /// Their numbers.
    numbers: BTreeMap<Origin, usize>,
    sources: Vec<Source>,
    placements: Vec<Placement>,
    aside: Vec<Aside>,
    pub(super) materials: BTreeMap<String, (String, MaterialOrigin)>,
    pub(super) lost_elsewhere: Vec<String>,
}

impl Apart {
    /// Notes a piece that is no material of its own.
    pub(super) fn leave(&mut self, role: Role, name: &str) {
        let what = match role {
            Role::Part => return,
            Role::Negative => "negative part",
            Role::Helper(what) => what,
        };
        self.aside.push(Aside { what: what.into(), name: name.to_owned() });
    }

    /// Places an object, or a piece of it, by the model that has it, its number there and the number of the piece. Returns its number here the
    /// first time.
    pub(super) fn place(
        &mut self,
        (model, id, piece): (&str, u32, Option<usize>),
        object: &Object,
        name: &str,
        transform: DAffine3,
    ) -> Option<usize> {
        let origin = Origin::Object { model: model.to_owned(), id, piece };
        let next = self.sources.len();
        let number = *self.numbers.entry(origin.clone()).or_insert(next);
        self.placements.push(Placement { object: number, name: name.to_owned(), transform });
        if number < next {
            return None;
        }
        let kinds = [
            (object.is_painted, "what a slicer has painted on its triangles"),
            (object.has_more, "what its mesh has beside triangles (beams, sets of triangles)"),
        ];
        let loses = kinds.into_iter().filter(|(there, _)| *there).map(|(_, what)| what).collect();
        self.sources.push(Source { name: name.to_owned(), origin: Some(origin), loses });
        Some(number)
    }

    /// Everything, with the meshes.
    pub(super) fn unplaced(self, loaded: Loaded) -> Unplaced {
        let Self { sources, placements, aside, materials, lost_elsewhere, .. } = self;
        Unplaced { loaded, sources, placements, parts: Vec::new(), materials, aside, lost_elsewhere }
    }
}
