//! Whether there are holes where rims are, by winding numbers of the open mesh.

use glam::DVec3;

use super::patches::{Patches, place};
use crate::fill::{FillOptions, Lid, Rim, Style, Surroundings, is_gap_in_plane, lid};
use crate::mesh::TriMesh;
use crate::orient::OrientMode;
use crate::progress::{Progress, Stopped};
use crate::survey::Soup;
use crate::vote::WindingTree;

/// How far before and behind the triangles of a lid winding numbers are looked at, as parts of the rim's diameter, or of the gap that a band closes: near it other holes matter little, and
/// farther away it matters little how the lid runs. One look at a triangle that says that there is a hole suffices; between rims that face each other none does.
const LOOKS: [f64; 3] = [0.1, 0.2, 0.4];

/// Over so much of a lid's area there has to be a hole: where a rim is bent, the flat lid over it runs through the body in part, or in front of it.
pub(super) const ENOUGH: f64 = 0.2;

/// Over less of it the lid is in doubt, and gives way to a band between two rims that face each other; a band has to part inside and outside over more: between rims that do not belong
/// together it runs through the inside or the outside for the most part. The flat lids at a ring torn by a quarter of its tube's width part them over a fifth of their area, by a half over four fifths.
pub(super) const MOST: f64 = 0.5;

/// From this winding number of all other patches on a place lies inside of these: what is open there is open inside of another body. Between two halves of a torn body it is about a half.
const WITHIN: f64 = 0.75;

/// How far before and behind the triangles of a sheet winding numbers are looked at, as a part of its width, and at most how many of them.
const ASIDE: f64 = 0.02;
const SAMPLED: usize = 256;

/// What parts inside and outside over more of its area is no sheet that may be left out.
const FEW: f64 = 0.05;

/// Winding numbers of all patches, and of each one that has a rim.
pub(super) struct Judge<'a> {
    around: &'a Surroundings<'a>,
    patches: &'a Patches,
    all: WindingTree,
    /// For each patch its own tree, where it has a rim and is not the only one.
    own: Vec<Option<WindingTree>>,
    /// What winding numbers are multiplied by: −1 where the one patch that there is faces inwards and may be turned over.
    pub sign: f64,
}

impl<'a> Judge<'a> {
    pub(super) fn new(
        around: &'a Surroundings<'a>,
        soup: &Soup,
        (patches, rims): (&'a Patches, &[Rim]),
        orient: OrientMode,
        progress: &Progress,
    ) -> Result<Self, Stopped> {
        let mesh = &soup.mesh;
        let all = WindingTree::new(mesh, 0..mesh.triangles.len(), progress)?;
        let mut own = Vec::new();
        own.resize_with(patches.triangles.len(), || None);
        let filled = patches.triangles.iter().filter(|list| !list.is_empty()).count();
        if filled > 1 {
            for rim in rims {
                let patch = patches.beside(rim);
                if own[patch].is_none() {
                    let part = mesh.submesh(&patches.triangles[patch]).mesh;
                    own[patch] = Some(WindingTree::new(&part, 0..part.triangles.len(), progress)?);
                }
            }
        }
        let turned = filled == 1
            && orient == OrientMode::Auto
            && rims.first().is_some_and(|rim| patches.volume(patches.beside(rim), mesh, rims) < 0.0);
        Ok(Self { around, patches, all, own, sign: if turned { -1.0 } else { 1.0 } })
    }

    /// The winding number of the patch that a rim is of.
    pub(super) fn own(&self, rim: &Rim, at: DVec3) -> f64 {
        self.sign * self.own[self.patches.beside(rim)].as_ref().unwrap_or(&self.all).winding(at)
    }

    /// Over which part of the flat lid over a rim inside is behind it and outside in front of it, or the inside of another body on both sides; see [`ENOUGH`]. Of two rims that face each
    /// other, as where a ring is missing, the space between them is inside as well. Where a piece of a flat side is missing that is known without: 1.
    pub(super) fn hole(&self, rim: &Rim, progress: &Progress) -> Result<f64, Stopped> {
        if is_gap_in_plane(self.around, rim) {
            return Ok(1.0);
        }
        let flat = FillOptions { style: Style::Flat, ..FillOptions::default() };
        let Ok(lid) = lid(self.around, rim, &flat) else { return Ok(0.0) };
        self.parting(&[&lid], rim.diameter, &|at| self.own(rim, at), progress)
    }

    /// Over which part of its area a band between two rims parts inside and outside. `gap`: how far the rims are from each other, model units.
    pub(super) fn band(&self, rims: [&Rim; 2], lids: &[Lid; 2], gap: f64, progress: &Progress) -> Result<f64, Stopped> {
        let several = self.patches.beside(rims[0]) != self.patches.beside(rims[1]);
        let own = |at| self.own(rims[0], at) + if several { self.own(rims[1], at) } else { 0.0 };
        self.parting(&[&lids[0], &lids[1]], gap, &own, progress)
    }

    /// Whether an open patch has inside on one side and outside on the other, as all patches have it: a single sheet has neither, its winding numbers are about ½ on both sides.
    pub(super) fn parts_space(&self, patch: usize, mesh: &TriMesh, progress: &Progress) -> Result<bool, Stopped> {
        let triangles = &self.patches.triangles[patch];
        let away = ASIDE * self.patches.size(patch);
        let (mut all, mut parting) = (0.0, 0.0);
        for &t in triangles.iter().step_by(triangles.len().div_ceil(SAMPLED)) {
            progress.check()?;
            let [a, b, c] = mesh.corners(t as usize);
            let across = (b - a).cross(c - a);
            let (middle, aside) = ((a + b + c) / 3.0, across.normalize_or_zero() * away);
            let sides = [middle - aside, middle + aside].map(|at| self.all.winding(at).abs());
            all += across.length();
            if sides[0].max(sides[1]) > WITHIN && sides[0].min(sides[1]) < 1.0 - WITHIN {
                parting += across.length();
            }
        }
        Ok(parting > FEW * all)
    }

    /// Over which part of their area lids part inside and outside. `width`: how far apart is what they close, model units; `own`: the winding number of what they are of.
    fn parting(
        &self,
        lids: &[&Lid],
        width: f64,
        own: &dyn Fn(DVec3) -> f64,
        progress: &Progress,
    ) -> Result<f64, Stopped> {
        let mesh = self.around.mesh();
        let (mut all, mut parting) = (0.0, 0.0);
        for (lid, corners) in lids.iter().flat_map(|lid| lid.triangles.iter().map(move |corners| (lid, corners))) {
            progress.check()?;
            let [a, b, c] = corners.map(|v| place(mesh, lid, v));
            let across = (b - a).cross(c - a);
            let (middle, unit) = ((a + b + c) / 3.0, across.normalize_or_zero() * (self.sign * width));
            all += across.length();
            if LOOKS.iter().any(|&share| self.parts(own, middle - unit * share, middle + unit * share)) {
                parting += across.length();
            }
        }
        Ok(if all > 0.0 { parting / all } else { 0.0 })
    }

    /// Whether the solid is behind a rim, and not in front of it but for another body.
    fn parts(&self, own: &dyn Fn(DVec3) -> f64, behind: DVec3, front: DVec3) -> bool {
        let all = [behind, front].map(|at| self.sign * self.all.winding(at));
        let own = [behind, front].map(own);
        let parted = own[0] > 0.5 && own[1] < 0.5;
        let within = all[0] - own[0] > WITHIN && all[1] - own[1] > WITHIN;
        parted && all[0] > 0.5 && (all[1] < 0.5 || within)
    }
}
