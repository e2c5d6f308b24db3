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

use std::sync::{Arc, OnceLock};

use crate::lattice::{DIRECTIONS, Lattice};
use crate::ldi::{Crossed, Layers, assemble, snap};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use run::Run;
use scatter::Arrived;
use scene::Beam;

/// How crossings are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum GpuMethod {
    /// Depth peeling, as the paper does: a pass over the triangles for each layer.
    Peel,
    /// Two compute passes over the triangles, whatever the number of layers: one counts the crossings of each ray, one writes them; all directions at
    /// once, as far as buffers hold them.
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
    /// Seconds of these until the device had sent all; what is left is the main processor's.
    pub sent: f64,
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
    let chunks = scene::upload(&mut run, &vertices, &soup.triangles, options)?;
    let finished: [OnceLock<Option<Layers>>; DIRECTIONS.len()] = Default::default();
    let windows = DIRECTIONS.map(|direction| {
        let (low, size) = Layers::window(direction, lattice.dims, factor);
        (Beam { direction, factor }, low, size)
    });
    let finish = |direction: usize, crossed: &[Crossed<'_>]| {
        let layers = assemble(&vertices, &soup.triangles, lattice.dims, DIRECTIONS[direction], factor, crossed);
        // The place is empty: each direction comes once.
        let _ = finished[direction].set(layers);
    };
    // The device finds more crossings while the processor computes the depths of those before.
    rayon::in_place_scope(|scope| {
        progress.check()?;
        match options.method {
            GpuMethod::Peel => {
                for (direction, &(beam, low, size)) in windows.iter().enumerate() {
                    let crossed = device.peel().crossed(&mut run, &chunks, beam, (low, size), &options.limits)?;
                    scope.spawn(move |_| finish(direction, &crossed));
                }
                Ok(())
            }
            GpuMethod::Scatter => {
                let mut waiting = windows.map(|(.., size)| Waiting::new(size));
                device.scatter().crossed(&mut run, &chunks, &windows, &options.limits, |arrived| {
                    for (n, (direction, rays)) in arrived.tiles().enumerate() {
                        let Some(parts) = waiting[direction].add(&arrived, n, rays) else { continue };
                        scope.spawn(move |_| {
                            let crossed: Option<Vec<_>> = parts.iter().map(|(part, n)| part.crossed(*n)).collect();
                            finish(direction, &crossed.unwrap_or_default());
                        });
                    }
                })
            }
        }
    })?;
    let layers = finished
        .into_iter()
        .enumerate()
        .map(|(direction, layers)| layers.into_inner().flatten().ok_or(GpuError::Nonsense { direction }));
    let layers = layers.collect::<Result<_, _>>()?;
    Ok((layers, run.report()))
}

/// A direction of which not all tiles have arrived.
struct Waiting {
    rays: u64,
    parts: Vec<(Arc<Arrived>, usize)>,
}

impl Waiting {
    fn new(size: [i32; 2]) -> Self {
        Self { rays: size[0] as u64 * size[1] as u64, parts: Vec::new() }
    }

    /// Adds tile number `n` of what has arrived; all tiles, when it is the last.
    fn add(&mut self, arrived: &Arc<Arrived>, n: usize, rays: u64) -> Option<Vec<(Arc<Arrived>, usize)>> {
        self.rays -= rays;
        self.parts.push((arrived.clone(), n));
        (self.rays == 0).then(|| std::mem::take(&mut self.parts))
    }
}
