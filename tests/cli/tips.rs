//! Tips about options and commands of other programs.

use super::{FIG_8_16, code, errors, json, patchcord};

#[test]
fn an_option_of_another_program_gets_a_tip() {
    let cases = [
        (["run", "--dt", "1e-4"], "tip: use '--step <SECONDS|auto>'\n"),
        (["run", "--tolerance", "1e-6"], "tip: use '--tol <SHARE>'\n"),
        (["sweep", "--duration", "1"], "tip: use '--for <SECONDS>'\n"),
        (["run", "-o", "x.csv"], "tip: use '--csv <FILE>', '--plot <FILE.svg|png>' or '--out <DIR>'\n"),
    ];
    for ([command, option, value], wanted) in cases {
        let failed = patchcord(&[command, FIG_8_16, option, value]);
        let message = errors(&failed);
        assert_eq!(code(&failed), 2, "{message}");
        assert!(message.starts_with(&format!("error: unexpected argument '{option}' found\n")), "{message}");
        assert!(message.contains(wanted) && message.matches("tip:").count() == 1, "{message}");
    }
    let message = errors(&patchcord(&["check", FIG_8_16, "--dt", "1e-4"]));
    assert!(!message.contains("--step"), "{message}");
}

/// The tip of a command line that is refused.
fn tip(arguments: &[&str]) -> String {
    let failed = patchcord(arguments);
    let message = errors(&failed);
    assert_eq!(code(&failed), 2, "{arguments:?}: {message}");
    assert_eq!(message.matches("tip:").count(), 1, "{arguments:?}: {message}");
    message.lines().find_map(|line| line.trim().strip_prefix("tip: ")).unwrap().to_owned()
}

#[test]
fn a_tip_about_an_unknown_option_names_what_the_command_has() {
    let method = "the step selects the method: '--step <SECONDS|auto>' takes equal Runge-Kutta steps of order 4, \
                  '--tol <SHARE>' takes Dormand-Prince steps of orders 5 and 4";
    let quiet = "set the environment variable PATCHCORD_PROGRESS=0 to print no progress, and redirect standard output \
                 to discard the results";
    let cases: &[(&[&str], &str)] = &[
        (&["run", FIG_8_16, "--method"], method),
        (&["run", FIG_8_16, "--method=rk45"], method),
        (&["run", FIG_8_16, "-v"], "use '--verbose'"),
        (&["run", FIG_8_16, "-q"], quiet),
        (&["check", FIG_8_16, "--quiet"], quiet),
        (&["run", FIG_8_16, "--zzz"], "'patchcord run --help' lists the options"),
        (&["check", FIG_8_16, "-z"], "'patchcord check --help' lists the options"),
        (&["run", FIG_8_16, "--recrod", "x"], "a similar argument exists: '--record'"),
        (&["--zzz"], "'patchcord --help' lists the commands"),
        (&["-v"], "use '--version'"),
        (&["--json", "run", FIG_8_16], "'run --json' exists"),
    ];
    for (arguments, expected) in cases {
        assert_eq!(tip(arguments), *expected, "{arguments:?}");
    }
}

#[test]
fn a_file_after_json_gets_a_tip() {
    let expected = "--json prints the document on standard output: redirect it with '> out.json'";
    for option in [&["--json", "out.json"][..], &["--json=out.json"]] {
        assert_eq!(tip(&[&["run", FIG_8_16], option].concat()), expected, "{option:?}");
    }
    let extra = patchcord(&["run", FIG_8_16, "out.json", "--json"]);
    assert_eq!((code(&extra), errors(&extra).contains("tip:")), (2, false), "{}", errors(&extra));
}

#[test]
fn a_command_of_another_program_gets_a_tip() {
    let curves = "'patchcord run PATCH --plot FILE.svg' draws the curves of a run, \
                  'patchcord draw PATCH --plot FILE.svg' the schematic";
    let fit = "'patchcord gap EXPERIMENT' fits a patch to measured data and finds the effect that it lacks";
    let cases: &[(&[&str], &str)] = &[
        (&["plot", FIG_8_16], curves),
        (&["simulate", FIG_8_16], "use 'patchcord run PATCH'"),
        (&["validate", FIG_8_16], "use 'patchcord check PATCH'"),
        (&["init"], "'patchcord new FILE.json' writes a first patch"),
        (&["fit", FIG_8_16], fit),
        (&["help", "lint"], "use 'patchcord check PATCH'"),
        (&["spring.json"], "use 'patchcord run spring.json' or 'patchcord check spring.json'"),
        (&["chekc"], "a similar subcommand exists: 'check'"),
    ];
    for (arguments, expected) in cases {
        assert_eq!(tip(arguments), *expected, "{arguments:?}");
    }
    let document = patchcord(&["plot", FIG_8_16, "--json"]);
    assert_eq!(json(&document)["error"], "unrecognized subcommand 'plot'");
}
