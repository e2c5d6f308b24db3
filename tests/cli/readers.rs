//! What readers leave out reaches the user of every verb, what they find to be taken away is taken away, and what they
//! may not take they do not.

use std::io::Write;
use std::path::PathBuf;

use super::{Run, folder, run_in};
use tempfile::TempDir;

/// A cube from 0 to 10, and a statement that is no mesh.
const CUBE_AND_POINT: &str = "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 0 0 10\nv 10 0 10\nv 10 10 10\nv 0 10 10\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\np 1\n";

/// A run of every verb that reads a mesh, with `IN` for the file.
const RUNS: [&str; 18] = [
    "repair IN -o OUT/o.ply --resolution 16",
    "union IN OUT/other.off -o OUT/o.ply --resolution 16",
    "intersection OUT/other.off IN -o OUT/o.ply --resolution 16",
    "difference OUT/other.off IN -o OUT/o.ply --resolution 16",
    "csg a|b a=OUT/other.off b=IN -o OUT/o.ply --resolution 16",
    "dilate IN -o OUT/o.ply --radius 2 --resolution 16",
    "erode IN -o OUT/o.ply --radius 2 --resolution 16",
    "open IN -o OUT/o.ply --radius 2 --resolution 16",
    "close IN -o OUT/o.ply --radius 2 --resolution 16",
    "canals IN --max-diameter 2 --resolution 16",
    "thicken IN -o OUT/o.ply --min 4 --resolution 16",
    "sdf IN -o OUT/o.nrrd --resolution 16",
    "field a a=IN -o OUT/o.ply --resolution 16",
    "compare OUT/other.off IN --samples 100",
    "render IN -o OUT/o.png --width 64 --height 64",
    "convert IN -o OUT/o.ply",
    "inspect IN",
    "repair IN --plan --resolution 16",
];

fn written(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// A cube that overlaps the first, as `other.off`.
fn other(folder: &TempDir) {
    let corners = "5 5 5\n15 5 5\n15 15 5\n5 15 5\n5 5 15\n15 5 15\n15 15 15\n5 15 15\n";
    let faces = "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    written(folder, "other.off", format!("OFF 8 6 0\n{corners}{faces}"));
}

fn on(folder: &TempDir, arguments: &str, path: &std::path::Path) -> Run {
    run_in(folder, &arguments.replace("IN", path.to_str().unwrap()))
}

#[test]
fn every_verb_passes_on_what_its_reader_found() {
    let folder = folder();
    let path = written(&folder, "cube.obj", CUBE_AND_POINT);
    other(&folder);
    let note = format!("{}: 1 line, point or free-form statement left out", path.display());
    for arguments in RUNS {
        let run = on(&folder, arguments, &path);
        assert!(run.status == 0 || run.status == 3, "{arguments}: {}", run.stderr);
        assert_eq!(run.stderr.matches(&format!("note: {note}")).count(), 1, "{arguments}:\n{}", run.stderr);
        let report = on(&folder, &format!("{arguments} --json -q"), &path).json();
        let warnings = report["warnings"].as_array().unwrap();
        assert_eq!(warnings.iter().filter(|warning| **warning == note).count(), 1, "{arguments}: {warnings:?}");
    }
    // Also when the run fails.
    on(&folder, "erode IN -o OUT/o.ply --radius 6 --resolution 16", &path)
        .exits(4)
        .says(&["note: ", "nothing is left"]);
}

/// An axis-aligned box in the words of 3MF.
fn cuboid(min: [i32; 3], max: [i32; 3]) -> String {
    let vertex = |n: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| if n >> k & 1 == 1 { max[k] } else { min[k] });
        format!(r#"<vertex x="{x}" y="{y}" z="{z}"/>"#)
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangle = |t: [usize; 3]| format!(r#"<triangle v1="{}" v2="{}" v3="{}"/>"#, t[0], t[1], t[2]);
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).map(triangle);
    let (vertices, triangles): (String, String) = ((0..8).map(vertex).collect(), triangles.collect());
    format!("<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>")
}

/// A block of 10 by 10 by 10 with a hole of 4 by 4 through it, as a slicer has it.
fn block_with_negative_part() -> Vec<u8> {
    let model = format!(
        r#"<model unit="millimeter"><resources><object id="1">{}</object><object id="2">{}</object><object id="3"><components>
        <component objectid="1"/><component objectid="2"/></components></object></resources><build><item objectid="3"/></build></model>"#,
        cuboid([0; 3], [10; 3]),
        cuboid([3, 3, -1], [7, 7, 11])
    );
    let settings = r#"<config><object id="3"><part id="1" subtype="normal_part"/><part id="2" subtype="negative_part">
        <metadata key="name" value="hole"/></part></object></config>"#;
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, text) in [("3D/3dmodel.model", model.as_str()), ("Metadata/model_settings.config", settings)] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    zip.finish().unwrap().into_inner()
}

#[test]
fn negative_parts_are_subtracted_where_there_is_something_to_subtract_from() {
    let folder = folder();
    let path = written(&folder, "block.3mf", block_with_negative_part());
    written(&folder, "slab.off", {
        let corners = "-1 -1 4\n11 -1 4\n11 11 4\n-1 11 4\n-1 -1 6\n11 -1 6\n11 11 6\n-1 11 6\n";
        format!("OFF 8 6 0\n{corners}4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n")
    });
    for (arguments, volume, tolerance) in [
        ("repair IN -o OUT/o.ply", 840.0, 0.1),
        ("union IN OUT/slab.off -o OUT/o.ply", 840.0 + 288.0 - 168.0, 0.1),
        ("intersection IN OUT/slab.off -o OUT/o.ply", 168.0, 0.1),
        ("difference OUT/slab.off IN -o OUT/o.ply", 288.0 - 168.0, 0.1),
        ("csg b-a a=IN b=OUT/slab.off -o OUT/o.ply", 288.0 - 168.0, 0.1),
        // 8 by 8 by 8 without 4 by 4 that has grown by a rounded 1.
        ("erode IN -o OUT/o.ply --radius 1", 8.0 * (64.0 - 32.0 - std::f64::consts::PI), 0.5),
    ] {
        let run = on(&folder, &format!("{arguments} --resolution 48 --json --force"), &path).exits(0);
        let found = run.json()["result"]["output"]["validity"]["volume"].as_f64().unwrap();
        assert!((found - volume).abs() <= tolerance, "{arguments}: {found} instead of {volume}");
        assert!(!run.stderr.contains("negative part left out"), "{}", run.stderr);
    }
    for arguments in [
        "sdf IN -o OUT/o.nrrd --resolution 16",
        "field a a=IN -o OUT/o.ply --resolution 16",
        "compare IN IN --samples 100",
        "render IN -o OUT/o.png --width 64 --height 64",
        "convert IN -o OUT/c.ply",
        "inspect IN",
    ] {
        on(&folder, arguments, &path).exits(0).says(&["note: ", "1 negative part (`hole`) left out"]);
    }
    let table = on(&folder, "inspect IN", &path).text();
    assert!(table.contains("hole: 12 triangles") && table.contains("1,000 mm³"), "{table}");
}

/// A lattice of zeros, packed.
fn zeros(side: usize) -> Vec<u8> {
    let header = format!(
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {side} {side} {side}\nencoding: gzip\nspacings: 1 1 1\n\n"
    );
    let mut packed = flate2::write::GzEncoder::new(header.into_bytes(), flate2::Compression::best());
    packed.write_all(&vec![0; side.pow(3)]).unwrap();
    packed.finish().unwrap()
}

#[test]
fn lattices_of_files_count_to_the_memory_that_is_allowed() {
    let folder = folder();
    let path = written(&folder, "zeros.nrrd", zeros(256));
    for arguments in [
        "field a a=IN -o OUT/o.nrrd --max-memory 60M",
        "render IN -o OUT/o.png --width 64 --height 64 --max-memory 60M",
    ] {
        on(&folder, arguments, &path).exits(5).says(&["67.1 MB of memory would be needed", "zeros.nrrd"]);
    }
    // The values fit, the field that is made of them does not.
    on(&folder, "field a a=IN -o OUT/o.nrrd --max-memory 100M", &path).exits(5).says(&["lattices that are read"]);
    let small = written(&folder, "small.nrrd", zeros(32));
    on(&folder, "render IN -o OUT/o.png --width 64 --height 64 --max-memory 200M", &small).exits(0);
    // Without a cap, by what the length of the file justifies.
    let bomb = written(&folder, "bomb.nrrd", zeros(640));
    on(&folder, "render IN -o OUT/o.png --width 64 --height 64", &bomb)
        .exits(4)
        .says(&["more than its size justifies"]);
}

#[test]
fn lengths_that_nobody_means_are_wrong_usage() {
    let folder = folder();
    other(&folder);
    for length in ["1e-300", "1e300", "1e300%", "1e-300mm --unit mm"] {
        for arguments in [
            "repair OUT/other.off -o OUT/o.ply --voxel",
            "repair OUT/other.off -o OUT/o.ply --simplify",
            "dilate OUT/other.off -o OUT/o.ply --radius",
            "erode OUT/other.off -o OUT/o.ply --radius",
            "open OUT/other.off -o OUT/o.ply --radius",
            "close OUT/other.off -o OUT/o.ply --radius",
            "canals OUT/other.off --max-diameter",
            "thicken OUT/other.off -o OUT/o.ply --min",
            "sdf OUT/other.off -o OUT/o.npy --voxel",
            "sdf OUT/other.off -o OUT/o.npy --band",
            "inspect OUT/other.off --thickness --voxel",
            "compare OUT/other.off OUT/other.off --tolerance",
            "compare OUT/other.off OUT/other.off --fail-on-max",
            "field a a=OUT/other.off -o OUT/o.ply --voxel",
            "field a a=OUT/other.off -o OUT/o.npy --band",
            "field a a=OUT/other.off -o OUT/o.ply --simplify",
        ] {
            let run = run_in(&folder, &format!("{arguments} {length}")).exits(2).says(&["cannot be meant in any unit"]);
            assert!(run.stderr.len() < 400, "{}", run.stderr);
        }
    }
    for expression in [
        "sphere(1e-300)",
        "sphere(1e300)",
        "box(1e-300,1,1)",
        "cylinder(1,1e300)",
        "torus(1,1e-300)",
        "a|sphere(1e-300)",
        "offset(a,1e300)",
        "shell(a,1e-300)",
        "blur(a,1e300)",
        "coarse(a,1e-300)",
        "move(a,1e300,0,0)",
        "blob(a,1e-300)",
        "filter(a,1e300)",
    ] {
        let file = if expression.contains("(a") || expression.contains("a|") { "a=OUT/other.off" } else { "" };
        let run = run_in(&folder, &format!("field {expression} {file} -o OUT/o.ply --resolution 16")).exits(2);
        run.says(&["column ", "cannot be meant in any unit"]);
    }
}

#[test]
fn point_clouds_and_pages_are_named() {
    let folder = folder();
    let cloud = written(&folder, "scan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    on(&folder, "repair IN -o OUT/o.stl", &cloud).exits(4).says(&["scan.obj", "a point cloud", "3 points"]);
    let page = written(&folder, "part.stl", "<html><body>404</body></html>".repeat(20));
    on(&folder, "repair IN -o OUT/o.stl", &page).exits(4).says(&["part.stl", "a web page", "the download failed"]);
    on(&folder, "repair IN -o OUT/o.stl --in-format stl", &page).exits(4).says(&["a web page"]);
}
