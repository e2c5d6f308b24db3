//! `licenses`: under what licences the program may be used and passed on.

use super::exit::Exit;
use super::say::print_failure;
use super::streams;

/// Those of the program itself.
const OWN: [&str; 2] = [include_str!("../../LICENSE-MIT"), include_str!("../../LICENSE-APACHE")];
/// Those of what it is built of, gathered by `tools/licenses.py`.
const OTHERS: &str = include_str!("licenses.txt");

/// Prints all of them.
pub fn run() -> Exit {
    let [mit, apache] = OWN;
    let text =
        format!("meshwright may be used under either of two licences, MIT or Apache-2.0.\n\n{mit}\n{apache}\n{OTHERS}");
    match streams::write_stream(text.as_bytes()) {
        Ok(()) => Exit::Done,
        Err(failure) => {
            print_failure(&failure);
            failure.exit
        }
    }
}
