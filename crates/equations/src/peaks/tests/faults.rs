//! Plans without ranges: the fault names the node and the time.

use super::{NO_DRIVE, integral, outcome, product, sum, term};
use crate::graph::{FunctionKind, NodeId, Operation};
use crate::peaks::fault::{Fault, FaultKind};
use crate::symbolic::Fraction;

/// Asserts that nodes have this fault, at the node with this name and within 2 % of the run of this time.
fn assert_fault(duration: f64, nodes: Vec<(&str, Operation)>, expected: (FaultKind, &str, f64)) {
    let names: Vec<String> = nodes.iter().map(|(name, _)| (*name).to_owned()).collect();
    let found = outcome(duration, NO_DRIVE, nodes);
    let Err(Fault::Node { kind, node, time }) = found else { panic!("{found:?}") };
    assert_eq!((kind, names[node].as_str()), (expected.0, expected.1), "at {time} s");
    assert!((time - expected.2).abs() <= 0.02 * duration, "{time} s instead of {} s", expected.2);
}

/// The number 1 and a ramp from 1 to -1 in 2 s, as nodes 0 and 1, and another node.
fn falling(name: &'static str, operation: Operation) -> Vec<(&'static str, Operation)> {
    vec![("1", Operation::One), ("ramp", integral(1.0, &[(-1.0, 0)])), (name, operation)]
}

#[test]
fn a_state_that_grows_without_bound_is_named() {
    // x' = x^2 from 1 is 1/(1 - t).
    let growing = vec![("x", integral(1.0, &[(1.0, 1)])), ("x^2", product(0, 0))];
    let found = outcome(2.0, NO_DRIVE, growing);
    // The square becomes infinite first.
    let Err(Fault::Node { kind: FaultKind::Unbounded, node: 1, time }) = found else { panic!("{found:?}") };
    assert!((time - 1.0).abs() < 1e-6, "{time}");
    // x' = exp(x) from 0 is -ln(1 - t): the rate becomes infinite, and x is still small.
    let exponential = Operation::Function { kind: FunctionKind::Exp, argument: term(1.0, 0) };
    let growing = vec![("x", integral(0.0, &[(1.0, 1)])), ("exp(x)", exponential)];
    let found = outcome(2.0, NO_DRIVE, growing);
    let Err(Fault::Node { kind: FaultKind::Unbounded, time, .. }) = found else { panic!("{found:?}") };
    assert!((time - 1.0).abs() < 1e-6, "{time}");
    // x' = 100 x from 1 exceeds 1e60 after ln(1e60)/100.
    let unstable = vec![("x", integral(1.0, &[(100.0, 0)]))];
    assert_fault(2.0, unstable, (FaultKind::TooLarge, "x", 1e60f64.ln() / 100.0));
}

#[test]
fn a_divisor_that_reaches_0_is_named() {
    let quotient = Operation::Quotient { dividend: sum(&[(1.0, 0)]), divisor: NodeId(1) };
    assert_fault(2.0, falling("q", quotient.clone()), (FaultKind::Divisor, "ramp", 1.0));
    // The quotient drives a state, which would become infinite.
    let mut driven = falling("q", quotient);
    driven.push(("x", integral(0.0, &[(1.0, 2)])));
    assert_fault(2.0, driven, (FaultKind::Divisor, "ramp", 1.0));
    let zero = vec![
        ("1", Operation::One),
        ("x", integral(0.0, &[(1.0, 0)])),
        ("q", Operation::Quotient { dividend: sum(&[(1.0, 0)]), divisor: NodeId(1) }),
    ];
    assert_fault(2.0, zero, (FaultKind::Divisor, "x", 0.0));
}

#[test]
fn roots_and_logarithms_of_negative_numbers_are_named() {
    let root = falling("root", Operation::Root(sum(&[(1.0, 1)])));
    assert_fault(2.0, root, (FaultKind::NegativeRoot, "root", 1.0));
    let logarithm = Operation::Function { kind: FunctionKind::Ln, argument: term(1.0, 1) };
    assert_fault(2.0, falling("ln", logarithm.clone()), (FaultKind::NegativeLogarithm, "ln", 1.0));
    // The logarithm drives a state, which has no value from then on.
    let mut driven = falling("ln", logarithm.clone());
    driven.push(("x", integral(0.0, &[(1.0, 2)])));
    assert_fault(2.0, driven, (FaultKind::NegativeLogarithm, "ln", 1.0));
    let zero = vec![("1", Operation::One), ("x", integral(0.0, &[(1.0, 0)])), ("ln", logarithm)];
    assert_fault(2.0, zero, (FaultKind::LogarithmOf0, "ln", 0.0));
}

#[test]
fn a_logarithm_in_front_of_a_loop_is_named_before_the_loop() {
    // y = ln(ramp) + y/2
    let logarithm = Operation::Function { kind: FunctionKind::Ln, argument: term(1.0, 1) };
    let mut nodes = falling("ln", logarithm);
    nodes.push(("y", Operation::Sum(sum(&[(1.0, 2), (0.5, 3)]))));
    assert_fault(2.0, nodes, (FaultKind::NegativeLogarithm, "ln", 1.0));
}

#[test]
fn too_large_values_name_the_operation() {
    // The exponential of 1000 is too large for a number.
    let exponential = Operation::Function { kind: FunctionKind::Exp, argument: term(1000.0, 0) };
    let nodes = vec![("1", Operation::One), ("exp", exponential), ("x", integral(0.0, &[(1.0, 1)]))];
    assert_fault(2.0, nodes, (FaultKind::Unbounded, "exp", 0.0));
}

#[test]
fn a_loop_without_a_solution_is_named() {
    // y^2 + 1 = 0
    let never = vec![
        ("1", Operation::One),
        ("y", Operation::Zero(sum(&[(1.0, 2), (1.0, 0)]))),
        ("y^2", product(1, 1)),
    ];
    assert_fault(2.0, never, (FaultKind::Unsolved, "y", 0.0));
    // y^2 = ramp has a solution for 1 s.
    let mut vanishing = falling("y", Operation::Zero(sum(&[(1.0, 3), (-1.0, 1)])));
    vanishing.push(("y^2", product(2, 2)));
    assert_fault(2.0, vanishing, (FaultKind::Unsolved, "y", 1.0));
    // y = y + 1
    let nodes = vec![("1", Operation::One), ("y", Operation::Sum(sum(&[(1.0, 1), (1.0, 0)])))];
    assert_fault(2.0, nodes, (FaultKind::Unsolved, "y", 0.0));
}

#[test]
fn wrong_numbers_are_named() {
    let infinite = vec![("x", Operation::Integral { initial: Fraction::number(f64::NAN), rate: sum(&[]) })];
    assert_fault(1.0, infinite, (FaultKind::Coefficient, "x", 0.0));
    let delay = Operation::Delay { input: NodeId(0), time: Fraction::zero(), initial: Fraction::zero() };
    assert_fault(1.0, vec![("1", Operation::One), ("past", delay)], (FaultKind::Delay, "past", 0.0));
}

#[test]
fn a_solution_with_too_many_steps_stops() {
    // No step is longer than the delay of a millionth of the run.
    let time = Fraction::number(1e-6);
    let delay = Operation::Delay { input: NodeId(0), time, initial: Fraction::whole(1) };
    let found = outcome(1.0, NO_DRIVE, vec![("x", integral(1.0, &[(-1.0, 1)])), ("past", delay)]);
    assert!(matches!(found, Err(Fault::TooLong { time }) if time > 0.1 && time < 0.3), "{found:?}");
}

#[test]
fn a_sum_of_squares_is_not_blamed_for_a_value_that_becomes_infinite() {
    // y falls from 1e4, so 1 + y^2 falls far below its peak. x' = x^2 from 1 is 1/(1 - t).
    let quotient = Operation::Quotient { dividend: sum(&[(1.0, 0)]), divisor: NodeId(3) };
    let growing = vec![
        ("1", Operation::One),
        ("y", integral(1e4, &[(-20.0, 1)])),
        ("y^2", product(1, 1)),
        ("1 + y^2", Operation::Sum(sum(&[(1.0, 0), (1.0, 2)]))),
        ("1/(1 + y^2)", quotient),
        ("x", integral(1.0, &[(1.0, 6)])),
        ("x^2", product(5, 5)),
    ];
    let found = outcome(2.0, NO_DRIVE, growing);
    assert!(
        matches!(found, Err(Fault::Node { kind: FaultKind::Unbounded | FaultKind::TooLarge, .. })),
        "{found:?}"
    );
}
