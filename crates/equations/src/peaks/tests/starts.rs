//! The values before the run, for plans that are not complete.

use std::collections::BTreeMap;

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Problem;

use super::{integral, planned, product, sum};
use crate::graph::{NodeId, Operation, PlannedQuantity, Sum};
use crate::peaks::{StartError, StartValues, start_values};
use crate::symbolic::Fraction;

/// The values at the start of these nodes. Node 2 is the quantity y, which is in mm and has the initial value 1 mm.
fn started(
    nodes: Vec<(&str, Operation)>,
    angles: &BTreeMap<NodeId, [Sum; 2]>,
) -> Result<StartValues, StartError> {
    let text = r#"{"patchcord": 1,
        "quantities": {"x": {"unit": "mm", "initial": 10}, "y": {"unit": "mm", "initial": 1}},
        "equations": ["x' = -x", "sin(y / x) = 0.1"], "run": {"for": 1, "step": 0.01}}"#;
    let problem = Problem::parse("problem.json", text).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
    let mut plan = planned(nodes);
    plan.quantities.push(PlannedQuantity { name: "y".to_owned(), node: NodeId(2) });
    start_values(&plan, &problem, &circuit, angles)
}

/// The number 1, an integral from this value, and another node y.
fn with_y(x: f64, y: Operation) -> Vec<(&'static str, Operation)> {
    vec![("1", Operation::One), ("x", integral(x, &[(-1.0, 1)])), ("y", y)]
}

#[test]
fn an_implicit_node_is_solved_near_its_initial_value_with_any_sign() {
    // x - y^2 = 0 for x = 9e-6: y is 3 mm and not -3 mm, and the sum falls with 2 y.
    let mut nodes = with_y(9e-6, Operation::Zero(sum(&[(1.0, 1), (-1.0, 3)])));
    nodes.push(("y^2", product(2, 2)));
    let StartValues { values, slopes } = started(nodes, &BTreeMap::new()).unwrap();
    assert!((values[2] - 3e-3).abs() < 1e-14 && (values[3] - 9e-6).abs() < 1e-16, "{values:?}");
    assert_eq!(slopes.keys().copied().collect::<Vec<_>>(), [NodeId(2)]);
    assert!((slopes[&NodeId(2)] + 6e-3).abs() < 1e-8, "{slopes:?}");
}

#[test]
fn an_angle_is_that_of_its_point_and_a_delay_begins_with_its_input() {
    let mut nodes = with_y(-1.0, Operation::Zero(sum(&[(1.0, 2)])));
    let time = Fraction::whole(1);
    nodes.push(("past", Operation::Delay { input: NodeId(2), time, initial: Fraction::zero() }));
    // The point (x, 1) with x = -1.
    let angles = BTreeMap::from([(NodeId(2), [sum(&[(1.0, 0)]), sum(&[(1.0, 1)])])]);
    let StartValues { values, slopes } = started(nodes, &angles).unwrap();
    let angle = 0.75 * std::f64::consts::PI;
    assert!(values[2..].iter().all(|value| (value - angle).abs() < 1e-15), "{values:?}");
    assert!(slopes.is_empty());
}

#[test]
fn an_equation_without_a_solution_is_named() {
    // y^2 + 1 = 0
    let mut nodes = with_y(1.0, Operation::Zero(sum(&[(1.0, 0), (1.0, 3)])));
    nodes.push(("y^2", product(2, 2)));
    let found = started(nodes, &BTreeMap::new());
    assert!(matches!(found, Err(StartError::Unsolved(NodeId(2)))), "{found:?}");
    let infinite = with_y(1.0, Operation::Sum(sum(&[(f64::NAN, 0)])));
    let found = started(infinite, &BTreeMap::new());
    assert!(matches!(&found, Err(StartError::Other(fault)) if fault.message.contains("y")), "{found:?}");
}
