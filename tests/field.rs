//! Fields: sources, algebra, filter, blends, blobs, blur, and their level sets.

#[path = "field/algebra.rs"]
mod algebra;
mod common;
#[path = "field/filter.rs"]
mod filter;
#[path = "field/sources.rs"]
mod sources;
#[path = "field/support.rs"]
mod support;
