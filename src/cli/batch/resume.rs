//! `--resume`: which jobs an earlier batch has done.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::class::Class;
use super::hash;
use super::job::Job;
use super::log::Entry;

/// For each job the entry of the log that says that it is done, if it still is: of the same inputs, with the same options, and with the
/// output in its place.
pub fn done_before(jobs: &[Job], log: &HashMap<String, Entry>, threads: usize) -> Vec<Option<Entry>> {
    let next = AtomicUsize::new(0);
    let look = || {
        let mut found = Vec::new();
        while let Some((n, job)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|n| Some((n, jobs.get(n)?))) {
            if let Some(entry) = log.get(&job.name).filter(|entry| stands(job, entry)) {
                found.push((n, entry.clone()));
            }
        }
        found
    };
    let mut done = vec![None; jobs.len()];
    std::thread::scope(|scope| {
        // Where a thread cannot be had, this one does it all.
        let others: Vec<_> =
            (1..threads).filter_map(|_| std::thread::Builder::new().spawn_scoped(scope, look).ok()).collect();
        let own = look();
        for (n, entry) in own.into_iter().chain(others.into_iter().filter_map(|other| other.join().ok()).flatten()) {
            done[n] = Some(entry);
        }
    });
    done
}

/// Whether what the log says of a job is still so.
fn stands(job: &Job, entry: &Entry) -> bool {
    let same = entry.verb == job.verb.name && entry.options == job.option_words();
    let ended_well = matches!(entry.class, Class::Done | Class::Limit) && entry.output_sha256.is_some();
    let is = |path: &std::path::Path, hash: &Option<String>| hash.is_some() && hash::of_file(path) == *hash;
    same && ended_well
        && entry.input_sha256.len() == job.inputs.len()
        && job.inputs.iter().zip(&entry.input_sha256).all(|(input, hash)| is(input, hash))
        && is(&job.output, &entry.output_sha256)
}
