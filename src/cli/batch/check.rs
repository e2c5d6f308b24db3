//! The options of jobs, looked at before the first begins.

use std::collections::HashSet;
use std::ffi::OsString;

use clap::{Args, Command, FromArgMatches};

use super::super::exit::Failure;
use super::super::{args, meant, misuse, words};
use super::args::EachArgs;
use super::job::Job;
use super::options::{Whose, name, pieces};
use super::verbs::{self, BatchVerb};

/// Options that a batch sets by itself, or that have no meaning in one.
const NOT_HERE: [(&str, &str); 6] = [
    ("output", "a batch names the outputs by itself: --out says the folder, and a manifest the names"),
    ("report", "a batch writes the report of every job by itself; its log says where"),
    ("json", "jobs have no standard output; their reports are files, and the log says where"),
    ("threads", "a batch shares out the threads by itself: --threads before `--` says how many there are"),
    ("map", "all jobs would write the same map"),
    ("plan", "a batch does its jobs, and a plan does nothing"),
];

/// The verb that goes by `word`, also by another word for it.
pub fn verb_of(word: &str, program: &Command) -> Result<&'static BatchVerb, Failure> {
    let name = program.find_subcommand(word).map(Command::get_name);
    name.and_then(verbs::of_name).ok_or_else(|| {
        let failure = match name {
            Some(name) => Failure::usage(format!("`{name}` cannot be run in a batch")),
            None => Failure::usage(format!("`{word}` is no verb")),
        };
        let can_be = format!("{} can be", words::list(&verbs::of_one_input()));
        failure.hint(match meant::verb(word, program).filter(|verb| verbs::of_name(verb).is_some()) {
            Some(verb) => format!("did you mean `{verb}`? {can_be}"),
            None => can_be,
        })
    })
}

/// Takes what `batch` itself must know out of the options of a job.
pub fn settle(options: &[OsString], verb: &BatchVerb, program: &Command) -> Result<(EachArgs, Vec<OsString>), Failure> {
    let mut each = EachArgs::augment_args(Command::new("job").no_binary_name(true).disable_help_flag(true));
    each.build();
    let mut command = program.find_subcommand(verb.name).cloned().unwrap_or_default();
    command.build();
    let (mut own, mut others) = (Vec::new(), Vec::new());
    for (whose, place) in pieces(options, &each, Some(&command)) {
        let piece = &options[place];
        match (whose, refused(piece, &command)) {
            (_, Some((flag, why))) => {
                return Err(Failure::usage(format!("--{flag} cannot be used in a batch")).hint(why));
            }
            (Whose::Batch, None) => own.extend_from_slice(piece),
            (_, None) => others.extend_from_slice(piece),
        }
    }
    let parsed = each.try_get_matches_from(own).and_then(|matches| EachArgs::from_arg_matches(&matches));
    Ok((parsed.map_err(|error| misuse::in_words(&error))?, others))
}

/// The options of `given` that are not among `others`.
pub fn without(given: Vec<OsString>, others: &[OsString], verb: &BatchVerb, program: &Command) -> Vec<OsString> {
    let nothing = Command::new("job");
    let command = program.find_subcommand(verb.name).unwrap_or(&nothing);
    let there: HashSet<String> =
        pieces(others, &nothing, Some(command)).filter_map(|(_, place)| name(&others[place], command)).collect();
    pieces(&given, &nothing, Some(command))
        .filter(|(_, place)| name(&given[place.clone()], command).is_none_or(|name| !there.contains(&name)))
        .flat_map(|(_, place)| given[place].to_vec())
        .collect()
}

fn refused(piece: &[OsString], command: &Command) -> Option<(&'static str, &'static str)> {
    let name = name(piece, command)?;
    NOT_HERE.into_iter().find(|(flag, _)| *flag == name)
}

/// Refuses options that the program would not take, with the place that they are from.
pub fn check_all(jobs: &[Job]) -> Result<(), Failure> {
    let mut seen = HashSet::new();
    for job in jobs {
        let kind = (job.verb.name, &job.options, job.each.out_format.map(|format| format.name()), job.inputs.len());
        if seen.insert(kind) {
            check(job)
                .map_err(|failure| Failure { message: format!("{}: {}", job.origin, failure.message), ..failure })?;
        }
    }
    Ok(())
}

fn check(job: &Job) -> Result<(), Failure> {
    let (verb, format) = (job.verb, job.each.out_format);
    if let Some(format) = format.filter(|&format| !verb.makes(format)) {
        return Err(Failure::usage(format!("`{}` cannot write {}", verb.name, format.name())));
    }
    let program = std::iter::once("meshwright".into());
    let mut cli = args::parse(program.chain(job.arguments(1))).map_err(|error| misuse::in_words(&error))?;
    args::solid(&mut cli.verb).map_or(Ok(()), |args| args.check())
}
