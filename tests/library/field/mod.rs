//! Fields: sources, algebra, filter, blends, blobs, blur, and their level sets.

mod algebra;
mod filter;
mod interpolated;
mod sources;
mod support;
