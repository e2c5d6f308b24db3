//! Layered depth images and fields of the graphics processor against those of the main one. Needs a Vulkan driver; a software one does.

mod equal;
mod field;
mod limits;
mod soups;
