//! Delays by constant times. Two of them are equal for given parameters if their times are.

use super::terms::TOLERANCE;
use crate::symbolic::{Atom, Fraction, Operation, Symbol, Values, delay, value};

/// Two expressions in which the constant times of delays are numbers for given parameters. Times that agree are the same
/// number. `None` if there is no delay by a constant time.
pub(super) fn with_delay_times(sides: [&Fraction; 2], parameters: &dyn Values) -> Option<[Fraction; 2]> {
    let mut times = Vec::new();
    let replaced = sides.map(|side| with_times(side, &mut times, parameters));
    (!times.is_empty()).then_some(replaced)
}

/// Two expressions in which variables stand for the values of delays. Delays of one value by one time have one variable.
/// `None` if there is no delay by a constant time, or if there are more delays than variables.
pub(super) fn with_delay_variables(
    sides: [&Fraction; 2],
    parameters: &dyn Values,
    variables: &[Symbol],
) -> Option<[Fraction; 2]> {
    let sides = with_delay_times(sides, parameters)?;
    let (mut known, mut is_complete) = (Vec::new(), true);
    let replaced = sides.map(|side| {
        side.with_factors(&mut |atom| {
            let Atom::Apply(applied) = atom else { return None };
            if applied.operation != Operation::Delay {
                return None;
            }
            let index = known.iter().position(|other| *other == *applied).unwrap_or_else(|| {
                known.push(applied.clone());
                known.len() - 1
            });
            is_complete &= index < variables.len();
            variables.get(index).map(|variable| Fraction::symbol(*variable))
        })
    });
    is_complete.then_some(replaced)
}

/// An expression in which the constant times of delays are numbers. `times` are those that occurred before.
fn with_times(expression: &Fraction, times: &mut Vec<f64>, parameters: &dyn Values) -> Fraction {
    expression.with_factors(&mut |atom| {
        let Atom::Apply(applied) = atom else { return None };
        let (Operation::Delay, [delayed, time]) = (applied.operation, applied.arguments.as_slice()) else {
            return None;
        };
        if !time.is_constant() {
            return None;
        }
        let seconds = known_time(value(time, parameters), times);
        let delayed = with_times(delayed, times, parameters);
        Some(delay(&delayed, &Fraction::number(seconds)))
    })
}

/// The first time that agrees with this one; it is added if there is none.
fn known_time(seconds: f64, times: &mut Vec<f64>) -> f64 {
    let is_same = |other: &&f64| (seconds - **other).abs() <= TOLERANCE * other.abs();
    if let Some(known) = times.iter().find(is_same) {
        return *known;
    }
    times.push(seconds);
    seconds
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Point;
    use crate::testing::reading::read;

    /// Whether two expressions are equal with the times for p = 2 and q = 5.
    fn are_equal(first: &str, second: &str) -> bool {
        let parameters = Point([0.0, 0.0, 0.0, 2.0, 5.0]);
        let sides = [first, second].map(read);
        let [one, other] = with_delay_times([&sides[0], &sides[1]], &parameters).unwrap();
        one == other
    }

    #[test]
    fn delays_by_equal_times_are_equal() {
        assert!(are_equal("delay(x, p)", "delay(x, 2)"));
        assert!(are_equal("y - q delay(x^2, p/q)", "y - q delay(x^2, 0.4)"));
        assert!(are_equal("delay(delay(x, p) y, q)", "delay(delay(x, 2.001) y, 5)"));
        assert!(!are_equal("delay(x, p)", "delay(x, 2.01)"));
        assert!(!are_equal("delay(x, p)", "delay(y, 2)"));
        assert!(!are_equal("delay(x, p)", "2 delay(x, 2)"));
    }

    #[test]
    fn delays_by_times_that_vary_stay() {
        let sides = ["x y", "delay(x, y)"].map(read);
        assert_eq!(with_delay_times([&sides[0], &sides[1]], &Point([0.0; 5])), None);
    }
}
