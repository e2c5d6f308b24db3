//! `repair --each` on 3MF: build items, components, colours, materials, roles.

use std::fs;

use glam::DVec3;
use meshwright::mesh::TriMesh;
use serde_json::Value;

use super::each::{assert_solid, open_box, scene, unzipped, zipped};
use super::{folder, run_in};
use crate::common::shapes::cuboid;

const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
const MATERIAL: &str = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02";

fn vertices(mesh: &TriMesh) -> String {
    mesh.positions.iter().map(|p| format!(r#"<vertex x="{}" y="{}" z="{}"/>"#, p.x, p.y, p.z)).collect()
}

/// The triangles with what `property` says of each.
fn mesh_of(mesh: &TriMesh, property: impl Fn(usize) -> String) -> String {
    let triangle =
        |(n, [a, b, c]): (usize, &[u32; 3])| format!(r#"<triangle v1="{a}" v2="{b}" v3="{c}"{}/>"#, property(n));
    let triangles: String = mesh.triangles.iter().enumerate().map(triangle).collect();
    format!("<mesh><vertices>{}</vertices><triangles>{triangles}</triangles></mesh>", vertices(mesh))
}

fn plain(mesh: &TriMesh) -> String {
    mesh_of(mesh, |_| String::new())
}

/// The text between two pieces of a text, which must be there.
#[track_caller]
fn between<'a>(text: &'a str, from: &str, to: &str) -> &'a str {
    let start = text.find(from).unwrap_or_else(|| panic!("{from} is not in\n{text}"));
    let end = text[start..].find(to).unwrap_or_else(|| panic!("{to} is not after {from}"));
    &text[start..start + end]
}

/// All start tags of elements of a name.
fn tags<'a>(text: &'a str, name: &str) -> Vec<&'a str> {
    let start = format!("<{name} ");
    text.match_indices(&start).map(|(at, _)| &text[at..at + text[at..].find('>').expect("an end")]).collect()
}

const COMPONENTS: &str = r#"<components><component objectid="1"/><component objectid="1" transform="0 1 0 -1 0 0 0 0 1 50 0 0"/><component objectid="1" transform="-1 0 0 0 1 0 0 0 1 -50 0 0"/><component objectid="5"/></components>"#;
const BUILD: &str = r#"<build><item objectid="3" transform="1 0 0 0 1 0 0 0 1 0 0 5.5" partnumber="P-1"/><item objectid="2" printable="0"/><item objectid="2" transform="2 0 0 0 2 0 0 0 2 100 0 0"/><item objectid="4"/></build>"#;
const SETTINGS: &str = r#"<config><object id="3"><part id="1" subtype="normal_part"/><part id="5" subtype="modifier_part"><metadata key="name" value="dense"/></part></object></config>"#;

/// Two objects with instances, one of them mirrored, a modifier and a support.
fn project() -> Vec<u8> {
    let body = open_box(0.0, 10.0);
    let gem = open_box(20.0, 24.0);
    // Red above, blue below, and a blend on one triangle.
    let of_gem = |t: usize| match (t, gem.corners(t).iter().all(|p| p.z == 24.0)) {
        (0, _) => r#" pid="7" p1="0" p2="1" p3="1""#.to_owned(),
        (_, true) => r#" pid="7" p1="0""#.to_owned(),
        _ => r#" pid="7" p1="1""#.to_owned(),
    };
    let support = cuboid(DVec3::ZERO, DVec3::splat(3.0));
    let model = format!(
        r##"<?xml version="1.0" encoding="UTF-8"?>
<model unit="inch" xmlns="{CORE}" xmlns:m="{MATERIAL}"><metadata name="Title">Two &amp; more</metadata><resources>
<basematerials id="6"><base name="steel" displaycolor="#808890"/><base name="brass" displaycolor="#C0A040FF"/></basematerials>
<m:colorgroup id="7"><m:color color="#FF0000"/><m:color color="#0000FF80"/></m:colorgroup>
<object id="1" name="body" type="model" pid="6" pindex="1">{}</object>
<object id="2" name="gem &lt;1&gt;" type="model" pid="7" pindex="0">{}</object>
<object id="4" name="prop" type="support">{}</object>
<object id="5" name="dense" type="other">{}</object>
<object id="3" name="pair">{COMPONENTS}</object>
</resources>{BUILD}</model>"##,
        plain(&body),
        mesh_of(&gem, of_gem),
        plain(&support),
        plain(&support)
    );
    zipped(&[
        ("[Content_Types].xml", b"<Types/>"),
        ("3D/3dmodel.model", model.as_bytes()),
        ("Metadata/model_settings.config", SETTINGS.as_bytes()),
        ("Metadata/thumbnail.png", b"\x89PNG not really"),
    ])
}

#[test]
fn a_project_keeps_all_but_the_meshes_that_are_repaired() {
    let folder = folder();
    let given = project();
    fs::write(folder.path().join("in.3mf"), &given).expect("written");
    run_in(&folder, "repair OUT/in.3mf --each -o OUT/out.3mf").exits(0).says(&[
        "2 objects, placed 5 times",
        "1 modifier (`dense`)",
        "1 support object (`prop`)",
        "2 objects repaired",
    ]);
    let written = fs::read(folder.path().join("out.3mf")).expect("written");
    let (before, after) = (unzipped(&given), unzipped(&written));
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
    let other = |name: &&String| *name != "3D/3dmodel.model";
    before.keys().filter(other).for_each(|name| assert_eq!(before[name], after[name], "{name}"));
    let text = |files: &std::collections::BTreeMap<String, Vec<u8>>| {
        String::from_utf8(files["3D/3dmodel.model"].clone()).expect("UTF-8")
    };
    let (before, after) = (text(&before), text(&after));
    // Everything but two meshes and their groups is the same to the letter.
    assert!(
        after.contains(BUILD)
            && after.contains(COMPONENTS)
            && after.contains("<metadata name=\"Title\">Two &amp; more")
    );
    for id in [3, 4, 5] {
        let start = format!("<object id=\"{id}\"");
        assert_eq!(between(&before, &start, "</object>"), between(&after, &start, "</object>"));
    }
    for tag in ["<object id=\"1\"", "<object id=\"2\"", "<basematerials id=\"6\"", "<m:colorgroup id=\"7\""] {
        let end = if tag.starts_with("<object") { ">" } else { "</" };
        assert_eq!(between(&before, tag, end), between(&after, tag, end));
    }
    // The body has its material from its object; its lid too.
    let body = between(&after, "<object id=\"1\"", "</object>");
    assert_eq!(tags(body, "triangle").len(), 12);
    assert!(!between(body, "<triangles>", "</triangles>").contains("pid"));
    // The colours of the gem: two red triangles above, blue ones, and a blend in a group of its own.
    let gem = between(&after, "<object id=\"2\"", "</object>");
    let (triangles, entry) = (tags(gem, "triangle"), |entry: &str| {
        tags(gem, "triangle").iter().filter(|tag| tag.contains(&format!("pid=\"7\" p1=\"{entry}\""))).count()
    });
    assert_eq!(triangles.len(), 12);
    // What closes the hole has the entry of the triangle next to it, or is grey where that blends.
    assert!((2..=4).contains(&entry("0")) && entry("1") >= 7, "{gem}");
    assert_eq!(triangles.iter().filter(|tag| tag.contains("p2=")).count(), 1);
    assert!(tags(&after, "m:color").iter().filter(|tag| tag.contains("#FF0000")).count() >= 2);
    // And by the reader: valid, placed as before.
    let (given, found) = (scene(&folder.path().join("in.3mf")), scene(&folder.path().join("out.3mf")));
    assert_eq!(given.placements, found.placements);
    assert_eq!((given.unit, &given.aside), (found.unit, &found.aside));
    assert_eq!(found.placements.iter().filter(|place| place.is_mirrored()).count(), 1);
    assert_solid(&found, 0, 1000.0);
    assert_solid(&found, 1, 64.0);
}

#[test]
fn volumes_of_a_slicer_are_repaired_one_by_one_and_their_ranges_follow() {
    let folder = folder();
    // Two parts and a modifier between them, in one mesh.
    let mut mesh = open_box(0.0, 10.0);
    let modifier = cuboid(DVec3::splat(2.0), DVec3::splat(5.0));
    mesh.append(&modifier);
    mesh.append(&open_box(20.0, 30.0));
    let paint = |t: usize| if t == 10 { r#" slic3rpe:mmu_segmentation="8""#.to_owned() } else { String::new() };
    let model = format!(
        r#"<model unit="millimeter" xmlns="{CORE}" xmlns:slic3rpe="http://schemas.slic3r.org/3mf/2017/06"><resources><object id="1" type="model">{}</object></resources><build><item objectid="1"/></build></model>"#,
        mesh_of(&mesh, paint)
    );
    let volume = |name: &str, kind: &str, [first, last]: [usize; 2]| {
        format!(
            r#"<volume firstid="{first}" lastid="{last}"><metadata type="volume" key="name" value="{name}"/><metadata type="volume" key="volume_type" value="{kind}"/><metadata type="volume" key="extruder" value="2"/></volume>"#
        )
    };
    let config = format!(
        r#"<config><object id="1" instances_count="1">{}{}{}</object></config>"#,
        volume("left", "ModelPart", [0, 9]),
        volume("dense", "ParameterModifier", [10, 21]),
        volume("right", "ModelPart", [22, 31])
    );
    let name = "Metadata/Slic3r_PE_model.config";
    let package = zipped(&[("3D/3dmodel.model", model.as_bytes()), (name, config.as_bytes())]);
    fs::write(folder.path().join("in.3mf"), package).expect("written");
    let listed = run_in(&folder, "inspect OUT/in.3mf").exits(0).text();
    assert!(listed.contains("1 left: 10 triangles") && listed.contains("2 right: 10 triangles"), "{listed}");
    run_in(&folder, "repair OUT/in.3mf --each -o OUT/out.3mf").exits(0).says(&[
        "1 left",
        "2 right",
        "1 modifier (`dense`)",
    ]);
    let files = unzipped(&fs::read(folder.path().join("out.3mf")).expect("written"));
    let config = String::from_utf8(files[name].clone()).expect("UTF-8");
    let ranges: Vec<&str> = tags(&config, "volume");
    assert_eq!(
        ranges,
        [
            r#"<volume firstid="0" lastid="11""#,
            r#"<volume firstid="12" lastid="23""#,
            r#"<volume firstid="24" lastid="35""#
        ]
    );
    assert_eq!(config.matches("key=\"extruder\"").count(), 3);
    // The modifier is the same mesh, with what was painted on it.
    let model = String::from_utf8(files["3D/3dmodel.model"].clone()).expect("UTF-8");
    let triangles = tags(&model, "triangle");
    assert!(triangles[12].contains(r#"slic3rpe:mmu_segmentation="8""#), "{}", triangles[12]);
    let number = |tag: &str, name: &str| -> f64 {
        let value = tag.split(&format!("{name}=\"")).nth(1).and_then(|rest| rest.split('"').next());
        value.and_then(|value| value.parse().ok()).expect("a number")
    };
    let all = tags(&model, "vertex");
    let place = |v: f64| DVec3::from(["x", "y", "z"].map(|axis| number(all[v as usize], axis)));
    for t in 0..12 {
        let corners = ["v1", "v2", "v3"].map(|corner| place(number(triangles[12 + t], corner)));
        assert_eq!(corners, modifier.corners(t));
    }
    assert_eq!(all.len(), 24);
    let found = scene(&folder.path().join("out.3mf"));
    assert_solid(&found, 0, 1000.0);
    assert_solid(&found, 1, 1000.0);
}

#[test]
fn a_model_without_the_name_space_for_colours_gets_it_and_other_models_are_followed() {
    let folder = folder();
    let part = format!(
        r##"<c:model xmlns:c="{CORE}" xmlns:q="{MATERIAL}"><c:resources><q:colorgroup id="4"><q:color color="#00FF00"/><q:color color="#FF00FF"/></q:colorgroup><c:object id="9" name="far">{}</c:object></c:resources></c:model>"##,
        mesh_of(&open_box(0.0, 10.0), |t| format!(r#" pid="4" p1="0" p2="{}" p3="0""#, t % 2))
            .replace("</", "</c:")
            .replace("<mesh", "<c:mesh")
            .replace("<vert", "<c:vert")
            .replace("<triang", "<c:triang")
    );
    let root = format!(
        r#"<model xmlns="{CORE}" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06"><resources><object id="1"><components><component objectid="9" p:path="/3D/part.model"/></components></object></resources><build><item objectid="1"/></build></model>"#
    );
    let package = zipped(&[("3D/3dmodel.model", root.as_bytes()), ("3D/part.model", part.as_bytes())]);
    fs::write(folder.path().join("in.3mf"), package).expect("written");
    run_in(&folder, "repair OUT/in.3mf --each -o OUT/out.3mf").exits(0).says(&["1 far"]);
    let files = unzipped(&fs::read(folder.path().join("out.3mf")).expect("written"));
    assert_eq!(files["3D/3dmodel.model"], root.as_bytes());
    let text = String::from_utf8(files["3D/part.model"].clone()).expect("UTF-8");
    assert!(text.contains(&format!("xmlns:m=\"{MATERIAL}\"")) && text.contains("<m:colorgroup id=\"10\">"), "{text}");
    assert_eq!(tags(&text, "c:triangle").len(), 12);
    let found = scene(&folder.path().join("out.3mf"));
    assert_solid(&found, 0, 1000.0);
    assert!(found.objects[0].colours.is_some());
}

#[test]
fn other_formats_get_objects_places_colours_and_materials() {
    let folder = folder();
    fs::write(folder.path().join("in.3mf"), project()).expect("written");
    run_in(&folder, "repair OUT/in.3mf --each -o OUT/out.gltf").exits(0).says(&[
        "glTF has no place for it, left out: 1 modifier (`dense`), 1 support object (`prop`)"
            .replace("glTF", "gltf")
            .as_str(),
    ]);
    let document: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out.gltf")).expect("written")).expect("JSON");
    let names = |list: &str| -> Vec<&str> {
        document[list].as_array().expect(list).iter().map(|entry| entry["name"].as_str().unwrap_or("")).collect()
    };
    assert_eq!(names("meshes"), ["body", "gem <1>"]);
    assert_eq!(names("nodes"), ["", "body", "body", "body", "gem <1>", "gem <1>"]);
    assert_eq!(document["nodes"][0]["scale"][0], 0.0254);
    assert_eq!(
        document["nodes"][2]["matrix"],
        serde_json::json!([0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 50.0, 0.0, 5.5, 1.0])
    );
    assert!(names("materials").contains(&"brass"));
    let found = scene(&folder.path().join("out.gltf"));
    assert_solid(&found, 0, 1000.0);
    assert_solid(&found, 1, 64.0);
    let brass = found.materials.iter().find(|own| own.material.name == "brass").expect("brass");
    assert_eq!(brass.material.colour, Some([0xC0, 0xA0, 0x40, 255]));
    // OBJ has every place by itself; the mirrored one is turned over.
    run_in(&folder, "repair OUT/in.3mf --each -o OUT/out.obj").exits(0).says(&["5 instances written one by one"]);
    let found = scene(&folder.path().join("out.obj"));
    assert_eq!(found.objects.len(), 5);
    (0..3).for_each(|n| assert_solid(&found, n, 1000.0));
    assert_solid(&found, 3, 64.0);
    assert_solid(&found, 4, 512.0);
    assert_eq!(found.objects[2].mesh.bounds().expect("a box").min, DVec3::new(-60.0, 0.0, 5.5));
}

#[test]
fn cycles_end_and_instances_are_not_unfolded() {
    let folder = folder();
    let model = |objects: &str, items: &str| {
        let text = format!(
            r#"<model unit="millimeter" xmlns="{CORE}"><resources>{objects}</resources><build>{items}</build></model>"#
        );
        zipped(&[("3D/3dmodel.model", text.as_bytes())])
    };
    let cycle = r#"<object id="1"><components><component objectid="2"/></components></object><object id="2"><components><component objectid="1"/></components></object>"#;
    fs::write(folder.path().join("cycle.3mf"), model(cycle, r#"<item objectid="1"/>"#)).expect("written");
    run_in(&folder, "repair OUT/cycle.3mf --each -o OUT/a.3mf").exits(4).says(&["an object within itself"]);
    // Ten times ten times ten and so on: refused for what it unfolds into.
    let mut objects = format!(r#"<object id="1">{}</object>"#, plain(&open_box(0.0, 1.0)));
    for id in 2..=9 {
        let inner = format!(r#"<component objectid="{}"/>"#, id - 1).repeat(10);
        objects += &format!(r#"<object id="{id}"><components>{inner}</components></object>"#);
    }
    fs::write(folder.path().join("bomb.3mf"), model(&objects, r#"<item objectid="9"/>"#)).expect("written");
    run_in(&folder, "repair OUT/bomb.3mf --each -o OUT/a.3mf").exits(4).says(&["instances"]);
    // Many instances of one object stay instances.
    let mut items = String::new();
    (0..20_000).for_each(|n| items += &format!(r#"<item objectid="1" transform="1 0 0 0 1 0 0 0 1 {n} 0 0"/>"#));
    let object = format!(r#"<object id="1" name="pin">{}</object>"#, plain(&open_box(0.0, 1.0)));
    fs::write(folder.path().join("many.3mf"), model(&object, &items)).expect("written");
    run_in(&folder, "repair OUT/many.3mf --each -o OUT/b.3mf").exits(0).says(&["1 object, placed 20,000 times"]);
    let files = unzipped(&fs::read(folder.path().join("b.3mf")).expect("written"));
    let text = String::from_utf8(files["3D/3dmodel.model"].clone()).expect("UTF-8");
    assert_eq!((tags(&text, "item").len(), tags(&text, "triangle").len()), (20_000, 12));
}
