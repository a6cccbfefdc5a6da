//! The positions of quantities, nodes and times in the text of a problem, for diagnostics.

use std::collections::{BTreeSet, VecDeque};

use patchcord_core::document::Span;
use patchcord_core::patch::Problem;
use patchcord_expr::split_primes;

use crate::graph::{NodeId, Plan};

/// The position of a quantity: its declaration, or that of the quantity of which it is a derivative, or else its first
/// appearance in an equation. `None` if the problem does not have the name.
pub(crate) fn quantity_span(problem: &Problem, name: &str) -> Option<Span> {
    let declared = |name: &str| problem.quantities.get(name).map(|quantity| quantity.span);
    let in_equations = || {
        problem.patch.equations.iter().find_map(|placed| {
            let range = placed.value.range_of(name)?;
            // The text of an equation is in quotes.
            Some(placed.span.subspan(&(range.start + 1..range.end + 1)))
        })
    };
    declared(name).or_else(|| declared(split_primes(name).0)).or_else(in_equations)
}

/// The position of what a node computes: that of its quantity, or else of the nearest quantity that depends on it. `None`
/// if no quantity does.
pub(crate) fn node_span(plan: &Plan, problem: &Problem, node: NodeId) -> Option<Span> {
    let (mut queue, mut seen) = (VecDeque::from([node]), BTreeSet::from([node]));
    while let Some(id) = queue.pop_front() {
        if let Some(span) = quantity_span(problem, &plan.node(id).name) {
            return Some(span);
        }
        let reads = |user: &NodeId| plan.node(*user).operation.inputs().contains(&id);
        queue.extend(plan.ids().filter(|user| reads(user) && seen.insert(*user)));
    }
    None
}

/// The position of the length of the run. `None` if the run has none.
pub(crate) fn run_length_span(problem: &Problem) -> Option<Span> {
    problem.patch.run.duration.as_ref().map(|duration| duration.span)
}

#[cfg(test)]
mod tests {
    use patchcord_expr::Dimension;

    use super::*;
    use crate::graph::{Node, Operation, Sum};
    use crate::symbolic::{Fraction, Symbols};

    /// A problem with an auxiliary quantity F that no entry declares.
    const PROBLEM: &str = r#"{"patchcord": 1,
        "parameters": {"m": {"value": 2, "unit": "kg"}, "c": {"value": 3, "unit": "N/m3"}},
        "quantities": {"x": {"unit": "m", "initial": 1}, "x'": {"unit": "m/s", "initial": 0}},
        "equations": ["m x'' = -F", "F = c x^3"], "run": {"for": 25, "step": 0.01}}"#;

    #[test]
    fn a_quantity_is_where_it_is_declared_or_first_used() {
        let problem = Problem::parse("p.json", PROBLEM).unwrap();
        let text = |span: Option<Span>| span.map(|span| &PROBLEM[span.start..span.end]);
        let found = ["x", "x'", "x''", "F", "G"].map(|name| text(quantity_span(&problem, name)));
        assert_eq!(found, [Some("\"x\""), Some("\"x'\""), Some("\"x\""), Some("F"), None]);
        assert_eq!(text(run_length_span(&problem)), Some("25"));
    }

    #[test]
    fn a_node_without_a_name_is_at_the_quantity_that_uses_it() {
        let product = |node: u32| Operation::Product([NodeId(node), NodeId(node)]);
        let sum = |node: u32| Operation::Sum(Sum { terms: [(NodeId(node), Fraction::number(3.0))].into() });
        let nodes =
            [("1", Operation::One), ("1^2", product(0)), ("3 1^2", sum(1)), ("F", sum(2)), ("2", sum(0))];
        let node = |(name, operation): (&str, Operation)| Node {
            name: name.to_owned(),
            dimension: Dimension::NONE,
            operation,
        };
        let nodes = nodes.into_iter().map(node).collect();
        let plan = Plan { symbols: Symbols::default(), nodes, quantities: Vec::new() };
        let problem = Problem::parse("p.json", PROBLEM).unwrap();
        let span = |node: u32| node_span(&plan, &problem, NodeId(node));
        let text = |node: u32| span(node).map(|span| &PROBLEM[span.start..span.end]);
        assert_eq!([1, 2, 3, 4].map(text), [Some("F"), Some("F"), Some("F"), None]);
    }
}
