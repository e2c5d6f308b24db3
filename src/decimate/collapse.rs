//! Edges are collapsed, the cheapest first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;

use super::bound::moved;
use super::guard::{Guard, Zone};
use super::work::{Way, Work};
use crate::progress::{Progress, Stopped};

/// A deviation of less than this part of the bound does not count.
const NOTHING: f64 = 0.005;

/// Vertices of more edges than this take no more.
const MOST_EDGES: usize = 96;

/// Times all edges are tried anew after none was left.
const MOST_ROUNDS: usize = 16;

/// Edges between two looks at the clock.
const GLANCE: usize = 256;

/// Edges whose cost is found at once.
const BATCH: usize = 1 << 18;

/// Where it ends.
pub(super) struct Limits {
    /// No more triangles than this are wanted.
    pub(super) triangles: usize,
    /// How far the surface may move; in the units of [`Work::at`].
    pub(super) deviation: Option<f64>,
    /// The scale, where coordinates are to be `f32`.
    pub(super) single: Option<f64>,
}

/// An edge in the queue, by the smaller of its half-edges.
#[derive(Debug, Clone, Copy)]
struct Entry {
    cost: f64,
    edge: u32,
    /// The number of this entry among those of the edge; older ones are void.
    number: u32,
    /// Which of the ways of the edge it stands for.
    way: u8,
}

impl Ord for Entry {
    /// The cheapest is the greatest; of equal ones that of the smaller number.
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |entry: &Self| (entry.edge, entry.number, entry.way);
        other.cost.total_cmp(&self.cost).then_with(|| key(other).cmp(&key(self)))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

/// The queue of edges.
struct Queue<'a> {
    limits: &'a Limits,
    heap: BinaryHeap<Entry>,
    /// By half-edge: how many entries the edge has had, and when its last one was made.
    numbers: Vec<u32>,
    made: Vec<u32>,
    /// By vertex: when a triangle around it has changed for the last time.
    changed: Vec<u32>,
    /// Collapses so far.
    clock: u32,
}

impl Queue<'_> {
    fn ways(&self, work: &Work, edge: u32) -> [Way; 3] {
        work.ways(edge, self.limits.deviation.is_none(), self.limits.single)
    }

    /// Puts all edges into it.
    fn fill(&mut self, work: &Work, progress: &Progress) -> Result<(), Stopped> {
        let edges: Vec<u32> = work.edges.edges().collect();
        let mut entries = Vec::with_capacity(edges.len());
        for some in edges.chunks(BATCH) {
            progress.check()?;
            let this = &*self;
            entries.par_extend(some.par_iter().with_min_len(64).map(|&edge| {
                let [best, ..] = this.ways(work, edge);
                Entry { cost: best.cost, edge, number: this.numbers[edge as usize] + 1, way: 0 }
            }));
        }
        for entry in &entries {
            self.numbers[entry.edge as usize] = entry.number;
            self.made[entry.edge as usize] = self.clock;
        }
        self.heap = BinaryHeap::from(entries);
        Ok(())
    }

    fn push(&mut self, work: &Work, half_edge: u32) {
        let edge = half_edge.min(work.edges.twin(half_edge));
        let [best, ..] = self.ways(work, edge);
        self.numbers[edge as usize] += 1;
        self.made[edge as usize] = self.clock;
        self.heap.push(Entry { cost: best.cost, edge, number: self.numbers[edge as usize], way: 0 });
    }

    /// The cheapest edge whose cost is that of the surface as it is, and the way to collapse it.
    fn pop(&mut self, work: &Work) -> Option<(Entry, [Way; 3])> {
        loop {
            let entry = self.heap.pop()?;
            let edge = entry.edge;
            if !work.edges.is_live(edge) || self.numbers[edge as usize] != entry.number {
                continue;
            }
            let changed = |vertex: u32| self.changed[vertex as usize];
            let (from, to) = (work.edges.origin(edge), work.edges.target(edge));
            if changed(from).max(changed(to)) > self.made[edge as usize] {
                self.push(work, edge);
                continue;
            }
            return Some((entry, self.ways(work, edge)));
        }
    }
}

/// Collapses edges until a limit is reached or nothing is left to collapse.
pub(super) fn run(work: &mut Work, zone: &Zone, limits: &Limits, progress: &Progress) -> Result<(), Stopped> {
    let (halves, vertices) = (3 * work.edges.triangle_ids(), work.edges.vertex_ids());
    let mut queue = Queue {
        limits,
        heap: BinaryHeap::new(),
        numbers: vec![0; halves],
        made: vec![0; halves],
        changed: vec![0; vertices],
        clock: 0,
    };
    let mut off = limits.deviation.map(|_| vec![0f32; work.edges.triangle_ids()]);
    let mut guard = Guard::new(zone, work);
    let first = work.edges.live_triangles();
    for _ in 0..MOST_ROUNDS {
        let before = work.edges.live_triangles();
        queue.fill(work, progress)?;
        let mut tries = 0usize;
        while work.edges.live_triangles() > limits.triangles {
            if tries.is_multiple_of(GLANCE) {
                progress.check()?;
                progress.share((first - work.edges.live_triangles()) as f32 / (first - limits.triangles) as f32);
            }
            tries += 1;
            let Some((entry, ways)) = queue.pop(work) else { break };
            let way = &ways[usize::from(entry.way)];
            if allowed(work, way, &guard) && moves_little(work, way, limits, off.as_deref_mut()) {
                done(work, way, &mut queue, &mut guard);
            } else if let Some(next) = ways.get(usize::from(entry.way) + 1).filter(|way| way.cost.is_finite()) {
                queue.heap.push(Entry { cost: next.cost, way: entry.way + 1, ..entry });
            }
        }
        let now = work.edges.live_triangles();
        if now <= limits.triangles || now == before {
            break;
        }
    }
    Ok(())
}

fn allowed(work: &Work, way: &Way, guard: &Guard<'_>) -> bool {
    let [u, v] = [work.edges.origin(way.half_edge), work.edges.target(way.half_edge)].map(|v| work.edges.valence(v));
    (u + v < MOST_EDGES + 4) && work.fits(way) && !guard.forbids(work, way)
}

/// Whether a collapse keeps the surface within the bound of where it was; if so, how far it is then is noted.
fn moves_little(work: &Work, way: &Way, limits: &Limits, off: Option<&mut [f32]>) -> bool {
    let (Some(most), Some(off)) = (limits.deviation, off) else { return true };
    let Some(after) = moved((&work.edges, &work.at, off), way.half_edge, (NOTHING * most, most)) else { return false };
    let mut e = way.half_edge;
    for distance in after {
        e = work.edges.twin(work.edges.prev(e));
        off[e as usize / 3] = distance;
    }
    true
}

fn done(work: &mut Work, way: &Way, queue: &mut Queue<'_>, guard: &mut Guard<'_>) {
    let vertex = work.collapse(way);
    queue.clock += 1;
    queue.changed[vertex as usize] = queue.clock;
    let ring: Vec<u32> = work.edges.ring(vertex).collect();
    for &h in &ring {
        queue.changed[work.edges.target(h) as usize] = queue.clock;
        if guard.is_on() {
            guard.add(work, h / 3);
        }
    }
    for h in ring {
        queue.push(work, h);
    }
}
