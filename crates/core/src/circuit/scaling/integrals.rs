//! Warns of a rate and its integral whose scales contradict the wiring between them.
//!
//! The unit of a position is that of a velocity times seconds, so the block gain between the two is 1. Eq. 4-8 then
//! gives the computer gain without any knowledge of the equations. A wrong scale, gain or time scale violates it.
//!
//! Wiring through a pot whose setting depends on a parameter is not checked: its block gain is that parameter.

use std::f64::consts::TAU;

use super::{Circuit, SignalPath, SignalPoint, Wiring, physical_gain};
use crate::document::{Code, Diagnostic, TIME_SCALE, format_number};
use crate::elements::Transfer;
use crate::patch::Amount;

/// Product of the numbers of elements and of scaled signals up to which the wiring is checked. It limits the time to
/// about a tenth of a second.
const MAX_WORK: usize = 1_000_000;

/// Relative deviation of a block gain from 1 up to which it counts as 1. Settings of pots are often rounded.
const GAIN_TOLERANCE: f64 = 0.01;

/// The warnings about all pairs of a rate and its integral. Empty if the circuit is too large to be checked.
pub(in crate::circuit) fn integral_warnings(circuit: &Circuit) -> Vec<Diagnostic> {
    let scaled = || circuit.signals().iter().filter(|point| point.scale.is_some());
    if scaled().count().saturating_mul(circuit.elements().len()) > MAX_WORK {
        return Vec::new();
    }
    let wiring = without_parameters(Wiring::new(circuit), circuit);
    let mut warnings = Vec::new();
    for output in scaled() {
        let paths = wiring.paths_to(output.element);
        warnings.extend(paths.iter().filter_map(|path| warning(circuit, output, path)));
    }
    warnings
}

/// The wiring with NaN as the gain of every pot whose setting depends on a parameter. So the gain of a path through
/// such a pot is NaN, too.
pub(super) fn without_parameters<'c>(mut wiring: Wiring<'c>, circuit: &Circuit) -> Wiring<'c> {
    for (element, drivers) in wiring.drivers.iter_mut().enumerate() {
        if depends_on_parameter(circuit, element) {
            drivers.iter_mut().for_each(|driver| driver.gain = f64::NAN);
        }
    }
    wiring
}

/// Whether an element is a pot whose setting names anything else than scales. Scales may depend on parameters.
fn depends_on_parameter(circuit: &Circuit, element: usize) -> bool {
    let scales = &circuit.patch().scales;
    let is_scale = |name: &&str| *name == TIME_SCALE || scales.contains_key(*name);
    let element = circuit.element(element);
    let names_parameter = |amount: &Amount| match amount {
        Amount::Formula(formula) => !formula.names().iter().all(is_scale),
        Amount::Flag(_) | Amount::Choice(_) | Amount::Points(_) => false,
    };
    element.kind.transfer == Transfer::Share
        && element.settings.iter().flatten().any(|setting| names_parameter(&setting.value))
}

/// The warning about a path from a rate to its integral. `None` if the path is none, or agrees with the scales.
///
/// The sign of the gain does not count: an output may be the integral of the negative input.
fn warning(circuit: &Circuit, output: &SignalPoint, path: &SignalPath<'_>) -> Option<Diagnostic> {
    let gain = physical_gain(circuit, output, path)?;
    let factor = gain.block_gain.abs();
    let required = path.gain.abs() / factor;
    if path.integrations == 0
        || !gain.dimension.is_dimensionless()
        || !is_wrong(factor)
        || !required.is_finite()
    {
        return None;
    }
    let integral = if path.integrations == 1 { "integral" } else { "double integral" };
    let has_time_scale = circuit.time_scale() != 1.0;
    let message = format!(
        "{} is {} times the {integral} of {}: the gain between them is {}, but {} {}",
        output.name,
        format_number(factor),
        path.input.name,
        format_number(path.gain.abs()),
        if has_time_scale { "the scales and the time scale require" } else { "the scales require" },
        format_number(required)
    );
    let wrong = if has_time_scale { "a scale, a gain or the time scale" } else { "a scale or a gain" };
    let is_time_scale = has_time_scale && is_power_of(factor, circuit.time_scale());
    let hint = if is_time_scale {
        "the factor is the time scale: divide the settings in front of integrators by time_scale".to_owned()
    } else {
        format!("correct {wrong}; if the factor is intended, write it as a parameter")
    };
    let span = circuit.element(output.element).span?;
    Some(Diagnostic::at(Code::SCALE_MISMATCH, span, message).hint(hint))
}

/// Whether a factor is the time scale or its square, or the reciprocal of either.
fn is_power_of(factor: f64, time_scale: f64) -> bool {
    [-2, -1, 1, 2].into_iter().any(|power| (factor / time_scale.powi(power) - 1.0).abs() < GAIN_TOLERANCE)
}

/// The warning if the patch has a time scale and pots in front of integrators, and none of their settings names the time
/// scale. `None` if a setting is a number or names only parameters that could contain the time scale, or if the patch
/// states equations: they decide, and the time scale can be in the gains.
pub(in crate::circuit) fn time_scale_warning(circuit: &Circuit) -> Option<Diagnostic> {
    let time_scale = circuit.time_scale();
    if time_scale == 1.0 || !circuit.equations().is_empty() {
        return None;
    }
    let elements = circuit.elements();
    let integrators =
        (0..elements.len()).filter(|element| elements[*element].kind.transfer == Transfer::Integrating);
    let drivers = integrators.flat_map(|element| circuit.cords(element)).filter(|(_, cord)| cord.input == 0);
    let pots: Vec<usize> = drivers
        .map(|(from, _)| from)
        .filter(|from| elements[*from].kind.transfer == Transfer::Share)
        .collect();
    let scales = &circuit.patch().scales;
    let is_scaled =
        |element: &usize| setting_names(circuit, *element).iter().any(|name| scales.contains_key(*name));
    let names_time =
        elements.iter().enumerate().any(|(element, _)| setting_names(circuit, element).contains(&TIME_SCALE));
    let first = *pots.first().filter(|_| !names_time && pots.iter().all(is_scaled))?;
    let speed = if time_scale < 1.0 { "slow" } else { "fast" };
    let times = format_number(time_scale.max(1.0 / time_scale));
    let message = format!(
        "no setting contains time_scale, so all rates are {times} times too {speed} for a time scale of {}",
        format_number(time_scale)
    );
    Some(Diagnostic::at(Code::UNUSED_TIME_SCALE, elements[first].span?, message))
}

/// The names in the formulas of an element's settings.
fn setting_names(circuit: &Circuit, element: usize) -> Vec<&str> {
    let settings = circuit.element(element).settings.iter().flatten();
    let formulas = settings.filter_map(|setting| match &setting.value {
        Amount::Formula(formula) => Some(formula.names()),
        Amount::Flag(_) | Amount::Choice(_) | Amount::Points(_) => None,
    });
    formulas.flatten().collect()
}

/// Whether a block gain differs from 1, and does not count turns. NaN is not wrong, and neither is 0: a pot at 0
/// disconnects its input on purpose.
fn is_wrong(factor: f64) -> bool {
    factor > 0.0 && (factor - 1.0).abs() > GAIN_TOLERANCE && !counts_turns(factor)
}

/// Whether a block gain is 2 pi or its reciprocal: a phase in rad is 2 pi times the integral of a frequency in Hz.
pub(super) fn counts_turns(factor: f64) -> bool {
    [TAU, 1.0 / TAU].into_iter().any(|turn| (factor / turn - 1.0).abs() <= GAIN_TOLERANCE)
}

#[cfg(test)]
mod tests {
    use crate::circuit::Circuit;
    use crate::patch::{ElementBuilder, PatchBuilder};

    /// The messages of the warnings about a position x, the integral of a velocity v behind a pot with this setting.
    /// `units` are those of x and v, and `velocity` is the value of one volt of v.
    fn warnings(units: [&str; 2], velocity: f64, time_scale: f64, setting: &str) -> Vec<String> {
        let patch = PatchBuilder::new("integral")
            .time_scale(time_scale)
            .parameter("ratio", 0.5, "1", [0.0, 1.0])
            .scale("position", 1.0, units[0])
            .scale("velocity", velocity, units[1])
            .drive("V", "velocity", ElementBuilder::new("step").set("height", 1))
            .element("P", ElementBuilder::new("pot").cord("in", "V").set("setting", setting))
            .element("X", ElementBuilder::new("integrator").cords("x10", ["P"]))
            .signal("v", "V", "velocity", 1.0)
            .signal("x", "X", "position", -1.0)
            .build()
            .unwrap();
        let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
        circuit.warnings().findings.into_iter().map(|finding| finding.message).collect()
    }

    #[test]
    fn a_gain_that_is_not_finite_is_not_required() {
        // One volt of v is 1e310 volts of x per second.
        let found = warnings(["mm", "m/s"], 1e307, 1.0, "1");
        assert!(found.iter().all(|message| !message.contains("inf")), "{found:?}");
    }

    #[test]
    fn a_wrong_scale_gain_or_time_scale_is_reported() {
        let mm = ["mm", "mm/s"];
        let half = "x is 0.5 times the integral of v: the gain between them is 10, but the scales require 20";
        assert_eq!(warnings(mm, 20.0, 1.0, "1"), [half]);
        let tenth = "x is 0.1 times the integral of v: the gain between them is 1, but the scales require 10";
        assert_eq!(warnings(mm, 10.0, 1.0, "velocity / position / 100"), [tenth]);
        let fast = "x is 10 times the integral of v: the gain between them is 10, \
                    but the scales and the time scale require 1";
        assert_eq!(warnings(mm, 10.0, 10.0, "1"), [fast]);
        let small =
            "x is 0.001 times the integral of v: the gain between them is 10, but the scales require 10000";
        assert_eq!(warnings(["mm", "m/s"], 10.0, 1.0, "1"), [small]);
    }

    #[test]
    fn right_scales_and_factors_of_parameters_get_no_warning() {
        let mm = ["mm", "mm/s"];
        let cases = [
            (mm, 10.0, 1.0, "1"),
            (mm, 10.0, 1.0, "0.995"),
            (mm, 20.0, 4.0, "velocity / position / 10 / time_scale"),
            (mm, 10.0, 1.0, "ratio"),
            (mm, 10.0, 1.0, "0"),
            (["rad", "Hz"], 1.0, 1.0, "0.628318531"),
            (["mm", "N"], 10.0, 1.0, "0.3"),
        ];
        for (units, velocity, time_scale, setting) in cases {
            let found = warnings(units, velocity, time_scale, setting);
            assert!(found.is_empty(), "{units:?} {velocity} {time_scale} {setting}: {found:?}");
        }
    }
}
