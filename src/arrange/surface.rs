//! The exact surface of a solid, before its vertices are rounded.

use glam::DVec3;

use super::draft::{Draft, Kind};
use super::extract::Face;
use super::fine::Fine;
use super::options::ArrangeOptions;
use super::refine::Refined;

/// The surface of a solid to be rounded.
pub(crate) struct Surface<'a> {
    pub(crate) refined: &'a Refined,
    pub(crate) faces: &'a [Face],
    /// What each vertex of the arrangement is.
    pub(crate) kinds: &'a [Kind],
    pub(crate) fine: &'a Fine,
    /// The positions of the input's vertices as the result may have them, model units.
    pub(crate) input: &'a [DVec3],
    pub(crate) options: &'a ArrangeOptions<'a>,
}

impl Surface<'_> {
    /// Marks what may cross: where it is known which triangles of the input touched nothing, those that are still what they were do not cross each
    /// other.
    pub(crate) fn mark(&self, draft: &mut Draft) {
        let suspects = self.options.suspects;
        if suspects.is_empty() {
            return;
        }
        let own = |v: &u32| matches!(draft.kinds[*v as usize], Kind::Own(_));
        let may = |(t, source): (&[u32; 3], &u32)| suspects[*source as usize] || !t.iter().all(own);
        draft.fresh = draft.triangles.iter().zip(&draft.sources).map(may).collect();
    }

    /// The volume before rounding, cubic model units, to about 1e-12 of it.
    pub(super) fn volume(&self) -> f64 {
        let corner = |p: u32| match self.kinds.get(p as usize) {
            Some(&Kind::Own(v)) => self.input[v as usize],
            _ => self.refined.points.approximate(p) * self.fine.step,
        };
        volume(self.faces.iter().map(|face: &Face| face.corners.map(corner)))
    }
}

/// The signed volume that triangles enclose.
pub(super) fn volume(triangles: impl Iterator<Item = [DVec3; 3]> + Clone) -> f64 {
    let Some([origin, ..]) = triangles.clone().next() else { return 0.0 };
    triangles.map(|corners| corners.map(|p| p - origin)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
}
