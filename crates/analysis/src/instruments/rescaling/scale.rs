//! The scale that decides how large an output is, and its change.

use patchcord_core::circuit::{Circuit, SignalPoint};
use patchcord_core::document::format_number;
use patchcord_core::elements::Transfer;

/// A change of the quantity that one volt represents, by a factor above 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Rescaling {
    /// One volt represents more, so that the voltages get smaller.
    Enlarge(f64),
    /// One volt represents less, so that the voltages get larger.
    Reduce(f64),
}

impl Rescaling {
    /// The value of one volt after the change, in the unit of the value before.
    fn apply(self, per_volt: f64) -> f64 {
        match self {
            Rescaling::Enlarge(factor) => per_volt * factor,
            Rescaling::Reduce(factor) => per_volt / factor,
        }
    }

    /// The formula of one volt after the change.
    fn formula(self, per_volt: &str) -> String {
        match self {
            Rescaling::Enlarge(factor) => format!("{factor} * ({per_volt})"),
            Rescaling::Reduce(factor) => format!("({per_volt}) / {factor}"),
        }
    }

    /// The change in words: "4 times as much" or "1/20 as much".
    fn words(self) -> String {
        match self {
            Rescaling::Enlarge(factor) => format!("{factor} times as much"),
            Rescaling::Reduce(factor) => format!("1/{factor} as much"),
        }
    }
}

/// The first signal with a scale at an element, and its scale. Without one, it is a signal at an amplifier that inverts
/// the element and nothing else: its voltage is as large.
pub(crate) fn scaled_signal(circuit: &Circuit, element: usize) -> Option<(&SignalPoint, usize)> {
    first_scaled(circuit, |at| at == element)
        .or_else(|| first_scaled(circuit, |at| inverted_by(circuit, at) == Some(element)))
}

/// The first signal with a scale whose element satisfies a condition, and its scale.
fn first_scaled(circuit: &Circuit, is_at: impl Fn(usize) -> bool) -> Option<(&SignalPoint, usize)> {
    circuit.signals().iter().find_map(|point| {
        let scale = point.scale.filter(|_| is_at(point.element))?;
        Some((point, scale))
    })
}

/// The element whose output an amplifier inverts with gain 1, if nothing else drives it.
pub(crate) fn inverted_by(circuit: &Circuit, element: usize) -> Option<usize> {
    let is_inverting = circuit.element(element).kind.transfer == Transfer::Inverting;
    match circuit.cords(element).as_slice() {
        [(from, cord)] if is_inverting && cord.gain == 1.0 => Some(*from),
        _ => None,
    }
}

/// The change of the scale of a signal, such as: let 1 V of v represent 4 times as much ("per_volt": 8 in place of 2 in the
/// scale "velocity"). `element` is the one whose voltage changes.
pub(crate) fn scale_change(
    circuit: &Circuit,
    element: usize,
    (point, scale): (&SignalPoint, usize),
    change: Rescaling,
) -> String {
    let place = place(circuit, element, point);
    format!(
        "let 1 V of {}{place} represent {} ({})",
        point.name,
        change.words(),
        new_value(circuit, scale, change)
    )
}

/// Where a signal is, if its name is not that of the element whose voltage changes.
fn place(circuit: &Circuit, element: usize, point: &SignalPoint) -> String {
    let [name, at] = [element, point.element].map(|index| circuit.element(index).name.as_str());
    match point.name.as_str() {
        signal if signal == name => String::new(),
        _ if at == name => format!(" at {at}"),
        _ => format!(" at {at}, which inverts {name},"),
    }
}

/// The key of a scale with its new value, and the present value if it is a number.
fn new_value(circuit: &Circuit, scale: usize, change: Rescaling) -> String {
    let (name, formula) = circuit.derived(scale);
    match circuit.per_volt(scale).filter(|_| circuit.is_literal(formula)) {
        Some(present) => {
            let [new, present] = [change.apply(present), present].map(format_number);
            format!("\"per_volt\": {new} in place of {present} in the scale \"{name}\"")
        }
        None => format!("\"per_volt\": \"{}\" in the scale \"{name}\"", change.formula(formula.text())),
    }
}
