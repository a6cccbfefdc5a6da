//! The quantities by which a reader knows the states: signals, or derivatives of signals, that are a constant times the
//! output of an integrator or a lag, apart from drives.

use std::collections::HashMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
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
/// first.
pub(super) fn handles(circuit: &Circuit, program: &Program) -> Vec<Vec<Handle>> {
    let system = system(circuit, program);
    states(&system).map(|state| of_state(circuit, &system, state)).collect()
}

/// For every state, in the order of the program, whether it follows the time: it is a ramp, and the equations contain
/// the time. The time of test values is 0.
pub(super) fn timed_states(circuit: &Circuit, program: &Program) -> Vec<bool> {
    let system = system(circuit, program);
    let ramps = if names_time(circuit) { ramps(&system) } else { HashMap::new() };
    states(&system).map(|state| ramps.contains_key(&state)).collect()
}

/// The equations of a circuit in the names of the patch.
fn system(circuit: &Circuit, program: &Program) -> System {
    let options = Options { keeps_elements: false, has_ideal_amplifiers: true, stays_in_range: false };
    let patch = circuit.patch();
    let is_known = |name: &str| patch.signals.contains_key(name) || patch.drives.contains_key(name);
    simplified(derive(circuit, program, options), &is_known)
}

/// The states. Names change in the derivation, but the laws of states stay in the order of the program.
fn states(system: &System) -> impl Iterator<Item = Symbol> {
    system.laws.iter().filter(|law| matches!(law.kind, LawKind::State { .. })).map(|law| law.of)
}

/// The quantities that determine a state.
fn of_state(circuit: &Circuit, system: &System, state: Symbol) -> Vec<Handle> {
    let own = system.symbols.entry(state);
    let direct = Handle { name: own.name.clone(), order: usize::from(own.primes) };
    let others = system.laws.iter().filter(|law| is_proportional(system, law, state));
    let others = others.map(|law| Handle { name: system.symbols.entry(law.of).name.clone(), order: 0 });
    let mut found: Vec<Handle> = std::iter::once(direct).chain(others).collect();
    found.retain(|handle| circuit.patch().signals.contains_key(&handle.name));
    found.sort_by_key(|handle| !is_stated(circuit, &handle.name));
    found
}

/// Whether a law defines a quantity as a constant times a state, apart from drives.
fn is_proportional(system: &System, law: &Law, state: Symbol) -> bool {
    let LawKind::Definition(value) = &law.kind else { return false };
    let factor = partial_derivative(value, state);
    let rest = value.minus(&factor.times(&Fraction::symbol(state)));
    let is_fixed =
        |symbol: Symbol| symbol.is_constant || matches!(system.law(symbol), Some(LawKind::Drive(_)));
    !factor.is_zero() && factor.is_constant() && !rest.contains(&mut |symbol| !is_fixed(symbol))
}

/// Whether an equation of the patch names a quantity, or a derivative of it.
pub(super) fn is_stated(circuit: &Circuit, name: &str) -> bool {
    let mut equations = circuit.equations().iter();
    equations.any(|placed| placed.value.names().iter().any(|other| split_primes(other).0 == name))
}
