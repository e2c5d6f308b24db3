//! Whether two triangles meet elsewhere than at what they share. Exact.

use glam::{DVec2, DVec3};

use super::predicates::{Face, clear_side_of_line, scale_of, side_of_line, without};

/// What two triangles have in common, as corner numbers (0 to 2) in each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shared {
    /// No corner.
    Nothing,
    /// One corner: its number in the first and in the second triangle.
    Corner(usize, usize),
    /// An edge: the numbers of the corners that are *not* shared.
    Edge(usize, usize),
    /// All three corners.
    All,
}

impl Shared {
    /// Compares two triangles corner by corner; each has three different corners.
    #[inline]
    pub(super) fn of<T: PartialEq>(a: &[T; 3], b: &[T; 3]) -> Self {
        let (mut count, mut sum_a, mut sum_b) = (0, 0, 0);
        for (i, p) in a.iter().enumerate() {
            for (j, q) in b.iter().enumerate() {
                if p == q {
                    count += 1;
                    sum_a += i;
                    sum_b += j;
                }
            }
        }
        match count {
            0 => Self::Nothing,
            1 => Self::Corner(sum_a, sum_b),
            2 => Self::Edge(3 - sum_a, 3 - sum_b),
            _ => Self::All,
        }
    }
}

/// Whether triangles `a` and `b` (model units) intersect: whether they have a point in common that
/// is neither a common corner nor on a common edge. Corners are common when their coordinates are
/// equal (−0 equals 0). A mere touch counts, and so does the same triangle twice in whatever order
/// of its corners. Triangles whose corners are exactly collinear intersect nothing but their
/// copies, and those with equal corners nothing at all: they are defects of another kind.
///
/// Exact for coordinates of any size; those 1e180 times smaller than the largest one count as zero
/// in products.
pub fn triangles_intersect(a: &[DVec3; 3], b: &[DVec3; 3]) -> bool {
    if [a, b].into_iter().any(|[p, q, r]| p == q || q == r || r == p) {
        return false;
    }
    let largest = a.iter().chain(b).fold(0f64, |m, p| m.max(p.abs().max_element()));
    let scale = scale_of(largest);
    match Shared::of(a, b) {
        Shared::All => true,
        shared => match (Face::new(a.map(|p| p * scale)), Face::new(b.map(|p| p * scale))) {
            (Some(a), Some(b)) => faces_intersect(&a, &b, shared),
            _ => false,
        },
    }
}

/// [`triangles_intersect`] for prepared faces.
#[inline]
pub(super) fn faces_intersect(a: &Face, b: &Face, shared: Shared) -> bool {
    match shared {
        Shared::Nothing => !clearly_apart(a, b) && apart_or_meeting(a, b),
        Shared::Corner(i, j) => fans_meet(a, b, i, j),
        Shared::Edge(i, j) => folded(a, b, i, j),
        Shared::All => true,
    }
}

/// Triangles over a common edge meet elsewhere only when one is folded onto the other's plane and
/// side. `i` and `j` number the corners off the edge.
fn folded(a: &Face, b: &Face, i: usize, j: usize) -> bool {
    let tip = b.corners[j];
    if a.clear_side(tip) != 0.0 {
        return false;
    }
    let [p, q, r] = [(i + 1) % 3, (i + 2) % 3, i].map(|k| without(a.axis, a.corners[k]));
    let s = without(a.axis, tip);
    // On different sides of the edge in a projection that keeps `a` a triangle: only the edge is common.
    if clear_side_of_line(p, q, r) * clear_side_of_line(p, q, s) < 0.0 || a.side(tip) != 0.0 {
        return false;
    }
    (side_of_line(p, q, r) > 0.0) == (side_of_line(p, q, s) > 0.0)
}

/// Triangles with one common corner, number `i` of `a` and `j` of `b`.
fn fans_meet(a: &Face, b: &Face, i: usize, j: usize) -> bool {
    let v = a.corners[i];
    let [p, q] = [a.corners[(i + 1) % 3], a.corners[(i + 2) % 3]];
    let [r, s] = [b.corners[(j + 1) % 3], b.corners[(j + 2) % 3]];
    if a.clear_side(r) * a.clear_side(s) > 0.0 {
        return false;
    }
    let flat = [v, p, q, r, s].map(|x| without(a.axis, x));
    if !wedges_overlap(flat, clear_side_of_line, true) {
        return false;
    }
    let (side_r, side_s) = (a.side(r), a.side(s));
    if side_r == 0.0 && side_s == 0.0 {
        return wedges_overlap(flat, side_of_line, false);
    }
    let (side_p, side_q) = (b.side(p), b.side(q));
    if one_sided(&[side_r, side_s]) || one_sided(&[side_p, side_q]) {
        return false;
    }
    // Both triangles reach from v along the line where their planes meet. With n and m their normals, that of `a`
    // goes towards n × m = (m·p) q − (m·q) p (from v) when p lies on the positive side of `b`; that of `b` goes towards m × n
    // when r lies on the positive side of `a`. Equal signs therefore mean opposite directions.
    let towards = |first: f64, second: f64| first > 0.0 || second < 0.0;
    towards(side_p, side_q) != towards(side_r, side_s)
}

/// Whether the angles p-v-q and r-v-s, less than 180° each, have a ray in common. With
/// `in_doubt` true, `side` gives 0 for unknown and the answer is false only if that is certain.
fn wedges_overlap([v, p, q, r, s]: [DVec2; 5], side: impl Fn(DVec2, DVec2, DVec2) -> f64, in_doubt: bool) -> bool {
    let turned = |a: DVec2, b: DVec2| if side(v, a, b) < 0.0 { (b, a) } else { (a, b) };
    if in_doubt && (side(v, p, q) == 0.0 || side(v, r, s) == 0.0) {
        return true;
    }
    let ((p, q), (r, s)) = (turned(p, q), turned(r, s));
    let (pr, rq, ps, sq) = (side(v, p, r), side(v, r, q), side(v, p, s), side(v, s, q));
    let within = |x: f64, y: f64| x >= 0.0 && y >= 0.0;
    within(pr, rq) || within(ps, sq) || within(-pr, ps)
}

/// Whether all signs are positive or all are negative.
fn one_sided(signs: &[f64]) -> bool {
    signs.iter().all(|&s| s > 0.0) || signs.iter().all(|&s| s < 0.0)
}

/// A filter for triangles without a common corner: true only if they certainly do not meet.
#[inline]
fn clearly_apart(a: &Face, b: &Face) -> bool {
    if one_sided(&b.corners.map(|p| a.clear_side(p))) || one_sided(&a.corners.map(|p| b.clear_side(p))) {
        return true;
    }
    // Neighbours on a flat face, the planes of which say nothing: a line of the projection separates them.
    let (flat_a, flat_b) = (a.flat(a.axis), b.flat(a.axis));
    line_separates(&flat_a, &flat_b, clear_side_of_line) || line_separates(&flat_b, &flat_a, clear_side_of_line)
}

/// Whether the line through an edge of `a` has `a` on one side and `b` strictly on the other.
fn line_separates(a: &[DVec2; 3], b: &[DVec2; 3], side: impl Fn(DVec2, DVec2, DVec2) -> f64) -> bool {
    (0..3).any(|k| {
        let (p, q, own) = (a[k], a[(k + 1) % 3], a[(k + 2) % 3]);
        let own = side(p, q, own);
        own != 0.0 && b.iter().all(|&r| own * side(p, q, r) < 0.0)
    })
}

/// The exact test of triangles without a common corner.
fn apart_or_meeting(a: &Face, b: &Face) -> bool {
    let of_b = b.corners.map(|p| a.side(p));
    if one_sided(&of_b) {
        return false;
    }
    if of_b.iter().all(|&s| s == 0.0) {
        let (flat_a, flat_b) = (a.flat(a.axis), b.flat(a.axis));
        return !line_separates(&flat_a, &flat_b, side_of_line) && !line_separates(&flat_b, &flat_a, side_of_line);
    }
    let of_a = a.corners.map(|p| b.side(p));
    if one_sided(&of_a) {
        return false;
    }
    // Each triangle meets the line common to both planes in an interval. The intervals overlap
    // when an end of one lies in the other triangle, and the ends are where edges cross the plane.
    crosses(a, &of_a, b) || crosses(b, &of_b, a)
}

/// Whether an edge of `a` that crosses the plane of `b` (or ends on it) meets `b`. An edge within the plane is
/// left out: the other two edges end at its ends.
fn crosses(a: &Face, sides: &[f64; 3], b: &Face) -> bool {
    (0..3).any(|k| {
        let next = (k + 1) % 3;
        let (s, t) = (sides[k], sides[next]);
        let transversal = !(s > 0.0 && t > 0.0 || s < 0.0 && t < 0.0 || s == 0.0 && t == 0.0);
        transversal && line_stabs(a.corners[k], a.corners[next], b)
    })
}

/// Whether the line from `p` to `q`, not parallel to the face, meets it.
fn line_stabs(p: DVec3, q: DVec3, face: &Face) -> bool {
    let (mut positive, mut negative) = (false, false);
    (0..3).all(|k| {
        let turn = super::predicates::side_of_plane(&[p, q, face.corners[k]], face.corners[(k + 1) % 3]);
        positive |= turn > 0.0;
        negative |= turn < 0.0;
        !(positive && negative)
    })
}
