//! Fig 8.7: constant friction as a dead zone in the spring force.

use crate::known_problems::runs::record;
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::equations;

/// The slideway of the step response with constant friction.
fn step() -> Slideway {
    Slideway::step_response(FrictionLaw::Constant)
}

#[test]
fn follows_the_equations() {
    assert!(equations::agrees_at("thesis/fig-8-07", &step()));
    equations::agrees_at_random_settings("thesis/fig-8-07", FrictionLaw::Constant, equations::agrees_at);
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(equations::equals_at_own_step("thesis/fig-8-07", &step(), 2.0));
    equations::equals_at_random_settings("thesis/fig-8-07", FrictionLaw::Constant);
}

#[test]
fn step_stops_within_fs_over_k_of_the_input() {
    let trace = record("thesis/fig-8-07", &step().changes(), 2.0, 1e-3, &["x_error", "v_o"]);
    let last = |name: &str| *trace.values(name).unwrap().last().unwrap();
    assert!((last("x_error") + 0.0389e-3).abs() < 0.000_05e-3, "{}", last("x_error"));
    assert!(last("x_error").abs() < 771.0 / 17.86e6);
    assert!(last("v_o").abs() < 1e-9);
}
