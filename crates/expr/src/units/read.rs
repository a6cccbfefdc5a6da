//! The reader of unit texts.
//!
//! ```text
//! quotient := product { "/" factor }
//! product  := factor { ( blank | "*" | "·" ) factor }
//! factor   := "1" | ( name | "%" | "(" quotient ")" ) [ power ]
//! power    := [ "^" ] [ "-" ] digits [ "." digits ] | superscript
//! ```

use std::ops::Range;

use super::error::UnitError;
use super::symbols::{Prefix, Symbol, known, suggestions};

const LONGEST_TEXT: usize = 200;
const DEEPEST_NESTING: usize = 8;
const LARGEST_POWER: f64 = 12.0;

/// One symbol of a unit with its prefix and power.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Factor {
    pub prefix: Prefix,
    pub symbol: Symbol,
    pub power: f64,
}

impl Factor {
    /// The name without the power: `mm`.
    pub fn name(&self) -> String {
        format!("{}{}", self.prefix.name, self.symbol.name)
    }

    pub fn raised(self, power: f64) -> Self {
        Self { power: self.power * power, ..self }
    }
}

/// The factors of a unit text in the order of writing; none for a pure number.
pub(super) fn factors(text: &str) -> Result<Vec<Factor>, UnitError> {
    if text.len() > LONGEST_TEXT {
        let message = format!("a unit has at most {LONGEST_TEXT} characters");
        return Err(UnitError::new(0..text.len(), message));
    }
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    let mut reader = Reader { text, at: 0, depth: 0 };
    let factors = reader.quotient()?;
    match reader.peek() {
        None => Ok(factors),
        Some(_) => Err(reader.unexpected()),
    }
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
}

impl Reader<'_> {
    fn quotient(&mut self) -> Result<Vec<Factor>, UnitError> {
        let mut factors = self.product()?;
        while self.take(&['/']) {
            let start = self.at;
            let divisor = self.factor()?;
            factors.extend(divisor.into_iter().map(|factor| factor.raised(-1.0)));
            self.refuse_product_after_slash(start)?;
        }
        Ok(factors)
    }

    fn product(&mut self) -> Result<Vec<Factor>, UnitError> {
        let mut factors = self.factor()?;
        while self.another_factor_follows()? {
            factors.extend(self.factor()?);
        }
        Ok(factors)
    }

    fn another_factor_follows(&mut self) -> Result<bool, UnitError> {
        let blank = self.skip_blanks();
        if self.take(&['*', '·', '⋅']) {
            return Ok(true);
        }
        match self.peek() {
            None | Some('/' | ')') => Ok(false),
            Some(_) if blank => Ok(true),
            Some(_) => Err(self.unexpected()),
        }
    }

    // "kg/m s2" is read both as kg/(m s2) and as (kg/m) s2 by different people.
    fn refuse_product_after_slash(&mut self, start: usize) -> Result<(), UnitError> {
        let divisor_end = self.at;
        if !self.another_factor_follows()? {
            return Ok(());
        }
        self.skip_blanks();
        let next_start = self.at;
        self.factor()?;
        let divisor = self.text[start..divisor_end].trim();
        let next = &self.text[next_start..self.at];
        let message = format!("it is not clear whether the / also divides by {next}");
        let hint = format!("write /({divisor} {next}) if it does, else put {next} before the /");
        Err(UnitError::new(start..self.at, message).with_hint(hint))
    }

    fn factor(&mut self) -> Result<Vec<Factor>, UnitError> {
        self.skip_blanks();
        match self.peek() {
            Some('(') => self.group(),
            Some(digit) if digit.is_ascii_digit() => self.one(),
            Some(letter) if letter == '%' || letter.is_alphabetic() => self.symbol(),
            Some('/' | ')' | '*' | '·' | '⋅') | None => {
                let end = self.at + self.peek().map_or(0, char::len_utf8);
                Err(UnitError::new(self.at..end, "a unit is missing here"))
            }
            Some(_) => Err(self.unexpected()),
        }
    }

    fn group(&mut self) -> Result<Vec<Factor>, UnitError> {
        let start = self.at;
        self.depth += 1;
        if self.depth > DEEPEST_NESTING {
            let message = "the parentheses of the unit are nested too deeply";
            return Err(UnitError::new(start..start + 1, message));
        }
        self.take(&['(']);
        let inner = self.quotient()?;
        if !self.take(&[')']) {
            let message = "this parenthesis is not closed";
            return Err(UnitError::new(start..start + 1, message));
        }
        self.depth -= 1;
        let power = self.power()?;
        Ok(inner.into_iter().map(|one| one.raised(power)).collect())
    }

    fn one(&mut self) -> Result<Vec<Factor>, UnitError> {
        let range = self.run(|letter| letter.is_ascii_digit() || letter == '.');
        match &self.text[range.clone()] {
            "1" => Ok(Vec::new()),
            number => {
                let message = format!("the number {number} cannot stand in a unit");
                let hint = "only 1 can, as in 1/s; a power follows its unit without a blank";
                Err(UnitError::new(range, message).with_hint(hint))
            }
        }
    }

    fn symbol(&mut self) -> Result<Vec<Factor>, UnitError> {
        let range = match self.peek() {
            Some('%') => self.at..self.at + 1,
            _ => self.run(is_name_letter),
        };
        self.at = range.end;
        let name = &self.text[range.clone()];
        let (prefix, symbol) = known(name).ok_or_else(|| unknown(name, range))?;
        let power = self.power()?;
        Ok(vec![Factor { prefix, symbol, power }])
    }

    fn power(&mut self) -> Result<f64, UnitError> {
        let start = self.at;
        let superscript = self.run(|letter| superscript_value(letter).is_some());
        if !superscript.is_empty() {
            let plain: String = self.text[superscript].chars().filter_map(superscript_value).collect();
            return self.power_value(&plain, start);
        }
        let marked = self.take(&['^']);
        let digits = self.run(|letter| letter.is_ascii_digit() || matches!(letter, '-' | '.'));
        if digits.is_empty() && !marked {
            return Ok(1.0);
        }
        self.power_value(&self.text[digits], start)
    }

    fn power_value(&self, digits: &str, start: usize) -> Result<f64, UnitError> {
        let range = start..self.at;
        let power: f64 = digits.parse().map_err(|_| {
            let message = format!("{} is not a power", &self.text[range.clone()]);
            UnitError::new(range.clone(), message)
                .with_hint("a power is written s2, s^2 or s-1; a product m s or m*s")
        })?;
        if power.abs() > LARGEST_POWER {
            let message = format!("a power is at most {LARGEST_POWER}");
            return Err(UnitError::new(range, message));
        }
        Ok(power)
    }

    fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    fn take(&mut self, signs: &[char]) -> bool {
        let found = self.peek().filter(|letter| signs.contains(letter));
        self.at += found.map_or(0, char::len_utf8);
        found.is_some()
    }

    fn run(&mut self, belongs: impl Fn(char) -> bool) -> Range<usize> {
        let start = self.at;
        let rest = &self.text[start..];
        self.at += rest.find(|letter| !belongs(letter)).unwrap_or(rest.len());
        start..self.at
    }

    fn skip_blanks(&mut self) -> bool {
        !self.run(char::is_whitespace).is_empty()
    }

    fn unexpected(&self) -> UnitError {
        let letter = self.peek();
        let end = self.at + letter.map_or(0, char::len_utf8);
        let shown = letter.map(String::from).unwrap_or_default();
        UnitError::new(self.at..end, format!("{shown} cannot stand here")).with_hint(match letter {
            Some('°') => "temperatures are in K, angles in rad",
            _ => "factors are separated by a blank, * or /, as in N s/m",
        })
    }
}

// The superscript digits count as numeric, but are no part of a name.
fn is_name_letter(letter: char) -> bool {
    letter.is_alphabetic() && superscript_value(letter).is_none()
}

/// Scales of temperature whose zero is not that of K.
const TEMPERATURES: [&str; 5] = ["degc", "degf", "celsius", "centigrade", "fahrenheit"];

fn unknown(name: &str, range: Range<usize>) -> UnitError {
    let error = UnitError::new(range, format!("{name} is not a known unit"));
    if TEMPERATURES.contains(&name.to_lowercase().as_str()) {
        return error.with_hint("temperatures are in K");
    }
    match suggestions(name).join(" or ") {
        none if none.is_empty() => error,
        meant => error.with_hint(format!("did you mean {meant}?")),
    }
}

fn superscript_value(letter: char) -> Option<char> {
    const PAIRS: [(char, char); 11] = [
        ('⁻', '-'),
        ('⁰', '0'),
        ('¹', '1'),
        ('²', '2'),
        ('³', '3'),
        ('⁴', '4'),
        ('⁵', '5'),
        ('⁶', '6'),
        ('⁷', '7'),
        ('⁸', '8'),
        ('⁹', '9'),
    ];
    let pair = PAIRS.iter().find(|(raised, _)| *raised == letter);
    pair.map(|(_, plain)| *plain)
}
