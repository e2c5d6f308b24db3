//! What may be wrong with a finished run: a result that is not what was asked for, or more memory than was allowed.

use super::report::RunReport;
use super::{doubts, words};

/// More than this share of the walls passing between voxels: the resolution does not hold the shape.
/// A few always do, where a ray grazes an edge: of the meshes in `testdata/`, and of scans and parts
/// at 64 voxels, at most 0.06; of sheets and wires that a repair at that size loses, at least 0.4.
const TOO_MANY_LOST: f64 = 0.2;

/// More than this share of the voxels near the surface decided by few or quarrelling rays: the
/// result is a guess. A car body made of sheets has 0.3, a hundred scattered triangles 0.7.
const TOO_MANY_DOUBTS: f64 = 0.5;

/// More than this share of the surface that morphology should leave is thinner than a voxel: what there is of it are rags.
const TOO_MUCH_THIN: f64 = 0.1;

/// A sentence for each reason why the result is not what the input describes. Such a result is written only when that is asked for.
pub fn lost(report: &RunReport) -> Vec<String> {
    let mut sentences = Vec::new();
    if let Some(pipeline) = report.pipeline() {
        let thin = &pipeline.thin;
        if share(thin.lost_spans, thin.spans) > TOO_MANY_LOST && !pipeline.kept_all() {
            sentences.push(format!(
                "{} of the walls are so thin that they fall between the voxels and are lost",
                words::percent(thin.lost_spans, thin.spans)
            ));
        }
        if let Some(change) = pipeline.morphology.as_ref().filter(|change| change.thin_share > TOO_MUCH_THIN) {
            let share = words::percent((1000.0 * change.thin_share) as usize, 1000);
            sentences.push(format!(
                "{share} of the surface that there should be bounds what is thinner than a voxel of {}, and is missing or in rags{}",
                words::number(change.voxel),
                change.voxel_that_holds.map_or(String::new(), |h| format!("; half of it is {} thick or more", words::number(h)))
            ));
        }
        if let Some(topology) = pipeline.topology.as_ref().filter(|topology| topology.is_large()) {
            sentences
                .push(format!("the result is not what the input describes: {}", doubts::changes(topology).join("; ")));
        }
    }
    sentences
}

/// A sentence when the result is mostly a guess. Nothing of the input is lost by that, so it is written: only a look at it tells.
pub fn guessed(report: &RunReport) -> Option<String> {
    let vote = &report.pipeline()?.vote;
    (share(vote.doubtful, vote.voxels) > TOO_MANY_DOUBTS).then(|| {
        format!(
            "{} of the voxels near the surface are a guess: the surface is too open to tell inside from outside",
            words::percent(vote.doubtful, vote.voxels)
        )
    })
}

/// A sentence when the run took more memory than it was allowed; the result is right all the same.
pub fn beyond_memory(report: &RunReport, max_memory: Option<u64>) -> Option<String> {
    match (report.peak_memory_bytes.or_else(super::machine::peak_memory), max_memory) {
        (Some(peak), Some(cap)) if peak > cap => Some(format!(
            "the run took {} of memory, more than the {} of --max-memory",
            words::bytes(peak),
            words::bytes(cap)
        )),
        _ => None,
    }
}

fn share(part: usize, whole: usize) -> f64 {
    part as f64 / whole.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::result::RunResult;
    use super::*;
    use crate::pipeline::{Report, ThinReport};
    use crate::vote::VoteReport;

    fn report(lost_spans: usize, doubtful: usize) -> RunReport {
        let thin = ThinReport { spans: 1000, lost_spans, ..ThinReport::default() };
        let vote = VoteReport { voxels: 1000, doubtful, ..VoteReport::default() };
        let result = RunResult::solid(Report { thin, vote, ..Report::default() });
        RunReport { result: Some(result), ..RunReport::new("repair") }
    }

    #[test]
    fn grazing_rays_are_no_broken_limit_and_lost_walls_are() {
        assert!(lost(&report(60, 0)).is_empty());
        assert_eq!(lost(&report(420, 0)).len(), 1);
        assert!(lost(&RunReport::new("repair")).is_empty());
    }

    #[test]
    fn a_result_that_is_mostly_a_guess_is_told() {
        assert_eq!(guessed(&report(0, 300)), None);
        assert!(guessed(&report(0, 670)).expect("a guess").starts_with("67"));
        assert!(lost(&report(0, 670)).is_empty());
    }

    #[test]
    fn a_passed_memory_cap_is_told() {
        let used = RunReport { peak_memory_bytes: Some(2000), ..report(0, 0) };
        assert_eq!(beyond_memory(&used, Some(2000)), None);
        let told = beyond_memory(&used, Some(1999)).expect("it is more");
        assert_eq!(told, "the run took 2.0 kB of memory, more than the 2.0 kB of --max-memory");
    }
}
