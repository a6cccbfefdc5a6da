//! Fig 8.14: friction that falls along a square law, without lag.

use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::{circuit_readings, equations};

#[test]
fn follows_the_equations() {
    assert!(equations::agrees_at("thesis/fig-8-14", &Slideway::thesis(FrictionLaw::Square)));
    equations::agrees_at_random_settings("thesis/fig-8-14", FrictionLaw::Square, equations::agrees_at);
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(equations::equals_at_own_step("thesis/fig-8-14", &Slideway::thesis(FrictionLaw::Square), 2.0));
    equations::equals_at_random_settings("thesis/fig-8-14", FrictionLaw::Square);
}

#[test]
fn voltages_at_rest_agree_with_the_text() {
    let volts = circuit_readings::initial_voltages("thesis/fig-8-14", &["X1", "PC1", "M1", "X2", "B2"]);
    let expected = [100.0, 70.7, 50.0, -50.0, 0.0];
    for (found, printed) in volts.iter().zip(expected) {
        assert!((found - printed).abs() < 0.05, "{volts:?}");
    }
}
