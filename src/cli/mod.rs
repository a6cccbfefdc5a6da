//! The command line: reads options, calls the library, prints what comes back.

mod check;
mod completions;
mod criteria;
mod draw;
mod effects;
mod elements;
mod failure;
mod files;
mod gap;
mod gap_check;
mod gap_files;
mod gap_report;
mod instant;
mod linear_report;
mod linearise;
mod load;
mod machines;
mod man;
mod new;
mod numbers;
mod overloads;
mod phases;
mod profile;
mod profile_report;
mod progress;
mod readings;
mod replay;
mod run;
mod slideway;
mod slideway_report;
mod sweep;
mod table;
mod times;

use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;

use clap::{CommandFactory as _, Parser, Subcommand};
use serde_json::Value;

use failure::Failure;
use patchcord::output::refusal;

/// A virtual analogue computer: patches in JSON, run in volts, read with the instruments of the period
///
/// Exit codes: 0 done, 1 the patch or the data is wrong, 2 the command line is wrong.
#[derive(Parser)]
#[command(name = "patchcord", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write a first patch, with notes, to change into your own
    New(new::Arguments),
    /// Check a patch: everything that is wrong with it, all at once
    Check(check::Arguments),
    /// Run a patch: readings, a table, scope pictures
    Run(run::Arguments),
    /// Run a patch for many settings of its parameters, and measure each run: a row a run
    Sweep(sweep::Arguments),
    /// Draw the figures of the study again, and examine what its text claims
    Replay(replay::Arguments),
    /// From oil, load, stiffness and surface of a slideway to its critical velocity, and what lowers it
    Slideway(slideway::Arguments),
    /// Explain a velocity profile: where it sticks and slips, oscillates and slides, while the command rises
    Profile(profile::Arguments),
    /// Hold a patch against what was measured: what is missing in it, where and when, and a patch that has it
    Gap(gap::Arguments),
    /// Draw the schematic of a patch, or the patch panel with its cords
    Draw(draw::Arguments),
    /// Small motions about a point: roots, frequencies, damping, Bode plot
    Linearise(linearise::Arguments),
    /// List the computing elements and drives, or tell all about one
    Elements(elements::Arguments),
    /// List the effects that a patch may lack, or tell all about one
    Effects(effects::Arguments),
    /// List the machines that patches can be made for
    Machines(machines::Arguments),
    /// Print what a shell needs to complete commands and options
    Completions(completions::Arguments),
    /// Print the manual page, or write those of all commands
    Man(man::Arguments),
}

/// The definition of every command and option.
fn definition() -> clap::Command {
    Arguments::command()
}

/// Runs the command line of this process. Exit codes: 0 done, 1 the patch or the data is wrong, 2 the command
/// line is wrong.
pub fn main() -> ExitCode {
    let outcome = match Arguments::try_parse() {
        Ok(arguments) => carry_out(&arguments.command),
        Err(error) => refused(&error),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.tell(),
    }
}

fn carry_out(command: &Command) -> Result<(), Failure> {
    match command {
        Command::New(arguments) => new::new(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Run(arguments) => run::run(arguments),
        Command::Sweep(arguments) => sweep::sweep(arguments),
        Command::Replay(arguments) => replay::replay(arguments),
        Command::Slideway(arguments) => slideway::slideway(arguments),
        Command::Profile(arguments) => profile::profile(arguments),
        Command::Gap(arguments) => gap::gap(arguments),
        Command::Draw(arguments) => draw::draw(arguments),
        Command::Linearise(arguments) => linearise::linearise(arguments),
        Command::Elements(arguments) => elements::elements(arguments),
        Command::Effects(arguments) => effects::effects(arguments),
        Command::Machines(arguments) => machines::machines(arguments),
        Command::Completions(arguments) => completions::completions(arguments),
        Command::Man(arguments) => man::man(arguments),
    }
}

/// Help and the version, or what is wrong with the command line: as a JSON document too where it asks for one.
fn refused(error: &clap::Error) -> Result<(), Failure> {
    if !error.use_stderr() || !std::env::args_os().any(|argument| argument == "--json") {
        error.exit();
    }
    let told = error.render().to_string();
    tell(told.trim_end());
    let first = told.split("\n\n").next().unwrap_or_default();
    Err(Failure::told(first.trim_start_matches("error: ")))
}

/// Writes to standard output. A reader that has gone away is no error of ours.
fn say(text: &str) -> Result<(), Failure> {
    write_out(&printable(text))
}

/// Writes a JSON document; control characters in its texts are escaped, so that they read back as they were.
fn say_json(value: &Value) -> Result<(), Failure> {
    let text = format!("{value:#}\n");
    let escaped = text.chars().map(|letter| match letter {
        '\n' => "\n".to_owned(),
        letter if letter.is_control() => format!("\\u{:04x}", u32::from(letter)),
        letter => letter.to_string(),
    });
    write_out(&escaped.collect::<String>())
}

fn write_out(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::data(format!("cannot write to standard output: {}", refusal(&error))))
        }
        _ => Ok(()),
    }
}

/// Writes a message to standard error, where nobody may be listening either.
fn tell(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(text));
}

/// Writes a message with colours of our own to standard error.
fn tell_coloured(text: &str) {
    let mut parts = text.split("\x1b[");
    let mut shown = printable(parts.next().unwrap_or_default());
    for part in parts {
        let end = part.find(|letter: char| !letter.is_ascii_digit() && letter != ';').unwrap_or(part.len());
        let is_colour = part[end..].starts_with('m');
        shown += if is_colour { "\x1b[" } else { "[" };
        shown += &printable(part);
    }
    let _ = writeln!(io::stderr().lock(), "{shown}");
}

/// A text without the control characters by which a file could play tricks on a terminal.
fn printable(text: &str) -> String {
    text.replace('\t', " ").chars().filter(|letter| *letter == '\n' || !letter.is_control()).collect()
}

fn errors_in_colour() -> bool {
    io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
