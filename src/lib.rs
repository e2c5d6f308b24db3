//! Repair of triangle meshes, and solid modelling on meshes as they really are: open, cracked,
//! self-intersecting, flipped, doubled.
//!
//! ```
//! use meshwright::glam::DVec3;
//! use meshwright::{Solid, VoxelSize, io};
//!
//! # let out = tempfile::tempdir()?;
//! # let out = |name: &str| out.path().join(name);
//! let mug = io::read("testdata/broken_mug.obj")?; // as broken as it is
//! let mug: Solid = meshwright::repair(&mug, VoxelSize::Along(64))?; // closed, oriented, free of self-intersections
//! let ball = meshwright::repair(&io::read("testdata/hollow_ball.stl")?, VoxelSize::Along(64))?;
//! let both = meshwright::union([&mug, &ball], VoxelSize::Along(64))?;
//! let far = both.distance().at(DVec3::splat(1000.0)); // the signed distance; `contains(p)` asks whether a point is inside
//! let rounded = both.close(3.0, VoxelSize::Along(64))?; // what a ball outside cannot reach is filled
//! io::write(out("both.stl"), &rounded)?;
//! assert!(far > 0.0 && rounded.validity().volume >= both.validity().volume);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`TriMesh`] is any mesh; [`Solid`] is one that has been checked to bound a solid, and every pipeline ends in that check. The functions at
//! the root are the short forms of those in [`pipeline`], which take a [`Progress`] (to show how far they are, and to stop them) and
//! give an [`Outcome`](pipeline::Outcome) with a report.
//!
//! The data's way, stage by stage, in the order of the modules below:
//!
//! ```text
//! files ─► io ─► mesh (soup) ─► orient ─► shells ─► ldi ─► spans ─► vote ─► sdf ─► contour ─► fit ─► mesh ─► io ─► files
//!                                 └───── survey ──────┘
//!                                             └────────── closed shells that touch nothing ──────────┘
//! ```
//!
//! What is promised: the mesh that a pipeline returns is closed, oriented, 2-manifold and free of
//! degenerate and intersecting triangles, or the pipeline gives an error that says what is wrong. The same input and
//! options give the same bytes, whatever the number of threads.
//!
//! Conventions, everywhere: positions are `f64` in *model units* unless a name says `lattice`
//! (voxel units, `h` = 1, origin at voxel (0,0,0)); signed distances are negative inside. Vectors are those of [`glam`], which is
//! re-exported.
//!
//! Features: `cli` (the program; off with `default-features = false`), `gpu` (rays on a graphics processor, through Vulkan).
#![warn(missing_docs)]
#![forbid(unsafe_code)]

// In the order in which the data passes: no module imports one below it.
mod digits;
mod nearest;
pub mod progress;
pub mod mesh;
pub mod zip;
pub mod fill;
pub mod lattice;
pub mod io;
pub mod ldi;
pub mod orient;
pub mod shells;
pub mod arrange;
pub mod vote;
pub mod sdf;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod backend;
pub mod survey;
pub mod contour;
pub mod fit;
pub mod field;
pub mod morphology;
pub mod outer;
pub mod decimate;
pub mod compare;
pub mod picture;
pub mod page;
pub mod pipeline;
mod front;
#[cfg(feature = "cli")]
pub mod cli;

pub use glam;

pub use front::{difference, intersection, repair, union};
pub use mesh::{Solid, TriMesh};
pub use pipeline::{Operand, Options, SurfaceOptions, VoxelSize};
pub use progress::Progress;
