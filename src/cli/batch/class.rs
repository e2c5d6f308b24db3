//! How a job ended, in one word.

use serde::{Deserialize, Serialize};

use super::super::exit::Exit;

/// How a job ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// It is done, and verified on the written file.
    Done,
    /// A promise or a stated limit does not hold.
    Limit,
    /// Its options do not suit it.
    Usage,
    /// Its input cannot be read, or holds nothing that the verb can take.
    Input,
    /// It needs more memory than it may take, or than there is.
    Memory,
    /// Its time has passed.
    Timeout,
    /// Its output cannot be written.
    Write,
    /// Somebody else has killed it.
    Killed,
    /// The program has a bug.
    Crashed,
    /// It was interrupted.
    Interrupted,
}

/// What made a job end that did not end by itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Cause {
    /// Its time has passed, and it did not stop.
    Timeout,
    /// It has taken so many bytes.
    Memory(u64),
    /// The whole batch was interrupted.
    Interrupted,
    /// It could not begin.
    NotBegun {
        /// A sentence.
        why: String,
        /// Whether memory, or another process, could not be had.
        wanting: bool,
    },
}

/// How a process ended.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Status {
    /// Its exit status; none when a signal has ended it.
    pub code: Option<i32>,
    /// The signal that has ended it.
    pub signal: Option<i32>,
}

impl Class {
    /// All of them, in the order of a summary.
    pub const ALL: [Self; 10] = [
        Self::Done,
        Self::Limit,
        Self::Usage,
        Self::Input,
        Self::Memory,
        Self::Timeout,
        Self::Write,
        Self::Killed,
        Self::Crashed,
        Self::Interrupted,
    ];

    /// Of a process that ended with `status`, and why it was ended, if it was.
    pub fn of(status: Status, cause: Option<&Cause>) -> Self {
        match (status.code, cause) {
            // It was done before anything could end it.
            (Some(0), _) => Self::Done,
            (_, Some(Cause::Timeout)) => Self::Timeout,
            (_, Some(Cause::Memory(_))) => Self::Memory,
            (_, Some(Cause::Interrupted)) => Self::Interrupted,
            (_, Some(Cause::NotBegun { wanting: true, .. })) => Self::Memory,
            (_, Some(Cause::NotBegun { wanting: false, .. })) => Self::Crashed,
            (Some(code), None) => Self::of_code(code),
            (None, None) => match status.signal {
                Some(signal) if OF_BUGS.contains(&signal) => Self::Crashed,
                _ => Self::Killed,
            },
        }
    }

    fn of_code(code: i32) -> Self {
        [
            (Exit::Limit, Self::Limit),
            (Exit::Usage, Self::Usage),
            (Exit::Input, Self::Input),
            (Exit::Memory, Self::Memory),
            (Exit::Deadline, Self::Timeout),
            (Exit::Write, Self::Write),
            (Exit::Interrupted, Self::Interrupted),
        ]
        .into_iter()
        .find_map(|(exit, class)| (i32::from(exit.code()) == code).then_some(class))
        .unwrap_or(Self::Crashed)
    }

    /// The word that the log has for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::Limit => "limit",
            Self::Usage => "usage",
            Self::Input => "input",
            Self::Memory => "memory",
            Self::Timeout => "timeout",
            Self::Write => "write",
            Self::Killed => "killed",
            Self::Crashed => "crashed",
            Self::Interrupted => "interrupted",
        }
    }
}

/// Signals that a process brings upon itself: SIGILL, SIGTRAP, SIGABRT, SIGBUS, SIGFPE, SIGSEGV and SIGSYS, in the numbers of Linux.
const OF_BUGS: [i32; 7] = [4, 5, 6, 7, 8, 11, 31];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_has_its_class() {
        let code = |code| Status { code: Some(code), signal: None };
        let signal = |signal| Status { code: None, signal: Some(signal) };
        for (status, cause, class) in [
            (code(0), None, Class::Done),
            (code(0), Some(Cause::Interrupted), Class::Done),
            (code(1), None, Class::Crashed),
            (code(3), None, Class::Limit),
            (code(4), None, Class::Input),
            (code(5), None, Class::Memory),
            (code(6), None, Class::Timeout),
            (code(7), None, Class::Write),
            (code(101), None, Class::Crashed),
            (signal(9), None, Class::Killed),
            (signal(9), Some(Cause::Timeout), Class::Timeout),
            (signal(9), Some(Cause::Memory(1)), Class::Memory),
            (signal(11), None, Class::Crashed),
            (signal(2), Some(Cause::Interrupted), Class::Interrupted),
        ] {
            assert_eq!(Class::of(status, cause.as_ref()), class, "{status:?} {cause:?}");
        }
    }

    #[test]
    fn the_log_has_the_same_words() {
        for class in Class::ALL {
            assert_eq!(serde_json::to_value(class).expect("JSON"), class.word());
        }
    }
}
