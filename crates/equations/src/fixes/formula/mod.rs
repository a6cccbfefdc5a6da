//! Formulas of settings, changed by one factor.

use patchcord_expr::{Expression, Formula, Node, Operator, format_significant, round_significant};
use serde_json::{Value, json};

use super::quotient::short_quotient;

/// Significant digits of a changed number. Fewer than those of f64, so that 0.1 x 3 is 0.3.
const DIGITS: usize = 12;
/// Significant digits of a number that must be precise.
const PRECISE_DIGITS: usize = 14;
/// Most digits of a number that is not written as a quotient.
const SHORT_DIGITS: usize = 5;

/// A value of the document as a product: a number, or a formula split into its factors.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Product {
    /// Whether the product has a minus sign.
    is_negative: bool,
    factors: Vec<Factor>,
    /// Whether the document has a number. It stays one as long as it has no other factor.
    is_number: bool,
}

/// A factor of a formula.
#[derive(Debug, Clone, PartialEq)]
struct Factor {
    content: Content,
    /// Whether it is in the denominator.
    divides: bool,
}

/// What a factor is.
#[derive(Debug, Clone, PartialEq)]
enum Content {
    /// A number, and how it is written.
    Number(f64, String),
    /// A name, or a power of one, as written. The second part is the name.
    Name(String, String),
    /// Anything else, as written, in parentheses if it is a sum.
    Other(String),
}

impl Content {
    /// A number with this number of digits.
    fn number(value: f64, digits: usize) -> Self {
        let value = round_significant(value, digits);
        Content::Number(value, format_significant(value, digits))
    }

    /// Whether it is a number with many digits.
    fn is_long(&self) -> bool {
        matches!(self, Content::Number(value, _) if is_long(*value))
    }

    /// The factor as it is written.
    fn text(&self) -> &str {
        match self {
            Content::Number(_, text) | Content::Name(text, _) | Content::Other(text) => text,
        }
    }
}

impl Product {
    /// The product that a value of the document is. `None` if it is neither a number nor a formula.
    pub(crate) fn new(value: &Value) -> Option<Self> {
        let mut product = Product { is_negative: false, factors: Vec::new(), is_number: value.is_number() };
        if let Some(number) = value.as_f64() {
            product.is_negative = number < 0.0;
            let text = value.to_string().trim_start_matches('-').to_owned();
            product.push(Content::Number(number.abs(), text), false);
        } else {
            let formula = Formula::parse(value.as_str()?).ok()?;
            product.collect(formula.root(), formula.text(), false);
        }
        Some(product)
    }

    /// Adds a factor.
    fn push(&mut self, content: Content, divides: bool) {
        self.factors.push(Factor { content, divides });
    }

    /// Adds the factors of a node. `divides` is whether the node is in the denominator.
    fn collect(&mut self, node: &Node, text: &str, divides: bool) {
        let written = &text[node.range.clone()];
        match &node.expression {
            Expression::Binary(Operator::Multiply, left, right) => {
                self.collect(left, text, divides);
                self.collect(right, text, divides);
            }
            Expression::Binary(Operator::Divide, left, right) => {
                self.collect(left, text, divides);
                self.collect(right, text, !divides);
            }
            Expression::Negate(inner) => {
                self.is_negative = !self.is_negative;
                self.collect(inner, text, divides);
            }
            // The constant pi keeps its name.
            Expression::Number(number) if written != "pi" => {
                self.push(Content::Number(*number, written.to_owned()), divides);
            }
            Expression::Name(name) => self.push(Content::Name(written.to_owned(), name.clone()), divides),
            Expression::Binary(Operator::Power, base, _) => {
                let content = match &base.expression {
                    Expression::Name(name) => Content::Name(written.to_owned(), name.clone()),
                    _ => Content::Other(written.to_owned()),
                };
                self.push(content, divides);
            }
            Expression::Binary(Operator::Add | Operator::Subtract, ..) if !is_enclosed(written) => {
                self.push(Content::Other(format!("({written})")), divides);
            }
            _ => self.push(Content::Other(written.to_owned()), divides),
        }
    }

    /// The value for the document: a number, or the text of the formula.
    pub(crate) fn value(&self) -> Value {
        if let ([Factor { content: Content::Number(number, _), divides: false }], true) =
            (self.factors.as_slice(), self.is_number)
        {
            let number = if self.is_negative { -number } else { *number };
            let is_whole = number.fract() == 0.0 && number.abs() < 1e15;
            return if is_whole { json!(number as i64) } else { json!(number) };
        }
        let mut text = String::new();
        for Factor { content, divides } in &self.factors {
            text += match (text.is_empty(), divides) {
                (true, false) => "",
                (true, true) => "1 / ",
                (false, false) => " * ",
                (false, true) => " / ",
            };
            text += content.text();
        }
        let text = if text.is_empty() { "1".to_owned() } else { text };
        json!(if self.is_negative { format!("-{text}") } else { text })
    }

    /// The product with the opposite sign.
    pub(super) fn negated(&self) -> Self {
        Product { is_negative: !self.is_negative, ..self.clone() }
    }

    /// The product times a positive number. A number of the formula changes if there is one: first a divisor, because
    /// `k / 100` times 10 is `k / 10`.
    pub(super) fn times(&self, factor: f64) -> Self {
        self.times_rounded(factor, DIGITS)
    }

    /// The product times a positive number, as by [`Product::times`], with more digits. A new number with many digits
    /// becomes a short quotient if it is one.
    pub(crate) fn times_precisely(&self, factor: f64) -> Self {
        let mut product = self.times_rounded(factor, PRECISE_DIGITS);
        let is_new = |own: &Factor| !self.factors.contains(own);
        let long = product.factors.iter().position(|own| is_new(own) && own.content.is_long());
        let found = long.and_then(|index| match product.factors[index].content {
            Content::Number(value, _) => Some((index, short_quotient(value)?)),
            _ => None,
        });
        if let Some((index, [dividend, divisor])) = found {
            let divides = product.factors[index].divides;
            product.factors[index].content = Content::number(dividend, PRECISE_DIGITS);
            let content = Content::number(divisor, PRECISE_DIGITS);
            product.factors.insert(index + 1, Factor { content, divides: !divides });
            product.tidy();
        }
        product
    }

    /// The product times a positive number that is rounded to this number of digits.
    fn times_rounded(&self, factor: f64, digits: usize) -> Self {
        let mut product = self.clone();
        let numbers = product.factors.iter().enumerate().rev();
        let number = |(index, own): (usize, &Factor)| match &own.content {
            Content::Number(value, _) => Some((index, *value, own.divides)),
            _ => None,
        };
        let numbers: Vec<(usize, f64, bool)> = numbers.filter_map(number).collect();
        let divisor = numbers.iter().find(|(.., divides)| *divides);
        match divisor.or(numbers.first()).copied() {
            Some((index, value, divides)) => {
                let changed = if divides { value / factor } else { value * factor };
                product.factors[index].content = Content::number(changed, digits);
            }
            None if factor < 1.0 && (is_long(factor) || !is_long(1.0 / factor)) => {
                product.push(Content::number(1.0 / factor, digits), true);
            }
            None => product.push(Content::number(factor, digits), false),
        }
        product.tidy();
        product
    }

    /// The product times or over a name. A factor of the same name on the other side of the fraction is removed.
    pub(crate) fn times_name(&self, name: &str, divides: bool) -> Self {
        let mut product = self.clone();
        let opposite = product.factors.iter().position(|factor| {
            factor.divides != divides && matches!(&factor.content, Content::Name(text, _) if text == name)
        });
        match opposite {
            Some(index) => {
                product.factors.remove(index);
            }
            None => product.push(Content::Name(name.to_owned(), name.to_owned()), divides),
        }
        product.tidy();
        product
    }

    /// The products in which two named factors have exchanged their places above and below the line, with their names.
    pub(super) fn exchanges(&self) -> Vec<([&str; 2], Self)> {
        let named = |divides: bool| {
            self.factors.iter().enumerate().filter_map(move |(index, factor)| match &factor.content {
                Content::Name(_, name) if factor.divides == divides => Some((index, name.as_str())),
                _ => None,
            })
        };
        let mut found = Vec::new();
        for (upper, above) in named(false) {
            for (lower, below) in named(true) {
                let mut product = self.clone();
                product.factors[upper].content = self.factors[lower].content.clone();
                product.factors[lower].content = self.factors[upper].content.clone();
                found.push(([above, below], product));
            }
        }
        found
    }

    /// The power of ten by which numbers divide the product: 2 for `k / 100` and 1 for `0.1 * k`. Other numbers do not
    /// count.
    pub(super) fn divided_decades(&self) -> i32 {
        let decades = |factor: &Factor| match factor.content {
            Content::Number(number, _) => {
                let power = if factor.divides { number.log10() } else { -number.log10() };
                let is_power = (power - power.round()).abs() < 1e-9;
                if is_power { (power.round() as i32).max(0) } else { 0 }
            }
            _ => 0,
        };
        self.factors.iter().map(decades).sum()
    }

    /// Whether the product has no names.
    pub(super) fn is_literal(&self) -> bool {
        self.factors.iter().all(|factor| matches!(factor.content, Content::Number(..)))
    }

    /// Removes factors of 1, unless the product is 1.
    fn tidy(&mut self) {
        let is_one = |factor: &Factor| matches!(factor.content, Content::Number(1.0, _));
        if !self.factors.iter().all(is_one) {
            self.factors.retain(|factor| !is_one(factor));
        }
    }
}

/// Whether a number has many digits, apart from rounding.
fn is_long(value: f64) -> bool {
    round_significant(value, SHORT_DIGITS) != round_significant(value, PRECISE_DIGITS)
}

/// Whether one pair of parentheses encloses a text.
fn is_enclosed(text: &str) -> bool {
    let mut depth = 0;
    let closes = |letter: char| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth == 0
    };
    text.starts_with('(') && text.find(closes) == text.len().checked_sub(1)
}

/// The formulas in which one name is another one. `other` gives the names that a name can be mistaken for.
pub(super) fn renamed<'n>(value: &Value, other: impl Fn(&str) -> Vec<&'n str>) -> Vec<Value> {
    let Some(text) = value.as_str() else { return Vec::new() };
    let Ok(formula) = Formula::parse(text) else { return Vec::new() };
    let mut found = Vec::new();
    for node in named_nodes(formula.root()) {
        // The range of a node includes its parentheses.
        let written = &text[node.range.clone()];
        for name in other(written.trim_matches(['(', ')', ' '])) {
            let mut changed = text.to_owned();
            changed.replace_range(node.range.clone(), name);
            found.push(json!(changed));
        }
    }
    found
}

/// The nodes that are names, from left to right.
pub(crate) fn named_nodes(node: &Node) -> Vec<&Node> {
    match &node.expression {
        Expression::Name(_) => vec![node],
        Expression::Number(_) => Vec::new(),
        Expression::Negate(inner) => named_nodes(inner),
        Expression::Binary(_, left, right) => {
            [left, right].into_iter().flat_map(|side| named_nodes(side)).collect()
        }
        Expression::Call(_, arguments) | Expression::Apply(_, arguments) => {
            arguments.iter().flat_map(named_nodes).collect()
        }
    }
}

#[cfg(test)]
mod tests;
