//! The outputs and signals of a patch, with the quantities for which their voltages stand.

use std::collections::HashMap;

use patchcord_core::circuit::Quantities;
use patchcord_core::document::Placed;
use patchcord_core::patch::Patch;
use patchcord_expr::Scope as _;

use crate::event::{OutputView, SignalView};
use crate::wiring;

/// A quantity: its unit and the value of one volt.
struct Quantity {
    /// Text of the unit.
    unit: String,
    /// Value of one volt in the unit.
    per_volt: f64,
}

/// All outputs, in the order of the voltages of a frame.
pub(super) fn outputs(patch: &Patch, quantities: &Quantities) -> Vec<OutputView> {
    // If several signals are read at an output, the first one counts.
    let mut signals = HashMap::new();
    for (name, signal) in &patch.signals {
        signals.entry(signal.element.value.as_str()).or_insert((name, signal));
    }
    let view = |output: wiring::Output| {
        let quantity = match signals.get(output.element.as_str()) {
            Some((name, signal)) => {
                let found = quantity(patch, quantities, signal.scale.as_ref(), signal.factor);
                found.map(|found| ((*name).clone(), found))
            }
            None => patch.drives.get(&output.element).and_then(|drive| {
                let found = quantity(patch, quantities, drive.scale.as_ref(), 1.0)?;
                Some((output.element.clone(), found))
            }),
        };
        let (signal, quantity) = match quantity {
            Some((name, found)) => (Some(name), found),
            None => (None, volts()),
        };
        OutputView { name: output.name, signal, unit: quantity.unit, per_volt: quantity.per_volt }
    };
    wiring::outputs(patch).into_iter().map(view).collect()
}

/// The signals, each at an output by its name at the panel. A signal whose scale has no value is shown in volts.
pub(super) fn signals(patch: &Patch, quantities: &Quantities) -> Vec<SignalView> {
    let outputs = wiring::outputs(patch);
    let at = |element: &str| {
        let output = outputs.iter().find(|output| output.element == element);
        output.map_or(element, |output| &output.name).to_owned()
    };
    let views = patch.signals.iter().map(|(name, signal)| {
        let found = quantity(patch, quantities, signal.scale.as_ref(), signal.factor);
        let Quantity { unit, per_volt } = found.unwrap_or_else(volts);
        SignalView { name: name.clone(), at: at(&signal.element.value), unit, per_volt }
    });
    views.collect()
}

/// The quantity of an output that has no signal.
fn volts() -> Quantity {
    Quantity { unit: "V".to_owned(), per_volt: 1.0 }
}

/// The quantity of a scale with a factor. `None` if the scale does not exist or has no value.
fn quantity(
    patch: &Patch,
    quantities: &Quantities,
    scale: Option<&Placed<String>>,
    factor: f64,
) -> Option<Quantity> {
    let Some(name) = scale else { return Some(Quantity { per_volt: factor, ..volts() }) };
    let scale = patch.scales.get(&name.value)?;
    let per_volt = scale.unit.out_of_si(quantities.value(&name.value)?);
    Some(Quantity { unit: scale.unit.text().to_owned(), per_volt: per_volt * factor })
}
