//! Mesh files and files of lattices, in and out: one folder or file a format, detection, and writing that never leaves
//! half a file behind.
//!
//! ```no_run
//! use meshwright::io;
//!
//! let loaded = io::read("scan.stl")?;
//! loaded.warnings.iter().for_each(|warning| eprintln!("{warning}"));
//! io::write("out.ply", &loaded.mesh)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | | reads | writes |
//! |---|---|---|
//! | a mesh in a file | [`read`], [`read_as`] | [`write()`], [`write_with`], [`write_painted`] |
//! | a mesh in arrays | [`of_triangles`], [`of_polygons`] | |
//! | the bytes of a mesh | [`read_bytes`] | [`encode`], [`encode_coloured`], [`encode_painted`] |
//! | the objects in the bytes of a file | [`read_scene`] | [`encode_scene`] |
//! | a lattice in a file | [`read_grid`] | [`write_grid`], [`write_grid_as`] |
//! | the bytes of a lattice | [`read_grid_bytes`], [`read_grid_within`] | [`encode_grid`] |
//!
//! A reader takes the whole file as bytes and returns a soup or an error that names the place. It
//! trusts no count in the file: memory is taken only for what the bytes back. Nothing is repaired,
//! scaled or merged here, except that STL, which repeats a vertex for every facet, is welded by
//! equal coordinates. The rules for each format are in `docs/formats.md`.
//!
//! What a caller should look at in a [`Loaded`] besides the mesh: [`Loaded::warnings`]; [`Loaded::unit`], before two files
//! are combined ([`Loaded::rescale`]); [`Loaded::negative`], which is to be subtracted; and
//! [`Loaded::validate_options`], before the mesh is judged.

mod arrays;
mod colour;
mod colour_scale;
mod detect;
pub(crate) mod draft;
mod encoding;
mod error;
mod file_format;
mod foreign;
mod format;
mod gltf;
mod grids;
#[cfg(feature = "cli")]
pub(crate) mod leftovers;
mod legend;
mod loaded;
mod obj;
mod off;
mod paint;
mod pieces;
mod ply;
mod polygon;
mod reading;
mod save;
mod scene;
mod slice;
mod sound;
mod soup;
mod stl;
mod text;
mod texture;
mod three_mf;
mod unit;
mod writing;

pub use arrays::{ArraysError, of_polygons, of_triangles};
pub(crate) use colour::linear_from_srgb;
pub use colour::{Carried, Colours, Rgba};
pub use colour_scale::ColourScale;
pub use error::{FileError, FileProblem, Location, Wanted, WriteError, WriteProblem};
pub use file_format::{FileFormat, UnknownFileFormat};
pub use format::{Format, UnknownFormat};
pub use grids::{
    BLOCK_SIDE, BLOCK_VOXELS, BlockValues, DistanceSamples, GridBlock, GridFile, GridFormat, GridMeasures, GridTile,
    GridValues, SampleBlocks, SparseValues, UnknownGridFormat, encode_grid, read_grid, read_grid_bytes,
    read_grid_within, write_grid, write_grid_as,
};
pub use legend::LegendEntry;
pub use loaded::{Loaded, Negative, Part};
pub use paint::Paint;
pub use ply::{FaceMap, VertexMap, encode_face_map, encode_vertex_map};
pub use reading::{read, read_as, read_bytes};
pub use save::save_bytes;
pub use scene::{
    Aside, Flattened, Placement, Scene, SceneMaterial, SceneObject, ScenePart, encode_scene, flattened, read_scene,
};
pub use texture::{ImageKind, Material, SideFile, TexCoords, TextureImage, TextureMap, shown_colours};
pub use unit::{Unit, UnknownUnit};
pub use writing::{WriteOptions, encode, encode_coloured, encode_painted, write, write_painted, write_with};
