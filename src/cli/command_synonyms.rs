//! Commands of other programs, and the commands of this one that do the same.
//!
//! An error about an unknown command gets a tip from this table before that of the parser, which looks for a similar
//! name.

use clap::error::{ContextKind, ContextValue, ErrorKind};

/// What people write, in lower case, and the tip.
const COMMANDS: &[(&[&str], &str)] = &[
    (
        &["plot", "scope", "curves", "picture"],
        "'patchcord run PATCH --plot FILE.svg' draws the curves of a run, \
         'patchcord draw PATCH --plot FILE.svg' the schematic",
    ),
    (
        &["graph", "diagram", "schematic", "render", "show", "view"],
        "'patchcord draw PATCH --plot FILE.svg' draws the schematic, \
         'patchcord run PATCH --plot FILE.svg' the curves of a run",
    ),
    #[cfg(feature = "panel")]
    (
        &["gui", "ui", "open", "edit", "browser", "web", "serve", "server", "interactive", "live"],
        "'patchcord panel PATCH' opens the front panel in a browser",
    ),
    (
        &["simulate", "sim", "start", "exec", "execute", "solve", "integrate", "operate"],
        "use 'patchcord run PATCH'",
    ),
    (
        &["validate", "verify", "lint", "test", "inspect", "info", "scaling", "voltages"],
        "use 'patchcord check PATCH'",
    ),
    (
        &["init", "create", "generate", "template", "example", "examples"],
        "'patchcord new FILE.json' writes a first patch",
    ),
    (
        &["fit", "identify", "ident", "identification", "estimate", "calibrate", "compare"],
        "'patchcord gap EXPERIMENT' fits a patch to measured data and finds the effect that it lacks",
    ),
    (
        &["optimize", "optimise", "optimization", "tune", "minimize", "minimise"],
        "'patchcord sweep PATCH --vary NAME=VALUES --measure MEASURE' compares parameter values, \
         'patchcord gap EXPERIMENT' fits parameters to measured data",
    ),
    (
        &["scan", "batch", "vary", "parameters", "montecarlo", "monte-carlo"],
        "use 'patchcord sweep PATCH --vary NAME=VALUES --measure MEASURE'",
    ),
    (
        &["bode", "roots", "eigenvalues", "poles", "stability", "frequency", "linear"],
        "use 'patchcord linearise PATCH'",
    ),
    (
        &["equation", "eqs", "ode", "odes", "formula", "formulas", "latex", "model"],
        "use 'patchcord equations PATCH'",
    ),
    (&["sensitivity", "sensitivities", "derivatives"], "use 'patchcord run PATCH --sensitivity PARAMETER'"),
    (
        &["list", "ls"],
        "'patchcord elements', 'patchcord effects', 'patchcord machines' and 'patchcord replay' each print a list",
    ),
    (&["version"], "use 'patchcord --version'"),
];

/// The same error with another tip, if it is about a command of other programs or about a file without a command.
pub(super) fn with_command_tip(mut error: clap::Error) -> clap::Error {
    let Some(tip) = tip(&error) else { return error };
    error.remove(ContextKind::SuggestedSubcommand);
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![tip.into()]));
    error
}

/// The tip about an unknown command; `None` if there is none.
fn tip(error: &clap::Error) -> Option<String> {
    let Some(ContextValue::String(written)) = error.get(ContextKind::InvalidSubcommand) else { return None };
    if error.kind() != ErrorKind::InvalidSubcommand {
        return None;
    }
    if written.ends_with(".experiment.json") {
        return Some(format!("use 'patchcord gap {written}'"));
    }
    if written.ends_with(".json") {
        return Some(format!("use 'patchcord run {written}' or 'patchcord check {written}'"));
    }
    let word = written.to_lowercase().replace('_', "-");
    let (_, tip) = COMMANDS.iter().find(|(words, _)| words.contains(&word.as_str()))?;
    Some((*tip).to_owned())
}

#[cfg(test)]
mod tests {
    use super::super::definition;
    use super::*;

    /// The tip about a command line; `None` if the command line is correct or its error has none.
    fn tip_about(line: &str) -> Option<String> {
        tip(&definition().try_get_matches_from(line.split(' ')).err()?)
    }

    #[test]
    fn commands_of_other_programs_are_recognised() {
        let cases = [
            ("patchcord Simulate spring.json", "use 'patchcord run PATCH'"),
            ("patchcord lint", "use 'patchcord check PATCH'"),
            ("patchcord help init", "'patchcord new FILE.json' writes a first patch"),
            ("patchcord spring.json", "use 'patchcord run spring.json' or 'patchcord check spring.json'"),
            ("patchcord spring.experiment.json", "use 'patchcord gap spring.experiment.json'"),
        ];
        for (line, expected) in cases {
            assert_eq!(tip_about(line).as_deref(), Some(expected), "{line}");
        }
        for line in ["patchcord chekc", "patchcord check spring.json", "patchcord run --plot"] {
            assert_eq!(tip_about(line), None, "{line}");
        }
    }

    #[test]
    fn every_word_is_in_one_row_and_is_no_command() {
        let words: Vec<&str> = COMMANDS.iter().flat_map(|(words, _)| *words).copied().collect();
        for (index, word) in words.iter().enumerate() {
            assert!(!words[..index].contains(word), "{word}");
            assert!(definition().find_subcommand(word).is_none(), "{word}");
        }
    }

    #[test]
    fn every_command_of_a_tip_is_accepted() {
        for (_, tip) in COMMANDS {
            let lines: Vec<&str> = tip.split('\'').skip(1).step_by(2).collect();
            assert!(!lines.is_empty(), "{tip}");
            for line in lines {
                let refused = definition().try_get_matches_from(line.split(' ')).err();
                assert!(refused.is_none_or(|error| !error.use_stderr()), "{line}");
            }
        }
    }
}
