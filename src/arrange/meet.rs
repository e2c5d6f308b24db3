//! What two facets have in common: nothing, a point, a segment, or a plane.

use std::cmp::Ordering;

use super::facets::Facets;
use super::plane::Plane;
use super::point::{Exact, Made};

/// A point that two facets have in common.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::large_enum_variant, reason = "most are of the large sort, and an allocation each would cost more")]
pub(crate) enum Place {
    /// A vertex by its number.
    Vertex(u32),
    /// A point of an edge.
    Made(Made),
}

/// What two facets have in common.
#[derive(Debug, Clone, Copy)]
#[expect(clippy::large_enum_variant, reason = "most are of the large sort, and an allocation each would cost more")]
pub(crate) enum Meeting {
    Nothing,
    Point(Place),
    Segment([Place; 2]),
    /// They lie in one plane.
    Coplanar,
}

/// What two facets have in common, exactly; shared vertices and edges count like everything else.
pub(crate) fn meet(facets: &Facets, f: u32, g: u32) -> Meeting {
    let planes = [facets.plane(f), facets.plane(g)];
    let on_g = crossings(facets, f, &planes[1]);
    if let Crossings::Within = on_g {
        return Meeting::Coplanar;
    }
    let (Crossings::At(on_g), Crossings::At(on_f)) = (on_g, crossings(facets, g, &planes[0])) else {
        return Meeting::Nothing;
    };
    let axis = along(&planes);
    let exact = |place: &Place| match place {
        Place::Vertex(v) => Exact::lattice(facets.vertices[*v as usize]),
        Place::Made(made) => made.exact(),
    };
    let compare = |a: &Place, b: &Place| exact(a).compare_along(&exact(b), axis);
    let ordered = |[a, b]: [Place; 2]| if compare(&a, &b).is_gt() { [b, a] } else { [a, b] };
    let (p, q) = (ordered(on_g), ordered(on_f));
    // Of equal points a vertex is the better name.
    let best = |a: Place, b: Place, wanted: Ordering| match compare(&a, &b) {
        Ordering::Equal if matches!(b, Place::Vertex(_)) => b,
        order if order == wanted || order.is_eq() => a,
        _ => b,
    };
    let low = best(p[0], q[0], Ordering::Greater);
    let high = best(p[1], q[1], Ordering::Less);
    match compare(&low, &high) {
        Ordering::Less => Meeting::Segment([low, high]),
        Ordering::Equal if matches!(high, Place::Vertex(_)) => Meeting::Point(high),
        Ordering::Equal => Meeting::Point(low),
        Ordering::Greater => Meeting::Nothing,
    }
}

/// The axis along which the line of two planes is longest.
fn along(planes: &[Plane; 2]) -> usize {
    let [a, b] = planes.map(|plane| plane.normal.map(i128::from));
    let part = |i: usize, j: usize| (a[i] * b[j] - a[j] * b[i]).unsigned_abs();
    let size = [part(1, 2), part(2, 0), part(0, 1)];
    (0..3).max_by_key(|&k| (size[k], 3 - k)).unwrap_or(0)
}

/// Where a facet's edges meet a plane.
#[expect(clippy::large_enum_variant, reason = "most are of the large sort, and an allocation each would cost more")]
enum Crossings {
    Nowhere,
    /// The facet lies in the plane.
    Within,
    /// The ends of what it has in common with the plane, which may be one point.
    At([Place; 2]),
}

fn crossings(facets: &Facets, facet: u32, plane: &Plane) -> Crossings {
    let corners = facets.corners[facet as usize];
    let places = facets.places(facet);
    let values = places.map(|p| plane.value(p));
    let mut found = [None; 2];
    let mut count = 0;
    let mut add = |place: Place| {
        if count < 2 {
            found[count] = Some(place);
        }
        count += 1;
    };
    for k in 0..3 {
        let next = (k + 1) % 3;
        if values[k] == 0 {
            add(Place::Vertex(corners[k]));
        }
        if values[k].signum() * values[next].signum() < 0 {
            // From the lower number to the higher, so that both facets of an edge make the same point.
            let [a, b] = if corners[k] < corners[next] { [k, next] } else { [next, k] };
            add(Place::Made(Made::new(Exact::on_line([places[a], places[b]], values[a], values[b]))));
        }
    }
    match (count, found) {
        (3, _) => Crossings::Within,
        (_, [Some(a), Some(b)]) => Crossings::At([a, b]),
        (_, [Some(a), None]) => Crossings::At([a, a]),
        _ => Crossings::Nowhere,
    }
}
