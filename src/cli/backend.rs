//! `--backend`.

use clap::ValueEnum;

use super::exit::Failure;
use super::words;
use crate::backend::{Backend, BackendReport};

/// `--backend`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BackendChoice {
    /// A graphics processor where there is a real one and the job is large enough to pay
    Auto,
    /// The main processor
    Cpu,
    /// A graphics adapter, a software one if there is no other
    Gpu,
}

impl From<BackendChoice> for Backend {
    fn from(choice: BackendChoice) -> Self {
        match choice {
            BackendChoice::Auto => Self::Auto,
            BackendChoice::Cpu => Self::Cpu,
            BackendChoice::Gpu => Self::Gpu,
        }
    }
}

/// Refuses `--backend gpu` in a build that has none.
pub fn check_built(choice: BackendChoice) -> Result<(), Failure> {
    if choice == BackendChoice::Gpu && !cfg!(feature = "gpu") {
        return Err(Failure::usage("--backend gpu: this program was built without the feature `gpu`")
            .hint("--backend cpu gives the same result"));
    }
    Ok(())
}

/// Whether a panic of this thread is expected, becomes an error, and is no bug of ours.
pub fn expects_panic() -> bool {
    #[cfg(feature = "gpu")]
    return crate::gpu::is_waiting();
    #[cfg(not(feature = "gpu"))]
    false
}

/// Who did it, in words that begin with what was done.
pub fn words(made_by: &BackendReport, done: &str) -> String {
    match &made_by.adapter {
        Some(adapter) => format!(
            "{done} by {adapter}; {} sent to it, {} read back",
            words::bytes(made_by.bytes_up),
            words::bytes(made_by.bytes_down)
        ),
        None => format!("{done} by the main processor"),
    }
}
