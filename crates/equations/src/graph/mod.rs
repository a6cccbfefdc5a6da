//! The graph of a plan: which operations compute the quantities of a problem, without scales, signs and gains.
//!
//! A plan is a graph of [`Node`]s. Each node is a physical quantity in SI units that some part of the machine computes
//! from other nodes. `sums` calculates with weighted sums of nodes, `operation` reads and replaces the nodes of an
//! operation, and `constants` has the values of coefficients.

mod constants;
mod operation;
mod sums;

use std::collections::BTreeMap;

use patchcord_expr::{Dimension, Function};

pub(crate) use constants::ConstantValues;
pub(crate) use sums::ONE;

use crate::symbolic::{Fraction, Symbols};

/// The index of a node in [`Plan::nodes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct NodeId(pub u32);

/// The graph of operations that solves a problem.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    /// The parameters of the coefficients. The values of all expressions are in SI units.
    pub symbols: Symbols,
    /// The nodes. The first one is [`Operation::One`]. A node can use later nodes, because loops are possible.
    pub nodes: Vec<Node>,
    /// The node of each quantity: those of the problem in its order, then the derivatives and auxiliary quantities that
    /// only the equations name. Derivatives have primes in their names. An auxiliary quantity that is constant has no
    /// node: the coefficients contain its value.
    pub quantities: Vec<PlannedQuantity>,
}

/// A quantity of the problem, or a derivative of one, as a node.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PlannedQuantity {
    /// Its name with primes, such as x or x'.
    pub name: String,
    /// Its node.
    pub node: NodeId,
}

/// A quantity that a part of the machine computes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Node {
    /// A name for the reader: that of the quantity of the problem, or an expression such as "1 - x^2".
    pub name: String,
    /// The dimension of its value.
    pub dimension: Dimension,
    /// How it is computed.
    pub operation: Operation,
}

/// The operation of a node.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Operation {
    /// The number 1: the reference voltage.
    One,
    /// A drive of the problem, with its name.
    Drive(String),
    /// An integrator: the integral of a sum over problem time.
    Integral {
        /// The value at the start.
        initial: Fraction,
        /// The derivative.
        rate: Sum,
    },
    /// A weighted sum: a summer, or a pot if it is a share of one node.
    Sum(Sum),
    /// A weighted sum that is limited to constant bounds, at least one of which is given: a summer with diodes.
    Limited {
        /// The value between the bounds.
        sum: Sum,
        /// The lower bound.
        lower: Option<Fraction>,
        /// The upper bound.
        upper: Option<Fraction>,
    },
    /// The product of two nodes, which may be the same.
    Product([NodeId; 2]),
    /// A sum over a node that is never 0 in a run: an open amplifier with a multiplier in its feedback.
    Quotient {
        /// The dividend.
        dividend: Sum,
        /// The divisor.
        divisor: NodeId,
    },
    /// The square root of a sum that is never negative: an open amplifier with a square in its feedback.
    Root(Sum),
    /// The value y for which a sum is 0. The sum contains this node, or nodes that depend on it, and rises with y: an
    /// open amplifier.
    Zero(Sum),
    /// The absolute value: an inverter and a diode pair.
    Absolute(NodeId),
    /// The lower of two weighted nodes: a diode pair. The coefficients are positive.
    Lower([Term; 2]),
    /// The higher of two weighted nodes: a diode pair. The coefficients are positive.
    Higher([Term; 2]),
    /// One of two constants by the sign of a node: a comparator.
    Switch {
        /// The node that is compared with 0.
        input: NodeId,
        /// The value while the input is 0 or more.
        at_least_0: Fraction,
        /// The value while the input is below 0.
        below_0: Fraction,
    },
    /// 0 while |input| <= width, otherwise the distance from the zone: free pots and diodes.
    DeadZone {
        /// The input.
        input: NodeId,
        /// The half width, which is positive.
        width: Term,
    },
    /// A function of a weighted node: a function generator.
    Function {
        /// The function.
        kind: FunctionKind,
        /// The argument, a pure number or an angle in radians.
        argument: Term,
    },
    /// A curve of straight segments through points: a function generator.
    Curve {
        /// The name of the table of the problem.
        table: String,
        /// The abscissa.
        input: Term,
    },
    /// The value of a node some time ago, and its initial value before the run: a delay line.
    Delay {
        /// The delayed node.
        input: NodeId,
        /// The delay in problem seconds.
        time: Fraction,
        /// The value until the first input arrives.
        initial: Fraction,
    },
}

/// A function that a function generator computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum FunctionKind {
    /// The sine of an angle in radians.
    Sin,
    /// The cosine of an angle in radians.
    Cos,
    /// The exponential function.
    Exp,
    /// The natural logarithm.
    Ln,
}

impl FunctionKind {
    /// The function of numbers that the function generator computes.
    pub(crate) fn function(self) -> Function {
        match self {
            FunctionKind::Sin => Function::Sin,
            FunctionKind::Cos => Function::Cos,
            FunctionKind::Exp => Function::Exp,
            FunctionKind::Ln => Function::Ln,
        }
    }
}

/// A weighted sum of nodes, each of which occurs once. The constant is the coefficient of [`Operation::One`].
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub(crate) struct Sum {
    /// The coefficient of each node. No coefficient is the number 0. All are constant in a run.
    pub terms: BTreeMap<NodeId, Fraction>,
}

/// A node times a constant.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Term {
    /// The constant factor, which is not 0.
    pub coefficient: Fraction,
    /// The node.
    pub node: NodeId,
}

impl Plan {
    /// The node with this index.
    pub(crate) fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.0 as usize]
    }

    /// The indices of all nodes.
    pub(crate) fn ids(&self) -> impl Iterator<Item = NodeId> + use<> {
        (0..self.nodes.len() as u32).map(NodeId)
    }
}
