//! Triangles that reach over a crease are cut along it.
//!
//! An edge between different smooth pieces gets a vertex where the crease is. A triangle with two
//! such edges is cut in two by the way between their vertices, and that way lies on the crease; one
//! with three is cut in three, around the corner. So creases become paths of edges by themselves,
//! as in marching over a triangulation by labels.

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::Surface;
use super::crease::{Crease, FLAT, Place, nearest};
use super::facets::{Facets, Sides};
use super::snap::shape;

/// A corner nearer to a point of a crease than this, h, is that point.
const SAME: f64 = 0.02;

/// A surface whose triangles know which triangle they were.
pub(super) struct Cut {
    pub surface: Surface,
    /// The triangle before cutting, for each triangle.
    pub origin: Vec<u32>,
    /// Triangles before cutting that got a vertex inside.
    pub centred: Vec<u32>,
}

/// Cuts `surface` at the points given for some of its edges (smaller vertex first).
pub(super) fn cut(
    surface: &Surface,
    facets: &Facets<'_>,
    h: f64,
    points: &[([u32; 2], Crease)],
    plain: &FxHashSet<u32>,
) -> Cut {
    let first = surface.mesh.positions.len() as u32;
    let ids: FxHashMap<[u32; 2], u32> = points.iter().zip(first..).map(|(&(edge, _), id)| (edge, id)).collect();
    let mut positions = surface.mesh.positions.clone();
    let mut sides = surface.sides.clone();
    positions.extend(points.iter().map(|(_, c)| super::rounded(c.place.at)));
    sides.extend(points.iter().map(|(_, c)| c.place.sides));
    let on = |a: u32, b: u32| ids.get(&[a.min(b), a.max(b)]).copied();
    let touched: Vec<Option<[Option<u32>; 3]>> = surface
        .mesh
        .triangles
        .par_iter()
        .map(|&[a, b, c]| {
            let cuts = [on(a, b), on(b, c), on(c, a)];
            cuts.iter().any(Option::is_some).then_some(cuts)
        })
        .collect();
    let mut triangles = Vec::with_capacity(surface.mesh.triangles.len() + 2 * points.len());
    let mut origin = Vec::with_capacity(triangles.capacity());
    let mut centred = Vec::new();
    for (id, (&corners, cuts)) in surface.mesh.triangles.iter().zip(&touched).enumerate() {
        let Some(cuts) = cuts else {
            triangles.push(corners);
            origin.push(id as u32);
            continue;
        };
        if let [Some(m), Some(n), Some(o)] = *cuts {
            let three = [m, n, o].map(|v| Place { at: positions[v as usize], sides: sides[v as usize] });
            let wanted = !plain.contains(&(id as u32));
            let centre = wanted.then(|| corner(facets, h, three)).flatten().map(|place| {
                centred.push(id as u32);
                positions.push(super::rounded(place.at));
                sides.push(place.sides);
                positions.len() as u32 - 1
            });
            split_in_three(corners, [m, n, o], centre, &mut triangles);
        } else {
            split(corners, *cuts, &positions, &mut triangles);
        }
        origin.resize(triangles.len(), id as u32);
    }
    let mesh = crate::mesh::TriMesh { positions, triangles };
    let mut cut = Cut { surface: Surface { mesh, sides }, origin, centred };
    raise_corners(&mut cut, facets, h, plain);
    cut
}

/// Puts a vertex into triangles whose corners lie on creases that meet in a corner not yet there.
fn raise_corners(cut: &mut Cut, facets: &Facets<'_>, h: f64, plain: &FxHashSet<u32>) {
    let surface = &cut.surface;
    let found: Vec<(u32, Place)> = (0..surface.mesh.triangles.len() as u32)
        .into_par_iter()
        .filter(|&t| !surface.is_smooth(facets, t) && !plain.contains(&cut.origin[t as usize]))
        .filter_map(|t| Some((t, corner(facets, h, surface.mesh.triangles[t as usize].map(|v| surface.place(v)))?)))
        .collect();
    for (t, place) in found {
        let [a, b, c] = cut.surface.mesh.triangles[t as usize];
        let z = cut.surface.mesh.positions.len() as u32;
        cut.surface.mesh.positions.push(super::rounded(place.at));
        cut.surface.sides.push(place.sides);
        cut.surface.mesh.triangles[t as usize] = [a, b, z];
        cut.surface.mesh.triangles.extend([[b, c, z], [c, a, z]]);
        cut.centred.push(cut.origin[t as usize]);
        cut.origin.extend([cut.origin[t as usize]; 2]);
    }
}

/// The corner in which the creases through three points meet, if it is another point.
fn corner(facets: &Facets<'_>, h: f64, three: [Place; 3]) -> Option<Place> {
    let mut sides = Sides::of(three.iter().flat_map(|p| p.sides.iter()));
    let normal = |s| facets.plane(s).normal;
    let distinct = sides.iter().enumerate().filter(|&(k, s)| {
        sides.iter().take(k).all(|o| normal(o).dot(normal(s)) < FLAT)
    });
    if distinct.count() < 3 {
        return None;
    }
    let middle = three.iter().map(|p| p.at).sum::<DVec3>() / 3.0;
    let mut at = nearest(sides.iter().map(|s| facets.plane(s)), middle)?;
    let mut beyond = 0.0f64;
    for _ in 0..3 {
        let walked: Vec<_> = sides.iter().map(|s| facets.walk(s, at)).collect();
        beyond = walked.iter().map(|w| w.1).fold(0.0, f64::max);
        sides = Sides::of(walked.into_iter().map(|w| w.0));
        at = nearest(sides.iter().map(|s| facets.plane(s)), middle)?;
    }
    let reach = three.iter().map(|p| p.at.distance(at)).fold(0.0, f64::max);
    let near = three.iter().any(|p| p.at.distance(at) < SAME * h);
    (!near && reach < 2.0 * h && (beyond < 0.05 * h || reach < h)).then_some(Place { at, sides })
}

/// Cuts a triangle at points on one or two of its edges (corner k to the next).
fn split(corners: [u32; 3], cuts: [Option<u32>; 3], at: &[DVec3], triangles: &mut Vec<[u32; 3]>) {
    for turn in 0..3 {
        let [a, b, c] = [0, 1, 2].map(|k| corners[(turn + k) % 3]);
        let [ab, bc, ca] = [0, 1, 2].map(|k| cuts[(turn + k) % 3]);
        match (ab, bc, ca) {
            (Some(m), None, None) => return triangles.extend([[a, m, c], [m, b, c]]),
            (Some(m), Some(n), None) => {
                triangles.push([m, b, n]);
                let height = |t: [u32; 3]| shape(t.map(|v| at[v as usize])).1;
                let across = [[a, m, n], [a, n, c]];
                let other = [[a, m, c], [m, n, c]];
                let least = |pair: [[u32; 3]; 2]| height(pair[0]).min(height(pair[1]));
                return triangles.extend(if least(across) >= least(other) { across } else { other });
            }
            _ => {}
        }
    }
}

/// Cuts a triangle at points on all its edges.
fn split_in_three([a, b, c]: [u32; 3], [m, n, o]: [u32; 3], centre: Option<u32>, triangles: &mut Vec<[u32; 3]>) {
    match centre {
        None => triangles.extend([[a, m, o], [m, b, n], [o, n, c], [m, n, o]]),
        Some(z) => triangles.extend([[a, m, z], [a, z, o], [m, b, z], [b, n, z], [n, c, z], [c, o, z]]),
    }
}
