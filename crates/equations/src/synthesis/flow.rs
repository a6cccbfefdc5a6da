//! The order of the elements of a patch: along the flow of the signals.

use crate::graph::{NodeId, Operation, Plan};

/// The nodes in the order of their elements: the quantities in the order of the problem, each after the nodes that it
/// reads. An integrator does not wait for the integrators that it reads, because these form loops.
pub(super) fn signal_flow(plan: &Plan) -> Vec<NodeId> {
    let mut order = Vec::with_capacity(plan.nodes.len());
    let mut is_reached = vec![false; plan.nodes.len()];
    for id in plan.quantities.iter().map(|quantity| quantity.node).chain(plan.ids()) {
        // The second part says whether the inputs of the node are in the order already.
        let mut open = vec![(id, false)];
        while let Some((id, has_inputs)) = open.pop() {
            if has_inputs {
                order.push(id);
            } else if !std::mem::replace(&mut is_reached[id.0 as usize], true) {
                open.push((id, true));
                let inputs = plan.node(id).operation.inputs().into_iter().rev();
                open.extend(inputs.filter(|input| !is_integral(plan, *input)).map(|input| (input, false)));
            }
        }
    }
    order
}

/// Whether a node is an integral.
fn is_integral(plan: &Plan, id: NodeId) -> bool {
    matches!(plan.node(id).operation, Operation::Integral { .. })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use patchcord_expr::Dimension;

    use super::*;
    use crate::graph::{Node, PlannedQuantity, Sum};
    use crate::symbolic::{Fraction, Symbols};

    /// A sum of these nodes.
    fn sum(nodes: &[u32]) -> Sum {
        let terms = nodes.iter().map(|node| (NodeId(*node), Fraction::whole(1)));
        Sum { terms: terms.collect::<BTreeMap<_, _>>() }
    }

    /// The order of nodes with these operations, of which some are quantities.
    fn order(operations: Vec<Operation>, quantities: &[u32]) -> Vec<u32> {
        let node = |operation| Node { name: String::new(), dimension: Dimension::NONE, operation };
        let quantity = |node: &u32| PlannedQuantity { name: format!("q{node}"), node: NodeId(*node) };
        let nodes = operations.into_iter().map(node).collect();
        let quantities = quantities.iter().map(quantity).collect();
        signal_flow(&Plan { symbols: Symbols::default(), nodes, quantities }).iter().map(|id| id.0).collect()
    }

    /// The integral of these nodes.
    fn integral(nodes: &[u32]) -> Operation {
        Operation::Integral { initial: Fraction::zero(), rate: sum(nodes) }
    }

    #[test]
    fn the_parts_of_a_quantity_come_before_it() {
        // x' = v, v' = -x^2 - force, force = x abs(v)
        let operations = vec![
            Operation::One,
            integral(&[2]),
            integral(&[3, 5]),
            Operation::Sum(sum(&[4])),
            Operation::Product([NodeId(1), NodeId(6)]),
            Operation::Product([NodeId(1), NodeId(1)]),
            Operation::Absolute(NodeId(2)),
        ];
        assert_eq!(order(operations, &[1, 2, 3]), [1, 6, 4, 3, 5, 2, 0]);
    }

    #[test]
    fn a_loop_without_an_integral_has_an_order() {
        let operations = vec![
            Operation::Zero(sum(&[0, 1])),
            Operation::Absolute(NodeId(0)),
            Operation::Absolute(NodeId(1)),
        ];
        assert_eq!(order(operations, &[2]), [0, 1, 2]);
    }

    #[test]
    fn a_long_chain_needs_no_recursion() {
        let count = 100_000;
        let operations = (0..count).map(|index| Operation::Absolute(NodeId((index + 1).min(count - 1))));
        let found = order(operations.collect(), &[0]);
        assert_eq!((found[0], found.len()), (count - 1, count as usize));
    }
}
