//! Fig 8.16 with the lag behind the multiplier, which "did not affect the simulation results at all" (8.3).

use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::equations;

/// The patch.
const STEM: &str = "thesis/fig-8-16-lag-last";

#[test]
fn follows_the_equations() {
    assert!(equations::agrees_at(STEM, &Slideway::thesis(FrictionLaw::LagAfterSquare)));
    equations::agrees_at_random_settings(STEM, FrictionLaw::LagAfterSquare, equations::agrees_at);
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(equations::equals_at_own_step(STEM, &Slideway::thesis(FrictionLaw::LagAfterSquare), 2.0));
    equations::equals_at_random_settings(STEM, FrictionLaw::LagAfterSquare);
}
