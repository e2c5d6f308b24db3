//! Which job begins next, and with how many threads: the largest first, as many side by side as cores and memory allow.

use super::job::Job;

/// What a job takes beside what it reads, bytes, before any has shown what it takes.
const LEAST_MEMORY: u64 = 64 << 20;

/// What a job takes for each byte that it reads. Of the meshes measured, repairs without voxels took 4 to 28 times the file; what voxels take beside
/// depends on the resolution, and is learnt.
const MEMORY_PER_BYTE: u64 = 30;

/// A job takes as long as reading so many bytes even when its file is empty.
const LEAST_WORK: u64 = 20_000;

/// A job may take this many times its cap before it is ended.
const BEYOND_CAP: f64 = 1.4;

/// How long a job will take, beside others.
pub fn work(job: &Job) -> u64 {
    job.bytes.unwrap_or(0) + LEAST_WORK
}

/// A job that is to begin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Start {
    /// Its number.
    pub job: usize,
    /// Its threads.
    pub threads: usize,
    /// The memory that it is expected to take, bytes.
    pub memory: u64,
}

/// A job that runs.
#[derive(Debug, Clone, Copy)]
pub struct Running {
    /// What it was begun with.
    pub start: Start,
    /// What it holds now, bytes.
    pub resident: u64,
}

/// The jobs that have not begun.
#[derive(Debug)]
pub struct Plan {
    /// The next last.
    waiting: Vec<Waiting>,
    /// The work of all of them.
    work: u64,
    cores: usize,
    most: usize,
    /// What jobs have taken beyond what was expected, bytes, and how many have ended.
    excess: (u64, u64),
}

#[derive(Debug, Clone, Copy)]
struct Waiting {
    job: usize,
    work: u64,
    bytes: u64,
    cap: Option<u64>,
    /// It has failed for want of memory beside others.
    alone: bool,
}

impl Waiting {
    fn of(jobs: &[Job], job: usize) -> Self {
        let Job { bytes, each, .. } = &jobs[job];
        Self { job, work: work(&jobs[job]), bytes: bytes.unwrap_or(0), cap: each.max_memory, alone: false }
    }
}

impl Plan {
    /// Of the jobs whose numbers are `left`, for so many threads and at most so many jobs side by side.
    pub fn new(jobs: &[Job], left: impl IntoIterator<Item = usize>, cores: usize, most: Option<usize>) -> Self {
        let mut left: Vec<usize> = left.into_iter().collect();
        // What is no file may wait for ever for somebody to write it: that begins first. Of equal jobs the order is that of their names.
        left.sort_by_key(|&n| (jobs[n].bytes.is_none(), work(&jobs[n]), std::cmp::Reverse(n)));
        let cores = cores.max(1);
        Self {
            work: left.iter().map(|&n| work(&jobs[n])).sum(),
            waiting: left.into_iter().map(|n| Waiting::of(jobs, n)).collect(),
            cores,
            most: most.unwrap_or(cores).clamp(1, cores),
            excess: (0, 0),
        }
    }

    /// The job to begin now, if there is one, beside those that run, when the machine has `free` bytes of memory left.
    pub fn next(&mut self, running: &[Running], free: Option<u64>) -> Option<Start> {
        let taken: usize = running.iter().map(|running| running.start.threads).sum();
        let threads = self.cores.saturating_sub(taken);
        let places = self.most.saturating_sub(running.len());
        if threads == 0 || places == 0 {
            return None;
        }
        // What those that run have not taken yet.
        let promised: u64 = running.iter().map(|running| running.start.memory.saturating_sub(running.resident)).sum();
        let fits = |waiting: &Waiting| {
            running.is_empty()
                || (!waiting.alone && free.is_none_or(|free| self.memory(waiting).saturating_add(promised) <= free))
        };
        let place = self.waiting.iter().rposition(fits)?;
        let waiting = self.waiting.remove(place);
        self.work -= waiting.work;
        Some(Start {
            job: waiting.job,
            threads: if waiting.alone { threads } else { self.share(&waiting, threads, places) },
            memory: self.memory(&waiting),
        })
    }

    /// Of so many free threads those for a job: its share of the work that is left, and no fewer than when all that can begin get the same.
    fn share(&self, job: &Waiting, threads: usize, places: usize) -> usize {
        let by_work = (threads as f64 * job.work as f64 / (self.work + job.work) as f64).round() as usize;
        let places = places.min(self.waiting.len() + 1);
        by_work.max(threads / places).clamp(1, threads)
    }

    /// The memory that a job is expected to take, bytes.
    fn memory(&self, job: &Waiting) -> u64 {
        let (excess, ended) = self.excess;
        let expected = expected(job.bytes).saturating_add(excess / ended.max(1));
        job.cap.map_or(expected, |cap| expected.min((BEYOND_CAP * cap.max(LEAST_MEMORY) as f64) as u64))
    }

    /// Learns what a job of these files has taken.
    pub fn learn(&mut self, job: &Job, peak: Option<u64>) {
        let beyond = peak.unwrap_or(0).saturating_sub(expected(job.bytes.unwrap_or(0)));
        self.excess = (self.excess.0.saturating_add(beyond), self.excess.1 + 1);
    }

    /// Takes a job back that has failed for want of memory beside others: it runs again when no other does.
    pub fn again(&mut self, jobs: &[Job], job: usize) {
        self.waiting.insert(0, Waiting { alone: true, ..Waiting::of(jobs, job) });
        self.work += work(&jobs[job]);
    }

    /// Takes back what could not begin.
    pub fn put_back(&mut self, jobs: &[Job], job: usize) {
        self.waiting.push(Waiting::of(jobs, job));
        self.work += work(&jobs[job]);
    }
}

fn expected(bytes: u64) -> u64 {
    bytes.saturating_mul(MEMORY_PER_BYTE).saturating_add(LEAST_MEMORY)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn jobs(sizes: &[u64]) -> Vec<Job> {
        let verb = super::super::verbs::of_name("repair").expect("a verb");
        let job = |(n, &bytes)| Job {
            bytes: Some(bytes),
            ..Job::new(verb, vec![], Path::new(&format!("{n}.stl")), Path::new("out"))
        };
        sizes.iter().enumerate().map(job).collect()
    }

    /// Begins what can begin at once.
    fn begun(plan: &mut Plan, free: u64) -> Vec<(usize, usize)> {
        let mut running: Vec<Running> = Vec::new();
        while let Some(start) = plan.next(&running, Some(free)) {
            running.push(Running { start, resident: 0 });
        }
        running.iter().map(|running| (running.start.job, running.start.threads)).collect()
    }

    const PLENTY: u64 = 1 << 40;

    #[test]
    fn the_largest_begin_first_and_never_with_more_threads_than_cores() {
        let jobs = jobs(&[1_000, 9_000_000, 2_000, 8_000_000, 3_000]);
        let mut plan = Plan::new(&jobs, 0..5, 4, None);
        assert_eq!(begun(&mut plan, PLENTY), [(1, 2), (3, 2)]);
        assert_eq!(begun(&mut plan, PLENTY), [(4, 1), (2, 2), (0, 1)]);
        for cores in 1..9 {
            for most in [None, Some(1), Some(3)] {
                let mut plan = Plan::new(&jobs, 0..5, cores, most);
                while !plan.waiting.is_empty() {
                    let begun = begun(&mut plan, PLENTY);
                    assert!(begun.iter().map(|(_, threads)| threads).sum::<usize>() <= cores);
                    assert!(most.is_none_or(|most| begun.len() <= most));
                }
            }
        }
    }

    #[test]
    fn small_jobs_get_a_thread_each_and_a_lone_one_gets_all() {
        let small = jobs(&[5_000; 20]);
        assert!(begun(&mut Plan::new(&small, 0..20, 8, None), PLENTY).iter().all(|&(_, threads)| threads == 1));
        assert_eq!(begun(&mut Plan::new(&small, 3..4, 8, None), PLENTY), [(3, 8)]);
        assert_eq!(begun(&mut Plan::new(&small, 0..20, 8, Some(1)), PLENTY), [(0, 8)]);
        let mixed = jobs(&[90_000_000, 100_000, 100_000]);
        assert_eq!(begun(&mut Plan::new(&mixed, 0..3, 2, None), PLENTY), [(0, 2)]);
    }

    #[test]
    fn memory_keeps_large_jobs_apart_and_lets_small_ones_by() {
        let jobs = jobs(&[10_000_000, 9_000_000, 1_000]);
        let mut plan = Plan::new(&jobs, 0..3, 8, None);
        let names = |begun: Vec<(usize, usize)>| begun.into_iter().map(|(job, _)| job).collect::<Vec<_>>();
        assert_eq!(names(begun(&mut plan, 600_000_000)), [0, 2]);
        assert_eq!(names(begun(&mut plan, 600_000_000)), [1]);
        // A lone job begins also where there seems to be too little.
        plan.again(&jobs, 0);
        assert_eq!(begun(&mut plan, 1), [(0, 8)]);
        // What was seen counts for those to come.
        let mut plan = Plan::new(&jobs, 0..3, 8, None);
        plan.learn(&jobs[2], Some(1 << 30));
        assert_eq!(names(begun(&mut plan, 1 << 30)), [0]);
    }
}
