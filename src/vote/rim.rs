//! The boundary of an operand, few edges or many.

use glam::DVec3;

use super::boundary::Loops;
use super::loop_tree::{LoopTree, Nearby, cut};
use super::phase::Phase;
use crate::mesh::TriMesh;
use crate::progress::{Progress, Stopped};

/// Up to so many boundary edges are summed one by one. 2048 take 17 µs for each point.
const MOST_EXACT: usize = 2048;

/// Of more, what is this many radii away, its own and the place's together, is far: errors up to 0.0006 where a third of a sphere's triangles
/// are missing; 4 leaves 0.0012.
const FAR: f64 = 5.0;

/// The boundary of one operand, ready to be asked.
#[derive(Debug, Clone)]
pub(super) struct Rim {
    /// None for a closed operand: its winding number is whole everywhere.
    tree: Option<LoopTree>,
    /// Where there are few edges.
    loops: Option<Loops>,
}

/// A rim as seen from near one place.
pub(super) enum View<'r> {
    /// Few edges: exact.
    Short(&'r Loops),
    /// Many: what is far in groups.
    Long(Box<Nearby>),
}

impl Rim {
    /// Of the triangles `range` of `mesh`.
    pub(super) fn new(mesh: &TriMesh, range: std::ops::Range<usize>, progress: &Progress) -> Result<Self, Stopped> {
        let loops = Loops::around(mesh, range, progress)?;
        if loops.edges() == 0 {
            return Ok(Self { tree: None, loops: None });
        }
        if loops.edges() <= MOST_EXACT {
            return Ok(Self { tree: Some(LoopTree::new(&loops, progress)?), loops: Some(loops) });
        }
        Ok(Self { tree: Some(LoopTree::new(&cut(&loops), progress)?), loops: None })
    }

    /// The boundary in groups; `None` for a closed operand.
    pub(super) fn loops(&self) -> Option<&LoopTree> {
        self.tree.as_ref()
    }

    /// Prepares for points within `radius` of `centre`, model units; `None` for a closed operand.
    pub(super) fn view(&self, centre: DVec3, radius: f64) -> Option<View<'_>> {
        match &self.loops {
            Some(loops) => Some(View::Short(loops)),
            None => self.tree.as_ref().map(|tree| View::Long(Box::new(tree.around(centre, radius, FAR)))),
        }
    }
}

impl View<'_> {
    /// The winding number at `p`, model units, but for a whole number.
    pub(super) fn at(&self, p: DVec3) -> Phase {
        match self {
            Self::Short(loops) => loops.phase(p),
            Self::Long(nearby) => nearby.at(p),
        }
    }

    /// [`Phase::above`] alone, which is faster.
    pub(super) fn above(&self, p: DVec3) -> f64 {
        match self {
            Self::Short(loops) => loops.turn(p).above(),
            Self::Long(nearby) => nearby.above(p),
        }
    }
}
