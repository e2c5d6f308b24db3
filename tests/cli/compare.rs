//! `compare` as users meet it.

use super::{assert_empty, folder, names_in, run, run_in};

#[test]
fn a_table_in_words_and_a_report() {
    let text = run(&["compare", "testdata/torus.ply", "testdata/torus.ply", "--unit", "mm"]).exits(0).text();
    for words in ["mean 0 mm, RMS 0 mm, 99 % within 0 mm, largest 0 mm", "in both", "sharp edges", "normals"] {
        assert!(text.contains(words), "`{words}` is missing in:\n{text}");
    }
    let folder = folder();
    let json = run_in(&folder, "compare testdata/torus.ply testdata/hollow_ball.stl --json --samples 5000").exits(0);
    let found = &json.json()["result"]["comparison"];
    assert_eq!(found["samples"], 5000);
    let number = |way: &str, what: &str| found[way][what].as_f64().expect("a number");
    assert_eq!(number("symmetric", "max"), number("a_to_b", "max").max(number("b_to_a", "max")));
    assert!(number("symmetric", "mean") > 0.0);
    assert!(found["sharp"]["tolerance"].as_f64().is_some_and(|tolerance| tolerance > 0.0));
    assert!(found["symmetric"]["relative"]["rms"].is_f64());
}

#[test]
fn a_limit_on_the_largest_distance() {
    let with = |limit: &str| {
        run(&["compare", "testdata/torus.ply", "testdata/open_cube.off", "--samples", "1000", "--fail-on-max", limit])
    };
    with("1000").exits(0);
    with("0.001%").exits(3).says(&["largest distance", "--fail-on-max"]);
    with("2h").exits(2).says(&["voxels"]);
    with("1mm").exits(2).says(&["--unit"]);
}

#[test]
fn a_coloured_map() {
    let folder = folder();
    let arguments = "compare testdata/open_cube.off testdata/torus.ply --samples 1000 --map OUT/map.ply";
    run_in(&folder, arguments).exits(0);
    assert_eq!(names_in(folder.path()), ["map.ply"]);
    let path = folder.path().join("map.ply");
    let map = meshwright::io::read(&path).expect("it is sound");
    let torus = meshwright::io::read("testdata/torus.ply").expect("it is sound");
    assert_eq!(map.mesh, torus.mesh);
    let bytes = std::fs::read(&path).expect("it is there");
    let header = String::from_utf8_lossy(&bytes[..1500.min(bytes.len())]).into_owned();
    for words in ["property float quality", "property uchar red", "full colour at", "99th percentile"] {
        assert!(header.contains(words), "`{words}` is missing in:\n{header}");
    }
}

#[test]
fn maps_and_inputs_that_cannot_be() {
    let folder = folder();
    for (arguments, status, words) in [
        ("--map OUT/map.stl", 2, "ply would be written"),
        ("--map -", 2, "wants a file"),
        ("--map testdata/torus.ply", 2, "input"),
        ("--map OUT/a.ply --report OUT/a.ply", 2, "--report"),
        ("--samples 0", 2, "samples"),
    ] {
        run_in(&folder, &format!("compare testdata/torus.ply testdata/torus.ply {arguments}"))
            .exits(status)
            .says(&[words]);
        assert_empty(&folder);
    }
    let flat = folder.path().join("flat.off");
    std::fs::write(&flat, "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n").expect("the folder is there");
    run_in(&folder, "compare testdata/torus.ply OUT/flat.off --map OUT/m.ply")
        .exits(4)
        .says(&["no triangle has an area"]);
    assert_eq!(names_in(folder.path()), ["flat.off"]);
}
