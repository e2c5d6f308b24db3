//! What filling one part does to the solid's handles, bodies and chambers.

use glam::IVec3;

use super::fill::{Fill, FilledPart, sides};
use crate::lattice::Lattice;
use crate::mesh::TriMesh;
use crate::mesh::edges::Union;
use crate::morphology::Gauge;

/// What filling one part changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Changes {
    /// Handles that it takes away.
    pub handles: u32,
    /// Shells of the solid that it touches: as many bodies become one.
    pub bodies: usize,
    /// Spaces that its mouths open to; they are parted.
    pub spaces: usize,
}

/// For each triangle the number of its shell.
pub(super) fn shells(mesh: &TriMesh) -> Vec<u32> {
    let mut sets = Union::of_triangles(mesh.positions.len(), mesh.triangles.iter().copied());
    mesh.triangles.iter().map(|t| sets.root(t[0])).collect()
}

/// Bodies, cavities and handles enter the Euler number with signs +, + and −; the voxels give it, the shells beside the
/// part give the first two.
pub(super) fn changes(
    part: &FilledPart,
    fill: &Fill,
    bodies: [&Gauge<'_>; 2],
    shells: [&Vec<u32>; 2],
    lattice: &Lattice,
) -> Changes {
    let near = |which: usize, voxels: &mut dyn Iterator<Item = IVec3>| {
        let at = |voxel: IVec3| bodies[which].distance().at(lattice.to_model(voxel.as_dvec3()));
        let mut found: Vec<u32> =
            voxels.filter_map(at).map(|nearest| shells[which][nearest.triangle as usize]).collect();
        found.sort_unstable();
        found.dedup();
        found.len()
    };
    let walls = part.voxels.iter().copied().filter(|&v| sides(v).any(|v| fill.is_solid(v)));
    let mouths = part.voxels.iter().zip(&part.mouth).filter(|(_, mouth)| **mouth).map(|(&v, _)| v);
    let (touched, spaces) = (near(0, &mut { walls }), near(1, &mut { mouths }));
    let euler = euler_change(part, &|v| fill.is_solid(v));
    let handles = (euler + touched as i64 - spaces as i64).max(0) as u32;
    Changes { handles, bodies: touched, spaces }
}

/// By how much the Euler number of the solid's voxels, joined through faces, grows with the part: voxels less pairs plus
/// squares less cubes.
fn euler_change(part: &FilledPart, solid: &impl Fn(IVec3) -> bool) -> i64 {
    let mut change = 0;
    for (n, &voxel) in (0u32..).zip(&part.voxels) {
        // Each set of voxels counts at the last of its members in the part.
        let inside = |v: IVec3| part.at(v).map_or_else(|| solid(v), |other| other < n);
        change += 1;
        for corner in 0..8 {
            let sign = |bit: i32| 1 - 2 * (corner >> bit & 1);
            let [x, y, z] = [IVec3::X * sign(0), IVec3::Y * sign(1), IVec3::Z * sign(2)];
            let faces = [x, y, z].map(|d| inside(voxel + d));
            let square = |a: usize, b: usize, d: IVec3| faces[a] && faces[b] && inside(voxel + d);
            let squares = [square(1, 2, y + z), square(2, 0, z + x), square(0, 1, x + y)];
            let cube = squares.iter().all(|&s| s) && inside(voxel + x + y + z);
            // Two opposite corners have each of the six pairs once, a square belongs to two corners.
            if corner == 0 || corner == 7 {
                change -= faces.iter().filter(|&&f| f).count() as i64;
            }
            change += (0..3).filter(|&k| squares[k] && sign(k as i32) > 0).count() as i64;
            change -= cube as i64;
        }
    }
    change
}
