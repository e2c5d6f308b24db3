//! Reports of operands that were made whole one by one, as one report.

use super::{Dropped, LdiReport, Report, StandingReport, ThinReport, TopologyReport};
use crate::fit::FitReport;
use crate::vote::VoteReport;
use crate::zip::ZipReport;

impl Report {
    /// This and the report of another operand, but for what was done to either. Sizes of lattices are those of this one.
    pub(crate) fn with(mut self, other: Self) -> Self {
        self.lattice |= other.lattice;
        self.standing = self.standing.with(other.standing);
        self.topology = both(self.topology, other.topology, TopologyReport::with);
        self.ldi = self.ldi.with(other.ldi);
        self.vote = with_votes(self.vote, other.vote);
        self.thin = self.thin.with(other.thin);
        self.fit = both(self.fit, other.fit, with_fit);
        self.crumbs = Dropped::and(self.crumbs, other.crumbs);
        self.zip = both(self.zip, other.zip, ZipReport::with);
        self.cut += other.cut;
        self.holes.extend(other.holes);
        self.closed_triangles += other.closed_triangles;
        self.warnings.extend(other.warnings);
        self
    }
}

/// Both together, or the one that there is.
fn both<T>(one: Option<T>, two: Option<T>, with: impl FnOnce(T, T) -> T) -> Option<T> {
    match (one, two) {
        (Some(one), Some(two)) => Some(with(one, two)),
        (one, two) => one.or(two),
    }
}

impl StandingReport {
    fn with(self, other: Self) -> Self {
        Self {
            shells: self.shells + other.shells,
            triangles: self.triangles + other.triangles,
            left_out: self.left_out + other.left_out,
            turned: self.turned + other.turned,
        }
    }
}

impl TopologyReport {
    /// What was lost of both; the bodies that either has are not those of the two together.
    fn with(mut self, other: Self) -> Self {
        self.before = None;
        self.lost.extend(other.lost);
        self.lost_count += other.lost_count;
        self.lost_share = self.lost_share.max(other.lost_share);
        self.buried += other.buried;
        self.fused += other.fused;
        self.parted += other.parted;
        self.crumbs += other.crumbs;
        self.new_tunnels = None;
        self
    }
}

impl LdiReport {
    fn with(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            silent_rays: self.silent_rays + other.silent_rays,
            hits: self.hits + other.hits,
            layers: self.layers.max(other.layers),
            made_by: self.made_by,
        }
    }
}

impl ThinReport {
    fn with(mut self, other: Self) -> Self {
        self.spans += other.spans;
        self.thin_spans += other.thin_spans;
        self.lost_spans += other.lost_spans;
        self.thin_gaps += other.thin_gaps;
        let least = |a: Option<f64>, b: Option<f64>| a.into_iter().chain(b).reduce(f64::min);
        self.thinnest = least(self.thinnest, other.thinnest);
        self.voxel_that_keeps = least(self.voxel_that_keeps, other.voxel_that_keeps);
        self.regions.extend(other.regions);
        self
    }
}

fn with_votes(mut one: VoteReport, two: VoteReport) -> VoteReport {
    one.voxels += two.voxels;
    one.doubtful += two.doubtful;
    one.doubtful_regions.extend(two.doubtful_regions);
    one
}

fn with_fit(one: FitReport, two: FitReport) -> FitReport {
    FitReport {
        kept: one.kept + two.kept,
        of: one.of + two.of,
        moved: one.moved + two.moved,
        inserted: one.inserted + two.inserted,
        given_up: one.given_up + two.given_up,
    }
}
