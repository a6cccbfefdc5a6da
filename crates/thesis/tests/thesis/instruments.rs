//! The slideway's instruments on the circuits for which they were made.

use crate::known_problems::runs::record;
use patchcord_analysis::instruments::{Criterion, Cycle, LoopSense, cycles, friction_loop, steady_friction};
use patchcord_core::trace::Trace;

/// Oscillation is a peak-to-peak velocity above 0.25 mm/s within 40 ms.
const USUAL: Criterion = Criterion { threshold: 0.25e-3, window: 0.04 };
/// The recorded signals.
const SIGNALS: [&str; 4] = ["v_i", "v_o", "spring_force", "a_o"];
/// sqrt(K / M) of the final circuit, in Hz.
const NATURAL: f64 = 51.3;

/// Runs a patch of the thesis.
fn run(patch: &str, settings: &[(&str, f64)], lasting: f64, every: f64) -> Trace {
    record(&format!("thesis/{patch}"), settings, lasting, every, &SIGNALS)
}

/// The samples of a recorded signal.
fn values(trace: &Trace, name: &str) -> Vec<f64> {
    trace.values(name).unwrap()
}

/// The cycles of oscillation in a run.
fn cycles_of(trace: &Trace) -> Vec<Cycle> {
    cycles(&trace.time, &values(trace, "v_i"), &values(trace, "v_o"), USUAL).unwrap()
}

/// Fig 8.26. With a brake the slips are regular from the first one on. `docs/compromise.md` explains the effect of
/// the dead zone at low commands.
#[test]
fn frequency_rises_towards_the_natural_frequency() {
    let found = cycles_of(&run("fig-8-16-coulomb", &[], 4.2, 5e-4));
    assert!(found.len() > 130, "{}", found.len());
    assert!(found.windows(2).all(|pair| pair[1].frequency > 0.998 * pair[0].frequency));
    let (first, last) = (found[0], found[found.len() - 1]);
    assert!(
        first.frequency < 0.2 * NATURAL && (last.frequency / NATURAL - 1.0).abs() < 0.01,
        "{first:?} {last:?}"
    );
    let found = cycles_of(&run("fig-8-16", &[], 4.2, 5e-4));
    let smooth: Vec<_> = found.iter().filter(|cycle| cycle.command > 1.7e-3).collect();
    assert!(smooth.windows(2).all(|pair| pair[1].frequency > 0.998 * pair[0].frequency));
}

/// The thesis reads frequencies from the spring force, whose peaks are also one cycle apart.
#[test]
fn peaks_of_spring_force_are_one_cycle_apart() {
    let trace = run("fig-8-16", &[("v_rate", 0.0), ("v_start", 2e-3)], 2.0, 1e-4);
    let force = values(&trace, "spring_force");
    let found = cycles_of(&trace);
    let peak = |cycle: &Cycle| {
        let within = (0..force.len()).filter(|index| (cycle.begin..cycle.end).contains(&trace.time[*index]));
        trace.time[within.max_by(|one, other| force[*one].total_cmp(&force[*other])).unwrap()]
    };
    let peaks: Vec<f64> = found.iter().map(peak).collect();
    for (peaks, cycle) in peaks.windows(2).zip(&found).skip(10) {
        assert!((1.0 / (peaks[1] - peaks[0]) / cycle.frequency - 1.0).abs() < 0.01, "{cycle:?}");
    }
}

/// Fig 8.18: a long time constant and a slow ramp.
#[test]
fn slow_ramp_follows_the_steady_friction() {
    let (memory, rate) = (0.1, 0.4e-3);
    let trace = run("fig-8-16", &[("Tc", memory), ("v_rate", rate)], 12.0, 1e-3);
    let [command, velocity, force] = ["v_i", "v_o", "spring_force"].map(|name| values(&trace, name));
    let slow = Criterion { threshold: 0.02e-3, window: 0.04 };
    let points = steady_friction(&trace.time, &command, &velocity, &force, 433.0, slow).unwrap();
    let law = |v: f64| 771.0 * (1.0 - v / 2.54e-3).max(0.0).powi(2) + 10.7e3 * v;
    assert!(points.len() > 200, "{}", points.len());
    for point in points.iter().filter(|point| point.velocity > 0.6e-3) {
        // The lag delays solid friction by its time constant.
        let delayed = 771.0 * (1.0 - (point.velocity - rate * memory) / 2.54e-3).max(0.0).powi(2);
        let lagging = delayed + 10.7e3 * point.velocity;
        assert!((point.friction - lagging).abs() < 1.0, "{point:?} {lagging}");
        assert!(point.friction > law(point.velocity) - 0.01, "{point:?}");
    }
}

/// Fig 8.22, 8.23: the work of the spring in a cycle equals the work of friction.
#[test]
fn work_of_a_loop_equals_the_work_of_friction() {
    for (command, reverses) in [(2e-3, true), (4e-3, false)] {
        let trace = run("fig-8-16-coulomb", &[("v_rate", 0.0), ("v_start", command)], 3.0, 1e-4);
        let [velocity, force, acceleration] = ["v_o", "spring_force", "a_o"].map(|name| values(&trace, name));
        let found = friction_loop(&trace.time, &velocity, &force, 5, USUAL.threshold).unwrap();
        assert_eq!((found.sense, found.velocity[0] < -0.1e-3), (LoopSense::Clockwise, reverses));
        assert!(found.closure_error < 1e-3, "{}", found.closure_error);
        let inertia: Vec<f64> = force.iter().zip(&acceleration).map(|(force, a)| force - 433.0 * a).collect();
        let taken = friction_loop(&trace.time, &velocity, &inertia, 5, USUAL.threshold).unwrap();
        assert!((found.work / taken.work - 1.0).abs() < 0.01, "{} {}", found.work, taken.work);
        // The spring stores no energy over a cycle, so the input at the steady command equals the work on the mass.
        let last = cycles_of(&trace)[..].last_chunk::<5>().unwrap().map(|cycle| (cycle.begin, cycle.end));
        let within = (0..force.len()).filter(|index| (last[0].0..last[4].1).contains(&trace.time[*index]));
        let mean = within.clone().map(|index| force[index]).sum::<f64>() / within.count() as f64;
        assert!((found.work * found.frequency / (mean * command) - 1.0).abs() < 0.01, "{found:?}");
    }
}

#[test]
fn motion_without_oscillation_has_no_loop() {
    let trace = run("fig-8-16", &[("v_rate", 0.0), ("v_start", 6e-3)], 3.0, 1e-3);
    let late = 2000;
    let [velocity, force] = ["v_o", "spring_force"].map(|name| values(&trace, name));
    let found = friction_loop(&trace.time[late..], &velocity[late..], &force[late..], 1, USUAL.threshold);
    assert!(found.is_err(), "{found:?}");
}
