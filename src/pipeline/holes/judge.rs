//! Whether there are holes where rims are, by winding numbers of the open mesh.

use glam::DVec3;

use super::patches::{Patches, place};
use crate::fill::{FillOptions, Rim, Style, Surroundings, lid};
use crate::orient::OrientMode;
use crate::progress::{Progress, Stopped};
use crate::survey::Soup;
use crate::vote::WindingTree;

/// How far before and behind a lid winding numbers are looked at, as parts of the width of its largest triangle: near it other holes matter little, and
/// farther away it matters little how the lid runs. One look that says that there is a hole suffices; between rims that face each other none does.
const LOOKS: [f64; 3] = [0.125, 0.25, 0.5];

/// From this winding number of all other patches on a place lies inside of these: what is open there is open inside of another body. Between two halves of a torn body it is about a half.
const WITHIN: f64 = 0.75;

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

    /// Whether there is a hole where a rim is: inside is behind the flat lid over it, and outside in front of it, or the inside of another body on both sides. Of two rims
    /// that face each other, as where a ring is missing, the space between them is inside as well.
    pub(super) fn is_hole(&self, rim: &Rim, progress: &Progress) -> Result<bool, Stopped> {
        progress.check()?;
        let mesh = self.around.mesh();
        let flat = FillOptions { style: Style::Flat, ..FillOptions::default() };
        let Ok(lid) = lid(self.around, rim, &flat) else { return Ok(false) };
        let at = |v: u32| place(mesh, &lid, v);
        let across = |t: &[u32; 3]| {
            let [a, b, c] = t.map(at);
            (b - a).cross(c - a)
        };
        let largest = lid.triangles.iter().max_by(|a, b| across(a).length().total_cmp(&across(b).length()));
        let Some(triangle) = largest else { return Ok(false) };
        let normal = across(triangle) * self.sign;
        let middle = triangle.map(at).iter().sum::<DVec3>() / 3.0;
        let unit = normal.normalize_or_zero() * (normal.length() / 2.0).sqrt();
        Ok(LOOKS.iter().any(|&share| self.parts(rim, middle - unit * share, middle + unit * share)))
    }

    /// Whether the solid is behind a rim, and not in front of it but for another body.
    fn parts(&self, rim: &Rim, behind: DVec3, front: DVec3) -> bool {
        let all = [behind, front].map(|at| self.sign * self.all.winding(at));
        let own = [behind, front].map(|at| self.own(rim, at));
        let parted = own[0] > 0.5 && own[1] < 0.5;
        let within = all[0] - own[0] > WITHIN && all[1] - own[1] > WITHIN;
        parted && all[0] > 0.5 && (all[1] < 0.5 || within)
    }
}
