//! `sdf` to VDB, and `render` of grids and slices.

use meshwright::io::{GridFile, GridFormat, GridValues, Unit, read_grid};
use tempfile::TempDir;

use super::{folder, names_in, run_in};

fn grid(folder: &TempDir, name: &str) -> GridFile {
    read_grid(folder.path().join(name)).unwrap_or_else(|e| panic!("{e}"))
}

/// Width, height and pixels of a picture.
fn picture(folder: &TempDir, name: &str) -> (usize, usize, Vec<[u8; 4]>) {
    let (width, height, _, pixels) = super::picture(folder, name);
    (width as usize, height as usize, pixels)
}

#[test]
fn every_format_holds_the_same_field_and_makes_the_same_picture() {
    let folder = folder();
    let mut all = Vec::new();
    for format in GridFormat::ALL {
        let line = format!("sdf testdata/noisy_cube.off -o OUT/f.{format} --resolution 24 --band 3h --unit cm");
        run_in(&folder, &line).exits(0);
        all.push(grid(&folder, &format!("f.{format}")));
    }
    let first = &all[0];
    let [x, y, z] = first.dims.map(|count| count as i32);
    for file in &all {
        assert_eq!((file.format.says_where(), file.dims), (file.unit == Some(Unit::Centimetre), first.dims));
        if file.format.says_where() {
            assert_eq!((file.origin, file.spacing, file.band), (first.origin, first.spacing, first.band));
        }
        for n in 0..x * y * z {
            let voxel = glam::IVec3::new(n % x, n / x % y, n / (x * y));
            assert_eq!(file.at(voxel), first.at(voxel), "{} at {voxel}", file.format);
        }
        let format = file.format;
        run_in(&folder, &format!("render OUT/f.{format} -o OUT/{format}.png --width 300 --height 200 --plain -q"))
            .exits(0);
    }
    let expected = picture(&folder, "vti.png");
    assert!(["nrrd.png", "npy.png", "vdb.png"].iter().all(|name| picture(&folder, name) == expected));
}

#[test]
fn the_whole_field_goes_into_a_tree_too() {
    let folder = folder();
    for format in ["vdb", "nrrd"] {
        run_in(&folder, &format!("sdf testdata/torus.ply -o OUT/f.{format} --resolution 20 --band full")).exits(0);
    }
    let [tree, dense] = ["f.vdb", "f.nrrd"].map(|name| grid(&folder, name));
    assert_eq!((tree.dims, tree.origin, tree.band), (dense.dims, dense.origin, None));
    let GridValues::Dense(values) = &dense.values else { panic!("it is dense") };
    let [x, y, _] = dense.dims;
    for (n, &value) in values.iter().enumerate() {
        let voxel = [n % x, n / x % y, n / (x * y)].map(|k| k as i32);
        assert_eq!(tree.at(voxel.into()), Some(value), "{voxel:?}");
    }
}

#[test]
fn a_tree_has_the_same_bytes_whatever_the_threads_and_takes_less_room() {
    let folder = folder();
    let line = "sdf testdata/broken_mug.obj --resolution 80 --band 2h -q";
    for threads in [1, 3] {
        run_in(&folder, &format!("{line} -o OUT/{threads}.vdb --threads {threads}")).exits(0);
    }
    let bytes = |name: &str| std::fs::read(folder.path().join(name)).expect("a file");
    assert!(bytes("1.vdb") == bytes("3.vdb"));
    let streamed = run_in(&folder, &format!("{line} -o - --out-format vdb")).exits(0).stdout;
    assert!(streamed == bytes("1.vdb"));
    let plan = |format: &str| {
        let json = run_in(&folder, &format!("{line} --plan --json -o OUT/x.{format}")).exits(0).json();
        json["result"]["plan"]["file"].as_u64().expect("bytes") as usize
    };
    assert!(plan("vdb") < plan("vti"), "{} {}", plan("vdb"), plan("vti"));
    assert!((plan("vdb") / 2..2 * plan("vdb")).contains(&streamed.len()), "{} {}", plan("vdb"), streamed.len());
    assert_eq!(names_in(folder.path()), ["1.vdb", "3.vdb"]);
}

#[test]
fn slices_show_both_sides_and_where_they_meet() {
    let folder = folder();
    run_in(&folder, "sdf testdata/torus.ply -o OUT/t.vti --resolution 40 --band 8h --unit mm").exits(0);
    let size = "--width 320 --height 240";
    let said = run_in(
        &folder,
        &format!("render OUT/t.vti -o OUT/z.png --slice z=60% --title t.vti {size} --report OUT/r.json"),
    )
    .exits(0);
    said.says(&["320 x 240 pixels", "slice z = ", "blue inside, orange outside", " mm"]);
    let report = std::fs::read(folder.path().join("r.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_slice(&report).expect("JSON");
    let slice = &report["result"]["slices"][0];
    assert_eq!((&slice["axis"], &report["options"]["slice"]), (&"z".into(), &"z=60%".into()));
    let [low, high] = [0, 1].map(|k| slice["range"][k].as_f64().expect("a number"));
    assert!(low < 0.0 && high > 0.0 && slice["full"].as_f64() == Some(high.max(-low)), "{slice}");
    assert_eq!((&report["inputs"][0]["format"], &report["inputs"][0]["unit"]), (&"vti".into(), &"mm".into()));
    let (width, height, pixels) = picture(&folder, "z.png");
    assert_eq!((width, height), (320, 240));
    let count = |test: fn(&[u8; 4]) -> bool| pixels.iter().filter(|pixel| test(pixel)).count();
    let blue = count(|p| p[2] > p[0].saturating_add(40));
    let orange = count(|p| p[0] > p[2].saturating_add(40));
    let dark = count(|p| p[..3].iter().all(|&c| c < 60));
    assert!(blue > 1000 && orange > 5000 && (200..4000).contains(&dark), "{blue} {orange} {dark}");
    // A grid is told by its content, also from a stream.
    std::fs::rename(folder.path().join("t.vti"), folder.path().join("t.stl")).expect("another name");
    run_in(&folder, &format!("render OUT/t.stl -o OUT/s.png --slice z=60% --title t.vti {size}")).exits(0);
    assert!(picture(&folder, "s.png") == (width, height, pixels));
}

#[test]
fn surfaces_and_slices_stand_beside_each_other() {
    let folder = folder();
    run_in(&folder, "sdf testdata/torus.ply -o OUT/t.vdb --resolution 32 --band full").exits(0);
    let size = "--width 200 --height 160";
    let draw = |inputs: &str, name: &str| {
        let json = run_in(&folder, &format!("render {inputs} -o OUT/{name}.png {size} --json")).exits(0).json();
        (picture(&folder, &format!("{name}.png")), json["result"]["slices"].as_array().map_or(0, Vec::len))
    };
    let (alone, _) = draw("testdata/torus.ply", "alone");
    let (slice, slices) = draw("OUT/t.vdb --slice x=0.2", "slice");
    assert_eq!(slices, 1);
    let (both, slices) = draw("testdata/torus.ply OUT/t.vdb --slice x=0.2", "both");
    assert_eq!((slices, both.0, both.1), (1, 403, 160));
    let part = |left: usize| -> Vec<[u8; 4]> {
        (0..160).flat_map(|y| (left..left + 200).map(move |x| (x, y))).map(|(x, y)| both.2[y * 403 + x]).collect()
    };
    assert!(part(0) == alone.2 && part(203) == slice.2);
    // Without a grid, meshes are sliced: a valid one by its pseudonormals gives the field that `sdf` gives.
    let (_, slices) = draw("testdata/torus.ply testdata/broken_mug.obj --slice z", "meshes");
    assert_eq!(slices, 2);
    let (mesh, _) = draw("testdata/torus.ply --slice z=0.05", "mesh");
    let inside = |pixels: &[[u8; 4]]| pixels.iter().filter(|p| p[2] > p[0].saturating_add(10)).count() as f64;
    assert!(inside(&mesh.2) > 500.0);
}

#[test]
fn slices_that_cannot_be_drawn() {
    let folder = folder();
    run_in(&folder, "sdf testdata/torus.ply -o OUT/t.nrrd --resolution 16").exits(0);
    std::fs::write(folder.path().join("cut.vdb"), b" BDV\0\0\0\0\xe0\0\0\0").expect("a file");
    std::fs::write(folder.path().join("text.nrrd"), b"who knows").expect("a file");
    for (arguments, status, words) in [
        ("OUT/t.nrrd --slice w", 2, "is not an axis"),
        ("OUT/t.nrrd --slice z=1000", 2, "lies outside"),
        ("OUT/t.nrrd --slice z=1mm", 2, "--unit"),
        ("OUT/cut.vdb", 4, "cut short"),
        ("OUT/text.nrrd", 4, "beginning of a file of nrrd"),
        ("testdata/torus.ply OUT/absent.vti", 4, "absent.vti"),
        ("- - --slice z", 2, "only once"),
    ] {
        run_in(&folder, &format!("render {arguments} -o OUT/a.png")).exits(status).says(&[words]);
        assert!(!names_in(folder.path()).contains(&"a.png".to_owned()), "{arguments}");
    }
}
