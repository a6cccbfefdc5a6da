//! Checks and evaluates the initial values of a problem.
//!
//! An initial value is a number in the unit of its quantity, or a formula of parameters. Like the settings of a patch, a
//! formula of bare numbers counts as a number in that unit. A formula with names has a unit of its own.

use super::names::TIME;
use super::{Problem, ProblemQuantity};
use crate::document::fields::Findings;
use crate::document::{
    Code, Diagnostic, Placed, TIME_SCALE, check_cycles, formula_diagnostic, unit_mismatch,
};
use crate::patch::Patch;
use patchcord_expr::{Dimension, Formula, FormulaDimension, FormulaError, Scope};

impl ProblemQuantity {
    /// The formula of the initial value, and the factor that converts its value to SI units. `None` if the problem does
    /// not state the initial value.
    ///
    /// The factor is the size of the unit if the formula consists of bare numbers, otherwise 1. `scope` has the
    /// dimensions of the parameters, such as the [quantities of a circuit](crate::circuit::Circuit::quantities).
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::Problem;
    ///
    /// let problem = Problem::read("../equations/tests/systems/kepler.json").unwrap();
    /// let circuit = Circuit::new(&problem.patch).unwrap();
    /// let (placed, factor) = problem.quantities["y'"].initial_formula(circuit.quantities()).unwrap();
    /// assert_eq!((placed.value.names(), factor), (vec!["e", "mu", "r0"], 1.0));
    /// ```
    pub fn initial_formula(&self, scope: &dyn Scope) -> Option<(&Placed<Formula>, f64)> {
        let initial = self.initial.as_ref()?;
        let is_literal = initial.value.dimension(scope) == Ok(FormulaDimension::Literal);
        Some((initial, if is_literal { self.unit.factor() } else { 1.0 }))
    }

    /// The initial value in SI units. `None` if the problem does not state it.
    ///
    /// `scope` has the values of the parameters, such as the
    /// [quantities of a circuit](crate::circuit::Circuit::quantities).
    ///
    /// # Errors
    /// If the formula has no finite value, for example because a denominator is 0 with these values.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::Problem;
    ///
    /// let problem = Problem::read("../equations/tests/systems/square-root-and-division.json").unwrap();
    /// let circuit = Circuit::with_parameters(&problem.patch, [("h0", 0.75)]).unwrap();
    /// assert_eq!(problem.quantities["h"].initial_in_si(circuit.quantities()), Ok(Some(0.75)));
    /// assert_eq!(problem.quantities["w"].initial_in_si(circuit.quantities()), Ok(None));
    /// ```
    pub fn initial_in_si(&self, scope: &dyn Scope) -> Result<Option<f64>, Diagnostic> {
        let Some((initial, factor)) = self.initial_formula(scope) else { return Ok(None) };
        let value = initial.value.evaluate(scope);
        let value = value.map_err(|error| formula_diagnostic(Code::BAD_FORMULA, initial, error))? * factor;
        if value.is_finite() {
            return Ok(Some(value));
        }
        let message = format!("the value of {} is too large", initial.value.text());
        Err(Diagnostic::at(Code::NOT_FINITE, initial.span, message).hint("look for a wrong power of ten"))
    }
}

/// Reports initial values that depend on other names than parameters, have the wrong dimension, or have no value.
///
/// A formula with an unread name is not checked: that fault was reported.
pub(super) fn check(problem: &Problem, findings: &mut Findings) {
    for (name, quantity) in &problem.quantities {
        let Some(initial) = &quantity.initial else { continue };
        let is_unread = |name: &&str| problem.patch.unread.can_include(name);
        if !initial.value.names().iter().any(is_unread) {
            check_value(problem, (name.as_str(), quantity), initial, findings);
        }
    }
}

/// Checks the initial value of a quantity with this name.
fn check_value(
    problem: &Problem,
    (name, quantity): (&str, &ProblemQuantity),
    initial: &Placed<Formula>,
    findings: &mut Findings,
) {
    let scope = ParameterScope(&problem.patch);
    let fault = dependence_fault(problem, initial, &initial.value, "an initial value")
        .or_else(|| dimension_fault(&scope, (name, quantity), initial));
    if let Some(fault) = fault {
        findings.push(fault);
    } else if check_cycles(initial, &scope, &quantity.unit, findings).is_some() {
        findings.extend(quantity.initial_in_si(&scope).err());
    }
}

/// The fault of the first name in a formula that has no value before the run. `None` if there is none.
///
/// `placed` has the position of the formula, and `what` is what the formula gives, with its article.
pub(super) fn dependence_fault<T>(
    problem: &Problem,
    placed: &Placed<T>,
    formula: &Formula,
    what: &str,
) -> Option<Diagnostic> {
    let variable = |name: &str| Some((name.to_owned(), variable_noun(problem, name)?));
    let (name, noun) = formula.names().into_iter().find_map(variable)?;
    let range = formula.root().find_name(&name)?.range.clone();
    let message = format!("{what} is an expression of parameters");
    let hint = Some(format!("{name} is {noun}: write a parameter in its place"));
    Some(formula_diagnostic(Code::BAD_FORMULA, placed, FormulaError { range, message, hint }))
}

/// What a name is that equations can use but formulas cannot, with its article. `None` for other names.
fn variable_noun(problem: &Problem, name: &str) -> Option<&'static str> {
    if problem.quantities.contains_key(name) {
        Some("a quantity")
    } else if problem.patch.drives.contains_key(name) {
        Some("a drive")
    } else if problem.tables.contains_key(name) {
        Some("a table")
    } else if name == TIME {
        Some("the time")
    } else {
        (name == TIME_SCALE).then_some("the time scale of a machine")
    }
}

/// The fault of an initial value whose dimension is not that of the quantity. `None` if it has this dimension.
fn dimension_fault(
    scope: &ParameterScope<'_>,
    (name, quantity): (&str, &ProblemQuantity),
    initial: &Placed<Formula>,
) -> Option<Diagnostic> {
    let unit = &quantity.unit;
    let found = match initial.value.dimension(scope) {
        Ok(FormulaDimension::Literal) => return None,
        Ok(FormulaDimension::Of(found)) => found,
        Err(error) => {
            let finding = unit_mismatch(scope, initial, error, Some(unit.text()));
            let is_about_units = finding.code == Code::UNIT_MISMATCH;
            let hint = is_about_units.then(|| "declare numbers with units as parameters".to_owned());
            return Some(finding.maybe_hint(hint));
        }
    };
    let expected = unit.dimension();
    let in_unit = |is_number: bool, text: &str| match is_number {
        true => "a pure number".to_owned(),
        false => format!("in {text}"),
    };
    let found_text = in_unit(found.is_dimensionless(), &found.to_string());
    let expected_text = in_unit(expected.is_dimensionless(), unit.text());
    let message = format!("the initial value of {name} is {found_text}, but {name} is {expected_text}");
    let hint = format!("multiply or divide by parameters until it is {expected_text}");
    (found != expected).then(|| Diagnostic::at(Code::UNIT_MISMATCH, initial.span, message).hint(hint))
}

/// The parameters of a problem with the values of the document, as the names that an initial value can use.
struct ParameterScope<'a>(&'a Patch);

impl Scope for ParameterScope<'_> {
    fn value(&self, name: &str) -> Option<f64> {
        let parameter = self.0.parameters.get(name)?;
        Some(parameter.unit.to_si(parameter.value))
    }

    fn dimension(&self, name: &str) -> Option<Dimension> {
        Some(self.0.parameters.get(name)?.unit.dimension())
    }

    fn declared_unit(&self, name: &str) -> Option<&str> {
        Some(self.0.parameters.get(name)?.unit.text())
    }

    fn names(&self) -> Vec<&str> {
        self.0.parameters.keys().map(String::as_str).collect()
    }
}
