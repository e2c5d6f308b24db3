//! Repair of triangle meshes, and solid modelling on meshes as they really are: open, cracked,
//! self-intersecting, flipped, doubled.
//!
//! The data's way, stage by stage, in the order of the modules below:
//!
//! ```text
//! files ─► io ─► mesh (soup) ─► orient ─► shells ─► ldi ─► spans ─► vote ─► sdf ─► contour ─► fit ─► mesh ─► io ─► files
//!                                             └────────── closed shells that touch nothing ──────────┘
//! ```
//!
//! What is promised: the mesh that a pipeline returns is closed, oriented, 2-manifold and free of
//! degenerate and intersecting triangles, or the result says that it is not. The same input and
//! options give the same bytes, whatever the number of threads.
//!
//! Conventions, everywhere: positions are `f64` in *model units* unless a name says `lattice`
//! (voxel units, `h` = 1, origin at voxel (0,0,0)); signed distances are negative inside.
#![warn(missing_docs)]
#![forbid(unsafe_code)]

pub mod backend;

#[cfg(feature = "cli")]
pub mod cli;
pub mod compare;
pub mod contour;
pub mod decimate;
mod digits;
pub mod field;
pub mod fit;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod io;
pub mod lattice;
pub mod ldi;
pub mod mesh;
pub mod morphology;
pub mod orient;
pub mod picture;
pub mod pipeline;
pub mod progress;
pub mod sdf;
pub mod shells;
pub mod survey;
pub mod vote;

pub use glam;
