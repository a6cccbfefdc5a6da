//! A plan with numbers: the laws that compute every node at an instant.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use patchcord_core::circuit::Circuit;
use patchcord_expr::Function;

use super::fault::{Fault, FaultKind};
use super::order::{Block, blocks};
use crate::derive::interpolated;
use crate::plan::{FunctionKind, NodeId, Operation, Plan, Sum, Term};
use crate::symbolic::{Fraction, Symbol, SymbolKind, Symbols, Values, value};

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

/// How a node follows from others at the same instant.
#[derive(Debug)]
pub(super) enum Law {
    /// The value of a state, a drive or a delay line, which is known before the evaluation.
    Given,
    /// A number.
    Constant(f64),
    /// A weighted sum.
    Sum(Vec<Weighted>),
    /// A weighted sum between bounds, which may be infinite.
    Limited {
        /// The sum.
        sum: Vec<Weighted>,
        /// The lower bound.
        lower: f64,
        /// The upper bound.
        upper: f64,
    },
    /// A product of two nodes.
    Product([usize; 2]),
    /// A weighted sum over a node.
    Quotient {
        /// The dividend.
        dividend: Vec<Weighted>,
        /// The divisor.
        divisor: usize,
    },
    /// The square root of a weighted sum. Negative sums count as 0.
    Root(Vec<Weighted>),
    /// The value for which a weighted sum is 0.
    Zero(Vec<Weighted>),
    /// The absolute value of a node.
    Absolute(usize),
    /// The lower of two weighted nodes.
    Lower([Weighted; 2]),
    /// The higher of two weighted nodes.
    Higher([Weighted; 2]),
    /// One of two numbers by the sign of a node.
    Switch {
        /// The node.
        input: usize,
        /// The value while the node is 0 or more.
        at_least_0: f64,
        /// The value while the node is below 0.
        below_0: f64,
    },
    /// 0 within a zone, otherwise the distance from it.
    DeadZone {
        /// The input.
        input: usize,
        /// The half width of the zone.
        width: Weighted,
    },
    /// A function of a weighted node.
    Function(Function, Weighted),
    /// Straight lines between points.
    Curve {
        /// The points.
        points: Vec<[f64; 2]>,
        /// The abscissa.
        input: Weighted,
    },
}

/// A node times a number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighted {
    /// The number.
    pub factor: f64,
    /// The node.
    pub node: usize,
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

impl Weighted {
    /// The product, from the values of all nodes.
    pub(super) fn value(self, values: &[f64]) -> f64 {
        self.factor * values[self.node]
    }
}

/// The value of a weighted sum.
pub(super) fn total(sum: &[Weighted], values: &[f64]) -> f64 {
    sum.iter().fold(0.0, |total, term| total + term.value(values))
}

/// The sum of the magnitudes of the terms of a weighted sum.
pub(super) fn size(sum: &[Weighted], values: &[f64]) -> f64 {
    sum.iter().fold(0.0, |total, term| total + term.value(values).abs())
}

impl Network {
    /// The network of a plan, with the parameter values of a circuit.
    ///
    /// # Errors
    /// If a coefficient is not finite, or a delay is not positive.
    pub(super) fn new(plan: &Plan, circuit: &Circuit, tables: &Tables) -> Result<Self, Fault> {
        let parameters = circuit.parameters().map(|(_, parameter, value)| parameter.unit.to_si(value));
        let numbers = Numbers { symbols: &plan.symbols, parameters: parameters.collect(), tables };
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
    /// The parameters of the coefficients.
    symbols: &'a Symbols,
    /// The values of the parameters in SI units.
    parameters: Vec<f64>,
    /// The tables.
    tables: &'a Tables,
}

/// Coefficients contain parameters and pi only, so everything else has no value.
impl Values for Numbers<'_> {
    fn symbol(&self, symbol: Symbol) -> f64 {
        match self.symbols.entry(symbol).kind {
            SymbolKind::Pi => PI,
            SymbolKind::Parameter(index) => self.parameters.get(index).copied().unwrap_or(f64::NAN),
            SymbolKind::Time | SymbolKind::Variable | SymbolKind::Held => f64::NAN,
        }
    }

    fn table(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    fn slope(&self, _table: u32, _at: f64) -> f64 {
        f64::NAN
    }

    fn delayed(&self, _expression: &Fraction, _time: f64) -> f64 {
        f64::NAN
    }
}

impl Numbers<'_> {
    /// The value of a coefficient of a node.
    ///
    /// # Errors
    /// If it is not finite.
    fn number(&self, node: usize, coefficient: &Fraction) -> Result<f64, Fault> {
        let number = value(coefficient, self);
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
                Law::Function(function(*kind), self.term(node, argument)?)
            }
            Operation::Curve { table, input } => Law::Curve {
                points: self.tables.get(table).cloned().unwrap_or_default(),
                input: self.term(node, input)?,
            },
        })
    }
}

/// The function of numbers that a function generator computes.
fn function(kind: FunctionKind) -> Function {
    match kind {
        FunctionKind::Sin => Function::Sin,
        FunctionKind::Cos => Function::Cos,
        FunctionKind::Exp => Function::Exp,
        FunctionKind::Ln => Function::Ln,
    }
}

impl Law {
    /// The nodes that the law reads at the same instant.
    pub(super) fn inputs(&self) -> Vec<usize> {
        let nodes = |sum: &[Weighted]| sum.iter().map(|term| term.node).collect::<Vec<_>>();
        match self {
            Law::Given | Law::Constant(_) => Vec::new(),
            Law::Sum(sum) | Law::Limited { sum, .. } | Law::Root(sum) | Law::Zero(sum) => nodes(sum),
            Law::Product(factors) => factors.to_vec(),
            Law::Quotient { dividend, divisor } => {
                let mut inputs = nodes(dividend);
                inputs.push(*divisor);
                inputs
            }
            Law::Absolute(input) | Law::Switch { input, .. } => vec![*input],
            Law::Lower(terms) | Law::Higher(terms) => nodes(terms),
            Law::DeadZone { input, width } => vec![*input, width.node],
            Law::Function(_, argument) => vec![argument.node],
            Law::Curve { input, .. } => vec![input.node],
        }
    }

    /// The value of a node with this law, from the values of all nodes. Values that other laws find, as those of states
    /// and of unknowns, stay as they are.
    pub(super) fn value(&self, node: usize, values: &[f64]) -> f64 {
        match self {
            Law::Given | Law::Zero(_) => values[node],
            Law::Constant(number) => *number,
            Law::Sum(sum) => total(sum, values),
            Law::Limited { sum, lower, upper } => limited(total(sum, values), *lower, *upper),
            Law::Product([one, other]) => values[*one] * values[*other],
            Law::Quotient { dividend, divisor } => total(dividend, values) / values[*divisor],
            Law::Root(sum) => limited(total(sum, values), 0.0, f64::INFINITY).sqrt(),
            Law::Absolute(input) => values[*input].abs(),
            Law::Lower([one, other]) => one.value(values).min(other.value(values)),
            Law::Higher([one, other]) => one.value(values).max(other.value(values)),
            Law::Switch { input, at_least_0, below_0 } => {
                *(if values[*input] >= 0.0 { at_least_0 } else { below_0 })
            }
            Law::DeadZone { input, width } => beyond(values[*input], width.value(values)),
            Law::Function(function, argument) => {
                let argument = argument.value(values);
                function.apply(argument, argument)
            }
            Law::Curve { points, input } => interpolated(points, input.value(values)),
        }
    }

    /// What must be 0 for the present value of an unknown: its sum, or the difference between its law and its value.
    pub(super) fn residual(&self, node: usize, values: &[f64]) -> f64 {
        match self {
            Law::Zero(sum) => total(sum, values),
            _ => self.value(node, values) - values[node],
        }
    }
}

/// A number between bounds. NaN stays NaN.
fn limited(number: f64, lower: f64, upper: f64) -> f64 {
    if number < lower {
        lower
    } else if number > upper {
        upper
    } else {
        number
    }
}

/// The distance of a number from the zone -width ... width, with its sign. NaN stays NaN.
fn beyond(number: f64, width: f64) -> f64 {
    if number > width {
        number - width
    } else if number < -width {
        number + width
    } else {
        0.0 * number
    }
}
