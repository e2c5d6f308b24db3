//! The collapse of edges that join two faces of one voxel's cube (Bærentzen §5).
//!
//! Any two faces of a cube that share an edge of it are joined by an edge of the mesh, so to
//! collapse all such edges is to merge the vertices of each inside voxel. Instead of one collapse
//! after the other, all voxels are merged at once and the ones that did harm are split again, until
//! nothing is wrong: a vertex whose triangles are not one fan, a triangle that turned over, a fold,
//! an intersection, two vertices in one place, a small body turned inside out. Each step looks at all vertices in parallel and depends on no order; it ends
//! because the mesh without any merging is sound.

use glam::{DVec3, IVec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::bodies::{shells, volumes};
use super::groups::{Candidate, groups};
use super::place::place;
use super::star::{Fault, star_fault, triangle_fault};
use super::{Contour, ContourVertex, NO_TRIANGLE};
use crate::lattice::Lattice;
use crate::mesh::around::Around;
use crate::mesh::{TriMesh, intersecting_triangles};
use crate::progress::{Progress, Stopped};

/// Not a member of any group.
const ALONE: u32 = u32::MAX;

/// Searches for intersections after which everything is split again.
const MOST_SEARCHES: usize = 12;

/// Searches after which the neighbours of intersecting triangles are split too.
const PATIENT_SEARCHES: usize = 3;

/// Which voxels' vertices are merged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Merge {
    /// All, as in the paper.
    All,
    /// Those whose source triangles are nearly one plane, so that nothing is lost.
    Flat {
        /// How far the merged vertex may lie beside the planes, h.
        within: f64,
    },
}

/// What [`collapse_same_voxel`] made of a contour.
#[derive(Debug, Clone, PartialEq)]
pub struct Collapsed {
    /// The coarser contour. The voxel of a vertex stays the one it belongs to.
    pub contour: Contour,
    /// The raw vertices that became vertex v: `members[starts[v]..starts[v + 1]]` in `raw`.
    pub starts: Vec<u32>,
    /// See `starts`.
    pub members: Vec<u32>,
    /// The vertices of the raw contour.
    pub raw: Vec<ContourVertex>,
    /// Voxels whose vertices became one.
    pub merged: usize,
    /// Voxels whose vertices stayed apart, because merging them would have made the mesh
    /// non-manifold, turned a triangle over, or made triangles intersect.
    pub kept_apart: usize,
}

/// Merges the vertices of each voxel into one that lies on the planes of their source triangles.
///
/// `planes` gives the unit normal n and the offset n·x of an input triangle's plane, model units;
/// `None` for one without area. The result is as valid as the raw contour: closed, oriented,
/// manifold, without intersecting triangles, every coordinate an `f32`. Bærentzen §5, but for the
/// place of the merged vertex: the midpoint would leave the surface.
pub fn collapse_same_voxel(
    contour: Contour,
    lattice: &Lattice,
    planes: &(impl Fn(u32) -> Option<(DVec3, f64)> + Sync),
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

/// The vertices of one voxel.
#[derive(Debug)]
struct Group {
    /// Range in the list of members.
    members: std::ops::Range<usize>,
    /// Where they are together, model units.
    at: DVec3,
    /// The triangle on whose plane that is.
    triangle: u32,
    /// Whether they are one vertex now.
    merged: bool,
}

/// Triangles of the current state, and the raw triangle of each.
struct Part {
    mesh: TriMesh,
    origin: Vec<u32>,
}

/// The raw contour and what of it is merged.
pub(super) struct Merging<'a> {
    raw: &'a Contour,
    groups: Vec<Group>,
    members: Vec<u32>,
    group_of: Vec<u32>,
    /// The vertex that stands for a raw vertex.
    pub(super) stands: Vec<u32>,
    /// The current position of a vertex that stands for others or itself.
    pub(super) at: Vec<DVec3>,
    /// The raw triangles around each vertex.
    around: Around,
}

impl<'a> Merging<'a> {
    fn new(
        raw: &'a Contour,
        lattice: &Lattice,
        planes: &(impl Fn(u32) -> Option<(DVec3, f64)> + Sync),
        merge: Merge,
    ) -> Self {
        let count = raw.mesh.positions.len();
        let (members, candidates) = groups(&raw.vertices, planes);
        let mut merging = Self {
            raw,
            groups: Vec::new(),
            members,
            group_of: vec![ALONE; count],
            stands: (0..count as u32).collect(),
            at: raw.mesh.positions.clone(),
            around: Around::new(&raw.mesh),
        };
        merging.groups = candidates
            .into_par_iter()
            .filter_map(|Candidate { members, voxel }| {
                let vertices = &merging.members[members.clone()];
                let characteristic = merging.euler_characteristic(vertices);
                let unjoined = vertices.len() == 2 && characteristic == 2; // opposite faces
                if unjoined {
                    return None;
                }
                let points =
                    vertices.iter().map(|&v| (raw.mesh.positions[v as usize], raw.vertices[v as usize].triangle));
                let (at, triangle) = place(points, voxel, lattice, planes);
                if let Merge::Flat { within } = merge {
                    let triangles = vertices.iter().map(|&v| raw.vertices[v as usize].triangle);
                    let known = triangles.map(|t| (t != NO_TRIANGLE).then(|| planes(t)).flatten());
                    let near = |plane: Option<(DVec3, f64)>| {
                        plane.is_none_or(|(normal, offset)| (normal.dot(at) - offset).abs() <= within * lattice.h)
                    };
                    if !known.clone().all(near) || known.flatten().any(|(n, _)| !flat(n, planes, triangle)) {
                        return None;
                    }
                }
                Some(Group { members, at, triangle, merged: characteristic == 1 })
            })
            .collect();
        for (id, group) in merging.groups.iter().enumerate().filter(|(_, g)| g.merged) {
            let vertices = &merging.members[group.members.clone()];
            for &v in vertices {
                merging.group_of[v as usize] = id as u32;
                merging.stands[v as usize] = vertices[0];
            }
            merging.at[vertices[0] as usize] = group.at;
        }
        merging
    }

    /// Vertices minus edges plus triangles of the part of the raw mesh that some vertices span. A part
    /// that is connected and has 1 can shrink to a point without changing the surface's kind; a
    /// ring around a rod of voxels has 0.
    fn euler_characteristic(&self, vertices: &[u32]) -> i32 {
        let (mut sides, mut corners) = (0, 0);
        for &v in vertices {
            for (_, t) in self.triangles_at(v) {
                let next = |k: usize| t.iter().position(|&c| c == v).map_or(v, |i| t[(i + k) % 3]);
                let with_next = vertices.contains(&next(1));
                sides += i32::from(with_next);
                corners += i32::from(with_next && vertices.contains(&next(2)));
            }
        }
        vertices.len() as i32 - sides / 2 + corners / 3
    }

    fn voxel(&self, vertex: u32) -> IVec3 {
        self.raw.vertices[vertex as usize].voxel
    }

    /// The raw triangles around a raw vertex.
    fn triangles_at(&self, vertex: u32) -> impl Iterator<Item = (u32, [u32; 3])> {
        self.around.of(vertex).iter().map(|&t| (t, self.raw.mesh.triangles[t as usize]))
    }

    /// The group of a vertex if it is merged.
    pub(super) fn merged_group(&self, vertex: u32) -> Option<u32> {
        let id = self.group_of[vertex as usize];
        (id != ALONE && self.groups[id as usize].merged).then_some(id)
    }

    /// The raw vertices that `vertex`, which stands for itself, stands for.
    fn crowd<'b>(&'b self, vertex: &'b u32) -> &'b [u32] {
        match self.merged_group(*vertex) {
            Some(id) => &self.members[self.groups[id as usize].members.clone()],
            None => std::slice::from_ref(vertex),
        }
    }

    /// A raw triangle in terms of the vertices that stand for its own; `None` if it has vanished.
    pub(super) fn triangle(&self, raw: [u32; 3]) -> Option<[u32; 3]> {
        let [a, b, c] = raw.map(|v| self.stands[v as usize]);
        (a != b && b != c && c != a).then_some([a, b, c])
    }

    /// The corners of a raw triangle where they were at first.
    pub(super) fn raw_corners(&self, triangle: u32) -> [DVec3; 3] {
        self.raw.mesh.corners(triangle as usize)
    }

    /// The triangles around `vertex`, which stands for itself, as pairs of the other corners.
    pub(super) fn star<'b>(&'b self, vertex: &'b u32) -> impl Iterator<Item = (u32, u32)> + 'b {
        let v = *vertex;
        self.crowd(vertex).iter().flat_map(|&m| self.triangles_at(m)).filter_map(move |(_, t)| {
            let t = self.triangle(t)?;
            let k = t.iter().position(|&c| c == v)?;
            Some((t[(k + 1) % 3], t[(k + 2) % 3]))
        })
    }

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

    /// Makes the vertices of groups stand for themselves again.
    fn split(&mut self, groups: &[u32]) {
        for &id in groups {
            let group = &mut self.groups[id as usize];
            group.merged = false;
            for &v in &self.members[group.members.clone()] {
                self.stands[v as usize] = v;
                self.at[v as usize] = self.raw.mesh.positions[v as usize];
            }
        }
    }

    /// The vertices and raw triangles that see a change of `groups`.
    fn surroundings(&self, groups: &[u32]) -> (Vec<u32>, Vec<u32>) {
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for &id in groups {
            for &v in &self.members[self.groups[id as usize].members.clone()] {
                for (t, corners) in self.triangles_at(v) {
                    triangles.push(t);
                    vertices.extend(corners.map(|c| self.stands[c as usize]));
                }
            }
        }
        for list in [&mut vertices, &mut triangles] {
            list.sort_unstable();
            list.dedup();
        }
        (vertices, triangles)
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

    /// The merged groups that the corners of raw triangles belong to.
    fn groups_of(&self, triangles: impl Iterator<Item = u32>) -> Vec<u32> {
        let corners = triangles.flat_map(|t| self.raw.mesh.triangles[t as usize]);
        let mut groups: Vec<u32> = corners.filter_map(|v| self.merged_group(v)).collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    /// `groups` and the merged groups beside them.
    fn with_neighbours(&self, groups: &[u32]) -> Vec<u32> {
        self.groups_of(self.surroundings(groups).1.into_iter())
    }

    /// The current mesh; with `changed` groups, only the triangles that could meet a changed one. As
    /// no vertex is farther than 2 h from its inside voxel and the voxels of a triangle are corners of
    /// one cell, such triangles have voxels at most 6 apart: they lie in neighbouring blocks of 8³.
    fn mesh(&self, changed: Option<&[u32]>) -> Part {
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
        let (positions, triangles, _) = self.compact(kept);
        Part { mesh: TriMesh { positions, triangles }, origin }
    }

    /// Numbers the vertices that `triangles` use: positions, triangles, and the old number of each.
    fn compact(&self, mut triangles: Vec<[u32; 3]>) -> (Vec<DVec3>, Vec<[u32; 3]>, Vec<u32>) {
        let mut number = vec![ALONE; self.stands.len()];
        triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
        let used: Vec<u32> = (0..number.len() as u32).filter(|&v| number[v as usize] == 0).collect();
        used.iter().zip(0..).for_each(|(&v, n)| number[v as usize] = n);
        triangles.par_iter_mut().for_each(|t| *t = t.map(|v| number[v as usize]));
        (used.iter().map(|&v| self.at[v as usize]).collect(), triangles, used)
    }

    fn finish(self) -> Collapsed {
        let kept = self.raw.mesh.triangles.par_iter().filter_map(|&t| self.triangle(t)).collect();
        let (positions, triangles, used) = self.compact(kept);
        let mut starts = vec![0];
        let mut members = Vec::with_capacity(self.stands.len());
        for v in &used {
            members.extend_from_slice(self.crowd(v));
            starts.push(members.len() as u32);
        }
        let source = |&v: &u32| match self.merged_group(v) {
            Some(id) => ContourVertex { triangle: self.groups[id as usize].triangle, ..self.raw.vertices[v as usize] },
            None => self.raw.vertices[v as usize],
        };
        let merged = self.groups.iter().filter(|g| g.merged).count();
        Collapsed {
            contour: Contour {
                vertices: used.iter().map(source).collect(),
                mesh: TriMesh { positions, triangles },
                folded_loops: self.raw.folded_loops,
            },
            starts,
            members,
            raw: self.raw.vertices.clone(),
            merged,
            kept_apart: self.groups.len() - merged,
        }
    }
}

/// Whether a normal agrees with that of `triangle` (20°), either way round.
fn flat(normal: DVec3, planes: &impl Fn(u32) -> Option<(DVec3, f64)>, triangle: u32) -> bool {
    planes(triangle).is_none_or(|(other, _)| normal.dot(other).abs() > 0.94)
}
