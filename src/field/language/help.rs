//! The table of functions in words.

use std::fmt;

use super::functions::FUNCTIONS;
use super::table::{Axis, Kind, List, Parameter, Presence, Preset};
use super::tree::Function;

/// The functions as `--help` lists them: how each is written, and below that what it gives.
pub fn help() -> String {
    FUNCTIONS.iter().map(|function| format!("  {function}\n      {}\n", function.help)).collect()
}

/// The functions as a table in Markdown.
pub fn markdown() -> String {
    let head = "| function | takes | gives |\n|---|---|---|\n".to_string();
    let rows = FUNCTIONS
        .iter()
        .map(|function| format!("| `{function}` | {} | {} |\n", takes(function), escaped(function.help)));
    head + &rows.collect::<String>()
}

/// A bar would end the cell.
fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

/// What its parameters take; those in a row that take the same are told of together.
fn takes(function: &Function) -> String {
    let mut parts: Vec<String> = Vec::new();
    if function.takes_a_name() {
        parts.push("name: that of a file".into());
    }
    for alike in function.parameters.chunk_by(|a, b| a.kind == b.kind) {
        let names: Vec<&str> = alike.iter().map(|parameter| parameter.name).collect();
        parts.push(format!("{}: {}", names.join(", "), alike[0].kind));
    }
    match function.list {
        List::None => {}
        List::Weights => parts.push("weights: a number for each, by default all the same".into()),
        List::Values => parts.push("values: a number for each".into()),
    }
    parts.join("; ")
}

/// As it is called: `filter(a, cap=5%, [width], [sigma], samples=64)`.
impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fields = self.fields.iter().map(|name| name.to_string());
        let more = self.more_fields.then(|| "...".to_string());
        let parameters = self.parameters.iter().map(Parameter::to_string);
        let all: Vec<String> = fields.chain(more).chain(parameters).collect();
        let list = match self.list {
            List::None => "",
            List::Weights => "; [weights]",
            List::Values => "; values",
        };
        write!(f, "{}({}{list})", self.name, all.join(", "))
    }
}

/// As it stands in a signature.
impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.presence {
            Presence::Required => f.write_str(self.name),
            Presence::Default(preset) => write!(f, "{}={preset}", self.name),
            Presence::Optional | Presence::InsteadOf(_) => write!(f, "[{}]", self.name),
        }
    }
}

impl fmt::Display for Preset {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Quantity(value, suffix) => write!(f, "{value}{suffix}"),
            Self::Axis(axis) => axis.fmt(f),
        }
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What it takes, in words that follow "must be".
impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length => f.write_str("a length above zero"),
            Self::SignedLength => f.write_str("a length of either sign"),
            Self::Place => f.write_str("a coordinate, or with % a share of the extent"),
            Self::Number(from, to) => write!(f, "a number from {from} to {to}, or t"),
            Self::Count(0, _) => f.write_str("a whole number"),
            Self::Count(from, to) => write!(f, "a whole number from {from} to {to}"),
            Self::Axis => f.write_str("x, y or z"),
        }
    }
}
