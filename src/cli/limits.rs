//! Limits that a finished run may have passed: the file is usable, but the user must know.

use super::report::RunReport;
use super::words;

/// More than this share of the walls below two voxels: the resolution does not hold the shape.
/// Curved and tilted surfaces always have some short spans where a ray grazes them (a sphere
/// 50 voxels across has about 0.2 %, an octahedron of that size about 8 %), so that a few say nothing.
const TOO_MANY_THIN: f64 = 0.25;

/// A sentence for each stated limit that does not hold.
pub fn broken(report: &RunReport, max_memory: Option<u64>) -> Vec<String> {
    let mut sentences = Vec::new();
    if let Some(pipeline) = &report.pipeline {
        let thin = &pipeline.thin;
        let share = thin.thin_spans as f64 / thin.spans.max(1) as f64;
        if share > TOO_MANY_THIN {
            sentences.push(format!(
                "{} of the walls are thinner than two voxels: the voxel is too large for this shape",
                words::percent(thin.thin_spans, thin.spans)
            ));
        }
    }
    match (report.peak_memory_bytes.or_else(super::report::peak_memory), max_memory) {
        (Some(peak), Some(cap)) if peak > cap => sentences.push(format!(
            "the run took {} of memory, more than the {} of --max-memory",
            words::bytes(peak),
            words::bytes(cap)
        )),
        _ => {}
    }
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Report, ThinReport};

    fn report(spans: usize, thin_spans: usize) -> RunReport {
        let thin = ThinReport { spans, thin_spans, ..ThinReport::default() };
        RunReport { pipeline: Some(Report { thin, ..Report::default() }), ..RunReport::new("repair") }
    }

    #[test]
    fn grazing_rays_are_no_broken_limit_and_walls_below_the_voxel_are() {
        assert!(broken(&report(1000, 80), None).is_empty());
        assert!(broken(&report(0, 0), None).is_empty());
        assert_eq!(broken(&report(1000, 900), None).len(), 1);
    }

    #[test]
    fn a_passed_memory_cap_is_told() {
        let used = RunReport { peak_memory_bytes: Some(2000), ..report(10, 0) };
        assert!(broken(&used, Some(2000)).is_empty());
        assert_eq!(broken(&used, Some(1999)), ["the run took 2.0 kB of memory, more than the 2.0 kB of --max-memory"]);
    }
}
