//! Options of other programs, and the options of this command that mean the same.
//!
//! An error about an unknown option gets a tip from these tables before that of the parser, which looks for a similar
//! name. If there is no such name either, the tip is the command that lists the options.

use std::ffi::OsString;

use clap::Command;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// What people write, in lower case without the first hyphens, and the options that are meant.
const OPTIONS: [(&[&str], &[&str]); 16] = [
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
    (&["v", "verbosity"], &["verbose"]),
];

/// What people write for the method of the solver.
const METHOD: &[&str] = &["method", "solver", "integrator", "algorithm"];

/// What people write for things that no single option selects, as in [`OPTIONS`], with the tip. If there is an option
/// between them, the tip is for commands with this option.
const SENTENCES: [(&[&str], Option<&str>, &str); 3] = [
    (
        METHOD,
        Some("tol"),
        "the step selects the method: '--step <SECONDS|auto>' takes equal Runge-Kutta steps of order 4, \
         '--tol <SHARE>' takes Dormand-Prince steps of orders 5 and 4",
    ),
    (
        METHOD,
        Some("set"),
        "the section \"run\" of the patch selects the method: with \"step\" equal Runge-Kutta steps of order 4, \
         with \"tolerance\" Dormand-Prince steps of orders 5 and 4",
    ),
    (
        &["q", "quiet", "silent", "no-progress"],
        None,
        "set the environment variable PATCHCORD_PROGRESS=0 to print no progress, and redirect standard output to \
         discard the results",
    ),
];

/// The same error with another tip, if it is about an unknown option or about a file name after `--json`. A tip about a
/// similar name stays. `definition` has all commands, and `arguments` are the command line.
pub(super) fn with_option_tip(
    mut error: clap::Error,
    definition: &Command,
    arguments: &[OsString],
) -> clap::Error {
    let Some(tip) = better_tip(&error, definition, arguments) else { return error };
    error.remove(ContextKind::SuggestedArg);
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}

/// The tip in place of that of the parser; `None` if that stays.
fn better_tip(error: &clap::Error, definition: &Command, arguments: &[OsString]) -> Option<String> {
    let written = context_text(error, ContextKind::InvalidArg)?;
    match error.kind() {
        ErrorKind::UnknownArgument if written.starts_with('-') => {
            unknown_option_tip(error, written, definition, arguments)
        }
        ErrorKind::UnknownArgument => {
            let mut pairs = arguments.windows(2);
            pairs.any(|pair| pair[0] == "--json" && pair[1] == *written).then(|| redirection_tip(written))
        }
        ErrorKind::TooManyValues if written == "--json" => {
            context_text(error, ContextKind::InvalidValue).map(redirection_tip)
        }
        _ => None,
    }
}

/// A text that belongs to an error; `None` if there is none.
fn context_text(error: &clap::Error, kind: ContextKind) -> Option<&str> {
    match error.get(kind) {
        Some(ContextValue::String(text)) => Some(text),
        _ => None,
    }
}

/// The tip about an unknown option; `None` if that of the parser stays.
fn unknown_option_tip(
    error: &clap::Error,
    written: &str,
    definition: &Command,
    arguments: &[OsString],
) -> Option<String> {
    let command = |argument: &OsString| definition.find_subcommand(argument);
    let synonym = arguments.iter().skip(1).find_map(command).and_then(|command| tip(command, written));
    if synonym.is_some() || error.get(ContextKind::SuggestedArg).is_some() {
        return synonym;
    }
    match arguments.get(1).and_then(command) {
        // The parser would advise to use the option as a file name.
        Some(command) => Some(format!("'patchcord {} --help' lists the options", command.get_name())),
        None if written == "-v" => Some("use '--version'".to_owned()),
        // The parser says that the command after the option has this option.
        None if error.get(ContextKind::Suggested).is_some() => None,
        None => Some("'patchcord --help' lists the commands".to_owned()),
    }
}

/// The tip about a file name after `--json`.
fn redirection_tip(file: &str) -> String {
    format!("--json prints the document on standard output: redirect it with '> {file}'")
}

/// The tip about an unknown option of a command, which begins with a hyphen. `None` if the tables have none for the
/// command.
fn tip(command: &Command, written: &str) -> Option<String> {
    let word = written.strip_prefix('-')?.trim_start_matches('-').to_lowercase().replace('_', "-");
    let sentence = SENTENCES.iter().find(|(words, option, _)| {
        words.contains(&word.as_str()) && option.is_none_or(|name| option_text(command, name).is_some())
    });
    if let Some((.., sentence)) = sentence {
        return Some((*sentence).to_owned());
    }
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
        Some([value, ..]) if option.get_action().takes_values() => Some(format!("'--{name} <{value}>'")),
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
            ("run", "-v", "use '--verbose'"),
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
    fn a_method_is_that_of_the_options_or_of_the_patch() {
        let [of_options, of_patch, quiet] = SENTENCES.map(|(.., sentence)| Some(sentence));
        for (command, expected) in
            [("run", of_options), ("slideway", of_options), ("draw", of_patch), ("man", None)]
        {
            assert_eq!(tip_of(command, "--method").as_deref(), expected, "{command}");
        }
        let run = definition().find_subcommand("run").unwrap().clone();
        for name in ["step", "tol"] {
            let option = option_text(&run, name).unwrap();
            assert!(of_options.is_some_and(|sentence| sentence.contains(&option)), "{option}");
        }
        assert_eq!(tip_of("man", "--quiet").as_deref(), quiet);
    }

    #[test]
    fn every_word_is_in_one_row_and_every_option_exists() {
        let sentences = SENTENCES.iter().skip(1).flat_map(|(words, ..)| *words);
        let words: Vec<&str> =
            OPTIONS.iter().flat_map(|(words, _)| *words).chain(sentences).copied().collect();
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
