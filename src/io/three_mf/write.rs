//! Writing: one object, placed once.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::super::error::WriteError;
use super::super::text::TextOut;
use crate::io::Unit;
use crate::mesh::TriMesh;

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// Writes a package. Without a unit the model states none, which means millimetres.
pub(in crate::io) fn write(mesh: &TriMesh, unit: Option<Unit>, out: &mut dyn Write) -> Result<(), WriteError> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    // A fixed date: the same mesh gives the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::default())
        .large_file(3 * mesh.positions.len() + 2 * mesh.triangles.len() > (u32::MAX / 64) as usize);
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONSHIPS)] {
        zip.start_file(name, options).map_err(std::io::Error::from)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options).map_err(std::io::Error::from)?;
    write_model(mesh, unit, &mut zip)?;
    let bytes = zip.finish().map_err(std::io::Error::from)?.into_inner();
    Ok(out.write_all(&bytes)?)
}

fn write_model(mesh: &TriMesh, unit: Option<Unit>, out: &mut dyn Write) -> std::io::Result<()> {
    let mut text = TextOut::new(out);
    text.text("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model");
    if let Some(unit) = unit {
        text.text(&format!(" unit=\"{}\"", unit.word()));
    }
    text.text(" xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n");
    text.text("<metadata name=\"Application\">meshwright</metadata>\n");
    text.text("<resources><object id=\"1\" type=\"model\"><mesh>\n<vertices>\n");
    for p in &mesh.positions {
        for (start, x) in ["<vertex x=\"", "\" y=\"", "\" z=\""].into_iter().zip(p.to_array()) {
            text.text(start);
            text.number(x);
        }
        text.text("\"/>\n");
        text.pass_on()?;
    }
    text.text("</vertices>\n<triangles>\n");
    for t in &mesh.triangles {
        for (start, v) in ["<triangle v1=\"", "\" v2=\"", "\" v3=\""].into_iter().zip(t) {
            text.text(start);
            text.integer(u64::from(*v));
        }
        text.text("\"/>\n");
        text.pass_on()?;
    }
    text.text("</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n");
    text.finish()
}
