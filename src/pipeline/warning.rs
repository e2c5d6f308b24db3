//! What a user should know of a result, although it is one.

use std::fmt;

use serde::{Serialize, Serializer};

use super::nothing::{NothingEnclosed, keeping_voxel};
use super::report::{Report, ThinReport};

/// Shares of rays and spans above which a user should know.
const MANY_LOST: f64 = 0.02;
const MANY_SILENT: f64 = 0.25;

/// One thing that a user should know. Its words are those of `Display`, and in JSON too.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Much of the walls lies between the voxels.
    ThinWalls {
        /// Share of the walls that hold no voxel, 0 to 1.
        share: f64,
        /// How thin they are.
        thin: ThinReport,
    },
    /// Many rays cannot tell inside from outside.
    SilentRays {
        /// Their share of the rays that meet anything, 0 to 1.
        share: f64,
    },
    /// The graphics processor was to work and did not.
    Fallback {
        /// Why not.
        reason: String,
    },
    /// Beside the shells that stay as they are, the rest of the input encloses nothing.
    NothingMore(NothingEnclosed),
}

impl Warning {
    /// Those of a report that is complete but for them.
    pub(super) fn of(report: &Report) -> Vec<Self> {
        let mut warnings = Vec::new();
        let share = |part: usize, all: usize| part as f64 / all.max(1) as f64;
        let lost = share(report.thin.lost_spans, report.thin.spans);
        if lost > MANY_LOST && !report.kept_all() {
            warnings.push(Self::ThinWalls { share: lost, thin: report.thin.clone() });
        }
        let silent = share(report.ldi.silent_rays, report.ldi.rays);
        if silent > MANY_SILENT {
            warnings.push(Self::SilentRays { share: silent });
        }
        if let Some(reason) = &report.ldi.made_by.fallback {
            warnings.push(Self::Fallback { reason: reason.clone() });
        }
        warnings
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ThinWalls { share, thin } => write!(
                f,
                "{:.0} % of the walls that rays meet fall between the voxels and may be missing{}",
                100.0 * share,
                keeping_voxel(thin)
            ),
            Self::SilentRays { share } => write!(
                f,
                "{:.0} % of the test rays meet an open or doubled surface and cannot tell inside from outside: \
                 look whether the result is what you want (-v lists the doubtful places)",
                100.0 * share
            ),
            Self::Fallback { reason } => {
                write!(f, "the graphics processor failed, so the main one did its work: {reason}")
            }
            Self::NothingMore(why) => write!(f, "beside what stays as it is, nothing more is enclosed: {why}"),
        }
    }
}

impl Serialize for Warning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn why_the_main_processor_stepped_in_is_a_line_of_the_report() {
        let mut report = Report::default();
        assert!(Warning::of(&report).is_empty());
        report.ldi.made_by.fallback = Some("it melted".into());
        let lines = Warning::of(&report);
        assert!(lines.len() == 1 && lines[0].to_string().contains("it melted"), "{lines:?}");
    }
}
