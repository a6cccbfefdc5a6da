//! The dimensions of expressions.

use num_traits::{One as _, Signed as _};
use patchcord_expr::{Dimension, Function};

use super::Writer;
use crate::symbolic::{
    Application, Atom, CallOrder, Fraction, Monomial, Operation, Polynomial, Rational, nearest,
};

impl Writer<'_> {
    /// The dimension of a product.
    pub(super) fn product_dimension(&self, product: &Monomial) -> Dimension {
        let powers = product
            .factors()
            .iter()
            .map(|(atom, exponent)| self.factor_dimension(atom).power(f64::from(*exponent)));
        powers.fold(Dimension::NONE, Dimension::times)
    }

    /// The dimension of an expression: that of a term with a variable, because the numbers of the others may have
    /// units. `None` for a number.
    pub(crate) fn dimension(&self, fraction: &Fraction) -> Option<Dimension> {
        let top = self.sum_dimension(fraction.numerator())?;
        let divisors = fraction.divisors().map(|(divisor, power)| {
            self.sum_dimension(divisor).unwrap_or(Dimension::NONE).power(f64::from(power))
        });
        Some(divisors.fold(top, Dimension::over))
    }

    /// The dimension of a sum; `None` for a number.
    ///
    /// Of the dimensions of its terms with variables, it is the one with which the fewest numbers get a unit, so that
    /// `t - 0.1 floor(10 t)` is a time. Without variables, it is that of the first term.
    pub(super) fn sum_dimension(&self, sum: &Polynomial) -> Option<Dimension> {
        let terms = || sum.terms().filter(|(product, _)| !product.is_one());
        let with_variable: Vec<(Dimension, &Rational)> = terms()
            .filter(|(product, _)| !product.is_constant())
            .map(|(product, number)| (self.product_dimension(product), number))
            .collect();
        let mut dimensions: Vec<Dimension> = Vec::new();
        for (dimension, _) in &with_variable {
            if !dimensions.contains(dimension) {
                dimensions.push(*dimension);
            }
        }
        let fewest = dimensions.into_iter().min_by_key(|dimension| unit_count(&with_variable, *dimension));
        fewest.or_else(|| terms().next().map(|(product, _)| self.product_dimension(product)))
    }

    /// The dimension of a factor. Tables read and give volts, except tables of time.
    fn factor_dimension(&self, atom: &Atom) -> Dimension {
        let dimension = match atom {
            Atom::Symbol(symbol) => self.system.symbols.entry(*symbol).dimension,
            Atom::Apply(applied) => self.applied_dimension(applied),
        };
        self.purity.reduced(dimension)
    }

    /// The dimension of a function.
    fn applied_dimension(&self, applied: &Application) -> Dimension {
        let first = || self.dimension(&applied.arguments[0]).unwrap_or(Dimension::NONE);
        match applied.operation {
            Operation::Absolute
            | Operation::Delay
            | Operation::Minimum
            | Operation::Maximum
            | Operation::Limit
            | Operation::Group => first(),
            Operation::Call(CallOrder(Function::Sqrt)) => first().power(0.5),
            Operation::Call(CallOrder(Function::Power)) => {
                let exponent = applied.arguments[1].as_rational();
                exponent.map_or(Dimension::NONE, |exponent| first().power(nearest(&exponent)))
            }
            Operation::Table(table) => {
                let unit = self.system.tables[table as usize].unit.as_ref();
                unit.map_or(Dimension::VOLTAGE, |unit| unit.dimension)
            }
            Operation::Step | Operation::Sign | Operation::Call(_) | Operation::TableSlope(_) => {
                Dimension::NONE
            }
        }
    }

    /// The dimension that an argument of a function must have; `None` if any is right.
    pub(super) fn argument_dimension(&self, applied: &Application, index: usize) -> Option<Dimension> {
        match applied.operation {
            Operation::Table(table) | Operation::TableSlope(table) => {
                let dimension = if self.is_time_table(table) { Dimension::TIME } else { Dimension::VOLTAGE };
                Some(self.purity.reduced(dimension))
            }
            Operation::Delay if index == 1 => Some(self.purity.reduced(Dimension::TIME)),
            Operation::Call(CallOrder(Function::Sqrt)) => self.dimension(&applied.arguments[0]),
            Operation::Call(CallOrder(Function::Power)) if index == 0 => {
                self.dimension(&applied.arguments[0])
            }
            Operation::Call(CallOrder(Function::Atan2))
            | Operation::Minimum
            | Operation::Maximum
            | Operation::Limit => applied.arguments.iter().find_map(|argument| self.dimension(argument)),
            Operation::Call(_) => Some(Dimension::NONE),
            Operation::Absolute | Operation::Step | Operation::Sign | Operation::Group | Operation::Delay => {
                self.dimension(&applied.arguments[0])
            }
        }
    }
}

/// The cost of a dimension for a sum of these terms: the number of terms that get a unit, and of those that need a
/// number 1 for it.
fn unit_count(terms: &[(Dimension, &Rational)], dimension: Dimension) -> usize {
    let others = terms.iter().filter(|(of_term, _)| *of_term != dimension);
    others.map(|(_, number)| 1 + usize::from(number.abs().is_one())).sum()
}
