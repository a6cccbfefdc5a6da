//! What the laws of the elements mean for scales: which outputs must have the same factor, and which settings change
//! with it.
//!
//! A factor multiplies the voltage of an output in every instant. The law of an element holds for the multiplied
//! voltages if the factors of its inputs and its output are related, and its settings are multiplied too.

use super::wiring::Wiring;

/// What a setting is proportional to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Size {
    /// It stays.
    Fixed,
    /// The output of its element.
    Output,
    /// An input.
    Input(&'static str),
    /// The reciprocal of an input.
    PerInput(&'static str),
    /// The output over an input.
    OutputPerInput(&'static str),
    /// Machine time.
    Time,
}

/// What a setting of a kind is proportional to. Settings of pots and of diode networks with biases are not here.
pub(super) fn size(kind: &str, setting: &str) -> Size {
    match (kind, setting) {
        ("integrator", "initial" | "rest" | "limit.upper" | "limit.lower" | "limit.drop")
        | ("summer", "limit.upper" | "limit.lower" | "limit.drop")
        | ("lag" | "backlash" | "track-hold" | "delay", "initial")
        | ("backlash", "width")
        | ("diode-dead-zone" | "diode-lower-of" | "diode-upper-of", "drop")
        | ("sin" | "cos", "amplitude")
        | ("log", "per_decade")
        | ("exp", "reference")
        | ("comparator", "high" | "low") => Size::Output,
        ("integrator", "threshold") => Size::Input("reset"),
        ("track-hold", "threshold") => Size::Input("track"),
        ("comparator", "threshold")
        | ("relay", "pull_in" | "drop_out")
        | ("dead-zone", "lower" | "upper")
        | ("log", "reference" | "least")
        | ("exp", "per_decade") => Size::Input("in"),
        ("sin" | "cos", "angle_per_volt") => Size::PerInput("in"),
        ("dead-zone", "slope") => Size::OutputPerInput("in"),
        ("lag", "time") | ("delay", "delay") => Size::Time,
        _ => Size::Fixed,
    }
}

/// The input without which a setting has no effect. `None` if it always has one.
pub(super) fn necessary_input(kind: &str, setting: &str) -> Option<&'static str> {
    match (kind, setting) {
        ("integrator", "rest") => Some("gap"),
        ("integrator", "threshold") => Some("reset"),
        _ => None,
    }
}

/// A relation between factors: the sum of coefficient x log(factor) over outputs is 0.
pub(super) type Tie = Vec<(usize, f64)>;

/// The relations between the factors of an element's inputs and output, except for jacks with gains and for pots.
///
/// If `adapts` is true, the setting of a diode network with biases follows its input, so its output is not tied.
pub(super) fn ties(wiring: &Wiring<'_>, element: usize, adapts: bool) -> Vec<Tie> {
    let sources = |input: &str| wiring.sources(element, input);
    let all = |inputs: &[&str]| inputs.iter().flat_map(|input| sources(input)).collect::<Vec<_>>();
    match wiring.kind(element).name {
        "inverter" | "absolute" | "key-switch" | "track-hold" | "delay" | "backlash" | "diode-lower-of"
        | "diode-upper-of" => equal(element, &sources("in")),
        "free-pot" if !wiring.is_pot(element) && !wiring.has_reference_ends(element) => {
            equal(element, &all(&["in", "end"]))
        }
        "diode-dead-zone" if adapts => among(&all(&["bias_plus", "bias_minus"])),
        "diode-dead-zone" => equal(element, &all(&["in", "bias_plus", "bias_minus"])),
        "multiplier" => product(wiring, element),
        "comparator" => among(&all(&["in", "against"])),
        "relay" => [among(&all(&["in", "against"])), equal(element, &all(&["on", "off"]))].concat(),
        "integrator" => among(&sources("gap")),
        _ => Vec::new(),
    }
}

/// One output has the same factor as each of the others.
fn equal(one: usize, others: &[usize]) -> Vec<Tie> {
    others.iter().map(|other| vec![(one, 1.0), (*other, -1.0)]).collect()
}

/// All these outputs have the same factor.
fn among(outputs: &[usize]) -> Vec<Tie> {
    outputs.split_first().map_or_else(Vec::new, |(first, others)| equal(*first, others))
}

/// The relations of a multiplier: the factor of a product is the product of the factors, and the squares of a sum have
/// equal factors.
fn product(wiring: &Wiring<'_>, element: usize) -> Vec<Tie> {
    let [a, b] = ["a", "b"].map(|input| wiring.sources(element, input));
    if wiring.word(element, "mode") == Some("sum-of-squares") {
        return a.iter().chain(&b).map(|from| vec![(element, 1.0), (*from, -2.0)]).collect();
    }
    match (a.first(), b.first()) {
        (Some(a), Some(b)) => vec![vec![(element, 1.0), (*a, -1.0), (*b, -1.0)]],
        // A product with ground is 0 V in every scale.
        _ => Vec::new(),
    }
}
