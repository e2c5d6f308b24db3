//! The front door: paths of any kind, formats from names, errors that say what, where and what to try.

use std::fs;
use std::path::PathBuf;

use glam::DVec3;
use meshwright::io::{
    Colours, FileFormat, FileProblem, Format, GridFormat, Loaded, Location, Paint, Unit, WriteOptions, WriteProblem,
    read, read_as, read_bytes, read_grid_bytes, write, write_painted, write_with,
};
use meshwright::mesh::{TriMesh, validate};
use meshwright::progress::Progress;

use super::support::{corners, encoded, tetrahedron};
use crate::common::textured;

#[test]
fn paths_are_of_any_kind_and_names_tell_the_format() {
    let folder = tempfile::tempdir().unwrap();
    for format in Format::ALL {
        let path: PathBuf = folder.path().join(format!("mesh.{}", format.name().to_uppercase()));
        write(&path, &tetrahedron()).unwrap();
        let as_text: &str = path.to_str().unwrap();
        let loaded = read(as_text).unwrap();
        assert_eq!((loaded.format, loaded.warnings.len()), (format, 0));
        assert_eq!(corners(&loaded.mesh), corners(&tetrahedron()), "{format}");
        assert_eq!(read(as_text.to_owned()).unwrap(), read(&path).unwrap());
        assert_eq!(read_as(&path, format).unwrap().format, format);
    }
    let path = folder.path().join("mesh.backup");
    write_with(&path, &tetrahedron(), &WriteOptions::new(Format::Off)).unwrap();
    assert_eq!(read(path).unwrap().format, Format::Off);
}

#[test]
fn a_name_without_a_format_is_a_typed_error() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["mesh", "mesh.docx", "mesh.vti", ".stl"] {
        let path = folder.path().join(name);
        let error = write(&path, &tetrahedron()).unwrap_err();
        assert!(matches!(error.problem, WriteProblem::UnknownFormat { .. }), "{error}");
        assert!(error.to_string().contains("the name does not tell a format that holds a mesh"), "{error}");
        assert!(error.hint().unwrap().contains(".3mf"));
        assert_eq!(error.path, Some(path));
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    assert_eq!(FileFormat::from_path("a.VTI"), Some(FileFormat::Grid(GridFormat::Vti)));
    assert_eq!("3mf".parse(), Ok(FileFormat::Mesh(Format::ThreeMf)));
    assert!("doc".parse::<FileFormat>().unwrap_err().to_string().contains("for lattices vti, nrrd, npy or vdb"));
}

#[test]
fn errors_say_what_where_and_what_to_try() {
    let mesh = |bytes: &[u8], name: &str| {
        let error = read_bytes(bytes, None, Some(name.as_ref())).expect_err(name);
        (error.to_string(), error.hint(), error.format)
    };
    let said = |text: &str| text.to_owned();
    assert_eq!(
        mesh(b"%PDF-1.7 and more", "a.stl"),
        (
            said("a.stl: the file holds a PDF document"),
            Some("export the model as STL, OBJ, PLY, OFF, glTF or 3MF in the program it comes from"),
            Some(Format::Stl.into())
        )
    );
    assert_eq!(
        mesh(b"who knows", "a.doc"),
        (
            said("a.doc: is no mesh file known here (STL, OBJ, PLY, OFF, glTF, GLB, 3MF)"),
            Some("name the format if it is one of these"),
            None
        )
    );
    assert_eq!(
        mesh(b"v 0 0 0\nv 1 0 0\n", "a.obj"),
        (
            said("a.obj: a point cloud: the file holds 2 points and no face"),
            Some("a program that lays a surface through points must come first"),
            Some(Format::Obj.into())
        )
    );
    let (text, hint, _) = mesh(b"OFF\n4 4 0\n0 0 0\n", "a.off");
    assert!(text.starts_with("a.off: line 3: the file is cut short: "), "{text}");
    assert_eq!(hint, Some("load the file down, or export it, once more"));
    let (text, hint, _) = mesh(b"v 0 0 0\nf 1 x 2\n", "a.obj");
    assert_eq!((text.as_str(), hint), ("a.obj: line 2: a vertex number expected, found `x`", None));
    // Lattices have the same error.
    let error = read_grid_bytes(b"NRRD0005\ntype: flot\n", None, Some("a.nrrd".as_ref())).unwrap_err();
    assert_eq!(error.format, Some(GridFormat::Nrrd.into()));
    assert!(error.to_string().starts_with("a.nrrd: "), "{error}");
    let error = read_grid_bytes(b"NRRD0005\nno field at all\n", None, Some("a.nrrd".as_ref())).unwrap_err();
    assert!(matches!(error.location, Some(Location::Line(2))), "{error}");
    let error = read_grid_bytes(b"who knows", None, None).unwrap_err();
    assert_eq!(error.to_string(), "input: is no file of a lattice known here (VTI, NRRD, NPY, VDB)");
}

#[test]
fn a_name_that_lies_is_a_warning_of_the_reader() {
    let stl = encoded(&tetrahedron(), &WriteOptions::new(Format::Stl));
    let warnings = |format, name: &str| read_bytes(&stl, format, Some(name.as_ref())).unwrap().warnings;
    assert_eq!(warnings(None, "a.obj"), ["named as obj, and read as stl, which it is"]);
    assert!(warnings(Some(Format::Stl), "a.obj").is_empty() && warnings(None, "a.txt").is_empty());
}

/// A square of two triangles of two materials, beside which `library` lies.
fn square(library: &[u8]) -> Loaded {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    fs::write(folder.path().join("a.mtl"), library).unwrap();
    let obj =
        b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl caf\xe9 \nf 1 3 4\nusemtl no\n";
    fs::write(&path, obj).unwrap();
    read(path).unwrap()
}

fn shown(library: &[u8]) -> Option<Colours> {
    square(library).shown_colours().map(std::borrow::Cow::into_owned)
}

#[test]
fn materials_of_obj_colour_their_faces() {
    const WHITE: [u8; 4] = [255; 4];
    let faces = |first, second| Some(Colours::Faces(vec![first, second]));
    assert_eq!(
        shown(b"newmtl red\nKd 1 0 0\nnewmtl caf\xe9\nKd 0 0.5 1\nd 0.2\n"),
        faces([255, 0, 0, 255], [0, 128, 255, 51])
    );
    // What is described twice counts once, the first time; the last statement within it counts.
    let twice = b"newmtl red\nKd 0 1 0\nKd 0 0 1\nd 1\nTr 0.8\nnewmtl red\nKd 1 1 0\n";
    assert_eq!(shown(twice), faces([0, 0, 255, 51], WHITE));
    assert_eq!(shown(b"newmtl red\nTr 0.8\nd 1\nKd 0 0 1\n"), faces([0, 0, 255, 255], WHITE));
    // Nothing that is wrong with one statement touches the others.
    for wrong in ["Kd 0.5", "Kd", "Kd nan 0 0", "Kd spectral a.rfl", "Ns much", "illum", "Ka 1", "map_Kd", "d", "d inf"]
    {
        let library =
            format!("{wrong}\nnewmtl red\n{wrong}\nKd 1 0 0 # red\n{wrong}\nnewmtl\nKd 0 0 0\nnewmtl other\n");
        assert_eq!(shown(library.as_bytes()), faces([255, 0, 0, 255], WHITE), "{wrong}");
    }
    assert_eq!(shown(b"\xff\xfe\x00"), None);
}

#[test]
fn colours_of_materials_come_through_the_formats() {
    let loaded = square(b"newmtl red\nKd 1 0 0\nnewmtl caf\xe9\nKd 0 0 1\n");
    let folder = tempfile::tempdir().unwrap();
    for format in [Format::Obj, Format::Ply, Format::Off, Format::Glb, Format::Gltf, Format::ThreeMf] {
        let path = folder.path().join(format!("out.{format}"));
        write_painted(&path, &loaded.mesh, &loaded.paint(), &WriteOptions::new(format)).unwrap();
        let read = read(&path).unwrap();
        let colours = read.shown_colours().unwrap();
        assert_eq!(colours.corners(&read.mesh, 0), [[255, 0, 0, 255]; 3], "{format}");
        assert_eq!(colours.corners(&read.mesh, 1), [[0, 0, 255, 255]; 3], "{format}");
    }
    assert!(folder.path().join("out.mtl").exists());
    let lost = |format| loaded.paint().lost_in(format, &loaded.mesh, true);
    assert_eq!(lost(Format::Stl), ["stl holds no materials; they are left out"]);
    assert_eq!(lost(Format::ThreeMf), [""; 0]);
}

#[test]
fn files_beside_a_mesh_are_written_with_it_and_replace_no_input() {
    let folder = tempfile::tempdir().unwrap();
    let (mesh, at) = (tetrahedron(), |name: &str| folder.path().join(name));
    let texture = textured::of_sides(&mesh, [textured::png([1, 2, 3]), textured::jpeg()]);
    let paint = Paint { texture: Some(&texture), ..Paint::default() };
    let options = WriteOptions::new(Format::Obj);
    write_painted(at("a.obj"), &mesh, &paint, &options).unwrap();
    let loaded = read(at("a.obj")).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    let images = &loaded.texture.as_ref().unwrap().images;
    assert!(images.len() == 2 && images.iter().all(|image| !image.bytes.is_empty()));
    // The same again changes nothing.
    write_painted(at("a.obj"), &loaded.mesh, &loaded.paint(), &options).unwrap();
    // Other materials under the names of those that were read: the input would be lost.
    let mut other = loaded.clone();
    other.texture.as_mut().unwrap().materials[0].colour = Some([1, 2, 3, 255]);
    let before = fs::read(at("a.mtl")).unwrap();
    let error = write_painted(at("a.obj"), &other.mesh, &other.paint(), &options).unwrap_err();
    assert!(matches!(&error.problem, WriteProblem::TextureInUse { file } if *file == at("a.mtl")), "{error}");
    assert_eq!(fs::read(at("a.mtl")).unwrap(), before);
    write_painted(at("b.obj"), &other.mesh, &other.paint(), &options).unwrap();
    // A mesh that is refused leaves no files beside.
    let bad = TriMesh { triangles: vec![[0, 1, 9]; 4], ..mesh };
    assert!(write_painted(at("c.obj"), &bad, &paint, &options).is_err());
    let names = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    assert!(names.into_iter().all(|name| !name.starts_with('c')));
}

#[test]
fn meshes_with_repeated_vertices_are_judged_by_their_places() {
    // Each triangle has vertices of its own, as glTF has it where normals differ.
    let mesh = tetrahedron();
    let positions: Vec<DVec3> = mesh.triangles.iter().flatten().map(|&v| mesh.positions[v as usize]).collect();
    let apart = TriMesh::new(positions, (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap();
    for format in Format::ALL {
        let loaded = read_bytes(&encoded(&apart, &WriteOptions::new(format)), None, None).unwrap();
        let validity = validate(&loaded.mesh, &loaded.validate_options(), &Progress::none()).unwrap();
        assert_eq!(validity.is_valid(), format.repeats_vertices(), "{format}");
    }
    let mut loaded = read_bytes(&encoded(&apart, &WriteOptions::new(Format::Glb)), None, None).unwrap();
    let colours: Vec<[u8; 4]> = (0..12).map(|v| [v / 3, v % 3, 0, 255]).collect();
    loaded.colours = Some(Colours::Vertices(colours));
    let before: Vec<_> = (0..4).map(|t| loaded.colours.as_ref().unwrap().corners(&loaded.mesh, t)).collect();
    loaded.weld();
    assert_eq!(loaded.mesh.positions.len(), 4);
    let after: Vec<_> = (0..4).map(|t| loaded.colours.as_ref().unwrap().corners(&loaded.mesh, t)).collect();
    assert_eq!(after, before);
}

#[test]
fn units_are_brought_together() {
    let options = WriteOptions { unit: Some(Unit::Inch), ..WriteOptions::new(Format::ThreeMf) };
    let mut loaded = read_bytes(&encoded(&tetrahedron(), &options), None, None).unwrap();
    assert_eq!(loaded.unit, Some(Unit::Inch));
    let factor = loaded.rescale(Unit::Inch, Unit::Millimetre);
    assert!((factor - 25.4).abs() < 1e-12 && loaded.unit == Some(Unit::Millimetre));
    assert_eq!(loaded.mesh.positions[1], DVec3::X * factor);
    assert_eq!(loaded.rescale(Unit::Millimetre, Unit::Millimetre), 1.0);
    assert_eq!(loaded.mesh.positions[1], DVec3::X * factor);
}

#[test]
fn a_problem_of_the_system_has_the_path() {
    let error = read("absent/file.obj").unwrap_err();
    assert!(matches!(*error.problem, FileProblem::Io(_)) && error.path == Some("absent/file.obj".into()));
    assert!(std::error::Error::source(&error).is_some() && error.hint().is_none());
}
