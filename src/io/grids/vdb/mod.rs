//! OpenVDB files of version 224: one tree of numbers with nodes of 4096³, 128³ and 8³ voxels.
//!
//! Layout, all numbers with the lowest byte first: the archive's header and metadata; for each grid a descriptor with its
//! places in the file, then compression flags, metadata, transform, the *topology* (masks and tiles of all nodes) and the
//! *buffers* (values of the 8³ blocks, called leaves, in the order of the topology). Within a node z changes fastest.

mod blosc;
mod cursor;
mod header;
mod leaves;
mod read;
mod transform;
mod tree;
mod values;
mod write;

use glam::IVec3;

pub(super) use read::read;
pub(super) use write::write;

/// Voxels along a side of the nodes below the root, the largest first.
const SIDES: [i32; 3] = [4096, 128, 8];

/// The name of the tree of single-precision numbers, and of that of double precision.
const TREES: [&str; 2] = ["Tree_float_5_4_3", "Tree_double_5_4_3"];
/// Follows the name of a tree whose numbers have 16 bits in the file.
const HALF: &str = "_HalfFloat";

/// Values are those of active voxels alone; how the others are made up is said.
const COMPRESS_ACTIVE_MASK: u32 = 2;
const COMPRESS_ZIP: u32 = 1;
const COMPRESS_BLOSC: u32 = 4;

/// Metadata: the number of voxels along x, y, z of the lattice that was written, whose first voxel has index 0 0 0.
const LATTICE_DIMS: &str = "lattice_dims";

/// The bit of a place within a node of `side` voxels whose children have `child` voxels.
fn offset(place: IVec3, side: i32, child: i32) -> usize {
    let n = (side / child) as usize;
    let [x, y, z] = (place & (side - 1)).to_array().map(|k| (k / child) as usize);
    (x * n + y) * n + z
}

/// The first voxel of child `offset` of a node of `side` voxels, relative to the node.
fn place(offset: usize, side: i32, child: i32) -> IVec3 {
    let n = (side / child) as usize;
    IVec3::new((offset / (n * n)) as i32, (offset / n % n) as i32, (offset % n) as i32) * child
}

/// The index in our blocks (x fastest) of entry `offset` of a leaf (z fastest).
fn in_block(offset: usize) -> usize {
    offset >> 6 | offset & 0o70 | (offset & 7) << 6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_offsets_belong_together() {
        for (side, child) in [(4096, 128), (128, 8), (8, 1)] {
            let count = ((side / child) as usize).pow(3);
            assert!((0..count).all(|n| offset(place(n, side, child), side, child) == n));
        }
        assert!((0..512).all(|n| {
            let p = place(n, 8, 1);
            in_block(n) == (p.x + 8 * p.y + 64 * p.z) as usize
        }));
        assert_eq!(offset(IVec3::new(-1, 0, 0), 128, 8), 15 * 256);
    }
}
