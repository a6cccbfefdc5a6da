//! The thesis's patches held against the slideway's equations, at settings of any size.

use crate::common::dice::Dice;
use crate::known::runs::{difference, record};
use crate::known::slideway::{Law, Slideway};
use crate::known::thesis::FINE_STEP;
use crate::thesis::bench;

impl Slideway {
    /// A setting from the ranges of the patches.
    pub fn random(law: Law, dice: &mut Dice) -> Self {
        Slideway {
            mass: dice.logarithmic(180.0, 4000.0),
            stiffness: dice.logarithmic(5e6, 178e6),
            viscous: dice.logarithmic(100.0, 178e3),
            solid: dice.even(1.0, 2000.0),
            vcl: dice.logarithmic(0.254e-3, 50e-3),
            tc: dice.logarithmic(1e-3, 1.0),
            v_start: dice.even(-0.01, 0.01),
            v_rate: dice.even(-3e-3, 3e-3),
            v_turn: dice.even(0.0, 0.4),
            ..Slideway::thesis(law)
        }
    }
}

/// Compared over this time, in seconds, at instants this far apart.
const COMPARED: f64 = 0.2;
const EVERY: f64 = 1e-3;
/// Wiring at its own step and equations at the fine one may differ by this share of the peak velocity;
/// they come to 6.1e-7 at the worst of the settings here.
const TOLERANCE: f64 = 2e-6;

/// Output velocity of the wiring at its own step, unless a lamp lit.
pub fn wired(stem: &str, slideway: &Slideway, duration: f64) -> Option<Vec<f64>> {
    let trace = record(stem, &slideway.changes(), duration, EVERY, &["v_o"]);
    bench::lit(&trace).is_empty().then(|| trace.values("v_o").unwrap())
}

/// Holds the wiring against what the output velocity should be; tells whether it could, no lamp being lit.
fn agrees(stem: &str, slideway: &Slideway, expected: impl Fn() -> Vec<f64>) -> bool {
    let Some(found) = wired(stem, slideway, COMPARED) else { return false };
    let off = difference(&found, &expected());
    assert!(off < TOLERANCE, "{stem} is {off:.1e} off at {slideway:?}");
    true
}

/// Holds the wiring at its own step against the equations at a fine one.
pub fn agrees_at(stem: &str, slideway: &Slideway) -> bool {
    agrees(stem, slideway, || slideway.velocity(COMPARED, EVERY, FINE_STEP))
}

/// The same at 20 random settings at which no lamp lights; few may be lost to overload.
pub fn agrees_at_random_settings(stem: &str, law: Law, check: impl Fn(&str, &Slideway) -> bool) {
    let mut dice = Dice(816);
    let (mut compared, mut skipped) = (0, 0);
    while compared < 20 {
        let could = check(stem, &Slideway::random(law, &mut dice));
        compared += usize::from(could);
        skipped += usize::from(!could);
        assert!(skipped <= 5, "{stem} cannot be compared at {skipped} settings");
    }
}

/// Holds the wiring against the equations at the wiring's own step: nothing but rounding differs.
pub fn equals_at_own_step(stem: &str, slideway: &Slideway, duration: f64) -> bool {
    let Some(found) = wired(stem, slideway, duration) else { return false };
    let off = difference(&found, &slideway.velocity(duration, EVERY, 2e-5));
    assert!(off < 1e-9, "{stem} is {off:.1e} off at {slideway:?}");
    true
}

/// The same at random settings, for a short time: there are some at which the last bit of K comes to 2e-9
/// after 2 s of stick-slip.
pub fn equals_at_random_settings(stem: &str, law: Law) {
    agrees_at_random_settings(stem, law, |stem, slideway| equals_at_own_step(stem, slideway, COMPARED));
}
