//! NumPy arrays. The array has the axes x, y, z.

mod read;
mod write;

pub(super) use read::read;
pub(super) use write::write;
