//! The trees of equations: their terms, their factors, and how a quantity occurs in them.

use patchcord_expr::{Equation, Expression, Node, Operator};

use super::constants::Constants;

/// A product as its factors.
pub(super) struct Factors<'n> {
    /// Whether the product has a minus sign.
    pub is_negative: bool,
    /// The factors from left to right, and whether each is a divisor.
    pub factors: Vec<(&'n Node, bool)>,
}

/// How a quantity occurs in an expression.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Occurrence {
    /// It does not occur.
    Absent,
    /// The expression is linear in it, and its factor is constant.
    Constant,
    /// The expression is linear in it, and its factor varies.
    Varying,
    /// The expression is not linear in it.
    Nonlinear,
}

/// The terms of a sum, each with whether it is subtracted. An expression that is no sum is its only term.
pub(super) fn terms(node: &Node) -> Vec<(bool, &Node)> {
    let mut terms = Vec::new();
    let mut open = vec![(false, node)];
    while let Some((is_negative, node)) = open.pop() {
        match &node.expression {
            Expression::Binary(Operator::Add, left, right) => {
                open.extend([(is_negative, &**right), (is_negative, &**left)]);
            }
            Expression::Binary(Operator::Subtract, left, right) => {
                open.extend([(!is_negative, &**right), (is_negative, &**left)]);
            }
            Expression::Negate(inner) => open.push((!is_negative, &**inner)),
            _ => terms.push((is_negative, node)),
        }
    }
    terms
}

/// The factors of a product. An expression that is no product is its only factor.
pub(super) fn factors(node: &Node) -> Factors<'_> {
    let mut product = Factors { is_negative: false, factors: Vec::new() };
    let mut open = vec![(node, false)];
    while let Some((node, divides)) = open.pop() {
        match &node.expression {
            Expression::Binary(Operator::Multiply, left, right) => {
                open.extend([(&**right, divides), (&**left, divides)]);
            }
            Expression::Binary(Operator::Divide, left, right) => {
                open.extend([(&**right, !divides), (&**left, divides)]);
            }
            Expression::Negate(inner) => {
                product.is_negative = !product.is_negative;
                open.push((&**inner, divides));
            }
            _ => product.factors.push((node, divides)),
        }
    }
    product
}

/// Whether an expression contains a name.
pub(super) fn contains(node: &Node, name: &str) -> bool {
    node.find_name(name).is_some()
}

/// The name that an expression consists of. `None` for other expressions.
pub(super) fn only_name(node: &Node) -> Option<&str> {
    match &node.expression {
        Expression::Name(name) => Some(name),
        _ => None,
    }
}

/// How a quantity occurs on each side of an equation.
pub(super) fn occurrences(equation: &Equation, name: &str, constants: &Constants) -> [Occurrence; 2] {
    [equation.left(), equation.right()].map(|side| occurrence(side, name, constants))
}

/// How a quantity occurs in an expression.
fn occurrence(node: &Node, name: &str, constants: &Constants) -> Occurrence {
    let of_terms = terms(node).into_iter().map(|(_, term)| match &term.expression {
        _ if !contains(term, name) => Occurrence::Absent,
        Expression::Name(_) => Occurrence::Constant,
        Expression::Binary(Operator::Multiply | Operator::Divide, ..) => in_product(term, name, constants),
        _ => Occurrence::Nonlinear,
    });
    of_terms.max().unwrap_or(Occurrence::Absent)
}

/// How a quantity occurs in a product that contains it.
fn in_product(product: &Node, name: &str, constants: &Constants) -> Occurrence {
    let (own, others): (Vec<_>, Vec<_>) =
        factors(product).factors.into_iter().partition(|(factor, _)| contains(factor, name));
    match own.as_slice() {
        [(factor, false)] => match occurrence(factor, name, constants) {
            Occurrence::Constant if !others.iter().all(|(factor, _)| constants.is_constant(factor)) => {
                Occurrence::Varying
            }
            of_factor => of_factor,
        },
        _ => Occurrence::Nonlinear,
    }
}
