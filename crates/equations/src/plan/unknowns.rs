//! The quantities that the equations determine: algebraic quantities and highest derivatives.

use std::collections::HashMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Diagnostic, Placed, formula_diagnostic};
use patchcord_core::patch::Problem;
use patchcord_expr::{Equation, FormulaError, split_primes};

use crate::notation::primed;

/// A quantity that an equation determines.
pub(super) struct Unknown {
    /// Its name without primes.
    pub base: String,
    /// The number of primes of its highest derivative, which is the unknown. 0 for an algebraic quantity.
    pub order: usize,
    /// Whether the problem declares the unknown. Otherwise only the equations name it.
    pub is_declared: bool,
}

impl Unknown {
    /// The name of the unknown, with primes.
    pub(super) fn name(&self) -> String {
        primed(&self.base, self.order)
    }
}

/// All unknowns of a problem.
pub(super) struct Unknowns {
    /// The unknowns: declared quantities in the order of the problem, then auxiliary quantities.
    pub all: Vec<Unknown>,
    /// The index of each unknown, by its name without primes.
    indices: HashMap<String, usize>,
}

/// The equations that are no initial values, with their indices.
pub(super) fn laws(circuit: &Circuit) -> impl Iterator<Item = (usize, &Placed<Equation>)> {
    let equations = circuit.equations().iter().enumerate();
    equations.filter(|(_, placed)| placed.value.initial_quantity().is_none())
}

impl Unknowns {
    /// The unknowns of a problem. The order of a quantity is the largest number of primes after its name in the
    /// equations.
    pub(super) fn new(problem: &Problem, circuit: &Circuit) -> Self {
        let mut unknowns = Unknowns { all: Vec::new(), indices: HashMap::new() };
        let declared = problem.quantities.keys().map(|name| split_primes(name).0);
        for base in declared.chain(circuit.auxiliary_quantities()) {
            unknowns.add(base);
        }
        for (_, placed) in laws(circuit) {
            for name in placed.value.names() {
                let (base, primes) = split_primes(name);
                if let Some(index) = unknowns.indices.get(base) {
                    let unknown = &mut unknowns.all[*index];
                    unknown.order = unknown.order.max(primes);
                }
            }
        }
        for unknown in &mut unknowns.all {
            unknown.is_declared = problem.quantities.contains_key(&unknown.name());
        }
        unknowns
    }

    /// Adds an algebraic quantity, if it is new.
    fn add(&mut self, base: &str) {
        if !self.indices.contains_key(base) {
            self.indices.insert(base.to_owned(), self.all.len());
            self.all.push(Unknown { base: base.to_owned(), order: 0, is_declared: false });
        }
    }

    /// The index of the unknown with this name, which has all its primes. `None` for states and other names.
    pub(super) fn index(&self, name: &str) -> Option<usize> {
        let (base, primes) = split_primes(name);
        let index = *self.indices.get(base)?;
        (self.all[index].order == primes).then_some(index)
    }

    /// The unknown to which a name belongs, as a state, as a highest derivative or as an algebraic quantity. `None` for
    /// other names.
    pub(super) fn of(&self, name: &str) -> Option<&Unknown> {
        self.indices.get(split_primes(name).0).map(|index| &self.all[*index])
    }

    /// The faults of derivatives: of drives, and of quantities that no equation differentiates so often.
    pub(super) fn derivative_faults(&self, problem: &Problem, circuit: &Circuit) -> Vec<Diagnostic> {
        let mut findings = Vec::new();
        for (name, quantity) in &problem.quantities {
            if self.of(name).is_some_and(|unknown| split_primes(name).1 > unknown.order) {
                let message = format!("no equation contains {name}");
                let hint = format!("remove {name}, or write an equation that contains it");
                findings.push(Diagnostic::at(Code::UNKNOWN_NAME, quantity.span, message).hint(hint));
            }
        }
        for (_, placed) in laws(circuit) {
            let derivatives = placed.value.names().into_iter().filter(|name| {
                let (base, primes) = split_primes(name);
                primes > 0 && problem.patch.drives.contains_key(base)
            });
            findings.extend(derivatives.map(|name| drive_derivative(problem, placed, name)));
        }
        findings
    }
}

/// The fault of the derivative of a drive.
fn drive_derivative(problem: &Problem, placed: &Placed<Equation>, name: &str) -> Diagnostic {
    let drive = split_primes(name).0;
    let message = format!("{name} is the derivative of the drive {drive}, which no element computes");
    let hint = derivative_hint(problem, name);
    let range = placed.value.range_of(name).unwrap_or_default();
    formula_diagnostic(Code::BAD_FORMULA, placed, FormulaError { range, message, hint: Some(hint) })
}

/// What to write in place of the derivative of a drive. That of a sine and that of a ramp without a reversal are known.
fn derivative_hint(problem: &Problem, name: &str) -> String {
    let (drive, primes) = split_primes(name);
    let kind = problem.patch.drives.get(drive).map(|entry| entry.kind.name);
    let reverses = || problem.patch.value()["drives"][drive].get("turn").is_some();
    match kind {
        Some("sine") if primes == 1 => format!(
            "add a drive of the kind sine for {name}, and write its name here: its amplitude is that of {drive} times \
             2 pi frequency, its frequency is the same, its phase is larger by pi/2, and its offset is 0"
        ),
        Some("ramp") if primes == 1 && !reverses() => {
            format!("add a parameter with the \"rate\" of {drive}, and write its name here")
        }
        _ => format!("add a drive for {name}, and write its name here"),
    }
}
