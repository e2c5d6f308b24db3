//! From facets that cross to pieces that meet only at common edges and vertices.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::facets::{Cover, Facets};
use super::layout::Layout;
use super::planar::Planar;
use super::point::Points;
use super::sheets::{Sheet, cross, sheets};
use crate::progress::{Progress, Stopped};

/// A piece of a facet, or of several that lie over one another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    /// Numbers of points, counter-clockwise where the facet is.
    pub(crate) corners: [u32; 3],
    /// A facet whose plane the piece lies in, and which it faces as.
    pub(crate) facet: u32,
    /// The number of the set of triangles that cover it.
    covering: u32,
}

/// Facets refined: pieces that meet only at common edges and vertices.
#[derive(Debug)]
pub(crate) struct Refined {
    pub(crate) facets: Facets,
    pub(crate) points: Points,
    pub(crate) pieces: Vec<Piece>,
    /// Sets of covers that are not those of a facet.
    sets: Vec<Vec<Cover>>,
    /// For each facet whether it was cut, and whether it shares a sheet with others.
    state: Vec<State>,
    /// Segments along which facets cross, by the numbers of their ends.
    pub(crate) curves: Vec<[u32; 2]>,
}

/// What became of a facet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    /// It is a piece as it is.
    Whole,
    /// It is cut, and a sheet by itself.
    Single,
    /// It lies in one plane with others that it touches.
    Shared,
}

impl Refined {
    /// The points of each piece.
    pub(crate) fn corners(&self) -> Vec<[u32; 3]> {
        self.pieces.iter().map(|piece| piece.corners).collect()
    }

    /// Whether a facet is a piece as it is.
    pub(crate) fn is_whole(&self, facet: u32) -> bool {
        self.state[facet as usize] == State::Whole
    }

    /// Whether a facet is a sheet by itself.
    pub(crate) fn is_single(&self, facet: u32) -> bool {
        self.state[facet as usize] != State::Shared
    }

    /// How many facets were cut.
    pub(crate) fn cut(&self) -> usize {
        self.state.iter().filter(|&&state| state != State::Whole).count()
    }

    /// The triangles that cover a piece.
    pub(crate) fn covers(&self, piece: &Piece) -> &[Cover] {
        match (piece.covering as usize).checked_sub(self.facets.len()) {
            None => self.facets.covers(piece.covering),
            Some(set) => &self.sets[set],
        }
    }
}

/// Cuts facets where they touch by these pairs of facets.
pub(crate) fn refine(facets: Facets, pairs: &[[u32; 2]], progress: &Progress) -> Result<Refined, Stopped> {
    let mut points = Points::new(facets.vertices.clone());
    let mut list = sheets(&facets, pairs, &mut points, progress)?;
    cross(&mut list, &facets, &mut points, progress)?;
    let (known, own) = (&points, &facets);
    let cut: Vec<Cut> =
        list.par_iter().map(|sheet| progress.check().map(|()| cut(sheet, own, known))).collect::<Result<_, _>>()?;
    let mut curves: Vec<[u32; 2]> = list.iter().flat_map(Sheet::curves).collect();
    curves.par_sort_unstable();
    curves.dedup();
    let mut state = vec![State::Whole; facets.len()];
    for sheet in &list {
        let new = if sheet.facets.len() == 1 { State::Single } else { State::Shared };
        sheet.facets.iter().for_each(|&f| state[f as usize] = new);
    }
    let mut refined = Refined { state, points, pieces: Vec::new(), sets: Vec::new(), curves, facets };
    let mut at = 0;
    let order: FxHashMap<u32, usize> = list.iter().enumerate().map(|(n, sheet)| (sheet.facets[0], n)).collect();
    for f in 0..refined.facets.len() as u32 {
        if refined.is_whole(f) {
            refined.pieces.push(Piece { corners: refined.facets.corners[f as usize], facet: f, covering: f });
        } else if let Some(&n) = order.get(&f) {
            let first = refined.facets.len() as u32 + at;
            let piece = |&(corners, set): &([u32; 3], u32)| Piece {
                corners,
                facet: f,
                covering: if cut[n].sets.is_empty() { f } else { first + set },
            };
            refined.pieces.extend(cut[n].pieces.iter().map(piece));
            refined.sets.extend(cut[n].sets.iter().cloned());
            at += cut[n].sets.len() as u32;
        }
    }
    Ok(refined)
}

/// A sheet cut up.
struct Cut {
    /// Corners by their points' numbers, and the set of covers.
    pieces: Vec<([u32; 3], u32)>,
    /// Empty where the facet is one by itself: its own covers are those of all pieces.
    sets: Vec<Vec<Cover>>,
}

impl Sheet {
    /// The parts of its segments that are not edges of facets.
    fn curves(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.segments.iter().filter(|segment| segment.edge_of.is_empty()).flat_map(|segment| {
            let chain: Vec<u32> = segment.chain().collect();
            chain.windows(2).map(|pair| [pair[0].min(pair[1]), pair[0].max(pair[1])]).collect::<Vec<_>>()
        })
    }
}

impl super::sheets::Segment {
    /// Its points from end to end.
    fn chain(&self) -> impl Iterator<Item = u32> + '_ {
        std::iter::once(self.ends[0]).chain(self.within.iter().copied()).chain([self.ends[1]])
    }
}

fn cut(sheet: &Sheet, facets: &Facets, points: &Points) -> Cut {
    let single = sheet.facets.len() == 1;
    let facet = single.then(|| facets.corners[sheet.facets[0] as usize]);
    let layout = Layout::new(points, sheet.all_points(facets), &sheet.plane, facet);
    let mut planar = layout.planar();
    let mut parts: Vec<([u32; 2], usize)> = Vec::new();
    for (s, segment) in sheet.segments.iter().enumerate() {
        let chain: Vec<u32> = segment.chain().map(|p| layout.local(p)).collect();
        parts.extend(chain.windows(2).map(|pair| ([pair[0].min(pair[1]), pair[0].max(pair[1])], s)));
    }
    parts.sort_unstable();
    let groups: Vec<&[([u32; 2], usize)]> = parts.chunk_by(|a, b| a.0 == b.0).collect();
    for (n, group) in groups.iter().enumerate() {
        let [a, b] = group[0].0;
        planar.fix(a, b, n as u32);
    }
    planar.relax();
    if single {
        let pieces = planar.triangles.iter().map(|&corners| (layout.named(corners), 0)).collect();
        return Cut { pieces, sets: Vec::new() };
    }
    let edge_of =
        |part: u32| groups[part as usize].iter().flat_map(|&(_, s)| sheet.segments[s].edge_of.iter().copied());
    let states = covered(&planar, edge_of);
    let mut cut = Cut { pieces: Vec::new(), sets: Vec::new() };
    let mut known: FxHashMap<&[u32], u32> = FxHashMap::default();
    for (&corners, state) in planar.triangles.iter().zip(&states).filter(|entry| !entry.1.is_empty()) {
        let set = *known.entry(state).or_insert_with(|| {
            cut.sets.push(covers(sheet, facets, state));
            cut.sets.len() as u32 - 1
        });
        cut.pieces.push((layout.named(corners), set));
    }
    cut
}

/// For each triangle the facets that cover it, ascending: crossing an edge of a facet enters or leaves it.
fn covered<I: Iterator<Item = u32>>(planar: &Planar<'_>, edge_of: impl Fn(u32) -> I) -> Vec<Vec<u32>> {
    let mut states: Vec<Option<Vec<u32>>> = vec![None; planar.triangles.len()];
    // The corners beyond come last in the list of points, and what lies at them is not covered.
    let outermost = planar.triangles.iter().enumerate().max_by_key(|(_, corners)| corners.iter().max().copied());
    let start = outermost.map_or(0, |(t, _)| t as u32);
    states[start as usize] = Some(Vec::new());
    let mut stack = vec![start];
    while let Some(t) = stack.pop() {
        for k in 0..3 {
            let Some(other) = planar.across(t, k).filter(|&other| states[other as usize].is_none()) else { continue };
            let mut state = states[t as usize].clone().unwrap_or_default();
            for facet in planar.fixed(t, k).into_iter().flat_map(&edge_of) {
                match state.binary_search(&facet) {
                    Ok(at) => _ = state.remove(at),
                    Err(at) => state.insert(at, facet),
                }
            }
            states[other as usize] = Some(state);
            stack.push(other);
        }
    }
    states.into_iter().map(Option::unwrap_or_default).collect()
}

/// The triangles that cover what these facets cover, as seen from the sheet's first.
fn covers(sheet: &Sheet, facets: &Facets, state: &[u32]) -> Vec<Cover> {
    let up = |facet: u32| facets.plane(facet).normal[sheet.axis] > 0;
    let first = up(sheet.facets[0]);
    let of = |&facet: &u32| {
        let over = up(facet) != first;
        facets.covers(facet).iter().map(move |&cover| Cover { reversed: cover.reversed != over, ..cover })
    };
    let mut list: Vec<Cover> = state.iter().flat_map(of).collect();
    list.sort_unstable();
    list
}
