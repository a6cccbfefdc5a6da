//! Solves loops without an integrator for the voltages at which they are open.

use std::collections::BTreeMap;

use crate::symbolic::{Atom, Fraction, Symbol, partial_derivative, root};

/// A quantity of a loop with the expression that is 0 at its value.
pub(super) struct Unknown {
    /// The quantity.
    pub of: Symbol,
    /// The expression that is 0.
    pub residual: Fraction,
    /// Whether it is the output of an open amplifier. Its residual rises with the output.
    pub is_open: bool,
}

/// Solves a system by elimination: `Ok` with the value of a quantity, or `Err` with what remains of its residual.
///
/// A value may contain quantities of the system that could not be solved for.
pub(super) fn solve(system: Vec<Unknown>) -> Vec<Result<Fraction, Fraction>> {
    let mut residuals: Vec<Fraction> = system.iter().map(|unknown| unknown.residual.clone()).collect();
    let mut solved: BTreeMap<usize, Fraction> = BTreeMap::new();
    for _ in 0..system.len() {
        let next = (0..system.len()).filter(|index| !solved.contains_key(index)).find_map(|index| {
            let solution = solution(&residuals[index], &system[index])?;
            Some((index, solution))
        });
        let Some((index, solution)) = next else { break };
        let replace = |fraction: &Fraction| {
            fraction.mapped(&mut |symbol| {
                if symbol == system[index].of { solution.clone() } else { Fraction::symbol(symbol) }
            })
        };
        residuals.iter_mut().for_each(|residual| *residual = replace(residual));
        solved.values_mut().for_each(|value| *value = replace(value));
        solved.insert(index, solution);
    }
    let outcome = |(index, residual)| solved.remove(&index).ok_or(residual);
    residuals.into_iter().enumerate().map(outcome).collect()
}

/// The value of a quantity at which its residual is 0: that of a linear equation, or the stable root of a quadratic
/// one. `None` if there is no such formula, or if it would be long.
fn solution(residual: &Fraction, unknown: &Unknown) -> Option<Fraction> {
    linear_solution(residual, unknown.of).or_else(|| quadratic_solution(residual, unknown))
}

/// Longest residual that is solved, in terms.
const LONGEST: usize = 40;

/// The solution if the residual is linear in the quantity.
fn linear_solution(residual: &Fraction, of: Symbol) -> Option<Fraction> {
    if residual.size() > LONGEST {
        return None;
    }
    let slope = partial_derivative(residual, of);
    if slope.is_zero() || slope.contains(&mut |symbol| symbol == of) {
        return None;
    }
    let own = Fraction::symbol(of);
    let value = own.minus(&residual.over(&slope));
    (!value.contains(&mut |symbol| symbol == of)).then_some(value)
}

/// The root at which the residual of an open amplifier rises, if the residual is p + q x^2.
///
/// The root has the sign of q. It is looked for with |x| = x first, because squaring networks give 0 for negative
/// voltages.
fn quadratic_solution(residual: &Fraction, unknown: &Unknown) -> Option<Fraction> {
    if !unknown.is_open || residual.size() > LONGEST {
        return None;
    }
    let positive = Symbol { is_nonnegative: true, ..unknown.of };
    let assumed =
        residual.mapped(&mut |symbol| Fraction::symbol(if symbol == unknown.of { positive } else { symbol }));
    if assumed.divisors().len() > 0 {
        return None;
    }
    let powers = assumed.numerator().by_powers(&Atom::Symbol(positive));
    let is_square = powers.keys().all(|exponent| [0, 2].contains(exponent));
    let factor = powers.get(&2).filter(|factor| is_square && factor.is_nonnegative())?;
    let rest = Fraction::from(powers.get(&0).cloned().unwrap_or_default());
    let value = root(&rest.over(&Fraction::from(factor.clone())).negated());
    (!value.contains(&mut |symbol| symbol.index == unknown.of.index)).then_some(value)
}
