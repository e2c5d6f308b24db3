//! Small sound files with a few bytes changed: any answer but a panic will do.

use std::path::Path;

use meshwright::io::{Colours, Format, read_bytes};
use proptest::prelude::*;

use super::support::{
    assert_sound, encoded, encoded_in_colour, encoded_with_textures, every_form, tetrahedron, zipped,
};

/// The committed seeds of the fuzzer and every form that the writers have.
pub fn originals() -> Vec<(Format, Vec<u8>)> {
    let mut all: Vec<_> = every_form().iter().map(|o| (o.format, encoded(&tetrahedron(), o))).collect();
    all.extend(every_form().iter().map(|o| (o.format, encoded_in_colour(&tetrahedron(), &four_colours(), o))));
    all.extend(every_form().iter().map(|o| (o.format, encoded_with_textures(&tetrahedron(), o))));
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    for format in Format::ALL {
        let folder = seeds.join(if format == Format::ThreeMf { "three_mf" } else { format.name() });
        let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        all.extend(files.iter().map(|file| (format, std::fs::read(file).unwrap())));
    }
    all
}

/// One for each face of the tetrahedron.
fn four_colours() -> Colours {
    Colours::Faces(vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 9], [1, 2, 3, 255]])
}

/// One change to some bytes.
#[derive(Debug, Clone)]
pub enum Change {
    Flip(prop::sample::Index, u8),
    Set(prop::sample::Index, u8),
    Insert(prop::sample::Index, Vec<u8>),
    Remove(prop::sample::Index, usize),
    Repeat(prop::sample::Index, usize),
    CutAt(prop::sample::Index),
}

/// Any change.
pub fn change() -> impl Strategy<Value = Change> {
    let place = || any::<prop::sample::Index>();
    let words = prop::sample::select(vec![
        "-1",
        "4294967295",
        "9999999999999999999",
        "nan",
        "1e999",
        "-0",
        "\n",
        " ",
        "/",
        "\\\n",
        "0",
        "\u{0}",
        "\"",
    ]);
    let bytes = prop_oneof![prop::collection::vec(any::<u8>(), 1..9), words.prop_map(|w| w.as_bytes().to_vec())];
    prop_oneof![
        4 => (place(), 0u8..8).prop_map(|(i, bit)| Change::Flip(i, 1 << bit)),
        2 => (place(), any::<u8>()).prop_map(|(i, byte)| Change::Set(i, byte)),
        3 => (place(), bytes).prop_map(|(i, bytes)| Change::Insert(i, bytes)),
        2 => (place(), 1usize..20).prop_map(|(i, n)| Change::Remove(i, n)),
        1 => (place(), 1usize..60).prop_map(|(i, n)| Change::Repeat(i, n)),
        1 => place().prop_map(Change::CutAt),
    ]
}

/// Changes the bytes.
pub fn apply(bytes: &mut Vec<u8>, change: &Change) {
    if bytes.is_empty() {
        return;
    }
    let length = bytes.len();
    let span = |i: &prop::sample::Index, n: usize| i.index(length)..(i.index(length) + n).min(length);
    match change {
        Change::Flip(i, mask) => bytes[i.index(length)] ^= mask,
        Change::Set(i, byte) => bytes[i.index(length)] = *byte,
        Change::Insert(i, new) => {
            let at = i.index(length);
            bytes.splice(at..at, new.iter().copied());
        }
        Change::Remove(i, n) => drop(bytes.drain(span(i, *n))),
        Change::Repeat(i, n) => {
            let copy = bytes[span(i, *n)].to_vec();
            let at = i.index(length);
            bytes.splice(at..at, copy);
        }
        Change::CutAt(i) => bytes.truncate(i.index(length)),
    }
}

/// A model alone, or what a slicer says of one, is packed, so that changes reach the reader of the XML.
pub fn packed(format: Format, original: &[u8], bytes: Vec<u8>) -> Vec<u8> {
    const MODEL: &[u8] = include_bytes!("../../../fuzz/seeds/three_mf/roles.model");
    if format != Format::ThreeMf || original.starts_with(b"PK") {
        return bytes;
    }
    match original.starts_with(b"<config") {
        true => zipped(&[("3D/3dmodel.model", MODEL), ("Metadata/model_settings.config", &bytes)]),
        false => zipped(&[("3D/3dmodel.model", &bytes)]),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    #[test]
    fn mutants_give_a_mesh_or_an_error(which in any::<prop::sample::Index>(),
                                       changes in prop::collection::vec(change(), 1..6)) {
        let originals = originals();
        let (format, original) = &originals[which.index(originals.len())];
        let mut bytes = original.clone();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        let bytes = packed(*format, original, bytes);
        for format in [Some(*format), None] {
            match read_bytes(&bytes, format, None) {
                Ok(loaded) => assert_sound(&loaded),
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
    }
}

/// Cut anywhere, a file is an error or, where only its end is missing, the same mesh: never less of it
/// without a word. (ASCII STL may lose whole facets; it then says so.)
#[test]
fn a_file_cut_anywhere_never_passes_for_a_smaller_mesh() {
    for options in every_form() {
        for bytes in [encoded(&tetrahedron(), &options), encoded_in_colour(&tetrahedron(), &four_colours(), &options)] {
            for length in 0..bytes.len() {
                if let Ok(loaded) = read_bytes(&bytes[..length], Some(options.format), None) {
                    let whole = loaded.mesh.triangles.len() == 4;
                    // OBJ states no count: a cut between two faces cannot be seen.
                    let unseen = options.format == Format::Obj;
                    assert!(whole || unseen || !loaded.warnings.is_empty(), "{options:?} cut at {length}");
                }
            }
        }
    }
}
