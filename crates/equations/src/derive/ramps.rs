//! Ramps: states that are linear functions of time, such as the output of an integrator with a constant input.

use std::collections::HashMap;

use super::system::{Law, LawKind, System};
use crate::symbolic::{Fraction, Symbol, SymbolKind};

/// The ramps of a simplified system, each as a function of time: initial value + rate x t.
///
/// The rate and the initial value are formulas of parameters. A state with limits of its own is no ramp, nor is one that
/// a mode stops or sets. Like every equation, the function holds while no amplifier is overloaded. A hold stops problem
/// time too.
pub(crate) fn ramps(system: &System) -> HashMap<Symbol, Fraction> {
    let mut entries = system.symbols.entries();
    let Some((time, _)) = entries.find(|(_, entry)| entry.kind == SymbolKind::Time) else {
        return HashMap::new();
    };
    let constants = constants(system);
    let ramp = |law: &Law| match &law.kind {
        LawKind::State { rate, initial, limits: [None, None] } if !is_set(system, law.of) => {
            let [rate, initial] = [constant(rate, &constants)?, constant(initial, &constants)?];
            let value = initial.plus(&rate.times(&Fraction::symbol(time)));
            (!rate.is_zero()).then_some((law.of, value))
        }
        _ => None,
    };
    system.laws.iter().filter_map(ramp).collect()
}

/// A simplified system without the ramps that have no name: where other quantities depend on them, their functions of
/// time are written. `is_known` is whether the patch names a quantity of this name.
pub(crate) fn without_unnamed_ramps(mut system: System, is_known: &dyn Fn(&str) -> bool) -> System {
    for (ramp, value) in ramps(&system) {
        let is_unnamed = !is_known(&system.symbols.entry(ramp).name);
        if is_unnamed && system.replace(ramp, &value) {
            system.laws.retain(|law| law.of != ramp);
        }
    }
    system
}

/// Whether a change of a mode sets a state.
fn is_set(system: &System, state: Symbol) -> bool {
    let mut changes = system.modes.iter().flat_map(|mode| &mode.transitions);
    changes.any(|change| change.reset.as_ref().is_some_and(|(of, _)| *of == state))
}

/// The quantities that are formulas of parameters, with these formulas.
fn constants(system: &System) -> HashMap<Symbol, Fraction> {
    let mut found = HashMap::new();
    for law in &system.laws {
        if let LawKind::Definition(value) = &law.kind
            && let Some(value) = constant(value, &found)
        {
            found.insert(law.of, value);
        }
    }
    found
}

/// An expression as a formula of parameters. `None` if it contains a quantity that is not among the constants.
fn constant(value: &Fraction, constants: &HashMap<Symbol, Fraction>) -> Option<Fraction> {
    if value.contains(&mut |symbol| !symbol.is_constant && !constants.contains_key(&symbol)) {
        return None;
    }
    Some(value.with_symbols(constants))
}
