//! The `meshwright` binary: everything is in [`meshwright::cli`].

fn main() -> std::process::ExitCode {
    meshwright::cli::main()
}
