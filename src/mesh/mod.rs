//! Triangle meshes: the soup as read, its defects, its measures, and the topology of manifolds.

mod plane;
mod tri_mesh;

pub use plane::Plane;
pub use tri_mesh::{Bounds, TriMesh};
