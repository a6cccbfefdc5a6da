//! Checks that a rescaled patch computes the same as the old one.
//!
//! 1. Every initial voltage must be the old one times the factor of its output.
//! 2. The laws are compared at random states (`states`), with the conditions for switches (`conditions`).
//! 3. An equation that the old wiring solves must be solved by the new one.
//! 4. The runs must agree (`runs`). If the old run overloads, it is wrong and cannot be compared.
//!
//! A check that cannot decide is a refusal, unless another check covers the same.

mod conditions;
mod runs;
mod states;

use patchcord_core::circuit::Circuit;

use super::decision::Decided;
use super::measured::Measured;
use crate::compare::{EquationComparer, Standing};
use runs::compare_runs;
use states::{Matches, compare_states};

/// Largest difference of a voltage, as a share of it.
const TOLERANCE: f64 = 1e-9;
/// Largest difference of a voltage that is a small difference of large ones, in volts. A derivative may differ by this
/// times the gains of its integrator.
const CANCELLED: f64 = 1e-8;

/// How a rescaled patch was compared with the old one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Verified {
    /// The number of random states at which the laws were compared.
    pub states: usize,
    /// The problem time up to which the runs agree. `None` if the old run overloads.
    pub agrees_until: Option<f64>,
}

/// Two patches that should compute the same.
struct Pair<'p> {
    old: &'p Measured,
    new: &'p Measured,
    /// The factor of each output of the old patch, by its index.
    factors: Vec<f64>,
}

/// Compares a rescaled patch with the old one.
///
/// # Errors
/// The message that says what differs, or what could not be compared.
pub(super) fn verify(old: &Measured, new: &Measured, decided: &Decided<'_>) -> Result<Verified, String> {
    let wiring = decided.wiring;
    let factor = |element: usize| {
        let factor = decided.factor(element, 0);
        factor.ok_or_else(|| format!("the factor of {} is not known", wiring.name(element)))
    };
    let factors = (0..wiring.len()).map(factor).collect::<Result<Vec<f64>, String>>()?;
    let pair = Pair { old, new, factors };
    let matches = Matches::new(&pair)?;
    compare_initial_voltages(&pair, &matches)?;
    let states = compare_states(&pair, &matches)?;
    compare_equations(&pair)?;
    if !old.overloads.is_empty() {
        let verified = Verified { states, agrees_until: None };
        let message = "it cannot be compared, neither at a random state nor in a run, which overloads";
        return (states > 0).then_some(verified).ok_or_else(|| message.to_owned());
    }
    if let Some(output) = new.overloads.first() {
        return Err(format!("{output} overloads"));
    }
    let agreement = compare_runs(&pair)?;
    if states == 0 && !agreement.is_whole {
        let message = "it cannot be compared at a random state, and the runs do not agree to their end";
        return Err(message.to_owned());
    }
    Ok(Verified { states, agrees_until: Some(agreement.until) })
}

/// Compares the initial voltages of integrators, lags, delay lines and stored samples.
///
/// # Errors
/// The message that names an element that begins at another voltage.
fn compare_initial_voltages(pair: &Pair<'_>, matches: &Matches) -> Result<(), String> {
    let program = &pair.old.program;
    let (old, new) = (program.initial_point(), pair.new.program.initial_point());
    let states = program.state_laws().iter().map(|law| law.element);
    let delays = program.delays().iter().map(|delay| delay.element);
    let sampled = program.sampled_values().iter().map(|sampled| sampled.element);
    let voltages = |one: &[f64], other: &[f64], positions: &[usize]| -> Vec<[f64; 2]> {
        one.iter().zip(positions).map(|(old, position)| [*old, other[*position]]).collect()
    };
    let pairs = states
        .zip(voltages(&old.states, &new.states, &matches.states))
        .chain(delays.zip(voltages(&old.delayed, &new.delayed, &matches.delays)))
        .chain(sampled.zip(voltages(&old.sampled, &new.sampled, &matches.sampled)));
    for (element, [before, after]) in pairs {
        let factor = pair.factors[element];
        let what = || format!("{} begins at", name(pair, element));
        require_equal(what, "V", [factor * before, after], CANCELLED * factor.max(1.0))?;
    }
    Ok(())
}

/// Compares how the stated equations agree with the wiring.
///
/// # Errors
/// The message with an equation that the old wiring solves and the new one does not.
fn compare_equations(pair: &Pair<'_>) -> Result<(), String> {
    let circuit: &Circuit = &pair.old.circuit;
    if circuit.equations().is_empty() {
        return Ok(());
    }
    let mut old = EquationComparer::new(circuit, &pair.old.program);
    let mut new = EquationComparer::new(&pair.new.circuit, &pair.new.program);
    for (index, equation) in circuit.equations().iter().enumerate() {
        if is_lost(old.standing(index), new.standing(index)) {
            return Err(format!("its wiring does not solve {}", equation.value.text()));
        }
    }
    Ok(())
}

/// Whether an equation that the old wiring solves is not known to be solved by the new one.
fn is_lost(old: Standing, new: Standing) -> bool {
    match old {
        Standing::Solved => new != Standing::Solved,
        Standing::SolvedAt => matches!(new, Standing::Different | Standing::Undecided),
        Standing::Undecided => new == Standing::Different,
        Standing::Different => false,
    }
}

/// The name of an output of the old patch.
fn name<'p>(pair: &Pair<'p>, element: usize) -> &'p str {
    &pair.old.program.element_outputs()[element].name
}

/// Checks that a value is the wanted one. `what` has the name and the verb, such as "A1 is".
///
/// # Errors
/// The message if it differs by more than rounding.
fn require_equal(
    what: impl FnOnce() -> String,
    unit: &str,
    [wanted, found]: [f64; 2],
    cancelled: f64,
) -> Result<(), String> {
    if is_different(wanted, found, cancelled) {
        return Err(format!("{} {found} {unit} in place of {wanted} {unit}", what()));
    }
    Ok(())
}

/// Whether two values differ by more than rounding. Two that are no numbers are equal, and so are two equal infinities.
fn is_different(wanted: f64, found: f64, cancelled: f64) -> bool {
    if !(wanted.is_finite() && found.is_finite()) {
        return wanted != found && !(wanted.is_nan() && found.is_nan());
    }
    (wanted - found).abs() > TOLERANCE * wanted.abs().max(found.abs()) + cancelled
}

#[cfg(test)]
mod tests;
