//! Files that lie: a typed error with the place, within the memory and time that their length justifies.

use meshwright::io::{FileProblem, Format, Location, Wanted, read_bytes};

use super::memory::peak_of;
use super::support::{encoded, tetrahedron, zipped};
use meshwright::io::WriteOptions;

/// The place and problem of a file that must not read, and which may take 64 times its length and 1 MB.
#[track_caller]
fn refuse(bytes: impl AsRef<[u8]>, format: Format) -> (Option<Location>, FileProblem) {
    let bytes = bytes.as_ref();
    let (result, peak) = peak_of(|| read_bytes(bytes, Some(format), Some("lies.bin".as_ref())));
    let error = result.expect_err("a file that lies is refused");
    assert!(error.to_string().starts_with("lies.bin: "), "{error}");
    assert!(peak <= 64 * bytes.len() + (1 << 20), "{peak} bytes for {}: {error}", bytes.len());
    (error.location, *error.problem)
}

#[track_caller]
fn refuse_at(bytes: impl AsRef<[u8]>, format: Format, place: Location) -> FileProblem {
    let (found, problem) = refuse(bytes, format);
    assert_eq!(found, Some(place), "{problem}");
    problem
}

macro_rules! assert_is {
    ($problem:expr, $pattern:pat) => {
        let problem = $problem;
        assert!(matches!(problem, $pattern), "{problem:?}");
    };
}

#[test]
fn nothing_is_no_mesh() {
    for format in Format::ALL {
        assert_is!(refuse("", format).1, FileProblem::Empty);
        refuse("\n", format);
        refuse([0; 3], format);
        refuse([0xff; 300], format);
    }
    let error = read_bytes(b"who knows", None, None).unwrap_err();
    assert_is!(*error.problem, FileProblem::UnknownFormat(Wanted::Mesh));
    assert!(meshwright::io::read("absent/file.stl").unwrap_err().to_string().contains("absent/file.stl"));
}

fn stl(stated: u32, facets: usize, extra: usize) -> Vec<u8> {
    let whole = encoded(&tetrahedron(), &WriteOptions::new(Format::Stl));
    let mut bytes = b"solid as many binary files begin".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(stated.to_le_bytes());
    bytes.extend(whole[84..].iter().cycle().take(50 * facets));
    bytes.resize(bytes.len() + extra, 7);
    bytes
}

#[test]
fn binary_stl_that_lies_about_its_count() {
    let ends = |length: u64| Location::Byte(length);
    for (stated, facets, extra) in [(u32::MAX, 0, 0), (5, 4, 0), (5, 4, 49), (u32::MAX, 4, 17), (1, 0, 0)] {
        let bytes = stl(stated, facets, extra);
        let length = bytes.len() as u64;
        assert_is!(refuse_at(bytes, Format::Stl, ends(length)), FileProblem::Truncated { .. });
    }
    // Never filled in, and then cut within a facet.
    assert_is!(refuse_at(stl(0, 4, 10), Format::Stl, ends(294)), FileProblem::Truncated { .. });
    assert_is!(refuse(stl(0, 0, 0), Format::Stl).1, FileProblem::NoTriangles);
    assert_is!(refuse_at(&stl(4, 4, 0)[..83], Format::Stl, ends(83)), FileProblem::Truncated { .. });

    let accept = |bytes: Vec<u8>| {
        let loaded = read_bytes(&bytes, None, Some("a.stl".as_ref())).unwrap();
        (loaded.mesh.triangles.len(), loaded.warnings)
    };
    assert_eq!(accept(stl(4, 4, 0)), (4, vec![]));
    assert_eq!(accept(stl(0, 4, 0)).0, 4);
    assert_eq!(accept(stl(3, 4, 0)), (4, vec!["the header counts 3 facets but 4 are there; all are read".into()]));
    assert_eq!(accept(stl(4, 4, 7)), (4, vec!["7 bytes after the last facet left out".into()]));
    assert_eq!(accept(stl(2, 4, 7)), (2, vec!["107 bytes after the last of 2 facets left out".into()]));
}

#[test]
fn stl_that_is_broken_inside() {
    let head = "solid x\nfacet normal 0 0 1\nouter loop\n";
    let line = |text: &str, line| refuse_at(format!("{head}{text}"), Format::Stl, Location::Line(line));
    assert_is!(line("vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n", 7), FileProblem::Truncated { .. });
    assert_is!(line("vertex 0 0 0\nvertex 1", 5), FileProblem::Truncated { .. });
    assert_is!(line("vertex 0 0 0\nvertex 1 0\nvertex 0 1 0\n", 6), FileProblem::Syntax { .. });
    assert_is!(line("vertex 0 0 1,5\n", 4), FileProblem::Syntax { .. });
    assert_is!(line("vertex 0 0 0\nendloop\nendfacet", 5), FileProblem::Syntax { .. });
    assert_is!(
        refuse_at("solid\nfacet normal 0 0 1 vertex", Format::Stl, Location::Line(2)),
        FileProblem::Syntax { .. }
    );
    assert_is!(refuse_at("solid a\nendsolid\nfact\n", Format::Stl, Location::Line(3)), FileProblem::Syntax { .. });
    assert_is!(refuse("solid a\nendsolid a\n", Format::Stl).1, FileProblem::NoTriangles);
}

#[test]
fn obj_that_lies() {
    let line =
        |text: &str, line| refuse_at(format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{text}"), Format::Obj, Location::Line(line));
    for face in ["f 1 2 0", "f 1 2 4", "f 1 2 -4", "f 1 2 4294967296", "f 1 2 -9223372036854775808", "f 1 2 4 3"] {
        assert_is!(line(&format!("f 1 2 3\n{face}\n"), 5), FileProblem::IndexOutOfRange { .. });
    }
    for face in ["f 1 2 x", "f 1 2 /3", "f 1 2 99999999999999999999", "f 1.5 2 3"] {
        assert_is!(line(face, 4), FileProblem::Syntax { .. });
    }
    assert_is!(line("v 1 2", 4), FileProblem::Syntax { .. });
    assert_is!(line("v 1 2 \\\n", 4), FileProblem::Syntax { .. });
    assert_is!(line("v 1 2 three", 4), FileProblem::Syntax { .. });
    assert_is!(refuse("v 0 0 0\nf 1 1\n", Format::Obj).1, FileProblem::NothingLeft(_));
    assert_is!(refuse("v 0 0 0\nv 1 0 0\nl 1 2\n", Format::Obj).1, FileProblem::NothingLeft(_));
}

#[test]
fn off_that_lies() {
    let at = |text: &str, line| refuse_at(text, Format::Off, Location::Line(line));
    assert_is!(at("OFF\n4000000000 4000000000 0\n0 0 0\n", 3), FileProblem::Truncated { .. });
    assert_is!(at("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 6), FileProblem::Truncated { .. });
    // A number is missing: what follows is told from numbers that go on in the next line.
    assert_is!(at("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 5), FileProblem::Syntax { .. });
    assert_is!(at("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n2 0 1 2\n", 7), FileProblem::Syntax { .. });
    assert_is!(at("OFF\n3 1 0\n0 0 0 x 0 0\n1 0 0\n", 3), FileProblem::Syntax { .. });
    assert_is!(at("OFF\n3 1 0\n0 0 0\n1 0 0 0 1\n", 4), FileProblem::Truncated { .. });
    assert_is!(at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", 6), FileProblem::IndexOutOfRange { .. });
    assert_is!(at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", 6), FileProblem::IndexOutOfRange { .. });
    assert_is!(at("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n", 6), FileProblem::Truncated { .. });
    assert_is!(at("OFF\n-3 1 0\n", 2), FileProblem::Syntax { .. });
    assert_is!(at("OFF BINARY\n", 1), FileProblem::Unsupported(_));
    assert_is!(at("4OFF\n1 1 1\n", 1), FileProblem::Unsupported(_));
    assert_is!(refuse("OFF 1 1 0\n0 0 0\n2 0 0\n", Format::Off).1, FileProblem::NothingLeft(_));
}

fn ply(format: &str, elements: &str, body: &[u8]) -> Vec<u8> {
    let mut bytes = format!("ply\nformat {format} 1.0\n{elements}end_header\n").into_bytes();
    bytes.extend_from_slice(body);
    bytes
}

#[test]
fn ply_that_lies_in_its_header() {
    let vertex = |n: u64| format!("element vertex {n}\nproperty float x\nproperty float y\nproperty float z\n");
    let list = "property list uint int vertex_indices\n";
    let binary = "binary_little_endian";
    for n in [5, 4_000_000_000, u64::MAX / 2] {
        for format in [binary, "binary_big_endian", "ascii"] {
            assert_is!(refuse(ply(format, &vertex(n), b"0 0 0\n"), Format::Ply).1, FileProblem::Truncated { .. });
        }
    }
    // A row of nothing, four billion times, costs nothing.
    let elements = format!("element nothing 4000000000\n{}element face 1\n{list}", vertex(1));
    let mut body = vec![0; 12];
    body.extend([3, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(read_bytes(&ply(binary, &elements, &body), None, None).unwrap().mesh.triangles, [[0, 0, 0]]);
    // A list of four billion.
    body[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_is!(refuse(ply(binary, &elements, &body), Format::Ply).1, FileProblem::Truncated { .. });

    for (elements, line) in [
        ("property float x\n", 3),
        ("element vertex\n", 3),
        ("element vertex -1\n", 3),
        ("element vertex 1\nproperty floot x\n", 4),
        ("element vertex 1\nproperty list float\n", 4),
        ("what is this\n", 3),
        ("element vertex 1\nproperty float x\nproperty float y\n", 3),
        ("element face 1\nproperty list uchar int vertex_indices\n", 5),
    ] {
        let problem = refuse_at(ply("ascii", elements, b"0 0 0\n"), Format::Ply, Location::Line(line));
        assert_is!(problem, FileProblem::Syntax { .. });
    }
    assert_is!(refuse_at(ply("utf8", "", b""), Format::Ply, Location::Line(2)), FileProblem::Syntax { .. });
    assert_is!(refuse("ply\nelement vertex 1\nend_header\n", Format::Ply).1, FileProblem::Syntax { .. });
    assert_is!(refuse_at("ply\nformat ascii 1.0\n", Format::Ply, Location::Byte(21)), FileProblem::Truncated { .. });
}

#[test]
fn ply_that_is_broken_inside() {
    let elements = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 1\nproperty list char float vertex_indices\n";
    let line = |body: &str, line| refuse_at(ply("ascii", elements, body.as_bytes()), Format::Ply, Location::Line(line));
    let points = "0 0 0\n1 0 0\n0 1 0\n";
    for face in ["3 0 1 3", "3 0 1 -1", "3 0 1 0.5", "3 0 1 nan", "3 0 1 1e99"] {
        assert_is!(line(&format!("{points}{face}\n"), 13), FileProblem::IndexOutOfRange { .. });
    }
    for face in ["3 0 1", "-3 0 1 2", "1.5 0 1 2", "nan", "3 0 1 x"] {
        assert_is!(line(&format!("{points}{face}\n"), 13), FileProblem::Syntax { .. });
    }
    assert_is!(line(points, 12), FileProblem::Truncated { .. });
    assert_is!(line("0 0 0\n1 0\n0 1 0\n3 0 1 2\n", 11), FileProblem::Syntax { .. });

    let whole = encoded(&tetrahedron(), &WriteOptions::new(Format::Ply));
    let body = whole.len() - 4 * 12 - 4 * 13;
    let mut index = whole.clone();
    index[body + 48 + 1..][..4].copy_from_slice(&(-1i32).to_le_bytes());
    assert_is!(refuse_at(index, Format::Ply, Location::Byte(body as u64 + 48)), FileProblem::IndexOutOfRange { .. });
    assert_is!(refuse(&whole[..whole.len() - 1], Format::Ply).1, FileProblem::Truncated { .. });
}

/// The JSON of a triangle with some of it replaced.
fn gltf(changes: &[(&str, &str)]) -> String {
    let mut json = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                     {"bufferView":1,"componentType":5121,"count":3,"type":"SCALAR"}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":3}],
        "buffers":[{"byteLength":39,
          "uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAEC"}]}"#
        .to_owned();
    for (from, to) in changes {
        assert!(json.contains(from), "{from}");
        json = json.replacen(from, to, 1);
    }
    json
}

#[test]
fn gltf_that_lies() {
    assert_eq!(read_bytes(gltf(&[]).as_bytes(), None, None).unwrap().mesh.triangles, [[0, 1, 2]]);
    let huge = r#""count":18446744073709551615,"type":"VEC3""#;
    let three = r#""count":3,"type":"VEC3""#;
    let cases: &[(&[(&str, &str)], &str)] = &[
        (&[(r#""scene":0"#, r#""scene":1"#)], "scene"),
        (&[(r#"{"nodes":[0]}"#, r#"{"nodes":[7]}"#)], "nodes[7]"),
        (&[(r#"{"mesh":0}"#, r#"{"mesh":3}"#)], "meshes[3]"),
        (&[(r#"{"mesh":0}"#, r#"{"mesh":0,"children":[0]}"#)], "nodes[0]"),
        (&[(r#""POSITION":0"#, r#""POSITION":9"#)], "meshes[0]"),
        (&[(r#""POSITION":0"#, r#""POSITION":1"#)], "accessors[1]"),
        (&[(r#""indices":1"#, r#""indices":0"#)], "accessors[0]"),
        (&[(three, r#""count":4,"type":"VEC3""#)], "accessors[0]"),
        (&[(three, huge)], "accessors[0]"),
        (&[(three, huge), (r#""bufferView":0,"#, "")], "accessors[0]"),
        (&[(three, r#""byteOffset":18446744073709551615,"count":3,"type":"VEC3""#)], "accessors[0]"),
        (&[(r#""count":3,"type":"SCALAR""#, r#""count":4,"type":"SCALAR""#)], "accessors[1]"),
        (&[(r#""byteLength":36}"#, r#""byteLength":36,"byteStride":0}"#)], "accessors[0]"),
        (&[(r#""byteLength":36}"#, r#""byteLength":40}"#)], "bufferViews[0]"),
        (&[(r#""byteOffset":36"#, r#""byteOffset":18446744073709551615"#)], "bufferViews[1]"),
        (&[(r#"{"buffer":0,"byteLength":36}"#, r#"{"buffer":5,"byteLength":36}"#)], "bufferViews[0]"),
        (&[(r#""byteLength":39"#, r#""byteLength":35"#)], "bufferViews[0]"),
        (&[("AAEC", "AAED")], "accessors[1]"),
        (&[("data:;base64,", "data:;base64,*")], "buffers[0]"),
        (&[("data:;base64,AAAA", "data:AAAA")], "buffers[0]"),
        (&[(r#""scene":0"#, r#""extensionsRequired":["KHR_draco_mesh_compression"]"#)], "extensionsRequired"),
    ];
    for (changes, place) in cases {
        refuse_at(gltf(changes), Format::Gltf, Location::Item((*place).to_owned()));
    }
    let points = gltf(&[(r#""indices":1"#, r#""indices":1,"mode":0"#)]);
    assert_is!(refuse(points, Format::Gltf).1, FileProblem::PointCloud { points: 3 });
    refuse_at(r#"{"asset":{"version":"2.0"},"#, Format::Gltf, Location::Line(1));
    refuse(format!("{{\"asset\":{}", "[".repeat(100_000)), Format::Gltf);
}

#[test]
fn glb_that_lies() {
    let whole = encoded(&tetrahedron(), &WriteOptions::new(Format::Glb));
    for length in 4..whole.len() {
        assert_is!(refuse(&whole[..length], Format::Glb).1, FileProblem::Truncated { .. });
    }
    let with = |at: usize, word: u32| {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&word.to_le_bytes());
        bytes
    };
    assert_is!(refuse_at(with(4, 1), Format::Glb, Location::Byte(4)), FileProblem::Unsupported(_));
    assert_is!(refuse(with(8, u32::MAX), Format::Glb).1, FileProblem::Truncated { .. });
    assert_is!(refuse(with(8, 0), Format::Glb).1, FileProblem::Syntax { .. });
    assert_is!(refuse(with(12, u32::MAX), Format::Glb).1, FileProblem::Truncated { .. });
    assert_is!(refuse(with(16, 0), Format::Glb).1, FileProblem::Syntax { .. });
}

/// Nodes and primitives that use the same large accessor many times over.
#[test]
fn gltf_that_unfolds_without_end() {
    let nodes = vec![r#"{"mesh":0}"#; 3000].join(",");
    let roots = (0..3000).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
    let json = gltf(&[
        (r#"{"mesh":0}"#, &nodes),
        (r#"{"nodes":[0]}"#, &format!(r#"{{"nodes":[{roots}]}}"#)),
        (r#""bufferView":0,"#, ""),
        (r#""count":3,"type":"VEC3""#, r#""count":4000,"type":"VEC3""#),
    ]);
    let (result, peak) = peak_of(|| read_bytes(json.as_bytes(), None, None));
    assert_is!(*result.unwrap_err().problem, FileProblem::TooLarge { .. });
    assert!(peak < 400 << 20, "{peak}");
}

const TRIANGLE: &str = r#"<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>
    </vertices><triangles><triangle v1="0" v2="1" v3="2"/></triangles></mesh>"#;

fn three_mf(body: &str) -> Vec<u8> {
    zipped(&[("3D/3dmodel.model", format!("<model>{body}</model>").as_bytes())])
}

fn object(changes: &[(&str, &str)]) -> Vec<u8> {
    let mut text =
        format!(r#"<resources><object id="1">{TRIANGLE}</object></resources><build><item objectid="1"/></build>"#);
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    three_mf(&text)
}

#[test]
fn three_mf_that_lies() {
    assert_eq!(read_bytes(&object(&[]), None, None).unwrap().mesh.triangles, [[0, 1, 2]]);
    let problem = |changes: &[(&str, &str)]| {
        let (place, problem) = refuse(object(changes), Format::ThreeMf);
        assert!(
            matches!(&place, Some(Location::Part { name, byte }) if name == "3D/3dmodel.model" && *byte > 0),
            "{place:?}"
        );
        problem
    };
    assert_is!(problem(&[(r#"v3="2""#, r#"v3="3""#)]), FileProblem::IndexOutOfRange { .. });
    assert_is!(problem(&[(r#"v3="2""#, r#"v3="-1""#)]), FileProblem::IndexOutOfRange { .. });
    assert_is!(problem(&[(r#" v3="2""#, "")]), FileProblem::Syntax { .. });
    assert_is!(problem(&[(r#" z="0""#, "")]), FileProblem::Syntax { .. });
    assert_is!(
        problem(&[("<item", r#"<item transform="1e999 0 0 0 1 0 0 0 1 0 0 0""#)]),
        FileProblem::NotFinite { .. }
    );
    assert_is!(problem(&[(r#"z="0""#, r#"z="&zero;""#)]), FileProblem::Syntax { .. });
    assert_is!(problem(&[("<item", r#"<item transform="1 0 0""#)]), FileProblem::Syntax { .. });
    assert_is!(problem(&[("</vertices>", "</vertexes>")]), FileProblem::Syntax { .. });
    assert_is!(problem(&[(r#"objectid="1""#, r#"objectid="one""#)]), FileProblem::Syntax { .. });
    assert_is!(
        refuse(object(&[(r#"objectid="1""#, r#"objectid="2""#)]), Format::ThreeMf).1,
        FileProblem::Syntax { .. }
    );
    assert_is!(refuse(three_mf(""), Format::ThreeMf).1, FileProblem::NoTriangles);
    assert_is!(refuse(zipped(&[("readme.txt", b"no model")]), Format::ThreeMf).1, FileProblem::Unsupported(_));
    let cut = zipped(&[("3D/3dmodel.model", b"<model><resources><object id=\"1\">")]);
    assert_is!(refuse(cut, Format::ThreeMf).1, FileProblem::Truncated { .. });
    let whole = object(&[]);
    for length in 0..whole.len() {
        refuse(&whole[..length], Format::ThreeMf);
    }
}

#[test]
fn three_mf_that_unfolds_without_end() {
    let components = |id: u32, parts: &[u32]| {
        let parts: String = parts.iter().map(|p| format!(r#"<component objectid="{p}"/>"#)).collect();
        format!(r#"<object id="{id}"><components>{parts}</components></object>"#)
    };
    let file = |objects: String, item: u32| {
        three_mf(&format!(r#"<resources>{objects}</resources><build><item objectid="{item}"/></build>"#))
    };
    // Within itself, and in a circle.
    let circle = file(components(1, &[1]), 1);
    assert_is!(refuse(circle, Format::ThreeMf).1, FileProblem::Syntax { .. });
    let circle = file(components(1, &[2]) + &components(2, &[1]), 1);
    assert_is!(refuse(circle, Format::ThreeMf).1, FileProblem::Syntax { .. });
    // Deeper than anybody builds, and no circle.
    let chain: String = (2..20_000).map(|id| components(id, &[id - 1])).collect();
    let deep = file(format!(r#"<object id="1">{TRIANGLE}</object>{chain}"#), 19_999);
    let error = read_bytes(&deep, None, None).unwrap_err();
    assert!(error.to_string().contains("more than 256 deep"), "{error}");
    // Two of two of two …, of a triangle or of nothing.
    for leaf in [TRIANGLE, ""] {
        let doubling: String = (2..60).map(|id| components(id, &[id - 1, id - 1])).collect();
        let bomb = file(format!(r#"<object id="1">{leaf}</object>{doubling}"#), 59);
        let (result, peak) = peak_of(|| read_bytes(&bomb, None, None));
        assert_is!(*result.unwrap_err().problem, FileProblem::TooLarge { .. });
        assert!(peak < 400 << 20, "{peak}");
    }
}

#[test]
fn a_zip_bomb_is_not_unpacked() {
    // 200 MB of vertices in little more than 1 MB.
    let mut model = format!("<model><resources><object id=\"1\">{TRIANGLE}</object><object id=\"2\"><mesh><vertices>");
    model.push_str(&"<vertex x=\"0\" y=\"0\" z=\"0\"/>".repeat(200 * 1024 * 1024 / 28));
    let bomb = zipped(&[("3D/3dmodel.model", model.as_bytes())]);
    drop(model);
    assert!(bomb.len() < 2 << 20, "{}", bomb.len());
    let (result, peak) = peak_of(|| read_bytes(&bomb, None, None));
    assert_is!(*result.unwrap_err().problem, FileProblem::TooLarge { what: "unpacked bytes", .. });
    assert!(peak < 256 << 20, "{peak}");
}

#[test]
fn entities_do_not_multiply() {
    let laughs = r#"<!DOCTYPE model [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>"#;
    let text =
        format!("{laughs}<model><resources><object id=\"1\" name=\"&b;\">{TRIANGLE}</object></resources></model>");
    let loaded = read_bytes(&zipped(&[("3D/3dmodel.model", text.as_bytes())]), None, None).unwrap();
    assert_eq!(loaded.parts[0].name, "&b;");
}

#[test]
fn gltf_of_empty_things_stays_small() {
    let document = |key: &str, thing: &str| {
        format!(r#"{{"asset":{{"version":"2.0"}},"{key}":[{}]}}"#, vec![thing; 100_000].join(","))
    };
    for key in ["nodes", "accessors", "meshes", "materials", "scenes"] {
        assert_is!(refuse(document(key, "{}"), Format::Gltf).1, FileProblem::TooLarge { .. });
    }
    assert_is!(refuse(document("nodes", r#"{"name":"a"}"#), Format::Gltf).1, FileProblem::NoTriangles);
}

#[test]
fn gltf_nodes_may_be_nested_without_end() {
    let chain: Vec<String> = (1..60_000).map(|n| format!(r#"{{"name":"n","children":[{n}]}}"#)).collect();
    let json = gltf(&[(r#"{"mesh":0}"#, &format!(r#"{},{{"mesh":0}}"#, chain.join(",")))]);
    assert_eq!(read_bytes(json.as_bytes(), None, None).unwrap().mesh.triangles.len(), 1);
}
