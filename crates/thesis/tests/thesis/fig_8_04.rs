//! Fig 8.4: the linear slideway compared with its closed solution.

use crate::known_problems::runs::{difference, record};
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::{circuit_readings, equations};
use patchcord_analysis::instruments::ringing;

/// Whether the slideway oscillates, as the closed solution assumes.
fn is_underdamped(slideway: &Slideway) -> bool {
    slideway.viscous < 2.0 * (slideway.stiffness * slideway.mass).sqrt()
}

/// The phase error of the classical Runge-Kutta method at 2e-5 s on an oscillation, in radians: wn t (wn step)^4 /
/// 120. No other error is permitted.
fn phase_error(slideway: &Slideway, time: f64) -> f64 {
    let wn = (slideway.stiffness / slideway.mass).sqrt();
    wn * time * (wn * 2e-5).powi(4) / 120.0
}

#[test]
fn closed_solution_is_reproduced() {
    let follows = |stem: &str, slideway: &Slideway| {
        let slideway = &Slideway { v_turn: 3600.0, ..slideway.clone() };
        let Some(found) =
            equations::circuit_velocity(stem, slideway, 0.2).filter(|_| is_underdamped(slideway))
        else {
            return false;
        };
        let closed: Vec<f64> =
            (0..found.len()).map(|row| slideway.linear_velocity(row as f64 * 1e-3)).collect();
        let error = difference(&found, &closed);
        assert!(error < phase_error(slideway, 0.2), "deviation {error:.1e} at {slideway:?}");
        true
    };
    assert!(follows("thesis/fig-8-04", &Slideway::step_response(FrictionLaw::Absent)));
    equations::agrees_at_random_settings("thesis/fig-8-04", FrictionLaw::Absent, follows);
}

#[test]
fn step_response_has_198_3_rad_s_and_0_0992() {
    let trace = record("thesis/fig-8-04", &[], 0.25, 2e-4, &["x_o"]);
    let read = ringing(&trace.time, &trace.values("x_o").unwrap()).unwrap();
    assert!((read.natural_frequency - 198.3).abs() < 0.05, "{read:?}");
    assert!((read.damping - 0.0992).abs() < 0.000_05, "{read:?}");
    assert!((read.final_value - 0.127e-3).abs() < 0.000_5e-3, "{read:?}");
}

#[test]
fn pots_are_set_as_in_the_text() {
    let pots = |named: &[(&str, f64)]| circuit_readings::pots("thesis/fig-8-04", named);
    let assert_near = |found: f64, printed: f64| {
        assert!((found - printed).abs() < 0.001, "found {found}, printed {printed}")
    };
    assert_near(pots(&[])["PC6"], 0.1);
    assert_near(pots(&[])["PA4"], 0.1);
    assert_near(pots(&[("K", 45e6)])["PC6"], 0.252);
    // The text rounds 0.3933 to 0.39, and calculates the setting for the other mass from 0.39.
    assert_near(pots(&[])["PA3"], 0.3933);
    assert_near(pots(&[("M", 810.0)])["PA3"] * 0.39 / 0.3933, 0.218);
}
