//! Random expressions: their text is read again, by a reader that shares no code with the writer, and has the same
//! value to the last bit.

use proptest::prelude::*;

use super::{call, name, negative, number, power, quotient};
use crate::notation::{Notation, text};

/// Quantities and their values. Some have the name of a function, and one looks like an exponent.
const QUANTITIES: [(&str, f64); 8] = [
    ("x", 0.7),
    ("v_o", -1.3),
    ("k", 2.1),
    ("e3", 0.45),
    ("F2", -3.3),
    ("step", 1.9),
    ("max", -0.6),
    ("sin", 0.25),
];

/// Numbers of different forms.
const NUMBERS: [f64; 7] = [0.0, 1.0, 2.0, 0.1 + 0.2, 45e6, 1e-5, 1234.5];

/// The value of a quantity or its derivative.
fn quantity(name: &str, primes: u8) -> f64 {
    let found = QUANTITIES.iter().find(|(known, _)| *known == name);
    found.unwrap_or_else(|| panic!("{name} is no quantity")).1 + f64::from(primes)
}

/// The value of a function; `None` if there is none of this name.
fn function(name: &str, arguments: &[f64]) -> Option<f64> {
    match (name, arguments) {
        ("sin", [a]) => Some(a.sin()),
        ("abs", [a]) => Some(a.abs()),
        ("step", [a]) => Some(f64::from(u8::from(*a >= 0.0))),
        ("max", [a, b]) => Some(if a > b { *a } else { *b }),
        _ => None,
    }
}

/// The value of an expression.
fn value(notation: &Notation) -> f64 {
    match notation {
        Notation::Number { value, .. } => *value,
        Notation::Name { name, primes } => quantity(name, *primes),
        Notation::Negative(operand) => -value(operand),
        Notation::Sum(terms) => terms.iter().map(value).reduce(|a, b| a + b).unwrap_or(0.0),
        Notation::Product(factors) => factors.iter().map(value).reduce(|a, b| a * b).unwrap_or(1.0),
        Notation::Quotient(numerator, denominator) => value(numerator) / value(denominator),
        Notation::Power(base, exponent) => value(base).powf(value(exponent)),
        Notation::Call(name, arguments) => {
            let arguments: Vec<f64> = arguments.iter().map(value).collect();
            function(name, &arguments).unwrap_or_else(|| panic!("{name} is no function"))
        }
        Notation::Cases(_) => panic!("cases are not in the language of equations"),
    }
}

/// Reads the text of an expression from left to right and computes its value.
struct Reader<'t> {
    /// The text that is not yet read.
    rest: &'t str,
}

impl<'t> Reader<'t> {
    /// The value of a whole text.
    fn read(text: &'t str) -> f64 {
        let mut reader = Self { rest: text };
        let value = reader.sum();
        assert_eq!(reader.rest, "", "the end of {text} is not read");
        value
    }

    /// The next character after blanks.
    fn peek(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    /// Reads a sign if it is the next character.
    fn take(&mut self, sign: char) -> bool {
        let found = self.peek() == Some(sign);
        self.rest = &self.rest[usize::from(found)..];
        found
    }

    /// Reads the letters of a word.
    fn word(&mut self, belongs: impl Fn(char) -> bool) -> &'t str {
        let end = self.rest.find(|letter| !belongs(letter)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    fn sum(&mut self) -> f64 {
        let mut sum = self.product();
        loop {
            if self.take('+') {
                sum += self.product();
            } else if self.take('-') {
                sum -= self.product();
            } else {
                return sum;
            }
        }
    }

    /// A product without a sign is ambiguous after a division, and misleading in front of a number.
    fn product(&mut self) -> f64 {
        let (mut product, mut is_divided) = (self.signed(), false);
        loop {
            if self.take('*') {
                product *= self.signed();
            } else if self.take('/') {
                product /= self.signed();
                is_divided = true;
            } else if self.begins_operand() {
                assert!(!is_divided, "a product without a sign after a division, before {}", self.rest);
                assert!(!self.rest.starts_with(|letter: char| letter.is_ascii_digit()), "{}", self.rest);
                product *= self.signed();
            } else {
                return product;
            }
        }
    }

    fn begins_operand(&mut self) -> bool {
        self.peek().is_some_and(|letter| letter.is_alphanumeric() || letter == '_' || letter == '(')
    }

    fn signed(&mut self) -> f64 {
        if self.take('-') { -self.signed() } else { self.power() }
    }

    fn power(&mut self) -> f64 {
        let base = self.primary();
        if self.take('^') { base.powf(self.signed()) } else { base }
    }

    fn primary(&mut self) -> f64 {
        match self.peek() {
            Some('(') => {
                self.take('(');
                let inner = self.sum();
                assert!(self.take(')'), "a parenthesis is not closed before {}", self.rest);
                inner
            }
            Some(digit) if digit.is_ascii_digit() => self.number(),
            _ => self.quantity_or_call(),
        }
    }

    /// A number, with its exponent if an "e" follows without a blank.
    fn number(&mut self) -> f64 {
        let start = self.rest;
        self.word(|letter| letter.is_ascii_digit() || letter == '.');
        if let Some(exponent) = self.rest.strip_prefix('e') {
            self.rest = exponent.strip_prefix('-').unwrap_or(exponent);
            self.word(|letter| letter.is_ascii_digit());
        }
        start[..start.len() - self.rest.len()].parse().unwrap()
    }

    /// A name of a function begins a call if a parenthesis follows. It must not stand in front of another operand.
    fn quantity_or_call(&mut self) -> f64 {
        let name = self.word(|letter| letter.is_ascii_alphanumeric() || letter == '_');
        let primes = self.word(|letter| letter == '\'').len();
        let is_function = primes == 0 && ["sin", "abs", "step", "max"].contains(&name);
        if !is_function || !self.begins_operand() {
            return quantity(name, u8::try_from(primes).unwrap());
        }
        assert!(self.take('('), "{name} is a function in front of {}", self.rest);
        let mut arguments = vec![self.sum()];
        while self.take(',') {
            arguments.push(self.sum());
        }
        assert!(self.take(')'), "a call is not closed before {}", self.rest);
        function(name, &arguments).unwrap_or_else(|| panic!("{name} has other arguments than {arguments:?}"))
    }
}

/// A random expression without units and cases.
fn notation() -> impl Strategy<Value = Notation> {
    let numbers = prop::sample::select(NUMBERS.to_vec()).prop_map(number);
    let names = (prop::sample::select(QUANTITIES.to_vec()), 0..3usize)
        .prop_map(|((known, _), primes)| name(&format!("{known}{}", "'".repeat(primes))));
    prop_oneof![1 => numbers, 3 => names].prop_recursive(5, 40, 3, |inner| {
        let several = || prop::collection::vec(inner.clone(), 0..4);
        let pair = || (inner.clone(), inner.clone());
        prop_oneof![
            2 => inner.clone().prop_map(negative),
            3 => several().prop_map(Notation::Sum),
            3 => several().prop_map(Notation::Product),
            2 => pair().prop_map(|(numerator, denominator)| quotient(numerator, denominator)),
            1 => pair().prop_map(|(base, exponent)| power(base, exponent)),
            1 => inner.clone().prop_map(|argument| call("abs", [argument])),
            1 => pair().prop_map(|(first, second)| call("max", [first, second])),
        ]
    })
}

/// Whether every parenthesis is closed, and none is closed that is not open.
fn is_balanced(text: &str) -> bool {
    let mut depth = 0_i32;
    let is_never_negative = text.chars().all(|letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth >= 0
    });
    is_never_negative && depth == 0
}

#[test]
fn the_reader_computes_usual_expressions() {
    let cases = [
        ("2 x' k", 2.0 * 1.7 * 2.1),
        ("-2^3 - k/(2 e3)", -8.0 - 2.1 / (2.0 * 0.45)),
        ("x k/4.5e7", 0.7 * 2.1 / 45e6),
        ("(x/k) max(x, 2) - -1e-5", 0.7 / 2.1 * 2.0 + 1e-5),
        ("step * (x + 1)", 1.9 * 1.7),
    ];
    for (text, expected) in cases {
        assert_eq!(Reader::read(text), expected, "{text}");
    }
}

proptest! {
    #[test]
    fn a_text_has_the_value_of_its_expression(notation in notation()) {
        let written = text(&notation);
        prop_assert!(is_balanced(&written), "{written}");
        prop_assert!(!written.contains("--") && !written.contains("+ -"), "{written}");
        let (expected, read) = (value(&notation), Reader::read(&written));
        prop_assert!(read == expected || (read.is_nan() && expected.is_nan()), "{written}: {read} {expected}");
    }
}
