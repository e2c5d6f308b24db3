//! Which words of a command line are options of `batch`, which are options of its verb, and which are inputs.

use std::ffi::{OsStr, OsString};
use std::ops::Range;

use clap::{Arg, Command};

/// Whose a word is, with the values after it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// An option of `batch`.
    Batch,
    /// An option of the verb, or one that nobody knows.
    Verb,
    /// A word that stands alone.
    Nobody,
}

/// Puts the options of the verb in `batch VERB IN... --out DIR --resolution 64` behind `--`, where the parser looks for them. Other command
/// lines stay as they are. `program` is the command of the whole program.
pub fn rearranged(arguments: Vec<OsString>, program: &Command) -> Vec<OsString> {
    let is_batch = arguments.get(1).is_some_and(|word| word == "batch");
    let Some(batch) = program.find_subcommand("batch").filter(|_| is_batch).map(built) else { return arguments };
    let (start, words) = arguments.split_at(2);
    // Of words before the verb none can be an option of it.
    let first = pieces(words, &batch, None).find(|(whose, _)| *whose == Whose::Nobody);
    let verb = first.and_then(|(_, place)| program.find_subcommand(&words[place.start])).map(built);
    let (mut own, mut others) = (start.to_vec(), Vec::new());
    for (whose, place) in pieces(words, &batch, verb.as_ref()) {
        let behind = words[..place.start].iter().any(|word| word == "--");
        match whose {
            Whose::Nobody if words[place.start] == "--" && !behind => {}
            Whose::Batch => own.extend_from_slice(&words[place]),
            Whose::Nobody if !behind => own.extend_from_slice(&words[place]),
            Whose::Verb | Whose::Nobody => others.extend_from_slice(&words[place]),
        }
    }
    if !others.is_empty() {
        own.push("--".into());
        own.append(&mut others);
    }
    own
}

/// The command with all that the parser fills in by itself.
fn built(command: &Command) -> Command {
    let mut command = command.clone();
    command.build();
    command
}

/// The words, taken apart: each option of `batch`, or else of `verb`, with its values.
pub fn pieces<'a>(
    words: &'a [OsString],
    batch: &'a Command,
    verb: Option<&'a Command>,
) -> impl Iterator<Item = (Whose, Range<usize>)> + 'a {
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at;
        let word = words.get(start)?;
        let found = |command: &'a Command| option(command, word);
        let (whose, argument) = match (found(batch), verb.and_then(found)) {
            (Some(argument), _) => (Whose::Batch, Some(argument)),
            (None, Some(argument)) => (Whose::Verb, Some(argument)),
            (None, None) if looks_like_option(word) => (Whose::Verb, None),
            (None, None) => (Whose::Nobody, None),
        };
        at = (start + 1 + argument.map_or(0, |argument| values(argument, word, &words[start + 1..]))).min(words.len());
        Some((whose, start..at))
    })
}

/// `--name`, `--name=value`, `-n` or `-nvalue`, and no negative number.
fn looks_like_option(word: &OsStr) -> bool {
    let word = word.to_string_lossy();
    word.len() > 1 && word.starts_with('-') && word != "--" && word.parse::<f64>().is_err()
}

/// The option of `command` that `word` begins with.
fn option<'a>(command: &'a Command, word: &OsStr) -> Option<&'a Arg> {
    let word = word.to_str()?;
    if let Some(long) = word.strip_prefix("--") {
        let name = long.split_once('=').map_or(long, |(name, _)| name);
        let named = |argument: &Arg| {
            argument.get_long() == Some(name)
                || argument.get_all_aliases().is_some_and(|aliases| aliases.contains(&name))
        };
        return command.get_arguments().find(|argument| !name.is_empty() && named(argument));
    }
    let short = word.strip_prefix('-')?.chars().next()?;
    command.get_arguments().find(|argument| argument.get_short() == Some(short))
}

/// How many of the words after an option are values of it.
fn values(argument: &Arg, word: &OsStr, after: &[OsString]) -> usize {
    let text = word.to_string_lossy();
    let attached = if text.starts_with("--") { text.contains('=') } else { text.chars().count() > 2 };
    if !argument.get_action().takes_values() || attached || argument.is_require_equals_set() {
        return 0;
    }
    let least = argument.get_num_args().map_or(1, |range| range.min_values());
    let optional = least == 0 && after.first().is_some_and(|next| !looks_like_option(next) && next != "--");
    if optional { 1 } else { least }
}

/// The long name of the option that a piece begins with, as `command` has it, or as it is written.
pub fn name(piece: &[OsString], command: &Command) -> Option<String> {
    let word = piece.first()?;
    if let Some(long) = option(command, word).and_then(Arg::get_long) {
        return Some(long.to_owned());
    }
    let text = word.to_str()?.strip_prefix("--")?;
    Some(text.split_once('=').map_or(text, |(name, _)| name).to_owned())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn options_of_the_verb_go_behind_the_others() {
        let program = super::super::super::args::Cli::command();
        for (line, expected) in [
            ("repair a.stl --out d", "repair a.stl --out d"),
            ("repair a.stl --resolution 64 b.stl --out d", "repair a.stl b.stl --out d -- --resolution 64"),
            ("--out d repair --resolution=64 a.stl -q", "--out d repair a.stl -q -- --resolution=64"),
            ("dilate -r 2mm a.stl --jobs 2 --rebuild --out d", "dilate a.stl --jobs 2 --out d -- -r 2mm --rebuild"),
            ("dilate -r2mm a.stl", "dilate a.stl -- -r2mm"),
            ("render a.stl --view -1,1,1 --out d", "render a.stl --out d -- --view -1,1,1"),
            ("repair a.stl -- --rebuild --timeout 5s", "repair a.stl --timeout 5s -- --rebuild"),
            ("repair a.stl --wrong 7", "repair a.stl 7 -- --wrong"),
            ("repair --help", "repair --help"),
        ] {
            let words = |line: &str| -> Vec<OsString> {
                ["meshwright", "batch"].into_iter().chain(line.split(' ')).map(OsString::from).collect()
            };
            assert_eq!(rearranged(words(line), &program), words(expected), "{line}");
        }
        let other: Vec<OsString> = ["meshwright", "repair", "a.stl", "--rebuild"].map(OsString::from).to_vec();
        assert_eq!(rearranged(other.clone(), &program), other);
    }
}
