//! What can go wrong with a graphics processor.

use crate::progress::Stopped;
use crate::sdf::exact::ExactError;

/// Why the graphics processor gave no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// There is no adapter of the kind that was asked for.
    #[error("no graphics adapter {wanted} was found")]
    NoAdapter {
        /// What was asked for, as the end of a sentence.
        wanted: String,
        /// The names of those that are there.
        present: Vec<String>,
    },
    /// The adapter is there, but its driver gives no device.
    #[error("the driver of {adapter} does not open it: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The adapter lacks something that is needed.
    #[error("{adapter} cannot do this: {lacks}")]
    Incapable {
        /// The adapter's name.
        adapter: String,
        /// What it lacks.
        lacks: String,
    },
    /// More memory was needed than the adapter has.
    #[error("the graphics processor has too little memory for this")]
    OutOfMemory,
    /// One ray alone is crossed more often than the adapter's buffers hold.
    #[error("a ray is crossed {crossings} times, and a buffer of the graphics processor holds {most}")]
    TooLarge {
        /// Crossings of the ray.
        crossings: u64,
        /// The most that fit.
        most: u64,
    },
    /// A part of the mesh is farther from the lattice than the device's integers reach.
    #[error(
        "a part of the mesh is more than {most:.1e} voxels from the lattice, farther than the graphics processor counts"
    )]
    Far {
        /// The farthest that it counts, h.
        most: f64,
    },
    /// The features that can be nearest within one brick are more than the adapter's buffers hold.
    #[error(
        "a block of voxels has {features} faces, edges and vertices near it, more than the graphics processor's buffers hold (lists of {most})"
    )]
    Crowded {
        /// Faces, edges and vertices.
        features: u64,
        /// Entries of a list.
        most: u64,
    },
    /// There is no such field.
    #[error(transparent)]
    Field(ExactError),
    /// The driver or wgpu refused a command.
    #[error("the graphics driver refused a command: {reason}")]
    Validation {
        /// What it said.
        reason: String,
    },
    /// The device stopped working, or was taken away.
    #[error("the graphics processor was lost: {reason}")]
    Lost {
        /// What the driver said.
        reason: String,
    },
    /// What came back does not fit what was sent.
    #[error("the graphics processor computed nonsense in direction {direction}: its driver or memory is faulty")]
    Nonsense {
        /// Number of the direction.
        direction: usize,
    },
}

impl From<ExactError> for GpuError {
    fn from(error: ExactError) -> Self {
        match error {
            ExactError::Stopped(stopped) => Self::Stopped(stopped),
            other => Self::Field(other),
        }
    }
}

impl GpuError {
    /// Something to try.
    pub fn hint(&self) -> &'static str {
        match self {
            Self::NoAdapter { present, .. } if present.is_empty() => INSTALL,
            Self::NoAdapter { .. } => "`meshwright devices` lists the adapters that are there",
            Self::Stopped(_) => "more time",
            Self::Far { .. } | Self::Crowded { .. } | Self::Field(_) => "a larger voxel, or --backend cpu",
            Self::OutOfMemory => "a larger voxel, or --backend cpu",
            _ => "--backend cpu gives the same result; a newer graphics driver may help",
        }
    }
}

/// What to install where no adapter is found.
pub const INSTALL: &str = "install a Vulkan driver: that of your graphics card, or the software one (Debian, Ubuntu: \
     mesa-vulkan-drivers; Fedora: mesa-vulkan-drivers; Arch: vulkan-swrast)";
