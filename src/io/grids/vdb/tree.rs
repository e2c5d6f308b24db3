//! The nodes of a tree: topology, then buffers.

use glam::IVec3;

use super::super::numbers::Cap;
use super::super::{BLOCK_VOXELS, BlockValues, GridBlock, GridTile, SparseValues};
use super::cursor::{Cursor, Mask};
use super::values::Format;
use super::{SIDES, in_block, place};
use crate::io::error::{FileError, FileProblem};

/// Indices go this far from 0, so that nothing that is made of them overflows.
const FARTHEST: i32 = 1 << 29;

/// Reads the tree at `cursor`, whose buffers begin at `buffers` or follow.
pub(super) fn read(
    cursor: &mut Cursor<'_>,
    buffers: Option<Cursor<'_>>,
    mut format: Format,
    cap: Cap,
) -> Result<SparseValues, FileError> {
    let count = cursor.u32("the number of buffers")?;
    if count != 1 {
        return Err(cursor.wrong("one buffer for each block", count.to_string()));
    }
    format.background = format.number(cursor, "the background")?;
    finite(format.background, IVec3::ZERO, cursor)?;
    let mut tree = Tree { format, cap, leaves: Vec::new(), tiles: Vec::new() };
    tree.root(cursor)?;
    tree.check_room(cursor)?;
    let mut cursor = buffers.unwrap_or_else(|| cursor.clone());
    let blocks = tree.leaves.iter().map(|&corner| tree.format.leaf(corner, &mut cursor)).collect::<Result<_, _>>()?;
    let mut values = SparseValues { blocks, tiles: tree.tiles, background: format.background, shift: IVec3::ZERO };
    values.sort();
    Ok(values)
}

struct Tree {
    format: Format,
    cap: Cap,
    /// The corners of the leaves, in their order.
    leaves: Vec<IVec3>,
    tiles: Vec<GridTile>,
}

impl Tree {
    /// Refuses more leaves and tiles than there may be.
    fn check_room(&self, cursor: &Cursor<'_>) -> Result<(), FileError> {
        // A block, its values, and what keeping them apart costs.
        const LEAF: usize = size_of::<GridBlock>() + size_of::<BlockValues>() + 48;
        let room = self.leaves.len().saturating_mul(LEAF).saturating_add(self.tiles.len() * size_of::<GridTile>());
        self.cap.check(room, 0).map_err(|problem| problem.at_byte(cursor.at()))
    }

    fn root(&mut self, cursor: &mut Cursor<'_>) -> Result<(), FileError> {
        const WHAT: &str = "the root of the tree";
        let (tiles, children) = (cursor.u32(WHAT)?, cursor.u32(WHAT)?);
        let mut corners = Vec::new();
        for _ in 0..tiles {
            let corner = corner(cursor)?;
            let value = self.format.number(cursor, WHAT)?;
            cursor.u8(WHAT)?;
            corners.push(corner);
            self.tile(corner, SIDES[0], value, cursor)?;
        }
        for _ in 0..children {
            let corner = corner(cursor)?;
            corners.push(corner);
            self.node(corner, 0, cursor)?;
        }
        corners.sort_unstable_by_key(|corner| corner.to_array());
        match corners.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(cursor.wrong("each node of the root once", format!("{} twice", pair[0]))),
            None => Ok(()),
        }
    }

    /// A node of `SIDES[level]` voxels.
    fn node(&mut self, corner: IVec3, level: usize, cursor: &mut Cursor<'_>) -> Result<(), FileError> {
        let what = ["a node of 4096 voxels", "a node of 128 voxels"][level];
        let [side, child] = [SIDES[level], SIDES[level + 1]];
        let count = ((side / child) as usize).pow(3);
        let (children, active) = (cursor.mask(count, what)?, cursor.mask(count, what)?);
        let values = self.format.values(cursor, &active, count, what)?;
        self.tiles_of(corner, [side, child], &children, &values, cursor)?;
        for n in children.ones() {
            let corner = corner + place(n, side, child);
            if level == 0 {
                self.node(corner, 1, cursor)?;
                self.check_room(cursor)?;
            } else {
                cursor.take(BLOCK_VOXELS / 8, "the mask of a block")?;
                self.leaves.push(corner);
            }
        }
        Ok(())
    }

    fn tiles_of(
        &mut self,
        corner: IVec3,
        [side, child]: [i32; 2],
        children: &Mask,
        values: &[f32],
        cursor: &Cursor<'_>,
    ) -> Result<(), FileError> {
        for (n, &value) in values.iter().enumerate() {
            if !children.has(n) && value != self.format.background {
                self.tile(corner + place(n, side, child), child, value, cursor)?;
            }
        }
        Ok(())
    }

    /// A tile, joined to the one before it along z where both have one value.
    fn tile(&mut self, corner: IVec3, side: i32, value: f32, cursor: &Cursor<'_>) -> Result<(), FileError> {
        finite(value, corner, cursor)?;
        if value == self.format.background {
            return Ok(());
        }
        match self.tiles.last_mut() {
            Some(last)
                if (last.side, last.value) == (side, value) && last.corner + IVec3::Z * last.length == corner =>
            {
                last.length += side;
            }
            _ => self.tiles.push(GridTile { corner, side, length: side, value }),
        }
        Ok(())
    }
}

impl Format {
    /// A leaf's values.
    fn leaf(&self, corner: IVec3, cursor: &mut Cursor<'_>) -> Result<GridBlock, FileError> {
        const WHAT: &str = "the values of a block";
        let active = cursor.mask(BLOCK_VOXELS, WHAT)?;
        let stored = self.values(cursor, &active, BLOCK_VOXELS, WHAT)?;
        let mut values = Box::new([0.0; BLOCK_VOXELS]);
        for (n, value) in stored.into_iter().enumerate() {
            finite(value, corner + place(n, SIDES[2], 1), cursor)?;
            values[in_block(n)] = value;
        }
        Ok(GridBlock { corner, values })
    }
}

fn corner(cursor: &mut Cursor<'_>) -> Result<IVec3, FileError> {
    let corner = cursor.voxel("the root of the tree")?;
    let sound =
        corner & (SIDES[0] - 1) == IVec3::ZERO && corner.to_array().iter().all(|k| k.unsigned_abs() <= FARTHEST as u32);
    match sound {
        true => Ok(corner),
        false => {
            Err(cursor
                .wrong(format!("multiples of {} up to {FARTHEST} as a node's place", SIDES[0]), corner.to_string()))
        }
    }
}

fn finite(value: f32, voxel: IVec3, cursor: &Cursor<'_>) -> Result<(), FileError> {
    let voxel = voxel.to_array().map(i64::from);
    let problem = FileProblem::NotFiniteVoxel { voxel, value };
    if value.is_finite() { Ok(()) } else { Err(problem.at_byte(cursor.at())) }
}
