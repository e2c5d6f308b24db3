//! All jobs of a batch, from its command line and its manifest.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use clap::Command;

use super::super::exit::Failure;
use super::args::BatchArgs;
use super::check;
use super::inputs;
use super::job::{Job, stays_below};
use super::manifest::{self, Line};
use super::verbs::BatchVerb;

/// All jobs, in the order of their names. No two write the same file, none writes over an input, and the program understands the
/// options of all.
pub fn all(args: &BatchArgs, program: &Command) -> Result<Vec<Job>, Failure> {
    let verb = args.verb.as_deref().map(|word| check::verb_of(word, program)).transpose()?;
    let mut jobs = Vec::new();
    if let Some(verb) = verb {
        jobs = of_command_line(args, verb, program)?;
    } else if let Some(option) = args.options.first() {
        return Err(Failure::usage(format!("{} belongs to no verb", option.to_string_lossy()))
            .hint("a verb before it, whose options hold for all its jobs; or `options` in the lines of the manifest"));
    }
    if let Some(path) = &args.manifest {
        for line in manifest::read(path)? {
            let place = line.place(path);
            let job = of_line(&line, args, verb, program).map(|job| Job { origin: place.clone(), ..job });
            jobs.push(job.map_err(|failure| Failure { message: format!("{place}: {}", failure.message), ..failure })?);
        }
    }
    if jobs.is_empty() {
        return Err(Failure::usage("there is nothing to do: no input is given")
            .hint("files, folders or patterns after the verb, or --manifest FILE.jsonl"));
    }
    check_outputs(&jobs)?;
    check_endless(&jobs)?;
    check::check_all(&jobs)?;
    jobs.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(jobs)
}

/// A job for each input.
fn of_command_line(args: &BatchArgs, verb: &'static BatchVerb, program: &Command) -> Result<Vec<Job>, Failure> {
    let (each, options) = check::settle(&args.options, verb, program)?;
    let each = each.or(&args.each);
    if !args.inputs.is_empty() && !verb.takes_one() {
        return Err(Failure::usage(format!(
            "`{}` takes several inputs, and a batch gives it one at a time",
            verb.name
        ))
        .hint(r#"--manifest FILE.jsonl, with lines such as {"inputs": ["a.stl", "b.stl"], "output": "c.stl"}"#));
    }
    let told = |job: Job| Job { options: options.clone(), each: each.clone(), ..job };
    let output = |name: &Path| verb.output_name(name, each.out_format);
    if !args.inputs.is_empty() {
        // Wrong options are told before files that are not there, which may be values of these options.
        let example = Job::new(verb, vec!["in.stl".into(); verb.inputs.0], &output(Path::new("in.stl")), &args.out);
        check::check_all(&[told(Job { origin: format!("batch {}", verb.name), ..example })])?;
    }
    let found = inputs::gather(&args.inputs, &args.out)?.into_iter();
    Ok(found.map(|file| told(Job::new(verb, vec![file.path], &output(&file.name), &args.out))).collect())
}

fn of_line(
    line: &Line,
    args: &BatchArgs,
    given: Option<&'static BatchVerb>,
    program: &Command,
) -> Result<Job, Failure> {
    let own = line.verb.as_deref().map(|word| check::verb_of(word, program)).transpose()?;
    let verb = own.or(given).ok_or_else(|| Failure::usage("there is no verb, neither here nor on the command line"))?;
    let inputs = line.inputs();
    if inputs.len() < verb.inputs.0 || inputs.len() > verb.inputs.1 {
        return Err(Failure::usage(format!("`{}` cannot be given {} inputs", verb.name, inputs.len())));
    }
    // The options of the command line are for its own verb, and those of the line win.
    let given = if given == Some(verb) { args.options.as_slice() } else { &[] };
    let (each, options) = check::settle(&line.options(), verb, program)?;
    let (for_all, given) = check::settle(given, verb, program)?;
    let options = [check::without(given, &options, verb, program), options].concat();
    let each = each.or(&for_all).or(&args.each);
    let output = match &line.output {
        Some(output) => output.clone(),
        None => {
            let name = inputs[0].file_name().map(PathBuf::from);
            verb.output_name(&name.ok_or_else(|| Failure::usage("the input has no name"))?, each.out_format)
        }
    };
    if !stays_below(&output) {
        let failure = Failure::usage(format!("the output {} is not in the folder of the outputs", output.display()));
        return Err(failure.hint("a name, perhaps with folders before it, as seen from --out DIR"));
    }
    let output = output.components().filter(|part| part.as_os_str() != ".").collect::<PathBuf>();
    Ok(Job { options, each, ..Job::new(verb, inputs, &output, &args.out) })
}

/// Refuses two jobs that would write the same file, and jobs that would write over an input.
fn check_outputs(jobs: &[Job]) -> Result<(), Failure> {
    let mut written: HashMap<&Path, &Job> = HashMap::new();
    for job in jobs {
        if let Some(other) = written.insert(&job.output, job) {
            let (first, second, output) = (&other.origin, &job.origin, job.output.display());
            return Err(Failure::usage(format!("{first} and {second} would both be written to {output}")).hint(
                "a folder given as a whole keeps the folders in it; or a batch for each, with an --out of its own; or a manifest",
            ));
        }
    }
    let read: HashMap<PathBuf, &Job> = jobs
        .iter()
        .flat_map(|job| job.inputs.iter().filter_map(move |input| Some((input.canonicalize().ok()?, job))))
        .collect();
    for job in jobs {
        let over = job.output.canonicalize().ok().filter(|output| read.contains_key(output));
        if over.is_some() {
            let failure = Failure::usage(format!("{} is an input and would be overwritten", job.output.display()));
            return Err(failure.hint("another folder after --out"));
        }
    }
    Ok(())
}

/// Refuses jobs that may wait for ever: of a pipe or a device nobody knows whether it ends.
fn check_endless(jobs: &[Job]) -> Result<(), Failure> {
    let special = |path: &PathBuf| path.metadata().is_ok_and(|data| !data.is_file() && !data.is_dir());
    for job in jobs.iter().filter(|job| job.bytes.is_none() && job.each.timeout.is_none()) {
        if let Some(input) = job.inputs.iter().find(|input| special(input)) {
            let failure = Failure::usage(format!("{} is no regular file, and may never end", input.display()));
            return Err(failure.hint("--timeout DUR says when to give up"));
        }
    }
    Ok(())
}
