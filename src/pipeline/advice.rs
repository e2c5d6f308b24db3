//! What kind of trouble an error is, and what to try: the same questions for the errors of all pipelines.

use super::{
    BlockError, BooleanError, CanalError, DistanceError, FieldError, HollowError, LimitError, MorphologyError,
    NothingEnclosed, OuterError, ThickenError, ThicknessError,
};
use crate::arrange::ArrangeError;
use crate::field::FillError;
use crate::field::language::BuildError;
use crate::mesh::NotSolid;
use crate::outer::ReachError;
use crate::progress::Stopped;

/// What kind of trouble an error is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trouble<'a> {
    /// The caller stopped it, or its deadline passed.
    Stopped(Stopped),
    /// The options ask for what cannot be; other ones can.
    Options,
    /// The voxel size does not go with the coordinates.
    Voxel,
    /// The input cannot be taken.
    Input,
    /// The result would enclose nothing.
    Nothing(&'a NothingEnclosed),
    /// Nothing of a solid is left.
    NothingLeft {
        /// The solid is nowhere thicker than this, model units; `None` where it is not that.
        thinner_than: Option<f64>,
    },
    /// What is left of a solid is thinner than the voxels.
    TooThin {
        /// The smallest voxel that was tried, model units.
        voxel: f64,
    },
    /// More triangles or crossings than can be numbered.
    TooMany,
    /// A closed surface is needed, and this is none.
    NotClosed {
        /// What is wrong with it, a sentence.
        problem: &'a str,
    },
    /// An operand has no triangle with an area.
    Empty {
        /// Its number, from 0.
        operand: usize,
    },
    /// A mesh that the caller made refers to vertices that it does not have.
    Index,
    /// More memory would be needed than allowed.
    Memory(&'a LimitError),
    /// What was asked for cannot be promised of this input.
    Unkept,
    /// There is no memory left.
    NoRoom,
    /// The graphics processor cannot do it.
    Device,
    /// An exact result was asked for, and there is none.
    NotExact(&'a ArrangeError),
    /// What was made is not valid.
    NotSolid(&'a NotSolid),
    /// The caller contradicts itself: the expression names what was not given.
    Call,
}

/// The errors of all pipelines answer these.
pub trait Advice: std::error::Error {
    /// What kind of trouble it is.
    fn trouble(&self) -> Trouble<'_>;

    /// Something to try, where the sentence of the error does not say it.
    fn hint(&self) -> Option<String> {
        None
    }
}

impl Advice for LimitError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Memory { .. } => Trouble::Memory(self),
            Self::Triangles { .. } | Self::Crossings { .. } => Trouble::TooMany,
        }
    }
}

impl Advice for BooleanError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Stopped(stopped) => Trouble::Stopped(*stopped),
            Self::Empty { operand } => Trouble::Empty { operand: *operand },
            Self::MissingOperand { .. } => Trouble::Call,
            Self::Index { .. } | Self::NotFinite { .. } => Trouble::Index,
            Self::Lattice(_) => Trouble::Voxel,
            Self::Limit(limit) => limit.trouble(),
            Self::Nothing(why) => Trouble::Nothing(why),
            Self::NotExact(why) => Trouble::NotExact(why),
            Self::Device { .. } => Trouble::Device,
            Self::NotSolid(what) => Trouble::NotSolid(what),
        }
    }

    fn hint(&self) -> Option<String> {
        match self {
            Self::Device { hint, .. } => Some(hint.clone()),
            Self::NotExact(ArrangeError::Open { .. }) => Some("--method auto closes what is open, with voxels".into()),
            Self::NotExact(_) => Some("--method auto does it with voxels".into()),
            _ => None,
        }
    }
}

impl Advice for MorphologyError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Stopped(stopped) => Trouble::Stopped(*stopped),
            Self::Radius { .. } => Trouble::Options,
            Self::Lattice(_) | Self::Distance(_) => Trouble::Voxel,
            Self::Limit(limit) => limit.trouble(),
            Self::Index(_) => Trouble::Index,
            Self::NothingLeft { thinner_than } => Trouble::NothingLeft { thinner_than: *thinner_than },
            Self::AllTooThin { voxel } => Trouble::TooThin { voxel: *voxel },
            Self::NotSolid(what) => Trouble::NotSolid(what),
        }
    }
}

impl Advice for CanalError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Closing(error) => error.trouble(),
            Self::Missing { .. } => Trouble::Options,
        }
    }

    fn hint(&self) -> Option<String> {
        matches!(self, Self::Missing { .. }).then(|| "without --remove they are listed with their numbers".into())
    }
}

impl Advice for ThickenError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::WallsForVoxel { .. } | Self::WallsForModel { .. } => Trouble::Options,
            Self::Empty => Trouble::Empty { operand: 0 },
            Self::Index(_) => Trouble::Index,
            Self::Offset(error) => error.trouble(),
            Self::Union(error) => error.trouble(),
        }
    }
}

impl Advice for HollowError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Stopped(stopped) => Trouble::Stopped(*stopped),
            Self::TooThin { .. } | Self::Drain { .. } => Trouble::Options,
            Self::NoCavity { .. } => Trouble::Input,
            Self::Erosion(error) => error.trouble(),
            Self::Difference(error) => error.trouble(),
        }
    }

    fn hint(&self) -> Option<String> {
        matches!(self, Self::Drain { .. }).then(|| "another point for it, or a thinner wall".into())
    }
}

impl Advice for DistanceError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Stopped(stopped) => Trouble::Stopped(*stopped),
            Self::Empty => Trouble::Empty { operand: 0 },
            Self::Index(_) => Trouble::Index,
            Self::Lattice(_) | Self::Exact(_) => Trouble::Voxel,
            Self::Limit(limit) => limit.trouble(),
            Self::NotClosed { problem, .. } => Trouble::NotClosed { problem },
            Self::Planes { .. } => Trouble::Options,
            Self::Levels(_) => Trouble::NoRoom,
            Self::Nothing(why) => Trouble::Nothing(why),
            Self::Device { .. } => Trouble::Device,
        }
    }

    fn hint(&self) -> Option<String> {
        match self {
            Self::Device { hint, .. } => Some(hint.clone()),
            Self::NotClosed { .. } => Some("repair it first (`meshwright repair`), or --method exact".into()),
            _ => None,
        }
    }
}

impl Advice for BuildError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Stopped(stopped) | Self::Fill(FillError::Stopped(stopped)) => Trouble::Stopped(*stopped),
            Self::Fill(FillError::Memory { .. }) => Trouble::NoRoom,
            Self::Lattice { .. } => Trouble::Voxel,
            Self::Filter(_) | Self::Ramp { .. } => Trouble::Options,
            Self::Incomplete { .. } => Trouble::Call,
            Self::Endless | Self::Nothing | Self::NoSize | Self::NoRadius | Self::NoBox => Trouble::Input,
        }
    }
}

impl Advice for FieldError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Stopped(stopped) => Trouble::Stopped(*stopped),
            Self::Lattice(_) => Trouble::Voxel,
            Self::Limit(limit) => limit.trouble(),
            Self::Build(error) => error.trouble(),
            Self::Index(_) => Trouble::Index,
            Self::Repair(error) => error.trouble(),
            Self::Distance(error) => error.trouble(),
            Self::NotSolid(what) => Trouble::NotSolid(what),
            Self::NothingOnLattice => Trouble::Input,
        }
    }

    fn hint(&self) -> Option<String> {
        match self {
            Self::Repair(error) => error.hint(),
            Self::Distance(error) => error.hint(),
            _ => None,
        }
    }
}

impl Advice for ThicknessError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Stopped(stopped) => Trouble::Stopped(*stopped),
            Self::Empty => Trouble::Empty { operand: 0 },
            Self::Index(_) => Trouble::Index,
            Self::Lattice(_) => Trouble::Voxel,
            Self::Limit(limit) => limit.trouble(),
        }
    }
}

impl Advice for BlockError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Depth { .. } | Self::Through { .. } => Trouble::Options,
            Self::Closed | Self::Upright { .. } => Trouble::Input,
            Self::Boolean(error) => error.trouble(),
        }
    }

    fn hint(&self) -> Option<String> {
        match self {
            Self::Upright { .. } => {
                Some("name another axis, such as --base x=0, or take the part out of the file".into())
            }
            Self::Boolean(error) => error.hint(),
            _ => None,
        }
    }
}

impl Advice for OuterError {
    fn trouble(&self) -> Trouble<'_> {
        match self {
            Self::Reach(ReachError::Stopped(stopped)) => Trouble::Stopped(*stopped),
            Self::Reach(ReachError::Empty) => Trouble::Empty { operand: 0 },
            Self::Reach(ReachError::Ball { .. }) => Trouble::Options,
            Self::Reach(ReachError::Memory { .. }) => Trouble::NoRoom,
            Self::Sheets { .. } => Trouble::Unkept,
            Self::Cut(error) => Trouble::NotExact(error),
            Self::Boolean(error) => error.trouble(),
            Self::Thicken(error) => error.trouble(),
        }
    }

    fn hint(&self) -> Option<String> {
        match self {
            Self::Sheets { .. } => Some(
                "--thickness LEN makes walls of them; a larger ball, --outer LEN, does not pass holes that are narrower than it"
                    .into(),
            ),
            Self::Boolean(error) => error.hint(),
            Self::Thicken(error) => error.hint(),
            _ => None,
        }
    }
}

impl<A: Advice + ?Sized> Advice for &A {
    fn trouble(&self) -> Trouble<'_> {
        (**self).trouble()
    }

    fn hint(&self) -> Option<String> {
        (**self).hint()
    }
}
