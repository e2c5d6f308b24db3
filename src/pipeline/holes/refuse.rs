//! Patches of which lids make no solid.

use super::maker::Made;
use super::patches::{Patches, place};
use crate::fill::Rim;
use crate::mesh::TriMesh;
use crate::pipeline::NotLidded;

/// A patch whose lids have more than this part of its area is a sheet, of which lids would make something that it is not.
const MOST_LIDS: f64 = 0.5;

/// For each patch why its rims have no lids: it is not closed by them so that these are a small part of it and that it faces outwards. Where a patch faces inwards the others have no
/// lids either, see [`beside`].
pub(super) fn refused(
    patches: &Patches,
    mesh: &TriMesh,
    lids: &[(&Rim, &Result<Made, NotLidded>)],
    sign: f64,
) -> Vec<Option<NotLidded>> {
    let (mut area, mut volume) = (vec![0.0; patches.area.len()], patches.volume.clone());
    for &(rim, lid) in lids {
        let patch = patches.beside(rim);
        let Ok(Made { lid, .. }) = lid else {
            // Whatever closes it is at least so large: over a single triangle as large as that.
            area[patch] += rim.area;
            continue;
        };
        area[patch] += lid.area;
        for triangle in &lid.triangles {
            let [a, b, c] = triangle.map(|v| place(mesh, lid, v));
            volume[patch] += a.dot(b.cross(c));
        }
    }
    let mut refused = vec![None; area.len()];
    for &(rim, lid) in lids {
        let patch = patches.beside(rim);
        // With a rim that has no lid the volume says nothing.
        let is_closed = lid.is_ok();
        if area[patch] > MOST_LIDS * patches.area[patch] {
            refused[patch] = Some(NotLidded::Sheet);
        } else if is_closed && volume[patch] * sign <= 0.0 {
            refused[patch] = Some(NotLidded::FacesInwards);
        }
    }
    if refused.contains(&Some(NotLidded::FacesInwards)) {
        refused.iter_mut().for_each(|why| *why = why.or(Some(NotLidded::Beside)));
    }
    refused
}

/// Takes the lids of other patches away, where some patch has none. Which way round that is, and what it is a piece of, is for the rays to find out: winding numbers of several that do not agree say
/// nothing.
pub(super) fn beside(lids: &mut [Result<Made, NotLidded>]) {
    lids.iter_mut().filter(|lid| lid.is_ok()).for_each(|lid| *lid = Err(NotLidded::Beside));
}
