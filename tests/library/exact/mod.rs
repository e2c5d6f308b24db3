//! The exact distance: at points against looking at all triangles, over lattices against points.

mod characteristics;
mod lattices;
mod planes;
mod levels;
mod points;
mod prism;
mod soups;
