//! `blend(a, b, 2mm) - offset(c, -0.4mm)`: the text of a field, parsed and checked.
//!
//! A text becomes a tree of [`Call`]s over operands, in which every argument is there, of the right kind and within
//! its range: [`parse`]. Lengths stay as they were typed, because what `1%` or `2h` means depends on the model;
//! [`Node::resolve`] turns them into model units once that is known. `t` in a number's place is the share of a sequence of
//! frames that has passed, until [`Node::at_frame`] says how much that is. Which functions there are is said by one table ([`FUNCTIONS`]),
//! from which arguments are checked and help is printed.
//!
//! Operators are those of boolean expressions, with Python's precedence for sets: `-x` (not) binds tightest, then
//! `a - b` (without), `&` (and), `^` (exactly one), `|` (or); those of one level group from the left. They are short for
//! functions, and the tree knows only these.

mod check;
mod error;
mod help;
mod syntax;
mod table;
#[cfg(test)]
mod tests;
mod tree;

pub use error::LanguageError;
pub use help::{help, markdown};
pub use table::{Axis, FUNCTIONS, Function, Kind, List, Parameter, Presence, Preset, Signature};
pub use tree::{Argument, Call, Node, NodeKind, Place, Quantity, Span, Typed, Value};

/// The name that stands for the share of a sequence of frames that has passed; no operand can go by it.
pub const FRAME: &str = "t";

/// Parses and checks `text`, in which operand number n goes by the name `names[n]`.
///
/// # Errors
/// See [`LanguageError`]; also when one of the names is not used.
pub fn parse(text: &str, names: &[&str]) -> Result<Node, LanguageError> {
    let node = parse_some(text, names)?;
    let used = node.operands();
    let unused = names.iter().enumerate().filter(|(n, _)| !used.contains(n));
    let unused: Vec<String> = unused.map(|(_, name)| name.to_string()).collect();
    if unused.is_empty() { Ok(node) } else { Err(LanguageError::UnusedNames { names: unused }) }
}

/// The same for a text that need not use all names.
///
/// # Errors
/// See [`LanguageError`].
pub fn parse_some(text: &str, names: &[&str]) -> Result<Node, LanguageError> {
    if names.contains(&FRAME) {
        return Err(LanguageError::ReservedName);
    }
    let raw = syntax::parse(text)?;
    check::check(&raw, text, names)
}
