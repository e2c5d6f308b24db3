//! Files as users have them: what they hold is read, and what is not read is named.

use glam::DVec3;
use meshwright::io::{Colours, FileProblem, Format, Loaded, WriteOptions, read, read_bytes};
use meshwright::mesh::TriMesh;

use super::memory::peak_of;
use super::roles::{three_mf_of, unzipped_model};
use super::support::{assert_sound, corners, encoded, encoded_in_colour, every_form, tetrahedron, zipped};

#[track_caller]
pub fn load(bytes: impl AsRef<[u8]>) -> Loaded {
    let loaded = read_bytes(bytes.as_ref(), None, None).unwrap_or_else(|error| panic!("{error}"));
    assert_sound(&loaded);
    loaded
}

#[track_caller]
pub fn problem(bytes: impl AsRef<[u8]>, name: &str) -> FileProblem {
    *read_bytes(bytes.as_ref(), None, Some(name.as_ref())).expect_err("no mesh").problem
}

pub fn volume(mesh: &TriMesh) -> f64 {
    corners(mesh).iter().map(|[a, b, c]| a.dot(b.cross(*c))).sum::<f64>() / 6.0
}

// Places that are no places.

/// Five vertices; the fourth is nowhere, and one of two triangles is at it.
fn with_nowhere(bad: &str) -> [(Format, String); 4] {
    let points = format!("0 0 0\n1 0 0\n0 1 0\n{bad} 0 0\n0 0 1\n");
    let obj: String = points.lines().map(|line| format!("v {line}\n")).collect();
    let facet = |points: [&str; 3]| {
        let loops: String = points.iter().map(|p| format!("vertex {p}\n")).collect();
        format!("facet normal 0 0 0\nouter loop\n{loops}endloop\nendfacet\n")
    };
    let lost = format!("{bad} 0 0");
    let [a, b, c, d] = ["0 0 0", "1 0 0", "0 1 0", "0 0 1"];
    let stl = [[a, b, &lost], [a, b, c], [b, c, d]].map(facet).concat();
    [
        (Format::Obj, format!("{obj}f 1 2 4\nf 1 2 3\nf 2 3 5\n")),
        (Format::Off, format!("OFF\n5 3 0\n{points}3 0 1 3\n3 0 1 2\n3 1 2 4\n")),
        (
            Format::Ply,
            format!(
                "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                 element face 3\nproperty list uchar int vertex_indices\nend_header\n{points}3 0 1 3\n3 0 1 2\n3 1 2 4\n"
            ),
        ),
        (Format::Stl, format!("solid a\n{stl}endsolid a\n")),
    ]
}

#[test]
fn vertices_nowhere_are_dropped_with_their_triangles() {
    for bad in ["nan", "NaN", "inf", "-inf", "1e999"] {
        for (format, text) in with_nowhere(bad) {
            let loaded = load(&text);
            assert_eq!(loaded.format, format);
            let expected = [[DVec3::ZERO, DVec3::X, DVec3::Y], [DVec3::X, DVec3::Y, DVec3::Z]];
            assert_eq!(corners(&loaded.mesh), expected, "{format} {bad}");
            assert_eq!(loaded.mesh.positions.len(), 4);
            let words = ["1 vertex with a coordinate that is no finite number left out, and 1 face there"];
            assert_eq!(loaded.warnings, words, "{format} {bad}");
        }
    }
}

#[test]
fn binary_forms_drop_vertices_nowhere_too() {
    let mesh = tetrahedron();
    for (format, at) in [(Format::Stl, 84 + 50 + 12), (Format::Ply, 0), (Format::Glb, 0)] {
        let mut bytes = encoded(&mesh, &WriteOptions::new(format));
        // In PLY and GLB the first vertex is all zeros; what follows it begins with 1.
        let one = 1f32.to_le_bytes();
        let at = match at {
            0 => bytes.windows(4).position(|window| window == one).unwrap(),
            _ => at,
        };
        bytes[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        let loaded = load(&bytes);
        let left = mesh.triangles.len() - loaded.mesh.triangles.len();
        assert_eq!(left, if format == Format::Stl { 1 } else { 3 }, "{format}");
        assert!(loaded.warnings[0].starts_with("1 vertex with a coordinate"), "{:?}", loaded.warnings);
    }
}

#[test]
fn a_vertex_nowhere_that_no_face_uses_costs_no_face() {
    let loaded = load("v 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 3 4\n");
    assert_eq!(corners(&loaded.mesh), [[DVec3::ZERO, DVec3::X, DVec3::Y]]);
    assert_eq!(loaded.warnings, ["1 vertex with a coordinate that is no finite number left out, and 0 faces there"]);
    let all = problem("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj");
    assert!(matches!(&all, FileProblem::NothingLeft(what) if what.contains("1 vertex")), "{all}");
}

/// Polygons at a vertex nowhere go as a whole; parts and colours stay with their triangles.
#[test]
fn parts_and_colours_stay_with_what_is_left() {
    let text = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv inf 0 0 0 0 0\nv 0 1 0 0 0 1\nv 0 0 1 1 1 1\n\
                o lost\nf 1 2 3 4\no kept\nf 1 2 4\nf 3 4 5\nf 2 4 5\n";
    let loaded = load(text);
    assert_eq!(
        loaded.parts.iter().map(|p| (p.name.as_str(), p.triangles.clone())).collect::<Vec<_>>(),
        [("kept", 0..2)]
    );
    let expected = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255; 4]];
    assert_eq!(loaded.colours, Some(Colours::Vertices(expected.to_vec())));
    assert!(loaded.warnings[0].ends_with("and 2 faces there"), "{:?}", loaded.warnings);
    let colours = Colours::Faces(vec![[1, 0, 0, 255], [2, 0, 0, 255], [3, 0, 0, 255], [4, 0, 0, 255]]);
    for format in [Format::Ply, Format::Off, Format::ThreeMf] {
        let mut mesh = tetrahedron();
        mesh.positions[3] = DVec3::new(0.0, 0.0, 7.0);
        let text = encoded_in_colour(&mesh, &colours, &WriteOptions { ascii: true, ..WriteOptions::new(format) });
        let bytes = match format {
            Format::ThreeMf => three_mf_of(&unzipped_model(&text).replace("z=\"7\"", "z=\"nan\""), &[]),
            _ => String::from_utf8(text).unwrap().replace("0 0 7", "0 0 nan").into_bytes(),
        };
        let loaded = load(bytes);
        assert_eq!(loaded.colours, Some(Colours::Faces(vec![[1, 0, 0, 255]])), "{format}");
    }
}

// OFF by words, STL with more words.

#[test]
fn off_is_read_by_words() {
    let cube = "8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n\
                4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";
    let plain = load(format!("OFF\n{cube}"));
    assert_eq!(volume(&plain.mesh), 1.0);
    let faces_over_lines = cube.replace("4 0 1 5 4\n", "4\n0 1\n5 4\n").replace("4 3 2 1 0", "4 3 2 # so\n\n1 0");
    let points_over_lines = cube.replace("1 1 1\n", "1\n1\n1\n");
    for text in [
        format!("OFF{cube}"),
        format!("OFF {cube}"),
        format!("# by hand\n\nOFF # keyword\n# counts\n{cube}"),
        cube.replacen("8 6 0", "OFF\n8 6", 1),
        cube.replacen("8 6 0", "OFF\n8\n6\n0", 1),
        cube.replacen("8 6 0", "OFF 8\n6 0", 1),
        format!("OFF\n{faces_over_lines}"),
        format!("OFF\n{points_over_lines}"),
        format!("OFF\n{}", cube.replace('\n', " ")),
        format!("OFF\n{}", cube.replace('\n', "\r\n")),
        format!("OFF\n{}", cube.replace(' ', "\n")),
    ] {
        let loaded = load(&text);
        assert_eq!((&loaded.mesh, &loaded.warnings), (&plain.mesh, &plain.warnings), "{text}");
        assert_eq!(loaded.format, Format::Off);
    }
}

#[test]
fn words_that_trail_in_text_stl_are_passed_over() {
    let clean =
        String::from_utf8(encoded(&tetrahedron(), &WriteOptions { ascii: true, ..WriteOptions::new(Format::Stl) }))
            .unwrap();
    for (from, to) in [
        ("endfacet\n", "endfacet facet_1\n"),
        ("endloop\n", "endloop ok\n"),
        ("outer loop\n", "outer loop 3 corners\n"),
        ("vertex 0 0 1\n", "vertex 0 0 1 ; the top\n"),
        ("facet normal 0 0 -1\n", "facet normal 0 0 -1 down here\n"),
    ] {
        assert!(clean.contains(from), "{from} in {clean}");
        let loaded = load(clean.replace(from, to));
        assert_eq!(loaded.mesh, load(&clean).mesh, "{to}");
    }
    let loaded = load(clean.replace("endfacet\n", "endfacet x y\n"));
    assert_eq!(loaded.warnings, ["8 words after the end of a statement left out"]);
    // A line that begins with such a word is damage.
    let damaged = problem(clean.replacen("facet normal", "fasset normal", 2), "a.stl");
    assert!(matches!(damaged, FileProblem::Syntax { .. }), "{damaged}");
}

// Texts in other encodings.

#[test]
fn texts_in_utf16_and_with_byte_order_marks_read_alike() {
    for options in every_form() {
        let bytes = encoded(&tetrahedron(), &options);
        let Ok(text) = String::from_utf8(bytes.clone()) else { continue };
        if options.format == Format::Gltf || text.contains('\0') {
            continue;
        }
        let plain = load(&bytes);
        let sixteen = |order: fn(u16) -> [u8; 2]| text.encode_utf16().flat_map(order).collect::<Vec<u8>>();
        let (little, big) = (sixteen(u16::to_le_bytes), sixteen(u16::to_be_bytes));
        for bytes in [
            [b"\xef\xbb\xbf", bytes.as_slice()].concat(),
            [b"\xff\xfe", little.as_slice()].concat(),
            [b"\xfe\xff", big.as_slice()].concat(),
            little,
            big,
        ] {
            assert_eq!(load(&bytes), plain, "{}", options.format);
        }
    }
}

// Files that are something else.

#[test]
fn files_that_are_something_else_are_named_with_what_to_do() {
    let named = |bytes: &[u8], name: &str, words: &[&str]| {
        let error = read_bytes(bytes, None, Some(name.as_ref())).expect_err(name);
        let text = format!("{error} ({})", error.hint().unwrap_or_default());
        words.iter().for_each(|word| assert!(text.contains(word), "`{word}` is missing in: {text}"));
    };
    let page = b"<!DOCTYPE html>\n<html><head><title>404</title></head><body>not found</body></html>".repeat(20);
    for name in ["part.stl", "part.obj", "part.off", "part.ply", "part.gltf", "part"] {
        named(&page, name, &["a web page", "the download failed"]);
        named(
            b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n",
            name,
            &["a STEP model", "export the model as STL"],
        );
        named(&[b"%PDF-1.7\n".as_slice(), &[7; 300]].concat(), name, &["a PDF document"]);
        named(&[b"\x1f\x8b\x08\0".as_slice(), &[9; 300]].concat(), name, &["gzip", "unpack it first"]);
        named(&[b"7z\xbc\xaf\x27\x1c".as_slice(), &[9; 300]].concat(), name, &["a 7z archive"]);
        named(&[b"\x89PNG\r\n\x1a\n".as_slice(), &[0; 300]].concat(), name, &["a PNG picture"]);
        named(&[b"\xff\xd8\xff\xe0".as_slice(), &[0; 300]].concat(), name, &["a JPEG picture"]);
        named(
            &zipped(&[("part.stl", b"solid"), ("readme.txt", b"")]),
            name,
            &["a ZIP archive", "`part.stl`", "unpack it"],
        );
        named(&zipped(&[("word/document.xml", b"<w/>")]), name, &["an Office document"]);
        named(b"NRRD0004\ntype: float\n", name, &["a lattice of values (NRRD)"]);
    }
    named(format!("{:72}S      1\n", "a part in IGES").as_bytes(), "part.stl", &["an IGES model"]);
    named(&[7; 300], "scene.bin", &["numbers without a description", ".gltf"]);
    // Also where the format is given.
    let error = read_bytes(&page, Some(Format::Stl), Some("part.stl".as_ref())).unwrap_err();
    assert!(error.to_string().contains("a web page"), "{error}");
}

#[test]
fn point_clouds_are_named_as_such() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n1 1 1\n";
    let gltf = br#"{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":0}]}],
        "accessors":[{"componentType":5126,"count":2,"type":"VEC3"}]}"#;
    let obj = b"v 0 0 0\nv 1 1 1\np 1 2\n";
    for bytes in [ply.as_bytes(), gltf, obj, b"v 0 0 0\nv 1 1 1\n", b"OFF\n2 0 0\n0 0 0\n1 1 1\n"] {
        let found = problem(bytes, "cloud.obj");
        assert!(matches!(found, FileProblem::PointCloud { points: 2 }), "{found}");
        assert!(found.to_string().starts_with("a point cloud: "), "{found}");
    }
}

// glTF.

/// A triangle, and the numbers of instances, in one buffer.
fn instanced(attributes: &str, accessors: &str, numbers: &[u8], node: &str) -> Vec<u8> {
    use base64::Engine;
    let mut buffer: Vec<u8> =
        [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    buffer.extend_from_slice(numbers);
    let data = base64::engine::general_purpose::STANDARD.encode(&buffer);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["EXT_mesh_gpu_instancing"],
        "extensionsRequired":["EXT_mesh_gpu_instancing"],"scene":0,"scenes":[{{"nodes":[0]}}],
        "nodes":[{{"mesh":0{node},"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},{accessors}],
        "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":{}}}],
        "buffers":[{{"byteLength":{},"uri":"data:;base64,{data}"}}]}}"#,
        numbers.len(),
        buffer.len()
    )
    .into_bytes()
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|x| x.to_le_bytes()).collect()
}

#[test]
fn instances_are_placed() {
    let accessor = |kind: u32, shape: &str, offset: usize, more: &str| {
        format!(r#"{{"bufferView":1,"byteOffset":{offset},"componentType":{kind},"count":2,"type":"{shape}"{more}}}"#)
    };
    let numbers = floats(&[0.0, 0.0, 0.0, 10.0, 0.0, 0.0]);
    let loaded = load(instanced(r#""TRANSLATION":1,"_ID":0"#, &accessor(5126, "VEC3", 0, ""), &numbers, ""));
    assert_eq!(loaded.mesh.triangles.len(), 2);
    assert_eq!(corners(&loaded.mesh)[1][0], DVec3::new(10.0, 0.0, 0.0));
    assert_eq!((loaded.parts.len(), loaded.warnings.len()), (2, 0));
    // A quarter turn about z in normalised integers, twice the size, and a node that moves all.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let short = |x: f64| ((x * 32767.0).round() as i16).to_le_bytes();
    let mut numbers: Vec<u8> = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half].into_iter().flat_map(short).collect();
    numbers.extend(floats(&[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]));
    let accessors = [accessor(5122, "VEC4", 0, r#","normalized":true"#), accessor(5126, "VEC3", 16, "")].join(",");
    let loaded = load(instanced(r#""ROTATION":1,"SCALE":2"#, &accessors, &numbers, r#","translation":[0,0,5]"#));
    let found = corners(&loaded.mesh);
    let near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-4, "{a} instead of {b}");
    near(found[0][1], DVec3::new(1.0, 0.0, 5.0));
    near(found[1][1], DVec3::new(0.0, 2.0, 5.0));
    near(found[1][2], DVec3::new(-2.0, 0.0, 5.0));
    // As many of each kind.
    let accessors =
        [accessor(5126, "VEC3", 0, ""), accessor(5126, "VEC3", 0, "").replace("\"count\":2", "\"count\":1")];
    let numbers = floats(&[0.0; 6]);
    let lie = instanced(r#""TRANSLATION":1,"SCALE":2"#, &accessors.join(","), &numbers, "");
    assert!(matches!(problem(lie, "a.gltf"), FileProblem::Syntax { .. }));
}

/// As many instances as a number can say, of nothing.
#[test]
fn instances_without_end_are_refused() {
    let count = 4_000_000;
    let accessor = format!(r#"{{"componentType":5126,"count":{count},"type":"VEC3"}}"#);
    let lie = instanced(r#""TRANSLATION":1"#, &accessor, &[0; 4], "");
    let (result, peak) = peak_of(|| read_bytes(&lie, None, None));
    assert!(matches!(*result.unwrap_err().problem, FileProblem::TooLarge { .. }));
    assert!(peak < 400 << 20, "{peak}");
}

#[test]
fn required_extensions_that_are_not_read_are_named() {
    let with = |extensions: &str| {
        let text = String::from_utf8(encoded(&tetrahedron(), &WriteOptions::new(Format::Gltf))).unwrap();
        text.replacen("{\"", &format!("{{\"extensionsRequired\":[{extensions}],\""), 1)
    };
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "ACME_implicit_shapes"] {
        let text = problem(with(&format!("\"KHR_mesh_quantization\",\"{name}\"")), "a.gltf").to_string();
        assert!(text.contains(&format!("`{name}`")), "{text}");
    }
    assert_eq!(load(with("\"KHR_mesh_quantization\"")).warnings, Vec::<String>::new());
    let looks = load(with("\"KHR_texture_transform\",\"KHR_materials_unlit\"")).warnings;
    assert_eq!(looks, ["required extensions on looks left out: KHR_texture_transform, KHR_materials_unlit"]);
}

#[test]
fn gltf_of_version_1_is_said_so() {
    let one = r#"{"asset":{"version":"1.0"},"meshes":{"a":{"primitives":[]}},"scenes":{},"nodes":{}}"#;
    for text in [one.to_owned(), one.replace("\"1.0\"", "1.0"), one.replace("{\"version\":\"1.0\"}", "{}")] {
        let found = problem(&text, "a.gltf").to_string();
        assert!(found.contains("only version 2.0") && found.contains("convert it"), "{found}");
    }
    let glb = [b"glTF\x01\0\0\0".as_slice(), &[0; 12]].concat();
    assert!(problem(glb, "a.glb").to_string().contains("glTF version 1 is not read here"));
}

#[cfg(unix)]
#[test]
fn buffers_come_from_the_own_folder_and_no_more_than_is_declared() {
    use std::os::unix::fs::symlink;
    let outer = tempfile::tempdir().unwrap();
    let folder = outer.path().join("model");
    std::fs::create_dir(&folder).unwrap();
    let text = String::from_utf8(encoded(&tetrahedron(), &WriteOptions::new(Format::Gltf))).unwrap();
    let start = text.find("data:").unwrap();
    let end = start + text[start..].find('"').unwrap();
    let with = |uri: &str| {
        std::fs::write(folder.join("a.gltf"), [&text[..start], uri, &text[end..]].concat()).unwrap();
        read(&folder.join("a.gltf"))
    };
    let glb = encoded(&tetrahedron(), &WriteOptions::new(Format::Glb));
    let buffer = &glb[glb.len() - 96..];
    std::fs::write(folder.join("own.bin"), buffer).unwrap();
    // Longer than declared: the rest is not read.
    std::fs::write(folder.join("long.bin"), [buffer, &[7; 100_000]].concat()).unwrap();
    std::fs::write(outer.path().join("secret.bin"), buffer).unwrap();
    symlink("own.bin", folder.join("inner_link.bin")).unwrap();
    symlink("../secret.bin", folder.join("outer_link.bin")).unwrap();
    symlink("/dev/zero", folder.join("endless.bin")).unwrap();
    symlink("loop.bin", folder.join("loop.bin")).unwrap();
    symlink("../../", folder.join("up")).unwrap();
    let pipe = std::process::Command::new("mkfifo").arg(folder.join("pipe.bin")).status();
    for uri in ["own.bin", "./own.bin", "long.bin", "inner_link.bin"] {
        let loaded = with(uri).unwrap_or_else(|error| panic!("{uri}: {error}"));
        assert_eq!(corners(&loaded.mesh), corners(&tetrahedron()), "{uri}");
    }
    let mut outside = vec![
        "outer_link.bin",
        "endless.bin",
        "up/secret.bin",
        "../secret.bin",
        "/etc/passwd",
        "loop.bin",
        "absent.bin",
        ".",
    ];
    outside.extend(pipe.is_ok_and(|status| status.success()).then_some("pipe.bin"));
    for uri in outside {
        let error = with(uri).expect_err(uri);
        let words = error.to_string();
        assert!(words.contains("buffers[0]") && !words.contains("os error"), "{uri}: {words}");
        assert!(matches!(*error.problem, FileProblem::Unsupported(_) | FileProblem::Io(_)), "{uri}: {words}");
    }
}
