//! The values of all nodes at the start.
//!
//! They decide the sign of implicit equations, and are the initial values of delays.

use std::collections::{BTreeMap, BTreeSet};

use patchcord_core::patch::Problem;
use patchcord_expr::Function;

use super::constants::Constants;
use super::names::function_of;
use super::newton::Loops;
use super::{Node, NodeId, Operation, Sum, Term};

/// Everything that determines the values at the start.
pub(super) struct Start<'a> {
    /// The nodes of the plan.
    pub nodes: &'a [Node],
    /// The constants of the problem.
    pub constants: &'a Constants,
    /// The problem, for its tables.
    pub problem: &'a Problem,
    /// The values of the drives at the start, in SI units.
    pub drives: &'a BTreeMap<String, f64>,
    /// The angles among the implicit nodes, each with the two sums of which it is `atan2`.
    pub angles: &'a BTreeMap<NodeId, [Sum; 2]>,
    /// A value near the solution and a typical size of nodes, in SI units.
    pub guesses: &'a BTreeMap<NodeId, [f64; 2]>,
}

/// The values at the start.
pub(super) struct StartValues {
    /// The value of each node in SI units.
    pub values: Vec<f64>,
    /// For each implicit node except angles, the derivative of its sum with respect to its own value.
    pub slopes: BTreeMap<NodeId, f64>,
}

/// The order of evaluation.
pub(super) struct Order {
    /// All nodes. Each comes after those that it reads, except the assumed ones.
    nodes: Vec<NodeId>,
    /// One node of each loop: its value is assumed.
    pub assumed: BTreeSet<NodeId>,
}

/// The state of a node in the search for the order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Visit {
    /// It has not been reached.
    Unseen,
    /// The nodes that it reads are being visited.
    Open,
    /// It has its place in the order.
    Done,
}

impl Start<'_> {
    /// The values of all nodes.
    ///
    /// # Errors
    /// A node of a loop if no solution of the loops is found.
    pub(super) fn values(&self) -> Result<StartValues, NodeId> {
        Loops::new(self, self.order()).solution()
    }

    /// The values of all nodes for these values of the assumed ones.
    pub(super) fn evaluated(&self, order: &Order, assumed: &BTreeMap<NodeId, f64>) -> Vec<f64> {
        let mut values = vec![f64::NAN; self.nodes.len()];
        for (node, value) in assumed {
            values[node.0 as usize] = *value;
        }
        for node in order.nodes.iter().filter(|node| !assumed.contains_key(node)) {
            values[node.0 as usize] = self.value(*node, &values);
        }
        values
    }

    /// By how much an assumed value is wrong. For an implicit node this is the value of its sum, for others the
    /// difference between the computed and the assumed value.
    pub(super) fn residual(&self, node: NodeId, values: &[f64]) -> f64 {
        match &self.node(node).operation {
            Operation::Zero(sum) if self.is_implicit(node) => self.sum(sum, values),
            _ => self.value(node, values) - values[node.0 as usize],
        }
    }

    /// Whether a node is implicit and no angle.
    pub(super) fn is_implicit(&self, node: NodeId) -> bool {
        matches!(self.node(node).operation, Operation::Zero(_)) && !self.angles.contains_key(&node)
    }

    /// A value near the solution of a node, and a typical size.
    pub(super) fn guess(&self, node: NodeId) -> [f64; 2] {
        self.guesses.get(&node).copied().unwrap_or([0.0, 1.0])
    }

    /// The value of a node from those of its inputs. An angle is computed directly.
    fn value(&self, node: NodeId, values: &[f64]) -> f64 {
        let of = |node: &NodeId| values[node.0 as usize];
        match &self.node(node).operation {
            Operation::One => 1.0,
            Operation::Drive(name) => self.drives.get(name).copied().unwrap_or(f64::NAN),
            Operation::Integral { initial, .. } => self.constants.value(initial),
            Operation::Sum(sum) => self.sum(sum, values),
            Operation::Limited { sum, lower, upper } => {
                let [lower, upper] =
                    [lower, upper].map(|bound| bound.as_ref().map(|bound| self.constants.value(bound)));
                let value = self.sum(sum, values);
                let raised = lower.map_or(value, |lower| larger(value, lower));
                upper.map_or(raised, |upper| -larger(-raised, -upper))
            }
            Operation::Product([left, right]) => of(left) * of(right),
            Operation::Quotient { dividend, divisor } => self.sum(dividend, values) / of(divisor),
            Operation::Root(sum) => self.sum(sum, values).sqrt(),
            Operation::Zero(_) => match self.angles.get(&node) {
                Some([first, second]) => {
                    Function::Atan2.apply(self.sum(first, values), self.sum(second, values))
                }
                None => of(&node),
            },
            Operation::Absolute(input) => of(input).abs(),
            Operation::Lower([first, second]) => {
                -larger(-self.term(first, values), -self.term(second, values))
            }
            Operation::Higher([first, second]) => larger(self.term(first, values), self.term(second, values)),
            Operation::Switch { input, .. } if of(input).is_nan() => f64::NAN,
            Operation::Switch { input, at_least_0, below_0 } => {
                self.constants.value(if of(input) >= 0.0 { at_least_0 } else { below_0 })
            }
            Operation::DeadZone { input, width } => {
                let (own, width) = (of(input), self.term(width, values));
                larger(own - width, 0.0) - larger(-own - width, 0.0)
            }
            Operation::Function { kind, argument } => {
                function_of(*kind).apply(self.term(argument, values), 0.0)
            }
            Operation::Curve { table, input } => self.curve(table, self.term(input, values)),
            Operation::Delay { input, .. } => of(input),
        }
    }

    /// The value of a sum.
    fn sum(&self, sum: &Sum, values: &[f64]) -> f64 {
        let terms = sum.terms.iter();
        terms.map(|(node, factor)| self.constants.value(factor) * values[node.0 as usize]).sum()
    }

    /// The value of a weighted node.
    fn term(&self, term: &Term, values: &[f64]) -> f64 {
        self.constants.value(&term.coefficient) * values[term.node.0 as usize]
    }

    /// The value of a table in SI units: straight lines between its points, constant outside.
    fn curve(&self, table: &str, at: f64) -> f64 {
        let Some(table) = self.problem.tables.get(table) else { return f64::NAN };
        let at = table.input_unit.out_of_si(at);
        let after = table.points.partition_point(|point| point[0] < at);
        let before = after.checked_sub(1).map(|before| table.points[before]);
        let value = match (before, table.points.get(after)) {
            _ if at.is_nan() => f64::NAN,
            (Some([x, y]), Some([next, value])) => y + (value - y) * (at - x) / (next - x),
            (Some([_, y]), None) => y,
            (None, Some([_, y])) => *y,
            (None, None) => f64::NAN,
        };
        table.output_unit.to_si(value)
    }

    /// The order of evaluation. The search is iterative, because a chain of nodes can be long.
    fn order(&self) -> Order {
        let mut order = Order { nodes: Vec::new(), assumed: BTreeSet::new() };
        let mut visits = vec![Visit::Unseen; self.nodes.len()];
        let mut open: Vec<(NodeId, Vec<NodeId>)> = Vec::new();
        for root in (0..self.nodes.len() as u32).map(NodeId) {
            if visits[root.0 as usize] == Visit::Unseen {
                visits[root.0 as usize] = Visit::Open;
                open.push((root, self.inputs(root)));
            }
            while let Some((node, inputs)) = open.last_mut() {
                let Some(input) = inputs.pop() else {
                    visits[node.0 as usize] = Visit::Done;
                    order.nodes.push(*node);
                    open.pop();
                    continue;
                };
                let visit = &mut visits[input.0 as usize];
                match visit {
                    Visit::Done => {}
                    Visit::Open => {
                        order.assumed.insert(input);
                    }
                    Visit::Unseen => {
                        *visit = Visit::Open;
                        open.push((input, self.inputs(input)));
                    }
                }
            }
        }
        order.assumed.extend((0..self.nodes.len() as u32).map(NodeId).filter(|node| self.is_implicit(*node)));
        order
    }

    /// The nodes on which the value of a node at the start depends.
    fn inputs(&self, node: NodeId) -> Vec<NodeId> {
        match (&self.node(node).operation, self.angles.get(&node)) {
            (Operation::Integral { .. }, _) | (Operation::Zero(_), None) => Vec::new(),
            (Operation::Zero(_), Some(sums)) => {
                sums.iter().flat_map(|sum| sum.terms.keys().copied()).collect()
            }
            (operation, _) => operation.inputs(),
        }
    }

    /// The node with this index.
    fn node(&self, node: NodeId) -> &Node {
        &self.nodes[node.0 as usize]
    }
}

/// The larger of two numbers. NaN if one of them is NaN, so that a value without meaning is not hidden.
fn larger(first: f64, second: f64) -> f64 {
    if first >= second || first.is_nan() { first } else { second }
}
