//! Prism scan conversion: the signed distance in a band around a closed surface, slice by slice (Sigg et al. 2003, §3.4 and §4).
//!
//! Every triangle has a [`Frustum`] on either side that holds whatever is nearest to it, its sides and corners included. Slices
//! along z cut these into convex polygons ([`Table`]); at each voxel of a polygon the exact distance to the triangle is
//! computed in its own frame ([`TriangleFrame`]), and the smallest in absolute value stays.

mod frame;
mod frustum;
mod surface;
mod table;

use glam::{DVec2, IVec3, Vec3};
use rayon::prelude::*;

pub use frame::TriangleFrame;
pub use frustum::{EDGES, Frustum};
pub use table::{MOST_CORNERS, Section, Table};

use super::exact::{ExactError, ExactOptions, Slab, Slabs};
use crate::lattice::{BRICK, DistanceField, Lattice};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use surface::PrismSurface;

/// The prisms of a surface.
#[derive(Debug, Default)]
pub struct Prisms {
    /// The triangles that have a plane, each in its own frame, in the order of the mesh.
    pub frames: Vec<TriangleFrame>,
    /// What each can be nearest to.
    pub frusta: Vec<Frustum>,
}

impl Prisms {
    /// The prisms of `mesh`, a closed, oriented manifold, in the coordinates of `lattice`, as far as they matter within `band`
    /// (voxels).
    pub fn new(mesh: &TriMesh, lattice: &Lattice, band: f64) -> Self {
        let surface = PrismSurface::new(mesh, lattice);
        let whole: Vec<usize> = (0..surface.triangles.len()).filter(|&t| surface.normals[t].is_some()).collect();
        let frame = |&t: &usize| {
            surface.normals[t].map(|normal| TriangleFrame::new(t, surface.corners(t), normal, &surface.pseudonormals))
        };
        let frames = whole.par_iter().filter_map(frame).collect();
        let frusta = whole.par_iter().enumerate();
        let frusta = frusta.flat_map_iter(|(n, &t)| frustum::frusta(&surface, t, n as u32, band)).collect();
        Self { frames, frusta }
    }
}

/// The signed distance to `mesh`, a closed, oriented manifold, at the voxels of `lattice`, counted in voxels: what
/// [`super::exact::exact`] gives with pseudonormals, to 1e-4 h, by scan conversion of prisms on the processor. Memory holds the
/// prisms, one slab of eight slices, and the result.
///
/// # Errors
/// See [`ExactError`].
pub fn prism(
    mesh: &TriMesh,
    lattice: &Lattice,
    options: &ExactOptions,
    progress: &Progress,
) -> Result<DistanceField, ExactError> {
    let mut slabs = Slabs::new(mesh, lattice, options)?;
    let prisms = Prisms::new(mesh, lattice, slabs.band());
    progress.check()?;
    let table = Table::new(&prisms.frusta, slabs.end().z);
    let mut sweep = table.sweep();
    for low in (0..slabs.end().z).step_by(BRICK as usize) {
        progress.check()?;
        let mut slab = Slab::new(slabs.end(), low);
        let active: Vec<Vec<u32>> = sweep.by_ref().take(BRICK as usize).collect();
        let planes = slab.planes().zip((low..).zip(&active)).par_bridge();
        planes.for_each(|(values, (z, active))| draw(&prisms, &table, active, z, slabs.end(), values));
        slabs.add(&slab);
    }
    slabs.finish(mesh, lattice, progress)
}

/// Draws the sections `active` of slice `z`: at each voxel the distance that is smallest in absolute value. Prisms overlap, those around a whole band
/// above all: blocks and tiles of voxels in which nothing would change are left out.
fn draw(prisms: &Prisms, table: &Table, active: &[u32], z: i32, end: IVec3, values: &mut [f32]) {
    let mut plane = Plane::new(values, end, z);
    for &n in active {
        let section = &table.sections()[n as usize];
        let frustum = &prisms.frusta[section.frustum as usize];
        let frame = &prisms.frames[frustum.frame as usize];
        let corners = section.corners(frustum, z);
        let low = corners.iter().fold(f64::INFINITY, |low, p| low.min(p.y)).ceil().max(0.0) as i32;
        let high = corners.iter().fold(f64::NEG_INFINITY, |high, p| high.max(p.y)).floor();
        let high = (high as i32).min(end.y - 1);
        for row_of_blocks in low / BLOCK..=high.div_euclid(BLOCK) {
            let first = row_of_blocks * BLOCK;
            let spans = std::array::from_fn(|k| {
                let y = first + k as i32;
                if y < low || y > high {
                    return [0, -1];
                }
                let [from, to] = row(&corners, f64::from(y));
                [from.ceil().max(0.0) as i32, to.floor().min(f64::from(end.x - 1)) as i32]
            });
            plane.draw_row(row_of_blocks, &spans, frame);
        }
    }
}

/// Voxels along a side of a tile, and of a block of tiles. Fandisk at 512 with a tenth of its size as the band takes 11 s with these or with tiles of 8
/// in blocks of 32, and minutes where every prism is drawn whole.
const TILE: i32 = BRICK / 2;
const BLOCK: i32 = 4 * BRICK;

/// How far the corners of a square of so many voxels are from its middle, and a little for rounding, h.
fn radius(side: i32) -> f32 {
    (side - 1) as f32 * std::f32::consts::FRAC_1_SQRT_2 + 0.01
}

/// One slice of a slab, in tiles.
struct Plane<'a> {
    values: &'a mut [f32],
    end: IVec3,
    z: i32,
    /// For each tile the largest distance in it, or more; and the same for each block.
    tiles: Vec<f32>,
    blocks: Vec<f32>,
}

/// The first and the last voxel of each row of voxels of a row of blocks.
type Spans = [[i32; 2]; BLOCK as usize];

impl<'a> Plane<'a> {
    fn new(values: &'a mut [f32], end: IVec3, z: i32) -> Self {
        let unknown =
            |side: i32| vec![f32::INFINITY; ((end.x + side - 1) / side * ((end.y + side - 1) / side)) as usize];
        Self { values, end, z, tiles: unknown(TILE), blocks: unknown(BLOCK) }
    }

    /// The number of a square of so many voxels among all of them.
    fn number(&self, side: i32, [column, row]: [i32; 2]) -> usize {
        (row * ((self.end.x + side - 1) / side) + column) as usize
    }

    /// How far the voxels of a square are from a triangle at least, h.
    fn at_least(&self, side: i32, [column, row]: [i32; 2], frame: &TriangleFrame) -> f32 {
        let half = (side - 1) as f32 / 2.0;
        let middle = Vec3::new((column * side) as f32 + half, (row * side) as f32 + half, self.z as f32);
        frame.at_least(middle) - radius(side)
    }

    /// Draws a triangle in a row of blocks.
    fn draw_row(&mut self, row: i32, spans: &Spans, frame: &TriangleFrame) {
        let any = || spans.iter().filter(|[from, to]| from <= to);
        let (Some(first), Some(last)) = (any().map(|s| s[0]).min(), any().map(|s| s[1]).max()) else { return };
        for column in first / BLOCK..=last / BLOCK {
            let block = self.number(BLOCK, [column, row]);
            if self.at_least(BLOCK, [column, row], frame) <= self.blocks[block]
                && self.draw_block([column, row], spans, frame)
            {
                self.blocks[block] = tiles_of([column, row], self.end)
                    .map(|tile| self.tiles[self.number(TILE, tile)])
                    .fold(0.0, f32::max);
            }
        }
    }

    /// Draws a triangle in the tiles of one block, and says whether that changed anything.
    fn draw_block(&mut self, block: [i32; 2], spans: &Spans, frame: &TriangleFrame) -> bool {
        let mut changed = false;
        for [column, row] in tiles_of(block, self.end) {
            let tile = self.number(TILE, [column, row]);
            let rows = &spans[((row * TILE) % BLOCK) as usize..][..TILE as usize];
            let is_met =
                rows.iter().any(|[from, to]| from.max(&(column * TILE)) <= to.min(&(column * TILE + TILE - 1)));
            if is_met
                && self.at_least(TILE, [column, row], frame) <= self.tiles[tile]
                && self.draw_tile([column, row], rows, frame)
            {
                self.tiles[tile] = self.farthest([column, row]);
                changed = true;
            }
        }
        changed
    }

    /// Draws a triangle in one tile, and says whether that changed anything.
    fn draw_tile(&mut self, [column, row]: [i32; 2], rows: &[[i32; 2]], frame: &TriangleFrame) -> bool {
        let mut changed = false;
        for (y, &[from, to]) in (row * TILE..).zip(rows) {
            for x in from.max(column * TILE)..=to.min(column * TILE + TILE - 1) {
                let signed = frame.signed(IVec3::new(x, y, self.z));
                let best = &mut self.values[(y * self.end.x + x) as usize];
                if signed.abs() < best.abs() {
                    *best = signed;
                    changed = true;
                }
            }
        }
        changed
    }

    /// The largest distance in a tile.
    fn farthest(&self, [column, row]: [i32; 2]) -> f32 {
        let rows = (row * TILE..(row + 1) * TILE).map(|y| (y * self.end.x + column * TILE) as usize);
        let values = rows.flat_map(|start| &self.values[start..start + TILE as usize]);
        values.fold(0.0, |most, value| most.max(value.abs()))
    }
}

/// The tiles of a block, as far as there are any.
fn tiles_of([column, row]: [i32; 2], end: IVec3) -> impl Iterator<Item = [i32; 2]> {
    const EACH: i32 = BLOCK / TILE;
    let columns = move || EACH * column..(EACH * (column + 1)).min(end.x / TILE);
    (EACH * row..(EACH * (row + 1)).min(end.y / TILE)).flat_map(move |y| columns().map(move |x| [x, y]))
}

/// Where a row passes through a convex polygon; the ends are in the wrong order where it does not.
fn row(corners: &[DVec2; MOST_CORNERS], y: f64) -> [f64; 2] {
    let mut ends = [f64::INFINITY, f64::NEG_INFINITY];
    for (k, &a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % MOST_CORNERS];
        if (a.y <= y) != (b.y <= y) || a.y == y {
            let x = if a.y == b.y { a.x } else { a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)) };
            ends = [ends[0].min(x), ends[1].max(x)];
        }
    }
    ends
}
