//! Writing: the images of a package, and the places that triangles have on them.

use std::fmt::Display;

use rustc_hash::FxHashMap;

use super::super::text::TextOut;
use super::super::texture::TextureMap;

/// The numbers 1 and 2 are those of the object and of the colours.
const FIRST_NUMBER: usize = 3;

/// The images that triangles have, and for each its group of places.
pub(super) struct Pictures<'a> {
    texture: &'a TextureMap,
    pub(super) list: Vec<Picture>,
    /// The place in the list of each image, by its number.
    place_of: Vec<Option<usize>>,
    /// Numbers of entries within their groups.
    entries: FxHashMap<(usize, [u32; 2]), u32>,
}

/// An image.
pub(super) struct Picture {
    number: u32,
    /// Its name in the package, with its folder.
    path: String,
    /// The different places on it, in the order of first use.
    places: Vec<[f32; 2]>,
}

impl<'a> Pictures<'a> {
    pub(super) fn of(texture: &'a TextureMap) -> Self {
        let names = texture.packed_names();
        let place_of = vec![None; texture.images.len()];
        let mut pictures = Self { texture, list: Vec::new(), place_of, entries: FxHashMap::default() };
        for triangle in 0..texture.coordinates.len() {
            let Some(number) = texture.packed_image(triangle) else { continue };
            let own = pictures.place_of[number as usize].unwrap_or_else(|| {
                let path = format!("/3D/Textures/{}", names[number as usize]);
                pictures.list.push(Picture { number, path, places: Vec::new() });
                pictures.list.len() - 1
            });
            pictures.place_of[number as usize] = Some(own);
            for place in texture.at(triangle, false).into_iter().flatten() {
                let next = pictures.list[own].places.len() as u32;
                if *pictures.entries.entry((own, place.map(f32::to_bits))).or_insert(next) == next {
                    pictures.list[own].places.push(place);
                }
            }
        }
        pictures
    }

    /// The place in the list of a triangle's image.
    pub(super) fn of_triangle(&self, triangle: usize) -> Option<usize> {
        self.place_of[self.texture.packed_image(triangle)? as usize]
    }

    /// The number of the group of an image.
    pub(super) fn group(&self, picture: usize) -> usize {
        FIRST_NUMBER + self.list.len() + picture
    }

    /// Names within the package and bytes.
    pub(super) fn files(&self) -> impl Iterator<Item = (&str, &[u8])> {
        let bytes = |picture: &Picture| &*self.texture.images[picture.number as usize].bytes;
        self.list.iter().map(move |picture| (picture.path.trim_start_matches('/'), bytes(picture)))
    }

    /// What says that the model uses the images.
    pub(super) fn relationships(&self) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">",
        );
        for (n, picture) in self.list.iter().enumerate() {
            text.push_str(&format!(
                "<Relationship Target=\"{}\" Id=\"rel{n}\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture\"/>",
                picture.path
            ));
        }
        text + "</Relationships>\n"
    }

    /// The images, then the groups of places.
    pub(super) fn write_groups(&self, text: &mut TextOut<'_>) -> std::io::Result<()> {
        for (n, picture) in self.list.iter().enumerate() {
            let image = &self.texture.images[picture.number as usize];
            text.text(&format!(
                "<m:texture2d id=\"{}\" path=\"{}\" contenttype=\"{}\"/>\n",
                FIRST_NUMBER + n,
                picture.path,
                image.media_type().unwrap_or_default()
            ));
        }
        for (n, picture) in self.list.iter().enumerate() {
            write_place_group(self.group(n), FIRST_NUMBER + n, &picture.places, text)?;
        }
        Ok(())
    }

    /// The attributes of a triangle that has an image: the group, and an entry for each corner.
    pub(super) fn write_entries(&self, triangle: usize, text: &mut TextOut<'_>) {
        let (Some(own), Some(places)) = (self.of_triangle(triangle), self.texture.at(triangle, false)) else { return };
        text.text(&format!("\" pid=\"{}", self.group(own)));
        for (start, place) in ["\" p1=\"", "\" p2=\"", "\" p3=\""].into_iter().zip(places) {
            text.text(start);
            let entry = self.entries.get(&(own, place.map(f32::to_bits))).copied();
            text.integer(u64::from(entry.unwrap_or_default()));
        }
    }
}

/// The group `id` of places on the image `image`.
pub(super) fn write_place_group(
    id: impl Display,
    image: impl Display,
    places: &[[f32; 2]],
    text: &mut TextOut<'_>,
) -> std::io::Result<()> {
    text.text(&format!("<m:texture2dgroup id=\"{id}\" texid=\"{image}\">\n"));
    for [u, v] in places {
        text.text("<m:tex2coord u=\"");
        text.short_number(*u);
        text.text("\" v=\"");
        text.short_number(*v);
        text.text("\"/>\n");
        text.pass_on()?;
    }
    text.text("</m:texture2dgroup>\n");
    Ok(())
}
