//! What an unknown name of an equation means in another notation: a derivative, or a product without a space.

use super::scope::EquationScope;
use patchcord_expr::{Scope, nearest, split_primes};

/// The ends of names that mean a derivative, with its order. An end that contains another one comes first.
const DERIVATIVE_ENDS: [(&str, usize); 8] = [
    ("_dddot", 3),
    ("_ddot", 2),
    ("_dot", 1),
    ("dddot", 3),
    ("ddot", 2),
    ("dot", 1),
    ("_prime", 1),
    ("prime", 1),
];
/// Beginnings and ends of names that mean a derivative, such as `dxdt`, with its order.
const DIFFERENTIALS: [(&str, &str, usize); 4] =
    [("d2", "dt2", 2), ("d", "dt", 1), ("d", "_dt", 1), ("d2", "_dt2", 2)];
/// The largest number of factors of a product that is looked for.
const MAX_FACTORS: usize = 3;
/// The largest length of a name that is rather a product than a misspelt name.
const MAX_PRODUCT_LETTERS: usize = 4;

/// The hint for an unknown name, with its primes, that has a meaning in another notation. `None` for other names.
pub(super) fn other_notation(scope: &EquationScope<'_>, name: &str) -> Option<String> {
    let (base, order) = split_primes(name);
    derivative(scope, base, order).or_else(|| product(scope, name))
}

/// The hint for a name such as `x_dot`. `order` is the number of primes after it.
fn derivative(scope: &EquationScope<'_>, base: &str, order: usize) -> Option<String> {
    let is_variable = |stem: &str| !stem.is_empty() && scope.is_variable(stem);
    let ends = DERIVATIVE_ENDS.iter().map(|(end, own)| (base.strip_suffix(end), own));
    let differentials = DIFFERENTIALS
        .iter()
        .map(|(begin, end, own)| (base.strip_prefix(begin).and_then(|rest| rest.strip_suffix(end)), own));
    let (stem, own) = ends
        .chain(differentials)
        .find_map(|(stem, own)| Some((stem.filter(|stem| is_variable(stem))?, own)))?;
    Some(format!("write {stem}{}: a prime is a derivative with respect to time", "'".repeat(own + order)))
}

/// The hint for a name that consists of known names, such as kx. The names of a product differ.
fn product(scope: &EquationScope<'_>, name: &str) -> Option<String> {
    let known = scope.names();
    let (base, _) = split_primes(name);
    if base.len() > MAX_PRODUCT_LETTERS && nearest(base, known.iter().copied()).is_some() {
        return None;
    }
    let factors = factors(scope, name, MAX_FACTORS)?;
    let are_different = factors.iter().enumerate().all(|(at, factor)| !factors[..at].contains(factor));
    are_different
        .then(|| format!("write {} for the product: names need a space between them", factors.join(" ")))
}

/// The known names of which a name consists, at most `most`. `None` if it has other parts.
fn factors<'n>(scope: &EquationScope<'_>, name: &'n str, most: usize) -> Option<Vec<&'n str>> {
    if scope.dimension(name).is_some() {
        return Some(vec![name]);
    }
    let most = most.checked_sub(1).filter(|most| *most > 0)?;
    (1..name.len()).rev().find_map(|end| {
        let (first, rest) = name.split_at_checked(end)?;
        scope.dimension(first)?;
        let mut all = vec![first];
        all.extend(factors(scope, rest, most)?);
        Some(all)
    })
}
