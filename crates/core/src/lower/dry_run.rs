//! The phases of a patch's run, gone through before it: what its changes of parameters come to, as far as that
//! can be told without running.

use crate::circuit::Circuit;
use crate::document::{Change, Code, Diagnostic, Phase, Span, told};
use crate::ir::{Program, Standing, Unfit};
use patchcord_expr::Formula;

/// More changes than this are left to the run.
const MOST_CHANGES: usize = 10_000;

/// What is wrong with the parameters that the phases set.
pub(super) fn findings(circuit: &Circuit, program: &Program) -> Vec<Diagnostic> {
    let mut rehearsal = Rehearsal {
        program,
        parameters: program.parameters.iter().map(|slot| slot.value).collect(),
        known: vec![true; program.parameters.len()],
        left: MOST_CHANGES,
        findings: Vec::new(),
    };
    rehearsal.all(&circuit.run_plan().phases);
    rehearsal.findings
}

struct Rehearsal<'a> {
    program: &'a Program,
    /// In SI.
    parameters: Vec<f64>,
    /// Whether a parameter's value can be told: not once a signal has had a say in it.
    known: Vec<bool>,
    left: usize,
    findings: Vec<Diagnostic>,
}

impl Rehearsal<'_> {
    fn all(&mut self, phases: &[Phase]) {
        for phase in phases {
            match phase {
                Phase::Set { changes } => self.set(changes),
                Phase::Repeat { times, phases } => self.again(*times, phases),
                _ => {}
            }
        }
    }

    fn again(&mut self, times: u64, phases: &[Phase]) {
        for _ in 0..times {
            let left = self.left;
            self.all(phases);
            // Where nothing was changed nothing will be; where too much was, the run will tell.
            if self.left == left || self.left == 0 {
                return;
            }
        }
    }

    fn set(&mut self, changes: &[Change]) {
        self.left = self.left.saturating_sub(changes.len());
        if self.left == 0 {
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

    /// The parameter that is set and its new value in SI units; `None` for a value that only the run can give.
    fn value(&mut self, change: &Change) -> Option<(usize, Option<f64>)> {
        let name = &change.parameter.value;
        let index = self.program.parameter(name)?;
        if !self.can_tell(&change.to.value) {
            return Some((index, None));
        }
        let coefficients = self.program.prepare(&self.parameters);
        let standing = Standing {
            program: self.program,
            parameters: &self.parameters,
            coefficients: &coefficients,
            registers: None,
        };
        match standing.value_for(index, &change.to.value) {
            Ok(value) => Some((index, self.in_si(index, value, change.to.span))),
            Err(error) => {
                let inside = error.range.start + 1..error.range.end + 1;
                let finding = Diagnostic::at(Code::BadFormula, change.to.span.part(&inside), error.message);
                self.tell(finding.maybe_hint(error.hint));
                Some((index, None))
            }
        }
    }

    /// A value of a parameter, converted to SI units; `None` and a finding if the parameter cannot have it.
    fn in_si(&mut self, index: usize, value: f64, span: Span) -> Option<f64> {
        let checked = self.program.parameters[index].in_si(value);
        checked.map_err(|violation| self.tell(violation.diagnostic(Some(span)))).ok()
    }

    /// Whether everything that a formula names is known without running; scales are, as no phase changes them.
    fn can_tell(&self, formula: &Formula) -> bool {
        let is_known = |name: &&str| match self.program.parameter(name) {
            Some(index) => self.known[index],
            None => self.program.signal(name).is_none(),
        };
        formula.names().iter().all(is_known)
    }

    /// Whether every setting still is what its element takes.
    fn check_settings(&mut self, span: Span) {
        if self.known.contains(&false) {
            return;
        }
        let coefficients = self.program.prepare(&self.parameters);
        if let Some(Unfit { coefficient, value, fault }) = self.program.first_unfit(&coefficients) {
            let message =
                format!("{} comes to {} here, {}", coefficient.label, told(value), fault.describe(value));
            let hint = "set the parameters otherwise, or rescale";
            self.tell(Diagnostic::at(Code::SettingOutside, span, message).hint(hint));
        }
    }

    /// Tells of a place once, however often it is repeated.
    fn tell(&mut self, finding: Diagnostic) {
        if !self.findings.iter().any(|told| told.span == finding.span) {
            self.findings.push(finding);
        }
    }
}
