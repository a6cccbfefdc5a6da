//! Patches with thousands of parts, and commands on them.

use super::case::Case;
use super::command_lines::{PATCH, SWEEP, TABLE, once_in};
use super::corpus::Files;
use super::document::Node;
use crate::common::random::SplitMix64;

/// The smallest and the largest number of parts.
const COUNTS: (f64, f64) = (300.0, 10_000.0);

/// The sine that all patches have as a drive.
const DRIVE: &str = "D0";

/// The signal of the last element.
const LAST: &str = "last";

/// The part of which a patch has many, or the way in which its elements are connected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    /// Pots, integrators, summers and inverters in a row.
    Chain,
    /// The same in a ring, so that every state acts on every other.
    Ring,
    /// Integrators that are not connected to each other.
    Integrators,
    /// Pairs of summers, each pair a loop without an integrator.
    Loops,
    /// One loop of summers without an integrator.
    Loop,
    /// Backlashes, half of them behind another.
    Backlashes,
    /// Relays, half of them behind another.
    Relays,
    /// Delay lines in a row.
    Delays,
    /// Pots in a row, each with a parameter.
    Parameters,
    /// Signals at a few elements.
    Signals,
    /// Cords to one summer.
    Cords,
    /// Square waves as drives.
    Drives,
    /// Instances of a macro in a row.
    Instances,
}

/// All shapes.
pub(crate) const SHAPES: [Shape; 13] = [
    Shape::Chain,
    Shape::Ring,
    Shape::Integrators,
    Shape::Loops,
    Shape::Loop,
    Shape::Backlashes,
    Shape::Relays,
    Shape::Delays,
    Shape::Parameters,
    Shape::Signals,
    Shape::Cords,
    Shape::Drives,
    Shape::Instances,
];

/// A random command on a random large patch.
pub(crate) fn large_case(random: &mut SplitMix64) -> Case {
    let shape = random.choose(&SHAPES);
    let count = random.log_uniform(COUNTS.0, COUNTS.1).round() as usize;
    case_of(shape, count, large_command(random))
}

/// A command on a large patch.
pub(crate) fn case_of(shape: Shape, count: usize, arguments: Vec<String>) -> Case {
    let bytes = large_patch(shape, count).json().into_bytes();
    Case::of(Files::from([(PATCH.to_owned(), bytes)]), arguments)
}

/// A command with random options, each of them in one of three cases. Its runs have the few steps of the patch.
fn large_command(random: &mut SplitMix64) -> Vec<String> {
    let (command, options): (&[&str], &[&[&str]]) = match random.below(8) {
        0 => (&["check", PATCH], &[&["--json"], &["--voltages"], &["--scaling"]]),
        1..4 => (
            &["run", PATCH],
            &[
                &["--json"],
                &["--csv", TABLE],
                &["--plot", "out.svg"],
                &["--sensitivity", "u"],
                &["--tol", "1e-3"],
                &["--backend", "reference"],
            ],
        ),
        4 | 5 => (
            &["linearise", PATCH],
            &[&["--json"], &["--at", "0.005"], &["--from", DRIVE, "--to", LAST, "--csv", TABLE]],
        ),
        6 => (&["draw", PATCH, "--plot", "d.svg"], &[&["--json"], &["--open"], &["--values"]]),
        _ => (
            &["sweep", PATCH, "--vary", "u=10:90:3", "--measure", "peak:last", "--threads", "2"],
            &[&["--out", SWEEP]],
        ),
    };
    let mut words = command.to_vec();
    for option in options {
        if once_in(3, random) {
            words.extend_from_slice(option);
        }
    }
    words.into_iter().map(str::to_owned).collect()
}

/// A valid patch with this number of parts, at least 8. Its run has ten steps.
pub(crate) fn large_patch(shape: Shape, count: usize) -> Node {
    let elements = match shape {
        Shape::Signals => 8,
        Shape::Drives => 1,
        _ => count,
    };
    let mut entries = vec![
        ("patchcord".to_owned(), Node::Number("1".to_owned())),
        ("parameters".to_owned(), Node::Object(parameters(shape, count))),
        (
            "scales".to_owned(),
            Node::object([(
                "volt",
                Node::object([("per_volt", Node::number(1.0)), ("unit", Node::text("V"))]),
            )]),
        ),
        ("drives".to_owned(), Node::Object(drives(shape, count))),
        ("elements".to_owned(), Node::Object(numbered("E", elements, |index| element(shape, index, count)))),
        ("signals".to_owned(), Node::Object(signals(shape, count, elements))),
        ("run".to_owned(), Node::object([("for", Node::number(0.01)), ("step", Node::number(0.001))])),
    ];
    if shape == Shape::Instances {
        entries.push(("macros".to_owned(), Node::object([("half", macro_of_a_pot())])));
    }
    Node::Object(entries)
}

/// Entries with numbered names.
fn numbered(name: &str, count: usize, value: impl Fn(usize) -> Node) -> Vec<(String, Node)> {
    (0..count).map(|index| (format!("{name}{index}"), value(index))).collect()
}

/// The amplitude of the drive, and those of the pots.
fn parameters(shape: Shape, count: usize) -> Vec<(String, Node)> {
    let parameter = |value: f64, unit: &str, highest: f64| {
        Node::object([
            ("value", Node::number(value)),
            ("unit", Node::text(unit)),
            ("range", Node::List(vec![Node::number(0.0), Node::number(highest)])),
        ])
    };
    let pots = if shape == Shape::Parameters { count } else { 0 };
    let mut found = vec![("u".to_owned(), parameter(50.0, "V", 100.0))];
    found.extend(numbered("p", pots, |_| parameter(0.5, "1", 1.0)));
    found
}

/// The sine, and the square waves if they are many.
fn drives(shape: Shape, count: usize) -> Vec<(String, Node)> {
    let drive = |kind: &str, amplitude: Node, frequency: usize| {
        Node::object([
            ("kind", Node::text(kind)),
            ("scale", Node::text("volt")),
            ("amplitude", amplitude),
            ("frequency", Node::number(frequency as f64)),
        ])
    };
    let mut found = vec![(DRIVE.to_owned(), drive("sine", Node::text("u"), 10))];
    if shape == Shape::Drives {
        found.extend(numbered("W", count, |index| drive("square", Node::number(5.0), 10 + index % 100)));
    }
    found
}

/// The signal of the last element, and more if they are many.
fn signals(shape: Shape, count: usize, elements: usize) -> Vec<(String, Node)> {
    let signal = |at: usize, factor: usize| {
        Node::object([
            ("at", Node::Text(name(at))),
            ("scale", Node::text("volt")),
            ("factor", Node::number(factor as f64)),
        ])
    };
    let many = if shape == Shape::Signals { count } else { 0 };
    let mut found = vec![(LAST.to_owned(), signal(elements - 1, 1))];
    found.extend(numbered("S", many, |index| signal(index % elements, index + 1)));
    found
}

/// A macro with one pot.
fn macro_of_a_pot() -> Node {
    Node::object([
        ("inputs", Node::object([("in", Node::text("input"))])),
        ("outputs", Node::object([("out", Node::text("F"))])),
        ("elements", Node::object([("F", pot("in".to_owned(), Node::number(0.5)))])),
    ])
}

/// The name of an element.
fn name(index: usize) -> String {
    format!("E{index}")
}

/// The element with this index. `count` is the number of parts.
fn element(shape: Shape, index: usize, count: usize) -> Node {
    let (drive, first) = (DRIVE.to_owned(), index == 0);
    let before = if first { drive.clone() } else { name(index - 1) };
    // Every other element reads the drive.
    let nearest = if index.is_multiple_of(2) { drive.clone() } else { before.clone() };
    match shape {
        Shape::Ring if first => amplifier("integrator", "x1", vec![drive, name(count - 1)]),
        Shape::Chain | Shape::Ring => link(index, before),
        Shape::Integrators => amplifier("integrator", "x1", vec![drive]),
        Shape::Loops => {
            // The last of an odd number of summers is a loop by itself.
            let partner = name((index ^ 1).min(count - 1));
            amplifier(
                "summer",
                "x0.3",
                if index.is_multiple_of(2) { vec![drive, partner] } else { vec![partner] },
            )
        }
        Shape::Loop if first => amplifier("summer", "x0.5", vec![drive, name(count - 1)]),
        Shape::Loop => amplifier("summer", "x0.5", vec![before]),
        Shape::Backlashes => {
            with_input("backlash", nearest, vec![("width", Node::number(1.0 + (index % 50) as f64))])
        }
        Shape::Relays => {
            let level = 0.5 * (index % 80) as f64;
            let settings = vec![
                ("on", Node::text("+100")),
                ("off", Node::text("-100")),
                ("pull_in", Node::number(level + 0.25)),
                ("drop_out", Node::number(level - 0.25)),
            ];
            with_input("relay", nearest, settings)
        }
        Shape::Delays => with_input("delay", before, vec![("delay", Node::number(0.005))]),
        Shape::Parameters => pot(before, Node::Text(format!("p{index}"))),
        Shape::Signals => pot(before, Node::number(0.5)),
        Shape::Cords if index + 1 == count => amplifier("summer", "x0.001", (0..index).map(name).collect()),
        Shape::Cords => pot(drive, Node::number(0.5)),
        Shape::Drives => {
            let waves = (0..count).map(|wave| format!("W{wave}"));
            amplifier("summer", "x0.0001", [drive].into_iter().chain(waves).collect())
        }
        Shape::Instances => with_input("half", before, Vec::new()),
    }
}

/// The element of a chain with this index.
fn link(index: usize, before: String) -> Node {
    match index % 4 {
        0 => pot(before, Node::number(0.5)),
        1 => amplifier("integrator", "x1", vec![before]),
        2 => amplifier("summer", "x1", vec![before]),
        _ => with_input("inverter", before, Vec::new()),
    }
}

/// A pot.
fn pot(source: String, setting: Node) -> Node {
    with_input("pot", source, vec![("setting", setting)])
}

/// An amplifier whose cords have the same gain.
fn amplifier(kind: &str, gain: &str, sources: Vec<String>) -> Node {
    let cords = Node::List(sources.into_iter().map(Node::Text).collect());
    Node::object([("kind", Node::text(kind)), ("in", Node::object([(gain, cords)]))])
}

/// An element with one main input.
fn with_input(kind: &str, source: String, settings: Vec<(&str, Node)>) -> Node {
    let entries = [("kind", Node::text(kind)), ("in", Node::Text(source))].into_iter().chain(settings);
    Node::Object(entries.map(|(key, value)| (key.to_owned(), value)).collect())
}
