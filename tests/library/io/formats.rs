//! What each reader makes of the freedoms of its format.

use glam::DVec3;
use meshwright::io::{Format, GridFormat, Loaded, Unit, read, read_bytes, read_grid};

use super::support::{assert_sound, corners, zipped};

fn load(bytes: impl AsRef<[u8]>, format: Format) -> Loaded {
    let loaded = read_bytes(bytes.as_ref(), Some(format), None).unwrap_or_else(|error| panic!("{error}"));
    assert_sound(&loaded);
    loaded
}

fn names(loaded: &Loaded) -> Vec<(&str, usize)> {
    loaded.parts.iter().map(|p| (p.name.as_str(), p.triangles.len())).collect()
}

/// Volume enclosed, by the divergence theorem.
fn volume(loaded: &Loaded) -> f64 {
    corners(&loaded.mesh).iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum()
}

#[test]
fn every_seed_of_the_fuzzer_is_read_and_detected() {
    let seeds = concat!(env!("CARGO_MANIFEST_DIR"), "/fuzz/seeds");
    let mut count = 0;
    for folder in std::fs::read_dir(seeds).unwrap() {
        for file in std::fs::read_dir(folder.unwrap().path()).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_some_and(|e| e == "model" || e == "config") {
                continue;
            }
            if let Some(format) = GridFormat::from_path(&path) {
                let grid = read_grid(&path).unwrap_or_else(|error| panic!("{error}"));
                assert_eq!(grid.format, format, "{}", path.display());
                count += 1;
                continue;
            }
            let loaded = read(&path).unwrap_or_else(|error| panic!("{error}"));
            assert_sound(&loaded);
            assert_eq!(Some(loaded.format), Format::from_path(&path), "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 31, "{count}");
}

#[test]
fn ascii_stl_takes_several_solids_and_any_case() {
    let facet =
        "FACET Normal nan -nan(ind) 1.#QNAN OUTER LOOP Vertex 0 0 0\nVERTEX 1 0 0 vertex 0 1e0 0 ENDLOOP EndFacet\n";
    let text = format!("  SOLID one\r\n{facet}{facet}EndSolid one\r\nsolid  two words \n{facet}endsolid");
    let loaded = load(&text, Format::Stl);
    assert_eq!(names(&loaded), [("one", 2), ("two words", 1)]);
    assert_eq!(loaded.mesh.positions.len(), 3);
    assert_eq!(Format::detect(text.as_bytes(), None), Some(Format::Stl));
    let loaded = load(format!("solid\n{facet}"), Format::Stl);
    assert_eq!(loaded.warnings, ["no `endsolid` at the end: facets may be missing"]);
}

#[test]
fn obj_takes_polygons_backward_indices_and_odd_bytes() {
    let text = b"# caf\xe9\no a\nv 0 0 0 1.0\nv 2 0 0 .1 .2 .3\nv 2 2 0\nv 0 2 0\n\
                 f 1/1/1 2//1 \\\n 3/7 4 # a comment\nl 1 2\np 3\no b\nf -4 -3 -2\ng c\nf 4 5 6\nv 0 0 5\nv 1 0 5\n";
    let loaded = load(text, Format::Obj);
    assert_eq!(names(&loaded), [("a", 2), ("b", 1), ("c", 1)]);
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2], [3, 4, 5]]);
    assert_eq!(loaded.warnings, ["2 line, point or free-form statements left out"]);
    let old_mac: Vec<u8> = text.iter().map(|&b| if b == b'\n' { b'\r' } else { b }).collect();
    assert_eq!(load(old_mac, Format::Obj).mesh, loaded.mesh);
}

#[test]
fn concave_polygons_are_not_folded_over() {
    // An L, its corners numbered so that a fan from the first would leave it.
    let text = "v 1 3 0\nv 0 3 0\nv 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nf 1 2 3 4 5 6\n";
    for format in [Format::Obj, Format::Off] {
        let text = match format {
            Format::Obj => text.to_owned(),
            _ => "OFF 6 1 0\n1 3 0\n0 3 0\n0 0 0\n3 0 0\n3 1 0\n1 1 0\n6 0 1 2 3 4 5\n".to_owned(),
        };
        let loaded = load(text, format);
        let areas: Vec<f64> = corners(&loaded.mesh).iter().map(|[a, b, c]| (b - a).cross(c - a).z / 2.0).collect();
        assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
        assert_eq!(areas.iter().sum::<f64>(), 5.0);
    }
}

#[test]
fn off_variants_are_told_by_the_keyword() {
    let body = "3 1 0\n0 0 0 9 9 9\n\n# between\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2 1 0 0\n";
    for keyword in ["OFF\n", "COFF\n", "NOFF ", "STCNOFF # all\n", ""] {
        let loaded = load(format!("# first\n{keyword}{body}"), Format::Off);
        assert_eq!(loaded.mesh.triangles, [[0, 1, 2]]);
        assert_eq!(loaded.warnings, Vec::<String>::new());
    }
    let loaded = load(format!("OFF\n{body}and more\n"), Format::Off);
    assert_eq!(loaded.warnings, ["the file goes on after its last face; left out from line 9"]);
}

#[test]
fn ply_says_the_same_in_all_encodings() {
    let seed = |name: &str| {
        let path = format!("{}/fuzz/seeds/ply/{name}.ply", env!("CARGO_MANIFEST_DIR"));
        load(std::fs::read(path).unwrap(), Format::Ply).mesh
    };
    let ascii = seed("ascii");
    assert_eq!(ascii.triangles, [[0, 2, 1], [0, 1, 3], [0, 1, 2], [0, 2, 3]]);
    assert_eq!(seed("binary_little_endian"), ascii);
    assert_eq!(seed("binary_big_endian"), ascii);
    // Two strips; the second triangle of a strip is turned.
    let strips = seed("strips-first");
    assert_eq!(strips.triangles, [[0, 1, 2], [2, 1, 3], [1, 2, 0]]);
    assert_eq!(strips.positions, ascii.positions);
}

#[test]
fn gltf_nodes_place_their_meshes() {
    let seed = |name: &str| {
        let path = format!("{}/fuzz/seeds/{name}", env!("CARGO_MANIFEST_DIR"));
        load(std::fs::read(&path).unwrap(), Format::from_path(path).unwrap())
    };
    let loaded = seed("gltf/nodes.gltf");
    assert_eq!(names(&loaded), [("mirror", 4), ("m", 12)]);
    // Notes on units that other programs leave do not count: glTF is in metres.
    assert_eq!(loaded.unit, Some(Unit::Metre));
    // The root turns x to y and moves; the mirrored node turns −x to −y. 16-bit positions.
    let p = loaded.mesh.positions[1];
    assert!((p - DVec3::new(1.0, 1.0, 3.0)).length() < 1e-6, "{p}");
    // A mirrored tetrahedron keeps its outside: triangles were turned back.
    let mirrored = &corners(&loaded.mesh)[..4];
    let volume: f64 = mirrored.iter().map(|[a, b, c]| (*a - p).dot((*b - p).cross(*c - p)) / 6.0).sum();
    assert!((volume - 1.0 / 6.0).abs() < 1e-6, "{volume}");
    // The sparse value replaces (0, 0, 1) by (0, 0, 2).
    let p = loaded.mesh.positions[7];
    assert!((p - DVec3::new(1.0, 7.0, 5.0)).length() < 1e-6, "{p}");
    assert_eq!(seed("glb/nodes.glb").mesh, loaded.mesh);
    assert_eq!(seed("gltf/one-triangle.gltf").unit, Some(Unit::Metre));
}

#[test]
fn gltf_buffers_lie_beside_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].iter().flat_map(|x| x.to_le_bytes()).collect();
    let document = |uri: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
        )
    };
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let path = folder.path().join("sub/a.gltf");
    std::fs::write(folder.path().join("sub/my data.bin"), &bytes).unwrap();
    std::fs::write(folder.path().join("outside.bin"), &bytes).unwrap();
    std::fs::write(&path, document("my%20data.bin")).unwrap();
    assert_eq!(read(&path).unwrap().mesh.triangles.len(), 1);

    for uri in ["../outside.bin", "%2E%2e/outside.bin", "https://example.org/a.bin", "absent.bin"] {
        std::fs::write(&path, document(uri)).unwrap();
        let message = read(&path).unwrap_err().to_string();
        assert!(message.contains("a.gltf: buffers[0]: "), "{message}");
    }
    std::fs::write(&path, document(&folder.path().join("outside.bin").display().to_string())).unwrap();
    assert!(read(&path).is_err());
    assert!(read_bytes(document("my%20data.bin").as_bytes(), None, None).is_err());
}

const TETRAHEDRON: &str = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
    <vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>
    <triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="2" v2="0" v3="3"/></triangles></mesh>"#;

fn model(unit: &str, objects: &str, items: &str) -> Vec<u8> {
    let model = format!("<model {unit}><resources>{objects}</resources><build>{items}</build></model>");
    zipped(&[("3D/3dmodel.model", model.as_bytes())])
}

#[test]
fn three_mf_places_components_within_components() {
    let objects = format!(
        r#"<object id="1" name="leaf &amp; twig">{TETRAHEDRON}</object>
        <object id="2"><components><component objectid="1" transform="2 0 0 0 2 0 0 0 2 0 0 0"/>
        <component objectid="1" transform="-1 0 0 0 1 0 0 0 1 10 0 0"/></components></object>
        <object id="3" name="branch"><components><component objectid="2"/></components></object>
        <object id="4" name="spare">{TETRAHEDRON}</object>"#
    );
    let items = r#"<item objectid="3" transform="0 1 0 -1 0 0 0 0 1 0 0 7"/>"#;
    let loaded = load(model(r#"unit="inch""#, &objects, items), Format::ThreeMf);
    assert_eq!(loaded.unit, Some(Unit::Inch));
    assert_eq!(names(&loaded), [("leaf & twig", 4), ("leaf & twig", 4)]);
    assert_eq!(loaded.warnings, ["1 object that the build does not place left out"]);
    // Twice as large is eight times the volume; the mirrored one keeps its outside.
    assert!((volume(&loaded) - 9.0 / 6.0).abs() < 1e-12, "{}", volume(&loaded));
    // (1, 0, 0), doubled, turned to y, lifted.
    assert_eq!(loaded.mesh.positions[1], DVec3::new(0.0, 2.0, 7.0));
    assert_eq!(loaded.mesh.positions[5], DVec3::new(0.0, 9.0, 7.0));
}

#[test]
fn three_mf_without_a_build_gives_its_objects() {
    let objects = format!(r#"<object id="7">{TETRAHEDRON}</object>"#);
    let loaded = load(model("", &objects, ""), Format::ThreeMf);
    assert_eq!((loaded.unit, loaded.mesh.triangles.len()), (Some(Unit::Millimetre), 4));
    assert_eq!(loaded.warnings.len(), 1);
}

#[test]
fn three_mf_models_may_lie_in_several_files() {
    let path = format!("{}/fuzz/seeds/three_mf/package.3mf", env!("CARGO_MANIFEST_DIR"));
    let loaded = read(path).unwrap();
    assert_eq!(names(&loaded), [("a & b", 4), ("a & b", 4)]);
}
