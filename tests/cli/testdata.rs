//! The committed meshes are what their program makes.

use super::{names_in, sample};

#[path = "../../examples/make_testdata.rs"]
mod make_testdata;

#[test]
fn committed_meshes_equal_what_the_generator_makes() {
    let mut made: Vec<&str> = Vec::new();
    for (name, bytes) in make_testdata::files() {
        let committed = std::fs::read(sample(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(committed == bytes, "{name} is not what `cargo run --example make_testdata` makes");
        made.push(name);
    }
    made.sort_unstable();
    assert_eq!(names_in(&sample("")), made);
}

#[test]
fn every_mesh_is_small() {
    for (name, bytes) in make_testdata::files() {
        let limit = if name == "broken_mug.obj" { 150_000 } else { 100_000 };
        assert!(bytes.len() < limit, "{name} has {} bytes", bytes.len());
    }
}
