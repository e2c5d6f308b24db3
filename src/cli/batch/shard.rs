//! `--shard`: which of the jobs this run does, where several runs share them.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use sha2::{Digest, Sha256};

use super::super::exit::Failure;

/// What `--shard` says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ShardChoice {
    /// One of so many.
    Of(Shard),
    /// What the array of jobs of Slurm says.
    Slurm,
}

/// One of several runs that share the jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    number: u64,
    /// How many there are.
    count: u64,
}

impl FromStr for ShardChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "slurm" {
            return Ok(Self::Slurm);
        }
        let wanted = || "a number of how many is needed, such as 1/4 to 4/4, or the word slurm".to_string();
        let (number, count) = text.split_once('/').ok_or_else(wanted)?;
        let shard =
            Shard { number: number.parse().map_err(|_| wanted())?, count: count.parse().map_err(|_| wanted())? };
        if (1..=shard.count).contains(&shard.number) { Ok(Self::Of(shard)) } else { Err(wanted()) }
    }
}

impl ShardChoice {
    /// The shard, where `variable` tells what a variable of the environment holds.
    pub fn resolve(self, variable: impl Fn(&str) -> Option<String>) -> Result<Shard, Failure> {
        if let Self::Of(shard) = self {
            return Ok(shard);
        }
        let number = |name: &str| -> Result<u64, Failure> {
            let text = variable(name).ok_or_else(|| no_array(&format!("{name} is not set")))?;
            text.trim().parse().map_err(|_| no_array(&format!("{name} is `{text}`")))
        };
        let (task, first) = (number("SLURM_ARRAY_TASK_ID")?, number("SLURM_ARRAY_TASK_MIN")?);
        let count = number("SLURM_ARRAY_TASK_COUNT")?;
        let step = variable("SLURM_ARRAY_TASK_STEP").and_then(|text| text.trim().parse().ok()).unwrap_or(1).max(1);
        let from_first = task.checked_sub(first).filter(|from_first| from_first % step == 0);
        match from_first.map(|from_first| from_first / step + 1).filter(|&number| number <= count) {
            Some(number) => Ok(Shard { number, count }),
            None => Err(no_array(&format!("task {task} is none of {count} from {first} on in steps of {step}"))),
        }
    }
}

fn no_array(why: &str) -> Failure {
    Failure::usage(format!("--shard slurm finds no array of jobs: {why}"))
        .hint("sbatch --array=1-N, without gaps; or --shard I/N says it by hand")
}

impl Shard {
    /// Whether it does the job of this name: decided by the name alone, so that runs agree that start at different times.
    pub fn has(self, name: &str) -> bool {
        let digest = Sha256::digest(name.as_bytes());
        let number = digest.iter().take(8).fold(0, |number, &byte| number << 8 | u64::from(byte));
        number % self.count == self.number - 1
    }

    /// `batch.jsonl` as `batch.2-of-4.jsonl`.
    pub fn log_name(self, log: &Path) -> PathBuf {
        let stem = log.file_stem().unwrap_or_default().to_string_lossy();
        let extension = log.extension().map_or(String::new(), |extension| format!(".{}", extension.to_string_lossy()));
        log.with_file_name(format!("{stem}.{}-of-{}{extension}", self.number, self.count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shard(text: &str) -> Shard {
        text.parse::<ShardChoice>().expect("a shard").resolve(|_| None).expect("a shard")
    }

    #[test]
    fn every_job_belongs_to_one_shard() {
        for count in [1, 2, 7] {
            let shards: Vec<Shard> = (1..=count).map(|number| shard(&format!("{number}/{count}"))).collect();
            let mut sizes = vec![0; count];
            for job in 0..700 {
                let owners: Vec<usize> = (0..count).filter(|&n| shards[n].has(&format!("sub/{job}.stl"))).collect();
                assert_eq!(owners.len(), 1);
                sizes[owners[0]] += 1;
            }
            assert!(sizes.iter().all(|&size| size > 50), "{sizes:?}");
        }
        for text in ["", "0/4", "5/4", "1/0", "1", "a/b", "-1/3"] {
            assert!(text.parse::<ShardChoice>().is_err(), "{text}");
        }
    }

    #[test]
    fn slurm_says_the_same_in_its_own_words() {
        let resolved = |id: &str, min: &str, count: &str, step: Option<&str>| {
            let variable = |name: &str| match name {
                "SLURM_ARRAY_TASK_ID" => Some(id.to_owned()),
                "SLURM_ARRAY_TASK_MIN" => Some(min.to_owned()),
                "SLURM_ARRAY_TASK_COUNT" => Some(count.to_owned()),
                _ => step.map(str::to_owned),
            };
            ShardChoice::Slurm.resolve(variable)
        };
        assert_eq!(resolved("0", "0", "4", None).expect("a shard"), shard("1/4"));
        assert_eq!(resolved("7", "4", "4", Some("1")).expect("a shard"), shard("4/4"));
        assert_eq!(resolved("5", "1", "3", Some("2")).expect("a shard"), shard("3/3"));
        for (id, min, count, step) in [("9", "1", "4", None), ("2", "1", "3", Some("2")), ("x", "1", "3", None)] {
            let failure = resolved(id, min, count, step).expect_err("no shard");
            assert!(failure.message.contains("--shard slurm"), "{failure}");
        }
        assert!(ShardChoice::Slurm.resolve(|_| None).is_err());
    }

    #[test]
    fn logs_of_shards_have_names_of_their_own() {
        assert_eq!(shard("2/4").log_name(Path::new("out/batch.jsonl")), Path::new("out/batch.2-of-4.jsonl"));
        assert_eq!(shard("1/2").log_name(Path::new("log")), Path::new("log.1-of-2"));
    }
}
