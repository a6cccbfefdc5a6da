//! Writes exact expressions in the order and grouping that a reader expects.
//!
//! Terms with equal constant factors are grouped: `sigma (y - x)`. A positive term comes first. Constant factors are
//! written in front: `(k/m) x`. Absolute values become minima and maxima where that is shorter, and choices by a
//! condition become cases.

mod brakes;
mod cases;
mod dimensions;
mod maxima;
mod names;
mod terms;

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_expr::{Dimension, Function};

use crate::derive::System;
use crate::notation::{Notation, WrittenEquation};
use crate::symbolic::{Application, Atom, CallOrder, Fraction, Operation, Symbol, whole};
use names::other_names;

/// Writes the expressions of a system.
pub(crate) struct Writer<'a> {
    /// The system, with the names of all quantities.
    pub system: &'a System,
    /// The dimensions that count as pure numbers.
    purity: Purity,
    /// Whether parameters or quantities are currents, charges or the like, so that units have amperes.
    is_of_circuit: bool,
    /// The written names of the symbols that do not keep their own, by the index of the symbol.
    other_names: BTreeMap<u32, String>,
}

/// The dimensions that count as pure numbers in a patch.
///
/// Its stated equations follow the same rule for times, see [`Circuit::is_time_dimensionless`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purity {
    /// None: the patch has physical units.
    Physical,
    /// Times: no parameter and no scale has a dimension that contains time, other than volts.
    Times,
    /// All: the patch has no units other than volts.
    All,
}

impl Purity {
    /// The purity of a patch.
    fn of(circuit: &Circuit) -> Self {
        let patch = circuit.patch();
        let parameters = patch.parameters.values().map(|parameter| parameter.unit.dimension());
        let scales = patch.scales.values().map(|scale| scale.unit.dimension());
        let is_volts = |dimension: Dimension| dimension.is_dimensionless() || dimension == Dimension::VOLTAGE;
        if parameters.chain(scales).all(is_volts) {
            Purity::All
        } else if circuit.is_time_dimensionless() {
            Purity::Times
        } else {
            Purity::Physical
        }
    }

    /// A dimension without its pure parts.
    fn reduced(self, dimension: Dimension) -> Dimension {
        match self {
            Purity::Physical => dimension,
            Purity::Times => dimension.without_time(),
            Purity::All => Dimension::NONE,
        }
    }
}

impl<'a> Writer<'a> {
    /// A writer for a system that was derived from this circuit.
    pub(crate) fn new(circuit: &Circuit, system: &'a System) -> Self {
        Self::with_purity(system, Purity::of(circuit))
    }

    /// A writer that takes these dimensions as pure numbers.
    fn with_purity(system: &'a System, purity: Purity) -> Self {
        let mut dimensions = system.symbols.entries().map(|(_, entry)| entry.dimension);
        let is_of_circuit = dimensions.any(Dimension::is_of_circuit);
        Writer { system, purity, is_of_circuit, other_names: other_names(&system.symbols) }
    }

    /// A writer for a system in which every dimension is physical: none counts as a pure number.
    pub(crate) fn physical(system: &'a System) -> Self {
        Self::with_purity(system, Purity::Physical)
    }

    /// An expression of this dimension. Numbers that have a dimension are written with their unit in SI. `None` if any
    /// dimension is right.
    pub(crate) fn expression(&self, value: &Fraction, dimension: Option<Dimension>) -> Notation {
        self.cases(value, dimension.map(|dimension| self.purity.reduced(dimension)))
    }

    /// The equation of a quantity that a residual of 0 determines. It cannot be solved for the quantity: the terms with it
    /// are on the left.
    pub(crate) fn implicit(&self, of: Symbol, residual: &Fraction) -> WrittenEquation {
        if residual.is_zero() {
            let zero = self.expression(residual, None);
            return WrittenEquation { left: zero.clone(), right: zero };
        }
        let (_, content, rest) = residual.numerator().clone().into_primitive();
        let unknown = content.only(|atom, _| !atom.is_nonnegative());
        let numerator = Fraction::from(rest.times_term(&unknown, &whole(1)));
        let [left, right] = numerator.split(&mut |product| product.contains(&mut |symbol| symbol == of));
        let dimension = self.dimension(&left);
        let right = right.negated();
        WrittenEquation { left: self.expression(&left, dimension), right: self.expression(&right, dimension) }
    }

    /// The unit in SI of a number of this dimension.
    fn unit_text(&self, dimension: Dimension) -> String {
        match self.is_of_circuit {
            true => dimension.text_in_volts_and_amperes(),
            false => dimension.text_in_volts(),
        }
    }

    /// A quantity, or one of its derivatives.
    pub(crate) fn name(&self, symbol: Symbol) -> Notation {
        let primes = self.system.symbols.entry(symbol).primes;
        Notation::Name { name: self.written_name(symbol).to_owned(), primes }
    }

    /// A factor.
    fn factor(&self, atom: &Atom) -> Notation {
        match atom {
            Atom::Symbol(symbol) => self.name(*symbol),
            Atom::Apply(applied) => self.function(applied),
        }
    }

    /// A function with its arguments.
    fn function(&self, applied: &Application) -> Notation {
        let argument = |(index, argument): (usize, &Fraction)| {
            self.expression(argument, self.argument_dimension(applied, index))
        };
        let mut arguments: Vec<Notation> = applied.arguments.iter().enumerate().map(argument).collect();
        if applied.operation == Operation::Group && arguments.len() == 1 {
            return arguments.remove(0);
        }
        if applied.operation == Operation::Call(CallOrder(Function::Power))
            && let (Some(exponent), Some(base)) = (arguments.pop(), arguments.pop())
        {
            return Notation::Power(Box::new(base), Box::new(exponent));
        }
        Notation::Call(self.function_name(applied.operation), arguments)
    }

    /// Name of a function.
    fn function_name(&self, operation: Operation) -> String {
        match operation {
            Operation::Absolute => "abs".to_owned(),
            Operation::Step => "step".to_owned(),
            Operation::Call(CallOrder(function)) => function.name().to_owned(),
            Operation::Table(table) => self.table_name(table),
            Operation::TableSlope(table) => format!("slope_of_{}", self.table_name(table)),
            Operation::Delay => "delay".to_owned(),
            Operation::Minimum => "min".to_owned(),
            Operation::Maximum => "max".to_owned(),
            Operation::Limit => "limit".to_owned(),
            Operation::Sign => "sign".to_owned(),
            // A group is written without a function.
            Operation::Group => String::new(),
        }
    }

    /// Name of a table as a function.
    pub(crate) fn table_name(&self, table: u32) -> String {
        let prefix = if self.is_time_table(table) { "table" } else { "curve" };
        format!("{prefix}_{}", self.system.tables[table as usize].element)
    }

    /// Whether a table is looked up at time.
    fn is_time_table(&self, table: u32) -> bool {
        self.system.tables[table as usize].unit.is_some()
    }
}

#[cfg(test)]
mod tests;
