//! From a tile of 32³ voxels down to single voxels: lists of the features that can be nearest, which shrink from
//! block to block.

use glam::{DVec3, IVec3, Vec3};

use super::feature::Features;
use super::quads::{Eight, Local, LocalEdge, LocalFace, LocalVertex, Sides};
use crate::lattice::{BRICK, BRICK_VOXELS};

/// Voxels along one side of a tile.
pub(super) const TILE: i32 = 32;
/// Levels from a tile to its blocks of two voxels.
const LEVELS: usize = 5;
/// With so few features in a brick's, or in a 4³ block's list, measuring them everywhere is faster than
/// finding out where they count.
const FEW_IN_BRICK: usize = 5;
const FEW_IN_BLOCK: usize = 12;
/// Two surfaces of which opposite sides are seen, at distances closer together than this (in h, and as a
/// share of the distance), are too close to tell the side by single precision.
const DOUBT: f32 = 3e-5;
const DOUBT_SHARE: f32 = 1e-6;
/// Features are passed over when they are farther than the nearest by more than this, in h.
const SLACK: f32 = 1e-3;
const ROOT_3: f32 = 1.732_051;

/// Numbers of the features that matter to a block.
#[derive(Debug, Default, Clone)]
pub(super) struct Lists {
    pub faces: Vec<u32>,
    pub edges: Vec<u32>,
    pub vertices: Vec<u32>,
}

impl Lists {
    pub(super) fn len(&self) -> usize {
        self.faces.len() + self.edges.len() + self.vertices.len()
    }
}

/// One brick that has voxels in the band.
pub(super) struct Filled {
    pub brick: IVec3,
    /// Signed distances in h; infinite beyond the band.
    pub values: Box<[f32; BRICK_VOXELS]>,
    /// Voxels whose side single precision cannot tell.
    pub doubtful: Vec<u16>,
}

/// A feature as eight blocks see it.
#[derive(Debug, Clone, Copy)]
struct Seen {
    id: u32,
    mask: u32,
    square: [f32; 8],
}

/// The lists of one block, and what its children see of them.
#[derive(Default)]
struct Level {
    lists: Lists,
    seen: [Vec<Seen>; 3],
}

/// Works through tiles, one after another; keeps its memory between them.
#[derive(Default)]
pub(super) struct Worker {
    levels: [Level; LEVELS],
    faces: Vec<LocalFace>,
    edges: Vec<LocalEdge>,
    vertices: Vec<LocalVertex>,
}

/// What all blocks of a tile share.
struct Tile<'a> {
    faces: &'a [LocalFace],
    edges: &'a [LocalEdge],
    vertices: &'a [LocalVertex],
    band: f32,
    /// First voxel, and the voxels after the last.
    base: IVec3,
    end: IVec3,
}

/// A block of a tile; `base` is its first voxel, counted from the tile's.
#[derive(Clone, Copy)]
struct Block {
    base: IVec3,
    size: i32,
}

impl Block {
    fn centre(self) -> Vec3 {
        (self.base.as_vec3() + 0.5 * (self.size - 1) as f32) - 0.5 * (TILE - 1) as f32
    }

    fn child(self, n: usize) -> Self {
        let size = self.size / 2;
        Self { base: self.base + IVec3::new(n as i32 & 1, n as i32 >> 1 & 1, n as i32 >> 2) * size, size }
    }
}

/// The voxels of a brick while they are found.
struct Voxels {
    values: Box<[f32; BRICK_VOXELS]>,
    doubtful: Vec<u16>,
    any: bool,
}

impl Worker {
    /// Adds the bricks of the tile at voxel `base` that have voxels within `band` (h). Only bricks before
    /// voxel `end` are wanted.
    pub(super) fn tile(
        &mut self,
        base: IVec3,
        end: IVec3,
        features: &Features,
        lists: &Lists,
        band: f32,
        out: &mut Vec<Filled>,
    ) {
        let centre = base.as_dvec3() + DVec3::splat(0.5 * f64::from(TILE - 1));
        refill(&mut self.faces, &lists.faces, |id| LocalFace::new(&features.faces[id], centre));
        refill(&mut self.edges, &lists.edges, |id| LocalEdge::new(&features.edges[id], centre));
        refill(&mut self.vertices, &lists.vertices, |id| LocalVertex::new(&features.vertices[id], centre));
        let tile =
            Tile { faces: &self.faces, edges: &self.edges, vertices: &self.vertices, band, base, end };
        let all = &mut self.levels[0].lists;
        refill_ids(&mut all.faces, lists.faces.len());
        refill_ids(&mut all.edges, lists.edges.len());
        refill_ids(&mut all.vertices, lists.vertices.len());
        tile.bricks(&mut self.levels, Block { base: IVec3::ZERO, size: TILE }, out);
    }
}

fn refill<T>(list: &mut Vec<T>, ids: &[u32], make: impl Fn(usize) -> T) {
    list.clear();
    list.extend(ids.iter().map(|&id| make(id as usize)));
}

fn refill_ids(list: &mut Vec<u32>, count: usize) {
    list.clear();
    list.extend(0..count as u32);
}

impl Tile<'_> {
    /// Goes down to the bricks of `block`, whose lists are in the first of `levels`.
    fn bricks(&self, levels: &mut [Level], block: Block, out: &mut Vec<Filled>) {
        if block.size == BRICK {
            let mut voxels =
                Voxels { values: Box::new([f32::INFINITY; BRICK_VOXELS]), doubtful: Vec::new(), any: false };
            self.voxels(levels, block, &mut voxels);
            if voxels.any {
                let brick = (self.base + block.base) / BRICK;
                voxels.doubtful.sort_unstable();
                out.push(Filled { brick, values: voxels.values, doubtful: voxels.doubtful });
            }
            return;
        }
        self.children(levels, block, |tile, levels, child| {
            if (tile.base + child.base).cmplt(tile.end).all() {
                tile.bricks(levels, child, out);
            }
        });
    }

    /// Fills the voxels of `block`, which lies within one brick.
    fn voxels(&self, levels: &mut [Level], block: Block, voxels: &mut Voxels) {
        let few = match block.size {
            2 => usize::MAX,
            4 => FEW_IN_BLOCK,
            _ => FEW_IN_BRICK,
        };
        if levels[0].lists.len() <= few {
            self.measure_all(&levels[0].lists, block, voxels);
        } else {
            self.children(levels, block, |tile, levels, child| tile.voxels(levels, child, voxels));
        }
    }

    /// Calls `visit` for each child of `block` that comes near the band, with its lists.
    fn children(&self, levels: &mut [Level], block: Block, mut visit: impl FnMut(&Self, &mut [Level], Block)) {
        let Some((this, below)) = levels.split_first_mut() else { return };
        let size = block.size / 2;
        let (step, half) = (0.5 * size as f32, 0.5 * (size - 1) as f32);
        let eight = Eight::new(block.centre(), step);
        let mut nearest = [f32::INFINITY; 8];
        let Level { lists, seen } = this;
        look(self.faces, &lists.faces, &eight, half, &mut seen[0], &mut nearest);
        look(self.edges, &lists.edges, &eight, half, &mut seen[1], &mut nearest);
        look(self.vertices, &lists.vertices, &eight, half, &mut seen[2], &mut nearest);
        let radius = ROOT_3 * half;
        for n in 0..8 {
            // Whatever is nearest to a voxel of the child is no farther from its centre than this.
            let most = (nearest[n].sqrt() + radius).min(self.band) + radius + SLACK;
            let lists = &mut below[0].lists;
            pick(&seen[0], n, most * most, &mut lists.faces);
            pick(&seen[1], n, most * most, &mut lists.edges);
            pick(&seen[2], n, most * most, &mut lists.vertices);
            if lists.len() > 0 {
                visit(self, below, block.child(n));
            }
        }
    }

    /// Measures all features of the lists at all voxels of `block`.
    fn measure_all(&self, lists: &Lists, block: Block, voxels: &mut Voxels) {
        let pairs = block.size / 2;
        for n in 0..pairs * pairs * pairs {
            let base = block.base + 2 * IVec3::new(n % pairs, n / pairs % pairs, n / (pairs * pairs));
            let eight = Eight::new(Block { base, size: 2 }.centre(), 0.5);
            let mut best = Sides::NONE;
            lists.faces.iter().for_each(|&id| self.faces[id as usize].measure(&eight, DOUBT, &mut best));
            lists.edges.iter().for_each(|&id| self.edges[id as usize].measure(&eight, DOUBT, &mut best));
            lists.vertices.iter().for_each(|&id| self.vertices[id as usize].measure(&eight, DOUBT, &mut best));
            voxels.store(base & (BRICK - 1), &best, self.band);
        }
    }
}

impl Voxels {
    /// Takes the eight voxels from `base`, counted from the brick's first, on.
    #[inline]
    fn store(&mut self, base: IVec3, best: &Sides, band: f32) {
        for half in 0..2 {
            let (outer, inner) = (best.outer[half], best.inner[half]);
            let distances = outer.min(inner).sqrt().to_array();
            let (outer, inner) = (outer.to_array(), inner.to_array());
            let first = (base.x | base.y << 3 | (base.z + half as i32) << 6) as usize;
            for (n, offset) in [0, 1, 8, 9].into_iter().enumerate() {
                let distance = distances[n];
                if distance > band {
                    continue;
                }
                self.any = true;
                self.values[first + offset] = if inner[n] < outer[n] { -distance } else { distance };
                let doubt = DOUBT + DOUBT_SHARE * distance;
                if (inner[n] - outer[n]).abs() <= doubt * (2.0 * distance + doubt) {
                    self.doubtful.push((first + offset) as u16);
                }
            }
        }
    }
}

/// Notes which of the features `ids` the eight blocks see, and the distance of the nearest to each centre.
fn look<L: Local>(all: &[L], ids: &[u32], eight: &Eight, half: f32, seen: &mut Vec<Seen>, nearest: &mut [f32; 8]) {
    seen.clear();
    let mut best = [glam::Vec4::INFINITY; 2];
    for &id in ids {
        let look = all[id as usize].look(eight, half);
        let mask = look.meets[0].bitmask() | look.meets[1].bitmask() << 4;
        if mask == 0 {
            continue;
        }
        for k in 0..2 {
            best[k] = best[k].min(glam::Vec4::select(look.true_at[k], look.square[k], glam::Vec4::INFINITY));
        }
        let mut square = [0.0; 8];
        square[..4].copy_from_slice(&look.square[0].to_array());
        square[4..].copy_from_slice(&look.square[1].to_array());
        seen.push(Seen { id, mask, square });
    }
    for (n, nearest) in nearest.iter_mut().enumerate() {
        *nearest = nearest.min(best[n / 4][n % 4]);
    }
}

/// The features that block `n` of eight sees at a square distance of at most `most`.
#[inline]
fn pick(seen: &[Seen], n: usize, most: f32, ids: &mut Vec<u32>) {
    ids.clear();
    ids.extend(seen.iter().filter(|seen| seen.mask >> n & 1 == 1 && seen.square[n] <= most).map(|seen| seen.id));
}
