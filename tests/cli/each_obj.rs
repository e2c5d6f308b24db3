//! `repair --each` on OBJ: objects, groups, colours, materials.

use std::fs;

use meshwright::io;

use super::each::{assert_solid, open_box, scene, unzipped};
use super::{folder, run_in};

/// The lines of a box: vertices with a colour behind each, then faces, counted from `first`.
fn lines(min: f64, max: f64, first: u32, colour: &str) -> (String, Vec<String>) {
    let mesh = open_box(min, max);
    let vertices = mesh.positions.iter().map(|p| format!("v {} {} {}{colour}\n", p.x, p.y, p.z)).collect();
    let faces = mesh.triangles.iter().map(|t| {
        let [a, b, c] = t.map(|v| v + first);
        format!("f {a} {b} {c}\n")
    });
    (vertices, faces.collect())
}

#[test]
fn objects_keep_names_colours_and_materials() {
    let folder = folder();
    let (a, faces_a) = lines(0.0, 10.0, 1, " 1 0 0");
    let (b, faces_b) = lines(20.0, 30.0, 9, " 0 0 1");
    let text = format!(
        "mtllib in.mtl\no first part\n{a}usemtl wood\n{}o second\n{b}g inner\nusemtl tin\n{}g outer\n{}l 1 2\n",
        faces_a.concat(),
        faces_b[..5].concat(),
        faces_b[5..].concat()
    );
    fs::write(folder.path().join("in.obj"), text).expect("written");
    fs::write(folder.path().join("in.mtl"), "newmtl wood\nKd 0.6 0.4 0.2\nnewmtl tin\nKd 0.5 0.5 0.5\n")
        .expect("written");
    run_in(&folder, "repair OUT/in.obj --each -o OUT/out.obj").exits(0).says(&[
        "1 first part",
        "2 second",
        "2 objects repaired",
    ]);
    let text = fs::read_to_string(folder.path().join("out.obj")).expect("written");
    let names: Vec<&str> = text.lines().filter(|line| line.starts_with("o ")).collect();
    assert_eq!(names, ["o first part", "o second"]);
    let mut under = "";
    let mut used = Vec::new();
    for line in text.lines() {
        match line.split_once(' ') {
            Some(("o", name)) => under = name,
            Some(("usemtl", name)) => used.push((under, name)),
            _ => {}
        }
    }
    assert_eq!(used, [("first part", "wood"), ("second", "tin")]);
    let materials = fs::read_to_string(folder.path().join("out.mtl")).expect("written");
    assert!(materials.contains("newmtl wood") && materials.contains("newmtl tin"), "{materials}");
    let reds = text.lines().filter(|line| line.starts_with("v ") && line.ends_with(" 1 0 0")).count();
    let blues = text.lines().filter(|line| line.starts_with("v ") && line.ends_with(" 0 0 1")).count();
    assert!(reds >= 4 && blues >= 4, "{reds} {blues}\n{text}");
    let found = scene(&folder.path().join("out.obj"));
    assert_solid(&found, 0, 1000.0);
    assert_solid(&found, 1, 1000.0);
    // In 3MF they are objects with base materials, or colours of their own.
    run_in(&folder, "repair OUT/in.obj --each -o OUT/out.3mf --unit cm").exits(0);
    let files = unzipped(&fs::read(folder.path().join("out.3mf")).expect("written"));
    let text = String::from_utf8(files["3D/3dmodel.model"].clone()).expect("UTF-8");
    assert!(
        text.contains("unit=\"centimeter\"")
            && text.contains("<base name=\"wood\"")
            && text.contains("name=\"first part\"")
    );
}

#[test]
fn groups_that_share_edges_are_one_object() {
    let folder = folder();
    let (a, faces_a) = lines(0.0, 10.0, 1, "");
    let (b, faces_b) = lines(20.0, 30.0, 9, "");
    let text =
        format!("{a}{b}g side\n{}g top\n{}g apart\n{}", faces_a[..4].concat(), faces_a[4..].concat(), faces_b.concat());
    fs::write(folder.path().join("in.obj"), text).expect("written");
    run_in(&folder, "repair OUT/in.obj --each -o OUT/out.obj").exits(0).says(&[
        "3 groups, some of which share edges or a name: taken as 2 objects",
        "1 side",
        "2 apart",
    ]);
    let found = scene(&folder.path().join("out.obj"));
    assert_eq!(found.objects.len(), 2);
    assert_solid(&found, 0, 1000.0);
    assert_solid(&found, 1, 1000.0);
    // The third group is the second object.
    run_in(&folder, "repair OUT/in.obj --each --part 3 -o OUT/one.obj").exits(0);
    let found = scene(&folder.path().join("one.obj"));
    assert_eq!(found.objects[0].mesh.triangles.len(), 10);
    assert_solid(&found, 1, 1000.0);
    let parts = io::read(folder.path().join("one.obj")).expect("ours").parts;
    assert_eq!(parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>(), ["side", "apart"]);
}
