//! The parts of a solution alone.

use super::{integral, planned, product, sum, term};
use crate::graph::{FunctionKind, Operation};
use crate::peaks::history::History;
use crate::peaks::law::{Law, Weighted};
use crate::peaks::network::{Network, Tables};
use crate::peaks::order::Block;
use crate::peaks::quartic::{largest_within, quartic};
use crate::peaks::step_control::StepControl;
use crate::peaks::times::RunTimes;

#[test]
fn a_polynomial_of_degree_4_is_reproduced() {
    let polynomial = |s: f64| 2.0 - s + 5.0 * s.powi(2) - 7.0 * s.powi(3) + 3.0 * s.powi(4);
    let values = [0.0, 0.25, 0.5, 0.75, 1.0].map(polynomial);
    for share in [0.1, 0.37, 0.5, 0.99] {
        assert!((quartic(&values, share) - polynomial(share)).abs() < 1e-14);
    }
}

#[test]
fn the_largest_value_between_samples_is_found() {
    let parabola = |s: f64| 1.0 - (s - 0.3).powi(2);
    let share = largest_within(&[0.0, 0.25, 0.5, 0.75, 1.0].map(parabola)).unwrap();
    assert!((share - 0.3).abs() < 1e-12);
    assert_eq!(largest_within(&[0.0, 1.0, 2.0, 3.0, 4.0]), None);
    assert_eq!(largest_within(&[1.0; 5]), None);
}

#[test]
fn a_history_gives_the_value_of_a_delay_ago() {
    // The input is t^2 over steps of 1/2 s.
    let mut history = History::new(1.0, 7.0);
    for step in 0..6 {
        let begin = 0.5 * f64::from(step);
        let values = [0.0, 0.125, 0.25, 0.375, 0.5].map(|since: f64| (begin + since).powi(2));
        history.arrive(begin);
        history.record(begin, begin + 0.5, values);
        if step < 2 {
            assert_eq!((history.value(begin), history.arrival()), (7.0, 1.0));
        } else {
            assert!((history.value(begin + 0.3) - (begin - 0.7).powi(2)).abs() < 1e-14);
            assert_eq!(history.arrival(), f64::INFINITY);
        }
    }
}

#[test]
fn steps_grow_shrink_and_end_at_stops() {
    let times = RunTimes { duration: 10.0, step: 0.01, every: 0.1 };
    let mut control = StepControl::new(times, 0.05);
    assert_eq!(control.length(10.0), 0.01);
    assert_eq!(control.length(0.015), 0.0075);
    assert_eq!(control.length(0.002), 0.002);
    control.adapt(0.01, 1e-9);
    assert_eq!(control.length(10.0), 0.05, "no step is longer than the shortest delay");
    assert!(!control.is_acceptable(0.05, 2.0) && !control.is_shortest(0.05));
    control.adapt(0.05, 32.0);
    assert!((control.length(10.0) - 0.05 * 0.9 / 2.0).abs() < 1e-15);
    control.adapt(0.02, f64::INFINITY);
    assert!((control.length(10.0) - 0.004).abs() < 1e-15);
    assert!(control.is_shortest(1e-12));
}

/// The blocks of a plan: the names of their nodes, those of loops in order of evaluation, with tears in brackets.
fn blocks(nodes: Vec<(&str, Operation)>) -> Vec<String> {
    let plan = planned(nodes);
    let circuit = super::circuit(1.0, super::NO_DRIVE);
    let network = Network::new(&plan, &circuit, &Tables::new()).unwrap_or_else(|fault| panic!("{fault:?}"));
    let name = |node: usize| plan.nodes[node].name.as_str();
    let text = |block: &Block| match block {
        Block::Node(node) => name(*node).to_owned(),
        Block::Loop(entry) => {
            let member = |(node, tear): &(usize, Option<usize>)| match tear {
                Some(_) => format!("[{}]", name(*node)),
                None => name(*node).to_owned(),
            };
            entry.members.iter().map(member).collect::<Vec<_>>().join(" ")
        }
    };
    network.blocks.iter().map(text).collect()
}

#[test]
fn a_value_that_is_not_a_number_is_not_hidden() {
    let terms = [0, 1].map(|node| Weighted { factor: 1.0, node });
    for values in [[f64::NAN, 1.0], [1.0, f64::NAN]] {
        assert!(Law::Higher(terms).value(2, &values).is_nan(), "{values:?}");
        assert!(Law::Lower(terms).value(2, &values).is_nan(), "{values:?}");
    }
    let switch = Law::Switch { input: 0, at_least_0: 1.0, below_0: -1.0 };
    assert!(switch.value(1, &[f64::NAN]).is_nan());
    let curve = Law::Curve { points: vec![[0.0, 1.0], [1.0, 2.0]], input: terms[0] };
    assert!(curve.value(1, &[f64::NAN]).is_nan());
}

#[test]
fn nodes_come_after_their_inputs() {
    let nodes = vec![
        ("c", product(1, 1)),
        ("b", Operation::Sum(sum(&[(2.0, 2)]))),
        ("a", integral(1.0, &[(1.0, 0)])),
    ];
    assert_eq!(blocks(nodes), ["a", "b", "c"]);
}

#[test]
fn loops_are_opened_at_few_nodes() {
    // The sum s is in both loops, through the sine and through the product.
    let nodes = vec![
        ("sine", Operation::Function { kind: FunctionKind::Sin, argument: term(1.0, 2) }),
        ("square", product(2, 2)),
        ("s", Operation::Sum(sum(&[(0.5, 0), (0.1, 1)]))),
    ];
    let found = blocks(nodes);
    assert_eq!(found.len(), 1);
    let members: Vec<&str> = found[0].split(' ').collect();
    assert_eq!(members.len(), 3);
    assert_eq!(members.iter().filter(|member| member.starts_with('[')).collect::<Vec<_>>(), [&"[s]"]);
    assert_eq!(members[2], "[s]", "it is computed again after the others");
}
