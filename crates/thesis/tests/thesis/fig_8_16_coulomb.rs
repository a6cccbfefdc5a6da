//! Fig 8.16 with Coulomb friction: a brake in the place of the dead zone.

use std::fs;

use serde_json::Value;

use crate::common::dice::Dice;
use crate::known::runs::{difference, peak, record};
use crate::known::slideway::{Law, Slideway};
use crate::thesis::bench::{self, document};
use crate::thesis::slideway;
use patchcord_core::trace::Trace;

const STEM: &str = "thesis/fig-8-16-coulomb";

/// Share of the peak by which the patch's own step may differ: nothing but the order of the step is left, as standstill,
/// release and the kink at VcL are met exactly. That is 6e-11 at the worst where the velocity does not pass VcL, and
/// 6.2e-9 where it does.
const SMOOTH: f64 = 1e-9;
const OVER_KINKS: f64 = 1e-8;

/// The settings of the cases in crates/core/tests/reference/fig_8_16_coulomb.py, and how closely they must be met.
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

/// The rows of a case: t, v_o, spring_force, memory, whether it stands still.
fn reference(case: usize) -> Vec<Vec<f64>> {
    let table = fs::read_to_string("../core/tests/reference/fig_8_16_coulomb.csv").unwrap();
    let rows = table.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect());
    rows.filter(|row: &Vec<f64>| row[0] == case as f64).map(|row| row[1..].to_vec()).collect()
}

fn column(rows: &[Vec<f64>], column: usize) -> Vec<f64> {
    rows.iter().map(|row| row[column]).collect()
}

fn ran(named: &[(&str, f64)], duration: f64, every: f64) -> Trace {
    let names = ["v_i", "x_error", "v_o", "a_o", "spring_force", "friction_level", "memory"];
    let trace = record(STEM, named, duration, every, &names);
    assert!(bench::lit(&trace).is_empty(), "{named:?}: {:?}", trace.sweeps);
    trace
}

fn braked() -> Slideway {
    Slideway { brake: true, ..Slideway::thesis(Law::Remembered) }
}

#[test]
fn follows_the_equations() {
    assert!(slideway::agrees_at(STEM, &braked()));
    slideway::agrees_at_random_settings(STEM, Law::Remembered, |stem, setting| {
        slideway::agrees_at(stem, &Slideway { brake: true, ..setting.clone() })
    });
}

#[test]
fn equals_the_equations_at_its_own_step() {
    assert!(slideway::equals_at_own_step(STEM, &braked(), 2.0));
}

#[test]
fn agrees_with_events_located_by_scipy() {
    for (case, (named, within)) in CASES.iter().enumerate() {
        let (trace, rows) = (ran(named, 0.3, 1e-3), reference(case));
        for (index, signal) in ["v_o", "spring_force", "memory"].iter().enumerate() {
            let off = difference(&trace.values(signal).unwrap(), &column(&rows, index + 1));
            println!("case {case}, {signal}: {off:.1e} of the peak");
            assert!(off < *within, "case {case}, {signal}: {off:e} of the peak");
        }
    }
}

#[test]
fn what_stands_still_does_not_move_at_all() {
    for (case, (named, _)) in CASES.iter().enumerate() {
        let (trace, rows) = (ran(named, 0.3, 1e-3), reference(case));
        let standing = column(&rows, 4);
        assert!(standing.iter().filter(|stands| **stands == 1.0).count() > 5, "case {case}");
        for signal in ["v_o", "a_o"] {
            for (stands, value) in standing.iter().zip(trace.values(signal).unwrap()) {
                assert!((*stands == 1.0) == (value == 0.0), "case {case}: {signal} is {value}");
            }
        }
    }
}

/// A quantity of the ramp in crates/core/tests/reference/fig_8_16_coulomb_ramp.csv.
fn on_the_ramp(quantity: &str) -> f64 {
    let table = fs::read_to_string("../core/tests/reference/fig_8_16_coulomb_ramp.csv").unwrap();
    let row = table.lines().find_map(|line| line.strip_prefix(quantity)?.strip_prefix(','));
    row.unwrap_or_else(|| panic!("no {quantity}")).parse().unwrap()
}

#[test]
fn ends_its_oscillation_where_scipy_does() {
    let trace = ran(&[], 8.466, 1e-3);
    let (velocity, command) = (trace.values("v_o").unwrap(), trace.values("v_i").unwrap());
    let standing = velocity.iter().filter(|velocity| **velocity == 0.0).count();
    assert_eq!(standing as f64, on_the_ramp("samples standing still"));
    let least = velocity.iter().copied().fold(0.0, f64::min);
    assert!((least - on_the_ramp("least velocity")).abs() < OVER_KINKS * peak(&velocity), "{least}");
    for (threshold, named) in [(0.1e-3, "0.1"), (0.25e-3, "0.25"), (0.5e-3, "0.5")] {
        let swing = bench::swing(&velocity);
        let last = swing.iter().rposition(|swing| *swing > threshold).unwrap();
        let expected = on_the_ramp(&format!("critical velocity at {named} mm/s"));
        // One sample of the ramp is 1.2 um/s.
        assert!((command[last] - expected).abs() < 1.3e-6, "{} against {expected}", command[last]);
    }
}

#[test]
fn stands_still_until_the_spring_overcomes_friction() {
    let mut dice = Dice(816);
    let mut stood = 0;
    for _ in 0..20 {
        let setting = Slideway::random(Law::Remembered, &mut dice);
        let trace =
            record(STEM, &setting.changes(), 0.2, 1e-3, &["v_o", "a_o", "spring_force", "friction_level"]);
        if !bench::lit(&trace).is_empty() {
            continue;
        }
        let [velocity, acceleration, spring, level] =
            ["v_o", "a_o", "spring_force", "friction_level"].map(|name| trace.values(name).unwrap());
        for row in 0..velocity.len() {
            if velocity[row] == 0.0 {
                stood += 1;
                assert!(spring[row].abs() <= level[row] * (1.0 + 1e-12), "{setting:?} at {row} ms");
                assert_eq!(acceleration[row], 0.0);
            }
        }
    }
    assert!(stood > 300, "{stood} samples stand still");
}

/// Integral of a product of signals over the recorded samples.
fn integral(every: f64, integrand: impl Fn(usize) -> f64, rows: usize) -> f64 {
    (1..rows).map(|row| 0.5 * every * (integrand(row - 1) + integrand(row))).sum()
}

#[test]
fn energy_goes_in_through_the_drive_and_out_through_friction() {
    let every = 2e-5;
    let trace = ran(&[("v_start", 1e-3), ("v_rate", 0.0)], 0.5, every);
    let [command, error, velocity, spring, level] =
        ["v_i", "x_error", "v_o", "spring_force", "friction_level"].map(|name| trace.values(name).unwrap());
    let (rows, slideway) = (trace.len(), Slideway::thesis(Law::Remembered));
    let driven = integral(every, |row| spring[row] * command[row], rows);
    let rubbed = integral(
        every,
        |row| slideway.viscous * velocity[row].powi(2) + level[row] * velocity[row].abs(),
        rows,
    );
    let stored = |row: usize| {
        0.5 * slideway.mass * velocity[row].powi(2) + 0.5 * slideway.stiffness * error[row].powi(2)
    };
    let off = (driven - rubbed - (stored(rows - 1) - stored(0))) / rubbed;
    println!("driven {driven} J, rubbed {rubbed} J, off by {off:e}");
    // The trapezoidal rule at 20 us is off by about (h w)^2 / 12 = 3e-6 at w = 322 rad/s.
    assert!(rubbed > 0.1 && off.abs() < 1e-5, "{driven} J, {rubbed} J, {off:e}");
}

#[test]
fn acceleration_is_what_the_forces_say() {
    let trace = ran(&[("v_start", 0.5e-3)], 0.5, 1e-3);
    let [velocity, acceleration, spring, level] =
        ["v_o", "a_o", "spring_force", "friction_level"].map(|name| trace.values(name).unwrap());
    let slideway = Slideway::thesis(Law::Remembered);
    for row in (0..trace.len()).filter(|row| velocity[*row] != 0.0) {
        let force = spring[row] - slideway.viscous * velocity[row] - level[row] * velocity[row].signum();
        let off = acceleration[row] - force / slideway.mass;
        assert!(off.abs() < 1e-11, "{off} at {row} ms");
    }
}

#[test]
fn everything_but_friction_is_fig_8_16() {
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
