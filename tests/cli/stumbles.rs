//! What new users stumble over: results that are mostly lost, units, grids, names, drivers that print.

use std::fs;

use glam::DVec3;
use meshwright::io::{Format, Unit, WriteOptions, read, write_with};
use meshwright::mesh::TriMesh;
use serde_json::Value;
use tempfile::TempDir;

use super::{assert_empty, folder, names_in, program, run_in};

/// The box from `low` to `high`.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> TriMesh {
    let corner = |n: usize| DVec3::from_array(std::array::from_fn(|k| if n >> k & 1 == 1 { high[k] } else { low[k] }));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    TriMesh {
        positions: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
    }
}

/// A cube of 10, and a plate of that size beside it.
fn cube_and_plate(thickness: f64) -> TriMesh {
    let mut mesh = cuboid([0.0; 3], [10.0; 3]);
    mesh.append(&cuboid([0.0, 0.0, 20.0], [10.0, 10.0, 20.0 + thickness]));
    mesh
}

fn saved(folder: &TempDir, name: &str, mesh: &TriMesh, unit: Option<Unit>) {
    let path = folder.path().join(name);
    let format = Format::from_path(&path).expect("a mesh");
    write_with(&path, mesh, &WriteOptions { unit, ..WriteOptions::new(format) }).expect("written");
}

#[test]
fn a_result_that_is_mostly_lost_replaces_no_file() {
    let folder = folder();
    saved(&folder, "in.ply", &cube_and_plate(0.2), None);
    let out = folder.path().join("out.ply");
    fs::write(&out, "what was there").expect("written");
    let line = "repair OUT/in.ply -o OUT/out.ply --map OUT/map.ply --report OUT/r.json --resolution 16 --rebuild";
    let said = run_in(&folder, line).exits(3);
    said.says(&[
        "1 body is gone",
        "Nothing was written",
        "out.ply stays as it was",
        "--keep-partial",
        "lost     a body",
    ]);
    assert_eq!(fs::read(&out).expect("it is there"), b"what was there");
    assert_eq!(names_in(folder.path()), ["in.ply", "out.ply", "r.json"]);
    let report: Value =
        serde_json::from_slice(&fs::read(folder.path().join("r.json")).expect("a report")).expect("JSON");
    assert_eq!((&report["exit"], &report["result"]["output"]), (&3.into(), &Value::Null));
    assert_eq!(report["result"]["pipeline"]["topology"]["lost_count"], 1);
    // A stream gets nothing either.
    let piped = run_in(&folder, "repair OUT/in.ply -o - --out-format ply --resolution 16 --rebuild").exits(3);
    assert!(piped.stdout.is_empty());
    for flag in ["--keep-partial", "--force"] {
        fs::write(&out, "what was there").expect("written");
        run_in(&folder, &format!("{line} {flag}")).exits(3).says(&["1 body is gone", "result"]);
        assert_eq!(read(&out).expect("a mesh").mesh.triangles.len(), 12, "{flag}");
    }
    // What the program suggests can be done.
    let hint = run_in(&folder, "repair OUT/in.ply -o OUT/again.ply --resolution 16 --rebuild").exits(3).stderr;
    let voxel = hint.split("hint: --voxel ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a voxel");
    run_in(&folder, &format!("repair OUT/in.ply -o OUT/again.ply --rebuild --voxel {voxel}")).exits(0);
}

#[test]
fn convert_writes_no_copy_that_has_lost_its_shape() {
    let folder = folder();
    let mut far = cuboid([0.0; 3], [0.001; 3]);
    far.positions.iter_mut().for_each(|p| *p += 1e6);
    saved(&folder, "far.ply", &far, None);
    run_in(&folder, "convert OUT/far.ply -o OUT/far.stl").exits(3).says(&["Nothing was written", "--keep-partial"]);
    assert_eq!(names_in(folder.path()), ["far.ply"]);
    run_in(&folder, "convert OUT/far.ply -o OUT/far.stl --keep-partial").exits(3).says(&["lost their area"]);
    assert!(folder.path().join("far.stl").exists());
}

#[test]
fn suggestions_stay_within_what_is_possible() {
    let folder = folder();
    // No voxel is as small as half of this plate.
    saved(&folder, "in.ply", &cube_and_plate(1e-3), None);
    let said = run_in(&folder, "repair OUT/in.ply -o OUT/out.ply --resolution 32 --rebuild").exits(3).stderr;
    assert!(said.contains("too thin") && !said.contains("--voxel"), "{said}");
    let table = run_in(&folder, "inspect OUT/in.ply --thickness --resolution 64").exits(0).text();
    assert!(table.contains("no voxel is small enough") && !table.contains("--resolution"), "{table}");
    let walls = run_in(&folder, "thicken OUT/in.ply --min 1e-6 -o OUT/out.ply --resolution 64").exits(2).stderr;
    let least = walls.split("walls of at least ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a length");
    let quarter = least.parse::<f64>().expect("a number") / 4.0;
    let plan = |verb: &str| run_in(&folder, &format!("{verb} OUT/in.ply --plan --max-memory 9000T"));
    plan(&format!("thicken --min {least} --voxel {quarter}")).exits(0);
    let fine = run_in(&folder, "repair OUT/in.ply -o OUT/out.ply --rebuild --voxel 1e-5").exits(2).stderr;
    let voxel = fine.split("a voxel of at least ").nth(1).expect("a voxel").trim();
    plan(&format!("dilate --radius 1 --voxel {voxel}")).exits(0);
    plan("dilate --radius 1 --voxel 0.004").exits(2);
    // Where no voxel helps, none is suggested.
    let little = run_in(&folder, "repair OUT/in.ply --plan --max-memory 1k").exits(5).stderr;
    assert!(little.contains("alone need that much") && !little.contains("--resolution"), "{little}");
    let little = run_in(&folder, "sdf OUT/in.ply --plan --max-memory 1k").exits(5).stderr;
    assert!(!little.contains("--resolution"), "{little}");
}

#[test]
fn gltf_is_in_metres_and_comes_back_as_it_was() {
    let folder = folder();
    let millimetres = cuboid([1.0, 2.0, 3.0], [11.5, 12.0, 13.25]);
    saved(&folder, "in.3mf", &millimetres, Some(Unit::Millimetre));
    for format in ["glb", "gltf"] {
        let report = run_in(&folder, &format!("convert OUT/in.3mf -o OUT/a.{format} --json")).exits(0);
        assert_eq!(report.says(&["times 0.001"]).json()["result"]["output"]["unit"], "m");
        run_in(&folder, &format!("repair OUT/in.3mf -o OUT/b.{format}")).exits(0).says(&["mm³", "times 0.001"]);
        for name in ["a", "b"] {
            let loaded = read(folder.path().join(format!("{name}.{format}"))).expect("it is sound");
            assert_eq!(loaded.unit, Some(Unit::Metre));
            let scaled = millimetres.positions.iter().map(|p| *p * 0.001);
            assert!(loaded.mesh.positions.iter().copied().eq(scaled), "{name}.{format}");
        }
    }
    run_in(&folder, "convert OUT/a.glb -o OUT/back.glb").exits(0);
    let bounds = read(folder.path().join("back.glb")).expect("it is sound").mesh.bounds().expect("a box");
    assert!((bounds.size() - DVec3::new(0.0105, 0.01, 0.01025)).abs().max_element() < 1e-8);
    // Without a unit the numbers stay, and that is said.
    run_in(&folder, "convert testdata/open_cube.off -o OUT/c.glb")
        .exits(0)
        .says(&["glb is in metres", "1 reads as 1 m"]);
    run_in(&folder, "convert testdata/open_cube.off -o OUT/c.3mf").exits(0).says(&["read as millimetres"]);
    assert_eq!(read(folder.path().join("c.glb")).expect("it is sound").mesh.bounds().expect("a box").max.x, 10.0);
    run_in(&folder, "convert OUT/a.glb -o OUT/d.stl").exits(0).says(&["its numbers are metres"]);
}

#[test]
fn files_in_different_units_are_told_of_in_one() {
    let folder = folder();
    saved(&folder, "a.3mf", &cuboid([0.0; 3], [25.4; 3]), Some(Unit::Millimetre));
    saved(&folder, "b.3mf", &cuboid([2.0, 0.0, 0.0], [3.0, 1.0, 1.0]), Some(Unit::Inch));
    for verb in ["union OUT/a.3mf OUT/b.3mf", "csg a|b a=OUT/a.3mf b=OUT/b.3mf"] {
        let run = run_in(&folder, &format!("{verb} -o OUT/out.3mf --resolution 32 --force")).exits(0);
        assert_eq!(run.stderr.matches("25.4 x 25.4 x 25.4 mm").count(), 2, "{}", run.stderr);
        run.says(&["b.3mf is in inches; it was rescaled to millimetres (times 25.4)", "volume 32,774 mm³"]);
    }
    // A grid beside a mesh, too: both are spheres of the same size.
    run_in(&folder, "sdf OUT/b.3mf -o OUT/b.vti --resolution 24 -q").exits(0);
    let slices = run_in(&folder, "render OUT/b.vti OUT/b.vti -o OUT/s.png --width 64 --height 64").exits(0);
    slices.says(&[" in; blue inside"]);
    run_in(&folder, "field a|b a=OUT/a.3mf b=OUT/b.vti -o OUT/f.stl --resolution 32").exits(0).says(&["times 25.4"]);
}

#[test]
fn grids_are_inspected_and_converted() {
    let folder = folder();
    run_in(&folder, "sdf testdata/open_cube.off -o OUT/a.vti --resolution 24 --unit mm -q").exits(0);
    let first = run_in(&folder, "inspect OUT/a.vti --json").exits(0).json()["result"]["grid"].clone();
    assert!((first["inside_volume"].as_f64().expect("a volume") - 1000.0).abs() < 60.0, "{first}");
    let mut from = "a.vti".to_string();
    for to in ["b.nrrd", "c.vdb", "d.vti", "e.vdb", "f.nrrd"] {
        run_in(&folder, &format!("convert OUT/{from} -o OUT/{to}")).exits(0).says(&["voxels, as ", ", in mm"]);
        let mut grid = run_in(&folder, &format!("inspect OUT/{to} --json")).exits(0).json()["result"]["grid"].clone();
        grid["stored"] = first["stored"].clone();
        assert_eq!(grid, first, "{from} to {to}");
        from = to.to_string();
    }
    let values = |name: &str| {
        let file = meshwright::io::read_grid(folder.path().join(name)).expect("it is sound");
        let mut values = Vec::new();
        (0..file.dims[2]).for_each(|z| file.plane(z, &mut values));
        values
    };
    assert_eq!(values("a.vti"), values("f.nrrd"));
    run_in(&folder, "convert OUT/c.vdb -o OUT/g.npy").exits(0).says(&["npy has no place for origin"]);
    assert_eq!(values("g.npy"), values("c.vdb"));
    let streamed = run_in(&folder, "convert OUT/c.vdb -o - --out-format nrrd").exits(0);
    assert!(streamed.stdout.starts_with(b"NRRD"));
    let text = run_in(&folder, "inspect OUT/a.vti").exits(0).text();
    for words in ["voxel size", "inside", "mm³", "values"] {
        assert!(text.contains(words), "`{words}` is missing in:\n{text}");
    }
    run_in(&folder, "convert OUT/a.vti -o OUT/x.stl").exits(2).says(&["meshwright field a a="]);
    run_in(&folder, "inspect OUT/a.vti --fail-on any").exits(2).says(&["about the triangles"]);
    assert!(!folder.path().join("x.stl").exists());
}

#[test]
fn files_named_as_something_else_are_told() {
    let folder = folder();
    fs::copy(super::sample("open_cube.off"), folder.path().join("cube.stl")).expect("copied");
    run_in(&folder, "inspect OUT/cube.stl").exits(0).says(&["named as stl, and read as off"]);
    run_in(&folder, "inspect OUT/cube.stl --in-format off --fail-on open").exits(3).says(&["4 open edges"]);
    fs::remove_file(folder.path().join("cube.stl")).expect("removed");
    assert_empty(&folder);
}

#[test]
fn graphics_drivers_print_nothing() {
    for arguments in [vec!["devices"], vec!["devices", "--json"]] {
        let output = program()
            .args(&arguments)
            .env_remove("XDG_RUNTIME_DIR")
            .env_remove("NODEVICE_SELECT")
            .env_remove("MESA_LOG_FILE")
            .output()
            .expect("the program starts");
        assert!(output.status.success() && !output.stdout.is_empty());
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{arguments:?}");
    }
}
