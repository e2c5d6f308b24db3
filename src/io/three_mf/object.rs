//! Writing an object of several: the groups of properties that its triangles need, and its triangles.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use super::super::scene::SceneObject;
use super::super::text::TextOut;
use super::palette::Palette;
use super::pictures::write_place_group;

/// What a triangle has as its property.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// Nothing: what its object has.
    Inherited,
    /// An entry of a group that is there already.
    Entry { group: u32, entry: u32 },
    /// Places on the image of this number.
    Picture(u32),
    /// Colours.
    Colours,
}

/// Places on an image, each once.
struct Places {
    id: u32,
    list: Vec<[f32; 2]>,
    numbers: FxHashMap<[u32; 2], u32>,
}

/// An object, ready to be written.
pub(super) struct Written<'a> {
    object: &'a SceneObject,
    looks: Vec<Look>,
    palette: Option<Palette<'a>>,
    /// By image.
    places: BTreeMap<u32, Places>,
    palette_id: u32,
}

impl<'a> Written<'a> {
    /// Numbers the groups from `next` on, which is moved behind them.
    pub(super) fn new(object: &'a SceneObject, look: impl Fn(usize) -> Look, next: &mut u32) -> Self {
        let mut take = || (*next, *next = next.saturating_add(1)).0;
        let at = |t: usize| object.texture.as_ref().and_then(|texture| texture.at(t, false));
        // An image without a place on it shows nothing.
        let look = |t: usize| match look(t) {
            Look::Picture(_) if at(t).is_none() => Look::Inherited,
            look => look,
        };
        let looks: Vec<Look> = (0..object.mesh.triangles.len()).map(look).collect();
        let palette_id = take();
        let palette = looks
            .contains(&Look::Colours)
            .then(|| Palette::new(palette_id, &object.mesh, object.colours.as_ref(), |t| looks[t] == Look::Colours));
        let mut places: BTreeMap<u32, Places> = BTreeMap::new();
        for (t, look) in looks.iter().enumerate() {
            let (Look::Picture(image), Some(corners)) = (*look, at(t)) else { continue };
            let own = places.entry(image);
            let own = own.or_insert_with(|| Places { id: take(), list: Vec::new(), numbers: FxHashMap::default() });
            for place in corners {
                let new = own.list.len() as u32;
                if *own.numbers.entry(place.map(f32::to_bits)).or_insert(new) == new {
                    own.list.push(place);
                }
            }
        }
        Self { object, looks, palette, places, palette_id }
    }

    /// Whether there is anything of the extension for materials.
    pub(super) fn has_groups(&self) -> bool {
        self.palette.is_some() || !self.places.is_empty()
    }

    pub(super) fn write_groups(&self, text: &mut TextOut<'_>) -> std::io::Result<()> {
        if let Some(palette) = &self.palette {
            palette.write_group(text)?;
        }
        for (image, places) in &self.places {
            write_place_group(places.id, image, &places.list, text)?;
        }
        Ok(())
    }

    /// The property of the first triangle that has one, a group and an entry: where triangles have properties the object shall have one too.
    pub(super) fn first_property(&self) -> Option<(u32, u32)> {
        self.looks.iter().find_map(|look| match *look {
            Look::Inherited => None,
            Look::Entry { group, entry } => Some((group, entry)),
            Look::Picture(image) => self.places.get(&image).map(|places| (places.id, 0)),
            Look::Colours => Some((self.palette_id, 0)),
        })
    }

    /// Writes the triangles, whose vertices are counted from `first`; `prefix`: what stands before the names of elements.
    pub(super) fn write_triangles(&self, first: usize, prefix: &str, text: &mut TextOut<'_>) -> std::io::Result<()> {
        let triangles = &self.object.mesh.triangles;
        text.each(triangles.len(), |triangle, text| {
            text.text("<");
            text.text(prefix);
            for (start, v) in ["triangle v1=\"", "\" v2=\"", "\" v3=\""].into_iter().zip(triangles[triangle]) {
                text.text(start);
                text.integer(first as u64 + u64::from(v));
            }
            match (self.looks[triangle], &self.palette) {
                (Look::Inherited, _) | (Look::Colours, None) => {}
                (Look::Entry { group, entry }, _) => text.text(&format!("\" pid=\"{group}\" p1=\"{entry}")),
                (Look::Colours, Some(palette)) => palette.write_entries(triangle, text),
                (Look::Picture(image), _) => self.write_places(triangle, image, text),
            }
            text.text("\"/>\n");
        })
    }

    fn write_places(&self, triangle: usize, image: u32, text: &mut TextOut<'_>) {
        let corners = self.object.texture.as_ref().and_then(|texture| texture.at(triangle, false));
        let (Some(places), Some(corners)) = (self.places.get(&image), corners) else { return };
        text.text(&format!("\" pid=\"{}", places.id));
        for (start, place) in ["\" p1=\"", "\" p2=\"", "\" p3=\""].into_iter().zip(corners) {
            text.text(start);
            text.integer(u64::from(places.numbers.get(&place.map(f32::to_bits)).copied().unwrap_or_default()));
        }
    }
}
