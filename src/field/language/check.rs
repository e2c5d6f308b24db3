//! From the form of a text to its meaning: names, functions and arguments looked up, counted and ranged.

use super::FRAME;
use super::error::LanguageError;
use super::functions::{FUNCTIONS, by_name};
use super::syntax::{Form, Raw, Raws};
use super::table::{Axis, Kind, List, Parameter, Presence, Preset};
use super::tree::{Argument, Call, Function, Node, NodeKind, Quantity, Span, Typed, check_range};
use crate::nearest::nearest;

type Result<T> = std::result::Result<T, LanguageError>;

/// Of a piece of text, an error shows so many characters.
const SHOWN: usize = 24;

/// The tree of `raw`, which is the form of `text`, over operands that go by `names`.
pub(super) fn check(raw: &Raw<'_>, text: &str, names: &[&str]) -> Result<Node> {
    Checker { text, names }.field(raw, "the expression")
}

struct Checker<'a> {
    text: &'a str,
    names: &'a [&'a str],
}

/// The arguments of one call, by what they are for.
struct Sorted<'r, 'a> {
    fields: Vec<&'r Raw<'a>>,
    /// One for each parameter.
    parameters: Vec<Option<&'r Raw<'a>>>,
}

impl Checker<'_> {
    /// `raw` as a field, which is wanted for `what`.
    fn field(&self, raw: &Raw<'_>, what: &str) -> Result<Node> {
        let kind = match &raw.form {
            Form::Name(name) => self.operand(name, raw.span, what)?,
            Form::Quantity(value, _) => return Err(self.not_a_field(raw, *value, what)),
            Form::Operator(function, fields) => {
                let what = function.to_string();
                let fields = fields.iter().map(|field| self.field(field, &what)).collect::<Result<_>>()?;
                NodeKind::Call(Call { function, fields, arguments: Vec::new(), list: Vec::new() })
            }
            Form::Call { name, arguments, list } => {
                let function = by_name(name).ok_or_else(|| unknown_function(name, raw.span))?;
                NodeKind::Call(self.call(function, arguments, list.as_ref(), raw.span)?)
            }
        };
        Ok(Node { span: raw.span, kind })
    }

    fn operand(&self, name: &str, span: Span, what: &str) -> Result<NodeKind> {
        let at = span.start;
        if name == FRAME && !self.names.contains(&FRAME) {
            let wanted = "a field, and t is a number".into();
            return Err(LanguageError::WrongKind { at, what: what.into(), wanted, found: name.into() });
        }
        let known = || self.names.iter().map(|name| name.to_string()).collect();
        let operand = self.names.iter().position(|n| *n == name);
        let function = || by_name(name).map(Function::to_string);
        let unknown = || LanguageError::UnknownName { at, name: name.into(), known: known(), function: function() };
        let operand = operand.ok_or_else(unknown)?;
        Ok(NodeKind::Name { operand, name: name.into() })
    }

    fn call(
        &self,
        function: &'static Function,
        arguments: &[(Option<&str>, Raw<'_>)],
        list: Option<&Raws<'_>>,
        span: Span,
    ) -> Result<Call> {
        let sorted = sort(function, arguments)?;
        let mut fields = Vec::new();
        for (n, raw) in sorted.fields.iter().enumerate() {
            let what = match function.fields.get(n) {
                Some(name) => format!("{name} of {function}"),
                None => function.to_string(),
            };
            if function.takes_a_name() && !matches!(raw.form, Form::Name(_)) {
                let wanted = "the name of a file".into();
                return Err(LanguageError::WrongKind { at: raw.span.start, what, wanted, found: self.shown(raw.span) });
            }
            fields.push(self.field(raw, &what)?);
        }
        let missing = |what| LanguageError::Missing { at: span.end - 1, what, signature: function.to_string() };
        if let Some(what) = function.fields.get(fields.len()) {
            return Err(missing(what));
        }
        let pairs = function.parameters.iter().zip(&sorted.parameters);
        let arguments: Result<Vec<Typed>> = pairs
            .map(|(parameter, raw)| match raw {
                Some(raw) => self.argument(parameter, raw),
                None => left_away(parameter, span).ok_or_else(|| missing(parameter.name)),
            })
            .collect();
        let arguments = arguments?;
        check_rivals(function, &sorted.parameters)?;
        let list = self.list(function, list, fields.len(), span)?;
        Ok(Call { function, fields, arguments, list })
    }

    fn argument(&self, parameter: &Parameter, raw: &Raw<'_>) -> Result<Typed> {
        let argument = match (&raw.form, parameter.kind) {
            (Form::Quantity(value, suffix), kind) if kind != Kind::Axis => {
                let quantity = Quantity { value: *value, suffix: suffix.to_string() };
                if !value.is_finite() {
                    return Err(self.overflow(raw));
                }
                if matches!(kind, Kind::Number(..) | Kind::Count(..)) && !suffix.is_empty() {
                    return Err(self.wrong_kind(parameter, raw));
                }
                check_range(parameter, &quantity, raw.span)?;
                Some(Argument::Quantity(quantity))
            }
            (Form::Name(name), Kind::Axis) => {
                Axis::ALL.into_iter().find(|axis| axis.name() == *name).map(Argument::Axis)
            }
            (Form::Name(FRAME), Kind::Number(..)) => Some(Argument::Frame),
            _ => None,
        };
        match argument {
            Some(argument) => Ok(Typed { span: raw.span, argument }),
            None => Err(self.wrong_kind(parameter, raw)),
        }
    }

    /// The numbers after the `;` of a call with `count` fields.
    fn list(&self, function: &Function, given: Option<&Raws<'_>>, count: usize, call: Span) -> Result<Vec<f64>> {
        let wanted = if function.list == List::None { 0 } else { count };
        let numbers = match given {
            Some(raws) => raws.items.iter().map(|raw| self.number(raw)).collect::<Result<Vec<f64>>>()?,
            None if function.list == List::Weights => vec![1.0; count],
            None => Vec::new(),
        };
        let at = given.map_or(call.end - 1, |raws| raws.span.start);
        if numbers.len() != wanted {
            let found = numbers.len();
            return Err(LanguageError::WrongCount { at, signature: function.to_string(), wanted, found });
        }
        let sum = numbers.iter().sum::<f64>();
        if let Some(negative) = numbers.iter().find(|number| function.list == List::Weights && **number < 0.0) {
            let (what, wanted) = ("each weight".into(), "zero or more".into());
            return Err(LanguageError::OutOfRange { at, what, wanted, found: negative.to_string() });
        }
        if function.list == List::Weights && !(sum > 0.0 && sum.is_finite()) {
            let (what, wanted) = ("the sum of the weights".into(), "above zero".into());
            return Err(LanguageError::OutOfRange { at, what, wanted, found: sum.to_string() });
        }
        Ok(numbers)
    }

    fn number(&self, raw: &Raw<'_>) -> Result<f64> {
        match raw.form {
            Form::Quantity(value, "") if value.is_finite() => Ok(value),
            Form::Quantity(_, "") => Err(self.overflow(raw)),
            _ => Err(LanguageError::WrongKind {
                at: raw.span.start,
                what: "what follows the ;".into(),
                wanted: "plain numbers".into(),
                found: self.shown(raw.span),
            }),
        }
    }

    fn overflow(&self, raw: &Raw<'_>) -> LanguageError {
        LanguageError::Overflow { at: raw.span.start, text: self.shown(raw.span) }
    }

    fn wrong_kind(&self, parameter: &Parameter, raw: &Raw<'_>) -> LanguageError {
        let (what, wanted) = (parameter.name.into(), parameter.kind.to_string());
        LanguageError::WrongKind { at: raw.span.start, what, wanted, found: self.shown(raw.span) }
    }

    fn not_a_field(&self, raw: &Raw<'_>, value: f64, what: &str) -> LanguageError {
        if !value.is_finite() {
            return self.overflow(raw);
        }
        let (what, wanted) = (what.into(), "a field".into());
        LanguageError::WrongKind { at: raw.span.start, what, wanted, found: self.shown(raw.span) }
    }

    /// The text of `span`, shortened.
    fn shown(&self, span: Span) -> String {
        let text = self.text.get(span.start..span.end).unwrap_or_default();
        match text.char_indices().nth(SHOWN) {
            Some((end, _)) => format!("{}…", &text[..end]),
            None => text.into(),
        }
    }
}

/// Which argument is for what: fields first, then parameters in order, then parameters by name.
fn sort<'r, 'a>(function: &Function, arguments: &'r [(Option<&str>, Raw<'a>)]) -> Result<Sorted<'r, 'a>> {
    let room = if function.more_fields { arguments.len() } else { function.fields.len() };
    let mut sorted = Sorted { fields: Vec::new(), parameters: vec![None; function.parameters.len()] };
    let (mut next, mut named) = (0, false);
    for (name, raw) in arguments {
        let at = raw.span.start;
        let number = match name {
            Some(name) => {
                named = true;
                let number = function.parameters.iter().position(|parameter| parameter.name == *name);
                number.ok_or_else(|| unknown_parameter(function, name, at))?
            }
            None if named => return Err(LanguageError::Unnamed { at, signature: function.to_string() }),
            None if sorted.fields.len() < room => {
                sorted.fields.push(raw);
                continue;
            }
            None => {
                next += 1;
                next - 1
            }
        };
        let slot = sorted.parameters.get_mut(number);
        let slot = slot.ok_or_else(|| LanguageError::TooMany { at, signature: function.to_string() })?;
        if slot.replace(raw).is_some() {
            let name = function.parameters[number].name;
            return Err(LanguageError::GivenTwice { at, name, other: name });
        }
    }
    Ok(sorted)
}

/// Refuses a parameter that is given together with the one it replaces.
fn check_rivals(function: &Function, given: &[Option<&Raw<'_>>]) -> Result<()> {
    for (parameter, raw) in function.parameters.iter().zip(given) {
        let (Presence::InsteadOf(other), Some(raw)) = (parameter.presence, raw) else { continue };
        let both = function.parameters.iter().zip(given).any(|(p, raw)| p.name == other && raw.is_some());
        if both {
            return Err(LanguageError::GivenTwice { at: raw.span.start, name: parameter.name, other });
        }
    }
    Ok(())
}

/// What stands for a parameter that is not given; `None` if it must be.
fn left_away(parameter: &Parameter, span: Span) -> Option<Typed> {
    let argument = match parameter.presence {
        Presence::Required => return None,
        Presence::Optional | Presence::InsteadOf(_) => Argument::Absent,
        Presence::Default(Preset::Axis(axis)) => Argument::Axis(axis),
        Presence::Default(Preset::Quantity(value, suffix)) => {
            Argument::Quantity(Quantity { value, suffix: suffix.into() })
        }
    };
    Some(Typed { span, argument })
}

fn unknown_parameter(function: &Function, name: &str, at: usize) -> LanguageError {
    let nearest = nearest(name, function.parameters.iter().map(|parameter| parameter.name));
    LanguageError::UnknownParameter { at, name: name.into(), signature: function.to_string(), nearest }
}

fn unknown_function(name: &str, span: Span) -> LanguageError {
    let nearest = nearest(name, FUNCTIONS.iter().map(|function| function.name));
    LanguageError::UnknownFunction { at: span.start, name: name.into(), nearest }
}
