//! The vertices of a raw contour, and which of them stand for several.

use std::ops::Range;

use glam::{DVec3, IVec3};
use rayon::prelude::*;

use super::groups::{Candidate, groups};
use super::place::place;
use super::{Collapsed, Contour, ContourVertex, Ground, Merge};
use crate::lattice::Lattice;
use crate::mesh::around::Around;
use crate::mesh::{Plane, Submesh};

/// Not a member of any group.
const ALONE: u32 = u32::MAX;

/// The vertices of one voxel.
#[derive(Debug)]
pub(super) struct Merger {
    /// Range in the list of members.
    members: Range<usize>,
    /// Where they are together, model units.
    at: DVec3,
    /// What that lies on.
    ground: Ground,
    /// Whether they are one vertex now.
    merged: bool,
}

/// The raw contour and what of it is merged.
pub(super) struct Merging<'a> {
    pub(super) raw: &'a Contour,
    pub(super) groups: Vec<Merger>,
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
    pub(super) fn new(
        raw: &'a Contour,
        lattice: &Lattice,
        planes: &(impl Fn(Ground) -> Option<Plane> + Sync),
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
                    vertices.iter().map(|&v| (raw.mesh.positions[v as usize], raw.vertices[v as usize].ground));
                let (at, ground) = place(points, voxel, lattice, planes);
                if let Merge::Flat { within } = merge {
                    let known = vertices.iter().map(|&v| planes(raw.vertices[v as usize].ground));
                    let near =
                        |plane: Option<Plane>| plane.is_none_or(|plane| plane.distance(at).abs() <= within * lattice.h);
                    if !known.clone().all(near) || known.flatten().any(|plane| !flat(plane.normal, planes, ground)) {
                        return None;
                    }
                }
                Some(Merger { members, at, ground, merged: characteristic == 1 })
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

    pub(super) fn voxel(&self, vertex: u32) -> IVec3 {
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

    /// Makes the vertices of groups stand for themselves again.
    pub(super) fn split(&mut self, groups: &[u32]) {
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
    pub(super) fn surroundings(&self, groups: &[u32]) -> (Vec<u32>, Vec<u32>) {
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

    /// The merged groups that the corners of raw triangles belong to.
    pub(super) fn groups_of(&self, triangles: impl Iterator<Item = u32>) -> Vec<u32> {
        let corners = triangles.flat_map(|t| self.raw.mesh.triangles[t as usize]);
        let mut groups: Vec<u32> = corners.filter_map(|v| self.merged_group(v)).collect();
        groups.sort_unstable();
        groups.dedup();
        groups
    }

    /// `groups` and the merged groups beside them.
    pub(super) fn with_neighbours(&self, groups: &[u32]) -> Vec<u32> {
        self.groups_of(self.surroundings(groups).1.into_iter())
    }

    pub(super) fn finish(self) -> Collapsed {
        let kept = self.raw.mesh.triangles.par_iter().filter_map(|&t| self.triangle(t)).collect();
        let Submesh { mesh, vertices: used } = Submesh::of(&self.at, kept);
        let mut starts = vec![0];
        let mut members = Vec::with_capacity(self.stands.len());
        for v in &used {
            members.extend_from_slice(self.crowd(v));
            starts.push(members.len() as u32);
        }
        let source = |&v: &u32| match self.merged_group(v) {
            Some(id) => ContourVertex { ground: self.groups[id as usize].ground, ..self.raw.vertices[v as usize] },
            None => self.raw.vertices[v as usize],
        };
        let merged = self.groups.iter().filter(|g| g.merged).count();
        Collapsed {
            contour: Contour { vertices: used.iter().map(source).collect(), mesh, folded_loops: self.raw.folded_loops },
            starts,
            members,
            raw: self.raw.vertices.clone(),
            merged,
            kept_apart: self.groups.len() - merged,
        }
    }
}

/// Whether a normal agrees with that of `ground` (20°), either way round.
fn flat(normal: DVec3, planes: &impl Fn(Ground) -> Option<Plane>, ground: Ground) -> bool {
    planes(ground).is_none_or(|other| normal.dot(other.normal).abs() > 0.94)
}
