//! The recursive-descent parser of unit texts.
//!
//! Each rule of the grammar is one method of [`Parser`], and returns the factors that it has read.
//! A power after a parenthesis, and a division, are applied to each factor.
//!
//! ```text
//! quotient := product { "/" factor }
//! product  := factor { ( blank | "*" | "·" ) factor }
//! factor   := "1" | ( name | "%" | "(" quotient ")" ) [ power ]
//! power    := [ "^" ] [ "-" ] digits [ "." digits ] | superscript
//! ```

use std::ops::Range;

use super::error::UnitError;
use super::symbols::{Prefix, Symbol, from_name, suggestions};
use super::synonyms::{PURE_NUMBER, advice};

/// The maximum length of a unit text, in bytes.
pub(super) const MAX_TEXT_LENGTH: usize = 200;
/// The maximum depth of nested parentheses; it bounds the recursion.
const MAX_NESTING: usize = 8;
/// The maximum absolute value of a written power.
const MAX_POWER: f64 = 12.0;
/// Signs that some people write for a missing unit.
const DASHES: [&str; 3] = ["-", "\u{2013}", "\u{2014}"];

/// A symbol with its prefix and power, such as the `mm2` of `N/mm2` (with power -2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Factor {
    /// The prefix, which may be empty.
    pub prefix: Prefix,
    /// The symbol with its size and dimension.
    pub symbol: Symbol,
    /// The power. It is negative if the text divides by the factor.
    pub power: f64,
}

impl Factor {
    /// Returns the prefix and symbol without the power: `mm`.
    pub(super) fn name(&self) -> String {
        format!("{}{}", self.prefix.name, self.symbol.name)
    }

    /// Returns the factor raised to a power.
    pub(super) fn raised(self, power: f64) -> Self {
        Self { power: self.power * power, ..self }
    }
}

/// Parses a unit text into factors in the order of the text. A pure number has no factors.
pub(super) fn parse_factors(text: &str) -> Result<Vec<Factor>, UnitError> {
    if text.len() > MAX_TEXT_LENGTH {
        let message = format!("a unit has at most {MAX_TEXT_LENGTH} characters");
        return Err(UnitError::new(0..text.len(), message));
    }
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    if DASHES.contains(&text.trim()) {
        let message = format!("{} is not a unit", text.trim());
        return Err(UnitError::new(0..text.len(), message).with_hint(PURE_NUMBER));
    }
    let mut parser = Parser { text, at: 0, depth: 0 };
    let factors = parser.quotient()?;
    match parser.peek() {
        None => Ok(factors),
        Some(_) => Err(parser.unexpected()),
    }
}

/// The text of a unit and the position of the parser in it.
struct Parser<'t> {
    /// The whole text. Errors contain ranges of its bytes.
    text: &'t str,
    /// The byte position of the next character.
    at: usize,
    /// The number of open parentheses.
    depth: usize,
}

impl Parser<'_> {
    /// Parses a product, and the factors by which it is divided.
    fn quotient(&mut self) -> Result<Vec<Factor>, UnitError> {
        let mut factors = self.product()?;
        while self.take(&['/']) {
            let start = self.at;
            let divisor = self.factor()?;
            factors.extend(divisor.into_iter().map(|factor| factor.raised(-1.0)));
            self.reject_product_after_slash(start)?;
        }
        Ok(factors)
    }

    /// Parses factors that are separated by blanks, `*` or a middle dot.
    fn product(&mut self) -> Result<Vec<Factor>, UnitError> {
        let mut factors = self.factor()?;
        while self.has_next_factor()? {
            factors.extend(self.factor()?);
        }
        Ok(factors)
    }

    /// Whether another factor of the product follows. The sign of multiplication is consumed.
    fn has_next_factor(&mut self) -> Result<bool, UnitError> {
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

    /// Returns the error if another factor follows the divisor that starts at byte `start`.
    ///
    /// The hint contains the text for either meaning.
    ///
    /// Some readers take "kg/m s2" for kg/(m s2), others for (kg/m) s2, so the text is an error.
    fn reject_product_after_slash(&mut self, start: usize) -> Result<(), UnitError> {
        let divisor_end = self.at;
        if !self.has_next_factor()? {
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

    /// Parses one factor: the number 1, a symbol or a group in parentheses, with its power.
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

    /// Parses a quotient in parentheses. A power after it is applied to every factor inside.
    fn group(&mut self) -> Result<Vec<Factor>, UnitError> {
        let start = self.at;
        self.depth += 1;
        if self.depth > MAX_NESTING {
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
        Ok(inner.into_iter().map(|factor| factor.raised(power)).collect())
    }

    /// Parses the number 1; any other number is an error.
    fn one(&mut self) -> Result<Vec<Factor>, UnitError> {
        let range = self.take_while(|letter| letter.is_ascii_digit() || letter == '.');
        match &self.text[range.clone()] {
            "1" => Ok(Vec::new()),
            number => {
                let message = format!("the number {number} is not allowed in a unit");
                let hint = "only 1 is, as in 1/s; a power follows its unit without a blank";
                Err(UnitError::new(range, message).with_hint(hint))
            }
        }
    }

    /// Parses a symbol with its prefix and power. The sign `%` is a symbol by itself.
    fn symbol(&mut self) -> Result<Vec<Factor>, UnitError> {
        let range = match self.peek() {
            Some('%') => self.at..self.at + 1,
            _ => self.take_while(is_name_letter),
        };
        self.at = range.end;
        let name = &self.text[range.clone()];
        let (prefix, symbol) = from_name(name).ok_or_else(|| unknown_unit(name, range))?;
        let power = self.power()?;
        Ok(vec![Factor { prefix, symbol, power }])
    }

    /// Parses an optional power; without one the power is 1.
    fn power(&mut self) -> Result<f64, UnitError> {
        let start = self.at;
        let superscript = self.take_while(|letter| plain_superscript(letter).is_some());
        if !superscript.is_empty() {
            let plain: String = self.text[superscript].chars().filter_map(plain_superscript).collect();
            return self.power_value(&plain, start);
        }
        let has_caret = self.take(&['^']);
        let digits = self.take_while(|letter| letter.is_ascii_digit() || matches!(letter, '-' | '.'));
        if digits.is_empty() && !has_caret {
            return Ok(1.0);
        }
        self.power_value(&self.text[digits], start)
    }

    /// Converts the digits of a power to a number. `start` is the first byte of the power, for errors.
    fn power_value(&self, digits: &str, start: usize) -> Result<f64, UnitError> {
        let range = start..self.at;
        let power: f64 = digits.parse().map_err(|_| {
            let message = format!("{} is not a power", &self.text[range.clone()]);
            UnitError::new(range.clone(), message)
                .with_hint("a power is written s2, s^2 or s-1; a product m s or m*s")
        })?;
        if power.abs() > MAX_POWER {
            let message = format!("a power is at most {MAX_POWER}");
            return Err(UnitError::new(range, message));
        }
        Ok(power)
    }

    /// Returns the next character; `None` at the end of the text.
    fn peek(&self) -> Option<char> {
        self.text[self.at..].chars().next()
    }

    /// Consumes the next character if it is one of `signs`.
    fn take(&mut self, signs: &[char]) -> bool {
        let found = self.peek().filter(|letter| signs.contains(letter));
        self.at += found.map_or(0, char::len_utf8);
        found.is_some()
    }

    /// Consumes characters while `belongs` holds and returns their bytes.
    fn take_while(&mut self, belongs: impl Fn(char) -> bool) -> Range<usize> {
        let start = self.at;
        let rest = &self.text[start..];
        self.at += rest.find(|letter| !belongs(letter)).unwrap_or(rest.len());
        start..self.at
    }

    /// Skips blanks and returns whether there were any.
    fn skip_blanks(&mut self) -> bool {
        !self.take_while(char::is_whitespace).is_empty()
    }

    /// Returns the error for the next character if it is not allowed at its position.
    fn unexpected(&self) -> UnitError {
        let letter = self.peek();
        let end = self.at + letter.map_or(0, char::len_utf8);
        let shown = letter.map(String::from).unwrap_or_default();
        UnitError::new(self.at..end, format!("{shown} is not allowed here")).with_hint(match letter {
            Some('°' | '℃' | '℉') => "temperatures are in K, and degrees of an angle in deg",
            _ => "factors are separated by a blank, * or /, as in N s/m",
        })
    }
}

/// Whether a character can be part of a unit's name.
///
/// A superscript starts a power, so it ends the name.
pub(super) fn is_name_letter(letter: char) -> bool {
    letter.is_alphabetic() && plain_superscript(letter).is_none()
}

/// Whether a text after a name begins with a power without a minus, such as `2`, `^2` or `²`.
pub(super) fn begins_with_power(text: &str) -> bool {
    text.starts_with(|sign: char| sign.is_ascii_digit() || sign == '^' || plain_superscript(sign).is_some())
}

/// Returns the error for a name that is not a unit, with the names that were probably meant.
fn unknown_unit(name: &str, range: Range<usize>) -> UnitError {
    let error = UnitError::new(range, format!("{name} is not a known unit"));
    if let Some((advice, _)) = advice(name) {
        return error.with_hint(advice);
    }
    match suggestions(name).join(" or ") {
        none if none.is_empty() => error,
        meant => error.with_hint(format!("did you mean {meant}?")),
    }
}

/// Returns the plain sign of a superscript digit or minus. `None` for another character.
///
/// # Examples
///
/// ```
/// use patchcord_expr::plain_superscript;
///
/// assert_eq!(['⁻', '²', '2'].map(plain_superscript), [Some('-'), Some('2'), None]);
/// ```
pub fn plain_superscript(letter: char) -> Option<char> {
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
