//! The meshes of `testdata/`.

use meshwright::io::{Loaded, read, read_bytes};

use crate::common::proofs::{against_another_reader, assert_sound, state};
use crate::common::sample;

/// Every file with its faces, and the names of its parts where it has several.
const SAMPLES: [(&str, usize, &[&str]); 16] = [
    ("bored_block.off", 1152, &[]),
    ("broken_mug.obj", 4986, &[]),
    ("cracked_ball.stl", 512, &[]),
    ("doubled_faces.off", 683, &[]),
    ("flipped_patches.ply", 512, &[]),
    ("hollow_ball.stl", 1024, &[]),
    ("inside_out_cube.stl", 12, &[]),
    ("monkey_saddle.off", 1760, &[]),
    ("noisy_cube.off", 768, &[]),
    ("open_cube.off", 10, &[]),
    ("open_sheet.obj", 288, &[]),
    ("overlapping_boxes.obj", 36, &["lying", "standing", "across"]),
    ("thin_parts.obj", 144, &["block", "thin plate", "plate", "thick plate", "rod"]),
    ("thin_plate.stl", 12, &[]),
    ("torus.ply", 4096, &[]),
    ("touching_boxes.obj", 24, &["left", "right"]),
];

fn load(name: &str) -> Loaded {
    let loaded = read(sample(name)).unwrap_or_else(|error| panic!("{error}"));
    assert_sound(&loaded);
    loaded
}

#[test]
fn every_file_has_its_faces_and_parts() {
    let files = std::fs::read_dir(sample("")).expect("the folder is there");
    assert_eq!(files.count(), SAMPLES.len());
    for (name, faces, parts) in SAMPLES {
        let loaded = load(name);
        assert_eq!(loaded.mesh.triangles.len(), faces, "{name}");
        assert_eq!(loaded.format.name(), name.rsplit('.').next().expect("an extension"), "{name}");
        assert_eq!(loaded.warnings, Vec::<String>::new(), "{name}");
        assert_eq!((&loaded.colours, loaded.unit), (&None, None), "{name}");
        if !parts.is_empty() {
            let names: Vec<&str> = loaded.parts.iter().map(|part| part.name.as_str()).collect();
            assert_eq!(names, parts, "{name}");
        }
    }
}

#[test]
fn extension_is_not_needed() {
    for (name, ..) in SAMPLES {
        let bytes = std::fs::read(sample(name)).expect("it is there");
        let loaded = read_bytes(&bytes, None, None).unwrap_or_else(|e| panic!("{name}: {e}"));
        let named = load(name);
        assert_eq!((loaded.format, &loaded.mesh), (named.format, &named.mesh), "{name}");
    }
}

#[test]
fn stl_is_welded() {
    let mesh = load("hollow_ball.stl").mesh;
    // Two spheres: a closed surface of genus 0 has F/2 + 2 vertices.
    assert_eq!(mesh.positions.len(), mesh.triangles.len() / 2 + 4);
    assert_eq!(mesh, mesh.welded());
    assert!(state(&mesh, false).is_valid());
}

/// The reader against an independent one.
#[test]
fn obj_agrees_with_another_reader() {
    for (name, ..) in SAMPLES.iter().filter(|(name, ..)| name.ends_with(".obj")) {
        let (same, ours, theirs) = against_another_reader(&sample(name)).expect("the other reader takes it");
        assert_eq!((same, ours), (theirs, theirs), "{name}");
    }
}
