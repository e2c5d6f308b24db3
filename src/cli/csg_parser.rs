//! `a - (b | c) & d`: the text of a boolean expression, parsed.
//!
//! The operators are Python's for sets, with Python's precedence: `-` (without) binds tightest,
//! then `&` (and), `^` (exactly one), `|` (or). Operators of one level group from the left.

use winnow::combinator::{Infix, cut_err, delimited, dispatch, expression, fail, peek, preceded, terminated};
use winnow::stream::Stream;
use winnow::token::{any, one_of, take_while};
use winnow::{ModalResult, Parser};

use crate::ldi::Expression;

/// More parentheses in each other than this are refused, so that no text can exhaust the stack.
const MAX_DEPTH: usize = 64;
/// More operators than this are refused, for the same reason.
const MAX_OPERATORS: usize = 1000;

/// Why the text is not an expression over the given names. Positions are bytes from the start.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExpressionError {
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
    /// The nesting or the number of operators is beyond what is reasonable.
    #[error("more than {limit} {what}")]
    TooLong {
        /// Where the limit is passed.
        at: usize,
        /// The limit.
        limit: usize,
        /// Of what.
        what: &'static str,
    },
    /// A name that no `NAME=FILE` gives.
    #[error("no file is given for `{name}`")]
    UnknownName {
        /// Where.
        at: usize,
        /// The name.
        name: String,
    },
    /// Files whose names the expression does not use.
    #[error("the expression does not use {}", .names.iter().map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", "))]
    UnusedNames {
        /// The names.
        names: Vec<String>,
    },
}

impl ExpressionError {
    /// Where in the text the error is, bytes from the start, if it is at one place.
    pub fn position(&self) -> Option<usize> {
        match self {
            Self::Syntax { at, .. } | Self::TooLong { at, .. } | Self::UnknownName { at, .. } => Some(*at),
            Self::UnusedNames { .. } => None,
        }
    }
}

/// An expression over names, as written.
#[derive(Debug)]
enum Node<'a> {
    Name { name: &'a str, rest: usize },
    Join { operator: char, left: Box<Node<'a>>, right: Box<Node<'a>> },
}

/// Parses `text`, in which operand number n goes by the name `names[n]`.
pub fn parse(text: &str, names: &[&str]) -> Result<Expression, ExpressionError> {
    check_size(text)?;
    let spaces = take_while(0.., char::is_whitespace);
    let tree = preceded(spaces, tree).parse(text).map_err(|e| syntax_error(text, e.offset()))?;
    let mut used = vec![false; names.len()];
    let expression = resolve(&tree, text.len(), names, &mut used)?;
    let unused: Vec<String> = names.iter().zip(&used).filter(|(_, used)| !**used).map(|(n, _)| n.to_string()).collect();
    if unused.is_empty() { Ok(expression) } else { Err(ExpressionError::UnusedNames { names: unused }) }
}

/// Whether `name` can stand in an expression.
pub fn is_name(name: &str) -> bool {
    name.starts_with(is_name_start) && name.chars().all(is_name_part)
}

fn is_name_start(c: char) -> bool {
    c.is_ascii_alphabetic() || c == '_'
}

fn is_name_part(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

fn is_operator(c: char) -> bool {
    matches!(c, '|' | '&' | '-' | '^')
}

fn check_size(text: &str) -> Result<(), ExpressionError> {
    let (mut depth, mut operators) = (0_usize, 0);
    for (at, c) in text.char_indices() {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            c if is_operator(c) => operators += 1,
            _ => {}
        }
        if depth > MAX_DEPTH {
            return Err(ExpressionError::TooLong { at, limit: MAX_DEPTH, what: "parentheses inside each other" });
        }
        if operators > MAX_OPERATORS {
            return Err(ExpressionError::TooLong { at, limit: MAX_OPERATORS, what: "operators" });
        }
    }
    Ok(())
}

fn tree<'a>(input: &mut &'a str) -> ModalResult<Node<'a>> {
    fn join<'a>(operator: char, left: Node<'a>, right: Node<'a>) -> ModalResult<Node<'a>> {
        Ok(Node::Join { operator, left: Box::new(left), right: Box::new(right) })
    }
    let mut operator = terminated(any, take_while(0.., char::is_whitespace));
    // Without a second way to read anything, the first error is the error, and its place the place.
    expression(cut_err(operand))
        .infix(dispatch! { operator;
            '|' => Infix::Left(1, |_: &mut &'a str, a, b| join('|', a, b)),
            '^' => Infix::Left(2, |_: &mut &'a str, a, b| join('^', a, b)),
            '&' => Infix::Left(3, |_: &mut &'a str, a, b| join('&', a, b)),
            '-' => Infix::Left(4, |_: &mut &'a str, a, b| join('-', a, b)),
            _ => fail,
        })
        .parse_next(input)
}

fn operand<'a>(input: &mut &'a str) -> ModalResult<Node<'a>> {
    let spaces = || take_while(0.., char::is_whitespace);
    let inner = dispatch! { peek(any);
        '(' => delimited(('(', spaces()), tree, ')'),
        _ => name,
    };
    terminated(inner, spaces()).parse_next(input)
}

fn name<'a>(input: &mut &'a str) -> ModalResult<Node<'a>> {
    let rest = input.eof_offset();
    let name = (one_of(is_name_start), take_while(0.., is_name_part)).take().parse_next(input)?;
    Ok(Node::Name { name, rest })
}

/// What is wrong at byte `at`, told from what stands before it.
fn syntax_error(text: &str, at: usize) -> ExpressionError {
    let before = text[..at].trim_end().chars().next_back();
    let open = text[..at].matches('(').count() > text[..at].matches(')').count();
    let expected = match before {
        None | Some('(' | '|' | '&' | '-' | '^') => "a name or `(`",
        _ if open => "an operator (`|` `&` `-` `^`) or `)`",
        _ => "an operator (`|` `&` `-` `^`) or the end",
    };
    let found = match text[at..].chars().next() {
        None => "the end".into(),
        Some(c) => format!("`{}`", c.escape_debug()),
    };
    ExpressionError::Syntax { at, expected, found }
}

fn resolve(node: &Node<'_>, length: usize, names: &[&str], used: &mut [bool]) -> Result<Expression, ExpressionError> {
    match node {
        Node::Name { name, rest } => match names.iter().position(|n| n == name) {
            Some(operand) => {
                used[operand] = true;
                Ok(Expression::Operand(operand))
            }
            None => Err(ExpressionError::UnknownName { at: length - rest, name: name.to_string() }),
        },
        Node::Join { operator, left, right } => {
            let left = resolve(left, length, names, used)?;
            let right = resolve(right, length, names, used)?;
            Ok(match operator {
                '|' => Expression::Union(vec![left, right]),
                '&' => Expression::Intersection(vec![left, right]),
                '-' => Expression::Difference(Box::new(left), Box::new(right)),
                _ => Expression::SymmetricDifference(Box::new(left), Box::new(right)),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NAMES: [&str; 4] = ["a", "b", "c", "d"];

    /// Truth of `text` for all 16 choices of what is inside a, b, c, d.
    fn table(text: &str) -> u16 {
        let only_used: Vec<&str> = NAMES.into_iter().filter(|n| text.contains(n)).collect();
        let expression = parse(text, &only_used).unwrap_or_else(|e| panic!("{text}: {e}"));
        (0..16_u16).fold(0, |bits, choice| {
            let inside: Vec<bool> =
                only_used.iter().map(|n| choice >> NAMES.iter().position(|m| m == n).unwrap() & 1 == 1).collect();
            bits | u16::from(expression.evaluate(&inside)) << choice
        })
    }

    #[test]
    fn precedence_is_that_of_python_sets() {
        assert_eq!(table("a | b & c"), table("a | (b & c)"));
        assert_eq!(table("a & b - c"), table("a & (b - c)"));
        assert_eq!(table("a - b & c"), table("(a - b) & c"));
        assert_eq!(table("a ^ b | c"), table("(a ^ b) | c"));
        assert_eq!(table("a | b ^ c & d"), table("a | (b ^ (c & d))"));
        assert_eq!(table("a - b - c"), table("(a - b) - c"));
        assert_ne!(table("a - b - c"), table("a - (b - c)"));
        assert_eq!(table("  a-(b|c)&d "), table("(a - (b | c)) & d"));
    }

    fn place(text: &str) -> (usize, String) {
        let error = parse(text, &NAMES).unwrap_err();
        (error.position().unwrap(), error.to_string())
    }

    #[test]
    fn errors_name_the_place_and_what_was_expected() {
        assert_eq!(place(""), (0, "expected a name or `(`, found the end".into()));
        assert_eq!(place("a - "), (4, "expected a name or `(`, found the end".into()));
        assert_eq!(place("a - * b"), (4, "expected a name or `(`, found `*`".into()));
        assert_eq!(place("a b"), (2, "expected an operator (`|` `&` `-` `^`) or the end, found `b`".into()));
        assert_eq!(place("(a | b"), (6, "expected an operator (`|` `&` `-` `^`) or `)`, found the end".into()));
        assert_eq!(place("a | b)"), (5, "expected an operator (`|` `&` `-` `^`) or the end, found `)`".into()));
        assert_eq!(place("()"), (1, "expected a name or `(`, found `)`".into()));
        assert_eq!(place("a | bb"), (4, "no file is given for `bb`".into()));
        assert_eq!(place("a | é"), (4, "expected a name or `(`, found `é`".into()));
        assert_eq!(place("2a"), (0, "expected a name or `(`, found `2`".into()));
    }

    #[test]
    fn unused_names_are_listed() {
        let error = parse("a | c", &NAMES).unwrap_err();
        assert_eq!(error, ExpressionError::UnusedNames { names: vec!["b".into(), "d".into()] });
        assert_eq!(error.to_string(), "the expression does not use `b`, `d`");
    }

    #[test]
    fn monstrous_expressions_are_refused_before_they_recurse() {
        let deep = "(".repeat(100_000);
        assert!(matches!(parse(&deep, &NAMES), Err(ExpressionError::TooLong { at: MAX_DEPTH, .. })));
        let long = vec!["a"; 100_000].join("-");
        assert!(matches!(parse(&long, &NAMES), Err(ExpressionError::TooLong { limit: MAX_OPERATORS, .. })));
        let longest_allowed = vec!["a"; MAX_OPERATORS + 1].join("-");
        assert!(parse(&longest_allowed, &["a"]).is_ok());
    }

    proptest! {
        /// Fully parenthesised text means what it says, spaces or not.
        #[test]
        fn parenthesised_text_is_its_tree(seed in proptest::collection::vec(0_u8..4, 1..12), space in 0_usize..3) {
            let pad = " ".repeat(space);
            let mut text = "a".to_string();
            let mut expected = Expression::Operand(0);
            for (n, choice) in seed.iter().enumerate() {
                let operand = (n + 1) % 4;
                let symbol = ['|', '&', '-', '^'][*choice as usize];
                text = format!("({text}{pad}{symbol}{pad}{})", NAMES[operand]);
                let right = Expression::Operand(operand);
                expected = match symbol {
                    '|' => Expression::Union(vec![expected, right]),
                    '&' => Expression::Intersection(vec![expected, right]),
                    '-' => Expression::Difference(Box::new(expected), Box::new(right)),
                    _ => Expression::SymmetricDifference(Box::new(expected), Box::new(right)),
                };
            }
            let used = &NAMES[..NAMES.len().min(seed.len() + 1)];
            prop_assert_eq!(parse(&text, used).unwrap(), expected);
        }

        /// Any text at all gives an expression or an error inside it.
        #[test]
        fn any_text_is_answered(text in "[a-d()|&^ -]{0,40}|\\PC{0,20}") {
            if let Err(error) = parse(&text, &NAMES) {
                prop_assert!(error.position().is_none_or(|at| text.is_char_boundary(at)));
            }
        }
    }
}
