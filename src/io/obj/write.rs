//! Writing: vertices with or without colours, texture coordinates, faces by material.

use std::io::Write;

use rustc_hash::FxHashMap;

use super::super::colour::vertex_means;
use super::super::error::WriteError;
use super::super::text::TextOut;
use super::super::texture::{TextureMap, library_name};
use super::super::{Paint, Part};
use crate::mesh::TriMesh;

/// Writes positions, with a colour after each if there are colours, texture coordinates and triangles, and the names of `parts` before theirs.
pub(in crate::io) fn write(
    mesh: &TriMesh,
    paint: &Paint<'_>,
    parts: &[Part],
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut text = TextOut::new(out);
    let texture = paint.texture;
    if let (Some(path), true) = (paint.beside, texture.is_some_and(TextureMap::has_library)) {
        text.text(&format!("mtllib {}\n", library_name(path)));
    }
    let colours = paint.colours.map(|colours| vertex_means(mesh, colours));
    text.each(mesh.positions.len(), |vertex, text| {
        text.text("v");
        for x in mesh.positions[vertex].to_array() {
            text.text(" ");
            text.number(x);
        }
        if let Some(colour) = colours.as_ref().and_then(|colours| colours.get(vertex)) {
            for level in &colour[..3] {
                text.text(" ");
                text.level(*level);
            }
        }
        text.text("\n");
    })?;
    let corners = texture.map(|texture| write_coordinates(texture, &mut text)).transpose()?.unwrap_or_default();
    let names = texture.map(TextureMap::material_names).unwrap_or_default();
    let material_of = |triangle: usize| texture.and_then(|texture| texture.material_of[triangle]);
    text.each(mesh.triangles.len(), |triangle, text| {
        if let Ok(part) = parts.binary_search_by_key(&triangle, |part| part.triangles.start) {
            text.text(&format!("o {}\n", parts[part].name));
        }
        let material = material_of(triangle);
        if material != triangle.checked_sub(1).and_then(material_of) {
            let name = material.and_then(|material| names.get(material as usize)).map_or("none", String::as_str);
            text.text(&format!("usemtl {name}\n"));
        }
        text.text("f");
        for (k, v) in mesh.triangles[triangle].iter().enumerate() {
            text.text(" ");
            text.integer(u64::from(*v) + 1);
            if let Some(corners) = corners.get(triangle).copied().flatten() {
                text.text("/");
                text.integer(u64::from(corners[k]) + 1);
            }
        }
        text.text("\n");
    })?;
    Ok(text.finish()?)
}

/// Writes each different pair of coordinates once, in the order of first use, and returns their numbers by triangle.
fn write_coordinates(texture: &TextureMap, text: &mut TextOut<'_>) -> std::io::Result<Vec<Option<[u32; 3]>>> {
    let mut numbers: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let mut of_triangles = Vec::with_capacity(texture.coordinates.len());
    for triangle in 0..texture.coordinates.len() {
        let corners = texture.at(triangle, false).map(|corners| {
            corners.map(|pair| {
                let next = numbers.len() as u32;
                let number = *numbers.entry(pair.map(f32::to_bits)).or_insert(next);
                if number == next {
                    text.text("vt ");
                    text.short_number(pair[0]);
                    text.text(" ");
                    text.short_number(pair[1]);
                    text.text("\n");
                }
                number
            })
        });
        of_triangles.push(corners);
        text.pass_on()?;
    }
    Ok(of_triangles)
}
