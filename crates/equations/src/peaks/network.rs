//! A plan with numbers: the laws that compute every node at an instant.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;

use super::fault::{Fault, FaultKind};
use super::law::{Law, Weighted};
use super::order::{Block, blocks};
use crate::graph::{ConstantValues, NodeId, Operation, Plan, Sum, Term};
use crate::symbolic::Fraction;

/// Tables in SI units by name. A point is [abscissa, ordinate].
pub(super) type Tables = BTreeMap<String, Vec<[f64; 2]>>;

/// The laws of all nodes of a plan. Nodes are given by their index in the plan, and all values are in SI units.
#[derive(Debug)]
pub(super) struct Network {
    /// The law of each node.
    pub laws: Vec<Law>,
    /// The nodes and loops in order of evaluation.
    pub blocks: Vec<Block>,
    /// The integrators. Their order is that of the states.
    pub integrals: Vec<Integral>,
    /// The delay lines.
    pub lines: Vec<Line>,
    /// The nodes that are drives, with the names of the drives.
    pub drives: Vec<(usize, String)>,
}

/// An integrator.
#[derive(Debug)]
pub(super) struct Integral {
    /// Its node.
    pub node: usize,
    /// The value at the start.
    pub initial: f64,
    /// The derivative.
    pub rate: Vec<Weighted>,
}

/// A delay line.
#[derive(Debug)]
pub(super) struct Line {
    /// Its node.
    pub node: usize,
    /// The delayed node.
    pub input: usize,
    /// The delay in seconds, above 0.
    pub time: f64,
    /// The value until the first input arrives.
    pub initial: f64,
}

impl Network {
    /// The network of a plan, with the parameter values of a circuit.
    ///
    /// # Errors
    /// If a coefficient is not finite, or a delay is not positive.
    pub(super) fn new(plan: &Plan, circuit: &Circuit, tables: &Tables) -> Result<Self, Fault> {
        let numbers = Numbers { constants: ConstantValues::new(&plan.symbols, circuit), tables };
        let (mut laws, mut integrals) = (Vec::with_capacity(plan.nodes.len()), Vec::new());
        let (mut lines, mut drives) = (Vec::new(), Vec::new());
        for (node, planned) in plan.nodes.iter().enumerate() {
            laws.push(numbers.law(node, &planned.operation)?);
            match &planned.operation {
                Operation::Drive(name) => drives.push((node, name.clone())),
                Operation::Integral { initial, rate } => {
                    let initial = numbers.number(node, initial)?;
                    integrals.push(Integral { node, initial, rate: numbers.sum(node, rate)? });
                }
                Operation::Delay { input, time, initial } => {
                    let (time, initial) = (numbers.number(node, time)?, numbers.number(node, initial)?);
                    if time <= 0.0 {
                        return Err(Fault::node(FaultKind::Delay, node, 0.0));
                    }
                    lines.push(Line { node, input: index(*input), time, initial });
                }
                _ => {}
            }
        }
        let blocks = blocks(&laws);
        Ok(Network { laws, blocks, integrals, lines, drives })
    }

    /// The network of a plan before its run. The value of a delay line is that of its input. An angle is computed from its
    /// two sums, as `atan2`, so its equation can have any sign.
    ///
    /// # Errors
    /// If a coefficient is not finite, or a delay is not positive.
    pub(super) fn at_start(
        plan: &Plan,
        circuit: &Circuit,
        tables: &Tables,
        angles: &BTreeMap<NodeId, [Sum; 2]>,
    ) -> Result<Self, Fault> {
        let mut network = Network::new(plan, circuit, tables)?;
        let numbers = Numbers { constants: ConstantValues::new(&plan.symbols, circuit), tables };
        for (id, [first, second]) in angles {
            let node = index(*id);
            network.laws[node] = Law::Angle([numbers.sum(node, first)?, numbers.sum(node, second)?]);
        }
        for line in std::mem::take(&mut network.lines) {
            network.laws[line.node] = Law::Sum(vec![Weighted { factor: 1.0, node: line.input }]);
        }
        network.blocks = blocks(&network.laws);
        Ok(network)
    }

    /// Number of nodes.
    pub(super) fn node_count(&self) -> usize {
        self.laws.len()
    }
}

/// The index of a node in the plan.
fn index(id: NodeId) -> usize {
    id.0 as usize
}

/// The numbers of a plan.
struct Numbers<'a> {
    /// The values of the parameters.
    constants: ConstantValues,
    /// The tables.
    tables: &'a Tables,
}

impl Numbers<'_> {
    /// The value of a coefficient of a node.
    ///
    /// # Errors
    /// If it is not finite.
    fn number(&self, node: usize, coefficient: &Fraction) -> Result<f64, Fault> {
        let number = self.constants.value(coefficient);
        if number.is_finite() { Ok(number) } else { Err(Fault::node(FaultKind::Coefficient, node, 0.0)) }
    }

    /// A term of a node with the value of its coefficient.
    ///
    /// # Errors
    /// If the coefficient is not finite.
    fn term(&self, node: usize, term: &Term) -> Result<Weighted, Fault> {
        Ok(Weighted { factor: self.number(node, &term.coefficient)?, node: index(term.node) })
    }

    /// A sum of a node with the values of its coefficients.
    ///
    /// # Errors
    /// If a coefficient is not finite.
    fn sum(&self, node: usize, sum: &Sum) -> Result<Vec<Weighted>, Fault> {
        let weighted = |(id, coefficient): (&NodeId, &Fraction)| {
            let factor = self.number(node, coefficient)?;
            Ok::<_, Fault>(Weighted { factor, node: index(*id) })
        };
        sum.terms.iter().map(weighted).collect()
    }

    /// A bound of a node; `otherwise` if it has none.
    ///
    /// # Errors
    /// If the bound is not finite.
    fn bound(&self, node: usize, bound: Option<&Fraction>, otherwise: f64) -> Result<f64, Fault> {
        bound.map_or(Ok(otherwise), |bound| self.number(node, bound))
    }

    /// The law of a node with this operation.
    ///
    /// # Errors
    /// If a coefficient is not finite.
    fn law(&self, node: usize, operation: &Operation) -> Result<Law, Fault> {
        Ok(match operation {
            Operation::Drive(_) | Operation::Integral { .. } | Operation::Delay { .. } => Law::Given,
            Operation::One => Law::Constant(1.0),
            Operation::Sum(sum) => Law::Sum(self.sum(node, sum)?),
            Operation::Limited { sum, lower, upper } => Law::Limited {
                sum: self.sum(node, sum)?,
                lower: self.bound(node, lower.as_ref(), f64::NEG_INFINITY)?,
                upper: self.bound(node, upper.as_ref(), f64::INFINITY)?,
            },
            Operation::Product(factors) => Law::Product(factors.map(index)),
            Operation::Quotient { dividend, divisor } => {
                Law::Quotient { dividend: self.sum(node, dividend)?, divisor: index(*divisor) }
            }
            Operation::Root(sum) => Law::Root(self.sum(node, sum)?),
            Operation::Zero(sum) => Law::Zero(self.sum(node, sum)?),
            Operation::Absolute(input) => Law::Absolute(index(*input)),
            Operation::Lower([one, other]) => Law::Lower([self.term(node, one)?, self.term(node, other)?]),
            Operation::Higher([one, other]) => Law::Higher([self.term(node, one)?, self.term(node, other)?]),
            Operation::Switch { input, at_least_0, below_0 } => Law::Switch {
                input: index(*input),
                at_least_0: self.number(node, at_least_0)?,
                below_0: self.number(node, below_0)?,
            },
            Operation::DeadZone { input, width } => {
                Law::DeadZone { input: index(*input), width: self.term(node, width)? }
            }
            Operation::Function { kind, argument } => {
                Law::Function(kind.function(), self.term(node, argument)?)
            }
            Operation::Curve { table, input } => Law::Curve {
                points: self.tables.get(table).cloned().unwrap_or_default(),
                input: self.term(node, input)?,
            },
        })
    }
}
