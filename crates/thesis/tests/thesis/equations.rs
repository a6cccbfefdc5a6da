//! Comparison of the thesis's patches with the slideway's equations, at random settings.

use crate::common::random::SplitMix64;
use crate::known_problems::runs::{difference, record};
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::known_problems::thesis::FINE_STEP;
use crate::thesis::circuit_readings;

impl Slideway {
    /// A random setting within the ranges of the patches.
    pub(crate) fn random(law: FrictionLaw, random: &mut SplitMix64) -> Self {
        Slideway {
            mass: random.log_uniform(180.0, 4000.0),
            stiffness: random.log_uniform(5e6, 178e6),
            viscous: random.log_uniform(100.0, 178e3),
            solid: random.uniform(1.0, 2000.0),
            vcl: random.log_uniform(0.254e-3, 50e-3),
            tc: random.log_uniform(1e-3, 1.0),
            v_start: random.uniform(-0.01, 0.01),
            v_rate: random.uniform(-3e-3, 3e-3),
            v_turn: random.uniform(0.0, 0.4),
            ..Slideway::thesis(law)
        }
    }
}

/// Duration of a comparison, in s.
const COMPARED: f64 = 0.2;
/// Time between compared samples, in s.
const EVERY: f64 = 1e-3;
/// Permitted difference between the circuit at its own step and the equations at the fine step, as a share of the
/// peak velocity. The largest difference of the settings here is 6.1e-7.
const TOLERANCE: f64 = 2e-6;

/// Output velocity of the circuit at its own step. `None` if an overload lamp lit.
pub(super) fn circuit_velocity(stem: &str, slideway: &Slideway, duration: f64) -> Option<Vec<f64>> {
    let trace = record(stem, &slideway.changes(), duration, EVERY, &["v_o"]);
    circuit_readings::overloaded_elements(&trace).is_empty().then(|| trace.values("v_o").unwrap())
}

/// Compares the circuit with the expected output velocity. Returns false if an overload lamp lit, so that no
/// comparison is possible.
fn agrees(stem: &str, slideway: &Slideway, expected: impl Fn() -> Vec<f64>) -> bool {
    let Some(found) = circuit_velocity(stem, slideway, COMPARED) else { return false };
    let error = difference(&found, &expected());
    assert!(error < TOLERANCE, "{stem} deviates by {error:.1e} at {slideway:?}");
    true
}

/// Compares the circuit at its own step with the equations at a fine step.
pub(super) fn agrees_at(stem: &str, slideway: &Slideway) -> bool {
    agrees(stem, slideway, || slideway.velocity(COMPARED, EVERY, FINE_STEP))
}

/// Compares at 20 random settings at which no overload lamp lights. At most 5 settings may be skipped because of
/// overload.
pub(super) fn agrees_at_random_settings(
    stem: &str,
    law: FrictionLaw,
    check: impl Fn(&str, &Slideway) -> bool,
) {
    let mut random = SplitMix64(816);
    let (mut compared, mut skipped) = (0, 0);
    while compared < 20 {
        let was_compared = check(stem, &Slideway::random(law, &mut random));
        compared += usize::from(was_compared);
        skipped += usize::from(!was_compared);
        assert!(skipped <= 5, "{stem} cannot be compared at {skipped} settings");
    }
}

/// Compares the circuit with the equations at the circuit's own step. Only rounding differs.
pub(super) fn equals_at_own_step(stem: &str, slideway: &Slideway, duration: f64) -> bool {
    let Some(found) = circuit_velocity(stem, slideway, duration) else { return false };
    let error = difference(&found, &slideway.velocity(duration, EVERY, 2e-5));
    assert!(error < 1e-9, "{stem} deviates by {error:.1e} at {slideway:?}");
    true
}

/// Compares with the equations at the circuit's own step, at random settings and for a short time. At some settings
/// an error in the last bit of K grows to 2e-9 after 2 s of stick-slip.
pub(super) fn equals_at_random_settings(stem: &str, law: FrictionLaw) {
    agrees_at_random_settings(stem, law, |stem, slideway| equals_at_own_step(stem, slideway, COMPARED));
}
