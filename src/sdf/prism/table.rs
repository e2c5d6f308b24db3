//! Which frusta a slice meets, and where: the paper's active prism table, and its active-edge tables unrolled.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::frustum::{EDGES, Frustum};

/// Most corners of a section.
pub const MOST_CORNERS: usize = 8;

/// A frustum between two heights of its corners: which of its edges slices cross there, in order around the section. The edge
/// table of a frustum changes only where a slice passes a corner, so these are all its states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Section {
    /// The frustum.
    pub frustum: u32,
    /// The numbers of the edges that are crossed, in [`EDGES`]; the last is repeated.
    pub edges: [u8; MOST_CORNERS],
    /// The first and the last slice.
    slices: [i32; 2],
}

/// All sections, by their first slice.
#[derive(Debug, Default)]
pub struct Table {
    sections: Vec<Section>,
    /// The sections that begin at or after a slice begin here.
    starts: Vec<usize>,
}

impl Table {
    /// The sections of `frusta` by slices 0 to `count` − 1.
    pub fn new(frusta: &[Frustum], count: i32) -> Self {
        let of = |(n, frustum): (usize, &Frustum)| sections(n as u32, frustum, count);
        let mut sections: Vec<Section> = frusta.par_iter().enumerate().flat_map_iter(of).collect();
        sections.sort_by_key(|section| section.slices[0]);
        let starts = (0..=count).map(|z| sections.partition_point(|s| s.slices[0] < z)).collect();
        Self { sections, starts }
    }

    /// The sections.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// The numbers of the sections that each slice meets, slice after slice.
    pub fn sweep(&self) -> impl Iterator<Item = Vec<u32>> + '_ {
        let mut active: Vec<u32> = Vec::new();
        (0i32..).zip(self.starts.windows(2)).map(move |(z, starts)| {
            active.retain(|&n| self.sections[n as usize].slices[1] >= z);
            active.extend(starts[0] as u32..starts[1] as u32);
            active.clone()
        })
    }
}

fn sections(number: u32, frustum: &Frustum, count: i32) -> Vec<Section> {
    let mut heights = frustum.corners.map(|corner| corner.z);
    heights.sort_unstable_by(f64::total_cmp);
    let pieces = heights.windows(2).filter_map(|ends| {
        let first = (ends[0].ceil() as i32).max(0);
        // A slice through corners belongs to the piece above them, and at the very top to the last one.
        let last = if ends[1] == heights[11] { ends[1].floor() } else { ends[1].ceil() - 1.0 };
        let last = (last as i32).min(count - 1);
        (first <= last).then(|| (f64::midpoint(ends[0], ends[1]), [first, last]))
    });
    pieces
        .filter_map(|(middle, slices)| Some(Section { frustum: number, edges: crossed(frustum, middle)?, slices }))
        .collect()
}

/// The edges that the slice at `z` crosses, around the section.
fn crossed(frustum: &Frustum, z: f64) -> Option<[u8; MOST_CORNERS]> {
    let mut found: Vec<(DVec2, u8)> = Vec::with_capacity(MOST_CORNERS);
    for (n, edge) in (0u8..).zip(EDGES) {
        let [a, b] = edge.map(|k| frustum.corners[usize::from(k)]);
        if (a.z < z) != (b.z < z) {
            found.push((at(a, b, z), n));
        }
    }
    let middle = found.iter().map(|(p, _)| *p).sum::<DVec2>() / found.len() as f64;
    found.sort_by(|a, b| (a.0 - middle).to_angle().total_cmp(&(b.0 - middle).to_angle()));
    let last = found.len().checked_sub(1)?;
    (last < MOST_CORNERS).then(|| std::array::from_fn(|k| found[k.min(last)].1))
}

fn at(a: DVec3, b: DVec3, z: f64) -> DVec2 {
    a.truncate().lerp(b.truncate(), (z - a.z) / (b.z - a.z))
}

impl Section {
    /// The corners of the section at slice `z`, lattice coordinates.
    pub(super) fn corners(&self, frustum: &Frustum, z: i32) -> [DVec2; MOST_CORNERS] {
        self.edges.map(|n| {
            let [a, b] = EDGES[usize::from(n)].map(|k| frustum.corners[usize::from(k)]);
            at(a, b, f64::from(z).clamp(a.z.min(b.z), a.z.max(b.z)))
        })
    }
}
