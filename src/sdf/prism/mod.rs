//! Prism scan conversion: the signed distance in a band around a closed surface, slice by slice (Sigg et al. 2003, §3.4 and §4).
//!
//! Every triangle has a [`Frustum`] on either side that holds whatever is nearest to it, its sides and corners included. Slices
//! along z cut these into convex polygons ([`Table`]); at each voxel of a polygon the exact distance to the triangle is
//! computed in its own frame ([`TriangleFrame`]), and the smallest in absolute value stays. Here this is done on the processor, as the
//! twin of what the graphics processor draws where that is built in: same prisms, same polygons, same distances.

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
/// above all: tiles of 4² voxels in which nothing would change are left out.
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
        for row_of_tiles in low / TILE..=high.div_euclid(TILE) {
            let first = row_of_tiles * TILE;
            let spans = std::array::from_fn(|k| {
                let y = first + k as i32;
                if y < low || y > high {
                    return [0, -1];
                }
                let [from, to] = row(&corners, f64::from(y));
                [from.ceil().max(0.0) as i32, to.floor().min(f64::from(end.x - 1)) as i32]
            });
            plane.draw_row(row_of_tiles, &spans, frame);
        }
    }
}

/// Voxels along a side of a tile. With 8, fandisk at 512 with a tenth of its size as the band takes 11 s.
const TILE: i32 = 4;

/// How far the corners of a tile are from its middle, and a little for rounding, h.
const TILE_RADIUS: f32 = 2.13;

/// One slice of a slab, in tiles.
struct Plane<'a> {
    values: &'a mut [f32],
    end: IVec3,
    z: i32,
    /// For each tile the largest distance in it, or more.
    most: Vec<f32>,
}

impl<'a> Plane<'a> {
    fn new(values: &'a mut [f32], end: IVec3, z: i32) -> Self {
        Self { values, end, z, most: vec![f32::INFINITY; ((end.x / TILE) * (end.y / TILE)) as usize] }
    }

    /// Draws a triangle in a row of tiles; `spans`: the first and the last voxel of each row of voxels.
    fn draw_row(&mut self, row: i32, spans: &[[i32; 2]; TILE as usize], frame: &TriangleFrame) {
        let any = || spans.iter().filter(|[from, to]| from <= to);
        let (Some(first), Some(last)) = (any().map(|s| s[0]).min(), any().map(|s| s[1]).max()) else { return };
        for column in first / TILE..=last / TILE {
            let tile = (row * (self.end.x / TILE) + column) as usize;
            let middle = IVec3::new(column, row, 0).as_vec3() * TILE as f32 + Vec3::new(1.5, 1.5, self.z as f32);
            if frame.at_least(middle) - TILE_RADIUS > self.most[tile] {
                continue;
            }
            if self.draw_tile([column, row], spans, frame) {
                self.most[tile] = self.farthest([column, row]);
            }
        }
    }

    /// Draws a triangle in one tile, and says whether that changed anything.
    fn draw_tile(&mut self, [column, row]: [i32; 2], spans: &[[i32; 2]; TILE as usize], frame: &TriangleFrame) -> bool {
        let mut changed = false;
        for (y, &[from, to]) in (row * TILE..).zip(spans) {
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
