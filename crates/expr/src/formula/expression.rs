//! The expression tree of a formula.

use std::ops::Range;

use super::callee::Callee;

/// A node of the expression tree and the bytes of the text that it covers.
///
/// # Examples
///
/// ```
/// use patchcord_expr::{Expression, Formula, Operator};
///
/// let formula = Formula::parse("-a * 2")?;
/// let Expression::Binary(operator, left, right) = &formula.root().expression else {
///     panic!("the root is a product");
/// };
/// assert_eq!(*operator, Operator::Multiply);
/// assert_eq!(left.range, 0..2);
/// assert_eq!(right.expression, Expression::Number(2.0));
/// # Ok::<(), patchcord_expr::FormulaError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// The operation, name or number of this node.
    pub expression: Expression,
    /// The bytes of the formula text, including the parentheses around the node.
    pub range: Range<usize>,
}

/// The content of a node.
#[derive(Debug, Clone, PartialEq)]
pub enum Expression {
    /// A number, or the constant `pi`.
    Number(f64),
    /// The name of a quantity. In an equation it ends in its primes, as in `x''`, or in the `(0)` of an initial
    /// value, as in `x'(0)`.
    Name(String),
    /// The operand with the opposite sign.
    Negate(Box<Node>),
    /// A binary operator with its left and right operands.
    Binary(Operator, Box<Node>, Box<Node>),
    /// A function call. The number of arguments is always [`Callee::argument_count`].
    Call(Callee, Vec<Node>),
    /// A function of equations or a table, with its arguments: only in equations. The number of arguments
    /// is [`EquationFunction::argument_count`](crate::EquationFunction::argument_count), and 1 for a table.
    Apply(String, Vec<Node>),
}

/// A binary operator.
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
    /// Returns each name below this node once, in the order of first appearance.
    pub fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        self.collect_names(&mut names);
        names
    }

    /// Returns a copy of the tree with each name replaced by `new_name(name)`, if that is not `None`.
    pub(super) fn renamed(&self, new_name: &impl Fn(&str) -> Option<String>) -> Node {
        let inner = |node: &Node| Box::new(node.renamed(new_name));
        let all = |nodes: &[Node]| nodes.iter().map(|node| node.renamed(new_name)).collect();
        let expression = match &self.expression {
            Expression::Number(value) => Expression::Number(*value),
            Expression::Name(name) => Expression::Name(new_name(name).unwrap_or_else(|| name.clone())),
            Expression::Negate(node) => Expression::Negate(inner(node)),
            Expression::Binary(operator, left, right) => {
                Expression::Binary(*operator, inner(left), inner(right))
            }
            Expression::Call(callee, arguments) => Expression::Call(*callee, all(arguments)),
            Expression::Apply(name, arguments) => Expression::Apply(name.clone(), all(arguments)),
        };
        Node { expression, range: self.range.clone() }
    }

    /// Returns the first node below this one, or this one, that is this name. `None` if there is none.
    pub fn find_name(&self, name: &str) -> Option<&Node> {
        match &self.expression {
            Expression::Name(found) if found == name => Some(self),
            _ => self.operands().into_iter().find_map(|operand| operand.find_name(name)),
        }
    }

    /// Adds the names below this node that `names` does not contain yet, from left to right.
    fn collect_names<'n>(&'n self, names: &mut Vec<&'n str>) {
        match &self.expression {
            Expression::Name(name) if !names.contains(&name.as_str()) => names.push(name),
            _ => self.operands().iter().for_each(|operand| operand.collect_names(names)),
        }
    }

    /// Returns the nodes directly below this one, from left to right. Numbers and names have none.
    fn operands(&self) -> Vec<&Node> {
        match &self.expression {
            Expression::Number(_) | Expression::Name(_) => Vec::new(),
            Expression::Negate(inner) => vec![inner],
            Expression::Binary(_, left, right) => vec![left, right],
            Expression::Call(_, arguments) | Expression::Apply(_, arguments) => arguments.iter().collect(),
        }
    }
}
