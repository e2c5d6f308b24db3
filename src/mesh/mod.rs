//! Triangle meshes: the soup as read, its defects, its measures, and the topology of manifolds.
//!
//! [`TriMesh`] assumes nothing. [`validate`] counts what is wrong with one and measures it,
//! [`defects`] says where, and both judge intersections by exact predicates. [`HalfEdges`] is the topology of
//! a closed, oriented manifold while it is edited. [`ClosestTree`] finds the nearest triangle or segment, and
//! [`Pseudonormals`] say on which side of it a point lies.

pub(crate) mod around;
mod closest;
mod defects;
pub(crate) mod edges;
mod half_edges;
mod hull;
pub(crate) mod least_squares;
mod mass;
mod nearest_point;
pub(crate) mod neighbours;
mod packet;
mod parted;
mod plane;
pub(crate) mod predicates;
mod pseudonormals;
mod self_intersection;
#[cfg(test)]
pub(crate) mod shapes;
mod solid;
mod submesh;
mod tri_mesh;
mod triangle_pair;
mod validity;
pub(crate) mod weld;

pub use closest::{Closest, ClosestTree};
pub(crate) use closest::{MARGIN, margin, tree_over};
pub use defects::{Defects, defects};
pub use half_edges::{CollapseRecord, Compacted, HalfEdges, NotManifold, Ring};
pub use hull::{convex_hull, largest_hull_face};
pub use mass::{MassProperties, Overhang};
pub use nearest_point::{Feature, Shape};
pub use plane::Plane;
pub use pseudonormals::Pseudonormals;
pub(crate) use self_intersection::{intersecting_groups, intersections_with};
pub use self_intersection::{intersecting_triangles, self_intersections};
pub use solid::{NotSolid, Solid, SolidError};
pub use submesh::Submesh;
pub use tri_mesh::{Bounds, IndexError, TriMesh};
pub use triangle_pair::triangles_intersect;
pub(crate) use validity::flat_triangles;
pub use validity::{ValidateOptions, Validity, validate};
