//! Triangulations of the plane with fixed edges, exact: points go in one by one, edges are recovered by flips, and what is left
//! free is made Delaunay as far as floating point can tell.

use std::collections::VecDeque;

use super::flat::FlatPoints;

/// No triangle on that side.
const NONE: u32 = u32::MAX;

/// A triangulation that grows inside of one triangle. Edge k of a triangle runs from its corner k to the next.
#[derive(Debug)]
pub(crate) struct Planar<'a> {
    points: &'a FlatPoints,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The triangle across each edge.
    across: Vec<[u32; 3]>,
    /// What is fixed at each edge: the number of a segment, or none.
    fixed: Vec<[u32; 3]>,
    /// A triangle at each point.
    at: Vec<u32>,
    last: u32,
}

/// Where a point lies.
enum Found {
    Inside(u32),
    Edge(u32, usize),
    Corner,
}

impl<'a> Planar<'a> {
    /// A triangle that runs counter-clockwise.
    pub(crate) fn new(points: &'a FlatPoints, corners: [u32; 3]) -> Self {
        let mut at = vec![NONE; points.len()];
        corners.iter().for_each(|&v| at[v as usize] = 0);
        Self { points, triangles: vec![corners], across: vec![[NONE; 3]], fixed: vec![[NONE; 3]], at, last: 0 }
    }

    /// What is fixed at an edge.
    pub(crate) fn fixed(&self, triangle: u32, k: usize) -> Option<u32> {
        Some(self.fixed[triangle as usize][k]).filter(|&segment| segment != NONE)
    }

    /// The triangle across an edge.
    pub(crate) fn across(&self, triangle: u32, k: usize) -> Option<u32> {
        Some(self.across[triangle as usize][k]).filter(|&t| t != NONE)
    }

    fn edge_to(&self, from: u32, to: u32) -> usize {
        self.across[from as usize].iter().position(|&t| t == to).unwrap_or(0)
    }

    /// Puts in a point that lies in the first triangle or on its edges.
    pub(crate) fn insert(&mut self, p: u32) {
        let around = match self.find(p) {
            Found::Corner => return,
            Found::Inside(t) => self.split_inside(t, p),
            Found::Edge(t, k) => self.split_edge(t, k, p),
        };
        self.last = around[0];
        let stack = around.into_iter().map(|t| self.opposite(t, p)).collect();
        self.improve_all(stack, 64 * self.points.len() + 64);
    }

    /// Flips edges, and those beside what was flipped, until they are Delaunay, or so many have been looked at.
    fn improve_all(&mut self, mut stack: Vec<[u32; 2]>, mut budget: usize) {
        while let Some([a, b]) = stack.pop() {
            let Some((t, k)) = self.edge(a, b) else { continue };
            budget -= 1;
            if budget == 0 {
                break;
            }
            if let Some([c, d]) = self.improve(t, k) {
                stack.extend([[a, c], [a, d], [b, c], [b, d]]);
            }
        }
    }

    /// The edge of a triangle that does not end in `p`.
    fn opposite(&self, t: u32, p: u32) -> [u32; 2] {
        let corners = self.triangles[t as usize];
        let k = corners.iter().position(|&v| v == p).unwrap_or(0);
        [corners[(k + 1) % 3], corners[(k + 2) % 3]]
    }

    fn find(&self, p: u32) -> Found {
        let mut t = self.last;
        // A walk in a triangulation that is not Delaunay may go round in circles: then all are asked.
        for step in 0..2 * self.triangles.len() + 8 {
            let turns = self.turns(t, p);
            let out = (0..3).map(|k| (k + step) % 3).find(|&k| turns[k] < 0);
            match out {
                None => return Self::found(t, turns),
                Some(k) if self.across[t as usize][k] != NONE => t = self.across[t as usize][k],
                Some(_) => break,
            }
        }
        let all = (0..self.triangles.len() as u32).map(|t| (t, self.turns(t, p)));
        all.into_iter()
            .find(|(_, turns)| turns.iter().all(|&turn| turn >= 0))
            .map_or(Found::Corner, |(t, turns)| Self::found(t, turns))
    }

    fn turns(&self, t: u32, p: u32) -> [i32; 3] {
        let [a, b, c] = self.triangles[t as usize];
        [self.points.turn(a, b, p), self.points.turn(b, c, p), self.points.turn(c, a, p)]
    }

    fn found(t: u32, turns: [i32; 3]) -> Found {
        match turns.iter().filter(|&&turn| turn == 0).count() {
            0 => Found::Inside(t),
            1 => Found::Edge(t, turns.iter().position(|&turn| turn == 0).unwrap_or(0)),
            _ => Found::Corner,
        }
    }

    fn put(&mut self, t: u32, corners: [u32; 3], across: [u32; 3], fixed: [u32; 3]) {
        if t as usize == self.triangles.len() {
            self.triangles.push(corners);
            self.across.push(across);
            self.fixed.push(fixed);
        } else {
            self.triangles[t as usize] = corners;
            self.across[t as usize] = across;
            self.fixed[t as usize] = fixed;
        }
        corners.iter().for_each(|&v| self.at[v as usize] = t);
    }

    /// Makes `of` know that its neighbour `old` is now `new`.
    fn relink(&mut self, of: u32, old: u32, new: u32) {
        if of != NONE {
            let k = self.edge_to(of, old);
            self.across[of as usize][k] = new;
        }
    }

    fn split_inside(&mut self, t: u32, p: u32) -> Vec<u32> {
        let [a, b, c] = self.triangles[t as usize];
        let [ab, bc, ca] = self.across[t as usize];
        let [fab, fbc, fca] = self.fixed[t as usize];
        let (u, v) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        self.put(t, [a, b, p], [ab, u, v], [fab, NONE, NONE]);
        self.put(u, [b, c, p], [bc, v, t], [fbc, NONE, NONE]);
        self.put(v, [c, a, p], [ca, t, u], [fca, NONE, NONE]);
        self.relink(bc, t, u);
        self.relink(ca, t, v);
        vec![t, u, v]
    }

    fn split_edge(&mut self, t: u32, k: usize, p: u32) -> Vec<u32> {
        let other = self.across[t as usize][k];
        let (first, new) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        let j = if other == NONE { 0 } else { self.edge_to(other, t) };
        // Corner k, p, corner k + 2 keeps the number; p, corner k + 1, corner k + 2 is new.
        let halves = |this: &Self, t: u32, k: usize| {
            let get = |list: &[[u32; 3]], n: usize| list[t as usize][(k + n) % 3];
            let corner = |n| get(&this.triangles, n);
            let (next, last) = (get(&this.across, 1), get(&this.across, 2));
            let fixed = [get(&this.fixed, 0), get(&this.fixed, 1), get(&this.fixed, 2)];
            ([corner(0), corner(1), corner(2)], next, last, fixed)
        };
        let ([a, b, c], bc, ca, [f, fbc, fca]) = halves(self, t, k);
        if other == NONE {
            self.put(t, [a, p, c], [NONE, first, ca], [f, NONE, fca]);
            self.put(first, [p, b, c], [NONE, bc, t], [f, fbc, NONE]);
            self.relink(bc, t, first);
            return vec![t, first];
        }
        let (_, ad, db, [_, fad, fdb]) = halves(self, other, j);
        let d = self.triangles[other as usize][(j + 2) % 3];
        self.put(t, [a, p, c], [new, first, ca], [f, NONE, fca]);
        self.put(first, [p, b, c], [other, bc, t], [f, fbc, NONE]);
        self.relink(bc, t, first);
        self.put(other, [b, p, d], [first, new, db], [f, NONE, fdb]);
        self.put(new, [p, a, d], [t, ad, other], [f, fad, NONE]);
        self.relink(ad, other, new);
        vec![t, first, other, new]
    }

    /// The triangle that has the edge from `a` to `b`, and which of its edges that is; for edges inside.
    fn edge(&self, a: u32, b: u32) -> Option<(u32, usize)> {
        self.around(a).into_iter().find_map(|(t, k)| {
            let corners = self.triangles[t as usize];
            match (corners[(k + 1) % 3] == b, corners[(k + 2) % 3] == b) {
                (true, _) => Some((t, k)),
                (_, true) => {
                    let k = (k + 2) % 3;
                    let other = self.across(t, k)?;
                    Some((other, self.edge_to(other, t)))
                }
                _ => None,
            }
        })
    }

    /// The triangles around a point, each with the place of the point among its corners.
    fn around(&self, p: u32) -> Vec<(u32, usize)> {
        let start = self.at[p as usize];
        let corner = |t: u32| self.triangles[t as usize].iter().position(|&v| v == p).unwrap_or(0);
        let mut fan = Vec::new();
        let mut t = start;
        loop {
            let k = corner(t);
            fan.push((t, k));
            t = self.across[t as usize][(k + 2) % 3];
            if t == start {
                return fan;
            }
            if t == NONE {
                break;
            }
        }
        t = self.across[start as usize][corner(start)];
        while t != NONE {
            let k = corner(t);
            fan.push((t, k));
            t = self.across[t as usize][k];
        }
        fan
    }

    /// Whether both triangles that a flip would make run counter-clockwise, with the other corners.
    fn flippable(&self, t: u32, k: usize) -> Option<[u32; 2]> {
        let other = self.across(t, k)?;
        let j = self.edge_to(other, t);
        let [a, b, c] = [0, 1, 2].map(|n| self.triangles[t as usize][(k + n) % 3]);
        let d = self.triangles[other as usize][(j + 2) % 3];
        (self.points.turn(a, d, c) > 0 && self.points.turn(d, b, c) > 0).then_some([c, d])
    }

    /// Turns the edge over: it then joins the other corners.
    fn flip(&mut self, t: u32, k: usize) {
        let other = self.across[t as usize][k];
        let j = self.edge_to(other, t);
        let take = |list: &[[u32; 3]], t: u32, k: usize| [0, 1, 2].map(|n| list[t as usize][(k + n) % 3]);
        let [a, b, c] = take(&self.triangles, t, k);
        let d = self.triangles[other as usize][(j + 2) % 3];
        let ([_, bc, ca], [_, ad, db]) = (take(&self.across, t, k), take(&self.across, other, j));
        let ([_, fbc, fca], [_, fad, fdb]) = (take(&self.fixed, t, k), take(&self.fixed, other, j));
        self.put(t, [a, d, c], [ad, other, ca], [fad, NONE, fca]);
        self.put(other, [d, b, c], [db, bc, t], [fdb, fbc, NONE]);
        self.relink(ad, other, t);
        self.relink(bc, t, other);
    }

    /// Flips a free edge if that makes it Delaunay; returns its new ends.
    fn improve(&mut self, t: u32, k: usize) -> Option<[u32; 2]> {
        if self.fixed[t as usize][k] != NONE {
            return None;
        }
        let [a, b] = [0, 1].map(|n| self.triangles[t as usize][(k + n) % 3]);
        let other = self.across(t, k)?;
        let c = self.triangles[t as usize][(k + 2) % 3];
        let d = self.triangles[other as usize][(self.edge_to(other, t) + 2) % 3];
        if !self.is_in_circle(a, b, c, d) {
            return None;
        }
        let ends = self.flippable(t, k)?;
        self.flip(t, k);
        Some(ends)
    }

    /// Whether `d` lies clearly inside of the circle through `a`, `b`, `c`, which run counter-clockwise.
    fn is_in_circle(&self, a: u32, b: u32, c: u32, d: u32) -> bool {
        let d = self.points.near(d);
        let [a, b, c] = [a, b, c].map(|v| self.points.near(v) - d);
        let (la, lb, lc) = (a.length_squared(), b.length_squared(), c.length_squared());
        let terms = [la * b.perp_dot(c), lb * c.perp_dot(a), lc * a.perp_dot(b)];
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        terms.iter().sum::<f64>() > 1e-9 * size
    }

    /// Makes the segment from `a` to `b`, which crosses no other one and no point, an edge, and fixes it.
    pub(crate) fn fix(&mut self, a: u32, b: u32, segment: u32) {
        let mut crossed = self.crossed(a, b);
        let mut budget = 16 * (crossed.len() + 4) * (crossed.len() + 4);
        while let Some([p, q]) = crossed.pop_front() {
            budget = budget.saturating_sub(1);
            let Some((t, k)) = self.edge(p, q) else { continue };
            let Some([c, d]) = self.flippable(t, k) else {
                crossed.push_back([p, q]);
                if budget == 0 {
                    break;
                }
                continue;
            };
            self.flip(t, k);
            let apart = ![c, d].contains(&a) && ![c, d].contains(&b);
            if apart && self.points.turn(a, b, c) * self.points.turn(a, b, d) < 0 {
                crossed.push_back([c, d]);
            }
        }
        if let Some((t, k)) = self.edge(a, b).or_else(|| self.edge(b, a)) {
            self.mark(t, k, segment);
        } else {
            self.mark_border(a, b, segment);
        }
    }

    fn mark(&mut self, t: u32, k: usize, segment: u32) {
        self.fixed[t as usize][k] = segment;
        if let Some(other) = self.across(t, k) {
            let j = self.edge_to(other, t);
            self.fixed[other as usize][j] = segment;
        }
    }

    /// Marks an edge that has a triangle on one side alone.
    fn mark_border(&mut self, a: u32, b: u32, segment: u32) {
        for (t, k) in self.around(a) {
            for k in [k, (k + 2) % 3] {
                let ends = [0, 1].map(|n| self.triangles[t as usize][(k + n) % 3]);
                if ends == [a, b] || ends == [b, a] {
                    self.mark(t, k, segment);
                }
            }
        }
    }

    /// The edges that the segment from `a` to `b` crosses, in their order.
    fn crossed(&self, a: u32, b: u32) -> VecDeque<[u32; 2]> {
        let mut crossed = VecDeque::new();
        let start = self.around(a).into_iter().find_map(|(t, k)| {
            let [p, q] = [1, 2].map(|n| self.triangles[t as usize][(k + n) % 3]);
            let passes = p != b && q != b && self.points.turn(a, p, b) > 0 && self.points.turn(a, b, q) > 0;
            passes.then_some((t, (k + 1) % 3))
        });
        let Some((mut t, mut k)) = start else { return crossed };
        for _ in 0..self.triangles.len() {
            let [p, q] = [0, 1].map(|n| self.triangles[t as usize][(k + n) % 3]);
            crossed.push_back([p, q]);
            let Some(other) = self.across(t, k) else { break };
            let j = self.edge_to(other, t);
            let r = self.triangles[other as usize][(j + 2) % 3];
            if r == b {
                break;
            }
            // p is right of the segment and q left of it; edge j + 1 of the other runs from p to r, edge j + 2 from r to q.
            k = if self.points.turn(a, b, r) > 0 { (j + 1) % 3 } else { (j + 2) % 3 };
            t = other;
        }
        crossed
    }

    /// Makes free edges Delaunay, once all segments are fixed.
    pub(crate) fn relax(&mut self) {
        let mut stack: Vec<[u32; 2]> = Vec::new();
        for t in 0..self.triangles.len() {
            let corners = self.triangles[t];
            stack.extend((0..3).map(|k| [corners[k], corners[(k + 1) % 3]]).filter(|[a, b]| a < b));
        }
        let budget = 16 * stack.len() + 64;
        self.improve_all(stack, budget);
    }
}
