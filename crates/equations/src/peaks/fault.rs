//! Why a plan has no ranges, as a diagnostic.

use patchcord_core::document::{Code, Diagnostic, Report, format_number};
use patchcord_core::patch::Problem;
use patchcord_core::solve::RunError;

use super::evaluator::MAX_EVALUATIONS;
use crate::findings::codes;
use crate::graph::{NodeId, Plan};
use crate::positions::{node_span, run_length_span};

/// Why a plan has no ranges.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Fault {
    /// A node is at fault.
    Node {
        /// What is wrong.
        kind: FaultKind,
        /// Index of the node in the plan.
        node: usize,
        /// Problem time in seconds.
        time: f64,
    },
    /// The solution takes too many evaluations.
    TooLong {
        /// Problem time in seconds that was reached.
        time: f64,
    },
    /// The drives or the times of the run are wrong.
    Other(Box<Diagnostic>),
}

/// What is wrong at a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FaultKind {
    /// A coefficient is not finite.
    Coefficient,
    /// A delay is not positive.
    Delay,
    /// The node is a divisor that passes 0.
    Divisor,
    /// The node is the root of a negative number.
    NegativeRoot,
    /// The value is not finite.
    NotFinite,
    /// The node belongs to a loop that has no solution.
    Unsolved,
    /// The value grows without bound.
    Unbounded,
}

impl Fault {
    /// A fault of a node at a problem time in seconds.
    pub(super) fn node(kind: FaultKind, node: usize, time: f64) -> Self {
        Fault::Node { kind, node, time }
    }

    /// The fault as a diagnostic: at the quantity of the problem, or at the length of the run.
    pub(super) fn diagnostic(self, plan: &Plan, problem: &Problem) -> Diagnostic {
        let finding = self.text(plan, problem);
        let span = finding.span.or_else(|| run_length_span(problem));
        Diagnostic { span, ..finding }
    }

    /// The fault as a diagnostic. It has no position if the fault is not at a quantity.
    fn text(self, plan: &Plan, problem: &Problem) -> Diagnostic {
        match self {
            Fault::Node { kind, node, time } => {
                let name = &plan.nodes[node].name;
                let (code, message, hint) = kind.text(name, &format!("t = {} s", format_number(time)));
                let span = node_span(plan, problem, NodeId(node as u32));
                Diagnostic { code, span, message, hint: Some(hint.to_owned()) }
            }
            Fault::TooLong { time } => {
                let message = format!(
                    "the numerical solution takes more than {MAX_EVALUATIONS} evaluations up to t = {} s",
                    format_number(time)
                );
                Diagnostic::without_span(codes::LONG_SOLUTION, message)
            }
            Fault::Other(diagnostic) => *diagnostic,
        }
    }
}

impl FaultKind {
    /// The code, the message and the hint for a node of this name. `at` is the time, such as "t = 2 s".
    fn text(self, name: &str, at: &str) -> (Code, String, &'static str) {
        match self {
            FaultKind::Coefficient => (
                codes::NO_SOLUTION,
                format!("a coefficient of {name} is not a finite number"),
                "look for a divisor that is 0 for the values of the parameters",
            ),
            FaultKind::Delay => (
                codes::NO_SOLUTION,
                format!("the delay of {name} is not positive"),
                "give the delay a value above 0 s",
            ),
            FaultKind::Divisor => (
                codes::ZERO_DIVISOR,
                format!("{name} is a divisor, but it reaches 0 at {at}"),
                "check its initial value and the signs of its terms, end the run earlier, or multiply the equation by \
                 the divisor",
            ),
            FaultKind::NegativeRoot => (
                codes::NO_SOLUTION,
                format!("{name} is the square root of a negative number at {at}"),
                "check the signs of the terms under the root, end the run earlier, or write sqrt(max(x, 0))",
            ),
            FaultKind::NotFinite => (
                codes::NO_SOLUTION,
                format!("{name} is not a finite number at {at}"),
                "check the initial values, the argument of each ln and exp, and the signs of the terms",
            ),
            FaultKind::Unsolved => (
                codes::NO_SOLUTION,
                format!("the equation of {name} has no solution at {at}"),
                "check the signs of its terms, the values of the parameters and the initial values",
            ),
            FaultKind::Unbounded => (
                codes::UNBOUNDED,
                format!("{name} grows without bound: at {at} it is too large for a patch"),
                "look for a term with the wrong sign, end the run earlier, or state a \"maximum\" for each quantity",
            ),
        }
    }
}

impl From<RunError> for Fault {
    fn from(error: RunError) -> Self {
        let finding = Diagnostic::without_span(codes::NO_SOLUTION, error.to_string());
        Fault::Other(Box::new(finding.hint("change the drives, or the times of \"run\"")))
    }
}

impl From<Box<Report>> for Fault {
    /// The first diagnostic of a report, which has at least one.
    fn from(report: Box<Report>) -> Self {
        let text = || Diagnostic::without_span(codes::NO_SOLUTION, report.to_string());
        Fault::Other(Box::new(report.findings.first().cloned().unwrap_or_else(text)))
    }
}
