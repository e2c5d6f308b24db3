//! Values that flags choose from.

use clap::ValueEnum;

use crate::fill::Style;
pub use crate::io::FileFormat as AnyFormat;
use crate::ldi::Inside;
use crate::orient::OrientMode;
use crate::pipeline::{DistanceMethod, DistanceSign, Method, SheetSide};
use crate::vote::VoteRule;

/// `--method` of the verbs that make a solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SolidMethod {
    /// Exactly where the inputs are closed once they are cut where they cross; else from voxels
    Auto,
    /// Exactly, or not at all: inputs with holes are refused
    Exact,
    /// From voxels, apart from what is closed and touches nothing
    Voxel,
}

impl From<SolidMethod> for Method {
    fn from(choice: SolidMethod) -> Self {
        match choice {
            SolidMethod::Auto => Self::Auto,
            SolidMethod::Exact => Self::Exact,
            SolidMethod::Voxel => Self::Voxel,
        }
    }
}

/// `--orient`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum OrientChoice {
    /// Turn triangles so that patches agree and the rays enter before they leave
    Auto,
    /// Trust the file
    Keep,
}

impl From<OrientChoice> for OrientMode {
    fn from(choice: OrientChoice) -> Self {
        match choice {
            OrientChoice::Auto => Self::Auto,
            OrientChoice::Keep => Self::Keep,
        }
    }
}

/// `--inside`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum InsideChoice {
    /// Where the surface winds around at least once: overlaps fuse, what faces inwards takes away
    Positive,
    /// Where it winds around at all, whichever way it faces
    Nonzero,
    /// Where it winds around an odd number of times: every closed surface swaps inside and outside
    Odd,
}

impl From<InsideChoice> for Inside {
    fn from(choice: InsideChoice) -> Self {
        match choice {
            InsideChoice::Positive => Self::Positive,
            InsideChoice::Nonzero => Self::Nonzero,
            InsideChoice::Odd => Self::Odd,
        }
    }
}

/// `--fill`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FillChoice {
    /// Flat where the rim lies in a plane at a sharp edge, or is short; else smooth
    Auto,
    /// As flat as the rim allows
    Flat,
    /// With the curvature of what is around
    Smooth,
    /// Not at all: the result has holes, and the exit status is 3 (`repair` alone)
    None,
}

impl From<FillChoice> for Style {
    fn from(choice: FillChoice) -> Self {
        match choice {
            // What is left open is closed first, so that all else is as it would be.
            FillChoice::Auto | FillChoice::None => Self::Auto,
            FillChoice::Flat => Self::Flat,
            FillChoice::Smooth => Self::Smooth,
        }
    }
}

/// `--vote`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum VoteChoice {
    /// The rays where ten or more balance and agree; elsewhere the winding number
    Winding,
    /// The majority of the rays that balance; where they are few, their halves
    HalfRays,
    /// The majority of the rays that balance
    Majority,
    /// More than half of all 13 rays
    Paper,
}

impl From<VoteChoice> for VoteRule {
    fn from(choice: VoteChoice) -> Self {
        match choice {
            VoteChoice::Winding => Self::Winding,
            VoteChoice::HalfRays => Self::HalfRays,
            VoteChoice::Majority => Self::Majority,
            VoteChoice::Paper => Self::Paper,
        }
    }
}

/// `--method` of `sdf`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodChoice {
    /// To the nearest triangle, exactly
    Exact,
    /// The same for closed surfaces, by a polyhedron for every face, edge and vertex: a reference to compare with
    Characteristics,
    /// The same for closed surfaces, slice by slice from a prism for every triangle
    Prism,
    /// The field that repairs are made from: smooth where the surface is broken, extended by fast marching
    Robust,
}

impl From<MethodChoice> for DistanceMethod {
    fn from(choice: MethodChoice) -> Self {
        match choice {
            MethodChoice::Exact => Self::Exact,
            MethodChoice::Characteristics => Self::Characteristics,
            MethodChoice::Prism => Self::Prism,
            MethodChoice::Robust => Self::Robust,
        }
    }
}

/// `--sign` of `sdf`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SignChoice {
    /// The votes of the rays, as in a repair
    Votes,
    /// The angle-weighted normal at the nearest point, for closed surfaces
    Pseudonormal,
    /// The generalised winding number
    Winding,
    /// The outlines of the surface in planes along z, their gaps closed
    Levels,
}

impl From<SignChoice> for DistanceSign {
    fn from(choice: SignChoice) -> Self {
        match choice {
            SignChoice::Votes => Self::Votes,
            SignChoice::Pseudonormal => Self::Pseudonormal,
            SignChoice::Winding => Self::Winding,
            SignChoice::Levels => Self::Levels,
        }
    }
}

/// `--edges` of `render`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum EdgeChoice {
    /// None
    None,
    /// Those where the surface turns sharply
    Sharp,
    /// All
    All,
}

/// `--projection` of `render`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ProjectionChoice {
    /// Near and far look alike, and lengths can be measured
    Orthographic,
    /// What is farther away looks smaller
    Perspective,
}

/// `--background` of `render`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BackgroundChoice {
    /// Light grey
    Gradient,
    /// White
    White,
    /// None: the picture is clear there
    Transparent,
}

/// `--zoom` of `render`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ZoomChoice {
    /// The largest group of defects
    Defects,
}

/// `--fail-on` of `inspect`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Defect {
    /// Edges with only one triangle
    Open,
    /// Edges or vertices where more than one sheet meets
    Nonmanifold,
    /// Neighbours that disagree about which side is outside
    Inconsistent,
    /// Triangles without area
    Degenerate,
    /// Triangles that are there twice
    Duplicate,
    /// Triangles that cut others
    #[value(name = "self")]
    SelfIntersecting,
    /// A volume below zero
    InsideOut,
    /// Any of these
    Any,
}

/// `--side` of `thicken`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SideChoice {
    /// Half of the thickness on either side
    Both,
    /// Where the triangles' normals point
    Front,
    /// On the other side
    Back,
}

impl From<SideChoice> for SheetSide {
    fn from(choice: SideChoice) -> Self {
        match choice {
            SideChoice::Both => Self::Both,
            SideChoice::Front => Self::Front,
            SideChoice::Back => Self::Back,
        }
    }
}
