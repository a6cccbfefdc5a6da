//! The quantities by which a reader knows the states: signals, or derivatives of signals, that are a constant times the
//! output of an integrator or a lag, apart from drives.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{MAX_DERIVATIVE, Program};
use patchcord_expr::split_primes;

use crate::compare::names_time;
use crate::derive::{Law, LawKind, Options, System, derive, ramps, simplified};
use crate::notation::primed;
use crate::symbolic::{Fraction, Symbol, partial_derivative};

/// A quantity that determines a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Handle {
    /// Name of the signal.
    pub name: String,
    /// Number of its derivatives.
    pub order: usize,
}

impl Handle {
    /// The name with primes.
    pub(super) fn text(&self) -> String {
        primed(&self.name, self.order)
    }
}

/// For every state, in the order of the program, the quantities that determine it. Those that the equations name come
/// first. The rates of these quantities have values too, so they have fewer derivatives than [`MAX_DERIVATIVE`].
pub(super) fn handles(circuit: &Circuit, program: &Program) -> Vec<Vec<Handle>> {
    let system = system(circuit, program);
    let stated = stated_names(circuit);
    let states = states(&system);
    let mut others = proportional(&system, &states);
    let of_state = |state: &Symbol| {
        let own = system.symbols.entry(*state);
        let direct = Handle { name: own.name.clone(), order: usize::from(own.primes) };
        let mut found = vec![direct];
        found.extend(others.remove(state).unwrap_or_default());
        let is_signal = |name: &str| circuit.patch().signals.contains_key(name);
        found.retain(|handle| is_signal(&handle.name) && handle.order < MAX_DERIVATIVE);
        found.sort_by_key(|handle| !stated.contains(handle.name.as_str()));
        found
    };
    states.iter().map(of_state).collect()
}

/// For every state, in the order of the program, whether it follows the time: it is a ramp, and the equations contain
/// the time. The time of test values is 0.
pub(super) fn timed_states(circuit: &Circuit, program: &Program) -> Vec<bool> {
    let system = system(circuit, program);
    let ramps = if names_time(circuit) { ramps(&system) } else { HashMap::new() };
    states(&system).iter().map(|state| ramps.contains_key(state)).collect()
}

/// The equations of a circuit in the names of the patch.
fn system(circuit: &Circuit, program: &Program) -> System {
    let options = Options { keeps_elements: false, has_ideal_amplifiers: true, stays_in_range: false };
    let patch = circuit.patch();
    let is_known = |name: &str| patch.signals.contains_key(name) || patch.drives.contains_key(name);
    simplified(derive(circuit, program, options), &is_known)
}

/// The states. Names change in the derivation, but the laws of states stay in the order of the program.
fn states(system: &System) -> Vec<Symbol> {
    with_kind(system, |kind| matches!(kind, LawKind::State { .. })).map(|law| law.of).collect()
}

/// The laws of a kind.
fn with_kind(system: &System, is_wanted: fn(&LawKind) -> bool) -> impl Iterator<Item = &Law> {
    system.laws.iter().filter(move |law| is_wanted(&law.kind))
}

/// The quantities that are a constant times a state, apart from drives, by this state.
fn proportional(system: &System, states: &[Symbol]) -> BTreeMap<Symbol, Vec<Handle>> {
    let states: BTreeSet<Symbol> = states.iter().copied().collect();
    let drives = with_kind(system, |kind| matches!(kind, LawKind::Drive(_))).map(|law| law.of).collect();
    let mut found: BTreeMap<Symbol, Vec<Handle>> = BTreeMap::new();
    for law in &system.laws {
        if let Some(state) = only_varying(law, &drives).filter(|symbol| states.contains(symbol)) {
            let handle = Handle { name: system.symbols.entry(law.of).name.clone(), order: 0 };
            found.entry(state).or_default().push(handle);
        }
    }
    found
}

/// The quantity s if a law defines another one as a constant times s, apart from drives.
fn only_varying(law: &Law, drives: &BTreeSet<Symbol>) -> Option<Symbol> {
    let LawKind::Definition(value) = &law.kind else { return None };
    let mut varying = BTreeSet::new();
    value.contains(&mut |symbol| {
        if !symbol.is_constant && !drives.contains(&symbol) {
            varying.insert(symbol);
        }
        varying.len() > 1
    });
    let only = varying.first().copied().filter(|_| varying.len() == 1)?;
    let factor = partial_derivative(value, only);
    let rest = value.minus(&factor.times(&Fraction::symbol(only)));
    let is_linear = !factor.is_zero() && factor.is_constant() && !rest.contains(&mut |symbol| symbol == only);
    is_linear.then_some(only)
}

/// The quantities that the equations of a patch name, themselves or with derivatives.
pub(super) fn stated_names(circuit: &Circuit) -> BTreeSet<&str> {
    let equations = circuit.equations().iter();
    equations.flat_map(|placed| placed.value.names()).map(|name| split_primes(name).0).collect()
}
