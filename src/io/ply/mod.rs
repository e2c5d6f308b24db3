//! PLY: a header that declares elements and their properties, then the data, as text or binary.

mod colour;
mod face_map;
mod header;
mod rows;
mod texture;
mod vertex_map;
mod write;

use std::path::Path;

use glam::DVec3;

use self::colour::Channels;
use self::header::{Element, Header};
use self::rows::Rows;
use self::texture::{OfFaces, OfVertices};
use super::error::{FileError, FileProblem};
use super::soup::{Soup, too_many_vertices};
use super::{Format, Loaded};

pub use face_map::{FaceMap, encode_face_map};
pub use vertex_map::{VertexMap, encode_vertex_map};
pub(super) use write::{write_ascii, write_binary};

/// Reads the file at `path`, beside which its images lie.
pub(super) fn read(bytes: &[u8], path: Option<&Path>) -> Result<Loaded, FileError> {
    let header = Header::read(bytes)?;
    let vertices = header.element("vertex").ok_or_else(|| {
        FileError::line(header.lines, FileProblem::syntax("an element `vertex` in the header", "none"))
    })?;
    let mut rows = Rows::new(bytes, &header);
    let mut soup = Soup::new();
    let mut waiting = Vec::new();
    let mut of_vertices = OfVertices::default();
    for (i, element) in header.elements.iter().enumerate() {
        if i == vertices {
            read_vertices(element, &mut rows, &mut soup, &mut of_vertices)?;
        } else if let Some(faces) = Faces::of(element) {
            // Faces may stand before the vertices they refer to: they are gone back to.
            if i < vertices {
                waiting.push((element, faces, rows.clone()));
                rows.pass_over(element)?;
            } else {
                faces.read(element, &mut rows, &mut soup)?;
            }
        } else {
            rows.pass_over(element)?;
        }
    }
    for (element, faces, mut rows) in waiting {
        faces.read(element, &mut rows, &mut soup)?;
    }
    of_vertices.spread(&mut soup);
    texture::hang(&header.images, path, &mut soup);
    let loaded = soup.finish(Format::Ply, None)?;
    Ok(Loaded { legend: header.legend, scale: header.scale, ..loaded })
}

fn read_vertices(
    element: &Element,
    rows: &mut Rows<'_>,
    soup: &mut Soup,
    of_vertices: &mut OfVertices,
) -> Result<(), FileError> {
    let axis = |name: &str| {
        let found = element.properties.iter().position(|p| p.name == name && p.list.is_none());
        let fail = || FileProblem::syntax(format!("a property `{name}` of `vertex`"), "none");
        found.ok_or_else(|| FileError::line(element.line, fail()))
    };
    let axes = [axis("x")?, axis("y")?, axis("z")?];
    rows.can_hold(element)?;
    if u32::try_from(element.count).is_err() {
        return Err(too_many_vertices());
    }
    soup.positions.reserve_exact(element.count);
    let channels = Channels::of(element, &mut soup.colours.vertices, &mut soup.warnings);
    of_vertices.begin(element);
    for vertex in 0..element.count {
        rows.next(element)?;
        soup.positions.push(DVec3::from(axes.map(|axis| rows.scalar(axis))));
        if let Some(channels) = &channels {
            soup.colours.vertices.put(vertex..vertex + 1, channels.levels(rows));
        }
        of_vertices.take(rows);
    }
    Ok(())
}

/// An element that holds faces.
#[derive(Debug, Clone, Copy)]
enum Faces {
    /// A polygon a row; the property of its corners.
    Polygons(usize),
    /// Strips, cut by −1, in one or more rows; the property of their corners.
    Strips(usize),
}

impl Faces {
    fn of(element: &Element) -> Option<Self> {
        let list = || {
            let named = |name: &str| element.properties.iter().position(|p| p.name == name && p.list.is_some());
            named("vertex_indices").or_else(|| named("vertex_index"))
        };
        match element.name.as_str() {
            "face" => list().map(Self::Polygons),
            "tristrips" => list().map(Self::Strips),
            _ => None,
        }
    }

    fn read(self, element: &Element, rows: &mut Rows<'_>, soup: &mut Soup) -> Result<(), FileError> {
        rows.can_hold(element)?;
        let count = soup.positions.len();
        if let Self::Polygons(_) = self {
            soup.triangles.reserve(element.count);
        }
        let channels = Channels::of(element, &mut soup.colours.faces, &mut soup.warnings);
        let mut textures = OfFaces::of(element);
        let mut corners = Vec::new();
        for _ in 0..element.count {
            rows.next(element)?;
            let first = soup.triangles.len();
            let (Self::Polygons(list) | Self::Strips(list)) = self;
            let values = rows.list(list);
            match self {
                Self::Polygons(_) => indices(values, count, &mut corners).map(|()| textures.face(&corners, rows, soup)),
                Self::Strips(_) => values
                    .split(|&v| v == -1.0)
                    .try_for_each(|strip| indices(strip, count, &mut corners).map(|()| soup.strip(&corners))),
            }
            .map_err(|problem| rows.fail(problem))?;
            if let Some(channels) = &channels {
                soup.colours.faces.put(first..soup.triangles.len(), channels.levels(rows));
            }
        }
        Ok(())
    }
}

fn indices(values: &[f64], count: usize, corners: &mut Vec<u32>) -> Result<(), FileProblem> {
    corners.clear();
    for &value in values {
        // Written so that NaN is out of range too.
        if !(value >= 0.0 && value < count as f64 && value.fract() == 0.0) {
            return Err(FileProblem::vertex(value as i64, count));
        }
        corners.push(value as u32);
    }
    Ok(())
}
