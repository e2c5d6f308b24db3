//! How a distance is found, and with what sign.

use serde::Serialize;

use crate::backend::Backend;
use crate::ldi::Inside;
use crate::mesh::Validity;
use crate::orient::OrientMode;
use crate::pipeline::VoxelSize;

/// How the distance is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum DistanceMethod {
    /// To the nearest triangle, exactly.
    Exact,
    /// The same by characteristics and scan conversion: for closed, oriented meshes and
    /// [`DistanceSign::Pseudonormal`] only. A reference to compare with.
    Characteristics,
    /// The same by scan conversion of a prism for every triangle: for closed, oriented meshes and
    /// [`DistanceSign::Pseudonormal`] only.
    Prism,
    /// The pipelines' own field: smooth where the surface is broken, extended by fast marching.
    Robust,
}

/// What tells inside from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum DistanceSign {
    /// The pseudonormal at the nearest point of the mesh as it is: for closed, oriented ones.
    Pseudonormal,
    /// The votes of the rays, after cleaning and orientation: for soups.
    Votes,
    /// The generalised winding number, after cleaning and orientation.
    Winding,
    /// The slice contours of the surface in the lattice's planes along z, gaps closed, after cleaning and orientation.
    Levels,
}

impl DistanceMethod {
    /// As people call it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Exact => "exact distance",
            Self::Characteristics => "characteristics",
            Self::Prism => "prisms",
            Self::Robust => "votes",
        }
    }

    /// Whether it is for closed, oriented surfaces only.
    pub fn is_for_closed(self) -> bool {
        matches!(self, Self::Characteristics | Self::Prism)
    }
}

impl DistanceSign {
    /// The sign that suits a mesh of this state: pseudonormals where they are exact, votes where the mesh is a soup, or where several
    /// bodies may mean something else by a rule of their own.
    pub fn suited(validity: &Validity, method: DistanceMethod, inside: Inside) -> Self {
        let faces = inside.needs_outward() || validity.bodies == 1;
        let exact = validity.is_valid() && faces && method == DistanceMethod::Exact;
        if exact || method.is_for_closed() { Self::Pseudonormal } else { Self::Votes }
    }
}

/// Options of [`distance`](super::distance).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistanceOptions {
    /// Spacing of the lattice.
    pub voxel: VoxelSize,
    /// How far from the surface the field is filled, model units; `None`: the whole lattice.
    pub band: Option<f64>,
    /// How the distance is found.
    pub method: DistanceMethod,
    /// What tells inside from outside; [`DistanceMethod::Robust`] goes by the votes always,
    /// [`DistanceMethod::Characteristics`] and [`DistanceMethod::Prism`] by pseudonormals.
    pub sign: DistanceSign,
    /// Some planes of z of the lattice alone, from the first on and before the second: the values are those of the whole, to the last bit. The first is a
    /// multiple of eight. For [`DistanceMethod::Exact`] on the main processor only; `None`: all.
    pub planes: Option<[u32; 2]>,
    /// Which processor makes the exact field; the others are made by the main one.
    pub backend: Backend,
    /// Orientation of the input, unless the sign is by pseudonormals.
    pub orient: OrientMode,
    /// Which winding numbers are inside, unless the sign is by pseudonormals.
    pub inside: Inside,
    /// Upper bound for the working memory, bytes; `None`: no bound.
    pub max_memory: Option<u64>,
}

impl DistanceOptions {
    /// The exact distance over the whole lattice, with votes for the sign: right for any mesh. [`DistanceSign::suited`] chooses what is faster
    /// where it is right as well.
    pub fn new(voxel: VoxelSize) -> Self {
        Self {
            voxel,
            band: None,
            method: DistanceMethod::Exact,
            sign: DistanceSign::Votes,
            planes: None,
            backend: Backend::default(),
            orient: OrientMode::Auto,
            inside: Inside::default(),
            max_memory: None,
        }
    }

    /// Whether rays vote.
    pub(super) fn votes(&self) -> bool {
        match self.method {
            DistanceMethod::Exact => self.sign != DistanceSign::Pseudonormal,
            DistanceMethod::Characteristics | DistanceMethod::Prism => false,
            DistanceMethod::Robust => true,
        }
    }
}
