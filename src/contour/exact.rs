//! Whether two triangles meet elsewhere than in the vertices and the edge they share. Exact.

use glam::DVec3;
use robust::{Coord, Coord3D, orient2d, orient3d};

fn coord3(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// The sign of the volume of `a b c d`.
fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    sign(orient3d(coord3(a), coord3(b), coord3(c), coord3(d)))
}

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// The sign of the area of `a b c` seen along coordinate axis `axis`.
fn turn(a: DVec3, b: DVec3, c: DVec3, axis: usize) -> i8 {
    let flat = |p: DVec3| Coord { x: p[(axis + 1) % 3], y: p[(axis + 2) % 3] };
    sign(orient2d(flat(a), flat(b), flat(c)))
}

/// An axis along which the triangle has an area; `None` for a degenerate one.
fn view(t: [DVec3; 3]) -> Option<usize> {
    (0..3).find(|&axis| turn(t[0], t[1], t[2], axis) != 0)
}

/// True when the corners lie on one line.
pub(super) fn is_degenerate(t: [DVec3; 3]) -> bool {
    view(t).is_none()
}

/// Whether the closed segment `p q` meets the closed triangle `t`, which must not be degenerate.
fn segment_meets(p: DVec3, q: DVec3, t: [DVec3; 3]) -> bool {
    let (at_p, at_q) = (side(t[0], t[1], t[2], p), side(t[0], t[1], t[2], q));
    if at_p == 0 && at_q == 0 {
        return view(t).is_some_and(|axis| flat_segment_meets(p, q, t, axis));
    }
    if at_p == at_q {
        return false;
    }
    let around = [0, 1, 2].map(|k| side(p, q, t[k], t[(k + 1) % 3]));
    around.iter().all(|&s| s >= 0) || around.iter().all(|&s| s <= 0)
}

/// [`segment_meets`] for a segment in the plane of the triangle, seen along `axis`.
fn flat_segment_meets(p: DVec3, q: DVec3, t: [DVec3; 3], axis: usize) -> bool {
    let within = |x: DVec3| {
        let s = [0, 1, 2].map(|k| turn(t[k], t[(k + 1) % 3], x, axis));
        s.iter().all(|&s| s >= 0) || s.iter().all(|&s| s <= 0)
    };
    within(p) || within(q) || (0..3).any(|k| flat_segments_cross(p, q, t[k], t[(k + 1) % 3], axis))
}

/// Whether two segments cross, seen along `axis`. Segments on one line may answer no: of two
/// triangles that meet so, an end of an edge lies in the other one.
fn flat_segments_cross(p: DVec3, q: DVec3, a: DVec3, b: DVec3, axis: usize) -> bool {
    let (ap, aq) = (turn(a, b, p, axis), turn(a, b, q, axis));
    let (pa, pb) = (turn(p, q, a, axis), turn(p, q, b, axis));
    ap * aq <= 0 && pa * pb <= 0 && (ap, aq) != (0, 0)
}

/// Whether two triangles meet in a point that is on no vertex or edge they have in common; vertices
/// are the same when their numbers are. Degenerate triangles meet everything.
pub(super) fn triangles_meet(a: [u32; 3], b: [u32; 3], at: impl Fn(u32) -> DVec3) -> bool {
    let (p, q) = (a.map(&at), b.map(&at));
    if is_degenerate(p) || is_degenerate(q) {
        return true;
    }
    let mut shared = [(0, 0); 3];
    let mut count = 0;
    for (i, u) in a.iter().enumerate() {
        if let Some(j) = b.iter().position(|v| v == u) {
            shared[count] = (i, j);
            count += 1;
        }
    }
    match count {
        0 => (0..3).any(|k| segment_meets(p[k], p[(k + 1) % 3], q) || segment_meets(q[k], q[(k + 1) % 3], p)),
        // what they share is convex and, if more than the vertex, leaves one of them through the side opposite
        1 => {
            let (i, j) = shared[0];
            segment_meets(p[(i + 1) % 3], p[(i + 2) % 3], q) || segment_meets(q[(j + 1) % 3], q[(j + 2) % 3], p)
        }
        2 => {
            let (i, j) = (3 - shared[0].0 - shared[1].0, 3 - shared[0].1 - shared[1].1);
            let (u, v) = (p[shared[0].0], p[shared[1].0]);
            side(u, v, p[i], q[j]) == 0 && view(p).is_none_or(|axis| turn(u, v, p[i], axis) == turn(u, v, q[j], axis))
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meet(points: &[[f64; 3]], a: [u32; 3], b: [u32; 3]) -> bool {
        let at = |v: u32| DVec3::from_array(points[v as usize]);
        assert_eq!(triangles_meet(a, b, at), triangles_meet(b, a, at));
        triangles_meet(a, b, at)
    }

    #[test]
    fn triangles_apart_piercing_touching_and_flat() {
        let base = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let with = |q: [[f64; 3]; 3]| meet(&[base, q].concat(), [0, 1, 2], [3, 4, 5]);
        assert!(!with([[1.0, 1.0, 1.0], [2.0, 1.0, 1.0], [1.0, 2.0, 1.0]]));
        assert!(with([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [1.0, 2.0, 1.0]]));
        assert!(with([[1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [1.0, 2.0, 1.0]]));
        assert!(with([[1.0, 1.0, 0.0], [1.5, 1.0, 0.0], [1.0, 1.5, 0.0]]));
        assert!(with([[-9.0, 1.0, 0.0], [9.0, 1.0, 0.0], [9.0, 1.1, 0.0]]));
        assert!(!with([[4.0, 4.0, 0.0], [5.0, 4.0, 0.0], [4.0, 5.0, 0.0]]));
    }

    #[test]
    fn shared_vertices_and_edges_do_not_count_but_folds_do() {
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.5, 0.9, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.4, 0.4, -1.0],
            [0.4, 0.4, 1.0],
        ];
        assert!(!meet(&points, [0, 1, 2], [2, 1, 3]), "flat neighbours");
        assert!(meet(&points, [0, 1, 2], [1, 0, 4]), "folded over the shared edge");
        assert!(!meet(&points, [0, 1, 2], [0, 5, 6]), "only a vertex");
        assert!(meet(&points, [0, 1, 2], [0, 3, 4]), "flat overlap from a shared vertex");
        assert!(meet(&points, [0, 1, 2], [0, 7, 8]), "pierced from a shared vertex");
        assert!(meet(&points, [0, 1, 2], [2, 1, 0]), "the same twice");
    }
}
