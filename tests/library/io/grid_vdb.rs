//! Files that OpenVDB itself wrote (`tools/make_vdb.cpp`), in every way it has.

use glam::{DVec3, IVec3};
use meshwright::io::{GridFile, GridFormat, GridValues, read_grid};

fn read(name: &str) -> GridFile {
    let path = format!("{}/tests/library/io/openvdb/{name}.vdb", env!("CARGO_MANIFEST_DIR"));
    read_grid(path).unwrap_or_else(|error| panic!("{error}"))
}

/// The largest difference from the ball that is in most files.
fn apart(file: &GridFile) -> f64 {
    let [x, y, z] = file.dims.map(|count| count as i32);
    let voxels = (0..z).flat_map(|z| (0..y).flat_map(move |y| (0..x).map(move |x| IVec3::new(x, y, z))));
    let error = |voxel: IVec3| {
        let p = file.origin + voxel.as_dvec3() * file.spacing;
        let truth = p.distance(DVec3::new(2.3, 2.2, 2.1)) - 1.25;
        (f64::from(file.at(voxel).expect("a voxel")) - truth.clamp(-0.5, 0.5)).abs()
    };
    voxels.map(error).fold(0.0, f64::max)
}

#[test]
fn every_compression_of_openvdb_is_read() {
    for (name, rounding) in
        [("plain", 1e-6), ("mask", 1e-6), ("zip", 1e-6), ("blosc", 1e-6), ("double", 1e-6), ("half", 3e-4)]
    {
        let file = read(name);
        assert_eq!(
            (file.format, file.spacing, file.band, file.unit),
            (GridFormat::Vdb, 0.25, Some(0.5), None),
            "{name}"
        );
        assert_eq!((file.origin, file.dims), (DVec3::ZERO, [24, 16, 16]), "{name}");
        assert!(file.warnings.is_empty(), "{:?}", file.warnings);
        assert!(
            matches!(&file.values, GridValues::Sparse(values) if values.blocks.len() >= 8 && values.background == 0.5)
        );
        assert!(apart(&file) < rounding, "{name}: {}", apart(&file));
    }
}

#[test]
fn tiles_and_inactive_values_are_where_they_were_set() {
    let file = read("odd");
    assert_eq!((file.spacing, file.band), (0.5, None));
    assert!(file.warnings.iter().any(|words| words.contains("`counts`")), "{:?}", file.warnings);
    assert!(file.warnings.iter().any(|words| words.contains("no level set") || words.contains("does not say")));
    // Its transform moves index 0 0 0 to 1 2 3.
    let first = ((file.origin - DVec3::new(1.0, 2.0, 3.0)) / 0.5).as_ivec3();
    let at = |x: i32, y: i32, z: i32| file.at(IVec3::new(x, y, z) - first);
    for n in 0..8 {
        assert_eq!(at(n - 130, 2 * n, -n), Some(0.1f32 * n as f32 - 0.35));
    }
    for (voxel, value) in [
        ([-130, 1, 0], -1.5),
        ([-129, 1, 0], 0.25),
        ([-128, 1, 0], 0.5),
        ([-127, 1, 0], 1.5),
        ([16, 0, 0], -1.5),
        ([23, 7, 7], -1.5),
        ([24, 7, 7], 1.5),
        ([24, 8, 0], 0.75),
        ([31, 15, 7], 0.75),
        ([31, 15, 8], 1.5),
        ([128, 128, 0], -1.5),
        ([255, 255, 127], -1.5),
        ([255, 255, 128], 1.5),
        ([-4096, 4096, 0], -1.5),
        ([-1, 8191, 4095], -1.5),
        ([0, 8191, 4095], 1.5),
    ] {
        let [x, y, z] = voxel;
        assert_eq!(at(x, y, z), Some(value), "{voxel:?}");
    }
    let [low, high] = [first, first + IVec3::from(file.dims.map(|count| count as i32))];
    assert_eq!((low, high), (IVec3::new(-4096, 0, -8), IVec3::new(256, 8192, 4096)));
}
