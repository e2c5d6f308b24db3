//! VTK image data in XML.

mod arrays;
mod read;
mod write;
mod xml;

pub(super) use read::read;
pub(super) use write::write;
