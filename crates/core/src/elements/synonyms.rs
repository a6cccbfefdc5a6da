//! Names of elements and words in other programs and in textbooks, and what to write here.
//!
//! Hints for unknown names use these tables before they look for a similar name. Keys have tables of their own in
//! `key_synonyms`, and functions of formulas in `patchcord_expr`.

use super::find;
use super::kind::Family;

/// Names for a kind of element or drive.
struct KindSynonyms {
    /// The section in which the names are written.
    family: Family,
    /// What people write, in lower case with hyphens.
    names: &'static [&'static str],
    /// What to write here. Every kind in it is in quotes.
    advice: &'static str,
}

/// Names in the section "elements".
const fn element(names: &'static [&'static str], advice: &'static str) -> KindSynonyms {
    KindSynonyms { family: Family::Computing, names, advice }
}

/// Names in the section "drives".
const fn drive(names: &'static [&'static str], advice: &'static str) -> KindSynonyms {
    KindSynonyms { family: Family::Drive, names, advice }
}

/// The names for kinds.
static KINDS: &[KindSynonyms] = &[
    element(
        &["adder", "add", "sum", "plus", "subtractor", "subtract", "minus", "difference"],
        "use a \"summer\": it adds its inputs and inverts the sum; to subtract, put an \"inverter\" in front",
    ),
    element(
        &["gain", "amplifier", "scale", "coefficient", "potentiometer", "attenuator", "voltage-divider"],
        "a gain up to 1 is a \"pot\"; a larger gain is an input of a \"summer\": \"in\": {\"x10\": [\"A1\"]}",
    ),
    element(&["negate", "negator", "invert", "inv", "neg"], "use an \"inverter\""),
    element(
        &["not", "not-gate"],
        "for a logical not, use a \"comparator\" with \"high\": -100 and \"low\": 100; to change the sign, use \
         an \"inverter\"",
    ),
    element(
        &["and", "and-gate"],
        "use a \"diode-lower-of\": with high and low voltages, it is high if both inputs are high",
    ),
    element(
        &["or", "or-gate"],
        "use a \"diode-upper-of\": with high and low voltages, it is high if an input is high",
    ),
    element(
        &["resistor"],
        "the resistors of an amplifier are the gains of its inputs: a \"summer\" has \"in\": {\"x10\": \
         [\"A1\"]}",
    ),
    element(&["capacitor"], "an amplifier with a capacitor as its feedback is an \"integrator\""),
    element(
        &["op-amp", "opamp", "operational-amplifier"],
        "use a \"summer\", an \"integrator\", or an \"open-amplifier\" with the feedback that you patch",
    ),
    element(
        &["compare", "threshold", "zero-crossing", "zero-crossing-detector", "logic", "gate"],
        "use a \"comparator\": its output is \"high\" while \"in\" is at or above \"threshold\", and \"low\" \
         below",
    ),
    element(
        &["schmitt", "schmitt-trigger", "hysteresis", "bang-bang", "hysteresis-comparator"],
        "use a \"relay\": it compares \"in\" with \"against\", and has two thresholds, \"drop_out\" below \
         \"pull_in\"",
    ),
    element(
        &["switch", "selector", "mux", "multiplexer"],
        "a \"relay\" is switched by a voltage, and a \"key-switch\" is set by hand",
    ),
    element(
        &["sign", "signum", "sgn"],
        "use a \"comparator\": its output is \"high\", 100 V, from 0 V on and \"low\", -100 V, below",
    ),
    element(
        &["divider", "divide", "division", "quotient", "reciprocal"],
        "use an \"open-amplifier\" with a \"multiplier\" in its feedback, as in patches/lessons/\
         square-root-and-division.json; a voltage divider is a \"pot\"",
    ),
    element(
        &["sqrt", "square-root", "root"],
        "use an \"open-amplifier\" with a \"multiplier\" in its feedback, as in patches/lessons/\
         square-root-and-division.json",
    ),
    element(
        &["asin", "arcsin", "arcsine"],
        "use an \"open-amplifier\" with a \"sin\" in its feedback, as in patches/lessons/\
         square-root-and-division.json",
    ),
    element(
        &["pow", "power", "exponent"],
        "a square is a \"multiplier\" with the same output at \"a\" and \"b\"; other powers are a \
         \"function-generator\"",
    ),
    element(
        &["tan", "tangent", "atan", "arctan", "acos", "arccos", "tanh", "cosh", "sinh"],
        "use a \"function-generator\" with points of this curve",
    ),
    element(
        &["product", "multiply", "mult", "mul", "times"],
        "use a \"multiplier\" with \"mode\": \"product\"",
    ),
    element(
        &["square", "squarer", "sqr"],
        "use a \"multiplier\" with \"mode\": \"product\" and the same output at \"a\" and \"b\"",
    ),
    element(
        &["limiter", "limit", "saturation", "saturate", "clamp", "clip", "clipper", "zener", "zener-diode"],
        "give a \"summer\" or an \"integrator\" the key \"limit\": {\"lower\": -10, \"upper\": 10}, in volts",
    ),
    element(
        &["constant", "const", "bias", "source", "dc", "voltage", "reference"],
        "use a \"pot\" with \"in\": \"+100\" or \"-100\": a \"setting\" of 0.2 gives 20 V or -20 V",
    ),
    element(
        &["sample-hold", "sample-and-hold", "sampler", "track-and-hold", "track-store", "zoh"],
        "use a \"track-hold\": it follows \"in\", inverted, while \"track\" is at or above its threshold",
    ),
    element(&["integral", "integrate", "int"], "use an \"integrator\": it inverts"),
    element(
        &["ic", "initial", "initial-condition"],
        "an initial condition is the setting \"initial\" of an \"integrator\", in volts",
    ),
    element(
        &["diode", "ideal-diode", "half-wave-rectifier"],
        "a \"diode-upper-of\" gives the larger of two voltages, and a \"diode-lower-of\" the smaller",
    ),
    element(
        &["derivative", "differentiator", "differentiate", "derivator"],
        "no element differentiates: the derivative is at the input of the \"integrator\" that makes the signal",
    ),
    element(&["filter", "low-pass", "lowpass", "pt1", "first-order"], "use a \"lag\": it inverts"),
    element(&["dead-time", "transport-delay", "time-delay", "delay-line"], "use a \"delay\""),
    element(&["abs", "absolute-value", "rectifier", "magnitude"], "use an \"absolute\""),
    element(&["deadband", "dead-band", "deadzone"], "use a \"dead-zone\""),
    element(&["play", "gear-play"], "use a \"backlash\""),
    element(&["min", "minimum", "lower-of"], "use a \"diode-lower-of\""),
    element(&["max", "maximum", "upper-of"], "use a \"diode-upper-of\""),
    element(
        &["lookup", "lookup-table", "lut", "curve", "function", "nonlinearity", "characteristic"],
        "a curve of a voltage is a \"function-generator\"; a \"table\" over time belongs in \"drives\"",
    ),
    element(&["table"], "a curve of a voltage is a \"function-generator\""),
    element(&["ln", "logarithm"], "use a \"log\": its base is 10"),
    element(
        &["log10", "lg"],
        "use a \"log\": its output is 0 V at an input of \"reference\", and \"per_decade\" more for each \
         factor of 10",
    ),
    element(
        &["dac", "d-a-converter", "digital-to-analog"],
        "a fixed voltage is a \"pot\" with \"in\": \"+100\"; values over time are a \"table\" in \"drives\"",
    ),
    element(
        &["vco", "voltage-controlled-oscillator"],
        "use two \"integrator\"s and an \"inverter\" in a loop, and multiply the input of each \"integrator\" \
         by the control voltage in a \"multiplier\"",
    ),
    element(
        &["prbs", "random-binary"],
        "use a \"comparator\" of a \"noise\" from \"drives\": it is high or low at random, for \"every\" \
         seconds each",
    ),
    element(
        &["sawtooth", "saw", "saw-tooth"],
        "use an \"integrator\" of a constant voltage, with a \"comparator\" of its output at \"reset\"; in \
         \"drives\", use a \"table\"",
    ),
    element(
        &["timer", "stopwatch"],
        "an \"integrator\" of a constant voltage measures time; a \"pulse\" in \"drives\" switches at given \
         times",
    ),
    element(
        &["counter", "pulse-counter"],
        "an \"integrator\" of equal pulses counts them: each one changes its output by the same voltage",
    ),
    element(
        &["pid", "pi", "pd", "pid-controller", "controller"],
        "add the error, its \"integrator\" and its derivative in a \"summer\", each through a \"pot\"; the \
         derivative is at the input of the \"integrator\" that makes the signal",
    ),
    element(
        &["transfer-function", "transfer-fcn", "tf", "state-space", "second-order", "pt2"],
        "a first order is a \"lag\"; a higher order needs one \"integrator\" for each order, with feedback \
         through a \"pot\" for each coefficient",
    ),
    drive(
        &["constant", "const", "dc", "heaviside", "jump"],
        "use a \"step\" with \"at\": 0: it has its \"height\" from the start",
    ),
    drive(
        &["sin", "sinus", "sinusoid", "sinusoidal", "sine-wave", "cos", "cosine", "oscillator"],
        "use a \"sine\"",
    ),
    drive(
        &["square-wave", "rect", "rectangle", "rectangular", "rectangular-wave", "clock", "pwm"],
        "use a \"square\"",
    ),
    drive(&["triangular", "triangle-wave"], "use a \"triangle\""),
    drive(
        &["trapezoid", "trapezoidal", "trapezium"],
        "use a \"table\" of its corners; a periodic one is a \"triangle\" through a \"summer\" with a \"limit\" in \
         \"elements\"",
    ),
    drive(
        &["pulse-train", "rectangular-pulse", "impulse", "burst", "gate"],
        "use a \"pulse\": with a \"period\" it repeats",
    ),
    drive(&["sweep", "swept-sine", "sine-sweep", "frequency-sweep", "fm"], "use a \"chirp\""),
    drive(&["staircase"], "use a \"table\" with \"hold\": \"previous\""),
    drive(&["csv", "file", "data", "curve", "lookup", "lut", "points", "dac"], "use a \"table\""),
    drive(
        &["sawtooth", "saw", "saw-tooth"],
        "use a \"table\"; a periodic one is an \"integrator\" in \"elements\" that a \"comparator\" of its \
         output resets",
    ),
    drive(&["random", "white-noise", "gaussian"], "use a \"noise\""),
    drive(
        &["prbs", "random-binary"],
        "use a \"noise\", and a \"comparator\" of it in \"elements\": its output is high or low at random",
    ),
];

/// What to write instead of a kind of other programs. `None` if the tables do not have the name.
///
/// Capitals, blanks and underscores in the name do not count.
///
/// # Examples
///
/// ```
/// use patchcord_core::elements::{Family, kind_advice};
///
/// assert_eq!(kind_advice(Family::Drive, "random"), Some("use a \"noise\""));
/// assert_eq!(kind_advice(Family::Computing, "Low Pass"), Some("use a \"lag\": it inverts"));
/// assert_eq!(kind_advice(Family::Computing, "sumer"), None);
/// ```
pub fn kind_advice(family: Family, name: &str) -> Option<&'static str> {
    let name = with_hyphens(name);
    let found = KINDS.iter().find(|row| row.family == family && row.names.contains(&name.as_str()));
    found.map(|row| row.advice)
}

/// A name in lower case, with hyphens in place of blanks and underscores.
fn with_hyphens(name: &str) -> String {
    name.to_lowercase().replace(['_', ' '], "-")
}

/// The hint for a name that no kind of a section has. A kind of the other section belongs there: a drive among elements,
/// or an element among drives. `None` if nothing is known about the name.
pub(crate) fn kind_hint(family: Family, name: &str) -> Option<String> {
    let (section, other, other_section, other_noun) = match family {
        Family::Drive => ("drives", Family::Computing, "elements", "an element"),
        Family::Computing | Family::Reference => ("elements", Family::Drive, "drives", "a drive"),
    };
    let advice = kind_advice(family, name);
    let misplaced = find(other, &with_hyphens(name))
        .map(|kind| format!("\"{}\" is {other_noun}: write it under \"{other_section}\"", kind.name));
    match (misplaced, advice) {
        (Some(misplaced), Some(advice)) => Some(format!("{misplaced}; in \"{section}\", {advice}")),
        (None, Some(advice)) => Some(advice.to_owned()),
        (Some(misplaced), None) => Some(misplaced),
        (None, None) => kind_advice(other, name).map(|advice| format!("in \"{other_section}\", {advice}")),
    }
}

/// Words that people write for a word of a setting.
const WORDS: [(&[&str], &str); 3] = [
    (&["multiply", "multiplication", "mult", "times", "four-quadrant", "quarter-squares", "xy"], "product"),
    (&["squares", "sum-squares", "sum_of_squares", "square"], "sum-of-squares"),
    (&["zoh", "zero-order", "hold", "staircase", "steps"], "previous"),
];

/// The permitted word that is meant by another one. `None` if the table does not have the word.
pub(crate) fn meant_word(written: &str, permitted: &[&'static str]) -> Option<&'static str> {
    let written = written.to_lowercase();
    let (_, meant) = WORDS.iter().find(|(words, _)| words.contains(&written.as_str()))?;
    permitted.iter().copied().find(|word| word == meant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::{REGISTRY, names};

    /// The texts in quotes.
    fn quoted(text: &str) -> Vec<&str> {
        text.split('"').skip(1).step_by(2).collect()
    }

    #[test]
    fn every_kind_has_one_row_and_advice_names_a_kind() {
        for (index, row) in KINDS.iter().enumerate() {
            for name in row.names {
                assert!(find(row.family, name).is_none(), "{name} is a kind");
                let first =
                    KINDS.iter().position(|row_2| row_2.family == row.family && row_2.names.contains(name));
                assert_eq!(first, Some(index), "{name}");
                assert_eq!(kind_advice(row.family, name), Some(row.advice));
            }
            let is_kind = |word: &&str| find(row.family, word).is_some();
            assert!(quoted(row.advice).iter().any(is_kind), "{}", row.advice);
        }
    }

    #[test]
    fn advice_quotes_only_words_of_the_format() {
        let mut words: Vec<&str> =
            vec!["+100", "-100", "A1", "x10", "in", "limit", "lower", "upper", "drives", "mode"];
        words.extend(["product", "previous", "hold", "elements"]);
        for kind in REGISTRY {
            words.push(kind.name);
            words.extend(kind.inputs.iter().map(|input| input.name));
            words.extend(kind.settings.iter().map(|setting| setting.name));
        }
        for word in KINDS.iter().flat_map(|row| quoted(row.advice)) {
            assert!(words.contains(&word), "{word}");
        }
    }

    #[test]
    fn advice_names_the_kind_that_does_the_same() {
        let cases: [(&[&str], &str); 14] = [
            (&["not"], "comparator"),
            (&["inv", "neg"], "inverter"),
            (&["schmitt", "Schmitt Trigger", "hysteresis", "mux"], "relay"),
            (&["log10", "ln"], "log"),
            (&["min", "and"], "diode-lower-of"),
            (&["max", "or", "diode"], "diode-upper-of"),
            (&["sqrt", "square_root", "op-amp"], "open-amplifier"),
            (&["amplifier", "resistor", "clamp", "zener", "saturation", "pid"], "summer"),
            (&["capacitor", "vco", "sawtooth", "timer", "counter", "differentiator"], "integrator"),
            (&["lookup", "lut"], "function-generator"),
            (&["deadband"], "dead-zone"),
            (&["play"], "backlash"),
            (&["prbs"], "noise"),
            (&["transfer-function"], "lag"),
        ];
        for (names, kind) in cases {
            for name in names {
                let advice = kind_advice(Family::Computing, name).unwrap_or_default();
                assert!(quoted(advice).contains(&kind), "{name}: {advice}");
            }
        }
    }

    /// Every drive among elements, and every element among drives, also in capitals.
    #[test]
    fn a_kind_of_the_other_section_belongs_there() {
        let families = [
            (Family::Drive, Family::Computing, "is a drive: write it under \"drives\""),
            (Family::Computing, Family::Drive, "is an element: write it under \"elements\""),
        ];
        for (family, other, place) in families {
            for name in names(family) {
                for written in [name.to_owned(), name.to_uppercase(), name.replace('-', "_")] {
                    let hint = kind_hint(other, &written).unwrap_or_default();
                    assert!(hint.starts_with(&format!("\"{name}\" {place}")), "{written}: {hint}");
                }
            }
        }
    }

    #[test]
    fn names_of_kinds_in_either_section_get_a_hint() {
        let element = |name| kind_hint(Family::Computing, name).unwrap();
        let drive = |name| kind_hint(Family::Drive, name).unwrap();
        assert_eq!(element("ramp"), "\"ramp\" is a drive: write it under \"drives\"");
        assert_eq!(
            element("square"),
            "\"square\" is a drive: write it under \"drives\"; in \"elements\", use a \"multiplier\" with \"mode\": \
             \"product\" and the same output at \"a\" and \"b\""
        );
        assert_eq!(
            element("table"),
            "\"table\" is a drive: write it under \"drives\"; in \"elements\", a curve of a voltage is a \
             \"function-generator\""
        );
        assert_eq!(element("rect"), "in \"drives\", use a \"square\"");
        assert_eq!(
            element("trapezoid"),
            "in \"drives\", use a \"table\" of its corners; a periodic one is a \"triangle\" through a \"summer\" \
             with a \"limit\" in \"elements\""
        );
        assert!(element("sawtooth").ends_with("at \"reset\"; in \"drives\", use a \"table\""));
        assert_eq!(drive("integrator"), "\"integrator\" is an element: write it under \"elements\"");
        assert_eq!(
            drive("cos"),
            "\"cos\" is an element: write it under \"elements\"; in \"drives\", use a \"sine\""
        );
        assert_eq!(drive("rect"), "use a \"square\"");
        assert_eq!(
            drive("adder"),
            format!("in \"elements\", {}", kind_advice(Family::Computing, "sum").unwrap())
        );
        assert_eq!(kind_hint(Family::Drive, "gyrator"), None);
    }

    #[test]
    fn articles_fit_the_kinds_in_quotes() {
        for advice in KINDS.iter().map(|row| row.advice) {
            for (before, after) in advice.match_indices(" \"").map(|(at, _)| advice.split_at(at)) {
                let is_vowel = after.trim_start_matches([' ', '"']).starts_with(['a', 'e', 'i', 'o', 'u']);
                let article = before.rsplit(' ').next().unwrap_or_default();
                let wrong = if is_vowel { "a" } else { "an" };
                assert_ne!(article, wrong, "{advice}");
            }
        }
    }

    #[test]
    fn words_of_other_programs_are_recognised() {
        let modes = ["sum-of-squares", "product"];
        assert_eq!(meant_word("Multiply", &modes), Some("product"));
        assert_eq!(meant_word("zoh", &modes), None);
        assert_eq!(meant_word("quotient", &modes), None);
    }
}
