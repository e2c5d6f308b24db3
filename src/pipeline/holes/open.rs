//! Holes that are left open after all.

use crate::mesh::TriMesh;
use crate::pipeline::{HoleClosing, HoleReport, Outcome, TriangleSource};

/// A mesh of which some holes are open again, so that it is no solid.
#[derive(Debug, Clone)]
pub struct Opened {
    /// What is left: the vertices of the solid that are still used, and its triangles, in their order.
    pub mesh: TriMesh,
    /// The numbers of these triangles in the solid.
    pub triangles: Vec<u32>,
}

/// Why holes cannot be left open.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotOpened {
    /// There is no hole with this number.
    #[error("there is no hole {number}: {}", counted(*.count))]
    NoHole {
        /// The number that was asked for.
        number: usize,
        /// How many holes there are.
        count: usize,
    },
    /// Of holes that are closed from voxels it is not known which surface closes which of them.
    #[error(
        "holes {} are closed from voxels together, and only all of them can be left open; hole {stays} is to be closed",
        listed(.together)
    )]
    Together {
        /// The numbers of these holes.
        together: Vec<usize>,
        /// One that is not to be left open.
        stays: usize,
    },
}

fn counted(count: usize) -> String {
    match count {
        0 => "the mesh has none that is closed by itself".into(),
        1 => "the mesh has one".into(),
        count => format!("the mesh has {count}"),
    }
}

fn listed(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

impl Outcome {
    /// What is left of the solid of one operand without what closes some of its holes, and notes in the report that these are open. `leave`: their numbers, see
    /// [`HoleReport::number`](super::HoleReport::number). Of two that are joined both are left open.
    ///
    /// # Errors
    /// [`NotOpened`] where a number is that of no hole, or where some of the holes that voxels close would stay closed.
    pub fn open(&mut self, leave: &[usize]) -> Result<Opened, NotOpened> {
        let holes = &self.report.holes;
        if let Some(&number) = leave.iter().find(|&&number| !holes.iter().any(|hole| hole.number == number)) {
            return Err(NotOpened::NoHole { number, count: holes.len() });
        }
        let joined = holes.iter().filter(|hole| leave.contains(&hole.number)).filter_map(|hole| hole.joined_with);
        let leave: Vec<usize> = leave.iter().copied().chain(joined).collect();
        let of_voxels = holes.iter().filter(|hole| matches!(hole.closed_by, HoleClosing::Voxels(_)));
        let (left, stay): (Vec<usize>, Vec<usize>) = of_voxels.map(|hole| hole.number).partition(|n| leave.contains(n));
        if let (false, Some(&stays)) = (left.is_empty(), stay.first()) {
            let mut together = [left, stay].concat();
            together.sort_unstable();
            return Err(NotOpened::Together { together, stays });
        }
        let goes = |source: &TriangleSource| match *source {
            TriangleSource::Operand { .. } => false,
            TriangleSource::Lid { hole, .. } => leave.contains(&(hole as usize)),
            TriangleSource::Closed => !left.is_empty(),
        };
        Ok(self.without(goes, |hole| leave.contains(&hole.number)))
    }

    /// What is left of the solid without all that no triangle of an operand is under: all holes are left open.
    pub fn open_all(&mut self) -> Opened {
        self.without(|source| source.is_made_up(), |_| true)
    }

    fn without(&mut self, goes: impl Fn(&TriangleSource) -> bool, leave: impl Fn(&&mut HoleReport) -> bool) -> Opened {
        let is_there = |hole: &&mut HoleReport| hole.closed_by != HoleClosing::LeftOut;
        for hole in self.report.holes.iter_mut().filter(leave).filter(is_there) {
            (hole.closed_by, hole.triangles, hole.area) = (HoleClosing::LeftOpen, 0, 0.0);
        }
        // Whatever was left open before: of that the solid knows nothing.
        let left = self.sources.iter().filter(|source| source.is_made_up() && !goes(source)).count();
        (self.report.triangles.made_up, self.report.closed_triangles) = (left, left);
        let numbers = (0u32..).zip(&self.sources);
        let triangles: Vec<u32> = numbers.filter(|(_, source)| !goes(source)).map(|(t, _)| t).collect();
        Opened { mesh: self.solid.submesh(&triangles).mesh, triangles }
    }
}
