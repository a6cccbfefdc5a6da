//! Why a plan has no ranges, as a diagnostic.

use patchcord_core::document::{Code, Diagnostic, Report, format_number};
use patchcord_core::patch::Problem;
use patchcord_core::solve::RunError;
use patchcord_expr::round_significant;

use super::evaluator::MAX_EVALUATIONS;
use super::watch::MAX_MAGNITUDE;
use crate::findings::codes;
use crate::graph::{FunctionKind, Node, NodeId, Operation, Plan};
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
    /// The node is the logarithm of a negative number.
    NegativeLogarithm,
    /// The node is the logarithm of 0.
    LogarithmOf0,
    /// The value is not a number.
    NotFinite,
    /// The node belongs to a loop that has no solution.
    Unsolved,
    /// The value becomes infinite.
    Unbounded,
    /// The magnitude of a state exceeds every sensible unit.
    TooLarge,
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
                let names = Names::of(plan, kind, node);
                let message = kind.message(&names, &format!("t = {} s", format_number(time)));
                let span = node_span(plan, problem, NodeId(node as u32));
                Diagnostic { code: kind.code(), span, message, hint: Some(kind.hint().to_owned()) }
            }
            Fault::TooLong { time } => too_long(time),
            Fault::Other(diagnostic) => *diagnostic,
        }
    }
}

/// The fault of a solution that takes too many evaluations and has reached a time. The hint names a run that is short
/// enough.
fn too_long(time: f64) -> Diagnostic {
    let message = format!(
        "the numerical solution takes more than {MAX_EVALUATIONS} evaluations: they reach t = {} s",
        format_number(time)
    );
    let finding = Diagnostic::without_span(codes::LONG_SOLUTION, message);
    let step = 10f64.powf(time.log10().floor() - 1.0);
    let end = round_significant((time / step).floor() * step, 2);
    if !(end.is_finite() && end > 0.0) {
        return finding;
    }
    let end = format_number(end);
    finding.hint(format!("let the run end at {end} s, with \"for\": {end}, or leave out the fastest motion"))
}

/// The names in the message of a fault.
struct Names<'p> {
    /// The node, or the power to which its logarithm belongs.
    node: &'p str,
    /// The argument of a logarithm.
    argument: &'p str,
}

impl<'p> Names<'p> {
    /// The names for a fault of a node. A power with any exponent is the exponential of a logarithm, and the reader
    /// knows the power only.
    fn of(plan: &'p Plan, kind: FaultKind, node: usize) -> Self {
        let own = plan.nodes[node].name.as_str();
        if !matches!(kind, FaultKind::NegativeLogarithm | FaultKind::LogarithmOf0) {
            return Names { node: own, argument: own };
        }
        let is_power = |other: &&Node| {
            matches!(&other.operation, Operation::Function { kind: FunctionKind::Exp, argument }
                if argument.node.0 as usize == node)
        };
        let power = plan.nodes.iter().find(is_power).map_or(own, |power| power.name.as_str());
        let argument = own.strip_prefix("ln(").and_then(|rest| rest.strip_suffix(')'));
        Names { node: power, argument: argument.unwrap_or("the argument of the logarithm") }
    }
}

impl FaultKind {
    /// The code of the fault.
    fn code(self) -> Code {
        match self {
            FaultKind::Divisor => codes::ZERO_DIVISOR,
            FaultKind::Unbounded | FaultKind::TooLarge => codes::UNBOUNDED,
            FaultKind::Coefficient
            | FaultKind::Delay
            | FaultKind::NegativeRoot
            | FaultKind::NegativeLogarithm
            | FaultKind::LogarithmOf0
            | FaultKind::NotFinite
            | FaultKind::Unsolved => codes::NO_SOLUTION,
        }
    }

    /// The message for a node with these names. `at` is the time, such as "t = 2 s".
    fn message(self, names: &Names<'_>, at: &str) -> String {
        let (name, argument) = (names.node, names.argument);
        match self {
            FaultKind::Coefficient => format!("a coefficient of {name} is not a finite number"),
            FaultKind::Delay => format!("the delay of {name} is not positive"),
            FaultKind::Divisor => format!("{name} is a divisor, but it reaches 0 at {at}"),
            FaultKind::NegativeRoot => format!("{name} is the square root of a negative number at {at}"),
            FaultKind::NegativeLogarithm => format!("{name}: {argument} is negative at {at}"),
            FaultKind::LogarithmOf0 => format!("{name}: {argument} is 0 at {at}"),
            FaultKind::NotFinite => format!("{name} is not a number at {at}"),
            FaultKind::Unsolved => format!("the equation of {name} has no solution at {at}"),
            FaultKind::Unbounded => format!("{name} grows without bound: it becomes infinite near {at}"),
            FaultKind::TooLarge => {
                format!("{name} grows without bound: it exceeds {MAX_MAGNITUDE:e} in SI units at {at}")
            }
        }
    }

    /// The cure.
    fn hint(self) -> &'static str {
        match self {
            FaultKind::Coefficient => "look for a divisor that is 0 for the values of the parameters",
            FaultKind::Delay => "give the delay a value above 0 s",
            FaultKind::Divisor => {
                "check its initial value and the signs of its terms, end the run earlier, or multiply the equation by \
                 the divisor"
            }
            FaultKind::NegativeRoot => {
                "check the signs of the terms under the root, end the run earlier, or write sqrt(max(x, 0))"
            }
            FaultKind::NegativeLogarithm | FaultKind::LogarithmOf0 => {
                "a logarithm needs a positive argument, and so does a power, unless its exponent is a whole number and \
                 no parameter: check the initial values and the signs of the terms, or end the run earlier"
            }
            FaultKind::NotFinite => "check the initial values and the arguments of all functions",
            FaultKind::Unsolved => {
                "check the signs of its terms, the values of the parameters and the initial values"
            }
            FaultKind::Unbounded | FaultKind::TooLarge => {
                "look for a term with the wrong sign, or end the run earlier"
            }
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
