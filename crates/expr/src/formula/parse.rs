//! The recursive-descent parser of formulas and equations.
//!
//! Each rule of the grammar is one method of [`Parser`]. A number, a name and a call are leaves or
//! nodes of the tree; parentheses only widen the range of the node inside them.
//!
//! ```text
//! equation := sum "=" sum
//! sum      := product { ( "+" | "-" ) product }
//! product  := signed { ( "*" | "/" ) signed | power }
//! signed   := "-" signed | power
//! power    := primary [ "^" signed ]
//! primary  := number | name | name "(0)" | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! Only an equation may have the initial value `name "(0)"`, and the product without a sign, which does not
//! begin with a number. The module `equation` has the rules that only equations have.

mod ambiguity;
mod equation;

use std::f64::consts::PI;
use std::ops::Range;

use super::callee::Callee;
use super::error::FormulaError;
use super::expression::{Expression, Node, Operator};
use super::language::Language;
use super::synonyms;
use super::tokens::{PRIME, Token, TokenKind, tokenize};
use crate::units::{Unit, nearest};
use ambiguity::{Factor, ambiguous_product};

/// The maximum length of a formula or an equation, in bytes. It bounds the time that a broken file can cost.
const MAX_TEXT_LENGTH: usize = 2000;
/// The maximum depth of nesting. It keeps the recursion of the parser, and of every later walk over
/// the tree, far below the limit of the stack.
const MAX_NESTING: usize = 200;

/// The hint for a unit after a number. It can also be meant as the name of a quantity.
const UNIT_HINT: &str = "numbers have no units in formulas; a product is written with *";

/// Parses a formula and returns the root of its expression tree.
pub(super) fn root(text: &str) -> Result<Node, FormulaError> {
    let mut parser = Parser::new(text, Language::Formula, &[])?;
    let root = parser.sum()?;
    match parser.current().kind {
        TokenKind::End => Ok(root),
        _ => Err(parser.superfluous()),
    }
}

/// Parses an equation and returns the roots of its left and right sides. `tables` has the names of the
/// tables that it can apply.
pub(super) fn sides(text: &str, tables: &[&str]) -> Result<(Node, Node), FormulaError> {
    let mut parser = Parser::new(text, Language::Equation, tables)?;
    let left = parser.sum()?;
    parser.equals_sign()?;
    let right = parser.sum()?;
    parser.end_of_equation()?;
    Ok((left, right))
}

/// The tokens of a formula or an equation and the position of the parser in them.
struct Parser<'t> {
    /// The text of the formula, for names and error messages.
    text: &'t str,
    /// The language of the text.
    language: Language,
    /// The names of the tables that an equation can apply.
    tables: &'t [&'t str],
    /// Never empty; the last token is the end.
    tokens: Vec<Token>,
    /// The index of the current token.
    at: usize,
    /// The number of calls of [`Parser::signed`] that are in progress.
    depth: usize,
}

impl<'t> Parser<'t> {
    /// Splits a text into tokens. A text that is empty or too long is an error.
    fn new(text: &'t str, language: Language, tables: &'t [&'t str]) -> Result<Self, FormulaError> {
        if text.len() > MAX_TEXT_LENGTH {
            let message = format!("{} has at most {MAX_TEXT_LENGTH} bytes", language.noun());
            return Err(FormulaError::new(0..text.len(), message));
        }
        let parser = Parser { text, language, tables, tokens: tokenize(text, language)?, at: 0, depth: 0 };
        match parser.current().kind {
            TokenKind::End => Err(FormulaError::new(0..text.len(), language.empty_message())),
            _ => Ok(parser),
        }
    }

    /// Parses terms joined by `+` and `-`. They associate to the left: `a - b - c` is `(a - b) - c`.
    fn sum(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.product()?;
        while let Some(operator) = self.take_operator(&['+', '-']) {
            left = binary(operator, left, self.product()?);
        }
        Ok(left)
    }

    /// Parses factors joined by `*` and `/`. They associate to the left.
    ///
    /// In an equation a factor may also follow without a sign, except after a division.
    fn product(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.signed()?;
        let mut factors = vec![Factor { operator: None, range: left.range.clone() }];
        loop {
            let operator = self.take_operator(&['*', '/']);
            if operator.is_none() && !self.begins_implied_factor() {
                break;
            }
            // A factor without a sign is no negative one; this method counts its depth.
            let right = self.signed()?;
            if operator == Some(Operator::Divide) {
                self.check_quotient(&left, &right)?;
            }
            factors.push(Factor { operator, range: right.range.clone() });
            left = binary(operator.unwrap_or(Operator::Multiply), left, right);
        }
        match ambiguous_product(self.text, &factors, &|name| self.has_name(name)) {
            Some(error) => Err(error),
            None => Ok(left),
        }
    }

    /// Whether the text contains a name, also with primes.
    fn has_name(&self, name: &str) -> bool {
        let mut names = self.tokens.iter().filter(|token| token.kind == TokenKind::Name);
        names.any(|token| self.text_of(&token.range).trim_end_matches(PRIME) == name)
    }

    /// Parses an operand with any number of minus signs in front.
    ///
    /// A sign binds less strongly than a power, so `-a^2` is `-(a^2)`.
    ///
    /// Every kind of nesting calls this method, so the depth is counted here.
    fn signed(&mut self) -> Result<Node, FormulaError> {
        self.depth += 1;
        if self.depth > MAX_NESTING {
            let range = self.current().range.clone();
            let (message, hint) = self.language.nesting_message();
            return Err(FormulaError::new(range, message).with_hint(hint));
        }
        let node = match self.take('-') {
            Some(sign) => negated(sign, self.signed()?),
            None => self.power()?,
        };
        self.depth -= 1;
        Ok(node)
    }

    /// Parses an operand with an optional exponent.
    ///
    /// The exponent may have a sign and another exponent, so powers associate to the right.
    fn power(&mut self) -> Result<Node, FormulaError> {
        let base = self.primary()?;
        match self.take('^') {
            Some(_) => Ok(binary(Operator::Power, base, self.signed()?)),
            None => Ok(base),
        }
    }

    /// Parses a number, a name, a call or a group in parentheses.
    fn primary(&mut self) -> Result<Node, FormulaError> {
        let Token { kind, range } = self.current().clone();
        match kind {
            TokenKind::Number(value) => {
                self.at += 1;
                let expression = Expression::Number(value);
                Ok(Node { expression, range })
            }
            TokenKind::Name => {
                self.at += 1;
                self.name_or_call(range)
            }
            TokenKind::Sign('(') => self.group(),
            TokenKind::Sign(_) | TokenKind::End => Err(self.missing_operand()),
        }
    }

    /// Parses a sum in parentheses. The range of its node includes the parentheses.
    fn group(&mut self) -> Result<Node, FormulaError> {
        let open = self.current().range.clone();
        self.at += 1;
        let inner = self.sum()?;
        let end = self.close(&open)?;
        Ok(Node { range: open.start..end, ..inner })
    }

    /// Parses what follows a name: an argument list makes it a call, and `pi` is a number.
    fn name_or_call(&mut self, range: Range<usize>) -> Result<Node, FormulaError> {
        if self.language == Language::Equation {
            return self.equation_name(range);
        }
        let name = self.text_of(&range);
        let expression = match (self.take('('), name) {
            (Some(open), _) => return self.call(range, &open),
            (None, "pi") => Expression::Number(PI),
            (None, _) => Expression::Name(name.to_owned()),
        };
        Ok(Node { expression, range })
    }

    /// Parses a call after its opening parenthesis, and checks the number of arguments.
    ///
    /// `name` is the range of the function's name, and `open` is that of the parenthesis.
    fn call(&mut self, name: Range<usize>, open: &Range<usize>) -> Result<Node, FormulaError> {
        let called = self.text_of(&name);
        let callee = Callee::from_name(called).ok_or_else(|| unknown_function(called, name.clone()))?;
        let arguments = self.arguments()?;
        let range = name.start..self.close(open)?;
        if arguments.len() != callee.argument_count() {
            return Err(wrong_argument_count(called, callee.argument_count(), arguments.len(), range));
        }
        let expression = Expression::Call(callee, arguments);
        Ok(Node { expression, range })
    }

    /// Parses arguments separated by commas, up to the closing parenthesis. The list may be empty.
    fn arguments(&mut self) -> Result<Vec<Node>, FormulaError> {
        if self.current().kind == TokenKind::Sign(')') {
            return Ok(Vec::new());
        }
        let mut arguments = vec![self.sum()?];
        while self.take(',').is_some() {
            arguments.push(self.sum()?);
        }
        Ok(arguments)
    }

    /// Consumes the closing parenthesis and returns the byte after it.
    fn close(&mut self, open: &Range<usize>) -> Result<usize, FormulaError> {
        if let Some(close) = self.take(')') {
            return Ok(close.end);
        }
        Err(match self.current().kind {
            TokenKind::End => FormulaError::new(open.clone(), "this parenthesis is not closed"),
            _ => self.superfluous(),
        })
    }

    /// Returns the token that is parsed next.
    fn current(&self) -> &Token {
        &self.tokens[self.at]
    }

    /// Returns the text of a range.
    fn text_of(&self, range: &Range<usize>) -> &'t str {
        &self.text[range.clone()]
    }

    /// Consumes the current token and returns its range if it is this sign.
    fn take(&mut self, sign: char) -> Option<Range<usize>> {
        let current = self.current();
        let found = (current.kind == TokenKind::Sign(sign)).then(|| current.range.clone());
        self.at += usize::from(found.is_some());
        found
    }

    /// Consumes the current token if it is one of these signs, and returns its operator.
    fn take_operator(&mut self, signs: &[char]) -> Option<Operator> {
        let sign = signs.iter().find(|sign| self.take(**sign).is_some())?;
        Some(match sign {
            '+' => Operator::Add,
            '-' => Operator::Subtract,
            '*' => Operator::Multiply,
            _ => Operator::Divide,
        })
    }

    /// Returns the error for a place where an operand must follow. A second sign gets a hint.
    fn missing_operand(&self) -> FormulaError {
        let range = self.current().range.clone();
        let hint = match self.current().kind {
            TokenKind::Sign('+') => Some("a positive number is written without a sign".to_owned()),
            TokenKind::Sign('*') => Some("a power is written with ^".to_owned()),
            TokenKind::Sign('=') => Some("an equation has a left and a right side".to_owned()),
            _ => None,
        };
        FormulaError::new(range, "a number, a name or a parenthesis is missing here").with_hint_if(hint)
    }

    /// Returns the error for a token that follows a complete expression.
    fn superfluous(&self) -> FormulaError {
        let Token { kind, range } = self.current().clone();
        let written = self.text_of(&range);
        match kind {
            TokenKind::Sign(')') => FormulaError::new(range, "this parenthesis has no opening parenthesis"),
            TokenKind::Sign(',') => FormulaError::new(range, "a comma is not allowed here")
                .with_hint("a comma separates arguments; decimals are written with a point"),
            TokenKind::Sign('=') => FormulaError::new(range, "= is not allowed inside parentheses")
                .with_hint("close the parenthesis before the ="),
            _ => FormulaError::new(range, format!("an operator is missing before {written}"))
                .with_hint(self.product_hint()),
        }
    }

    /// Returns the hint for a token where an operator is missing. In an equation it is a number.
    fn product_hint(&self) -> &'static str {
        match self.language {
            Language::Equation => "a product of numbers is written with *, and a power with ^",
            Language::Formula if self.is_unit_of_number() => UNIT_HINT,
            Language::Formula => "a product is written with *",
        }
    }

    /// Whether the current token is the name of a unit and follows a number, as in `2 mm`.
    fn is_unit_of_number(&self) -> bool {
        let follows_number =
            self.tokens[..self.at].last().is_some_and(|token| matches!(token.kind, TokenKind::Number(_)));
        let Token { kind, range } = self.current();
        follows_number && *kind == TokenKind::Name && Unit::parse(self.text_of(range)).is_ok()
    }
}

/// Joins two operands. The range of the node extends from the first to the last byte of both.
fn binary(operator: Operator, left: Node, right: Node) -> Node {
    Node {
        range: left.range.start..right.range.end,
        expression: Expression::Binary(operator, Box::new(left), Box::new(right)),
    }
}

/// Puts a minus sign, at the bytes `sign`, in front of an operand.
fn negated(sign: Range<usize>, inner: Node) -> Node {
    Node { range: sign.start..inner.range.end, expression: Expression::Negate(Box::new(inner)) }
}

/// Returns the error for a call of an unknown function: it is one of other languages, it is misspelt, or a
/// `*` is missing.
fn unknown_function(name: &str, range: Range<usize>) -> FormulaError {
    let similar = || nearest(name, Callee::all().map(Callee::name));
    let hint = match synonyms::advice(name) {
        Some(advice) => advice.to_owned(),
        None => match similar() {
            Some(near) => format!("did you mean {near}?"),
            None => format!("a product is written {name} * ( ... )"),
        },
    };
    FormulaError::new(range, format!("{name} is not a function")).with_hint(hint)
}

/// Returns the error for a call with `found` arguments instead of `wanted`. `range` is that of the whole
/// call.
fn wrong_argument_count(name: &str, wanted: usize, found: usize, range: Range<usize>) -> FormulaError {
    let hint = format!("write {name}({})", vec![" ... "; wanted].join(","));
    let wanted = match wanted {
        1 => "1 argument".to_owned(),
        several => format!("{several} arguments"),
    };
    FormulaError::new(range, format!("{name} takes {wanted}, not {found}")).with_hint(hint)
}
