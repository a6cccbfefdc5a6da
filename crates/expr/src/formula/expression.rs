use std::ops::Range;

use super::callee::Callee;

/// A part of a formula and where it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// What the part is.
    pub expression: Expression,
    /// The bytes of the formula text it covers, with the parentheses around it.
    pub range: Range<usize>,
}

/// What a part of a formula is.
#[derive(Debug, Clone, PartialEq)]
pub enum Expression {
    /// A number, or the constant `pi`.
    Number(f64),
    /// The name of a quantity.
    Name(String),
    /// The part with the opposite sign.
    Negate(Box<Node>),
    /// Two parts joined by an operator.
    Binary(Operator, Box<Node>, Box<Node>),
    /// A function with as many arguments as it takes.
    Call(Callee, Vec<Node>),
}

/// The sign between two parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// `+`
    Add,
    /// `-`
    Subtract,
    /// `*`
    Multiply,
    /// `/`
    Divide,
    /// `^`
    Power,
}

impl Node {
    /// The names that occur in this part, each once, in the order of their first appearance.
    pub fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        self.collect_names(&mut names);
        names
    }

    /// The same part with other names, for those that `other` has one for.
    pub(super) fn renamed(&self, other: &impl Fn(&str) -> Option<String>) -> Node {
        let inner = |node: &Node| Box::new(node.renamed(other));
        let expression = match &self.expression {
            Expression::Number(value) => Expression::Number(*value),
            Expression::Name(name) => Expression::Name(other(name).unwrap_or_else(|| name.clone())),
            Expression::Negate(node) => Expression::Negate(inner(node)),
            Expression::Binary(operator, left, right) => {
                Expression::Binary(*operator, inner(left), inner(right))
            }
            Expression::Call(callee, arguments) => {
                Expression::Call(*callee, arguments.iter().map(|argument| argument.renamed(other)).collect())
            }
        };
        Node { expression, range: self.range.clone() }
    }

    fn collect_names<'n>(&'n self, names: &mut Vec<&'n str>) {
        match &self.expression {
            Expression::Name(name) if !names.contains(&name.as_str()) => names.push(name),
            _ => self.parts().iter().for_each(|part| part.collect_names(names)),
        }
    }

    fn parts(&self) -> Vec<&Node> {
        match &self.expression {
            Expression::Number(_) | Expression::Name(_) => Vec::new(),
            Expression::Negate(inner) => vec![inner],
            Expression::Binary(_, left, right) => vec![left, right],
            Expression::Call(_, arguments) => arguments.iter().collect(),
        }
    }
}
