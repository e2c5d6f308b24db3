//! 3MF as slicers write it: types of objects, roles of parts, extensions.

use super::found::{load, problem, volume};
use super::support::zipped;

const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";

pub fn three_mf_of(model: &str, more: &[(&str, &str)]) -> Vec<u8> {
    let mut files = vec![("3D/3dmodel.model", model.as_bytes())];
    files.extend(more.iter().map(|(name, text)| (*name, text.as_bytes())));
    zipped(&files)
}

pub fn unzipped_model(package: &[u8]) -> String {
    use std::io::Read;
    let mut text = String::new();
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(package)).unwrap();
    archive.by_name("3D/3dmodel.model").unwrap().read_to_string(&mut text).unwrap();
    text
}

/// An axis-aligned box as triangles of the format, its vertices counted from `first`.
fn cuboid(min: [i32; 3], max: [i32; 3], first: usize) -> (String, String) {
    let vertex = |n: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| if n >> k & 1 == 1 { max[k] } else { min[k] });
        format!(r#"<vertex x="{x}" y="{y}" z="{z}"/>"#)
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangle = |t: [usize; 3]| {
        let [a, b, c] = t.map(|v| v + first);
        format!(r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)
    };
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).map(triangle);
    ((0..8).map(vertex).collect(), triangles.collect())
}

fn mesh_of(boxes: &[([i32; 3], [i32; 3])]) -> String {
    let parts: Vec<_> = boxes.iter().enumerate().map(|(n, (min, max))| cuboid(*min, *max, 8 * n)).collect();
    let vertices: String = parts.iter().map(|(vertices, _)| vertices.as_str()).collect();
    let triangles: String = parts.iter().map(|(_, triangles)| triangles.as_str()).collect();
    format!("<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>")
}

const BLOCK: ([i32; 3], [i32; 3]) = ([0; 3], [10; 3]);
const DRILL: ([i32; 3], [i32; 3]) = ([3, 3, -1], [7, 7, 11]);

fn model(resources: &str, items: &[u32]) -> String {
    let items: String = items.iter().map(|id| format!(r#"<item objectid="{id}"/>"#)).collect();
    format!(
        r#"<?xml version="1.0"?><model unit="millimeter" xmlns="{CORE}"><resources>{resources}</resources><build>{items}</build></model>"#
    )
}

fn object(id: u32, attributes: &str, content: &str) -> String {
    format!(r#"<object id="{id}" {attributes}>{content}</object>"#)
}

#[test]
fn object_types_that_are_no_parts_are_left_out_and_named() {
    let file = |kind: &str| {
        let objects = object(1, r#"type="model""#, &mesh_of(&[BLOCK]))
            + &object(2, &format!(r#"type="{kind}" name="extra""#), &mesh_of(&[DRILL]));
        three_mf_of(&model(&objects, &[1, 2]), &[])
    };
    for kind in ["model", "surface", ""] {
        let loaded = load(file(kind));
        assert_eq!((loaded.mesh.triangles.len(), loaded.warnings.len()), (24, 0), "{kind}");
    }
    for (kind, words) in
        [("support", "support object"), ("solidsupport", "support object"), ("other", "auxiliary object")]
    {
        let loaded = load(file(kind));
        assert_eq!(volume(&loaded.mesh), 1000.0, "{kind}");
        assert_eq!(loaded.warnings, [format!("1 {words} (`extra`) left out")], "{kind}");
    }
    let alone = three_mf_of(&model(&object(1, r#"type="support""#, &mesh_of(&[BLOCK])), &[1]), &[]);
    let found = problem(alone, "a.3mf").to_string();
    assert_eq!(found, "no triangle is left: 1 support object left out");
}

/// Two components of one object, with what a slicer says of the second.
fn components(second: &str, kind: &str) -> Vec<u8> {
    let objects = object(1, r#"type="model""#, &mesh_of(&[BLOCK]))
        + &object(2, &format!(r#"type="{kind}""#), &mesh_of(&[DRILL]))
        + &object(3, "", r#"<components><component objectid="1"/><component objectid="2"/></components>"#);
    let settings = format!(
        r#"<config><object id="3"><metadata key="name" value="all"/><part id="1" subtype="normal_part"/>
        <part id="2" subtype="{second}"><metadata key="name" value="hole"/></part></object></config>"#
    );
    three_mf_of(&model(&objects, &[3]), &[("Metadata/model_settings.config", &settings)])
}

#[test]
fn roles_of_components_are_read() {
    // Some slicers write `other` as the type of everything that is no material.
    for kind in ["model", "other"] {
        let loaded = load(components("negative_part", kind));
        assert_eq!((volume(&loaded.mesh), loaded.warnings.len()), (1000.0, 0), "{kind}");
        let negative = loaded.negative.expect("the second part");
        assert_eq!(volume(&negative.mesh), 192.0);
        assert_eq!(negative.parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>(), ["hole"]);
    }
    for (role, what) in [
        ("modifier_part", "modifier"),
        ("support_blocker", "support blocker"),
        ("support_enforcer", "support enforcer"),
    ] {
        let loaded = load(components(role, "model"));
        assert_eq!((volume(&loaded.mesh), loaded.negative), (1000.0, None));
        assert_eq!(loaded.warnings, [format!("1 {what} (`hole`) left out")]);
    }
    let loaded = load(components("normal_part", "other"));
    assert_eq!((volume(&loaded.mesh), loaded.warnings.len()), (1192.0, 0));
    let loaded = load(components("unheard_of", "model"));
    assert_eq!((volume(&loaded.mesh), loaded.warnings.len()), (1192.0, 1));
}

#[test]
fn roles_of_ranges_of_triangles_are_read() {
    let file = |setting: &str| {
        let settings = format!(
            r#"<config><object id="1"><volume firstid="0" lastid="11"><metadata type="volume" key="volume_type" value="ModelPart"/></volume>
            <volume firstid="12" lastid="23"><metadata type="volume" key="name" value="drill"/>{setting}</volume></object></config>"#
        );
        let objects = object(1, r#"type="model""#, &mesh_of(&[BLOCK, DRILL]));
        three_mf_of(&model(&objects, &[1]), &[("Metadata/Slic3r_PE_model.config", &settings)])
    };
    let kind = |value: &str| format!(r#"<metadata type="volume" key="volume_type" value="{value}"/>"#);
    let loaded = load(file(&kind("NegativeVolume")));
    assert_eq!((loaded.mesh.positions.len(), loaded.mesh.triangles.len(), volume(&loaded.mesh)), (8, 12, 1000.0));
    let negative = loaded.negative.expect("the second range");
    assert_eq!((negative.mesh.positions.len(), volume(&negative.mesh)), (8, 192.0));
    for (setting, what) in [
        (kind("ParameterModifier"), "modifier"),
        (r#"<metadata type="volume" key="modifier" value="1"/>"#.to_owned(), "modifier"),
        (kind("SupportBlocker"), "support blocker"),
        (kind("SupportEnforcer"), "support enforcer"),
    ] {
        let loaded = load(file(&setting));
        assert_eq!((loaded.mesh.positions.len(), volume(&loaded.mesh), loaded.negative), (8, 1000.0, None));
        assert_eq!(loaded.warnings, [format!("1 {what} (`drill`) left out")]);
    }
    let loaded = load(file(&kind("ModelPart")));
    assert_eq!((volume(&loaded.mesh), loaded.warnings.len()), (1192.0, 0));
    // Settings that are damaged cost the roles, not the mesh.
    let damaged = three_mf_of(
        &model(&object(1, "", &mesh_of(&[BLOCK])), &[1]),
        &[("Metadata/Slic3r_PE_model.config", "<config><object id=\"1\"></config>")],
    );
    let loaded = load(damaged);
    assert_eq!((volume(&loaded.mesh), loaded.warnings.len()), (1000.0, 1));
    assert!(loaded.warnings[0].contains("Slic3r_PE_model.config"), "{:?}", loaded.warnings);
}

#[test]
fn settings_of_objects_are_read() {
    let setting = |name: &str, value: &str| {
        let group = format!(
            r#"<metadatagroup><metadata name="cura:{name}" type="xs:boolean">{value}</metadata></metadatagroup>"#
        );
        let objects = object(1, "", &mesh_of(&[BLOCK])) + &object(2, "", &(group + &mesh_of(&[DRILL])));
        load(three_mf_of(&model(&objects, &[1, 2]), &[]))
    };
    assert_eq!(setting("anti_overhang_mesh", "True").warnings, ["1 support blocker left out"]);
    assert_eq!(setting("infill_mesh", "True").warnings, ["1 modifier left out"]);
    assert_eq!(setting("infill_mesh", "False").mesh.triangles.len(), 24);
    assert_eq!(setting("infill_mesh_order", "1").mesh.triangles.len(), 24);
}

#[test]
fn a_negative_part_that_reaches_another_object_is_told() {
    let objects = object(1, "", &mesh_of(&[BLOCK]))
        + &object(2, "", &mesh_of(&[([3, 3, -1], [7, 7, 30])]))
        + &object(3, "", r#"<components><component objectid="1"/><component objectid="2"/></components>"#)
        + &object(4, "", &mesh_of(&[([0, 0, 20], [10, 10, 25])]));
    let settings = r#"<config><object id="3"><part id="2" subtype="negative_part"/></object></config>"#;
    let file =
        |items: &[u32]| load(three_mf_of(&model(&objects, items), &[("Metadata/model_settings.config", settings)]));
    assert!(file(&[3, 4]).warnings[0].contains("reaches into another object"));
    assert!(file(&[3]).warnings.iter().all(|warning| !warning.contains("reaches")));
}

#[test]
fn extensions_of_3mf_that_are_not_read_are_named() {
    let address = "http://schemas.3mf.io/3dmanufacturing/booleanoperations/2023/07";
    let shape = format!(
        r#"<bo:booleanshape xmlns:bo="{address}" objectid="1" operation="difference"><bo:boolean objectid="2"/></bo:booleanshape>"#
    );
    let objects = object(1, "", &mesh_of(&[BLOCK])) + &object(2, "", &mesh_of(&[DRILL])) + &object(3, "", &shape);
    let found = problem(three_mf_of(&model(&objects, &[3]), &[]), "a.3mf").to_string();
    assert!(found.contains("the extension for boolean operations is not read"), "{found}");
    assert!(found.starts_with("no triangle is left"), "{found}");
    let loaded = load(three_mf_of(&model(&objects, &[1, 3]), &[]));
    assert!(loaded.warnings[0].contains("boolean operations"), "{:?}", loaded.warnings);
    for (address, words) in [
        ("http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02", "beam lattices"),
        ("http://schemas.3mf.io/3dmanufacturing/volumetric/2022/01", "volumetric data"),
        ("http://schemas.microsoft.com/3dmanufacturing/slice/2015/07", "slices"),
        ("urn:acme:magic", "`urn:acme:magic`"),
    ] {
        let used = mesh_of(&[BLOCK]).replace("</mesh>", &format!(r#"<x:thing xmlns:x="{address}"/></mesh>"#));
        let plain = model(&object(1, "", &used), &[1]);
        let loaded = load(three_mf_of(&plain, &[]));
        assert!(loaded.warnings.len() == 1 && loaded.warnings[0].contains(words), "{:?}", loaded.warnings);
        // Declared and not used is nothing; required is too much.
        let declared = model(&object(1, "", &mesh_of(&[BLOCK])), &[1])
            .replace("<model ", &format!(r#"<model xmlns:x="{address}" "#));
        assert_eq!(load(three_mf_of(&declared, &[])).warnings.len(), 0);
        let required = declared.replace("<model ", r#"<model requiredextensions="x" "#);
        let found = problem(three_mf_of(&required, &[]), "a.3mf").to_string();
        assert!(found.contains("requires the extension") && found.contains(words), "{found}");
    }
    for address in [
        "http://schemas.microsoft.com/3dmanufacturing/material/2015/02",
        "http://schemas.microsoft.com/3dmanufacturing/production/2015/06",
    ] {
        let known = model(&object(1, "", &mesh_of(&[BLOCK])), &[1])
            .replace("<model ", &format!(r#"<model requiredextensions="x" xmlns:x="{address}" "#));
        assert_eq!(load(three_mf_of(&known, &[])).warnings.len(), 0);
    }
}
