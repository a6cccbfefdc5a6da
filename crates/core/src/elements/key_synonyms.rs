//! Keys of elements and drives in other programs and in textbooks, and the keys of this format.
//!
//! Hints for unknown keys use these tables before they look for a similar key.

use super::kind::Kind;
use super::setting::Setting;
use crate::document::fields::KeyAdvice;
use crate::document::key_synonyms::{KeySynonyms, synonym_advice};

/// Keys that people write, and the key of this format. A row counts only for a kind that has the key.
static KEYS: [KeySynonyms; 31] = [
    KeySynonyms::new("initial", &["ic", "initial_condition", "initial_value", "init", "start", "x0", "y0"]),
    KeySynonyms::new("in", &["input", "inputs", "from", "source"]),
    KeySynonyms::new("setting", &["gain", "k", "value", "coefficient", "fraction", "factor", "position"]),
    KeySynonyms::new("time", &["tau", "time_constant", "t"]),
    KeySynonyms::new("delay", &["time", "delay_time", "dead_time", "tau"]),
    KeySynonyms::new("pull_in", &["threshold", "upper", "hysteresis", "level"]),
    KeySynonyms::new("drop_out", &["lower", "release", "dropout"]),
    KeySynonyms::new("on", &["high", "true", "then"]),
    KeySynonyms::new("off", &["low", "false", "else"]),
    KeySynonyms::new("high", &["on", "true", "then", "upper", "max"]),
    KeySynonyms::new("low", &["off", "false", "else", "lower", "min"]),
    KeySynonyms::new("threshold", &["level", "pull_in", "trigger", "reset_threshold", "reset_level"]),
    KeySynonyms::new("against", &["reference", "compare", "than"]),
    KeySynonyms::new("track", &["control", "sample", "sampling"]),
    KeySynonyms::new("a", &["x", "in1", "first"]),
    KeySynonyms::new("b", &["y", "in2", "second"]),
    KeySynonyms::new("upper", &["max", "maximum", "high"]),
    KeySynonyms::new("lower", &["min", "minimum", "low"]),
    KeySynonyms::new("mode", &["operation", "type", "connection"]),
    KeySynonyms::new("amplitude", &["amp", "ampl", "a", "peak"]),
    KeySynonyms::new("height", &["amplitude", "amp", "ampl", "a", "value", "size"]),
    KeySynonyms::new("at", &["time", "start", "t0", "delay"]),
    KeySynonyms::new("rate", &["slope", "speed"]),
    KeySynonyms::new("frequency", &["freq", "f", "hz"]),
    KeySynonyms::new("phase", &["phi", "angle", "phase_angle"]),
    KeySynonyms::new("duty", &["duty_cycle", "duty_factor", "ratio"]),
    KeySynonyms::new("width", &["pulse_width", "length", "duration", "on_time"]),
    KeySynonyms::new("begin", &["at", "time", "start", "t0", "delay"]),
    KeySynonyms::new("from", &["f0", "start", "start_frequency", "f_start"]),
    KeySynonyms::new("to", &["f1", "end", "stop", "end_frequency", "f_end"]),
    KeySynonyms::new("time", &["duration", "sweep_time", "t1", "length"]),
];

/// The hint for a period where the format has a frequency.
const PERIOD_HINT: &str = "write the frequency, 1 / period: \"frequency\": \"1 / 0.5\" for a period of 0.5 s";

/// The hint for an angular frequency where the format has a frequency.
const ANGULAR_FREQUENCY_HINT: &str =
    "write the frequency in Hz: \"frequency\": \"10 / (2 * pi)\" for an angular frequency of 10 rad/s";

/// What people write for an angular frequency.
const ANGULAR_FREQUENCIES: [&str; 4] = ["omega", "w", "w0", "angular_frequency"];

/// The hint for another way to specify the frequency: a period or an angular frequency. `None` for other keys.
fn frequency_hint(written: &str) -> Option<&'static str> {
    match written {
        "period" => Some(PERIOD_HINT),
        _ => ANGULAR_FREQUENCIES.contains(&written).then_some(ANGULAR_FREQUENCY_HINT),
    }
}

/// The hint for a gain of a pot.
const POT_GAIN_HINT: &str = "the \"setting\" of a pot is from 0 to 1; a gain above 1 belongs to a cord of a summer or \
                             integrator: \"in\": {\"x10\": [\"P1\"]}";

/// The hint about a key that a kind does not have. `None` if the tables do not have the key.
///
/// `group` is the group of settings that has the key and a dot, such as "limit."; it is empty for the keys of the
/// element itself.
pub(crate) fn key_advice(kind: &Kind, group: &str, written: &str) -> Option<KeyAdvice> {
    if group.is_empty()
        && kind.has_gains()
        && let Some(hint) = jack_hint(kind, written)
    {
        return Some(KeyAdvice { key: "in", hint });
    }
    let written = written.to_lowercase();
    if group.is_empty()
        && kind.setting("frequency").is_some()
        && let Some(hint) = frequency_hint(&written)
    {
        return Some(KeyAdvice { key: "frequency", hint: hint.to_owned() });
    }
    if group.is_empty() && kind.setting("setting").is_some() && is_gain(&written) {
        return Some(KeyAdvice { key: "setting", hint: POT_GAIN_HINT.to_owned() });
    }
    let has_key = |key: &str| {
        let has_input = kind.inputs.iter().any(|input| input.name == key);
        let is_input = group.is_empty() && (has_input || (kind.has_gains() && key == "in"));
        is_input || kind.setting(&format!("{group}{key}")).is_some()
    };
    let limit = || if group.is_empty() { limit_advice(kind, &written) } else { None };
    synonym_advice(&KEYS, &written, has_key).or_else(limit)
}

/// The hint for a limit of an amplifier that is written outside "limit". `None` for other keys.
fn limit_advice(kind: &Kind, written: &str) -> Option<KeyAdvice> {
    kind.setting("limit.lower")?;
    let is_limit = |key: &str| ["lower", "upper"].contains(&key);
    let advice = synonym_advice(&KEYS, written, is_limit);
    let key = if is_limit(written) { written } else { advice.as_ref()?.key };
    let volts = if key == "lower" { "-10" } else { "10" };
    let hint = format!("write \"limit\": {{\"{key}\": {volts}}}, in volts");
    Some(KeyAdvice { key: "limit", hint })
}

/// The hint for a key of an amplifier that is written among its inputs, inside "in". `None` for other keys.
pub(crate) fn misplaced_key_hint(kind: &Kind, written: &str) -> Option<String> {
    let has_key = |setting: &Setting| setting.name.split('.').next() == Some(written);
    let key = if ["note", "uses"].contains(&written) || kind.settings.iter().any(has_key) {
        written
    } else {
        let KeyAdvice { key, hint } = key_advice(kind, "", written)?;
        match key {
            "in" => return is_gain(written).then_some(hint),
            "limit" => return Some(format!("{hint}, next to \"in\"")),
            other => other,
        }
    };
    Some(format!("write \"{key}\" next to \"in\", not in it"))
}

/// The hint for a gain of an element whose inputs have gains.
const GAIN_HINT: &str = "the gain is in the name of an input: write \"in\": {\"x10\": [\"A1\"]}";

/// The hint for a jack, or for a gain, that is written next to "in" and not in it. `None` for other keys.
fn jack_hint(kind: &Kind, written: &str) -> Option<String> {
    if kind.input(written).is_some() {
        return Some(format!("write \"in\": {{\"{written}\": [\"A1\"]}}"));
    }
    is_gain(written).then(|| GAIN_HINT.to_owned())
}

/// Whether a key is meant as a gain.
fn is_gain(written: &str) -> bool {
    ["gain", "gains"].contains(&written)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::{Family, find};

    #[test]
    fn keys_of_other_programs_are_recognised() {
        let hint = |family, kind: &str, group: &str, key: &str| {
            key_advice(find(family, kind).unwrap(), group, key).map(|advice| advice.hint)
        };
        let element = |kind: &str, key: &str| hint(Family::Computing, kind, "", key);
        let meant = |key: &str| Some(format!("did you mean \"{key}\"?"));
        assert_eq!(element("integrator", "ic"), meant("initial"));
        assert_eq!(element("pot", "K"), meant("setting"));
        assert_eq!(element("pot", "gain").as_deref(), Some(POT_GAIN_HINT));
        assert_eq!(element("free-pot", "gains").as_deref(), Some(POT_GAIN_HINT));
        assert_eq!(element("lag", "tau"), meant("time"));
        assert_eq!(element("delay", "tau"), meant("delay"));
        assert_eq!(element("relay", "threshold"), meant("pull_in"));
        assert_eq!(hint(Family::Computing, "summer", "limit.", "max"), meant("upper"));
        assert_eq!(hint(Family::Drive, "step", "", "value"), meant("height"));
        assert_eq!(hint(Family::Drive, "pulse", "", "at"), meant("begin"));
        assert_eq!(hint(Family::Drive, "chirp", "", "duration"), meant("time"));
        assert_eq!(hint(Family::Drive, "square", "", "period").as_deref(), Some(PERIOD_HINT));
        for key in ["amp", "ampl", "A"] {
            assert_eq!(hint(Family::Drive, "sine", "", key), meant("amplitude"), "{key}");
            assert_eq!(hint(Family::Drive, "step", "", key), meant("height"), "{key}");
        }
        assert_eq!(hint(Family::Drive, "sine", "", "f"), meant("frequency"));
        assert_eq!(hint(Family::Drive, "sine", "", "omega").as_deref(), Some(ANGULAR_FREQUENCY_HINT));
        assert_eq!(element("comparator", "level"), meant("threshold"));
        assert_eq!(element("integrator", "reset").as_deref(), Some("write \"in\": {\"reset\": [\"A1\"]}"));
        assert_eq!(element("pot", "ic"), None);
        assert_eq!(element("summer", "x10").as_deref(), Some("write \"in\": {\"x10\": [\"A1\"]}"));
        assert_eq!(element("integrator", "gain").as_deref(), Some(GAIN_HINT));
        assert_eq!(element("summer", "inputs"), meant("in"));
        assert_eq!(element("multiplier", "y"), meant("b"));
        assert_eq!(element("comparator", "min"), meant("low"));
        let limit = |bound: &str| Some(format!("write \"limit\": {{{bound}}}, in volts"));
        for key in ["min", "Minimum", "lower", "low"] {
            assert_eq!(element("integrator", key), limit("\"lower\": -10"), "{key}");
        }
        for key in ["max", "upper", "high"] {
            assert_eq!(element("summer", key), limit("\"upper\": 10"), "{key}");
        }
        assert_eq!(element("pot", "min"), None);
    }

    #[test]
    fn a_key_inside_the_inputs_belongs_next_to_them() {
        let hint = |written| misplaced_key_hint(find(Family::Computing, "integrator").unwrap(), written);
        let next_to = |key: &str| Some(format!("write \"{key}\" next to \"in\", not in it"));
        let cases = [("initial", "initial"), ("ic", "initial"), ("limit", "limit"), ("note", "note")];
        for (written, key) in cases {
            assert_eq!(hint(written), next_to(key), "{written}");
        }
        let limit = "write \"limit\": {\"lower\": -10}, in volts, next to \"in\"";
        assert_eq!(hint("min").as_deref(), Some(limit));
        assert_eq!(hint("gain").as_deref(), Some(GAIN_HINT));
        for written in ["P1", "x", "input", ""] {
            assert_eq!(hint(written), None, "{written}");
        }
    }
}
