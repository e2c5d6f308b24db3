//! Bodies, voids and tunnels, before and after.

use serde::{Deserialize, Serialize};

/// What a surface bounds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Topology {
    /// Closed surfaces that face outwards.
    pub bodies: usize,
    /// Closed surfaces that face inwards.
    pub voids: usize,
    /// Handles of all of them.
    pub tunnels: i64,
}

/// A body or void of the operands that the result should have and has not.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LostBody {
    /// Whether it was a void.
    pub void: bool,
    /// The middle of its box, model units.
    pub at: [f64; 3],
    /// The diagonal of its box, model units.
    pub size: f64,
    /// Its volume, cubic model units.
    pub volume: f64,
}

/// How the bodies of the result compare with those that the operands describe.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TopologyReport {
    /// What the operands describe; `None` where they are too torn to tell, or where they cross each other. Bodies that touch count
    /// as one, and holes as closed.
    pub before: Option<Topology>,
    /// What the result has.
    pub after: Topology,
    /// Bodies and voids that are gone, the largest first, 20 at most.
    pub lost: Vec<LostBody>,
    /// How many are gone.
    pub lost_count: usize,
    /// Their part of the volume of all bodies, 0 to 1.
    pub lost_share: f64,
    /// Bodies that touch others, or have holes, and lie inside of the result or outside of it, so that it has no surface of theirs. Those that are closed
    /// and touch nothing are counted in [`StandingReport::left_out`](super::StandingReport::left_out).
    pub buried: usize,
    /// Bodies that touched no other and came out joined with one.
    pub fused: usize,
    /// Pieces into which single bodies came apart, beyond the first of each.
    pub parted: usize,
    /// Of these, pieces smaller than a ten-thousandth of their body.
    pub crumbs: usize,
    /// Tunnels beyond those of the operands, and beyond what crossings and rims that are joined can make; `None` where the operands are too torn to tell.
    pub new_tunnels: Option<i64>,
}

/// More than this part of the bodies lost, fused or come apart, or of the volume lost, or as many tunnels more, is a broken promise.
const LARGE: f64 = 0.1;

const LARGE_VOLUME: f64 = 0.01;

impl TopologyReport {
    /// Whether so much has changed that the result is not what the operands describe.
    pub fn is_large(&self) -> bool {
        let bodies = self.before.map_or(self.after.bodies + self.lost_count, |before| before.bodies + before.voids);
        let handles = self.before.map_or(0, |before| before.tunnels.max(0));
        let changed = self.lost_count + self.fused + self.parted - self.crumbs;
        changed as f64 > LARGE * bodies as f64
            || self.lost_share > LARGE_VOLUME
            || self.new_tunnels.is_some_and(|new| new as f64 > LARGE * (bodies as f64 + handles as f64))
    }
}
