//! The gains and pots that change the output of an amplifier by a factor.

use patchcord_core::circuit::{Circuit, Cord, Element};
use patchcord_core::elements::{Jacks, OutputStage, Transfer};
use patchcord_core::patch::Amount;
use patchcord_expr::format_significant;

/// Number of inputs whose changes are listed.
const MAX_CHANGES: usize = 3;
/// Largest relative difference between two gains that count as the same.
const GAIN_TOLERANCE: f64 = 1e-9;
/// The setting with the output at the start.
const INITIAL: &str = "initial";

/// The changes at the inputs of an amplifier that multiply its output by `times`. Its feedback to itself stays, because it
/// changes with the output. `None` if its inputs have no gains, if the machine has no gains that are large enough, or if
/// the amplifier has no feedback inside: then all gains together change nothing.
pub(super) fn gain_changes(circuit: &Circuit, element: usize, times: f64) -> Option<String> {
    let to = circuit.element(element);
    let has_gain = |cord: &Cord| matches!(to.kind.inputs[cord.input].jacks, Jacks::Gains);
    let mut cords = circuit.cords(element);
    cords.retain(|(_, cord)| has_gain(cord));
    if cords.is_empty() || to.kind.output == OutputStage::OpenAmplifier {
        return None;
    }
    cords.retain(|(from, _)| !comes_from(circuit, *from, element));
    let listed = cords.iter().take(MAX_CHANGES);
    let changes = listed.map(|(from, cord)| cord_change(circuit, element, (*from, cord.gain), times));
    let mut changes: Vec<String> = changes.collect::<Option<_>>()?;
    if cords.len() > MAX_CHANGES {
        changes.push("change its other inputs in the same way".to_owned());
    }
    if setting(circuit, to, INITIAL).is_some_and(|volts| volts != 0.0) {
        changes.push(format!("multiply its initial value by {}", number(times)));
    }
    (!changes.is_empty()).then(|| changes.join(", "))
}

/// Whether a voltage is the output of an element, or a share of it.
fn comes_from(circuit: &Circuit, voltage: usize, element: usize) -> bool {
    let is_pot = circuit.element(voltage).kind.transfer == Transfer::Share;
    voltage == element || is_pot && circuit.cords(voltage).iter().any(|(from, _)| *from == element)
}

/// The change at the input of an element that an output drives with a gain. A pot that drives nothing else is set. `None`
/// if the machine has no gain that is large enough.
fn cord_change(circuit: &Circuit, element: usize, (from, gain): (usize, f64), times: f64) -> Option<String> {
    let [to, source] = [element, from].map(|index| circuit.element(index));
    let name = source.name.as_str();
    let own_share = pot_setting(circuit, source).filter(|_| reader_count(circuit, from) == 1);
    match own_share {
        Some(share) if share * times <= 1.0 => {
            Some(format!("set {name} to {} in place of {}", number(share * times), number(share)))
        }
        _ if times < 1.0 => Some(format!("put a pot of {} between {name} and {}", number(times), to.name)),
        _ => gain_change((name, own_share), (to, circuit.input_gains(element)), gain, times),
    }
}

/// A larger gain of an input, of those that the machine has. A pot makes the product right if it must be smaller.
///
/// `source` is the output with its share if it is a pot that drives nothing else. `to` is the element with the gains that
/// it can have in ascending order; all, if there are none. `None` if no gain is large enough.
fn gain_change(
    (name, own_share): (&str, Option<f64>),
    (to, available): (&Element, &[f64]),
    gain: f64,
    times: f64,
) -> Option<String> {
    let change = |new: f64| format!("give {name} a gain of {} in place of {}", number(new), number(gain));
    let is_same = |new: &f64| (new / (gain * times) - 1.0).abs() < GAIN_TOLERANCE;
    if available.is_empty() || available.iter().any(is_same) {
        return Some(change(gain * times));
    }
    let product = own_share.unwrap_or(1.0) * gain * times;
    let new = *available.iter().find(|new| **new >= product * (1.0 - GAIN_TOLERANCE))?;
    let share = number(product / new);
    Some(match own_share {
        Some(present) => format!("{} and set {name} to {share} in place of {}", change(new), number(present)),
        None => format!("{} and put a pot of {share} between {name} and {}", change(new), to.name),
    })
}

/// The setting of a pot. `None` for any other element.
fn pot_setting(circuit: &Circuit, element: &Element) -> Option<f64> {
    if element.kind.transfer == Transfer::Share { setting(circuit, element, "setting") } else { None }
}

/// The value of a setting of an element. `None` if the patch does not give it, or if it is no formula.
fn setting(circuit: &Circuit, element: &Element, name: &str) -> Option<f64> {
    let index = element.kind.settings.iter().position(|setting| setting.name == name)?;
    match &element.settings.get(index)?.as_ref()?.value {
        Amount::Formula(formula) => formula.evaluate(circuit.quantities()).ok(),
        _ => None,
    }
}

/// Number of elements that read the output of an element.
fn reader_count(circuit: &Circuit, element: usize) -> usize {
    let reads = |reader: &usize| circuit.cords(*reader).iter().any(|(from, _)| *from == element);
    (0..circuit.elements().len()).filter(reads).count()
}

/// A gain, a setting or a factor with at most three digits.
fn number(value: f64) -> String {
    format_significant(value, 3)
}
