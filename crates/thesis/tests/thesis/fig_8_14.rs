//! Fig 8.14: friction that falls along a square law, without memory.

use crate::known::slideway::{Law, Slideway};
use crate::thesis::{bench, slideway};

#[test]
fn follows_the_equations() {
    assert!(slideway::agrees_at("thesis/fig-8-14", &Slideway::thesis(Law::Square)));
    slideway::agrees_at_random_settings("thesis/fig-8-14", Law::Square, slideway::agrees_at);
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(slideway::equals_at_own_step("thesis/fig-8-14", &Slideway::thesis(Law::Square), 2.0));
    slideway::equals_at_random_settings("thesis/fig-8-14", Law::Square);
}

#[test]
fn voltages_at_rest_are_those_of_the_setting_up() {
    let volts = bench::volts_at_rest("thesis/fig-8-14", &["X1", "PC1", "M1", "X2", "B2"]);
    let expected = [100.0, 70.7, 50.0, -50.0, 0.0];
    for (found, printed) in volts.iter().zip(expected) {
        assert!((found - printed).abs() < 0.05, "{volts:?}");
    }
}
