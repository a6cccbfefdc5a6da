//! Angles that open amplifiers find, with a range around 0.
//!
//! The angle y of a point (b, a) solves b sin(y) - a cos(y) = 0, and so does the opposite angle. Only one of them may be
//! within ±100 V, because a loop without an integrator must have one solution. If an angle is far from 0, the amplifier
//! gives its distance from the middle of its range, and a summer adds the middle.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use patchcord_core::machines::REFERENCE;
use patchcord_expr::{Dimension, round_significant};

use crate::graph::{FunctionKind, Node, NodeId, Operation, Plan, Sum};
use crate::symbolic::{Fraction, nearest};

/// An angle up to this magnitude, in rad, needs no change: its opposite is outside ±100 V at every scale.
const LARGEST_ANGLE: f64 = 1.0;
/// A range around another value than 0 must be smaller than this share of the range around 0.
const SMALLER: f64 = 0.8;
/// Digits of the middle of a range.
const DIGITS: usize = 2;
/// The opposite angle is outside ±100 V by this factor.
const MARGIN: f64 = 1.02;

/// Centres the ranges of the angles in a plan that are far from 0. The ranges are in SI units by node. Nodes are added at
/// the end.
pub(super) fn centre_angles(plan: &mut Plan, ranges: &mut Vec<[f64; 2]>) {
    for id in plan.ids() {
        let [low, high] = ranges[id.0 as usize];
        let Some(factor) = angle_factor(plan, id) else { continue };
        let (peak, middle) = (low.abs().max(high.abs()), f64::midpoint(low, high));
        if peak * factor > LARGEST_ANGLE && (high - low) / 2.0 < SMALLER * peak {
            centre(plan, ranges, id, round_significant(middle, DIGITS));
        }
    }
}

/// The largest coefficient with which a solution of an open amplifier, or its sum with a constant, is an angle of a sine
/// or a cosine. `None` for other nodes.
fn angle_factor(plan: &Plan, id: NodeId) -> Option<f64> {
    if !matches!(plan.node(id).operation, Operation::Zero(_)) {
        return None;
    }
    plan.ids().filter_map(|function| factor_in(plan, function, id)).reduce(f64::max)
}

/// The coefficient of a node, or of its sum with a constant, in the argument of a sine or a cosine. `None` if `function` is
/// another node.
fn factor_in(plan: &Plan, function: NodeId, id: NodeId) -> Option<f64> {
    match &plan.node(function).operation {
        Operation::Function { kind: FunctionKind::Sin | FunctionKind::Cos, argument }
            if argument.node == id || is_shifted(plan, argument.node, id) =>
        {
            Some(nearest(&argument.coefficient.as_rational()?).abs())
        }
        _ => None,
    }
}

/// Whether a node is the sum of another one and a constant.
fn is_shifted(plan: &Plan, id: NodeId, other: NodeId) -> bool {
    let Operation::Sum(sum) = &plan.node(id).operation else { return false };
    let is_one = |node: &NodeId| plan.node(*node).operation == Operation::One;
    let is_whole = sum.terms.get(&other).is_some_and(|factor| *factor == Fraction::whole(1));
    is_whole && sum.terms.len() == 2 && sum.terms.keys().any(is_one)
}

/// The angles of points that turn by half a turn or more, each with the width of its range in rad. An open amplifier
/// finds none of them: at every scale, the opposite angle is within ±100 V too. The ranges are in SI units by node.
pub(super) fn wide_angles(plan: &Plan, ranges: &[[f64; 2]]) -> Vec<(NodeId, f64)> {
    let width = |id: NodeId| {
        let [low, high] = ranges[id.0 as usize];
        let width = angle_factor(plan, id)? * (high - low);
        (width >= PI && is_angle_of_point(plan, id)).then_some((id, width))
    };
    plan.ids().filter_map(width).collect()
}

/// Whether each term of the equation of a node has its sine or its cosine as a factor.
fn is_angle_of_point(plan: &Plan, id: NodeId) -> bool {
    let Operation::Zero(sum) = &plan.node(id).operation else { return false };
    let is_function = |node: NodeId| factor_in(plan, node, id).is_some();
    sum.terms.keys().all(|node| match plan.node(*node).operation {
        Operation::Product(factors) => factors.into_iter().any(is_function),
        _ => is_function(*node),
    })
}

/// The scale of an angle with which its largest usual magnitude is 100 V, in SI units per volt. `None` if the node is no
/// angle.
pub(super) fn angle_scale(plan: &Plan, id: NodeId) -> Option<f64> {
    Some(LARGEST_ANGLE / REFERENCE / angle_factor(plan, id)?)
}

/// The smallest voltage of the peak of a node at which the opposite angle is outside ±100 V. 0 if the node is no angle.
pub(super) fn least_volts(plan: &Plan, id: NodeId, peak: f64) -> f64 {
    let distance = |factor: f64| PI / factor - peak;
    angle_factor(plan, id).map_or(0.0, |factor| MARGIN * REFERENCE * peak / distance(factor).max(peak))
}

/// Moves the operation of a node to a new node, which is smaller by `middle`. The node becomes a sum of both.
fn centre(plan: &mut Plan, ranges: &mut Vec<[f64; 2]>, id: NodeId, middle: f64) {
    let one = one(plan, ranges);
    let added = NodeId(plan.nodes.len() as u32);
    let terms = BTreeMap::from([(added, Fraction::whole(1)), (one, Fraction::number(middle))]);
    let node = &mut plan.nodes[id.0 as usize];
    let operation = std::mem::replace(&mut node.operation, Operation::Sum(Sum { terms }));
    let sign = if middle < 0.0 { "+" } else { "-" };
    let name = format!("{} {sign} {}", node.name, middle.abs());
    let moved = Node { name, dimension: node.dimension, operation };
    plan.nodes.push(moved);
    ranges.push(ranges[id.0 as usize].map(|end| end - middle));
}

/// The node of the number 1, which is added if the plan has none.
pub(super) fn one(plan: &mut Plan, ranges: &mut Vec<[f64; 2]>) -> NodeId {
    let known = plan.ids().find(|id| plan.node(*id).operation == Operation::One);
    known.unwrap_or_else(|| {
        let one = Node { name: "1".to_owned(), dimension: Dimension::NONE, operation: Operation::One };
        plan.nodes.push(one);
        ranges.push([1.0, 1.0]);
        NodeId(plan.nodes.len() as u32 - 1)
    })
}
