//! Where solids touch at an edge or a vertex alone, the surface is no manifold: what touches is moved apart.
//!
//! Formats without vertex numbers tell vertices by their places, so that copies at one place would be one vertex again: each copy goes a few
//! steps into the material whose surface it is on.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::draft::{Draft, Kind};
use super::fine::Fine;
use crate::mesh::edges::{Edge, Edges, Union};

/// How far copies are moved: so many of the smallest steps that coordinates of their size may have.
const STEPS: f64 = 2.0;

/// Two triangles that bound one wedge of solid at an edge, as half-edges.
struct Wedge {
    /// The ends of the edge, the lower number first.
    ends: [u32; 2],
    halves: [u32; 2],
    /// Into the wedge, of unit length.
    inward: DVec3,
}

/// How often what touches is moved apart, each time twice as far: where many contacts are close together, two may come to one place again.
const ATTEMPTS: u32 = 6;

/// What came of moving apart what touches.
pub(crate) struct Separated {
    /// Vertices that were made for it.
    pub(crate) vertices: usize,
    /// Whether nothing touches any more.
    pub(crate) is_manifold: bool,
}

impl Draft {
    /// Moves apart what touches at edges and vertices alone. `factor` makes the moves longer.
    pub(crate) fn separate(&mut self, fine: &Fine, factor: f64) -> Separated {
        let mut vertices = 0;
        for attempt in 0..ATTEMPTS {
            let made = self.move_apart(fine, factor * f64::from(1 << attempt));
            if made == 0 {
                return Separated { vertices, is_manifold: true };
            }
            vertices += made;
            self.weld();
        }
        Separated { vertices, is_manifold: false }
    }

    /// Moves apart what touches, once; returns how many vertices were made.
    fn move_apart(&mut self, fine: &Fine, factor: f64) -> usize {
        let before = self.places.len();
        let (wedges, mut corners) = self.wedges();
        for wedge in &wedges {
            let [a, b] = wedge.halves;
            for k in 0..2 {
                let (a, b) = (self.corner_at(a, wedge.ends[k]), self.corner_at(b, wedge.ends[k]));
                corners.join(a, b);
            }
        }
        self.split_vertices(&mut corners, fine, factor);
        self.split_edges(&wedges, fine, factor);
        self.places.len() - before
    }

    fn point(&self, v: u32) -> DVec3 {
        DVec3::from_array(self.places[v as usize].map(f64::from))
    }

    /// The corner (3t + k) of a half-edge's triangle at one of its ends.
    fn corner_at(&self, half: u32, vertex: u32) -> u32 {
        let t = half / 3;
        let k = self.triangles[t as usize].iter().position(|&v| v == vertex).unwrap_or(0);
        3 * t + k as u32
    }

    /// The wedges of solid at edges with more than two triangles; and the corners around each vertex, joined over ordinary edges.
    fn wedges(&self) -> (Vec<Wedge>, Union) {
        let edges = Edges::new(&self.triangles, self.places.len());
        let mut corners = Union::new(3 * self.triangles.len());
        let mut wedges = Vec::new();
        edges.each(|edge| {
            let halves: Vec<u32> = edge.halves().collect();
            match halves[..] {
                [a, b] => edge.ends.iter().for_each(|&end| {
                    corners.join(self.corner_at(a, end), self.corner_at(b, end));
                }),
                _ => self.pair(&edge, &edges, &mut wedges),
            }
        });
        (wedges, corners)
    }

    /// Pairs the triangles at an edge by the wedges of solid between them: by the angle around the edge, from a triangle that runs down it to the next
    /// one that runs up.
    fn pair(&self, edge: &Edge<'_>, edges: &Edges<'_>, wedges: &mut Vec<Wedge>) {
        let [low, high] = edge.ends;
        let origin = self.point(low);
        let along = (self.point(high) - origin).normalize_or_zero();
        let first = along.any_orthonormal_vector();
        let second = along.cross(first);
        let mut around: Vec<(f64, bool, u32)> = edge
            .halves()
            .map(|half| {
                let [a, b, c] = self.triangles[half as usize / 3];
                let third = [c, a, b][half as usize % 3];
                let out = self.point(third) - origin;
                (out.dot(second).atan2(out.dot(first)), edges.runs_up(half), half)
            })
            .collect();
        around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        let count = around.len();
        let direction = |angle: f64| first * angle.cos() + second * angle.sin();
        let mut open: Vec<(f64, u32)> = Vec::new();
        // Twice around, so that wedges across the start are closed, too: a triangle that runs up has the solid before it, one that runs down after it.
        let mut used = vec![false; count];
        for n in 0..2 * count {
            let (angle, up, half) = around[n % count];
            let angle = angle + if n < count { 0.0 } else { std::f64::consts::TAU };
            if !up && n < count {
                open.push((angle, half));
            } else if up
                && !used[n % count]
                && let Some((from, other)) = open.pop()
            {
                used[n % count] = true;
                let inward = direction((from + angle) / 2.0);
                wedges.push(Wedge { ends: edge.ends, halves: [other, half], inward });
            }
        }
    }

    /// A place some steps away from a point in a direction.
    fn beside(&self, p: DVec3, inward: DVec3, fine: &Fine, factor: f64) -> [i32; 3] {
        let step = DVec3::from_array(p.abs().to_array().map(|size| fine.step_at(size)));
        // So far that rounding loses it along no axis that matters: near zero, where steps are short, a move may be too short for the others.
        let matters = inward.abs().max_element() / 4.0;
        let share = |k: usize| Some(inward[k].abs() / step[k]).filter(|_| inward[k].abs() > matters);
        let share = (0..3).filter_map(share).fold(f64::INFINITY, f64::min);
        let share = if share.is_finite() { share } else { 1.0 };
        fine.settled(p + inward / share * (STEPS * factor))
    }

    /// Gives each fan of triangles around a vertex a vertex of its own.
    fn split_vertices(&mut self, corners: &mut Union, fine: &Fine, factor: f64) {
        let mut fans: Vec<(u32, u32, u32)> = (0..3 * self.triangles.len() as u32)
            .map(|corner| (self.triangles[corner as usize / 3][corner as usize % 3], corners.root(corner), corner))
            .collect();
        fans.sort_unstable();
        let mut moves: Vec<(Vec<u32>, [i32; 3])> = Vec::new();
        for same in fans.chunk_by(|a, b| a.0 == b.0) {
            let parts: Vec<&[(u32, u32, u32)]> = same.chunk_by(|a, b| a.1 == b.1).collect();
            if parts.len() < 2 {
                continue;
            }
            for (n, part) in parts.iter().enumerate() {
                let others = parts.iter().enumerate().filter(|&(m, _)| m != n);
                let solid: Vec<bool> = others.map(|(_, other)| self.is_behind(part, self.middle(other[0].2))).collect();
                // Away from the other fans: into the solid's tip, or out of the void's; a fan between others stays.
                let away = match (solid.contains(&true), solid.contains(&false)) {
                    (true, true) => DVec3::ZERO,
                    (behind, _) => self.away(part, behind),
                };
                let place = self.beside(self.point(same[0].0), away.normalize_or_zero(), fine, factor);
                moves.push((part.iter().map(|entry| entry.2).collect(), place));
            }
        }
        for (corners, place) in moves {
            let v = self.add(place, Kind::Moved);
            for corner in corners.into_iter().map(|corner| corner as usize) {
                let mut triangle = self.triangles[corner / 3];
                triangle[corner % 3] = v;
                self.change(corner / 3, triangle);
            }
        }
    }

    /// A direction in which a fan of triangles leaves what lies behind it, where the solid is, or in front of it.
    fn away(&self, fan: &[(u32, u32, u32)], behind: bool) -> DVec3 {
        let angle = |corner: u32| {
            let [u, v] = self.legs(corner);
            u.dot(v).clamp(-1.0, 1.0).acos()
        };
        let corners = || fan.iter().map(|entry| entry.2);
        let middle: DVec3 = corners().map(|corner| self.middle(corner) * angle(corner)).sum();
        let outward: DVec3 = corners().map(|corner| self.weighted_normal(corner)).sum();
        // The normal of a narrow tip may lie across it; its middle does not.
        let is_tip = middle.length() > 0.5 * corners().map(angle).sum::<f64>();
        match is_tip {
            true if behind == self.is_behind(fan, middle) => -middle,
            true => middle,
            false if behind => outward,
            false => -outward,
        }
    }

    /// The directions of the edges of a corner's triangle that leave from it.
    fn legs(&self, corner: u32) -> [DVec3; 2] {
        let t = self.triangles[corner as usize / 3];
        let [p, q, r] = [0, 1, 2].map(|n| self.point(t[(corner as usize + n) % 3]));
        [q - p, r - p].map(DVec3::normalize_or_zero)
    }

    /// A direction from a corner into its triangle.
    fn middle(&self, corner: u32) -> DVec3 {
        let [u, v] = self.legs(corner);
        (u + v).normalize_or_zero()
    }

    /// Whether a direction from a vertex leads behind a fan of triangles around it: where the solid is. On the sphere of directions, an arc leads to
    /// the first triangle of the fan, and crosses others on its way.
    fn is_behind(&self, fan: &[(u32, u32, u32)], direction: DVec3) -> bool {
        let target = self.middle(fan[0].2);
        let plane = direction.cross(target);
        let crosses = |corner: u32| {
            let [u, v] = self.legs(corner);
            let own = u.cross(v);
            let between = |n: DVec3, a: DVec3, b: DVec3, p: DVec3| n.dot(a.cross(p)) > 0.0 && n.dot(p.cross(b)) > 0.0;
            let point = plane.cross(own);
            [point, -point].into_iter().any(|p| between(own, u, v, p) && between(plane, direction, target, p))
        };
        let crossings = fan[1..].iter().filter(|entry| crosses(entry.2)).count();
        let [u, v] = self.legs(fan[0].2);
        (u.cross(v).dot(direction) < 0.0) == crossings.is_multiple_of(2)
    }

    /// The unit normal of a corner's triangle times the angle there.
    fn weighted_normal(&self, corner: u32) -> DVec3 {
        let [u, v] = self.legs(corner);
        u.cross(v).normalize_or_zero() * u.dot(v).clamp(-1.0, 1.0).acos()
    }

    /// Gives each wedge at an edge that still has several a middle of its own.
    fn split_edges(&mut self, wedges: &[Wedge], fine: &Fine, factor: f64) {
        let ends = |this: &Self, half: u32| {
            let t = this.triangles[half as usize / 3];
            let [a, b] = [t[half as usize % 3], t[(half as usize + 1) % 3]];
            [a.min(b), a.max(b)]
        };
        let mut count: FxHashMap<[u32; 2], usize> = FxHashMap::default();
        wedges.iter().for_each(|wedge| *count.entry(ends(self, wedge.halves[0])).or_default() += 1);
        // The middle of each half-edge that is to be cut.
        let mut middles: FxHashMap<u32, u32> = FxHashMap::default();
        for wedge in wedges {
            let [a, b] = ends(self, wedge.halves[0]);
            if count[&[a, b]] > 1 {
                let middle = (self.point(a) + self.point(b)) / 2.0;
                let v = self.add(self.beside(middle, wedge.inward, fine, factor), Kind::Moved);
                wedge.halves.iter().for_each(|&half| _ = middles.insert(half, v));
            }
        }
        for t in 0..self.triangles.len() {
            let cuts = [0, 1, 2].map(|k| middles.get(&(3 * t as u32 + k)).copied());
            if cuts.iter().any(Option::is_some) {
                self.cut(t, cuts);
            }
        }
    }

    /// Cuts a triangle at the middles of its edges.
    fn cut(&mut self, t: usize, middles: [Option<u32>; 3]) {
        let corners = self.triangles[t];
        let mut ring: Vec<u32> = (0..3).flat_map(|k| [Some(corners[k]), middles[k]]).flatten().collect();
        let source = self.sources[t];
        let mut parts = Vec::new();
        // Corners between two middles go first; what is left is a fan.
        while ring.len() > 3 {
            let is_middle = |v: u32| middles.contains(&Some(v));
            let n = ring.len();
            let ear = (0..n).find(|&k| {
                let (before, at, after) = (ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]);
                !is_middle(at) && (is_middle(before) || is_middle(after))
            });
            let k = ear.unwrap_or(0);
            parts.push([ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]]);
            ring.remove(k);
        }
        self.change(t, [ring[0], ring[1], ring[2]]);
        parts.into_iter().for_each(|part| self.push(part, source, true));
    }
}
