//! Promises of `mesh`: counts on meshes whose defects are known, intersections against integer arithmetic, and
//! half-edges that stay manifolds whatever is done to them.

mod closest;
mod half_edges;
mod intersections;
mod shapes;
mod soup;
mod validity;
