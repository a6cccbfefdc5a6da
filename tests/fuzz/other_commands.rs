//! Command lines of the commands that read no document of the user.

use super::case::Case;
use super::command_lines::once_in;
use super::corpus::Files;
use super::number_text::{changed_number, edge_name, usual_number};
use crate::common::random::SplitMix64;
use patchcord::elements::REGISTRY;
use patchcord::thesis::replay::{Figure, figures};

/// The names of all commands.
pub(crate) const COMMAND_NAMES: [&str; 18] = [
    "check",
    "completions",
    "draw",
    "effects",
    "elements",
    "equations",
    "gap",
    "linearise",
    "machines",
    "man",
    "new",
    "panel",
    "profile",
    "replay",
    "run",
    "scale",
    "slideway",
    "sweep",
];

/// Other words in place of a command: the one for help texts, and one that does not exist.
const OTHER_WORDS: [&str; 2] = ["help", "schema"];

/// The shells with completions, and one without.
const SHELLS: [&str; 6] = ["bash", "elvish", "fish", "powershell", "zsh", "csh"];

/// A patch that exists before the command.
const EXISTING: &str = "first.json";

/// How the names of figures begin that are drawn within seconds. The others need sweeps.
const QUICK_FIGURES: [&str; 5] = ["fig-2-", "fig-4-", "fig-7-", "fig-8-0", "fig-8-1"];

/// The words as a command line.
fn line(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// The name of a command, or another word in its place.
fn command_word(random: &mut SplitMix64) -> &'static str {
    random.choose(&[&COMMAND_NAMES[..], &OTHER_WORDS[..]].concat())
}

/// A command that reads no document and computes nothing.
pub(crate) fn other_case(random: &mut SplitMix64) -> Case {
    let arguments = match random.below(11) {
        0 | 1 => new_command(random),
        2 | 3 => catalogue_command(random),
        4 => machines_command(random),
        5 => completions_command(random),
        6 => man_command(random),
        7 | 8 => refused_figure_command(random),
        9 => refused_panel_command(random),
        _ => help_command(random),
    };
    Case::of(Files::from([(EXISTING.to_owned(), b"{}\n".to_vec())]), arguments)
}

/// `new`. No name leads out of the folder of the case, unless it has the wrong ending.
fn new_command(random: &mut SplitMix64) -> Vec<String> {
    let names =
        ["spring.json", "two words.json", "no/such/folder/spring.json", "./a.json", "spring", ".json"];
    let mut words = line(&["new"]);
    if once_in(3, random) {
        words.push("--json".to_owned());
    }
    words.push(match random.below(5) {
        0 => EXISTING.to_owned(),
        1 => edge_name(random),
        2 => format!("{}.json", edge_name(random).replace('/', "_")),
        _ => random.choose(&names).to_owned(),
    });
    words
}

/// `elements` or `effects`: the catalogue, a page, the schema. The name is last, since "--" ends the options.
fn catalogue_command(random: &mut SplitMix64) -> Vec<String> {
    let mut words = line(&[random.choose(&["elements", "effects"])]);
    for option in ["--json", "--schema", "--markdown"] {
        if once_in(4, random) {
            words.push(option.to_owned());
        }
    }
    match random.below(4) {
        0 => words.push(random.choose(REGISTRY).name.to_owned()),
        1 => words.push(edge_name(random)),
        _ => (),
    }
    words
}

/// `machines`, sometimes with an argument that it does not have.
fn machines_command(random: &mut SplitMix64) -> Vec<String> {
    let lines: [&[&str]; 4] =
        [&["machines"], &["machines", "--json"], &["machines", "one"], &["machines", "-j"]];
    line(random.choose(&lines))
}

/// `completions`.
fn completions_command(random: &mut SplitMix64) -> Vec<String> {
    let shell = if once_in(5, random) { edge_name(random) } else { random.choose(&SHELLS).to_owned() };
    vec!["completions".to_owned(), shell]
}

/// `man`: a page, or all pages in a folder.
fn man_command(random: &mut SplitMix64) -> Vec<String> {
    let mut words = line(&["man"]);
    if once_in(3, random) {
        words.extend(line(&["--out", "results"]));
    }
    match random.below(4) {
        0 => words.push(edge_name(random)),
        1 | 2 => words.push(command_word(random).to_owned()),
        _ => (),
    }
    words
}

/// `panel` with an option or a patch that it refuses. Otherwise it would serve and not end.
fn refused_panel_command(random: &mut SplitMix64) -> Vec<String> {
    let lines: [&[&str]; 7] = [
        &["panel", "--no-open", "--port", "0", "no-such-file.json"],
        &["panel", "--no-open", "--port", "65536"],
        &["panel", "--no-open", "--address", "nowhere"],
        &["panel", "--no-open", "--address", "203.0.113.1"],
        &["panel", "--no-open", "--open"],
        &["panel", "--export", "page.html", "--site", "no-such-folder"],
        &["panel", "--export", "page.json", "no-such-file.json"],
    ];
    line(random.choose(&lines))
}

/// A help text, or the message about a command that does not exist.
fn help_command(random: &mut SplitMix64) -> Vec<String> {
    let command = command_word(random);
    match random.below(8) {
        0 => line(&["--help"]),
        1 => line(&["--version"]),
        2 => line(&["help", command]),
        3 => vec!["help".to_owned(), edge_name(random)],
        4 | 5 => line(&[command, random.choose(&["--help", "-h"])]),
        6 => line(&[command, "--no-such-option", "--json"]),
        _ => line(&["chekc", "--json"]),
    }
}

/// `replay` without a figure that is drawn: the list, or a line that is refused.
fn refused_figure_command(random: &mut SplitMix64) -> Vec<String> {
    let all: Vec<&'static Figure> = figures().collect();
    let figure = random.choose(&all).id;
    let wrong = match random.below(5) {
        0 => format!("{figure}x"),
        1 => format!("{figure}.json"),
        2 => figure.to_uppercase(),
        3 => "Fig 1.1".to_owned(),
        // The mark keeps "--" from being accepted.
        _ => format!("{}?", edge_name(random)),
    };
    let mut words = line(&["replay"]);
    if once_in(3, random) {
        words.push("--json".to_owned());
    }
    words.extend(match random.below(6) {
        0 => Vec::new(),
        1 => line(&["--out", "results"]),
        2 => line(&["--plot", "d.svg", "all"]),
        3 => line(&["--plot", "d.jpg", figure]),
        4 => line(&["--out", "results", figure, &wrong]),
        _ => vec![wrong],
    });
    words
}

/// `replay` with one or two figures that are drawn within seconds.
pub(crate) fn figure_command(random: &mut SplitMix64) -> Vec<String> {
    let is_quick = |figure: &&Figure| QUICK_FIGURES.iter().any(|begin| figure.id.starts_with(begin));
    let quick: Vec<&'static Figure> = figures().filter(is_quick).collect();
    let mut words = line(&["replay"]);
    let options: [&[&str]; 4] =
        [&["--json"], &["--out", "results"], &["--plot", "d.svg"], &["--plot", "d.png"]];
    for option in options {
        if once_in(3, random) {
            words.extend(line(option));
        }
    }
    for _ in 0..=random.below(2) {
        let figure = random.choose(&quick);
        let number = figure.number();
        words.push(match random.below(3) {
            0 => number.trim_start_matches("Fig ").to_owned(),
            1 => number,
            _ => figure.id.to_owned(),
        });
    }
    words
}

/// `slideway`. Its step is short enough that a run has few events in each step.
pub(crate) fn slideway(random: &mut SplitMix64) -> Vec<String> {
    let required = [("--oil", "2.5"), ("--weight", "433"), ("--stiffness", "45")];
    let optional = [
        ("--area", "697"),
        ("--ridge-width", "50"),
        ("--ridge-height", "2.5"),
        ("--by", "10"),
        ("--threshold", "0.25"),
        ("--window", "0.04"),
    ];
    let mut words = line(&["slideway", "--step", "1e-3"]);
    for (index, (option, usual)) in required.iter().chain(&optional).enumerate() {
        if index < required.len() || once_in(2, random) {
            let value = if once_in(2, random) { changed_number(usual, random) } else { (*usual).to_owned() };
            words.extend([(*option).to_owned(), value]);
        }
    }
    if once_in(3, random) {
        words.push("--polar".to_owned());
    }
    if once_in(3, random) {
        let name = random.pick(&["M", "K", "f", "Fs", "VcL", "Tc"]);
        words.extend(["--set".to_owned(), format!("{name}={}", usual_number(random))]);
    }
    let outputs = ["--json", "--out=slideway.json", "--plot=profile.svg"];
    words.extend(outputs.get(random.below(5)).map(|word| (*word).to_owned()));
    words
}
