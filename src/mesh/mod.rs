//! Triangle meshes: the soup as read, its defects, its measures, and the topology of manifolds.

mod tri_mesh;

pub use tri_mesh::{Bounds, TriMesh};
