//! The laws of the nodes, with values from their definitions.

use super::{NO_DRIVE, assert_range, circuit, integral, nothing_stated, planned, product, solved, sum, term};
use crate::graph::{FunctionKind, Node, NodeId, Operation, Plan};
use crate::peaks::network::Tables;
use crate::peaks::solve;
use crate::symbolic::{Fraction, SymbolEntry, SymbolKind, Symbols};
use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Patch;
use patchcord_expr::Dimension;

/// The number 1 and a ramp from -2 to 2 in 4 s, as nodes 0 and 1, and further nodes.
fn ramp(nodes: Vec<(&'static str, Operation)>) -> Vec<(&'static str, Operation)> {
    let mut all = vec![("1", Operation::One), ("ramp", integral(-2.0, &[(1.0, 0)]))];
    all.extend(nodes);
    all
}

#[test]
fn every_operation_has_the_range_of_its_definition() {
    let number = Fraction::number;
    let function = |kind, factor| Operation::Function { kind, argument: term(factor, 1) };
    let ranges = solved(
        4.0,
        ramp(vec![
            ("2 - ramp", Operation::Sum(sum(&[(2.0, 0), (-1.0, 1)]))),
            ("square", product(1, 1)),
            ("magnitude", Operation::Absolute(NodeId(17))),
            ("lower", Operation::Lower([term(3.0, 1), term(1.5, 0)])),
            ("higher", Operation::Higher([term(3.0, 1), term(1.5, 0)])),
            ("beyond", Operation::DeadZone { input: NodeId(1), width: term(0.75, 0) }),
            ("sign", Operation::Switch { input: NodeId(1), at_least_0: number(5.0), below_0: number(-3.0) }),
            ("sine", function(FunctionKind::Sin, 1.0)),
            ("cosine", function(FunctionKind::Cos, 1.0)),
            ("exponential", function(FunctionKind::Exp, 0.5)),
            ("above 0", Operation::Sum(sum(&[(3.0, 0), (1.0, 1)]))),
            ("logarithm", Operation::Function { kind: FunctionKind::Ln, argument: term(1.0, 12) }),
            ("root", Operation::Root(sum(&[(1.0, 12)]))),
            ("quotient", Operation::Quotient { dividend: sum(&[(1.0, 1)]), divisor: NodeId(12) }),
            (
                "one bound",
                Operation::Limited { sum: sum(&[(1.0, 1)]), lower: Some(number(0.0)), upper: None },
            ),
            ("below 0", Operation::Sum(sum(&[(-3.0, 0), (1.0, 1)]))),
        ]),
    );
    let expected = [
        [0.0, 4.0],
        [0.0, 4.0],
        [1.0, 5.0],
        [-6.0, 1.5],
        [1.5, 6.0],
        [-1.25, 1.25],
        [-3.0, 5.0],
        [-1.0, 1.0],
        [2f64.cos(), 1.0],
        [(-1f64).exp(), 1f64.exp()],
        [1.0, 5.0],
        [0.0, 5f64.ln()],
        [1.0, 5f64.sqrt()],
        [-2.0, 0.4],
        [0.0, 2.0],
        [-5.0, -1.0],
    ];
    for (node, expected) in expected.into_iter().enumerate() {
        assert_range(&ranges, node + 2, expected);
    }
}

#[test]
fn a_root_follows_a_tank_that_empties() {
    // h' = -sqrt(h) from 4: h = (2 - t/2)^2.
    let nodes = vec![("h", integral(4.0, &[(-1.0, 1)])), ("flow", Operation::Root(sum(&[(1.0, 0)])))];
    let ranges = solved(3.0, nodes);
    assert_range(&ranges, 0, [0.25, 4.0]);
    assert_range(&ranges, 1, [0.5, 2.0]);
}

#[test]
fn a_curve_is_straight_between_its_points_and_continues_outside() {
    let curve = Operation::Curve { table: "spring".to_owned(), input: term(1.0, 1) };
    let plan = planned(ramp(vec![("curve", curve), ("area", integral(0.0, &[(1.0, 2)]))]));
    let tables = Tables::from([("spring".to_owned(), vec![[-1.0, 3.0], [0.5, 4.0], [1.0, 7.0]])]);
    let ranges = solve(&plan, &circuit(4.0, NO_DRIVE), &tables, &nothing_stated(&plan));
    let ranges = ranges.unwrap_or_else(|fault| panic!("{fault:?}"));
    // The first line has the slope 2/3, and the last one 6.
    let first = 3.0 - 2.0 / 3.0;
    assert_range(&ranges, 2, [first, 13.0]);
    // The areas of the four straight pieces.
    assert_range(&ranges, 3, [0.0, 0.5 * (first + 3.0) + 1.5 * 3.5 + 0.5 * 5.5 + 1.0 * 10.0]);
}

#[test]
fn coefficients_have_the_values_of_the_parameters_in_si() {
    let text = r#"{"patchcord": 1, "parameters": {"d": {"value": 3, "unit": "mm"}},
        "scales": {"length": {"per_volt": 1, "unit": "m"}},
        "drives": {"u": {"kind": "step", "height": 1, "scale": "length"}},
        "run": {"for": 1, "step": 0.01}}"#;
    let patch = Patch::parse("p.json", text).unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&patch).unwrap_or_else(|report| panic!("{report}"));
    let mut symbols = Symbols::default();
    let kind = SymbolKind::Parameter(0);
    let entry = SymbolEntry { name: "d".to_owned(), primes: 0, kind, dimension: Dimension::LENGTH };
    let initial = Fraction::symbol(symbols.add(entry, true));
    let operation = Operation::Integral { initial, rate: sum(&[]) };
    let nodes = vec![Node { name: "x".to_owned(), dimension: Dimension::LENGTH, operation }];
    let plan = Plan { symbols, nodes, quantities: Vec::new() };
    let ranges = solve(&plan, &circuit, &Tables::new(), &nothing_stated(&plan));
    assert_range(&ranges.unwrap_or_else(|fault| panic!("{fault:?}")), 0, [3e-3, 3e-3]);
}
