//! NRRD, header and numbers in one file.

mod header;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::write;
