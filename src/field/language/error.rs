//! What is wrong with a text, and where.

use crate::nearest::nearest;

/// Why the text is no field over the given names. Positions are bytes from the start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LanguageError {
    /// Something else was expected at a place.
    #[error("expected {expected}, found {found}")]
    Syntax {
        /// Where.
        at: usize,
        /// What would have been understood there.
        expected: &'static str,
        /// What is there.
        found: String,
    },
    /// The nesting or the length is beyond what is reasonable.
    #[error("more than {limit} {what}")]
    TooLong {
        /// Where the limit is passed.
        at: usize,
        /// The limit.
        limit: usize,
        /// Of what.
        what: &'static str,
    },
    /// A number too large to be one.
    #[error("`{text}` is beyond all numbers")]
    Overflow {
        /// Where.
        at: usize,
        /// As typed.
        text: String,
    },
    /// A name that no operand has.
    #[error("no file is given for `{name}`")]
    UnknownName {
        /// Where.
        at: usize,
        /// The name.
        name: String,
        /// The names there are.
        known: Vec<String>,
        /// How the function of that name is called, if there is one.
        function: Option<String>,
    },
    /// Operands whose names the text does not use.
    #[error("the expression does not use {}", .names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "))]
    UnusedNames {
        /// The names.
        names: Vec<String>,
    },
    /// An operand that goes by the name of the frame.
    #[error("no file can go by the name `t`: it stands for the frame of a sequence")]
    ReservedName,
    /// A function that there is not.
    #[error("there is no function `{name}`")]
    UnknownFunction {
        /// Where.
        at: usize,
        /// The name.
        name: String,
        /// The function with the nearest name, if one is near.
        nearest: Option<&'static str>,
    },
    /// A parameter that the function does not have.
    #[error("`{signature}` has no parameter `{name}`")]
    UnknownParameter {
        /// Where.
        at: usize,
        /// The name.
        name: String,
        /// How the function is called.
        signature: String,
        /// Its parameter with the nearest name, if one is near.
        nearest: Option<&'static str>,
    },
    /// A field or parameter that is not given and has no default.
    #[error("`{what}` of `{signature}` is missing")]
    Missing {
        /// Where the call ends.
        at: usize,
        /// What is missing.
        what: &'static str,
        /// How the function is called.
        signature: String,
    },
    /// More arguments than the function takes.
    #[error("too many arguments for `{signature}`")]
    TooMany {
        /// Where the first is that is too many.
        at: usize,
        /// How the function is called.
        signature: String,
    },
    /// An argument without a name after one with a name.
    #[error("after an argument with a name, all must have one: `{signature}`")]
    Unnamed {
        /// Where.
        at: usize,
        /// How the function is called.
        signature: String,
    },
    /// A parameter that is given twice, or together with the one that it replaces.
    #[error("`{name}` is given, and `{other}` too")]
    GivenTwice {
        /// Where the second is.
        at: usize,
        /// The parameter.
        name: &'static str,
        /// What is there already; the same where it is given twice.
        other: &'static str,
    },
    /// An argument of the wrong kind.
    #[error("`{what}` must be {wanted}; `{found}` is not")]
    WrongKind {
        /// Where.
        at: usize,
        /// What it is for.
        what: String,
        /// What would be right.
        wanted: String,
        /// As typed.
        found: String,
    },
    /// An argument of the right kind that is too large or too small.
    #[error("`{what}` must be {wanted}; `{found}` is out of that range")]
    OutOfRange {
        /// Where.
        at: usize,
        /// What it is for.
        what: String,
        /// The range.
        wanted: String,
        /// As typed, or as it comes out.
        found: String,
    },
    /// A list after `;` that does not have a number for each field, or where none is taken.
    #[error("`{signature}` takes {wanted} after the `;`, found {found}")]
    WrongCount {
        /// Where.
        at: usize,
        /// How the function is called.
        signature: String,
        /// So many.
        wanted: usize,
        /// So many are there.
        found: usize,
    },
    /// A quantity that means nothing for this model.
    #[error("{reason}")]
    Quantity {
        /// Where; for a default, the call.
        at: usize,
        /// Why, in words of who knows the model.
        reason: String,
    },
    /// A function that makes no solid of solids, where a boolean expression is wanted.
    #[error("`{function}` is no boolean operation")]
    NotBoolean {
        /// Where.
        at: usize,
        /// How it is called.
        function: String,
    },
    /// `t` where there is one picture only.
    #[error("`t` has no value here: it runs from 0 to 1 over the frames of a sequence")]
    NoFrame {
        /// Where.
        at: usize,
    },
}

impl LanguageError {
    /// Where in the text the error is, bytes from the start, if it is at one place.
    pub fn position(&self) -> Option<usize> {
        match self {
            Self::UnusedNames { .. } | Self::ReservedName => None,
            Self::Syntax { at, .. }
            | Self::TooLong { at, .. }
            | Self::Overflow { at, .. }
            | Self::UnknownName { at, .. }
            | Self::UnknownFunction { at, .. }
            | Self::UnknownParameter { at, .. }
            | Self::Missing { at, .. }
            | Self::TooMany { at, .. }
            | Self::Unnamed { at, .. }
            | Self::GivenTwice { at, .. }
            | Self::WrongKind { at, .. }
            | Self::OutOfRange { at, .. }
            | Self::WrongCount { at, .. }
            | Self::Quantity { at, .. }
            | Self::NotBoolean { at, .. }
            | Self::NoFrame { at } => Some(*at),
        }
    }

    /// Something to try.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::UnknownName { name, known, function, .. } => Some(match function {
                Some(function) => format!("`{name}` is a function: {}", function),
                None if known.is_empty() => format!("give it one: {name}=FILE"),
                None => match nearest(name, known.iter().map(String::as_str)) {
                    Some(near) => format!("did you mean `{near}`? the names given are {}", known.join(", ")),
                    None => format!("the names given are {}", known.join(", ")),
                },
            }),
            Self::UnusedNames { .. } => Some("use them, or leave their files away".into()),
            Self::ReservedName => Some("another name, in the expression too".into()),
            Self::UnknownFunction { nearest, .. } => Some(match nearest {
                Some(nearest) => format!("did you mean `{nearest}`?"),
                None => "--help lists all functions".into(),
            }),
            Self::UnknownParameter { nearest: Some(nearest), .. } => Some(format!("did you mean `{nearest}`?")),
            Self::NotBoolean { function, .. } if function.starts_with("complement(") => {
                Some("what is outside has no end: `a - b` is what is inside a and outside b".into())
            }
            Self::NotBoolean { .. } => {
                Some("names joined by `|`, `&`, `-` and `^`; `meshwright field` takes all functions".into())
            }
            Self::NoFrame { .. } => Some("--frames N, or a number instead of `t`".into()),
            _ => None,
        }
    }
}
