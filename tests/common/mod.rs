//! What several test programs share: shapes made here, and what must hold of any mesh.
//!
//! A fresh clone has neither the real meshes nor, perhaps, a graphics driver. A test that needs one of them says so and passes over; where the
//! environment promises that it is there, the test fails without it.

#![allow(dead_code)] // each test program uses its own part

pub mod exact;
pub mod fields;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod proofs;
pub mod repaired;
pub mod shapes;
pub mod stages;
pub mod textured;

use std::io::Write;
use std::path::{Path, PathBuf};

use meshwright::mesh::TriMesh;

/// A mesh of our own.
pub fn sample(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("testdata").join(name)
}

/// One mesh file.
pub fn read(path: &Path) -> TriMesh {
    meshwright::io::read(path).unwrap_or_else(|e| panic!("{e}")).mesh
}

/// Says that the running test was left out. The words go around the harness, which keeps what a test that passes prints.
pub fn left_out(why: &str) {
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("a test");
    // One piece, so that tests beside this one do not write into the middle of it.
    let _ = std::io::stderr().write_all(format!("left out: {test}: {why}\n").as_bytes());
}
