//! `blend(a, b, 2mm) - offset(c, -0.4mm)`: the text of a field, parsed and checked.
//!
//! A text becomes a tree of [`Call`]s over operands, in which every argument is there, of the right kind and within
//! its range: [`parse`]. Lengths stay as they were typed, because what `1%` or `2h` means depends on the model;
//! [`Node::resolve`] turns them into model units once that is known. `t` in a number's place is the share of a sequence of
//! frames that has passed, until [`Node::at_frame`] says how much that is. Which functions there are is said by one table ([`FUNCTIONS`]),
//! from which arguments are checked, help is printed and fields are made ([`build`]).
//!
//! Operators are those of boolean expressions, with Python's precedence for sets: `-x` (not) binds tightest, then
//! `a - b` (without), `&` (and), `^` (exactly one), `|` (or); those of one level group from the left. They are short for
//! functions, and the tree knows only these.
//!
//! A text of operators and names alone is a boolean expression as well: [`parse_boolean`], [`Node::boolean`].

mod build;
mod check;
mod error;
mod functions;
mod help;
mod site;
mod syntax;
mod table;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_boolean;
mod tree;

use crate::ldi::Expression;
pub use build::{build, shape_extent};
pub use error::LanguageError;
pub use functions::{FUNCTIONS, by_name};
pub use help::{help, markdown};
pub use site::{BuildError, MakeLattice, Operands, Site};
pub use table::{Axis, Kind, List, Parameter, Presence, Preset, Reading};
pub use tree::{Argument, Build, Call, Function, Gives, Join, Node, NodeKind, Place, Quantity, Span, Typed, Value};

/// The name that stands for the share of a sequence of frames that has passed; no operand can go by it.
pub const FRAME: &str = "t";

/// Whether `text` can be the name of an operand: letters, digits and `_`, and no digit first.
pub fn is_name(text: &str) -> bool {
    syntax::is_name(text)
}

/// Parses and checks `text`, in which operand number n goes by the name `names[n]`.
///
/// # Errors
/// See [`LanguageError`]; also when one of the names is not used.
pub fn parse(text: &str, names: &[&str]) -> Result<Node, LanguageError> {
    let node = parse_some(text, names)?;
    all_used(&node, names)?;
    Ok(node)
}

/// The same for a text that need not use all names.
///
/// # Errors
/// See [`LanguageError`].
pub fn parse_some(text: &str, names: &[&str]) -> Result<Node, LanguageError> {
    if names.contains(&FRAME) {
        return Err(LanguageError::ReservedName);
    }
    check::check(&syntax::parse(text)?, text, names)
}

/// Parses `text` as a boolean expression. There are no frames in it, so that an operand can go by the name `t`.
///
/// ```
/// use meshwright::field::language::parse_boolean;
///
/// let without = parse_boolean("a - (b | c)", &["a", "b", "c"])?;
/// assert!(without.evaluate(&[true, false, false]));
/// assert!(!without.evaluate(&[true, false, true]));
/// # Ok::<(), meshwright::field::language::LanguageError>(())
/// ```
///
/// # Errors
/// See [`LanguageError`]; also when one of the names is not used, and for functions that are no boolean operations.
pub fn parse_boolean(text: &str, names: &[&str]) -> Result<Expression, LanguageError> {
    let node = check::check(&syntax::parse(text)?, text, names)?;
    let expression = node.boolean()?;
    all_used(&node, names)?;
    Ok(expression)
}

fn all_used(node: &Node, names: &[&str]) -> Result<(), LanguageError> {
    let used = node.operands();
    let unused = names.iter().enumerate().filter(|(n, _)| !used.contains(n));
    let unused: Vec<String> = unused.map(|(_, name)| name.to_string()).collect();
    if unused.is_empty() { Ok(()) } else { Err(LanguageError::UnusedNames { names: unused }) }
}
