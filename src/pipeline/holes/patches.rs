//! The patches of a soup, as far as they matter for lids.

use glam::DVec3;

use super::Plan;
use super::judge::Judge;
use super::maker::Made;
use crate::fill::{Lid, Rim};
use crate::mesh::{Bounds, TriMesh};
use crate::pipeline::NotLidded;
use crate::survey::Soup;

/// A patch whose lids have more than this part of its area is a sheet, of which lids would make something that it is not.
const MOST_LIDS: f64 = 0.5;

/// The patches of a soup.
pub(super) struct Patches {
    /// For each vertex a patch that has it.
    at: Vec<usize>,
    /// For each patch its area, square model units.
    area: Vec<f64>,
    /// For each patch six times the volume between its triangles and the origin, cubic model units.
    volume: Vec<f64>,
    /// For each patch the diagonal of its bounding box, model units.
    size: Vec<f64>,
    /// For each patch its triangles.
    pub triangles: Vec<Vec<u32>>,
}

/// For each patch why its rims have no lids, if so.
pub(super) struct Refused(Vec<Option<NotLidded>>);

impl Refused {
    /// Why a rim has none.
    pub(super) fn of(&self, rim: &Rim, patches: &Patches) -> Option<NotLidded> {
        self.0[patches.beside(rim)]
    }
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

    /// Which patches are not closed by their lids so that these are a small part of them and that they face outwards. Which way round other patches are is for the
    /// rays to find out: winding numbers of several that do not agree say nothing, so that then the others have no lids either.
    pub(super) fn refused(&self, mesh: &TriMesh, plan: &Plan, judge: &Judge<'_>) -> Refused {
        let (mut area, mut volume) = (vec![0.0; self.area.len()], self.volume.clone());
        for (rim, lid) in plan.rims.iter().zip(&plan.lids) {
            let Ok(Made { lid, .. }) = lid else { continue };
            let patch = self.beside(rim);
            area[patch] += lid.area;
            for triangle in &lid.triangles {
                let [a, b, c] = triangle.map(|v| place(mesh, lid, v));
                volume[patch] += a.dot(b.cross(c));
            }
        }
        let mut refused = vec![None; area.len()];
        for (rim, lid) in plan.rims.iter().zip(&plan.lids) {
            let patch = self.beside(rim);
            // With a rim that has no lid the volume says nothing.
            let is_closed = lid.is_ok();
            if area[patch] > MOST_LIDS * self.area[patch] {
                refused[patch] = Some(NotLidded::Sheet);
            } else if is_closed && volume[patch] * judge.sign <= 0.0 {
                refused[patch] = Some(NotLidded::FacesInwards);
            }
        }
        if refused.iter().any(Option::is_some) {
            refused.iter_mut().for_each(|why| *why = why.or(Some(NotLidded::Beside)));
        }
        Refused(refused)
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
