//! The patches of a soup, as far as they matter for lids.

use glam::DVec3;

use crate::fill::{Lid, Rim};
use crate::mesh::{Bounds, TriMesh};
use crate::survey::Soup;

/// The patches of a soup.
pub(super) struct Patches {
    /// For each vertex a patch that has it.
    at: Vec<usize>,
    /// For each patch its area, square model units.
    pub area: Vec<f64>,
    /// For each patch six times the volume between its triangles and the origin, cubic model units.
    pub volume: Vec<f64>,
    /// For each patch its bounding box, where it has any triangles.
    bounds: Vec<Option<Bounds>>,
    /// For each patch its triangles.
    pub triangles: Vec<Vec<u32>>,
}

impl Patches {
    pub(super) fn of(soup: &Soup) -> Self {
        let mesh = &soup.mesh;
        let count = soup.patch_count;
        let mut patches = Self {
            at: vec![0; mesh.positions.len()],
            area: vec![0.0; count],
            volume: vec![0.0; count],
            bounds: vec![None; count],
            triangles: vec![Vec::new(); count],
        };
        for (t, patch) in soup.patch_of.iter().map(|patch| patch.index()).enumerate() {
            let [a, b, c] = mesh.corners(t);
            patches.triangles[patch].push(t as u32);
            patches.area[patch] += (b - a).cross(c - a).length() / 2.0;
            patches.volume[patch] += a.dot(b.cross(c));
            mesh.triangles[t].iter().for_each(|&v| patches.at[v as usize] = patch);
            patches.bounds[patch] = both(patches.bounds[patch].take(), Bounds::of([a, b, c]));
        }
        patches
    }

    /// The same patches, of which those that bands join are one. `pairs`: rims that are joined.
    pub(super) fn joined<'r>(mut self, pairs: impl Iterator<Item = [&'r Rim; 2]>) -> Self {
        for rims in pairs {
            let [one, other] = rims.map(|rim| self.beside(rim));
            if one == other {
                continue;
            }
            self.at.iter_mut().filter(|patch| **patch == other).for_each(|patch| *patch = one);
            self.area[one] += std::mem::take(&mut self.area[other]);
            self.volume[one] += std::mem::take(&mut self.volume[other]);
            let (bounds, triangles) = (self.bounds[other].take(), std::mem::take(&mut self.triangles[other]));
            self.bounds[one] = both(self.bounds[one].take(), bounds);
            self.triangles[one].extend(triangles);
        }
        self
    }

    /// The patch that a rim is of.
    pub(super) fn beside(&self, rim: &Rim) -> usize {
        self.at[rim.vertices[0] as usize]
    }

    /// The diagonal of the bounding box of the patch that a rim is of.
    pub(super) fn size_beside(&self, rim: &Rim) -> f64 {
        self.size(self.beside(rim))
    }

    /// The diagonal of the bounding box of a patch, model units.
    pub(super) fn size(&self, patch: usize) -> f64 {
        self.bounds[patch].as_ref().map_or(0.0, Bounds::diagonal)
    }

    /// Six times the volume between a patch and the cone from the middles of its rims over them: that of the patch closed by simple lids.
    pub(super) fn volume(&self, patch: usize, mesh: &TriMesh, rims: &[Rim]) -> f64 {
        let mut volume = self.volume[patch];
        for rim in rims.iter().filter(|rim| self.beside(rim) == patch) {
            let ends = rim.vertices.iter().zip(rim.vertices.iter().cycle().skip(1));
            let at = |v: &u32| mesh.positions[*v as usize];
            volume += ends.map(|(a, b)| rim.centre.dot(at(a).cross(at(b)))).sum::<f64>();
        }
        volume
    }
}

fn both(one: Option<Bounds>, other: Option<Bounds>) -> Option<Bounds> {
    match (one, other) {
        (Some(one), Some(other)) => Some(one.union(&other)),
        (one, other) => one.or(other),
    }
}

/// Where a vertex of a lid is.
pub(super) fn place(mesh: &TriMesh, lid: &Lid, vertex: u32) -> DVec3 {
    match (vertex as usize).checked_sub(mesh.positions.len()) {
        None => mesh.positions[vertex as usize],
        Some(new) => lid.positions[new],
    }
}
