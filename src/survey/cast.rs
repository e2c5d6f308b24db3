//! Rays are cast at a soup, and decide which side of each patch is outside.

use super::Soup;
use crate::backend::{self, Backend, BackendError, BackendReport};
use crate::lattice::Lattice;
use crate::ldi::{Layers, ldis};
use crate::orient::OrientMode;
use crate::progress::{Progress, Stopped};
use crate::vote::Winding;

/// Options of [`Cast::of`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CastOptions {
    /// Whether patches are turned over as the rays say.
    pub orient: OrientMode,
    /// Which processor casts the rays.
    pub backend: Backend,
    /// How many crossings there will be, about: [`Backend::Auto`] goes by it.
    pub crossings: f64,
}

/// Rays and crossings of all directions.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RayCount {
    /// Rays that meet something.
    pub rays: usize,
    /// Crossings with triangles.
    pub hits: usize,
    /// The most crossings on one ray.
    pub layers: usize,
}

/// An oriented soup and every crossing of the lattice's rays with it.
#[derive(Debug, Clone)]
pub struct Cast {
    /// The operands, oriented.
    pub soup: Soup,
    /// The lattice whose rays were cast.
    pub lattice: Lattice,
    /// The layered depth images of all 13 directions (Bærentzen §3).
    pub layers: Vec<Layers>,
    /// How many rays and crossings there are.
    pub count: RayCount,
    /// The processor that found them.
    pub made_by: BackendReport,
}

impl Cast {
    /// Casts the rays of all directions, and turns patches over that face inwards.
    ///
    /// # Errors
    /// [`BackendError`] when the processor that was asked for cannot, or when stopped.
    pub fn of(soup: Soup, lattice: &Lattice, options: &CastOptions, progress: &Progress) -> Result<Self, BackendError> {
        let (layers, made_by) = backend::layers(&soup.mesh, lattice, options.backend, options.crossings, progress)?;
        Ok(Self { made_by, ..Self::turned(soup, lattice, layers, options.orient, progress)? })
    }

    /// The same on the main processor.
    ///
    /// # Errors
    /// [`Stopped`] alone.
    pub fn on_cpu(soup: Soup, lattice: &Lattice, orient: OrientMode, progress: &Progress) -> Result<Self, Stopped> {
        let layers = ldis(&soup.mesh, lattice, 1, progress)?;
        Self::turned(soup, lattice, layers, orient, progress)
    }

    fn turned(
        mut soup: Soup,
        lattice: &Lattice,
        mut layers: Vec<Layers>,
        orient: OrientMode,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        soup.turn_patches(&mut layers, orient, progress)?;
        let (count, made_by) = (count(&layers), BackendReport { backend: Backend::Cpu, ..BackendReport::default() });
        Ok(Self { soup, lattice: *lattice, layers, count, made_by })
    }

    /// The generalised winding numbers of the operands; its trees are made when they are first needed.
    pub fn winding(&self, progress: &Progress) -> Winding<'_> {
        Winding::new(&self.soup.mesh, &self.soup.operands, &self.lattice, progress)
    }
}

fn count(layers: &[Layers]) -> RayCount {
    layers.iter().fold(RayCount::default(), |count, layers| RayCount {
        rays: count.rays + layers.offsets.windows(2).filter(|w| w[1] > w[0]).count(),
        hits: count.hits + layers.hits.len(),
        layers: count.layers.max(layers.deepest()),
    })
}
