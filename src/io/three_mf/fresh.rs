//! Writing a scene of another format: an object for each object, and an item of the build for each place.

use std::io::{Cursor, Write};

use glam::DAffine3;
use quick_xml::escape::escape;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::super::colour::{Colours, Rgba, WHITE, linear_from_srgb, srgb_from_linear};
use super::super::error::WriteError;
use super::super::scene::{Scene, SceneObject};
use super::super::text::TextOut;
use super::object::{Look, Written};
use super::write::{RELATIONSHIPS, TYPES, TYPES_OF_IMAGES, write_vertices};
use crate::io::Unit;

/// The number of the group of base materials.
const MATERIALS: u32 = 1;

/// The images of a scene that the format holds, and their names in the package.
struct Album {
    /// By image: its number as a resource, and its name.
    pictures: Vec<Option<(u32, String)>>,
}

impl Album {
    fn of(scene: &Scene) -> Self {
        let mut next = MATERIALS;
        let picture = |(n, image): (usize, &crate::io::TextureImage)| {
            let ending = image.media_type()?.trim_start_matches("image/");
            next += 1;
            Some((next, format!("/3D/Textures/image_{}.{ending}", n + 1)))
        };
        Self { pictures: scene.images.iter().enumerate().map(picture).collect() }
    }

    fn number(&self, image: Option<u32>) -> Option<u32> {
        self.pictures.get(image? as usize)?.as_ref().map(|(number, _)| *number)
    }

    fn relationships(&self) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">",
        );
        for (number, path) in self.pictures.iter().flatten() {
            text.push_str(&format!(
                "<Relationship Target=\"{path}\" Id=\"rel{number}\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dtexture\"/>"
            ));
        }
        text + "</Relationships>\n"
    }
}

/// Writes a scene whose coordinates are in `unit`; without one the model states none, which means millimetres.
pub(in crate::io) fn write_fresh(scene: &Scene, unit: Option<Unit>, out: &mut dyn Write) -> Result<(), WriteError> {
    let album = Album::of(scene);
    let has_images = album.pictures.iter().any(Option::is_some);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    // A fixed date: the same scene gives the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .large_file(true);
    let types = if has_images { TYPES.replace("</Types>", TYPES_OF_IMAGES) } else { TYPES.to_owned() };
    let mut files = vec![("[Content_Types].xml", types), ("_rels/.rels", RELATIONSHIPS.to_owned())];
    files.extend(has_images.then(|| ("3D/_rels/3dmodel.model.rels", album.relationships())));
    for (name, text) in files {
        zip.start_file(name, options.large_file(false)).map_err(std::io::Error::from)?;
        zip.write_all(text.as_bytes())?;
    }
    let stored = options.compression_method(CompressionMethod::Stored);
    for (image, picture) in scene.images.iter().zip(&album.pictures) {
        let Some((_, path)) = picture else { continue };
        zip.start_file(path.trim_start_matches('/'), stored).map_err(std::io::Error::from)?;
        zip.write_all(&image.bytes)?;
    }
    zip.start_file("3D/3dmodel.model", options).map_err(std::io::Error::from)?;
    write_model(scene, &album, unit, &mut zip)?;
    let bytes = zip.finish().map_err(std::io::Error::from)?.into_inner();
    Ok(out.write_all(&bytes)?)
}

fn write_model(scene: &Scene, album: &Album, unit: Option<Unit>, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = TextOut::new(out);
    text.text("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model");
    if let Some(unit) = unit {
        text.text(&format!(" unit=\"{}\"", unit.word()));
    }
    text.text(" xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"");
    text.text(" xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\">\n");
    text.text("<metadata name=\"Application\">meshwright</metadata>\n<resources>\n");
    write_resources(scene, album, &mut text);
    let mut next = MATERIALS + 1 + album.pictures.iter().flatten().count() as u32;
    let mut ids = Vec::with_capacity(scene.objects.len());
    for object in &scene.objects {
        let shown = shown(scene, object);
        let object = shown.as_ref().unwrap_or(object);
        let written = Written::new(object, |t| look(scene, album, object, t), &mut next);
        written.write_groups(&mut text)?;
        text.text(&format!("<object id=\"{next}\" type=\"model\""));
        if !object.name.is_empty() {
            text.text(&format!(" name=\"{}\"", escape(&object.name)));
        }
        if let Some((group, entry)) = written.first_property() {
            text.text(&format!(" pid=\"{group}\" pindex=\"{entry}\""));
        }
        text.text("><mesh>\n<vertices>\n");
        write_vertices(&object.mesh, "", &mut text)?;
        text.text("</vertices>\n<triangles>\n");
        written.write_triangles(0, "", &mut text)?;
        text.text("</triangles>\n</mesh></object>\n");
        ids.push(next);
        next += 1;
    }
    text.text("</resources>\n<build>\n");
    for place in &scene.placements {
        text.text(&format!("<item objectid=\"{}\"", ids[place.object]));
        if place.transform != DAffine3::IDENTITY {
            text.text(" transform=\"");
            for (n, x) in place.transform.to_cols_array().into_iter().enumerate() {
                text.text(if n > 0 { " " } else { "" });
                text.number(x);
            }
            text.text("\"");
        }
        if !place.name.is_empty() && place.name != scene.objects[place.object].name {
            text.text(&format!(" partnumber=\"{}\"", escape(&place.name)));
        }
        text.text("/>\n");
    }
    text.text("</build>\n</model>\n");
    text.finish()
}

/// The base materials and the images.
fn write_resources(scene: &Scene, album: &Album, text: &mut TextOut<'_>) {
    if !scene.materials.is_empty() {
        text.text(&format!("<basematerials id=\"{MATERIALS}\">\n"));
        for own in &scene.materials {
            let [red, green, blue, alpha] = own.material.colour.unwrap_or(WHITE);
            let name = if own.material.name.is_empty() { "material" } else { &own.material.name };
            let name = escape(name);
            text.text(&format!(
                "<base name=\"{name}\" displaycolor=\"#{red:02X}{green:02X}{blue:02X}{alpha:02X}\"/>\n"
            ));
        }
        text.text("</basematerials>\n");
    }
    for (image, picture) in scene.images.iter().zip(&album.pictures) {
        let Some((number, path)) = picture else { continue };
        let kind = image.media_type().unwrap_or_default();
        text.text(&format!("<m:texture2d id=\"{number}\" path=\"{path}\" contenttype=\"{kind}\"/>\n"));
    }
}

/// What a triangle of an object has. Colours of its own stand for those of its material, which are multiplied into them.
fn look(scene: &Scene, album: &Album, object: &SceneObject, triangle: usize) -> Look {
    let material = scene.material_of(object, triangle);
    if let Some(image) = material.and_then(|(_, own)| album.number(own.material.image)) {
        return Look::Picture(image);
    }
    match (&object.colours, material) {
        (Some(_), _) => Look::Colours,
        (None, Some((number, _))) => Look::Entry { group: MATERIALS, entry: number as u32 },
        (None, None) => Look::Inherited,
    }
}

/// An object with the colours of its materials multiplied into its own, where it has some.
fn shown(scene: &Scene, object: &SceneObject) -> Option<SceneObject> {
    let colours = object.colours.as_ref()?;
    let corners = |t: usize| {
        let colour = scene.material_of(object, t).and_then(|(_, own)| own.material.colour);
        colours.corners(&object.mesh, t).map(|own| colour.map_or(own, |colour| times(own, colour)))
    };
    let corners = (0..object.mesh.triangles.len()).map(corners).collect();
    Some(SceneObject { colours: Some(Colours::of_corners(corners, &object.mesh)), ..object.clone() })
}

/// One colour seen through another: multiplied in linear light.
fn times(a: Rgba, b: Rgba) -> Rgba {
    let channel = |k: usize| match (a[k], b[k]) {
        (255, other) | (other, 255) => other,
        (a, b) => srgb_from_linear(linear_from_srgb(a) * linear_from_srgb(b)).unwrap_or(0),
    };
    [channel(0), channel(1), channel(2), (u32::from(a[3]) * u32::from(b[3]) / 255) as u8]
}
