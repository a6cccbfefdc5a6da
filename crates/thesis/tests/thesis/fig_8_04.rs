//! Fig 8.4: the linear slideway against its closed solution.

use crate::known::runs::{difference, record};
use crate::known::slideway::{Law, Slideway};
use crate::thesis::{bench, slideway};
use patchcord_analysis::instruments::ringing;

fn is_underdamped(slideway: &Slideway) -> bool {
    slideway.viscous < 2.0 * (slideway.stiffness * slideway.mass).sqrt()
}

/// What the classical Runge-Kutta method at 2e-5 s lags behind on an oscillation, in radians:
/// wn t (wn step)^4 / 120. Nothing else may be wrong.
fn phase_error(slideway: &Slideway, time: f64) -> f64 {
    let wn = (slideway.stiffness / slideway.mass).sqrt();
    wn * time * (wn * 2e-5).powi(4) / 120.0
}

#[test]
fn the_closed_solution_comes_out() {
    let follows = |stem: &str, slideway: &Slideway| {
        let slideway = &Slideway { v_turn: 3600.0, ..slideway.clone() };
        let Some(found) = slideway::wired(stem, slideway, 0.2).filter(|_| is_underdamped(slideway)) else {
            return false;
        };
        let closed: Vec<f64> =
            (0..found.len()).map(|row| slideway.linear_velocity(row as f64 * 1e-3)).collect();
        let off = difference(&found, &closed);
        assert!(off < phase_error(slideway, 0.2), "{off:.1e} off at {slideway:?}");
        true
    };
    assert!(follows("thesis/fig-8-04", &Slideway::step_response(Law::Absent)));
    slideway::agrees_at_random_settings("thesis/fig-8-04", Law::Absent, follows);
}

#[test]
fn the_step_response_reads_198_3_rad_s_and_0_0992() {
    let trace = record("thesis/fig-8-04", &[], 0.25, 2e-4, &["x_o"]);
    let read = ringing(&trace.time, &trace.values("x_o").unwrap()).unwrap();
    assert!((read.natural_frequency - 198.3).abs() < 0.05, "{read:?}");
    assert!((read.damping - 0.0992).abs() < 0.000_05, "{read:?}");
    assert!((read.final_value - 0.127e-3).abs() < 0.000_5e-3, "{read:?}");
}

#[test]
fn pots_stand_where_the_text_sets_them() {
    let pots = |named: &[(&str, f64)]| bench::pots("thesis/fig-8-04", named);
    let near = |found: f64, printed: f64| assert!((found - printed).abs() < 0.001, "{found} {printed}");
    near(pots(&[])["PC6"], 0.1);
    near(pots(&[])["PA4"], 0.1);
    near(pots(&[("K", 45e6)])["PC6"], 0.252);
    // The text rounds 0.3933 to 0.39, and takes the other mass from there.
    near(pots(&[])["PA3"], 0.3933);
    near(pots(&[("M", 810.0)])["PA3"] * 0.39 / 0.3933, 0.218);
}
