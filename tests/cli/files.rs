//! Reading, writing, inspecting, converting, drawing.

use std::io::Write;
use std::process::Stdio;

use super::{Run, assert_empty, folder, program, run, run_in, sample};

/// Runs the program with `bytes` on its standard input.
fn piped(arguments: &[&str], bytes: &[u8]) -> Run {
    let mut child =
        program().args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let bytes = bytes.to_vec();
    let feeder = std::thread::spawn(move || stdin.write_all(&bytes));
    let output = child.wait_with_output().unwrap();
    // A program that refuses early closes the pipe: its exit status is judged, not the feeding.
    let _ = feeder.join().unwrap();
    output.into()
}

#[test]
fn an_absent_file_is_named() {
    let folder = folder();
    for arguments in [
        "repair OUT/absent.stl -o OUT/a.stl",
        "inspect OUT/absent.stl",
        "convert OUT/absent.stl -o OUT/a.stl",
        "render OUT/absent.stl -o OUT/a.png",
        "union testdata/torus.ply OUT/absent.stl -o OUT/a.stl",
        "csg a|b a=testdata/torus.ply b=OUT/absent.stl -o OUT/a.stl",
    ] {
        run_in(&folder, arguments).exits(4).says(&["error: ", "absent.stl"]);
        assert_empty(&folder);
    }
}

#[test]
fn empty_and_broken_files_exit_with_4_and_say_where() {
    let folder = folder();
    for (name, bytes) in [
        ("empty.stl", &b""[..]),
        ("no_triangles.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        ("short.off", b"OFF\n4 4 0\n0 0 0\n"),
        ("noise.bin", b"\x01\x02\x03 nobody knows what this is"),
    ] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        run_in(&folder, &format!("inspect OUT/{name}")).exits(4).says(&["error: ", name]);
        run_in(&folder, &format!("convert OUT/{name} -o OUT/out.ply")).exits(4).says(&["error: ", name]);
        assert!(!folder.path().join("out.ply").exists());
    }
}

#[test]
fn inspect_prints_a_table_and_json() {
    let text = run(&["inspect", "testdata/open_cube.off"]).exits(0).text();
    for words in ["triangles  10", "10 x 10 x 10", "not stated", "4 edges are open"] {
        assert!(text.contains(words), "`{words}` is missing in:\n{text}");
    }
    let json = run(&["inspect", "testdata/hollow_ball.stl", "--json", "--unit", "mm"]).exits(0).json();
    assert_eq!(json["schema"], 2);
    assert_eq!(json["verb"], "inspect");
    assert_eq!(json["exit"], 0);
    let validity = &json["inputs"][0]["validity"];
    assert_eq!((&validity["bodies"], &validity["open_edges"]), (&2.into(), &0.into()));
    assert_eq!(json["inputs"][0]["sha256"].as_str().unwrap().len(), 64);
}

#[test]
fn inspect_fails_on_the_defects_asked_for() {
    for (file, defect, status) in [
        ("open_cube.off", "open", 3),
        ("open_cube.off", "self,nonmanifold", 0),
        ("overlapping_boxes.obj", "self", 3),
        ("overlapping_boxes.obj", "open", 0),
        ("inside_out_cube.stl", "inside-out", 3),
        ("flipped_patches.ply", "inconsistent", 3),
        ("doubled_faces.off", "duplicate", 3),
        ("noisy_cube.off", "any", 0),
        ("hollow_ball.stl", "any", 0),
        ("torus.ply", "any", 0),
        ("monkey_saddle.off", "any", 0),
    ] {
        let path = format!("testdata/{file}");
        let run = run(&["inspect", &path, "--fail-on", defect]).exits(status);
        assert_eq!(run.stderr.starts_with("error: "), status == 3, "{file}: {}", run.stderr);
    }
}

#[test]
fn convert_keeps_every_triangle_in_every_format() {
    let folder = folder();
    for format in ["stl", "obj", "ply", "off", "glb", "3mf"] {
        let out = format!("OUT/torus.{format}");
        run_in(&folder, &format!("convert testdata/torus.ply -o {out}")).exits(0);
        let json = run_in(&folder, &format!("inspect {out} --json")).exits(0).json();
        let validity = &json["inputs"][0]["validity"];
        assert_eq!(json["inputs"][0]["format"], format);
        assert_eq!(validity["triangles"], 4096, "{format}");
        assert_eq!(validity["open_edges"], 0, "{format}");
        assert!((validity["volume"].as_f64().unwrap() - 1824.06).abs() < 0.01, "{format}");
    }
}

#[test]
fn convert_keeps_colours_and_says_where_it_cannot() {
    let folder = folder();
    let read = |name: &str| meshwright::io::read(folder.path().join(name)).expect("it is sound");
    let off =
        "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1 255 0 0\n3 0 1 3 0 0 255\n3 1 2 3 9 8 7\n3 2 0 3 1 2 3\n";
    std::fs::write(folder.path().join("in.off"), off).unwrap();
    let colours = read("in.off").colours;
    assert!(colours.is_some());
    for format in ["ply", "off", "glb", "gltf", "3mf"] {
        let text = run_in(&folder, &format!("convert OUT/in.off -o OUT/out.{format}")).exits(0).stderr;
        let text: String = text.lines().filter(|line| !line.contains("the model is not known")).collect();
        assert!(!text.contains("note:"), "{text}");
        let loaded = read(&format!("out.{format}"));
        let corners = |loaded: &meshwright::io::Loaded| {
            let colours = loaded.colours.as_ref().expect("it has colours");
            (0..4).map(|t| colours.corners(&loaded.mesh, t)).collect::<Vec<_>>()
        };
        assert_eq!(corners(&loaded), corners(&read("in.off")), "{format}");
    }
    run_in(&folder, "convert OUT/in.off -o OUT/out.stl").exits(0).says(&["stl holds no colours"]);
    run_in(&folder, "convert OUT/in.off -o OUT/out.obj").exits(0).says(&["obj has no place", "averaged"]);
    assert!(read("out.obj").colours.is_some());
}

#[test]
fn convert_writes_text_when_asked() {
    let folder = folder();
    run_in(&folder, "convert testdata/thin_plate.stl -o OUT/text.stl --ascii").exits(0);
    let text = std::fs::read_to_string(folder.path().join("text.stl")).unwrap();
    assert!(text.starts_with("solid"), "{text}");
}

#[test]
fn a_unit_goes_along_where_the_format_has_a_place_for_it() {
    let folder = folder();
    run_in(&folder, "convert testdata/thin_plate.stl -o OUT/plate.3mf --unit in").exits(0);
    let json = run_in(&folder, "inspect OUT/plate.3mf --json").exits(0).json();
    assert_eq!(json["inputs"][0]["unit"], "in");
    // The numbers are untouched: nothing is rescaled.
    assert_eq!(json["inputs"][0]["validity"]["bounds"][1][0], 10.0);
    run_in(&folder, "inspect OUT/plate.3mf --unit mm").exits(0);
    run_in(&folder, "inspect OUT/plate.3mf --unit mm").says(&["note: --unit mm is not used"]);
}

#[test]
fn streams_carry_what_files_do() {
    let folder = folder();
    let cube = std::fs::read(sample("open_cube.off")).unwrap();
    run_in(&folder, "convert testdata/open_cube.off -o OUT/cube.stl").exits(0);
    let streamed = piped(&["convert", "-", "-o", "-", "--out-format", "stl"], &cube).exits(0);
    assert_eq!(streamed.stdout, std::fs::read(folder.path().join("cube.stl")).unwrap());
    let text = piped(&["inspect", "-", "--in-format", "off"], &cube).exits(0).text();
    assert!(text.contains("standard input"), "{text}");
    piped(&["inspect", "-"], b"what is this").exits(4).says(&["standard input", "--in-format"]);
}

#[test]
fn render_draws_a_picture_of_the_size_asked_for() {
    let folder = folder();
    run_in(&folder, "render testdata/broken_mug.obj -o OUT/one.png --width 200 --height 150").exits(0);
    run_in(
        &folder,
        "render testdata/open_cube.off testdata/noisy_cube.off -o OUT/two.png --width 200 --height 100 --edges all",
    )
    .exits(0);
    run_in(&folder, "render testdata/torus.ply -o OUT/plain.png --width 64 --height 64 --edges none --no-defects")
        .exits(0);
    for (name, size) in [("one.png", Some((200, 150))), ("two.png", None), ("plain.png", Some((64, 64)))] {
        let file = std::fs::File::open(folder.path().join(name)).unwrap();
        let reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().unwrap();
        let info = reader.info();
        assert!(size.is_none_or(|size| size == (info.width, info.height)), "{name}: {} x {}", info.width, info.height);
    }
}

#[test]
fn an_existing_output_keeps_its_mode_and_links_are_followed() {
    let folder = folder();
    let out = folder.path().join("out.stl");
    std::fs::write(&out, b"old").unwrap();
    #[cfg(unix)]
    {
        use std::os::unix::fs::{PermissionsExt, symlink};
        std::fs::set_permissions(&out, std::fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&out, folder.path().join("link.stl")).unwrap();
        run_in(&folder, "convert testdata/open_cube.off -o OUT/link.stl").exits(0);
        assert!(folder.path().join("link.stl").is_symlink());
        assert_eq!(out.metadata().unwrap().permissions().mode() & 0o777, 0o640);
        assert_eq!(std::fs::read(&out).unwrap().len(), 84 + 50 * 10);
        run_in(&folder, "convert testdata/open_cube.off -o /dev/null --out-format off").exits(0);
    }
}
