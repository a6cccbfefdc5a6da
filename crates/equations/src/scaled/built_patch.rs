//! The faults of a built patch as faults of the problem from which it is made.
//!
//! The reader did not write the text of a built patch. So positions in it become those of quantities in the problem, and
//! advice about elements becomes advice about equations.

use patchcord_core::document::{Diagnostic, Report, Severity, Span, format_number};
use patchcord_core::patch::{ElementEntry, Patch};
use patchcord_core::solve::RunError;

use super::attempt::Basis;
use super::error::ScaleError;
use crate::findings::codes;
use crate::graph::{Node, NodeId, Operation};
use crate::positions::{quantity_span, run_length_span};
use crate::synthesis::Synthesis;

/// What to do about a jump that acts on itself without end.
const GRADUAL_SWITCH: &str = "replace the jump by a steep line: limit(x / w, -1, 1) in place of sign(x), or \
                              limit(x / w, 0, 1) in place of step(x), with a small parameter w in the unit of x";
/// What to do about a bend that is crossed without end.
const STEADY_INPUT: &str = "find out why its argument oscillates, or write a shorter \"step\"";
/// What to do about a run that stopped.
const OTHER_RUN: &str = "check the equations, the initial values and the times of \"run\"";

/// A built patch, and what it is made from.
pub(super) struct BuiltPatch<'a> {
    /// The problem with its plan.
    pub basis: Basis<'a>,
    /// The elements and drives with the values of nodes.
    pub outputs: &'a [(NodeId, String)],
    /// The patch.
    pub patch: &'a Patch,
}

impl<'a> BuiltPatch<'a> {
    /// The patch of a synthesis.
    pub(super) fn new(basis: &Basis<'a>, synthesis: &'a Synthesis) -> Self {
        BuiltPatch { basis: *basis, outputs: &synthesis.outputs, patch: &synthesis.patch }
    }

    /// A fault of the patch as one of the problem.
    pub(super) fn fault_of_problem(&self, error: ScaleError) -> ScaleError {
        let findings = match error {
            ScaleError::Problem(report) => return ScaleError::Problem(report),
            ScaleError::Circuit(report) => self.errors(&report),
            ScaleError::Settings(error) => vec![self.stopped_run(&error)],
            ScaleError::Run(stopped) => vec![self.stopped_run(&stopped.error)],
        };
        ScaleError::of_problem(self.basis.problem, self.basis.circuit, findings)
    }

    /// The errors of a report on the patch, at positions in the problem.
    fn errors(&self, report: &Report) -> Vec<Diagnostic> {
        let is_error = |finding: &&Diagnostic| finding.code.severity() == Severity::Error;
        report.findings.iter().filter(is_error).map(|finding| self.in_problem(finding)).collect()
    }

    /// A finding about the patch, at the position in the problem.
    pub(super) fn in_problem(&self, finding: &Diagnostic) -> Diagnostic {
        let element = finding.span.and_then(|span| self.element_at(span));
        let first_equation = || self.basis.problem.patch.equations.first().map(|placed| placed.span);
        let span = element.and_then(|element| self.span_of(element)).or_else(first_equation);
        Diagnostic { span, ..finding.clone() }
    }

    /// The element on whose line a position of the patch is.
    fn element_at(&self, span: Span) -> Option<&str> {
        let between = |entry: &ElementEntry| self.patch.text().get(entry.span.start..span.start);
        let is_on_line = |entry: &ElementEntry| between(entry).is_some_and(|text| !text.contains('\n'));
        let found = self.patch.elements.iter().find(|(_, entry)| is_on_line(entry));
        found.map(|(name, _)| name.as_str())
    }

    /// The position in the problem of the quantity at an output, or else of the nearest quantity that depends on it.
    /// `None` if there is none.
    pub(super) fn span_of(&self, output: &str) -> Option<Span> {
        let mut outputs = vec![output];
        let mut next = 0;
        while let Some(output) = outputs.get(next).copied() {
            if let Some(span) =
                self.node(output).and_then(|node| quantity_span(self.basis.problem, &node.name))
            {
                return Some(span);
            }
            let reads = |entry: &ElementEntry| entry.plugs.iter().any(|plug| plug.from.value == output);
            for (reader, _) in self.patch.elements.iter().filter(|(_, entry)| reads(entry)) {
                if !outputs.contains(&reader.as_str()) {
                    outputs.push(reader);
                }
            }
            next += 1;
        }
        None
    }

    /// The node with the value of an output. `None` if the plan has none: for pots, inverters and added nodes.
    fn node(&self, output: &str) -> Option<&Node> {
        let (id, _) = self.outputs.iter().find(|(_, name)| name == output)?;
        self.basis.plan.nodes.get(id.0 as usize)
    }

    /// The fault of a run of the patch that stopped or could not begin.
    fn stopped_run(&self, error: &RunError) -> Diagnostic {
        let output = error.element();
        let span =
            output.and_then(|output| self.span_of(output)).or_else(|| run_length_span(self.basis.problem));
        let node = output.and_then(|output| self.node(output));
        let (message, hint) = match error {
            RunError::Chatter { time, .. } => {
                let name = node.map_or("a function", |node| node.name.as_str());
                let is_switch = node.is_some_and(|node| matches!(node.operation, Operation::Switch { .. }));
                let message = format!("{name} switches without end at t = {} s", format_number(*time));
                (message, if is_switch { GRADUAL_SWITCH } else { STEADY_INPUT })
            }
            other => (format!("the run of the scaled patch stopped: {other}"), OTHER_RUN),
        };
        Diagnostic { code: codes::NO_SOLUTION, span, message, hint: Some(hint.to_owned()) }
    }
}

#[cfg(test)]
mod tests;
