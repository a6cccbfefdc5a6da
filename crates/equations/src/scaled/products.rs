//! Products of numbers and expressions, written with one number in front.

use patchcord_expr::Unit;

use crate::notation::Notation;

/// A number with its sign.
pub(super) fn number(value: f64) -> Notation {
    signed(value, Notation::Number { value: value.abs(), unit: None })
}

/// A value in SI units as a number with this unit.
pub(super) fn with_unit(value: f64, unit: &Unit) -> Notation {
    let text = (unit.text() != "1").then(|| unit.text().to_owned());
    signed(value, Notation::Number { value: unit.out_of_si(value.abs()), unit: text })
}

/// An expression with the sign of a number.
fn signed(sign: f64, magnitude: Notation) -> Notation {
    if sign < 0.0 { negated(magnitude) } else { magnitude }
}

/// An expression with the opposite sign.
pub(super) fn negated(notation: Notation) -> Notation {
    match notation {
        Notation::Negative(operand) => *operand,
        other => Notation::Negative(Box::new(other)),
    }
}

/// An expression as a number times the rest. The rest of a number is the product of nothing.
fn split(notation: Notation) -> (f64, Notation) {
    match notation {
        Notation::Negative(operand) => {
            let (factor, rest) = split(*operand);
            (-factor, rest)
        }
        Notation::Number { value, unit: None } => (value, Notation::Product(Vec::new())),
        Notation::Product(mut factors) => match factors.first() {
            Some(Notation::Number { value, unit: None }) => {
                let value = *value;
                factors.remove(0);
                (value, Notation::Product(factors))
            }
            _ => (1.0, Notation::Product(factors)),
        },
        other => (1.0, other),
    }
}

/// The factors of an expression.
fn factors(notation: Notation) -> Vec<Notation> {
    match notation {
        Notation::Product(factors) => factors,
        other => vec![other],
    }
}

/// The product of factors. A product of one factor is that factor.
fn joined(mut factors: Vec<Notation>) -> Notation {
    match factors.pop() {
        Some(only) if factors.is_empty() => only,
        Some(last) => {
            factors.push(last);
            Notation::Product(factors)
        }
        None => number(1.0),
    }
}

/// A number times an expression. The number multiplies one that the expression has, also that of a dividend.
pub(super) fn times(factor: f64, notation: Notation) -> Notation {
    if let Notation::Quotient(top, bottom) = notation {
        return quotient(times(factor, *top), *bottom);
    }
    let (own, rest) = split(notation);
    let value = factor * own;
    let rest = factors(rest);
    let is_needed = value.abs() != 1.0 || rest.is_empty();
    let first = is_needed.then(|| number(value.abs()));
    signed(value, joined(first.into_iter().chain(rest).collect()))
}

/// The product of two expressions.
pub(super) fn product(left: Notation, right: Notation) -> Notation {
    let ((one, left), (other, right)) = (split(left), split(right));
    times(one * other, joined(factors(left).into_iter().chain(factors(right)).collect()))
}

/// The square of an expression.
pub(super) fn square(base: Notation) -> Notation {
    let (factor, rest) = split(base);
    times(factor * factor, Notation::Power(Box::new(joined(factors(rest))), Box::new(number(2.0))))
}

/// The quotient of two expressions. Its sign is in front.
pub(super) fn quotient(top: Notation, bottom: Notation) -> Notation {
    match (top, bottom) {
        (Notation::Negative(top), bottom) => negated(quotient(*top, bottom)),
        (top, Notation::Negative(bottom)) => negated(quotient(top, *bottom)),
        (top, bottom) => Notation::Quotient(Box::new(top), Box::new(bottom)),
    }
}

/// A value in SI units per volt, as a number with a unit, times a voltage.
pub(super) fn times_with_unit(value: f64, unit: &Unit, voltage: Notation) -> Notation {
    let (factor, rest) = split(voltage);
    let value = value * factor;
    if unit.text() == "1" {
        return times(unit.out_of_si(value), joined(factors(rest)));
    }
    let all = [with_unit(value.abs(), unit)].into_iter().chain(factors(rest));
    signed(value, joined(all.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::notation::text;

    /// The name of a quantity.
    fn name(name: &str) -> Notation {
        Notation::Name { name: name.to_owned(), primes: 0 }
    }

    #[test]
    fn a_product_has_one_number_and_one_sign_in_front() {
        let half_x = || times(0.5, name("x"));
        let sum = Notation::Sum(vec![name("x"), number(3.0)]);
        let cases = [
            (times(1.0, name("x")), "x"),
            (times(-1.0, name("x")), "-x"),
            (times(2.0, number(-3.0)), "-6"),
            (times(-4.0, negated(half_x())), "2 x"),
            (times(2.0, half_x()), "x"),
            (times(3.0, sum.clone()), "3 (x + 3)"),
            (times(3.0, quotient(half_x(), number(100.0))), "1.5 x/100"),
            (product(times(-2.0, name("x")), half_x()), "-x x"),
            (product(half_x(), sum.clone()), "0.5 x (x + 3)"),
            (product(number(2.0), number(3.0)), "6"),
            (square(times(-3.0, name("x"))), "9 x^2"),
            (square(sum), "(x + 3)^2"),
            (quotient(times(-2.0, name("x")), times(-3.0, name("y"))), "2 x/(3 y)"),
        ];
        for (notation, expected) in cases {
            assert_eq!(text(&notation), expected);
        }
    }

    #[test]
    fn a_number_with_a_unit_is_a_factor_of_its_own() {
        let [millimetre, pure] = ["mm", "1"].map(|unit| Unit::parse(unit).unwrap());
        let cases = [
            (with_unit(0.25, &millimetre), "250 mm"),
            (with_unit(-0.25, &pure), "-0.25"),
            (times_with_unit(4e-4, &millimetre, times(-0.5, name("x"))), "-(0.2 mm) x"),
            (times_with_unit(0.5, &pure, times(3.0, name("x"))), "1.5 x"),
        ];
        for (notation, expected) in cases {
            assert_eq!(text(&crate::notation::rounded(&notation, 12)), expected);
        }
    }
}
