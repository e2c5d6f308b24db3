//! The checked tree, and its lengths in model units.

use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;

use super::error::LanguageError;
use super::site::{BuildError, Site};
use super::table::{Axis, Kind, List, Parameter, Reading};
use crate::field::Shared;
use crate::ldi::Expression;

/// A piece of the text, in bytes from its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// Its first byte.
    pub start: usize,
    /// The byte after its last.
    pub end: usize,
}

impl From<Range<usize>> for Span {
    fn from(range: Range<usize>) -> Self {
        Self { start: range.start, end: range.end }
    }
}

/// A field: an operand, or what a function makes of fields. Arguments are as typed, or resolved: `Node<Value>`.
#[derive(Debug, Clone, PartialEq)]
pub struct Node<A = Typed> {
    /// Where it stands in the text.
    pub span: Span,
    /// What it is.
    pub kind: NodeKind<A>,
}

/// What a [`Node`] is.
#[derive(Debug, Clone, PartialEq)]
pub enum NodeKind<A = Typed> {
    /// One of the operands.
    Name {
        /// Its number.
        operand: usize,
        /// Its name.
        name: String,
    },
    /// A function of fields.
    Call(Call<A>),
}

/// A call of a function, with all that the function asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Call<A = Typed> {
    /// Of which function.
    pub function: &'static Function,
    /// Its fields, as many as the function asks for.
    pub fields: Vec<Node<A>>,
    /// Its arguments, one for each parameter of the function.
    pub arguments: Vec<A>,
    /// Weights or values, one for each field; empty for functions that take none.
    pub list: Vec<f64>,
}

/// A function of the language: one row of [`FUNCTIONS`](super::FUNCTIONS), which says all there is to say of it.
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

impl Function {
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

/// An argument as it was typed.
#[derive(Debug, Clone, PartialEq)]
pub struct Typed {
    /// Where it stands in the text; for what was left away, where the call stands.
    pub span: Span,
    /// What it is.
    pub argument: Argument,
}

/// What was typed, or stands in the table for what was left away.
#[derive(Debug, Clone, PartialEq)]
pub enum Argument {
    /// A number, perhaps with a unit.
    Quantity(Quantity),
    /// An axis.
    Axis(Axis),
    /// The share of a sequence of frames that has passed.
    Frame,
    /// Nothing: an optional parameter that is not given.
    Absent,
}

/// A number and what stands behind it: `0.4mm`, `1%`, `3`.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The number, finite.
    pub value: f64,
    /// Letters, `%`, or nothing.
    pub suffix: String,
}

/// An argument that needs nothing more to be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value {
    /// Of [`Kind::Length`] and [`Kind::SignedLength`]: model units, finite.
    Length(f64),
    /// Of [`Kind::Place`].
    Place(Place),
    /// Of [`Kind::Number`], within its range.
    Number(f64),
    /// Of [`Kind::Count`], within its range.
    Count(u64),
    /// Of [`Kind::Axis`].
    Axis(Axis),
    /// Not given.
    Absent,
}

/// A coordinate along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// Model units.
    At(f64),
    /// A share of the extent along the axis: 0 is its lower end, 1 its upper.
    Share(f64),
}

impl<A> Call<A> {
    /// The argument for the parameter called `name`; `None` if the function has none of that name.
    pub fn argument(&self, name: &str) -> Option<&A> {
        let number = self.function.parameters.iter().position(|parameter| parameter.name == name)?;
        self.arguments.get(number)
    }
}

impl Call<Value> {
    /// The length called `name`, model units; `None` where it is absent.
    pub fn length(&self, name: &str) -> Option<f64> {
        if let Value::Length(length) = self.argument(name)? { Some(*length) } else { None }
    }

    /// The length called `name`, model units; zero where it is absent.
    pub fn length_or_zero(&self, name: &str) -> f64 {
        self.length(name).unwrap_or_default()
    }

    /// The number called `name`.
    pub fn number(&self, name: &str) -> Option<f64> {
        if let Value::Number(number) = self.argument(name)? { Some(*number) } else { None }
    }

    /// The whole number called `name`.
    pub fn count(&self, name: &str) -> Option<u64> {
        if let Value::Count(count) = self.argument(name)? { Some(*count) } else { None }
    }

    /// The axis called `name`.
    pub fn axis(&self, name: &str) -> Option<Axis> {
        if let Value::Axis(axis) = self.argument(name)? { Some(*axis) } else { None }
    }

    /// The number of the axis called `name`, 0 to 2; that of z where the function has none.
    pub fn axis_or_z(&self, name: &str) -> usize {
        self.axis(name).unwrap_or(Axis::Z).number()
    }

    /// The coordinate called `name`.
    pub fn place(&self, name: &str) -> Option<Place> {
        if let Value::Place(place) = self.argument(name)? { Some(*place) } else { None }
    }
}

impl Node {
    /// Where `t` first stands, if it does: then the text is one of a sequence.
    pub fn frame(&self) -> Option<Span> {
        let NodeKind::Call(call) = &self.kind else { return None };
        let of_fields = call.fields.iter().filter_map(Self::frame);
        let own = call.arguments.iter().filter(|typed| typed.argument == Argument::Frame).map(|typed| typed.span);
        of_fields.chain(own).min_by_key(|span| span.start)
    }

    /// The same with the number `t` for the frame.
    ///
    /// # Errors
    /// [`LanguageError::OutOfRange`] where a parameter does not take that number.
    pub fn at_frame(&self, t: f64) -> Result<Self, LanguageError> {
        self.map(&mut |what, typed| {
            let Argument::Frame = typed.argument else { return Ok(typed.clone()) };
            let quantity = Quantity { value: t, suffix: String::new() };
            check_range(what, &quantity, typed.span)?;
            Ok(Typed { span: typed.span, argument: Argument::Quantity(quantity) })
        })
    }

    /// The same with all arguments ready for use. `length` says what a number with a suffix is in model units, or why it
    /// is nothing; it is asked about lengths only.
    ///
    /// # Errors
    /// At the place of the argument: what `length` says, a length that must be above zero and is not, or `t`.
    pub fn resolve(
        &self,
        mut length: impl FnMut(f64, &str) -> Result<f64, String>,
    ) -> Result<Node<Value>, LanguageError> {
        self.map(&mut |what, typed| match &typed.argument {
            Argument::Quantity(quantity) => resolve(what, quantity, typed.span, &mut length),
            Argument::Axis(axis) => Ok(Value::Axis(*axis)),
            Argument::Frame => Err(LanguageError::NoFrame { at: typed.span.start }),
            Argument::Absent => Ok(Value::Absent),
        })
    }
}

impl<A> Node<A> {
    /// Whether its values are no distances to a shape, but measures of something else.
    pub fn is_measure(&self) -> bool {
        let of_call = |call: &Call<A>| call.function.measure || call.fields.iter().any(Self::is_measure);
        matches!(&self.kind, NodeKind::Call(call) if of_call(call))
    }

    /// The numbers of the operands that it uses.
    pub fn operands(&self) -> BTreeSet<usize> {
        match &self.kind {
            NodeKind::Name { operand, .. } => BTreeSet::from([*operand]),
            NodeKind::Call(call) => call.fields.iter().flat_map(Self::operands).collect(),
        }
    }

    /// Which operands it uses, and how each is read; in the order in which they stand in the text.
    pub fn readings(&self) -> Vec<(usize, Reading)> {
        let call = match &self.kind {
            NodeKind::Name { operand, .. } => return vec![(*operand, Reading::Usual)],
            NodeKind::Call(call) => call,
        };
        let of_fields = call.fields.iter().flat_map(Self::readings);
        match call.function.gives {
            Gives::Made(_) => of_fields.collect(),
            Gives::Read(reading) => of_fields.map(|(operand, _)| (operand, reading)).collect(),
        }
    }

    /// The boolean expression that it is, over the same operands.
    ///
    /// # Errors
    /// [`LanguageError::NotBoolean`] at the first function that is no boolean operation.
    pub fn boolean(&self) -> Result<Expression, LanguageError> {
        let call = match &self.kind {
            NodeKind::Name { operand, .. } => return Ok(Expression::Operand(*operand)),
            NodeKind::Call(call) => call,
        };
        let other = || LanguageError::NotBoolean { at: self.span.start, function: call.function.to_string() };
        let join = call.function.boolean.ok_or_else(other)?;
        let parts = call.fields.iter().map(Self::boolean).collect::<Result<Vec<_>, _>>()?;
        parts.into_iter().reduce(join).ok_or_else(other)
    }

    /// The same tree with other arguments.
    fn map<B>(&self, change: &mut Change<'_, A, B>) -> Result<Node<B>, LanguageError> {
        let kind = match &self.kind {
            NodeKind::Name { operand, name } => NodeKind::Name { operand: *operand, name: name.clone() },
            NodeKind::Call(Call { function, fields, arguments, list }) => {
                let fields = fields.iter().map(|field| field.map(change)).collect::<Result<_, _>>()?;
                let pairs = function.parameters.iter().zip(arguments);
                let arguments = pairs.map(|(what, argument)| change(what, argument)).collect::<Result<_, _>>()?;
                NodeKind::Call(Call { function, fields, arguments, list: list.clone() })
            }
        };
        Ok(Node { span: self.span, kind })
    }
}

type Change<'c, A, B> = dyn FnMut(&Parameter, &A) -> Result<B, LanguageError> + 'c;

/// Whether `quantity` can be what `parameter` takes, as far as this can be told without the model.
pub(super) fn check_range(parameter: &Parameter, quantity: &Quantity, span: Span) -> Result<(), LanguageError> {
    let value = quantity.value;
    let right = match parameter.kind {
        Kind::Length => value > 0.0,
        Kind::Number(from, to) => (from..=to).contains(&value),
        Kind::Count(from, to) => value.fract() == 0.0 && (from as f64..=to as f64).contains(&value),
        Kind::SignedLength | Kind::Place | Kind::Axis => true,
    };
    if right { Ok(()) } else { Err(out_of_range(parameter, quantity.to_string(), span)) }
}

fn out_of_range(parameter: &Parameter, found: String, span: Span) -> LanguageError {
    let (what, wanted) = (parameter.name.into(), parameter.kind.to_string());
    LanguageError::OutOfRange { at: span.start, what, wanted, found }
}

fn resolve(
    parameter: &Parameter,
    quantity: &Quantity,
    span: Span,
    length: &mut impl FnMut(f64, &str) -> Result<f64, String>,
) -> Result<Value, LanguageError> {
    let mut in_model_units = || {
        let reason = |reason| LanguageError::Quantity { at: span.start, reason };
        let length = length(quantity.value, &quantity.suffix).map_err(reason)?;
        let right = length.is_finite() && (parameter.kind != Kind::Length || length > 0.0);
        if right { Ok(length) } else { Err(out_of_range(parameter, format!("{quantity} = {length}"), span)) }
    };
    Ok(match parameter.kind {
        Kind::Number(..) => Value::Number(quantity.value),
        Kind::Count(..) => Value::Count(quantity.value as u64),
        Kind::Place if quantity.suffix == "%" => Value::Place(Place::Share(quantity.value / 100.0)),
        Kind::Place => Value::Place(Place::At(in_model_units()?)),
        // No quantity stands for an axis, see `check`.
        Kind::Length | Kind::SignedLength | Kind::Axis => Value::Length(in_model_units()?),
    })
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.value, self.suffix)
    }
}

/// As functions of fields, with the arguments that have defaults; parsed again, it is the same tree.
impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.kind {
            NodeKind::Name { name, .. } => f.write_str(name),
            NodeKind::Call(call) => call.fmt(f),
        }
    }
}

impl fmt::Display for Call {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let function = self.function;
        write!(f, "{}(", function.name)?;
        let (mut separator, mut named) = ("", false);
        for field in &self.fields {
            write!(f, "{separator}{field}")?;
            separator = ", ";
        }
        for (parameter, typed) in function.parameters.iter().zip(&self.arguments) {
            let text = match &typed.argument {
                Argument::Quantity(quantity) => quantity.to_string(),
                Argument::Axis(axis) => axis.to_string(),
                Argument::Frame => super::FRAME.to_string(),
                Argument::Absent => {
                    named = true;
                    continue;
                }
            };
            f.write_str(separator)?;
            if named {
                write!(f, "{}=", parameter.name)?;
            }
            f.write_str(&text)?;
            separator = ", ";
        }
        if function.list != List::None {
            let numbers: Vec<String> = self.list.iter().map(f64::to_string).collect();
            write!(f, "; {}", numbers.join(", "))?;
        }
        f.write_str(")")
    }
}
