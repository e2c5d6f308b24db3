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
    /// For each patch the diagonal of its bounding box, model units.
    size: Vec<f64>,
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
            size: Vec::new(),
            triangles: vec![Vec::new(); count],
        };
        let mut bounds: Vec<Option<Bounds>> = vec![None; count];
        for (t, patch) in soup.patch_of.iter().map(|patch| patch.index()).enumerate() {
            let [a, b, c] = mesh.corners(t);
            patches.triangles[patch].push(t as u32);
            patches.area[patch] += (b - a).cross(c - a).length() / 2.0;
            patches.volume[patch] += a.dot(b.cross(c));
            mesh.triangles[t].iter().for_each(|&v| patches.at[v as usize] = patch);
            let own = Bounds::of([a, b, c]);
            bounds[patch] = match (bounds[patch].take(), own) {
                (Some(all), Some(own)) => Some(all.union(&own)),
                (all, own) => all.or(own),
            };
        }
        patches.size = bounds.iter().map(|bounds| bounds.as_ref().map_or(0.0, Bounds::diagonal)).collect();
        patches
    }

    /// The patch that a rim is of.
    pub(super) fn beside(&self, rim: &Rim) -> usize {
        self.at[rim.vertices[0] as usize]
    }

    /// The diagonal of the bounding box of the patch that a rim is of.
    pub(super) fn size_beside(&self, rim: &Rim) -> f64 {
        self.size[self.beside(rim)]
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

/// Where a vertex of a lid is.
pub(super) fn place(mesh: &TriMesh, lid: &Lid, vertex: u32) -> DVec3 {
    match (vertex as usize).checked_sub(mesh.positions.len()) {
        None => mesh.positions[vertex as usize],
        Some(new) => lid.positions[new],
    }
}
