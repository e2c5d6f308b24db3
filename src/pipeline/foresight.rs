//! What a repair would do about a mesh, as far as that is known before it is run.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::ahead::Ahead;
use super::frame::Frame;
use super::{BooleanError, HoleReport, Options, Plan, StandingReport, plan, sizing};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use crate::zip::ZipReport;

/// What [`repair`](super::repair) would do about a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Foresight {
    /// What it would cost, and which way it would go.
    pub plan: Plan,
    /// What would stay as it is.
    pub standing: StandingReport,
    /// What would be done to close cracks; `None` where none can be closed.
    pub zip: Option<ZipReport>,
    /// The holes that are left then, the longest rim first, and what would close each; none where what crosses closes once it is cut.
    pub holes: Vec<HoleReport>,
    /// For each hole the vertices of the mesh that lie on its rim, ascending. Of vertices at one place all are there.
    pub rims: Vec<Vec<u32>>,
}

impl Foresight {
    /// Whether some surface would be made from voxels.
    pub fn has_voxels(&self) -> bool {
        !self.plan.exact && self.plan.dims != [0; 3]
    }
}

/// Looks at what a repair would do. A run may end in another way: what is cut is not cut here, and no ray is cast.
///
/// # Errors
/// Those that the run would have before anything is made.
pub fn foresee(mesh: &TriMesh, options: &Options, progress: &Progress) -> Result<Foresight, BooleanError> {
    BooleanError::check(0, mesh)?;
    let frame = Frame::of(&[mesh], &options.surface());
    let local = frame.local(mesh);
    let bounds = sizing::bounds([&*local]).map_err(|operand| BooleanError::Empty { operand })?;
    let h = sizing::spacing(&bounds, options.voxel)?;
    let ahead = Ahead::of(&[&local], options, progress)?;
    let plan = plan::seen(&[&local], &ahead, options, h)?;
    let mut holes = ahead.holes.reports();
    holes.iter_mut().for_each(|hole| frame.place(&mut hole.centre));
    let rims = on_rims(&local, &ahead);
    Ok(Foresight { plan, standing: ahead.standing, zip: ahead.zip, holes, rims })
}

/// For each rim the vertices of `mesh` that are where one of its own is.
fn on_rims(mesh: &TriMesh, ahead: &Ahead) -> Vec<Vec<u32>> {
    // Minus nought and nought are one.
    let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut at: FxHashMap<[u64; 3], Vec<u32>> = FxHashMap::default();
    for (n, rim) in (0u32..).zip(ahead.holes.rims()) {
        for &v in &rim.vertices {
            at.entry(key(ahead.rest.positions[v as usize])).or_default().push(n);
        }
    }
    let mut on = vec![Vec::new(); ahead.holes.rims().len()];
    for (v, &p) in (0u32..).zip(&mesh.positions) {
        at.get(&key(p)).into_iter().flatten().for_each(|&n| on[n as usize].push(v));
    }
    on
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{VoxelSize, plan, repair};

    #[test]
    fn what_is_foreseen_is_what_is_planned_and_done() {
        for (name, voxels) in [
            ("open_cube.off", false),
            ("cracked_ball.stl", true),
            ("overlapping_boxes.obj", false),
            ("torus.ply", false),
        ] {
            let mesh = crate::io::read(format!("testdata/{name}")).expect("our own").mesh.welded();
            let options = Options::new(VoxelSize::Along(32));
            let seen = foresee(&mesh, &options, &Progress::none()).expect(name);
            assert_eq!(seen.plan, plan([&mesh], &options).expect(name), "{name}");
            assert_eq!(seen.has_voxels(), voxels, "{name}");
            let done = repair(&mesh, &options, &Progress::none()).expect(name).report;
            assert_eq!(done.lattice, voxels, "{name}");
            assert_eq!(seen.holes, done.holes, "{name}");
            assert_eq!(seen.standing, done.standing, "{name}");
            assert_eq!(seen.zip, done.zip, "{name}");
            assert_eq!(seen.rims.len(), seen.holes.len());
            for (hole, rim) in seen.holes.iter().zip(&seen.rims) {
                assert!(rim.len() <= hole.edges && rim.is_sorted(), "{name}: {rim:?}");
            }
        }
    }
}
