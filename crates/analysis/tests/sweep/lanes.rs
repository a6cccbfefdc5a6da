//! Runs side by side are those that each is alone, to the last bit.

use std::path::PathBuf;

use super::{near, program, rows, sweep};
use crate::common::dice::Dice;
use crate::common::files::{representative, shipped};
use crate::common::traces::bits;
use crate::common::{element, slideway, volts};
use patchcord_core::document::Phase;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{self, Backend, RunSettings, Stopped};
use patchcord_core::trace::Trace;

/// Everything that a run leaves.
fn left(outcome: &Result<Trace, Stopped>) -> (Option<String>, &Trace) {
    match outcome {
        Ok(trace) => (None, trace),
        Err(stopped) => (Some(stopped.error.to_string()), &stopped.trace),
    }
}

/// Runs programs abreast and alone; how many of the runs had to stop.
fn compared(programs: &[Program], settings: &RunSettings, told: &str) -> usize {
    let on = |backend| RunSettings { backend, ..settings.clone() };
    let alone: Vec<_> =
        programs.iter().map(|program| solve::run(program, &on(Backend::Interpreter))).collect();
    for backend in [Backend::Lanes, Backend::Automatic] {
        let abreast = solve::run_abreast(programs, &on(backend));
        assert_eq!(abreast.len(), alone.len());
        for (index, (abreast, alone)) in abreast.iter().zip(&alone).enumerate() {
            let [(error, trace), (expected, other)] = [left(abreast), left(alone)];
            assert_eq!(error, expected, "{told} by {backend}: run {index}");
            assert!(trace == other && bits(trace) == bits(other), "{told} by {backend}: run {index}");
        }
    }
    alone.iter().filter(|outcome| outcome.is_err()).count()
}

/// So many steps of what a patch asks for, recorded within steps too.
fn some_of(settings: RunSettings, steps: f64) -> RunSettings {
    let settings = RunSettings { tolerance: None, sensitivities: Vec::new(), ..settings };
    let asked = settings.whole() / settings.step;
    let settings = if asked > steps { settings.clone().lasting(steps * settings.step) } else { settings };
    RunSettings { every: (7.3 * settings.step).min(settings.duration()), ..settings }
}

#[test]
fn representative_patches() {
    assert!(runs_compared(representative()) > 30);
}

#[test]
#[ignore = "takes twenty seconds"]
fn every_shipped_patch() {
    assert!(runs_compared(shipped()) > 120);
}

/// Compares runs side by side with runs alone, and counts them.
fn runs_compared(files: Vec<PathBuf>) -> usize {
    let mut runs = 0;
    for file in files {
        let patch = crate::common::patch_of(&file);
        let (circuit, own) = program(&patch, &[]).unwrap();
        let turned = [0.05, 0.3, 0.0, 0.15, 0.02, 0.5].map(|toward| {
            let (changes, mut turned) = (near(&patch, toward), own.clone());
            let named: Vec<_> = changes.iter().map(|(name, value)| (name.as_str(), *value)).collect();
            turned.set_parameters(named).ok().map(|()| turned)
        });
        let programs: Vec<_> = turned.into_iter().flatten().collect();
        let settings = some_of(RunSettings::of(&circuit).unwrap(), 6000.0);
        compared(&programs, &settings, &file.display().to_string());
        runs += programs.len();
    }
    runs
}

/// More circuits than there are lanes, of everything that bends, switches, stops and remembers.
#[test]
fn random_circuits() {
    let mut dice = Dice(32);
    for number in 0..25 {
        let (circuit, own) = program(&crate::common::circuits::circuit(&mut dice), &[]).unwrap();
        let record = ["A0", "A1", "A2", "N0", "N3", "u", "w"].map(str::to_owned).to_vec();
        let settings = RunSettings { step: 1.3e-3, record, ..RunSettings::of(&circuit).unwrap() };
        let programs: Vec<_> = (0..19).map(|_| turned(&own, &mut dice)).collect();
        compared(&programs, &some_of(settings.lasting(2.0), f64::INFINITY), &format!("circuit {number}"));
    }
}

/// The same program with its parameters set by chance.
fn turned(program: &Program, dice: &mut Dice) -> Program {
    let mut turned = program.clone();
    let values = crate::common::circuits::PARAMETERS.map(|name| (name, dice.even(0.3, 0.9)));
    turned.set_parameters(values).unwrap();
    turned
}

/// Without lamps, beyond ±100 V: every lane comes there, and back, at another step.
#[test]
fn runs_beyond_their_range() {
    let sine = element("sine").set("amplitude", 60).set("frequency", 1);
    let patch = volts("beyond its range")
        .parameter("g", 0.5, "1", [0.0, 1.0])
        .drive("u", "volt", sine)
        .element("P", element("pot").cord("in", "u").set("setting", "g"))
        .element("S", element("summer").cords("x4", ["P"]))
        .element("A", element("integrator").cords("x1", ["S"]).cords("x10", ["P"]))
        .run(2.0, 1e-3)
        .build()
        .unwrap();
    let (circuit, own) = program(&patch, &[]).unwrap();
    let record = ["S", "A"].map(str::to_owned).to_vec();
    let settings = RunSettings { lamps: false, record, ..RunSettings::of(&circuit).unwrap() };
    let programs: Vec<_> = (0..19).map(|run| set(&own, &[("g", f64::from(run) / 18.0)])).collect();
    assert_eq!(compared(&programs, &settings, "beyond its range"), 0);
}

/// Curves through points, whose corners the lanes cross together.
#[test]
fn runs_driven_by_points() {
    let (circuit, own) = program(&crate::common::driven_by_points("L"), &[]).unwrap();
    let record = ["u", "S", "A1", "A2"].map(str::to_owned).to_vec();
    let programs: Vec<_> = (0..19).map(|run| set(&own, &[("g", f64::from(run) / 20.0)])).collect();
    for every in [1e-3, 2.3e-3] {
        let settings = RunSettings { record: record.clone(), every, ..RunSettings::of(&circuit).unwrap() };
        assert_eq!(compared(&programs, &settings, "driven by points"), 0);
    }
    // Some go through other points, and share their kernels with the rest.
    let mut other = own.clone();
    solve::set_drive_table(
        &mut other,
        "u",
        (0..200).map(|place| [0.005 * f64::from(place), 0.3 * f64::from(place)]).collect(),
    )
    .unwrap();
    let some =
        |run: u32| set(if run.is_multiple_of(3) { &other } else { &own }, &[("g", f64::from(run) / 20.0)]);
    let programs: Vec<_> = (0..19).map(some).collect();
    assert_eq!(compared(&programs, &RunSettings { record, ..RunSettings::of(&circuit).unwrap() }, "fed"), 0);
}

/// Delays of whole steps and of others, short and long, another in every lane.
#[test]
fn runs_with_delays() {
    let (circuit, own) = program(&crate::common::late_and_bent(), &[]).unwrap();
    let record = ["D1", "D2", "S", "A2"].map(str::to_owned).to_vec();
    for (step, every) in [(1e-3, 1e-3), (2.5e-3, 1e-2), (7e-4, 2.3e-3)] {
        let settings =
            RunSettings { step, every, record: record.clone(), ..RunSettings::of(&circuit).unwrap() };
        let times =
            |run: u32| [1.0 + 0.31 * f64::from(run), 1.0 + f64::from(run * run)].map(|steps| steps * step);
        let all: Vec<_> = (0..19).map(times).map(|[t, f]| set(&own, &[("T", t), ("F", f)])).collect();
        assert_eq!(compared(&all, &settings, "late"), 0);
        // Hardly another, as where a fit takes differences.
        let near = |run: u32| set(&own, &[("T", 0.0123 + 1e-7 * f64::from(run)), ("F", 0.01)]);
        let all: Vec<_> = (0..16).map(near).collect();
        assert_eq!(compared(&all, &settings, "nearly as late"), 0);
    }
}

/// An integrator that its own relay turns back: with hysteresis it swings, without it the relay chatters once it is met. A
/// second one follows it.
fn kept_by_a_relay() -> Patch {
    let relay = element("relay").cord("in", "A1").cord("on", "+100").cord("off", "-100");
    let builder = volts("kept by a relay")
        .parameter("start", 40.0, "1", [-90.0, 90.0])
        .parameter("hysteresis", 1.0, "1", [1e-9, 10.0])
        .element("K1", relay.set("pull_in", "hysteresis").set("drop_out", "-hysteresis"))
        .element("A1", element("integrator").cords("x1", ["K1"]).set("initial", "start"))
        .element("A2", element("integrator").cords("x10", ["A1"]));
    builder.build().unwrap()
}

fn set(program: &Program, values: &[(&str, f64)]) -> Program {
    let mut program = program.clone();
    program.set_parameters(values.iter().copied()).unwrap();
    program
}

#[test]
fn runs_that_stop_leave_the_others_alone() {
    let (circuit, own) = program(&kept_by_a_relay(), &[]).unwrap();
    let record = vec!["A1".to_owned(), "K1".to_owned()];
    let settings = RunSettings { record, every: 0.013, ..RunSettings::of(&circuit).unwrap() }.lasting(1.0);
    // Every third chatters, each at another time; one from the beginning.
    let programs: Vec<_> = (0..16)
        .map(|run| {
            let hysteresis = if run % 3 == 0 { 1e-9 } else { 0.5 + f64::from(run) / 10.0 };
            set(&own, &[("start", f64::from(5 * run)), ("hysteresis", hysteresis)])
        })
        .collect();
    assert_eq!(compared(&programs, &settings, "kept by a relay"), 6);
}

/// Phases that end for every run in its own time, by a relay or by an overload, so that the others are elsewhere.
#[test]
fn runs_that_part_stay_what_they_are() {
    let (circuit, own) = program(&kept_by_a_relay(), &[]).unwrap();
    let phases = vec![
        Phase::operate_until(0.6, "K1", None),
        Phase::Hold { time: 0.1 },
        Phase::operate(0.3),
        Phase::set("hysteresis", 2.0),
        Phase::operate(0.2),
        Phase::Repeat { times: 2, phases: vec![Phase::InitialCondition, Phase::operate(0.15)] },
    ];
    let record = ["A1", "A2", "K1"].map(str::to_owned).to_vec();
    let settings = RunSettings { record, every: 0.01, phases, ..RunSettings::of(&circuit).unwrap() };
    let start = |run: u32| [("start", f64::from(6 * run) - 20.0)];
    let programs: Vec<_> = (0..16).map(|run| set(&own, &start(run))).collect();
    for hold_on_overload in [false, true] {
        let settings = RunSettings { hold_on_overload, ..settings.clone() };
        assert_eq!(compared(&programs, &settings, "phases"), 0);
        let traces = programs.iter().map(|program| solve::run(program, &settings).unwrap());
        let overloaded = traces.filter(|trace| trace.overloads().next().is_some()).count();
        assert!((4..12).contains(&overloaded), "{overloaded}");
    }
}

/// What is too small to matter becomes 0 at the same step in every lane.
#[test]
fn small_voltages_become_nothing() {
    let decaying = element("integrator").cords("x10", ["A1"]).set("initial", "start");
    let builder = volts("decay").parameter("start", 1.0, "1", [-100.0, 100.0]).element("A1", decaying);
    let (circuit, own) = program(&builder.build().unwrap(), &[]).unwrap();
    let record = vec!["A1".to_owned()];
    let settings = RunSettings { step: 0.02, every: 0.02, record, ..RunSettings::of(&circuit).unwrap() };
    let programs: Vec<_> = (0..16).map(|run| set(&own, &[("start", 10f64.powi(run) * 1e-14)])).collect();
    let settings = settings.lasting(40.0);
    assert_eq!(compared(&programs, &settings, "decay"), 0);
    let trace = solve::run(&programs[0], &settings).unwrap();
    assert!(trace.tracks[0].volts.last().is_some_and(|volts| volts.abs() < 1e-110));
}

#[test]
fn the_table_is_the_same_on_any_number_of_threads() {
    let with = |backend| {
        sweep(
            &slideway(),
            &["VcL=1.27e-3:25.4e-3:5:log", "Tc=0.006:0.025:9"],
            &["peak:v_o", "stick_end", "frequency:v_o,last=0.1"],
            |own| RunSettings { backend, ..own.lasting(0.25) },
        )
    };
    let alone = rows(&with(Backend::Interpreter), 1);
    assert_eq!(alone.len(), 45);
    for backend in [Backend::Lanes, Backend::Automatic] {
        for threads in [1, 2, 3, 20] {
            assert_eq!(rows(&with(backend), threads), alone, "{backend}, {threads} threads");
        }
    }
}

/// A sample next to the end of a step is taken there by everyone or by no one, whoever flies beside whom.
#[test]
fn samples_next_to_the_ends_of_steps_are_the_same_in_any_company() {
    let lesson = crate::common::shipped("lessons/mass-and-spring");
    let with = |backend| {
        sweep(&lesson, &["k=5:8:16"], &["frequency:x,last=12"], |own| {
            let settings = RunSettings { backend, step: 1e-3, ..own.lasting(12.0) };
            RunSettings { every: 0.149_999_999_999_81, ..settings }
        })
    };
    let alone = rows(&with(Backend::Interpreter), 1);
    for backend in [Backend::Interpreter, Backend::Native, Backend::Lanes, Backend::Automatic] {
        for threads in [1, 2, 8, 16] {
            assert_eq!(rows(&with(backend), threads), alone, "{backend}, {threads} threads");
        }
    }
}
