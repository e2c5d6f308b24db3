//! A lattice as read.

use glam::{DVec3, IVec3};

use super::GridFormat;
use crate::io::Unit;
use crate::io::error::FileProblem;
use crate::lattice::Lattice;

/// Voxels along one side of a block.
pub const BLOCK_SIDE: i32 = 8;
/// Voxels of a block.
pub const BLOCK_VOXELS: usize = 512;

/// The values of a block; voxel (x, y, z) of it has index `x + 8 y + 64 z`.
pub type BlockValues = [f32; BLOCK_VOXELS];

/// A file of values over a lattice, as read. Voxel `v` lies at `origin + spacing * v`.
#[derive(Debug, Clone, PartialEq)]
pub struct GridFile {
    /// The format that was found.
    pub format: GridFormat,
    /// Position of voxel (0, 0, 0), model units; zero where the format has no place for it.
    pub origin: DVec3,
    /// Voxel spacing, model units, above zero; 1 where the format has no place for it.
    pub spacing: f64,
    /// Voxels along x, y, z, each at least 1.
    pub dims: [usize; 3],
    /// The unit of all lengths, where the file states it.
    pub unit: Option<Unit>,
    /// Values are clamped to ± this, model units, where the file says so.
    pub band: Option<f64>,
    /// The values: model units and negative inside, also where the file says that it has the opposite sign.
    pub values: GridValues,
    /// Sentences about what was left out or read otherwise than it stands.
    pub warnings: Vec<String>,
}

/// The values of a lattice, all finite.
#[derive(Debug, Clone, PartialEq)]
pub enum GridValues {
    /// One for each voxel, x fastest, then y.
    Dense(Vec<f32>),
    /// In blocks near the surface.
    Sparse(SparseValues),
}

/// Values stored in blocks of 8³ voxels where they differ, and in boxes of one value elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct SparseValues {
    /// The blocks, sorted by the z, then the y, then the x of their corners; no two are at one place.
    pub blocks: Vec<GridBlock>,
    /// Boxes of one value that is not the background, in an order of their own; none overlaps a block.
    pub tiles: Vec<GridTile>,
    /// The value of all other voxels.
    pub background: f32,
    /// Tiles are at multiples of their side when this is added to them.
    pub(super) shift: IVec3,
}

/// A block of 8³ voxels, each with a value of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct GridBlock {
    /// The first voxel of the block; a multiple of 8 along each axis.
    pub corner: IVec3,
    /// The values of the voxels.
    pub values: Box<BlockValues>,
}

/// A box of voxels that all have one value, which VDB calls a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridTile {
    /// The first voxel of the box; a multiple of 8 along each axis.
    pub corner: IVec3,
    /// Voxels along x and y: 8, 128 or 4096.
    pub side: i32,
    /// Voxels along z, a multiple of `side`.
    pub length: i32,
    /// The value of all voxels of the box.
    pub value: f32,
}

impl GridValues {
    /// Bytes of memory that the values take.
    pub fn memory(&self) -> u64 {
        let bytes = match self {
            Self::Dense(values) => size_of_val(values.as_slice()),
            Self::Sparse(values) => {
                let block = size_of::<GridBlock>() + size_of::<BlockValues>();
                values.blocks.len() * block + size_of_val(values.tiles.as_slice())
            }
        };
        bytes as u64
    }
}

impl GridFile {
    /// Where the voxels lie.
    pub fn lattice(&self) -> Lattice {
        Lattice { origin: self.origin, h: self.spacing, dims: IVec3::from(self.dims.map(|count| count as i32)) }
    }

    /// The value at a voxel, model units; `None` outside the lattice.
    pub fn at(&self, voxel: IVec3) -> Option<f32> {
        let [x, y, z] = voxel.to_array().map(|k| usize::try_from(k).unwrap_or(usize::MAX));
        let [width, height, depth] = self.dims;
        if x >= width || y >= height || z >= depth {
            return None;
        }
        match &self.values {
            GridValues::Dense(values) => values.get(x + width * (y + height * z)).copied(),
            GridValues::Sparse(values) => Some(values.at(voxel)),
        }
    }
}

impl SparseValues {
    /// The value at a voxel.
    pub fn at(&self, voxel: IVec3) -> f32 {
        // Nothing that a file can hold lies farther out.
        if voxel.abs().max_element() > 1 << 30 || voxel.min_element() == i32::MIN {
            return self.background;
        }
        let corner = voxel & !(BLOCK_SIDE - 1);
        let found = self.blocks.binary_search_by(|block| block_order(block.corner).cmp(&block_order(corner)));
        match found {
            Ok(n) => {
                let local = voxel & (BLOCK_SIDE - 1);
                self.blocks[n].values[(local.x + 8 * local.y + 64 * local.z) as usize]
            }
            Err(_) => self.tile_at(voxel).unwrap_or(self.background),
        }
    }

    fn tile_at(&self, voxel: IVec3) -> Option<f32> {
        [8, 128, 4096].into_iter().find_map(|side| {
            let corner = ((voxel + self.shift) & !(side - 1)) - self.shift;
            let after = self.tiles.partition_point(|tile| tile_order(tile) <= (side, corner.x, corner.y, corner.z));
            let tile = self.tiles[..after].last()?;
            let same_row = (tile.side, tile.corner.x, tile.corner.y) == (side, corner.x, corner.y);
            (same_row && voxel.z - tile.corner.z < tile.length).then_some(tile.value)
        })
    }

    /// Brings blocks and tiles into the order that the look-ups need.
    pub(super) fn sort(&mut self) {
        self.blocks.sort_unstable_by_key(|block| block_order(block.corner));
        self.tiles.sort_unstable_by_key(tile_order);
    }

    /// Makes `first`, whose coordinates are multiples of 8, the first voxel.
    pub(super) fn rebase(&mut self, first: IVec3) {
        self.blocks.iter_mut().for_each(|block| block.corner -= first);
        self.tiles.iter_mut().for_each(|tile| tile.corner -= first);
        self.shift += first;
    }

    /// Turns inside out.
    pub(super) fn turn(&mut self) {
        self.blocks.iter_mut().flat_map(|block| block.values.iter_mut()).for_each(|value| *value = -*value);
        self.tiles.iter_mut().for_each(|tile| tile.value = -tile.value);
        self.background = -self.background;
    }

    /// Smallest corner, and the corner after the last voxel, of all blocks and tiles.
    pub(super) fn bounds(&self) -> Option<[IVec3; 2]> {
        let blocks = self.blocks.iter().map(|block| [block.corner, block.corner + BLOCK_SIDE]);
        let tiles = self.tiles.iter().map(GridTile::ends);
        blocks.chain(tiles).reduce(|[a, b], [low, high]| [a.min(low), b.max(high)])
    }
}

impl GridTile {
    fn ends(&self) -> [IVec3; 2] {
        [self.corner, self.corner + IVec3::new(self.side, self.side, self.length)]
    }
}

fn block_order(corner: IVec3) -> (i32, i32, i32) {
    (corner.z, corner.y, corner.x)
}

fn tile_order(tile: &GridTile) -> (i32, i32, i32, i32) {
    (tile.side, tile.corner.x, tile.corner.y, tile.corner.z)
}

/// Checks that all values of a dense lattice are finite.
pub(super) fn all_finite(values: &[f32], dims: [usize; 3]) -> Result<(), FileProblem> {
    let Some(n) = values.iter().position(|value| !value.is_finite()) else { return Ok(()) };
    let [x, y] = [dims[0].max(1), dims[1].max(1)];
    let voxel = [n % x, n / x % y, n / (x * y)].map(|k| k as i64);
    Err(FileProblem::NotFiniteVoxel { voxel, value: values[n] })
}

/// The one spacing of all axes. Files round their numbers, so a few units in the seventh digit do not count.
pub(super) fn one_spacing(spacing: [f64; 3]) -> Result<f64, FileProblem> {
    const ROUNDING: f64 = 2e-7;
    let h = spacing[0];
    if !spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        let found = format!("{} {} {}", spacing[0], spacing[1], spacing[2]);
        return Err(FileProblem::syntax("a spacing above zero along each axis", found));
    }
    match spacing.iter().all(|s| (s - h).abs() <= ROUNDING * h) {
        true => Ok(h),
        false => Err(FileProblem::Anisotropic(spacing)),
    }
}

/// Spacing from the three axes of the lattice, each the step from one voxel to the next.
pub(super) fn spacing_of_axes(axes: [[f64; 3]; 3]) -> Result<f64, FileProblem> {
    let largest = axes.iter().flatten().fold(0.0f64, |most, x| most.max(x.abs()));
    let straight = (0..3).all(|k| (0..3).all(|j| j == k || axes[k][j].abs() <= 1e-7 * largest));
    let forward = (0..3).all(|k| axes[k][k] > 0.0);
    if !(straight && forward) {
        let words = axes.map(|[x, y, z]| format!("({x}, {y}, {z})"));
        return Err(FileProblem::Turned(words.join(" ")));
    }
    one_spacing([axes[0][0], axes[1][1], axes[2][2]])
}

/// The range of the values of a lattice, and how many there are on either side of zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridMeasures {
    /// The smallest and the largest value.
    pub range: [f32; 2],
    /// Voxels with a value below zero.
    pub below_zero: u64,
    /// Voxels whose values are stored one by one.
    pub stored: u64,
}

impl GridFile {
    /// Appends the values of plane `z` to `values`: x changes fastest, then y.
    pub fn plane(&self, z: usize, values: &mut Vec<f32>) {
        let points = self.dims[0] * self.dims[1];
        match &self.values {
            GridValues::Dense(all) => values.extend(all.iter().skip(z * points).take(points)),
            GridValues::Sparse(sparse) => {
                let start = values.len();
                values.resize(start + points, sparse.background);
                self.sparse_plane(sparse, z as i32, &mut values[start..]);
            }
        }
    }

    fn sparse_plane(&self, sparse: &SparseValues, z: i32, plane: &mut [f32]) {
        let [width, height] = [self.dims[0] as i32, self.dims[1] as i32];
        let row = |y: i32| (y * width) as usize;
        let crossed = sparse.tiles.iter().filter(|tile| (tile.corner.z..tile.corner.z + tile.length).contains(&z));
        for tile in crossed {
            let [low, high] = tile.ends();
            for y in low.y.max(0)..high.y.min(height) {
                let (from, to) = (low.x.clamp(0, width), high.x.clamp(0, width));
                plane[row(y)..][from as usize..to as usize].fill(tile.value);
            }
        }
        let layer = z & !(BLOCK_SIDE - 1);
        let first = sparse.blocks.partition_point(|block| block.corner.z < layer);
        for block in sparse.blocks[first..].iter().take_while(|block| block.corner.z == layer) {
            for y in 0..BLOCK_SIDE {
                for x in 0..BLOCK_SIDE {
                    let at = block.corner + IVec3::new(x, y, 0);
                    if (0..width).contains(&at.x) && (0..height).contains(&at.y) {
                        plane[row(at.y) + at.x as usize] = block.values[(x + 8 * y + 64 * (z - layer)) as usize];
                    }
                }
            }
        }
    }

    /// Measures all values. Boxes of one value are counted without visiting their voxels.
    pub fn measures(&self) -> GridMeasures {
        let mut found = GridMeasures { range: [f32::INFINITY, f32::NEG_INFINITY], below_zero: 0, stored: 0 };
        let mut add = |value: f32, count: u64, stored: bool| {
            if count > 0 {
                found.range = [found.range[0].min(value), found.range[1].max(value)];
                found.below_zero += if value < 0.0 { count } else { 0 };
                found.stored += if stored { count } else { 0 };
            }
        };
        let sparse = match &self.values {
            GridValues::Dense(values) => {
                values.iter().for_each(|&value| add(value, 1, true));
                return found;
            }
            GridValues::Sparse(sparse) => sparse,
        };
        let dims = IVec3::from(self.dims.map(|count| i32::try_from(count).unwrap_or(i32::MAX)));
        let within = |low: IVec3, high: IVec3| {
            let size = (high.min(dims) - low.max(IVec3::ZERO)).max(IVec3::ZERO);
            size.to_array().iter().map(|&k| k as u64).product::<u64>()
        };
        let mut covered = 0;
        for block in &sparse.blocks {
            for (n, &value) in (0i32..).zip(block.values.iter()) {
                let at = block.corner + IVec3::new(n & 7, n >> 3 & 7, n >> 6);
                let count = within(at, at + 1);
                covered += count;
                add(value, count, true);
            }
        }
        for tile in &sparse.tiles {
            let [low, high] = tile.ends();
            let count = within(low, high);
            covered += count;
            add(tile.value, count, false);
        }
        let all: u64 = self.dims.iter().map(|&count| count as u64).product();
        add(sparse.background, all.saturating_sub(covered), false);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::GridFormat;

    /// Blocks and tiles that reach beyond the lattice on both sides.
    fn sparse() -> GridFile {
        let values = std::array::from_fn(|n| n as f32 - 200.0);
        let block = |corner: [i32; 3]| GridBlock { corner: IVec3::from(corner), values: Box::new(values) };
        let tile = |corner: [i32; 3], length, value| GridTile { corner: IVec3::from(corner), side: 8, length, value };
        let mut sparse = SparseValues {
            blocks: vec![block([8, 8, 8]), block([0, 0, 0]), block([16, 0, 0])],
            tiles: vec![tile([8, 0, 0], 16, -7.0), tile([0, 16, 8], 8, 9.5)],
            background: 300.0,
            shift: IVec3::ZERO,
        };
        sparse.sort();
        GridFile {
            format: GridFormat::Vdb,
            origin: DVec3::ZERO,
            spacing: 1.0,
            dims: [21, 19, 13],
            unit: None,
            band: None,
            values: GridValues::Sparse(sparse),
            warnings: Vec::new(),
        }
    }

    #[test]
    fn planes_and_measures_are_what_the_voxels_say() {
        let file = sparse();
        let mut all = Vec::new();
        (0..file.dims[2]).for_each(|z| file.plane(z, &mut all));
        let [width, height, depth] = file.dims.map(|count| count as i32);
        let voxels =
            (0..depth).flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| IVec3::new(x, y, z))));
        let expected: Vec<f32> = voxels.map(|voxel| file.at(voxel).expect("in the lattice")).collect();
        assert_eq!(all, expected);
        let dense = GridFile { values: GridValues::Dense(all.clone()), ..file.clone() };
        let mut again = Vec::new();
        (0..dense.dims[2]).for_each(|z| dense.plane(z, &mut again));
        assert_eq!(again, all);
        let (found, whole) = (file.measures(), dense.measures());
        assert_eq!((found.range, found.below_zero), (whole.range, whole.below_zero));
        assert_eq!(found.below_zero, all.iter().filter(|value| **value < 0.0).count() as u64);
        assert!(found.stored < whole.stored && whole.stored == all.len() as u64);
    }
}
