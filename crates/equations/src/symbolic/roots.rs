//! Values at which several expressions are 0, by Newton's method.

use super::derivative::partial_derivative;
use super::evaluate::{Values, ZERO_SHARE, term_size, value};
use super::fraction::Fraction;
use super::linear_system::linear_solution;
use super::symbol::Symbol;

/// Steps at most.
const MAX_STEPS: usize = 50;

/// Expressions with as many unknowns.
#[derive(Debug)]
pub(crate) struct Roots {
    unknowns: Vec<Symbol>,
    expressions: Vec<Fraction>,
    /// The derivatives of each expression, as a row, with respect to the unknowns.
    slopes: Vec<Vec<Fraction>>,
}

impl Roots {
    /// The expressions that are 0, and their unknowns.
    pub(crate) fn new(unknowns: Vec<Symbol>, expressions: Vec<Fraction>) -> Self {
        let row = |expression: &Fraction| -> Vec<Fraction> {
            unknowns.iter().map(|symbol| partial_derivative(expression, *symbol)).collect()
        };
        let slopes = expressions.iter().map(row).collect();
        Roots { unknowns, expressions, slopes }
    }

    /// The unknowns.
    pub(crate) fn unknowns(&self) -> &[Symbol] {
        &self.unknowns
    }

    /// The expressions.
    pub(crate) fn expressions(&self) -> &[Fraction] {
        &self.expressions
    }

    /// The values of the unknowns at which all expressions are 0, by steps from a start. `values` has all other
    /// quantities. `None` if the steps do not end.
    pub(crate) fn near(&self, start: Vec<f64>, values: &dyn Values) -> Option<Vec<f64>> {
        let mut trial = start;
        for _ in 0..MAX_STEPS {
            let at = self.with(&trial, values);
            let sums: Vec<f64> = self.expressions.iter().map(|expression| value(expression, &at)).collect();
            let is_zero =
                |(expression, sum): (&Fraction, &f64)| sum.abs() <= ZERO_SHARE * term_size(expression, &at);
            if self.expressions.iter().zip(&sums).all(is_zero) {
                return Some(trial);
            }
            let step = linear_solution(&self.matrix(&trial, values), sums)?;
            trial.iter_mut().zip(step).for_each(|(value, step)| *value -= step);
            if trial.iter().any(|value| !value.is_finite()) {
                return None;
            }
        }
        None
    }

    /// Whether the expressions determine the unknowns near these values: the matrix of derivatives is regular.
    pub(crate) fn is_regular(&self, trial: &[f64], values: &dyn Values) -> bool {
        linear_solution(&self.matrix(trial, values), vec![0.0; trial.len()]).is_some()
    }

    /// All quantities, with these values of the unknowns.
    pub(crate) fn with<'t>(&'t self, trial: &'t [f64], values: &'t dyn Values) -> TrialValues<'t> {
        TrialValues::new(&self.unknowns, trial, values)
    }

    /// The derivatives at these values of the unknowns, by rows.
    fn matrix(&self, trial: &[f64], values: &dyn Values) -> Vec<Vec<f64>> {
        let at = self.with(trial, values);
        let row = |row: &Vec<Fraction>| -> Vec<f64> { row.iter().map(|slope| value(slope, &at)).collect() };
        self.slopes.iter().map(row).collect()
    }
}

/// The values of all quantities: trial values of unknowns, and those that are known.
pub(crate) struct TrialValues<'t> {
    unknowns: &'t [Symbol],
    trial: &'t [f64],
    values: &'t dyn Values,
}

impl<'t> TrialValues<'t> {
    /// The quantities of `values`, with trial values of the unknowns.
    pub(crate) fn new(unknowns: &'t [Symbol], trial: &'t [f64], values: &'t dyn Values) -> Self {
        TrialValues { unknowns, trial, values }
    }
}

impl Values for TrialValues<'_> {
    fn symbol(&self, symbol: Symbol) -> f64 {
        let index = self.unknowns.iter().position(|unknown| *unknown == symbol);
        index.map_or_else(|| self.values.symbol(symbol), |index| self.trial[index])
    }

    fn table(&self, table: u32, at: f64) -> f64 {
        self.values.table(table, at)
    }

    fn slope(&self, table: u32, at: f64) -> f64 {
        self.values.slope(table, at)
    }

    fn delayed(&self, expression: &Fraction, time: f64) -> f64 {
        self.values.delayed(expression, time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::reading::read;
    use crate::testing::{Point, symbol};

    /// The values of the quantities x, y, z, p and q.
    const POINT: Point = Point([0.7, -0.3, 0.0, 2.0, 5.0]);

    #[test]
    fn the_root_near_a_start_is_found() {
        // sin(z) = p/4 = 1/2 at pi/6 and 5 pi/6.
        let roots = Roots::new(vec![symbol("z")], vec![read("sin(z) - p/4")]);
        for (start, turn) in [(0.1, 1.0 / 6.0), (3.0, 5.0 / 6.0)] {
            let found = roots.near(vec![start], &POINT).unwrap();
            assert!((found[0] - turn * std::f64::consts::PI).abs() < 1e-12, "{found:?}");
            assert!(roots.is_regular(&found, &POINT));
        }
        let none = Roots::new(vec![symbol("z")], vec![read("z^2 + p")]);
        assert_eq!(none.near(vec![1.0], &POINT), None);
        let double = Roots::new(vec![symbol("z")], vec![read("p z^2")]);
        assert_eq!(double.near(vec![0.0], &POINT), Some(vec![0.0]));
        assert!(!double.is_regular(&[0.0], &POINT) && double.is_regular(&[0.1], &POINT));
    }

    #[test]
    fn several_expressions_have_a_common_root() {
        // x y = p and x + y = 3 at x = 1 and y = 2.
        let roots = Roots::new(["x", "y"].map(symbol).to_vec(), vec![read("x y - p"), read("x + y - 3")]);
        let found = roots.near(vec![0.5, 3.0], &POINT).unwrap();
        assert!((found[0] - 1.0).abs() < 1e-12 && (found[1] - 2.0).abs() < 1e-12, "{found:?}");
    }
}
