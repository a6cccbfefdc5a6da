//! The scaled equations of a plan: relations between the voltages of the machine.
//!
//! A quantity in brackets is its voltage: `[x]` is x divided by the scale of x. The derivative is that over machine time.
//! So the factors are the computer gains of the block gain rule (thesis eq. 4-8): coefficient times input scale over
//! output scale.

use patchcord_expr::format_significant;

use crate::graph::{ConstantValues, NodeId, Operation, Plan, Sum, Term};
use crate::symbolic::Fraction;

/// Significant digits of the factors.
const DIGITS: usize = 4;
/// The voltage of the constant 1 is the reference voltage in volts.
const FULL_SCALE: f64 = 100.0;

/// Writes the scaled equations of a plan.
pub(super) struct ScaledEquations<'a> {
    /// The plan.
    pub plan: &'a Plan,
    /// The value of one volt of each node, in SI units.
    pub per_volt: &'a [f64],
    /// Machine seconds per problem second.
    pub time_scale: f64,
    /// The values of the parameters.
    pub constants: &'a ConstantValues,
    /// For each node, whether the equation of another one has its name in place of its expression.
    pub is_named: Vec<bool>,
}

impl<'a> ScaledEquations<'a> {
    /// The equations of a plan with the values of one volt of all nodes in SI units.
    pub(super) fn new(
        plan: &'a Plan,
        per_volt: &'a [f64],
        time_scale: f64,
        constants: &'a ConstantValues,
    ) -> Self {
        let mut is_named = vec![false; plan.nodes.len()];
        for quantity in &plan.quantities {
            is_named[quantity.node.0 as usize] = true;
        }
        for id in plan.ids() {
            let is_integral = matches!(plan.node(id).operation, Operation::Integral { .. });
            is_named[id.0 as usize] |= is_integral || depends_on_itself(plan, id, &is_named);
        }
        ScaledEquations { plan, per_volt, time_scale, constants, is_named }
    }
}

/// Whether a node is in a loop without a named node.
fn depends_on_itself(plan: &Plan, id: NodeId, is_named: &[bool]) -> bool {
    let mut is_visited = vec![false; plan.nodes.len()];
    let mut open = plan.node(id).operation.inputs();
    while let Some(input) = open.pop() {
        let index = input.0 as usize;
        if input == id {
            return true;
        }
        if !is_named[index] && !is_visited[index] {
            is_visited[index] = true;
            open.extend(plan.node(input).operation.inputs());
        }
    }
    false
}

impl ScaledEquations<'_> {
    /// The nodes that have a name in the equations and are no quantities of the problem: they are in loops.
    pub(super) fn further(&self) -> impl Iterator<Item = NodeId> {
        let is_quantity = |id: &NodeId| self.plan.quantities.iter().any(|quantity| quantity.node == *id);
        self.plan.ids().filter(|id| self.is_named[id.0 as usize]).filter(move |id| !is_quantity(id))
    }

    /// The scaled equation of a node, such as `[v]' = -2.5 [x] - 0.4 [v]`.
    pub(super) fn equation(&self, id: NodeId) -> String {
        let name = &self.plan.node(id).name;
        match &self.plan.node(id).operation {
            Operation::Integral { rate, .. } => {
                format!("[{name}]' = {}", self.sum(rate, self.scale(id) * self.time_scale))
            }
            _ => format!("[{name}] = {}", self.right_side(id)),
        }
    }

    /// The scale of a node, in SI units per volt.
    fn scale(&self, id: NodeId) -> f64 {
        self.per_volt[id.0 as usize]
    }

    /// The voltage of a node as an operand: its name in brackets, or the expression of an unnamed node.
    fn operand(&self, id: NodeId) -> String {
        if self.is_named[id.0 as usize] {
            return format!("[{}]", self.plan.node(id).name);
        }
        match &self.plan.node(id).operation {
            Operation::Drive(name) => format!("[{name}]"),
            Operation::One => format_significant(FULL_SCALE, DIGITS),
            Operation::Sum(_) | Operation::Quotient { .. } => format!("({})", self.right_side(id)),
            _ => self.right_side(id),
        }
    }

    /// The voltage of a node as a function of others.
    fn right_side(&self, id: NodeId) -> String {
        let own = self.scale(id);
        match &self.plan.node(id).operation {
            Operation::One => format_significant(FULL_SCALE, DIGITS),
            Operation::Drive(name) => format!("[{name}]"),
            Operation::Integral { .. } => format!("[{}]", self.plan.node(id).name),
            Operation::Sum(sum) => self.sum(sum, own),
            Operation::Limited { sum, lower, upper } => {
                self.limited(sum, lower.as_ref(), upper.as_ref(), own)
            }
            Operation::Product([a, b]) if a == b => format!("{}^2/100", self.operand(*a)),
            Operation::Product([a, b]) => format!("{} {}/100", self.operand(*a), self.operand(*b)),
            Operation::Quotient { dividend, divisor } => {
                let dividend = self.sum(dividend, FULL_SCALE * own * self.scale(*divisor));
                format!("100 ({dividend})/{}", self.operand(*divisor))
            }
            Operation::Root(sum) => format!("10 sqrt({})", self.sum(sum, FULL_SCALE * own * own)),
            Operation::Zero(sum) => format!("the value for which {} = 0", self.sum(sum, own)),
            Operation::Absolute(input) => format!("abs({})", self.operand(*input)),
            Operation::Lower(terms) => format!("min({})", self.arguments(terms, own)),
            Operation::Higher(terms) => format!("max({})", self.arguments(terms, own)),
            Operation::Switch { input, at_least_0, below_0 } => {
                let volts = |value: &Fraction| format_significant(self.constants.value(value) / own, DIGITS);
                format!(
                    "{} if {} >= 0, otherwise {}",
                    volts(at_least_0),
                    self.operand(*input),
                    volts(below_0)
                )
            }
            Operation::DeadZone { input, width } => {
                let zone =
                    format!("dead_zone({}, {})", self.operand(*input), self.term(width, self.scale(*input)));
                let factor = self.scale(*input) / own;
                format!("{} {zone}", format_significant(factor, DIGITS))
            }
            Operation::Function { kind, argument } => {
                let factor = self.constants.value(&argument.coefficient) * self.scale(argument.node);
                let inner = with_factor(factor, &self.operand(argument.node));
                format!("{} {}({inner})", format_significant(1.0 / own, DIGITS), kind.function().name())
            }
            Operation::Curve { table, input } => format!("{table}({})", self.operand(input.node)),
            Operation::Delay { input, time, .. } => {
                let seconds = format_significant(self.constants.value(time) * self.time_scale, DIGITS);
                format!("delay({}, {seconds} s)", self.operand(*input))
            }
        }
    }

    /// A limited sum, with its bounds in volts.
    fn limited(&self, sum: &Sum, lower: Option<&Fraction>, upper: Option<&Fraction>, own: f64) -> String {
        let volts = |bound: &Fraction| format_significant(self.constants.value(bound) / own, DIGITS);
        let inner = self.sum(sum, own);
        match (lower, upper) {
            (Some(lower), Some(upper)) => format!("limit({inner}, {}, {})", volts(lower), volts(upper)),
            (Some(lower), None) => format!("max({inner}, {})", volts(lower)),
            (None, Some(upper)) => format!("min({inner}, {})", volts(upper)),
            (None, None) => inner,
        }
    }

    /// Two weighted nodes as arguments of a function, in volts of a scale.
    fn arguments(&self, terms: &[Term; 2], scale: f64) -> String {
        terms.iter().map(|term| self.term(term, scale)).collect::<Vec<_>>().join(", ")
    }

    /// A weighted node, in volts of a scale.
    fn term(&self, term: &Term, scale: f64) -> String {
        self.weighted(self.constants.value(&term.coefficient), term.node, scale)
    }

    /// A coefficient times a node, in volts of a scale. The constant 1 becomes a number of volts.
    fn weighted(&self, coefficient: f64, node: NodeId, scale: f64) -> String {
        let gain = coefficient * self.scale(node) / scale;
        match self.plan.node(node).operation {
            Operation::One => format_significant(gain * FULL_SCALE, DIGITS),
            _ => with_factor(gain, &self.operand(node)),
        }
    }

    /// A weighted sum of nodes, in volts of a scale: each term has the computer gain as its factor.
    fn sum(&self, sum: &Sum, scale: f64) -> String {
        let mut text = String::new();
        for (node, coefficient) in &sum.terms {
            let coefficient = self.constants.value(coefficient);
            let term = self.weighted(coefficient.abs(), *node, scale);
            text += match (coefficient < 0.0, text.is_empty()) {
                (true, true) => "-",
                (false, true) => "",
                (true, false) => " - ",
                (false, false) => " + ",
            };
            text += &term;
        }
        if text.is_empty() { "0".to_owned() } else { text }
    }
}

/// An operand with a factor in front, unless that is 1.
fn with_factor(factor: f64, operand: &str) -> String {
    match format_significant(factor, DIGITS).as_str() {
        "1" => operand.to_owned(),
        "-1" => format!("-{operand}"),
        factor => format!("{factor} {operand}"),
    }
}
