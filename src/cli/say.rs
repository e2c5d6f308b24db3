//! Lines on standard error.

use std::io::{IsTerminal, Write};

use super::exit::Failure;

/// `error: ...`, the place, and `hint: ...` on standard error.
pub fn print_failure(failure: &Failure) {
    eprintln_quietly(&format!("{} {}", painted("error:", "1;31"), failure.message));
    if let Some(place) = &failure.place {
        eprintln_quietly(place);
    }
    if let Some(hint) = &failure.hint {
        eprintln_quietly(&format!("{} {hint}", painted("hint:", "1;36")));
    }
}

/// `text` in the ANSI style `code`, on a terminal without `NO_COLOR`.
pub fn painted(text: &str, code: &str) -> String {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty())
        || std::env::var_os("TERM").is_some_and(|v| v == "dumb")
        || !std::io::stderr().is_terminal();
    if plain { text.to_string() } else { format!("\x1b[{code}m{text}\x1b[0m") }
}

/// Like `eprintln!`, but a closed standard error is no reason to panic.
pub fn eprintln_quietly(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
