//! Formulas of pots and of initial values with a mistake.

use patchcord_core::patch::Patch;
use patchcord_expr::{Expression, Formula, Node, Operator, round_significant};
use serde_json::{Value, json};

/// Significant digits of a changed number.
const DIGITS: usize = 12;

/// A factor of a formula.
#[derive(Debug, Clone)]
struct Factor {
    /// Its text.
    text: String,
    /// Whether it is in the denominator.
    divides: bool,
}

/// Wrong settings of a pot: times or over 10, a parameter or scale left out, or two of them exchanged between numerator
/// and denominator. `is_name` is whether a text is the name of a parameter or scale, or `time_scale`.
pub(crate) fn wrong_settings(setting: &Value, is_name: impl Fn(&str) -> bool) -> Vec<Value> {
    if let Some(number) = setting.as_f64() {
        return [10.0, 0.1].map(|factor| json!(round_significant(factor * number, DIGITS))).to_vec();
    }
    let Some(formula) = setting.as_str().and_then(|text| Formula::parse(text).ok()) else {
        return Vec::new();
    };
    let factors = factors(&formula);
    let has_name = |index: &usize| {
        let text = &factors[*index].text;
        is_name(text.split('^').next().unwrap_or(text).trim())
    };
    let named: Vec<usize> = (0..factors.len()).filter(has_name).collect();
    let (below, above): (Vec<usize>, Vec<usize>) = named.iter().partition(|index| factors[**index].divides);
    let mut wrong = vec![ten_times(&factors), with_ten(&factors, true)];
    wrong.extend(named.iter().map(|index| without(&factors, *index)));
    for upper in above {
        wrong.extend(below.iter().map(|lower| exchanged(&factors, upper, *lower)));
    }
    wrong.iter().map(|factors| json!(written(factors))).collect()
}

/// The factors of a formula. A sum is one factor.
fn factors(formula: &Formula) -> Vec<Factor> {
    let mut factors = Vec::new();
    collect_factors(formula.root(), formula.text(), false, &mut factors);
    factors
}

/// Adds the factors of a node. `divides` is whether the node is in the denominator.
fn collect_factors(node: &Node, text: &str, divides: bool, factors: &mut Vec<Factor>) {
    match &node.expression {
        Expression::Binary(Operator::Multiply, left, right) => {
            collect_factors(left, text, divides, factors);
            collect_factors(right, text, divides, factors);
        }
        Expression::Binary(Operator::Divide, left, right) => {
            collect_factors(left, text, divides, factors);
            collect_factors(right, text, !divides, factors);
        }
        expression => {
            let written = &text[node.range.clone()];
            let is_sum = matches!(
                expression,
                Expression::Negate(_) | Expression::Binary(Operator::Add | Operator::Subtract, ..)
            );
            let needs_parentheses = is_sum && !written.starts_with('(');
            let text = if needs_parentheses { format!("({written})") } else { written.to_owned() };
            factors.push(Factor { text, divides });
        }
    }
}

/// A formula with these factors.
fn written(factors: &[Factor]) -> String {
    let mut text = String::new();
    for factor in factors {
        text += match (text.is_empty(), factor.divides) {
            (true, false) => "",
            (true, true) => "1 / ",
            (false, false) => " * ",
            (false, true) => " / ",
        };
        text += &factor.text;
    }
    if text.is_empty() { "1".to_owned() } else { text }
}

/// Ten times the factors: without a divisor 10, or with a further factor.
fn ten_times(factors: &[Factor]) -> Vec<Factor> {
    let divisor = factors.iter().position(|factor| factor.divides && factor.text == "10");
    divisor.map_or_else(|| with_ten(factors, false), |index| without(factors, index))
}

/// The factors and a further one of 10.
fn with_ten(factors: &[Factor], divides: bool) -> Vec<Factor> {
    let ten = Factor { text: "10".to_owned(), divides };
    factors.iter().cloned().chain([ten]).collect()
}

/// The factors without one of them.
fn without(factors: &[Factor], index: usize) -> Vec<Factor> {
    let mut factors = factors.to_vec();
    factors.remove(index);
    factors
}

/// The factors with two of them exchanged: one from the numerator and one from the denominator.
fn exchanged(factors: &[Factor], upper: usize, lower: usize) -> Vec<Factor> {
    let mut factors = factors.to_vec();
    factors[upper].divides = true;
    factors[lower].divides = false;
    factors
}

/// Wrong initial values: with the opposite sign, ten times as large, or with another parameter of the same dimension.
/// There are none for 0.
pub(crate) fn wrong_initial_values(patch: &Patch, value: &Value) -> Vec<Value> {
    if let Some(number) = value.as_f64() {
        let wrong = [-1.0, 10.0].map(|factor| json!(round_significant(factor * number, DIGITS)));
        return if number == 0.0 { Vec::new() } else { wrong.to_vec() };
    }
    let Some(text) = value.as_str() else { return Vec::new() };
    let Ok(formula) = Formula::parse(text) else { return Vec::new() };
    let mut wrong = vec![opposite(text), format!("10 * ({text})")];
    for name in formula.names() {
        let found = patch.parameters.get(name).zip(formula.root().find_name(name));
        let Some((parameter, node)) = found else { continue };
        for (other, entry) in &patch.parameters {
            if other != name && entry.unit.dimension() == parameter.unit.dimension() {
                let mut changed = text.to_owned();
                changed.replace_range(node.range.clone(), other);
                wrong.push(changed);
            }
        }
    }
    wrong.into_iter().map(Value::from).collect()
}

/// A formula with the opposite sign.
fn opposite(text: &str) -> String {
    match text.strip_prefix('-') {
        Some(positive) if !positive.contains(['+', '-']) => positive.trim_start().to_owned(),
        _ => format!("-({text})"),
    }
}
