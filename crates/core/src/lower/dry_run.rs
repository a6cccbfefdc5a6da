//! Checks the changes of parameters in a run plan before the run.
//!
//! The phases are followed in order, without integration. A value that depends on a signal is unknown, and so is
//! everything computed from it; the run checks these.

use crate::circuit::Circuit;
use crate::document::{Code, Diagnostic, ParameterChange, Phase, Span, formula_diagnostic};
use crate::ir::{InvalidCoefficient, Program, RunScope};
use patchcord_expr::Formula;

/// Maximum number of changes that are checked here. The run checks the rest.
const MAX_CHANGES: usize = 10_000;

/// The faults in the parameter values that the phases set.
pub(super) fn findings(circuit: &Circuit, program: &Program) -> Vec<Diagnostic> {
    let mut run = DryRun {
        program,
        parameters: program.parameters.iter().map(|parameter| parameter.value).collect(),
        known: vec![true; program.parameters.len()],
        remaining_changes: MAX_CHANGES,
        findings: Vec::new(),
    };
    run.phases(&circuit.run_plan().phases);
    run.findings
}

/// Parameter values while the phases are followed.
struct DryRun<'a> {
    /// The lowered program. Its own parameter values are not changed.
    program: &'a Program,
    /// Values in SI.
    parameters: Vec<f64>,
    /// Whether the value of each parameter is known. It is unknown if a signal affects it.
    known: Vec<bool>,
    /// Number of changes that may still be checked.
    remaining_changes: usize,
    /// The faults so far, at most one for each position in the document.
    findings: Vec<Diagnostic>,
}

impl DryRun<'_> {
    /// Follows some phases in order.
    fn phases(&mut self, phases: &[Phase]) {
        for phase in phases {
            match phase {
                Phase::Set { changes } => self.set(changes),
                Phase::Repeat { times, phases } => self.repeat(*times, phases),
                _ => {}
            }
        }
    }

    /// Follows a repetition, until nothing changes or the limit is reached. So a billion repetitions take no longer
    /// than ten thousand changes.
    fn repeat(&mut self, times: u64, phases: &[Phase]) {
        for _ in 0..times {
            let remaining_changes = self.remaining_changes;
            self.phases(phases);
            // A repetition without changes changes nothing the next time. Beyond the limit, the run checks.
            if self.remaining_changes == remaining_changes || self.remaining_changes == 0 {
                return;
            }
        }
    }

    /// Applies the changes of a phase together, then checks all settings.
    ///
    /// All formulas are evaluated first: they use the values from before the phase. A parameter that is set to
    /// an unknown value keeps its old number and counts as unknown.
    fn set(&mut self, changes: &[ParameterChange]) {
        self.remaining_changes = self.remaining_changes.saturating_sub(changes.len());
        if self.remaining_changes == 0 {
            return;
        }
        let values: Vec<_> = changes.iter().filter_map(|change| self.value(change)).collect();
        for (index, value) in values {
            self.known[index] = value.is_some();
            if let Some(value) = value {
                self.parameters[index] = value;
            }
        }
        if let Some(change) = changes.first() {
            self.check_settings(change.parameter.span);
        }
    }

    /// Index of the parameter that is set, and its value in SI units if it is known. `None` if there is no
    /// such parameter.
    fn value(&mut self, change: &ParameterChange) -> Option<(usize, Option<f64>)> {
        let name = &change.parameter.value;
        let index = self.program.parameter(name)?;
        if !self.is_predictable(&change.to.value) {
            return Some((index, None));
        }
        let coefficients = self.program.prepare(&self.parameters);
        let scope = RunScope {
            program: self.program,
            parameters: &self.parameters,
            coefficients: &coefficients,
            registers: None,
        };
        match scope.value_for(index, &change.to.value) {
            Ok(value) => Some((index, self.in_si(index, value, change.to.span))),
            Err(error) => {
                self.report(formula_diagnostic(Code::BAD_FORMULA, &change.to, error));
                Some((index, None))
            }
        }
    }

    /// A value of a parameter, converted from its declared unit to SI units; `None` and a finding if the parameter
    /// cannot have it.
    fn in_si(&mut self, index: usize, value: f64, span: Span) -> Option<f64> {
        let checked = self.program.parameters[index].in_si(value);
        checked.map_err(|violation| self.report(violation.diagnostic(Some(span)))).ok()
    }

    /// Whether a formula depends on known values only, which excludes all signals. Scales count as known.
    fn is_predictable(&self, formula: &Formula) -> bool {
        let is_known = |name: &&str| match self.program.parameter(name) {
            Some(index) => self.known[index],
            None => self.program.signal(name).is_none(),
        };
        formula.names().iter().all(is_known)
    }

    /// Checks every setting and every order of settings with the present parameter values. Nothing is checked while a
    /// value is unknown, because any setting may depend on it. `span` is the position of the phase.
    fn check_settings(&mut self, span: Span) {
        if self.known.contains(&false) {
            return;
        }
        let coefficients = self.program.prepare(&self.parameters);
        if let Some(InvalidCoefficient { coefficient, value, fault }) =
            self.program.first_invalid_coefficient(&coefficients)
        {
            let (value, violation) = (fault.value_text(value), fault.describe(value));
            let message = format!("{} is {value} here, {violation}", coefficient.label);
            let hint = "choose other parameter values, or rescale";
            self.report(Diagnostic::at(Code::SETTING_OUTSIDE, span, message).hint(hint));
        }
    }

    /// Reports a fault unless there already is one at the same position.
    fn report(&mut self, finding: Diagnostic) {
        if !self.findings.iter().any(|other| other.span == finding.span) {
            self.findings.push(finding);
        }
    }
}
