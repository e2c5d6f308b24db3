//! The topology of a closed, oriented manifold that can be edited: collapse, flip, split.
//!
//! Triangle-based: half-edge 3t+k runs from corner k of triangle t to the next corner, so a half-edge's triangle, its
//! next and its previous one need no storage. Positions live with the caller, one for each vertex id.

use super::edges::Buckets;
use super::weld::has_repeated_index;

/// No half-edge, no vertex: the mark of what was removed.
const NONE: u32 = u32::MAX;

/// The triangles are no closed, oriented 2-manifold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the triangles are not a closed oriented manifold at the edge of vertices {} and {}", edge[0], edge[1])]
pub struct NotManifold {
    /// The edge where that shows: an edge that lacks its one opposite, or an edge at a vertex with several fans; twice the
    /// same vertex for a triangle that repeats it; an edge with an index out of range.
    pub edge: [u32; 2],
}

/// The live triangles without gaps: what [`HalfEdges::compacted`] gives.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Compacted {
    /// The triangles, in the old order, over new vertex ids.
    pub triangles: Vec<[u32; 3]>,
    /// For each new vertex its old id, ascending.
    pub vertices: Vec<u32>,
}

/// How to take a collapse back; see [`HalfEdges::undo`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CollapseRecord {
    half_edge: u32,
    other: u32,
    /// The two triangles that vanish.
    removed: [[u32; 3]; 2],
    /// The half-edges across them that lie in the star.
    inner: [u32; 2],
    /// The other triangles of the star.
    star: Vec<u32>,
}

impl CollapseRecord {
    /// The triangles around the removed vertex that stay, with the vertex it went into as a corner.
    pub fn changed(&self) -> &[u32] {
        &self.star
    }
}

/// The triangles of a closed, oriented 2-manifold with the twin of each half-edge. Every operation takes constant time
/// but for the rings it visits. Ids stay what they are under all operations; what is removed leaves a
/// gap until [`HalfEdges::compacted`].
#[derive(Debug, Clone)]
pub struct HalfEdges {
    triangles: Vec<[u32; 3]>,
    twin: Vec<u32>,
    /// One half-edge that starts at the vertex.
    outgoing: Vec<u32>,
    valence: Vec<u32>,
    live_triangles: usize,
}

impl HalfEdges {
    /// The topology of `triangles` over vertices 0 to `vertex_count` − 1. Vertices without triangles are
    /// allowed and count as removed.
    pub fn new(triangles: &[[u32; 3]], vertex_count: usize) -> Result<Self, NotManifold> {
        for t in triangles {
            let over = (0..3).find(|&k| t[k] as usize >= vertex_count);
            if let Some(k) = over {
                return Err(NotManifold { edge: [t[k], t[(k + 1) % 3]] });
            }
            if has_repeated_index(*t) {
                let twice = if t[0] == t[1] { t[0] } else { t[2] };
                return Err(NotManifold { edge: [twice, twice] });
            }
        }
        let mut mesh = Self {
            triangles: triangles.to_vec(),
            twin: vec![NONE; 3 * triangles.len()],
            outgoing: vec![NONE; vertex_count],
            valence: vec![0; vertex_count],
            live_triangles: triangles.len(),
        };
        mesh.pair_up()?;
        mesh.check_fans()?;
        Ok(mesh)
    }

    /// Finds the twins, the outgoing half-edges and the valences.
    fn pair_up(&mut self) -> Result<(), NotManifold> {
        let halves = 0..3 * self.triangles.len() as u32;
        let ends = |h: u32| (self.origin(h).min(self.target(h)), self.origin(h).max(self.target(h)));
        let by_low = |h: usize| {
            let (low, high) = ends(h as u32);
            Some((low, (u64::from(high) << 32) | h as u64))
        };
        let buckets = Buckets::new(self.outgoing.len(), 3 * self.triangles.len(), by_low);
        for low in 0..buckets.keys() {
            for edge in buckets.get(low).chunk_by(|a, b| a >> 32 == b >> 32) {
                let not_manifold = NotManifold { edge: [low as u32, (edge[0] >> 32) as u32] };
                let &[a, b] = edge else { return Err(not_manifold) };
                let (a, b) = (a as u32, b as u32);
                if self.origin(a) == self.origin(b) {
                    return Err(not_manifold);
                }
                self.join(a, b);
            }
        }
        for h in halves.rev() {
            let origin = self.origin(h) as usize;
            self.outgoing[origin] = h;
            self.valence[origin] += 1;
        }
        Ok(())
    }

    /// Each ring must hold all half-edges that start at its vertex.
    fn check_fans(&self) -> Result<(), NotManifold> {
        for v in 0..self.outgoing.len() as u32 {
            if self.ring(v).count() != self.valence(v) {
                return Err(NotManifold { edge: [v, self.target(self.outgoing[v as usize])] });
            }
        }
        Ok(())
    }

    /// Number of vertex ids ever given, removed ones included.
    pub fn vertex_ids(&self) -> usize {
        self.outgoing.len()
    }

    /// Number of triangle ids ever given, removed ones included; half-edge ids are below three times this.
    pub fn triangle_ids(&self) -> usize {
        self.triangles.len()
    }

    /// Number of triangles.
    pub fn live_triangles(&self) -> usize {
        self.live_triangles
    }

    /// Whether the triangle of this id has not been removed.
    pub fn is_live_triangle(&self, triangle: u32) -> bool {
        self.triangles[triangle as usize][0] != NONE
    }

    /// Whether the half-edge of this id has not been removed.
    pub fn is_live(&self, half_edge: u32) -> bool {
        self.is_live_triangle(half_edge / 3)
    }

    /// Whether the vertex has triangles.
    pub fn is_live_vertex(&self, vertex: u32) -> bool {
        self.outgoing[vertex as usize] != NONE
    }

    /// The vertices of a triangle.
    #[inline]
    pub fn triangle(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    /// The vertex where a half-edge starts.
    #[inline]
    pub fn origin(&self, half_edge: u32) -> u32 {
        self.triangles[half_edge as usize / 3][half_edge as usize % 3]
    }

    /// The vertex where a half-edge ends.
    #[inline]
    pub fn target(&self, half_edge: u32) -> u32 {
        self.origin(self.next(half_edge))
    }

    /// The vertex opposite to a half-edge in its triangle.
    #[inline]
    pub fn apex(&self, half_edge: u32) -> u32 {
        self.origin(self.prev(half_edge))
    }

    /// The next half-edge around the triangle.
    #[inline]
    pub fn next(&self, half_edge: u32) -> u32 {
        if half_edge % 3 == 2 { half_edge - 2 } else { half_edge + 1 }
    }

    /// The previous half-edge around the triangle.
    #[inline]
    pub fn prev(&self, half_edge: u32) -> u32 {
        if half_edge.is_multiple_of(3) { half_edge + 2 } else { half_edge - 1 }
    }

    /// The half-edge that runs the other way, in the neighbouring triangle.
    #[inline]
    pub fn twin(&self, half_edge: u32) -> u32 {
        self.twin[half_edge as usize]
    }

    /// Number of edges at a vertex; 0 for removed vertices.
    #[inline]
    pub fn valence(&self, vertex: u32) -> usize {
        self.valence[vertex as usize] as usize
    }

    /// The half-edges that start at `vertex`, counter-clockwise seen from outside. Their targets are the one-ring and their
    /// triangles the fan, both in order.
    #[inline]
    pub fn ring(&self, vertex: u32) -> Ring<'_> {
        let first = self.outgoing[vertex as usize];
        Ring { mesh: self, first, next: first }
    }

    /// The half-edge from `from` to `to`, if there is one.
    pub fn find(&self, from: u32, to: u32) -> Option<u32> {
        // Hubs of flat faces have thousands of edges, their neighbours a few.
        if self.valence(from) <= self.valence(to) {
            self.ring(from).find(|&h| self.target(h) == to)
        } else {
            self.ring(to).find(|&h| self.target(h) == from).map(|h| self.twin(h))
        }
    }

    /// One half-edge of each edge, by id.
    pub fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.twin.len() as u32).filter(|&h| self.twin(h) != NONE && h < self.twin(h))
    }

    /// Whether collapsing this edge leaves a closed manifold of the same genus without vertices of fewer than three edges: the
    /// link condition. False for removed half-edges.
    pub fn can_collapse(&self, half_edge: u32) -> bool {
        if !self.is_live(half_edge) {
            return false;
        }
        let (u, v) = (self.origin(half_edge), self.target(half_edge));
        let (c, d) = (self.apex(half_edge), self.apex(self.twin(half_edge)));
        if c == d || self.valence(c) < 4 || self.valence(d) < 4 || self.valence(u) + self.valence(v) < 7 {
            return false;
        }
        let (few, many) = if self.valence(u) <= self.valence(v) { (u, v) } else { (v, u) };
        self.ring(few).map(|h| self.target(h)).all(|w| w == many || w == c || w == d || self.find(w, many).is_none())
    }

    /// Collapses an edge for which [`HalfEdges::can_collapse`] holds: its origin and its two triangles are removed, its
    /// target stays, inherits the origin's other triangles, and is returned. Does nothing but return the target when the
    /// collapse is not possible.
    pub fn collapse(&mut self, half_edge: u32) -> u32 {
        let kept = self.target(half_edge);
        if self.can_collapse(half_edge) { self.collapse_unchecked(half_edge) } else { kept }
    }

    /// [`HalfEdges::collapse`] for an edge whose link condition the caller has just checked. Leaves
    /// a mesh that is no manifold when it does not hold.
    pub fn collapse_unchecked(&mut self, half_edge: u32) -> u32 {
        let (h, o) = (half_edge, self.twin(half_edge));
        let (removed, kept) = (self.origin(h), self.target(h));
        let (c, d) = (self.apex(h), self.apex(o));
        let (next, prev) = (self.twin(self.next(h)), self.twin(self.prev(h)));
        let (other_next, other_prev) = (self.twin(self.next(o)), self.twin(self.prev(o)));

        let mut at = prev;
        // From the twin of c→u around u, the last triangle before the removed ones holds d.
        while at / 3 != o / 3 {
            self.triangles[at as usize / 3][at as usize % 3] = kept;
            at = self.twin(self.prev(at));
        }
        self.valence[kept as usize] = self.valence[kept as usize] + self.valence[removed as usize] - 4;
        self.valence[removed as usize] = 0;
        self.valence[c as usize] -= 1;
        self.valence[d as usize] -= 1;
        self.join(next, prev);
        self.join(other_next, other_prev);
        self.remove(h / 3);
        self.remove(o / 3);
        self.outgoing[removed as usize] = NONE;
        self.outgoing[kept as usize] = prev;
        self.outgoing[c as usize] = next;
        self.outgoing[d as usize] = other_next;
        kept
    }

    /// What [`HalfEdges::undo`] needs to take the collapse of this edge back, to be asked for before.
    pub fn record(&self, half_edge: u32) -> CollapseRecord {
        let (h, o) = (half_edge, self.twin(half_edge));
        CollapseRecord {
            half_edge,
            other: o,
            removed: [self.triangle(h / 3), self.triangle(o / 3)],
            inner: [self.twin(self.prev(h)), self.twin(self.next(o))],
            star: self.ring(self.origin(h)).map(|e| e / 3).filter(|t| ![h / 3, o / 3].contains(t)).collect(),
        }
    }

    /// Takes a collapse back. Since then nothing else may have changed the triangles that were around the removed vertex; those
    /// beside them may be others.
    pub fn undo(&mut self, record: &CollapseRecord) {
        let CollapseRecord { half_edge: h, other: o, removed, inner: [prev, other_next], ref star } = *record;
        let (next, other_prev) = (self.twin(prev), self.twin(other_next));
        self.triangles[h as usize / 3] = removed[0];
        self.triangles[o as usize / 3] = removed[1];
        let (vertex, kept) = (self.origin(h), self.target(h));
        for &t in star {
            self.triangles[t as usize].iter_mut().filter(|v| **v == kept).for_each(|v| *v = vertex);
        }
        self.join(h, o);
        self.join(self.next(h), next);
        self.join(self.prev(h), prev);
        self.join(self.next(o), other_next);
        self.join(self.prev(o), other_prev);
        self.outgoing[vertex as usize] = h;
        self.outgoing[kept as usize] = o;
        let (c, d) = (self.apex(h), self.apex(o));
        self.valence[vertex as usize] = star.len() as u32 + 2;
        self.valence[kept as usize] = self.valence[kept as usize] + 4 - self.valence[vertex as usize];
        self.valence[c as usize] += 1;
        self.valence[d as usize] += 1;
        self.live_triangles += 2;
    }

    /// Whether the edge can be turned in the quadrilateral of its two triangles: the new edge does not exist yet and
    /// both ends keep at least three edges. False for removed half-edges.
    pub fn can_flip(&self, half_edge: u32) -> bool {
        if !self.is_live(half_edge) {
            return false;
        }
        let (u, v) = (self.origin(half_edge), self.target(half_edge));
        let (c, d) = (self.apex(half_edge), self.apex(self.twin(half_edge)));
        c != d && self.valence(u) > 3 && self.valence(v) > 3 && self.find(c, d).is_none()
    }

    /// Turns an edge for which [`HalfEdges::can_flip`] holds: from origin-target to the line between its two apexes. The half-edge
    /// keeps its id and runs from the apex of its twin's triangle to that of its own; the edges around keep theirs only
    /// up to triangle. Returns whether the flip was possible; nothing happens otherwise.
    pub fn flip(&mut self, half_edge: u32) -> bool {
        if !self.can_flip(half_edge) {
            return false;
        }
        let (h, o) = (half_edge, self.twin(half_edge));
        let (u, v) = (self.origin(h), self.target(h));
        let (c, d) = (self.apex(h), self.apex(o));
        // The outer half-edges' twins: v→c, c→u, u→d, d→v.
        let [vc, cu, ud, dv] = [self.next(h), self.prev(h), self.next(o), self.prev(o)].map(|inner| self.twin(inner));
        // h: d→c, then c→u, u→d; o: c→d, then d→v, v→c.
        self.set_corners(h, [d, c, u]);
        self.set_corners(o, [c, d, v]);
        self.join(self.next(h), cu);
        self.join(self.prev(h), ud);
        self.join(self.next(o), dv);
        self.join(self.prev(o), vc);
        self.outgoing[u as usize] = self.prev(h);
        self.outgoing[v as usize] = self.prev(o);
        self.outgoing[d as usize] = h;
        self.outgoing[c as usize] = o;
        self.valence[u as usize] -= 1;
        self.valence[v as usize] -= 1;
        self.valence[c as usize] += 1;
        self.valence[d as usize] += 1;
        true
    }

    /// Puts a new vertex on a live edge, joined to both apexes, and returns its id: the next one, [`HalfEdges::vertex_ids`] before
    /// the call. The half-edge keeps its id and its origin and ends at the new vertex. Two triangles are added
    /// after the existing ones.
    pub fn split(&mut self, half_edge: u32) -> u32 {
        let (h, o) = (half_edge, self.twin(half_edge));
        let (u, v) = (self.origin(h), self.target(h));
        let (c, d) = (self.apex(h), self.apex(o));
        let (vc, dv) = (self.twin(self.next(h)), self.twin(self.prev(o)));
        let new = self.outgoing.len() as u32;
        let first = 3 * self.triangles.len() as u32;
        self.triangles.extend([[new, v, c], [v, new, d]]);
        self.twin.extend([NONE; 6]);
        self.outgoing.push(first);
        self.valence.push(4);
        self.live_triangles += 2;
        // h: u→new, new→c, c→u; o: new→u, u→d, d→new; first: new→v, v→c, c→new; first+3: v→new, new→d, d→v.
        self.set_corners(h, [u, new, c]);
        self.set_corners(o, [new, u, d]);
        self.join(first, first + 3);
        self.join(first + 1, vc);
        self.join(first + 2, self.next(h));
        self.join(first + 4, self.prev(o));
        self.join(first + 5, dv);
        self.outgoing[v as usize] = first + 3;
        self.outgoing[d as usize] = first + 5;
        self.valence[c as usize] += 1;
        self.valence[d as usize] += 1;
        new
    }

    /// The live triangles, in order, over the vertex ids as they are.
    pub fn to_triangles(&self) -> Vec<[u32; 3]> {
        self.triangles.iter().copied().filter(|t| t[0] != NONE).collect()
    }

    /// The live triangles over the live vertices, renumbered in order.
    pub fn compacted(&self) -> Compacted {
        let vertices: Vec<u32> = (0..self.outgoing.len() as u32).filter(|&v| self.is_live_vertex(v)).collect();
        let mut new_ids = vec![NONE; self.outgoing.len()];
        for (new, &old) in (0..).zip(&vertices) {
            new_ids[old as usize] = new;
        }
        let triangles = self.to_triangles().iter().map(|t| t.map(|v| new_ids[v as usize])).collect();
        Compacted { triangles, vertices }
    }

    fn join(&mut self, a: u32, b: u32) {
        self.twin[a as usize] = b;
        self.twin[b as usize] = a;
    }

    fn remove(&mut self, triangle: u32) {
        self.triangles[triangle as usize] = [NONE; 3];
        self.twin[3 * triangle as usize..][..3].fill(NONE);
        self.live_triangles -= 1;
    }

    /// Sets the corners of a half-edge's triangle, from its origin on.
    fn set_corners(&mut self, half_edge: u32, corners: [u32; 3]) {
        let k = half_edge as usize % 3;
        for (i, corner) in corners.into_iter().enumerate() {
            self.triangles[half_edge as usize / 3][(k + i) % 3] = corner;
        }
    }
}

/// The half-edges around a vertex, one after another: what [`HalfEdges::ring`] gives.
#[derive(Debug, Clone)]
pub struct Ring<'a> {
    mesh: &'a HalfEdges,
    first: u32,
    next: u32,
}

impl Iterator for Ring<'_> {
    type Item = u32;

    #[inline]
    fn next(&mut self) -> Option<u32> {
        if self.next == NONE {
            return None;
        }
        let at = self.next;
        let after = self.mesh.twin(self.mesh.prev(at));
        self.next = if after == self.first { NONE } else { after };
        Some(at)
    }
}
