//! What was typed: the command, and what kind of report a name asks for.

use std::path::Path;

/// Whether the report is a page, by its name.
pub fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|extension| ["html", "htm"].iter().any(|html| extension.eq_ignore_ascii_case(html)))
}

/// The command of this process as it would be typed.
pub fn command() -> String {
    line(std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()))
}

/// A command of the program with these arguments, as it would be typed.
pub fn line(arguments: impl IntoIterator<Item = String>) -> String {
    let words = arguments.into_iter().map(|word| quoted(&word));
    std::iter::once(env!("CARGO_PKG_NAME").to_string()).chain(words).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:%+@".contains(c);
    let is_plain = !word.is_empty() && word.chars().all(plain);
    if is_plain { word.to_string() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

/// The name of a result beside its input: `part.stl` as `part_repaired.stl`, with `made` for what was done.
pub fn named(file: &str, made: &str) -> String {
    let path = Path::new(file);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or("stl".into(), |extension| extension.to_string_lossy());
    path.with_file_name(format!("{stem}_{made}.{extension}")).display().to_string()
}
