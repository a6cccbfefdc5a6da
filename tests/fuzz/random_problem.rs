//! Random problems for `scale`: a few equations between pure numbers.

use super::document::Node;
use crate::common::random::SplitMix64;

/// The parameters, with their values. One of them is 0.
const PARAMETERS: [(&str, f64); 3] = [("a", 0.7), ("b", -2.5), ("c", 0.0)];

/// Functions of one argument, and the text after the argument.
const FUNCTIONS: [(&str, &str); 12] = [
    ("sin(", ")"),
    ("cos(", ")"),
    ("abs(", ")"),
    ("sign(", ")"),
    ("step(", ")"),
    ("max(", ", 0)"),
    ("min(", ", 0.5)"),
    ("exp(-abs(", "))"),
    ("atan(", ")"),
    ("sqrt(1 + (", ")^2)"),
    ("dead_zone(", ", 0.2)"),
    ("1/(2 + sin(", "))"),
];

/// The number of steps of a run.
const STEPS: f64 = 200.0;

/// A problem with up to four quantities, most of which are bounded for any right side.
pub(crate) fn random_problem(random: &mut SplitMix64) -> Node {
    let names: Vec<String> = (1..=1 + random.below(4)).map(|number| format!("x{number}")).collect();
    let mut quantities = Vec::new();
    let mut equations = Vec::new();
    for name in &names {
        let is_second = random.below(4) == 0;
        quantities.push((name.clone(), quantity(random)));
        if is_second {
            quantities.push((format!("{name}'"), quantity(random)));
        }
        let [primes, damping] = if is_second { ["''", "'"] } else { ["'", ""] };
        let right = expression(&names, 3, random);
        let rest = if is_second { format!(" - {name}") } else { String::new() };
        equations.push(Node::text(&format!("{name}{primes} = {right} - {name}{damping}{rest}")));
    }
    let parameters = PARAMETERS.map(|(name, value)| {
        (name.to_owned(), Node::object([("value", Node::number(value)), ("unit", Node::text("1"))]))
    });
    let step = random.choose(&[0.001, 0.01]);
    Node::object([
        ("patchcord", Node::Number("1".to_owned())),
        ("parameters", Node::Object(parameters.to_vec())),
        ("quantities", Node::Object(quantities)),
        ("equations", Node::List(equations)),
        ("run", Node::object([("for", Node::number(STEPS * step)), ("step", Node::number(step))])),
    ])
}

/// A quantity with a value at the start.
fn quantity(random: &mut SplitMix64) -> Node {
    let initial = random.choose(&[0.0, 0.5, 1.0, -3.0, 20.0]);
    Node::object([("unit", Node::text("1")), ("initial", Node::number(initial))])
}

/// The right side of an equation. `depth` limits how deeply it is nested.
fn expression(names: &[String], depth: usize, random: &mut SplitMix64) -> String {
    if depth == 0 {
        return leaf(names, random);
    }
    let mut inner = || expression(names, depth - 1, random);
    let [one, other] = [inner(), inner()];
    match random.below(8) {
        0 | 1 => format!("({one} + {other})"),
        2 => format!("({one} - {other})"),
        3 => format!("({one})*({other})"),
        4 => format!("({one})/(1 + ({other})^2)"),
        5 => leaf(names, random),
        _ => {
            let (before, after) = random.choose(&FUNCTIONS);
            format!("{before}{one}{after}")
        }
    }
}

/// A name or a number.
fn leaf(names: &[String], random: &mut SplitMix64) -> String {
    match random.below(8) {
        0 => random.choose(&["2", "0.1", "7", "0"]).to_owned(),
        1 => random.choose(&PARAMETERS).0.to_owned(),
        2 => "t".to_owned(),
        3 => format!("{} {}", random.choose(&PARAMETERS).0, random.pick(names)),
        _ => random.pick(names).clone(),
    }
}
