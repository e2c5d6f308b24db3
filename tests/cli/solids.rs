//! `repair`, the booleans and `csg`, from file to file.

use glam::DVec3;
use serde_json::Value;
use tempfile::TempDir;

use super::common::shapes::cuboid;
use super::{assert_empty, folder, names_in, run_in};

/// The validity of a written file, as `inspect` sees it; it must have no defect at all.
#[track_caller]
fn solid(folder: &TempDir, name: &str) -> Value {
    let json = run_in(folder, &format!("inspect OUT/{name} --json --fail-on any")).exits(0).json();
    json["inputs"][0]["validity"].clone()
}

#[track_caller]
fn assert_volume(validity: &Value, expected: f64, tolerance: f64) {
    let volume = validity["volume"].as_f64().expect("a number");
    assert!((volume / expected - 1.0).abs() < tolerance, "volume {volume} instead of {expected}");
}

/// Spikes thinner than the voxel may leave a crumb of a single voxel at their tip.
const MAY_CRUMBLE: i32 = 0;

#[test]
fn every_broken_sample_comes_back_as_a_valid_solid() {
    for (name, volume, tolerance, bodies) in [
        ("torus.ply", 1824.06, 0.01, 1),
        ("noisy_cube.off", 1009.1, 0.02, MAY_CRUMBLE),
        ("hollow_ball.stl", 3207.83, 0.02, 2),
        ("overlapping_boxes.obj", 1328.0, 0.02, 1),
        ("open_cube.off", 1000.0, 0.03, 1),
        ("cracked_ball.stl", 4120.0, 0.03, 1),
        ("inside_out_cube.stl", 1000.0, 0.02, 1),
        ("flipped_patches.ply", 4120.0, 0.02, 1),
        ("doubled_faces.off", 4120.0, 0.02, 1),
        ("touching_boxes.obj", 2000.0, 0.02, 1),
        ("monkey_saddle.off", 1200.0, 0.02, 1),
    ] {
        let folder = folder();
        run_in(&folder, &format!("repair testdata/{name} -o OUT/out.stl --resolution 64")).exits(0);
        let validity = solid(&folder, "out.stl");
        assert_volume(&validity, volume, tolerance);
        assert!(bodies == MAY_CRUMBLE || validity["bodies"] == bodies, "{name}: {} bodies", validity["bodies"]);
        assert_eq!(names_in(folder.path()), ["out.stl"], "{name}");
    }
}

#[test]
fn the_broken_mug_comes_back_in_one_piece() {
    let folder = folder();
    let said =
        run_in(&folder, "repair testdata/broken_mug.obj -o OUT/mug.3mf --resolution 128 --unit mm").exits(0).stderr;
    let validity = solid(&folder, "mug.3mf");
    assert_eq!((&validity["bodies"], &validity["genus"]), (&1.into(), &1.into()), "a mug is one body with one tunnel");
    for label in ["input", "wrong", "done", "voxel", "result", "time"] {
        assert!(said.lines().any(|line| line.starts_with(label)), "`{label}` is missing in:\n{said}");
    }
    assert!(said.contains(" mm³"), "{said}");
}

#[test]
fn output_is_the_same_in_every_format() {
    let folder = folder();
    for name in ["a.stl", "a.obj", "a.ply", "a.off", "a.glb", "a.3mf"] {
        run_in(&folder, &format!("repair testdata/open_cube.off -o OUT/{name} --resolution 32")).exits(0);
        assert_volume(&solid(&folder, name), 1000.0, 0.05);
    }
}

#[test]
fn booleans_of_boxes_have_the_volumes_of_sets() {
    // 10 x 10 x 10 at the origin, and 20 x 10 x 10 made of two touching boxes over it.
    let (a, b) = ("testdata/inside_out_cube.stl", "testdata/touching_boxes.obj");
    let folder = folder();
    for (arguments, volume) in [
        (format!("union {a} {b}"), 2000.0),
        (format!("intersection {a} {b}"), 1000.0),
        (format!("difference {b} {a}"), 1000.0),
        (format!("csg b-a a={a} b={b}"), 1000.0),
        (format!("csg a^b a={a} b={b}"), 1000.0),
        (format!("csg (a|b)&(b-a) a={a} b={b}"), 1000.0),
    ] {
        run_in(&folder, &format!("{arguments} -o OUT/out.off --resolution 64")).exits(0);
        assert_volume(&solid(&folder, "out.off"), volume, 0.02);
    }
}

#[test]
fn nothing_left_is_exit_4_and_no_file() {
    let folder = folder();
    let a = "testdata/torus.ply";
    run_in(&folder, &format!("difference {a} {a} -o OUT/out.stl --resolution 32")).exits(4).says(&["error: "]);
    assert_empty(&folder);
    let said = run_in(&folder, "repair testdata/open_sheet.obj -o OUT/out.stl --resolution 64").exits(4).stderr;
    assert!(said.starts_with("error: ") && said.contains("enclose"), "{said}");
    assert_empty(&folder);
}

#[test]
fn walls_far_below_the_voxel_are_told() {
    let folder = folder();
    let run = run_in(&folder, "repair testdata/thin_plate.stl -o OUT/out.stl --resolution 64 --rebuild");
    assert!(matches!(run.status, 3 | 4), "{}: {}", run.status, run.stderr);
    assert!(run.stderr.contains("voxel"), "{}", run.stderr);
    assert_empty(&folder);
    run_in(&folder, "repair testdata/thin_plate.stl -o OUT/fine.stl --voxel 0.018 --rebuild").exits(0);
    assert_volume(&solid(&folder, "fine.stl"), 1.6, 0.02);
}

#[test]
fn threads_do_not_change_a_byte() {
    let folder = folder();
    for threads in [1, 2, 5] {
        let arguments = "repair testdata/broken_mug.obj --resolution 64 -o";
        run_in(&folder, &format!("{arguments} OUT/{threads}.stl --threads {threads}")).exits(0);
    }
    let bytes = |threads: u32| std::fs::read(folder.path().join(format!("{threads}.stl"))).unwrap();
    assert!(bytes(1) == bytes(2) && bytes(1) == bytes(5), "the bytes differ between numbers of threads");
}

#[test]
fn a_plan_says_what_it_would_cost_and_does_nothing() {
    let folder = folder();
    let text = run_in(&folder, "repair testdata/torus.ply --plan --resolution 100").exits(0).text();
    for label in ["voxel", "result", "memory", "time"] {
        assert!(text.lines().any(|line| line.starts_with(label)), "`{label}` is missing in:\n{text}");
    }
    let json = run_in(&folder, "repair testdata/torus.ply -o OUT/a.stl --plan --json").exits(0).json();
    assert!(json["result"]["plan"]["memory"].as_u64().unwrap() > 0);
    assert!(json["result"]["plan"]["triangles"].as_u64().unwrap() > 0);
    assert_empty(&folder);
}

#[test]
fn the_report_is_json_and_complete() {
    let folder = folder();
    let arguments = "csg a-b a=testdata/noisy_cube.off b=testdata/open_cube.off -o OUT/a.stl --voxel 2% --unit mm";
    let run = run_in(&folder, &format!("{arguments} --json --report OUT/r.json -q"));
    let json = run.json();
    let file: Value = serde_json::from_slice(&std::fs::read(folder.path().join("r.json")).unwrap()).unwrap();
    assert_eq!(json, file, "--json and --report differ");
    assert_eq!(json["exit"], run.status);
    assert_eq!((&json["verb"], &json["inputs"][1]["name"]), (&"csg".into(), &"b".into()));
    assert_eq!(json["options"]["unit"], "mm");
    assert!(json["options"]["voxel"].as_f64().unwrap() > 0.0);
    assert!(json["seconds"].as_f64().unwrap() > 0.0);
    assert!(json["stages"].as_array().unwrap().len() > 3);
    if run.status == 0 {
        assert_eq!(run.stderr, "", "-q and yet words");
        assert_eq!(json["result"]["output"]["validity"]["open_edges"], 0);
    }
}

#[test]
fn a_failed_run_reports_its_error() {
    let folder = folder();
    let run = run_in(&folder, "repair testdata/open_sheet.obj -o OUT/a.stl --resolution 32 --json").exits(4);
    let json = run.json();
    assert_eq!(json["exit"], 4);
    assert!(json["error"]["message"].as_str().unwrap().len() > 10);
    assert_eq!(json["result"]["output"], Value::Null);
}

#[test]
fn no_progress_noise_when_nobody_watches() {
    let folder = folder();
    let run = run_in(&folder, "repair testdata/torus.ply -o OUT/a.stl --resolution 64 -v").exits(0);
    assert!(!run.stderr.contains(['\r', '\u{1b}']), "{:?}", run.stderr);
    assert!(run.stdout.is_empty());
    assert_eq!(run_in(&folder, "repair testdata/torus.ply -o OUT/b.stl --resolution 64 -q").exits(0).stderr, "");
}

#[test]
fn a_stream_carries_the_same_bytes_as_a_file() {
    let folder = folder();
    run_in(&folder, "repair testdata/open_cube.off -o OUT/a.ply --resolution 32").exits(0);
    let streamed = run_in(&folder, "repair testdata/open_cube.off -o - --out-format ply --resolution 32").exits(0);
    assert_eq!(streamed.stdout, std::fs::read(folder.path().join("a.ply")).unwrap());
}

#[test]
fn morphology_verbs_say_what_they_did_and_refuse_what_cannot_be() {
    let folder = folder();
    let run = |verb: &str, flags: &str| {
        run_in(&folder, &format!("{verb} testdata/open_cube.off -o OUT/out.off --resolution 32 --force {flags}"))
    };
    let volume = |verb: &str, flags: &str| {
        let report = run(verb, &format!("{flags} --json")).exits(0).json();
        assert_eq!(report["result"]["output"]["validity"]["open_edges"], 0);
        assert_eq!(report["result"]["pipeline"]["morphology"]["operation"], verb);
        report["result"]["output"]["validity"]["volume"].as_f64().expect("a volume")
    };
    assert!((volume("dilate", "--radius 1 --sharp") - 1728.0).abs() < 0.1);
    let round = volume("dilate", "--radius 1");
    assert!((1600.0..1720.0).contains(&round), "{round}");
    assert!((volume("erode", "-r 1") - 512.0).abs() < 0.1);
    assert!((volume("close", "-r 4h") - 1000.0).abs() < 0.1);
    let opened = volume("open", "-r 4h");
    assert!((950.0..999.0).contains(&opened), "{opened}");
    let text = run("erode", "--radius 10%").exits(0).stderr;
    assert!(text.contains("shrunk by 1.732"), "{text}");
    assert!(run("erode", "--radius 6").exits(4).stderr.contains("nowhere thicker than 12"));
    run("dilate", "").exits(2);
    run("dilate", "--radius 1 --sharp=0.5").exits(2);
    run("open", "--radius 1 --sharp").exits(2);
}

#[test]
fn holes_are_listed_and_left_open_where_that_is_asked_for() {
    let folder = folder();
    let listed = run_in(&folder, "inspect testdata/open_cube.off --holes").exits(0);
    assert!(listed.text().contains("1: at") && listed.text().contains("flat, 2 triangles"), "{}", listed.text());
    let report = run_in(&folder, "inspect testdata/open_cube.off --holes --json").exits(0).json();
    assert_eq!(report["result"]["holes"][0]["closed_by"]["lid"], "flat");
    run_in(&folder, "inspect testdata/open_cube.off --fill flat").exits(2);
    for flags in ["--fill none", "--max-hole 10%"] {
        let line = format!("repair testdata/open_cube.off -o OUT/open.off --force --map OUT/map.ply {flags}");
        let run = run_in(&folder, &format!("{line} --json")).exits(3);
        let report = run.json();
        let output = &report["result"]["output"]["validity"];
        assert_eq!((&output["triangles"], &output["open_edges"]), (&10.into(), &4.into()), "{flags}: {output}");
        assert_eq!(report["result"]["pipeline"]["holes"][0]["closed_by"], "left_open");
        run_in(&folder, &line).exits(3).says(&["1 hole is left open", "left open", "4 open edges: no solid"]);
        let map = run_in(&folder, "inspect OUT/map.ply --json").exits(0).json();
        assert_eq!(map["inputs"][0]["validity"]["triangles"], 10);
    }
    for flags in ["--max-hole 2000%", "--holes 1"] {
        run_in(&folder, &format!("repair testdata/open_cube.off -o OUT/whole.off --force {flags}")).exits(0);
        assert_eq!(solid(&folder, "whole.off")["triangles"], 12);
    }
    run_in(&folder, "repair testdata/open_cube.off -o OUT/none.off --holes 2").exits(2).says(&["no hole 2"]);
    run_in(&folder, "repair testdata/open_cube.off -o OUT/none.off --fill none --holes 1").exits(2);
    run_in(&folder, "union testdata/open_cube.off testdata/open_cube.off -o OUT/none.off --fill none").exits(2);
}

#[test]
fn canals_are_listed_and_filled_by_number() {
    let folder = folder();
    let canals = |flags: &str| {
        run_in(&folder, &format!("canals testdata/bored_block.off --resolution 128 --max-diameter 2 {flags}"))
    };
    let listed = canals("--map OUT/map.ply").exits(0);
    let rows: Vec<Vec<String>> =
        listed.text().lines().map(|line| line.split_whitespace().map(str::to_string).collect()).collect();
    assert_eq!(rows.len(), 4, "{}", listed.text());
    for (row, (number, diameter)) in rows[1..].iter().zip([(1, 1.6), (2, 1.0), (3, 0.6)]) {
        assert_eq!((row[0].clone(), row[1].as_str()), (number.to_string(), "tunnel"));
        assert!((row[2].parse::<f64>().expect("a diameter") - diameter).abs() < 0.05, "{row:?}");
    }
    assert_eq!(solid(&folder, "map.ply")["genus"], 5);
    let report = canals("--remove 1,3 -o OUT/out.off --json").exits(0).json();
    assert_eq!(report["result"]["pipeline"]["canals"]["removed"], serde_json::json!([1, 3]));
    assert_eq!(report["result"]["output"]["validity"]["genus"], 3);
    canals("--remove -o OUT/all.off").exits(0).says(&["3 of 3 canals filled"]);
    assert_eq!(solid(&folder, "all.off")["genus"], 2);
    let none = run_in(&folder, "canals testdata/open_cube.off --resolution 32 -d 1").exits(0);
    assert!(none.text().starts_with("no canal"), "{}", none.text());
    canals("--remove 4 -o OUT/none.off").exits(2).says(&["no canal 4: 3 were found"]);
    canals("--remove 1").exits(2).says(&["where to write"]);
    canals("-o OUT/none.off").exits(2).says(&["--remove"]);
    canals("--remove 0 -o OUT/none.off").exits(2);
    run_in(&folder, "canals testdata/bored_block.off").exits(2);
    assert!(canals("--plan").exits(0).text().contains("memory"));
}

#[test]
fn thin_parts_are_measured_and_thickened_and_sheets_become_plates() {
    let folder = folder();
    let thinnest = |file: &str| {
        let report = run_in(&folder, &format!("inspect {file} --thickness --voxel 0.2 --json")).exits(0).json();
        report["result"]["thickness"]["walls"]["percentiles"][1].as_f64().expect("a width")
    };
    assert!((thinnest("testdata/thin_parts.obj") - 0.3).abs() < 0.01);
    let text = run_in(&folder, "inspect testdata/thin_parts.obj --thickness --voxel 0.2").exits(0).text();
    assert!(text.contains("walls") && text.contains("--resolution"), "{text}");
    let thicken = |file: &str, flags: &str| run_in(&folder, &format!("thicken testdata/{file} -o OUT/out.off {flags}"));
    thicken("thin_parts.obj", "--min 1 --voxel 0.2").exits(0).says(&["walls grown to 1: volume +"]);
    assert_eq!(solid(&folder, "out.off")["bodies"], 1);
    let out = folder.path().join("out.off");
    assert!(thinnest(out.to_str().expect("a plain name")) > 0.97);
    for side in ["both", "front", "back"] {
        thicken("open_sheet.obj", &format!("--min 1 --voxel 0.2 --side {side} --force"))
            .exits(0)
            .says(&["open sheets grown to 1"]);
        assert_eq!(solid(&folder, "out.off")["bodies"], 1, "{side}");
    }
    thicken("open_cube.off", "--min 4h --resolution 32 --force").exits(0).says(&["nothing is thinner than"]);
    thicken("thin_parts.obj", "--min 1h --force").exits(2).says(&["a voxel of at most"]);
    thicken("thin_parts.obj", "").exits(2);
    let text = run_in(&folder, "inspect testdata/thin_parts.obj --voxel 0.2").exits(0).text();
    assert!(text.contains("--each --voxel 0.2"), "{text}");
}

#[test]
fn the_map_shows_what_closes_holes_and_the_fit_has_switches() {
    let folder = folder();
    let repair = |flags: &str| {
        let line = format!("repair testdata/open_cube.off -o OUT/out.off --resolution 48 --force {flags}");
        let report = run_in(&folder, &format!("{line} --json")).exits(0).json();
        (report["result"]["output"]["validity"]["triangles"].as_u64().expect("a count"), report)
    };
    let (few, report) = repair("--map OUT/map.ply");
    let closed = report["result"]["pipeline"]["closed_triangles"].as_u64().expect("a count");
    assert!(few < 100 && closed > 0 && closed < few, "{few} triangles, {closed} of them close the hole");
    let map = solid(&folder, "map.ply");
    assert_eq!(map["triangles"], few);
    let text = String::from_utf8_lossy(&std::fs::read(folder.path().join("map.ply")).expect("a map")).into_owned();
    assert!(text.contains("property uchar red"), "the map has colours");
    let pipeline = &report["result"]["pipeline"];
    assert_eq!((&pipeline["triangles"]["kept"], &pipeline["lattice"]), (&10.into(), &false.into()));
    let holes = pipeline["holes"].as_array().expect("a list");
    assert!(holes.len() == 1 && holes[0]["edges"] == 4 && holes[0]["closed_by"]["lid"] == "flat", "{holes:?}");
    for fill in ["flat", "smooth"] {
        let line = format!("repair testdata/open_cube.off -o OUT/out.off --force --fill {fill}");
        run_in(&folder, &line).exits(0).says(&["1 hole closed with "]);
        let report = run_in(&folder, &format!("{line} --json")).exits(0).json();
        assert_eq!(
            (&report["options"]["fill"], &report["result"]["pipeline"]["holes"][0]["closed_by"]["lid"]),
            (&fill.into(), &fill.into())
        );
    }
    let (all, report) = repair("--simplify off --rebuild");
    assert_eq!(report["result"]["pipeline"]["fit"]["kept"], 0);
    let (raw, report) = repair("--no-fit");
    assert!(all > 1000 && raw > 1000, "{all} and {raw} triangles");
    assert!(report["result"]["pipeline"]["fit"].is_null());
    run_in(&folder, "repair testdata/open_cube.off -o OUT/out.off --no-fit --simplify off").exits(2);
    run_in(&folder, "repair testdata/open_cube.off -o OUT/out.off --no-fit --rebuild").exits(2);
    run_in(&folder, "repair testdata/open_cube.off -o OUT/out.ply --map OUT/out.ply").exits(2);
    run_in(&folder, "repair testdata/open_cube.off -o OUT/out.ply --map testdata/open_cube.off").exits(2);
}

#[test]
fn what_counts_as_inside_is_a_flag_of_every_verb_that_reads_a_soup() {
    let folder = folder();
    // Three boxes of 960, 360 and 256; the first overlaps the others by 120 and 128.
    let boxes = "testdata/overlapping_boxes.obj";
    for (line, rule, volume) in [
        (format!("repair {boxes}"), "positive", 1328.0),
        (format!("repair {boxes}"), "nonzero", 1328.0),
        (format!("repair {boxes}"), "odd", 1080.0),
        (format!("csg a|b a={boxes} b={boxes}"), "odd", 1080.0),
        (format!("union {boxes} {boxes}"), "odd", 1080.0),
    ] {
        let flags = format!("-o OUT/a.ply --force --resolution 64 --json --inside {rule}");
        let said = run_in(&folder, &format!("{line} {flags}")).exits(0).json();
        let both = (&said["options"]["inside"], &said["result"]["pipeline"]["inside"]);
        assert_eq!(both, (&rule.into(), &rule.into()), "{line}");
        assert_volume(&solid(&folder, "a.ply"), volume, 0.005);
    }
    assert_eq!(
        run_in(&folder, &format!("repair {boxes} -o OUT/b.ply --resolution 32 --json")).json()["options"]["inside"],
        "positive"
    );
    // Verbs that repair first take it, too.
    let grown = format!("dilate {boxes} --radius 0.5 -o OUT/d.ply --resolution 64 --inside odd --json");
    let said = run_in(&folder, &grown).exits(0).json();
    let before = said["result"]["pipeline"]["morphology"]["volume_before"].as_f64().expect("a number");
    assert!((before / 1080.0 - 1.0).abs() < 0.005, "{before}");
    // The sign of a distance and the reading of a field.
    let inside = |rule: &str| {
        let line = format!("sdf {boxes} -o OUT/{rule}.nrrd --resolution 40 --inside {rule} --json");
        run_in(&folder, &line).exits(0).json()["result"]["distance"]["inside"].as_u64().expect("a number")
    };
    let (odd, positive) = (inside("odd") as f64, inside("positive") as f64);
    assert!((odd / positive / (1080.0 / 1328.0) - 1.0).abs() < 0.05, "{odd} and {positive}");
    assert_eq!(inside("nonzero") as f64, positive);
    run_in(&folder, &format!("field a a={boxes} -o OUT/f.ply --resolution 64 --inside odd")).exits(0);
    assert_volume(&solid(&folder, "f.ply"), 1080.0, 0.01);
    let refused = format!("sdf {boxes} -o OUT/p.nrrd --sign pseudonormal --inside odd");
    run_in(&folder, &refused).exits(2).says(&["--inside cannot change that", "hint: "]);
    run_in(&folder, &format!("repair {boxes} -o OUT/p.ply --inside even")).exits(2).says(&["positive, nonzero, odd"]);
}

#[test]
fn surfaces_inside_others_are_counted_whether_they_are_whole_or_not() {
    let folder = folder();
    let put = |name: &str, triangles: usize| {
        let big = cuboid(DVec3::ZERO, DVec3::splat(8.0));
        let mut mesh = cuboid(DVec3::splat(2.0), DVec3::splat(5.0));
        mesh.triangles.truncate(triangles);
        mesh.append(&big);
        meshwright::io::write(folder.path().join(name), &mesh).expect("written");
    };
    put("whole.off", 12);
    put("open.off", 11);
    for name in ["whole", "open"] {
        let run = run_in(&folder, &format!("repair OUT/{name}.off -o OUT/{name}.ply --resolution 32"));
        run.exits(0).says(&["1 surface left out: inside of others, or outside of the result"]);
        assert_volume(&solid(&folder, &format!("{name}.ply")), 512.0, 1e-12);
    }
}
