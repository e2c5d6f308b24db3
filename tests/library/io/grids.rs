//! Files of lattices: whole or not there, and read back as they were written.

use glam::{DVec3, IVec3};
use meshwright::io::{
    BLOCK_VOXELS, BlockValues, DistanceSamples, GridFile, GridFormat, GridValues, SampleBlocks, Unit, encode_grid,
    read_grid_bytes, write_grid,
};
use proptest::prelude::*;

use super::memory::peak_of;

fn samples(plane: &(dyn Fn(usize, &mut Vec<f32>) + Sync)) -> DistanceSamples<'_> {
    let origin = DVec3::new(-1.0, 0.1, 1e-7);
    let (spacing, dims, unit, band) = (0.25, [3, 2, 4], Some(Unit::Inch), Some(1.5));
    DistanceSamples { origin, spacing, dims, unit, band, plane, blocks: None }
}

fn number(z: usize, k: usize) -> f32 {
    (10 * z + k) as f32 - 7.5
}

/// The samples as a file.
pub fn encoded(samples: &DistanceSamples<'_>, format: GridFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    encode_grid(samples, format, &mut bytes).expect("memory does not refuse");
    bytes
}

/// A small file of `format`, all of whose values are within the band.
pub fn small(format: GridFormat) -> Vec<u8> {
    let plane = |z: usize, values: &mut Vec<f32>| values.extend((0..6).map(|k| number(z, k) / 40.0));
    encoded(&samples(&plane), format)
}

#[test]
fn dense_formats_end_with_the_numbers_in_order() {
    let plane = |z: usize, values: &mut Vec<f32>| values.extend((0..6).map(|k| number(z, k)));
    let expected: Vec<u8> = (0..4).flat_map(|z| (0..6).flat_map(move |k| number(z, k).to_le_bytes())).collect();
    for format in [GridFormat::Vti, GridFormat::Nrrd, GridFormat::Npy] {
        let bytes = encoded(&samples(&plane), format);
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
    let short = |z: usize, values: &mut Vec<f32>| values.extend((0..6 - z / 3).map(|k| number(z, k)));
    let whole = |z: usize, values: &mut Vec<f32>| values.extend((0..6).map(|k| number(z, k)));
    for format in GridFormat::ALL {
        let path = folder.path().join(format!("a.{format}"));
        let error = write_grid(&path, &samples(&short)).expect_err("plane 3 is short").to_string();
        assert!(error.contains("plane 3 has 5 values") && error.contains(&format!("a.{format}")), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
        write_grid(&path, &samples(&whole)).expect("it can be written");
        let read = meshwright::io::read_grid(&path).expect("it can be read");
        assert_eq!((read.format, read.dims), (format, [3, 2, 4]));
        std::fs::remove_file(path).expect("it is there");
    }
}

#[test]
fn names_of_formats() {
    for format in GridFormat::ALL {
        assert_eq!(format.to_string().parse(), Ok(format));
        let path = format!("a.b/c.{}", format.name().to_uppercase());
        assert_eq!(GridFormat::from_path(&path), Some(format));
        assert_eq!(GridFormat::detect(&small(format), Some("lies.stl".as_ref())), Some(format));
        assert_eq!(GridFormat::detect(b"who knows", Some(path.as_ref())), Some(format));
    }
    assert!("mha".parse::<GridFormat>().is_err());
    assert_eq!(GridFormat::from_path("nrrd"), None);
    assert_eq!(GridFormat::detect(b"solid a", None), None);
}

/// The values of all voxels, x fastest.
pub fn values_of(file: &GridFile) -> Vec<f32> {
    let [x, y, z] = file.dims.map(|count| count as i32);
    let voxels = (0..z).flat_map(|z| (0..y).flat_map(move |y| (0..x).map(move |x| IVec3::new(x, y, z))));
    voxels.map(|voxel| file.at(voxel).expect("a voxel of the lattice")).collect()
}

/// A lattice of any shape and what is in it.
#[derive(Debug, Clone)]
struct Case {
    dims: [usize; 3],
    origin: [f64; 3],
    spacing: f64,
    unit: Option<Unit>,
    band: Option<f64>,
    /// The distance from a ball and some noise, so that there are both sides, and blocks without values.
    ball: [f32; 4],
    noise: f32,
}

impl Case {
    fn value(&self, [x, y, z]: [usize; 3]) -> f32 {
        let [a, b, c, r] = self.ball;
        let d = ((x as f32 - a).powi(2) + (y as f32 - b).powi(2) + (z as f32 - c).powi(2)).sqrt() - r;
        let value = (d + self.noise * ((7 * x + 5 * y + 3 * z) % 11) as f32 / 11.0) * self.spacing as f32;
        self.band.map_or(value, |band| value.clamp(-band as f32, band as f32))
    }

    fn plane(&self, z: usize, values: &mut Vec<f32>) {
        let [width, height, _] = self.dims;
        values.extend((0..width * height).map(|k| self.value([k % width, k / width, z])));
    }

    fn with<T>(&self, blocks: Option<&SampleBlocks<'_>>, work: impl FnOnce(&DistanceSamples<'_>) -> T) -> T {
        let plane = |z: usize, values: &mut Vec<f32>| self.plane(z, values);
        let Case { dims, spacing, unit, band, .. } = *self;
        let origin = DVec3::from(self.origin);
        work(&DistanceSamples { origin, spacing, dims, unit, band, plane: &plane, blocks })
    }

    /// The blocks that have a value within the band, and the first value of the others.
    fn blocks<T>(&self, work: impl FnOnce(&SampleBlocks<'_>) -> T) -> T {
        let counts = self.dims.map(|count| count.div_ceil(8) as i32);
        let of_block = |block: IVec3| -> BlockValues {
            let corner = (block * 8).to_array().map(|k| k as usize);
            std::array::from_fn(|n| self.value([corner[0] + n % 8, corner[1] + n / 8 % 8, corner[2] + n / 64]))
        };
        let all = (0..counts[2])
            .flat_map(|z| (0..counts[1]).flat_map(move |y| (0..counts[0]).map(move |x| IVec3::new(x, y, z))));
        let band = self.band.map_or(f32::INFINITY, |band| band as f32);
        let stored: Vec<IVec3> = all.filter(|&b| of_block(b).iter().any(|value| value.abs() < band)).collect();
        let values = |n: usize| of_block(stored[n]);
        let inside = |block: IVec3| of_block(block)[0] < 0.0;
        work(&SampleBlocks { stored: &stored, values: &values, inside: &inside })
    }
}

prop_compose! {
    fn case()(
        dims in [1usize..30, 1usize..30, 1usize..30],
        origin in [-9.0..9.0, -9.0..9.0, -9.0..9.0],
        spacing in 1e-3..1e3,
        unit in prop::option::of(prop::sample::select(Unit::ALL.to_vec())),
        band in prop::option::of(1.8f64..4.0),
        ball in [0f32..30.0, 0f32..30.0, 0f32..30.0, 1f32..14.0],
        noise in 0f32..0.2,
    ) -> Case {
        // In blocks that are not stored all values are on one side, as they are in fields of distances.
        Case { dims, origin, spacing, unit, band: band.map(|band| band * spacing), ball, noise }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read_back(case in case()) {
        let expected: Vec<f32> = case.with(None, |samples| {
            let mut all = Vec::new();
            (0..case.dims[2]).for_each(|z| (samples.plane)(z, &mut all));
            all
        });
        for format in GridFormat::ALL {
            let bytes = case.with(None, |samples| encoded(samples, format));
            let read = read_grid_bytes(&bytes, None, None).expect("it is sound");
            prop_assert_eq!((read.format, read.dims), (format, case.dims));
            if format.says_where() {
                prop_assert_eq!((read.origin, read.spacing), (DVec3::from(case.origin), case.spacing));
                prop_assert_eq!((read.unit, read.band), (case.unit, case.band));
            } else {
                prop_assert_eq!((read.origin, read.spacing), (DVec3::ZERO, 1.0));
            }
            prop_assert!(read.warnings.is_empty(), "{:?}", read.warnings);
            prop_assert_eq!(read.at(IVec3::from(case.dims.map(|k| k as i32)) - IVec3::Z), None);
            prop_assert!(values_of(&read) == expected, "{} changes values", format);
        }
    }

    #[test]
    fn blocks_and_planes_make_the_same_file(case in case()) {
        let planes = case.with(None, |samples| encoded(samples, GridFormat::Vdb));
        let blocks = case.blocks(|blocks| case.with(Some(blocks), |samples| encoded(samples, GridFormat::Vdb)));
        prop_assert!(planes == blocks);
    }
}

/// 4,352³ voxels, and a sphere around the corner of four nodes of the root.
#[test]
fn a_huge_lattice_takes_the_blocks_near_the_surface_only() {
    let (middle, radius, band) = (IVec3::new(4096, 4096, 300), 40.0, 3.0f32);
    let dims = [4352, 4352, 4352];
    let distance = |voxel: IVec3| ((voxel - middle).as_vec3().length() - radius).clamp(-band, band);
    let of_block = |block: IVec3| -> BlockValues {
        std::array::from_fn(|n| distance(8 * block + IVec3::new(n as i32 % 8, n as i32 / 8 % 8, n as i32 / 64)))
    };
    let range = |k: usize| (middle[k] - 48).div_euclid(8)..=(middle[k] + 48).div_euclid(8);
    let near = range(2).flat_map(|z| range(1).flat_map(move |y| range(0).map(move |x| IVec3::new(x, y, z))));
    let stored: Vec<IVec3> = near.filter(|&b| of_block(b).iter().any(|value| value.abs() < band)).collect();
    let values = |n: usize| of_block(stored[n]);
    let inside = |block: IVec3| distance(8 * block) < 0.0;
    let blocks = SampleBlocks { stored: &stored, values: &values, inside: &inside };
    let plane = |_: usize, _: &mut Vec<f32>| panic!("planes are not asked for");
    let spacing = 0.5;
    let samples = DistanceSamples {
        origin: DVec3::ZERO,
        spacing,
        dims,
        unit: None,
        band: Some(band.into()),
        plane: &plane,
        blocks: Some(&blocks),
    };
    let (bytes, peak) = peak_of(|| encoded(&samples, GridFormat::Vdb));
    assert!(bytes.len() < 3 * stored.len() * BLOCK_VOXELS && peak < 8 * bytes.len(), "{} {peak}", bytes.len());
    let read = read_grid_bytes(&bytes, None, None).expect("it is sound");
    assert_eq!((read.dims, read.origin), (dims, DVec3::ZERO));
    let GridValues::Sparse(sparse) = &read.values else { panic!("it is sparse") };
    assert!(sparse.blocks.len() <= stored.len() && sparse.blocks.iter().all(|block| block.corner & 7 == IVec3::ZERO));
    for n in 0..200_000 {
        let offset = IVec3::new(n * 37 % 97, n * 11 % 89, n * 53 % 101) - 48;
        assert_eq!(read.at(middle + offset), Some(distance(middle + offset)), "{offset}");
    }
    assert_eq!(read.at(IVec3::splat(4351)), Some(band));
}
