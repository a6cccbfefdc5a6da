//! The slideway's instruments on the circuits that they were made for.

use crate::known::runs::record;
use patchcord_analysis::instruments::{Criterion, Cycle, Turning, cycles, friction_loop, steady_friction};
use patchcord_core::trace::Trace;

const USUAL: Criterion = Criterion { threshold: 0.25e-3, window: 0.04 };
const SIGNALS: [&str; 4] = ["v_i", "v_o", "spring_force", "a_o"];
/// sqrt(K / M) of the final circuit, in Hz.
const NATURAL: f64 = 51.3;

fn run(patch: &str, settings: &[(&str, f64)], lasting: f64, every: f64) -> Trace {
    record(&format!("thesis/{patch}"), settings, lasting, every, &SIGNALS)
}

fn values(trace: &Trace, name: &str) -> Vec<f64> {
    trace.values(name).unwrap()
}

fn cycles_of(trace: &Trace) -> Vec<Cycle> {
    cycles(&trace.time, &values(trace, "v_i"), &values(trace, "v_o"), USUAL).unwrap()
}

/// Fig 8.26. With a brake slips follow each other evenly from the first on; what the dead zone does to them at low commands tells
/// `docs/compromise.md`.
#[test]
fn frequency_rises_with_the_command_towards_the_natural_one() {
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

/// The study reads frequencies off the spring force: its peaks are a cycle apart, too.
#[test]
fn a_cycle_lasts_from_one_greatest_spring_force_to_the_next() {
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

/// Fig 8.18: a long memory and a slow ramp.
#[test]
fn a_creeping_command_traces_the_steady_friction() {
    let (memory, rate) = (0.1, 0.4e-3);
    let trace = run("fig-8-16", &[("Tc", memory), ("v_rate", rate)], 12.0, 1e-3);
    let [command, velocity, force] = ["v_i", "v_o", "spring_force"].map(|name| values(&trace, name));
    let slow = Criterion { threshold: 0.02e-3, window: 0.04 };
    let points = steady_friction(&trace.time, &command, &velocity, &force, 433.0, slow).unwrap();
    let law = |v: f64| 771.0 * (1.0 - v / 2.54e-3).max(0.0).powi(2) + 10.7e3 * v;
    assert!(points.len() > 200, "{}", points.len());
    for point in points.iter().filter(|point| point.velocity > 0.6e-3) {
        // The memory is a mean over the past: the share remembered is that of so much earlier.
        let remembered = 771.0 * (1.0 - (point.velocity - rate * memory) / 2.54e-3).max(0.0).powi(2);
        let late = remembered + 10.7e3 * point.velocity;
        assert!((point.friction - late).abs() < 1.0, "{point:?} {late}");
        assert!(point.friction > law(point.velocity) - 0.01, "{point:?}");
    }
}

/// Fig 8.22, 8.23: what the spring does in a cycle is what friction takes.
#[test]
fn the_work_of_a_loop_is_what_friction_takes() {
    for (command, reverses) in [(2e-3, true), (4e-3, false)] {
        let trace = run("fig-8-16-coulomb", &[("v_rate", 0.0), ("v_start", command)], 3.0, 1e-4);
        let [velocity, force, acceleration] = ["v_o", "spring_force", "a_o"].map(|name| values(&trace, name));
        let found = friction_loop(&trace.time, &velocity, &force, 5, USUAL.threshold).unwrap();
        assert_eq!((found.turning, found.velocity[0] < -0.1e-3), (Turning::Clockwise, reverses));
        assert!(found.gap < 1e-3, "{}", found.gap);
        let inertia: Vec<f64> = force.iter().zip(&acceleration).map(|(force, a)| force - 433.0 * a).collect();
        let taken = friction_loop(&trace.time, &velocity, &inertia, 5, USUAL.threshold).unwrap();
        assert!((found.work / taken.work - 1.0).abs() < 0.01, "{} {}", found.work, taken.work);
        // The spring gives back what it takes, so that what goes in at the even command comes out at the mass.
        let last = cycles_of(&trace)[..].last_chunk::<5>().unwrap().map(|cycle| (cycle.begin, cycle.end));
        let within = (0..force.len()).filter(|index| (last[0].0..last[4].1).contains(&trace.time[*index]));
        let mean = within.clone().map(|index| force[index]).sum::<f64>() / within.count() as f64;
        assert!((found.work * found.frequency / (mean * command) - 1.0).abs() < 0.01, "{found:?}");
    }
}

#[test]
fn where_nothing_oscillates_there_is_no_loop() {
    let trace = run("fig-8-16", &[("v_rate", 0.0), ("v_start", 6e-3)], 3.0, 1e-3);
    let late = 2000;
    let [velocity, force] = ["v_o", "spring_force"].map(|name| values(&trace, name));
    let found = friction_loop(&trace.time[late..], &velocity[late..], &force[late..], 1, USUAL.threshold);
    assert!(found.is_err(), "{found:?}");
}
