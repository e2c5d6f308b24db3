//! Textures from file to file.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use glam::DVec3;
use meshwright::io::{self, Format, TextureMap, WriteOptions};
use meshwright::mesh::TriMesh;

use super::{folder, names_in, run_in};
use crate::common::shapes::cuboid;
use crate::common::textured::{axis, image, jpeg, of_sides, place, png, save};

const FORMATS: [Format; 5] = [Format::Obj, Format::Ply, Format::Glb, Format::Gltf, Format::ThreeMf];

/// A cube of 10, with textures, without its top if it is open.
fn cube(open: bool) -> (TriMesh, TextureMap) {
    let mut mesh = cuboid(DVec3::ZERO, DVec3::splat(10.0));
    if open {
        let top: Vec<bool> = (0..12).map(|t| axis(mesh.corners(t)) == 5).collect();
        let mut top = top.into_iter();
        mesh.triangles.retain(|_| top.next() == Some(false));
    }
    let texture = of_sides(&mesh, [png([9, 8, 7]), jpeg()]);
    (mesh, texture)
}

fn write(path: &Path, (mesh, texture): &(TriMesh, TextureMap)) {
    let format = Format::from_path(path).expect("a format");
    save(path, mesh, texture, &WriteOptions::new(format));
}

fn bits(corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    corners.map(|p| (p + 0.0).to_array().map(f64::to_bits))
}

#[test]
fn what_is_kept_keeps_its_coordinates_and_what_is_new_gets_the_nearest() {
    for format in FORMATS {
        let folder = folder();
        let at = |name: &str| folder.path().join(name);
        let given = cube(true);
        write(&at(&format!("in.{format}")), &given);
        let line = format!("repair OUT/in.{format} -o OUT/out.{format} --map OUT/map.ply --resolution 32");
        let said = run_in(&folder, &line).exits(0).stderr;
        assert!(!said.contains("texture"), "{format}: {said}");
        let out = io::read(at(&format!("out.{format}"))).expect("ours");
        assert_eq!(out.warnings, Vec::<String>::new(), "{format}");
        let found = out.texture.as_ref().expect("textures");
        let (mesh, texture) = &given;
        let own: HashMap<_, usize> = (0..mesh.triangles.len())
            .flat_map(|t| [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|o| (bits(o.map(|k| mesh.corners(t)[k])), t)))
            .collect();
        let (mut kept, mut made) = (0, 0);
        for t in 0..out.mesh.triangles.len() {
            let corners = out.mesh.corners(t);
            let coordinates = found.at(t, false).unwrap_or_else(|| panic!("{format}: triangle {t} has none"));
            let Some(&source) = own.get(&bits(corners)) else {
                made += 1;
                assert!(image(found, t).is_some(), "{format}: triangle {t}");
                // Within the piece of one side, or a little beyond: never over all of the image.
                let low = coordinates.iter().fold([f32::MAX; 2], |a, b| [a[0].min(b[0]), a[1].min(b[1])]);
                let high = coordinates.iter().fold([f32::MIN; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
                assert!((0..2).all(|k| high[k] - low[k] < 0.4), "{format}: triangle {t}: {coordinates:?}");
                continue;
            };
            kept += 1;
            assert_eq!(image(found, t), image(texture, source), "{format}");
            for (k, p) in corners.iter().enumerate() {
                assert_eq!(coordinates[k].map(f32::to_bits), place(*p, axis(corners)).map(f32::to_bits), "{format}");
            }
        }
        assert!(kept >= 6 && made > 0, "{format}: {kept} kept, {made} made");
        // The map has the same triangles, and says which are made.
        let map = io::read(at("map.ply")).expect("a map");
        assert_eq!(map.mesh.triangles.len(), out.mesh.triangles.len());
    }
}

/// The box (0 or 1) and the side that a triangle lies on, if it lies on one.
fn side(corners: [DVec3; 3], boxes: [[f64; 2]; 2]) -> Option<(usize, usize)> {
    let axis = axis(corners);
    (0..2).find_map(|b| corners.iter().all(|p| (p[axis / 2] - boxes[b][axis % 2]).abs() < 1e-6).then_some((b, axis)))
}

#[test]
fn two_operands_keep_their_images_apart() {
    let boxes = [[0.0, 10.0], [5.0, 15.0]];
    let pictures = [[png([1; 3]), jpeg()], [png([2; 3]), png([3; 3])]];
    for format in FORMATS {
        let folder = folder();
        // Coordinates that are counted up, and such that are counted down.
        for (name, n) in [("a.obj", 0), ("b.glb", 1)] {
            let mesh = cuboid(DVec3::splat(boxes[n][0]), DVec3::splat(boxes[n][1]));
            let texture = of_sides(&mesh, pictures[n].clone());
            write(&folder.path().join(name), &(mesh, texture));
        }
        let line = format!("union OUT/a.obj OUT/b.glb -o OUT/out.{format} --resolution 48");
        run_in(&folder, &line).exits(0);
        let out = io::read(folder.path().join(format!("out.{format}"))).expect("ours");
        assert_eq!(out.warnings, Vec::<String>::new(), "{format}");
        let found = out.texture.as_ref().expect("textures");
        let mut seen = [[0usize; 2]; 2];
        let (mut whole, mut between) = (0.0, 0.0);
        for t in 0..out.mesh.triangles.len() {
            let corners = out.mesh.corners(t);
            // Where the boxes meet, a few are left as the voxels have them.
            let size = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
            whole += size;
            let Some((n, axis)) = side(corners, boxes) else {
                between += size;
                continue;
            };
            let own = usize::from(axis < 4);
            seen[n][own] += 1;
            assert_eq!(image(found, t), Some(pictures[n][own].clone()), "{format}: {corners:?}");
            let coordinates = found.at(t, false).expect("coordinates");
            for (p, found) in corners.iter().zip(coordinates) {
                let wanted = place(*p, axis);
                assert!((0..2).all(|k| (found[k] - wanted[k]).abs() < 1e-5), "{format}: {p} {found:?} {wanted:?}");
            }
        }
        assert!(between < 0.01 * whole, "{format}: {between} of {whole}");
        assert!(seen.iter().flatten().all(|count| *count > 0), "{format}: {seen:?}");
    }
}

/// A box of 8 in cells of 1, whose top has a seam across the middle.
fn cells() -> (TriMesh, TextureMap) {
    let mut numbers: HashMap<[i64; 3], u32> = HashMap::new();
    let mut mesh = TriMesh::default();
    for axis in 0..6 {
        for (i, j) in (0..8).flat_map(|i| (0..8).map(move |j| (i, j))) {
            let corner = |u: i64, v: i64| {
                let mut p = [0; 3];
                let [a, b] = [[1, 2], [0, 2], [0, 1]][axis / 2];
                (p[axis / 2], p[a], p[b]) = (8 * (axis % 2) as i64, u, v);
                p
            };
            let square = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)].map(|p| {
                *numbers.entry(p).or_insert_with(|| {
                    mesh.positions.push(DVec3::from_array(p.map(|x| x as f64)));
                    mesh.positions.len() as u32 - 1
                })
            });
            let turned = (axis % 2 == 1) == (axis / 2 == 1);
            let [a, b, c, d] = if turned { [square[0], square[3], square[2], square[1]] } else { square };
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let mut texture = of_sides(&mesh, [png([1; 3]), png([2; 3])]);
    for t in 0..mesh.triangles.len() {
        if on_second_half(mesh.corners(t)) {
            texture.coordinates[t].iter_mut().flatten().for_each(|place| place[0] += 0.25);
        }
    }
    (mesh, texture)
}

fn on_second_half(corners: [DVec3; 3]) -> bool {
    axis(corners) == 5 && corners.iter().all(|p| p.x >= 4.0)
}

#[test]
fn simplification_stops_at_seams_and_materials() {
    let folder = folder();
    let given = cells();
    write(&folder.path().join("in.obj"), &given);
    let count = |flags: &str| {
        run_in(&folder, &format!("repair OUT/in.obj -o OUT/out.obj --force {flags}")).exits(0);
        let out = io::read(folder.path().join("out.obj")).expect("ours");
        let found = out.texture.as_ref().expect("textures");
        for t in 0..out.mesh.triangles.len() {
            let corners = out.mesh.corners(t);
            let across = axis(corners) == 5 && corners.iter().any(|p| p.x < 4.0) && corners.iter().any(|p| p.x > 4.0);
            // What is made from voxels has no corners on the seam; its triangles lie on one side of it or the other.
            let made = flags.contains("--rebuild");
            assert!(!across || made, "{flags}: {corners:?} lies across the seam");
            let coordinates = found.at(t, false).expect("coordinates");
            let second = match across {
                true => coordinates[0][0] - place(corners[0], 5)[0] > 0.125,
                false => on_second_half(corners),
            };
            let shift = if second { 0.25 } else { 0.0 };
            for (p, found) in corners.iter().zip(coordinates) {
                let [u, v] = place(*p, axis(corners));
                assert!((found[0] - u - shift).abs() < 1e-5 && (found[1] - v).abs() < 1e-5, "{flags}: {p} {found:?}");
            }
            assert_eq!(image(found, t), Some(png(if axis(corners) < 4 { [2; 3] } else { [1; 3] })));
        }
        out.mesh.triangles.len()
    };
    assert_eq!(count(""), given.0.triangles.len());
    // Beside seams everything stays, and of 49 vertices within a side 25 can go, of those within the halved one 10.
    let simple = count("--simplify 0.1h --resolution 32");
    assert!(simple <= given.0.triangles.len() - 2 * (4 * 25 + 10), "{simple} triangles");
    // So it is with what is made anew.
    let [all, few] =
        ["--simplify off", "--simplify 0.01h"].map(|flags| count(&format!("--rebuild --resolution 24 {flags}")));
    assert!(few < all / 3, "{few} of {all}");
}

#[test]
fn every_verb_that_makes_a_mesh_keeps_textures() {
    let folder = folder();
    write(&folder.path().join("in.obj"), &cube(false));
    write(&folder.path().join("other.ply"), &cube(false));
    for line in [
        "dilate OUT/in.obj -o OUT/out.glb -r 1 --voxel 0.5",
        "close OUT/in.obj -o OUT/out.3mf -r 1 --voxel 0.5",
        "thicken OUT/in.obj -o OUT/out.obj --min 2 --voxel 0.5",
        "csg a-b a=OUT/in.obj b=testdata/torus.ply -o OUT/out.ply --resolution 48",
        "field offset(a,-1) a=OUT/in.obj -o OUT/out.gltf --voxel 0.5",
        "convert OUT/in.obj -o OUT/out.ply --ascii",
        "intersection OUT/in.obj OUT/other.ply -o OUT/out.obj --resolution 32",
    ] {
        let said = run_in(&folder, &format!("{line} --force")).exits(0).stderr;
        let name =
            line.split_whitespace().find(|word| word.contains("OUT/out")).expect("an output").replace("OUT/", "");
        let out = io::read(folder.path().join(&name)).expect("ours");
        let found = out.texture.unwrap_or_else(|| panic!("{line}: {said}"));
        let count = out.mesh.triangles.len();
        let with = (0..count).filter(|t| found.at(*t, false).is_some() && image(&found, *t).is_some()).count();
        // Where another operand without textures has left its surface there are none.
        assert!(if line.starts_with("csg") { with > count / 20 } else { with == count }, "{line}: {with} of {count}");
    }
}

#[test]
fn what_cannot_be_kept_is_said() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    write(&at("in.obj"), &cube(false));
    for format in ["stl", "off"] {
        run_in(&folder, &format!("convert OUT/in.obj -o OUT/out.{format}")).exits(0).says(&["holds no textures"]);
        run_in(&folder, &format!("repair OUT/in.obj -o OUT/out.{format} --force"))
            .exits(0)
            .says(&["holds no textures"]);
    }
    run_in(&folder, "convert OUT/in.obj -o - --out-format obj").exits(0).says(&["which a stream has not"]);
    let bmp = TextureMap {
        images: cube(false).1.images.into_iter().map(|i| io::TextureImage { bytes: (*b"BM..").into(), ..i }).collect(),
        ..cube(false).1
    };
    save(&at("bmp.obj"), &cube(false).0, &bmp, &WriteOptions::new(Format::Obj));
    run_in(&folder, "convert OUT/bmp.obj -o OUT/bmp.glb").exits(0).says(&["2 images of another kind left out"]);
    fs::remove_file(at("in.mtl")).expect("it was there");
    run_in(&folder, "repair OUT/in.obj -o OUT/out.obj").exits(0).says(&["in.mtl", "left out"]);
    let out = io::read(at("out.obj")).expect("ours").texture.expect("coordinates");
    assert!(out.has_coordinates() && out.materials.len() == 2);
}

#[test]
fn files_beside_come_together_and_take_nobody_s_place() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    write(&at("in.obj"), &cube(false));
    run_in(&folder, "convert OUT/in.obj -o OUT/new.obj").exits(0);
    let beside = |stem: &str| [".mtl", ".obj", "_picture_0.png", "_picture_1.jpg"].map(|end| format!("{stem}{end}"));
    assert_eq!(names_in(folder.path()), [beside("in"), beside("new")].concat());
    // Again and again the names are the same.
    run_in(&folder, "convert OUT/new.obj -o OUT/new.obj --force").exits(0);
    assert_eq!(names_in(folder.path()), [beside("in"), beside("new")].concat());
    // What an input is made of stays as it is.
    fs::rename(at("new.obj"), at("old.obj")).expect("renamed");
    let library = [b"# mine\n", &fs::read(at("new.mtl")).expect("there")[..]].concat();
    fs::write(at("new.mtl"), &library).expect("written");
    let before = names_in(folder.path());
    run_in(&folder, "convert OUT/old.obj -o OUT/new.obj").exits(2).says(&["new.mtl", "would be overwritten"]);
    assert_eq!(names_in(folder.path()), before);
    assert_eq!(fs::read(at("new.mtl")).expect("there"), library);
    run_in(&folder, "convert OUT/old.obj -o OUT/new.obj --force").exits(0);
    assert_ne!(fs::read(at("new.mtl")).expect("there"), library);
    // Neither do they meet other files of the run.
    let before = names_in(folder.path());
    run_in(&folder, "convert OUT/in.obj -o OUT/third.obj --report OUT/third.mtl").exits(2).says(&["third.mtl"]);
    let mut with_report = before.clone();
    with_report.push("third.mtl".into());
    with_report.sort();
    assert_eq!(names_in(folder.path()), with_report);
    run_in(&folder, "convert OUT/in.obj -o OUT/in.mtl --out-format obj").exits(2).says(&["in.mtl"]);
    assert_eq!(names_in(folder.path()), with_report);
    // A run that fails leaves none.
    run_in(&folder, "repair OUT/in.obj -o OUT/fourth.obj --max-memory 1k").exits(5);
    assert_eq!(names_in(folder.path()), with_report);
}
