//! Cells: the parts of space between the pieces of a refined surface, joined around edges.

use std::cmp::Ordering;

use rustc_hash::FxHashMap;

use super::anchor::{Anchor, Cell, Crossed, anchors};
use super::plane::normal;
use super::refine::Refined;
use crate::mesh::edges::{Edge, Edges, Union};
use crate::progress::{Progress, Stopped};

/// The cells of a refined surface and what is needed to know how often triangles wind around each.
#[derive(Debug)]
pub(crate) struct Cells {
    /// The cells in front of each piece and behind it.
    pub(crate) beside: Vec<[Cell; 2]>,
    pub(crate) count: usize,
    /// A piece for each pair of cells that meet over one, by the pair.
    doors: Vec<([Cell; 2], u32)>,
    anchors: Vec<Anchor>,
}

/// An edge around which the triangles do not close: its pieces do not face one way as often as the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Gap {
    pub(crate) operand: u32,
    /// The ends, numbers of points.
    pub(crate) ends: [u32; 2],
}

/// Who a triangle belongs to and whether it counts turned over.
pub(crate) trait Owner: Sync {
    /// The operand of a triangle.
    fn operand(&self, triangle: u32) -> u32;
    /// Whether the triangle is taken the other way round than it is.
    fn is_turned(&self, triangle: u32) -> bool;
}

/// Calls `visit` with each operand of which triangles cover a piece and how much its winding number grows from the front to the back.
pub(crate) fn steps(refined: &Refined, piece: u32, owner: &impl Owner, mut visit: impl FnMut(u32, i32)) {
    for cover in refined.covers(&refined.pieces[piece as usize]) {
        let back = cover.reversed == owner.is_turned(cover.triangle);
        visit(owner.operand(cover.triangle), if back { 1 } else { -1 });
    }
}

/// The edges around which the triangles of some operand do not close, in the order of their ends. `edges`: those of the pieces.
pub(crate) fn gaps(refined: &Refined, edges: &Edges<'_>, owner: &impl Owner, ring: &Ring<'_>) -> Vec<Gap> {
    let mut found = Vec::new();
    let mut sums: Vec<(u32, i32)> = Vec::new();
    edges.each(|edge| {
        if ring.is_rim(refined, &edge) {
            return;
        }
        sums.clear();
        for half in edge.halves() {
            let way = if edges.runs_up(half) { 1 } else { -1 };
            steps(refined, half / 3, owner, |operand, step| match sums.iter_mut().find(|sum| sum.0 == operand) {
                Some(sum) => sum.1 += way * step,
                None => sums.push((operand, way * step)),
            });
        }
        let open = sums.iter().filter(|sum| sum.1 != 0);
        found.extend(open.map(|&(operand, _)| Gap { operand, ends: edge.ends }));
    });
    found
}

/// The triangles around a part of a surface that is valid beyond it: they touch nothing, the outside is in front of them, and the solid behind.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Ring<'a> {
    /// For each triangle whether it is one of them; empty where a surface is whole.
    pub(crate) triangles: &'a [bool],
}

impl Ring<'_> {
    fn has(&self, refined: &Refined, piece: u32) -> bool {
        let Some(cover) = refined.covers(&refined.pieces[piece as usize]).first() else { return false };
        self.triangles.get(cover.triangle as usize) == Some(&true)
    }

    /// Whether the surface may go on beyond this edge.
    fn is_rim(&self, refined: &Refined, edge: &Edge<'_>) -> bool {
        !self.triangles.is_empty() && edge.halves().all(|half| self.has(refined, half / 3))
    }
}

impl Cells {
    /// The cells between the pieces, which must close around each of their `edges`, but for the rim of a ring.
    pub(crate) fn of(
        refined: &Refined,
        edges: &Edges<'_>,
        ring: &Ring<'_>,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        progress.check()?;
        let pieces = refined.pieces.len() as u32;
        let mut sides = Union::new(2 * pieces as usize);
        let mut around: Vec<Spoke> = Vec::new();
        edges.each(|edge| {
            if ring.is_rim(refined, &edge) {
                return;
            }
            around.clear();
            around.extend(edge.halves().map(|half| Spoke { piece: half / 3, up: edges.runs_up(half), normal: [0; 3] }));
            if around.len() > 2 {
                sort_around(refined, &edge, &mut around);
            }
            for (n, spoke) in around.iter().enumerate() {
                let next = &around[(n + 1) % around.len()];
                // A spoke that runs up has its front where the angle grows.
                sides.join(2 * spoke.piece + u32::from(!spoke.up), 2 * next.piece + u32::from(next.up));
            }
        });
        let mut number: FxHashMap<u32, Cell> = FxHashMap::default();
        let mut cell = |side: u32| {
            let root = sides.root(side);
            let new = number.len() as Cell;
            *number.entry(root).or_insert(new)
        };
        let beside: Vec<[Cell; 2]> = (0..pieces).map(|p| [cell(2 * p), cell(2 * p + 1)]).collect();
        let count = number.len();
        let mut first: FxHashMap<[Cell; 2], u32> = FxHashMap::default();
        for (&pair, piece) in beside.iter().zip(0..) {
            first.entry(pair).or_insert(piece);
        }
        let mut doors: Vec<([Cell; 2], u32)> = first.into_iter().collect();
        doors.sort_unstable();
        let anchors = match ring.triangles.is_empty() {
            true => {
                let mut parts = Union::new(count);
                doors.iter().for_each(|&([a, b], _)| _ = parts.join(a, b));
                let part_of: Vec<u32> = beside.iter().map(|pair| parts.root(pair[0])).collect();
                anchors(refined, &part_of, &beside, progress)?
            }
            false => {
                let known = (0..pieces).filter(|&piece| ring.has(refined, piece));
                known.map(|piece| Anchor { cell: beside[piece as usize][0], crossed: Vec::new() }).collect()
            }
        };
        Ok(Self { beside, count, doors, anchors })
    }

    /// How often the triangles of each of `operands` operands wind around each cell: `operands` numbers a cell, one cell after another. `None` if
    /// that is not one number everywhere.
    pub(crate) fn winding(&self, refined: &Refined, operands: usize, owner: &impl Owner) -> Option<Vec<i32>> {
        let mut winding = vec![0i32; self.count * operands];
        let mut known = vec![false; self.count];
        let mut ways: Vec<(Cell, Cell, u32, i32)> = Vec::new();
        for &([front, back], piece) in &self.doors {
            ways.extend([(front, back, piece, 1), (back, front, piece, -1)]);
        }
        ways.sort_unstable();
        let mut row = vec![0i32; operands];
        for anchor in &self.anchors {
            row.fill(0);
            for &Crossed { cover, sign } in &anchor.crossed {
                let sign = if cover.reversed == owner.is_turned(cover.triangle) { sign } else { -sign };
                row[owner.operand(cover.triangle) as usize] += sign;
            }
            let start = anchor.cell as usize;
            let own = start * operands..(start + 1) * operands;
            if std::mem::replace(&mut known[start], true) {
                if winding[own] != row {
                    return None;
                }
                continue;
            }
            winding[own].copy_from_slice(&row);
            let mut stack = vec![anchor.cell];
            while let Some(from) = stack.pop() {
                let begin = ways.partition_point(|way| way.0 < from);
                for &(_, to, piece, sign) in ways[begin..].iter().take_while(|way| way.0 == from) {
                    if std::mem::replace(&mut known[to as usize], true) {
                        continue;
                    }
                    let (from, to_row) = (from as usize * operands, to as usize * operands);
                    winding.copy_within(from..from + operands, to_row);
                    steps(refined, piece, owner, |operand, step| winding[to_row + operand as usize] += sign * step);
                    stack.push(to);
                }
            }
        }
        let mut sum = vec![0i32; operands];
        let agrees = |piece: u32| {
            let [front, back] = self.beside[piece as usize].map(|cell| cell as usize * operands);
            sum.copy_from_slice(&winding[front..front + operands]);
            steps(refined, piece, owner, |operand, step| sum[operand as usize] += step);
            sum == winding[back..back + operands]
        };
        (known.iter().all(|&known| known) && (0..self.beside.len() as u32).all(agrees)).then_some(winding)
    }
}

/// A piece at an edge.
#[derive(Debug, Clone, Copy)]
struct Spoke {
    piece: u32,
    /// Whether the piece runs along the edge from its lower end to its higher one.
    up: bool,
    /// The piece's normal, turned over if it runs down: it points to where the angle around the edge grows.
    normal: [i64; 3],
}

/// Sorts the pieces at an edge by the angle around it. All of them lie in planes of input triangles through the edge, so that the edge is parallel to the cross
/// product of any two of their normals: the angle is compared by one component of that.
fn sort_around(refined: &Refined, edge: &Edge<'_>, around: &mut [Spoke]) {
    let [low, high] = edge.ends;
    let points = &refined.points;
    let axis = points.longest_axis(low, high);
    let forward = points.compare_along(low, high, axis).is_lt();
    for spoke in around.iter_mut() {
        let facet = refined.pieces[spoke.piece as usize].facet;
        let own = normal(refined.facets.places(facet));
        spoke.normal = if spoke.up { own } else { own.map(|x| -x) };
    }
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let turn = |a: &Spoke, b: &Spoke| {
        let part = |i: usize, j: usize| i128::from(a.normal[i]) * i128::from(b.normal[j]);
        let sign = (part(i, j) - part(j, i)).signum();
        if forward { sign } else { -sign }
    };
    let first = around[0];
    // Along the first, in the half turn after it, opposite to it, in the half turn before it.
    let quarter = |spoke: &Spoke| match turn(&first, spoke) {
        0 => {
            let same: i128 = (0..3).map(|k| i128::from(first.normal[k]) * i128::from(spoke.normal[k])).sum();
            if same > 0 { 0 } else { 2 }
        }
        1 => 1,
        _ => 3,
    };
    around.sort_by(|a, b| {
        quarter(a).cmp(&quarter(b)).then_with(|| match turn(a, b) {
            0 => Ordering::Equal,
            sign if sign > 0 => Ordering::Less,
            _ => Ordering::Greater,
        })
    });
}
