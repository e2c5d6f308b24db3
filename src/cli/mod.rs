//! The command line: one file a verb. Only this folder prints and knows exit codes.

/// Runs the program on the process's arguments.
pub fn main() -> std::process::ExitCode {
    std::process::ExitCode::from(2)
}
