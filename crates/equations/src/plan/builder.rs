//! Makes the nodes of a plan. Equal operations share a node.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Problem;
use patchcord_expr::{Dimension, Scope as _, split_primes};

use super::constants::Constants;
use super::names::ONE_NOTATION;
use crate::graph::{NodeId, ONE, Operation, Sum, Term};
use crate::notation::Notation;
use crate::symbolic::{Fraction, Rational};
use crate::writing::Writer;

/// The nodes of a plan while it is made.
pub(super) struct Builder<'a> {
    /// The problem, for the units of its tables.
    problem: &'a Problem,
    /// The circuit of the problem, for the dimensions of names.
    circuit: &'a Circuit,
    /// The constants of the problem.
    pub constants: &'a Constants,
    /// Writes constants.
    pub writer: Writer<'a>,
    /// The nodes.
    pub entries: Vec<Entry>,
    /// The node of each operation that can be shared.
    known: BTreeMap<Operation, NodeId>,
    /// For sums and quotients divided by their leading number: that number, and the node.
    multiples: BTreeMap<Operation, (Rational, NodeId)>,
    /// The node of problem time. `None` if no equation has used it yet.
    time: Option<NodeId>,
    /// The nodes of angles, each by the two sums of which it is `atan2`.
    pub angles: BTreeMap<[Sum; 2], NodeId>,
}

/// A node while a plan is made.
pub(super) struct Entry {
    /// Its name, as an expression.
    pub notation: Notation,
    /// The dimension of its value.
    pub dimension: Dimension,
    /// Its operation. `None` until the equation of the quantity has been read.
    pub operation: Option<Operation>,
    /// What the name is.
    pub kind: NameKind,
}

/// What the name of a node is. If two names belong to one node, it has that of the greater kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum NameKind {
    /// An expression that an equation contains.
    Expression,
    /// A quantity that only equations name: a derivative or an auxiliary quantity.
    Implied,
    /// A quantity of the problem.
    Declared,
}

impl<'a> Builder<'a> {
    /// A builder with the node of the number 1.
    pub(super) fn new(problem: &'a Problem, circuit: &'a Circuit, constants: &'a Constants) -> Self {
        let (notation, dimension, kind) = (ONE_NOTATION, Dimension::NONE, NameKind::Expression);
        let one = Entry { notation, dimension, operation: Some(Operation::One), kind };
        Builder {
            problem,
            circuit,
            constants,
            writer: Writer::physical(&constants.system),
            entries: vec![one],
            known: BTreeMap::from([(Operation::One, ONE)]),
            multiples: BTreeMap::new(),
            time: None,
            angles: BTreeMap::new(),
        }
    }

    /// A node for the quantity with this name. Its operation follows later.
    pub(super) fn reserve(&mut self, name: &str, kind: NameKind) -> NodeId {
        let (base, primes) = split_primes(name);
        let notation = Notation::Name { name: base.to_owned(), primes: primes as u8 };
        let dimension = self.circuit.equation_dimension(name).unwrap_or(Dimension::NONE);
        self.push(Entry { notation, dimension, operation: None, kind })
    }

    /// A node for a pure number with this name. Its operation follows later.
    pub(super) fn reserve_number(&mut self, notation: Notation) -> NodeId {
        let (dimension, kind) = (Dimension::NONE, NameKind::Expression);
        self.push(Entry { notation, dimension, operation: None, kind })
    }

    /// The node of an operation.
    pub(super) fn add(&mut self, operation: Operation) -> NodeId {
        self.add_as(operation, Self::notation)
    }

    /// The node of an operation. `notation` makes its name if it is new.
    pub(super) fn add_as(
        &mut self,
        operation: Operation,
        notation: impl FnOnce(&Self, &Operation) -> Notation,
    ) -> NodeId {
        if let Some(node) = self.find(&operation) {
            return node;
        }
        let (notation, dimension) = (notation(self, &operation), self.dimension(&operation));
        let kind = NameKind::Expression;
        let node = self.push(Entry { notation, dimension, operation: None, kind });
        self.define(node, operation);
        node
    }

    /// The node that has an operation already.
    pub(super) fn find(&self, operation: &Operation) -> Option<NodeId> {
        self.known.get(operation).copied()
    }

    /// Gives a node its operation. Later equal operations share the node.
    pub(super) fn define(&mut self, node: NodeId, operation: Operation) {
        if operation.is_shareable() {
            self.known.entry(operation.clone()).or_insert(node);
        }
        if let Some((number, key)) = without_number(&operation) {
            self.multiples.entry(key).or_insert((number, node));
        }
        self.entries[node.0 as usize].operation = Some(operation);
    }

    /// A sum as a constant times a node. The sum must not be constant. A node has no sum of negative terms only.
    pub(super) fn factored(&mut self, sum: &Sum) -> Term {
        if let Some(term) = sum.as_term() {
            return term;
        }
        if sum.is_negative() {
            let Term { coefficient, node } = self.multiple(Operation::Sum(sum.negated()));
            return Term { coefficient: coefficient.negated(), node };
        }
        self.multiple(Operation::Sum(sum.clone()))
    }

    /// A sum or a quotient as a constant times a node that exists already, or as a new node.
    pub(super) fn multiple(&mut self, operation: Operation) -> Term {
        let known = without_number(&operation).and_then(|(number, key)| {
            let (own, node) = self.multiples.get(&key)?;
            Some(Term { coefficient: Fraction::rational(number / own), node: *node })
        });
        known.unwrap_or_else(|| Term { coefficient: Fraction::whole(1), node: self.add(operation) })
    }

    /// The node whose value is exactly that of a sum.
    pub(super) fn node_of(&mut self, sum: &Sum) -> NodeId {
        sum.as_node().unwrap_or_else(|| self.add(Operation::Sum(sum.clone())))
    }

    /// Whether a name is that of a drive.
    pub(super) fn is_drive(&self, name: &str) -> bool {
        self.problem.patch.drives.contains_key(name)
    }

    /// The node of a drive.
    pub(super) fn drive(&mut self, name: &str) -> NodeId {
        self.add(Operation::Drive(name.to_owned()))
    }

    /// The node of problem time: the integral of 1 from 0.
    pub(super) fn time(&mut self) -> NodeId {
        if let Some(node) = self.time {
            return node;
        }
        let node = self.reserve("t", NameKind::Expression);
        let rate = Sum::constant(&Fraction::whole(1));
        self.define(node, Operation::Integral { initial: Fraction::zero(), rate });
        self.time = Some(node);
        node
    }

    /// The entry of a node.
    pub(super) fn entry(&self, node: NodeId) -> &Entry {
        &self.entries[node.0 as usize]
    }

    /// Adds an entry.
    fn push(&mut self, entry: Entry) -> NodeId {
        let node = NodeId(self.entries.len() as u32);
        self.entries.push(entry);
        node
    }

    /// The dimension of the value of an operation.
    fn dimension(&self, operation: &Operation) -> Dimension {
        let of = |node: &NodeId| self.entry(*node).dimension;
        match operation {
            Operation::One | Operation::Switch { .. } | Operation::Function { .. } => Dimension::NONE,
            Operation::Drive(name) => self.circuit.equation_dimension(name).unwrap_or(Dimension::NONE),
            Operation::Integral { rate, .. } => {
                self.sum_dimension(rate).times(self.circuit.equation_scope().time())
            }
            Operation::Sum(sum) | Operation::Limited { sum, .. } | Operation::Zero(sum) => {
                self.sum_dimension(sum)
            }
            Operation::Root(sum) => self.sum_dimension(sum).power(0.5),
            Operation::Product([left, right]) => of(left).times(of(right)),
            Operation::Quotient { dividend, divisor } => self.sum_dimension(dividend).over(of(divisor)),
            Operation::Absolute(input)
            | Operation::DeadZone { input, .. }
            | Operation::Delay { input, .. } => of(input),
            Operation::Lower([first, _]) | Operation::Higher([first, _]) => {
                self.term_dimension(first.node, &first.coefficient)
            }
            Operation::Curve { table, .. } => {
                let table = self.problem.tables.get(table);
                table.map_or(Dimension::NONE, |table| table.output_unit.dimension())
            }
        }
    }

    /// The dimension of a sum: that of its first term. Equations whose terms differ have been reported.
    fn sum_dimension(&self, sum: &Sum) -> Dimension {
        let first = sum.terms.first_key_value();
        first.map_or(Dimension::NONE, |(node, coefficient)| self.term_dimension(*node, coefficient))
    }

    /// The dimension of a node times a constant.
    fn term_dimension(&self, node: NodeId, coefficient: &Fraction) -> Dimension {
        let of_coefficient = self.writer.dimension(coefficient).unwrap_or(Dimension::NONE);
        of_coefficient.times(self.entry(node).dimension)
    }
}

/// A sum of several terms or a quotient as a number times an operation whose leading number is 1. `None` for other
/// operations.
fn without_number(operation: &Operation) -> Option<(Rational, Operation)> {
    let sum = match operation {
        Operation::Sum(sum) if sum.terms.len() > 1 => sum,
        Operation::Quotient { dividend, .. } => dividend,
        _ => return None,
    };
    let number = sum.leading_number()?;
    let rest = sum.scaled(&Fraction::rational(number.recip()));
    let key = match operation {
        Operation::Quotient { divisor, .. } => Operation::Quotient { dividend: rest, divisor: *divisor },
        _ => Operation::Sum(rest),
    };
    Some((number, key))
}
