//! What is promised of real meshes, which the project reads but may not carry: they keep their owners' licences.
//!
//! `MESHWRIGHT_DATA` names their folder. Where it is not set every test here says that it was left out; where it is set the meshes must be there.

#[path = "../common/mod.rs"]
mod common;

mod closing;
mod decimate;
mod exact;
mod field;
#[cfg(feature = "gpu")]
mod gpu;
mod io;
mod rays;

use std::path::PathBuf;

use meshwright::mesh::TriMesh;

/// The folder of the real meshes.
struct Data(PathBuf);

/// The folder that the environment names; none, with a word, where it names none.
fn data() -> Option<Data> {
    let Some(folder) = std::env::var_os("MESHWRIGHT_DATA") else {
        common::left_out("MESHWRIGHT_DATA does not name the folder of the real meshes");
        return None;
    };
    let data = Data(PathBuf::from(folder));
    assert!(data.path("clean").is_dir(), "{} has no folder `clean` of meshes", data.0.display());
    Some(data)
}

impl Data {
    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn mesh(&self, name: &str) -> TriMesh {
        common::read(&self.path(name))
    }

    /// All meshes that are clean, by name.
    fn clean(&self) -> Vec<(String, TriMesh)> {
        let folder = self.path("clean");
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
        let mut names: Vec<String> =
            entries.map(|e| e.expect("readable folder").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        assert!(!names.is_empty(), "{} is empty", folder.display());
        names.into_iter().map(|name| (name.clone(), self.mesh(&format!("clean/{name}")))).collect()
    }
}
