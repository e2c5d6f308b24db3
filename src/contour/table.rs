//! What every one of the 256 sign patterns of a cell asks for: its loops and their triangulations.
//! Derived once from the rule of the faces; nothing is typed in.

use std::sync::LazyLock;

/// Most vertices of a loop.
pub(super) const MOST_VERTICES: usize = 7;

/// One way to cut a loop into triangles.
#[derive(Debug, Clone)]
pub(super) struct Triangulation {
    /// Bit `k`: diagonal `k` of the loop is used.
    pub diagonals: u16,
    /// Corners, as positions within the loop; the loop's orientation.
    pub triangles: Vec<[u8; 3]>,
}

/// One polygon of a cell, counter-clockwise seen from outside the solid.
#[derive(Debug, Clone)]
pub(super) struct Loop {
    /// Cell edges in order; see [`edge_ends`].
    pub edges: Vec<u8>,
    /// The allowed diagonals, as pairs of positions within the loop.
    pub diagonals: Vec<[u8; 2]>,
    /// All triangulations made of allowed diagonals; at least one.
    pub triangulations: Vec<Triangulation>,
}

/// The loops of a cell by its pattern: bit `x + 2 y + 4 z` is set where that corner is inside.
pub(super) static LOOPS: LazyLock<Vec<Vec<Loop>>> = LazyLock::new(|| (0..256).map(loops_of).collect());

/// The corners (bits x, y, z) of cell edge `edge` = `4 axis + k`: the bits of `k` are the places
/// along the axes `axis + 1` and `axis + 2` (mod 3). The lower corner comes first.
pub(super) const fn edge_ends(edge: u8) -> (u8, u8) {
    let axis = edge / 4;
    let k = edge % 4;
    let low = (k & 1) << ((axis + 1) % 3) | (k >> 1) << ((axis + 2) % 3);
    (low, low | 1 << axis)
}

/// Whether corner `corner` lies on face `face` = `2 axis + side`.
const fn on_face(corner: u8, face: u8) -> bool {
    (corner >> (face / 2)) & 1 == face % 2
}

fn edge_on_face(edge: u8, face: u8) -> bool {
    let (low, high) = edge_ends(edge);
    on_face(low, face) && on_face(high, face)
}

fn share_a_face(a: u8, b: u8) -> bool {
    (0..6).any(|face| edge_on_face(a, face) && edge_on_face(b, face))
}

/// The middle of an edge, in half cell units, or a corner with both ends equal.
fn middle(ends: (u8, u8)) -> [i32; 3] {
    [0, 1, 2].map(|axis| i32::from((ends.0 >> axis) & 1) + i32::from((ends.1 >> axis) & 1))
}

/// The edges `a` and `b` of `face`, in the order in which the loop passes them, given a corner of
/// the face that lies inside on their side: seen from outside the cell the solid is on the right.
fn directed(face: u8, a: u8, b: u8, inside: u8) -> (u8, u8) {
    let (pa, pb, pc) = (middle(edge_ends(a)), middle(edge_ends(b)), middle((inside, inside)));
    let (u, v) = ((face as usize / 2 + 1) % 3, (face as usize / 2 + 2) % 3);
    let turn = (pb[u] - pa[u]) * (pc[v] - pa[v]) - (pb[v] - pa[v]) * (pc[u] - pa[u]);
    if (turn > 0) == face.is_multiple_of(2) { (a, b) } else { (b, a) }
}

/// The directed links of one face. On a checkerboard each inside corner keeps its two edges to
/// itself, which both cells of the face see alike: cubes that share only an edge are separated.
fn links_of_face(pattern: u8, face: u8) -> Vec<(u8, u8)> {
    let inside = |corner: u8| (pattern >> corner) & 1 == 1;
    let crossed: Vec<u8> = (0..12)
        .filter(|&e| {
            let (low, high) = edge_ends(e);
            edge_on_face(e, face) && inside(low) != inside(high)
        })
        .collect();
    let inner = || (0..8).filter(|&c| on_face(c, face) && inside(c));
    match crossed[..] {
        [a, b] => {
            // a corner that is off the line through the two middles decides the side
            let corner = inner().find(|&c| touches(a, c) || touches(b, c));
            corner.map(|c| directed(face, a, b, c)).into_iter().collect()
        }
        [_, _, _, _] => inner()
            .filter_map(|c| {
                let mut at_corner = crossed.iter().copied().filter(|&e| touches(e, c));
                Some(directed(face, at_corner.next()?, at_corner.next()?, c))
            })
            .collect(),
        _ => Vec::new(),
    }
}

fn touches(edge: u8, corner: u8) -> bool {
    let (low, high) = edge_ends(edge);
    low == corner || high == corner
}

fn loops_of(pattern: usize) -> Vec<Loop> {
    let mut next = [u8::MAX; 12];
    for face in 0..6 {
        for (from, to) in links_of_face(pattern as u8, face) {
            next[from as usize] = to;
        }
    }
    let mut loops = Vec::new();
    for first in 0..12u8 {
        let mut edges = Vec::new();
        let mut edge = first;
        while next[edge as usize] != u8::MAX {
            edges.push(edge);
            edge = std::mem::replace(&mut next[edge as usize], u8::MAX);
        }
        if !edges.is_empty() {
            loops.push(with_triangulations(edges));
        }
    }
    loops
}

/// A diagonal whose ends lie on one face of the cell is forbidden: the cell beyond that face could
/// draw it too, and four triangles would meet in it.
fn with_triangulations(edges: Vec<u8>) -> Loop {
    let n = edges.len() as u8;
    let mut diagonals = Vec::new();
    for a in 0..n {
        for b in a + 2..n {
            if (a, b) != (0, n - 1) && !share_a_face(edges[a as usize], edges[b as usize]) {
                diagonals.push([a, b]);
            }
        }
    }
    let triangulations = cut(0, n - 1, n, &diagonals)
        .into_iter()
        .map(|triangles| {
            let used = |d: &[u8; 2]| triangles.iter().any(|t| t.contains(&d[0]) && t.contains(&d[1]));
            let mask = diagonals.iter().enumerate().map(|(k, d)| u16::from(used(d)) << k).sum();
            Triangulation { diagonals: mask, triangles }
        })
        .collect();
    Loop { edges, diagonals, triangulations }
}

/// All ways to cut the part of the loop from `a` to `b` (closed by the chord `a b`) into triangles.
fn cut(a: u8, b: u8, n: u8, diagonals: &[[u8; 2]]) -> Vec<Vec<[u8; 3]>> {
    if b - a < 2 {
        return vec![Vec::new()];
    }
    let allowed = |i: u8, j: u8| j - i == 1 || (i, j) == (0, n - 1) || diagonals.contains(&[i, j]);
    let mut all = Vec::new();
    for apex in a + 1..b {
        if !allowed(a, apex) || !allowed(apex, b) {
            continue;
        }
        for left in cut(a, apex, n, diagonals) {
            for right in cut(apex, b, n, diagonals) {
                let mut triangles = vec![[a, apex, b]];
                triangles.extend_from_slice(&left);
                triangles.extend_from_slice(&right);
                all.push(triangles);
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_has_few_short_loops_that_use_each_crossed_edge_once() {
        let mut longest = 0;
        let mut most = 0;
        for (pattern, loops) in LOOPS.iter().enumerate() {
            let mut crossed: Vec<u8> = (0..12)
                .filter(|&e| {
                    let (low, high) = edge_ends(e);
                    (pattern >> low) & 1 != (pattern >> high) & 1
                })
                .collect();
            let mut used: Vec<u8> = loops.iter().flat_map(|l| l.edges.clone()).collect();
            used.sort_unstable();
            crossed.sort_unstable();
            assert_eq!(used, crossed, "pattern {pattern}");
            for l in loops {
                assert!((3..=MOST_VERTICES).contains(&l.edges.len()), "pattern {pattern}");
                assert!(!l.triangulations.is_empty(), "pattern {pattern}");
                longest = longest.max(l.edges.len());
                for t in &l.triangulations {
                    assert_eq!(t.triangles.len(), l.edges.len() - 2);
                    assert_eq!(t.diagonals.count_ones() as usize, l.edges.len() - 3);
                }
            }
            most = most.max(loops.len());
        }
        assert_eq!((longest, most), (7, 4));
    }

    #[test]
    fn normals_point_away_from_a_lone_inside_corner() {
        for corner in 0..8u8 {
            let [l] = &LOOPS[1 << corner][..] else { panic!("corner {corner}") };
            let p: Vec<[i32; 3]> = l.edges.iter().map(|&e| middle(edge_ends(e))).collect();
            let c = middle((corner, corner));
            let d = |k: usize, axis: usize| p[k][axis] - p[0][axis];
            let normal = [0, 1, 2].map(|a| {
                let (u, v) = ((a + 1) % 3, (a + 2) % 3);
                d(1, u) * d(2, v) - d(1, v) * d(2, u)
            });
            let outwards: i32 = (0..3).map(|a| normal[a] * (p[0][a] - c[a])).sum();
            assert!(outwards > 0, "corner {corner}");
        }
    }
}
