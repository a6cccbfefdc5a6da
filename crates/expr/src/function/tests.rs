//! Unit tests of `function`.

use super::*;

#[test]
fn the_table_is_in_the_order_of_the_enumeration() {
    for (index, entry) in TABLE.iter().enumerate() {
        assert_eq!(entry.function as usize, index, "{}", entry.name);
        assert_eq!(Function::from_name(entry.name), Some(entry.function));
    }
}

#[test]
fn values() {
    assert_eq!(Function::Sqrt.apply(9.0, 0.0), 3.0);
    assert_eq!(Function::Power.apply(2.0, 10.0), 1024.0);
    assert_eq!(Function::Log10.apply(1000.0, 0.0), 3.0);
    assert_eq!(Function::Exp10.apply(3.0, 0.0), 1000.0);
    assert_eq!(Function::Atan2.apply(1.0, 0.0), std::f64::consts::FRAC_PI_2);
    assert!(Function::Sqrt.apply(-1.0, 0.0).is_nan());
}

#[test]
fn derivatives_agree_with_central_differences() {
    let step = 1e-5;
    for function in Function::all() {
        for (a, b) in [(0.3, 1.7), (1.2, 2.5), (2.9, -0.8), (0.05, 3.0)] {
            let value = |a, b| function.apply(a, b);
            let by_a = (value(a + step, b) - value(a - step, b)) / (2.0 * step);
            let by_b = (value(a, b + step) - value(a, b - step)) / (2.0 * step);
            let (exact_a, exact_b) = function.derivative(a, b);
            let near = |found: f64, exact: f64| (found - exact).abs() < 1e-5 * (1.0 + exact.abs());
            assert!(near(by_a, exact_a), "{function:?} {a} {b}: {by_a} {exact_a}");
            assert!(near(by_b, exact_b), "{function:?} {a} {b}: {by_b} {exact_b}");
        }
    }
}

#[test]
fn derivatives_of_power_at_the_edge() {
    assert_eq!(Function::Power.derivative(0.0, 2.0), (0.0, 0.0));
    assert_eq!(Function::Power.derivative(0.0, 0.0), (0.0, 0.0));
    assert_eq!(Function::Power.derivative(-3.0, 2.0), (-6.0, 0.0));
    assert_eq!(Function::Tanh.derivative(1000.0, 0.0), (0.0, 0.0));
}

#[test]
fn slope_bounds_contain_the_derivatives_inside_and_are_attained() {
    for function in Function::all() {
        for (low, high) in [(-2.0, 2.5), (-7.0, -0.5), (0.25, 0.75), (1.0, 9.0), (3.0, 3.0)] {
            let bounds = function.slope_bounds((low, high));
            let slopes = (0..=1000).map(|step| low + (high - low) * f64::from(step) / 1000.0);
            let slopes: Vec<f64> = slopes.map(|at| function.derivative(at, at).0).collect();
            let known = slopes.iter().filter(|slope| !slope.is_nan());
            assert!(
                known.clone().all(|slope| bounds.0 <= *slope && *slope <= bounds.1),
                "{function:?} {low} {high}"
            );
            let (least, most) =
                known.fold((f64::MAX, f64::MIN), |(a, b), slope| (a.min(*slope), b.max(*slope)));
            if bounds.0.is_finite() && bounds.1.is_finite() {
                let gap = (least - bounds.0).max(bounds.1 - most);
                assert!(gap < 1e-4 * (1.0 + bounds.1.abs()), "{function:?} {low} {high}: {gap}");
            }
        }
    }
}
