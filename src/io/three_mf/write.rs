//! Writing: one object, placed once.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::super::colour::Colours;
use super::super::error::WriteError;
use super::super::text::TextOut;
use super::palette::Palette;
use super::pictures::Pictures;
use crate::io::{Paint, Unit, shown_colours};
use crate::mesh::TriMesh;

pub(super) const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

pub(super) const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// What is added to the types of files where there are images.
pub(super) const TYPES_OF_IMAGES: &str = r#"<Default Extension="png" ContentType="image/png"/><Default Extension="jpg" ContentType="image/jpeg"/><Default Extension="jpeg" ContentType="image/jpeg"/></Types>"#;

/// Writes a package. Without a unit the model states none, which means millimetres.
pub(in crate::io) fn write(
    mesh: &TriMesh,
    paint: &Paint<'_>,
    unit: Option<Unit>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let colours = shown_colours(paint.colours, paint.texture);
    let pictures = paint.texture.map(Pictures::of).filter(|pictures| !pictures.list.is_empty());
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    // A fixed date: the same mesh gives the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .large_file(3 * mesh.positions.len() + 4 * mesh.triangles.len() > (u32::MAX / 64) as usize);
    let types = match &pictures {
        Some(_) => TYPES.replace("</Types>", TYPES_OF_IMAGES),
        None => TYPES.to_owned(),
    };
    let mut files = vec![("[Content_Types].xml", types), ("_rels/.rels", RELATIONSHIPS.to_owned())];
    files.extend(pictures.as_ref().map(|pictures| ("3D/_rels/3dmodel.model.rels", pictures.relationships())));
    for (name, text) in files {
        zip.start_file(name, options).map_err(std::io::Error::from)?;
        zip.write_all(text.as_bytes())?;
    }
    // Images are packed already.
    let stored = options.compression_method(CompressionMethod::Stored);
    for (path, image) in pictures.iter().flat_map(Pictures::files) {
        zip.start_file(path, stored.large_file(image.len() > u32::MAX as usize)).map_err(std::io::Error::from)?;
        zip.write_all(image)?;
    }
    zip.start_file("3D/3dmodel.model", options).map_err(std::io::Error::from)?;
    write_model(mesh, colours.as_deref(), pictures.as_ref(), unit, &mut zip)?;
    let bytes = zip.finish().map_err(std::io::Error::from)?.into_inner();
    Ok(out.write_all(&bytes)?)
}

fn write_model(
    mesh: &TriMesh,
    colours: Option<&Colours>,
    pictures: Option<&Pictures<'_>>,
    unit: Option<Unit>,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let is_picture = |t: usize| pictures.is_some_and(|pictures| pictures.of_triangle(t).is_some());
    // Where triangles have properties all have one, or they would get that of the object.
    let has_palette = match pictures {
        Some(_) => (0..mesh.triangles.len()).any(|t| !is_picture(t)),
        None => colours.is_some(),
    };
    let palette = has_palette.then(|| Palette::new(2, mesh, colours, |t| !is_picture(t)));
    let mut text = TextOut::new(out);
    text.text("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model");
    if let Some(unit) = unit {
        text.text(&format!(" unit=\"{}\"", unit.word()));
    }
    text.text(" xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"");
    if palette.is_some() || pictures.is_some() {
        text.text(" xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"");
    }
    text.text(">\n");
    text.text("<metadata name=\"Application\">meshwright</metadata>\n");
    text.text("<resources>");
    if let Some(palette) = &palette {
        palette.write_group(&mut text)?;
    }
    if let Some(pictures) = pictures {
        pictures.write_groups(&mut text)?;
    }
    text.text("<object id=\"1\" type=\"model\"");
    // Where triangles have properties the object shall have one too.
    match (&palette, pictures) {
        (Some(_), _) => text.text(" pid=\"2\" pindex=\"0\""),
        (None, Some(pictures)) => text.text(&format!(" pid=\"{}\" pindex=\"0\"", pictures.group(0))),
        (None, None) => {}
    }
    text.text("><mesh>\n<vertices>\n");
    write_vertices(mesh, "", &mut text)?;
    text.text("</vertices>\n<triangles>\n");
    text.each(mesh.triangles.len(), |triangle, text| {
        for (start, v) in ["<triangle v1=\"", "\" v2=\"", "\" v3=\""].into_iter().zip(mesh.triangles[triangle]) {
            text.text(start);
            text.integer(u64::from(v));
        }
        match (pictures.filter(|_| is_picture(triangle)), &palette) {
            (Some(pictures), _) => pictures.write_entries(triangle, text),
            (None, Some(palette)) => palette.write_entries(triangle, text),
            (None, None) => {}
        }
        text.text("\"/>\n");
    })?;
    text.text("</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n");
    text.finish()
}

/// Writes the vertices; `prefix`: what stands before the names of elements.
pub(super) fn write_vertices(mesh: &TriMesh, prefix: &str, text: &mut TextOut<'_>) -> std::io::Result<()> {
    text.each(mesh.positions.len(), |vertex, text| {
        text.text("<");
        text.text(prefix);
        let places = mesh.positions[vertex].to_array();
        for (start, x) in ["vertex x=\"", "\" y=\"", "\" z=\""].into_iter().zip(places) {
            text.text(start);
            text.number(x);
        }
        text.text("\"/>\n");
    })
}
