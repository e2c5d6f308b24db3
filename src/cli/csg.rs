//! `csg EXPR NAME=FILE... -o OUT`.

use clap::Args;
use std::path::Path;

use super::exit::{Exit, Failure};
use super::meant;
use super::report::RunReport;
use super::session::Session;
use super::solid::{self, Job};
use super::solid_args::SolidArgs;
use crate::field::language::{self, LanguageError};

/// What `csg --help` ends with.
pub const CSG_HELP: &str = "\
Operators, from the one that binds tightest, grouping from the left as in Python:
  a - b   inside a and not inside b
  a & b   inside both
  a ^ b   inside exactly one
  a | b   inside at least one
Parentheses group. A name is letters, digits and _, and begins with no digit.";

/// `csg EXPR NAME=FILE... -o OUT`.
#[derive(Debug, Args)]
pub struct CsgArgs {
    /// The expression over the names
    #[arg(value_name = "EXPR")]
    pub expression: String,
    /// A mesh and the name it goes by in the expression
    #[arg(value_name = "NAME=FILE", required = true)]
    pub operands: Vec<String>,
    /// Flags of the pipeline and its output.
    #[command(flatten)]
    pub solid: SolidArgs,
}

/// Evaluates the expression over the named files.
pub fn run(args: &CsgArgs, session: &Session, report: &mut RunReport) -> Result<Exit, Failure> {
    let operands = named_files(&args.operands)?;
    let names: Vec<&str> = operands.iter().map(|(name, _)| *name).collect();
    let expression = language::parse_boolean(&args.expression, &names).map_err(|e| explain(&args.expression, &e))?;
    let job = Job {
        change: None,
        leave: None,
        pick: None,
        paths: operands.iter().map(|(_, path)| *path).collect(),
        names: names.iter().map(|name| name.to_string()).collect(),
        expression,
        args: &args.solid,
    };
    solid::run(&job, session, report)
}

/// The paths of `NAME=FILE` arguments.
pub fn paths(operands: &[String]) -> Vec<&Path> {
    operands.iter().filter_map(|operand| operand.split_once('=')).map(|(_, path)| Path::new(path)).collect()
}

/// Names and paths of `NAME=FILE` arguments.
pub(super) fn named_files(operands: &[String]) -> Result<Vec<(&str, &Path)>, Failure> {
    let mut files: Vec<(&str, &Path)> = Vec::new();
    for operand in operands {
        let (name, path) = operand.split_once('=').filter(|(_, path)| !path.is_empty()).ok_or_else(|| {
            Failure::usage(format!("`{operand}` is not NAME=FILE")).hint(format!("for example a={operand}"))
        })?;
        if !language::is_name(name) {
            return Err(Failure::usage(format!("`{name}` in `{operand}` is not a name"))
                .hint("letters, digits and _, and no digit first"));
        }
        if files.iter().any(|(other, _)| *other == name) {
            return Err(Failure::usage(format!("the name `{name}` is given twice")));
        }
        files.push((name, Path::new(path)));
    }
    Ok(files)
}

/// The error with a caret below its place, and what could have been written.
pub(super) fn explain(text: &str, error: &LanguageError) -> Failure {
    let failure = match error.position() {
        Some(at) => {
            let column = text[..at].chars().count();
            // A control character would move the caret.
            let shown: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
            Failure::usage(format!("column {} of the expression: {error}", column + 1))
                .place(format!("  {shown}\n  {}^", " ".repeat(column)))
        }
        None => Failure::usage(error.to_string()),
    };
    match error.hint().or_else(|| near_length(text, error)) {
        Some(hint) => failure.hint(hint),
        None => failure,
    }
}

/// The length that may be meant where one is not understood.
fn near_length(text: &str, error: &LanguageError) -> Option<String> {
    let LanguageError::Quantity { at, .. } = error else { return None };
    let typed = text.get(*at..)?.split([',', ')', ';']).next()?;
    meant::length(typed.trim()).map(|near| format!("did you mean {near}?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operands_need_a_name_and_a_file() {
        let parse = |texts: &[&str]| {
            let owned: Vec<String> = texts.iter().map(|t| t.to_string()).collect();
            named_files(&owned).map(|files| files.len()).map_err(|f| f.message)
        };
        assert_eq!(parse(&["a=x.stl", "b=y=z.stl"]), Ok(2));
        assert_eq!(parse(&["x.stl"]), Err("`x.stl` is not NAME=FILE".into()));
        assert_eq!(parse(&["a="]), Err("`a=` is not NAME=FILE".into()));
        assert_eq!(parse(&["1a=x.stl"]), Err("`1a` in `1a=x.stl` is not a name".into()));
        assert_eq!(parse(&["a=x.stl", "a=y.stl"]), Err("the name `a` is given twice".into()));
    }

    #[test]
    fn the_caret_stands_below_the_place() {
        let error = language::parse_boolean("a - ü", &["a"]).unwrap_err();
        let failure = explain("a - ü", &error);
        assert_eq!(failure.message, "column 5 of the expression: expected a name, a function or `(`, found `ü`");
        assert_eq!(failure.place.as_deref(), Some("  a - ü\n      ^"));
    }

    #[test]
    fn errors_of_fields_are_shown_alike() {
        let error = language::parse("a | ofset(b, 1mm)", &["a", "b"]).unwrap_err();
        let failure = explain("a | ofset(b, 1mm)", &error);
        assert_eq!(failure.message, "column 5 of the expression: there is no function `ofset`");
        assert_eq!(failure.place.as_deref(), Some("  a | ofset(b, 1mm)\n      ^"));
        assert_eq!(failure.hint.as_deref(), Some("did you mean `offset`?"));
    }
}
