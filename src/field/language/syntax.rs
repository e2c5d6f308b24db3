//! From text to its grammatical form: nothing is looked up yet.

use winnow::ascii::{digit0, digit1};
use winnow::combinator::{
    Infix, alt, cut_err, delimited, dispatch, empty, expression, fail, opt, peek, preceded, repeat, separated,
    terminated,
};
use winnow::stream::{LocatingSlice, Location};
use winnow::token::{any, one_of, take_while};
use winnow::{ModalResult, Parser};

use super::error::LanguageError;
use super::functions::{COMPLEMENT, DIFFERENCE, INTERSECTION, SYMMETRIC_DIFFERENCE, UNION};
use super::tree::{Function, Span};

/// More parentheses in each other than this are refused, so that no text can exhaust the stack.
pub(super) const MAX_DEPTH: usize = 64;
/// More operators and separators than this are refused, for the same reason.
pub(super) const MAX_PARTS: usize = 1000;

/// A piece of text and its form.
#[derive(Debug)]
pub(super) struct Raw<'a> {
    pub span: Span,
    pub form: Form<'a>,
}

#[derive(Debug)]
pub(super) enum Form<'a> {
    Name(&'a str),
    /// Infinite where the digits are beyond all numbers.
    Quantity(f64, &'a str),
    /// What an operator is short for.
    Operator(&'static Function, Vec<Raw<'a>>),
    Call {
        name: &'a str,
        /// With the names of those that have one.
        arguments: Vec<(Option<&'a str>, Raw<'a>)>,
        /// What follows a `;`.
        list: Option<Raws<'a>>,
    },
}

/// Several in a row.
#[derive(Debug)]
pub(super) struct Raws<'a> {
    pub span: Span,
    pub items: Vec<Raw<'a>>,
}

type Input<'a> = LocatingSlice<&'a str>;

/// The form of `text`.
pub(super) fn parse(text: &str) -> Result<Raw<'_>, LanguageError> {
    check_size(text)?;
    preceded(spaces, tree).parse(LocatingSlice::new(text)).map_err(|e| syntax_error(text, e.offset()))
}

fn check_size(text: &str) -> Result<(), LanguageError> {
    let (mut depth, mut parts) = (0_usize, 0);
    for (at, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            '|' | '&' | '-' | '^' | ',' | ';' => parts += 1,
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Err(LanguageError::TooLong { at, limit: MAX_DEPTH, what: "parentheses inside each other" });
        }
        if parts > MAX_PARTS {
            return Err(LanguageError::TooLong { at, limit: MAX_PARTS, what: "operators and arguments" });
        }
    }
    Ok(())
}

fn spaces<'a>(input: &mut Input<'a>) -> ModalResult<&'a str> {
    take_while(0.., char::is_whitespace).parse_next(input)
}

fn tree<'a>(input: &mut Input<'a>) -> ModalResult<Raw<'a>> {
    let mut operator = terminated(any, spaces);
    // Without a second way to read anything, the first error is the error, and its place the place.
    expression(cut_err(operand))
        .infix(dispatch! { operator;
            '|' => Infix::Left(1, |_: &mut Input<'a>, a, b| Ok(join(&UNION, a, b))),
            '^' => Infix::Left(2, |_: &mut Input<'a>, a, b| Ok(join(&SYMMETRIC_DIFFERENCE, a, b))),
            '&' => Infix::Left(3, |_: &mut Input<'a>, a, b| Ok(join(&INTERSECTION, a, b))),
            '-' => Infix::Left(4, |_: &mut Input<'a>, a, b| Ok(join(&DIFFERENCE, a, b))),
            _ => fail,
        })
        .parse_next(input)
}

/// `a - b - c` is one difference of three: long chains make no deep trees.
fn join<'a>(operator: &'static Function, left: Raw<'a>, right: Raw<'a>) -> Raw<'a> {
    let span = Span { start: left.span.start, end: right.span.end };
    let fields = match left.form {
        Form::Operator(same, mut fields) if same == operator => {
            fields.push(right);
            fields
        }
        _ => vec![left, right],
    };
    Raw { span, form: Form::Operator(operator, fields) }
}

fn operand<'a>(input: &mut Input<'a>) -> ModalResult<Raw<'a>> {
    let start = input.current_token_start();
    let minuses: usize = repeat(0.., terminated('-', spaces)).parse_next(input)?;
    let mut raw = terminated(atom, spaces).parse_next(input)?;
    raw.span.start = start;
    if minuses % 2 == 1 {
        raw.form = match raw.form {
            Form::Quantity(value, suffix) => Form::Quantity(-value, suffix),
            form => Form::Operator(&COMPLEMENT, vec![Raw { span: raw.span, form }]),
        };
    }
    Ok(raw)
}

fn atom<'a>(input: &mut Input<'a>) -> ModalResult<Raw<'a>> {
    let form = dispatch! { peek(any);
        '(' => delimited(('(', spaces), tree.map(|raw| raw.form), ')'),
        '0'..='9' | '.' => quantity,
        _ => name_or_call,
    };
    form.with_span().map(|(form, range)| Raw { span: range.into(), form }).parse_next(input)
}

fn quantity<'a>(input: &mut Input<'a>) -> ModalResult<Form<'a>> {
    let digits = alt(((digit1, opt(('.', digit0))).void(), ('.', digit1).void()));
    let exponent = opt((one_of(['e', 'E']), opt(one_of(['+', '-'])), digit1));
    let number = (digits, exponent).take().parse_to::<f64>().parse_next(input)?;
    let mut suffix = opt(preceded(spaces, take_while(1.., |c: char| c.is_alphabetic() || matches!(c, '%' | '"'))));
    Ok(Form::Quantity(number, suffix.parse_next(input)?.unwrap_or_default()))
}

/// Whether `text` can be the name of an operand.
pub(super) fn is_name(text: &str) -> bool {
    name.parse(LocatingSlice::new(text)).is_ok()
}

fn name<'a>(input: &mut Input<'a>) -> ModalResult<&'a str> {
    let start = one_of(|c: char| c.is_ascii_alphabetic() || c == '_');
    (start, take_while(0.., |c: char| c.is_ascii_alphanumeric() || c == '_')).take().parse_next(input)
}

fn name_or_call<'a>(input: &mut Input<'a>) -> ModalResult<Form<'a>> {
    let name = name.parse_next(input)?;
    if opt((spaces, '(', spaces)).parse_next(input)?.is_none() {
        return Ok(Form::Name(name));
    }
    let arguments = dispatch! { peek(any);
        ')' | ';' => empty.map(|()| Vec::new()),
        _ => separated(1.., argument, (',', spaces)),
    }
    .parse_next(input)?;
    let items = separated(1.., tree, (',', spaces)).with_span();
    let items = items.map(|(items, range)| Raws { span: range.into(), items });
    let list = opt(preceded((';', spaces), items)).parse_next(input)?;
    ')'.parse_next(input)?;
    Ok(Form::Call { name, arguments, list })
}

fn argument<'a>(input: &mut Input<'a>) -> ModalResult<(Option<&'a str>, Raw<'a>)> {
    (opt(terminated(name, (spaces, '=', spaces))), tree).parse_next(input)
}

/// What is wrong at byte `at`, told from what stands before it.
fn syntax_error(text: &str, at: usize) -> LanguageError {
    let before = text[..at].trim_end().chars().next_back();
    let lone_point = text[..at].strip_suffix('.').is_some_and(|rest| !rest.ends_with(|c: char| c.is_ascii_digit()));
    let expected = match (before, innermost(&text[..at])) {
        _ if lone_point => "a digit",
        (Some(';'), _) => "a number",
        (Some(',' | '='), _) => "a name, a function, a number or `(`",
        (None | Some('(' | '|' | '&' | '-' | '^'), _) => "a name, a function or `(`",
        (_, Bracket::None) => "an operator (`|` `&` `-` `^`) or the end",
        (_, Bracket::Group) => "an operator (`|` `&` `-` `^`) or `)`",
        (_, Bracket::Call) => "`,`, an operator (`|` `&` `-` `^`) or `)`",
    };
    let found = match text[at..].chars().next() {
        None => "the end".into(),
        Some(c) => format!("`{}`", c.escape_debug()),
    };
    LanguageError::Syntax { at, expected, found }
}

enum Bracket {
    None,
    Group,
    Call,
}

/// What the last parenthesis that is still open belongs to.
fn innermost(text: &str) -> Bracket {
    let mut shut = 0_usize;
    for (at, c) in text.char_indices().rev() {
        match c {
            ')' => shut += 1,
            '(' if shut > 0 => shut -= 1,
            '(' => {
                let named = text[..at].trim_end().ends_with(|c: char| c.is_ascii_alphanumeric() || c == '_');
                return if named { Bracket::Call } else { Bracket::Group };
            }
            _ => {}
        }
    }
    Bracket::None
}
