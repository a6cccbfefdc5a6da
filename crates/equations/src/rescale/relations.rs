//! Linear equations between the logarithms of factors, solved as they are added.

use std::collections::BTreeMap;

/// A coefficient or a constant below this size is rounding.
const ROUNDING: f64 = 1e-9;

/// A linear expression of unknowns.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Affine {
    pub constant: f64,
    /// The coefficients by unknown. None of them is 0.
    pub terms: BTreeMap<usize, f64>,
}

impl Affine {
    /// An unknown alone.
    pub(super) fn unknown(index: usize) -> Self {
        Affine { constant: 0.0, terms: BTreeMap::from([(index, 1.0)]) }
    }

    /// The sum of coefficient x unknown.
    pub(super) fn sum(terms: &[(usize, f64)]) -> Self {
        let start = Affine::default();
        terms.iter().fold(start, |sum, (index, factor)| sum.plus(&Affine::unknown(*index), *factor))
    }

    /// The same expression with a number added.
    pub(super) fn plus_constant(mut self, number: f64) -> Self {
        self.constant += number;
        self
    }

    /// The sum of this expression and `factor` x another one.
    pub(super) fn plus(mut self, other: &Affine, factor: f64) -> Self {
        self.constant += factor * other.constant;
        for (index, coefficient) in &other.terms {
            let own = self.terms.entry(*index).or_insert(0.0);
            *own += factor * coefficient;
            if own.abs() < ROUNDING {
                self.terms.remove(index);
            }
        }
        self
    }

    /// The value for these values of the unknowns.
    pub(super) fn value(&self, values: &[f64]) -> f64 {
        self.constant
            + self.terms.iter().map(|(index, coefficient)| coefficient * values[*index]).sum::<f64>()
    }
}

/// Equations between unknowns, in solved form.
#[derive(Debug, Clone)]
pub(super) struct Relations {
    /// For each unknown that is determined by others: its expression in unknowns that are not.
    solved: Vec<Option<Affine>>,
    /// The rank of each unknown. Of two unknowns, that with the larger rank stays free.
    ranks: Vec<u32>,
}

impl Relations {
    /// Unknowns with these ranks, without equations.
    pub(super) fn new(ranks: Vec<u32>) -> Self {
        Relations { solved: vec![None; ranks.len()], ranks }
    }

    /// An expression in free unknowns.
    pub(super) fn reduced(&self, expression: &Affine) -> Affine {
        let start = Affine { constant: expression.constant, terms: BTreeMap::new() };
        expression.terms.iter().fold(start, |sum, (index, factor)| match &self.solved[*index] {
            Some(own) => sum.plus(own, *factor),
            None => sum.plus(&Affine::unknown(*index), *factor),
        })
    }

    /// Adds the equation that an expression is 0. Returns whether it agrees with the earlier ones; otherwise it is not
    /// added.
    #[must_use]
    pub(super) fn require(&mut self, expression: &Affine) -> bool {
        let reduced = self.reduced(expression);
        let lowest = reduced.terms.iter().min_by_key(|(index, _)| (self.ranks[**index], **index));
        let Some((pivot, coefficient)) = lowest.map(|(index, coefficient)| (*index, *coefficient)) else {
            return reduced.constant.abs() < ROUNDING;
        };
        // pivot = -(rest) / coefficient
        let rest = reduced.plus(&Affine::unknown(pivot), -coefficient);
        let solution = Affine::default().plus(&rest, -1.0 / coefficient);
        for own in self.solved.iter_mut().flatten() {
            if let Some(factor) = own.terms.remove(&pivot) {
                *own = std::mem::take(own).plus(&solution, factor);
            }
        }
        self.solved[pivot] = Some(solution);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved_for_unknowns_of_low_rank() {
        let mut relations = Relations::new(vec![1, 0, 2]);
        // a = 2 b, and b = c + 1
        assert!(relations.require(&Affine::sum(&[(0, 1.0), (1, -2.0)])));
        assert!(relations.require(&Affine::sum(&[(1, 1.0), (2, -1.0)]).plus_constant(-1.0)));
        let a = relations.reduced(&Affine::unknown(0));
        assert_eq!(a, Affine { constant: 2.0, terms: BTreeMap::from([(2, 2.0)]) });
        let b = relations.reduced(&Affine::unknown(1));
        assert_eq!((b.value(&[0.0, 0.0, 3.0]), a.value(&[0.0, 0.0, 3.0])), (4.0, 8.0));
    }

    #[test]
    fn an_equation_that_contradicts_earlier_ones_is_not_added() {
        let mut relations = Relations::new(vec![0, 0]);
        assert!(relations.require(&Affine::sum(&[(0, 1.0), (1, -1.0)])));
        assert!(relations.require(&Affine::sum(&[(0, 3.0), (1, -3.0)])));
        assert!(!relations.require(&Affine::sum(&[(0, 1.0), (1, -1.0)]).plus_constant(1.0)));
        assert_eq!(relations.reduced(&Affine::sum(&[(0, 1.0), (1, -1.0)])), Affine::default());
    }

    #[test]
    fn an_unknown_that_occurs_twice_has_both_coefficients() {
        assert_eq!(Affine::sum(&[(0, -1.0), (0, -1.0)]).terms, BTreeMap::from([(0, -2.0)]));
        assert!(Affine::sum(&[(0, 1.0), (0, -1.0)]).terms.is_empty());
    }
}
