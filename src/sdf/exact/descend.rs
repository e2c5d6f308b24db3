//! From a tile of 32³ voxels down to single voxels: lists of the features that can be nearest, which shrink from
//! block to block.

use glam::{DVec3, IVec3, Vec3, Vec4};

use super::feature::Features;
use super::quads::{Eight, Local, LocalEdge, LocalFace, LocalVertex, NearestSides};
use crate::lattice::{BRICK, BRICK_VOXELS, brick_of, index_in_brick};

/// Voxels along one side of a tile.
pub(super) const TILE: i32 = 32;
/// Levels from a tile to its blocks of two voxels.
const LEVELS: usize = 5;
/// With so few features in a brick's, or in a 4³ block's list, measuring them everywhere is faster than
/// finding out where they count.
const FEW_IN_BRICK: usize = 5;
const FEW_IN_BLOCK: usize = 14;
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
    /// All features.
    pub(super) fn all(features: &Features) -> Self {
        let all = |count: usize| (0..count as u32).collect();
        Self {
            faces: all(features.faces.len()),
            edges: all(features.edges.len()),
            vertices: all(features.vertices.len()),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.faces.len() + self.edges.len() + self.vertices.len()
    }
}

/// One brick that has voxels in the band.
pub(crate) struct Filled {
    pub brick: IVec3,
    /// Signed distances in h; infinite beyond the band.
    pub values: Box<[f32; BRICK_VOXELS]>,
}

/// A feature as eight blocks see it: which of them its region meets, and the squares of its distances.
#[derive(Debug, Clone, Copy)]
struct Seen {
    id: u32,
    mask: u32,
    squares: [Vec4; 2],
}

/// Numbers of features, of which the first `count` matter; the rest is room for more.
#[derive(Debug, Default)]
struct Ids {
    ids: Vec<u32>,
    count: usize,
}

/// The lists of one block, and room to find those of its children.
#[derive(Default)]
struct BlockLists {
    faces: Ids,
    edges: Ids,
    vertices: Ids,
    seen: [Vec<Seen>; 3],
    /// Features, and bit by bit the children that they matter to.
    shared: [Vec<(u32, u32)>; 3],
}

impl BlockLists {
    fn len(&self) -> usize {
        self.faces.count + self.edges.count + self.vertices.count
    }
}

impl Ids {
    fn all(&mut self, count: usize) {
        self.ids.clear();
        self.ids.extend(0..count as u32);
        self.count = count;
    }

    fn list(&self) -> &[u32] {
        &self.ids[..self.count]
    }

    /// The features that matter to child `n`. Without a branch on that: it could not be foretold.
    #[inline]
    fn pick(&mut self, shared: &[(u32, u32)], n: usize) {
        if self.ids.len() < shared.len() {
            self.ids.resize(shared.len(), 0);
        }
        let mut count = 0;
        for &(id, mask) in shared {
            self.ids[count] = id;
            count += (mask >> n & 1) as usize;
        }
        self.count = count;
    }
}

/// Works through tiles, one after another; keeps its memory between them.
#[derive(Default)]
pub(super) struct Worker {
    levels: [BlockLists; LEVELS],
    faces: Vec<LocalFace>,
    edges: Vec<LocalEdge>,
    vertices: Vec<LocalVertex>,
}

/// What all blocks of a tile share.
struct TileFeatures<'a> {
    faces: &'a [LocalFace],
    edges: &'a [LocalEdge],
    vertices: &'a [LocalVertex],
    /// The same in double precision, and the numbers they have there.
    features: &'a Features,
    ids: &'a Lists,
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
        Self { base: self.base + voxel_in_pair(n as i32) * size, size }
    }
}

/// The voxels of a brick while they are found.
struct Voxels {
    values: Box<[f32; BRICK_VOXELS]>,
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
        let Self { faces, edges, vertices, .. } = self;
        let tile = TileFeatures { faces, edges, vertices, features, ids: lists, band, base, end };
        let top = &mut self.levels[0];
        top.faces.all(lists.faces.len());
        top.edges.all(lists.edges.len());
        top.vertices.all(lists.vertices.len());
        tile.bricks(&mut self.levels, Block { base: IVec3::ZERO, size: TILE }, out);
    }
}

fn refill<T>(list: &mut Vec<T>, ids: &[u32], make: impl Fn(usize) -> T) {
    list.clear();
    list.extend(ids.iter().map(|&id| make(id as usize)));
}

impl TileFeatures<'_> {
    /// Goes down to the bricks of `block`, whose lists are in the first of `levels`.
    fn bricks(&self, levels: &mut [BlockLists], block: Block, out: &mut Vec<Filled>) {
        if block.size == BRICK {
            let mut voxels = Voxels { values: Box::new([f32::INFINITY; BRICK_VOXELS]), any: false };
            self.voxels(levels, block, &mut voxels);
            if voxels.any {
                out.push(Filled { brick: brick_of(self.base + block.base), values: voxels.values });
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
    fn voxels(&self, levels: &mut [BlockLists], block: Block, voxels: &mut Voxels) {
        let few = match block.size {
            2 => usize::MAX,
            4 => FEW_IN_BLOCK,
            _ => FEW_IN_BRICK,
        };
        if levels[0].len() <= few {
            self.measure_all(&levels[0], block, voxels);
        } else {
            self.children(levels, block, |tile, levels, child| tile.voxels(levels, child, voxels));
        }
    }

    /// Calls `visit` for each child of `block` that comes near the band, with its lists.
    fn children(
        &self,
        levels: &mut [BlockLists],
        block: Block,
        mut visit: impl FnMut(&Self, &mut [BlockLists], Block),
    ) {
        let Some((this, below)) = levels.split_first_mut() else { return };
        let size = block.size / 2;
        let (step, half) = (0.5 * size as f32, 0.5 * (size - 1) as f32);
        let eight = Eight::new(block.centre(), step);
        let mut nearest = [Vec4::INFINITY; 2];
        let BlockLists { faces, edges, vertices, seen, shared } = this;
        look(self.faces, faces.list(), &eight, half, &mut seen[0], &mut nearest);
        look(self.edges, edges.list(), &eight, half, &mut seen[1], &mut nearest);
        look(self.vertices, vertices.list(), &eight, half, &mut seen[2], &mut nearest);
        // Whatever is nearest to a voxel of a child is no farther from the child's centre than this.
        let radius = Vec4::splat(ROOT_3 * half);
        let most = nearest.map(|square| (square.sqrt() + radius).min(Vec4::splat(self.band)) + radius + SLACK);
        let most = most.map(|most| most * most);
        let mut any = 0;
        for (seen, shared) in seen.iter().zip(&mut *shared) {
            any |= share(seen, most, shared);
        }
        for n in (0..8).filter(|n| any >> n & 1 == 1) {
            below[0].faces.pick(&shared[0], n);
            below[0].edges.pick(&shared[1], n);
            below[0].vertices.pick(&shared[2], n);
            visit(self, below, block.child(n));
        }
    }

    /// Measures all features of the lists at all voxels of `block`.
    fn measure_all(&self, lists: &BlockLists, block: Block, voxels: &mut Voxels) {
        let pairs = block.size / 2;
        for n in 0..pairs * pairs * pairs {
            let base = block.base + 2 * IVec3::new(n % pairs, n / pairs % pairs, n / (pairs * pairs));
            let eight = Eight::new(Block { base, size: 2 }.centre(), 0.5);
            let mut best = NearestSides::NONE;
            lists.faces.list().iter().for_each(|&id| self.faces[id as usize].measure(&eight, DOUBT, &mut best));
            lists.edges.list().iter().for_each(|&id| self.edges[id as usize].measure(&eight, DOUBT, &mut best));
            lists.vertices.list().iter().for_each(|&id| self.vertices[id as usize].measure(&eight, DOUBT, &mut best));
            let mut doubtful = voxels.store(base & (BRICK - 1), &best, self.band);
            while doubtful != 0 {
                let offset = voxel_in_pair(doubtful.trailing_zeros() as i32);
                self.decide(lists, base + offset, voxels);
                doubtful &= doubtful - 1;
            }
        }
    }

    /// Measures a voxel again in double precision, which tells its side.
    fn decide(&self, lists: &BlockLists, voxel: IVec3, voxels: &mut Voxels) {
        let p = (self.base + voxel).as_dvec3();
        let faces = lists.faces.list().iter().map(|&id| self.ids.faces[id as usize]);
        let edges = lists.edges.list().iter().map(|&id| self.ids.edges[id as usize]);
        let vertices = lists.vertices.list().iter().map(|&id| self.ids.vertices[id as usize]);
        if let Some(signed) = self.features.signed(p, faces, edges, vertices) {
            voxels.values[index_in_brick(voxel)] = signed as f32;
        }
    }
}

impl Voxels {
    /// Takes the eight voxels from `base`, counted from the brick's first, on. Returns those, bit by bit, whose side
    /// single precision cannot tell.
    #[inline]
    fn store(&mut self, base: IVec3, best: &NearestSides, band: f32) -> u32 {
        let mut doubtful = 0;
        for half in 0..2 {
            let (outer, inner) = (best.outer[half], best.inner[half]);
            let distance = outer.min(inner).sqrt();
            let doubt = distance * DOUBT_SHARE + DOUBT;
            let close = (inner - outer).abs().cmple(doubt * (distance * 2.0 + doubt));
            let within = distance.cmple(Vec4::splat(band)).bitmask();
            let signed = Vec4::select(inner.cmplt(outer), -distance, distance);
            let signed = Vec4::select(distance.cmple(Vec4::splat(band)), signed, Vec4::INFINITY).to_array();
            let first = index_in_brick(base + IVec3::new(0, 0, half as i32));
            for (n, offset) in [0, 1, 8, 9].into_iter().enumerate() {
                self.values[first + offset] = signed[n];
            }
            self.any |= within != 0;
            doubtful |= (close.bitmask() & within) << (4 * half);
        }
        doubtful
    }
}

/// Offset of one of the eight voxels of a block.
fn voxel_in_pair(n: i32) -> IVec3 {
    IVec3::new(n & 1, n >> 1 & 1, n >> 2)
}

/// Notes which of the features `ids` the eight blocks see, and the square of the distance of the nearest from each
/// centre.
fn look<L: Local>(all: &[L], ids: &[u32], eight: &Eight, half: f32, seen: &mut Vec<Seen>, nearest: &mut [Vec4; 2]) {
    seen.clear();
    for &id in ids {
        let look = all[id as usize].look(eight, half);
        let mask = look.meets[0].bitmask() | look.meets[1].bitmask() << 4;
        for (k, nearest) in nearest.iter_mut().enumerate() {
            *nearest = nearest.min(Vec4::select(look.true_at[k], look.square[k], Vec4::INFINITY));
        }
        seen.push(Seen { id, mask, squares: look.square });
    }
}

/// Notes to which blocks each feature matters: those that see it at a square distance of at most `most`. Returns the
/// blocks to which any does.
fn share(seen: &[Seen], most: [Vec4; 2], shared: &mut Vec<(u32, u32)>) -> u32 {
    shared.clear();
    let mut any = 0;
    for seen in seen {
        let near = |k: usize| seen.squares[k].cmple(most[k]).bitmask();
        let mask = seen.mask & (near(0) | near(1) << 4);
        any |= mask;
        if mask != 0 {
            shared.push((seen.id, mask));
        }
    }
    any
}
