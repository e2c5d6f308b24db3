//! Materials and texture coordinates: `vt`, `usemtl`, and the files that `mtllib` names, which `tobj` reads.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::super::soup::Soup;
use super::super::text::{Lines, Words, counted, integer, quoted, single};
use super::super::texture::{Gallery, Woven};
use crate::io::Material;

/// The number of what is not there.
const NONE: u32 = u32::MAX;

/// Names that programs write where faces have no material.
const NO_NAMES: [&str; 3] = ["none", "(null)", "(none)"];

/// Maps of an image that say something else than the colour.
const OTHER_MAPS: [&[u8]; 15] = [
    b"map_Ka",
    b"map_Ks",
    b"map_Ke",
    b"map_Ns",
    b"map_d",
    b"map_Bump",
    b"map_bump",
    b"map_Pr",
    b"map_Pm",
    b"bump",
    b"disp",
    b"decal",
    b"norm",
    b"refl",
    b"map_Ps",
];

/// What the statements about looks have said so far.
#[derive(Default)]
pub(super) struct Looks {
    /// `vt`.
    coordinates: Vec<[f32; 2]>,
    /// The `vt` at the corners of each triangle; triangles after the last have none.
    corners: Vec<[u32; 3]>,
    /// Those of the face that is being read.
    face: Vec<u32>,
    cut: Vec<[u32; 3]>,
    /// The material of the faces to come.
    current: Option<u32>,
    numbers: BTreeMap<Vec<u8>, u32>,
    /// The rest of each `mtllib` line.
    libraries: BTreeSet<Vec<u8>>,
}

impl Looks {
    /// `vt u [v [w]]`.
    pub(super) fn coordinate(&mut self, mut words: Words<'_>) {
        let mut next = |otherwise: f32| words.next().filter(|word| !word.starts_with(b"#")).map_or(otherwise, single);
        self.coordinates.push([next(f32::NAN), next(0.0)]);
    }

    /// `usemtl NAME`.
    pub(super) fn material(&mut self, name: &[u8], woven: &mut Woven) {
        let next = woven.materials.len() as u32;
        let number = *self.numbers.entry(name.to_vec()).or_insert(next);
        if number == next {
            let name = String::from_utf8_lossy(name).into_owned();
            woven.materials.push(Material { name, colour: None, image: None });
        }
        self.current = Some(number);
    }

    /// `mtllib NAME ...`.
    pub(super) fn library(&mut self, names: &[u8]) {
        self.libraries.insert(names.to_vec());
    }

    /// Begins a face.
    #[inline]
    pub(super) fn begin_face(&mut self) {
        self.face.clear();
    }

    /// The next corner of a face, as it stands: `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    #[inline]
    pub(super) fn corner(&mut self, word: &[u8]) {
        let Some(slash) = word.iter().position(|&b| b == b'/') else { return };
        let rest = &word[slash + 1..];
        let end = rest.iter().position(|&b| b == b'/').unwrap_or(rest.len());
        if end == 0 {
            return;
        }
        // What is no number of a `vt` counts as none: the mesh is sound without it.
        let index = integer(&rest[..end]).unwrap_or(0);
        let from_zero = if index < 0 { index.checked_add(self.coordinates.len() as i64) } else { index.checked_sub(1) };
        self.face.push(from_zero.and_then(|i| u32::try_from(i).ok()).unwrap_or(NONE));
    }

    /// Whether each corner of the face has coordinates.
    #[inline]
    pub(super) fn is_textured(&self, corners: usize) -> bool {
        self.face.len() == corners
    }

    /// Adds the face, whose corners all have coordinates.
    pub(super) fn add(&mut self, corners: &[u32], ahead: bool, soup: &mut Soup) {
        let first = soup.triangles.len();
        match ahead {
            true => {
                super::super::polygon::fan(corners, &mut soup.triangles);
                self.cut.clear();
                let numbers: Vec<u32> = (0..corners.len() as u32).collect();
                super::super::polygon::fan(&numbers, &mut self.cut);
            }
            false => soup.face_of_corners(corners, &mut self.cut),
        }
        self.corners.resize(first, [NONE; 3]);
        self.corners.extend(self.cut.iter().map(|t| t.map(|k| self.face[k as usize])));
    }

    /// Gives the triangles from number `first` on their material.
    #[inline]
    pub(super) fn cover(&self, first: usize, soup: &mut Soup) {
        if let Some(material) = self.current
            && first < soup.triangles.len()
        {
            soup.texture.cover(first..soup.triangles.len(), material);
        }
    }

    /// Reads the materials and their images beside the file, and gives the triangles what they have.
    pub(super) fn finish(self, soup: &mut Soup, path: Option<&Path>) {
        let mut absent = 0;
        for (triangle, corners) in self.corners.iter().enumerate() {
            let [a, b, c] = corners.map(|k| self.coordinates.get(k as usize).copied());
            match (a, b, c) {
                (Some(a), Some(b), Some(c)) => soup.texture.put(triangle, [a, b, c]),
                _ => absent += usize::from(*corners != [NONE; 3]),
            }
        }
        if absent > 0 {
            let triangles = counted(absent, "triangle");
            soup.warnings.push(format!("{triangles} with texture coordinates that are not there; read without"));
        }
        let mut read =
            Read { gallery: Gallery::beside(path), known: &self.numbers, maps: 0, shifts: 0, met: BTreeSet::new() };
        if !soup.texture.materials.is_empty() {
            self.libraries.iter().for_each(|line| read.libraries(line, &mut soup.texture));
        }
        if read.maps > 0 {
            let maps = counted(read.maps, "further texture");
            soup.warnings
                .push(format!("{maps} of materials (gloss, bumps and the like) left out; that of the colour is kept"));
        }
        if read.shifts > 0 {
            let textures = counted(read.shifts, "texture");
            soup.warnings.push(format!("{textures} shifted or scaled in the file of materials; taken as they are"));
        }
        let met = read.met;
        soup.texture.hang(read.gallery, &mut soup.warnings);
        soup.texture
            .drop_materials(|n, name| !met.contains(&n) && NO_NAMES.iter().any(|no| name.eq_ignore_ascii_case(no)));
    }
}

/// Files of materials being read.
struct Read<'a> {
    gallery: Gallery<'a>,
    known: &'a BTreeMap<Vec<u8>, u32>,
    /// Further images, of something else than the colour.
    maps: usize,
    /// Images that do not lie as their coordinates say.
    shifts: usize,
    /// Materials that a file describes.
    met: BTreeSet<u32>,
}

impl Read<'_> {
    /// A `mtllib` line: one name, which may have spaces, or several.
    fn libraries(&mut self, line: &[u8], woven: &mut Woven) {
        let name = |bytes: &[u8]| String::from_utf8_lossy(bytes).replace('\\', "/");
        let whole = self.gallery.file(&name(line));
        let several: Vec<&[u8]> = Words::new(line).collect();
        match whole {
            Ok(bytes) => self.library(&bytes, woven),
            Err(reason) if several.len() < 2 => self.no_library(line, &reason),
            Err(_) => several.iter().for_each(|word| match self.gallery.file(&name(word)) {
                Ok(bytes) => self.library(&bytes, woven),
                Err(reason) => self.no_library(word, &reason),
            }),
        }
    }

    fn no_library(&mut self, name: &[u8], reason: &str) {
        let what = quoted(name);
        self.gallery.complain(format!(
            "the file of materials {what} left out: {reason}; names of materials and texture coordinates are kept"
        ));
    }

    /// The content of a file of materials. Of what is described twice, the first counts.
    fn library(&mut self, bytes: &[u8], woven: &mut Woven) {
        for described in self.described(bytes) {
            let number = described.name.parse::<u32>().ok().filter(|&number| self.met.insert(number));
            let Some(material) = number.and_then(|number| woven.materials.get_mut(number as usize)) else { continue };
            let opacity = described.dissolve.map(|opacity| level(opacity as f32));
            let red_green_blue = described.diffuse.map(|levels| levels.map(|x| level(x as f32)));
            if red_green_blue.is_some() || opacity.is_some() {
                let [red, green, blue] = red_green_blue.unwrap_or([255; 3]);
                material.colour = Some([red, green, blue, opacity.unwrap_or(255)]);
            }
            if let Some(texture) = described.diffuse_texture {
                let (name, _) = file_of(Words::new(texture.as_bytes()));
                material.image = Some(self.gallery.image(&String::from_utf8_lossy(name)));
            }
        }
    }

    /// What a file describes of the materials that faces have, in its order, as `tobj` reads it. A single number that is none would
    /// make `tobj` refuse the whole file, and a colour of two numbers would make it panic. So it gets the statements
    /// that are sound and that say something of the colour; the others are passed over, or counted. Materials go by their numbers in the mesh
    /// there, because names need not be UTF-8.
    fn described(&mut self, bytes: &[u8]) -> Vec<tobj::Material> {
        let mut sound = Vec::with_capacity(bytes.len().min(1 << 16));
        // The material that is being described, if faces have it and nothing has described it before.
        let (mut current, mut begun) = (None, BTreeSet::new());
        for (_, line) in Lines::new(bytes) {
            let mut words = Words::new(line);
            let statement = words.next().unwrap_or_default();
            let rest = words.rest();
            if statement == b"newmtl" {
                let number = self.known.get(rest).copied();
                current = number.filter(|number| !self.met.contains(number) && begun.insert(*number));
            }
            let Some(number) = current else { continue };
            let numbers =
                |count: usize| words.clone().take(count).map(single).filter(|x| x.is_finite()).count() == count;
            let is_sound = match statement {
                b"newmtl" => true,
                b"Kd" => numbers(3),
                b"d" | b"Tr" => numbers(1),
                b"map_Kd" => {
                    let (name, shifted) = file_of(words.clone());
                    self.shifts += usize::from(shifted);
                    !name.is_empty()
                }
                other => {
                    self.maps += usize::from(OTHER_MAPS.contains(&other));
                    false
                }
            };
            if !is_sound {
                continue;
            }
            // `Tr` is one minus `d`, and the later of both counts.
            let line = match (statement, words.next()) {
                (b"newmtl", _) => format!("newmtl {number}"),
                (b"Tr", Some(word)) => format!("d {}", 1.0 - single(word)),
                _ => format!("{} {}", String::from_utf8_lossy(statement), String::from_utf8_lossy(rest)),
            };
            sound.extend_from_slice(line.as_bytes());
            sound.push(b'\n');
        }
        tobj::load_mtl_buf(&mut sound.as_slice()).map(|(materials, _)| materials).unwrap_or_default()
    }
}

/// From 0 to 1 to 0 to 255; the cast ends there.
fn level(value: f32) -> u8 {
    (value * 255.0).round() as u8
}

/// The file of a `map_Kd` line, after its options, and whether one of these shifts or scales the image.
fn file_of(mut words: Words<'_>) -> (&[u8], bool) {
    let mut shifted = false;
    loop {
        let mut ahead = words.clone();
        let values = match ahead.next() {
            Some(b"-o" | b"-s" | b"-t") => {
                shifted = true;
                3
            }
            Some(b"-mm") => 2,
            Some(
                b"-blendu" | b"-blendv" | b"-cc" | b"-clamp" | b"-boost" | b"-texres" | b"-imfchan" | b"-bm" | b"-type",
            ) => 1,
            _ => return (words.rest(), shifted),
        };
        words = ahead;
        for _ in 0..values {
            let mut ahead = words.clone();
            let word = ahead.next();
            // Of three numbers the last ones may be missing.
            if values == 3 && word.is_some_and(|word| !single(word).is_finite()) {
                break;
            }
            words = ahead;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_stand_after_options() {
        let of = |line: &'static str| file_of(Words::new(line.as_bytes()));
        assert_eq!(of(" wood.png"), (b"wood.png".as_slice(), false));
        assert_eq!(of("-s 2 2 my wood.png "), (b"my wood.png".as_slice(), true));
        assert_eq!(of("-o 0.1 -mm 0 1 -clamp on a.png"), (b"a.png".as_slice(), true));
        assert_eq!(of("-s 1 1 1"), (b"".as_slice(), true));
        assert_eq!(of(""), (b"".as_slice(), false));
    }
}
