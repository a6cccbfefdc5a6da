//! Texts for error messages: numbers, excerpts of the formula, and lists of values.

use super::expression::{Expression, Node};
use super::scope::Scope;
use crate::number_text::format_shortest;

/// The maximum length of an excerpt, in characters; longer excerpts end in ` ...`.
const MAX_EXCERPT: usize = 40;

/// Returns the text of a node, shortened if it is longer than [`MAX_EXCERPT`].
pub(super) fn excerpt(text: &str, node: &Node) -> String {
    let whole = text.get(node.range.clone()).unwrap_or(text);
    match whole.char_indices().nth(MAX_EXCERPT) {
        Some((end, _)) => format!("{} ...", &whole[..end]),
        None => whole.to_owned(),
    }
}

/// Returns a text without the parentheses around the whole of it: `a + b` for `(a + b)`. The text `(a) + (b)` has none.
pub(super) fn without_parentheses(text: &str) -> &str {
    let Some(inside) = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')) else { return text };
    let mut depth = 0_i32;
    let is_balanced = inside.chars().all(|letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        depth >= 0
    });
    if is_balanced { inside } else { text }
}

/// Lists the values of the given operands: `: a - b is -4 and c is 2`.
///
/// Literal numbers are omitted, since the excerpt already contains them. The text is empty if all
/// operands are literal.
pub(super) fn operand_values(text: &str, operands: &[(&Node, f64)]) -> String {
    let computed = operands.iter().filter(|(node, _)| !is_literal(node));
    format_values(computed.map(|(node, value)| (excerpt(text, node), *value)))
}

/// Lists the values of the names in a node: `: a is 3 and b is 7`.
///
/// The text is empty if the node is itself a name.
pub(super) fn name_values(node: &Node, scope: &dyn Scope) -> String {
    match node.expression {
        Expression::Name(_) => String::new(),
        _ => format_values(
            node.names().into_iter().filter_map(|name| Some((name.to_owned(), scope.value(name)?))),
        ),
    }
}

/// Whether a node is a number, with any number of signs in front.
fn is_literal(node: &Node) -> bool {
    match &node.expression {
        Expression::Number(_) => true,
        Expression::Negate(inner) => is_literal(inner),
        _ => false,
    }
}

/// Joins names and values to the end of a message. The text is empty if there are no values.
fn format_values(values: impl Iterator<Item = (String, f64)>) -> String {
    let sentences: Vec<String> =
        values.map(|(name, value)| format!("{name} is {}", format_shortest(value))).collect();
    if sentences.is_empty() { String::new() } else { format!(": {}", sentences.join(" and ")) }
}
