//! The initial values of the states.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Code, Diagnostic, Placed, formula_diagnostic};
use patchcord_core::patch::{Problem, ProblemQuantity};
use patchcord_expr::{Equation, FormulaError, Node, split_primes};

use super::constants::Constants;
use super::unknowns::{Unknown, Unknowns, laws};
use crate::notation::primed;
use crate::symbolic::Fraction;

/// The parts of a problem with initial values.
pub(super) struct InitialValues<'a> {
    /// The problem, for the keys "initial".
    pub problem: &'a Problem,
    /// The circuit of the problem, for equations such as `x(0) = x0`.
    pub circuit: &'a Circuit,
    /// The constants of the problem.
    pub constants: &'a Constants,
}

impl InitialValues<'_> {
    /// The initial value of every state, by its name. Also the faults: states without an initial value, and initial
    /// values of other quantities. A quantity in `implicit` can have one: its solution is sought near it.
    pub(super) fn all(
        &self,
        unknowns: &Unknowns,
        implicit: &[&str],
    ) -> (BTreeMap<String, Fraction>, Vec<Diagnostic>) {
        let (mut values, mut faults) = (BTreeMap::new(), self.superfluous(unknowns, implicit));
        let mut keep = |name: String, value: Result<Fraction, Diagnostic>| match value {
            Ok(value) => drop(values.insert(name, value)),
            Err(fault) => faults.push(fault),
        };
        for unknown in &unknowns.all {
            for primes in 0..unknown.order {
                let name = primed(&unknown.base, primes);
                let value = self.stated(&name).unwrap_or_else(|| Err(self.missing(unknown, &name)));
                keep(name, value);
            }
        }
        for name in implicit {
            if let Some(value) = self.stated(name) {
                keep((*name).to_owned(), value);
            }
        }
        (values, faults)
    }

    /// The initial value that the problem states for a quantity. `None` if it states none.
    fn stated(&self, name: &str) -> Option<Result<Fraction, Diagnostic>> {
        let declared = self.problem.quantities.get(name).and_then(|quantity| self.declared(quantity));
        declared.or_else(|| self.equation(name).map(|placed| self.value(placed, placed.value.right())))
    }

    /// The value of the key "initial". `None` if the quantity does not have it.
    fn declared(&self, quantity: &ProblemQuantity) -> Option<Result<Fraction, Diagnostic>> {
        let (placed, factor) = quantity.initial_formula(self.circuit.quantities())?;
        let value = self.value(placed, placed.value.root());
        Some(value.map(|value| value.times(&Fraction::number(factor))))
    }

    /// The equation that states an initial value.
    fn equation(&self, name: &str) -> Option<&Placed<Equation>> {
        self.circuit.equations().iter().find(|placed| placed.value.initial_quantity() == Some(name))
    }

    /// The value of an expression of parameters.
    fn value<T>(&self, placed: &Placed<T>, node: &Node) -> Result<Fraction, Diagnostic> {
        let fault = |code, message: &str, hint: &str| {
            let (range, message, hint) = (node.range.clone(), message.to_owned(), Some(hint.to_owned()));
            formula_diagnostic(code, placed, FormulaError { range, message, hint })
        };
        let Some(value) = self.constants.expression(node) else {
            let message = "an initial value is an expression of parameters";
            return Err(fault(Code::BAD_FORMULA, message, "declare the value at the start as a parameter"));
        };
        if !self.constants.value(&value).is_finite() {
            let message = "the initial value is not a finite number";
            return Err(fault(Code::NOT_FINITE, message, "look for a division by 0 or a wrong power of ten"));
        }
        Ok(value)
    }

    /// The fault of a state without an initial value: at its declaration, or at its highest derivative.
    fn missing(&self, unknown: &Unknown, name: &str) -> Diagnostic {
        if let Some(quantity) = self.problem.quantities.get(name) {
            let message = format!("{name} needs \"initial\"");
            let hint = format!("add \"initial\": 0, or the value of {name} at the start");
            return Diagnostic::at(Code::MISSING_KEY, quantity.span, message).hint(hint);
        }
        let message = format!("{name} needs an initial value");
        let unit = self.unit_of_derivative(name).unwrap_or_else(|| "1".to_owned());
        let hint = format!(
            "add \"{name}\": {{\"unit\": \"{unit}\", \"initial\": 0}} to the quantities, with its value at the start"
        );
        let derivative = unknown.name();
        let first =
            laws(self.circuit).find_map(|(_, placed)| Some((placed, placed.value.range_of(&derivative)?)));
        match first {
            Some((placed, range)) => {
                let error = FormulaError { range, message, hint: Some(hint) };
                formula_diagnostic(Code::MISSING_KEY, placed, error)
            }
            None => Diagnostic::without_span(Code::MISSING_KEY, message).hint(hint),
        }
    }

    /// The unit of a derivative by that of its quantity. `None` if the quantity is not declared.
    fn unit_of_derivative(&self, name: &str) -> Option<String> {
        let (base, order) = split_primes(name);
        let unit = self.problem.quantities.get(base)?.unit.clone();
        let times = if self.circuit.is_time_dimensionless() { 0 } else { order };
        let unit = (0..times).fold(unit, |unit, _| unit.per_second());
        Some(unit.text().to_owned()).filter(|text| !text.is_empty())
    }

    /// The faults of initial values of quantities that are no states.
    fn superfluous(&self, unknowns: &Unknowns, implicit: &[&str]) -> Vec<Diagnostic> {
        let is_state =
            |name: &str| unknowns.of(name).is_some_and(|unknown| split_primes(name).1 < unknown.order);
        let can_start = |name: &str| is_state(name) || implicit.contains(&name);
        let message = |name: &str| format!("an equation determines {name}, so it has no initial value");
        let mut findings = Vec::new();
        for (name, quantity) in &self.problem.quantities {
            if let Some(initial) = &quantity.initial
                && !can_start(name)
            {
                let hint = "remove \"initial\": only quantities whose derivative is in an equation have one";
                findings.push(Diagnostic::at(Code::BAD_FORMULA, initial.span, message(name)).hint(hint));
            }
        }
        for placed in self.circuit.equations() {
            if let Some(name) = placed.value.initial_quantity()
                && !can_start(name)
            {
                let hint = format!("remove this equation: another one determines {name}");
                findings.push(Diagnostic::at(Code::BAD_FORMULA, placed.span, message(name)).hint(hint));
            }
        }
        findings
    }
}
