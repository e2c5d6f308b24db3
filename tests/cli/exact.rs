//! What is closed and crosses is cut exactly: `--method`, and what a run, a plan, `inspect` and `render` say of it.

use glam::DVec3;
use meshwright::io;
use meshwright::mesh::TriMesh;
use tempfile::TempDir;

use super::common::shapes::cuboid;
use super::{assert_empty, folder, picture, run_in};

/// Three boxes of 960, 360 and 256; the first overlaps the others by 120 and 128.
const BOXES: &str = "testdata/overlapping_boxes.obj";
const FUSED: f64 = 1328.0;

fn volume(folder: &TempDir, name: &str) -> f64 {
    let json = run_in(folder, &format!("inspect OUT/{name} --json --fail-on any")).exits(0).json();
    json["inputs"][0]["validity"]["volume"].as_f64().expect("a number")
}

/// A box with sides of this length.
fn cube(low: [f64; 3], side: f64) -> TriMesh {
    let low = DVec3::from_array(low);
    cuboid(low, low + DVec3::splat(side))
}

fn put(folder: &TempDir, name: &str, parts: &[TriMesh]) {
    let mut all = TriMesh::default();
    parts.iter().for_each(|part| all.append(part));
    io::write(folder.path().join(name), &all).expect("written");
}

#[test]
fn closed_files_that_cross_are_cut_exactly_whatever_the_voxel() {
    let folder = folder();
    let repair = |flags: &str| run_in(&folder, &format!("repair {BOXES} -o OUT/a.off --force {flags}")).exits(0);
    let said = repair("--resolution 16").stderr;
    let coarse = std::fs::read(folder.path().join("a.off")).expect("a file");
    assert!((volume(&folder, "a.off") / FUSED - 1.0).abs() < 1e-12);
    let row = said.lines().find(|line| line.starts_with("exact")).expect("a row of the summary");
    assert!(row.contains(" triangles cut along ") && row.ends_with("; no voxels"), "{said}");
    assert!(!said.lines().any(|line| line.starts_with("voxel") || line.starts_with("thin")), "{said}");
    let said = repair("--resolution 200 -v").stderr;
    assert!(coarse == std::fs::read(folder.path().join("a.off")).expect("a file"), "the voxel matters");
    assert!(said.contains(" touch; ") && !said.lines().any(|line| line.starts_with("rays")), "{said}");
    for flags in ["--method exact", ""] {
        let json = repair(&format!("{flags} --json")).json();
        let pipeline = &json["result"]["pipeline"];
        assert_eq!(json["options"]["method"], if flags.is_empty() { "auto" } else { "exact" });
        assert!(pipeline["exact"]["cut"].as_u64() > Some(8) && pipeline["lattice"] == false, "{pipeline}");
    }
}

#[test]
fn voxels_are_taken_where_they_are_asked_for() {
    let folder = folder();
    for (flags, method) in [("--method voxel", "voxel"), ("--rebuild", "auto"), ("--no-fit", "auto")] {
        let line = format!("repair {BOXES} -o OUT/a.off --resolution 48 --force {flags}");
        let json = run_in(&folder, &format!("{line} --json")).exits(0).json();
        assert_eq!(json["options"]["method"], method);
        let pipeline = &json["result"]["pipeline"];
        assert!(pipeline["exact"].is_null() && pipeline["lattice"] == true, "{flags}: {pipeline}");
        assert!((volume(&folder, "a.off") / FUSED - 1.0).abs() < 0.05, "{flags}");
        let said = run_in(&folder, &line).exits(0).stderr;
        assert!(said.lines().any(|line| line.starts_with("voxel")) && !said.contains("no voxels"), "{said}");
    }
}

#[test]
fn exact_or_not_at_all_names_the_file_that_is_open_and_where() {
    let folder = folder();
    let (open, closed) = ("testdata/open_cube.off", "testdata/torus.ply");
    let refused = "there is no exact result: testdata/open_cube.off does not close around 4 edges, one from ";
    let hint = "hint: --method auto";
    for line in [
        format!("repair {open}"),
        format!("union {open} {closed}"),
        format!("union {closed} {open}"),
        format!("csg b-a a={open} b={closed}"),
        format!("hollow {open} --wall 1"),
    ] {
        run_in(&folder, &format!("{line} -o OUT/a.off --method exact")).exits(3).says(&[refused, hint]);
        assert_empty(&folder);
    }
    let both = format!("union {open} {closed} testdata/open_sheet.obj -o OUT/a.off --method exact");
    let words = ["open_cube.off and testdata/open_sheet.obj do not close around ", " edges, one of testdata/open_"];
    run_in(&folder, &both).exits(3).says(&words);
    assert_empty(&folder);
    // Places are those of the file, also where the work is done elsewhere.
    run_in(&folder, &format!("convert {open} -o OUT/far.off --translate 700000,0,0")).exits(0);
    run_in(&folder, "repair OUT/far.off -o OUT/a.off --method exact").exits(3).says(&["from 700,0", " to 700,0"]);
    // What stands as it is needs no cut.
    run_in(&folder, &format!("repair {closed} -o OUT/a.off --method exact")).exits(0).says(&["kept as it is"]);
}

#[test]
fn what_became_of_the_shells_is_told() {
    let folder = folder();
    // Two boxes that cross, both inside of a third.
    put(&folder, "buried.off", &[cube([0.0; 3], 9.0), cube([2.0; 3], 3.0), cube([4.0; 3], 3.0)]);
    let run = run_in(&folder, "repair OUT/buried.off -o OUT/a.off").exits(0);
    run.says(&["2 surfaces left out: inside of others, or outside of the result", "no voxels"]);
    assert!((volume(&folder, "a.off") / 729.0 - 1.0).abs() < 1e-12);
    // One of two that cross is inside out.
    let mut inside_out = cube([2.0; 3], 4.0);
    inside_out.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    put(&folder, "mixed.off", &[cube([0.0; 3], 4.0), inside_out]);
    let run = run_in(&folder, "repair OUT/mixed.off -o OUT/b.off").exits(0);
    run.says(&["1 patch turned over as a whole"]);
    assert!((volume(&folder, "b.off") / 120.0 - 1.0).abs() < 1e-12);
    // Two that touch at an edge alone.
    put(&folder, "edge.off", &[cube([0.0; 3], 4.0), cube([4.0, 4.0, 0.0], 4.0)]);
    let run = run_in(&folder, "repair OUT/edge.off -o OUT/c.off").exits(0);
    run.says(&["moved apart by a hair, where bodies touch at an edge or a corner alone"]);
    assert!((volume(&folder, "c.off") / 128.0 - 1.0).abs() < 1e-5);
}

#[test]
fn what_is_simplified_by_hand_is_what_was_cut_too() {
    let folder = folder();
    put(&folder, "box.off", &[cube([0.0; 3], 12.0)]);
    let triangles = |flags: &str| {
        let line = format!("union testdata/torus.ply OUT/box.off -o OUT/a.off --force --json {flags}");
        let json = run_in(&folder, &line).exits(0).json();
        assert!(json["result"]["pipeline"]["exact"]["cut"].as_u64() > Some(0), "{json}");
        assert!(volume(&folder, "a.off") > 1728.0);
        json["result"]["output"]["validity"]["triangles"].as_u64().expect("a count")
    };
    let (all, fewer) = (triangles(""), triangles("--simplify 1%"));
    assert!(4 * fewer < 3 * all, "{all} and {fewer}");
}

#[test]
fn plans_know_the_way_and_refuse_nothing_that_fits() {
    let folder = folder();
    let plan = |flags: &str| run_in(&folder, &format!("repair {BOXES} --plan {flags}"));
    let text = plan("").exits(0).text();
    assert!(text.lines().any(|line| line.starts_with("exact") && line.ends_with("no voxels")), "{text}");
    assert!(!text.lines().any(|line| line.starts_with("voxel")), "{text}");
    let json = plan("--json").exits(0).json();
    let found = &json["result"]["plan"];
    assert!(found["exact"] == true && found["touching"].as_u64() > Some(8), "{found}");
    assert_eq!(found["dims"], serde_json::json!([0, 0, 0]));
    let [memory, least] = ["memory", "least_memory"].map(|field| found[field].as_u64().expect("bytes"));
    assert!(least < memory, "{found}");
    // Between the two the run may fit, and is not refused.
    plan(&format!("--max-memory {}", (least + memory) / 2)).exits(0).says(&["of memory may be needed"]);
    plan("--max-memory 1M").exits(5).says(&["would be needed"]);
    for flags in ["--method voxel", "--rebuild"] {
        let json = plan(&format!("{flags} --json")).exits(0).json();
        assert!(json["result"]["plan"]["exact"] == false, "{flags}: {json}");
        assert!(plan(flags).exits(0).text().lines().any(|line| line.starts_with("voxel")), "{flags}");
    }
    let json = run_in(&folder, "repair testdata/open_cube.off --plan --json").exits(0).json();
    assert!(json["result"]["plan"]["exact"] == true, "{json}");
    let json = run_in(&folder, "repair testdata/open_sheet.obj --plan --json").exits(0).json();
    assert!(json["result"]["plan"]["exact"] == false, "{json}");
}

#[test]
fn where_triangles_cross_is_measured_and_drawn() {
    let folder = folder();
    // The second box goes through the bottom and top of the first, and the third through two of its sides.
    let around = 2.0 * (5.0 + 4.0 + 5.0 + 4.0) + 2.0 * (4.0 + 4.0 + 4.0 + 4.0);
    let json = run_in(&folder, &format!("inspect {BOXES} --json")).exits(0).json();
    let found = &json["result"]["crossings"];
    let length = found["length"].as_f64().expect("a length");
    assert!((length / around - 1.0).abs() < 1e-9 && found["segments"].as_u64() >= Some(16), "{found}");
    let text = run_in(&folder, &format!("inspect {BOXES} --unit mm")).exits(0).text();
    assert!(text.contains("triangles cross along ") && text.contains(" segments, 68 mm long in all"), "{text}");
    for name in ["torus.ply", "open_cube.off"] {
        let json = run_in(&folder, &format!("inspect testdata/{name} --json")).exits(0).json();
        assert!(json["result"]["crossings"].is_null(), "{name}");
    }
    let blue = |flags: &str| {
        run_in(&folder, &format!("render {BOXES} -o OUT/a.png --width 300 --height 200 --plain {flags}")).exits(0);
        let (.., pixels) = picture(&folder, "a.png");
        pixels.iter().filter(|pixel| pixel[2] > 150 && pixel[0] < 60 && pixel[1] < 90).count()
    };
    assert!(blue("") > 50 && blue("--no-defects") == 0, "{} {}", blue(""), blue("--no-defects"));
    run_in(&folder, &format!("render {BOXES} -o OUT/a.png")).exits(0).says(&["where they cross"]);
}
