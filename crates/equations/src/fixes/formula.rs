//! Formulas of settings, changed by one factor.

use patchcord_expr::{Expression, Formula, Node, Operator, format_significant, round_significant};
use serde_json::{Value, json};

/// Significant digits of a changed number. Fewer than those of f64, so that 0.1 x 3 is 0.3.
const DIGITS: usize = 12;
/// Significant digits of a number that must be precise.
const PRECISE_DIGITS: usize = 14;

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

    /// The product times a positive number, as by [`Product::times`], with more digits.
    pub(crate) fn times_precisely(&self, factor: f64) -> Self {
        self.times_rounded(factor, PRECISE_DIGITS)
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
            None if factor < 1.0 => product.push(Content::number(1.0 / factor, digits), true),
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
mod tests {
    use super::*;

    /// The product of a formula.
    fn product(text: &str) -> Product {
        Product::new(&json!(text)).unwrap()
    }

    #[test]
    fn a_number_of_the_formula_takes_a_factor() {
        let cases = [
            ("K * position / force / 100", 10.0, "K * position / force / 10"),
            ("k / m / 10", 10.0, "k / m"),
            ("k / m", 0.1, "k / m / 10"),
            ("k / m", 10.0, "k / m * 10"),
            ("50 * m * v^2 / energy", 0.1, "5 * m * v^2 / energy"),
            ("10 * y0 / lynxes", 0.1, "y0 / lynxes"),
            ("k / 10 / 10", 10.0, "k / 10"),
            ("sqrt(0.5) / 10", 10.0, "sqrt(0.5)"),
            ("2 * pi / 10", 10.0, "2 * pi"),
            ("a + b", 0.1, "(a + b) / 10"),
            ("(a) + (b)", 0.1, "((a) + (b)) / 10"),
            ("2.6666666666666665 * k / 10", 10.0, "2.6666666666666665 * k"),
            ("1", 0.1, "0.1"),
        ];
        for (text, factor, expected) in cases {
            assert_eq!(product(text).times(factor).value(), json!(expected), "{text}");
        }
        assert_eq!(Product::new(&json!(0.3)).unwrap().times(0.1).value(), json!(0.03));
        assert_eq!(Product::new(&json!(-5)).unwrap().times(10.0).value(), json!(-50));
        let third = Product::new(&json!(10)).unwrap();
        assert_eq!(third.times(1.0 / 3.0).value(), json!(3.333_333_333_33));
        assert_eq!(third.times_precisely(1.0 / 3.0).value(), json!(3.333_333_333_333_3));
    }

    #[test]
    fn a_name_cancels_the_same_name_below_the_line() {
        let cases = [
            ("rho / 100 * flow", "difference", true, "rho / 100 * flow / difference"),
            ("a / b", "b", false, "a"),
            ("a / b^2", "b", false, "a / b^2 * b"),
            ("a", "a", true, "1"),
            ("1", "mu", false, "mu"),
            ("1", "mu", true, "1 / mu"),
        ];
        for (text, name, divides, expected) in cases {
            assert_eq!(product(text).times_name(name, divides).value(), json!(expected), "{text}");
        }
        let number = Product::new(&json!(0.4)).unwrap();
        assert_eq!(number.times_name("k", false).value(), json!("0.4 * k"));
    }

    #[test]
    fn two_minus_signs_cancel() {
        let cases = [
            ("x0 / position", "-x0 / position"),
            ("-x0 / position", "x0 / position"),
            ("-(-(Fk + drop) / K)", "-(Fk + drop) / K"),
            ("a - b", "-(a - b)"),
            ("a * (-b)", "a * b"),
        ];
        for (text, expected) in cases {
            assert_eq!(product(text).negated().value(), json!(expected), "{text}");
        }
        assert_eq!(Product::new(&json!(-100)).unwrap().negated().value(), json!(100));
    }

    #[test]
    fn named_factors_above_and_below_the_line_are_exchanged() {
        let found: Vec<Value> = product("velocity / position / 10")
            .exchanges()
            .iter()
            .map(|(_, product)| product.value())
            .collect();
        assert_eq!(found, [json!("position / velocity / 10")]);
        assert_eq!(product("a * b / c^2 / d").exchanges().len(), 4);
        assert!(product("a / (b + c)").exchanges().is_empty());
    }

    #[test]
    fn divisors_that_are_powers_of_ten_count() {
        let cases = [
            ("k / 100", 2),
            ("0.1 * k", 1),
            ("k", 0),
            ("50 * k", 0),
            ("100 * k / 10", 1),
            ("k / 10 / 10", 2),
        ];
        for (text, expected) in cases {
            assert_eq!(product(text).divided_decades(), expected, "{text}");
        }
    }

    #[test]
    fn every_name_of_a_formula_can_be_another() {
        let others = |name: &str| if name == "c" { vec!["k", "d"] } else { Vec::new() };
        let found = renamed(&json!("sqrt(c / m) + c"), others);
        let texts: Vec<&str> = found.iter().filter_map(Value::as_str).collect();
        assert_eq!(texts, ["sqrt(k / m) + c", "sqrt(d / m) + c", "sqrt(c / m) + k", "sqrt(c / m) + d"]);
        assert!(renamed(&json!(5), |_| vec!["k"]).is_empty());
    }

    #[test]
    fn other_values_are_no_products() {
        for value in [json!(null), json!([1]), json!("k *"), json!(true)] {
            assert_eq!(Product::new(&value), None, "{value}");
        }
    }
}
