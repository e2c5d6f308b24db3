//! Meshes made by hand: indices are checked, and coordinates that are no numbers do no harm.

use glam::DVec3;
use meshwright::mesh::{IndexError, TriMesh, ValidateOptions, validate};
use meshwright::pipeline::{BooleanError, Options, VoxelSize, repair};
use meshwright::progress::Progress;
use proptest::prelude::*;

use crate::common::shapes::torus;

proptest! {
    #[test]
    fn a_mesh_is_made_exactly_when_its_indices_are_in_range(
        vertices in 0usize..6,
        triangles in prop::collection::vec(prop::array::uniform3(0u32..7), 0..6),
    ) {
        let positions = vec![DVec3::ONE; vertices];
        let first = triangles.iter().position(|t| t.iter().any(|&v| v as usize >= vertices));
        match TriMesh::new(positions.clone(), triangles.clone()) {
            Ok(mesh) => {
                prop_assert_eq!(first, None);
                prop_assert_eq!(mesh.check(), Ok(()));
                prop_assert_eq!(mesh, TriMesh { positions, triangles });
            }
            Err(error) => {
                let IndexError { triangle, index, vertices: count } = error;
                prop_assert_eq!((Some(triangle), count), (first, vertices));
                prop_assert!(triangles[triangle].contains(&index) && index as usize >= vertices);
                prop_assert_eq!(TriMesh { positions, triangles }.check(), Err(error));
            }
        }
    }
}

#[test]
fn the_error_says_what_and_where() {
    let error = TriMesh::new(vec![DVec3::ZERO; 3], vec![[0, 1, 2], [2, 1, u32::MAX]]).unwrap_err();
    let expected =
        "triangle 1 refers to vertex 4294967295, which is not there: the mesh has 3 vertices, numbered from 0";
    assert_eq!(error.to_string(), expected);
    assert!(TriMesh::new(Vec::new(), Vec::new()).is_ok());
}

#[test]
fn a_triangle_at_coordinates_that_are_no_numbers_is_named() {
    let sound = torus(32, 16);
    let options = Options::new(VoxelSize::Length(0.1));
    for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut mesh = sound.clone();
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([DVec3::new(odd, 0.0, 0.0), DVec3::splat(odd)]);
        mesh.triangles.extend([[0, 1, first], [first, first + 1, 2]]);
        assert_eq!(mesh.check(), Ok(()));
        let look = ValidateOptions { self_intersections: true, weld: false };
        let validity = validate(&mesh, &look, &Progress::none()).expect("not stopped");
        assert!(validity.volume.is_nan() && !validity.is_valid(), "{odd}: {:?}", validity.problems());
        let refused = repair(&mesh, &options, &Progress::none()).map(|outcome| outcome.solid);
        let expected = BooleanError::NotFinite { operand: 0, triangle: sound.triangles.len() };
        assert_eq!(refused.map_err(|error| error.to_string()), Err(expected.to_string()), "{odd}");
    }
}
