//! Curves of one signal against another one: close to the exact curve between all points, and without effect on samples.

use crate::common::{built, circuit, element, program_of, shipped};
use patchcord_core::ir::Program;
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{Backend, Phase, RunSettings, check, run, run_batch};
use patchcord_core::trace::{SignalCurve, Trace};

/// x'' = -x from 80 V: a circle of `A2` against `A1`.
fn oscillator() -> Program {
    let patch = PatchBuilder::new("oscillator")
        .parameter("x0", 80.0, "V", [-100.0, 100.0])
        .element("A1", element("integrator").cords("x1", ["A2"]).set("initial", "x0"))
        .element("A2", element("integrator").cords("x1", ["B1"]))
        .element("B1", element("inverter").cord("in", "A1"));
    built(patch)
}

/// Settings of one operation, in steps of `step`, that follow the circle.
fn circle(seconds: f64, step: f64) -> RunSettings {
    let phases = [Phase::InitialCondition, Phase::operate(seconds)];
    RunSettings::from_phases(phases, step).with_signals(["A1"]).with_curves([("A1", "A2")])
}

/// The trace of a run without error.
fn trace(program: &Program, settings: &RunSettings) -> Trace {
    run(program, settings).unwrap_or_else(|stopped| panic!("{stopped}"))
}

/// The largest distance in volts between the circle of 80 V and the straight lines between points of a curve.
fn distance_from_circle(curve: &SignalCurve) -> f64 {
    let lines = curve.points.windows(2).filter(|ends| !ends[1].begins);
    let places = lines.flat_map(|ends| {
        (0..=10).map(|tenth| {
            let share = f64::from(tenth) / 10.0;
            let at = |axis: usize| ends[0].volts[axis] + (ends[1].volts[axis] - ends[0].volts[axis]) * share;
            (at(0).hypot(at(1)) - 80.0).abs()
        })
    });
    places.fold(0.0, f64::max)
}

#[test]
fn a_circle_in_long_steps_is_round() {
    let program = oscillator();
    let long = circle(6.6, 0.3);
    let all = [
        long.clone(),
        long.clone().with_backend(Backend::Interpreter),
        long.clone().with_backend(Backend::Native),
        long.clone().with_backend(Backend::Reference),
        long.clone().with_sensitivities(["x0"]),
        long.with_tolerance(1e-6),
    ];
    for settings in all {
        let trace = trace(&program, &settings);
        let curve = trace.curve("A1", "A2").unwrap();
        let distance = distance_from_circle(curve);
        assert!(distance < 0.1, "{distance}: {settings:?}");
        assert_eq!((curve.points[0].time, curve.points[0].volts), (0.0, [80.0, 0.0]));
        assert!(curve.points.last().is_some_and(|point| (point.time - 6.6).abs() < 1e-9));
        assert!(curve.points.len() < 400, "{}", curve.points.len());
    }
}

#[test]
fn a_curve_of_a_million_steps_has_a_bounded_number_of_points() {
    let trace = trace(&oscillator(), &circle(1000.0, 1e-3).with_sample_interval(1.0));
    let curve = trace.curve("A1", "A2").unwrap();
    assert!((5_000..=20_000).contains(&curve.points.len()), "{}", curve.points.len());
    let distance = distance_from_circle(curve);
    assert!(distance < 0.2, "{distance}");
}

/// The samples of all tracks, with their times.
fn samples(trace: &Trace) -> Vec<&[f64]> {
    [&trace.time[..]].into_iter().chain(trace.tracks.iter().map(|track| &track.volts[..])).collect()
}

#[test]
fn curves_do_not_change_samples_and_do_not_depend_on_how_a_run_is_made() {
    let patches = ["lorenz", "bouncing-ball", "stick-slip", "projectile", "driven-oscillator", "van-der-pol"];
    let lessons = patches.map(|name| format!("lessons/{name}"));
    for name in lessons.into_iter().chain(["others/singh".to_owned(), "thesis/fig-8-09".to_owned()]) {
        let circuit = circuit(&shipped(&name), &[]);
        let program = program_of(&circuit);
        let settings = RunSettings::of(&circuit).unwrap();
        let settings = settings.with_sensitivities(Vec::<String>::new());
        let plain = trace(&program, &settings);
        let settings = settings.with_curves(circuit.drawn_curves());
        let followed = trace(&program, &settings);
        assert!(!followed.curves.is_empty() && plain.curves.is_empty());
        assert!(samples(&followed) == samples(&plain), "{name}");
        assert!(followed.overloads().eq(plain.overloads()), "{name}");
        for backend in [Backend::Interpreter, Backend::Native] {
            let other = trace(&program, &settings.clone().with_backend(backend));
            assert!(other.curves == followed.curves, "{name} with {backend:?}");
        }
        let every = settings.every * 7.0;
        for other in [settings.clone().with_blocks(100), settings.clone().with_sample_interval(every)] {
            assert!(trace(&program, &other).curves == followed.curves, "{name}: {other:?}");
        }
        for batched in run_batch(&[program.clone(), program.clone()], &settings) {
            let batched = batched.unwrap_or_else(|stopped| panic!("{stopped}"));
            assert!(batched.curves == followed.curves, "{name}");
        }
    }
}

#[test]
fn samples_are_close_to_the_curve() {
    let circuit = circuit(&shipped("thesis/fig-8-16"), &[]);
    let settings = RunSettings::of(&circuit).unwrap().with_duration(1.0);
    let trace = trace(&program_of(&circuit), &settings.with_curves([("v_o", "spring_force")]));
    let curve = trace.curve("v_o", "spring_force").unwrap();
    let [velocity, force] = ["v_o", "spring_force"].map(|name| &trace.track(name).unwrap().volts);
    let mut after = 1;
    for (time, volts) in trace.time.iter().zip(velocity.iter().zip(force)) {
        while curve.points[after].time < *time {
            after += 1;
        }
        let [from, to] = [curve.points[after - 1], curve.points[after]];
        let share = if to.time > from.time { (time - from.time) / (to.time - from.time) } else { 1.0 };
        for (axis, volts) in [volts.0, volts.1].into_iter().enumerate() {
            let place = from.volts[axis] + (to.volts[axis] - from.volts[axis]) * share;
            assert!((place - volts).abs() < 0.1, "{time}: {place} {volts}");
        }
    }
}

#[test]
fn a_jump_has_both_of_its_sides() {
    let relay = element("relay").cord("in", "A1").cord("on", "+100").cord("off", "-100");
    let patch = PatchBuilder::new("jump")
        .element("A1", element("integrator").cords("x1", ["-100"]).set("initial", -50))
        .element("K1", relay.set("pull_in", 10).set("drop_out", 5));
    let phases = [Phase::InitialCondition, Phase::operate(1.0)];
    for step in [0.01, 0.3] {
        let settings = RunSettings::from_phases(phases.clone(), step).with_signals(["A1"]);
        let trace = trace(&built(patch.clone()), &settings.with_curves([("A1", "K1")]));
        // A1 = -50 + 100 t passes 10 V at 0.6 s. There are no other corners.
        let points = &trace.curve("A1", "K1").unwrap().points;
        let found: Vec<_> = points.iter().map(|point| (point.time, point.volts)).collect();
        let [begin, before, after, end] = found[..] else { panic!("{found:?}") };
        assert_eq!((begin, end.0, end.1[1]), ((0.0, [-50.0, -100.0]), 1.0, 100.0));
        assert!((before.0 - 0.6).abs() < 1e-9 && before.0 == after.0, "{found:?}");
        assert!((before.1[0] - 10.0).abs() < 1e-6 && (before.1[1], after.1[1]) == (-100.0, 100.0));
    }
}

#[test]
fn every_repetition_begins_a_curve() {
    let (operate, hold) = (Phase::operate(1.0), Phase::Hold { time: 0.5 });
    let phases = [Phase::InitialCondition, operate.clone(), hold, operate];
    let settings = RunSettings::from_phases(phases, 0.01).repeated(3).with_signals(["A1"]);
    let trace = trace(&oscillator(), &settings.with_curves([("A1", "A2"), ("A2", "A1")]));
    for curve in &trace.curves {
        let begins: Vec<_> = curve.begins().collect();
        assert_eq!(begins.len(), trace.repetitions.len());
        assert!(begins.iter().all(|begin| curve.points[*begin].time == 0.0));
        let ends = begins.iter().skip(1).copied().chain([curve.points.len()]);
        assert!(ends.map(|end| curve.points[end - 1].time).all(|time| (time - 2.5).abs() < 1e-9));
        assert!(curve.points.windows(2).all(|pair| pair[0].time <= pair[1].time || pair[1].begins));
        assert!(distance_from_circle(curve) < 0.1);
    }
    assert_eq!(trace.curves[0].axes.clone().map(|axis| axis.name), ["A1", "A2"]);
}

#[test]
fn an_unknown_signal_of_a_curve_is_an_error() {
    let settings = circle(1.0, 0.1).with_curves([("A1", "A3")]);
    assert_eq!(check(&oscillator(), &settings).unwrap_err().code(), "unknown-signal");
    assert!(run(&oscillator(), &settings).is_err());
}
