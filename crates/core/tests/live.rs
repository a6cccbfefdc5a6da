//! A run played in pieces: the same bits as the run at once, and what an operator can do in between.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{ElementBuilder, Patch, PatchBuilder};
use patchcord_core::solve::{Backend, LiveRun, LiveState, RunSettings, run};

/// Every patch that is shipped.
fn shipped_patches() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../patches");
    let folders = ["lessons", "others", "problems", "thesis"].map(|folder| root.join(folder));
    let files = folders.iter().flat_map(|folder| fs::read_dir(folder).unwrap());
    let mut files: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending == "json"));
    files.sort();
    files
}

/// The samples of a live run, in volts, which returns to the caller after pieces of irregular length. The machine is
/// read after each, and some outputs are watched if `is_watched`.
fn samples_in_pieces(program: &Program, settings: &RunSettings, is_watched: bool) -> Vec<Vec<f64>> {
    let mut live = LiveRun::new(program, settings).unwrap();
    if is_watched {
        let outputs: Vec<&str> = program.element_outputs().iter().map(|output| &output.name[..]).collect();
        live.watch(&outputs[outputs.len() / 2..], settings.duration() / 300.0, 0.5).unwrap();
    }
    let mut tracks = vec![Vec::new(); 1 + settings.record.len()];
    let (mut clock, mut pieces) = (0.0, 0_u32);
    loop {
        let state = live.advance(clock, 700).unwrap();
        live.machine().unwrap();
        let samples = live.take_samples();
        tracks[0].extend(&samples.time);
        tracks[1..].iter_mut().zip(&samples.tracks).for_each(|(all, track)| all.extend(&track.volts));
        live.points().clear();
        if state == LiveState::Finished {
            return tracks;
        }
        pieces += 1;
        clock = live.clock() + settings.duration() * (0.002 + 0.01 * f64::from(pieces % 7));
    }
}

#[test]
fn every_shipped_patch_has_the_same_samples_in_pieces_as_at_once() {
    for file in shipped_patches() {
        let circuit = Circuit::new(&Patch::read(&file).unwrap()).unwrap();
        let program = Program::new(&circuit).unwrap();
        let settings = RunSettings::of(&circuit).unwrap();
        // Long runs are cut: the beginning has every kind of step.
        let settings = match settings.duration() / settings.step > 2e5 && settings.phases.len() == 2 {
            true => {
                let duration = 2e5 * settings.step;
                settings.with_duration(duration)
            }
            false => settings,
        };
        let trace = run(&program, &settings).unwrap();
        let mut expected = vec![trace.time.clone()];
        expected.extend(
            trace.tracks.iter().filter(|track| track.derivative.is_none()).map(|track| track.volts.clone()),
        );
        for is_watched in [false, true] {
            let settings = settings.clone().with_sensitivities(Vec::<String>::new());
            assert!(samples_in_pieces(&program, &settings, is_watched) == expected, "{}", file.display());
        }
    }
}

/// x'' = -x with amplitude 80 V, in equal steps of 0.1 s or with a tolerance.
fn oscillator() -> Program {
    let patch = PatchBuilder::new("oscillator")
        .element("A1", ElementBuilder::new("integrator").cords("x1", ["A2"]).set("initial", 80))
        .element("A2", ElementBuilder::new("integrator").cords("x1", ["B1"]))
        .element("B1", ElementBuilder::new("inverter").cord("in", "A1"));
    Program::new(&Circuit::new(&patch.build().unwrap()).unwrap()).unwrap()
}

#[test]
fn points_within_long_steps_are_on_the_curve() {
    let program = oscillator();
    let settings = RunSettings::from_phases([patchcord_core::solve::Phase::operate(6.0)], 0.1);
    let settings = settings.with_signals(["A1"]);
    for settings in
        [settings.clone(), settings.clone().with_backend(Backend::Reference), settings.with_tolerance(1e-6)]
    {
        let mut live = LiveRun::new(&program, &settings).unwrap();
        live.watch(&["A1", "A2"], 0.02, 0.5).unwrap();
        let mut clock = 0.0;
        while live.advance(clock, u64::MAX).unwrap() != LiveState::Finished {
            clock += 0.37;
        }
        let points = live.points();
        assert!(points.len() > 400, "{}", points.len());
        let (mut last_time, mut last_volts) = (0.0, 80.0);
        for (time, volts) in points.iter() {
            assert!((volts[0] - 80.0 * time.cos()).abs() < 2e-3, "{time}: {volts:?}");
            assert!((volts[1].abs() - (80.0 * time.sin()).abs()).abs() < 2e-3, "{time}: {volts:?}");
            assert!(time - last_time < 0.0200001 && f64::abs(volts[0] - last_volts) < 1.7);
            (last_time, last_volts) = (time, volts[0]);
        }
        assert_eq!(last_time, 6.0);
    }
}

#[test]
fn steps_as_long_as_the_distance_of_points_have_no_points_within() {
    let program = oscillator();
    let settings = RunSettings::from_phases([patchcord_core::solve::Phase::operate(3.0)], 1e-3);
    let settings = settings.with_signals(["A1"]);
    for backend in [Backend::Reference, Backend::Interpreter, Backend::Native] {
        let mut live = LiveRun::new(&program, &settings.clone().with_backend(backend)).unwrap();
        live.watch(&["A1"], 1e-3, f64::INFINITY).unwrap();
        while live.advance(4.0, u64::MAX).unwrap() != LiveState::Finished {}
        let points: Vec<(f64, f64)> = live.points().iter().map(|(time, volts)| (time, volts[0])).collect();
        assert!(points.len() >= 3001, "{backend:?}: {}", points.len());
        for pair in points.windows(2) {
            let (time, volts) = pair[1];
            assert!((volts - 80.0 * time.cos()).abs() < 1e-8, "{backend:?}: {volts} V at {time} s");
            let distance = time - pair[0].0;
            assert!(distance.abs() < 1e-9 || (distance - 1e-3).abs() < 1e-9, "{backend:?}: {distance} s");
        }
    }
}

#[test]
fn both_sides_of_a_jump_are_points() {
    let relay = ElementBuilder::new("relay").cord("in", "A1").cord("on", "+100").cord("off", "-100");
    let patch = PatchBuilder::new("jump")
        .element("A1", ElementBuilder::new("integrator").cords("x1", ["-100"]).set("initial", -50))
        .element("K1", relay.set("pull_in", 10).set("drop_out", 5));
    let program = Program::new(&Circuit::new(&patch.build().unwrap()).unwrap()).unwrap();
    let settings = RunSettings::from_phases([patchcord_core::solve::Phase::operate(1.0)], 0.01);
    let mut live = LiveRun::new(&program, &settings.with_signals(["A1"])).unwrap();
    live.watch(&["K1"], 1.0, f64::INFINITY).unwrap();
    while live.advance(2.0, u64::MAX).unwrap() != LiveState::Finished {}
    // A1 = -50 + 100 t passes 10 V at 0.6 s.
    let points: Vec<(f64, f64)> = live.points().iter().map(|(time, volts)| (time, volts[0])).collect();
    let jump = points.windows(2).find(|pair| pair[0].1 != pair[1].1).unwrap();
    assert!((jump[0].0 - 0.6).abs() < 1e-9 && jump[0].0 == jump[1].0, "{jump:?}");
    assert_eq!((jump[0].1, jump[1].1), (-100.0, 100.0));
}

#[test]
fn a_parameter_acts_from_the_present_instant() {
    let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
    let patch = PatchBuilder::new("decay").parameter("k", 0.5, "1", [0.0, 1.0]).element("P1", pot);
    let patch = patch.element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50));
    let circuit = Circuit::new(&patch.run(10.0, 1e-3).build().unwrap()).unwrap();
    let program = Program::new(&circuit).unwrap();
    let mut live = LiveRun::new(&program, &RunSettings::of(&circuit).unwrap()).unwrap();
    while live.clock() < 2.0 {
        live.advance(2.0, 123).unwrap();
    }
    live.set_parameters([("k", 1.0)]).unwrap();
    assert!(live.set_parameters([("k", 2.0)]).is_err());
    live.advance(3.0, u64::MAX).unwrap();
    let volts = live.machine().unwrap().voltage("A1").unwrap();
    assert!((volts - 50.0 * (-2.0_f64).exp()).abs() < 1e-9, "{volts}");
}

#[test]
fn a_run_returns_to_a_checkpoint_with_the_same_bits() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../patches/thesis/fig-8-16.json");
    let circuit = Circuit::new(&Patch::read(file).unwrap()).unwrap();
    let program = Program::new(&circuit).unwrap();
    let mut live = LiveRun::new(&program, &RunSettings::of(&circuit).unwrap()).unwrap();
    let play_to = |live: &mut LiveRun<'_>, clock: f64| {
        while live.clock() < clock - 1e-9 {
            live.advance(clock, 5000).unwrap();
        }
        let machine = live.machine().unwrap();
        (machine.time(), machine.states().to_vec())
    };
    play_to(&mut live, 1.0);
    let checkpoint = live.checkpoint().unwrap();
    play_to(&mut live, 2.0);
    let later = live.checkpoint().unwrap();
    let expected = play_to(&mut live, 2.5);
    live.return_to(&checkpoint);
    assert!((live.clock() - 1.0).abs() < 1e-9 && live.clock() == checkpoint.clock());
    assert_eq!(play_to(&mut live, 2.5), expected);
    // Back, and forward again to a checkpoint that the run has not reached since then.
    live.return_to(&checkpoint);
    play_to(&mut live, 1.5);
    live.return_to(&later);
    assert_eq!(live.clock(), later.clock());
    assert_eq!(play_to(&mut live, 2.5), expected);
}

#[test]
fn another_program_continues_with_the_states() {
    let program = oscillator();
    let settings = RunSettings::from_phases([patchcord_core::solve::Phase::operate(20.0)], 1e-3);
    let settings = settings.with_signals(["A1"]);
    let mut live = LiveRun::new(&program, &settings).unwrap();
    while live.clock() < PI / 2.0 {
        live.advance(PI / 2.0, 1000).unwrap();
    }
    // Without the cord into A2, its voltage stays and A1 rises or falls evenly.
    let patch = PatchBuilder::new("open")
        .element("A1", ElementBuilder::new("integrator").cords("x1", ["A2"]).set("initial", 80));
    let patch = patch.element("A2", ElementBuilder::new("integrator").cords("x1", ["ground"]));
    let open = Program::new(&Circuit::new(&patch.build().unwrap()).unwrap()).unwrap();
    let mut other = LiveRun::new(&open, &settings).unwrap();
    other.continue_from(&mut live).unwrap();
    assert!((other.clock() - live.clock()).abs() < 1e-12 && other.is_operating());
    let begin = other.clock();
    let before = other.machine().unwrap().voltage("A2").unwrap();
    assert!((before.abs() - 80.0).abs() < 0.01);
    while other.clock() < begin + 0.5 {
        other.advance(begin + 0.5, u64::MAX).unwrap();
    }
    let machine = other.machine().unwrap();
    assert_eq!(machine.voltage("A2").unwrap(), before);
    assert!((machine.voltage("A1").unwrap().abs() - 40.0).abs() < 0.1);
}
