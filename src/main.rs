//! The command-line program `patchcord`.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
