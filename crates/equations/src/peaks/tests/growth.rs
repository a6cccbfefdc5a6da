//! Values that begin tiny and grow by many orders: a finite peak has a range.

use super::{assert_range, driven, integral, product, range_of, solved, sum, term};
use crate::graph::{FunctionKind, Operation};

#[test]
fn an_exponential_has_its_last_value_as_peak() {
    let ranges = solved(8.0, vec![("x", integral(1.0, &[(1.0, 0)]))]);
    assert_range(&ranges, 0, [1.0, 8f64.exp()]);
    let ranges = solved(100.0, vec![("x", integral(1.0, &[(1.0, 0)]))]);
    assert_range(&ranges, 0, [1.0, 100f64.exp()]);
}

#[test]
fn a_chain_of_lags_that_starts_at_0_has_a_range() {
    const COUNT: u32 = 20;
    // Node 0 is the number 1, and each lag follows the node before it.
    let mut nodes = vec![("1", Operation::One)];
    nodes.extend((1..=COUNT).map(|node| ("lag", integral(0.0, &[(1.0, node - 1), (-1.0, node)]))));
    let ranges = solved(40.0, nodes);
    // x_n is 1 - exp(-t) (1 + t + t^2/2 + ... + t^(n-1)/(n-1)!).
    let mut power = 1.0;
    let mut partial = 0.0;
    for node in 1..=COUNT {
        partial += power;
        power *= 40.0 / f64::from(node);
        assert_range(&ranges, node as usize, [0.0, 1.0 - (-40f64).exp() * partial]);
    }
}

#[test]
fn a_rod_that_is_heated_at_one_end_has_a_range() {
    const COUNT: u32 = 12;
    // Node 0 is the number 1. The other end is kept at 0.
    let mut nodes = vec![("1", Operation::One)];
    nodes.extend((1..=COUNT).map(|cell| {
        let mut rate = vec![(1.0, cell - 1), (-2.0, cell)];
        if cell < COUNT {
            rate.push((1.0, cell + 1));
        }
        ("cell", integral(0.0, &rate))
    }));
    let ranges = solved(500.0, nodes);
    for cell in 1..=COUNT {
        // The slowest mode has the rate 4 sin^2(pi / 26), so it has died out.
        assert_range(&ranges, cell as usize, [0.0, 1.0 - f64::from(cell) / f64::from(COUNT + 1)]);
    }
}

#[test]
fn a_pulse_far_from_the_start_is_integrated() {
    // x' = exp(-(t - 10)^2) begins with 4e-44 and ends at sqrt(pi).
    let nodes = vec![
        ("1", Operation::One),
        ("t", integral(0.0, &[(1.0, 0)])),
        ("t - 10", Operation::Sum(sum(&[(1.0, 1), (-10.0, 0)]))),
        ("(t - 10)^2", product(2, 2)),
        ("pulse", Operation::Function { kind: FunctionKind::Exp, argument: term(-1.0, 3) }),
        ("x", integral(0.0, &[(1.0, 4)])),
    ];
    let ranges = solved(20.0, nodes);
    assert_range(&ranges, 4, [(-100f64).exp(), 1.0]);
    assert_range(&ranges, 5, [0.0, std::f64::consts::PI.sqrt()]);
}

#[test]
fn a_mass_at_rest_that_is_pushed_late_has_a_range() {
    // x'' = push - 2 x' - x from 1e-17, with a push of 4 mm from 5 s on.
    let drive = r#"{"kind": "step", "height": 4, "at": 5, "scale": "force"}"#;
    let velocity = integral(0.0, &[(1.0, 2), (-2.0, 1), (-1.0, 0)]);
    let push = Operation::Drive("push".to_owned());
    let nodes = vec![("x", integral(1e-17, &[(1.0, 1)])), ("x'", velocity), ("push", push)];
    let ranges = driven(20.0, drive, nodes);
    let since = |t: f64| (t - 5.0).max(0.0);
    let position = |t: f64| 4e-3 * (1.0 - (1.0 + since(t)) * (-since(t)).exp());
    assert_range(&ranges, 0, range_of(20.0, position));
    assert_range(&ranges, 1, [0.0, 4e-3 * (-1f64).exp()]);
}
