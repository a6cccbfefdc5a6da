//! Checks the names in the equations of a patch.

use std::collections::HashSet;

use super::notations::other_notation;
use super::scope::{EquationScope, ParameterNames, TIME, is_element, is_scale};
use crate::document::{
    Code, Diagnostic, MAX_SUGGESTIONS, Placed, TIME_SCALE, formula_diagnostic, suggestion, unit_advice,
};
use crate::patch::Patch;
use patchcord_expr::{Equation, Expression, FormulaError, Scope, split_initial, split_primes};

/// Checks names against the patch and the auxiliary quantities.
pub(super) struct NameChecker<'a> {
    /// The patch, for its names and equations.
    pub patch: &'a Patch,
    /// The names that the equations can use.
    pub scope: &'a EquationScope<'a>,
}

/// The fault of a name.
struct NameFault {
    /// The code of the diagnostic.
    code: Code,
    /// What is wrong.
    message: String,
    /// What to do about it; `None` if there is no good guess.
    hint: Option<String>,
}

impl NameFault {
    /// A fault with a hint.
    fn new(code: Code, message: String, hint: impl Into<String>) -> NameFault {
        NameFault { code, message, hint: Some(hint.into()) }
    }
}

impl NameChecker<'_> {
    /// Whether an equation can use all its names. Reports each name that it cannot use once, at its first position.
    ///
    /// A name whose definition could not be read makes the equation unusable without a report.
    pub(super) fn check(&self, placed: &Placed<Equation>, findings: &mut Vec<Diagnostic>) -> bool {
        let mut faulty = HashSet::new();
        for name in placed.value.names() {
            let (base, order) = split_primes(name);
            if faulty.contains(base) {
                continue;
            }
            let is_known = self.scope.is_variable(base) || self.patch.parameters.contains_key(base);
            if !is_known && base != TIME && self.patch.unread_names().can_include(base) {
                faulty.insert(base);
            } else if let Some(fault) = self.fault(placed, name, base, order, findings.len()) {
                faulty.insert(base);
                let range = placed.value.range_of(name).unwrap_or_default();
                let error = FormulaError { range, message: fault.message, hint: fault.hint };
                findings.push(formula_diagnostic(fault.code, placed, error));
            }
        }
        faulty.is_empty()
    }

    /// The fault of a name with this base and number of primes. `None` if the equation can use it.
    ///
    /// `reported` is the number of diagnostics so far. After many of them, unknown names get no hint.
    fn fault(
        &self,
        placed: &Placed<Equation>,
        name: &str,
        base: &str,
        order: usize,
        reported: usize,
    ) -> Option<NameFault> {
        let is_parameter = self.patch.parameters.contains_key(base);
        if is_parameter && let Some(other) = self.meaning(base) {
            let message = format!("{base} is ambiguous: it is {other} and a parameter");
            return Some(NameFault::new(Code::DUPLICATE_NAME, message, "rename the parameter"));
        }
        let is_initial = split_initial(name).is_some();
        if self.scope.is_variable(base) {
            let is_signal = self.patch.signals.contains_key(base);
            return (is_initial && !is_signal)
                .then(|| self.no_initial_value(base, variable_noun(self.patch, base)));
        }
        if is_parameter || base == TIME {
            let noun = if is_parameter { "a parameter" } else { "the time" };
            return match is_initial {
                true => Some(self.no_initial_value(base, noun)),
                false => (order > 0).then(|| self.no_derivative(base, noun)),
            };
        }
        let message = format!("{base} is not a quantity of the equations");
        if is_element(self.patch, base) {
            return Some(NameFault::new(Code::UNKNOWN_NAME, message, self.element_hint(base, reported)));
        }
        if is_scale(self.patch, base) {
            return Some(NameFault::new(Code::UNKNOWN_NAME, message, scale_hint(base)));
        }
        Some(self.unknown(placed, name, base, reported))
    }

    /// What a name is apart from a parameter, with its article. `None` if it is nothing else.
    fn meaning(&self, name: &str) -> Option<&'static str> {
        if self.patch.signals.contains_key(name) {
            Some("a signal")
        } else if self.patch.drives.contains_key(name) {
            Some("a drive")
        } else {
            (name == TIME).then_some("the time")
        }
    }

    /// The hint for the name of an element. It gives a signal that reads the element, if there is one.
    fn element_hint(&self, element: &str, reported: usize) -> String {
        let find = || self.patch.signals.iter().find(|(_, signal)| signal.element.value == element);
        match (reported < MAX_SUGGESTIONS).then(find).flatten() {
            Some((signal, _)) => format!("{element} is an element: name its signal {signal}"),
            None => format!("{element} is an element: name a signal"),
        }
    }

    /// The fault of an unknown name. The hint is the unit, the notation or the name that is probably meant, the signal that
    /// an equation such as `x' = v` needs, or a list of the known names. In an initial value the name is meant as a
    /// parameter.
    fn unknown(&self, placed: &Placed<Equation>, name: &str, base: &str, reported: usize) -> NameFault {
        let message = format!("{base} is not known here");
        let equation = &placed.value;
        let is_in_initial_value =
            equation.initial_quantity().is_some_and(|quantity| split_primes(quantity).0 != base);
        let parameters = ParameterNames(self.patch);
        let scope: &dyn Scope = if is_in_initial_value { &parameters } else { self.scope };
        let error = match reported < MAX_SUGGESTIONS {
            true => equation.unknown_name(name, scope),
            false => None,
        };
        let Some(error) = error else { return NameFault { code: Code::UNKNOWN_NAME, message, hint: None } };
        let sides = [equation.left(), equation.right()];
        let hint = unit_advice(self.scope, equation.text(), &sides, &error, None)
            .map(|advice| format!("numbers have no units in equations: {advice}"))
            .or_else(|| if is_in_initial_value { None } else { other_notation(self.scope, name) })
            .or(error.hint)
            .or_else(|| is_in_initial_value.then(|| format!("declare {base} as a parameter")))
            .or_else(|| self.derivative_hint(base))
            .or_else(|| self.known_names(base));
        NameFault { code: Code::UNKNOWN_NAME, message, hint }
    }

    /// The hint for an unknown name that resembles no other: the known names. In a problem, the name can be declared.
    fn known_names(&self, unknown: &str) -> Option<String> {
        let known = suggestion(unknown, &self.scope.names())?;
        Some(match self.patch.is_problem() {
            true => format!("declare {unknown} as a parameter or a quantity; {known}"),
            false => known,
        })
    }

    /// The hint for an unknown name v if one of the equations is `x' = v`.
    fn derivative_hint(&self, unknown: &str) -> Option<String> {
        let mut derivatives = self.patch.equations.iter().filter_map(|placed| {
            let [left, right] = [placed.value.left(), placed.value.right()].map(|side| &side.expression);
            match (left, right) {
                (Expression::Name(left), Expression::Name(right)) if right == unknown => Some(left),
                _ => None,
            }
        });
        let derivative = derivatives.find(|name| {
            let (base, order) = split_primes(name);
            order > 0 && split_initial(name).is_none() && self.scope.is_variable(base)
        })?;
        Some(format!("{}, or write {derivative}", how_to_add(self.patch, unknown)))
    }

    /// The fault of a prime after a name without a derivative. `noun` is what the name is, with its article.
    fn no_derivative(&self, name: &str, noun: &str) -> NameFault {
        let message = format!("{name} is {noun} and has no derivative");
        let signals = signals_noun(self.patch);
        let hint = format!("primes follow the names of {signals}, drives and auxiliary quantities");
        NameFault::new(Code::BAD_FORMULA, message, hint)
    }

    /// The fault of the initial value of a name that has none. `noun` is what the name is, with its article.
    fn no_initial_value(&self, name: &str, noun: &str) -> NameFault {
        let message = format!("{name} is {noun} and has no initial value");
        let hint = format!("only {} have initial values, such as x(0)", signals_noun(self.patch));
        NameFault::new(Code::BAD_FORMULA, message, hint)
    }
}

/// What messages call the signals. The signals of a problem are its quantities.
fn signals_noun(patch: &Patch) -> &'static str {
    if patch.is_problem() { "quantities" } else { "signals" }
}

/// What to do so that the equations can use a name.
pub(super) fn how_to_add(patch: &Patch, name: &str) -> String {
    match patch.is_problem() {
        true => format!("add {name} to the quantities"),
        false => format!("add a signal {name} to the patch"),
    }
}

/// What a signal, a drive or an auxiliary quantity is, with its article.
pub(super) fn variable_noun(patch: &Patch, name: &str) -> &'static str {
    if patch.signals.contains_key(name) {
        if patch.is_problem() { "a quantity" } else { "a signal" }
    } else if patch.drives.contains_key(name) {
        "a drive"
    } else {
        "an auxiliary quantity"
    }
}

/// The hint for the name of a scale.
fn scale_hint(name: &str) -> String {
    match name {
        TIME_SCALE => "equations are in problem time, so they do not contain the time scale".to_owned(),
        _ => format!("{name} is a scale: name a signal or a parameter, or choose another name"),
    }
}
