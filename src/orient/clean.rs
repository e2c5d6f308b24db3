//! Exact cleaning: degenerate triangles, repetitions, and triangles present in both orientations.

use glam::DVec3;
use rayon::prelude::*;

use crate::mesh::TriMesh;
use crate::mesh::edges::{Edges, Union};
use crate::mesh::weld::canonical;

/// Edges with more triangles than this have no say about membranes.
const MOST_ON_AN_EDGE: usize = 16;

/// The soup after cleaning.
#[derive(Debug, Clone, Default)]
pub struct Cleaned {
    /// The triangles that are left, over vertices merged where their coordinates are equal.
    pub mesh: TriMesh,
    /// For each triangle that is left its number in the input.
    pub source: Vec<u32>,
    /// For each triangle that is left whether the input has it equally often in both orientations.
    pub unoriented: Vec<bool>,
    /// Number of triangles that were dropped because they have no area or a repeated vertex.
    pub degenerate: usize,
    /// Number of repetitions that were dropped.
    pub duplicates: usize,
    /// Number of triangles that were there in both orientations.
    pub both_sided: usize,
}

/// Merges vertices of equal coordinates, drops triangles without area, and keeps one of each set
/// of triangles over the same three vertices, in the orientation that most of the set have.
/// Both-sided triangles that only separate two bodies that are closed without them (a membrane
/// between boxes that share a face) are dropped altogether.
pub fn clean(input: &TriMesh) -> Cleaned {
    let welded = input.welded();
    let mut keyed: Vec<([u32; 3], u32)> = (0..welded.triangles.len() as u32)
        .into_par_iter()
        .filter(|&t| has_area(&welded, t))
        .map(|t| (canonical(welded.triangles[t as usize]).0, t))
        .collect();
    let degenerate = welded.triangles.len() - keyed.len();
    keyed.par_sort_unstable();
    let with_area = keyed.len();
    let mut kept: Vec<(u32, bool, bool)> = Vec::with_capacity(with_area);
    for same in keyed.chunk_by(|a, b| a.0 == b.0) {
        let even = |&&(_, t): &&([u32; 3], u32)| canonical(welded.triangles[t as usize]).1;
        let forward = same.iter().filter(even).count();
        let wanted = 2 * forward >= same.len();
        let first = same.iter().find(|entry| even(entry) == wanted).unwrap_or(&same[0]).1;
        kept.push((first, 2 * forward == same.len(), forward != 0 && forward != same.len()));
    }
    kept.par_sort_unstable();
    let mut cleaned = Cleaned {
        degenerate,
        duplicates: with_area - kept.len(),
        both_sided: kept.iter().filter(|k| k.2).count(),
        ..Cleaned::default()
    };
    cleaned.mesh.positions = welded.positions;
    cleaned.mesh.triangles = kept.iter().map(|k| welded.triangles[k.0 as usize]).collect();
    cleaned.source = kept.iter().map(|k| k.0).collect();
    cleaned.unoriented = kept.iter().map(|k| k.1).collect();
    drop_membranes(&mut cleaned);
    cleaned
}

/// Whether triangle `t` has three different vertices that are not on one line.
fn has_area(mesh: &TriMesh, t: u32) -> bool {
    let [a, b, c] = mesh.corners(t as usize);
    let n = (b - a).cross(c - a);
    n != DVec3::ZERO && n.is_finite()
}

/// Drops groups of both-sided triangles whose rims are closed without them.
fn drop_membranes(cleaned: &mut Cleaned) {
    if !cleaned.unoriented.contains(&true) {
        return;
    }
    let unoriented = &cleaned.unoriented;
    let edges = Edges::new(&cleaned.mesh.triangles, cleaned.mesh.positions.len());
    let mut group = Union::new(unoriented.len());
    edges.each(|edge| {
        let mut sided = edge.halves().map(|half| half / 3).filter(|&t| unoriented[t as usize]);
        if let Some(first) = sided.next() {
            sided.for_each(|t| _ = group.join(first, t));
        }
    });
    // A rim edge with an even number of other triangles speaks for dropping the group.
    let mut balance = vec![0i64; unoriented.len()];
    edges.each(|edge| {
        let sided = edge.halves().map(|half| half / 3).filter(|&t| unoriented[t as usize]);
        let others = edge.count() - sided.clone().count();
        if others > 0 && edge.count() <= MOST_ON_AN_EDGE {
            sided.for_each(|t| balance[group.root(t) as usize] += if others % 2 == 0 { 1 } else { -1 });
        }
    });
    let drop: Vec<bool> =
        (0..unoriented.len()).map(|t| unoriented[t] && balance[group.root(t as u32) as usize] > 0).collect();
    let keep = |t: &usize| !drop[*t];
    let all = 0..drop.len();
    cleaned.mesh.triangles = all.clone().filter(keep).map(|t| cleaned.mesh.triangles[t]).collect();
    cleaned.source = all.clone().filter(keep).map(|t| cleaned.source[t]).collect();
    cleaned.unoriented = all.filter(keep).map(|t| cleaned.unoriented[t]).collect();
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::shapes::tetrahedron;

    #[test]
    fn repetitions_and_flat_triangles_go_and_a_reversed_copy_marks_its_triangle() {
        let mut mesh = tetrahedron();
        mesh.triangles.extend([[1, 0, 2], [3, 1, 2], [1, 1, 2], [0, 3, 2], [2, 3, 0]]);
        let cleaned = clean(&mesh);
        assert_eq!(cleaned.mesh.triangles.len(), 4);
        assert_eq!((cleaned.degenerate, cleaned.duplicates, cleaned.both_sided), (1, 4, 1));
        // [0,3,2] was there twice, its reverse [2,3,0] once: the majority decides.
        assert!(!cleaned.unoriented.contains(&true));
    }

    #[test]
    fn of_doubled_faces_with_half_of_the_copies_reversed_one_each_is_left() {
        let mut mesh = tetrahedron();
        let copies: Vec<[u32; 3]> = mesh.triangles.iter().map(|&[a, b, c]| [b, c, a]).collect();
        mesh.triangles.extend(copies);
        mesh.triangles[4].swap(0, 1);
        mesh.triangles[6].swap(0, 1);
        let cleaned = clean(&mesh);
        assert_eq!((cleaned.duplicates, cleaned.both_sided), (4, 2));
        // One of each pair: either of a pair that disagrees, the first of one that agrees.
        let mut left: Vec<(u32, bool)> = cleaned.source.iter().map(|t| t % 4).zip(cleaned.unoriented).collect();
        left.sort_unstable();
        assert_eq!(left, [(0, true), (1, false), (2, true), (3, false)]);
        assert!(cleaned.source.contains(&1) && cleaned.source.contains(&3));
    }

    #[test]
    fn a_membrane_of_two_triangles_between_boxes_that_share_a_face_goes() {
        // Two unit boxes side by side; between them four triangles over the vertices 1, 3, 5, 7.
        let positions = (0..12u32).map(|n| match n {
            0..8 => DVec3::new((n & 1) as f64, (n >> 1 & 1) as f64, (n >> 2) as f64),
            _ => DVec3::new(2.0, (n & 1) as f64, (n >> 1 & 1) as f64),
        });
        let quads = |v: [u32; 8]| {
            let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            sides.map(|s| s.map(|k: usize| v[k])).into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]])
        };
        let (left, right) = ([0, 1, 2, 3, 4, 5, 6, 7], [1, 8, 3, 9, 5, 10, 7, 11]);
        let mut mesh = TriMesh { positions: positions.collect(), triangles: quads(left).chain(quads(right)).collect() };
        // The right box has the diagonal of the shared face the other way round: make it the same.
        let shared = mesh.triangles[10..12].to_vec();
        mesh.triangles[20..22].copy_from_slice(&[0, 1].map(|k| [shared[k][0], shared[k][2], shared[k][1]]));
        let cleaned = clean(&mesh);
        assert_eq!(cleaned.both_sided, 2);
        assert_eq!(cleaned.mesh.triangles.len(), 20);
        assert!(!cleaned.unoriented.contains(&true));
        // Without the membrane the outer hull is one closed patch.
        let edges = Edges::new(&cleaned.mesh.triangles, cleaned.mesh.positions.len());
        edges.each(|edge| assert_eq!(edge.count(), 2));
    }

    #[test]
    fn a_both_sided_lid_of_an_open_body_stays() {
        let mut mesh = tetrahedron();
        mesh.triangles.push([1, 3, 2]);
        let cleaned = clean(&mesh);
        assert_eq!(cleaned.mesh.triangles.len(), 4);
        assert_eq!(cleaned.unoriented.iter().filter(|&&sided| sided).count(), 1);
    }

    #[test]
    fn a_membrane_between_two_closed_bodies_goes() {
        let mut mesh = tetrahedron();
        // A second tetrahedron on the other side of face [1,2,3], which both have.
        mesh.positions.push(DVec3::ONE);
        mesh.triangles.extend([[1, 3, 2], [4, 3, 1], [4, 1, 2], [4, 2, 3]]);
        let cleaned = clean(&mesh);
        assert_eq!(cleaned.mesh.triangles.len(), 6);
        assert_eq!(cleaned.both_sided, 1);
    }
}
