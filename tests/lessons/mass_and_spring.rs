//! Mass and spring: the period 2 pi sqrt(m / k), and the energy loss of Runge-Kutta.

use std::f64::consts::TAU;

use crate::common::{convergence_order, run_for, voltage};
use crate::known_problems::runs::{program, step_of};
use crate::lessons::crossings::next_rise;
use patchcord::ir::Program;

const STEM: &str = "lessons/mass-and-spring";

#[test]
fn the_period_matches_the_formula() {
    for (m, k) in [(1.0, 40.0), (4.0, 40.0), (1.0, 100.0), (10.0, 1.0f64)] {
        let program = program(STEM, &[("m", m), ("k", k)]);
        let mut machine = run_for(&program, step_of(STEM), 0.0);
        let first = next_rise(&mut machine, |machine| voltage(machine, "B1"));
        let period = next_rise(&mut machine, |machine| voltage(machine, "B1")) - first;
        // The phase error of Runge-Kutta is (omega h)^4 / 120, here 1e-10 at most.
        assert!((period / (TAU * f64::sqrt(m / k)) - 1.0).abs() < 2e-10, "{m} kg, {k} N/m: {period} s");
    }
}

/// Energy in J, from the voltages of velocity and position.
fn energy(program: &Program, step: f64, time: f64) -> f64 {
    let machine = run_for(program, step, time);
    let (v, x) = (voltage(&machine, "A1") * 0.01, voltage(&machine, "A2") * 1e-3);
    0.5 * v * v + 0.5 * 40.0 * x * x
}

#[test]
fn halving_the_step_divides_the_energy_loss_by_32() {
    let (program, time) = (program(STEM, &[]), 20.0);
    let begin = 0.5 * 40.0 * 0.08 * 0.08;
    let steps = [0.02, 0.01, 0.005];
    let losses = steps.map(|step| {
        let loss = 1.0 - energy(&program, step, time) / begin;
        // |R(i z)|^2 of Runge-Kutta 4 is 1 - z^6 / 72 + z^8 / 576, z = omega h (Hairer, Norsett, Wanner).
        let z2 = 40.0 * step * step;
        let per_step = z2.powi(3) / 72.0 - z2.powi(4) / 576.0;
        let expected = 1.0 - (1.0 - per_step).powf(time / step);
        assert!((loss - expected).abs() < 1e-11, "{step}: {loss:e} {expected:e}");
        loss
    });
    let observed = convergence_order(&steps, &losses);
    assert!((4.95..5.05).contains(&observed), "{observed} {losses:?}");
}

#[test]
fn the_multipliers_give_the_initial_energy() {
    for (m, k, x0) in [(1.0, 40.0, 80.0), (2.5, 90.0, -90.0), (10.0, 100.0, 60.0)] {
        let program = program(STEM, &[("m", m), ("k", k), ("x0", x0)]);
        for time in [0.0, 0.13, 1.0, 2.9] {
            let machine = run_for(&program, step_of(STEM), time);
            let millijoule = -voltage(&machine, "B2") * 5.0;
            let begin = 0.5e-3 * k * x0 * x0;
            assert!((millijoule / begin - 1.0).abs() < 1e-9, "{m} kg, {k} N/m after {time} s: {millijoule}");
        }
    }
}
