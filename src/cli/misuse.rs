//! Command lines that are not understood, in words that say what to type.

use std::ffi::OsString;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{Command, CommandFactory};

use super::args::{Cli, parse};
use super::choices::AnyFormat;
use super::exit::Failure;
use super::meant;
use super::typed::{line, named};

/// What is wrong with `arguments` (the program's name left out), where more can be said than the parser's `error` does.
pub fn explain(error: &clap::Error, arguments: &[OsString]) -> Option<Failure> {
    let told = |kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let command = Cli::command();
    let words: Vec<String> = arguments.iter().map(|word| word.to_string_lossy().into_owned()).collect();
    if let Some(word) = told(ContextKind::InvalidSubcommand).filter(|word| !is_a_mesh(word)) {
        return Some(unknown_verb(&word, &command));
    }
    let Some(verb) = words.iter().find_map(|word| command.find_subcommand(word)) else {
        let after_a_flag = |n: usize| n > 0 && words[n - 1].starts_with('-');
        let mut files = (0..words.len()).filter(|&n| !words[n].starts_with('-') && is_a_mesh(&words[n]));
        let file = files.clone().find(|&n| !after_a_flag(n)).or_else(|| files.next())?;
        return Some(no_verb(&words[file]));
    };
    match error.kind() {
        ErrorKind::UnknownArgument => {
            let word = told(ContextKind::InvalidArg)?;
            match word.starts_with('-') {
                true => unknown_flag(error, verb, &word, &command),
                false => one_too_many(verb, &word, &words),
            }
        }
        ErrorKind::ValueValidation => wrong_value(error, arguments),
        ErrorKind::WrongNumberOfValues | ErrorKind::TooFewValues if takes_several(verb) => Some(
            Failure::usage(format!("`{}` combines two files or more, and one was given", verb.get_name()))
                .hint("`meshwright repair` makes one solid of all that is in one file"),
        ),
        _ => None,
    }
}

/// What the parser says, as one failure.
pub fn in_words(error: &clap::Error) -> Failure {
    let text = error.to_string();
    let (said, rest) = text.split_once("\n\n").unwrap_or((&text, ""));
    let said = said.strip_prefix("error: ").unwrap_or(said).trim();
    let tip = rest.lines().find_map(|line| line.trim().strip_prefix("tip: "));
    let failure = Failure::usage(said.split_whitespace().collect::<Vec<_>>().join(" "));
    match tip {
        Some(tip) => failure.hint(tip),
        None => failure,
    }
}

fn unknown_verb(word: &str, program: &Command) -> Failure {
    Failure::usage(format!("`{word}` is no verb")).hint(match meant::verb(word, program) {
        Some(verb) => format!("did you mean `{verb}`?"),
        None => "`meshwright --help` lists all verbs".into(),
    })
}

/// A flag that the verb does not have, where another verb has it, or one is near that the parser has not found.
fn unknown_flag(error: &clap::Error, verb: &Command, word: &str, program: &Command) -> Option<Failure> {
    let is_of_others = program.get_subcommands().flat_map(Command::get_arguments).any(|argument| {
        argument.get_long().is_some_and(|long| word.strip_prefix("--") == Some(long))
            || argument.get_short().is_some_and(|short| word == format!("-{short}"))
    });
    if error.get(ContextKind::SuggestedArg).is_some() && !is_of_others {
        return None;
    }
    let hint = meant::flag(word, verb, program)?;
    Some(Failure::usage(format!("`{}` has no flag {word}", verb.get_name())).hint(hint))
}

/// A value that is not understood, where one is near that is.
fn wrong_value(error: &clap::Error, arguments: &[OsString]) -> Option<Failure> {
    let told = |error: &clap::Error, kind| match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text.clone()),
        _ => None,
    };
    let (flag, value) = (told(error, ContextKind::InvalidArg)?, told(error, ContextKind::InvalidValue)?);
    let kind = flag.split_once(['<']).and_then(|(_, name)| name.split_once('>')).map(|(name, _)| name)?;
    let is_understood = |near: &String| {
        let replaced = arguments.iter().map(|word| match word.to_str() {
            Some(word) if word == value => near.into(),
            Some(word) if word.starts_with('-') => match word.split_once('=') {
                Some((name, given)) if given == value => format!("{name}={near}").into(),
                _ => word.into(),
            },
            _ => word.clone(),
        });
        match parse(std::iter::once("meshwright".into()).chain(replaced)) {
            Ok(_) => true,
            Err(other) => told(&other, ContextKind::InvalidArg).as_ref() != Some(&flag),
        }
    };
    let near = meant::values(kind, &value).into_iter().find(is_understood)?;
    let text = error.render().to_string();
    let first = text.lines().next().unwrap_or_default();
    Some(Failure::usage(first.strip_prefix("error: ").unwrap_or(first)).hint(format!("did you mean {near}?")))
}

/// Whether a word is a file, or is named as one.
fn is_a_mesh(word: &str) -> bool {
    let path = Path::new(word);
    AnyFormat::from_path(path).is_some() || path.is_file()
}

fn no_verb(file: &str) -> Failure {
    let command = |words: &[&str]| line(words.iter().map(ToString::to_string));
    Failure::usage(format!("what to do with {file} is not said: a verb comes first")).hint(format!(
        "`{}` mends it, `{}` says what is wrong with it",
        command(&["repair", file, "-o", &named(file, "repaired")]),
        command(&["inspect", file])
    ))
}

/// Whether a verb takes any number of files.
fn takes_several(verb: &Command) -> bool {
    matches!(verb.get_name(), "union" | "intersection" | "difference")
}

fn one_too_many(verb: &Command, extra: &str, words: &[String]) -> Option<Failure> {
    let files: Vec<_> = verb.get_positionals().collect();
    if files.is_empty() || takes_several(verb) || !is_a_mesh(extra) {
        return None;
    }
    let name = verb.get_name();
    let has_output = words.iter().any(|word| word == "-o" || word.starts_with("--output"));
    let wants_output = verb.get_arguments().any(|argument| argument.get_id() == "output");
    if wants_output && !has_output && !Path::new(extra).exists() {
        return Some(
            Failure::usage(format!("`{name}` takes its output after -o, and {extra} stands without it"))
                .hint(format!("-o {extra}")),
        );
    }
    let count = if files.len() == 1 { "one file" } else { "no more than two files" };
    let failure = Failure::usage(format!("`{name}` takes {count}, and {extra} is one more"));
    let each = format!("`meshwright batch {name} IN... --out DIR` runs it for each");
    Some(match (name, files.len()) {
        ("repair", _) => failure.hint(format!("`meshwright union` makes one solid of several files; {each}")),
        ("split", _) => failure,
        (_, 1) => failure.hint(each),
        _ => failure,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn explained(line: &str) -> String {
        let arguments: Vec<OsString> = line.split_whitespace().map(OsString::from).collect();
        let error = Cli::try_parse_from(std::iter::once(OsString::from("meshwright")).chain(arguments.clone()))
            .expect_err("it is no command line");
        explain(&error, &arguments).map_or(String::new(), |f| format!("{}\n{}", f.message, f.hint.unwrap_or_default()))
    }

    #[test]
    fn what_to_type_is_said() {
        for (line, words) in [
            ("part.stl", "meshwright repair part.stl -o part_repaired.stl"),
            ("-o fixed.stl sub/part.3mf", "meshwright repair sub/part.3mf -o sub/part_repaired.3mf"),
            ("repair a.stl b.stl -o c.stl", "meshwright union"),
            ("fix a.stl b.stl c.stl -o d.stl", "`repair` takes one file, and b.stl is one more"),
            ("repair a.stl b.stl", "-o b.stl"),
            ("inspect a.stl b.stl", "`meshwright batch inspect IN... --out DIR` runs it for each"),
            ("compare a.stl b.stl c.stl", "no more than two files"),
            ("union a.stl -o b.stl", "meshwright repair"),
            ("subtract a.stl -o b.stl", "`difference` combines two files or more"),
        ] {
            assert!(explained(line).contains(words), "{line}: {}", explained(line));
        }
        for line in ["repair a.stl --wrong -o b.stl", "repair a.stl -o", "union --resolution 7"] {
            assert_eq!(explained(line), "", "{line}");
        }
    }

    #[test]
    fn what_is_near_is_said_and_nothing_else() {
        for (line, message, hint) in [
            ("reapir a.stl -o b.stl", "`reapir` is no verb", "did you mean `repair`?"),
            ("substract a.stl b.stl -o c.stl", "`substract` is no verb", "did you mean `difference`?"),
            ("mend a.stl", "`mend` is no verb", "`meshwright --help` lists all verbs"),
            (
                "inspect a.stl --keep-partial",
                "`inspect` has no flag --keep-partial",
                "it is a flag of `repair`, `union`",
            ),
            ("repair a.stl -o b.stl --max-deviation 1", "has no flag --max-deviation", "it is a flag of `decimate`"),
            (
                "inspect a.stl --max-deviaton 1",
                "has no flag --max-deviaton",
                "did you mean --max-deviation? it is a flag of",
            ),
            ("repair a.stl -o b.stl -w 2", "`repair` has no flag -w", "it is a flag of `hollow`"),
            ("dilate a.stl -o b.stl -R 2", "`dilate` has no flag -R", "did you mean -r?"),
            ("repair a.stl -o b.stl --voxel 0.4mn", "`0.4mn` is not a length", "did you mean 0.4mm?"),
            ("repair a.stl -o b.stl --voxel=0.4mn", "`0.4mn` is not a length", "did you mean 0.4mm?"),
            ("repair a.stl -o b.stl --unit inhc", "is no unit of length", "did you mean inch?"),
            ("repair a.stl -o b.stl --out-format sltt", "is no format known here", "did you mean stl?"),
            ("repair a.stl -o b.stl --simplify of", "is not a length", "did you mean off?"),
            ("repair a.stl -o b.stl --timeout 5mn", "is not a duration", "did you mean 5min?"),
            ("render a.stl -o b.png --view fornt", "wanted one of iso", "did you mean front?"),
            ("render a.stl -o b.png --slice Z=3", "is not an axis", "did you mean z=3?"),
            ("hollow a.stl -o b.stl -w 1 --drain 3mn@0,0,0", "`3mn` is not a length", "did you mean 3mm@0,0,0?"),
        ] {
            let told = explained(line);
            let (said, tried) = told.split_once('\n').unwrap_or_default();
            assert!(said.contains(message) && tried.contains(hint), "{line}: {told}");
        }
        // Nothing is near, or the parser says it by itself.
        for line in [
            "repair a.stl -o b.stl --colour red",
            "repair a.stl -o b.stl --voxel 3furlongs",
            "repair a.stl -o b.stl --in-format vtii",
            "repair a.stl -o b.stl --unit parsec",
            "render a.stl -o b.png --slice w=3",
            "repair a.stl -o b.stl --preset prnit",
            "repair a.stl -o b.stl --resoluton 7",
        ] {
            assert_eq!(explained(line), "", "{line}");
        }
    }

    #[test]
    fn what_the_parser_lists_is_in_its_sentence() {
        let line = ["meshwright", "compare", "a.stl", "b.stl", "--map-range", "2"];
        let failure = in_words(&Cli::try_parse_from(line).expect_err("there is no map"));
        assert!(failure.message.ends_with("not provided: --map <FILE.ply>"), "{}", failure.message);
        let failure =
            in_words(&Cli::try_parse_from(["meshwright", "repair", "a.stl", "--resoluton", "7"]).expect_err("no"));
        assert!(failure.hint.is_some_and(|hint| hint.contains("--resolution")));
    }

    #[test]
    fn words_that_people_type_are_verbs() {
        for (word, verb) in [
            ("fix", "repair"),
            ("subtract", "difference"),
            ("intersect", "intersection"),
            ("merge", "union"),
            ("info", "inspect"),
            ("grow", "dilate"),
            ("shrink", "erode"),
        ] {
            assert_eq!(
                Cli::command().find_subcommand(word).map(|found| found.get_name().to_string()),
                Some(verb.into())
            );
        }
    }
}
