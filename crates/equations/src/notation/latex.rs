//! Expressions and equations as LaTeX. A document needs the package amsmath for them, and a page `MathJax`.

use patchcord_expr::format_significant;

use super::symbols::{MAX_DOTS, function_latex, quantity_latex, unit_latex, words_latex};
use super::text::EXACT_DIGITS;
use super::{Comparison, Condition, Notation, Precedence, Relation, WrittenEquation, signed_terms};

/// Returns an expression in LaTeX, for the inside of a formula.
#[must_use]
pub fn latex(notation: &Notation) -> String {
    match notation.unwrapped() {
        Notation::Number { value, unit } => number_latex(*value, unit.as_deref()),
        Notation::Name { name, primes } => quantity_latex(name, *primes),
        Notation::Negative(operand) => format!("-{}", grouped(operand, Precedence::Quotient)),
        Notation::Sum(terms) if terms.is_empty() => "0".to_owned(),
        Notation::Sum(terms) => signed_terms(terms, |term| grouped(term, Precedence::Quotient)).join(" "),
        Notation::Product(factors) if factors.is_empty() => "1".to_owned(),
        Notation::Product(factors) => product_latex(factors),
        Notation::Quotient(numerator, denominator) => {
            format!(r"\frac{{{}}}{{{}}}", latex(numerator), latex(denominator))
        }
        Notation::Power(base, exponent) => power_latex(base, exponent),
        Notation::Call(name, arguments) => call_latex(name, arguments),
        Notation::Cases(cases) => cases_latex(cases),
    }
}

/// Returns an equation in LaTeX, for the inside of a formula.
#[must_use]
pub fn equation_latex(equation: &WrittenEquation) -> String {
    format!("{} = {}", latex(&equation.left), latex(&equation.right))
}

/// Returns equations in LaTeX, one on a line and aligned at the sign of equality. Without equations, the text is empty.
#[must_use]
pub fn document(equations: &[WrittenEquation]) -> String {
    aligned(equations.iter().map(|equation| (latex(&equation.left), latex(&equation.right))))
}

/// Returns left and right sides in LaTeX, one equation on a line and aligned at the sign of equality.
pub(crate) fn aligned(sides: impl Iterator<Item = (String, String)>) -> String {
    let lines: Vec<String> = sides.map(|(left, right)| format!("  {left} &= {right}")).collect();
    if lines.is_empty() {
        return String::new();
    }
    format!("\\begin{{align}}\n{}\n\\end{{align}}\n", lines.join(" \\\\\n"))
}

/// Returns the precedence of an expression in LaTeX. A fraction needs no parentheses as a factor.
fn precedence(notation: &Notation) -> Precedence {
    match notation.unwrapped() {
        Notation::Sum(terms) if !terms.is_empty() => Precedence::Sum,
        // The brace of cases is open at the right.
        Notation::Cases(_) => Precedence::Sum,
        Notation::Negative(_) => Precedence::Negation,
        Notation::Number { value, .. } if *value < 0.0 => Precedence::Negation,
        Notation::Number { unit: Some(_), .. } => Precedence::Quotient,
        Notation::Product(factors) if !factors.is_empty() => Precedence::Product,
        Notation::Quotient(..) | Notation::Power(..) => Precedence::Power,
        Notation::Number { value, unit: None } if has_exponent(*value) => Precedence::Power,
        Notation::Name { primes, .. } if *primes > MAX_DOTS => Precedence::Power,
        Notation::Call(name, arguments) if is_raised(name, arguments) => Precedence::Power,
        Notation::Number { .. }
        | Notation::Name { .. }
        | Notation::Sum(_)
        | Notation::Product(_)
        | Notation::Call(..) => Precedence::Atom,
    }
}

/// Returns an expression, in parentheses if its precedence is below `lowest`.
fn grouped(notation: &Notation, lowest: Precedence) -> String {
    let written = latex(notation);
    if precedence(notation) < lowest { in_parentheses(&written) } else { written }
}

/// Puts parentheses of the right height around a part.
fn in_parentheses(part: &str) -> String {
    format!(r"\left({part}\right)")
}

/// Whether the text of a number has an exponent.
fn has_exponent(value: f64) -> bool {
    format_significant(value, EXACT_DIGITS).contains('e')
}

/// Returns a number with its unit: `4.5 \times 10^{7}\,\mathrm{N}`.
fn number_latex(value: f64, unit: Option<&str>) -> String {
    let digits = format_significant(value, EXACT_DIGITS);
    let number = match digits.split_once('e') {
        Some(("1", exponent)) => format!("10^{{{exponent}}}"),
        Some((factor, exponent)) => format!(r"{factor} \times 10^{{{exponent}}}"),
        None => digits,
    };
    match unit {
        Some(unit) => format!(r"{number}\,{}", unit_latex(unit)),
        None => number,
    }
}

/// Returns a product. There is a dot in front of a number, and a thin space in front of every other factor.
fn product_latex(factors: &[Notation]) -> String {
    let mut product = String::new();
    for factor in factors {
        let written = grouped(factor, Precedence::Product);
        if !product.is_empty() {
            let is_number = written.starts_with(|letter: char| letter.is_ascii_digit());
            product += if is_number { r" \cdot " } else { r"\," };
        }
        product += &written;
    }
    product
}

/// Returns a base with its exponent.
fn power_latex(base: &Notation, exponent: &Notation) -> String {
    format!("{}^{{{}}}", grouped(base, Precedence::Atom), latex(exponent))
}

/// Whether a call is written as a base with its exponent.
fn is_raised(name: &str, arguments: &[Notation]) -> bool {
    matches!((name, arguments.len()), ("exp10", 1) | ("power", 2))
}

/// Returns a call, with the signs of mathematics for functions that have some.
fn call_latex(name: &str, arguments: &[Notation]) -> String {
    match (name, arguments) {
        ("abs", [argument]) => format!(r"\left|{}\right|", latex(argument)),
        ("sqrt", [argument]) => format!(r"\sqrt{{{}}}", latex(argument)),
        ("floor", [argument]) => format!(r"\left\lfloor {}\right\rfloor", latex(argument)),
        ("exp10", [exponent]) => format!("10^{{{}}}", latex(exponent)),
        ("power", [base, exponent]) => power_latex(base, exponent),
        _ => {
            let arguments: Vec<String> = arguments.iter().map(latex).collect();
            function_latex(name) + &in_parentheses(&arguments.join(", "))
        }
    }
}

/// Returns values by condition, each in a row.
fn cases_latex(cases: &[(Notation, Option<Condition>)]) -> String {
    let rows = cases.iter().map(|(value, condition)| {
        let condition = condition_latex(condition.as_ref());
        format!("{} & {condition}", latex(value))
    });
    format!(r"\begin{{cases}} {} \end{{cases}}", rows.collect::<Vec<_>>().join(r" \\ "))
}

/// Returns a condition with the word in front.
fn condition_latex(condition: Option<&Condition>) -> String {
    match condition {
        Some(condition) if !condition.0.is_empty() => {
            format!(r"\text{{if }} {}", conditions_latex(condition))
        }
        _ => r"\text{otherwise}".to_owned(),
    }
}

/// Returns a condition without a word in front.
pub(crate) fn conditions_latex(condition: &Condition) -> String {
    let comparisons: Vec<String> = condition.0.iter().map(comparison_latex).collect();
    comparisons.join(r" \text{ and } ")
}

/// Returns one part of a condition.
fn comparison_latex(comparison: &Comparison) -> String {
    match comparison {
        Comparison::Compare { left, relation, right } => {
            format!("{} {} {}", latex(left), relation_latex(*relation), latex(right))
        }
        Comparison::Words(words) => words_latex(words),
    }
}

/// Returns the sign of a relation.
fn relation_latex(relation: Relation) -> &'static str {
    match relation {
        Relation::Less => "<",
        Relation::AtMost => r"\le",
        Relation::Greater => ">",
        Relation::AtLeast => r"\ge",
        Relation::Equal => "=",
    }
}
