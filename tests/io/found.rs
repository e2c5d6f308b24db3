//! Files as users have them: what they hold is read, and what is not read is named.

use glam::DVec3;
use meshwright::io::{Colours, Format, Loaded, ReadProblem, WriteOptions, read, read_bytes};
use meshwright::mesh::TriMesh;

use crate::memory::peak_of;
use crate::support::{assert_sound, corners, encoded, encoded_in_colour, every_form, tetrahedron, zipped};

#[track_caller]
fn load(bytes: impl AsRef<[u8]>) -> Loaded {
    let loaded = read_bytes(bytes.as_ref(), None, None).unwrap_or_else(|error| panic!("{error}"));
    assert_sound(&loaded);
    loaded
}

#[track_caller]
fn problem(bytes: impl AsRef<[u8]>, name: &str) -> ReadProblem {
    *read_bytes(bytes.as_ref(), None, Some(name.as_ref())).expect_err("no mesh").problem
}

fn volume(mesh: &TriMesh) -> f64 {
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
    assert!(matches!(&all, ReadProblem::NothingLeft(what) if what.contains("1 vertex")), "{all}");
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
    assert!(matches!(damaged, ReadProblem::Syntax { .. }), "{damaged}");
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
        let text = problem(bytes, name).to_string();
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
        assert!(matches!(found, ReadProblem::PointCloud { points: 2 }), "{found}");
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
    assert!(matches!(problem(lie, "a.gltf"), ReadProblem::Syntax { .. }));
}

/// As many instances as a number can say, of nothing.
#[test]
fn instances_without_end_are_refused() {
    let count = 4_000_000;
    let accessor = format!(r#"{{"componentType":5126,"count":{count},"type":"VEC3"}}"#);
    let lie = instanced(r#""TRANSLATION":1"#, &accessor, &[0; 4], "");
    let (result, peak) = peak_of(|| read_bytes(&lie, None, None));
    assert!(matches!(*result.unwrap_err().problem, ReadProblem::TooLarge { .. }));
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
        assert!(matches!(*error.problem, ReadProblem::Unsupported(_) | ReadProblem::Io(_)), "{uri}: {words}");
    }
}

// 3MF.

const CORE: &str = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";

fn three_mf_of(model: &str, more: &[(&str, &str)]) -> Vec<u8> {
    let mut files = vec![("3D/3dmodel.model", model.as_bytes())];
    files.extend(more.iter().map(|(name, text)| (*name, text.as_bytes())));
    zipped(&files)
}

fn unzipped_model(package: &[u8]) -> String {
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
