//! Fig 8.16: the final circuit.

use crate::known_problems::runs::record;
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::{circuit_readings, equations};
use patchcord_analysis::instruments::{Criterion, critical_velocity};
use patchcord_core::trace::Trace;

#[test]
fn follows_the_equations() {
    assert!(equations::agrees_at("thesis/fig-8-16", &Slideway::thesis(FrictionLaw::LagBeforeSquare)));
    equations::agrees_at_random_settings(
        "thesis/fig-8-16",
        FrictionLaw::LagBeforeSquare,
        equations::agrees_at,
    );
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(equations::equals_at_own_step(
        "thesis/fig-8-16",
        &Slideway::thesis(FrictionLaw::LagBeforeSquare),
        2.0
    ));
    equations::equals_at_random_settings("thesis/fig-8-16", FrictionLaw::LagBeforeSquare);
}

#[test]
fn voltages_at_rest_agree_with_the_text() {
    let volts = circuit_readings::initial_voltages("thesis/fig-8-16", &["A1", "B1", "PC1", "M1", "X2", "A2"]);
    let expected = [100.0, -100.0, 70.7, 50.0, -50.0, 0.0];
    for (found, printed) in volts.iter().zip(expected) {
        assert!((found - printed).abs() < 0.05, "{volts:?}");
    }
}

/// Amplifier, its largest voltage in the default run, and half a unit of the last known digit.
const PEAKS: &[(&str, f64, f64)] = &[
    ("A6", -0.72, 0.005),
    ("B4", 0.0, 0.0),
    ("B5", 7.21, 0.005),
    ("A5", -18.16, 0.005),
    ("A4", -13.89, 0.005),
    ("A3", -40.0, 0.05),
    ("B3", 40.0, 0.05),
    ("B2", 10.0, 1e-9),
    ("X3", -100.0, 1e-9),
    ("A2", -75.2, 0.05),
    ("A1", 100.0, 1e-9),
    ("B1", -100.0, 1e-9),
    ("M1", 50.0, 1e-9),
    ("X2", -50.0, 1e-9),
];

#[test]
fn default_run_reaches_the_known_peaks_without_overload() {
    let names: Vec<&str> = PEAKS.iter().map(|(name, ..)| *name).collect();
    let trace = record("thesis/fig-8-16", &[], 8.4667, 2e-5, &names);
    assert!(circuit_readings::overloaded_elements(&trace).is_empty(), "{:?}", trace.repetitions);
    for (name, expected, within) in PEAKS {
        let volts = trace.values(name).unwrap();
        let peak = volts.into_iter().fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
        assert!((peak - expected).abs() <= *within, "{name} reaches {peak} V, expected {expected} V");
    }
}

#[test]
fn step_of_0_127_mm_overloads_only_a_stiff_drive() {
    let step = |stiffness: f64| {
        let named = [("K", stiffness), ("v_rate", 0.0), ("x_step", 0.127e-3)];
        record("thesis/fig-8-16", &named, 0.2, 1e-3, &["v_o"])
    };
    assert!(circuit_readings::overloaded_elements(&step(17.86e6)).is_empty());
    let stiff = step(45e6);
    let first = stiff.overloads().next().unwrap();
    assert_eq!((first.element.as_str(), first.time), ("A5", 0.0));
    // 0.127 mm are 126 V at this stiffness.
    assert!((first.peak().unwrap() - 126.0).abs() < 0.5, "{first:?}");
}

/// Time of the turn in s, at 1.2 mm/s2: 4.8 mm/s, above the critical velocity. The remaining motion of the rise is
/// the disturbance from which oscillation grows during the fall.
const TURN: f64 = 4.0;
/// Interval of the recorded samples in s.
const EVERY: f64 = 1e-3;
/// A larger peak-to-peak swing of velocity, in m/s, counts as oscillation.
const THRESHOLD: f64 = 0.25e-3;

/// The run with a rising and falling command.
fn profile() -> Trace {
    let named = [("v_turn", TURN)];
    record("thesis/fig-8-16", &named, 2.0 * TURN, EVERY, &["v_i", "v_o"])
}

#[test]
fn command_rises_and_falls() {
    let trace = profile();
    let (time, commanded) = (&trace.time, trace.values("v_i").unwrap());
    for (time, velocity) in time.iter().zip(commanded) {
        let expected = 1.2e-3 * if *time <= TURN { *time } else { 2.0 * TURN - time };
        assert!((velocity - expected).abs() < 1e-12, "{velocity} at {time} s");
    }
}

#[test]
fn rising_critical_velocity_exceeds_the_falling_one() {
    let trace = profile();
    assert!(circuit_readings::overloaded_elements(&trace).is_empty(), "{:?}", trace.repetitions);
    let (commanded, swing) =
        (trace.values("v_i").unwrap(), circuit_readings::swing(&trace.values("v_o").unwrap()));
    let turn = (TURN / EVERY) as usize;
    let ends = swing[..turn].iter().rposition(|swing| *swing > THRESHOLD).unwrap();
    let begins = turn + swing[turn..].iter().position(|swing| *swing > THRESHOLD).unwrap();
    let (rising, falling) = (commanded[ends], commanded[begins]);
    let criterion = Criterion { threshold: THRESHOLD, window: 40.0 * EVERY };
    let read = critical_velocity(&trace.time, &commanded, &trace.values("v_o").unwrap(), criterion);
    assert_eq!((read.rising, read.falling), (Ok(rising), Ok(falling)), "the instrument must agree");
    assert!((rising - 4.54e-3).abs() < 0.05e-3, "{rising}");
    assert!(falling < 2.54e-3 && falling > 0.0, "{falling}");
}
