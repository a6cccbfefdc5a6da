//! Integrators and lags that begin at a limit.

use super::is_at_limit;
use crate::instruments::{Rescaling, element_index, scale_change, scaled_signal, smaller_output};
use crate::linear::codes;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Diagnostic, format_number};
use patchcord_core::ir::{StateHold, StateSpace, StateTerm};
use patchcord_expr::format_significant;

/// Rate in volts per second up to which a state is at rest. Rounding is smaller.
const REST_RATE: f64 = 1e-6;
/// Factor of the proposed change of a scale. It leaves a reserve of half the range.
const FACTOR: f64 = 2.0;

/// The warnings about all states of the model that begin at a limit and may leave it outward.
pub(super) fn warnings(circuit: &Circuit, model: &StateSpace) -> Vec<Diagnostic> {
    let matrix = model.state_matrix();
    let states = model.states.iter().zip(&matrix).enumerate();
    let risky = states.filter(|(index, (state, row))| is_risky(state, row[*index]));
    risky.filter_map(|(_, (state, _))| warning(circuit, state)).collect()
}

/// Whether a state begins at a limit, and moves outward or has no feedback that draws it back. `own_slope` is the
/// derivative of its rate with respect to itself, in 1/s.
fn is_risky(state: &StateTerm, own_slope: f64) -> bool {
    is_at_limit(state.volts) && (outward_rate(state) > REST_RATE || is_held(state) || own_slope >= 0.0)
}

/// The rate towards larger voltages without sign, in volts per second.
fn outward_rate(state: &StateTerm) -> f64 {
    state.rate * state.volts.signum()
}

/// Whether the limit holds the state, because its rate points outward.
fn is_held(state: &StateTerm) -> bool {
    state.hold == Some(StateHold::Limit)
}

/// The warning about a state. `None` if the patch has no such element.
fn warning(circuit: &Circuit, state: &StateTerm) -> Option<Diagnostic> {
    let [verb, noun] = if state.volts > 0.0 { ["rises", "rise"] } else { ["falls", "fall"] };
    let begins = format!("{} begins at {} V, its limit", state.name, format_number(state.volts));
    let rate = outward_rate(state);
    let message = if rate > REST_RATE {
        let rate = format_significant(rate, 3);
        format!("{begins}, and {verb} by {rate} V/s at the start: it is overloaded at once")
    } else if is_held(state) {
        format!("{begins}, and its inputs drive it beyond: it is overloaded at once")
    } else {
        format!("{begins}: any {noun} overloads it")
    };
    let entry = circuit.patch().elements.get(&state.name)?;
    let hint = element_index(circuit, &state.name).map(|element| hint(circuit, element));
    Some(Diagnostic::at(codes::INITIAL_AT_LIMIT, entry.span, message).maybe_hint(hint))
}

/// The change that halves the initial voltage.
fn hint(circuit: &Circuit, element: usize) -> String {
    match scaled_signal(circuit, element) {
        Some(signal) => {
            format!(
                "{}, and adapt the gains",
                scale_change(circuit, element, signal, Rescaling::Enlarge(FACTOR))
            )
        }
        None => smaller_output(circuit, element, FACTOR),
    }
}
