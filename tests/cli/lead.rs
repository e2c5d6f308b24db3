//! What `inspect` leads to: the worst defects first, what a repair would do, and a command that does it.

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

use super::{Run, folder, program, run, sample};

/// The meshes of `testdata` that are no solids.
const BROKEN: [&str; 11] = [
    "bored_block.off",
    "broken_mug.obj",
    "cracked_ball.stl",
    "doubled_faces.off",
    "flipped_patches.ply",
    "inside_out_cube.stl",
    "open_cube.off",
    "open_sheet.obj",
    "overlapping_boxes.obj",
    "thin_parts.obj",
    "touching_boxes.obj",
];

/// And those that are.
const VALID: [&str; 5] = ["hollow_ball.stl", "monkey_saddle.off", "noisy_cube.off", "thin_plate.stl", "torus.ply"];

/// The report of `inspect` for a mesh of `testdata`.
fn inspected(name: &str) -> Value {
    run(&["inspect", sample(name).to_str().expect("a name"), "--resolution", "48", "--json"]).exits(0).json()
}

/// Runs a command as it is printed, in a folder.
fn typed(command: &str, folder: &Path) -> Run {
    let programs = Path::new(env!("CARGO_BIN_EXE_meshwright")).parent().expect("a folder").to_owned();
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::env::join_paths(std::iter::once(programs).chain(std::env::split_paths(&paths))).expect("paths");
    let mut shell = Command::new("sh");
    shell.args(["-c", command]).current_dir(folder).env("PATH", paths).stdin(Stdio::null());
    shell.output().expect("a shell").into()
}

/// The commands of the rows `next`, of a file in a folder.
fn next(folder: &TempDir, arguments: &[&str]) -> Vec<String> {
    let mut program = program();
    program.current_dir(folder.path()).arg("inspect").args(arguments);
    let text = Run::from(program.output().expect("the program starts")).exits(0).text();
    let rows = text.lines().skip_while(|line| !line.starts_with("next"));
    let rows = rows.map(|line| line.strip_prefix("next").unwrap_or(line).trim());
    rows.filter(|row| row.starts_with("meshwright ")).map(str::to_owned).collect()
}

#[test]
fn the_command_makes_a_solid() {
    for name in BROKEN {
        let folder = folder();
        std::fs::copy(sample(name), folder.path().join(name)).expect("copied");
        let commands = next(&folder, &[name, "--resolution", "48"]);
        let first = commands.first().expect(name);
        let verb = if name == "open_sheet.obj" { "thicken" } else { "repair" };
        assert!(first.starts_with(&format!("meshwright {verb} {name} -o ")), "{first}");
        let ran = typed(first, folder.path());
        assert_eq!(ran.status, 0, "{first}: {}", ran.stderr);
        let made = first.split(' ').skip_while(|word| *word != "-o").nth(1).expect("an output");
        let made = folder.path().join(made);
        run(&["inspect", made.to_str().expect("a name"), "--fail-on", "any"]).exits(0);
    }
}

#[test]
fn a_valid_solid_needs_no_command() {
    for name in VALID {
        let result = &inspected(name)["result"];
        assert_eq!(result["next"].as_array().map(Vec::len), Some(1), "{name}");
        assert_eq!(result["next"][0]["command"], Value::Null, "{name}");
        assert!(result["next"][0]["what"].as_str().is_some_and(|what| what.starts_with("nothing to repair")), "{name}");
        assert!(result["worst"].is_null() && result["detail"].is_null(), "{name}");
    }
}

#[test]
fn groups_are_all_there_is_the_worst_first_and_where_the_mesh_is() {
    const KINDS: [(&str, &str); 7] = [
        ("open", "open_edges"),
        ("self", "self_intersecting_triangles"),
        ("nonmanifold", "nonmanifold_edges"),
        ("inconsistent", "inconsistent_edges"),
        ("nonmanifold-vertex", "nonmanifold_vertices"),
        ("duplicate", "duplicate_triangles"),
        ("degenerate", "degenerate_triangles"),
    ];
    for name in BROKEN {
        let report = inspected(name);
        let validity = &report["inputs"][0]["validity"];
        let list = |field: &str| report["result"][field].as_array().cloned().unwrap_or_default();
        let (worst, further) = (list("worst"), list("further"));
        for (kind, field) in KINDS {
            let of_kind = worst.iter().chain(&further).filter(|entry| entry["kind"] == kind);
            let sum: u64 = of_kind.filter_map(|entry| entry["count"].as_u64()).sum();
            assert_eq!(Some(sum), validity[field].as_u64(), "{name}: {kind}");
        }
        let [min, max] = [0, 1].map(|n| validity["bounds"][n].as_array().cloned().expect("three numbers"));
        for entry in &worst {
            for axis in 0..3 {
                let [low, at, high] =
                    [&min[axis], &entry["at"][axis], &max[axis]].map(|x| x.as_f64().expect("a number"));
                assert!(low <= at && at <= high, "{name}: {entry}");
            }
            assert!(!entry["repair"].as_str().expect("words").is_empty());
        }
        // What is open or crosses comes before what is only left out, and of those the largest first.
        let rank = |entry: &Value| match entry["kind"].as_str().expect("a kind") {
            "open" if entry["repair"].as_str().is_some_and(|words| words.starts_with("joined")) => 3,
            "open" | "self" => 0,
            "nonmanifold" => 1,
            "inconsistent" => 2,
            "nonmanifold-vertex" => 4,
            "duplicate" => 5,
            _ => 6,
        };
        let size = |entry: &Value| entry["size"].as_f64().expect("a size");
        let in_order = |a: &Value, b: &Value| rank(a) < rank(b) || rank(a) == rank(b) && size(a) >= size(b);
        assert!(worst.is_sorted_by(in_order), "{name}");
    }
}

#[test]
fn the_table_tells_eight_groups_and_sums_the_others_up() {
    let text = run(&["inspect", sample("doubled_faces.off").to_str().expect("a name")]).exits(0).text();
    let rows: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("worst")).collect();
    assert!(rows[0].contains("304 crossing triangles, 34.02 across, around "), "{text}");
    assert!(rows[8].contains("and 50 other groups: ") && rows[8].contains("and 171 repeated triangles"), "{text}");
    assert!(rows[9].starts_with("detail") && rows[9].contains("nothing is lost"), "{text}");
    assert!(rows[10].starts_with("next") && rows[10].contains("meshwright repair "), "{text}");
}

#[test]
fn what_is_foretold_is_what_is_done() {
    let folder = folder();
    let out = folder.path().join("out.ply");
    for name in BROKEN.iter().filter(|name| **name != "open_sheet.obj") {
        let said = inspected(name);
        let arguments =
            ["repair", sample(name).to_str().expect("a name"), "-o", out.to_str().expect("a name")].map(str::to_owned);
        let arguments = arguments.into_iter().chain(["--resolution", "48", "--json"].map(str::to_owned));
        let done = Run::from(program().args(arguments).output().expect("it starts")).exits(0).json();
        let done = &done["result"]["pipeline"];
        let way = match (done["lattice"] == true, done["exact"].is_null()) {
            (true, _) => "voxels",
            (false, false) => "exact",
            (false, true) => "as-it-is",
        };
        assert_eq!(said["result"]["detail"]["way"], way, "{name}");
    }
    let cube = inspected("open_cube.off");
    assert_eq!(cube["result"]["worst"][0]["repair"], "closed: flat, 2 triangles");
}

#[test]
fn names_are_quoted_and_flags_go_on() {
    let folder = folder();
    for name in ["it's a part.off", "-part.off", "ö (1).off"] {
        std::fs::copy(sample("open_cube.off"), folder.path().join(name)).expect("copied");
        let path = format!("./{name}");
        let given = if name.starts_with('-') { path.as_str() } else { name };
        let commands = next(&folder, &[given, "--unit", "mm", "--voxel", "0.5mm"]);
        let first = commands.first().expect(name);
        assert!(first.contains("--voxel 0.5mm") && first.contains("--unit mm"), "{first}");
        assert_eq!(typed(first, folder.path()).status, 0, "{first}");
        let made = name.replace(".off", "_repaired.off");
        assert!(folder.path().join(&made).exists(), "{made}");
    }
}

#[test]
fn what_makes_no_difference_is_refused() {
    let folder = folder();
    let grid = folder.path().join("a.vti");
    let grid = grid.to_str().expect("a name");
    run(&["sdf", sample("open_cube.off").to_str().expect("a name"), "-o", grid, "--resolution", "16"]).exits(0);
    run(&["inspect", grid, "--resolution", "64"]).exits(2).says(&["are about the triangles of a mesh"]);
}
