//! The reader of formulas.
//!
//! ```text
//! sum     := product { ( "+" | "-" ) product }
//! product := signed { ( "*" | "/" ) signed }
//! signed  := "-" signed | power
//! power   := primary [ "^" signed ]
//! primary := number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```

use std::f64::consts::PI;
use std::ops::Range;

use super::callee::Callee;
use super::error::FormulaError;
use super::expression::{Expression, Node, Operator};
use super::tokens::{Placed, Token, tokens};
use crate::units::nearest;

const LONGEST_TEXT: usize = 2000;
const DEEPEST_NESTING: usize = 200;

/// The expression that a text describes.
pub(super) fn root(text: &str) -> Result<Node, FormulaError> {
    if text.len() > LONGEST_TEXT {
        let message = format!("a formula has at most {LONGEST_TEXT} bytes");
        return Err(FormulaError::new(0..text.len(), message));
    }
    let mut parser = Parser { text, tokens: tokens(text)?, at: 0, depth: 0 };
    if parser.current().token == Token::End {
        return Err(FormulaError::new(0..text.len(), "the formula is empty"));
    }
    let root = parser.sum()?;
    match parser.current().token {
        Token::End => Ok(root),
        _ => Err(parser.superfluous()),
    }
}

struct Parser<'t> {
    text: &'t str,
    /// Never empty, and the last one is the end.
    tokens: Vec<Placed>,
    at: usize,
    depth: usize,
}

impl<'t> Parser<'t> {
    fn sum(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.product()?;
        while let Some(operator) = self.take_operator(&['+', '-']) {
            left = joined(operator, left, self.product()?);
        }
        Ok(left)
    }

    fn product(&mut self) -> Result<Node, FormulaError> {
        let mut left = self.signed()?;
        while let Some(operator) = self.take_operator(&['*', '/']) {
            left = joined(operator, left, self.signed()?);
        }
        Ok(left)
    }

    // Every kind of nesting passes through here, so this is where its depth is counted.
    fn signed(&mut self) -> Result<Node, FormulaError> {
        self.depth += 1;
        if self.depth > DEEPEST_NESTING {
            let range = self.current().range.clone();
            return Err(FormulaError::new(range, "the formula is nested too deeply")
                .with_hint("give a part of it a name of its own"));
        }
        let node = match self.take('-') {
            Some(sign) => negated(sign, self.signed()?),
            None => self.power()?,
        };
        self.depth -= 1;
        Ok(node)
    }

    fn power(&mut self) -> Result<Node, FormulaError> {
        let base = self.primary()?;
        match self.take('^') {
            Some(_) => Ok(joined(Operator::Power, base, self.signed()?)),
            None => Ok(base),
        }
    }

    fn primary(&mut self) -> Result<Node, FormulaError> {
        let Placed { token, range } = self.current().clone();
        match token {
            Token::Number(value) => {
                self.at += 1;
                let expression = Expression::Number(value);
                Ok(Node { expression, range })
            }
            Token::Name => {
                self.at += 1;
                self.name_or_call(range)
            }
            Token::Sign('(') => self.group(),
            Token::Sign(_) | Token::End => Err(self.missing_operand()),
        }
    }

    fn group(&mut self) -> Result<Node, FormulaError> {
        let open = self.current().range.clone();
        self.at += 1;
        let inner = self.sum()?;
        let end = self.close(&open)?;
        Ok(Node { range: open.start..end, ..inner })
    }

    fn name_or_call(&mut self, range: Range<usize>) -> Result<Node, FormulaError> {
        let name = self.written(&range);
        let expression = match (self.take('('), name) {
            (Some(open), _) => return self.call(range, &open),
            (None, "pi") => Expression::Number(PI),
            (None, _) => Expression::Name(name.to_owned()),
        };
        Ok(Node { expression, range })
    }

    fn call(&mut self, name: Range<usize>, open: &Range<usize>) -> Result<Node, FormulaError> {
        let called = self.written(&name);
        let callee = Callee::named(called).ok_or_else(|| no_function(called, name.clone()))?;
        let arguments = self.arguments()?;
        let range = name.start..self.close(open)?;
        if arguments.len() != callee.arguments() {
            return Err(wrong_count(callee, arguments.len(), range));
        }
        let expression = Expression::Call(callee, arguments);
        Ok(Node { expression, range })
    }

    fn arguments(&mut self) -> Result<Vec<Node>, FormulaError> {
        if self.current().token == Token::Sign(')') {
            return Ok(Vec::new());
        }
        let mut arguments = vec![self.sum()?];
        while self.take(',').is_some() {
            arguments.push(self.sum()?);
        }
        Ok(arguments)
    }

    fn close(&mut self, open: &Range<usize>) -> Result<usize, FormulaError> {
        if let Some(close) = self.take(')') {
            return Ok(close.end);
        }
        Err(match self.current().token {
            Token::End => FormulaError::new(open.clone(), "this parenthesis is not closed"),
            _ => self.superfluous(),
        })
    }

    fn current(&self) -> &Placed {
        &self.tokens[self.at]
    }

    fn written(&self, range: &Range<usize>) -> &'t str {
        &self.text[range.clone()]
    }

    fn take(&mut self, sign: char) -> Option<Range<usize>> {
        let placed = self.current();
        let found = (placed.token == Token::Sign(sign)).then(|| placed.range.clone());
        self.at += usize::from(found.is_some());
        found
    }

    fn take_operator(&mut self, signs: &[char]) -> Option<Operator> {
        let sign = signs.iter().find(|sign| self.take(**sign).is_some())?;
        Some(match sign {
            '+' => Operator::Add,
            '-' => Operator::Subtract,
            '*' => Operator::Multiply,
            _ => Operator::Divide,
        })
    }

    fn missing_operand(&self) -> FormulaError {
        let range = self.current().range.clone();
        let hint = match self.current().token {
            Token::Sign('+') => Some("a positive number is written without a sign".to_owned()),
            Token::Sign('*') => Some("a power is written with ^".to_owned()),
            _ => None,
        };
        FormulaError::new(range, "a number, a name or a parenthesis is missing here").with_hint_if(hint)
    }

    /// The error for a token after what could have been the end.
    fn superfluous(&self) -> FormulaError {
        let Placed { token, range } = self.current().clone();
        let written = self.written(&range);
        match token {
            Token::Sign(')') => FormulaError::new(range, "this parenthesis was never opened"),
            Token::Sign(',') => FormulaError::new(range, "a comma cannot stand here")
                .with_hint("a comma separates arguments; decimals are written with a point"),
            _ => FormulaError::new(range, format!("an operator is missing before {written}"))
                .with_hint("a product is written with *"),
        }
    }
}

fn joined(operator: Operator, left: Node, right: Node) -> Node {
    Node {
        range: left.range.start..right.range.end,
        expression: Expression::Binary(operator, Box::new(left), Box::new(right)),
    }
}

fn negated(sign: Range<usize>, inner: Node) -> Node {
    Node { range: sign.start..inner.range.end, expression: Expression::Negate(Box::new(inner)) }
}

fn no_function(name: &str, range: Range<usize>) -> FormulaError {
    let hint = match nearest(name, Callee::all().map(Callee::name)) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("a product is written {name} * ( ... )"),
    };
    FormulaError::new(range, format!("{name} is not a function")).with_hint(hint)
}

fn wrong_count(callee: Callee, found: usize, range: Range<usize>) -> FormulaError {
    let name = callee.name();
    let wanted = match callee.arguments() {
        1 => "1 argument".to_owned(),
        several => format!("{several} arguments"),
    };
    FormulaError::new(range, format!("{name} takes {wanted}, not {found}"))
}
