//! The tests of the library, one module a stage or promise; one program, so that the library is linked once.

#[path = "../common/mod.rs"]
mod common;

mod arrange;
mod block;
mod closing;
mod compare;
mod contour;
mod contour_support;
mod decimate;
mod exact;
mod field;
mod field_language;
mod fill;
mod fit;
#[cfg(feature = "gpu")]
mod gpu;
mod hollow;
mod inside;
mod io;
mod keep;
mod mesh;
mod morphology;
mod outer;
mod rays;
mod sdf;
mod simplify;
mod solid;
mod standing;
mod thin;
mod vote;
