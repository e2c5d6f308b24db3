//! Textures in and out.

use std::fs;

use glam::DVec3;
use meshwright::io::{
    Colours, Format, Material, Paint, TextureImage, TextureMap, WriteOptions, WriteProblem, encode_painted, read,
    read_bytes, shown_colours,
};
use meshwright::mesh::TriMesh;
use proptest::prelude::*;

use super::support::{assert_sound, corners, tetrahedron, zipped};
use crate::common::shapes::cuboid;
use crate::common::textured::{image, jpeg, load, of_sides, png, save};

/// The forms that hold textures, with a name for a file.
fn forms() -> Vec<(WriteOptions, String)> {
    let formats = [Format::Obj, Format::Ply, Format::Glb, Format::Gltf, Format::ThreeMf].map(WriteOptions::new);
    let ascii = WriteOptions { ascii: true, ..WriteOptions::new(Format::Ply) };
    let all = formats.into_iter().chain([ascii]).enumerate();
    all.map(|(n, options)| (options, format!("form {n}.{}", options.format))).collect()
}

/// A block with textures, to which triangles without an image, or without anything, are added.
fn block() -> (TriMesh, TextureMap) {
    let mut mesh = cuboid(DVec3::ZERO, DVec3::new(3.0, 2.0, 4.0));
    let mut texture = of_sides(&mesh, [png([200, 10, 20]), jpeg()]);
    mesh.append(&cuboid(DVec3::splat(8.0), DVec3::splat(9.0)));
    texture.materials.push(Material { name: "red lacquer".into(), colour: Some([255, 0, 51, 255]), image: None });
    for t in 12..24 {
        texture.coordinates.push(None);
        texture.material_of.push((t % 2 == 0).then_some(2));
    }
    (mesh, texture)
}

#[test]
fn every_format_hands_them_to_every_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mesh, texture) = block();
    for (first, name) in forms() {
        let path = folder.path().join(&name);
        save(&path, &mesh, &texture, &first);
        let between = load(&path);
        for (second, name) in forms() {
            let path = folder.path().join(format!("then {name}"));
            let own = between.texture.as_ref().expect("textures");
            save(&path, &between.mesh, own, &second);
            let after = load(&path);
            assert_sound(&after);
            let case = format!("{first:?} {second:?}");
            assert_eq!(corners(&after.mesh), corners(&mesh), "{case}");
            let found = after.texture.as_ref().expect("textures");
            assert!(found.fits(&after.mesh), "{case}");
            for t in 0..mesh.triangles.len() {
                // Sixteenths are exact, however they are counted.
                assert_eq!(found.at(t, false), texture.at(t, false), "{case}, triangle {t}");
                assert_eq!(image(found, t), image(&texture, t), "{case}, triangle {t}");
            }
            let holds_names = |format| matches!(format, Format::Obj | Format::Glb | Format::Gltf);
            if holds_names(first.format) && holds_names(second.format) {
                let named = |texture: &TextureMap, t| texture.material(t).map(|m| (m.name.replace(' ', "_"), m.colour));
                (0..24).for_each(|t| assert_eq!(named(found, t), named(&texture, t), "{case}, triangle {t}"));
            }
        }
    }
    // Colours of materials are not lost where there are no materials.
    let shown = shown_colours(None, Some(&texture)).expect("a red one").into_owned();
    for format in [Format::Ply, Format::ThreeMf, Format::Off] {
        let mut bytes = Vec::new();
        let paint = Paint { texture: Some(&texture), ..Paint::default() };
        encode_painted(&mesh, &paint, &WriteOptions::new(format), &mut bytes).expect("memory takes it");
        let found = read_bytes(&bytes, Some(format), None).expect("ours").colours;
        assert_eq!(found, Some(shown.clone()), "{format}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn any_coordinates_survive_to_the_last_bit(
        values in prop::collection::vec(prop_oneof![-2f32..2.0, any::<f32>().prop_filter("finite", |x| x.is_finite())], 24),
        downward in any::<bool>(), given in prop::collection::vec(any::<bool>(), 4),
    ) {
        let folder = tempfile::tempdir().expect("a folder");
        let mesh = tetrahedron();
        let one = |t: usize| given[t].then(|| [0, 2, 4].map(|k| [values[6 * t + k], values[6 * t + k + 1]]));
        let texture = TextureMap {
            coordinates: (0..4).map(one).collect(),
            material_of: given.iter().map(|given| given.then_some(0)).collect(),
            materials: vec![Material { name: "a".into(), colour: None, image: Some(0) }],
            images: vec![TextureImage { name: "a.png".into(), bytes: png([1, 2, 3]) }],
            downward,
            ..TextureMap::default()
        };
        for (options, name) in forms() {
            let path = folder.path().join(name);
            save(&path, &mesh, &texture, &options);
            let loaded = load(&path);
            let down = matches!(options.format, Format::Glb | Format::Gltf);
            for t in 0..4 {
                let found = loaded.texture.as_ref().and_then(|texture| texture.at(t, down));
                prop_assert_eq!(found, texture.at(t, down), "{:?}", options);
            }
        }
    }

    /// Coordinates that are the places themselves stay with their corners, however polygons are cut.
    #[test]
    fn corners_of_polygons_keep_their_own(radii in prop::collection::vec(0.1f64..1.0, 3..12), ahead in any::<bool>()) {
        let n = radii.len();
        let turn = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
        let places: Vec<[f32; 2]> =
            (0..n).map(|k| [(radii[k] * turn(k).cos()) as f32, (radii[k] * turn(k).sin()) as f32]).collect();
        let vertices: String = places.iter().map(|[x, y]| format!("v {x} {y} 1\n")).collect();
        // In another order than the vertices.
        let coordinates: String = places.iter().rev().map(|[x, y]| format!("vt {x} {y}\n")).collect();
        let face: String = (1..=n).map(|k| format!(" {k}/{}", n + 1 - k)).collect();
        let obj = match ahead {
            true => format!("v 0 0 0\nf{}\n{vertices}{coordinates}", (1..=n).map(|k| format!(" {}/{}", k + 1, n + 1 - k)).collect::<String>()),
            false => format!("{vertices}{coordinates}f{face}\n"),
        };
        let rows: String = places.iter().map(|[x, y]| format!("{x} {y} 1\n")).collect();
        let numbers: String = (0..n).map(|k| format!(" {k}")).collect();
        let pairs: String = places.iter().map(|[x, y]| format!(" {x} {y}")).collect();
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
             property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n{rows}{n}{numbers} {}{pairs}\n",
            2 * n
        );
        for (text, format) in [(obj, Format::Obj), (ply, Format::Ply)] {
            let loaded = read_bytes(text.as_bytes(), Some(format), None).expect("a polygon");
            prop_assert_eq!(loaded.mesh.triangles.len(), n - 2);
            let texture = loaded.texture.expect("coordinates");
            for t in 0..n - 2 {
                let wanted = loaded.mesh.corners(t).map(|p| p.truncate().as_vec2().to_array());
                prop_assert_eq!(texture.coordinates[t], Some(wanted));
            }
        }
    }
}

#[test]
fn what_is_missing_is_told_and_the_rest_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl wood\n\
               f 1/1 3/3 2/2\nf 1/1 2/2 4/3\nusemtl none\nf 2//1 3//2 4//1\nf 1/1 4/9 3/3\n";
    fs::write(at("a.obj"), obj).expect("written");
    let told = |words: &[&str]| {
        let loaded = read(at("a.obj")).expect("the mesh is sound");
        for word in words {
            assert!(loaded.warnings.iter().any(|w| w.contains(word)), "`{word}` is not in {:?}", loaded.warnings);
        }
        let texture = loaded.texture.expect("coordinates");
        assert_eq!(texture.coordinates[0], Some([[0.0, 0.0], [0.0, 1.0], [1.0, 0.0]]));
        assert_eq!((texture.coordinates[2], texture.coordinates[3]), (None, None));
        assert_eq!(texture.material_of, [Some(0), Some(0), None, None]);
        assert_eq!(texture.materials[0].name, "wood");
        texture
    };
    told(&["a.mtl", "1 triangle with texture coordinates that are not there"]);
    fs::write(at("a.mtl"), "newmtl wood\nKd 1 0.5 0\nd 0.4\nmap_Kd -s 2 2 1 sub\\my wood.png\nmap_Bump b.png\n")
        .expect("written");
    let texture = told(&["sub/my wood.png", "1 further texture", "1 texture shifted"]);
    assert_eq!(texture.materials[0].colour, Some([255, 128, 0, 102]));
    assert!(texture.images[0].bytes.is_empty());
    fs::create_dir(at("sub")).expect("made");
    fs::write(at("sub/my wood.png"), &png([9; 3])[..]).expect("written");
    let texture = told(&[]);
    assert_eq!((texture.images[0].name.as_str(), texture.images[0].bytes.clone()), ("my wood.png", png([9; 3])));
    assert_eq!(texture.files.len(), 2);
    // Without a place, as from a stream, the names are kept.
    let loaded = read_bytes(obj.as_bytes(), None, None).expect("the mesh is sound");
    assert!(loaded.warnings.iter().any(|w| w.contains("stream")), "{:?}", loaded.warnings);
    // Lists that do not fit are refused.
    let texture = TextureMap { coordinates: Vec::new(), ..texture };
    let paint = Paint { texture: Some(&texture), ..Paint::default() };
    let error = encode_painted(&tetrahedron(), &paint, &WriteOptions::new(Format::Obj), &mut Vec::new()).unwrap_err();
    assert!(matches!(error.problem, WriteProblem::Textures));
}

#[test]
fn nothing_outside_of_the_folder_is_read() {
    let outer = tempfile::tempdir().expect("a folder");
    let folder = outer.path().join("inner");
    fs::create_dir(&folder).expect("made");
    let secret = png([7; 3]);
    fs::write(outer.path().join("secret.png"), &secret[..]).expect("written");
    fs::write(outer.path().join("secret.mtl"), "newmtl m\nKd 1 0 0\n").expect("written");
    let absolute = outer.path().join("secret.png").display().to_string();
    let mut names = vec![
        "../secret.png".to_owned(),
        absolute,
        "x/../../secret.png".into(),
        "file:secret.png".into(),
        "..\\secret.png".into(),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../secret.png", folder.join("link.png")).expect("linked");
        std::os::unix::fs::symlink("/dev/zero", folder.join("endless.png")).expect("linked");
        names.extend(["link.png".to_owned(), "endless.png".into()]);
    }
    let faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3\n";
    for name in &names {
        fs::write(folder.join("a.mtl"), format!("newmtl m\nmap_Kd {name}\n")).expect("written");
        fs::write(folder.join("a.obj"), format!("mtllib a.mtl\n{faces}")).expect("written");
        let ply = format!(
            "ply\nformat ascii 1.0\ncomment TextureFile {name}\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
             0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n"
        );
        fs::write(folder.join("a.ply"), ply).expect("written");
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"material":0}}]}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},{{"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":24}}],
            "buffers":[{{"byteLength":60,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/"}}],
            "materials":[{{"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}],"textures":[{{"source":0}}],
            "images":[{{"uri":{}}}]}}"#,
            serde_json::to_string(name).expect("text")
        );
        fs::write(folder.join("a.gltf"), json).expect("written");
        for file in ["a.obj", "a.ply", "a.gltf"] {
            let loaded = read(folder.join(file)).unwrap_or_else(|e| panic!("{e}"));
            let texture = loaded.texture.as_ref().expect("coordinates");
            assert_eq!(texture.at(0, texture.downward), Some([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), "{file} {name}");
            assert!(texture.images[0].bytes.is_empty(), "{file} {name}");
            assert!(loaded.warnings.iter().any(|w| w.contains("left out")), "{file} {name}: {:?}", loaded.warnings);
            // Nor is anything written outside.
            for file in texture.side_files(Format::Obj, &folder.join("b.obj")) {
                assert!(!file.name.contains(['/', '\\']) && file.name.starts_with("b"), "{}", file.name);
            }
        }
    }
    fs::write(folder.join("a.obj"), format!("mtllib ../secret.mtl\n{faces}")).expect("written");
    let loaded = read(folder.join("a.obj")).expect("the mesh is sound");
    assert_eq!(loaded.texture.expect("coordinates").materials[0].colour, None);
    assert!(loaded.warnings.iter().any(|w| w.contains("secret.mtl")), "{:?}", loaded.warnings);
}

#[test]
fn packages_and_documents_of_others_are_read() {
    // A model with an image that is not there, one for an object, and a place that is not there.
    let model = r##"<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
      <resources><m:texture2d id="5" path="/3D/Texture/a.png" contenttype="image/png"/><m:texture2d id="6" path="/3D/none.png" contenttype="image/png"/>
      <m:texture2dgroup id="7" texid="5"><m:tex2coord u="0" v="0.25"/><m:tex2coord u="1" v="0"/><m:tex2coord u="0" v="1e0"/></m:texture2dgroup>
      <m:texture2dgroup id="8" texid="6"><m:tex2coord u="0.5" v="0.5"/></m:texture2dgroup>
      <object id="1" pid="8" pindex="0"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices>
      <triangles><triangle v1="0" v2="2" v3="1" pid="7" p1="0" p2="1" p3="2"/><triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3" pid="7" p1="9"/>
      <triangle v1="2" v2="0" v3="3"/></triangles></mesh></object></resources><build><item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/></build></model>"##;
    let bytes = zipped(&[("3D/3dmodel.model", model.as_bytes()), ("3D/Texture/a.png", &png([5; 3]))]);
    let loaded = read_bytes(&bytes, None, None).expect("a package");
    let texture = loaded.texture.as_ref().expect("textures");
    // Mirrored, so turned over.
    assert_eq!(texture.coordinates[0], Some([[0.0, 0.25], [0.0, 1.0], [1.0, 0.0]]));
    assert_eq!(texture.coordinates[1], Some([[0.5; 2]; 3]));
    assert_eq!(texture.coordinates[2], None);
    assert_eq!((image(texture, 0), image(texture, 1)), (Some(png([5; 3])), Some(Vec::new().into())));
    let told = |word: &str| assert!(loaded.warnings.iter().any(|w| w.contains(word)), "{word}: {:?}", loaded.warnings);
    told("none.png");
    told("1 triangle with a texture or a material that has no colour");
    assert_eq!(loaded.colours, None);
}

#[test]
fn colours_and_textures_go_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = cuboid(DVec3::ZERO, DVec3::ONE);
    let texture = of_sides(&mesh, [png([1; 3]), png([2; 3])]);
    let colours = Colours::Vertices((0..8).map(|v| [31 * v, 200, 9, 255]).collect());
    for format in [Format::Obj, Format::Ply, Format::Glb, Format::Gltf] {
        let path = folder.path().join(format!("a.{format}"));
        let paint = Paint { colours: Some(&colours), texture: Some(&texture), beside: Some(&path) };
        let mut bytes = Vec::new();
        encode_painted(&mesh, &paint, &WriteOptions::new(format), &mut bytes).expect("memory takes it");
        let loaded = read_bytes(&bytes, Some(format), Some(&path)).expect("ours");
        let found = loaded.colours.expect("colours");
        let found_textures = loaded.texture.expect("textures");
        for t in 0..12 {
            assert_eq!(found.corners(&loaded.mesh, t), colours.corners(&mesh, t), "{format}");
            assert_eq!(found_textures.at(t, false), texture.at(t, false), "{format}");
        }
    }
}
