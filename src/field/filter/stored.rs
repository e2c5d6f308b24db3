//! A field that is remembered: tiles of it, made where they are asked for.

use std::sync::{Arc, OnceLock, PoisonError, RwLock};

use glam::{DVec3, IVec3};
use rustc_hash::FxHashMap;

use super::tile::{CELLS, Tile};
use crate::field::{Cubes, Sample, Shared};

/// Parts of the memory that are locked one by one.
const SHARDS: usize = 64;
/// Tiles beyond this number from the origin are not made.
const FARTHEST: f64 = (1 << 30) as f64;

/// A field by interpolation. What it is at a place does not depend on what was asked before: tiles that find no room are
/// forgotten, and made again when they are asked for.
pub(super) struct Stored {
    cubes: Arc<dyn Cubes>,
    /// The edge of the cells, model units.
    edge: f64,
    shards: Vec<Shard>,
    /// Bytes that a shard may hold.
    most: usize,
}

/// A place for a tile: who comes while it is made waits for it.
type Place = Arc<OnceLock<Option<Arc<Tile>>>>;

/// All tiles take as much memory.
#[derive(Default)]
struct Shard {
    places: RwLock<FxHashMap<IVec3, Place>>,
}

/// The tiles that were met last: those around a point have places of their own.
pub(super) struct Recent {
    tiles: [Option<(IVec3, Arc<Tile>)>; 8],
}

impl Default for Recent {
    fn default() -> Self {
        Self { tiles: [const { None }; 8] }
    }
}

impl Stored {
    /// Ready to remember `field` in cells of this edge, model units, in `memory` bytes; nothing where the field has no
    /// quick way to tell its values over a lattice.
    pub fn new(field: &Shared, edge: f64, memory: u64) -> Option<Self> {
        let cubes = field.over(DVec3::ZERO, edge)?;
        let most = usize::try_from(memory / SHARDS as u64).unwrap_or(usize::MAX);
        Some(Self { cubes, edge, shards: std::iter::repeat_with(Shard::default).take(SHARDS).collect(), most })
    }

    /// How far a value between the points may be off where the field is nowhere steeper than a distance, model units: as far
    /// as the corners of a cell are in the mean, at most half its diagonal, and half an edge for what is taken away.
    pub fn off(&self) -> f64 {
        (3f64.sqrt() + 1.0) / 2.0 * self.edge
    }

    /// The value at `p`; nothing far out, where tiles have no numbers, or where the field cannot tell.
    #[inline]
    pub fn value(&self, p: DVec3, recent: &mut Recent) -> Option<f64> {
        self.with(p, recent, |tile, at| tile.value(at))
    }

    /// Value and gradient at `p`.
    pub fn sample(&self, p: DVec3, recent: &mut Recent) -> Option<Sample> {
        self.with(p, recent, |tile, at| tile.sample(at, self.edge))
    }

    /// What `look` finds in the tile of `p`, at a place in it that is given in cells.
    #[inline]
    fn with<T>(&self, p: DVec3, recent: &mut Recent, look: impl Fn(&Tile, DVec3) -> T) -> Option<T> {
        let at = p / self.edge;
        let low = (at / f64::from(CELLS)).floor();
        // Also for what is no number.
        let near = low.abs().max_element() < FARTHEST;
        if !near {
            return None;
        }
        let key = low.as_ivec3();
        let place = &mut recent.tiles[(key.x & 1 | (key.y & 1) << 1 | (key.z & 1) << 2) as usize];
        if place.as_ref().is_none_or(|(known, _)| *known != key) {
            *place = Some((key, self.tile(key)?));
        }
        place.as_ref().map(|(_, tile)| look(tile, at - low * f64::from(CELLS)))
    }

    /// The tile of this number, made if it is not there.
    #[cold]
    fn tile(&self, key: IVec3) -> Option<Arc<Tile>> {
        let hash = (key.x.wrapping_mul(73) ^ key.y.wrapping_mul(179) ^ key.z.wrapping_mul(283)) as usize;
        self.place(&self.shards[hash % SHARDS], key)
            .get_or_init(|| Tile::new(&self.cubes.cube(key)?).map(Arc::new))
            .clone()
    }

    /// The place of a tile, one of a shard's if there is room for it.
    fn place(&self, shard: &Shard, key: IVec3) -> Place {
        let known = |places: &FxHashMap<IVec3, Place>| places.get(&key).cloned();
        if let Some(known) = known(&shard.places.read().unwrap_or_else(PoisonError::into_inner)) {
            return known;
        }
        let mut places = shard.places.write().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = known(&places) {
            return known;
        }
        let place = Place::default();
        let bytes = Tile::MEMORY + size_of::<(IVec3, Place)>();
        if (places.len() + 1) * bytes > self.most {
            places.clear();
        }
        if bytes <= self.most {
            places.insert(key, place.clone());
        }
        place
    }
}
