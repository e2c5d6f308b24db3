//! Cleaning and orientation of the soup: exact repetitions go, each edge-connected patch becomes
//! consistent, and the rays of the LDIs decide which of its sides is outside.

mod clean;
mod patches;
mod sides;

pub use clean::{Cleaned, clean};
pub use patches::{PatchId, Patches, orient_patches};
pub use sides::orient_sides;

use serde::{Deserialize, Serialize};

/// What is done about the orientation of the input's triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum OrientMode {
    /// Make each edge-connected patch consistent and decide its side by the LDIs.
    #[default]
    Auto,
    /// Take the triangles as they are: the file is trusted.
    Keep,
}

/// What cleaning and orientation did.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OrientReport {
    /// Triangles that were dropped because they have no area or a repeated vertex.
    pub degenerate_dropped: usize,
    /// Triangles that were dropped because they repeat another one.
    pub duplicates_dropped: usize,
    /// Triangles that were present in both orientations; one copy was kept.
    pub both_sided: usize,
    /// Edge-connected patches.
    pub patches: usize,
    /// Triangles turned over to agree with the rest of their patch.
    pub flipped_in_patches: usize,
    /// Patches turned over as a whole, by the vote of the rays or, where they are shells that stand as they are, by winding numbers.
    pub flipped_patches: usize,
    /// Triangles in the patches that were turned over as a whole.
    pub flipped_by_rays: usize,
}
