//! Unit tests of the notation, and short constructors for expressions.

mod latex;
mod round_trip;
mod text;

use super::{Comparison, Condition, EquationDocument, Notation, Relation, WrittenEquation};

/// A pure number.
fn number(value: f64) -> Notation {
    Notation::Number { value, unit: None }
}

/// A number with a unit.
fn measured(value: f64, unit: &str) -> Notation {
    Notation::Number { value, unit: Some(unit.to_owned()) }
}

/// A quantity. The primes after its name are derivatives.
fn name(text: &str) -> Notation {
    let name = text.trim_end_matches('\'');
    let primes = u8::try_from(text.len() - name.len()).unwrap();
    Notation::Name { name: name.to_owned(), primes }
}

fn negative(operand: Notation) -> Notation {
    Notation::Negative(Box::new(operand))
}

fn sum<const N: usize>(terms: [Notation; N]) -> Notation {
    Notation::Sum(terms.into())
}

fn product<const N: usize>(factors: [Notation; N]) -> Notation {
    Notation::Product(factors.into())
}

fn quotient(numerator: Notation, denominator: Notation) -> Notation {
    Notation::Quotient(Box::new(numerator), Box::new(denominator))
}

fn power(base: Notation, exponent: Notation) -> Notation {
    Notation::Power(Box::new(base), Box::new(exponent))
}

fn call<const N: usize>(function: &str, arguments: [Notation; N]) -> Notation {
    Notation::Call(function.to_owned(), arguments.into())
}

fn compare(left: Notation, relation: Relation, right: Notation) -> Comparison {
    Comparison::Compare { left, relation, right }
}

fn words(text: &str) -> Comparison {
    Comparison::Words(text.to_owned())
}

fn equation(left: Notation, right: Notation) -> WrittenEquation {
    WrittenEquation { left, right }
}

/// 1 - x^2
fn one_minus_square() -> Notation {
    sum([number(1.0), negative(power(name("x"), number(2.0)))])
}

/// v' = -(k/m) x - (c/m) v
fn oscillator() -> WrittenEquation {
    let term = |over: &str, state: &str| negative(product([quotient(name(over), name("m")), name(state)]));
    equation(name("v'"), sum([term("k", "x"), term("c", "v")]))
}

/// friction = Fs max(u, 0)^2
fn friction() -> WrittenEquation {
    let square = power(call("max", [name("u"), number(0.0)]), number(2.0));
    equation(name("friction"), product([name("Fs"), square]))
}

/// x' = sigma (y - x)
fn lorenz() -> WrittenEquation {
    equation(name("x'"), product([name("sigma"), sum([name("y"), negative(name("x"))])]))
}

/// memory' = (max(1 - abs(v_o)/VcL, 0) - memory)/Tc
fn memory() -> WrittenEquation {
    let share = quotient(call("abs", [name("v_o")]), name("VcL"));
    let limited = call("max", [sum([number(1.0), negative(share)]), number(0.0)]);
    equation(name("memory'"), quotient(sum([limited, negative(name("memory"))]), name("Tc")))
}

/// v' = mu (1 - x^2) v - x
fn van_der_pol() -> WrittenEquation {
    let damping = product([name("mu"), one_minus_square(), name("v")]);
    equation(name("v'"), sum([damping, negative(name("x"))]))
}

/// The values 0 if x >= 100 and v > 0, and otherwise v - x.
fn limited_rate() -> Notation {
    let is_at_limit = Condition(vec![
        compare(name("x"), Relation::AtLeast, number(100.0)),
        compare(name("v"), Relation::Greater, number(0.0)),
    ]);
    let free = sum([name("v"), negative(name("x"))]);
    Notation::Cases(vec![(number(0.0), Some(is_at_limit)), (free, None)])
}

#[test]
fn a_json_document_has_both_sides_and_both_forms() {
    let document = EquationDocument::from(&van_der_pol());
    let expected = serde_json::json!({
        "left": "v'",
        "right": "mu (1 - x^2) v - x",
        "text": "v' = mu (1 - x^2) v - x",
        "latex": r"\dot{v} = \mu\,\left(1 - x^{2}\right)\,v - x",
    });
    assert_eq!(serde_json::to_value(&document).unwrap(), expected);
}

#[test]
fn the_text_in_a_json_document_is_one_line() {
    let document = EquationDocument::from(&equation(name("y'"), limited_rate()));
    assert_eq!(document.text, "y' = {0 if x >= 100 and v > 0; v - x otherwise}");
    let terms = (0..40).map(|index| name(&format!("term{index}")));
    let long = equation(name("y"), Notation::Sum(terms.collect()));
    assert!(!EquationDocument::from(&long).text.contains('\n'));
}
