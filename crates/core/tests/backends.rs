//! Backends: all give the same bits, but for the reference, from which they differ by rounding.

use std::path::PathBuf;

use crate::common::dice::Dice;
use crate::common::files::{representative, shipped};
use crate::common::traces::{bits, parts};
use crate::common::{built, circuit, element, program, ran, source, volts};
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::PatchBuilder;
use patchcord_core::solve::{self, Backend, Machine, RunSettings};
use patchcord_core::trace::Trace;

const FOLDED: [Backend; 4] = [Backend::Interpreter, Backend::Lanes, Backend::Native, Backend::Automatic];

fn trace(program: &Program, settings: &RunSettings, backend: Backend) -> Trace {
    solve::run(program, &RunSettings { backend, ..settings.clone() })
        .unwrap_or_else(|stopped| panic!("{stopped}"))
}

/// Traces of the folded backends, which are the same, and that of the reference.
fn both(program: &Program, settings: &RunSettings) -> (Trace, Trace) {
    let [interpreted, others @ ..] = FOLDED.map(|backend| trace(program, settings, backend));
    for other in others {
        assert_eq!(interpreted, other);
        assert!(bits(&interpreted) == bits(&other));
    }
    (interpreted, trace(program, settings, Backend::Reference))
}

/// The largest difference of samples, in volts.
fn difference(a: &Trace, b: &Trace) -> f64 {
    assert_eq!(a.time, b.time);
    let pairs = a.tracks.iter().zip(&b.tracks).flat_map(|(a, b)| a.volts.iter().zip(&b.volts));
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn representative_patches() {
    agree_on(representative());
}

#[test]
#[ignore = "takes ten seconds"]
fn every_shipped_patch() {
    agree_on(shipped());
}

fn agree_on(files: Vec<PathBuf>) {
    for file in files {
        let circuit = circuit(&crate::common::patch_of(&file), &[]);
        let settings = RunSettings::of(&circuit).unwrap();
        // What is chaotic, and what sticks and slips, makes rounding grow: so many seconds of it. Where a step ends on a
        // corner, the reference's stages may be bent there, the kernel's are not: a shorter step leaves rounding only.
        let settings = match file.file_stem().unwrap().to_str().unwrap() {
            "lorenz" => settings.lasting(10.0),
            // The same slips by other wirings: rounding is tenfold every 60 ms, and begins a little larger.
            "fig-8-17" | "fig-4-07" => RunSettings { step: 0.25 * settings.step, ..settings.lasting(0.4) },
            name if name.starts_with("fig-8-1") => {
                RunSettings { step: 0.25 * settings.step, ..settings.lasting(0.5) }
            }
            _ => settings,
        };
        let (folded, reference) = both(&Program::new(&circuit).unwrap(), &settings);
        let found = difference(&folded, &reference);
        assert!(found <= 1e-9, "{}: {found:e} V", file.display());
        for (folded, reference) in folded.tracks.iter().zip(&reference.tracks) {
            let pairs = folded.courses.iter().zip(&reference.courses);
            for (folded, reference) in pairs {
                let ends = [folded, reference].map(|course| [course.least.volts, course.most.volts]);
                let apart = (ends[0][0] - ends[1][0]).abs().max((ends[0][1] - ends[1][1]).abs());
                assert!(apart <= 1e-6, "{}: {ends:?}", file.display());
            }
        }
    }
}

#[test]
fn random_circuits() {
    let mut dice = Dice(31);
    for number in 0..30 {
        let patch = crate::common::circuits::circuit(&mut dice);
        let circuit = circuit(&patch, &[]);
        let record = ["A0", "A1", "A2", "N0", "N3", "u", "w"].map(str::to_owned).to_vec();
        // A step that is no multiple of the time between samples, so that some lie within steps.
        let settings =
            RunSettings { step: 1.3e-3, every: 7e-3, record, ..RunSettings::of(&circuit).unwrap() };
        let (folded, reference) = both(&Program::new(&circuit).unwrap(), &settings.lasting(3.0));
        let found = difference(&folded, &reference);
        assert!(found <= 1e-8, "circuit {number}: {found:e} V");
    }
}

/// Corners of tables in time, on the ends of steps and beside them, recorded at every step and within steps.
#[test]
fn curves_through_points() {
    let circuit = circuit(&crate::common::driven_by_points("A2"), &[]);
    let program = Program::new(&circuit).unwrap();
    let record = ["u", "w", "R", "L", "S", "A1", "A2"].map(str::to_owned).to_vec();
    for (step, every) in [(1e-3, 1e-3), (1e-3, 2.3e-3), (1e-2, 1e-2), (2.5e-4, 1e-3), (7e-4, 1e-3)] {
        let settings =
            RunSettings { step, every, record: record.clone(), ..RunSettings::of(&circuit).unwrap() };
        let (folded, reference) = both(&program, &settings);
        let found = difference(&folded, &reference);
        assert!(found <= 1e-11, "step {step}, every {every}: {found:e} V");
        assert!(folded.sweeps[0].work.changes >= 10);
        for (folded, reference) in folded.tracks.iter().zip(&reference.tracks) {
            let [folded, reference] = [folded, reference].map(|track| track.courses[0]);
            let apart = [(folded.least, reference.least), (folded.most, reference.most)];
            assert!(apart.iter().all(|(own, other)| (own.volts - other.volts).abs() <= 1e-9), "{apart:?}");
        }
    }
}

/// The largest difference between the folded backends and the reference, where two delays are so many steps long.
fn late(own: &Program, settings: &RunSettings, [t, f]: [f64; 2]) -> f64 {
    let mut program = own.clone();
    program.set_parameters([("T", t * settings.step), ("F", f * settings.step)]).unwrap();
    let (folded, reference) = both(&program, settings);
    // The same was met on the way.
    let [own, other] = [&folded, &reference].map(|trace| trace.sweeps[0].work);
    assert_eq!((own.changes, own.crossings), (other.changes, other.crossings), "{t} and {f} steps");
    difference(&folded, &reference)
}

/// Delays of whole steps and of others, as short as a step and longer than the run, recorded at every step and within steps.
#[test]
fn delays() {
    let straight = crate::common::late(element("summer").cords("x1", ["D1", "A2"]));
    for (patch, grids, most) in [
        (straight, [(1e-3, 1e-3), (1e-3, 2.3e-3), (2.5e-3, 1e-2), (7e-4, 1e-3)], 1e-11),
        // Where a step ends on a corner, the reference's stages may be bent there: shorter steps leave rounding only.
        (
            crate::common::late_and_bent(),
            [(2e-4, 1e-3), (1e-4, 2.3e-3), (1.25e-4, 1.25e-4), (7e-5, 1e-3)],
            1e-9,
        ),
    ] {
        let circuit = circuit(&patch, &[]);
        let own = Program::new(&circuit).unwrap();
        let record = ["D1", "D2", "L", "S", "A1", "A2"].map(str::to_owned).to_vec();
        let times = [1.0, 1.5, 2.0, 2.71, 4.0, 17.0, 23.45, 700.0];
        for (step, every) in grids {
            let settings =
                RunSettings { step, every, record: record.clone(), ..RunSettings::of(&circuit).unwrap() };
            for (place, t) in times.into_iter().enumerate() {
                let f = times[(5 * place + 3) % times.len()];
                // No delay is declared to be shorter than 0.1 ms.
                let both = [t, f].map(|steps| f64::max(steps, 1.01e-4 / step));
                let found = late(&own, &settings, both);
                assert!(found <= most, "{both:?} steps of {step}, every {every}: {found:e} V");
            }
        }
    }
}

/// An amplifier that passes 100 V for a while: the kernel ends there, and holds again.
#[test]
fn overloads_are_the_same() {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1);
    let patch = volts("overloaded for a while")
        .drive("u", "volt", sine)
        .element("S", element("summer").cords("x2", ["u"]))
        .element("A", element("integrator").cords("x1", ["S", "A"]))
        .build()
        .unwrap();
    let circuit = circuit(&patch, &[]);
    let record = vec!["S".to_owned(), "A".to_owned()];
    let settings = RunSettings { every: 1e-2, record, ..RunSettings::of(&circuit).unwrap() };
    let program = Program::new(&circuit).unwrap();
    let (folded, reference) = both(&program, &settings.lasting(2.0));
    assert!(difference(&folded, &reference) <= 1e-10);
    let [folded, reference] = [folded, reference].map(|trace| trace.sweeps[0].overloads.clone());
    assert_eq!(folded.len(), 1);
    assert_eq!(folded[0].element, "S");
    assert!((folded[0].time - reference[0].time).abs() < 1e-9 && folded[0].peak == 120.0);
}

/// A patch on a sine of 60 V, run without lamps by all backends, and with them by the reference: which lit.
fn without_lamps(of_sine: impl Fn(PatchBuilder) -> PatchBuilder, record: &[&str], step: f64) -> Vec<String> {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1);
    let patch = of_sine(volts("overloaded for a while").drive("u", "volt", sine)).build().unwrap();
    let circuit = circuit(&patch, &[]);
    let record = record.iter().map(|signal| (*signal).to_owned()).collect();
    let settings =
        RunSettings { every: step, step, record, ..RunSettings::of(&circuit).unwrap() }.lasting(0.9);
    let program = Program::new(&circuit).unwrap();
    let lit = trace(&program, &settings, Backend::Reference);
    let (folded, reference) = both(&program, &RunSettings { lamps: false, ..settings });
    for trace in [folded, reference] {
        let found = difference(&trace, &lit);
        assert!(found <= 1e-9, "{found:e} V");
        assert_eq!(trace.overloads().count(), 0);
    }
    lit.overloads().map(|overload| overload.element.clone()).collect()
}

/// Where nobody asks for lamps, kernels go on beyond ±100 V: past a summer and an integrator that are driven on, and back.
#[test]
fn runs_without_lamps_are_the_same() {
    let summed = |builder: PatchBuilder| {
        let builder = builder.element("S", element("summer").cords("x2", ["u"]));
        let builder = builder.element("A", element("integrator").cords("x1", ["S", "A"]));
        let builder = builder.element("B", element("integrator").cords("x10", ["u"]));
        builder.element("C", element("integrator").cords("x1", ["B", "S"]))
    };
    assert_eq!(without_lamps(summed, &["S", "A", "B", "C"], 1e-3), ["S", "B"]);
}

/// What is overloaded comes back for less than a step, at a corner and between two stages.
#[test]
fn no_step_without_lamps_reaches_across_what_comes_back() {
    let rectified = |builder: PatchBuilder| {
        let builder = builder.element("N", element("absolute").cord("in", "u"));
        let builder = builder.element("S", element("summer").cords("x100", ["N"]));
        builder.element("A", element("integrator").cords("x1", ["S"]))
    };
    // It is asked for 377 V, 113 V and 151 V where the step begins, in its middle and at the end, and for 0 at the corner.
    assert_eq!(without_lamps(rectified, &["A"], 1.4e-2), ["S"]);
    let smooth = |builder: PatchBuilder| {
        let pot = |setting| element("pot").cord("in", "+100").set("setting", setting);
        let summer = element("summer").cords("x1000", ["P", "u"]).cords("x100", ["R"]);
        let builder = builder.element("P", pot(0.6)).element("R", pot(7.04e-3)).element("S", summer);
        builder.element("A", element("integrator").cords("x1", ["S"]))
    };
    // Within ±100 V for 10 ms about 0.75 s, in the middle of a step.
    assert_eq!(without_lamps(smooth, &["A"], 1.2e-2), ["S"]);
}

/// A ramp that two diodes turn where it passes 0, between two samples: its extreme is seen there.
#[test]
fn the_turn_of_a_ramp_is_seen() {
    let ramp = element("ramp").set("start", -30.01).set("rate", 60);
    let patch = volts("the size of a ramp")
        .drive("u", "volt", ramp)
        .element("N", element("summer").cords("x1", ["u"]))
        .element("L", element("diode-lower-of").cords("in", ["u", "N"]))
        .element("A", element("integrator").cords("x1", ["L"]))
        .build()
        .unwrap();
    let circuit = circuit(&patch, &[]);
    let settings =
        RunSettings { record: vec!["L".to_owned()], every: 0.4, ..RunSettings::of(&circuit).unwrap() };
    let (folded, reference) = both(&Program::new(&circuit).unwrap(), &settings.lasting(1.2));
    for trace in [folded, reference] {
        let most = trace.tracks[0].courses[0].most;
        assert!(most.volts.abs() <= 1e-9 && (most.time - 30.01 / 60.0).abs() <= 1e-9, "{most:?}");
    }
}

/// Recording does not change a run, and what is seen of a signal depends neither on what is recorded beside it nor on how
/// often.
#[test]
fn courses_are_the_same_with_any_recording() {
    let patch = crate::common::slideway();
    let circuit = circuit(&patch, &[]);
    let program = Program::new(&circuit).unwrap();
    let own = RunSettings::of(&circuit).unwrap().lasting(0.3);
    let whole = trace(&program, &own, Backend::Native);
    for (name, every) in ["v_i", "v_o", "memory", "friction_level"]
        .into_iter()
        .flat_map(|name| [0.3, 7e-4, 2e-5].map(|every| (name, every)))
    {
        let settings = RunSettings { record: vec![name.to_owned()], every, ..own.clone() };
        for backend in Backend::ALL {
            let alone = trace(&program, &settings, backend);
            let [alone, beside] = [&alone, &whole].map(|trace| trace.track(name).unwrap().courses[0]);
            // By rounding, what stands still is most at another of its instants.
            let stands =
                |index: usize| backend == Backend::Reference && name == "friction_level" && index == 5;
            let is_same = |a: f64, b: f64| match backend {
                Backend::Reference => (a - b).abs() <= 1e-9,
                _ => a.to_bits() == b.to_bits(),
            };
            let pairs = parts(&alone).into_iter().zip(parts(&beside)).enumerate();
            let pairs = pairs.filter(|(index, _)| !stands(*index)).map(|(_, pair)| pair);
            pairs.for_each(|(a, b)| assert!(is_same(a, b), "{name} every {every} by {backend}: {a} {b}"));
        }
    }
}

/// What a limit holds is least where it reached the limit, however seldom it is recorded.
#[test]
fn a_flat_extreme_begins_where_it_was_reached() {
    let ramp = element("ramp").set("start", 30).set("rate", -200);
    let limited = element("summer").cords("x1", ["u"]).set("limit", serde_json::json!({"upper": 5}));
    let patch = volts("limited ramp")
        .drive("u", "volt", ramp)
        .element("N", limited)
        .element("A", element("integrator").cords("x1", ["N"]))
        .build()
        .unwrap();
    let circuit = circuit(&patch, &[]);
    let program = Program::new(&circuit).unwrap();
    for every in [1e-3, 0.07, 0.25] {
        let settings =
            RunSettings { record: vec!["N".to_owned()], every, ..RunSettings::of(&circuit).unwrap() };
        let (folded, reference) = both(&program, &settings.lasting(0.25));
        for trace in [folded, reference] {
            let most = trace.tracks[0].courses[0].most;
            assert!(most.volts == 5.0 && (most.time - 0.175).abs() <= 1e-9, "every {every}: {most:?}");
        }
    }
}

/// States are remembered from step to step, and read off within one, wherever samples fall.
#[test]
fn states_are_recorded_alike_however_often() {
    let circuit = circuit(&crate::common::shipped("thesis/fig-8-16"), &[("v_start", 3e-3)]);
    let program = Program::new(&circuit).unwrap();
    let own = RunSettings::of(&circuit).unwrap().lasting(0.06);
    let record = ["A1", "A3", "A6", "v_o"].map(str::to_owned).to_vec();
    for steps in [0.4, 1.0 - 1e-10, 1.0, 1.0 + 1e-7, 2.0, 2.5, 7.0, 64.0, 100.0] {
        let settings = RunSettings { every: steps * own.step, record: record.clone(), ..own.clone() };
        let (folded, reference) = both(&program, &settings);
        assert!(folded.tracks[3].courses[0].most.volts > 1.0, "it never slipped");
        let found = difference(&folded, &reference);
        assert!(found <= 1e-9, "every {steps} steps: {found:e} V");
    }
}

/// The same of a state with a constant beside it, before the machine was held and after that.
#[test]
fn states_are_recorded_alike_after_a_hold() {
    let patch = volts("an oscillator, seen from beside")
        .element("P1", element("pot").cord("in", "A2").set("setting", 0.9))
        .element("A1", element("integrator").cords("x10", ["P1"]).set("initial", 20))
        .element("A2", element("integrator").cords("x10", ["D"]))
        .element("D", element("summer").cords("x1", ["A1"]))
        .element("PB", element("pot").cord("in", "+100").set("setting", 0.3))
        .element("S", element("summer").cords("x1", ["A1", "PB"]))
        .build()
        .unwrap();
    let circuit = circuit(&patch, &[]);
    let program = Program::new(&circuit).unwrap();
    let own = RunSettings::of(&circuit).unwrap();
    let operate = |time: f64| Phase::Operate { time, until: None };
    let phases = vec![Phase::InitialCondition, operate(0.3), Phase::Hold { time: 0.11 }, operate(0.3)];
    let record = ["A1", "S"].map(str::to_owned).to_vec();
    for every in [4e-4, 1e-3, 2e-3, 2.5e-3] {
        let settings =
            RunSettings { step: 1e-3, every, phases: phases.clone(), record: record.clone(), ..own.clone() };
        let (folded, reference) = both(&program, &settings);
        assert!(difference(&folded, &reference) <= 1e-10, "every {every}");
        let beside = folded.tracks[0].volts.iter().zip(&folded.tracks[1].volts);
        beside.for_each(|(state, seen)| assert!((state + seen + 30.0).abs() < 1e-12));
    }
}

/// Samples that come before the end of a step by less than the grid of steps tells apart.
#[test]
fn samples_just_before_a_step_ends_are_read_off_it() {
    let circuit = circuit(&crate::common::shipped("lessons/mass-and-spring"), &[]);
    let program = Program::new(&circuit).unwrap();
    let settings =
        RunSettings { step: 1e-3, every: 0.149_999_999_999_81, ..RunSettings::of(&circuit).unwrap() };
    let (folded, reference) = both(&program, &settings.lasting(6.0));
    assert!(difference(&folded, &reference) <= 1e-10);
}

/// What follows from the sides of corners is worked out anew where potentiometers were turned.
#[test]
fn crossings_follow_the_potentiometers() {
    let bent = volts("an oscillator that a diode bends")
        .parameter("g", 0.3, "1", [0.0, 1.0])
        .parameter("b", 8.0, "1", [1.0, 90.0])
        .element("P1", element("pot").cord("in", "A2").set("setting", 0.9))
        .element("A1", element("integrator").cords("x10", ["P1"]).set("initial", 20))
        .element("A2", element("integrator").cords("x10", ["D"]))
        .element("PB", element("pot").cord("in", "+100").set("setting", "b / 100"))
        .element("D", element("summer").cords("x1", ["PG", "A1"]))
        .element("U", element("diode-lower-of").cords("in", ["A1", "PB"]))
        .element("PG", element("pot").cord("in", "U").set("setting", "g"))
        .build()
        .unwrap();
    let program = program(&bent, &[]);
    let voltages = Backend::ALL.map(|backend| {
        let mut machine = Machine::new(&program, 1e-3).unwrap().on(backend);
        machine.operate(2.0).unwrap();
        for (g, b) in [(0.8, 4.0), (0.3, 8.0)] {
            machine.set("g", g).unwrap();
            machine.set("b", b).unwrap();
            machine.operate(1.0).unwrap();
        }
        machine.voltage("A1").unwrap()
    });
    assert!(voltages.iter().all(|volts| (volts - voltages[0]).abs() <= 1e-9), "{voltages:?}");
    assert!(voltages[1..].iter().all(|volts| volts.to_bits() == voltages[1].to_bits()), "{voltages:?}");
}

#[test]
fn a_machine_by_hand_takes_any_backend() {
    let program = program(&crate::common::slideway(), &[]);
    let voltages = Backend::ALL.map(|backend| {
        let mut machine = Machine::new(&program, 2e-5).unwrap().on(backend);
        machine.operate(0.01).unwrap();
        machine.set("Fs", 700.0).unwrap();
        machine.operate(0.05).unwrap();
        machine.voltage("B3").unwrap()
    });
    let bits = voltages.map(f64::to_bits);
    assert!(bits[2..].iter().all(|other| *other == bits[1]));
    assert!((voltages[0] - voltages[1]).abs() < 1e-10);
}

/// A ramp that turns back within a step, between two samples.
#[test]
fn a_machine_stops_within_a_step_alike() {
    let ramp = element("ramp").set("rate", 10).set("turn", 0.12345);
    let builder = source(volts("ramp"), "level", 5.0).drive("u", "volt", ramp);
    let program = built(builder.element("A", element("integrator").cords("x10", ["u", "level"])));
    let reference = ran(&program, 1e-3, 0.25).voltage("A").unwrap();
    // -10 (5 t + 5 t^2 up to the turn, and as much back beyond it)
    let turn: f64 = 0.12345;
    let area = |time: f64| 5.0 * time * time;
    let expected = -10.0 * (5.0 * 0.25 + 2.0 * area(turn) - area(2.0 * turn - 0.25));
    assert!((reference - expected).abs() < 1e-9, "{reference} {expected}");
}

/// What jumps on the ends of steps and within them, by itself and by a relay, where a brake holds and lets go; recorded at these
/// instants and between them.
#[test]
fn jumps() {
    let points: Vec<_> =
        (0..40).map(|place| [0.05 * f64::from(place), 60.0 * f64::from(place).sin()]).collect();
    let mut beside = points.clone();
    beside.iter_mut().for_each(|point| point[0] += 0.0123);
    let held = |points: Vec<[f64; 2]>| {
        element("table").set("points", serde_json::json!(points)).set("hold", "previous")
    };
    let relay = element("relay").cord("in", "u").cord("on", "w").cord("off", "ground");
    let mass = element("integrator").cords("x1", ["u", "R", "A"]).cords("brake_x1", ["L"]);
    let patch = volts("held levels")
        .drive("u", "volt", held(points))
        .drive("w", "volt", held(beside))
        .element("R", relay.set("pull_in", 20).set("drop_out", -20))
        .element("L", element("pot").cord("in", "+100").set("setting", 0.3))
        .element("A", mass)
        .element("B", element("integrator").cords("x10", ["A"]))
        .build()
        .unwrap();
    let circuit = circuit(&patch, &[]);
    let program = Program::new(&circuit).unwrap();
    let record = ["u", "w", "R", "A", "B"].map(str::to_owned).to_vec();
    for (step, every) in [(1e-3, 0.05), (1e-3, 2.3e-3), (0.05, 0.05), (0.05, 0.0123), (7e-3, 1e-2)] {
        let settings =
            RunSettings { step, every, record: record.clone(), ..RunSettings::of(&circuit).unwrap() };
        let (folded, reference) = both(&program, &settings.lasting(2.0));
        let found = difference(&folded, &reference);
        assert!(found <= 1e-11, "step {step}, every {every}: {found:e} V");
        let [own, other] = [&folded, &reference].map(|trace| trace.sweeps[0].work.changes);
        assert!(own == other && own >= 20, "{own} {other}");
    }
}
