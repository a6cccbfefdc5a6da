//! Removes the stated equations that cannot be checked without a removed signal or drive.

use std::collections::HashSet;

use super::retain;
use crate::document::Span;
use crate::document::tree::{Content, Node};
use patchcord_expr::{Equation, Expression, split_primes};

/// The sections whose names cannot be auxiliary quantities of the equations.
pub(super) const NAME_SECTIONS: [&str; 5] = ["signals", "drives", "elements", "parameters", "scales"];

/// Removes the equations that name a removed quantity, and those that name an auxiliary quantity which a removed
/// equation defines. Returns whether the value of the key "equations" stays. `other_names` are no auxiliary quantities.
pub(super) fn remove_equations(
    equations: &mut Node,
    removed: HashSet<String>,
    other_names: &HashSet<String>,
) -> bool {
    let positions = faulty_equations(equations, removed, other_names);
    match &mut equations.value {
        Content::List(items) => retain(items, |item| !positions.contains(&item.span)),
        _ => !positions.contains(&equations.span),
    }
}

/// The positions of the equations that name a removed quantity. The quantities that they define are then removed too.
fn faulty_equations(
    equations: &Node,
    mut removed: HashSet<String>,
    other_names: &HashSet<String>,
) -> HashSet<Span> {
    let items = match &equations.value {
        Content::List(items) => items.as_slice(),
        _ => std::slice::from_ref(equations),
    };
    let mut stated: Vec<_> = items.iter().filter_map(parsed).collect();
    let mut positions = HashSet::new();
    loop {
        let is_faulty = |(_, equation): &(Span, Equation)| {
            equation.names().into_iter().any(|name| removed.contains(split_primes(name).0))
        };
        let (faulty, rest): (Vec<_>, Vec<_>) = stated.into_iter().partition(is_faulty);
        if faulty.is_empty() {
            return positions;
        }
        for (position, equation) in faulty {
            positions.insert(position);
            let defined = defined_quantity(&equation).filter(|name| !other_names.contains(*name));
            removed.extend(defined.map(str::to_owned));
        }
        stated = rest;
    }
}

/// An equation with its position. `None` if it cannot be read.
fn parsed(item: &Node) -> Option<(Span, Equation)> {
    let Content::Text(text) = &item.value else { return None };
    Some((item.span, Equation::parse(text, &[]).ok()?))
}

/// The name that stands alone on the left of an equation, without primes. `None` if the left side is something else.
fn defined_quantity(equation: &Equation) -> Option<&str> {
    match &equation.left().expression {
        Expression::Name(name) if split_primes(name).0 == name => Some(name),
        _ => None,
    }
}
