//! `--preset`: a handful of options for those who print, scan or construct.

use clap::ValueEnum;

/// `--preset`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Preset {
    /// For a slicer: millimetres, fine voxels, few triangles
    Print,
    /// For measured surfaces: finer voxels, and no measured point is simplified away
    Scan,
    /// For constructed parts: millimetres, finer voxels, flat faces of few triangles and edges where they were
    Cad,
}

/// A flag and what a preset gives it.
type Setting = (&'static str, &'static str);

impl Preset {
    /// What it sets. A flag is left as it is where it, or one that excludes it, was given.
    pub fn settings(self) -> &'static [Setting] {
        match self {
            Self::Print => &[("unit", "mm"), ("resolution", "384"), ("simplify", "0.02h")],
            Self::Scan => &[("resolution", "512"), ("simplify", "off")],
            Self::Cad => &[("unit", "mm"), ("resolution", "512"), ("simplify", "0.002h")],
        }
    }

    /// As it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Print => "print",
            Self::Scan => "scan",
            Self::Cad => "cad",
        }
    }
}
