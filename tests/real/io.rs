//! The real meshes beside the project.

use meshwright::io::{Colours, Format, Loaded, Rgba, Unit, read};

use crate::common::proofs::{against_another_reader, assert_sound};
use crate::{Data, data};

impl Data {
    fn load(&self, name: &str) -> Loaded {
        let loaded = read(self.path(name)).unwrap_or_else(|error| panic!("{error}"));
        assert_sound(&loaded);
        loaded
    }

    /// File and faces of each row of the table beside the meshes.
    fn table(&self) -> Vec<(String, usize)> {
        let text = std::fs::read_to_string(self.path("README.md")).expect("the table is part of the data");
        let rows = text.lines().filter_map(|line| {
            let mut cells = line.split('|').map(str::trim).skip(1);
            let (name, faces) = (cells.next()?, cells.nth(1)?);
            Some((name.to_owned(), faces.parse().ok()?))
        });
        rows.collect()
    }
}

#[test]
fn every_real_mesh_has_its_faces() {
    let Some(data) = data() else { return };
    let rows = data.table();
    assert_eq!(rows.len(), 41);
    for (name, faces) in rows {
        let loaded = data.load(&name);
        assert_eq!(loaded.mesh.triangles.len(), faces, "{name}");
        let extension = name.rsplit('.').next().unwrap();
        assert_eq!(loaded.format.name(), extension.to_lowercase(), "{name}");
        // These name a file of materials that did not come with them.
        let library = match name.as_str() {
            "broken/wallhole.obj" => Some("00.mtl"),
            "broken/beetle.obj" => Some("VWBugMesh002.mtl"),
            "clean/quadknot.obj" => Some("./quadknot.obj.mtl"),
            _ => None,
        };
        let expected = library.map(|library| {
            format!(
                "the file of materials `{library}` left out: No such file or directory; names of materials and texture coordinates are kept"
            )
        });
        assert_eq!(loaded.warnings, Vec::from_iter(expected), "{name}");
    }
}

/// The colours of the triangles of a mesh that has one for each, with how many triangles have them.
fn tally(loaded: &Loaded) -> Vec<(Rgba, usize)> {
    let Some(Colours::Faces(colours)) = &loaded.colours else { panic!("{:?}", loaded.colours) };
    let mut tally = std::collections::BTreeMap::new();
    colours.iter().for_each(|colour| *tally.entry(*colour).or_insert(0) += 1);
    tally.into_iter().collect()
}

#[test]
fn real_meshes_have_their_colours() {
    let Some(data) = data() else { return };
    // All vertices are white, the faces are not.
    let counts = tally(&data.load("broken/cycloidal.ply"));
    assert_eq!(counts.len(), 7);
    assert!(counts.contains(&([191, 191, 191, 255], 12198)));
    // The colours are stated for the objects that hold the components.
    let loaded = data.load("broken/counterXP.3MF");
    let body = loaded.parts[0].triangles.len();
    let screws = loaded.mesh.triangles.len() - body;
    assert_eq!(tally(&loaded), [([0, 0, 0, 255], screws), ([0xca, 0xd1, 0xee, 255], body)]);
    // Materials; the textured parts are white.
    let loaded = data.load("broken/CesiumMilkTruck.glb");
    let shown = meshwright::io::shown_colours(loaded.colours.as_ref(), loaded.texture.as_ref());
    let shown = Loaded { colours: shown.map(std::borrow::Cow::into_owned), ..loaded };
    let colours: Vec<Rgba> = tally(&shown).into_iter().map(|(colour, _)| colour).collect();
    assert_eq!(colours, [[0, 57, 40, 255], [72, 72, 72, 255], [255; 4]]);
    assert_eq!(data.load("clean/fandisk.off").colours, None);
}

#[test]
fn stl_is_welded() {
    let Some(data) = data() else { return };
    let loaded = data.load("clean/65004.stl");
    // A closed surface of genus g has F/2 + 2 − 2g vertices.
    let (vertices, faces) = (loaded.mesh.positions.len(), loaded.mesh.triangles.len());
    assert_eq!((faces / 2 + 2 - vertices) % 2, 0);
    assert_eq!(loaded.mesh, loaded.mesh.welded());
}

#[test]
fn solids_objects_and_nodes_become_parts() {
    let Some(data) = data() else { return };
    let names = |name: &str| data.load(name).parts.into_iter().map(|p| p.name).collect::<Vec<_>>();
    assert_eq!(names("broken/multibody.stl"), ["bodyB", "bodyA"]);
    assert_eq!(names("broken/beetle.obj").len(), 1);
    // One body and five placed copies of a screw.
    let parts = names("broken/counterXP.3MF");
    assert_eq!(parts.len(), 6);
    assert_eq!(parts[0], "body418");
    assert!(names("broken/CesiumMilkTruck.glb").len() >= 3);
}

#[test]
fn units_are_read() {
    let Some(data) = data() else { return };
    assert_eq!(data.load("broken/counterXP.3MF").unit, Some(Unit::Millimetre));
    assert_eq!(data.load("broken/CesiumMilkTruck.glb").unit, Some(Unit::Metre));
    assert_eq!(data.load("broken/teapot.obj").unit, None);
}

#[test]
fn a_truck_stands_on_its_wheels() {
    let Some(data) = data() else { return };
    // With the node transforms the truck is about 5 m long, y is up, and both axles lie apart.
    let loaded = data.load("broken/CesiumMilkTruck.glb");
    let size = loaded.mesh.bounds().unwrap().size();
    assert!(size.x > 4.0 && size.x < 6.0 && size.y > 2.0 && size.y < 3.5, "{size}");
    let wheels: Vec<_> = loaded.parts.iter().filter(|p| p.name.contains("Wheels")).collect();
    assert_eq!(wheels.len(), 2);
    let centre = |range: &std::ops::Range<usize>| {
        let points = range.clone().flat_map(|t| loaded.mesh.corners(t));
        points.sum::<glam::DVec3>() / (3 * range.len()) as f64
    };
    assert!((centre(&wheels[0].triangles) - centre(&wheels[1].triangles)).length() > 2.0);
}

/// The reader against an independent one, on every OBJ file that both accept.
#[test]
fn obj_agrees_with_another_reader() {
    let Some(data) = data() else { return };
    let mut compared = 0;
    for (name, _) in data.table().into_iter().filter(|(name, _)| name.ends_with(".obj")) {
        let Some((same, ours, theirs)) = against_another_reader(&data.path(&name)) else { continue };
        // Concave polygons are cut better here, so the triangles may differ; their number may not.
        assert_eq!(ours, theirs, "{name}");
        assert!(same * 100 >= ours * 95, "{name}: {same} of {ours}");
        compared += 1;
    }
    assert!(compared >= 12, "{compared}");
}

#[test]
fn extension_is_not_needed() {
    let Some(data) = data() else { return };
    for (name, faces) in data.table() {
        let bytes = std::fs::read(data.path(&name)).unwrap();
        let loaded = meshwright::io::read_bytes(&bytes, None, None).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(loaded.mesh.triangles.len(), faces, "{name}");
        assert_ne!(loaded.format, Format::Gltf);
    }
}
