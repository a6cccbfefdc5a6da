//! The command `patchcord`.

use std::process::ExitCode;

fn main() -> ExitCode {
    patchcord::cli::main()
}
