//! Layered depth images: every crossing of the lattice's own rays with the soup, in 13 directions
//! (Bærentzen §3), and the spans of the result along them (§3.1, §5.1).

mod assemble;
mod crossings;
mod evidence;
mod expression;
mod inside;
mod layers;
mod raster;
mod spans;
mod thin;

pub use assemble::{Crossed, assemble};
pub use crossings::edge_crossing;
pub use evidence::Evidence;
pub use expression::Expression;
pub use inside::Inside;
pub use layers::{Hit, Layers, MAX_CROSSINGS, MAX_TRIANGLES};
pub use raster::{MAX_VOXELS, SNAP_BITS, rasterise, snap};
pub use spans::{Balance, Operands, Spans, TIE, balance, spans};
pub(crate) use spans::{Facing, facing};
pub use thin::{Lengths, THIN, ThinPlace, lengths, thin_places, widths};

use rayon::prelude::*;

use crate::lattice::{DIRECTIONS, Lattice};
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// The LDIs of `soup` in all 13 directions, `factor` (1 or 2) rays per voxel along each axis.
/// Rays that pass the lattice are left out; the later stages expect that it holds the whole soup, as
/// [`Lattice::around`] sees to. At most [`MAX_VOXELS`] a side, [`MAX_TRIANGLES`] and
/// [`MAX_CROSSINGS`]; the pipelines refuse what is beyond.
pub fn ldis(soup: &TriMesh, lattice: &Lattice, factor: u32, progress: &Progress) -> Result<Vec<Layers>, Stopped> {
    let vertices = snap(&soup.positions, lattice);
    DIRECTIONS
        .par_iter()
        .map(|&direction| rasterise(&vertices, &soup.triangles, lattice.dims, direction, factor, progress))
        .collect()
}
