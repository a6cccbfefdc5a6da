//! Drive: a table of points.

use std::fs;

use proptest::prelude::*;
use serde_json::json;

use crate::common::{built, element, program, random_cases, run_for, volts};
use crate::elements::bench::{ANY, bench_drive, drive_stops_at_100_volts, near, out, waits_in_hold};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Patch, PatchBuilder, TableAccess};
use patchcord_core::solve::{self, Backend, DriveTableError, Machine, RunSettings};

/// The value of a table with "hold": "previous". Before the first point it has the first value.
fn staircase(points: &[[f64; 2]], time: f64) -> f64 {
    points.iter().rev().find(|point| point[0] <= time).unwrap_or(&points[0])[1]
}

/// The value of a table with linear interpolation. Outside the points it is constant.
fn interpolated(points: &[[f64; 2]], time: f64) -> f64 {
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
        for (interval, volts) in more {
            points.push([points[points.len() - 1][0] + interval, volts]);
        }
        let program = bench_drive(element("table").set("points", json!(points)));
        let (found, expected) = (out(&run_for(&program, 0.1, time)), interpolated(&points, time));
        prop_assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        let program = bench_drive(element("table").set("points", json!(points)).set("hold", "previous"));
        let (found, expected) = (out(&run_for(&program, 0.1, time)), staircase(&points, time));
        prop_assert!((found - expected).abs() < 1e-11, "{found} {expected}");
    }
}

#[test]
fn overload() {
    for hold in ["linear", "previous"] {
        drive_stops_at_100_volts(element("table").set("points", json!([[0, 130]])).set("hold", hold), 130.0);
    }
}

#[test]
fn modes() {
    let points = [[0.1, 20.0], [0.5, 60.0], [0.6, -30.0]];
    let table = element("table").set("points", json!(points));
    waits_in_hold(table.clone(), |time| interpolated(&points, time));
    waits_in_hold(table.set("hold", "previous"), |time| staircase(&points, time));
}

#[test]
fn a_table_is_constant_outside_its_points() {
    let program = bench_drive(element("table").set("points", json!([[0.1, 20], [0.2, 60]])));
    for (time, expected) in [(0.0, 20.0), (0.05, 20.0), (0.3, 60.0)] {
        assert!(near(out(&run_for(&program, 1e-2, time)), expected), "{time}");
    }
}

/// The program of a patch that is read from a folder with the file table.csv. `points` refers to that file.
fn with_csv(table: &str, points: serde_json::Value, unit: &str) -> Program {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("table.csv"), table).unwrap();
    let drive = element("table").set("points", points);
    let patch =
        PatchBuilder::new("with a csv file").scale("force", 2, unit).drive("E", "force", drive).build();
    // A patch that was not read from a file looks in the working directory, where there is no such file.
    assert!(Circuit::new(patch.as_ref().unwrap()).is_err());
    let path = folder.path().join("patch.json");
    patch.unwrap().write(&path).unwrap();
    program(&Patch::read(&path).unwrap(), &[])
}

#[test]
fn a_table_in_a_file_gives_its_values() {
    let csv = "# a measurement\nt,other,f\n0.1,7,20\n0.3,7,60\n0.4,7,-30\n";
    let program = with_csv(csv, json!({"csv": "table.csv", "y": "f"}), "N");
    for time in [0.0, 0.15, 0.37, 0.9] {
        let expected = interpolated(&[[0.1, 10.0], [0.3, 30.0], [0.4, -15.0]], time);
        assert!(near(out(&run_for(&program, 1e-2, time)), expected), "{time}");
    }
}

#[test]
fn units_in_a_file_are_converted() {
    let csv = "# t: min\n# f: kN\nt,f\n0,0.02\n0.01,0.08\n";
    let program = with_csv(csv, json!({"csv": "table.csv"}), "N");
    assert!(near(out(&run_for(&program, 1e-2, 0.0)), 10.0));
    assert!(near(out(&run_for(&program, 1e-2, 0.3)), 25.0), "half-way to 0.6 s");
}

#[test]
fn a_text_with_the_points_of_its_tables_needs_no_files() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("force.csv"), "t (ms),f (kN)\n0,0.02\n500,0.08\n").unwrap();
    fs::write(folder.path().join("curve.csv"), "x,y\n-100,100\n100,-100\n").unwrap();
    let text = r#"{"patchcord": 1, "scales": {"force": {"per_volt": 2, "unit": "N"}},
        "drives": {"E": {"kind": "table", "scale": "force", "points": {"csv": "force.csv"}, "note": "ä"}},
        "elements": {"F1": {"kind": "function-generator", "in": "E", "points": { "csv": "curve.csv", "x": "x" }}},
        "run": {"for": 1, "step": 0.01}, "record": ["F1"]}"#;
    let patch = Patch::parse_in(folder.path(), "p.json", text).unwrap();
    let inside = patch.text_with_tables().unwrap();
    let expected = text.replace(r#"{"csv": "force.csv"}"#, "[[0.0,20.0],[0.5,80.0]]");
    let expected = expected.replace(r#"{ "csv": "curve.csv", "x": "x" }"#, "[[-100.0,100.0],[100.0,-100.0]]");
    assert_eq!(inside, expected);
    let other = Patch::parse_with(TableAccess::None, "p.json", &inside).unwrap();
    assert_eq!(other.text_with_tables().unwrap(), inside, "a text without references stays as it is");
    Circuit::new(&other).unwrap();
}

#[test]
fn a_table_that_cannot_be_read_has_no_text() {
    let text = r#"{"patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}}, "record": ["A9"],
        "drives": {"u": {"kind": "table", "scale": "volt", "points": {"csv": "no-such-table.csv"}}}}"#;
    let report = Patch::parse("p.json", text).unwrap().text_with_tables().unwrap_err();
    assert_eq!(report.findings.len(), 1, "{report}");
    assert!(report.findings[0].message.contains("no-such-table.csv"), "{report}");
}

#[test]
fn units_in_the_names_of_columns_are_converted() {
    let csv = "t (ms),f [kN]\n0,0.02\n600,0.08\n";
    for points in [json!({"csv": "table.csv"}), json!({"csv": "table.csv", "x": "t", "y": "f"})] {
        let program = with_csv(csv, points, "N");
        assert!(near(out(&run_for(&program, 1e-2, 0.0)), 10.0));
        assert!(near(out(&run_for(&program, 1e-2, 0.3)), 25.0), "half-way to 0.6 s");
    }
}

#[test]
fn speeds_in_a_file_are_converted_to_cycles_per_second() {
    let program = with_csv("t,n (rpm)\n0,1200\n1,1200\n", json!({"csv": "table.csv"}), "Hz");
    assert!(near(out(&run_for(&program, 1e-2, 0.5)), 10.0), "20 Hz at 2 Hz per volt");
}

#[test]
fn revolutions_in_a_file_are_not_taken_for_radians() {
    for (unit, scale, value) in
        [("1/min", "rpm", 120), ("1/s", "rpm", 2), ("rpm", "1/s", 7200), ("rpm", "1/min", 120)]
    {
        let csv = format!("t,n ({unit})\n0,{value}\n1,{value}\n");
        let program = with_csv(&csv, json!({"csv": "table.csv"}), scale);
        assert!(near(out(&run_for(&program, 1e-2, 0.5)), 60.0), "{value} {unit} are 120 {scale}");
    }
}

#[test]
fn units_in_full_are_converted() {
    let csv = "t (milliseconds),f {kilonewtons}\n0,0.02\n600,0.08\n";
    let program = with_csv(csv, json!({"csv": "table.csv", "x": "t", "y": "f"}), "N");
    assert!(near(out(&run_for(&program, 1e-2, 0.3)), 25.0), "half-way to 0.6 s");
}

/// Points in s and V of the tables below.
const POINTS: [[f64; 2]; 6] =
    [[0.0, 30.0], [0.02, -50.0], [0.03, -50.0], [0.0643, 80.0], [0.08, 10.0], [0.1, 0.0]];

/// The integral of the table from 0 to a time, with linear interpolation or as a staircase.
fn area(hold: &str, time: f64) -> f64 {
    let mut corners: Vec<f64> = POINTS.iter().map(|point| point[0]).filter(|corner| *corner < time).collect();
    corners.push(time);
    let value = |time| if hold == "linear" { interpolated(&POINTS, time) } else { staircase(&POINTS, time) };
    corners.windows(2).map(|ends| (ends[1] - ends[0]) * value(0.5 * (ends[0] + ends[1]))).sum()
}

/// A patch with the drive u through POINTS.
fn through_points(hold: &str) -> PatchBuilder {
    let table = element("table").set("points", json!(POINTS)).set("hold", hold);
    volts("through points").drive("u", "volt", table)
}

/// The integral of straight lines and of a staircase is exact. Steps are shorter than the intervals or equal, begin
/// within them, and a second run continues from within one.
#[test]
fn the_integral_of_a_table_is_exact() {
    for (hold, step) in
        ["linear", "previous"].into_iter().flat_map(|hold| [0.02, 0.01, 5e-3, 3e-3].map(|step| (hold, step)))
    {
        let program = built(through_points(hold).element("A", element("integrator").cords("x10", ["u"])));
        for backend in Backend::ALL {
            let mut machine = Machine::new(&program, step).unwrap().with_backend(backend);
            for length in [0.07, 0.0133, 0.04] {
                machine.operate(length).unwrap();
                let (found, expected) = (machine.voltage("A").unwrap(), -10.0 * area(hold, machine.time()));
                assert!((found - expected).abs() <= 1e-11, "{hold} {step} {backend}: {found} {expected}");
            }
        }
        let mut machine = Machine::adaptive(&program, 1e-6, step).unwrap();
        machine.operate(0.12).unwrap();
        assert!((machine.voltage("A").unwrap() + 10.0 * area(hold, 0.12)).abs() <= 1e-11, "{hold}");
    }
}

/// A sample at a jump has the new value.
#[test]
fn samples_at_a_jump_show_the_new_value() {
    let builder =
        through_points("previous").element("S", element("summer").cords("x1", ["u"])).run(0.1, 0.01);
    let circuit = Circuit::new(&builder.build().unwrap()).unwrap();
    let program = Program::new(&circuit).unwrap();
    for backend in Backend::ALL {
        let settings = RunSettings::of(&circuit).unwrap().with_signals(["S"]).with_backend(backend);
        let trace = solve::run(&program, &settings).unwrap();
        let expected: Vec<f64> = trace.time.iter().map(|time| -staircase(&POINTS, time + 1e-9)).collect();
        assert_eq!(trace.tracks[0].volts, expected, "{backend}");
        let extremes = trace.tracks[0].extremes[0];
        // The 80 V begin between two samples.
        assert_eq!((extremes.least.volts, extremes.most.volts), (-80.0, 50.0), "{backend}");
    }
}

/// The integral of a delayed staircase is exact, and so are its derivatives by the delay and by a potentiometer.
#[test]
fn a_staircase_is_delayed_and_differentiated() {
    let builder = through_points("previous")
        .parameter("T", 0.0311, "s", [0.02, 0.2])
        .parameter("g", 0.7, "1", [0.0, 1.0])
        .element("D", element("delay").cord("in", "u").set("delay", "T").set("initial", 0))
        .element("P", element("pot").cord("in", "D").set("setting", "g"))
        .element("A", element("integrator").cords("x10", ["P"]));
    let program = built(builder);
    for step in [0.01, 4e-3, 1e-3] {
        let mut machine = Machine::new(&program, step).unwrap();
        machine.differentiate(["T", "g"]).unwrap();
        for _ in 0..3 {
            machine.operate(0.0377).unwrap();
            let delayed_time = machine.time() - 0.0311;
            let [by_delay, by_pot] = ["T", "g"].map(|name| machine.sensitivity("A", name).unwrap());
            let integral = area("previous", delayed_time);
            for (found, expected) in [
                (machine.voltage("A").unwrap(), -7.0 * integral),
                (by_delay, 7.0 * staircase(&POINTS, delayed_time)),
                (by_pot, -10.0 * integral),
            ] {
                assert!((found - expected).abs() <= 1e-9, "{step}, {delayed_time}: {found} {expected}");
            }
        }
    }
}

/// A drive with a replaced table equals a drive with that table in the patch.
#[test]
fn the_table_of_a_drive_can_be_replaced() {
    let builder = |points: &[[f64; 2]], hold: &str| {
        let table = element("table").set("points", json!(points)).set("hold", hold);
        let builder = PatchBuilder::new("replaced").scale("force", 2, "N").drive("u", "force", table);
        builder.element("A", element("integrator").cords("x10", ["u"]))
    };
    for hold in ["linear", "previous"] {
        let mut program = built(builder(&[[0.0, 7.0], [0.05, 9.0]], hold));
        let first = run_for(&program, 7e-3, 0.2).voltage("A").unwrap();
        solve::set_drive_table(&mut program, "u", POINTS.to_vec()).unwrap();
        let replaced = program.clone();
        let expected = run_for(&built(builder(&POINTS, hold)), 7e-3, 0.2).voltage("A").unwrap();
        assert_ne!(first, expected);
        assert_eq!(run_for(&replaced, 7e-3, 0.2).voltage("A").unwrap(), expected, "{hold}");
        assert!((expected + 5.0 * area(hold, 0.2)).abs() <= 1e-11);
    }
}

#[test]
fn invalid_replacement_tables_are_refused_without_effect() {
    let builder = through_points("linear").drive("s", "volt", element("step").set("height", 3));
    let mut program = built(builder.element("A", element("integrator").cords("x10", ["u", "s"])));
    let drive_name = || "u".to_owned();
    let refused = [
        ("A", vec![[0.0, 1.0]], DriveTableError::UnknownDrive("A".to_owned())),
        ("x", vec![[0.0, 1.0]], DriveTableError::UnknownDrive("x".to_owned())),
        ("s", vec![[0.0, 1.0]], DriveTableError::NotATable("s".to_owned())),
        ("u", vec![], DriveTableError::NoPoints(drive_name())),
        (
            "u",
            vec![[0.0, 1.0], [1.0, f64::NAN]],
            DriveTableError::NotFinite { drive: drive_name(), index: 1 },
        ),
        ("u", vec![[f64::INFINITY, 1.0]], DriveTableError::NotFinite { drive: drive_name(), index: 0 }),
        (
            "u",
            vec![[0.0, 1.0], [1.0, 1.0], [1.0, 2.0]],
            DriveTableError::NotRising { drive: drive_name(), index: 2 },
        ),
    ];
    for (drive, points, error) in refused {
        assert_eq!(solve::set_drive_table(&mut program, drive, points), Err(error));
    }
    let found = run_for(&program, 0.01, 0.1).voltage("A").unwrap();
    assert!((found + 10.0 * (area("linear", 0.1) + 0.3)).abs() <= 1e-11, "the patch changed: {found}");
}

/// A recorded triangle drives another patch. The samples include its corners.
#[test]
fn a_recorded_trace_drives_another_patch() {
    let triangle = element("triangle").set("amplitude", 37.3).set("frequency", 2.5);
    let first = volts("first").drive("f", "volt", triangle).record(["f"]).build().unwrap();
    let circuit = Circuit::new(&first).unwrap();
    let settings = RunSettings::of(&circuit).unwrap().with_sample_interval(0.02);
    let trace = solve::run(&Program::new(&circuit).unwrap(), &settings).unwrap();
    let mut csv = Vec::new();
    trace.write_csv(&mut csv).unwrap();
    let second =
        with_csv(std::str::from_utf8(&csv).unwrap(), json!({"csv": "table.csv", "x": "t", "y": "f"}), "V");
    for (time, volts) in trace.time.iter().zip(&trace.tracks[0].volts) {
        let found = out(&run_for(&second, 1e-2, *time));
        assert!(near(found, 0.5 * volts), "{time}: {found} {volts}");
    }
}
