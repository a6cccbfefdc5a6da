//! The command line: parses options, calls the library and prints the results.
//!
//! Each command has its own file with its options and its function. `load`, `times` and `files` hold options that
//! several commands share. `outputs` writes all files, and `standard_streams` has the meaning of `-`. Files named
//! `*_report` format results as text and as JSON; long reports have their JSON in a file named `*_document`. `failure`
//! maps errors to messages and exit codes.
//!
//! Every command follows the same order: parse and check the options, read the input, check that the output files can
//! be written, do the work, write the files, print. A wrong option or an unwritable file is so reported before a long
//! run.
//!
//! With `--json` a command prints one JSON document on standard output. Its key `ok` is true on success. A failure
//! prints `{"ok": false, ...}` in addition to the message on standard error. Warnings and progress go to standard error
//! in both cases. Units in documents are SI or are named next to the value; times are seconds; absent numbers are null.
//!
//! The doc comments of structs and fields that derive `Args` are the help texts. Everything else is for readers of the
//! code.

mod check;
mod command_synonyms;
mod compared_equations;
mod completions;
mod criteria;
mod doubts;
mod draw;
mod effects;
mod elements;
mod equations;
mod failure;
mod files;
mod gap;
mod gap_check;
mod gap_files;
mod gap_report;
mod instant;
mod linear_document;
mod linear_report;
mod linearise;
mod load;
mod low_peaks;
mod machines;
mod man;
mod new;
mod numbers;
mod option_synonyms;
mod outputs;
mod overloads;
#[cfg(feature = "panel")]
mod panel;
#[cfg(feature = "panel")]
mod panel_export;
mod phases;
mod pictures;
mod profile;
mod profile_report;
mod progress;
mod progress_lines;
mod progress_status;
mod readings;
mod recording;
mod replay;
mod requested_checks;
mod rescale;
mod run;
mod run_report;
mod scale;
mod scaling_report;
mod slideway;
mod slideway_document;
mod slideway_report;
mod standard_streams;
mod start_warnings;
mod static_check;
mod step_warning;
mod streamed_tables;
mod sweep;
mod table;
mod times;

use std::ffi::OsString;
use std::io::{self, IsTerminal as _, Write as _};
use std::process::ExitCode;

use clap::{ArgMatches, CommandFactory as _, FromArgMatches as _, Parser, Subcommand};
use serde::Serialize;

use command_synonyms::with_command_tip;
use failure::Failure;
use option_synonyms::with_option_tip;
use patchcord::document::{escape_controls, printable};
use patchcord::output::io_reason;

/// A virtual analogue computer: patch it in JSON, run it in volts, read it with the instruments of the period
///
/// The exit code is 0 for success, 1 for an error in the patch or the data or if output cannot be written, 2 for an
/// error in the command line, and 3 for an overload in a run with --fail-on-overload.
///
/// Long work shows its progress on standard error: a bar on a terminal, otherwise a line every ten seconds. The
/// environment variable PATCHCORD_PROGRESS sets another interval of the lines, in seconds and at least 0.001. With 0,
/// no lines are printed.
#[derive(Parser)]
#[command(name = "patchcord", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Write an annotated first patch as a starting point
    New(new::Arguments),
    /// Make a patch from equations: scales, gains, pots and wiring. Or rescale a patch
    Scale(scale::Arguments),
    /// Check a patch and report all errors at once
    Check(check::Arguments),
    /// Run a patch: print readings, write a CSV table, draw scope pictures
    Run(run::Arguments),
    /// Run a patch for many parameter values and write one row of measures per run
    Sweep(sweep::Arguments),
    /// Reproduce the figures of the thesis on stick-slip friction and check its claims
    Replay(replay::Arguments),
    /// Predict the critical velocity of a slideway from oil, load, stiffness and surface, and test how to lower it
    Slideway(slideway::Arguments),
    /// Explain a velocity profile: where motion sticks, slips, oscillates or slides evenly as the command changes
    Profile(profile::Arguments),
    /// Compare a patch with measured data, find the effect that it lacks, and write a patch with this effect
    Gap(gap::Arguments),
    /// Open the front panel in a browser: turn pots, move cords, operate, and watch the scopes
    #[cfg(feature = "panel")]
    Panel(panel::Arguments),
    /// Draw the schematic of a patch, or the patch panel with its cords
    Draw(draw::Arguments),
    /// Print the equations that the wiring of a patch solves, as text or LaTeX
    Equations(equations::Arguments),
    /// Linearise a patch about an operating point: roots, frequencies, damping, Bode plot
    Linearise(linearise::Arguments),
    /// List the computing elements and drives, or describe one of them
    Elements(elements::Arguments),
    /// List the effects that a patch may lack, or describe one of them
    Effects(effects::Arguments),
    /// List the machines for which patches can be written
    Machines(machines::Arguments),
    /// Print a script that completes commands and options in a shell
    Completions(completions::Arguments),
    /// Print a manual page, or write the pages of all commands
    Man(man::Arguments),
}

/// The definition of every command and option.
fn definition() -> clap::Command {
    Arguments::command()
}

/// Runs the command line of this process and returns the exit code: 0 success, 1 error in the patch or the data, or
/// output that cannot be written, 2 error in the command line, 3 overload in a run with `--fail-on-overload`.
pub(crate) fn main() -> ExitCode {
    let arguments: Vec<OsString> = std::env::args_os().collect();
    let outcome = match parse(&arguments) {
        Ok((command, json)) => run_command(&command).map_err(|failure| failure.with_json_output(json)),
        Err(error) => report_usage(&with_escaped_arguments(error, &arguments), &arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

/// Parses a command line. Returns the command, and whether it was given `--json`.
fn parse(arguments: &[OsString]) -> Result<(Command, bool), clap::Error> {
    let matches = definition().try_get_matches_from(arguments);
    let mut matches =
        matches.map_err(|error| with_command_tip(with_option_tip(error, &definition(), arguments)))?;
    let json = matches.subcommand().is_some_and(|(_, options)| has_json(options));
    let arguments = Arguments::from_arg_matches_mut(&mut matches);
    let arguments = arguments.map_err(|error| error.format(&mut definition()))?;
    Ok((arguments.command, json))
}

/// Whether `--json` was given. Some commands do not have this option.
fn has_json(options: &ArgMatches) -> bool {
    options.try_get_one::<bool>("json").is_ok_and(|json| json == Some(&true))
}

/// Runs one command.
fn run_command(command: &Command) -> Result<(), Failure> {
    progress::check_interval()?;
    match command {
        Command::New(arguments) => new::new(arguments),
        Command::Scale(arguments) => scale::scale(arguments),
        Command::Check(arguments) => check::check(arguments),
        Command::Run(arguments) => run::run(arguments),
        Command::Sweep(arguments) => sweep::sweep(arguments),
        Command::Replay(arguments) => replay::replay(arguments),
        Command::Slideway(arguments) => slideway::slideway(arguments),
        Command::Profile(arguments) => profile::profile(arguments),
        Command::Gap(arguments) => gap::gap(arguments),
        #[cfg(feature = "panel")]
        Command::Panel(arguments) => panel::panel(arguments),
        Command::Draw(arguments) => draw::draw(arguments),
        Command::Equations(arguments) => equations::equations(arguments),
        Command::Linearise(arguments) => linearise::linearise(arguments),
        Command::Elements(arguments) => elements::elements(arguments),
        Command::Effects(arguments) => effects::effects(arguments),
        Command::Machines(arguments) => machines::machines(arguments),
        Command::Completions(arguments) => completions::completions(arguments),
        Command::Man(arguments) => man::man(arguments),
    }
}

/// The error of the same command line without control characters, because the message of an error repeats arguments.
fn with_escaped_arguments(error: clap::Error, arguments: &[OsString]) -> clap::Error {
    let escaped: Vec<OsString> =
        arguments.iter().map(|argument| escape_controls(&argument.to_string_lossy()).into()).collect();
    parse(&escaped).err().unwrap_or(error)
}

/// Prints help, version or an error of the command line. With `--json` an error is also printed as a JSON document.
///
/// The JSON document has the first paragraph of the message as `error`.
///
/// # Errors
/// The error of the command line, or the failure to write help or version.
fn report_usage(error: &clap::Error, arguments: &[OsString]) -> Result<(), Failure> {
    let printed = error.print();
    if !error.use_stderr() {
        return standard_output_result(printed.and_then(|()| io::stdout().flush()));
    }
    let message = error.render().to_string();
    let first = message.split("\n\n").next().unwrap_or_default();
    let failure = Failure::already_printed(first.trim_start_matches("error: "));
    Err(failure.with_json_output(arguments.iter().any(|argument| argument == "--json")))
}

/// Prints to standard output without control characters, which could manipulate a terminal. A closed pipe is not an
/// error.
///
/// Line feeds stay; tabs become spaces; other control characters become escape sequences, such as `\u001b`.
fn print(text: &str) -> Result<(), Failure> {
    write_out(&printable(text))
}

/// Prints a text with colour codes to standard output, without other control characters.
fn print_coloured(text: &str) -> Result<(), Failure> {
    write_out(&printable_coloured(text))
}

/// Prints a JSON document. Control characters in texts are escaped, so that they are preserved.
fn print_json(document: &impl Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(document).map_err(|error| Failure::data(error.to_string()))?;
    print(&(text + "\n"))
}

/// Writes text to standard output. A closed pipe is not an error.
fn write_out(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    standard_output_result(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// The result of writing to standard output. A pipe that closes early, as with `head`, ends the output without a
/// message.
fn standard_output_result(outcome: io::Result<()>) -> Result<(), Failure> {
    match outcome {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::data(format!("cannot write to standard output: {}", io_reason(&error))))
        }
        _ => Ok(()),
    }
}

/// Prints a message to standard error. Errors are ignored, because there is no other place for a message.
fn eprint(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable(text));
}

/// Prints a message with colour codes to standard error, without other control characters. Texts from outside in the
/// message have no control characters.
fn eprint_coloured(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{}", printable_coloured(text));
}

/// The text without control characters except colour codes.
fn printable_coloured(text: &str) -> String {
    let mut parts = text.split("\x1b[");
    let mut shown = printable(parts.next().unwrap_or_default());
    for part in parts {
        let end = part.find(|letter: char| !letter.is_ascii_digit() && letter != ';').unwrap_or(part.len());
        let is_colour = part[end..].starts_with('m');
        shown += if is_colour { "\x1b[" } else { "\\u001b[" };
        shown += &printable(part);
    }
    shown
}

/// Whether errors are printed in colour: standard error is a terminal and NO_COLOR is not set.
fn errors_in_colour() -> bool {
    io::stderr().is_terminal() && is_colour_permitted()
}

/// Whether overloads are printed in colour: standard output is a terminal and NO_COLOR is not set.
fn output_in_colour() -> bool {
    io::stdout().is_terminal() && is_colour_permitted()
}

/// Whether the environment permits colours: NO_COLOR is not set.
fn is_colour_permitted() -> bool {
    std::env::var_os("NO_COLOR").is_none()
}
