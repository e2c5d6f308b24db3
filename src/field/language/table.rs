//! What the table of functions says of parameters, lists and operands.

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
