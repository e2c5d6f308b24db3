//! All intersecting triangles of a mesh: a box tree over triangles in Morton order, walked against
//! itself, and the exact test for pairs whose boxes overlap.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::TriMesh;
use super::edges::copies;
use super::predicates::{Face, scale_of_mesh};
use super::triangle_pair::{Shared, faces_intersect};
use super::weld::{has_repeated_index, welded_triangles};
use crate::progress::{Progress, Stopped};

/// Triangles in a leaf of the tree.
const LEAF: usize = 4;

/// Pairs of subtrees that are handed out to threads.
const TASKS: usize = 512;

/// All pairs of triangles that intersect in the sense of
/// [`triangles_intersect`](super::triangles_intersect), each with the smaller id first, sorted.
/// A triangle given more than once is paired with its first copy alone, which stands for all of them.
///
/// The list may be as long as the square of the number of triangles; for meshes of unknown
/// origin ask for [`intersecting_triangles`].
pub fn self_intersections(mesh: &TriMesh, progress: &Progress) -> Result<Vec<[u32; 2]>, Stopped> {
    pairs_of(&Scene::new(mesh), None, progress)
}

/// The same of the pairs in which one triangle at least is marked.
pub(crate) fn intersections_with(
    mesh: &TriMesh,
    marked: &[bool],
    progress: &Progress,
) -> Result<Vec<[u32; 2]>, Stopped> {
    let scene = Scene::new(mesh);
    let marks = Marks::new(&scene, marked);
    pairs_of(&scene, Some(&marks), progress)
}

/// The pairs of a scene that intersect; with marks those in which one triangle at least is marked.
fn pairs_of(scene: &Scene, marks: Option<&Marks<'_>>, progress: &Progress) -> Result<Vec<[u32; 2]>, Stopped> {
    let lists = scene.tasks().into_par_iter().map(|task| {
        let mut sink = Pairs { marks, pairs: Vec::new() };
        scene.visit(task, &mut sink, progress).map(|()| sink.pairs)
    });
    let mut pairs: Vec<[u32; 2]> = lists.collect::<Result<Vec<_>, _>>()?.concat();
    pairs.extend(scene.copies.iter().map(|&[copy, first]| [first, copy]));
    pairs.par_sort_unstable();
    Ok(pairs)
}

/// The triangles that intersect another one in the sense of
/// [`triangles_intersect`](super::triangles_intersect), ascending. Memory stays proportional to the
/// mesh, and parts of it where every triangle has been found to intersect are not searched again.
pub fn intersecting_triangles(mesh: &TriMesh, progress: &Progress) -> Result<Vec<u32>, Stopped> {
    let scene = Scene::new(mesh);
    let flags = Flags::new(&scene);
    scene.tasks().into_par_iter().try_for_each(|task| scene.visit(task, &mut &flags, progress))?;
    Ok(flags.found(&scene))
}

/// What [`intersecting_groups`] found.
#[derive(Debug, Clone, Default)]
pub(crate) struct Groups {
    /// The triangles that intersect another one, ascending.
    pub(crate) triangles: Vec<u32>,
    /// The pairs of groups of which triangles intersect, the smaller first, sorted; a group with itself, too.
    pub(crate) pairs: Vec<[u32; 2]>,
}

/// [`intersecting_triangles`], and which groups of triangles meet by them; `group` has a number for each triangle.
/// Memory stays proportional to the mesh and to the pairs of groups.
pub(crate) fn intersecting_groups(mesh: &TriMesh, group: &[u32], progress: &Progress) -> Result<Groups, Stopped> {
    let scene = Scene::new(mesh);
    let flags = Flags::new(&scene);
    let lists = scene.tasks().into_par_iter().map(|task| {
        let mut sink = Grouped { flags: &flags, group, pairs: FxHashSet::default() };
        scene.visit(task, &mut sink, progress).map(|()| sink.pairs)
    });
    let lists: Vec<FxHashSet<[u32; 2]>> = lists.collect::<Result<_, _>>()?;
    let mut pairs: Vec<[u32; 2]> = lists.into_iter().flatten().collect();
    let of_copy = |&[copy, first]: &[u32; 2]| sorted_pair(group[copy as usize], group[first as usize]);
    pairs.extend(scene.copies.iter().map(of_copy));
    pairs.par_sort_unstable();
    pairs.dedup();
    Ok(Groups { triangles: flags.found(&scene), pairs })
}

fn sorted_pair(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// A box in single precision. Coordinates went through one monotone map, so boxes that overlap in
/// the mesh overlap here.
#[derive(Debug, Clone, Copy)]
struct Box3 {
    min: Vec3,
    max: Vec3,
}

impl Box3 {
    const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    #[inline]
    fn overlaps(&self, other: &Self) -> bool {
        // Bitwise, because six branches cost more than six comparisons.
        (self.min.x <= other.max.x)
            & (other.min.x <= self.max.x)
            & (self.min.y <= other.max.y)
            & (other.min.y <= self.max.y)
            & (self.min.z <= other.max.z)
            & (other.min.z <= self.max.z)
    }
}

/// One triangle of the tree.
struct Item {
    face: Face,
    vertices: [u32; 3],
    id: u32,
}

/// Two subtrees (or one, twice) at the same level of the tree.
#[derive(Debug, Clone, Copy)]
struct Task {
    level: usize,
    nodes: [usize; 2],
}

/// Where intersecting pairs go.
trait Sink {
    /// Whether nothing more can be learnt from this pair of subtrees.
    fn settled(&self, task: Task) -> bool;
    /// Whether nothing more can be learnt from this pair of items.
    fn known(&self, scene: &Scene, items: [usize; 2]) -> bool;
    /// Items `items` intersect.
    fn hit(&mut self, scene: &Scene, items: [usize; 2]);
    /// This pair of subtrees has been searched.
    fn leave(&self, task: Task);
}

/// Which triangles are marked, and which subtrees have such triangles.
struct Marks<'a> {
    triangles: &'a [bool],
    nodes: Vec<Vec<bool>>,
}

impl<'a> Marks<'a> {
    fn new(scene: &Scene, triangles: &'a [bool]) -> Self {
        let mut nodes: Vec<Vec<bool>> = Vec::new();
        for (level, boxes) in scene.levels.iter().enumerate() {
            let any = |n: usize| match level {
                0 => {
                    let items = &scene.items[LEAF * n..(LEAF * (n + 1)).min(scene.items.len())];
                    items.iter().any(|item| triangles[item.id as usize])
                }
                _ => nodes[level - 1][2 * n..(2 * n + 2).min(nodes[level - 1].len())].contains(&true),
            };
            let marks = (0..boxes.len()).map(any).collect();
            nodes.push(marks);
        }
        Self { triangles, nodes }
    }
}

/// The pairs that one task has found.
struct Pairs<'a> {
    marks: Option<&'a Marks<'a>>,
    pairs: Vec<[u32; 2]>,
}

impl Sink for Pairs<'_> {
    fn settled(&self, Task { level, nodes }: Task) -> bool {
        self.marks.is_some_and(|marks| nodes.iter().all(|&n| !marks.nodes[level][n]))
    }

    fn known(&self, scene: &Scene, items: [usize; 2]) -> bool {
        self.marks.is_some_and(|marks| items.iter().all(|&i| !marks.triangles[scene.items[i].id as usize]))
    }

    fn hit(&mut self, scene: &Scene, items: [usize; 2]) {
        let [a, b] = items.map(|i| scene.items[i].id);
        self.pairs.push([a.min(b), a.max(b)]);
    }

    fn leave(&self, _: Task) {}
}

/// Which items and which whole subtrees are known to intersect something. Which of them are known
/// *when* depends on the threads; what is known at the end does not, because a pair is skipped only
/// when both are known already.
struct Flags {
    faces: Vec<AtomicBool>,
    nodes: Vec<Vec<AtomicBool>>,
}

impl Flags {
    fn new(scene: &Scene) -> Self {
        let cleared = |count: usize| (0..count).map(|_| AtomicBool::new(false)).collect::<Vec<_>>();
        Self { faces: cleared(scene.items.len()), nodes: scene.levels.iter().map(|l| cleared(l.len())).collect() }
    }

    /// The triangles that are known to intersect, copies among them, ascending.
    fn found(&self, scene: &Scene) -> Vec<u32> {
        let hit = self.faces.iter().zip(&scene.items).filter(|(flag, _)| flag.load(Ordering::Relaxed));
        let mut found: Vec<u32> = hit.map(|(_, item)| item.id).collect();
        found.extend(scene.copies.iter().flatten());
        found.par_sort_unstable();
        found.dedup();
        found
    }

    fn whole(&self, level: usize, node: usize) -> bool {
        self.nodes[level][node].load(Ordering::Relaxed)
    }

    fn update(&self, level: usize, node: usize) {
        let all = |flags: &[AtomicBool], width: usize| {
            let range = width * node..(width * (node + 1)).min(flags.len());
            flags[range].iter().all(|f| f.load(Ordering::Relaxed))
        };
        if match level {
            0 => all(&self.faces, LEAF),
            _ => all(&self.nodes[level - 1], 2),
        } {
            self.nodes[level][node].store(true, Ordering::Relaxed);
        }
    }
}

impl Sink for &Flags {
    fn settled(&self, Task { level, nodes }: Task) -> bool {
        nodes.iter().all(|&n| self.whole(level, n))
    }

    fn known(&self, _: &Scene, items: [usize; 2]) -> bool {
        items.iter().all(|&i| self.faces[i].load(Ordering::Relaxed))
    }

    fn hit(&mut self, _: &Scene, items: [usize; 2]) {
        items.iter().for_each(|&i| self.faces[i].store(true, Ordering::Relaxed));
    }

    fn leave(&self, Task { level, nodes }: Task) {
        nodes.iter().for_each(|&n| self.update(level, n));
    }
}

/// Flags, and the pairs of groups that one task has found. A pair of groups that is known already is looked at again only
/// for the sake of its triangles.
struct Grouped<'a> {
    flags: &'a Flags,
    group: &'a [u32],
    pairs: FxHashSet<[u32; 2]>,
}

impl Grouped<'_> {
    fn pair(&self, scene: &Scene, items: [usize; 2]) -> [u32; 2] {
        let [a, b] = items.map(|i| self.group[scene.items[i].id as usize]);
        sorted_pair(a, b)
    }
}

impl Sink for Grouped<'_> {
    fn settled(&self, _: Task) -> bool {
        false
    }

    fn known(&self, scene: &Scene, items: [usize; 2]) -> bool {
        (&self.flags).known(scene, items) && self.pairs.contains(&self.pair(scene, items))
    }

    fn hit(&mut self, scene: &Scene, items: [usize; 2]) {
        (&mut &*self.flags).hit(scene, items);
        self.pairs.insert(self.pair(scene, items));
    }

    fn leave(&self, _: Task) {}
}

/// The triangles in Morton order and a binary tree of boxes over them: node n of a level holds nodes
/// 2n and 2n+1 of the level below, and node n of level 0 holds items LEAF·n and up.
struct Scene {
    items: Vec<Item>,
    boxes: Vec<Box3>,
    levels: Vec<Vec<Box3>>,
    /// Triangles given more than once, as [copy, first]; copies are not in the tree.
    copies: Vec<[u32; 2]>,
}

impl Scene {
    fn new(mesh: &TriMesh) -> Self {
        let triangles = welded_triangles(mesh);
        let copies = copies(&triangles, mesh.positions.len());
        let mut kept = vec![true; triangles.len()];
        copies.iter().for_each(|&[copy, _]| kept[copy as usize] = false);

        let frame = Frame::of(mesh);
        let boxed = |id: usize| {
            let [a, b, c] = mesh.corners(id).map(|p| frame.map(p));
            Box3 { min: a.min(b).min(c), max: a.max(b).max(c) }
        };
        let mut order: Vec<(u64, u32)> = (0..triangles.len())
            .into_par_iter()
            .filter(|&id| kept[id] && !has_repeated_index(triangles[id]))
            .map(|id| (frame.code(boxed(id)), id as u32))
            .collect();
        order.par_sort_unstable();

        let items: Vec<Item> = order
            .into_par_iter()
            .filter_map(|(_, id)| {
                let corners = mesh.corners(id as usize).map(|p| p * frame.scale);
                Face::new(corners).map(|face| Item { face, vertices: triangles[id as usize], id })
            })
            .collect();
        let boxes: Vec<Box3> = items.par_iter().map(|item| boxed(item.id as usize)).collect();
        let levels = levels_over(&boxes);
        Self { items, boxes, levels, copies }
    }

    /// The whole walk, split into enough independent parts, in an order that depends on the mesh alone.
    fn tasks(&self) -> Vec<Task> {
        let Some(top) = self.levels.len().checked_sub(1) else { return Vec::new() };
        let mut tasks = vec![Task { level: top, nodes: [0, 0] }];
        while tasks.len() < TASKS && tasks.first().is_some_and(|t| t.level > 0) {
            let mut next = Vec::new();
            tasks.iter().for_each(|&task| self.split(task, |part| next.push(part)));
            tasks = next;
        }
        tasks
    }

    /// The pairs of children of a pair of subtrees whose boxes overlap.
    #[inline]
    fn split(&self, Task { level, nodes: [a, b] }: Task, mut visit: impl FnMut(Task)) {
        let below = &self.levels[level - 1];
        for i in 2 * a..(2 * a + 2).min(below.len()) {
            let first = if a == b { i } else { 2 * b };
            for j in first..(2 * b + 2).min(below.len()) {
                if i == j || below[i].overlaps(&below[j]) {
                    visit(Task { level: level - 1, nodes: [i, j] });
                }
            }
        }
    }

    fn visit(&self, task: Task, sink: &mut impl Sink, progress: &Progress) -> Result<(), Stopped> {
        progress.check()?;
        let mut budget = 1 << 16;
        self.walk(task, sink, progress, &mut budget)
    }

    fn walk(&self, task: Task, sink: &mut impl Sink, progress: &Progress, budget: &mut u32) -> Result<(), Stopped> {
        if sink.settled(task) {
            return Ok(());
        }
        if task.level == 0 {
            *budget -= 1;
            if *budget == 0 {
                progress.check()?;
                *budget = 1 << 16;
            }
            self.leaves(task.nodes, sink);
        } else {
            let mut result = Ok(());
            self.split(task, |part| {
                if result.is_ok() {
                    result = self.walk(part, sink, progress, budget);
                }
            });
            result?;
        }
        sink.leave(task);
        Ok(())
    }

    fn leaves(&self, [a, b]: [usize; 2], sink: &mut impl Sink) {
        let range = |n: usize| LEAF * n..(LEAF * (n + 1)).min(self.items.len());
        for i in range(a) {
            let others = if a == b { i + 1..range(b).end } else { range(b) };
            for j in others {
                if self.boxes[i].overlaps(&self.boxes[j]) && !sink.known(self, [i, j]) && self.meet(i, j) {
                    sink.hit(self, [i, j]);
                }
            }
        }
    }

    #[inline]
    fn meet(&self, i: usize, j: usize) -> bool {
        let (a, b) = (&self.items[i], &self.items[j]);
        faces_intersect(&a.face, &b.face, Shared::of(&a.vertices, &b.vertices))
    }
}

/// The boxes of a binary tree over leaves of [`LEAF`] boxes, leaves first.
fn levels_over(boxes: &[Box3]) -> Vec<Vec<Box3>> {
    let merged = |boxes: &[Box3], width: usize| -> Vec<Box3> {
        boxes.chunks(width).map(|chunk| chunk.iter().fold(Box3::EMPTY, |all, &b| all.union(b))).collect()
    };
    let mut levels = Vec::new();
    let mut level = merged(boxes, LEAF);
    while !level.is_empty() {
        let next = if level.len() > 1 { merged(&level, 2) } else { Vec::new() };
        levels.push(std::mem::replace(&mut level, next));
    }
    levels
}

/// The maps from model units: exact scaling for the predicates, and a monotone one into about −1 to 1
/// for boxes.
struct Frame {
    scale: f64,
    centre: DVec3,
    shrink: f64,
}

impl Frame {
    fn of(mesh: &TriMesh) -> Self {
        let (centre, half) = mesh.bounds().map_or((DVec3::ZERO, 0.0), |b| {
            let half = (b.max / 2.0 - b.min / 2.0).max_element();
            (b.min / 2.0 + b.max / 2.0, half)
        });
        let shrink = if half > 0.0 { (1.0 / half).min(f64::MAX) } else { 1.0 };
        Self { scale: scale_of_mesh(mesh), centre, shrink }
    }

    fn map(&self, p: DVec3) -> Vec3 {
        ((p - self.centre) * self.shrink).as_vec3()
    }

    /// The Morton code of a box's centre.
    fn code(&self, b: Box3) -> u64 {
        let cell = |x: f32| (((x + 1.0) * (1 << 20) as f32).max(0.0) as u64).min((1 << 21) - 1);
        let centre = (b.min + b.max) * 0.5;
        spread(cell(centre.x)) | (spread(cell(centre.y)) << 1) | (spread(cell(centre.z)) << 2)
    }
}

/// The 21 low bits of `x`, each followed by two zero bits.
fn spread(x: u64) -> u64 {
    let x = (x | (x << 32)) & 0x001f_0000_0000_ffff;
    let x = (x | (x << 16)) & 0x001f_0000_ff00_00ff;
    let x = (x | (x << 8)) & 0x100f_00f0_0f00_f00f;
    let x = (x | (x << 4)) & 0x10c3_0c30_c30c_30c3;
    (x | (x << 2)) & 0x1249_2492_4924_9249
}
