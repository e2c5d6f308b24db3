//! Pieces of a surface on which textures are continuous.

use rustc_hash::FxHashMap;

use super::TextureMap;
use crate::mesh::TriMesh;

/// A place and the coordinates that a corner has there.
type Corner = ([u64; 3], [u32; 2]);

impl TextureMap {
    /// A number for each triangle of `mesh`, the same for triangles that have one material and, across an edge, the same coordinates at both
    /// ends; or all the same material and no coordinates.
    pub fn charts(&self, mesh: &TriMesh) -> Vec<u32> {
        let count = mesh.triangles.len();
        let mut root: Vec<u32> = (0..count as u32).collect();
        let mut first_at: FxHashMap<[Corner; 2], u32> = FxHashMap::default();
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
                let (a, b) = (corner(k), corner((k + 1) % 3));
                let other = *first_at.entry([a.min(b), a.max(b)]).or_insert(t as u32);
                if self.material_of.get(other as usize).copied().flatten() == material {
                    join(&mut root, other, t as u32);
                }
            }
        }
        (0..count as u32).map(|t| find(&mut root, t)).collect()
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
        let mut bare = two;
        bare.coordinates.fill(None);
        assert_eq!(bare.charts(&mesh), [0, 0, 0, 3]);
    }
}
