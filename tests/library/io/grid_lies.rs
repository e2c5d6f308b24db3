//! Files of lattices that lie or cannot be used: a typed error with the place, within the memory that their length
//! justifies; and files with a few bytes changed.

use std::path::Path;
use std::sync::LazyLock;

use meshwright::io::{FileProblem, GridFormat, GridValues, Wanted, read_grid_bytes};
use proptest::prelude::*;

use super::grids::small;
use super::memory::peak_of;
use super::mutants::{apply, change};

/// The problem of a file that must not read, and which may take 64 times its length and 1 MB.
#[track_caller]
fn refuse(bytes: &[u8], format: GridFormat, words: &str) -> FileProblem {
    let (result, peak) = peak_of(|| read_grid_bytes(bytes, Some(format), Some("lies.bin".as_ref())));
    let error = result.expect_err("a file that lies is refused");
    let text = error.to_string();
    assert!(text.starts_with("lies.bin: ") && text.contains(words), "`{words}` is missing in: {text}");
    assert!(peak <= 64 * bytes.len() + (1 << 20), "{peak} bytes for {}: {text}", bytes.len());
    *error.problem
}

/// A small file with a piece of its text replaced.
fn with(format: GridFormat, from: &str, to: &str) -> Vec<u8> {
    let bytes = small(format);
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes());
    let at = at.unwrap_or_else(|| panic!("`{from}` is missing in {format}"));
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

#[test]
fn nothing_is_no_lattice() {
    for format in GridFormat::ALL {
        assert!(matches!(refuse(b"", format, "empty"), FileProblem::Empty));
        for bytes in [b"\n".as_slice(), &[0; 300], &[0xff; 300], b"solid a\n"] {
            assert!(matches!(refuse(bytes, format, "expected"), FileProblem::Syntax { .. }));
        }
    }
    let error = read_grid_bytes(b"who knows", None, None).unwrap_err();
    assert!(matches!(*error.problem, FileProblem::UnknownFormat(Wanted::Grid)), "{error}");
    let error = meshwright::io::read_grid("absent/file.vti").unwrap_err();
    assert!(error.to_string().contains("absent/file.vti") && matches!(*error.problem, FileProblem::Io(_)));
}

#[test]
fn voxels_must_be_cubes_along_the_axes() {
    use GridFormat::{Nrrd, Vti};
    let spacing = "Spacing=\"0.25 0.25 0.25\"";
    for (format, from, to) in [(Vti, spacing, "Spacing=\"0.25 0.25 0.5\""), (Nrrd, "(0,0.25,0)", "(0,0.5,0)")] {
        let problem = refuse(&with(format, from, to), format, "one spacing for all axes is needed");
        assert!(matches!(problem, FileProblem::Anisotropic(spacing) if spacing[0] == 0.25), "{problem}");
    }
    let turned = "Direction=\"0 1 0 1 0 0 0 0 1\"";
    for (format, from, to) in [
        (Vti, "Direction=\"1 0 0 0 1 0 0 0 1\"", turned),
        (Nrrd, "(0,0.25,0)", "(0.1,0.25,0)"),
        (Nrrd, "(0,0.25,0)", "(0,-0.25,0)"),
    ] {
        let problem = refuse(&with(format, from, to), format, "are turned, sheared or mirrored");
        assert!(matches!(problem, FileProblem::Turned(_)), "{problem}");
    }
    for (format, from, to) in [(Vti, spacing, "Spacing=\"0 0 0\""), (Vti, spacing, "Spacing=\"nan 1 1\"")] {
        refuse(&with(format, from, to), format, "a spacing above zero");
    }
}

#[test]
fn what_is_not_read_says_what_to_do() {
    use GridFormat::{Npy, Nrrd, Vdb, Vti};
    for (format, from, to, words) in [
        (Vti, "header_type=\"UInt64\"", "compressor=\"vtkLZ4DataCompressor\"", "save it with ZLib"),
        (Vti, "type=\"ImageData\"", "type=\"PolyData\"", "resample it to an image"),
        (Nrrd, "encoding: raw", "encoding: bzip2", "save it raw or as gzip"),
        (Nrrd, "encoding: raw", "data file: a.raw", "save it as one file"),
        (Nrrd, "dimension: 3", "dimension: 4", "a lattice of numbers has three"),
        (Npy, "<f4", "<c8", "convert the array to float32"),
        (Vdb, "Tree_float_5_4_3", "Tree_vec3s_5_4_3", "no grid of floats"),
        (Vdb, "UniformScaleTranslateMap", "UniformNonlinearFrustMap", "resample the grid"),
    ] {
        let problem = refuse(&with(format, from, to), format, words);
        assert!(matches!(problem, FileProblem::Unsupported(_)), "{problem}");
    }
    let mut old = small(Vdb);
    old[8] = 220;
    refuse(&old, Vdb, "version 220 of the format is not read here");
}

#[test]
fn counts_that_the_file_does_not_back() {
    use GridFormat::{Npy, Nrrd, Vti};
    for (format, from, to) in [
        (Vti, "0 2 0 1 0 3\" Origin", "0 4000000000 0 4000000000 0 4000000000\" Origin"),
        (Vti, "0 2 0 1 0 3\" Origin", "0 9223372036854775807 0 1 0 3\" Origin"),
        (Nrrd, "sizes: 3 2 4", "sizes: 4000000000 4000000000 4"),
        (Nrrd, "sizes: 3 2 4", "sizes: 3 2 5"),
        (Npy, "(3, 2, 4)", "(3, 2, 5)"),
        (Npy, "(3, 2, 4)", "(99999999999, 99999999999, 99999999999)"),
    ] {
        let mut bytes = with(format, from, to);
        if format == Vti {
            let extent = to.split('"').next().unwrap_or_default();
            let text = String::from_utf8_lossy(&bytes)
                .replace("Piece Extent=\"0 2 0 1 0 3\"", &format!("Piece Extent=\"{extent}\""));
            bytes = text.into_bytes();
        }
        refuse(&bytes, format, "");
    }
    for (encoding, data) in [("gzip", b"\x1f\x8b\x08\0\0\0\0\0\0\x03".as_slice()), ("ascii", b"1 2 3")] {
        let header =
            format!("NRRD0001\ntype: float\ndimension: 3\nsizes: 400 400 400\nencoding: {encoding}\nendian: big\n\n");
        refuse(&[header.as_bytes(), data].concat(), Nrrd, "");
    }
}

#[test]
fn values_must_be_finite() {
    for (format, at) in [(GridFormat::Npy, 4), (GridFormat::Nrrd, 4), (GridFormat::Vti, 4 + 26)] {
        let mut bytes = small(format);
        let end = bytes.len() - at;
        bytes[end..end + 4].copy_from_slice(&f32::NAN.to_le_bytes());
        let problem = refuse(&bytes, format, "a finite value expected at voxel 2 1 3");
        assert!(matches!(problem, FileProblem::NotFiniteVoxel { voxel: [2, 1, 3], .. }), "{problem}");
    }
    let mut bytes = small(GridFormat::Vdb);
    let end = bytes.len() - 4;
    bytes[end..].copy_from_slice(&f32::INFINITY.to_le_bytes());
    refuse(&bytes, GridFormat::Vdb, "at voxel 2 1 3");
}

static ORIGINALS: LazyLock<Vec<(GridFormat, Vec<u8>)>> = LazyLock::new(originals);

/// The seeds of the fuzzer and what the writers make, and what OpenVDB makes.
fn originals() -> Vec<(GridFormat, Vec<u8>)> {
    let mut all: Vec<_> = GridFormat::ALL.map(|format| (format, small(format))).to_vec();
    let folders = ["fuzz/seeds/grid", "tests/library/io/openvdb"]
        .map(|folder| Path::new(env!("CARGO_MANIFEST_DIR")).join(folder));
    for folder in folders {
        let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        for file in files {
            let bytes = std::fs::read(&file).unwrap();
            let format = GridFormat::detect(&bytes, Some(&file));
            all.push((format.unwrap_or_else(|| panic!("{} is no grid", file.display())), bytes));
        }
    }
    all
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn mutants_give_a_lattice_or_an_error(which in any::<prop::sample::Index>(), changes in prop::collection::vec(change(), 1..6)) {
        let originals = &*ORIGINALS;
        let (format, original) = &originals[which.index(originals.len())];
        let mut bytes = original.clone();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        match read_grid_bytes(&bytes, Some(*format), None) {
            Ok(file) => {
                prop_assert!(file.spacing > 0.0 && file.origin.is_finite() && !file.dims.contains(&0));
                if let GridValues::Dense(values) = &file.values {
                    prop_assert_eq!(Some(values.len()), file.dims.iter().try_fold(1, |n: usize, &d| n.checked_mul(d)));
                }
                let last = file.dims.map(|count| count as i32 - 1);
                prop_assert!(file.at(last.into()).is_some_and(f32::is_finite));
            }
            Err(error) => prop_assert!(!error.to_string().is_empty()),
        }
    }
}

/// Cut anywhere, a file is an error or holds the same values.
#[test]
fn a_file_cut_anywhere_never_passes_for_another_lattice() {
    for format in GridFormat::ALL {
        let bytes = small(format);
        let whole = read_grid_bytes(&bytes, None, None).expect("it is sound");
        // The first megabytes of a tree are masks; the header and the values are what matters.
        for length in (0..bytes.len()).filter(|n| format != GridFormat::Vdb || *n < 1200 || n % 97 == 0) {
            if let Ok(cut) = read_grid_bytes(&bytes[..length], Some(format), None) {
                assert_eq!((cut.dims, cut.values), (whole.dims, whole.values.clone()), "{format} cut at {length}");
            }
        }
    }
}
