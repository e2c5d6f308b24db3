//! Sheets beside bodies: patches that enclose nothing, as pieces of a scan that float around it. They are left out, so that they do not keep the holes of the bodies from being
//! closed by lids.

use super::Plan;
use super::judge::Judge;
use super::patches::Patches;
use crate::mesh::TriMesh;
use crate::pipeline::NotLidded;
use crate::progress::{Progress, Stopped};

/// Sheets that have more than this part of the area of all patches are not left out: what they are pieces of is for rays and voxels to find out.
const SMALL: f64 = 0.1;

/// For each triangle whether it is of a sheet that is left out; empty where none is. All sheets are left out or none: those that are small, and part no inside from an outside.
/// All other rims must have lids.
pub(super) fn left_out(
    plan: &Plan,
    (patches, judge): (&Patches, &Judge<'_>),
    mesh: &TriMesh,
    progress: &Progress,
) -> Result<Vec<bool>, Stopped> {
    let mut is_sheet = vec![false; patches.area.len()];
    for (rim, lid) in plan.rims.iter().zip(&plan.lids) {
        match lid {
            Err(NotLidded::Sheet) => is_sheet[patches.beside(rim)] = true,
            Err(_) => return Ok(Vec::new()),
            Ok(_) => {}
        }
    }
    let all: f64 = patches.area.iter().sum();
    let own: f64 = patches.area.iter().zip(&is_sheet).filter(|(_, sheet)| **sheet).map(|(area, _)| area).sum();
    if own == 0.0 || own > SMALL * all {
        return Ok(Vec::new());
    }
    let mut out = vec![false; mesh.triangles.len()];
    for (patch, triangles) in patches.triangles.iter().enumerate().filter(|(patch, _)| is_sheet[*patch]) {
        if judge.parts_space(patch, mesh, progress)? {
            return Ok(Vec::new());
        }
        triangles.iter().for_each(|&t| out[t as usize] = true);
    }
    Ok(out)
}
