//! The equations that the wiring solves, as the page shows them.

use std::collections::BTreeSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_equations::{Comparison, Condition, Detail, EquationListing, Notation, WrittenEquation};

use crate::event::{EquationView, EquationsView};

/// The equations of a circuit, in its signals, drives and states.
pub fn equations(circuit: &Circuit, program: &Program) -> EquationsView {
    let listing = EquationListing::new(circuit, program, Detail::Signals);
    let patch = circuit.patch();
    let latex = listing.latex();
    let more = EquationListing { equations: Vec::new(), ..listing.clone() };
    let views = listing.equations.iter().map(|equation| equation_view(equation, patch));
    EquationsView {
        equations: views.collect(),
        stated: patch.equations.iter().map(|equation| equation.value.text().to_owned()).collect(),
        more: more.text(),
        latex,
        message: None,
    }
}

/// An equation with the names that a user can select.
fn equation_view(equation: &WrittenEquation, patch: &Patch) -> EquationView {
    // A listing of this equation alone rounds its numbers.
    let alone = EquationListing {
        equations: vec![equation.clone()],
        initial: Vec::new(),
        drives: Vec::new(),
        modes: Vec::new(),
        tables: Vec::new(),
        remarks: Vec::new(),
    };
    let mut names = BTreeSet::new();
    for side in [&equation.left, &equation.right] {
        collect_names(side, &mut names);
    }
    let is_shown = |name: &&str| {
        patch.signals.contains_key(*name)
            || patch.drives.contains_key(*name)
            || patch.elements.contains_key(*name)
            || patch.parameters.contains_key(*name)
    };
    EquationView {
        text: alone.text().trim_end().to_owned(),
        names: names.into_iter().filter(is_shown).map(str::to_owned).collect(),
    }
}

/// Adds the names of the quantities in an expression.
fn collect_names<'n>(notation: &'n Notation, names: &mut BTreeSet<&'n str>) {
    match notation {
        Notation::Number { .. } => {}
        Notation::Name { name, .. } => drop(names.insert(name)),
        Notation::Negative(operand) => collect_names(operand, names),
        Notation::Sum(operands) | Notation::Product(operands) | Notation::Call(_, operands) => {
            operands.iter().for_each(|operand| collect_names(operand, names));
        }
        Notation::Quotient(one, other) | Notation::Power(one, other) => {
            collect_names(one, names);
            collect_names(other, names);
        }
        Notation::Cases(cases) => {
            for (value, condition) in cases {
                collect_names(value, names);
                condition.iter().for_each(|condition| collect_condition_names(condition, names));
            }
        }
    }
}

/// Adds the names of the quantities in a condition.
fn collect_condition_names<'n>(Condition(comparisons): &'n Condition, names: &mut BTreeSet<&'n str>) {
    for comparison in comparisons {
        if let Comparison::Compare { left, right, .. } = comparison {
            collect_names(left, names);
            collect_names(right, names);
        }
    }
}
