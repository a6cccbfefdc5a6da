//! Expressions with rounded numbers, for readers.

use patchcord_expr::round_significant;

use super::{Comparison, Condition, Notation, WrittenEquation};

/// An expression whose numbers have at most `digits` significant digits. A factor of a product that is then 1 is left
/// out.
pub(crate) fn rounded(notation: &Notation, digits: usize) -> Notation {
    let inside = |inner: &Notation| Box::new(rounded(inner, digits));
    let all = |parts: &[Notation]| parts.iter().map(|part| rounded(part, digits)).collect::<Vec<_>>();
    match notation {
        Notation::Number { value, unit } => {
            Notation::Number { value: round_significant(*value, digits), unit: unit.clone() }
        }
        Notation::Name { .. } => notation.clone(),
        Notation::Negative(operand) => Notation::Negative(inside(operand)),
        Notation::Sum(terms) => Notation::Sum(all(terms)),
        Notation::Product(factors) => {
            Notation::Product(all(factors).into_iter().filter(|factor| !is_one(factor)).collect())
        }
        Notation::Quotient(top, bottom) => Notation::Quotient(inside(top), inside(bottom)),
        Notation::Power(base, exponent) => Notation::Power(inside(base), inside(exponent)),
        Notation::Call(name, arguments) => Notation::Call(name.clone(), all(arguments)),
        Notation::Cases(cases) => {
            let case = |(value, condition): &(Notation, Option<Condition>)| {
                let condition = condition.as_ref().map(|condition| rounded_condition(condition, digits));
                (rounded(value, digits), condition)
            };
            Notation::Cases(cases.iter().map(case).collect())
        }
    }
}

/// An equation with rounded numbers on both sides.
pub(crate) fn rounded_equation(equation: &WrittenEquation, digits: usize) -> WrittenEquation {
    let [left, right] = [&equation.left, &equation.right].map(|side| rounded(side, digits));
    WrittenEquation { left, right }
}

/// A condition with rounded numbers.
pub(crate) fn rounded_condition(condition: &Condition, digits: usize) -> Condition {
    let comparison = |comparison: &Comparison| match comparison {
        Comparison::Compare { left, relation, right } => Comparison::Compare {
            left: rounded(left, digits),
            relation: *relation,
            right: rounded(right, digits),
        },
        Comparison::Words(words) => Comparison::Words(words.clone()),
    };
    Condition(condition.0.iter().map(comparison).collect())
}

/// Whether an expression is the number 1.
pub(crate) fn is_one(notation: &Notation) -> bool {
    matches!(notation, Notation::Number { value, unit: None } if *value == 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::notation::{Relation, text};

    fn number(value: f64) -> Notation {
        Notation::Number { value, unit: None }
    }

    fn x() -> Notation {
        Notation::Name { name: "x".to_owned(), primes: 0 }
    }

    #[test]
    fn numbers_are_rounded_everywhere_and_a_factor_of_1_is_left_out() {
        let product = |factor| Notation::Product(vec![number(factor), x()]);
        let third = 1.0 / 3.0;
        let condition =
            Comparison::Compare { left: product(third), relation: Relation::AtLeast, right: number(third) };
        let cases = Notation::Cases(vec![
            (product(2.0 * third), Some(Condition(vec![condition]))),
            (Notation::Negative(Box::new(number(third))), None),
        ]);
        let quotient = |top, bottom| Notation::Quotient(Box::new(top), Box::new(bottom));
        let expected = [
            (product(1.000_01), "x"),
            (product(third), "0.3333 x"),
            (Notation::Sum(vec![product(third), number(1.0)]), "0.3333 x + 1"),
            (quotient(product(1.0), number(100.0 * third)), "x/33.33"),
            (Notation::Power(Box::new(x()), Box::new(number(2.0 * third))), "x^0.6667"),
            (Notation::Call("sin".to_owned(), vec![product(third)]), "sin(0.3333 x)"),
            (cases, "{0.6667 x if 0.3333 x >= 0.3333; -0.3333 otherwise}"),
        ];
        for (notation, expected) in expected {
            assert_eq!(text(&rounded(&notation, 4)), expected);
        }
    }
}
