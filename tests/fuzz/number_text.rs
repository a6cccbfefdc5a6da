//! Random texts of numbers, formulas and names.

use super::edge_values::{FORMULAS, NAMES, NUMBERS, USUAL_NUMBERS};
use crate::common::random::SplitMix64;

/// A number at an edge, sometimes with hundreds of digits.
pub(crate) fn edge_number(random: &mut SplitMix64) -> String {
    match random.below(30) {
        0 => format!("1{}", "0".repeat(400)),
        1 => format!("0.{}1", "0".repeat(400)),
        _ => (*random.pick(&NUMBERS)).to_owned(),
    }
}

/// A number that is usual in patches.
pub(crate) fn usual_number(random: &mut SplitMix64) -> String {
    (*random.pick(&NUMBERS[..USUAL_NUMBERS])).to_owned()
}

/// A number near another one, or at an edge.
pub(crate) fn changed_number(text: &str, random: &mut SplitMix64) -> String {
    let Ok(number) = text.parse::<f64>() else { return edge_number(random) };
    let changed = match random.below(10) {
        0..4 => return edge_number(random),
        4 | 5 => number * 10f64.powi(random.below(25) as i32 - 12),
        6 => -number,
        7 => number * (1.0 + 0.5f64.powi(random.below(53) as i32)),
        8 => number * random.uniform(0.3, 3.0),
        _ => number + random.pick(&[1.0, -1.0, 100.0, 1e-9]),
    };
    if changed.is_finite() { format!("{changed:?}") } else { "1e308".to_owned() }
}

/// A name at an edge, sometimes a very long one.
pub(crate) fn edge_name(random: &mut SplitMix64) -> String {
    match random.below(20) {
        0 => "n".repeat(*random.pick(&[200, 201, 5000])),
        1 => "日".repeat(150),
        _ => (*random.pick(&NAMES)).to_owned(),
    }
}

/// A formula at an edge, sometimes a very long or deeply nested one.
pub(crate) fn edge_formula(random: &mut SplitMix64) -> String {
    match random.below(20) {
        0 => format!("{}1{}", "(".repeat(300), ")".repeat(300)),
        1 => format!("{}1", "1+".repeat(500)),
        2 => format!("{}1", "-".repeat(500)),
        _ => (*random.pick(&FORMULAS)).to_owned(),
    }
}

/// A formula with another operation, function, name or number. `names` is not empty.
pub(crate) fn changed_formula(text: &str, names: &[String], random: &mut SplitMix64) -> String {
    let functions = ["sqrt", "exp", "ln", "sin", "tan", "atan", "tanh", "floor", "abs", "log10", "exp10"];
    match random.below(5) {
        0 => edge_formula(random),
        1 => format!("{text}{}{}", random.pick(&[" * ", " / ", " + ", " - ", "^"]), random.pick(names)),
        2 => format!("{}({text})", random.pick(&functions)),
        3 => replaced_word(text, random.pick(names).as_str(), random),
        _ => replaced_word(text, &usual_number(random), random),
    }
}

/// The text with one of its names or numbers replaced.
fn replaced_word(text: &str, replacement: &str, random: &mut SplitMix64) -> String {
    let is_separator = |letter: char| !(letter.is_alphanumeric() || "_.".contains(letter));
    let words: Vec<&str> = text.split(is_separator).filter(|word| !word.is_empty()).collect();
    if words.is_empty() { replacement.to_owned() } else { text.replacen(random.pick(&words), replacement, 1) }
}
