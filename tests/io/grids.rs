//! Files of lattices: whole or not there.

use glam::DVec3;
use meshwright::io::{DistanceSamples, GridFormat, Unit, encode_grid, write_grid};

fn samples(plane: &(dyn Fn(usize, &mut Vec<f32>) + Sync)) -> DistanceSamples<'_> {
    let origin = DVec3::new(-1.0, 0.1, 1e-7);
    DistanceSamples { origin, spacing: 0.25, dims: [3, 2, 4], unit: Some(Unit::Inch), band: Some(1.5), plane }
}

fn number(z: usize, k: usize) -> f32 {
    (10 * z + k) as f32 - 7.5
}

#[test]
fn every_format_ends_with_the_numbers_in_order() {
    let plane = |z: usize, values: &mut Vec<f32>| values.extend((0..6).map(|k| number(z, k)));
    let expected: Vec<u8> = (0..4).flat_map(|z| (0..6).flat_map(move |k| number(z, k).to_le_bytes())).collect();
    for format in GridFormat::ALL {
        let mut bytes = Vec::new();
        encode_grid(&samples(&plane), format, &mut bytes).expect("memory does not refuse");
        let tail = if format == GridFormat::Vti { "</AppendedData></VTKFile>\n".len() } else { 0 };
        let numbers = &bytes[bytes.len() - tail - expected.len()..bytes.len() - tail];
        assert_eq!(numbers, expected, "{format}");
        let header = String::from_utf8_lossy(&bytes[..bytes.len() - tail - expected.len()]).into_owned();
        for word in ["0.0000001", "0.25", "in, negative inside", "1.5"] {
            assert_eq!(header.contains(word), format.says_where(), "`{word}` in {format}:\n{header}");
        }
    }
}

#[test]
fn a_plane_of_the_wrong_size_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("a.nrrd");
    let short = |z: usize, values: &mut Vec<f32>| values.extend((0..6 - z / 3).map(|k| number(z, k)));
    let error = write_grid(&path, &samples(&short), GridFormat::Nrrd).expect_err("plane 3 is short").to_string();
    assert!(error.contains("plane 3 has 5 values") && error.contains("a.nrrd"), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
    let whole = |z: usize, values: &mut Vec<f32>| values.extend((0..6).map(|k| number(z, k)));
    write_grid(&path, &samples(&whole), GridFormat::Nrrd).expect("it can be written");
    assert!(path.metadata().expect("it is there").len() > 4 * 24);
}

#[test]
fn names_of_formats() {
    for format in GridFormat::ALL {
        assert_eq!(format.to_string().parse(), Ok(format));
        let path = format!("a.b/c.{}", format.name().to_uppercase());
        assert_eq!(GridFormat::from_path(path.as_ref()), Some(format));
    }
    assert!("vdb".parse::<GridFormat>().is_err());
    assert_eq!(GridFormat::from_path("nrrd".as_ref()), None);
}
