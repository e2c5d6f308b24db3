//! Cracks closed by moving vertices a little: open edges that lie along each other become one.
//!
//! Files that were tessellated face by face have seams whose sides do not agree: by the rounding of numbers, or because one side has a vertex where the other has none (a T-junction).
//! [`zip()`] puts such vertices on the edges that they lie beside, and merges the ends of edges that run along each other. Nothing moves farther than the tolerance, and only vertices at open
//! edges move.

mod grid;

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use serde::{Deserialize, Serialize};

use self::grid::Grid;
use crate::mesh::edges::Edges;
use crate::mesh::weld::has_repeated_index;
use crate::mesh::{Bounds, TriMesh};
use crate::progress::{Progress, Stopped};

/// The tolerance that is used where none is given, as a share of the diagonal of the mesh: text with six digits, and single precision some way from the origin, are rounded by less.
pub const USUAL: f64 = 1e-5;

/// So many steps and neighbours are looked at for each open edge, on average. Where there are more within the tolerance, sheets lie on each other there, or the tolerance is far
/// larger than the triangles: these are no cracks, and to look at all pairs would take for ever.
const BUDGET: usize = 100;

/// A mesh whose cracks are closed.
#[derive(Debug, Clone)]
pub struct Zipped {
    /// Vertices with equal coordinates are merged.
    pub mesh: TriMesh,
    /// For each of its triangles the number of the given one that it is, or is a piece of. Pieces follow each other.
    pub sources: Vec<u32>,
    /// What was done.
    pub report: ZipReport,
}

/// What was done to close cracks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ZipReport {
    /// Open edges before.
    pub open_before: usize,
    /// Open edges that are left.
    pub open_after: usize,
    /// Vertices that were put on an edge of another triangle, which was divided there.
    pub inserted: usize,
    /// Vertices that were merged with others.
    pub merged: usize,
    /// How far the farthest of them moved, model units.
    pub farthest: f64,
}

impl ZipReport {
    /// Both together.
    pub fn with(self, other: Self) -> Self {
        Self {
            open_before: self.open_before + other.open_before,
            open_after: self.open_after + other.open_after,
            inserted: self.inserted + other.inserted,
            merged: self.merged + other.merged,
            farthest: self.farthest.max(other.farthest),
        }
    }
}

/// The mesh with its cracks closed; `None` where that closes none. `tolerance`: how far a vertex may move, model units; `None`: a [share](USUAL) of the diagonal.
///
/// # Errors
/// [`Stopped`].
pub fn zip(mesh: &TriMesh, tolerance: Option<f64>, progress: &Progress) -> Result<Option<Zipped>, Stopped> {
    let diagonal = mesh.bounds().as_ref().map_or(0.0, Bounds::diagonal);
    let tolerance = tolerance.unwrap_or(USUAL * diagonal);
    let mut work = Work { mesh: mesh.welded(), sources: (0..mesh.triangles.len() as u32).collect() };
    let open = work.open();
    if open.is_empty() || tolerance <= 0.0 || !tolerance.is_finite() {
        return Ok(None);
    }
    let mut report = ZipReport { open_before: open.len(), ..ZipReport::default() };
    progress.check()?;
    let Some(inserted) = work.insert(&open, tolerance) else { return Ok(None) };
    progress.check()?;
    let open = if inserted > 0 { work.open() } else { open };
    let Some((merged, farthest)) = work.merge(&open, tolerance) else { return Ok(None) };
    (report.inserted, report.merged, report.farthest) = (inserted, merged, farthest);
    report.open_after = work.open().len();
    Ok((report.open_after < report.open_before).then_some(Zipped { mesh: work.mesh, sources: work.sources, report }))
}

/// An open edge: the triangle that it is of, and its ends.
#[derive(Debug, Clone, Copy)]
struct Open {
    triangle: u32,
    ends: [u32; 2],
}

/// An edge of a triangle, and the vertices that are put on it, in order.
struct Division {
    ends: [u32; 2],
    on: Vec<u32>,
}

/// Two open edges that may become one.
struct Pair {
    /// How far the farthest of their ends is from its place on the other.
    apart: f64,
    edges: [u32; 2],
    /// The ends that become one.
    ends: [[u32; 2]; 2],
}

struct Work {
    mesh: TriMesh,
    sources: Vec<u32>,
}

impl Work {
    /// The edges of one triangle alone.
    fn open(&self) -> Vec<Open> {
        let mut open = Vec::new();
        Edges::new(&self.mesh.triangles, self.mesh.positions.len()).each(|edge| {
            if let (1, Some(half)) = (edge.count(), edge.halves().next()) {
                let corners = self.mesh.triangles[half as usize / 3];
                let k = half as usize % 3;
                open.push(Open { triangle: half / 3, ends: [corners[k], corners[(k + 1) % 3]] });
            }
        });
        open
    }

    fn at(&self, v: u32) -> DVec3 {
        self.mesh.positions[v as usize]
    }

    /// Puts vertices at open edges on the open edges of other triangles that they lie beside, where an open edge runs along there. Returns how many; `None` beyond the
    /// [budget](BUDGET).
    fn insert(&mut self, open: &[Open], tolerance: f64) -> Option<usize> {
        let mut ends: Vec<u32> = open.iter().flat_map(|edge| edge.ends).collect();
        ends.sort_unstable();
        ends.dedup();
        let mut beside: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        for edge in open {
            let [a, b] = edge.ends;
            beside.entry(a).or_default().push(b);
            beside.entry(b).or_default().push(a);
        }
        let mean = open.iter().map(|edge| self.at(edge.ends[0]).distance(self.at(edge.ends[1]))).sum::<f64>()
            / open.len() as f64;
        let grid = Grid::new(ends.iter().map(|&v| (self.at(v), v)), mean.max(4.0 * tolerance));
        let mut inserted = 0;
        let mut cuts: FxHashMap<u32, Vec<Division>> = FxHashMap::default();
        let mut budget = BUDGET * open.len();
        for edge in open {
            let on = self.along(edge, &grid, &beside, (tolerance, &mut budget))?;
            if !on.is_empty() {
                inserted += on.len();
                cuts.entry(edge.triangle).or_default().push(Division { ends: edge.ends, on });
            }
        }
        if inserted > 0 {
            self.divide(&cuts);
        }
        Some(inserted)
    }

    /// The vertices that lie beside an open edge, in order along it.
    fn along(
        &self,
        edge: &Open,
        grid: &Grid,
        beside: &FxHashMap<u32, Vec<u32>>,
        (tolerance, budget): (f64, &mut usize),
    ) -> Option<Vec<u32>> {
        let [a, b] = edge.ends.map(|v| self.at(v));
        let way = b - a;
        let squared = way.length_squared();
        let corners = self.mesh.triangles[edge.triangle as usize];
        let near = |p: DVec3| {
            let t = ((p - a).dot(way) / squared).clamp(0.0, 1.0);
            (p.distance(a + way * t) <= tolerance).then_some(t)
        };
        let mut on: Vec<(f64, u32)> = Vec::new();
        grid.each_along([a, b], tolerance, budget, |v| {
            let p = self.at(v);
            if corners.contains(&v) || p.distance(a) <= tolerance || p.distance(b) <= tolerance {
                return;
            }
            let Some(t) = near(p) else { return };
            // An open edge of another triangle runs along here.
            let runs = beside.get(&v).is_some_and(|list| {
                list.iter()
                    .any(|&w| near(self.at(w)).is_some_and(|other| (other - t).abs() * squared.sqrt() > tolerance))
            });
            if runs {
                on.push((t, v));
            }
        })?;
        on.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        on.dedup();
        // Two within the tolerance of each other are merged later; only one may stand on the edge.
        on.dedup_by(|later, earlier| self.at(later.1).distance(self.at(earlier.1)) <= tolerance);
        Some(on.into_iter().map(|(_, v)| v).collect())
    }

    /// Divides triangles at the vertices along their edges.
    fn divide(&mut self, cuts: &FxHashMap<u32, Vec<Division>>) {
        let (mut triangles, mut sources) = (Vec::new(), Vec::new());
        for (t, &corners) in (0u32..).zip(&self.mesh.triangles) {
            let mut pieces = vec![corners];
            for Division { ends: [a, b], on } in cuts.get(&t).into_iter().flatten() {
                let has = |piece: &[u32; 3]| (0..3).find(|&k| piece[k] == *a && piece[(k + 1) % 3] == *b);
                let Some((at, k)) = pieces.iter().enumerate().find_map(|(n, piece)| Some((n, has(piece)?))) else {
                    continue;
                };
                let piece = pieces.swap_remove(at);
                let apex = piece[(k + 2) % 3];
                let chain: Vec<u32> = std::iter::once(*a).chain(on.iter().copied()).chain([*b]).collect();
                pieces.extend(chain.windows(2).map(|pair| [pair[0], pair[1], apex]));
            }
            sources.extend(std::iter::repeat_n(self.sources[t as usize], pieces.len()));
            triangles.append(&mut pieces);
        }
        (self.mesh.triangles, self.sources) = (triangles, sources);
    }

    /// Merges the ends of open edges that run along each other. Returns how many vertices moved, and how far the farthest; `None` beyond the [budget](BUDGET).
    fn merge(&mut self, open: &[Open], tolerance: f64) -> Option<(usize, f64)> {
        let middle = |edge: &Open| (self.at(edge.ends[0]) + self.at(edge.ends[1])) / 2.0;
        let grid = Grid::new((0u32..).zip(open).map(|(n, edge)| (middle(edge), n)), 2.0 * tolerance);
        let mut pairs: Vec<Pair> = Vec::new();
        let mut budget = BUDGET * open.len();
        for (n, edge) in (0u32..).zip(open) {
            let at = middle(edge);
            grid.each_along([at, at], tolerance, &mut budget, |m| {
                let other = &open[m as usize];
                if m <= n || other.triangle == edge.triangle {
                    return;
                }
                let [a, b] = edge.ends;
                let [c, d] = other.ends;
                let apart = |pairs: [[u32; 2]; 2]| {
                    pairs.iter().map(|[v, w]| self.at(*v).distance(self.at(*w))).fold(0.0, f64::max)
                };
                let (turned, same) = ([[a, d], [b, c]], [[a, c], [b, d]]);
                let best = if apart(turned) <= apart(same) { turned } else { same };
                if apart(best) <= tolerance {
                    pairs.push(Pair { apart: apart(best), edges: [n, m], ends: best });
                }
            })?;
        }
        pairs.sort_by(|x, y| x.apart.total_cmp(&y.apart).then(x.edges.cmp(&y.edges)));
        let mut paired = FxHashSet::default();
        let mut groups = Groups::default();
        for Pair { edges, ends, .. } in pairs {
            if edges.iter().any(|n| paired.contains(n)) {
                continue;
            }
            let joined = ends.iter().all(|&[v, w]| groups.join(v, w, &self.mesh.positions, tolerance));
            if joined {
                paired.extend(edges);
            }
        }
        let (into, farthest) = groups.representatives(&self.mesh.positions);
        let moved = into.len();
        let number = |v: u32| into.get(&v).copied().unwrap_or(v);
        self.mesh.triangles.iter_mut().for_each(|t| *t = t.map(number));
        // Slivers between vertices that are one now.
        let stays: Vec<bool> = self.mesh.triangles.iter().map(|t| !has_repeated_index(*t)).collect();
        let mut stay = stays.iter();
        self.mesh.triangles.retain(|_| *stay.next().unwrap_or(&true));
        let mut stay = stays.iter();
        self.sources.retain(|_| *stay.next().unwrap_or(&true));
        Some((moved, farthest))
    }
}

/// Vertices that become one.
#[derive(Default)]
struct Groups {
    of: FxHashMap<u32, u32>,
    members: Vec<Vec<u32>>,
}

impl Groups {
    /// Puts two vertices into one group, if one of its vertices then is near enough to all of them.
    fn join(&mut self, v: u32, w: u32, positions: &[DVec3], tolerance: f64) -> bool {
        if v == w {
            return true;
        }
        let [a, b] = [v, w].map(|v| self.of.get(&v).copied());
        if a.is_some() && a == b {
            return true;
        }
        let list = |group: Option<u32>, v: u32| group.map_or_else(|| vec![v], |g| self.members[g as usize].clone());
        let both = [list(a, v), list(b, w)].concat();
        if best(&both, positions).1 > tolerance {
            return false;
        }
        let group = self.members.len() as u32;
        self.of.extend(both.iter().map(|&v| (v, group)));
        [a, b].into_iter().flatten().for_each(|old| self.members[old as usize].clear());
        self.members.push(both);
        true
    }

    /// The vertex that each one but the representatives becomes, and how far the farthest moves.
    fn representatives(&self, positions: &[DVec3]) -> (FxHashMap<u32, u32>, f64) {
        let (mut into, mut farthest) = (FxHashMap::default(), 0.0f64);
        for group in self.members.iter().filter(|group| !group.is_empty()) {
            let (chosen, far) = best(group, positions);
            farthest = farthest.max(far);
            into.extend(group.iter().filter(|&&v| v != chosen).map(|&v| (v, chosen)));
        }
        (into, farthest)
    }
}

/// The vertex of a group to which the others are nearest, by the farthest of them, and how far that is.
fn best(group: &[u32], positions: &[DVec3]) -> (u32, f64) {
    let at = |v: u32| positions[v as usize];
    let far = |v: u32| group.iter().map(|&w| at(v).distance(at(w))).fold(0.0, f64::max);
    let place = |v: u32| at(v).to_array();
    let by = |x: &(u32, f64), y: &(u32, f64)| {
        let by_place = place(x.0).partial_cmp(&place(y.0)).unwrap_or(std::cmp::Ordering::Equal);
        x.1.total_cmp(&y.1).then(by_place)
    };
    group.iter().map(|&v| (v, far(v))).min_by(by).unwrap_or((0, 0.0))
}

#[cfg(test)]
mod tests;
