//! A row of the table of functions: what a function takes, what it gives, and how that is made.

use std::fmt;

use super::build::{BuildError, Site};
use super::functions::FUNCTIONS;
use super::tree::{Call, Value};
use crate::field::Shared;
use crate::ldi::Expression;

/// A function of the language: one row of [`FUNCTIONS`], which says all there is to say of it.
#[derive(Clone, Copy)]
pub struct Function {
    /// What it is called by.
    pub name: &'static str,
    /// What its fields are called where it is explained; as many are needed.
    pub fields: &'static [&'static str],
    /// Whether any number of fields may follow; then there are no parameters.
    pub more_fields: bool,
    /// What comes after the fields, in order.
    pub parameters: &'static [Parameter],
    /// What comes after a `;`.
    pub list: List,
    /// One line on what it gives.
    pub help: &'static str,
    /// Where its field comes from.
    pub gives: Gives,
    /// What it does to two solids, where it is a boolean operation; more solids are joined one after another, from the left.
    pub boolean: Option<Join>,
    /// Whether its values are no distances to a shape, but measures of something else.
    pub measure: bool,
}

/// Makes a boolean expression of two.
pub type Join = fn(Expression, Expression) -> Expression;

/// Makes the field of a call. The fields of the call are made already, and there are as many as the function needs.
pub type Build = fn(&Call<Value>, &[Shared], &mut Site<'_>) -> Result<Shared, BuildError>;

/// Where the field of a function comes from.
#[derive(Clone, Copy)]
pub enum Gives {
    /// It is made of the function's fields.
    Made(Build),
    /// It is an operand, read in a way of its own; the function's field must be the plain name of an operand.
    Read(Reading),
}

/// How an operand becomes a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reading {
    /// A grid as it is, a mesh by its exact distance, repaired first where it is no solid: what a plain name means.
    Usual,
    /// The distance to the nearest triangle.
    Exact,
    /// The field that repairs are made from.
    Robust,
    /// The distance to the nearest triangle, with sides by the outlines of horizontal slices.
    Levels,
}

/// One parameter of a function.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// What it is called by, as in `radius=2mm`.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Whether it can be left away.
    pub presence: Presence,
}

/// What a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// A length above zero.
    Length,
    /// A length of either sign.
    SignedLength,
    /// A coordinate along an axis: a length, or with `%` a share of the extent along that axis.
    Place,
    /// A number without a unit in this range, ends included; or the frame, `t`.
    Number(f64, f64),
    /// A whole number in this range, ends included.
    Count(u64, u64),
    /// `x`, `y` or `z`.
    Axis,
}

/// Whether a parameter can be left away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Presence {
    /// It cannot.
    Required,
    /// Then it is this.
    Default(Preset),
    /// Then it is absent, which means something of its own.
    Optional,
    /// The same, and it cannot be given together with the parameter of this name.
    InsteadOf(&'static str),
}

/// A default, as if it had been typed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Preset {
    /// A number and its suffix.
    Quantity(f64, &'static str),
    /// An axis.
    Axis(Axis),
}

/// An axis of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "they say what they are")]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    /// All of them, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    pub fn number(self) -> usize {
        self as usize
    }

    /// As it is typed.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self.number()]
    }
}

/// What a function takes after a `;`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum List {
    /// Nothing.
    None,
    /// A weight for each field, with a sum above zero; left away, all weigh the same.
    Weights,
    /// A value for each field.
    Values,
}

impl Function {
    /// The function that is called `name`.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        FUNCTIONS.iter().copied().find(|function| function.name == name)
    }

    /// Whether its field must be the plain name of an operand.
    pub fn takes_a_name(&self) -> bool {
        matches!(self.gives, Gives::Read(_))
    }
}

/// Functions are told apart by their names.
impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Function {}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Function").field(&self.name).finish()
    }
}
