//! Colours and textures of what is written: what the format loses of them, the order that it needs, and the files beside it.

use std::borrow::Cow;

use super::exit::Failure;
use super::session::Session;
use super::target::Target;
use super::{side, streams};
use crate::io::draft::folder_of;
use crate::io::{Carried, Colours, Format, Loaded, Paint, TextureMap};
use crate::mesh::TriMesh;

/// A mesh with its colours and textures, the triangles in an order that the format keeps.
pub struct Arranged<'a> {
    pub mesh: Cow<'a, TriMesh>,
    pub colours: Option<Cow<'a, Colours>>,
    pub texture: Option<Cow<'a, TextureMap>>,
}

impl<'a> Arranged<'a> {
    /// For glTF, which has the triangles of a material in one piece, in the order of the materials; else as they are.
    pub fn new(mesh: &'a TriMesh, paint: &Paint<'a>, format: Format) -> Self {
        let as_it_is = Self {
            mesh: Cow::Borrowed(mesh),
            colours: paint.colours.map(Cow::Borrowed),
            texture: paint.texture.map(Cow::Borrowed),
        };
        let pieces = matches!(format, Format::Glb | Format::Gltf);
        let (Some(texture), true) = (paint.texture.filter(|texture| texture.fits(mesh)), pieces) else {
            return as_it_is;
        };
        let Some(order) = texture.by_material() else { return as_it_is };
        let triangles = order.iter().map(|&t| mesh.triangles[t as usize]).collect();
        let colours = paint.colours.map(|colours| match colours {
            Colours::Vertices(_) => Cow::Borrowed(colours),
            Colours::Faces(list) => Cow::Owned(Colours::Faces(order.iter().map(|&t| list[t as usize]).collect())),
            Colours::Corners(list) => Cow::Owned(Colours::Corners(order.iter().map(|&t| list[t as usize]).collect())),
        });
        Self {
            mesh: Cow::Owned(TriMesh { positions: mesh.positions.clone(), triangles }),
            colours,
            texture: Some(Cow::Owned(texture.picked(&order))),
        }
    }

    /// What it looks like.
    pub fn paint(&self) -> Paint<'_> {
        Paint { colours: self.colours.as_deref(), texture: self.texture.as_deref(), beside: None }
    }
}

/// What becomes of colours and textures that the format has no place for.
pub fn lost(mesh: &TriMesh, paint: &Paint<'_>, target: &Target) -> Vec<String> {
    paint.lost_in(target.options.format, mesh, !streams::is_direct(&target.path))
}

/// Whether the file as read back has the colours, as far as its format holds them.
pub fn check_colours(read: &Loaded, mesh: &TriMesh, paint: &Paint<'_>) -> Result<(), Failure> {
    let Some(colours) = paint.colours else { return Ok(()) };
    let same =
        |found: &Colours| (0..mesh.triangles.len()).all(|t| colours.corners(mesh, t) == found.corners(&read.mesh, t));
    // Beside a texture a reader takes white for nothing.
    let white = || (0..mesh.triangles.len()).all(|t| colours.corners(mesh, t) == [[255; 4]; 3]);
    let covered = paint.texture_covers_colours(read.format);
    let found = |read: &Loaded| match &read.colours {
        Some(found) => same(found),
        None => read.texture.is_some() && white(),
    };
    match colours.carried_by(read.format, mesh) {
        Carried::Wholly if !covered && !found(read) => {
            Err(Failure::internal("the file does not hold the colours that were written to it; it was removed"))
        }
        _ => Ok(()),
    }
}

/// Whether the file as read back has the textures, as far as its format holds them.
pub fn check_texture(read: &Loaded, paint: &Paint<'_>) -> Result<(), Failure> {
    match paint.texture {
        Some(texture) if !texture.is_held(read.texture.as_ref(), read.format) => {
            Err(Failure::internal("the file does not hold the textures that were written to it; it was removed"))
        }
        _ => Ok(()),
    }
}

/// Writes the files of materials and images that belong beside the mesh. They get their names with it.
pub fn write_beside(target: &Target, texture: &TextureMap, session: &Session) -> Result<(), Failure> {
    if streams::is_direct(&target.path) {
        return Ok(());
    }
    for file in texture.side_files(target.options.format, &target.path) {
        let path = folder_of(&target.path).join(&file.name);
        if session.kept.contain(&path) {
            let name = path.display();
            let message = format!("{name} belongs to the textures of the output, and is another file of this run, too");
            return Err(Failure::usage(message).hint("another name for one of them"));
        }
        if file.is_at(&path) {
            continue;
        }
        if !session.kept.force && texture.was_read_from(&path).map_err(|error| streams::unwritable(&path, &error))? {
            let message = format!("{} belongs to the textures of an input and would be overwritten", path.display());
            return Err(Failure::usage(message).hint("another name after -o, or --force"));
        }
        side::write_side(&path, &file.bytes, session)?;
    }
    Ok(())
}
