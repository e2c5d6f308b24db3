//! Layered depth images ([`ldis`]) and exact distances over a lattice ([`distances`]) on the graphics processor, through Vulkan.
//!
//! For layered depth images the device finds which triangles each ray crosses, with the same integers and the same rule for ties as
//! [`crate::ldi::rasterise`]; the depths are then computed here, by the same function. So the result is the same to the last
//! bit, on any device and in whatever order its threads run. There are two ways, see [`GpuMethod`].

mod adapters;
mod clock;
mod device;
mod error;
mod field;
mod peel;
mod programs;
mod run;
mod scan;
mod scatter;
mod scene;
mod setup;
mod shaders;
#[cfg(test)]
mod tests;

pub use adapters::{AdapterEntry, AdapterKind, Wanted, adapters};
pub use device::{Device, is_waiting};
pub use error::{GpuError, INSTALL};
pub use field::{FieldLimits, FieldOptions, GpuField, distances};

use std::sync::OnceLock;

use crate::lattice::{DIRECTIONS, Lattice};
use crate::ldi::{Layers, assemble, snap};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use run::Run;
use scene::Beam;

/// How crossings are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GpuMethod {
    /// Depth peeling, as the paper does: a pass over the triangles for each layer.
    Peel,
    /// Two passes over the triangles, whatever the number of layers: one counts the crossings of each ray, one writes them.
    #[default]
    Scatter,
}

/// Limits below those of the adapter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GpuLimits {
    /// Rays along a side of a tile.
    pub tile_side: u32,
    /// Triangles of a buffer.
    pub triangles: u32,
    /// Crossings of a tile; with more it is halved ([`GpuMethod::Scatter`]).
    pub crossings: u32,
}

impl Default for GpuLimits {
    /// Those of the adapter.
    fn default() -> Self {
        Self { tile_side: u32::MAX, triangles: u32::MAX, crossings: u32::MAX }
    }
}

/// Options of [`ldis`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GpuOptions {
    /// How crossings are found.
    pub method: GpuMethod,
    /// Limits below those of the adapter.
    pub limits: GpuLimits,
    /// Whether passes are timed, where the adapter can.
    pub timings: bool,
}

/// Time on the device of all passes of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct PassTime {
    /// What the passes do.
    pub pass: &'static str,
    /// How many there were.
    pub count: usize,
    /// Seconds of all of them.
    pub seconds: f64,
    /// Seconds of these until the device had sent all; what is left is the main processor's.
    pub sent: f64,
}

/// What a job moved, and how long its passes took.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GpuReport {
    /// Bytes sent to the device.
    pub bytes_up: u64,
    /// Bytes read back.
    pub bytes_down: u64,
    /// Times, when they were asked for.
    pub passes: Vec<PassTime>,
    /// Seconds until the result was there, with all that either processor did, without opening the device.
    pub seconds: f64,
}

/// The LDIs of `soup` in all 13 directions: what [`crate::ldi::ldis`] gives, to the last bit.
pub fn ldis(
    device: &Device,
    soup: &TriMesh,
    lattice: &Lattice,
    factor: u32,
    options: &GpuOptions,
    progress: &Progress,
) -> Result<(Vec<Layers>, GpuReport), GpuError> {
    device.check_can(options.method)?;
    let vertices = snap(&soup.positions, lattice);
    let mut run = Run::new(device, options.timings, progress);
    let chunks = scene::upload(&mut run, &vertices, &soup.triangles, &options.limits)?;
    let finished: [OnceLock<Option<Layers>>; DIRECTIONS.len()] = Default::default();
    // The device finds the next direction's crossings while the processor computes this one's depths.
    rayon::in_place_scope(|scope| {
        for (&direction, finished) in DIRECTIONS.iter().zip(&finished) {
            progress.check()?;
            let window = Layers::window(direction, lattice.dims, factor);
            let beam = Beam { direction, factor };
            let crossed = match options.method {
                GpuMethod::Peel => device.peel().crossed(&mut run, &chunks, beam, window, &options.limits)?,
                GpuMethod::Scatter => device.scatter().crossed(&mut run, &chunks, beam, window, &options.limits)?,
            };
            let (vertices, triangles) = (&vertices, &soup.triangles);
            scope.spawn(move |_| {
                let layers = assemble(vertices, triangles, lattice.dims, direction, factor, &crossed);
                // The place is empty: each direction comes once.
                let _ = finished.set(layers);
            });
        }
        Ok::<(), GpuError>(())
    })?;
    let layers = finished
        .into_iter()
        .enumerate()
        .map(|(direction, layers)| layers.into_inner().flatten().ok_or(GpuError::Nonsense { direction }));
    let layers = layers.collect::<Result<_, _>>()?;
    Ok((layers, run.report()))
}
