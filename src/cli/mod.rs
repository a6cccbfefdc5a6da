//! The command line: reads options, calls the library, prints what comes back.

mod check;
mod elements;
mod failure;
mod files;
mod load;
mod machines;
mod run;
mod table;

use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use serde_json::Value;

use failure::Failure;

/// A virtual analogue computer: patches in JSON, run in volts, read with the instruments of the period.
#[derive(Parser)]
#[command(name = "patchcord", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Check a patch: everything that is wrong with it, all at once
    Check(check::Arguments),
    /// Run a patch: readings, a table, scope pictures
    Run(run::Arguments),
    /// List the computing elements and drives, or tell all about one
    Elements(elements::Arguments),
    /// List the machines that patches can be made for
    Machines(machines::Arguments),
}

/// Runs the command line of this process. Exit codes: 0 done, 1 the patch or the data is wrong, 2 the command
/// line is wrong.
pub fn main() -> ExitCode {
    let outcome = match Arguments::parse().command {
        Command::Check(arguments) => check::check(&arguments),
        Command::Run(arguments) => run::run(&arguments),
        Command::Elements(arguments) => elements::elements(&arguments),
        Command::Machines(arguments) => machines::machines(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell(),
    }
}

/// Writes to standard output. A reader that has gone away is no error of ours.
fn say(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::data(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

fn say_json(value: &Value) -> Result<(), Failure> {
    say(&format!("{value:#}\n"))
}

/// Writes a message to standard error, where nobody may be listening either.
fn tell(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

fn errors_in_colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
