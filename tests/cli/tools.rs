//! The small tools beside a repair: `decimate`, `split`, `hollow`, the transforms of `convert`, what `inspect` measures, `--preset`.

use std::path::Path;

use meshwright::io;
use meshwright::mesh::TriMesh;
use serde_json::Value;
use tempfile::TempDir;

use super::{assert_empty, folder, names_in, run_in, sample};

fn mesh(folder: &TempDir, name: &str) -> TriMesh {
    io::read(folder.path().join(name)).expect("it reads").mesh
}

fn given(name: &str) -> TriMesh {
    io::read(sample(name)).expect("it reads").mesh
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
}

#[test]
fn decimate_leaves_what_was_asked_for_and_says_how_far_it_moved() {
    let folder = folder();
    let json = run_in(&folder, "decimate testdata/torus.ply -o OUT/t.stl --ratio 25% --json").exits(0).json();
    assert_eq!(json["result"]["decimate"]["before"], 4096);
    assert_eq!(json["result"]["decimate"]["reached"], true);
    assert!(
        number(&json["result"]["decimate"]["after"]) <= 1024.0 && number(&json["result"]["decimate"]["after"]) > 900.0
    );
    assert!(number(&json["result"]["comparison"]["symmetric"]["max"]) < 0.2);
    assert_eq!(json["result"]["output"]["validity"]["self_intersecting_triangles"], 0);
    assert_eq!(
        mesh(&folder, "t.stl").triangles.len(),
        json["result"]["decimate"]["after"].as_u64().expect("a count") as usize
    );
    let said = run_in(&folder, "decimate testdata/torus.ply -o OUT/t.ply --max-deviation 0.05").exits(0);
    said.says(&["4,096 triangles became", "moved", "without self-intersections"]);
    let json = run_in(&folder, "compare testdata/torus.ply OUT/t.ply --json").exits(0).json();
    assert!(number(&json["result"]["comparison"]["symmetric"]["max"]) <= 0.05);
    run_in(&folder, "inspect OUT/t.ply --fail-on any").exits(0);
}

#[test]
fn decimate_refuses_what_it_cannot_keep_valid_and_says_when_it_could_not_go_on() {
    let folder = folder();
    run_in(&folder, "decimate testdata/open_cube.off -o OUT/x.stl --ratio 0.5").exits(4).says(&[
        "no valid solid",
        "4 edges are open",
        "meshwright repair",
    ]);
    run_in(&folder, "decimate testdata/torus.ply -o OUT/x.stl").exits(2).says(&["--triangles"]);
    run_in(&folder, "decimate testdata/torus.ply -o OUT/x.stl --triangles 9 --ratio 0.5").exits(2);
    for ratio in ["0", "1", "-0.5", "100%", "x"] {
        run_in(&folder, &format!("decimate testdata/torus.ply -o OUT/x.stl --ratio={ratio}")).exits(2).says(&["share"]);
    }
    run_in(&folder, "decimate testdata/torus.ply -o OUT/x.stl --max-deviation 2h").exits(2).says(&["voxels"]);
    assert_empty(&folder);
    // A ball and its void have at least four triangles each.
    run_in(&folder, "decimate testdata/hollow_ball.stl -o OUT/b.off --triangles 6").exits(3).says(&["no edge is left"]);
    run_in(&folder, "inspect OUT/b.off --fail-on any").exits(0);
    // With a bound for the deviation that is what was asked for.
    run_in(&folder, "decimate testdata/hollow_ball.stl -o OUT/b.off --triangles 6 --max-deviation 0.1").exits(0);
}

#[test]
fn decimate_keeps_the_colours_of_faces_and_their_borders() {
    let folder = folder();
    // A box of grids, one half of it red.
    let mut text = String::from("OFF\n");
    let (n, mut vertices, mut faces) = (6i32, Vec::new(), Vec::new());
    for axis in 0..3 {
        for up in [0, n] {
            let first = vertices.len();
            for k in 0..(n + 1) * (n + 1) {
                let mut p = [0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (up, k % (n + 1), k / (n + 1));
                vertices.push(p);
            }
            for k in 0..n * n {
                let at = |du: i32, dv: i32| first + ((k / n + dv) * (n + 1) + k % n + du) as usize;
                let quad = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
                let [a, b, c, d] = if up == n { quad } else { [quad[0], quad[3], quad[2], quad[1]] };
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    // The sides share their borders.
    let mut first = std::collections::HashMap::new();
    for (k, p) in vertices.iter().enumerate() {
        first.entry(*p).or_insert(k);
    }
    text += &format!("{} {} 0\n", vertices.len(), faces.len());
    vertices.iter().for_each(|p| text += &format!("{} {} {}\n", p[0], p[1], p[2]));
    for face in &faces {
        let red = face.iter().map(|&v| vertices[v][2]).sum::<i32>() > 3 * n / 2;
        let corners = face.map(|v| first[&vertices[v]]);
        let colour = if red { "255 0 0" } else { "0 0 255" };
        text += &format!("3 {} {} {} {colour}\n", corners[0], corners[1], corners[2]);
    }
    std::fs::write(folder.path().join("box.off"), text).expect("written");
    run_in(&folder, "decimate OUT/box.off -o OUT/few.off --triangles 60").exits(0);
    let read = io::read(folder.path().join("few.off")).expect("it reads");
    let colours = read.colours.expect("colours");
    assert!(read.mesh.triangles.len() <= 60);
    for t in 0..read.mesh.triangles.len() {
        let red = colours.corners(&read.mesh, t)[0][0] == 255;
        let fits = read.mesh.corners(t).iter().all(|p| if red { p.z >= 3.0 - 1e-9 } else { p.z <= 3.0 + 1e-9 });
        assert!(fits, "a triangle reaches over the border: {:?}", read.mesh.corners(t));
    }
}

#[test]
fn split_writes_every_body_and_keeps_voids_with_theirs() {
    let folder = folder();
    // A ball with a void, and beside it a torus within a larger file.
    let (ball, torus) = (given("hollow_ball.stl"), given("torus.ply"));
    let mut all = torus.clone();
    let mut aside = ball.clone();
    aside.positions.iter_mut().for_each(|p| p.x += 100.0);
    all.append(&aside);
    io::write(folder.path().join("two.ply"), &all).expect("written");
    let json = run_in(&folder, "split OUT/two.ply -o OUT/parts --json").exits(0).json();
    assert_eq!((&json["options"]["bodies"], &json["options"]["voids"]), (&2.into(), &1.into()));
    assert_eq!(names_in(&folder.path().join("parts")), ["part_001.ply", "part_002.ply"]);
    // The largest first; both as they were, to the last bit.
    let volumes: Vec<f64> = json["result"]["outputs"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|o| number(&o["validity"]["volume"]))
        .collect();
    assert!(volumes[0] > volumes[1], "{volumes:?}");
    for (name, expected) in [("parts/part_001.ply", &aside), ("parts/part_002.ply", &torus)] {
        let found = mesh(&folder, name);
        assert_eq!(found.triangles.len(), expected.triangles.len(), "{name}");
        assert!((0..found.triangles.len()).all(|t| found.corners(t) == expected.corners(t)), "{name}");
    }
    run_in(&folder, "split OUT/two.ply -o OUT/bolt.stl").exits(0).says(&["2 bodies, with 1 void inside"]);
    assert_eq!(names_in(folder.path()), ["bolt_001.stl", "bolt_002.stl", "parts", "two.ply"]);
    run_in(&folder, "inspect OUT/bolt_001.stl --fail-on any").exits(0);
}

#[test]
fn split_keeps_the_colours_of_each_body() {
    let folder = folder();
    let mut text = String::from("OFF\n8 8 0\n");
    for (at, size) in [(0, 1), (9, 3)] {
        text += &format!("{at} 0 0\n{} 0 0\n{at} {size} 0\n{at} 0 {size}\n", at + size);
    }
    for (first, colour) in [(0, "0 0 255"), (4, "255 0 0")] {
        for face in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
            let [a, b, c] = face.map(|v| v + first);
            text += &format!("3 {a} {b} {c} {colour}\n");
        }
    }
    std::fs::write(folder.path().join("two.off"), text).expect("written");
    run_in(&folder, "split OUT/two.off -o OUT/one.off").exits(0).says(&["2 bodies"]);
    for (name, colour) in [("one_001.off", [255, 0, 0, 255]), ("one_002.off", [0, 0, 255, 255])] {
        let read = io::read(folder.path().join(name)).expect("it reads");
        let colours = read.colours.expect("colours");
        assert_eq!(read.mesh.triangles.len(), 4);
        assert!((0..4).all(|t| colours.corners(&read.mesh, t) == [colour; 3]), "{name}: {colours:?}");
    }
}

#[test]
fn split_says_where_it_cannot_write_and_leaves_nothing() {
    let folder = folder();
    run_in(&folder, "split testdata/torus.ply -o -").exits(2).says(&["standard output"]);
    run_in(&folder, "split testdata/torus.ply -o OUT/a.xyz").exits(2).says(&["does not tell its format"]);
    run_in(&folder, "split testdata/torus.ply -o OUT/none/parts").exits(7);
    run_in(&folder, "split testdata/torus.ply -o OUT/parts --timeout 0s").exits(6);
    assert_empty(&folder);
    std::fs::copy(sample("torus.ply"), folder.path().join("part_001.ply")).expect("copied");
    run_in(&folder, "split OUT/part_001.ply -o OUT").exits(2).says(&["is an input and would be overwritten"]);
    run_in(&folder, "split OUT/part_001.ply -o OUT --force").exits(0);
}

#[test]
fn convert_without_transforms_changes_nothing() {
    let folder = folder();
    run_in(&folder, "convert testdata/torus.ply -o OUT/a.off").exits(0);
    let (before, after) = (given("torus.ply"), mesh(&folder, "a.off"));
    assert!(before.positions == after.positions && before.triangles == after.triangles);
}

#[test]
fn transforms_are_done_in_their_order() {
    let folder = folder();
    let line = "convert testdata/torus.ply -o OUT/a.off --translate 1,-2,0.5 --to-origin --rotate x=90 --rotate z=90 --scale 2,1,1";
    let json = run_in(&folder, &format!("{line} --json")).exits(0).json();
    let (before, after) = (given("torus.ply"), mesh(&folder, "a.off"));
    // Scaled along x; then y goes to z and x to y.
    let turned = |p: &glam::DVec3| glam::DVec3::new(p.z, 2.0 * p.x, p.y);
    let low = before.positions.iter().map(turned).reduce(|a, b| a.min(b)).expect("points");
    let moved = glam::DVec3::new(1.0, -2.0, 0.5);
    for (p, q) in before.positions.iter().zip(&after.positions) {
        assert!((turned(p) - low + moved).distance(*q) < 1e-12, "{p} became {q}");
    }
    assert_eq!(json["options"]["transform"]["bounds"][0], serde_json::json!([1.0, -2.0, 0.5]));
    run_in(&folder, "inspect OUT/a.off --fail-on any").exits(0);
}

#[test]
fn a_mirror_keeps_solids_the_right_way_round() {
    let folder = folder();
    run_in(&folder, "convert testdata/torus.ply -o OUT/a.ply --scale 1,1,-1").exits(0).says(&["mirrored"]);
    run_in(&folder, "inspect OUT/a.ply --fail-on any").exits(0);
    run_in(&folder, "convert testdata/torus.ply -o OUT/b.ply --scale 1,-1,-1").exits(0);
    run_in(&folder, "inspect OUT/b.ply --fail-on any").exits(0);
    for nonsense in
        ["--scale 0", "--scale 1,2", "--rotate w=3", "--translate 1,2", "--translate 2h,0,0", "--translate 1mm,0,0"]
    {
        run_in(&folder, &format!("convert testdata/torus.ply -o OUT/c.ply {nonsense}")).exits(2);
    }
    run_in(&folder, "convert testdata/torus.ply -o OUT/c.ply --unit mm --translate 1in,-10%,0")
        .exits(0)
        .says(&["25.4"]);
}

#[test]
fn lay_flat_puts_the_largest_face_down() {
    let folder = folder();
    // A plate, tilted; then laid flat again.
    run_in(&folder, "convert testdata/thin_plate.stl -o OUT/tilted.ply --rotate x=37 --rotate y=20").exits(0);
    run_in(&folder, "convert OUT/tilted.ply -o OUT/flat.ply --lay-flat").exits(0).says(&["laid flat on a face of"]);
    let (plate, flat) =
        (given("thin_plate.stl").bounds().expect("box"), mesh(&folder, "flat.ply").bounds().expect("box"));
    assert_near(flat.min.z, 0.0, 1e-9);
    assert_near(flat.size().z, plate.size().min_element(), 1e-6);
}

#[test]
fn hollow_keeps_the_surface_and_reports_what_is_saved() {
    let folder = folder();
    let line = "hollow testdata/inside_out_cube.stl -o OUT/h.off --wall 1 --resolution 64";
    let json = run_in(&folder, &format!("{line} --json")).exits(0).json();
    let report = &json["result"]["pipeline"]["hollow"];
    assert_eq!((&report["cavities"], &report["left_out"]), (&1.into(), &0.into()));
    assert_near(number(&report["volume_after"]), 1000.0 - 512.0, 0.5);
    assert_eq!(json["result"]["output"]["validity"]["bodies"], 2);
    let said = run_in(&folder, &format!("{line} --drain 2@5,5,11 --drain 1.5@5,5,-1")).exits(0);
    said.says(&[
        "1 cavity with walls of 1",
        "a drain of 2, 1 deep, from 5 5 10 along 0 0 -1",
        "1 closed surface with 1 tunnel",
    ]);
    run_in(&folder, "inspect OUT/h.off --fail-on any").exits(0);
}

#[test]
fn hollow_refuses_with_words() {
    let folder = folder();
    let line = "hollow testdata/inside_out_cube.stl -o OUT/h.off --resolution 64";
    run_in(&folder, &format!("{line} --wall 4.9")).exits(4).says(&["nothing would be hollow"]);
    run_in(&folder, &format!("{line} --wall 0.2")).exits(2).says(&["need a voxel of at most"]);
    run_in(&folder, &format!("{line} --wall 1 --drain 2")).exits(2).says(&["3mm@10,0,-5"]);
    run_in(&folder, line).exits(2).says(&["--wall"]);
    assert_empty(&folder);
    run_in(&folder, "hollow testdata/torus.ply --wall 1 --plan").exits(0);
}

#[test]
fn inspect_weighs_a_cube_and_finds_what_hangs_over() {
    let folder = folder();
    let json = run_in(&folder, "inspect testdata/torus.ply --json").exits(0).json();
    let volume = number(&json["inputs"][0]["validity"]["volume"]);
    assert_near(number(&json["result"]["mass"]["volume"]), volume, 1e-9 * volume);
    run_in(&folder, "repair testdata/inside_out_cube.stl -o OUT/cube.off").exits(0);
    let json = run_in(&folder, "inspect OUT/cube.off --json").exits(0).json();
    for axis in 0..3 {
        assert_near(number(&json["result"]["mass"]["centre"][axis]), 5.0, 1e-9);
        assert_near(number(&json["result"]["mass"]["moments"][axis]), 1000.0 * 200.0 / 12.0, 1e-6);
        assert_near(number(&json["result"]["mass"]["inertia"][axis][axis]), 1000.0 * 200.0 / 12.0, 1e-6);
    }
    assert_eq!(
        (&json["result"]["overhang"]["area"], &json["result"]["overhang"]["resting"]),
        (&0.0.into(), &100.0.into())
    );
    // On its edge, two sides of 100 each hang over by exactly 45°, which is allowed, and not by 44°.
    run_in(&folder, "convert OUT/cube.off -o OUT/edge.off --rotate x=45").exits(0);
    let area = |degrees: &str| {
        let json = run_in(&folder, &format!("inspect OUT/edge.off --json --overhang {degrees}")).exits(0).json();
        number(&json["result"]["overhang"]["area"])
    };
    assert_near(area("45"), 0.0, 0.0);
    assert_near(area("44"), 200.0, 1e-9);
    let said =
        run_in(&folder, "inspect OUT/edge.off --overhang 30 --unit mm --thickness --resolution 64").exits(0).text();
    for words in ["of mass: 5 ", "principal 16,667", "200 mm² (33.33 % of the area) steeper than 30°", "thinnest 10 mm"]
    {
        assert!(said.contains(words), "`{words}` is missing in:\n{said}");
    }
    // An open mesh has no mass.
    let json = run_in(&folder, "inspect testdata/open_cube.off --json").exits(0).json();
    assert!(json["result"]["mass"].is_null() && json["result"]["overhang"].is_null());
    run_in(&folder, "inspect testdata/torus.ply --overhang 90").exits(2);
}

#[test]
fn presets_say_what_they_set_and_what_is_given_by_hand_wins() {
    let folder = folder();
    let line = "repair testdata/torus.ply -o OUT/a.3mf --preset print";
    run_in(&folder, line).exits(0).says(&["preset", "--unit mm --resolution 384 --simplify 0.02h"]);
    let json = run_in(&folder, &format!("{line} --resolution 32 --unit in --json")).exits(0).json();
    assert_eq!(json["options"]["preset"], "print: --simplify 0.02h");
    assert_eq!((&json["options"]["resolution"], &json["options"]["unit"]), (&32.into(), &"in".into()));
    let boolean = "union testdata/torus.ply testdata/inside_out_cube.stl -o OUT/u.ply --preset scan --resolution 32";
    run_in(&folder, boolean).exits(0).says(&["scan: --simplify off"]);
    run_in(&folder, "repair testdata/torus.ply -o OUT/a.3mf --preset laser").exits(2).says(&["print"]);
}

#[test]
fn the_files_of_a_split_that_fails_are_gone() {
    let folder = folder();
    let parts = folder.path().join("parts");
    run_in(&folder, "split testdata/torus.ply -o OUT/parts --report OUT/none/report.json").exits(2);
    assert!(!Path::new(&parts).exists());
}
