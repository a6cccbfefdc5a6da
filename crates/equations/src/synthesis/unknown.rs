//! Scales of nodes that are 0 during the whole run, so that their peaks are not known.
//!
//! For a chain of integrators the equal coefficient rule estimates them: in x'' = -a0 x, the peak of x' is the natural
//! frequency sqrt(a0) times that of x (A. S. Jackson, Analog Computation, McGraw-Hill 1960; thesis 8.2). A sine and an
//! angle have a natural range. Other nodes get a scale with which their largest input or their first user has a gain near
//! 1.

use patchcord_core::machines::REFERENCE;

use super::centred::angle_scale;
use super::input::Input;
use super::rescaled::is_forced;
use super::round::roundest;
use crate::graph::{FunctionKind, NodeId, Operation, Sum};
use crate::symbolic::Fraction;

/// An estimated scale is rounded within this factor.
const MARGIN: f64 = 1.4;

/// Fills in the scales that are missing, in SI units by node. Those of nodes that follow from others stay missing.
pub(super) fn fill_unknown(input: &Input<'_>, per_volt: &mut [Option<f64>]) {
    for id in input.plan.ids().filter(|id| is_chosen(input, *id)) {
        let scale = &mut per_volt[id.0 as usize];
        *scale = scale.or_else(|| natural_scale(input, id));
    }
    for chain in chains(input) {
        fill_chain(input, &chain, per_volt);
    }
    let mut is_changed = true;
    while is_changed {
        is_changed = false;
        for id in input.plan.ids().filter(|id| is_chosen(input, *id)) {
            if per_volt[id.0 as usize].is_none()
                && let Some(scale) =
                    from_inputs(input, id, per_volt).or_else(|| from_users(input, id, per_volt))
            {
                per_volt[id.0 as usize] = Some(rounded(input, id, scale));
                is_changed = true;
            }
        }
    }
    for id in input.plan.ids().filter(|id| is_chosen(input, *id)) {
        per_volt[id.0 as usize].get_or_insert_with(|| input.unit(id).factor());
    }
}

/// Whether the scale of a node is chosen, and not fixed or computed.
pub(super) fn is_chosen(input: &Input<'_>, id: NodeId) -> bool {
    let operation = input.operation(id);
    *operation != Operation::One && !is_forced(operation)
}

/// The scale of a node with a natural range in SI units per volt: 100 V is 1 for a sine or a cosine, and about 1 rad for
/// an angle that an open amplifier finds. `None` for other nodes.
fn natural_scale(input: &Input<'_>, id: NodeId) -> Option<f64> {
    match input.operation(id) {
        Operation::Function { kind: FunctionKind::Sin | FunctionKind::Cos, .. } => Some(1.0 / REFERENCE),
        _ => angle_scale(&input.plan, id).map(|scale| rounded(input, id, scale)),
    }
}

/// A scale in SI units, rounded in the unit of the node.
fn rounded(input: &Input<'_>, id: NodeId, scale: f64) -> f64 {
    let unit = input.unit(id).factor();
    roundest(scale / unit / MARGIN, scale / unit * MARGIN) * unit
}

/// The sum in an operation, if it has one.
fn sum_of(operation: &Operation) -> Option<&Sum> {
    match operation {
        Operation::Sum(sum) | Operation::Limited { sum, .. } | Operation::Integral { rate: sum, .. } => {
            Some(sum)
        }
        _ => None,
    }
}

/// The largest contribution of one volt of an input to the sum of a node. `None` if no scale of an input is known.
fn from_inputs(input: &Input<'_>, id: NodeId, per_volt: &[Option<f64>]) -> Option<f64> {
    let terms = sum_of(input.operation(id))?.terms.iter().filter(|(node, _)| **node != id);
    let contribution =
        |(node, c): (&NodeId, &Fraction)| Some(input.expressions.value(c).abs() * per_volt[node.0 as usize]?);
    terms.filter_map(contribution).filter(|scale| is_usable(*scale)).reduce(f64::max)
}

/// The scale with which the first user of a node has a gain of 1. `None` if no user has a scale.
fn from_users(input: &Input<'_>, id: NodeId, per_volt: &[Option<f64>]) -> Option<f64> {
    input.plan.ids().filter(|user| *user != id).find_map(|user| {
        let coefficient = sum_of(input.operation(user))?.terms.get(&id)?;
        let scale = per_volt[user.0 as usize]? / input.expressions.value(coefficient).abs();
        is_usable(scale).then_some(scale)
    })
}

/// Whether a number can be a scale.
fn is_usable(scale: f64) -> bool {
    scale.is_normal() && scale > 0.0
}

/// The chains of integrators: x, x', x'' and so on. Each node is the integral of the next one with the coefficient 1.
fn chains(input: &Input<'_>) -> Vec<Vec<NodeId>> {
    let next: Vec<Option<NodeId>> = input.plan.ids().map(|id| next_in_chain(input, id)).collect();
    let is_first = |id: &NodeId| !next.contains(&Some(*id)) && next[id.0 as usize].is_some();
    let chain = |first: NodeId| {
        let mut chain = vec![first];
        while let Some(following) = next[chain[chain.len() - 1].0 as usize]
            && !chain.contains(&following)
        {
            chain.push(following);
        }
        chain
    };
    input.plan.ids().filter(is_first).map(chain).collect()
}

/// The integral of which a node is the integral with the coefficient 1.
fn next_in_chain(input: &Input<'_>, id: NodeId) -> Option<NodeId> {
    let Operation::Integral { rate, .. } = input.operation(id) else { return None };
    let (node, coefficient) = rate.terms.first_key_value().filter(|_| rate.terms.len() == 1)?;
    let is_integral = matches!(input.operation(*node), Operation::Integral { .. });
    (is_integral && *coefficient == Fraction::whole(1)).then_some(*node)
}

/// Fills in the missing scales of a chain of integrators by the equal coefficient rule, if one of its scales is known.
fn fill_chain(input: &Input<'_>, chain: &[NodeId], per_volt: &mut [Option<f64>]) {
    let known = chain.iter().position(|id| per_volt[id.0 as usize].is_some());
    let (Some(known), Some(frequency)) = (known, natural_frequency(input, chain)) else { return };
    let Some(scale) = per_volt[chain[known].0 as usize] else { return };
    for (order, id) in chain.iter().enumerate() {
        let estimate = scale * frequency.powi(order as i32 - known as i32);
        if per_volt[id.0 as usize].is_none() && is_usable(estimate) {
            per_volt[id.0 as usize] = Some(rounded(input, *id, estimate));
        }
    }
}

/// The geometric mean (a0 / an)^(1/n) of the equation an x^(n) + ... + a0 x = 0 of a chain, in rad/s. `None` if the
/// highest derivative does not contain x.
fn natural_frequency(input: &Input<'_>, chain: &[NodeId]) -> Option<f64> {
    let (first, last) = (chain.first()?, chain.last()?);
    let Operation::Integral { rate, .. } = input.operation(*last) else { return None };
    let coefficient = input.expressions.value(rate.terms.get(first)?).abs();
    Some(coefficient.powf(1.0 / chain.len() as f64)).filter(|frequency| is_usable(*frequency))
}
