//! `sdf` as users meet it.

use meshwright::mesh::TriMesh;
use meshwright::sdf::exact::{ExactDistance, PointSign};
use tempfile::TempDir;

use super::{assert_empty, folder, names_in, run_in};

/// A field as read back from an NRRD file.
struct Field {
    header: String,
    sizes: Vec<usize>,
    origin: Vec<f64>,
    spacing: f64,
    values: Vec<f32>,
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks_exact(4).map(|four| f32::from_le_bytes(four.try_into().expect("four bytes"))).collect()
}

fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| "(), ".contains(c))
        .filter(|word| !word.is_empty())
        .map(|w| w.parse().expect("a number"))
        .collect()
}

fn field(folder: &TempDir, name: &str) -> Field {
    let bytes = std::fs::read(folder.path().join(name)).expect("the file is there");
    let end = bytes.windows(2).position(|two| two == b"\n\n").expect("a header");
    let header = String::from_utf8(bytes[..end].to_vec()).expect("text");
    let line = |key: &str| {
        let found = header.lines().find_map(|line| line.strip_prefix(key));
        found.unwrap_or_else(|| panic!("{key} is missing in:\n{header}")).to_string()
    };
    let sizes = numbers(&line("sizes:")).into_iter().map(|size| size as usize).collect();
    let (origin, spacing) = (numbers(&line("space origin:")), numbers(&line("space directions:"))[0]);
    Field { sizes, origin, spacing, values: floats(&bytes[end + 2..]), header }
}

fn mesh(name: &str) -> TriMesh {
    meshwright::io::read(name).expect("it is sound").mesh
}

impl Field {
    /// Checks every value against the distance of its point.
    fn agrees_with(&self, mesh: &TriMesh, band: f64, signed: bool) {
        assert_eq!(self.values.len(), self.sizes.iter().product::<usize>());
        let exact = ExactDistance::of(mesh, PointSign::Pseudonormal);
        for (n, &value) in self.values.iter().enumerate().step_by(7) {
            let at = [n % self.sizes[0], n / self.sizes[0] % self.sizes[1], n / (self.sizes[0] * self.sizes[1])];
            let p = glam::DVec3::from([0, 1, 2].map(|k| self.origin[k] + self.spacing * at[k] as f64));
            let truth = exact.at(p).expect("triangles").signed;
            let (got, truth) = if signed { (f64::from(value), truth) } else { (f64::from(value.abs()), truth.abs()) };
            let truth = truth.clamp(-band, band);
            assert!((got - truth).abs() < 1.1e-4 * self.spacing, "{got} instead of {truth} at {p}");
        }
    }
}

#[test]
fn a_closed_mesh_has_its_exact_distance() {
    let folder = folder();
    let said =
        run_in(&folder, "sdf testdata/torus.ply -o OUT/t.nrrd --resolution 40 --band 3h --unit mm").exits(0).stderr;
    assert!(said.contains("normal at the nearest point") && said.contains("negative inside"), "{said}");
    let found = field(&folder, "t.nrrd");
    for words in ["negative inside", "signed distance in mm", "space units: \"mm\"", "band:=", "endian: little"] {
        assert!(found.header.contains(words), "`{words}` is missing in:\n{}", found.header);
    }
    let torus = mesh("testdata/torus.ply");
    found.agrees_with(&torus, 3.0 * found.spacing, true);
    // The lattice holds the whole band.
    let size = torus.bounds().expect("triangles").size();
    assert!((0..3).all(|k| found.sizes[k] as f64 * found.spacing > size[k] + 6.0 * found.spacing));
    run_in(&folder, "sdf testdata/torus.ply -o OUT/full.nrrd --resolution 30 --band full").exits(0);
    let full = field(&folder, "full.nrrd");
    full.agrees_with(&torus, f64::INFINITY, true);
    assert!(!full.header.contains("band"), "{}", full.header);
}

#[test]
fn soups_go_by_the_votes_unless_told_otherwise() {
    let folder = folder();
    let cube = mesh("testdata/open_cube.off");
    let inside = |flags: &str| {
        let line = format!("sdf testdata/open_cube.off -o OUT/c.nrrd --resolution 24 --band 2h --force {flags} --json");
        let json = run_in(&folder, &line).exits(0).json();
        (json["result"]["distance"]["inside"].as_u64().expect("a count"), json)
    };
    let (count, json) = inside("");
    assert_eq!((&json["options"]["sign"], &json["options"]["method"]), (&"votes".into(), &"exact".into()));
    field(&folder, "c.nrrd").agrees_with(&cube, json["result"]["distance"]["band"].as_f64().expect("a length"), false);
    // 24³ voxels of the cube, give or take its border.
    assert!((22 * 22 * 22..26 * 26 * 26).contains(&count), "{count}");
    assert_eq!(inside("--sign winding").0, count);
    let (by_levels, json) = inside("--sign levels");
    assert_eq!((by_levels, &json["options"]["sign"]), (count, &"levels".into()));
    let (robust, json) = inside("--method robust");
    assert_eq!((robust, &json["options"]["sign"]), (count, &"votes".into()));
    let note = run_in(&folder, "sdf testdata/open_cube.off -o OUT/c.nrrd --resolution 24 --sign pseudonormal").exits(0);
    assert!(note.stderr.contains("note: the surface is no valid solid"), "{}", note.stderr);
    for sign in ["winding", "levels"] {
        let line = format!("sdf testdata/open_cube.off -o OUT/c.nrrd --method robust --sign {sign}");
        run_in(&folder, &line).exits(2).says(&["hint:"]);
    }
}

#[test]
fn characteristics_are_for_closed_surfaces() {
    let folder = folder();
    let line = "sdf testdata/torus.ply -o OUT/c.nrrd --resolution 32 --method characteristics --json";
    let json = run_in(&folder, line).exits(0).json();
    let options = &json["options"];
    assert_eq!((&options["method"], &options["sign"]), (&"characteristics".into(), &"pseudonormal".into()));
    let band = json["result"]["distance"]["band"].as_f64().expect("a length");
    field(&folder, "c.nrrd").agrees_with(&mesh("testdata/torus.ply"), band, true);
    let plan = run_in(&folder, "sdf testdata/torus.ply --method characteristics --plan --json").exits(0).json();
    assert!(plan["result"]["plan"]["seconds"].as_f64().is_some_and(|seconds| seconds > 0.0), "{plan}");
    for (arguments, words) in [
        ("testdata/torus.ply --sign votes", ["goes by pseudonormals", "--method exact"]),
        ("testdata/torus.ply --sign winding", ["goes by pseudonormals", "--method exact"]),
        ("testdata/open_cube.off", ["a closed, oriented surface", "repair it first"]),
        ("testdata/open_cube.off --sign pseudonormal", ["edges are open", "repair it first"]),
        ("testdata/flipped_patches.ply", ["face opposite ways", "repair it first"]),
    ] {
        let line = format!("sdf {arguments} -o OUT/d.nrrd --method characteristics");
        run_in(&folder, &line).exits(2).says(&words);
    }
    assert_eq!(names_in(folder.path()), ["c.nrrd"]);
}

#[test]
fn prisms_give_the_exact_field() {
    let folder = folder();
    let values = |method: &str| {
        let line =
            format!("sdf testdata/monkey_saddle.off -o OUT/{method}.npy --resolution 40 --band 5h --method {method}");
        let said = run_in(&folder, &format!("{line} --backend cpu")).exits(0);
        let bytes = std::fs::read(folder.path().join(format!("{method}.npy"))).expect("a field");
        let start = bytes.len() % 4;
        let numbers: Vec<f32> =
            bytes[start..].chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        (numbers, said.stderr)
    };
    let (exact, (prism, said)) = (values("exact").0, values("prism"));
    assert!(said.contains("by prisms"), "{said}");
    let header = 128 / 4;
    let apart = exact[header..].iter().zip(&prism[header..]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(exact.len() == prism.len() && apart < 1e-3, "{apart}");
    run_in(&folder, "sdf testdata/open_cube.off -o OUT/a.npy --method prism")
        .exits(2)
        .says(&["a field by prisms needs a closed, oriented surface"]);
    run_in(&folder, "sdf testdata/torus.ply -o OUT/a.npy --method prism --sign votes").exits(2).says(&["--sign"]);
}

#[test]
fn the_formats_hold_the_same_numbers() {
    let folder = folder();
    for format in ["nrrd", "npy", "vti"] {
        let line = format!("sdf testdata/noisy_cube.off -o OUT/f.{format} --resolution 20 --report OUT/r.json");
        let said = run_in(&folder, &line).exits(0).stderr;
        assert_eq!(said.contains("no place for origin"), format == "npy", "{said}");
        let json = std::fs::read(folder.path().join("r.json")).expect("a report");
        let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
        assert_eq!((&json["result"]["output"]["format"], &json["verb"]), (&format.into(), &"sdf".into()));
        assert_eq!(json["result"]["output"]["sha256"].as_str().map(str::len), Some(64));
        assert!(json["result"]["distance"]["origin"][0].is_f64() && json["result"]["distance"]["dims"][2].is_u64());
    }
    let expected = field(&folder, "f.nrrd");
    let [x, y, z] = [0, 1, 2].map(|k| expected.sizes[k]);
    let count = 4 * x * y * z;
    let npy = std::fs::read(folder.path().join("f.npy")).expect("the file is there");
    let header = String::from_utf8_lossy(&npy[..npy.len() - count]).into_owned();
    assert!(npy.starts_with(b"\x93NUMPY\x01\x00") && (npy.len() - count).is_multiple_of(64) && header.ends_with('\n'));
    assert!(header.contains(&format!("'descr': '<f4', 'fortran_order': True, 'shape': ({x}, {y}, {z})")), "{header}");
    assert_eq!(floats(&npy[npy.len() - count..]), expected.values);
    let vti = std::fs::read(folder.path().join("f.vti")).expect("the file is there");
    let start =
        vti.windows(9).position(|w| w == b"\"raw\">_\x00".as_slice() || w.starts_with(b"\"raw\">_")).expect("data") + 7;
    assert_eq!(u64::from_le_bytes(vti[start..start + 8].try_into().expect("eight bytes")), count as u64);
    assert_eq!(floats(&vti[start + 8..start + 8 + count]), expected.values);
    let header = String::from_utf8_lossy(&vti[..start]).into_owned();
    assert!(header.contains(&format!("WholeExtent=\"0 {} 0 {} 0 {}\"", x - 1, y - 1, z - 1)), "{header}");
    assert!(header.contains(&format!("Spacing=\"{0} {0} {0}\"", expected.spacing)), "{header}");
    assert!(header.contains("negative inside") && vti.ends_with(b"</AppendedData></VTKFile>\n"));
}

#[test]
fn threads_and_streams_do_not_change_a_byte() {
    let folder = folder();
    let line = "sdf testdata/broken_mug.obj --resolution 40 --band 20h -q -o";
    for threads in [1, 2, 5] {
        run_in(&folder, &format!("{line} OUT/{threads}.nrrd --threads {threads}")).exits(0);
    }
    let bytes = |threads: u32| std::fs::read(folder.path().join(format!("{threads}.nrrd"))).expect("the file is there");
    assert!(bytes(1) == bytes(2) && bytes(1) == bytes(5), "the bytes differ between numbers of threads");
    let streamed = run_in(&folder, &format!("{line} - --out-format nrrd")).exits(0);
    assert!(streamed.stdout == bytes(1) && streamed.stderr.is_empty(), "{}", streamed.stderr);
}

#[test]
fn a_plan_and_a_cap() {
    let folder = folder();
    let text = run_in(&folder, "sdf testdata/torus.ply --plan --band 10%").exits(0).text();
    for label in ["voxel", "stored", "file", "memory", "time"] {
        assert!(text.lines().any(|line| line.starts_with(label)), "`{label}` is missing in:\n{text}");
    }
    let plan = |band: &str| {
        let json = run_in(&folder, &format!("sdf testdata/torus.ply --plan --json --band {band}")).exits(0).json();
        json["result"]["plan"]["memory"].as_u64().expect("bytes")
    };
    assert!(plan("2h") < plan("10h") && plan("10h") < plan("40h"));
    for flags in ["-o OUT/a.nrrd", "--plan"] {
        for (cap, hint) in [("30M", "hint: a narrower --band"), ("1M", "hint: the inputs alone need that much")] {
            run_in(&folder, &format!("sdf testdata/torus.ply {flags} --max-memory {cap}")).exits(5).says(&[
                "error: ",
                "--max-memory",
                hint,
            ]);
        }
    }
    run_in(&folder, "sdf testdata/torus.ply -o OUT/a.nrrd --timeout 0s").exits(6);
    assert_empty(&folder);
}

#[test]
fn wrong_usage_and_inputs_that_enclose_nothing() {
    let folder = folder();
    for (arguments, status, words) in [
        ("testdata/torus.ply", 2, "--output"),
        ("testdata/torus.ply -o OUT/a.stl", 2, ".vti, .nrrd, .npy or .vdb"),
        ("testdata/torus.ply -o -", 2, "--out-format"),
        ("testdata/torus.ply -o OUT/a.nrrd --band 0", 2, "not above zero"),
        ("testdata/torus.ply -o OUT/a.nrrd --band wide", 2, "not a length"),
        ("testdata/torus.ply -o OUT/a.nrrd --band 1mm", 2, "--unit"),
        ("testdata/torus.ply -o OUT/a.nrrd --voxel 2h", 2, "it is the voxel"),
        ("testdata/torus.ply -o OUT/a.nrrd --band 100000h", 4, "narrower band"),
        ("testdata/torus.ply -o OUT/a.nrrd --method guess", 2, "guess"),
        ("testdata/torus.ply -o OUT/nowhere/a.nrrd", 2, "nowhere"),
        ("testdata/absent.ply -o OUT/a.nrrd", 4, "absent.ply"),
        ("testdata/open_sheet.obj -o OUT/a.nrrd --resolution 32", 4, "enclose"),
    ] {
        run_in(&folder, &format!("sdf {arguments}")).exits(status).says(&[words]);
        assert_empty(&folder);
    }
    // A sheet has a distance all the same, if its side is told by its normals.
    run_in(&folder, "sdf testdata/open_sheet.obj -o OUT/a.nrrd --resolution 32 --sign pseudonormal").exits(0);
    assert_eq!(names_in(folder.path()), ["a.nrrd"]);
    std::fs::copy("testdata/torus.ply", folder.path().join("t.nrrd")).expect("a copy");
    run_in(&folder, "sdf OUT/t.nrrd -o OUT/t.nrrd").exits(2).says(&["would be overwritten"]);
}
