//! Exit codes, and what every error means for them.

use std::fmt;

use serde::Serialize;
use serde_json::json;

use super::class::Class;
use super::length::QuantityError;
use super::meant;
use super::words;
use crate::arrange::ArrangeError;
use crate::mesh::{SolidError, Validity};
use crate::pipeline::{Advice, LimitError, Trouble};
use crate::progress::Stopped;

/// The exit status of the process.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Exit {
    /// Done, and verified on the written file.
    Done,
    /// Internal error.
    Internal,
    /// Wrong usage.
    Usage,
    /// Done, but a promise or a stated limit does not hold.
    Limit,
    /// Unreadable or empty input, or nothing enclosed.
    Input,
    /// More memory, or more threads, than can be had.
    Memory,
    /// Deadline.
    Deadline,
    /// A file or stream cannot be written.
    Write,
    /// Interrupted.
    Interrupted,
}

impl Exit {
    /// The number the shell sees.
    pub fn code(self) -> u8 {
        match self {
            Self::Done => 0,
            Self::Internal => 1,
            Self::Usage => 2,
            Self::Limit => 3,
            Self::Input => 4,
            Self::Memory => 5,
            Self::Deadline => 6,
            Self::Write => 7,
            Self::Interrupted => 130,
        }
    }
}

impl Exit {
    /// What the status alone tells of a failure.
    fn class(self) -> Class {
        match self {
            Self::Done | Self::Internal => Class::Internal,
            Self::Usage => Class::Usage,
            Self::Limit => Class::Limit,
            Self::Input => Class::Input,
            Self::Memory => Class::Memory,
            Self::Deadline => Class::Deadline,
            Self::Write => Class::Write,
            Self::Interrupted => Class::Interrupted,
        }
    }
}

/// What the user has asked for.
#[derive(Debug, Clone, Copy)]
pub struct Asked {
    /// Whether the voxel size was given, as a length.
    pub voxel: bool,
    /// `--max-memory`.
    pub memory: Option<u64>,
}

/// Why a run ended without its result: a sentence, perhaps something to try, and the exit status.
#[derive(Debug, Clone, Serialize, schemars::JsonSchema)]
pub struct Failure {
    /// The exit status.
    #[serde(skip)]
    pub exit: Exit,
    /// What kind of failure it is.
    pub class: Class,
    /// What belongs to that kind, by name.
    #[serde(skip_serializing_if = "serde_json::Value::is_null")]
    pub fields: serde_json::Value,
    /// One sentence.
    pub message: String,
    /// Lines that show the place, printed as they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// Something to try.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hint: Option<String>,
}

/// What to try where no voxel fits.
pub const INPUTS_ALONE: &str = "the inputs alone need that much: a larger --max-memory, or a machine with more";

impl Failure {
    /// A failure without a hint.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        let (class, message) = (exit.class(), message.into());
        Self { exit, class, fields: serde_json::Value::Null, message, place: None, hint: None }
    }

    /// Wrong usage.
    pub fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    /// Bad input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(Exit::Input, message)
    }

    /// A bug of ours, or a machine that does not do what it says.
    pub fn internal(message: impl Into<String>) -> Self {
        Self::new(Exit::Internal, message)
    }

    /// More memory needed than allowed, bytes; by `asked` or, without it, by what is free.
    pub fn memory(needed: u64, allowed: u64, asked: Option<u64>) -> Self {
        let words = match asked {
            Some(cap) => format!("--max-memory allows {}", words::bytes(cap)),
            None => format!("{} can be had (--max-memory SIZE says another limit)", words::bytes(allowed)),
        };
        let failure =
            Self::new(Exit::Memory, format!("about {} of memory would be needed, and {words}", words::bytes(needed)));
        Self { fields: json!({ "needed": needed, "allowed": asked.unwrap_or(allowed) }), ..failure }
    }

    /// The same, of a kind that the exit status does not tell.
    pub fn of_class(mut self, class: Class) -> Self {
        self.class = class;
        self
    }

    /// The same with something to try.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// The same with lines that show the place.
    pub fn place(mut self, place: impl Into<String>) -> Self {
        self.place = Some(place.into());
        self
    }

    /// What a pipeline's error means, for operands that go by `labels`.
    pub fn pipeline(error: &impl Advice, labels: &[String], unit: words::UnitName<'_>, asked: Asked) -> Self {
        let failure = Self::in_words(error, labels, unit, asked);
        match Class::of_trouble(&error.trouble()) {
            Some((class, fields)) => Self { class, fields, ..failure },
            None => failure,
        }
    }

    fn in_words(error: &impl Advice, labels: &[String], unit: words::UnitName<'_>, asked: Asked) -> Self {
        let failure = match error.trouble() {
            Trouble::Stopped(stopped) => return Self::from(stopped),
            Trouble::Memory(limit) => return Self::limit(limit, unit, asked),
            Trouble::NotSolid(what) => return Self::not_solid(&what.validity),
            Trouble::Empty { operand } => {
                let label = labels.get(operand).map_or("the input", String::as_str);
                Self::input(format!("{label}: no triangle has an area"))
            }
            Trouble::Options | Trouble::NotClosed { .. } => Self::usage(error.to_string()),
            Trouble::Voxel => Self::new(if asked.voxel { Exit::Usage } else { Exit::Input }, error.to_string()),
            Trouble::NotExact(why) => Self::new(Exit::Limit, not_exact(why, labels)),
            Trouble::Input
            | Trouble::Nothing(_)
            | Trouble::NothingLeft { .. }
            | Trouble::TooThin { .. }
            | Trouble::TooMany => Self::input(error.to_string()),
            Trouble::Unkept => Self::new(Exit::Limit, error.to_string()),
            Trouble::NoRoom => Self::new(Exit::Memory, error.to_string()),
            Trouble::Device | Trouble::Call | Trouble::Index => Self::internal(error.to_string()),
        };
        match error.hint() {
            Some(hint) => failure.hint(hint),
            None => failure,
        }
    }

    /// More memory needed than allowed, and a voxel that would fit.
    fn limit(limit: &LimitError, unit: words::UnitName<'_>, asked: Asked) -> Self {
        let LimitError::Memory { needed, allowed, voxel_that_fits } = limit else {
            return Self::input(limit.to_string());
        };
        let failure = Self::memory(*needed, *allowed, asked.memory);
        match voxel_that_fits {
            Some(h) => failure
                .hint(format!("--voxel {} would fit", words::with_unit(&words::rounded_up(*h), unit).replace(' ', ""))),
            None => failure.hint(INPUTS_ALONE),
        }
    }

    /// A result that does not keep the promise.
    pub fn not_solid(validity: &Validity) -> Self {
        let problems = validity.problems().join("; ");
        Self::new(Exit::Limit, format!("the result is not a valid solid ({problems}); it was not written"))
            .of_class(Class::NotSolid)
            .hint("another --resolution or --voxel; and please report it: this should not happen")
    }
}

/// Why there is no exact result, for operands that go by `labels`.
fn not_exact(why: &ArrangeError, labels: &[String]) -> String {
    let ArrangeError::Open { edges, first, closed, .. } = why else {
        return format!("there is no exact result: {why}");
    };
    let label = |operand: usize| labels.get(operand).map_or("the input", String::as_str).to_string();
    let open: Vec<String> = (0..closed.len()).filter(|&n| !closed[n]).map(label).collect();
    let place = |p: [f64; 3]| p.map(words::number).join(" ");
    let [from, to] = first.ends.map(place);
    let (edges, of) = (words::plural(*edges, "edge"), label(first.operand));
    match open.as_slice() {
        [] => "there is no exact result: what the surfaces enclose contradicts itself".into(),
        [one] => format!("there is no exact result: {one} does not close around {edges}, one from {from} to {to}"),
        several => format!(
            "there is no exact result: {} do not close around {edges}, one of {of} from {from} to {to}",
            words::list(several)
        ),
    }
}

impl From<Stopped> for Failure {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            Stopped::Interrupted => Self::new(Exit::Interrupted, "interrupted; no output was written"),
            Stopped::Deadline => {
                Self::new(Exit::Deadline, "the time given with --timeout has passed; no output was written")
                    .hint("a larger --timeout, or a lower --resolution")
            }
        }
    }
}

impl From<SolidError> for Failure {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::Stopped(stopped) => Self::from(stopped),
            SolidError::Index(error) => Self::internal(error.to_string()),
            SolidError::NotSolid(what) => Self::not_solid(&what.validity),
        }
    }
}

impl From<QuantityError> for Failure {
    fn from(error: QuantityError) -> Self {
        let failure = Self::usage(error.to_string());
        match error {
            QuantityError::UnitUnknown { .. } => {
                failure.hint("say what the file's numbers are, for example --unit mm, or give a plain number")
            }
            QuantityError::Malformed { text, .. } => match meant::length(&text) {
                Some(near) => failure.hint(format!("did you mean {near}?")),
                None => failure,
            },
            QuantityError::VoxelItself { .. } => failure.hint("a LEN such as 0.4mm, 1% or 0.4, or --resolution N"),
            _ => failure,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}
