//! `repair --each`: objects one by one. What the three formats share; the formats have files of their own.

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Read, Write};
use std::path::Path;

use glam::DVec3;
use meshwright::io::{self, Format, Scene};
use meshwright::mesh::{TriMesh, ValidateOptions, validate};
use meshwright::progress::Progress;
use tempfile::TempDir;

use super::{assert_empty, folder, run_in};
use crate::common::shapes::cuboid;

/// A box without the side towards −x: two triangles are missing.
pub fn open_box(min: f64, max: f64) -> TriMesh {
    let mut mesh = cuboid(DVec3::splat(min), DVec3::splat(max));
    let side: Vec<bool> = (0..mesh.triangles.len()).map(|t| mesh.corners(t).iter().all(|p| p.x == min)).collect();
    let mut side = side.into_iter();
    mesh.triangles.retain(|_| side.next() == Some(false));
    assert_eq!(mesh.triangles.len(), 10);
    mesh
}

/// The files of a package by name.
pub fn unzipped(bytes: &[u8]) -> BTreeMap<String, Vec<u8>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).expect("a package");
    (0..archive.len())
        .map(|n| {
            let mut file = archive.by_index(n).expect("a file");
            let mut content = Vec::new();
            file.read_to_end(&mut content).expect("its bytes");
            (file.name().to_owned(), content)
        })
        .collect()
}

/// A package of files.
pub fn zipped(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).expect("a new file");
        zip.write_all(content).expect("memory takes it");
    }
    zip.finish().expect("a package").into_inner()
}

pub fn scene(path: &Path) -> Scene {
    io::read_scene(&fs::read(path).expect("written"), None, Some(path)).unwrap_or_else(|e| panic!("{e}"))
}

/// Asserts that an object of a scene is a solid of about this volume.
#[track_caller]
pub fn assert_solid(scene: &Scene, object: usize, volume: f64) {
    let options = ValidateOptions { self_intersections: true, weld: scene.format.repeats_vertices() };
    let found = validate(&scene.objects[object].mesh, &options, &Progress::none()).expect("in time");
    assert!(found.is_valid(), "{}: {:?}", scene.objects[object].name, found.problems());
    assert!((found.volume - volume).abs() < 1e-3 * volume, "{}: {}", scene.objects[object].name, found.volume);
}

/// Writes boxes under `o` names.
fn boxes(folder: &TempDir, name: &str, boxes: &[(&str, TriMesh)]) {
    let (mut text, mut first) = (String::new(), 1);
    for (name, mesh) in boxes {
        text += &format!("o {name}\n");
        mesh.positions.iter().for_each(|p| text += &format!("v {} {} {}\n", p.x, p.y, p.z));
        mesh.triangles.iter().for_each(|t| {
            let [a, b, c] = t.map(|v| v + first);
            text += &format!("f {a} {b} {c}\n");
        });
        first += mesh.positions.len() as u32;
    }
    fs::write(folder.path().join(name), text).expect("written");
}

#[test]
fn without_each_a_note_says_how_many_objects_were_fused() {
    let folder = folder();
    boxes(&folder, "in.obj", &[("a", open_box(0.0, 10.0)), ("b", open_box(20.0, 30.0)), ("c", open_box(40.0, 50.0))]);
    run_in(&folder, "repair OUT/in.obj -o OUT/out.3mf --resolution 24")
        .exits(0)
        .says(&["note: ", "in.obj: 3 objects were fused into one solid; --each keeps them apart"]);
    run_in(&folder, "repair OUT/in.obj -o OUT/one.3mf --part b").exits(0);
    let one = io::read(folder.path().join("one.3mf")).expect("ours");
    assert_eq!(one.mesh.bounds().expect("a box").min, DVec3::splat(20.0));
    let said = run_in(&folder, "repair OUT/in.obj -o OUT/two.stl --part 3 --part a").exits(0).stderr;
    assert!(said.contains("2 objects were fused"), "{said}");
    let said = run_in(&folder, "repair OUT/one.3mf -o OUT/alone.stl").exits(0).stderr;
    assert!(!said.contains("fused"), "{said}");
}

#[test]
fn parts_are_picked_by_name_or_by_the_number_that_inspect_lists() {
    let folder = folder();
    boxes(&folder, "in.obj", &[("wheel", open_box(0.0, 10.0)), ("axle", open_box(20.0, 30.0))]);
    let listed = run_in(&folder, "inspect OUT/in.obj").exits(0).text();
    assert!(listed.contains("1 wheel: 10 triangles") && listed.contains("2 axle: 10 triangles"), "{listed}");
    run_in(&folder, "repair OUT/in.obj --each --part 2 -o OUT/out.obj").exits(0).says(&["1 object not picked"]);
    let found = scene(&folder.path().join("out.obj"));
    assert_eq!(found.objects[0].mesh.triangles.len(), 10);
    assert_solid(&found, 1, 1000.0);
    for asked in ["whel", "3", "0"] {
        run_in(&folder, &format!("repair OUT/in.obj --each --part {asked} -o OUT/no.obj")).exits(2).says(&[
            "has no object",
            "2 objects in all",
            "1 `wheel`",
        ]);
    }
    run_in(&folder, "repair OUT/in.obj --part whel -o OUT/no.obj").exits(2).says(&["1 `wheel`"]);
    assert!(!folder.path().join("no.obj").exists());
}

#[test]
fn what_encloses_nothing_is_left_as_it_is_and_listed() {
    let folder = folder();
    let flat = TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: vec![[0, 1, 2]] };
    boxes(&folder, "in.obj", &[("box", open_box(0.0, 10.0)), ("flat", flat.clone())]);
    for format in ["obj", "3mf", "glb", "gltf"] {
        let line = format!("repair OUT/in.obj --each -o OUT/out.{format} --json");
        let done = run_in(&folder, &line).exits(3).says(&["2 flat", "as it is: ", "1 object left alone, not solid"]);
        let objects = &done.json()["result"]["objects"];
        assert_eq!((&objects[0]["done"], &objects[1]["done"]), (&"repaired".into(), &"left".into()));
        assert_eq!(objects[0]["after"]["open_edges"], 0);
        assert!(objects[1]["why"].is_string() && objects[1]["after"].is_null() && objects[0]["pipeline"].is_object());
        let found = scene(&folder.path().join(format!("out.{format}")));
        assert_solid(&found, 0, 1000.0);
        assert_eq!(found.objects[1].mesh.corners(0), flat.corners(0));
    }
    boxes(&folder, "flat.obj", &[("flat", flat.clone()), ("too", flat)]);
    let nothing = self::folder();
    let path = folder.path().join("flat.obj");
    run_in(&nothing, &format!("repair {} --each -o OUT/out.obj", path.display())).exits(4).says(&["2 objects"]);
    assert_empty(&nothing);
}

#[test]
fn formats_without_objects_and_flags_for_one_mesh_are_refused() {
    let folder = folder();
    for format in ["stl", "ply", "off"] {
        run_in(&folder, &format!("repair testdata/overlapping_boxes.obj --each -o OUT/a.{format}"))
            .exits(2)
            .says(&["holds one mesh", "3mf, glb, gltf and obj"]);
    }
    run_in(&folder, "repair testdata/torus.ply --each -o OUT/a.3mf").exits(4).says(&["no objects"]);
    for flags in ["--plan", "--map OUT/m.ply", "--max-hole 3", "--holes 1", "--fill none"] {
        run_in(&folder, &format!("repair testdata/overlapping_boxes.obj --each -o OUT/a.3mf {flags}")).exits(2);
    }
    run_in(&folder, "repair testdata/overlapping_boxes.obj --each").exits(2);
    assert_empty(&folder);
}

#[test]
fn a_voxel_is_a_share_of_the_longest_side_of_each_object() {
    let folder = folder();
    boxes(&folder, "in.obj", &[("small", open_box(0.0, 1.0)), ("large", open_box(10.0, 110.0))]);
    let line = "repair OUT/in.obj --each -o OUT/out.3mf --resolution 50 --method voxel --rebuild --json -q";
    let objects = &run_in(&folder, line).exits(0).json()["result"]["objects"];
    let voxel = |n: usize| objects[n]["pipeline"]["voxel"].as_f64().expect("a length");
    assert!((voxel(0) - 0.02).abs() < 1e-9 && (voxel(1) - 2.0).abs() < 1e-9, "{} {}", voxel(0), voxel(1));
    // Streams have objects, too.
    let path = folder.path().join("out.3mf");
    assert_eq!(scene(&path).format, Format::ThreeMf);
    let line = format!("repair {} --each -o - --out-format glb", path.display());
    let bytes = run_in(&folder, &line).exits(0).stdout;
    let found = io::read_scene(&bytes, None, None).expect("a scene");
    assert_eq!(found.objects.iter().map(|object| object.name.as_str()).collect::<Vec<_>>(), ["small", "large"]);
}
