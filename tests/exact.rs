//! The exact distance: at points against looking at all triangles, over lattices against points.

mod common;

#[path = "exact/characteristics.rs"]
mod characteristics;
#[path = "exact/lattices.rs"]
mod lattices;
#[path = "exact/levels.rs"]
mod levels;
#[path = "exact/points.rs"]
mod points;
#[path = "exact/prism.rs"]
mod prism;
#[path = "exact/shapes.rs"]
mod shapes;
#[path = "exact/soups.rs"]
mod soups;
