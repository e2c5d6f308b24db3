//! Collapses that would make triangles meet, found before they are done, where that has happened once.

use glam::{DVec3, IVec3};
use rustc_hash::{FxHashMap, FxHashSet};

use super::work::{Way, Work};
use crate::mesh::{Bounds, TriMesh, intersecting_triangles, self_intersections, triangles_intersect};
use crate::progress::{Progress, Stopped};

/// A box of more cells than this is not looked at cell by cell.
const MOST_CELLS: i64 = 512;

/// Part of space, in cells; in the units of [`Work::at`].
pub(super) struct Zone {
    size: f64,
    /// `None`: all of it.
    cells: Option<FxHashSet<IVec3>>,
}

impl Zone {
    /// No space at all.
    pub(super) fn nothing(size: f64) -> Self {
        Self { size, cells: Some(FxHashSet::default()) }
    }

    /// All space.
    pub(super) fn everything(size: f64) -> Self {
        Self { size, cells: None }
    }

    pub(super) fn is_everything(&self) -> bool {
        self.cells.is_none()
    }

    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Adds what is around the places where triangles of `mesh`, in model units, meet.
    pub(super) fn add_meetings(&mut self, mesh: &TriMesh, scale: f64, progress: &Progress) -> Result<(), Stopped> {
        let bad = intersecting_triangles(mesh, progress)?;
        let part = TriMesh {
            positions: mesh.positions.iter().map(|&p| p * scale).collect(),
            triangles: bad.iter().map(|&t| mesh.triangles[t as usize]).collect(),
        };
        for pair in self_intersections(&part, progress)? {
            let [a, b] = pair.map(|t| bounds(part.corners(t as usize)));
            let common = Bounds { min: a.min.max(b.min) - self.size, max: a.max.min(b.max) + self.size };
            match (cells(&common, self.size), &mut self.cells) {
                (Some(more), Some(cells)) => cells.extend(more),
                _ => self.cells = None,
            }
        }
        Ok(())
    }
}

fn bounds(corners: [DVec3; 3]) -> Bounds {
    let [a, b, c] = corners;
    Bounds { min: a.min(b).min(c), max: a.max(b).max(c) }
}

/// The cells of a box, unless they are too many.
fn cells(bounds: &Bounds, size: f64) -> Option<impl Iterator<Item = IVec3> + use<>> {
    let (low, high) = ((bounds.min / size).floor().as_ivec3(), (bounds.max / size).floor().as_ivec3());
    let counts = (high - low + 1).as_i64vec3();
    let along = move |axis: usize| low[axis]..=high[axis];
    let plane = move |z: i32| along(1).flat_map(move |y| along(0).map(move |x| IVec3::new(x, y, z)));
    (counts.x * counts.y * counts.z <= MOST_CELLS).then(|| along(2).flat_map(plane))
}

/// The triangles of a surface by the cells of a zone that they reach into. Lists may name triangles that have gone or moved away.
pub(super) struct Guard<'a> {
    zone: &'a Zone,
    lists: FxHashMap<IVec3, Vec<u32>>,
    /// Triangles over very many cells.
    large: Vec<u32>,
}

impl<'a> Guard<'a> {
    pub(super) fn new(zone: &'a Zone, work: &Work) -> Self {
        let mut guard = Self { zone, lists: FxHashMap::default(), large: Vec::new() };
        if guard.is_on() {
            (0..work.edges.triangle_ids() as u32)
                .filter(|&t| work.edges.is_live_triangle(t))
                .for_each(|t| guard.add(work, t));
        }
        guard
    }

    /// Whether there is anything to look at.
    pub(super) fn is_on(&self) -> bool {
        self.zone.cells.as_ref().is_none_or(|cells| !cells.is_empty())
    }

    fn watches(&self, cell: &IVec3) -> bool {
        self.zone.cells.as_ref().is_none_or(|cells| cells.contains(cell))
    }

    /// Notes where a triangle is that is new or has changed.
    pub(super) fn add(&mut self, work: &Work, t: u32) {
        match cells(&bounds(work.corners(t)), self.zone.size) {
            None if self.large.last() != Some(&t) => self.large.push(t),
            None => {}
            Some(cells) => {
                for cell in cells {
                    if self.watches(&cell) {
                        let list = self.lists.entry(cell).or_default();
                        if list.last() != Some(&t) {
                            list.push(t);
                        }
                    }
                }
            }
        }
    }

    /// Whether triangles would meet, or vertices be at one place, after a collapse.
    pub(super) fn forbids(&self, work: &Work, way: &Way) -> bool {
        if !self.is_on() {
            return false;
        }
        let mut star: Vec<u32> = Vec::with_capacity(16);
        let mut made: Vec<[DVec3; 3]> = Vec::with_capacity(16);
        work.star(way.half_edge, |h, gone| {
            star.push(h / 3);
            if !gone {
                made.push([way.place, work.place(work.edges.target(h)), work.place(work.edges.apex(h))]);
            }
        });
        let meets_own = (0..made.len()).any(|i| (0..i).any(|j| triangles_intersect(&made[i], &made[j])));
        meets_own || made.iter().any(|corners| self.meets(work, corners, way.place, &star))
    }

    /// Whether a triangle meets one that is not of the star.
    fn meets(&self, work: &Work, corners: &[DVec3; 3], place: DVec3, star: &[u32]) -> bool {
        let own = bounds(*corners);
        let meets = |&t: &u32| {
            if !work.edges.is_live_triangle(t) || star.contains(&t) {
                return false;
            }
            let other = work.corners(t);
            let its = bounds(other);
            let apart = own.min.cmpgt(its.max).any() || its.min.cmpgt(own.max).any();
            !apart && (other.contains(&place) || triangles_intersect(corners, &other))
        };
        if self.large.iter().any(meets) {
            return true;
        }
        match cells(&own, self.zone.size) {
            Some(mut cells) => cells.any(|cell| self.lists.get(&cell).is_some_and(|list| list.iter().any(meets))),
            None => self.lists.values().any(|list| list.iter().any(meets)),
        }
    }
}
