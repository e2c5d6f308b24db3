//! Which features matter to which tile: blocks about as large as the band first, halved down to tiles of 32³ voxels.

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::descend::{Filled, Lists, TILE, Worker};
use super::feature::{EdgeFeature, FaceFeature, Features, VertexFeature};
use crate::lattice::BRICK;
use crate::progress::{Progress, Stopped};

/// Regions are larger by this, in h.
pub(crate) const MARGIN: f64 = 1e-3;
/// Where faces bend less than by this sine, rounding may turn the direction in which they do.
const SLIGHT: f64 = 1e-6;
/// Features that one task sorts into blocks.
const CHUNK: usize = 1 << 12;
/// At most so many blocks along an axis to begin with.
const MOST_BLOCKS: i32 = 128;

/// The lattice in voxels, and the width of the band.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scope {
    /// The voxels after the last.
    pub end: IVec3,
    /// In h; finite.
    pub band: f64,
    /// The first plane of z that is wanted and the one after the last, multiples of eight.
    pub planes: [i32; 2],
}

impl Scope {
    /// Whether cubes of `size` voxels from the plane `low` of z on have planes that are wanted.
    pub(crate) fn wants(&self, low: i32, size: i32) -> bool {
        low < self.planes[1] && low.saturating_add(size) > self.planes[0]
    }
}

/// A cube of voxels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block {
    pub base: IVec3,
    pub size: i32,
}

impl Block {
    fn half(self) -> f64 {
        0.5 * f64::from(self.size - 1)
    }

    pub fn centre(self) -> DVec3 {
        self.base.as_dvec3() + self.half()
    }

    fn children(self) -> impl Iterator<Item = Self> {
        let size = self.size / 2;
        (0..8).map(move |n| Self { base: self.base + IVec3::new(n & 1, n >> 1 & 1, n >> 2) * size, size })
    }
}

/// What a feature is to a block.
pub(crate) struct Seen {
    /// A lower bound of its distance from the centre, h.
    least: f64,
    /// Its distance from the centre where it is certain, else infinite.
    distance: f64,
}

/// A feature whose region may meet a block.
pub(crate) trait Region: Sync {
    /// What it is to the block of half-width `half` around `centre`; `None` where its region lies outside.
    fn seen(&self, centre: DVec3, half: f64) -> Option<Seen>;
    /// The box around the part of the region within `band`.
    fn bounds(&self, band: f64) -> [DVec3; 2];
}

/// Whether the block around `from` (seen from a point of the plane) reaches the inner side of a plane.
fn reaches(inner: DVec3, from: DVec3, half: f64) -> bool {
    inner.dot(from) >= -MARGIN - half * inner.abs().element_sum()
}

impl Region for FaceFeature {
    fn seen(&self, centre: DVec3, half: f64) -> Option<Seen> {
        let from = self.corners.map(|corner| centre - corner);
        if !(0..3).all(|k| reaches(self.inner[k], from[k], half)) {
            return None;
        }
        let least = self.normal.dot(from[0]).abs();
        let over = (0..3).all(|k| self.inner[k].dot(from[k]) >= 0.0);
        Some(Seen { least, distance: if over { least } else { f64::INFINITY } })
    }

    fn bounds(&self, band: f64) -> [DVec3; 2] {
        let [a, b, c] = self.corners;
        let up = band * self.normal.abs();
        [a.min(b).min(c) - up, a.max(b).max(c) + up]
    }
}

impl Region for EdgeFeature {
    fn seen(&self, centre: DVec3, half: f64) -> Option<Seen> {
        let from = centre - self.start;
        let along = self.along.dot(from);
        let growth = MARGIN + half * self.along.abs().element_sum();
        let outside = along < -growth || along > self.length + growth;
        if outside || !self.sides.iter().all(|&side| reaches(-side, from, half)) {
            return None;
        }
        let nearest = from - self.along * along.clamp(0.0, self.length);
        Some(Seen { least: (from - self.along * along).length(), distance: nearest.length() })
    }

    fn bounds(&self, band: f64) -> [DVec3; 2] {
        let end = self.start + self.along * self.length;
        let (low, high) = (self.start.min(end), self.start.max(end));
        let bend = -(self.sides[0] + self.sides[1]);
        let sine = 0.5 * bend.length();
        if self.sides.contains(&DVec3::ZERO) || sine < SLIGHT {
            return [low - band, high + band];
        }
        // Directions of the wedge: as far from its axis, turned about the edge, as the faces bend.
        let axis = bend / (2.0 * sine);
        let aside = sine * self.along.cross(axis).abs();
        let least = axis * (1.0 - sine * sine).max(0.0).sqrt();
        [
            low + band * (axis.min(least).min(DVec3::ZERO) - aside),
            high + band * (axis.max(least).max(DVec3::ZERO) + aside),
        ]
    }
}

impl Region for VertexFeature {
    fn seen(&self, centre: DVec3, half: f64) -> Option<Seen> {
        let from = centre - self.at;
        let distance = self.sides.iter().all(|&side| reaches(-side, from, half)).then(|| from.length())?;
        Some(Seen { least: distance, distance })
    }

    fn bounds(&self, band: f64) -> [DVec3; 2] {
        [self.at - band, self.at + band]
    }
}

/// All bricks that have voxels in the band, in no particular but always the same order.
pub(super) fn bricks(features: &Features, scope: &Scope, progress: &Progress) -> Result<Vec<Filled>, Stopped> {
    let longest = scope.end.max_element();
    let mut size = TILE;
    while size < longest && (f64::from(size) < scope.band || longest / size >= MOST_BLOCKS) {
        size *= 2;
    }
    let grid = Blocks { size, counts: (scope.end + size - 1) / size };
    let faces = grid.sorted(&features.faces, scope.band, progress)?;
    let edges = grid.sorted(&features.edges, scope.band, progress)?;
    let vertices = grid.sorted(&features.vertices, scope.band, progress)?;
    let count = grid.counts.element_product() as usize;
    let done = std::sync::atomic::AtomicUsize::new(0);
    let work = |worker: &mut Worker, n: usize| {
        let lists = Lists { faces: faces.of(n), edges: edges.of(n), vertices: vertices.of(n) };
        let found = halve(&grid.block(n), lists, features, scope, worker, progress);
        let done = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        progress.share(done as f32 / count as f32);
        found
    };
    let parts: Vec<Vec<Filled>> =
        (0..count).into_par_iter().map_init(Worker::default, work).collect::<Result<_, _>>()?;
    Ok(parts.into_iter().flatten().collect())
}

/// The bricks of `block`, which needs no features but those in `lists`.
fn halve(
    block: &Block,
    lists: Lists,
    features: &Features,
    scope: &Scope,
    worker: &mut Worker,
    progress: &Progress,
) -> Result<Vec<Filled>, Stopped> {
    progress.check()?;
    let mut out = Vec::new();
    if lists.len() == 0 || block.base.cmpge(scope.end).any() || !scope.wants(block.base.z, block.size) {
        return Ok(out);
    }
    if block.size == TILE {
        worker.tile(block.base, scope.end, features, &lists, scope.band as f32, &mut out);
        out.retain(|filled| scope.wants(filled.brick.z * BRICK, BRICK));
        return Ok(out);
    }
    let children: Vec<Block> = block.children().collect();
    let work = |worker: &mut Worker, child: &Block| {
        halve(child, lists_of(child, &lists, features, scope), features, scope, worker, progress)
    };
    let parts: Vec<Vec<Filled>> = children.par_iter().map_init(Worker::default, work).collect::<Result<_, _>>()?;
    Ok(parts.into_iter().flatten().collect())
}

/// Those of `lists` that can be nearest to a voxel of `block`.
pub(super) fn lists_of(block: &Block, lists: &Lists, features: &Features, scope: &Scope) -> Lists {
    let (centre, half) = (block.centre(), block.half());
    let faces = seen(&features.faces, &lists.faces, centre, half);
    let edges = seen(&features.edges, &lists.edges, centre, half);
    let vertices = seen(&features.vertices, &lists.vertices, centre, half);
    let radius = half * 3f64.sqrt();
    let nearest = [&faces, &edges, &vertices].into_iter().flatten().map(|(_, seen)| seen.distance);
    let nearest = nearest.fold(f64::INFINITY, f64::min);
    let most = (nearest + radius).min(scope.band) + radius + MARGIN;
    let keep =
        |all: Vec<(u32, Seen)>| all.into_iter().filter(|(_, seen)| seen.least <= most).map(|(id, _)| id).collect();
    Lists { faces: keep(faces), edges: keep(edges), vertices: keep(vertices) }
}

fn seen<R: Region>(all: &[R], ids: &[u32], centre: DVec3, half: f64) -> Vec<(u32, Seen)> {
    ids.iter().filter_map(|&id| Some((id, all[id as usize].seen(centre, half)?))).collect()
}

/// A grid of blocks of the same size over the lattice.
struct Blocks {
    size: i32,
    counts: IVec3,
}

/// The features of each block.
struct Sorted {
    starts: Vec<usize>,
    ids: Vec<u32>,
}

impl Sorted {
    fn of(&self, block: usize) -> Vec<u32> {
        self.ids[self.starts[block]..self.starts[block + 1]].to_vec()
    }
}

impl Blocks {
    fn block(&self, n: usize) -> Block {
        let (x, y) = (self.counts.x as usize, self.counts.y as usize);
        let at = [n % x, n / x % y, n / (x * y)].map(|k| k as i32);
        Block { base: IVec3::from(at) * self.size, size: self.size }
    }

    /// The features whose regions meet each block within `band`.
    fn sorted<R: Region>(&self, all: &[R], band: f64, progress: &Progress) -> Result<Sorted, Stopped> {
        let count = self.counts.element_product() as usize;
        let chunks: Vec<Vec<(u32, u32)>> = all
            .par_chunks(CHUNK)
            .enumerate()
            .map(|(n, chunk)| {
                progress.check()?;
                let mut pairs = Vec::new();
                for (k, region) in chunk.iter().enumerate() {
                    self.blocks_of(region, band, |block| pairs.push((block, (n * CHUNK + k) as u32)));
                }
                Ok(pairs)
            })
            .collect::<Result<_, Stopped>>()?;
        let mut starts = vec![0usize; count + 1];
        chunks.iter().flatten().for_each(|&(block, _)| starts[block as usize + 1] += 1);
        (0..count).for_each(|n| starts[n + 1] += starts[n]);
        let mut fill = starts.clone();
        let mut ids = vec![0u32; starts[count]];
        for (block, id) in chunks.into_iter().flatten() {
            ids[fill[block as usize]] = id;
            fill[block as usize] += 1;
        }
        Ok(Sorted { starts, ids })
    }

    fn blocks_of<R: Region>(&self, region: &R, band: f64, mut visit: impl FnMut(u32)) {
        let size = f64::from(self.size);
        let [low, high] = region.bounds(band);
        // A block holds voxels from its base to its base + size - 1.
        let first = ((low - MARGIN - size + 1.0) / size).ceil().max(DVec3::ZERO).as_ivec3();
        let last = ((high + MARGIN) / size).floor().min((self.counts - 1).as_dvec3()).as_ivec3();
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let block = Block { base: IVec3::new(x, y, z) * self.size, size: self.size };
                    let radius = block.half() * 3f64.sqrt();
                    let seen = region.seen(block.centre(), block.half());
                    if seen.is_some_and(|seen| seen.least <= band + radius + MARGIN) {
                        visit(((z * self.counts.y + y) * self.counts.x + x) as u32);
                    }
                }
            }
        }
    }
}
