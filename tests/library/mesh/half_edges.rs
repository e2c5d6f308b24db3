//! Editing keeps manifolds manifold.

use glam::DVec3;
use meshwright::mesh::{HalfEdges, NotManifold, TriMesh, ValidateOptions, validate};
use meshwright::progress::Progress;
use proptest::prelude::*;

use super::shapes::{cases, cube, torus, unit_cube};

fn topology(mesh: &TriMesh) -> HalfEdges {
    HalfEdges::new(&mesh.triangles, mesh.positions.len()).unwrap()
}

/// Whether every relation between the half-edges holds, and the triangles are a closed manifold of this genus.
fn assert_sound(mesh: &HalfEdges, genus: i64) {
    let half_edges = 0..3 * mesh.triangle_ids() as u32;
    for h in half_edges.filter(|&h| mesh.is_live(h)) {
        assert_eq!(mesh.twin(mesh.twin(h)), h);
        assert_eq!((mesh.origin(h), mesh.target(h)), (mesh.target(mesh.twin(h)), mesh.origin(mesh.twin(h))));
        assert!(mesh.is_live(mesh.twin(h)) && mesh.next(mesh.next(mesh.next(h))) == h && mesh.prev(mesh.next(h)) == h);
    }
    for v in (0..mesh.vertex_ids() as u32).filter(|&v| mesh.is_live_vertex(v)) {
        let ring: Vec<u32> = mesh.ring(v).collect();
        assert!(ring.len() >= 3 && ring.len() == mesh.valence(v));
        assert!(ring.iter().all(|&h| mesh.origin(h) == v));
        assert!((0..ring.len()).all(|k| mesh.target(ring[(k + 1) % ring.len()]) == mesh.apex(ring[k])));
    }
    let compact = mesh.compacted();
    assert_eq!(compact.triangles.len(), mesh.live_triangles());
    let soup = TriMesh { positions: vec![DVec3::ZERO; compact.vertices.len()], triangles: compact.triangles };
    let options = ValidateOptions { self_intersections: false, weld: false };
    let found = validate(&soup, &options, &Progress::none()).unwrap();
    assert!(found.is_oriented_manifold(), "{:?}", found.problems());
    assert_eq!((found.genus, found.unused_vertices, found.duplicate_triangles), (Some(genus), 0, 0));
}

/// The collapse of `from` into `to` on a plain list of triangles, and whether a manifold comes out of it.
fn collapses_by_brute_force(mesh: &HalfEdges, from: u32, to: u32) -> bool {
    let moved = mesh.to_triangles().into_iter().map(|t| t.map(|v| if v == from { to } else { v }));
    let left: Vec<[u32; 3]> = moved.filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]).collect();
    let vertices = mesh.vertex_ids();
    left.len() + 2 == mesh.live_triangles()
        && HalfEdges::new(&left, vertices)
            .is_ok_and(|m| (0..vertices as u32).all(|v| !m.is_live_vertex(v) || m.valence(v) >= 3))
}

fn flips_by_brute_force(mesh: &HalfEdges, h: u32) -> bool {
    let (u, v) = (mesh.origin(h), mesh.target(h));
    let (c, d) = (mesh.apex(h), mesh.apex(mesh.twin(h)));
    let (one, two) = (h / 3, mesh.twin(h) / 3);
    let mut list: Vec<[u32; 3]> = (0..mesh.triangle_ids() as u32)
        .filter(|&t| t != one && t != two && mesh.is_live_triangle(t))
        .map(|t| mesh.triangle(t))
        .collect();
    list.extend([[d, c, u], [c, d, v]]);
    let vertices = mesh.vertex_ids();
    HalfEdges::new(&list, vertices)
        .is_ok_and(|m| (0..vertices as u32).all(|v| !m.is_live_vertex(v) || m.valence(v) >= 3))
}

proptest! {
    #![proptest_config(cases(60))]

    #[test]
    fn legal_operations_keep_the_manifold(
        ring in 3..9u32,
        tube in 3..7u32,
        sphere in any::<bool>(),
        steps in prop::collection::vec((0..100usize, any::<u32>()), 1..150),
    ) {
        let (start, genus) = if sphere { (unit_cube(), 0) } else { (torus(ring, tube), 1) };
        let mut mesh = topology(&start);
        let mut vertices = start.positions.len();
        for (kind, pick) in steps {
            let h = pick % (3 * mesh.triangle_ids() as u32);
            if !mesh.is_live(h) {
                prop_assert!(!mesh.can_collapse(h) && !mesh.can_flip(h));
                continue;
            }
            let (u, v) = (mesh.origin(h), mesh.target(h));
            let (c, d) = (mesh.apex(h), mesh.apex(mesh.twin(h)));
            match kind {
                0..50 => {
                    let legal = mesh.can_collapse(h);
                    prop_assert_eq!(legal, collapses_by_brute_force(&mesh, u, v));
                    prop_assert_eq!(mesh.collapse(h), v);
                    prop_assert_eq!(mesh.is_live_vertex(u), !legal);
                    vertices -= usize::from(legal);
                }
                50..80 => {
                    let legal = mesh.can_flip(h);
                    prop_assert_eq!(legal, flips_by_brute_force(&mesh, h));
                    prop_assert_eq!(mesh.flip(h), legal);
                    if legal {
                        prop_assert_eq!((mesh.origin(h), mesh.target(h)), (d, c));
                        prop_assert_eq!(mesh.find(u, v), None);
                    }
                }
                _ => {
                    let new = mesh.split(h);
                    vertices += 1;
                    prop_assert_eq!((mesh.origin(h), mesh.target(h), mesh.valence(new)), (u, new, 4));
                    prop_assert!([u, v, c, d].iter().all(|&w| mesh.find(new, w).is_some()));
                }
            }
        }
        assert_sound(&mesh, genus);
        prop_assert_eq!(mesh.compacted().vertices.len(), vertices);
    }
}

#[test]
fn collapsing_as_long_as_possible_leaves_the_smallest_manifolds() {
    for (mesh, genus, at_most) in [(unit_cube(), 0, 4), (torus(30, 20), 1, 20)] {
        let mut edited = topology(&mesh);
        loop {
            let next = edited.edges().find(|&h| edited.can_collapse(h));
            let Some(h) = next else { break };
            edited.collapse(h);
        }
        assert_sound(&edited, genus);
        assert!(edited.live_triangles() <= at_most, "{}", edited.live_triangles());
    }
}

#[test]
fn what_is_no_closed_oriented_manifold_is_refused_with_the_place() {
    let refused = |change: fn(&mut Vec<[u32; 3]>)| {
        let mut mesh = unit_cube();
        change(&mut mesh.triangles);
        HalfEdges::new(&mesh.triangles, 8).unwrap_err()
    };
    let edges = |t: [u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|e| [e[0].min(e[1]), e[0].max(e[1])]);
    let last = edges(*unit_cube().triangles.last().unwrap());
    assert!(last.contains(&refused(|t| t.truncate(11)).edge));
    assert!(last.contains(&refused(|t| t[11].swap(0, 1)).edge));
    assert!(last.contains(&refused(|t| t.push(t[11])).edge));
    assert_eq!(refused(|t| t[4] = [1, 6, 6]), NotManifold { edge: [6, 6] });
    assert_eq!(refused(|t| t[4] = [1, 6, 8]).edge, [8, 1]);

    // Two closed surfaces with one vertex in common.
    let mut bow = unit_cube();
    bow.append(&cube(DVec3::ONE, 1.0));
    let bow = bow.welded();
    let shared = bow.positions.iter().position(|&p| p == DVec3::ONE).unwrap() as u32;
    assert_eq!(HalfEdges::new(&bow.triangles, 15).unwrap_err().edge[0], shared);
}

#[test]
fn collapses_that_do_not_touch_are_taken_back_in_any_order() {
    for (name, shape) in [("cube", unit_cube()), ("small torus", torus(5, 4)), ("torus", torus(24, 16))] {
        let before = topology(&shape);
        let mut mesh = before.clone();
        let mut locked = vec![false; shape.positions.len()];
        let mut records = Vec::new();
        for v in 0..locked.len() as u32 {
            let ring: Vec<u32> = if mesh.is_live_vertex(v) { mesh.ring(v).collect() } else { Vec::new() };
            let Some(&h) = ring.iter().find(|&&h| !locked[v as usize] && mesh.can_collapse(h)) else { continue };
            ring.iter().for_each(|&h| locked[mesh.target(h) as usize] = true);
            records.push(mesh.record(h));
            mesh.collapse_unchecked(h);
        }
        let collapsed = mesh.clone();
        // The even ones first, then the odd ones.
        let (even, odd): (Vec<_>, Vec<_>) = (0..records.len()).partition(|k| k % 2 == 0);
        even.iter().for_each(|&k| mesh.undo(&records[k]));
        for v in (0..mesh.vertex_ids() as u32).filter(|&v| mesh.is_live_vertex(v)) {
            assert_eq!(mesh.ring(v).count(), mesh.valence(v), "{name}");
        }
        odd.iter().for_each(|&k| mesh.undo(&records[k]));
        assert_eq!(mesh.to_triangles(), before.to_triangles(), "{name}");
        assert_eq!(mesh.live_triangles(), before.live_triangles(), "{name}");
        for h in 0..3 * mesh.triangle_ids() as u32 {
            assert_eq!(mesh.twin(h), before.twin(h), "{name}");
        }
        for v in 0..mesh.vertex_ids() as u32 {
            assert_eq!((mesh.valence(v), mesh.ring(v).count()), (before.valence(v), before.valence(v)), "{name}");
        }
        assert!(records.is_empty() || collapsed.live_triangles() < before.live_triangles(), "{name}");
    }
}
