//! Whether a file of several objects holds what was written to it.

use glam::{DAffine3, DVec3};

use super::entries::{ObjectDone, ObjectEntry};
use super::exit::Failure;
use super::session::Session;
use super::streams::is_stream;
use super::target::Target;
use crate::fit::rounded;
use crate::io::{self, Format, Placement, Rgba, Scene, SceneObject};
use crate::mesh::{ValidateOptions, Validity, validate};

/// Transforms of glTF are in single precision: so near they must come back, times the largest of their numbers.
const NEAR: f64 = 1e-6;

/// What was written.
pub struct Written<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Where to.
    pub target: &'a Target,
    /// Whether it is the file that was read, with other meshes.
    pub is_kept: bool,
}

/// Looks at the bytes of a written file. Returns the state of each object of those that were read, where it is to be a solid: of several
/// that were made of one, the first that is none, or else the first.
pub fn judge(
    bytes: &[u8],
    written: &Written<'_>,
    entries: &[ObjectEntry],
    count: usize,
    session: &Session,
) -> Result<Vec<Option<Validity>>, Failure> {
    let target = written.target;
    let name = (!is_stream(&target.path)).then_some(target.path.as_path());
    let read = io::read_scene(bytes, Some(target.options.format), name)
        .map_err(|e| Failure::internal(format!("the written file does not read back: {e}")))?;
    check(&read, written)?;
    let mut found: Vec<Option<Validity>> = vec![None; count];
    for (own, meant) in read.objects.iter().zip(&written.scene.objects) {
        let number = meant.number;
        let is_solid =
            entries.get(number).is_some_and(|entry| matches!(entry.done, ObjectDone::Repaired | ObjectDone::Kept));
        if !is_solid {
            continue;
        }
        let options = ValidateOptions { self_intersections: true, weld: read.format.repeats_vertices() };
        let validity = validate(&own.mesh, &options, &session.progress)?;
        if !validity.is_valid() {
            let problems = validity.problems().join("; ");
            let name = if own.name.is_empty() { "without a name" } else { &own.name };
            return Err(Failure::new(
                super::exit::Exit::Limit,
                format!(
                    "the object {} ({name}) is not a valid solid in the written file ({problems}); it was not written",
                    number + 1
                ),
            )
            .hint("another format: 3MF keeps objects and all digits; or another --resolution or --voxel"));
        }
        found[number].get_or_insert(validity);
    }
    Ok(found)
}

/// Whether all objects are there, where they belong and as they should look.
fn check(read: &Scene, written: &Written<'_>) -> Result<(), Failure> {
    let wrong = |what: &str| {
        Err(Failure::internal(format!("the file does not hold {what} that were written to it; it was removed")))
    };
    let (scene, options) = (written.scene, &written.target.options);
    if read.objects.len() != scene.objects.len() || read.placements.len() != scene.placements.len() {
        return wrong("the objects");
    }
    let names = |scene: &Scene| scene.objects.iter().map(|object| object.name.clone()).collect::<Vec<_>>();
    if names(read) != names(scene) {
        return wrong("the names");
    }
    let factor = if written.is_kept { 1.0 } else { options.factor() };
    let has_names = written.is_kept || matches!(options.format, Format::Glb | Format::Gltf);
    let is_placed = |(a, b): (&Placement, &Placement)| {
        a.object == b.object && (!has_names || a.name == b.name) && is_near(&a.transform, &b.transform, factor)
    };
    if !read.placements.iter().zip(&scene.placements).all(is_placed) {
        return wrong("the places");
    }
    for (own, meant) in read.objects.iter().zip(&scene.objects) {
        if !is_mesh(own, meant, options.format.is_single()) {
            return wrong("the triangles");
        }
        if !looks_alike((read, own), (scene, meant), options.format, written.is_kept) {
            return wrong("the colours, materials and textures");
        }
    }
    Ok(())
}

fn is_near(read: &DAffine3, meant: &DAffine3, factor: f64) -> bool {
    let meant = (DAffine3::from_scale(DVec3::splat(factor)) * *meant).to_cols_array();
    let largest = meant.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    read.to_cols_array().iter().zip(meant).all(|(a, b)| (a - b).abs() <= NEAR * largest)
}

fn is_mesh(read: &SceneObject, meant: &SceneObject, single: bool) -> bool {
    let place = |p: DVec3| if single { rounded(p) } else { p };
    read.mesh.triangles.len() == meant.mesh.triangles.len()
        && (0..meant.mesh.triangles.len()).all(|t| read.mesh.corners(t) == meant.mesh.corners(t).map(place))
}

/// Whether an object looks as it should, as far as the format holds that.
fn looks_alike(
    (read, own): (&Scene, &SceneObject),
    (scene, meant): (&Scene, &SceneObject),
    format: Format,
    is_kept: bool,
) -> bool {
    let white = [255; 4];
    let corners = |object: &SceneObject, t: usize| {
        object.colours.as_ref().map_or([white; 3], |colours| colours.corners(&object.mesh, t))
    };
    let material = |scene: &Scene, object: &SceneObject, t: usize| {
        let name = &object.texture.as_ref()?.material(t)?.name;
        scene.material_called(name).map(|(_, own)| own.material.clone())
    };
    let at = |object: &SceneObject, t: usize| object.texture.as_ref().and_then(|texture| texture.at(t, false));
    (0..meant.mesh.triangles.len()).all(|t| {
        let (a, b) = (material(read, own, t), material(scene, meant, t));
        let image = |scene: &Scene, material: &Option<io::Material>| {
            let image = scene.images.get(material.as_ref()?.image? as usize)?;
            image.media_type().map(|_| image.bytes.clone())
        };
        match format {
            // Files beside it are not there yet, and colours are those of vertices.
            Format::Obj => at(own, t) == at(meant, t),
            Format::ThreeMf if at(meant, t).is_some() && image(scene, &b).is_some() => {
                at(own, t) == at(meant, t) && image(read, &a) == image(scene, &b)
            }
            // Colours are multiplied into those of materials.
            Format::ThreeMf if !is_kept && meant.colours.is_some() => true,
            _ => {
                let colour =
                    |material: &Option<io::Material>| material.as_ref().and_then(|m| m.colour).unwrap_or(white);
                let same_places = format == Format::ThreeMf || at(own, t) == at(meant, t);
                let shown = |own: [Rgba; 3], material: Rgba| own.map(|own| times(own, material));
                shown(corners(own, t), colour(&a)) == shown(corners(meant, t), colour(&b))
                    && same_places
                    && (format == Format::ThreeMf || image(read, &a) == image(scene, &b))
            }
        }
    })
}

/// A colour under another: the same wherever one of the two is white.
fn times(a: Rgba, b: Rgba) -> Rgba {
    std::array::from_fn(|k| (u16::from(a[k]) * u16::from(b[k]) / 255) as u8)
}
