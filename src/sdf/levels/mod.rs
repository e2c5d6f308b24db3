//! Inside and outside level by level (Payne & Toga 1992, "Optimizations", point 1).
//!
//! Each plane of voxels cuts the oriented surface in slice contours: one segment for each triangle, with the inside on its left, from one cut
//! edge of the mesh to another. At an edge with as many triangles one way as the other, as many segments come as go, so
//! on a closed surface the contours are closed, whatever their coordinates. Elsewhere, at the rim of a hole or at a
//! crack, they end; each end is joined by a straight segment with a beginning, the nearest pairs of a plane first. A voxel is inside
//! where the closed contours wind around it at least once, or as often as another rule says ([`Inside`]).
//!
//! A vertex on a plane counts as above it, and likewise for rows and voxels, as if the lattice were moved by
//! (−ε³, −ε², −ε): nothing ever lies on a plane.

mod gaps;
mod scan;

use glam::{DVec2, DVec3, IVec3};
use rayon::prelude::*;

use crate::lattice::{BRICK, Lattice, brick_of};
use crate::ldi::Inside;
use crate::mesh::TriMesh;
use crate::mesh::edges::Edges;
use crate::mesh::weld::{first_of_equal, has_repeated_index};
use crate::progress::{Progress, Stopped};

/// So many planes are cut at a time: for each, the triangles it cuts are listed.
const PLANES: usize = 64;

/// Which voxels of a lattice are inside. One bit for every voxel of the lattice, however far from the surface.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Levels {
    /// Bricks along x, y and z.
    counts: IVec3,
    /// Eight voxels along x each; rows along x, then y, then z.
    eights: Vec<u8>,
}

/// Why there are no [`Levels`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LevelsError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// There is no room for a bit a voxel.
    #[error("a bit for each of {dims} voxels takes {} MB, and there is no room for them: use a larger voxel", needed / 1_000_000)]
    Memory {
        /// Voxels along x, y, z.
        dims: IVec3,
        /// Bytes.
        needed: u64,
    },
}

/// Bytes that [`Levels::of`] takes: the bits, and what it knows of `triangles` triangles while it works.
pub fn levels_memory(lattice: &Lattice, triangles: usize) -> u64 {
    bits(lattice) + BYTES_PER_TRIANGLE * triangles as u64
}

/// Bytes of all bits.
fn bits(lattice: &Lattice) -> u64 {
    (counts(lattice).as_dvec3().element_product() * f64::from(BRICK * BRICK)) as u64
}

/// Welded corners, positions, the edges while the rim is found, and one list of those that a plane cuts.
const BYTES_PER_TRIANGLE: u64 = 100;

/// Bricks along each axis.
fn counts(lattice: &Lattice) -> IVec3 {
    brick_of(lattice.dims.max(IVec3::ONE) - 1) + 1
}

impl Levels {
    /// Finds the inside of the oriented surface `mesh`, for the voxels of `lattice` and of the bricks at its end. Vertices of
    /// equal coordinates are one. `inside` says how often contours have to wind around a voxel.
    ///
    /// # Errors
    /// See [`LevelsError`].
    pub fn of(mesh: &TriMesh, lattice: &Lattice, inside: Inside, progress: &Progress) -> Result<Self, LevelsError> {
        let counts = counts(lattice);
        let surface = CutSurface::of(mesh, lattice);
        progress.check()?;
        let [width, height, depth] = [counts.x, BRICK * counts.y, BRICK * counts.z].map(|count| count as usize);
        let mut eights = Vec::new();
        let enough = eights.try_reserve_exact(width * height * depth);
        enough.map_err(|_| LevelsError::Memory { dims: lattice.dims, needed: bits(lattice) })?;
        eights.resize(width * height * depth, 0);
        for (n, planes) in eights.chunks_mut(width * height * PLANES).enumerate() {
            let first = n * PLANES;
            let cut = surface.cut_by(first, planes.len() / (width * height));
            planes.par_chunks_mut(width * height).zip(&cut).enumerate().try_for_each(|(k, (plane, cut))| {
                progress.check()?;
                scan::fill(plane, width, surface.contours((first + k) as f64, cut), inside);
                Ok::<_, Stopped>(())
            })?;
        }
        Ok(Self { counts, eights })
    }

    /// Whether `voxel` is inside; beyond the bricks of the lattice all are outside.
    pub fn is_inside(&self, voxel: IVec3) -> bool {
        self.brick(brick_of(voxel))[((voxel.z & 7) * BRICK + (voxel.y & 7)) as usize] >> (voxel.x & 7) & 1 == 1
    }

    /// The rows of a brick, bit x of number y + 8 z.
    pub(in crate::sdf) fn brick(&self, brick: IVec3) -> [u8; 64] {
        if brick.cmplt(IVec3::ZERO).any() || brick.cmpge(self.counts).any() {
            return [0; 64];
        }
        let [x, y, z] = brick.to_array().map(|k| k as usize);
        let [width, height] = [self.counts.x as usize, (BRICK * self.counts.y) as usize];
        std::array::from_fn(|n| self.eights[((8 * z + n / 8) * height + 8 * y + n % 8) * width + x])
    }
}

/// A surface to be cut; lattice coordinates.
struct CutSurface {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    rim: Vec<RimEdge>,
}

/// An edge that more triangles run along one way than the other.
struct RimEdge {
    /// The way that has more.
    ends: [u32; 2],
    /// How many more.
    times: u32,
}

/// What cuts one plane: numbers of triangles and of edges of the rim.
#[derive(Default, Clone)]
struct Cut {
    triangles: Vec<u32>,
    rim: Vec<u32>,
}

/// A directed piece of a slice contour within its plane.
type Segment = [DVec2; 2];

impl CutSurface {
    fn of(mesh: &TriMesh, lattice: &Lattice) -> Self {
        let first = first_of_equal(&mesh.positions);
        let welded = mesh.triangles.iter().map(|t| t.map(|v| first[v as usize]));
        let triangles: Vec<[u32; 3]> = welded.filter(|t| !has_repeated_index(*t)).collect();
        let edges = Edges::new(&triangles, mesh.positions.len());
        let mut rim = Vec::new();
        edges.each(|edge| {
            let up = edge.halves().filter(|&half| edges.runs_up(half)).count();
            let down = edge.count() - up;
            let [low, high] = edge.ends;
            let ends = if up > down { [low, high] } else { [high, low] };
            if up != down {
                rim.push(RimEdge { ends, times: up.abs_diff(down) as u32 });
            }
        });
        let positions = mesh.positions.par_iter().map(|&p| lattice.to_lattice(p)).collect();
        Self { positions, triangles, rim }
    }

    /// What cuts each of `count` planes from plane `first` on.
    fn cut_by(&self, first: usize, count: usize) -> Vec<Cut> {
        let mut cut = vec![Cut::default(); count];
        for (n, triangle) in (0..).zip(&self.triangles) {
            self.planes(triangle, first, count).for_each(|k| cut[k].triangles.push(n));
        }
        for (n, edge) in (0..).zip(&self.rim) {
            self.planes(&edge.ends, first, count).for_each(|k| cut[k].rim.push(n));
        }
        cut
    }

    /// The planes, counted from `first`, that pass between `vertices`: at least one is below, and at least one is not.
    fn planes(&self, vertices: &[u32], first: usize, count: usize) -> std::ops::Range<usize> {
        let heights = vertices.iter().map(|&v| self.positions[v as usize].z);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| (low.min(z), high.max(z)));
        let number = |z: f64| (z.floor() + 1.0 - first as f64).clamp(0.0, count as f64) as usize;
        number(low)..number(high)
    }

    /// The closed slice contours in plane `z`.
    fn contours(&self, z: f64, cut: &Cut) -> Vec<Segment> {
        let of_triangles = cut.triangles.iter().map(|&n| self.segment(self.triangles[n as usize], z));
        let mut segments: Vec<Segment> = of_triangles.collect();
        let (mut ends, mut beginnings) = (Vec::new(), Vec::new());
        for edge in cut.rim.iter().map(|&n| &self.rim[n as usize]) {
            // Where a triangle's side goes up, its segment ends.
            let list = if self.is_above(edge.ends[1], z) { &mut ends } else { &mut beginnings };
            list.extend((0..edge.times).map(|_| self.node(edge.ends, z)));
        }
        segments.extend(gaps::pairs(&ends, &beginnings).into_iter().map(|(n, m)| [ends[n], beginnings[m]]));
        segments
    }

    fn is_above(&self, vertex: u32, z: f64) -> bool {
        self.positions[vertex as usize].z >= z
    }

    /// Where plane `z` cuts a triangle that has vertices on both sides of it: from the side that goes down to the one that
    /// goes up, so that what is behind the triangle is on the left.
    fn segment(&self, triangle: [u32; 3], z: f64) -> Segment {
        let above = triangle.map(|v| self.is_above(v, z));
        let side = |up: bool| (0..3).find(|&k| above[k] != up && above[(k + 1) % 3] == up).unwrap_or(0);
        [false, true].map(|up| self.node([triangle[side(up)], triangle[(side(up) + 1) % 3]], z))
    }

    /// Where plane `z` cuts an edge: the same for both of its directions.
    fn node(&self, [a, b]: [u32; 2], z: f64) -> DVec2 {
        let [p, q] = [a.min(b), a.max(b)].map(|v| self.positions[v as usize]);
        let t = ((z - p.z) / (q.z - p.z)).clamp(0.0, 1.0);
        p.truncate().lerp(q.truncate(), t)
    }
}
