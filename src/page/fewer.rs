//! Fewer triangles for the view: vertices that share a cell of a grid become one.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::mesh::TriMesh;

/// A mesh for the view, and where its parts come from.
#[derive(Debug, Clone, Default)]
pub(super) struct Fewer {
    /// The mesh.
    pub mesh: TriMesh,
    /// For each triangle the one that it was.
    pub triangles: Vec<u32>,
    /// For each vertex of the whole mesh the one that it became.
    pub vertex_of: Vec<u32>,
}

/// The most cells along the longest side.
const FINEST: u32 = 4096;

/// The mesh with at most `most` triangles, on the finest grid that gives so few; `None` where it has no more as it is.
pub(super) fn fewer(mesh: &TriMesh, most: usize) -> Option<Fewer> {
    if mesh.triangles.len() <= most {
        return None;
    }
    let bounds = mesh.bounds()?;
    let side = bounds.size().max_element().max(f64::MIN_POSITIVE);
    let on = |cells: u32| clustered(mesh, bounds.min, side / f64::from(cells));
    // The number of triangles grows with that of the cells, nearly: bisection ends at a grid that is fine enough.
    let (mut coarse, mut fine) = (2, FINEST);
    let mut found = on(coarse);
    while fine - coarse > (coarse / 32).max(1) {
        let middle = coarse.midpoint(fine);
        let made = on(middle);
        if made.triangles.len() <= most {
            (coarse, found) = (middle, made);
        } else {
            fine = middle;
        }
    }
    Some(found)
}

fn clustered(mesh: &TriMesh, origin: DVec3, cell: f64) -> Fewer {
    let mut numbers: FxHashMap<[i32; 3], u32> = FxHashMap::default();
    let (mut sums, mut counts): (Vec<DVec3>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut vertex_of = vec![0u32; mesh.positions.len()];
    for (p, number) in mesh.positions.iter().zip(&mut vertex_of) {
        let key = ((*p - origin) / cell).floor().as_ivec3().to_array();
        *number = *numbers.entry(key).or_insert(sums.len() as u32);
        if *number as usize == sums.len() {
            sums.push(DVec3::ZERO);
            counts.push(0.0);
        }
        sums[*number as usize] += *p;
        counts[*number as usize] += 1.0;
    }
    let mut seen = FxHashSet::default();
    let (mut triangles, mut of) = (Vec::new(), Vec::new());
    for (t, corners) in (0u32..).zip(&mesh.triangles) {
        let [a, b, c] = corners.map(|v| vertex_of[v as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        // The same way round, beginning with the smallest.
        let turned = if a < b && a < c {
            [a, b, c]
        } else if b < c {
            [b, c, a]
        } else {
            [c, a, b]
        };
        if seen.insert(turned) {
            triangles.push([a, b, c]);
            of.push(t);
        }
    }
    let positions = sums.iter().zip(&counts).map(|(sum, count)| *sum / *count).collect();
    Fewer { mesh: TriMesh { positions, triangles }, triangles: of, vertex_of }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_view_has_no_more_triangles_than_asked_for() {
        let mesh = crate::io::read("testdata/torus.ply").expect("our own").mesh;
        let before = mesh.triangles.len();
        assert!(fewer(&mesh, before).is_none());
        let made = fewer(&mesh, before / 4).expect("fewer");
        let count = made.mesh.triangles.len();
        assert!((before / 16..=before / 4).contains(&count), "{count} of {before}");
        assert_eq!(made.triangles.len(), count);
        assert!(made.mesh.check().is_ok());
    }
}
