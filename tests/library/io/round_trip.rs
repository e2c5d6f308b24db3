//! Written and read again, a mesh is the same.

use glam::DVec3;
use meshwright::io::{Format, Unit, WriteOptions, WriteProblem, encode, read_bytes};
use meshwright::mesh::{IndexError, TriMesh};
use proptest::prelude::*;

use super::support::{assert_sound, corners, encoded, every_form, tetrahedron};

/// Any soup: shared, repeated and unused vertices, repeated corners.
fn soup(coordinate: impl Strategy<Value = f64> + Clone) -> impl Strategy<Value = TriMesh> {
    let points = prop::collection::vec([coordinate.clone(), coordinate.clone(), coordinate], 1..20);
    (points, prop::collection::vec(any::<[prop::sample::Index; 3]>(), 1..30)).prop_map(|(points, picks)| TriMesh {
        triangles: picks.iter().map(|t| t.map(|i| i.index(points.len()) as u32)).collect(),
        positions: points.into_iter().map(DVec3::from).collect(),
    })
}

fn single() -> impl Strategy<Value = f64> + Clone {
    let any = prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL | prop::num::f32::ZERO;
    prop_oneof![any, -100.0f32..100.0, (-9i8..9).prop_map(f32::from)].prop_map(f64::from)
}

fn double() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL | prop::num::f64::ZERO, -1.0f64..1.0]
}

/// The places to the last bit: −0 is not 0.
fn bits(mesh: &TriMesh) -> Vec<[u64; 3]> {
    mesh.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect()
}

proptest! {
    #[test]
    fn singles_survive_every_format(mesh in soup(single())) {
        for options in every_form() {
            let loaded = read_bytes(&encoded(&mesh, &options), None, None).unwrap();
            assert_sound(&loaded);
            prop_assert_eq!(loaded.format, options.format);
            prop_assert_eq!(&loaded.warnings, &Vec::<String>::new());
            prop_assert_eq!(corners(&loaded.mesh), corners(&mesh), "{:?}", options);
            if options.format != Format::Stl {
                prop_assert_eq!(&loaded.mesh, &mesh, "{:?}", options);
                prop_assert_eq!(bits(&loaded.mesh), bits(&mesh), "{:?}", options);
            }
        }
    }

    #[test]
    fn doubles_survive_where_the_format_holds_them(mesh in soup(double())) {
        for options in every_form() {
            match options.format {
                Format::Obj | Format::Off | Format::Ply | Format::ThreeMf => {
                    let bytes = encoded(&mesh, &options);
                    // An ASCII PLY of singles alone is told apart from one of doubles by its header.
                    let loaded = read_bytes(&bytes, None, None).unwrap();
                    prop_assert_eq!(&loaded.mesh, &mesh, "{:?}", options);
                    prop_assert_eq!(bits(&loaded.mesh), bits(&mesh), "{:?}", options);
                }
                Format::Stl | Format::Glb | Format::Gltf => {}
            }
        }
    }

    #[test]
    fn doubles_are_rounded_once(mesh in soup(-1e3f64..1e3)) {
        let rounded: Vec<_> = corners(&mesh).iter().map(|t| t.map(|p| p.as_vec3().as_dvec3())).collect();
        for format in [Format::Stl, Format::Glb, Format::Gltf] {
            let loaded = read_bytes(&encoded(&mesh, &WriteOptions::new(format)), None, None).unwrap();
            prop_assert_eq!(&corners(&loaded.mesh), &rounded, "{}", format);
        }
    }
}

#[test]
fn units_survive_where_the_format_holds_them() {
    for format in [Format::ThreeMf, Format::Glb, Format::Gltf] {
        for unit in Unit::ALL {
            let options = WriteOptions { unit: Some(unit), ..WriteOptions::new(format) };
            let loaded = read_bytes(&encoded(&tetrahedron(), &options), None, None).unwrap();
            // glTF is in metres.
            let (expected, factor) = if format == Format::ThreeMf { (unit, 1.0) } else { (Unit::Metre, unit.metres()) };
            assert_eq!((loaded.unit, options.unit_in_file()), (Some(expected), Some(expected)), "{format}");
            assert_eq!(options.factor(), factor);
            let scaled = tetrahedron().positions.iter().map(|p| *p * factor).collect();
            assert_eq!(loaded.mesh, TriMesh { positions: scaled, ..tetrahedron() }, "{format}");
        }
        let loaded = read_bytes(&encoded(&tetrahedron(), &WriteOptions::new(format)), None, None).unwrap();
        assert_eq!((loaded.unit, loaded.mesh), (WriteOptions::new(format).unit_in_file(), tetrahedron()), "{format}");
    }
}

#[test]
fn a_note_on_the_unit_counts_only_where_this_program_left_it() {
    let document = String::from_utf8(encoded(&tetrahedron(), &WriteOptions::new(Format::Gltf))).unwrap();
    for (generator, unit) in [("meshwright", Unit::Inch), ("another", Unit::Metre)] {
        let asset = format!("\"extras\":{{\"unit\":\"inch\"}},\"generator\":\"{generator}\"");
        let noted = document.replace("\"generator\":\"meshwright\"", &asset);
        assert_ne!(noted, document);
        let loaded = read_bytes(noted.as_bytes(), None, None).unwrap();
        assert_eq!((loaded.unit, loaded.mesh), (Some(unit), tetrahedron()), "{generator}");
    }
}

#[test]
fn the_same_mesh_gives_the_same_bytes() {
    for options in every_form() {
        assert_eq!(encoded(&tetrahedron(), &options), encoded(&tetrahedron(), &options), "{options:?}");
    }
}

#[test]
fn ply_takes_doubles_only_when_needed() {
    let header = |mesh: &TriMesh| {
        let bytes = encoded(mesh, &WriteOptions::new(Format::Ply));
        String::from_utf8_lossy(&bytes[..200]).into_owned()
    };
    let mut mesh = tetrahedron();
    assert!(header(&mesh).contains("property float x"));
    mesh.positions[3].x = 0.1;
    assert!(header(&mesh).contains("property double x"));
}

#[test]
fn what_no_format_holds_is_refused_before_a_byte() {
    let refuse = |mesh: &TriMesh, options: &WriteOptions| {
        let mut bytes = Vec::new();
        let error = encode(mesh, options, &mut bytes).expect_err("nothing that is not sound is written");
        assert!(bytes.is_empty());
        error.problem
    };
    for options in every_form() {
        assert!(matches!(refuse(&TriMesh::default(), &options), WriteProblem::NoTriangles));
        let mut mesh = tetrahedron();
        mesh.triangles[2] = [0, 1, 4];
        assert!(matches!(
            refuse(&mesh, &options),
            WriteProblem::Index(IndexError { triangle: 2, index: 4, vertices: 4 })
        ));
        let mut mesh = tetrahedron();
        mesh.positions[1].y = f64::NAN;
        assert!(matches!(refuse(&mesh, &options), WriteProblem::Coordinate { vertex: 1, .. }));
        let mut mesh = tetrahedron();
        mesh.positions[3].z = 1e39;
        let single = matches!(options.format, Format::Stl | Format::Glb | Format::Gltf);
        assert_eq!(encode(&mesh, &options, &mut Vec::new()).is_err(), single, "{options:?}");
    }
}
