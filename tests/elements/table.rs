//! Drive: a table of points.

use std::fs;

use patchcord::circuit::Circuit;
use patchcord::patch::{Patch, PatchBuilder};
use patchcord::program::Program;
use patchcord::solve::{self, Backend, Machine, RunSettings};
use proptest::prelude::*;
use serde_json::json;

use crate::bench::{ANY, bench_drive, drive_stops_at_100_volts, near, out, waits_in_hold};
use crate::common::{built, element, program, ran, random_cases, volts};

/// The value of a table: straight between its points, level outside.
fn looked_up(points: &[[f64; 2]], time: f64) -> f64 {
    for pair in points.windows(2) {
        let ([from, low], [to, high]) = (pair[0], pair[1]);
        if (from..to).contains(&time) {
            return (low * (to - time) + high * (time - from)) / (to - from);
        }
    }
    if time < points[0][0] { points[0][1] } else { points[points.len() - 1][1] }
}

proptest! {
    #![proptest_config(random_cases(48))]

    #[test]
    fn law(first in -0.2..0.2f64, more in prop::collection::vec((0.01..0.3f64, ANY), 1..8), time in 0.0..1.0f64) {
        let mut points = vec![[first, 30.0]];
        for (wait, volts) in more {
            points.push([points[points.len() - 1][0] + wait, volts]);
        }
        let program = bench_drive(element("table").set("points", json!(points)));
        let (found, expected) = (out(&ran(&program, 0.1, time)), looked_up(&points, time));
        prop_assert!((found - expected).abs() < 1e-11, "{found} {expected}");
    }
}

#[test]
fn overload() {
    drive_stops_at_100_volts(element("table").set("points", json!([[0, 130]])), 130.0);
}

#[test]
fn modes() {
    let points = [[0.1, 20.0], [0.5, 60.0], [0.6, -30.0]];
    waits_in_hold(element("table").set("points", json!(points)), |time| looked_up(&points, time));
}

#[test]
fn it_is_level_outside_its_points() {
    let program = bench_drive(element("table").set("points", json!([[0.1, 20], [0.2, 60]])));
    for (time, expected) in [(0.0, 20.0), (0.05, 20.0), (0.3, 60.0)] {
        assert!(near(out(&ran(&program, 1e-2, time)), expected), "{time}");
    }
}

/// The program of a patch file of this text, in a folder with a table.
fn beside(table: &str, points: serde_json::Value, unit: &str) -> Program {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("table.csv"), table).unwrap();
    let drive = element("table").set("points", points);
    let patch = PatchBuilder::new("beside").scale("force", 2, unit).drive("E", "force", drive).build();
    // A built patch looks in the working directory, where there is no such file.
    assert!(Circuit::new(patch.as_ref().unwrap(), &[]).is_err());
    let path = folder.path().join("patch.json");
    patch.unwrap().write(&path).unwrap();
    program(&Patch::read(&path).unwrap(), &[])
}

#[test]
fn a_table_in_a_file_is_that_table() {
    let csv = "# a measurement\nt,other,f\n0.1,7,20\n0.3,7,60\n0.4,7,-30\n";
    let program = beside(csv, json!({"csv": "table.csv", "y": "f"}), "N");
    for time in [0.0, 0.15, 0.37, 0.9] {
        let expected = looked_up(&[[0.1, 10.0], [0.3, 30.0], [0.4, -15.0]], time);
        assert!(near(out(&ran(&program, 1e-2, time)), expected), "{time}");
    }
}

#[test]
fn units_that_a_file_tells_are_converted() {
    let csv = "# t: min\n# f: kN\nt,f\n0,0.02\n0.01,0.08\n";
    let program = beside(csv, json!({"csv": "table.csv"}), "N");
    assert!(near(out(&ran(&program, 1e-2, 0.0)), 10.0));
    assert!(near(out(&ran(&program, 1e-2, 0.3)), 25.0), "half-way to 0.6 s");
}

/// What an integrator makes of straight pieces is known: also where a step is as long as a piece, where steps begin within pieces, and
/// where a second run goes on from between them.
#[test]
fn its_integral_is_exact() {
    let points = [[0.0, 30.0], [0.02, -50.0], [0.03, -50.0], [0.0643, 80.0], [0.08, 10.0], [0.1, 0.0]];
    let area = |time: f64| {
        let mut corners: Vec<f64> = points.iter().map(|point| point[0]).filter(|at| *at < time).collect();
        corners.push(time);
        let pieces = corners
            .windows(2)
            .map(|ends| (ends[1] - ends[0]) * looked_up(&points, 0.5 * (ends[0] + ends[1])));
        pieces.sum::<f64>()
    };
    let builder = volts("integral").drive("u", "volt", element("table").set("points", json!(points)));
    let program = built(builder.element("A", element("integrator").cords("x10", ["u"])));
    for (step, backend) in
        [0.02, 0.01, 5e-3, 3e-3].into_iter().flat_map(|step| Backend::ALL.map(|own| (step, own)))
    {
        let mut machine = Machine::new(&program, step).unwrap().on(backend);
        for length in [0.07, 0.0133, 0.04] {
            machine.operate(length).unwrap();
            let (found, expected) = (machine.voltage("A").unwrap(), -10.0 * area(machine.time()));
            assert!((found - expected).abs() <= 1e-11, "{step} {backend}: {found} {expected}");
        }
    }
}

/// A triangle, recorded on a grid that meets its corners, drives another patch, volt by volt.
#[test]
fn a_recorded_trace_drives_another_patch() {
    let triangle = element("triangle").set("amplitude", 37.3).set("frequency", 2.5);
    let first = volts("first").drive("f", "volt", triangle).record(["f"]).build().unwrap();
    let circuit = Circuit::new(&first, &[]).unwrap();
    let settings = RunSettings { every: 0.02, ..RunSettings::of(&circuit).unwrap() };
    let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
    let mut csv = Vec::new();
    trace.write_csv(&mut csv).unwrap();
    let second =
        beside(std::str::from_utf8(&csv).unwrap(), json!({"csv": "table.csv", "x": "t", "y": "f"}), "V");
    for (time, volts) in trace.time.iter().zip(&trace.tracks[0].volts) {
        let found = out(&ran(&second, 1e-2, *time));
        assert!(near(found, 0.5 * volts), "{time}: {found} {volts}");
    }
}
