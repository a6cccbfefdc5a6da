//! Expressions and equations as plain text, in the language in which a patch states its equations.
//!
//! Products have no sign: `k x`. A product without a sign after a division is ambiguous, so a quotient that
//! is a factor is in parentheses: `(k/m) x`. Only two kinds of expressions cannot be read again: numbers with a
//! unit, and values by condition.

use patchcord_expr::{Callee, EquationFunction, format_significant};

use super::{Comparison, Condition, Notation, Precedence, Relation, WrittenEquation, signed_terms};

/// The usual largest number of characters of a line.
pub const LINE_WIDTH: usize = 100;

/// The number of significant digits from which every number is read again without a change.
pub(super) const EXACT_DIGITS: usize = 17;

/// The least width of the column of values in an equation with cases. With it, the conditions of several
/// equations are usually below each other.
const MIN_VALUE_WIDTH: usize = 12;

/// Returns the text of an expression, on one line.
#[must_use]
pub fn text(notation: &Notation) -> String {
    match notation.unwrapped() {
        Notation::Number { value, unit } => number_text(*value, unit.as_deref()),
        Notation::Name { name, primes } => primed(name, usize::from(*primes)),
        Notation::Negative(operand) => format!("-{}", grouped(operand, Precedence::Quotient)),
        Notation::Sum(terms) if terms.is_empty() => "0".to_owned(),
        Notation::Sum(terms) => term_texts(terms).join(" "),
        Notation::Product(factors) if factors.is_empty() => "1".to_owned(),
        Notation::Product(factors) => product_text(factors),
        Notation::Quotient(numerator, denominator) => {
            format!("{}/{}", grouped(numerator, Precedence::Product), grouped(denominator, Precedence::Power))
        }
        Notation::Power(base, exponent) => {
            format!("{}^{}", grouped(base, Precedence::Atom), grouped(exponent, Precedence::Atom))
        }
        Notation::Call(name, arguments) => {
            let arguments: Vec<String> = arguments.iter().map(text).collect();
            format!("{name}({})", arguments.join(", "))
        }
        Notation::Cases(cases) => cases_text(cases),
    }
}

/// A name with this number of primes.
pub(crate) fn primed(name: &str, primes: usize) -> String {
    name.to_owned() + &"'".repeat(primes)
}

/// Returns the text of an equation.
///
/// If the right side has cases, each case has a line, and the conditions are below each other. If the right
/// side is a sum and the line would have more than `width` characters, there are line breaks between its terms.
/// [`LINE_WIDTH`] is the usual width. Every other equation is one line.
#[must_use]
pub fn equation_text(equation: &WrittenEquation, width: usize) -> String {
    let start = format!("{} = ", text(&equation.left));
    match equation.right.unwrapped() {
        Notation::Cases(cases) => case_lines(&start, cases),
        Notation::Sum(terms) if !terms.is_empty() => term_lines(&start, &term_texts(terms), width),
        right => start + &text(right),
    }
}

/// Returns the precedence of the text of an expression.
fn precedence(notation: &Notation) -> Precedence {
    match notation.unwrapped() {
        Notation::Sum(terms) if !terms.is_empty() => Precedence::Sum,
        Notation::Negative(_) => Precedence::Negation,
        Notation::Number { value, .. } if *value < 0.0 => Precedence::Negation,
        Notation::Number { unit: Some(_), .. } | Notation::Quotient(..) => Precedence::Quotient,
        Notation::Product(factors) if !factors.is_empty() => Precedence::Product,
        Notation::Power(..) => Precedence::Power,
        Notation::Number { .. }
        | Notation::Name { .. }
        | Notation::Sum(_)
        | Notation::Product(_)
        | Notation::Call(..)
        | Notation::Cases(_) => Precedence::Atom,
    }
}

/// Returns the text of an expression, in parentheses if its precedence is below `lowest`.
fn grouped(notation: &Notation, lowest: Precedence) -> String {
    let written = text(notation);
    if precedence(notation) < lowest { format!("({written})") } else { written }
}

/// Returns the shortest text from which the same number is read again, and its unit.
fn number_text(value: f64, unit: Option<&str>) -> String {
    let number = format_significant(value, EXACT_DIGITS);
    match unit {
        Some(unit) => format!("{number} {unit}"),
        None => number,
    }
}

/// Returns the texts of the terms of a sum, each with its sign.
fn term_texts(terms: &[Notation]) -> Vec<String> {
    signed_terms(terms, |term| grouped(term, Precedence::Quotient))
}

/// Returns the text of a product. There is a sign between two factors only if it is necessary.
fn product_text(factors: &[Notation]) -> String {
    let mut product = String::new();
    for factor in factors {
        let written = grouped(factor, Precedence::Power);
        if !product.is_empty() {
            product += if needs_sign(&product, &written) { " * " } else { " " };
        }
        product += &written;
    }
    product
}

/// Whether two factors need a sign between them.
///
/// Without one, `2 3` would be misread as one number, and the name of a function would begin a call.
fn needs_sign(left: &str, right: &str) -> bool {
    let is_name_letter = |letter: char| letter.is_ascii_alphanumeric() || letter == '_';
    let last_word = left.rsplit(|letter| !is_name_letter(letter)).next().unwrap_or_default();
    let is_function =
        Callee::from_name(last_word).is_some() || EquationFunction::from_name(last_word).is_some();
    is_function || right.starts_with(|letter: char| letter.is_ascii_digit())
}

/// Returns the text of values by condition, on one line: `{0 if x >= 100; v - x otherwise}`.
fn cases_text(cases: &[(Notation, Option<Condition>)]) -> String {
    let cases = cases.iter().map(|(value, condition)| {
        let condition = condition_text(condition.as_ref());
        format!("{} {condition}", text(value))
    });
    format!("{{{}}}", cases.collect::<Vec<_>>().join("; "))
}

/// Returns the text of a condition with the word in front: `if x >= 100 and v > 0`, or `otherwise`.
fn condition_text(condition: Option<&Condition>) -> String {
    match condition {
        Some(condition) if !condition.0.is_empty() => format!("if {}", conditions_text(condition)),
        _ => "otherwise".to_owned(),
    }
}

/// Returns the text of a condition without a word in front.
pub(crate) fn conditions_text(condition: &Condition) -> String {
    let comparisons: Vec<String> = condition.0.iter().map(comparison_text).collect();
    comparisons.join(" and ")
}

/// Returns the text of one part of a condition.
fn comparison_text(comparison: &Comparison) -> String {
    match comparison {
        Comparison::Compare { left, relation, right } => {
            format!("{} {} {}", text(left), relation_text(*relation), text(right))
        }
        Comparison::Words(words) => words.clone(),
    }
}

/// Returns the sign of a relation.
fn relation_text(relation: Relation) -> &'static str {
    match relation {
        Relation::Less => "<",
        Relation::AtMost => "<=",
        Relation::Greater => ">",
        Relation::AtLeast => ">=",
        Relation::Equal => "=",
    }
}

/// Returns the lines of an equation with cases. `start` is the left side with the sign of equality.
fn case_lines(start: &str, cases: &[(Notation, Option<Condition>)]) -> String {
    let values: Vec<String> = cases.iter().map(|(value, _)| text(value)).collect();
    let longest = values.iter().map(|value| value.chars().count()).max().unwrap_or_default();
    let width = longest.max(MIN_VALUE_WIDTH);
    let lines = values.iter().zip(cases).map(|(value, (_, condition))| {
        let condition = condition_text(condition.as_ref());
        format!("{value:width$}  {condition}")
    });
    let between = format!("\n{}", " ".repeat(start.chars().count()));
    start.to_owned() + &lines.collect::<Vec<_>>().join(&between)
}

/// Returns the lines of an equation with a sum on the right side, each with as many terms as fit into `width`.
///
/// `start` is the left side with the sign of equality.
fn term_lines(start: &str, terms: &[String], width: usize) -> String {
    let indent = start.chars().count();
    let (mut lines, mut length) = (start.to_owned(), indent);
    for (index, term) in terms.iter().enumerate() {
        let term_length = term.chars().count();
        if index > 0 && length + 1 + term_length > width {
            lines += "\n";
            lines += &" ".repeat(indent);
            length = indent;
        } else if index > 0 {
            lines += " ";
            length += 1;
        }
        lines += term;
        length += term_length;
    }
    lines
}
