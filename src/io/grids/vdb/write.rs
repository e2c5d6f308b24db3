//! Writing: one level set of single-precision numbers, compressed only by leaving out what lies beyond the band.

use std::io::{self, Write};

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use sha2::{Digest, Sha256};

use super::super::format::VDB_MAGIC as MAGIC;
use super::super::{BLOCK_VOXELS, DistanceSamples, remark};
use super::leaves::{Leaf, Leaves, has};
use super::transform::SCALE_TRANSLATE;
use super::values::{BACKGROUND, MASK, MINUS_BACKGROUND};
use super::{COMPRESS_ACTIVE_MASK, LATTICE_DIMS, SIDES, TREES, offset, place};

/// The version of the format, and that of the library that first wrote it.
const VERSION: [u32; 3] = [224, 4, 0];
/// What programs look for.
const NAME: &str = "surface";
/// So many leaves are turned into bytes at a time.
const BATCH: usize = 4096;

pub(in crate::io::grids) fn write(samples: &DistanceSamples<'_>, out: &mut dyn Write) -> io::Result<()> {
    let leaves = Leaves::of(samples)?;
    let topology = topology(&leaves);
    let described = described(samples);
    let identity = identity(&described, &topology, &leaves);
    let mut head = archive(&identity);
    // The descriptor ends with three places of eight bytes.
    let grid = head.len() + 24;
    let values = grid + described.len() + topology.len();
    let end = values + leaves.all.iter().map(size).sum::<usize>();
    for place in [grid, values, end] {
        head.extend((place as i64).to_le_bytes());
    }
    for part in [&head, &described, &topology] {
        out.write_all(part)?;
    }
    for batch in leaves.all.chunks(BATCH) {
        let bytes: Vec<Vec<u8>> = batch.par_iter().map(|leaf| encoded(leaf, &leaves)).collect();
        out.write_all(&bytes.concat())?;
    }
    Ok(())
}

/// The beginning, up to the places of the descriptor.
fn archive(identity: &str) -> Vec<u8> {
    let mut out = MAGIC.to_vec();
    VERSION.iter().for_each(|number| out.extend(number.to_le_bytes()));
    // The descriptor says where its grid is.
    out.push(1);
    out.extend(identity.as_bytes());
    metadata(&[("creator", Value::Text(concat!("meshwright ", env!("CARGO_PKG_VERSION")).into()))], &mut out);
    out.extend(1u32.to_le_bytes());
    for word in [NAME, TREES[0], ""] {
        text(word, &mut out);
    }
    out
}

/// Flags of compression, metadata and transform.
fn described(samples: &DistanceSamples<'_>) -> Vec<u8> {
    let mut out = COMPRESS_ACTIVE_MASK.to_le_bytes().to_vec();
    let mut pairs = vec![
        ("class", Value::Text("level set".into())),
        ("description", Value::Text(remark(samples))),
        (LATTICE_DIMS, Value::Voxel(samples.dims.map(|count| count as i32))),
        ("name", Value::Text(NAME.into())),
        ("sign", Value::Text("negative inside".into())),
    ];
    pairs.extend(samples.band.map(|band| ("band", Value::Double(band))));
    pairs.extend(samples.unit.map(|unit| ("unit", Value::Text(unit.symbol().into()))));
    metadata(&pairs, &mut out);
    let h = samples.spacing;
    text(SCALE_TRANSLATE, &mut out);
    out.extend(samples.origin.to_array().iter().flat_map(|k| k.to_le_bytes()));
    // The scale, the size of a voxel, and what follows from them.
    for number in [h, h, 1.0 / h, 1.0 / (h * h), 0.5 / h] {
        out.extend(DVec3::splat(number).to_array().iter().flat_map(|k| k.to_le_bytes()));
    }
    out
}

/// A value of metadata.
enum Value {
    Text(String),
    Double(f64),
    Voxel([i32; 3]),
}

fn metadata(pairs: &[(&str, Value)], out: &mut Vec<u8>) {
    out.extend((pairs.len() as u32).to_le_bytes());
    for (name, value) in pairs {
        text(name, out);
        match value {
            Value::Text(words) => {
                text("string", out);
                text(words, out);
            }
            Value::Double(number) => {
                text("double", out);
                out.extend(8u32.to_le_bytes());
                out.extend(number.to_le_bytes());
            }
            Value::Voxel(voxel) => {
                text("vec3i", out);
                out.extend(12u32.to_le_bytes());
                out.extend(voxel.iter().flat_map(|k| k.to_le_bytes()));
            }
        }
    }
}

fn text(words: &str, out: &mut Vec<u8>) {
    out.extend((words.len() as u32).to_le_bytes());
    out.extend(words.as_bytes());
}

/// A name-based identifier in place of a random one, so that the same field makes the same bytes.
fn identity(described: &[u8], topology: &[u8], leaves: &Leaves<'_>) -> String {
    let mut hash = Sha256::new();
    hash.update(described);
    hash.update(topology);
    leaves.all.iter().for_each(|leaf| hash.update(leaf.hash.to_le_bytes()));
    let digest = hash.finalize();
    let mut id = [0; 16];
    id.copy_from_slice(&digest[..16]);
    // Version 8, "custom", of RFC 9562.
    id[6] = id[6] & 0x0f | 0x80;
    id[8] = id[8] & 0x3f | 0x80;
    let hex: String = id.iter().map(|byte| format!("{byte:02x}")).collect();
    [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-")
}

/// Masks and tiles of all nodes.
fn topology(leaves: &Leaves<'_>) -> Vec<u8> {
    let mut out = 1u32.to_le_bytes().to_vec();
    out.extend(leaves.background.to_le_bytes());
    let roots: Vec<&[Leaf]> = leaves.all.chunk_by(|a, b| root(a) == root(b)).collect();
    let has_leaves = |corner: &IVec3| roots.iter().any(|leaves| root(&leaves[0]) == *corner);
    let corners = leaves.root_corners().into_iter();
    let tiles: Vec<IVec3> = corners.filter(|corner| !has_leaves(corner) && leaves.is_inside(*corner)).collect();
    out.extend((tiles.len() as u32).to_le_bytes());
    out.extend((roots.len() as u32).to_le_bytes());
    for tile in tiles {
        out.extend(tile.to_array().iter().flat_map(|k| k.to_le_bytes()));
        out.extend((-leaves.background).to_le_bytes());
        out.push(0);
    }
    for below in roots {
        let corner = root(&below[0]);
        out.extend(corner.to_array().iter().flat_map(|k| k.to_le_bytes()));
        node(corner, 0, below, leaves, &mut out);
    }
    out
}

fn root(leaf: &Leaf) -> IVec3 {
    leaf.corner & !(SIDES[0] - 1)
}

/// The node of `SIDES[level]` voxels that has the leaves `below`.
fn node(corner: IVec3, level: usize, below: &[Leaf], leaves: &Leaves<'_>, out: &mut Vec<u8>) {
    let [side, child] = [SIDES[level], SIDES[level + 1]];
    let count = ((side / child) as usize).pow(3);
    let entry = |leaf: &Leaf| offset(leaf.corner, side, child);
    let children: Vec<&[Leaf]> = below.chunk_by(|a, b| entry(a) == entry(b)).collect();
    let (mut taken, mut outside) = (vec![0u64; count / 64], vec![0u64; count / 64]);
    children.iter().map(|leaves| entry(&leaves[0])).for_each(|n| taken[n / 64] |= 1 << (n % 64));
    for n in 0..count {
        if !has(&taken, n) && !leaves.is_inside(corner + place(n, side, child)) {
            outside[n / 64] |= 1 << (n % 64);
        }
    }
    mask(&taken, out);
    // No tile is active.
    out.resize(out.len() + count / 8, 0);
    sides(&taken, &outside, out);
    for below in children {
        let corner = corner + place(entry(&below[0]), side, child);
        match level {
            0 => node(corner, 1, below, leaves, out),
            _ => mask(&below[0].active, out),
        }
    }
}

fn mask(bits: &[u64], out: &mut Vec<u8>) {
    out.extend(bits.iter().flat_map(|word| word.to_le_bytes()));
}

/// Says which entries have the background and which its negative; those that are `taken` have neither.
fn sides(taken: &[u64], outside: &[u64], out: &mut Vec<u8>) {
    out.push(how(taken, outside));
    if out.last() == Some(&MASK) {
        mask(outside, out);
    }
}

fn how(taken: &[u64], outside: &[u64]) -> u8 {
    let none_inside = taken.iter().zip(outside).all(|(taken, outside)| taken | outside == u64::MAX);
    let none_outside = taken.iter().zip(outside).all(|(taken, outside)| outside & !taken == 0);
    match (none_inside, none_outside) {
        (true, _) => BACKGROUND,
        (false, true) => MINUS_BACKGROUND,
        (false, false) => MASK,
    }
}

fn outside(leaf: &Leaf) -> [u64; BLOCK_VOXELS / 64] {
    leaf.inside.map(|word| !word)
}

/// Mask, sides and values of a leaf.
fn encoded(leaf: &Leaf, leaves: &Leaves<'_>) -> Vec<u8> {
    let mut out = Vec::with_capacity(size(leaf));
    mask(&leaf.active, &mut out);
    sides(&leaf.active, &outside(leaf), &mut out);
    out.extend(leaves.values(leaf).iter().flat_map(|value| value.to_le_bytes()));
    out
}

/// The bytes of a leaf.
fn size(leaf: &Leaf) -> usize {
    const MASK_BYTES: usize = BLOCK_VOXELS / 8;
    let active: usize = leaf.active.iter().map(|word| word.count_ones() as usize).sum();
    let choice = if how(&leaf.active, &outside(leaf)) == MASK { MASK_BYTES } else { 0 };
    MASK_BYTES + 1 + choice + 4 * active
}
