//! Layered depth images of the graphics processor against those of the main one. Needs a Vulkan driver; a software one does.

mod equal;
mod limits;
mod prism;
mod soups;
