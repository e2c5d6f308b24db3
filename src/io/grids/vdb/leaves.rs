//! The blocks that a file stores: those with values within the band.

use std::io;

use glam::IVec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::super::{BLOCK_SIDE, BLOCK_VOXELS, BlockValues, DistanceSamples, SampleBlocks, read_plane};
use super::{SIDES, in_block, offset, place};

/// Bits of the entries of a leaf, z fastest.
type Bits = [u64; BLOCK_VOXELS / 64];

/// A block with a value within the band, or with values on both sides of it.
pub(super) struct Leaf {
    /// Its first voxel.
    pub(super) corner: IVec3,
    /// Its number among the source's blocks.
    source: usize,
    /// Values within the band.
    pub(super) active: Bits,
    /// Values that are negative.
    pub(super) inside: Bits,
    /// Changes with the values.
    pub(super) hash: u64,
}

/// All leaves in the order of the tree, and the side of everything else.
pub(super) struct Leaves<'a> {
    pub(super) all: Vec<Leaf>,
    /// The value beyond the band, model units.
    pub(super) background: f32,
    dims: IVec3,
    source: Source<'a>,
    /// The side of blocks of the source that are no leaves.
    sides: FxHashMap<IVec3, bool>,
}

/// Where blocks come from.
enum Source<'a> {
    Given(&'a SampleBlocks<'a>),
    Gathered { blocks: Vec<(IVec3, Box<BlockValues>)>, inside: Vec<bool>, counts: IVec3 },
}

impl Source<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Given(given) => given.stored.len(),
            Self::Gathered { blocks, .. } => blocks.len(),
        }
    }

    /// Block `n`, and its values.
    fn block(&self, n: usize) -> (IVec3, BlockValues) {
        match self {
            Self::Given(given) => (given.stored[n], (given.values)(n)),
            Self::Gathered { blocks, .. } => (blocks[n].0, *blocks[n].1),
        }
    }

    /// The side of a block of the lattice that is not among the source's.
    fn is_inside(&self, block: IVec3) -> bool {
        match self {
            Self::Given(given) => (given.inside)(block),
            Self::Gathered { inside, counts, .. } => inside[index(block, *counts)],
        }
    }
}

fn index(block: IVec3, counts: IVec3) -> usize {
    let [x, y, z, width, height] = [block.x, block.y, block.z, counts.x, counts.y].map(|k| k as usize);
    x + width * (y + height * z)
}

impl<'a> Leaves<'a> {
    pub(super) fn of(samples: &'a DistanceSamples<'a>) -> io::Result<Self> {
        let most = i32::MAX as usize / 4;
        if samples.dims.iter().any(|&count| count == 0 || count > most) {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "a lattice of 1 to 2^29 voxels along each axis is needed",
            ));
        }
        let dims = IVec3::from(samples.dims.map(|count| count as i32));
        let background = background(samples, dims)?;
        let band = Band { background, dims };
        let source = match samples.blocks {
            Some(given) => Source::Given(given),
            None => gathered(samples, band)?,
        };
        let found = (0..source.len()).into_par_iter().map(|n| {
            let (block, values) = source.block(n);
            band.leaf(block * BLOCK_SIDE, n, &values).ok_or((block, values[0] < 0.0))
        });
        let found: Vec<Result<Leaf, (IVec3, bool)>> = found.collect();
        let (mut all, mut sides) = (Vec::new(), FxHashMap::default());
        for leaf in found {
            match leaf {
                Ok(leaf) => all.push(leaf),
                Err((block, inside)) => drop(sides.insert(block, inside)),
            }
        }
        all.sort_unstable_by_key(Leaf::order);
        Ok(Self { all, background, dims, source, sides })
    }

    /// Whether the voxels from `corner` to the next leaf lie inside; `corner` is the first of a box without leaves.
    pub(super) fn is_inside(&self, corner: IVec3) -> bool {
        let block = corner / BLOCK_SIDE;
        let in_lattice = corner.min_element() >= 0 && corner.cmplt(self.dims).all();
        in_lattice && self.sides.get(&block).copied().unwrap_or_else(|| self.source.is_inside(block))
    }

    /// Nodes of the root that the lattice meets.
    pub(super) fn root_corners(&self) -> Vec<IVec3> {
        let [x, y, z] = ((self.dims + SIDES[0] - 1) / SIDES[0]).to_array();
        let corners =
            (0..x).flat_map(|x| (0..y).flat_map(move |y| (0..z).map(move |z| IVec3::new(x, y, z) * SIDES[0])));
        corners.collect()
    }

    /// The values of a leaf's active entries, in order.
    pub(super) fn values(&self, leaf: &Leaf) -> Vec<f32> {
        let (_, values) = self.source.block(leaf.source);
        (0..BLOCK_VOXELS).filter(|&n| has(&leaf.active, n)).map(|n| values[in_block(n)]).collect()
    }
}

impl Leaf {
    /// The order of the tree: node by node from the root down.
    fn order(&self) -> ([i32; 3], usize, usize) {
        let root = self.corner & !(SIDES[0] - 1);
        (root.to_array(), offset(self.corner, SIDES[0], SIDES[1]), offset(self.corner, SIDES[1], SIDES[2]))
    }
}

/// What makes a value active.
#[derive(Clone, Copy)]
struct Band {
    background: f32,
    dims: IVec3,
}

impl Band {
    /// Values at the end of the band differ from the background by rounding.
    fn holds(self, value: f32) -> bool {
        value.abs() < self.background * (1.0 - 4.0 * f32::EPSILON)
    }

    fn leaf(self, corner: IVec3, source: usize, values: &BlockValues) -> Option<Leaf> {
        let mut leaf = Leaf { corner, source, active: Bits::default(), inside: Bits::default(), hash: 0 };
        for n in 0..BLOCK_VOXELS {
            let value = values[in_block(n)];
            let bit = 1 << (n % 64);
            let in_lattice = (corner + place(n, SIDES[2], 1)).cmplt(self.dims).all();
            if in_lattice && self.holds(value) {
                leaf.active[n / 64] |= bit;
                leaf.hash = (leaf.hash ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3);
            }
            // Beyond the lattice a block goes on as it begins.
            if if in_lattice { value < 0.0 } else { values[0] < 0.0 } {
                leaf.inside[n / 64] |= bit;
            }
        }
        let one_side = [Bits::default(), [u64::MAX; BLOCK_VOXELS / 64]].contains(&leaf.inside);
        (leaf.active != Bits::default() || !one_side).then_some(leaf)
    }
}

pub(super) fn has(bits: &[u64], n: usize) -> bool {
    bits[n / 64] >> (n % 64) & 1 == 1
}

/// The width of the band; without one, a little more than the largest distance there is.
fn background(samples: &DistanceSamples<'_>, dims: IVec3) -> io::Result<f32> {
    let background = match (samples.band, samples.blocks) {
        (Some(band), _) => band as f32,
        (None, Some(given)) => {
            let largest = |n: usize| {
                let (corner, values) = (given.stored[n] * BLOCK_SIDE, (given.values)(n));
                let in_lattice = |n: &usize| (corner + place(*n, SIDES[2], 1)).cmplt(dims).all();
                let all = (0..BLOCK_VOXELS).filter(in_lattice).map(|n| values[in_block(n)].abs());
                all.fold(0.0, f32::max)
            };
            beyond((0..given.stored.len()).into_par_iter().map(largest).reduce(|| 0.0, f32::max))
        }
        (None, None) => {
            let (mut plane, mut most) = (Vec::new(), 0.0f32);
            for z in 0..samples.dims[2] {
                read_plane(samples, z, &mut plane)?;
                most = plane.iter().fold(most, |most, value| most.max(value.abs()));
            }
            beyond(most)
        }
    };
    match background > 0.0 && background.is_finite() {
        true => Ok(background),
        false => Err(io::Error::new(io::ErrorKind::InvalidData, format!("a band of {background} cannot be stored"))),
    }
}

fn beyond(largest: f32) -> f32 {
    (largest * (1.0 + 16.0 * f32::EPSILON)).max(f32::MIN_POSITIVE)
}

/// Blocks from planes: as many planes as a block is high at a time.
fn gathered(samples: &DistanceSamples<'_>, band: Band) -> io::Result<Source<'static>> {
    let counts = (band.dims + BLOCK_SIDE - 1) / BLOCK_SIDE;
    let [width, height, depth] = samples.dims;
    let (mut blocks, mut inside) = (Vec::new(), Vec::new());
    let (mut slab, mut plane) = (Vec::new(), Vec::new());
    for z in 0..counts.z {
        slab.clear();
        for z in (8 * z as usize..depth).take(BLOCK_SIDE as usize) {
            read_plane(samples, z, &mut plane)?;
            slab.extend_from_slice(&plane);
        }
        for (x, y) in (0..counts.y).flat_map(|y| (0..counts.x).map(move |x| (x, y))) {
            let mut values = Box::new([band.background; BLOCK_VOXELS]);
            for (n, value) in values.iter_mut().enumerate() {
                let [dx, dy] = [8 * x as usize + n % 8, 8 * y as usize + n / 8 % 8];
                let at = (dx < width && dy < height).then(|| dx + width * (dy + height * (n / 64)));
                *value = at.and_then(|at| slab.get(at)).copied().unwrap_or(band.background);
            }
            inside.push(values[0] < 0.0);
            let both_sides = values.iter().any(|&value| (value < 0.0) != (values[0] < 0.0));
            if both_sides || values.iter().any(|&value| band.holds(value)) {
                blocks.push((IVec3::new(x, y, z), values));
            }
        }
    }
    Ok(Source::Gathered { blocks, inside, counts })
}
