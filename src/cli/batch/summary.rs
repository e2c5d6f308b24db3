//! What is said at the end, and of each job with `-v`.

use std::path::Path;
use std::time::Duration;

use super::super::words;
use super::class::Class;
use super::log::Entry;

/// So many failed jobs of each class are named.
const NAMED: usize = 20;

/// One job in a line.
pub fn line(entry: &Entry) -> String {
    let memory = entry.peak_memory_bytes.map_or(String::new(), |bytes| format!(", {}", words::bytes(bytes)));
    let what = entry.message.as_ref().map_or(String::new(), |message| format!(": {message}"));
    format!("{:<11} {} ({}{memory}){what}", entry.class.word(), entry.job, words::seconds(entry.seconds))
}

/// What is said at the end, in lines: the failed jobs by class, and how many there are of each.
pub struct Summary<'a> {
    /// Of jobs that have ended.
    pub entries: &'a [Entry],
    /// How many of them an earlier batch has done.
    pub before: usize,
    /// How many have not begun.
    pub left: usize,
    /// How long it took.
    pub took: Duration,
    /// Where the log is.
    pub log: &'a Path,
}

impl Summary<'_> {
    /// The lines.
    pub fn lines(&self) -> Vec<String> {
        let of = |class: Class| self.entries.iter().filter(move |entry| entry.class == class);
        let mut lines = Vec::new();
        for class in Class::ALL.into_iter().filter(|&class| class != Class::Done) {
            let failed: Vec<&Entry> = of(class).collect();
            for entry in failed.iter().take(NAMED) {
                let message = entry.message.as_ref().map_or(String::new(), |message| format!(": {message}"));
                lines.push(format!("{:<11} {}{message}", class.word(), entry.job));
            }
            if failed.len() > NAMED {
                lines.push(format!("{:<11} and {} more", "", words::count(failed.len() - NAMED)));
            }
        }
        let counts: Vec<String> = Class::ALL
            .into_iter()
            .map(|class| (class, of(class).count()))
            .filter(|&(_, count)| count > 0)
            .map(|(class, count)| format!("{} {}", words::count(count), class.word()))
            .collect();
        let before = match self.before {
            0 => String::new(),
            before => format!(" ({} by an earlier batch)", words::count(before)),
        };
        let left = if self.left > 0 { format!(", {} not begun", words::count(self.left)) } else { String::new() };
        let all = words::plural(self.entries.len() + self.left, "job");
        lines.push(format!("jobs        {all}: {}{before}{left}", counts.join(", ")));
        lines.push(format!("log         {}", self.log.display()));
        lines.push(format!("time        {}", words::seconds(self.took.as_secs_f64())));
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::super::log::tests::entry;
    use super::*;

    #[test]
    fn failures_are_named_and_counted() {
        let failed = |job: &str, class| Entry { class, message: Some("why".into()), ..entry(job) };
        let mut entries: Vec<Entry> = (0..25).map(|n| failed(&format!("{n}.stl"), Class::Timeout)).collect();
        entries.extend([entry("good.stl"), failed("bad.stl", Class::Input)]);
        let summary =
            Summary { entries: &entries, before: 1, left: 3, took: Duration::from_secs(2), log: Path::new("log") };
        let lines = summary.lines();
        assert_eq!(lines[0], "input       bad.stl: why");
        assert_eq!(lines.iter().filter(|line| line.starts_with("timeout ")).count(), NAMED);
        assert_eq!(lines[21], "            and 5 more");
        assert_eq!(lines[22], "jobs        30 jobs: 1 done, 1 input, 25 timeout (1 by an earlier batch), 3 not begun");
    }
}
