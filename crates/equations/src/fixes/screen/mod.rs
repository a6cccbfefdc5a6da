//! A numerical test of equations at some points, before the exact comparison.
//!
//! The wiring is evaluated without the limits of amplifiers. Derivatives are central differences along the motion, so the
//! test has a tolerance. It passes every change after which the wiring solves an equation, and refuses nearly all others,
//! at a small part of the cost of an exact comparison.

mod expression;
mod instants;
mod trial;

use std::collections::{HashMap, HashSet};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{ElementLaws, Op, SignalInfo};
use patchcord_core::patch::Amount;
use patchcord_expr::{Equation, Expression, split_primes};

use super::netlist::{Conditions, Netlist, Order, Rewiring};
use crate::compare::{names_time, other_value};
use crate::derive::ranged;
use instants::{Centre, Setup};
pub(super) use trial::Trial;

/// Sizes of the voltages at the points in volts. Characteristics have their corners at different voltages.
const SIZES: [f64; 6] = [20.0, 60.0, 6.0, 2.0, 35.0, 11.0];

/// The parameters for which an equation must hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Validity {
    /// Their present values.
    Present,
    /// All values: they are tested at others than the present ones.
    General,
}

/// The equations of a circuit, to be tested for rewirings of it.
pub(super) struct Screen<'a> {
    netlist: Netlist,
    /// The conditions of the tests. An equation passes if it holds under one of them at all points.
    cases: Vec<Case>,
    /// The points.
    centres: Vec<Centre>,
    /// The signals and drives, by name.
    signals: HashMap<String, Output>,
    /// The equations that define auxiliary quantities.
    auxiliaries: HashMap<&'a str, &'a Equation>,
    /// The indices of the parameters.
    parameters: HashMap<&'a str, usize>,
    /// The names that an equation contains if it writes out the law of a drive. Empty if there are no such laws.
    drive_names: HashSet<&'a str>,
    /// Whether the equations name the time, so that ramps follow it.
    names_time: bool,
}

/// The output that a signal reads.
struct Output {
    element: usize,
    /// The index of its state, if it is one.
    state: Option<usize>,
    /// The coefficient with the value per volt. `None` if the signal is in volts.
    per_volt: Option<u32>,
}

/// The conditions of a test.
struct Case {
    conditions: Conditions,
    /// Whether drives are free. Otherwise they follow from time.
    has_free_drives: bool,
    /// The start of a run.
    start: Centre,
}

impl<'a> Screen<'a> {
    /// A screen for the equations of a circuit.
    pub(super) fn new(circuit: &'a Circuit, validity: Validity) -> Self {
        let laws = ElementLaws::new(circuit);
        let netlist = Netlist::new(circuit, &laws);
        let signals = signals(circuit, &laws);
        let cases = cases(&laws, validity);
        let rewiring = Rewiring::default();
        let order = Order::new(&netlist, &rewiring);
        let setup = Setup {
            netlist: &netlist,
            rewiring: &rewiring,
            order: &order,
            conditions: &cases[0].conditions,
            has_free_drives: true,
        };
        let centres = SIZES.iter().enumerate().map(|(index, size)| Centre::new(setup, index, *size));
        let centres = centres.collect();
        let parameters = circuit.parameters().enumerate().map(|(index, (name, ..))| (name, index)).collect();
        let auxiliaries = auxiliaries(circuit);
        let drive_names = drive_names(circuit, &cases);
        let names_time = names_time(circuit);
        Screen { netlist, cases, centres, signals, auxiliaries, parameters, drive_names, names_time }
    }

    /// Whether an equation can contain the law of a drive in place of its name.
    fn can_write_out_drives(&self, equation: &Equation) -> bool {
        equation.names().into_iter().any(|name| self.drive_names.contains(split_primes(name).0))
    }

    /// The tests of one rewiring.
    pub(super) fn trial<'s>(&'s self, rewiring: &'s Rewiring) -> Trial<'s, 'a> {
        Trial::new(self, rewiring)
    }
}

/// The conditions of the tests: the wiring as it is, and while its networks are within their range. Drives are free at
/// first, so that one that is 0 at present is visible. An equation may also write out their laws of time. It must then
/// hold for other parameters than the present ones.
fn cases(laws: &ElementLaws, validity: Validity) -> Vec<Case> {
    let ranged = ranged(laws.operations());
    let in_range = (!ranged.is_empty()).then(|| {
        laws.clone().with_operations(|register, op| match op {
            Op::Maximum(input, _) if ranged.contains(&register) => Op::Maximum(input, input),
            op => op,
        })
    });
    let present: Vec<f64> = laws.parameters().iter().map(|parameter| parameter.value).collect();
    let others: Vec<f64> =
        present.iter().enumerate().map(|(index, value)| other_value(*value, index)).collect();
    let first = if validity == Validity::General { &others } else { &present };
    let mut cases = Vec::new();
    for (parameters, has_free_drives) in [(first, true), (&others, false)] {
        for laws in [Some(laws), in_range.as_ref()].into_iter().flatten() {
            let conditions = Conditions::new(laws.clone(), parameters.clone());
            let start = Centre::at_start(&conditions);
            cases.push(Case { conditions, has_free_drives, start });
        }
    }
    cases
}

/// The names in the laws of the drives: parameters and the time. Empty if a drive is noise or consists of pulses: its
/// values are not known at other times than 0.
fn drive_names<'a>(circuit: &'a Circuit, cases: &[Case]) -> HashSet<&'a str> {
    let has_levels = cases.iter().any(|case| case.start.has_levels());
    let drives = &circuit.patch().drives;
    if has_levels || drives.is_empty() {
        return HashSet::new();
    }
    let amounts = drives.values().flat_map(|drive| drive.settings.iter().flatten());
    let names = amounts.flat_map(|placed| match &placed.value {
        Amount::Formula(formula) => formula.names(),
        _ => Vec::new(),
    });
    names.chain(["t"]).collect()
}

/// The outputs that signals read, by the names of the signals and drives. Equations do not name elements.
fn signals(circuit: &Circuit, laws: &ElementLaws) -> HashMap<String, Output> {
    let drives = &circuit.patch().drives;
    let output = |signal: &SignalInfo| {
        let element = laws.elements().iter().position(|law| law.output == signal.register)?;
        let state = laws.states().iter().position(|state| state.element == element);
        Some((signal.name.clone(), Output { element, state, per_volt: signal.per_volt }))
    };
    let named = laws.signals().iter().filter(|signal| signal.is_named || drives.contains_key(&signal.name));
    named.filter_map(output).collect()
}

/// The equations that define auxiliary quantities, by their names.
fn auxiliaries(circuit: &Circuit) -> HashMap<&str, &Equation> {
    let names: Vec<&str> = circuit.auxiliary_quantities().collect();
    let definition = |equation: &Equation| match &equation.left().expression {
        Expression::Name(name) => names.iter().find(|known| *known == name).copied(),
        _ => None,
    };
    let definitions = circuit.equations().iter().map(|placed| &placed.value);
    definitions.filter_map(|equation| Some((definition(equation)?, equation))).collect()
}

#[cfg(test)]
mod tests;
