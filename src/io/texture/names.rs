//! Files that are written beside a mesh: safe names, and what is in them.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs;
use std::io;
use std::path::Path;
use std::sync::Arc;

use super::super::draft::folder_of;
use super::super::error::{WriteError, WriteProblem};
use super::super::format::Format;
use super::super::text::TextOut;
use super::{ImageKind, TextureImage, TextureMap};

/// Characters of a name that are kept.
const LONGEST: usize = 80;

/// A file that belongs beside a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SideFile {
    /// The name of the file, without a folder.
    pub name: String,
    /// The bytes of the file.
    pub bytes: Arc<[u8]>,
}

impl SideFile {
    /// Whether there is a file at `path` with these bytes already.
    pub fn is_at(&self, path: &Path) -> bool {
        let same_length = path.metadata().is_ok_and(|found| found.is_file() && found.len() == self.bytes.len() as u64);
        same_length && fs::read(path).is_ok_and(|found| found[..] == self.bytes[..])
    }
}

impl TextureMap {
    /// The files that belong beside a mesh file of `format` at `path`: its materials (OBJ) and images (OBJ and PLY).
    pub fn side_files(&self, format: Format, path: &Path) -> Vec<SideFile> {
        let names = self.image_names(path);
        let images = self.images.iter().zip(&names).filter(|(image, _)| !image.bytes.is_empty());
        let images = images.map(|(image, name)| SideFile { name: name.clone(), bytes: image.bytes.clone() });
        match format {
            Format::Obj => self.library(path).into_iter().chain(images).collect(),
            Format::Ply => images.collect(),
            _ => Vec::new(),
        }
    }

    /// The [side files](Self::side_files) that are not there yet with the same content. None may take the place of a file that these textures
    /// were read from.
    pub(in crate::io) fn files_to_write(&self, format: Format, path: &Path) -> Result<Vec<SideFile>, WriteError> {
        let mut wanted = self.side_files(format, path);
        wanted.retain(|file| !file.is_at(&folder_of(path).join(&file.name)));
        for side in &wanted {
            let file = folder_of(path).join(&side.name);
            if self.was_read_from(&file)? {
                return Err(WriteProblem::TextureInUse { file }.into());
            }
        }
        Ok(wanted)
    }

    /// Whether the textures were read from the file at `path`, links followed. It is `false` where there is no such file.
    ///
    /// # Errors
    /// When the operating system does not tell.
    pub fn was_read_from(&self, path: &Path) -> io::Result<bool> {
        let place = match path.canonicalize() {
            Ok(place) => place,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(error),
        };
        Ok(self.files.iter().any(|file| file.canonicalize().is_ok_and(|file| file == place)))
    }

    /// The file of the materials, where they are more than names.
    fn library(&self, path: &Path) -> Option<SideFile> {
        self.has_library().then(|| SideFile { name: library_name(path), bytes: self.written_library(path).into() })
    }

    /// Whether the materials are more than names.
    pub(in crate::io) fn has_library(&self) -> bool {
        self.materials.iter().any(|material| material.colour.is_some() || material.image.is_some())
    }

    fn written_library(&self, path: &Path) -> Vec<u8> {
        let images = self.image_names(path);
        let mut bytes = b"# written by meshwright\n".to_vec();
        let mut text = TextOut::new(&mut bytes);
        for (material, name) in self.materials.iter().zip(self.material_names()) {
            text.text(&format!("newmtl {name}\n"));
            if let Some([red, green, blue, alpha]) = material.colour {
                text.text("Kd");
                for level in [red, green, blue] {
                    text.text(" ");
                    text.level(level);
                }
                if alpha != 255 {
                    text.text("\nd ");
                    text.level(alpha);
                }
                text.text("\n");
            }
            if let Some(image) = material.image.and_then(|image| images.get(image as usize)) {
                text.text(&format!("map_Kd {image}\n"));
            }
        }
        // Memory takes everything.
        let _ = text.finish();
        bytes
    }

    /// A name for each material, one word and different from the others, also from `none`.
    pub(in crate::io) fn material_names(&self) -> Vec<String> {
        let mut met = BTreeSet::from(["none".to_owned()]);
        let named = self.materials.iter().map(|material| {
            let plain: String =
                material.name.chars().map(|c| if c.is_whitespace() || c.is_control() { '_' } else { c }).collect();
            unique(if plain.is_empty() { "material".into() } else { plain }, "", &mut met)
        });
        named.collect()
    }

    /// A name for the file of each image beside a mesh file at `path`: it begins as that does, so that it is nobody else's.
    pub(in crate::io) fn image_names(&self, path: &Path) -> Vec<String> {
        let start = format!("{}_", stem(path));
        let mut met = BTreeSet::new();
        let named = self.images.iter().map(|image| {
            let (name, ending) = parts(image);
            unique(format!("{start}{name}"), &format!(".{ending}"), &mut met)
        });
        named.collect()
    }

    /// A name for the file of each image within a package, in ASCII.
    pub(in crate::io) fn packed_names(&self) -> Vec<String> {
        let mut met = BTreeSet::new();
        let named = self.images.iter().map(|image| {
            let (name, ending) = parts(image);
            let plain: String = name.chars().map(|c| if c.is_ascii() { c } else { '_' }).collect();
            unique(plain, &format!(".{ending}"), &mut met)
        });
        named.collect()
    }
}

/// The name of the file of the materials beside an OBJ at `path`.
pub(in crate::io) fn library_name(path: &Path) -> String {
    format!("{}.mtl", stem(path))
}

/// The name of the mesh file without its ending.
fn stem(path: &Path) -> String {
    plain(&path.file_stem().map(OsStr::to_string_lossy).unwrap_or_default(), "mesh")
}

/// Letters, digits and a few signs; no folder, and no hidden file.
fn plain(text: &str, otherwise: &str) -> String {
    let sign = |c: char| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '_' };
    let text: String = text.chars().map(sign).take(LONGEST).collect();
    let text = text.trim_start_matches('.');
    if text.is_empty() { otherwise.into() } else { text.into() }
}

/// The name of an image's file and its ending, which is that of its kind.
fn parts(image: &TextureImage) -> (String, String) {
    let path = Path::new(&image.name);
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    let fits = |ending: &String| match image.kind() {
        ImageKind::Png => ending == "png",
        ImageKind::Jpeg => ending == "jpg" || ending == "jpeg",
        ImageKind::Other => ending.chars().all(|c| c.is_ascii_alphanumeric()) && (1..=8).contains(&ending.len()),
    };
    let usual = match image.kind() {
        ImageKind::Png => "png",
        ImageKind::Jpeg => "jpg",
        ImageKind::Other => "image",
    };
    let name = path.file_stem().map(OsStr::to_string_lossy).unwrap_or_default();
    (plain(&name, "texture"), ending.filter(fits).unwrap_or_else(|| usual.into()))
}

/// `start` and `end`, with a number between if the name was met; capitals do not count.
fn unique(start: String, end: &str, met: &mut BTreeSet<String>) -> String {
    let numbered = (2..).map(|n| format!("{start}_{n}{end}"));
    let mut names = std::iter::once(format!("{start}{end}")).chain(numbered);
    names.find(|name| met.insert(name.to_lowercase())).unwrap_or(start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::Material;

    fn image(name: &str, bytes: &[u8]) -> TextureImage {
        TextureImage { name: name.into(), bytes: bytes.into() }
    }

    #[test]
    fn names_stay_in_the_folder_and_apart() {
        let png = b"\x89PNG....";
        let images = vec![
            image("wood.png", png),
            image("Wood.PNG", png),
            image("../../etc/passwd", png),
            image("a/b\\c d.jpg", b"\xff\xd8\xff\xe0"),
            image("", b""),
            image("x.tga", b"tga"),
            image("part_lid.png", png),
            image(".hidden", png),
        ];
        let map = TextureMap { images, ..TextureMap::default() };
        let names = map.image_names("some/folder/my part.obj".as_ref());
        assert_eq!(names[0], "my_part_wood.png");
        assert_eq!(names[1], "my_part_Wood_2.png");
        assert_eq!(names[2], "my_part_passwd.png");
        assert_eq!(names[5], "my_part_x.tga");
        for name in &names {
            assert!(!name.contains(['/', '\\', ' ']) && !name.starts_with('.'), "{name}");
        }
        // What could not be read is named and not written.
        assert_eq!(map.side_files(Format::Ply, "a.ply".as_ref()).len(), 7);
        assert!(map.side_files(Format::Glb, "a.glb".as_ref()).is_empty());
    }

    #[test]
    fn materials_have_names_of_one_word() {
        let material = |name: &str| Material { name: name.into(), colour: None, image: None };
        let materials = ["a b", "a_b", "", "None", "ä"].map(material).to_vec();
        let map = TextureMap { materials, ..TextureMap::default() };
        assert_eq!(map.material_names(), ["a_b", "a_b_2", "material", "None_2", "ä"]);
        assert!(map.side_files(Format::Obj, "a.obj".as_ref()).is_empty());
    }
}
