//! Options of other programs, and the options of this command that mean the same.
//!
//! An error about an unknown option gets a tip from this table before that of the parser, which looks for a similar
//! name.

use std::ffi::OsString;

use clap::Command;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// What people write, in lower case without the first hyphens, and the options that are meant.
const OPTIONS: [(&[&str], &[&str]); 15] = [
    (
        &["dt", "h", "timestep", "time-step", "stepsize", "step-size", "max-step", "dt-max", "delta-t"],
        &["step"],
    ),
    (&["tolerance", "rtol", "atol", "reltol", "abstol", "rel-tol", "abs-tol", "accuracy", "eps"], &["tol"]),
    (&["time", "t"], &["for", "at", "values"]),
    (
        &[
            "duration",
            "length",
            "tmax",
            "t-max",
            "tend",
            "t-end",
            "tstop",
            "t-stop",
            "tfinal",
            "t-final",
            "end",
            "end-time",
            "stop",
            "stop-time",
            "until",
        ],
        &["for"],
    ),
    (&["sample", "sampling", "sample-time", "interval", "save-every", "saveat"], &["every"]),
    (&["output", "o", "outfile", "out-file", "output-file", "file", "save"], &["csv", "plot", "out"]),
    (&["outdir", "out-dir", "output-dir", "folder", "directory"], &["out"]),
    (&["picture", "image", "figure", "graph", "svg", "png"], &["plot"]),
    (&["param", "params", "parameter", "parameters", "p"], &["set"]),
    (&["repeats", "repetitions", "runs", "cycles"], &["repeat"]),
    (&["signal", "signals", "probe", "probes"], &["record"]),
    (&["measures", "metric", "metrics"], &["measure"]),
    (&["sweep", "range"], &["vary"]),
    (&["jobs", "j", "workers", "parallel", "cores"], &["threads"]),
    (&["freq", "frequency", "frequencies", "band"], &["hz"]),
];

/// The same error with a tip, if it is about an option of other programs and the command has an option that means the
/// same. `definition` has all commands, and `arguments` are the command line.
pub(super) fn with_option_tip(
    mut error: clap::Error,
    definition: &Command,
    arguments: &[OsString],
) -> clap::Error {
    let Some(tip) = option_tip(&error, definition, arguments) else { return error };
    error.remove(ContextKind::SuggestedArg);
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}

/// The tip about the unknown option of an error; `None` if there is none.
fn option_tip(error: &clap::Error, definition: &Command, arguments: &[OsString]) -> Option<String> {
    if error.kind() != ErrorKind::UnknownArgument {
        return None;
    }
    let Some(ContextValue::String(written)) = error.get(ContextKind::InvalidArg) else { return None };
    let command = arguments.iter().skip(1).find_map(|argument| definition.find_subcommand(argument))?;
    tip(command, written)
}

/// The options of a command that are meant by an unknown one, which begins with a hyphen. `None` if there are none.
fn tip(command: &Command, written: &str) -> Option<String> {
    let word = written.strip_prefix('-')?.trim_start_matches('-').to_lowercase().replace('_', "-");
    let (_, meant) = OPTIONS.iter().find(|(words, _)| words.contains(&word.as_str()))?;
    let options: Vec<String> = meant.iter().filter_map(|name| option_text(command, name)).collect();
    let (last, others) = options.split_last()?;
    match others {
        [] => Some(format!("use {last}")),
        _ => Some(format!("use {} or {last}", others.join(", "))),
    }
}

/// An option of a command with the name of its value, such as `'--csv <FILE>'`. `None` if the command does not have it.
fn option_text(command: &Command, name: &str) -> Option<String> {
    let option = command.get_arguments().find(|option| option.get_long() == Some(name))?;
    match option.get_value_names() {
        Some([value, ..]) => Some(format!("'--{name} <{value}>'")),
        _ => Some(format!("'--{name}'")),
    }
}

#[cfg(test)]
mod tests {
    use super::super::definition;
    use super::*;

    /// The tip of a command about an unknown option.
    fn tip_of(command: &str, written: &str) -> Option<String> {
        tip(definition().find_subcommand(command).unwrap(), written)
    }

    #[test]
    fn options_of_other_programs_are_recognised() {
        let cases = [
            ("run", "--dt", "use '--step <SECONDS|auto>'"),
            ("sweep", "--Time_Step", "use '--step <SECONDS|auto>'"),
            ("profile", "--rtol", "use '--tol <SHARE>'"),
            ("run", "--tmax", "use '--for <SECONDS>'"),
            ("run", "-t", "use '--for <SECONDS>'"),
            ("linearise", "--time", "use '--at <SECONDS>'"),
            ("run", "-o", "use '--csv <FILE>', '--plot <FILE.svg|png>' or '--out <DIR>'"),
            ("gap", "--output", "use '--out <DIR>'"),
            ("sweep", "-j", "use '--threads <NUMBER>'"),
        ];
        for (command, written, expected) in cases {
            assert_eq!(tip_of(command, written).as_deref(), Some(expected), "{command} {written}");
        }
    }

    #[test]
    fn a_command_without_the_option_has_no_tip() {
        for (command, written) in [("check", "--dt"), ("draw", "--tol"), ("run", "dt"), ("run", "--colour")] {
            assert_eq!(tip_of(command, written), None, "{command} {written}");
        }
    }

    #[test]
    fn every_word_is_in_one_row_and_every_option_exists() {
        let words: Vec<&str> = OPTIONS.iter().flat_map(|(words, _)| *words).copied().collect();
        for (index, word) in words.iter().enumerate() {
            assert!(!words[..index].contains(word), "{word}");
        }
        let definition = definition();
        for name in OPTIONS.iter().flat_map(|(_, meant)| *meant) {
            assert!(
                definition.get_subcommands().any(|command| option_text(command, name).is_some()),
                "{name}"
            );
        }
    }
}
