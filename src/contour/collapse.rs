//! The collapse of edges that join two faces of one voxel's cube (Bærentzen §5).
//!
//! Any two faces of a cube that share an edge of it are joined by an edge of the mesh, so to
//! collapse all such edges is to merge the vertices of each inside voxel. Instead of one collapse
//! after the other, all voxels are merged at once and the ones that did harm are split again, until
//! nothing is wrong: a vertex whose triangles are not one fan, a triangle that turned over, a fold,
//! an intersection, two vertices in one place, a small body turned inside out. Each step looks at all vertices in parallel and depends on no order; it ends
//! because the mesh without any merging is sound.

use glam::IVec3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::bodies::{shells, volumes};
use super::merging::Merging;
use super::star::{Fault, star_fault, triangle_fault};
use super::{Collapsed, Contour, Ground, Merge};
use crate::lattice::Lattice;
use crate::mesh::{Plane, Submesh, TriMesh, intersecting_triangles};
use crate::progress::{Progress, Stopped};

/// Searches for intersections after which everything is split again.
const MOST_SEARCHES: usize = 12;

/// Searches after which the neighbours of intersecting triangles are split too.
const PATIENT_SEARCHES: usize = 3;

/// Merges the vertices of each voxel into one that lies on the planes of their source triangles.
///
/// `planes` gives the plane of what a vertex lies on, model units, where that is known and a triangle has an area. The result is as valid as the raw contour: closed, oriented,
/// manifold, without intersecting triangles, every coordinate an `f32`. Bærentzen §5, but for the
/// place of the merged vertex: the midpoint would leave the surface.
pub fn collapse_same_voxel(
    contour: Contour,
    lattice: &Lattice,
    planes: &(impl Fn(Ground) -> Option<Plane> + Sync),
    merge: Merge,
    progress: &Progress,
) -> Result<Collapsed, Stopped> {
    let (shells, mut merging) =
        rayon::join(|| shells(&contour.mesh), || Merging::new(&contour, lattice, planes, merge));
    progress.check()?;
    merging.settle(None, progress)?;
    let volumes = merging.volumes_before(&shells);
    let mut changed: Option<Vec<u32>> = None;
    for search in 0.. {
        let part = merging.mesh(changed.as_deref());
        let (intersecting, overturned) =
            rayon::join(|| intersecting_triangles(&part.mesh, progress), || merging.overturned(&shells, &volumes));
        let mut harmful = merging.groups_of(intersecting?.iter().map(|&t| part.origin[t as usize]));
        harmful.extend(overturned);
        harmful.extend(merging.coincident());
        harmful.sort_unstable();
        harmful.dedup();
        if harmful.is_empty() {
            break;
        }
        if search >= MOST_SEARCHES {
            harmful = (0..merging.groups.len() as u32).collect();
        } else if search >= PATIENT_SEARCHES {
            harmful = merging.with_neighbours(&harmful);
        }
        let mut split = harmful.clone();
        merging.split(&harmful);
        split.extend(merging.settle(Some(&harmful), progress)?);
        changed = Some(split);
    }
    Ok(merging.finish())
}

/// Triangles of the current state, and the raw triangle of each.
struct Present {
    mesh: TriMesh,
    origin: Vec<u32>,
}

impl Merging<'_> {
    /// Splits groups until no vertex and no triangle is at fault, and says which. Looks everywhere, or
    /// near the groups in `near` that have just been split.
    fn settle(&mut self, near: Option<&[u32]>, progress: &Progress) -> Result<Vec<u32>, Stopped> {
        let mut total = Vec::new();
        let (mut vertices, mut triangles) = match near {
            None => {
                let all: Vec<u32> = (0..self.stands.len() as u32).filter(|&v| self.stands[v as usize] == v).collect();
                (all, (0..self.raw.mesh.triangles.len() as u32).collect())
            }
            Some(groups) => self.surroundings(groups),
        };
        loop {
            progress.check()?;
            let this = &*self;
            let of_vertices = vertices.par_iter().with_min_len(256).filter_map(|v| star_fault(this, v));
            let of_triangles = triangles
                .par_iter()
                .with_min_len(256)
                .filter_map(|&t| triangle_fault(this, t, this.triangle(this.raw.mesh.triangles[t as usize])?));
            let faults: Vec<Fault> = of_vertices.chain(of_triangles).collect();
            let mut harmful: Vec<u32> = faults.iter().map(|f| f.group).collect();
            harmful.sort_unstable();
            harmful.dedup();
            if harmful.is_empty() {
                return Ok(total);
            }
            self.split(&harmful);
            (vertices, triangles) = self.surroundings(&harmful);
            total.extend(harmful);
        }
    }

    fn volumes_before(&self, shells: &[u32]) -> Vec<f64> {
        let mesh = &self.raw.mesh;
        volumes(shells, &mesh.positions, mesh.triangles.iter().zip(0..).map(|(t, id)| (t[0], mesh.corners(id))))
    }

    /// The merged groups of shells that have turned inside out.
    fn overturned(&self, shells: &[u32], before: &[f64]) -> Vec<u32> {
        let triangles = self.raw.mesh.triangles.iter().filter_map(|&t| self.triangle(t));
        let corners = triangles.map(|t| (t[0], t.map(|v| self.at[v as usize])));
        let after = volumes(shells, &self.raw.mesh.positions, corners);
        if after.iter().zip(before).all(|(after, before)| after * before > 0.0 || *before == 0.0) {
            return Vec::new();
        }
        let over = |v: usize| before[shells[v] as usize] * after[shells[v] as usize] <= 0.0;
        (0..shells.len()).filter(|&v| over(v)).filter_map(|v| self.merged_group(v as u32)).collect()
    }

    /// The merged groups whose vertex is exactly where another one is: in formats without indices the two would be one, and the
    /// search for intersections takes them for one.
    fn coincident(&self) -> Vec<u32> {
        let mut places: Vec<([u64; 3], u32)> = (0..self.stands.len() as u32)
            .into_par_iter()
            .filter(|&v| self.stands[v as usize] == v)
            .map(|v| ((self.at[v as usize] + 0.0).to_array().map(f64::to_bits), v))
            .collect();
        places.par_sort_unstable();
        let shared = places.chunk_by(|a, b| a.0 == b.0).filter(|same| same.len() > 1).flatten();
        shared.filter_map(|&(_, v)| self.merged_group(v)).collect()
    }

    /// The current mesh; with `changed` groups, only the triangles that could meet a changed one. As
    /// no vertex is farther than 2 h from its inside voxel and the voxels of a triangle are corners of
    /// one cell, such triangles have voxels at most 6 apart: they lie in neighbouring blocks of 8³.
    fn mesh(&self, changed: Option<&[u32]>) -> Present {
        let block = |v: u32| self.voxel(v) >> 3;
        let near = changed.map(|groups| {
            let blocks: FxHashSet<IVec3> = self.surroundings(groups).0.into_iter().map(block).collect();
            let steps = || (0..27).map(|k| IVec3::new(k % 3, k / 3 % 3, k / 9) - 1);
            blocks.iter().flat_map(|&b| steps().map(move |s| b + s)).collect::<FxHashSet<IVec3>>()
        });
        let wanted = |t: [u32; 3]| near.as_ref().is_none_or(|near| t.iter().any(|&v| near.contains(&block(v))));
        let all = self.raw.mesh.triangles.par_iter().enumerate();
        let (origin, kept): (Vec<u32>, Vec<[u32; 3]>) =
            all.filter(|(_, t)| wanted(**t)).filter_map(|(id, &t)| Some((id as u32, self.triangle(t)?))).unzip();
        Present { mesh: Submesh::of(&self.at, kept).mesh, origin }
    }
}
