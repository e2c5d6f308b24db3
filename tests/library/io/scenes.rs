//! Scenes: what is read as objects is the same mesh as what is read as a whole, and comes back from every format.

use std::path::Path;

use glam::{DAffine3, DVec3};
use meshwright::io::{Format, Placement, Scene, WriteOptions, encode_scene, read_bytes, read_scene};
use meshwright::mesh::TriMesh;
use proptest::prelude::*;

use super::mutants::{apply, change, originals, packed};
use super::support::tetrahedron;

const FORMATS: [Format; 4] = [Format::Obj, Format::Glb, Format::Gltf, Format::ThreeMf];

/// Files that may have objects.
fn files() -> impl Iterator<Item = (Format, Vec<u8>)> {
    let all = originals().into_iter().filter(|(format, _)| format.has_objects());
    all.map(|(format, original)| (format, packed(format, &original, original.clone())))
}

fn encoded(scene: &Scene, format: Format) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let options = WriteOptions { unit: scene.unit, ..WriteOptions::new(format) };
    encode_scene(scene, &options, None, &mut bytes).map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// All places of all objects.
fn placed(scene: &Scene) -> Vec<[DVec3; 3]> {
    let corners = |place: &Placement| {
        let mesh = &scene.objects[place.object].mesh;
        let turned = |[a, b, c]: [DVec3; 3]| if place.is_mirrored() { [a, c, b] } else { [a, b, c] };
        let at = |t: usize| turned(mesh.corners(t)).map(|p| place.transform.transform_point3(p));
        (0..mesh.triangles.len()).map(at).collect::<Vec<_>>()
    };
    scene.placements.iter().flat_map(corners).collect()
}

#[test]
fn a_file_read_as_objects_is_the_file_read_as_a_whole() {
    for (format, bytes) in files() {
        let Ok(whole) = read_bytes(&bytes, Some(format), None) else { continue };
        // What is taken away from the whole, or left out of it, is no object.
        let scene = read_scene(&bytes, Some(format), None).unwrap_or_else(|error| panic!("{format}: {error}"));
        assert_eq!(scene.unit, whole.unit);
        assert_eq!(scene.parts.len(), whole.parts.len(), "{format}");
        for (part, own) in whole.parts.iter().zip(&scene.parts) {
            assert_eq!(part.name, own.name, "{format}");
        }
        if scene.parts.iter().any(|part| part.object.is_none()) {
            continue;
        }
        let mut found = placed(&scene);
        let mut wanted: Vec<[DVec3; 3]> = (0..whole.mesh.triangles.len()).map(|t| whole.mesh.corners(t)).collect();
        let key = |t: &[DVec3; 3]| t.map(|p| (p + 0.0).to_array().map(|x| (x * 1e6).round() as i64));
        found.sort_by_key(key);
        wanted.sort_by_key(key);
        let near = |a: DVec3, b: DVec3| (a - b).length() <= 1e-9 * a.length().max(1e-6);
        assert_eq!(found.len(), wanted.len(), "{format}");
        assert!(found.iter().flatten().zip(wanted.iter().flatten()).all(|(a, b)| near(*a, *b)), "{format}");
    }
}

/// Two objects, one of them placed twice, and once as its mirror image.
fn assembly() -> Scene {
    let obj = b"o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\no two\nv 5 0 0\nv 6 0 0\nv 5 1 0\nv 5 0 1\nf 5 7 6\nf 5 6 8\nf 6 7 8\nf 7 5 8\n";
    let mut scene = read_scene(obj, None, None).expect("two objects");
    let mirror = DAffine3::from_scale(DVec3::new(1.0, -1.0, 1.0));
    let moved = DAffine3::from_translation(DVec3::new(0.5, 8.0, -3.0));
    for (name, transform) in [("again", moved), ("mirrored", moved * mirror)] {
        scene.placements.push(Placement { object: 0, name: name.into(), transform });
    }
    scene
}

#[test]
fn objects_and_places_come_back_from_every_format() {
    let scene = assembly();
    let volume = |scene: &Scene| {
        let of = |[a, b, c]: &[DVec3; 3]| a.dot(b.cross(*c)) / 6.0;
        placed(scene).iter().map(of).sum::<f64>()
    };
    assert!((volume(&scene) - 4.0 / 6.0).abs() < 1e-12);
    for (format, objects, notes) in
        [(Format::Obj, 4, 1), (Format::Glb, 2, 0), (Format::Gltf, 2, 0), (Format::ThreeMf, 3, 1)]
    {
        let (suited, said) = scene.clone().suited_to(format).expect("few instances");
        assert_eq!((suited.objects.len(), said.len()), (objects, notes), "{format}: {said:?}");
        let bytes = encoded(&suited, format).expect("sound");
        let back = read_scene(&bytes, None, None).expect("ours");
        assert_eq!((back.objects.len(), back.placements.len()), (objects, 4), "{format}");
        assert!((volume(&back) - 4.0 / 6.0).abs() < 1e-6, "{format}: {}", volume(&back));
        assert_eq!(back.objects[0].name, "one");
        // Written again it is the same.
        let (again, _) = back.clone().suited_to(format).expect("few instances");
        let again = read_scene(&encoded(&again, format).expect("sound"), None, None).expect("ours");
        assert_eq!((again.objects, again.placements), (back.objects, back.placements), "{format}");
    }
    for format in [Format::Stl, Format::Ply, Format::Off] {
        assert!(encoded(&scene, format).is_err());
    }
    assert!(read_scene(b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", None, None).is_err());
}

#[test]
fn instances_that_obj_would_unfold_without_end_are_refused() {
    let mut scene = assembly();
    let place = scene.placements[0].clone();
    scene.placements.resize(1_000_000, place);
    assert!(scene.suited_to(Format::Obj).is_err());
}

/// Whatever was read can be replaced, suited to every format and written, or is refused; and what is written reads back.
fn no_panic(bytes: &[u8], format: Format) {
    let Ok(scene) = read_scene(bytes, Some(format), Some(Path::new("a.x"))) else { return };
    for other in FORMATS {
        let mut scene = scene.clone();
        for number in 0..scene.objects.len() {
            scene.replace(number, tetrahedron(), None, None);
        }
        let Ok((suited, _)) = scene.suited_to(other) else { continue };
        if let Ok(bytes) = encoded(&suited, other) {
            let back = read_scene(&bytes, Some(other), None).unwrap_or_else(|e| panic!("{format} to {other}: {e}"));
            let whole = |mesh: &TriMesh| mesh.triangles.len() == 4;
            assert!(back.objects.iter().all(|object| whole(&object.mesh)), "{format} to {other}");
        }
    }
}

#[test]
fn samples_can_be_replaced_in_every_format() {
    files().for_each(|(format, bytes)| no_panic(&bytes, format));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]
    #[test]
    fn changed_files_do_no_more_than_return_an_error(
        which in any::<prop::sample::Index>(),
        changes in prop::collection::vec(change(), 1..4),
    ) {
        let all: Vec<_> = originals().into_iter().filter(|(format, _)| format.has_objects()).collect();
        let (format, original) = &all[which.index(all.len())];
        let mut bytes = original.clone();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        let (format, bytes) = (*format, packed(*format, original, bytes));
        if let Ok(scene) = read_scene(&bytes, Some(format), None) {
            for other in FORMATS {
                let mut scene = scene.clone();
                (0..scene.objects.len()).for_each(|number| scene.replace(number, tetrahedron(), None, None));
                if let Ok((suited, _)) = scene.suited_to(other) {
                    let _ = encoded(&suited, other);
                }
            }
        }
    }
}
