//! Loops without integrators, with closed solutions.

use super::{
    NO_DRIVE, assert_range, circuit, integral, nothing_stated, planned, product, range_of, solved, sum, term,
};
use crate::graph::{FunctionKind, Operation};
use crate::peaks::network::Tables;
use crate::peaks::solve;

/// The sine and the cosine of a time plus an angle in radians, as nodes 0 and 1.
fn circle(angle: f64) -> Vec<(&'static str, Operation)> {
    vec![("sine", integral(angle.sin(), &[(1.0, 1)])), ("cosine", integral(angle.cos(), &[(-1.0, 0)]))]
}

/// The angle y of a point (cosine, sine) as the solution of cosine sin(y) - sine cos(y) = 0, as node 2.
fn angle_of_circle(angle: f64) -> Vec<(&'static str, Operation)> {
    let function = |kind| Operation::Function { kind, argument: term(1.0, 2) };
    let mut nodes = circle(angle);
    nodes.extend([
        ("y", Operation::Zero(sum(&[(1.0, 5), (-1.0, 6)]))),
        ("sin(y)", function(FunctionKind::Sin)),
        ("cos(y)", function(FunctionKind::Cos)),
        ("cosine sin(y)", product(1, 3)),
        ("sine cos(y)", product(0, 4)),
    ]);
    nodes
}

#[test]
fn coupled_masses_have_the_ranges_of_their_modes() {
    // 2 x'' + y'' = -x and x'' + 2 y'' = -y: the sum swings at 1/sqrt(3) rad/s, the difference at 1 rad/s.
    let nodes = vec![
        ("x", integral(1.0, &[(1.0, 1)])),
        ("x'", integral(0.0, &[(1.0, 4)])),
        ("y", integral(0.0, &[(1.0, 3)])),
        ("y'", integral(0.0, &[(1.0, 5)])),
        ("x''", Operation::Sum(sum(&[(-0.5, 0), (-0.5, 5)]))),
        ("y''", Operation::Sum(sum(&[(-0.5, 2), (-0.5, 4)]))),
    ];
    let slow = 1.0 / 3f64.sqrt();
    let ranges = solved(12.0, nodes);
    assert_range(&ranges, 0, range_of(12.0, |t| 0.5 * ((slow * t).cos() + t.cos())));
    assert_range(&ranges, 2, range_of(12.0, |t| 0.5 * ((slow * t).cos() - t.cos())));
    assert_range(&ranges, 4, range_of(12.0, |t| -0.5 * ((slow * t).cos() / 3.0 + t.cos())));
}

#[test]
fn an_angle_is_followed_over_half_a_turn() {
    assert_range(&solved(3.0, angle_of_circle(0.0)), 2, [0.0, 3.0]);
    // The first angle is the one between -pi and pi. The solution does not jump at pi.
    assert_range(&solved(1.0, angle_of_circle(2.5)), 2, [2.5, 3.5]);
    assert_range(&solved(1.0, angle_of_circle(-2.5)), 2, [-2.5, -1.5]);
}

#[test]
fn a_curved_loop_is_solved_at_every_instant() {
    // y = exp(-y) + sine - 1 is W(1) for a sine of 1, and W(e^2) - 2 for a sine of -1; W is the inverse of w exp(w).
    let nodes = vec![
        ("sine", integral(0.0, &[(1.0, 1)])),
        ("cosine", integral(1.0, &[(-1.0, 0)])),
        ("1", Operation::One),
        ("y", Operation::Sum(sum(&[(1.0, 4), (1.0, 0), (-1.0, 2)]))),
        ("exp(-y)", Operation::Function { kind: FunctionKind::Exp, argument: term(-1.0, 3) }),
    ];
    let (upper, lower) = (0.567_143_290_409_784, 1.557_145_598_997_611 - 2.0);
    assert_range(&solved(7.0, nodes), 3, [lower, upper]);
}

/// The solutions of y^3 - 4 y + 1 = 0, where y is node 1. The left side rises at the first and the last of them.
const CUBIC_ROOTS: [f64; 3] = [-2.114_907_541_476_756, 0.254_101_688_365_052_4, 1.860_805_853_111_703];

/// The nodes of y^3 - 4 y + 1 = 0.
fn cubic() -> Vec<(&'static str, Operation)> {
    vec![
        ("1", Operation::One),
        ("y", Operation::Zero(sum(&[(1.0, 3), (-4.0, 1), (1.0, 0)]))),
        ("y^2", product(1, 1)),
        ("y^3", product(1, 2)),
    ]
}

#[test]
fn the_solution_nearest_to_0_at_which_the_sum_rises_is_taken() {
    assert_range(&solved(1.0, cubic()), 1, [CUBIC_ROOTS[2]; 2]);
}

#[test]
fn a_solution_is_sought_near_its_stated_value() {
    // Near 0.3 the sum falls with y, so an open amplifier leaves this solution.
    for (start, root) in [(-2.0, CUBIC_ROOTS[0]), (1.5, CUBIC_ROOTS[2]), (0.3, CUBIC_ROOTS[2])] {
        let plan = planned(cubic());
        let mut stated = nothing_stated(&plan);
        stated.starts[1] = Some(start);
        let ranges = solve(&plan, &circuit(1.0, NO_DRIVE), &Tables::new(), &stated);
        assert_range(&ranges.unwrap_or_else(|fault| panic!("{fault:?}")), 1, [root; 2]);
    }
}
