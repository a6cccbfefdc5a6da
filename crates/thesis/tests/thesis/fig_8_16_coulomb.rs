//! Fig 8.16 with Coulomb friction: a brake in place of the dead zone.

use std::fs;

use serde_json::Value;

use crate::common::random::SplitMix64;
use crate::known_problems::runs::{difference, peak, record};
use crate::known_problems::slideway::{FrictionLaw, Slideway};
use crate::thesis::circuit_readings::{self, document};
use crate::thesis::equations;
use patchcord_core::trace::Trace;

/// The patch.
const STEM: &str = "thesis/fig-8-16-coulomb";

/// Permitted error as a share of the peak, if velocity does not pass VcL. The largest error is 6e-11.
///
/// Standstill, release and the kink at VcL are located exactly, so only the order of the method limits the accuracy.
const SMOOTH: f64 = 1e-9;
/// Permitted error as a share of the peak, if velocity passes VcL. The largest error is 6.2e-9.
const OVER_KINKS: f64 = 1e-8;

/// The settings of the cases in crates/core/tests/reference/fig_8_16_coulomb.py, and their permitted errors.
const CASES: &[(&[(&str, f64)], f64)] = &[
    (&[("v_start", 0.5e-3), ("v_rate", 0.0)], OVER_KINKS),
    (&[("v_start", 1.5e-3)], OVER_KINKS),
    (&[("VcL", 1.27e-3), ("Tc", 0.006), ("v_start", -1e-3), ("v_rate", -1.2e-3)], OVER_KINKS),
    (&[("VcL", 5.08e-3), ("Tc", 0.0095), ("v_rate", 2.4e-3), ("v_start", 2e-3)], OVER_KINKS),
    (&[("VcL", 25.4e-3), ("Tc", 0.025), ("v_start", 3e-3), ("K", 17.86e6), ("M", 454.0)], SMOOTH),
    (
        &[("VcL", 10.16e-3), ("Tc", 0.002), ("v_rate", 0.0), ("v_start", 1e-3), ("f", 2e3), ("Fs", 300.0)],
        SMOOTH,
    ),
    (&[("Tc", 0.5), ("v_start", -1e-3), ("v_rate", 10e-3), ("K", 80e6), ("M", 1000.0)], SMOOTH),
    (&[("v_start", 3e-3), ("v_rate", -20e-3)], OVER_KINKS),
];

/// The rows of a case: t, v_o, spring_force, memory, and 1 if the table is at rest.
fn reference(case: usize) -> Vec<Vec<f64>> {
    let table = fs::read_to_string("../core/tests/reference/fig_8_16_coulomb.csv").unwrap();
    let rows = table.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect());
    rows.filter(|row: &Vec<f64>| row[0] == case as f64).map(|row| row[1..].to_vec()).collect()
}

/// A column of the reference table.
fn column(rows: &[Vec<f64>], column: usize) -> Vec<f64> {
    rows.iter().map(|row| row[column]).collect()
}

/// A run without overload.
fn run_without_overload(changes: &[(&str, f64)], duration: f64, every: f64) -> Trace {
    let names = ["v_i", "x_error", "v_o", "a_o", "spring_force", "friction_level", "memory"];
    let trace = record(STEM, changes, duration, every, &names);
    assert!(circuit_readings::overloaded_elements(&trace).is_empty(), "{changes:?}: {:?}", trace.repetitions);
    trace
}

/// The default slideway with a brake.
fn braked() -> Slideway {
    Slideway { brake: true, ..Slideway::thesis(FrictionLaw::LagBeforeSquare) }
}

#[test]
fn follows_the_equations() {
    assert!(equations::agrees_at(STEM, &braked()));
    equations::agrees_at_random_settings(STEM, FrictionLaw::LagBeforeSquare, |stem, setting| {
        equations::agrees_at(stem, &Slideway { brake: true, ..setting.clone() })
    });
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(equations::equals_at_own_step(STEM, &braked(), 2.0));
}

#[test]
fn agrees_with_events_located_by_scipy() {
    for (case, (changes, max_error)) in CASES.iter().enumerate() {
        let (trace, rows) = (run_without_overload(changes, 0.3, 1e-3), reference(case));
        for (index, signal) in ["v_o", "spring_force", "memory"].iter().enumerate() {
            let error = difference(&trace.values(signal).unwrap(), &column(&rows, index + 1));
            println!("case {case}, {signal}: error {error:.1e} of the peak");
            assert!(error < *max_error, "case {case}, {signal}: error {error:e} of the peak");
        }
    }
}

#[test]
fn velocity_at_rest_is_exactly_zero() {
    for (case, (changes, _)) in CASES.iter().enumerate() {
        let (trace, rows) = (run_without_overload(changes, 0.3, 1e-3), reference(case));
        let at_rest = column(&rows, 4);
        assert!(at_rest.iter().filter(|rests| **rests == 1.0).count() > 5, "case {case}");
        for signal in ["v_o", "a_o"] {
            for (rests, value) in at_rest.iter().zip(trace.values(signal).unwrap()) {
                assert!((*rests == 1.0) == (value == 0.0), "case {case}: {signal} is {value}");
            }
        }
    }
}

/// A reference value of the ramp, from crates/core/tests/reference/fig_8_16_coulomb_ramp.csv.
fn ramp_reference(quantity: &str) -> f64 {
    let table = fs::read_to_string("../core/tests/reference/fig_8_16_coulomb_ramp.csv").unwrap();
    let row = table.lines().find_map(|line| line.strip_prefix(quantity)?.strip_prefix(','));
    row.unwrap_or_else(|| panic!("no {quantity}")).parse().unwrap()
}

#[test]
fn oscillation_ends_as_in_scipy() {
    let trace = run_without_overload(&[], 8.466, 1e-3);
    let (velocity, command) = (trace.values("v_o").unwrap(), trace.values("v_i").unwrap());
    let at_rest = velocity.iter().filter(|velocity| **velocity == 0.0).count();
    assert_eq!(at_rest as f64, ramp_reference("samples standing still"));
    let least = velocity.iter().copied().fold(0.0, f64::min);
    assert!((least - ramp_reference("least velocity")).abs() < OVER_KINKS * peak(&velocity), "{least}");
    for (threshold, named) in [(0.1e-3, "0.1"), (0.25e-3, "0.25"), (0.5e-3, "0.5")] {
        let swing = circuit_readings::swing(&velocity);
        let last = swing.iter().rposition(|swing| *swing > threshold).unwrap();
        let expected = ramp_reference(&format!("critical velocity at {named} mm/s"));
        // One sample of the ramp is 1.2 um/s.
        assert!((command[last] - expected).abs() < 1.3e-6, "got {}, expected {expected}", command[last]);
    }
}

#[test]
fn table_rests_until_the_spring_overcomes_friction() {
    let mut random = SplitMix64(816);
    let mut rests = 0;
    for _ in 0..20 {
        let setting = Slideway::random(FrictionLaw::LagBeforeSquare, &mut random);
        let trace =
            record(STEM, &setting.changes(), 0.2, 1e-3, &["v_o", "a_o", "spring_force", "friction_level"]);
        if !circuit_readings::overloaded_elements(&trace).is_empty() {
            continue;
        }
        let [velocity, acceleration, spring, level] =
            ["v_o", "a_o", "spring_force", "friction_level"].map(|name| trace.values(name).unwrap());
        for row in 0..velocity.len() {
            if velocity[row] == 0.0 {
                rests += 1;
                assert!(spring[row].abs() <= level[row] * (1.0 + 1e-12), "{setting:?} at {row} ms");
                assert_eq!(acceleration[row], 0.0);
            }
        }
    }
    assert!(rests > 300, "{rests} samples at rest");
}

/// Integral of a product of signals over the recorded samples.
fn integral(every: f64, integrand: impl Fn(usize) -> f64, rows: usize) -> f64 {
    (1..rows).map(|row| 0.5 * every * (integrand(row - 1) + integrand(row))).sum()
}

#[test]
fn energy_balance_of_drive_and_friction_holds() {
    let every = 2e-5;
    let trace = run_without_overload(&[("v_start", 1e-3), ("v_rate", 0.0)], 0.5, every);
    let [command, error, velocity, spring, level] =
        ["v_i", "x_error", "v_o", "spring_force", "friction_level"].map(|name| trace.values(name).unwrap());
    let (rows, slideway) = (trace.len(), Slideway::thesis(FrictionLaw::LagBeforeSquare));
    let driven = integral(every, |row| spring[row] * command[row], rows);
    let dissipated = integral(
        every,
        |row| slideway.viscous * velocity[row].powi(2) + level[row] * velocity[row].abs(),
        rows,
    );
    let stored = |row: usize| {
        0.5 * slideway.mass * velocity[row].powi(2) + 0.5 * slideway.stiffness * error[row].powi(2)
    };
    let error = (driven - dissipated - (stored(rows - 1) - stored(0))) / dissipated;
    println!("driven {driven} J, dissipated {dissipated} J, error {error:e}");
    // The error of the trapezoidal rule at 20 us is about (h w)^2 / 12 = 3e-6 at w = 322 rad/s.
    assert!(dissipated > 0.1 && error.abs() < 1e-5, "{driven} J, {dissipated} J, {error:e}");
}

#[test]
fn acceleration_agrees_with_the_forces() {
    let trace = run_without_overload(&[("v_start", 0.5e-3)], 0.5, 1e-3);
    let [velocity, acceleration, spring, level] =
        ["v_o", "a_o", "spring_force", "friction_level"].map(|name| trace.values(name).unwrap());
    let slideway = Slideway::thesis(FrictionLaw::LagBeforeSquare);
    for row in (0..trace.len()).filter(|row| velocity[*row] != 0.0) {
        let force = spring[row] - slideway.viscous * velocity[row] - level[row] * velocity[row].signum();
        let error = acceleration[row] - force / slideway.mass;
        assert!(error.abs() < 1e-11, "{error} at {row} ms");
    }
}

#[test]
fn circuit_differs_from_fig_8_16_only_in_friction() {
    let (thesis, ours) = (document("thesis/fig-8-16"), document(STEM));
    for section in ["parameters", "scales", "drives", "run", "record"] {
        assert_eq!(thesis[section], ours[section], "{section}");
    }
    let elements = |patch: &Value| patch["elements"].as_object().unwrap().clone();
    let (before, after) = (elements(&thesis), elements(&ours));
    let differ = |name: &&String| before.get(*name) != after.get(*name);
    let mut changed: Vec<_> = before.keys().chain(after.keys()).filter(differ).cloned().collect();
    changed.sort();
    changed.dedup();
    assert_eq!(changed, ["A3", "A4", "A7", "DZ", "KM", "KV", "M1", "PA5", "PB", "PX", "X2"]);
    for name in ["M1", "X2"] {
        let without_note = |entry: &Value| {
            let mut entry = entry.as_object().unwrap().clone();
            entry.remove("note");
            entry
        };
        assert_eq!(without_note(&before[name]), without_note(&after[name]), "{name}");
    }
}
