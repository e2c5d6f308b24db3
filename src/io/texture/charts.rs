//! Pieces of a surface on which textures go on evenly.

use glam::{DVec2, DVec3};
use rustc_hash::FxHashMap;

use super::{TexCoords, TextureMap};
use crate::mesh::TriMesh;

/// Coordinates that are not farther from where they would be if the neighbour's texture went on than this, or than this part of the triangles'
/// size on the image, are where they should be: files have them rounded.
const ROUNDING: f64 = 1e-5;
const UNEVEN: f64 = 1e-3;

/// A place and the coordinates that a corner has there.
type Corner = ([u64; 3], [u32; 2]);

/// A side of a triangle: which triangle, and which of its corners is opposite.
type TriangleSide = (u32, usize);

impl TextureMap {
    /// A number for each triangle of `mesh`, which is the same for all triangles of a *chart*: a piece of the surface that, laid into one plane, shows
    /// one picture. Two neighbours are of one chart if they have the same material and, at both ends of their common edge, the same
    /// coordinates, and if the texture goes on evenly over that edge. Where there are no coordinates, the material alone counts.
    pub fn charts(&self, mesh: &TriMesh) -> Vec<u32> {
        let count = mesh.triangles.len();
        let mut root: Vec<u32> = (0..count as u32).collect();
        let mut first_at: FxHashMap<[Corner; 2], TriangleSide> = FxHashMap::default();
        let mut first_of: FxHashMap<Option<u32>, u32> = FxHashMap::default();
        for t in 0..count {
            let material = self.material_of.get(t).copied().flatten();
            let Some(coordinates) = self.coordinates.get(t).copied().flatten() else {
                let first = *first_of.entry(material).or_insert(t as u32);
                join(&mut root, first, t as u32);
                continue;
            };
            let corners = mesh.corners(t);
            let corner = |k: usize| {
                let place = (corners[k] + 0.0).to_array().map(f64::to_bits);
                (place, coordinates[k].map(|x| (x + 0.0).to_bits()))
            };
            for k in 0..3 {
                let (a, b) = (corner((k + 1) % 3), corner((k + 2) % 3));
                let (other, opposite) = *first_at.entry([a.min(b), a.max(b)]).or_insert((t as u32, k));
                let same = self.material_of.get(other as usize).copied().flatten() == material;
                if other as usize != t && same && self.goes_on(mesh, (other, opposite), (t as u32, k)) {
                    join(&mut root, other, t as u32);
                }
            }
        }
        (0..count as u32).map(|t| find(&mut root, t)).collect()
    }

    /// Whether the texture of one triangle goes on evenly over the common side to another.
    fn goes_on(&self, mesh: &TriMesh, (s, i): TriangleSide, (t, k): TriangleSide) -> bool {
        let (Some(from), Some(to)) = (self.coordinates[s as usize], self.coordinates[t as usize]) else { return false };
        let (own, next) = (mesh.corners(s as usize), mesh.corners(t as usize));
        let place = |coordinates: &TexCoords, k: usize| DVec2::from(coordinates[k % 3].map(f64::from));
        // Along the side and across it, in the plane of each.
        let (start, end) = (own[(i + 1) % 3], own[(i + 2) % 3]);
        let along = (end - start).normalize_or_zero();
        let flat = |p: DVec3| {
            let along_it = (p - start).dot(along);
            DVec2::new(along_it, (p - start - along * along_it).length())
        };
        let (length, apex, beyond) = ((end - start).length(), flat(own[i]), flat(next[k]));
        if length <= 0.0 || apex.y <= 0.0 {
            return false;
        }
        let (a, b, c) = (place(&from, i + 1), place(&from, i + 2), place(&from, i));
        let per_along = (b - a) / length;
        let per_across = (c - a - per_along * apex.x) / apex.y;
        let wanted = a + per_along * beyond.x - per_across * beyond.y;
        let found = place(&to, k);
        let size = [b - a, c - a, found - a].map(|v| v.abs().max_element()).into_iter().fold(0.0, f64::max);
        (found - wanted).abs().max_element() <= ROUNDING + UNEVEN * size
    }
}

fn find(root: &mut [u32], mut t: u32) -> u32 {
    while root[t as usize] != t {
        root[t as usize] = root[root[t as usize] as usize];
        t = root[t as usize];
    }
    t
}

fn join(root: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn seams_and_materials_part_charts() {
        let positions = (0..6).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
        let mesh = TriMesh { positions, triangles: vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]] };
        let flat = |t: &[u32; 3]| Some(t.map(|v| mesh.positions[v as usize].truncate().as_vec2().to_array()));
        let whole = TextureMap {
            coordinates: mesh.triangles.iter().map(flat).collect(),
            material_of: vec![Some(0); 4],
            ..TextureMap::default()
        };
        assert_eq!(whole.charts(&mesh), [0; 4]);
        let mut seam = whole.clone();
        seam.coordinates[2..].iter_mut().flatten().flatten().for_each(|c| c[0] += 0.5);
        assert_eq!(seam.charts(&mesh), [0, 0, 2, 2]);
        let mut two = whole.clone();
        two.material_of[3] = Some(1);
        assert_eq!(two.charts(&mesh), [0, 0, 0, 3]);
        // Continuous, but squeezed.
        let mut squeezed = whole.clone();
        for coordinates in squeezed.coordinates.iter_mut().flatten().flatten() {
            coordinates[0] = coordinates[0].max(1.0).mul_add(0.5, coordinates[0].min(1.0));
        }
        assert_eq!(squeezed.charts(&mesh), [0, 0, 2, 2]);
        // Bent, but of one piece.
        let mut bent = mesh.clone();
        bent.positions[4..].iter_mut().for_each(|p| *p = DVec3::new(1.0, p.y, 1.0));
        assert_eq!(whole.charts(&bent), [0; 4]);
        let mut bare = two;
        bare.coordinates.fill(None);
        assert_eq!(bare.charts(&mesh), [0, 0, 0, 3]);
    }
}
