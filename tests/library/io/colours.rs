//! Colours in and out.

use glam::DVec3;
use meshwright::io::{
    Carried, Colours, FileProblem, Format, Loaded, Rgba, WriteOptions, WriteProblem, encode_coloured, read_bytes,
};
use meshwright::mesh::TriMesh;
use proptest::prelude::*;

use super::support::{assert_sound, corner_colours, corners, encoded_in_colour, every_form, tetrahedron, zipped};

fn load(bytes: impl AsRef<[u8]>, format: Format) -> Loaded {
    let loaded = read_bytes(bytes.as_ref(), Some(format), None).unwrap_or_else(|error| panic!("{error}"));
    assert_sound(&loaded);
    loaded
}

fn seed(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/fuzz/seeds/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// A mesh with shared, repeated and unused vertices, and colours of any kind. Few different ones, so that neighbours often have the same.
fn painted() -> impl Strategy<Value = (TriMesh, Colours)> {
    let level = prop_oneof![Just(0u8), Just(1), Just(254), Just(255), any::<u8>()];
    let alpha = prop_oneof![3 => Just(255u8), 1 => any::<u8>()];
    let colour = (prop::array::uniform3(level), alpha).prop_map(|([r, g, b], a)| [r, g, b, a]);
    let palette = prop::collection::vec(colour, 1..4);
    let picks = prop::collection::vec(any::<[prop::sample::Index; 3]>(), 1..20);
    let paint = prop::collection::vec(any::<[prop::sample::Index; 3]>(), 20);
    (1..12usize, picks, palette, paint, 0..3).prop_map(|(points, picks, palette, paint, kind)| {
        let mesh = TriMesh {
            positions: (0..points).map(|i| DVec3::new(i as f64, (i * i) as f64, 0.5)).collect(),
            triangles: picks.iter().map(|t| t.map(|i| i.index(points) as u32)).collect(),
        };
        let corners = paint.iter().map(|t| t.map(|i| palette[i.index(palette.len())]));
        let colours = match kind {
            0 => Colours::Faces(corners.take(picks.len()).map(|c| c[0]).collect()),
            1 => Colours::Vertices(corners.take(points).map(|c| c[0]).collect()),
            _ => Colours::Corners(corners.take(picks.len()).collect()),
        };
        (mesh, colours)
    })
}

proptest! {
    #[test]
    fn colours_survive_where_the_format_holds_them((mesh, colours) in painted()) {
        for options in every_form() {
            let bytes = encoded_in_colour(&mesh, &colours, &options);
            prop_assert_eq!(&bytes, &encoded_in_colour(&mesh, &colours, &options), "{:?}", options);
            let loaded = load(&bytes, options.format);
            prop_assert_eq!(corners(&loaded.mesh), corners(&mesh), "{:?}", options);
            prop_assert_eq!(&loaded.warnings, &Vec::<String>::new(), "{:?}", options);
            // Only glTF repeats vertices for the sake of colours.
            if !matches!(options.format, Format::Stl | Format::Glb | Format::Gltf) {
                prop_assert_eq!(&loaded.mesh, &mesh, "{:?}", options);
            }
            let found = loaded.colours.as_ref().map(|colours| corner_colours(&loaded.mesh, colours));
            match colours.carried_by(options.format, &mesh) {
                Carried::Wholly => prop_assert_eq!(found, Some(corner_colours(&mesh, &colours)), "{:?}", options),
                Carried::Roughly => prop_assert!(found.is_some(), "{:?}", options),
                Carried::Not => prop_assert_eq!(found, None, "{:?}", options),
            }
        }
    }

    /// What one format made of colours, no other changes.
    #[test]
    fn colours_survive_a_journey((mesh, colours) in painted()) {
        let forms = [Format::ThreeMf, Format::Glb, Format::Ply, Format::Gltf, Format::Off, Format::ThreeMf];
        let mut loaded = load(encoded_in_colour(&mesh, &colours, &WriteOptions::new(forms[0])), forms[0]);
        for format in &forms[1..] {
            let colours = loaded.colours.clone().unwrap();
            let next = load(encoded_in_colour(&loaded.mesh, &colours, &WriteOptions::new(*format)), *format);
            if colours.carried_by(*format, &loaded.mesh) == Carried::Wholly {
                prop_assert_eq!(
                    corner_colours(&next.mesh, next.colours.as_ref().unwrap()),
                    corner_colours(&loaded.mesh, &colours),
                    "{}", format
                );
            }
            loaded = next;
        }
    }
}

/// Every level of every channel through every format, by itself and not by chance.
#[test]
fn all_256_levels_survive() {
    let mesh =
        TriMesh { positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y], triangles: (0..256).map(|_| [0, 1, 2]).collect() };
    let faces: Vec<Rgba> = (0..=255u8).map(|i| [i, 255 - i, i ^ 0x55, i.wrapping_mul(3)]).collect();
    let colours = Colours::Faces(faces);
    for options in every_form().iter().filter(|o| !matches!(o.format, Format::Stl | Format::Obj)) {
        let loaded = load(encoded_in_colour(&mesh, &colours, options), options.format);
        assert_eq!(loaded.colours.map(|c| corner_colours(&loaded.mesh, &c)), Some(corner_colours(&mesh, &colours)));
    }
    let mesh = TriMesh { positions: vec![DVec3::ZERO; 256], triangles: (0..254).map(|i| [i, i + 1, i + 2]).collect() };
    let colours = Colours::Vertices((0..=255).map(|i| [i, 255 - i, i ^ 0x55, 255]).collect());
    let loaded = load(encoded_in_colour(&mesh, &colours, &WriteOptions::new(Format::Obj)), Format::Obj);
    assert_eq!(loaded.colours, Some(colours));
}

#[test]
fn colours_that_do_not_fit_are_refused() {
    for (colours, expected) in [
        (Colours::Faces(vec![[0; 4]; 3]), 4),
        (Colours::Vertices(vec![[0; 4]; 5]), 4),
        (Colours::Corners(Vec::new()), 4),
    ] {
        for options in every_form() {
            let mut bytes = Vec::new();
            let error = encode_coloured(&tetrahedron(), Some(&colours), &options, &mut bytes).unwrap_err();
            assert!(matches!(error.problem, WriteProblem::Colours { expected: e, .. } if e == expected), "{error}");
            assert!(bytes.is_empty());
        }
    }
}

fn ply(encoding: &str, kind: &str, channels: &str, rows: &[&[u8]]) -> Vec<u8> {
    let channels: String = channels.split(' ').map(|name| format!("property {kind} {name}\n")).collect();
    let mut bytes = format!(
        "ply\nformat {encoding} 1.0\nelement vertex 3\nproperty char x\nproperty char y\nproperty char z\n{channels}\
         element face 1\nproperty list uchar char vertex_index\nend_header\n"
    )
    .into_bytes();
    rows.iter().for_each(|row| bytes.extend_from_slice(row));
    bytes
}

#[test]
fn ply_takes_bytes_shorts_and_floats_in_every_encoding() {
    let vertices = |loaded: &Loaded| match &loaded.colours {
        Some(Colours::Vertices(colours)) => colours.clone(),
        other => panic!("{other:?}"),
    };
    let expected = [[0, 128, 255, 255], [255, 1, 0, 255], [3, 2, 1, 255]];
    let text = |rows: [&str; 3]| format!("0 0 0 {}\n1 0 0 {}\n0 1 0 {}\n3 0 1 2\n", rows[0], rows[1], rows[2]);
    for (kind, rows) in [
        ("uchar", ["0 128 255", "255 1 0", "3 2 1"]),
        ("int", ["0 128 255", "255 1 0", "3 2 1"]),
        ("ushort", ["0 32896 65535", "65535 257 0", "771 514 257"]),
        ("float", ["0 0.5 1", "1 0.004 0", "0.0118 0.0078 0.0039"]),
        // Floats that count to 255.
        ("double", ["0 128 255", "255 1 0", "3 2 1"]),
    ] {
        let loaded = load(ply("ascii", kind, "red green blue", &[text(rows).as_bytes()]), Format::Ply);
        assert_eq!(vertices(&loaded), expected, "{kind}");
        assert_eq!(loaded.warnings, Vec::<String>::new());
    }
    let tail: &[u8] = &[3, 0, 1, 2];
    let points: [&[u8]; 3] = [&[0, 0, 0], &[1, 0, 0], &[0, 1, 0]];
    for (encoding, pack) in [
        ("binary_little_endian", u16::to_le_bytes as fn(u16) -> [u8; 2]),
        ("binary_big_endian", u16::to_be_bytes as fn(u16) -> [u8; 2]),
    ] {
        // Blue first, and alpha before it.
        let rows: Vec<Vec<u8>> = points
            .iter()
            .zip(expected)
            .map(|(p, [r, g, b, a])| {
                let shorts = [a, b, g, r].into_iter().flat_map(|level| pack(u16::from(level) * 257));
                p.iter().copied().chain(shorts).collect()
            })
            .collect();
        let rows: Vec<&[u8]> = rows.iter().map(Vec::as_slice).chain([tail]).collect();
        assert_eq!(vertices(&load(ply(encoding, "ushort", "alpha blue green red", &rows), Format::Ply)), expected);
    }
}

#[test]
fn ply_polygons_colour_all_their_triangles() {
    let loaded = load(seed("ply/colours.ply"), Format::Ply);
    let vertices = vec![[0, 128, 255, 255], [255, 128, 0, 255], [0, 0, 0, 64], [51, 102, 153, 255]];
    assert_eq!(loaded.colours, Some(Colours::Vertices(vertices)));
    assert_eq!(loaded.warnings, ["the colours of the faces left out; the vertices have colours too"]);
    let faces =
        String::from_utf8(seed("ply/colours.ply")).unwrap().replace("property float red", "property float dull");
    let loaded = load(faces, Format::Ply);
    let quad = [255, 0, 1, 255];
    assert_eq!(loaded.colours, Some(Colours::Faces(vec![quad, quad, [0, 128, 2, 255]])));
    assert_eq!(loaded.warnings, Vec::<String>::new());
}

#[test]
fn ply_colours_that_make_no_sense() {
    let body = b"0 0 0 nan 0 300\n1 0 0 -5 7 0\n0 1 0 1 2 3\n3 0 1 2\n";
    let loaded = load(ply("ascii", "uchar", "red green blue", &[body]), Format::Ply);
    assert_eq!(loaded.colours, Some(Colours::Vertices(vec![[0, 0, 255, 255], [0, 7, 0, 255], [1, 2, 3, 255]])));
    assert_eq!(loaded.warnings, ["2 colours out of range taken as the nearest in range"]);
    let error = read_bytes(&ply("ascii", "uchar", "red green blue", &[b"0 0 0 1 red 3\n"]), None, None).unwrap_err();
    assert!(matches!(*error.problem, FileProblem::Syntax { .. } | FileProblem::Truncated { .. }), "{error}");
    // Two of three are none.
    let body = b"0 0 0 1 2\n1 0 0 1 2\n0 1 0 1 2\n3 0 1 2\n";
    assert_eq!(load(ply("ascii", "uchar", "red green", &[body]), Format::Ply).colours, None);
    let mixed = String::from_utf8(ply(
        "ascii",
        "uchar",
        "red green blue",
        &[b"0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n"],
    ));
    let loaded = load(mixed.unwrap().replace("uchar blue", "float blue"), Format::Ply);
    assert_eq!(loaded.colours, None);
    assert_eq!(loaded.warnings, ["the colours of `vertex` left out; their channels differ in type"]);
}

#[test]
fn gltf_multiplies_colours_and_materials() {
    let loaded = load(seed("gltf/colours.gltf"), Format::Gltf);
    // The node mirrors, so triangles are turned back, and their colours with them.
    assert_eq!(loaded.mesh.triangles, [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
    let (red, green, blue) = ([255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]);
    let half = 188;
    let expected = vec![
        [red, green, blue],
        [[half, 255, 255, 128], [0, 0, 0, 128], [half, 255, 255, 64]],
        // Without blending alpha does not count.
        [[0, half, 255, 255]; 3],
        // A texture and no colour.
        [[255; 4]; 3],
    ];
    assert_eq!(loaded.colours, Some(Colours::Corners(expected)));
    assert_eq!(
        loaded.warnings,
        [
            "the image `absent.png` left out: it lies in another file, which a stream does not give; texture coordinates are kept"
        ]
    );
    assert_eq!(load(seed("glb/colours.glb"), Format::Glb).colours, loaded.colours);
}

#[test]
fn gltf_colours_that_lie() {
    let original = String::from_utf8(seed("gltf/colours.gltf")).unwrap();
    let compact: String = original.split_whitespace().collect();
    let refuse = |from: &str, to: &str| {
        assert!(compact.contains(from), "{from}");
        let error = read_bytes(compact.replacen(from, to, 1).as_bytes(), None, None).unwrap_err();
        (error.location.as_ref().map(ToString::to_string).unwrap_or_default(), *error.problem)
    };
    let (place, problem) = refuse(r#""COLOR_0":1"#, r#""COLOR_0":9"#);
    assert!(matches!((place.as_str(), problem), ("meshes[0]", FileProblem::IndexOutOfRange { .. })));
    let (place, problem) = refuse(r#""COLOR_0":1"#, r#""COLOR_0":3"#);
    assert!(matches!((place.as_str(), problem), ("accessors[3]", FileProblem::Syntax { .. })));
    let (place, problem) = refuse(r#""normalized":true,"count":4"#, r#""normalized":true,"count":2"#);
    assert!(matches!((place.as_str(), problem), ("accessors[1]", FileProblem::Truncated { .. })));
    let (place, problem) = refuse(r#""normalized":true,"count":4"#, r#""count":18446744073709551615"#);
    assert!(matches!((place.as_str(), problem), ("accessors[1]", FileProblem::TooLarge { .. })));
    let (place, problem) = refuse(r#""material":0"#, r#""material":7"#);
    assert!(matches!((place.as_str(), problem), ("meshes[0]", FileProblem::IndexOutOfRange { .. })));
}

fn model(text: &[u8]) -> Vec<u8> {
    zipped(&[("3D/3dmodel.model", text)])
}

#[test]
fn three_mf_takes_colours_and_materials() {
    let loaded = load(model(&seed("three_mf/colours.model")), Format::ThreeMf);
    let glass = [0, 0, 255, 128];
    let (leaf, red, dark) = ([0, 255, 0, 255], [255, 0, 0, 255], [1, 2, 3, 255]);
    let expected = vec![
        // The object's default, an entry of the object's group, three of another group, a texture.
        [glass; 3],
        [leaf; 3],
        [red, dark, dark],
        [[255; 4]; 3],
        // The default of the components' object, then nothing.
        [dark; 3],
        [[255; 4]; 3],
        [glass; 3],
        [leaf; 3],
        // Mirrored: the triangle is turned back, and its colours with it.
        [red, dark, dark],
        [[255; 4]; 3],
    ];
    assert_eq!(loaded.mesh.triangles[8], [8 + 4, 8 + 6, 8 + 5].map(|v| v - 1));
    assert_eq!(loaded.colours, Some(Colours::Corners(expected)));
    assert_eq!(loaded.warnings, ["2 triangles with a texture or a material that has no colour; left out"]);
}

#[test]
fn three_mf_colours_that_lie() {
    let original = String::from_utf8(seed("three_mf/colours.model")).unwrap();
    let changed = |from: &str, to: &str| {
        assert!(original.contains(from), "{from}");
        read_bytes(&model(original.replacen(from, to, 1).as_bytes()), None, None)
    };
    for (from, to) in [
        ("#FF0000", "#FF00"),
        ("#FF0000", "FF0000"),
        ("#FF0000", "#FF00GG"),
        ("#00FF00", "#+1+1+1"),
        (" displaycolor=\"#00FF00\"", ""),
        ("p2=\"1\"", "p2=\"-1\""),
        ("pindex=\"1\"", "pindex=\"one\""),
        ("<m:colorgroup id=\"6\"", "<m:colorgroup"),
    ] {
        let error = changed(from, to).unwrap_err();
        assert!(error.to_string().contains("3D/3dmodel.model, byte"), "{error}");
        assert!(matches!(*error.problem, FileProblem::Syntax { .. }), "{error}");
    }
    // Entries and groups that are not there: the mesh is sound without them.
    for (from, to) in [("p2=\"1\"", "p2=\"2\""), ("pid=\"6\" p1", "pid=\"99\" p1")] {
        let loaded = changed(from, to).unwrap();
        assert_eq!(loaded.warnings, ["4 triangles with a texture or a material that has no colour; left out"]);
    }
}

#[test]
fn off_takes_colours_of_vertices_and_faces() {
    let body = "3 2 0\n0 0 0 TAIL\n1 0 0\n0 1 0 TAIL\n3 0 1 2 FACE\n3 0 2 1\n";
    let file = |keyword: &str, tail: &str, face: &str| {
        load(format!("{keyword}\n{}", body.replace("TAIL", tail).replace("FACE", face)), Format::Off).colours
    };
    let white = [255; 4];
    let vertices = |colour| Some(Colours::Vertices(vec![colour, white, colour]));
    assert_eq!(file("COFF", "10 20 30 40", ""), vertices([10, 20, 30, 40]));
    assert_eq!(file("COFF", "10 20 30", ""), vertices([10, 20, 30, 255]));
    assert_eq!(file("COFF", "0.0 0.5 1 1", ""), vertices([0, 128, 255, 255]));
    assert_eq!(file("COFF", "1 0 1 1", ""), vertices([1, 0, 1, 1]));
    assert_eq!(file("CNOFF", "0.6 0.8 0.5 10 20 30 40", ""), vertices([10, 20, 30, 40]));
    assert_eq!(file("STCNOFF", "0.6 0.8 0.5 10 20 30 40 0.5 0.5", ""), vertices([10, 20, 30, 40]));
    assert_eq!(file("STCOFF", "1 2 3 0.5 0.5", ""), vertices([1, 2, 3, 255]));
    // Not said to be colours, or not colours: passed over.
    assert_eq!(file("OFF", "10 20 30 40", ""), None);
    assert_eq!(file("NOFF", "10 20 30 40", ""), None);
    assert_eq!(file("COFF", "10 20", "7"), None);
    assert_eq!(file("COFF", "10 twenty 30", "1 2 three"), None);
    assert_eq!(file("COFF", "1 2 3 4 5 6 7 8 9 10", ""), None);
    let faces = |colour| Some(Colours::Faces(vec![colour, white]));
    assert_eq!(file("OFF", "", "9 8 7"), faces([9, 8, 7, 255]));
    assert_eq!(file("OFF", "", "0.2 0.4 0.6 0.8"), faces([51, 102, 153, 204]));
}

#[test]
fn obj_takes_a_colour_after_the_position() {
    let loaded = load(seed("obj/colours.obj"), Format::Obj);
    let expected = vec![[255, 0, 128, 255], [128, 255, 0, 255], [255; 4], [0, 0, 0, 255]];
    assert_eq!(loaded.colours, Some(Colours::Vertices(expected)));
    for other in ["v 0 0 0 1", "v 0 0 0 1 2", "v 0 0 0 1 2 3 4", "v 0 0 0 1 2 x", "v 0 0 0 # 1 2 3"] {
        let text = format!("{other}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        assert_eq!(load(text, Format::Obj).colours, None, "{other}");
    }
    let bytes = load("v 0 0 0 255 128 0\nv 1 0 0 0 0 1\nv 0 1 0 9 9 9\nf 1 2 3\n", Format::Obj).colours;
    let expected = vec![[255, 128, 0, 255], [0, 0, 1, 255], [9, 9, 9, 255]];
    assert_eq!(bytes, Some(Colours::Vertices(expected)));
}

/// A header may promise colours, but memory is taken for rows alone.
#[test]
fn colours_take_no_memory_that_the_file_does_not_justify() {
    let channels = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    let file = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
         property float z\n{channels}element face 4000000000\nproperty list uchar int vertex_indices\n{channels}end_header\n"
    );
    let (result, peak) = super::memory::peak_of(|| read_bytes(file.as_bytes(), None, None));
    assert!(matches!(*result.unwrap_err().problem, FileProblem::Truncated { .. }));
    assert!(peak < 1 << 20, "{peak}");
}
