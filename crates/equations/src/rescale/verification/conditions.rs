//! Compares the conditions for switches: the quantities whose sign decides whether a mode changes, and the voltages to
//! which a change sets an integrator.
//!
//! In both patches, such a quantity must be the same except for one positive factor at all states. A threshold that is
//! not rescaled breaks this. The smaller or larger of two quantities can have two factors, so both are compared alone.

use patchcord_core::ir::{Mode, Op, Program, Register, Transition};

use super::states::Matches;
use super::{CANCELLED, Pair, name};

/// Largest difference of a quantity from its factor times the old one, as a share of its largest value.
const ROUNDING: f64 = 1e-8;

/// The quantities in the conditions for switches, with their values at states.
pub(super) struct Conditions {
    quantities: Vec<Quantity>,
}

/// A quantity of both patches.
struct Quantity {
    /// The index of the element that switches.
    element: usize,
    /// Its registers in the old and the new program.
    registers: [Register; 2],
    /// The factor between its values. `None` if it can be any positive number.
    factor: Option<f64>,
    /// Its values in the old and the new program, at each state.
    values: Vec<[f64; 2]>,
}

impl Conditions {
    /// The conditions of all modes, except for those of drives, which depend on time only, and for the limits of
    /// integrators. The latter are compared as voltages.
    ///
    /// # Errors
    /// The message that names an element that switches by other conditions.
    pub(super) fn new(pair: &Pair<'_>, matches: &Matches) -> Result<Self, String> {
        let programs = [&pair.old.program, &pair.new.program];
        let mut quantities = Vec::new();
        for (mode, position) in programs[0].modes().iter().zip(&matches.modes) {
            if mode.is_drive || mode.names.mode == "limit" {
                continue;
            }
            let found = of_mode(pair, [mode, &programs[1].modes()[*position]]);
            let other = || format!("{} switches by other conditions", name(pair, mode.element));
            quantities.extend(found.ok_or_else(other)?);
        }
        Ok(Conditions { quantities })
    }

    /// Adds the values at a state. `voltages` has those of all registers in both programs.
    pub(super) fn add(&mut self, voltages: [&[f64]; 2]) {
        for quantity in &mut self.quantities {
            let [old, new] = quantity.registers;
            quantity.values.push([voltages[0][old.index()], voltages[1][new.index()]]);
        }
    }

    /// Compares the values of all states.
    ///
    /// # Errors
    /// The message that names an element that switches by another condition.
    pub(super) fn compare(&self, pair: &Pair<'_>) -> Result<(), String> {
        let is_wrong = |quantity: &&Quantity| !is_proportional(&quantity.values, quantity.factor);
        self.quantities.iter().find(is_wrong).map_or(Ok(()), |quantity| {
            let output = name(pair, quantity.element);
            Err(format!("{output} would switch at another voltage or to another one"))
        })
    }
}

/// The quantities of a mode in both programs. `None` if they are not the same.
fn of_mode(pair: &Pair<'_>, [old, new]: [&Mode; 2]) -> Option<Vec<Quantity>> {
    if old.transitions.len() != new.transitions.len() {
        return None;
    }
    let pairs = old.transitions.iter().zip(&new.transitions);
    let found = pairs.map(|(one, other)| of_transition(pair, old.element, [one, other]));
    Some(found.collect::<Option<Vec<Vec<Quantity>>>>()?.into_iter().flatten().collect())
}

/// The quantities of a transition in both programs. `None` if they are not the same.
fn of_transition(pair: &Pair<'_>, element: usize, transitions: [&Transition; 2]) -> Option<Vec<Quantity>> {
    let [old, new] = transitions;
    let sides = [(&pair.old.program, old), (&pair.new.program, new)];
    let [before, after] = sides.map(|(program, transition)| operands(program, transition.guard.register));
    if before.len() != after.len() || [old.from, old.to] != [new.from, new.to] {
        return None;
    }
    let quantity = |(old, new): (Register, Register)| Quantity {
        element,
        registers: [old, new],
        factor: None,
        values: Vec::new(),
    };
    let mut found: Vec<Quantity> = before.into_iter().zip(after).map(quantity).collect();
    match (&old.reset, &new.reset) {
        (Some(old), Some(new)) => {
            let factor = pair.factors[pair.old.program.state_laws()[old.state as usize].element];
            found.push(Quantity { factor: Some(factor), ..quantity((old.to, new.to)) });
        }
        (None, None) => {}
        _ => return None,
    }
    Some(found)
}

/// The registers of which a register is the smallest or the largest; otherwise the register itself.
fn operands(program: &Program, register: Register) -> Vec<Register> {
    match program.body()[register.index()] {
        Op::Minimum(one, other) | Op::Maximum(one, other) => {
            [operands(program, one), operands(program, other)].concat()
        }
        _ => vec![register],
    }
}

/// Whether the second of each pair of values is a factor times the first one. If no factor is given, it is any positive
/// one.
fn is_proportional(values: &[[f64; 2]], factor: Option<f64>) -> bool {
    let finite: Vec<[f64; 2]> =
        values.iter().copied().filter(|pair| pair.iter().any(|value| value.is_finite())).collect();
    let largest = finite.iter().copied().max_by(|one, other| one[0].abs().total_cmp(&other[0].abs()));
    let Some([old, new]) = largest else { return true };
    let factor = match factor {
        Some(factor) => factor,
        // A quantity that is always 0 has no factor.
        None if old.abs() <= CANCELLED => 1.0,
        None => new / old,
    };
    let permitted = ROUNDING * (factor * old).abs() + CANCELLED * factor.max(1.0);
    let is_equal = |[old, new]: &[f64; 2]| (new - factor * old).abs() <= permitted;
    factor > 0.0 && finite.iter().all(is_equal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_threshold_that_stays_is_not_proportional() {
        // The voltage is multiplied by 4. Its difference from 5 V is not, if the threshold stays.
        let voltages = [-40.0, -2.0, 0.3, 8.0];
        let differences = |threshold: f64| voltages.map(|volts| [volts - 5.0, 4.0 * volts - threshold]);
        assert!(is_proportional(&differences(20.0), None));
        assert!(!is_proportional(&differences(5.0), None));
        assert!(!is_proportional(&differences(20.001), None));
        assert!(is_proportional(&differences(20.0), Some(4.0)));
        assert!(!is_proportional(&differences(20.0), Some(2.0)));
    }

    #[test]
    fn a_reversed_condition_is_not_proportional() {
        assert!(!is_proportional(&[[1.0, -1.0], [2.0, -2.0]], None));
        assert!(!is_proportional(&[[1.0, f64::NAN], [2.0, 2.0]], None));
        assert!(!is_proportional(&[[0.0, 3.0], [0.0, 0.0]], None));
        assert!(is_proportional(&[[f64::NAN, f64::NAN], [2.0, 2.0]], None));
        assert!(is_proportional(&[], None));
    }
}
