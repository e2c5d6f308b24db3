//! Writes the manual pages of the program and its verbs, and completions for shells, into a folder:
//! `cargo run --example man_pages -- FOLDER`. `tools/package.sh` puts them into the packages.

use std::error::Error;
use std::fs;
use std::path::Path;

use clap_complete::Shell;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("a folder is needed")?;
    let [man, completions] = ["man", "completions"].map(|name| Path::new(&folder).join(name));
    fs::create_dir_all(&man)?;
    fs::create_dir_all(&completions)?;
    let mut command = meshwright::cli::command();
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish, Shell::PowerShell, Shell::Elvish] {
        clap_complete::generate_to(shell, &mut command, "meshwright", &completions)?;
    }
    clap_mangen::generate_to(command.disable_help_subcommand(true), &man)?;
    Ok(())
}
