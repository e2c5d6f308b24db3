//! Shells: the edge-connected parts of the operands' surfaces, and which of them are right as they are.
//!
//! A shell that is closed, a manifold, and touches nothing else is an exact statement about the solid: it bounds it as it is, or
//! not at all. Which of the two is a question of winding numbers, and those are whole on both sides of it. So such a
//! shell needs no ray, no vote and no voxel: [`standing`] finds the shells that stay as they are, and only the
//! others go on to the lattice.

mod bodies;
mod boxes;
mod buried;
mod contacts;
mod standing;
mod winding;

pub use bodies::bodies;
pub use buried::buried;
pub use contacts::{Contacts, contacts};
pub use standing::{Fate, StandingOptions, standing};

use rayon::prelude::*;

use crate::ldi::Operands;
use crate::mesh::edges::{Edges, Union};
use crate::mesh::{Bounds, TriMesh};

/// What the edges of a shell say of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Every edge has two triangles that run along it in opposite ways, and every vertex one fan.
    Closed,
    /// Some edges have one triangle; otherwise the shell is like a closed one.
    Open,
    /// Some edge has more triangles or ones that run the same way, or some vertex has several fans.
    Torn,
}

/// An edge-connected part of one operand's surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Shell {
    /// The number of the operand that the shell is part of.
    pub operand: usize,
    /// The triangles of the shell by their numbers in the soup, ascending.
    pub triangles: Vec<u32>,
    /// What the edges of the shell say of it.
    pub kind: Kind,
    /// Whether each of its edges is run along as often one way as the other: its winding numbers are then whole.
    pub balanced: bool,
    /// The box around it, model units.
    pub bounds: Bounds,
    /// Signed volume, cubic model units, seen from the middle of its box: positive when the triangles face outwards.
    pub volume: f64,
    /// Area, square model units.
    pub area: f64,
    /// Loops of open edges.
    pub rims: usize,
    /// The most area that its rims can enclose, as if each were a circle, square model units.
    pub rim_area: f64,
    /// Handles, once every rim is closed by a disk; `None` for torn shells.
    pub genus: Option<i64>,
}

/// A shell whose rims enclose at most this part of its area is a body with holes, rather than a piece of one. A cube without a side has
/// 0.25, half a ball 0.5, a flat sheet 1 or more.
const SMALL_RIMS: f64 = 0.3;

impl Shell {
    /// Whether it encloses something by itself, or would once its holes, small against it, are closed.
    pub fn is_body(&self) -> bool {
        match self.kind {
            Kind::Closed => true,
            Kind::Open => self.rim_area < SMALL_RIMS * self.area,
            Kind::Torn => false,
        }
    }
}

/// The shells of a soup.
#[derive(Debug, Clone, Default)]
pub struct Shells {
    /// The number of the shell of each triangle.
    pub of: Vec<u32>,
    /// All shells, by their first triangle.
    pub list: Vec<Shell>,
}

/// What is counted along the edges of a shell.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    edges: i64,
    open: u32,
    torn: bool,
    unbalanced: bool,
    rims: usize,
    rim_area: f64,
}

/// The shells of operands that lie one after another in `mesh`, whose vertices are merged within each operand.
pub fn shells(mesh: &TriMesh, operands: &Operands) -> Shells {
    let edges = Edges::new(&mesh.triangles, mesh.positions.len());
    let mut union = Union::new(mesh.triangles.len());
    edges.each(|edge| {
        let mut halves = edge.halves();
        let first = halves.next();
        halves.for_each(|half| {
            union.join(first.unwrap_or(half) / 3, half / 3);
        });
    });
    let mut shells = Shells { of: vec![0; mesh.triangles.len()], list: Vec::new() };
    let mut members: Vec<Vec<u32>> = Vec::new();
    for t in 0..mesh.triangles.len() as u32 {
        let root = union.root(t);
        let shell = if root == t { members.len() as u32 } else { shells.of[root as usize] };
        shells.of[t as usize] = shell;
        if root == t {
            members.push(Vec::new());
        }
        members[shell as usize].push(t);
    }
    let (tallies, connectivity) =
        rayon::join(|| tallies(mesh, &edges, &shells.of, members.len()), || edges.connectivity());
    let fans = connectivity.fans;
    shells.list = members
        .into_par_iter()
        .zip(&tallies)
        .map(|(triangles, tally)| shell(mesh, operands, triangles, tally, &fans))
        .collect();
    shells
}

/// What is counted along the edges of each shell.
fn tallies(mesh: &TriMesh, edges: &Edges<'_>, of: &[u32], count: usize) -> Vec<Tally> {
    let mut tallies = vec![Tally::default(); count];
    // Open edges that share a vertex are of one loop.
    let mut ends: Vec<([u32; 2], u32)> = Vec::new();
    edges.each(|edge| {
        let mut halves = edge.halves();
        let shell = of[halves.next().map_or(0, |half| half as usize / 3)];
        let up = edge.halves().filter(|&half| edges.runs_up(half)).count();
        let tally = &mut tallies[shell as usize];
        tally.edges += 1;
        tally.unbalanced |= 2 * up != edge.count();
        if edge.count() == 1 {
            tally.open += 1;
            ends.push((edge.ends, shell));
        } else {
            tally.torn |= edge.count() != 2 || up != 1;
        }
    });
    let mut vertices: Vec<u32> = ends.iter().flat_map(|entry| entry.0).collect();
    vertices.sort_unstable();
    vertices.dedup();
    let number = |v: u32| vertices.partition_point(|&other| other < v) as u32;
    let mut union = Union::new(vertices.len());
    ends.iter().for_each(|(ends, _)| {
        union.join(number(ends[0]), number(ends[1]));
    });
    let mut loops: Vec<(u32, f64)> = vec![(0, 0.0); vertices.len()];
    for (ends, shell) in &ends {
        let [a, b] = ends.map(|v| mesh.positions[v as usize]);
        let length = &mut loops[union.root(number(ends[0])) as usize];
        *length = (*shell, length.1 + a.distance(b));
    }
    for (shell, length) in loops.into_iter().filter(|entry| entry.1 > 0.0) {
        tallies[shell as usize].rims += 1;
        tallies[shell as usize].rim_area += length * length / (4.0 * std::f64::consts::PI);
    }
    tallies
}

fn shell(mesh: &TriMesh, operands: &Operands, triangles: Vec<u32>, tally: &Tally, fans: &[u32]) -> Shell {
    let corners = || triangles.iter().map(|&t| mesh.corners(t as usize));
    let nothing = Bounds { min: glam::DVec3::ZERO, max: glam::DVec3::ZERO };
    let bounds = Bounds::of(corners().flatten()).unwrap_or(nothing);
    let centre = (bounds.min + bounds.max) / 2.0;
    let (mut volume, mut area) = (0.0, 0.0);
    for [a, b, c] in corners().map(|corners| corners.map(|p| p - centre)) {
        volume += a.dot(b.cross(c)) / 6.0;
        area += (b - a).cross(c - a).length() / 2.0;
    }
    let mut vertices: Vec<u32> = triangles.iter().flat_map(|&t| mesh.triangles[t as usize]).collect();
    vertices.par_sort_unstable();
    vertices.dedup();
    let torn = tally.torn || vertices.iter().any(|&v| fans[v as usize] > 1);
    let kind = match (torn, tally.open) {
        (true, _) => Kind::Torn,
        (false, 0) => Kind::Closed,
        (false, _) => Kind::Open,
    };
    let euler = vertices.len() as i64 - tally.edges + triangles.len() as i64;
    Shell {
        operand: operands.of(triangles[0]),
        kind,
        balanced: !tally.unbalanced,
        bounds,
        volume,
        area,
        rims: tally.rims,
        rim_area: tally.rim_area,
        genus: (!torn).then_some((2 - euler - tally.rims as i64) / 2),
        triangles,
    }
}
