//! Cases in which an input or an output is a pipe, a device, a folder, a file of the system, protected or missing.
//!
//! Such an input is refused without waiting, and without reading a device that has no end. Pipes are no outputs here: a
//! program that writes to a pipe without a reader waits.

use super::case::Case;
use super::command_lines::{PATCH, once_in};
use super::corpus::Corpus;
use super::experiment_case::{EFFECTS, effect_case, plain_experiment_case};
use super::patch_case::plain_patch_case;
use super::special_files::{FULL_DEVICE, Special};
use super::streams::{DASH, StandardInput, replace_word};
use crate::common::random::SplitMix64;

/// Paths in place of an input.
const INPUTS: [&str; 16] = [
    "/dev/zero",
    "/dev/null",
    FULL_DEVICE,
    "/dev/urandom",
    "/dev/stdin",
    "/dev/fd/0",
    "/proc",
    "/proc/kmsg",
    "/proc/self/fd/0",
    "/proc/self/maps",
    "/proc/self/mem",
    "/proc/self/pagemap",
    ".",
    "nowhere",
    "no/such/folder/file",
    DASH,
];

/// Paths in place of an output. No file outside the folder of the case can be created with them.
const OUTPUTS: [&str; 10] = [
    FULL_DEVICE,
    FULL_DEVICE,
    "/dev/null",
    "/dev/zero",
    "/proc/new.csv",
    ".",
    "nowhere",
    "no/such/folder/file",
    DASH,
    PATCH,
];

/// Paths in place of a patch on standard input.
const STREAMS: [&str; 6] = ["/dev/zero", "/dev/null", FULL_DEVICE, "/dev/urandom", "/proc/self/maps", "."];

/// A command of which one input or output is special.
pub(crate) fn special_case(corpus: &Corpus, random: &mut SplitMix64) -> Case {
    let mut case = match random.below(5) {
        0 => plain_experiment_case(corpus, random),
        1 => effect_case(corpus, random),
        _ => plain_patch_case(corpus, random),
    };
    match random.below(6) {
        0 => read_stream(&mut case, random),
        1 | 2 => replace_output(&mut case, random),
        _ => replace_input(&mut case, random),
    }
    case
}

/// Lets the command read its patch from a device or a folder on standard input.
fn read_stream(case: &mut Case, random: &mut SplitMix64) {
    replace_word(&mut case.arguments, PATCH, DASH);
    case.input = StandardInput::File(random.choose(&STREAMS).to_owned());
}

/// Replaces an output. If there is none, an input is replaced.
fn replace_output(case: &mut Case, random: &mut SplitMix64) {
    let outputs = output_paths(&case.arguments);
    if outputs.is_empty() {
        return replace_input(case, random);
    }
    let path = random.pick(&outputs).clone();
    match random.below(6) {
        0 => drop(case.specials.insert(path, Special::Folder)),
        1 => drop(case.specials.insert(path.clone(), link_to_itself(&path))),
        2 => {
            case.files.insert(path.clone(), b"kept\n".to_vec());
            case.specials.insert(path, Special::Protected);
        }
        _ => redirect(case, path, random.choose(&OUTPUTS), random),
    }
}

/// The paths that a command line names as outputs.
fn output_paths(arguments: &[String]) -> Vec<String> {
    let is_output = |pair: &&[String]| ["--csv", "--plot", "--out"].contains(&pair[0].as_str());
    arguments.windows(2).filter(is_output).map(|pair| pair[1].clone()).collect()
}

/// Replaces an input, or removes it: a file of the case or the folder of its effects.
fn replace_input(case: &mut Case, random: &mut SplitMix64) {
    let in_folder = format!("{EFFECTS}/");
    let mut inputs: Vec<String> = case.files.keys().cloned().collect();
    if inputs.iter().any(|path| path.starts_with(&in_folder)) {
        inputs.push(EFFECTS.to_owned());
    }
    let path = random.pick(&inputs).clone();
    let choice = random.below(10);
    if choice == 0 && path != EFFECTS {
        case.specials.insert(path, Special::Protected);
        return;
    }
    case.files.retain(|name, _| *name != path && !(path == EFFECTS && name.starts_with(&in_folder)));
    match choice {
        0 | 1 => (),
        2 | 3 => drop(case.specials.insert(path, Special::Pipe)),
        4 => drop(case.specials.insert(path, Special::Folder)),
        5 => drop(case.specials.insert(path.clone(), link_to_itself(&path))),
        _ => redirect(case, path, random.choose(&INPUTS), random),
    }
}

/// A link at this path whose target is the link.
fn link_to_itself(path: &str) -> Special {
    Special::Link(path.rsplit('/').next().unwrap_or_default().to_owned())
}

/// Replaces a path by a target: sometimes in the arguments, if they have it, otherwise by a link.
fn redirect(case: &mut Case, path: String, target: &str, random: &mut SplitMix64) {
    if case.arguments.contains(&path) && once_in(2, random) {
        replace_word(&mut case.arguments, &path, target);
    } else {
        case.specials.insert(path, Special::Link(target.to_owned()));
    }
}
