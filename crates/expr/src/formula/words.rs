use super::expression::{Expression, Node};
use super::scope::Scope;

const LONGEST_EXCERPT: usize = 40;

/// A number as it would be written in a formula, without loss.
pub(super) fn number(value: f64) -> String {
    match value.abs() {
        0.0 | 1e-4..1e7 => value.to_string(),
        _ => format!("{value:e}"),
    }
}

/// How a part was written, shortened if it is long.
pub(super) fn excerpt(text: &str, node: &Node) -> String {
    let whole = text.get(node.range.clone()).unwrap_or(text);
    match whole.char_indices().nth(LONGEST_EXCERPT) {
        Some((end, _)) => format!("{} ...", &whole[..end]),
        None => whole.to_owned(),
    }
}

/// `: a - b is -4 and c is 2`, the values of the given parts; numbers are left out, and nothing
/// remains if there is no other part.
pub(super) fn values_of_parts(text: &str, parts: &[(&Node, f64)]) -> String {
    let telling = parts.iter().filter(|(node, _)| !is_literal(node));
    listed(telling.map(|(node, value)| (excerpt(text, node), *value)))
}

/// `: a is 3 and b is 7`, the values of the names in a part, unless the part is a name itself.
pub(super) fn values_of_names(node: &Node, scope: &dyn Scope) -> String {
    match node.expression {
        Expression::Name(_) => String::new(),
        _ => listed(node.names().into_iter().filter_map(|name| Some((name.to_owned(), scope.value(name)?)))),
    }
}

fn is_literal(node: &Node) -> bool {
    match &node.expression {
        Expression::Number(_) => true,
        Expression::Negate(inner) => is_literal(inner),
        _ => false,
    }
}

fn listed(values: impl Iterator<Item = (String, f64)>) -> String {
    let sentences: Vec<String> = values.map(|(what, value)| format!("{what} is {}", number(value))).collect();
    if sentences.is_empty() { String::new() } else { format!(": {}", sentences.join(" and ")) }
}
