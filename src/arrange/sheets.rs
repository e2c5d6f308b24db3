//! Sheets: what is triangulated at once. Facets of one plane that touch are one sheet, any other facet is one by itself.

use rayon::prelude::*;

use super::facets::Facets;
use super::meet::{Meeting, Place, meet};
use super::plane::Plane;
use super::point::{Exact, Made, Points};
use crate::mesh::edges::Union;
use crate::progress::{Progress, Stopped};

/// What lies over a segment of a sheet: a plane that cuts the sheet's own along it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Wall {
    /// The plane of another facet.
    Facet(u32),
    /// The plane through an edge of the sheet, along the axis that the sheet is seen from.
    Edge([u32; 2]),
}

/// A segment of a sheet.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) ends: [u32; 2],
    wall: Wall,
    /// The facets of the sheet of which it is an edge.
    pub(super) edge_of: Vec<u32>,
    /// The points on it that are not its ends.
    pub(super) within: Vec<u32>,
}

/// Facets of one plane and what cuts them.
#[derive(Debug)]
pub(super) struct Sheet {
    /// The facets, ascending; the first of them stands for all.
    pub(super) facets: Vec<u32>,
    /// The points on it besides the facets' corners, ascending.
    pub(super) points: Vec<u32>,
    pub(super) segments: Vec<Segment>,
    pub(super) plane: Plane,
    pub(super) axis: usize,
}

/// What is found in a sheet: a point on one or two of its segments.
#[expect(clippy::large_enum_variant, reason = "most are of the large sort, and an allocation each would cost more")]
enum Crossing {
    /// A point that has a number lies on a segment.
    On(usize, u32),
    /// Two segments cross.
    Two(usize, usize, Made),
}

/// What a pair of facets leaves on each of their sheets.
type Trace = (u32, [u32; 2], u32);

/// The sheets of facets that touch, by these pairs of facets. The points that they have in common get their numbers.
pub(super) fn sheets(
    facets: &Facets,
    pairs: &[[u32; 2]],
    points: &mut Points,
    progress: &Progress,
) -> Result<Vec<Sheet>, Stopped> {
    let meetings: Vec<Meeting> = pairs
        .par_iter()
        .with_min_len(256)
        .map(|&[f, g]| progress.check().map(|()| meet(facets, f, g)))
        .collect::<Result<_, _>>()?;
    let mut touched: Vec<u32> = pairs.iter().flatten().copied().collect();
    touched.sort_unstable();
    touched.dedup();
    points.expect(touched.iter().flat_map(|&f| facets.corners[f as usize]));
    let place_of = |f: u32| touched.partition_point(|&other| other < f);
    let mut union = Union::new(touched.len());
    for (&[f, g], meeting) in pairs.iter().zip(&meetings) {
        if matches!(meeting, Meeting::Coplanar) {
            union.join(place_of(f) as u32, place_of(g) as u32);
        }
    }
    let mut number = |place: &Place| match place {
        Place::Vertex(v) => *v,
        Place::Made(made) => points.number(made),
    };
    let mut traces: Vec<Trace> = Vec::new();
    for (&[f, g], meeting) in pairs.iter().zip(&meetings) {
        let ends = match meeting {
            Meeting::Segment(ends) => ends.each_ref().map(&mut number),
            Meeting::Point(place) => [number(place); 2],
            Meeting::Nothing | Meeting::Coplanar => continue,
        };
        let ends = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        traces.extend([(f, ends, g), (g, ends, f)]);
    }
    let roots: Vec<u32> = (0..touched.len() as u32).map(|n| union.root(n)).collect();
    Ok(gathered(facets, &touched, &roots, traces, place_of))
}

/// The sheets with their points and segments.
fn gathered(
    facets: &Facets,
    touched: &[u32],
    roots: &[u32],
    traces: Vec<Trace>,
    place_of: impl Fn(u32) -> usize + Sync,
) -> Vec<Sheet> {
    let mut members: Vec<(u32, u32)> = roots.iter().copied().zip(touched.iter().copied()).collect();
    members.sort_unstable();
    let mut traces: Vec<(u32, Trace)> = traces.into_iter().map(|trace| (roots[place_of(trace.0)], trace)).collect();
    traces.par_sort_unstable();
    let groups: Vec<&[(u32, u32)]> = members.chunk_by(|a, b| a.0 == b.0).collect();
    groups
        .par_iter()
        .map(|group| {
            let root = group[0].0;
            let from = traces.partition_point(|trace| trace.0 < root);
            let to = traces.partition_point(|trace| trace.0 <= root);
            Sheet::new(facets, group.iter().map(|member| member.1).collect(), &traces[from..to])
        })
        .collect()
}

impl Sheet {
    fn new(facets: &Facets, own: Vec<u32>, traces: &[(u32, Trace)]) -> Self {
        let plane = facets.plane(own[0]);
        let axis = plane.axis();
        let mut segments: Vec<Segment> = Vec::new();
        let segment = |ends, wall, edge_of| Segment { ends, wall, edge_of, within: Vec::new() };
        if own.len() > 1 {
            let mut edges: Vec<([u32; 2], u32)> = own
                .iter()
                .flat_map(|&f| {
                    let [a, b, c] = facets.corners[f as usize];
                    [[a, b], [b, c], [c, a]].map(|[a, b]| ([a.min(b), a.max(b)], f))
                })
                .collect();
            edges.sort_unstable();
            for same in edges.chunk_by(|a, b| a.0 == b.0) {
                let edge_of = same.iter().map(|edge| edge.1).collect();
                segments.push(segment(same[0].0, Wall::Edge(same[0].0), edge_of));
            }
        }
        let mut found: Vec<([u32; 2], u32)> = traces.iter().map(|&(_, (_, ends, other))| (ends, other)).collect();
        found.sort_unstable();
        let mut points: Vec<u32> = Vec::new();
        for same in found.chunk_by(|a, b| a.0 == b.0) {
            let ends = same[0].0;
            points.extend(ends);
            let is_edge = |f: &u32| ends.iter().all(|end| facets.corners[*f as usize].contains(end));
            if ends[0] != ends[1] && !own.iter().any(is_edge) {
                segments.push(segment(ends, Wall::Facet(same[0].1), Vec::new()));
            }
        }
        points.sort_unstable();
        points.dedup();
        points.retain(|p| !own.iter().any(|&f| facets.corners[f as usize].contains(p)));
        Self { facets: own, points, segments, plane, axis }
    }

    /// All points that have numbers: corners and others.
    pub(super) fn all_points(&self, facets: &Facets) -> Vec<u32> {
        let corners = self.facets.iter().flat_map(|&f| facets.corners[f as usize]);
        let mut all: Vec<u32> = corners.chain(self.points.iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn wall(&self, segment: usize, facets: &Facets) -> Plane {
        match self.segments[segment].wall {
            Wall::Facet(f) => facets.plane(f),
            Wall::Edge([a, b]) => Plane::wall(facets.vertices[a as usize], facets.vertices[b as usize], self.axis),
        }
    }

    /// Where segments of the sheet cross, and which points lie on them.
    fn crossings(&self, facets: &Facets, points: &Points) -> Vec<Crossing> {
        let mut found = Vec::new();
        if self.segments.is_empty() || (self.segments.len() < 2 && self.points.len() < 3) {
            return found;
        }
        let walls: Vec<Plane> = (0..self.segments.len()).map(|s| self.wall(s, facets)).collect();
        let span = |s: usize| {
            let [p, q] = self.segments[s].ends.map(|end| points.approximate(end));
            (p.min(q) - 1e-5, p.max(q) + 1e-5)
        };
        let spans: Vec<_> = (0..self.segments.len()).map(span).collect();
        // Along the axis on which the sheet is longest, segments and points are swept.
        let low = spans.iter().fold(glam::DVec3::INFINITY, |low, s| low.min(s.0));
        let high = spans.iter().fold(glam::DVec3::NEG_INFINITY, |high, s| high.max(s.1));
        let sweep = (high - low).max_position();
        let mut order: Vec<usize> = (0..self.segments.len()).collect();
        order.sort_by(|&a, &b| spans[a].0[sweep].total_cmp(&spans[b].0[sweep]).then(a.cmp(&b)));
        let overlap = |a: usize, b: usize| spans[a].0.cmple(spans[b].1).all() && spans[b].0.cmple(spans[a].1).all();
        for (n, &s) in order.iter().enumerate() {
            let behind = order[n + 1..].iter().take_while(|&&t| spans[t].0[sweep] <= spans[s].1[sweep]);
            for &t in behind.filter(|&&t| overlap(s, t)) {
                self.cross([s.min(t), s.max(t)], &walls, points, &mut found);
            }
        }
        let starts: Vec<f64> = order.iter().map(|&s| spans[s].0[sweep]).collect();
        let longest = spans.iter().map(|span| span.1[sweep] - span.0[sweep]).fold(0.0, f64::max);
        for p in self.all_points(facets) {
            let at = points.approximate(p);
            let from = starts.partition_point(|&start| start < at[sweep] - longest - 1e-4);
            let to = starts.partition_point(|&start| start <= at[sweep]);
            for &s in &order[from..to] {
                let near = at.cmpge(spans[s].0).all() && at.cmple(spans[s].1).all();
                if near
                    && !self.segments[s].ends.contains(&p)
                    && points.side(&walls[s], p) == 0
                    && self.is_between(s, p, points)
                {
                    found.push(Crossing::On(s, p));
                }
            }
        }
        found
    }

    /// Whether a point on the line of a segment lies between its ends.
    fn is_between(&self, segment: usize, p: u32, points: &Points) -> bool {
        let [a, b] = self.segments[segment].ends;
        let axis = points.longest_axis(a, b);
        let (first, second) = (points.compare_along(a, p, axis), points.compare_along(p, b, axis));
        first == second && first.is_ne()
    }

    /// The crossing of two segments between their ends.
    fn cross(&self, [s, t]: [usize; 2], walls: &[Plane], points: &Points, found: &mut Vec<Crossing>) {
        let apart = |segment: usize, wall: usize| {
            let [a, b] = self.segments[segment].ends;
            let side = points.side(&walls[wall], a);
            side != 0 && side == -points.side(&walls[wall], b)
        };
        let shared = self.segments[s].ends.iter().any(|end| self.segments[t].ends.contains(end));
        if shared || !apart(s, t) || !apart(t, s) {
            return;
        }
        if let Some(exact) = Exact::of_planes([&self.plane, &walls[s], &walls[t]]) {
            found.push(Crossing::Two(s, t, Made::new(exact)));
        }
    }
}

/// Finds where segments of the sheets cross and gives these points numbers, so that segments meet only at their ends and at the points
/// within.
pub(super) fn cross(
    sheets: &mut [Sheet],
    facets: &Facets,
    points: &mut Points,
    progress: &Progress,
) -> Result<(), Stopped> {
    let known = &*points;
    let found: Vec<Vec<Crossing>> = sheets
        .par_iter()
        .map(|sheet| progress.check().map(|()| sheet.crossings(facets, known)))
        .collect::<Result<_, _>>()?;
    for (sheet, found) in sheets.iter_mut().zip(found) {
        for crossing in found {
            match crossing {
                Crossing::On(s, p) => sheet.segments[s].within.push(p),
                Crossing::Two(s, t, made) => {
                    let p = points.number(&made);
                    sheet.points.push(p);
                    [s, t].iter().for_each(|&s| sheet.segments[s].within.push(p));
                }
            }
        }
        sheet.points.sort_unstable();
        sheet.points.dedup();
    }
    let known = &*points;
    sheets.par_iter_mut().for_each(|sheet| {
        for segment in &mut sheet.segments {
            let [a, b] = segment.ends;
            let axis = known.longest_axis(a, b);
            let up = known.compare_along(a, b, axis).is_lt();
            segment
                .within
                .sort_by(|&p, &q| if up { known.compare_along(p, q, axis) } else { known.compare_along(q, p, axis) });
            segment.within.dedup();
        }
    });
    Ok(())
}
