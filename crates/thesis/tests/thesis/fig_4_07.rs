//! Fig 4.7: velocity profiles of one table with linear friction, with falling friction, and with friction that drops
//! to a constant.

use crate::known_problems::runs::{difference, record};
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::known_problems::thesis::fine_velocity;
use crate::thesis::circuit_readings;
use patchcord_analysis::instruments::{Criterion, CriticalVelocityError, critical_velocity};

/// The patch.
const STEM: &str = "thesis/fig-4-07";
/// The command and the output velocities of the three tables.
const SIGNALS: [&str; 4] = ["v_i", "linear.v_o", "stribeck.v_o", "coulomb.v_o"];

/// The tables of the patch, in the order of its signals.
fn tables() -> [Slideway; 3] {
    let remembered = Slideway::thesis(FrictionLaw::LagBeforeSquare);
    [
        Slideway::thesis(FrictionLaw::Absent),
        Slideway { brake: true, ..remembered },
        Slideway::with_friction_drop(),
    ]
}

#[test]
fn every_table_follows_its_equations() {
    let trace = record(STEM, &[], 0.5, 1e-3, &SIGNALS);
    assert!(circuit_readings::overloaded_elements(&trace).is_empty());
    for (table, signal) in tables().iter().zip(&SIGNALS[1..]) {
        let error = difference(&trace.values(signal).unwrap(), &fine_velocity(table, 0.5, 1e-3));
        assert!(error < 1e-8, "{signal} deviates by {error:e}");
    }
}

#[test]
fn falling_friction_is_fig_8_16_with_a_brake() {
    let ours = record(STEM, &[], 8.466, 1e-3, &["stribeck.v_o"]).values("stribeck.v_o").unwrap();
    let alone = record("thesis/fig-8-16-coulomb", &[], 8.466, 1e-3, &["v_o"]).values("v_o").unwrap();
    // Switching and kinks of the other tables shift the steps.
    assert!(difference(&ours, &alone) < 1e-6, "{:e}", difference(&ours, &alone));
}

/// The curves of Fig 4.6, for a slowly rising command.
#[test]
fn steady_friction_agrees_with_the_laws() {
    let names = ["v_i", "linear.friction", "stribeck.friction", "coulomb.friction"];
    let trace = record(STEM, &[], 8.0, 1e-2, &names);
    let [velocity, linear, stribeck, coulomb] = names.map(|name| trace.values(name).unwrap());
    let falling = |velocity: f64, limit: f64| (1.0 - (velocity / limit).min(1.0)).powi(2);
    for (row, velocity) in velocity.into_iter().enumerate() {
        let viscous = 10.7e3 * velocity;
        let kept = 0.6 * 771.0 + 0.4 * 771.0 * falling(velocity, 0.508e-3);
        let expected = [viscous, viscous + 771.0 * falling(velocity, 2.54e-3), viscous + kept];
        for (found, expected) in [linear[row], stribeck[row], coulomb[row]].into_iter().zip(expected) {
            assert!(
                (found - expected).abs() < 1e-9,
                "got {found} N, expected {expected} N at {velocity} m/s"
            );
        }
    }
}

/// "For the linear friction characteristic the output velocity is always the same as the commanded input velocity".
/// The other two oscillate over a part of the falling range, and the steeper fall ends oscillation at a lower
/// command.
#[test]
fn only_falling_friction_causes_oscillation() {
    let trace = record(STEM, &[], 8.466, 1e-3, &SIGNALS);
    let [command, linear, stribeck, coulomb] = SIGNALS.map(|name| trace.values(name).unwrap());
    let rising = |velocity: &[f64]| {
        let criterion = Criterion { threshold: 0.25e-3, window: 0.04 };
        critical_velocity(&trace.time, &command, velocity, criterion).rising
    };
    assert_eq!(rising(&linear), Err(CriticalVelocityError::NoOscillation));
    let (falls, drops) = (rising(&stribeck).unwrap(), rising(&coulomb).unwrap());
    assert!((falls - 4.65e-3).abs() < 0.02e-3, "{falls}");
    assert!(drops > 0.508e-3 && drops < 0.5 * falls, "{drops}");
    // The velocity lags behind the ramp by the rate times f / K.
    let lag = linear.iter().zip(&command).map(|(velocity, command)| (velocity - command).abs());
    assert!(lag.fold(0.0, f64::max) < 2.0 * 1.2e-3 * (433.0f64 / 45e6).sqrt());
}
