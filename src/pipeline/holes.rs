//! Operands of which only holes are wrong: a lid over each rim, made from the rim alone and judged by winding numbers.

use glam::DVec3;
use rayon::prelude::*;

use super::{FilledHole, Options};
use crate::fill::{FillOptions, Lid, Rim, Style, Surroundings, lid, rims};
use crate::mesh::{Bounds, TriMesh, intersections_with};
use crate::progress::{Progress, Stopped};
use crate::survey::Soup;
use crate::vote::{VoteRule, WindingTree};

/// A patch whose lids have more than this part of its area is a sheet, of which lids would make something that it is not.
const MOST_LIDS: f64 = 0.5;

/// A rim whose diameter is more than this part of its patch's diagonal is where the body was cut off, rather than a hole in it: by [`Style::Auto`] it is closed
/// flat. Smooth lids there are domes: over the lion's back one of 15 % of its volume, over the camel's neck one of 7 %.
const WIDE: f64 = 0.25;

/// A wide rim that lies farther from its plane than this part of its diameter has no flat lid: the few triangles over the camel's neck (6 %) are 1.2 % of
/// its volume away from where winding numbers have the lid.
const UNEVEN: f64 = 0.02;

/// How far before and behind a lid winding numbers are looked at, as parts of the width of its largest triangle: near it other holes matter little, and
/// farther away it matters little how the lid runs. One look that says that there is a hole suffices; between rims that face each other none does.
const LOOKS: [f64; 3] = [0.125, 0.25, 0.5];

/// At most so many rims are closed like this.
const MOST_RIMS: usize = 5000;

/// A mesh with a lid over each of its rims.
pub(super) struct Closed {
    /// The triangles of the mesh, and after them those of the lids.
    pub mesh: TriMesh,
    pub holes: Vec<FilledHole>,
}

/// A soup with a lid over each rim; `None` where one has none, where a lid meets anything, where winding numbers see no hole there, or where it is not they
/// that are to decide.
pub(super) fn closed(soup: &Soup, options: &Options, progress: &Progress) -> Result<Option<Closed>, Stopped> {
    if options.vote != VoteRule::Winding {
        return Ok(None);
    }
    let (mesh, style) = (&soup.mesh, options.fill);
    let rims = rims(mesh);
    if rims.is_empty() || rims.len() > MOST_RIMS {
        return Ok(None);
    }
    let around = Surroundings::new(mesh);
    let patches = Patches::of(soup);
    let lidded = |rim: &Rim| {
        progress.check()?;
        let is_wide = style == Style::Auto && rim.diameter > WIDE * patches.size[patches.beside(rim)];
        if is_wide && rim.flatness > UNEVEN * rim.diameter {
            return Ok(None);
        }
        let style = if is_wide { Style::Flat } else { style };
        Ok(lid(&around, rim, &FillOptions { style, ..FillOptions::default() }).ok())
    };
    let made = rims.par_iter().map(lidded);
    let made: Option<Vec<Lid>> = made.collect::<Result<Vec<_>, _>>()?.into_iter().collect();
    let Some(lids) = made else { return Ok(None) };
    if !patches.hold(mesh, &rims, &lids) || !are_holes(&around, &rims, progress)? {
        return Ok(None);
    }
    let (own, known) = (mesh.triangles.len(), mesh.positions.len());
    let mut closed = Closed { mesh: mesh.clone(), holes: Vec::new() };
    for (rim, lid) in rims.iter().zip(&lids) {
        let new = (closed.mesh.positions.len() - known) as u32;
        let number = |v: u32| if (v as usize) < known { v } else { v + new };
        closed.mesh.triangles.extend(lid.triangles.iter().map(|corners| corners.map(number)));
        closed.mesh.positions.extend_from_slice(&lid.positions);
        closed.holes.push(FilledHole::of(rim, lid));
    }
    let is_lid: Vec<bool> = (0..closed.mesh.triangles.len()).map(|t| t >= own).collect();
    let meets = !intersections_with(&closed.mesh, &is_lid, progress)?.is_empty();
    Ok((!meets).then_some(closed))
}

/// The patches of a soup, as far as they matter for lids.
struct Patches {
    /// For each vertex a patch that has it.
    at: Vec<usize>,
    /// For each patch its area, square model units.
    area: Vec<f64>,
    /// For each patch six times the volume between its triangles and the origin, cubic model units.
    volume: Vec<f64>,
    /// For each patch the diagonal of its bounding box, model units.
    size: Vec<f64>,
}

impl Patches {
    fn of(soup: &Soup) -> Self {
        let mesh = &soup.mesh;
        let count = soup.patch_count;
        let mut patches = Self {
            at: vec![0; mesh.positions.len()],
            area: vec![0.0; count],
            volume: vec![0.0; count],
            size: Vec::new(),
        };
        let mut bounds: Vec<Option<Bounds>> = vec![None; soup.patch_count];
        for (t, patch) in soup.patch_of.iter().map(|patch| patch.index()).enumerate() {
            let [a, b, c] = mesh.corners(t);
            patches.area[patch] += (b - a).cross(c - a).length() / 2.0;
            patches.volume[patch] += a.dot(b.cross(c));
            mesh.triangles[t].iter().for_each(|&v| patches.at[v as usize] = patch);
            let own = Bounds::of([a, b, c]);
            bounds[patch] = match (bounds[patch].take(), own) {
                (Some(all), Some(own)) => Some(all.union(&own)),
                (all, own) => all.or(own),
            };
        }
        patches.size = bounds.iter().map(|bounds| bounds.as_ref().map_or(0.0, Bounds::diagonal)).collect();
        patches
    }

    /// The patch that a rim is of.
    fn beside(&self, rim: &Rim) -> usize {
        self.at[rim.vertices[0] as usize]
    }

    /// Whether the lids of each patch are a small part of it, and close it so that it faces outwards. Which way round other patches are is for the rays
    /// to find out: winding numbers of several that do not agree say nothing.
    fn hold(&self, mesh: &TriMesh, rims: &[Rim], lids: &[Lid]) -> bool {
        let (mut area, mut volume) = (vec![0.0; self.area.len()], self.volume.clone());
        for (rim, lid) in rims.iter().zip(lids) {
            let patch = self.beside(rim);
            area[patch] += lid.area;
            for triangle in &lid.triangles {
                let [a, b, c] = triangle.map(|v| place(mesh, lid, v));
                volume[patch] += a.dot(b.cross(c));
            }
        }
        let is_held =
            |patch: usize| area[patch] == 0.0 || area[patch] <= MOST_LIDS * self.area[patch] && volume[patch] > 0.0;
        (0..area.len()).all(is_held)
    }
}

/// Where a vertex of a lid is.
fn place(mesh: &TriMesh, lid: &Lid, vertex: u32) -> DVec3 {
    match (vertex as usize).checked_sub(mesh.positions.len()) {
        None => mesh.positions[vertex as usize],
        Some(new) => lid.positions[new],
    }
}

/// Whether winding numbers of the open mesh say that there are holes where the rims are: inside is behind the flat lid of each, and outside in
/// front of it. Of two rims that face each other, as where a ring is missing, the space between them is inside as well.
fn are_holes(around: &Surroundings<'_>, rims: &[Rim], progress: &Progress) -> Result<bool, Stopped> {
    let mesh = around.mesh();
    let tree = WindingTree::new(mesh, 0..mesh.triangles.len(), progress)?;
    let flat = FillOptions { style: Style::Flat, ..FillOptions::default() };
    let is_hole = |rim: &Rim| {
        progress.check()?;
        let Ok(lid) = lid(around, rim, &flat) else { return Ok(false) };
        let at = |v: u32| place(mesh, &lid, v);
        let across = |t: &[u32; 3]| {
            let [a, b, c] = t.map(at);
            (b - a).cross(c - a)
        };
        let largest = lid.triangles.iter().max_by(|a, b| across(a).length().total_cmp(&across(b).length()));
        let Some(triangle) = largest else { return Ok(false) };
        let normal = across(triangle);
        let middle = triangle.map(at).iter().sum::<DVec3>() / 3.0;
        let unit = normal.normalize_or_zero() * (normal.length() / 2.0).sqrt();
        Ok(LOOKS
            .iter()
            .any(|&share| tree.winding(middle - unit * share) > 0.5 && tree.winding(middle + unit * share) < 0.5))
    };
    Ok(rims.par_iter().map(is_hole).collect::<Result<Vec<bool>, Stopped>>()?.into_iter().all(|hole| hole))
}
