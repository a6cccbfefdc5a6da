//! Fig 8.11: friction that falls along a straight line.

use crate::known_problems::runs::record;
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::equations;

#[test]
fn follows_the_equations() {
    assert!(equations::agrees_at("thesis/fig-8-11", &Slideway::thesis(FrictionLaw::Linear)));
    equations::agrees_at_random_settings("thesis/fig-8-11", FrictionLaw::Linear, equations::agrees_at);
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(equations::equals_at_own_step("thesis/fig-8-11", &Slideway::thesis(FrictionLaw::Linear), 2.0));
    equations::equals_at_random_settings("thesis/fig-8-11", FrictionLaw::Linear);
}

#[test]
fn friction_falls_from_fs_to_zero_at_vcl() {
    for vcl in [1.27e-3, 2.54e-3, 3.81e-3] {
        let trace = record("thesis/fig-8-11", &[("VcL", vcl)], 3.0, 1e-3, &["v_o", "friction_level"]);
        let pairs = trace.values("v_o").unwrap().into_iter().zip(trace.values("friction_level").unwrap());
        for (velocity, level) in pairs {
            let expected = 771.0 * (1.0 - velocity.abs() / vcl).max(0.0);
            assert!((level - expected).abs() < 1e-9, "{level} N at {velocity} m/s");
        }
    }
}
