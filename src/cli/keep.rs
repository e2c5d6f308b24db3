//! `--keep-partial`: results of which the program says itself that they are not what was asked for.

use std::path::Path;

use clap::Args;

use super::class::Class;
use super::exit::{Exit, Failure};
use super::streams::is_stream;

/// Whether a result that is mostly lost is written all the same.
#[derive(Debug, Clone, Copy, Args)]
pub struct KeepArgs {
    /// Write the result also when most of the shape is lost (exit status 3); --force does so, too
    #[arg(long)]
    pub keep_partial: bool,
}

/// Why nothing was written: the result is not what was asked for, for these reasons. `instead`: what may do better.
pub fn withheld(reasons: &[String], output: Option<&Path>, instead: &str) -> Failure {
    let before = output.filter(|path| !is_stream(path) && path.exists());
    let stays = before.map_or(String::new(), |path| format!("; {} stays as it was", path.display()));
    Failure::new(Exit::Limit, format!("{}. Nothing was written{stays}", reasons.join("; ")))
        .of_class(Class::Withheld)
        .hint(format!("{instead}; --keep-partial writes this result all the same"))
}
