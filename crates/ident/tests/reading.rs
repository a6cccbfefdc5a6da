//! What is read of good experiments.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use proptest::prelude::*;
use serde_json::{Value, json};
use tempfile::TempDir;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_expr::Unit;
use patchcord_ident::{Experiment, Hold, Record};

/// A folder with the patch of these tests.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::copy("tests/base.json", folder.path().join("base.json")).unwrap();
    folder
}

fn put(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap();
}

/// An experiment on data.csv, with other keys than the usual ones.
fn read(folder: &TempDir, changes: &Value) -> Experiment {
    let mut document =
        json!({"patch": "base.json", "data": "data.csv", "drives": {"F": "F"}, "outputs": {"x": "x"}});
    for (key, value) in changes.as_object().unwrap() {
        document[key] = value.clone();
    }
    let text = document.to_string();
    Experiment::parse_in(folder.path(), "e.json", &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Rows of time, force, velocity and position: these are 1, 2 and 3 times the number of the row.
fn table(rows: impl Iterator<Item = usize>, interval: f64) -> String {
    let mut text = "t,F,v,x\n".to_owned();
    for row in rows {
        let (time, row) = (row as f64 * interval, 1e-2 * row as f64);
        writeln!(text, "{time},{row},{row},{}", 3.0 * row).unwrap();
    }
    text
}

fn begins_and_ends(record: &Record) -> (f64, f64) {
    let tenth = |time: f64| (1e6 * time).round() / 1e6;
    (tenth(record.begin), tenth(record.begin + record.duration()))
}

#[test]
fn a_record_is_cut_in_three_quarters_and_one() {
    let folder = folder();
    put(&folder, "data.csv", &table(0..80, 0.1));
    let made = read(&folder, &json!({}));
    assert_eq!(made.warnings.to_string(), "");
    let [train, test] = [&made.train, &made.test].map(|records| &records[0]);
    assert_eq!((begins_and_ends(train), begins_and_ends(test)), ((0.0, 5.9), (6.0, 7.9)));
    assert_eq!((train.len(), test.len(), train.missing(), train.drives.len()), (60, 20, 0, 1));
    assert!((train.interval - 0.1).abs() < 1e-12);
    assert!((test.drives[0][0] - 0.6).abs() < 1e-12 && (test.outputs[0][0] - 1.8).abs() < 1e-12);
    assert_eq!(made.fit, ["M", "f"], "what has a range and is read by more than the drive");
    let [drive, output] =
        [(&made.drives[0].drive, &made.drives[0].unit), (&made.outputs[0].signal, &made.outputs[0].unit)];
    assert_eq!((drive.0.as_str(), drive.1.text(), output.0.as_str(), output.1.text()), ("F", "N", "x", "m"));
    assert_eq!(
        (made.drives[0].hold, made.outputs[0].offset, made.outputs[0].sigma),
        (Hold::Linear, false, None)
    );
}

#[test]
fn ranges_decide_what_is_trained_and_tested_on() {
    let folder = folder();
    ["data.csv", "again.csv"].into_iter().for_each(|file| put(&folder, file, &table(0..80, 0.1)));
    let parts = |changes: Value| {
        let made = read(&folder, &changes);
        assert_eq!(made.warnings.to_string(), "");
        let of = |records: &[Record]| records.iter().map(begins_and_ends).collect::<Vec<_>>();
        (of(&made.train), of(&made.test))
    };
    let range = json!({"data": "again.csv", "range": [2, 6]});
    let cases = [
        (json!({"train": [0, 4]}), vec![(0.0, 4.0)], vec![(4.1, 7.9)]),
        (json!({"train": [0, 4], "test": [4, 6]}), vec![(0.0, 4.0)], vec![(4.1, 6.0)]),
        (json!({"train": [4, 7], "test": [2, 4]}), vec![(4.0, 7.0)], vec![(2.0, 3.9)]),
        (json!({"test": [4, 6]}), vec![(0.0, 3.9)], vec![(4.0, 6.0)]),
        (json!({"test": [0, 3]}), vec![(3.1, 7.9)], vec![(0.0, 3.0)]),
        (json!({"train": [0.04, 3.96]}), vec![(0.1, 3.9)], vec![(4.0, 7.9)]),
        (json!({"data": range, "train": [0, 4]}), vec![(2.0, 4.0)], vec![(4.1, 6.0)]),
        (
            json!({"data": ["data.csv", range], "test": [5, 7.9]}),
            vec![(0.0, 4.9), (2.0, 4.9)],
            vec![(5.0, 7.9), (5.0, 6.0)],
        ),
    ];
    for (changes, train, test) in cases {
        assert_eq!(parts(changes.clone()), (train, test), "{changes}");
    }
}

#[test]
fn a_test_of_its_own_leaves_all_of_the_record_to_train_on() {
    let folder = folder();
    put(&folder, "data.csv", &table(0..40, 0.1));
    put(&folder, "other.csv", &table(10..60, 0.1).replace("t,F,v,x", "t,F,v,position"));
    let test = json!({"data": "other.csv", "range": [2, 4], "columns": {"x": "position"}});
    let made = read(&folder, &json!({"test": test}));
    assert_eq!((made.train[0].len(), begins_and_ends(&made.test[0])), (40, (2.0, 4.0)));
    assert_eq!(made.test[0].name, "other.csv (position)");
}

#[test]
fn one_file_may_hold_two_records_beside_each_other() {
    let folder = folder();
    let rows: String = (0..40)
        .map(|row| {
            format!("0.{row:02},{},{},{},0.1,\n", 0.02 * f64::from(row), 3 * row, row % 10 * (row % 10))
        })
        .collect();
    put(&folder, "data.csv", &format!("\"uEst\",\"uVal\",\"yEst\",\"yVal\",\"Ts\",\n{rows}"));
    let made = read(
        &folder,
        &json!({
            "time": {"interval": 100, "unit": "ms"},
            "drives": {"F": {"column": "uEst", "hold": "previous"}},
            "outputs": {"x": {"column": "yEst", "unit": "cm", "sigma": 0.5, "offset": true}},
            "test": {"data": "data.csv", "columns": {"uEst": "uVal", "yEst": "yVal"}},
        }),
    );
    let [train, test] = [&made.train[0], &made.test[0]];
    assert_eq!((train.len(), test.len(), train.interval, train.begin), (40, 40, 0.1, 0.0));
    assert_eq!(
        (train.drives[0][3], train.outputs[0][3], test.drives[0][3], test.outputs[0][3]),
        (0.03, 0.09, 0.06, 0.09)
    );
    assert_eq!((made.drives[0].hold, made.outputs[0].offset), (Hold::Previous, true));
    assert!((made.outputs[0].sigma.unwrap() - 5e-3).abs() < 1e-15);
    assert!(made.warnings.findings.is_empty(), "{}", made.warnings);
}

#[test]
fn rows_may_be_missing() {
    let folder = folder();
    put(&folder, "data.csv", &table((0..80).filter(|row| !(10..13).contains(row)), 0.1));
    let made = read(&folder, &json!({}));
    let train = &made.train[0];
    assert_eq!((train.len(), train.missing(), made.warnings.warnings()), (60, 3, 1));
    assert!(train.outputs[0][10..13].iter().all(|sample| sample.is_nan()));
    assert!((train.drives[0][11] - 0.11).abs() < 1e-12, "straight between its neighbours");
    // Those that no range holds are nobody's loss.
    put(&folder, "hole.csv", &table((0..120).filter(|row| !(60..63).contains(row)), 0.1));
    let parts = [[0.0, 5.9], [6.3, 11.9]].map(|range| json!({"data": "hole.csv", "range": range}));
    let made = read(&folder, &json!({"data": parts}));
    assert_eq!(made.warnings.to_string(), "");
    assert_eq!(made.train.iter().map(Record::missing).sum::<usize>(), 0);
}

#[test]
fn times_written_with_few_digits_are_even_enough() {
    let folder = folder();
    let rows: String =
        (0..80).map(|row| format!("{:.3},0.{row:02},0.{row:02}\n", 1000.0 + row as f64 / 30.0)).collect();
    put(&folder, "data.csv", &format!("t,F,x\n{rows}"));
    let made = read(&folder, &json!({}));
    let train = &made.train[0];
    assert_eq!((train.len(), train.missing()), (60, 0));
    let told = 1e-3 / 79.0;
    assert!(
        (train.interval - 1.0 / 30.0).abs() < told,
        "as exactly as both ends are told: {}",
        train.interval
    );
    assert!((0.01..0.03).contains(&train.jitter), "{}", train.jitter);
}

#[test]
fn a_signal_has_its_factor_and_a_drive_becomes_a_table() {
    let folder = folder();
    put(&folder, "data.csv", &table(0..80, 0.1));
    let held = json!({"F": {"column": "F", "hold": "previous"}});
    let made = read(&folder, &json!({"drives": held, "outputs": {"v": "v"}}));
    assert_eq!((made.outputs[0].per_volt, made.drives[0].per_volt), (-0.01, 0.1));
    let fed = made.patch_to_feed().unwrap();
    assert_eq!((made.patch.drives["F"].kind.name, fed.drives["F"].kind.name), ("step", "table"));
    assert_eq!(fed.drives["F"].scale.as_ref().unwrap().value, "force");
    assert_eq!(fed.value()["drives"]["F"]["hold"], "previous");
    let circuit = Circuit::new(&fed, &[]).unwrap_or_else(|report| panic!("{report}"));
    Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
}

#[test]
fn without_drives_a_patch_is_left_to_itself() {
    let folder = folder();
    put(&folder, "data.csv", &table(0..80, 0.1));
    let made = read(&folder, &json!({"drives": {}, "fit": ["F_step"]}));
    assert!(made.drives.is_empty() && made.train[0].drives.is_empty());
    assert_eq!(made.fit, ["F_step"]);
}

#[test]
fn what_was_measured_in_volts_is_a_signal_too() {
    let folder = folder();
    put(&folder, "data.csv", &table(0..80, 0.1));
    let made = read(&folder, &json!({"outputs": {"A2": {"column": "x", "unit": "mV"}}}));
    assert_eq!((made.outputs[0].unit.text(), made.outputs[0].per_volt), ("V", 1.0));
    assert!((made.train[0].outputs[0][10] - 3e-4).abs() < 1e-15);
}

/// Ways to write the same table.
fn written(rows: &[[f64; 3]], ends: &str, quote: &str, mark: &str) -> String {
    let mut text = format!("{mark}# t: ms{ends}{quote}t{quote},{quote}F{quote},{quote}x{quote}{ends}");
    for [time, force, position] in rows {
        write!(text, "{time:?},{force:?},{position:?}{ends}").unwrap();
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..Default::default() })]

    #[test]
    fn what_was_written_is_read(
        numbers in prop::collection::vec((-9.0..9.0f64, -4.0..4.0f64), 40..100),
        interval in 0.001..100.0f64,
        begin in -1e3..1e3f64,
        ends in "\r?\n",
        quote in "\"?",
        mark in "\u{feff}?",
    ) {
        let folder = folder();
        let rows: Vec<_> = numbers.iter().enumerate().map(|(row, (force, position))| {
            [begin + row as f64 * interval, *force, *position]
        }).collect();
        put(&folder, "data.csv", &written(&rows, &ends, &quote, &mark));
        let made = read(&folder, &json!({}));
        let samples = |of: &dyn Fn(&Record) -> Vec<f64>| [of(&made.train[0]), of(&made.test[0])].concat();
        let column = |place: usize| rows.iter().map(|row| row[place]).collect::<Vec<_>>();
        prop_assert_eq!(samples(&|record| record.drives[0].clone()), column(1));
        prop_assert_eq!(samples(&|record| record.outputs[0].clone()), column(2));
        prop_assert!((made.train[0].interval - 1e-3 * interval).abs() < 1e-9 * interval);
        prop_assert!((made.train[0].begin - 1e-3 * begin).abs() < 1e-12 * begin.abs());
    }

    #[test]
    fn columns_come_into_the_unit_of_the_patch(unit in "(m|k|µ|c|)m", in_file: bool, numbers in prop::collection::vec(-4.0..4.0f64, 80)) {
        let folder = folder();
        let of_metre = Unit::parse(&unit).unwrap().factor();
        let rows: String = numbers.iter().enumerate().map(|(row, x)| format!("{row},0.{row:02},{:?}\n", x / of_metre)).collect();
        let comment = if in_file { format!("# x: {unit}\n") } else { String::new() };
        put(&folder, "data.csv", &format!("{comment}t,F,x\n{rows}"));
        let output = if in_file { json!("x") } else { json!({"column": "x", "unit": unit}) };
        let made = read(&folder, &json!({"outputs": {"x": output}}));
        for (read, meant) in made.train[0].outputs[0].iter().zip(&numbers) {
            prop_assert!((read - meant).abs() <= 4e-16 * meant.abs() + 1e-300, "{} {}", read, meant);
        }
    }
}

#[test]
fn the_measurements_that_are_not_ours_can_be_read() {
    let tanks = Path::new("../shared/data/cascaded_tanks/dataBenchmark.csv");
    let Ok(text) = fs::read_to_string(tanks) else {
        eprintln!("{} is not here", tanks.display());
        return;
    };
    let folder = folder();
    put(&folder, "data.csv", &text);
    let made = read(
        &folder,
        &json!({
            "time": {"interval": 4},
            "drives": {"F": "uEst"},
            "outputs": {"x": {"column": "yEst", "unit": "cm"}},
            "test": {"data": "data.csv", "columns": {"uEst": "uVal", "yEst": "yVal"}},
        }),
    );
    assert_eq!((made.train[0].len(), made.test[0].len()), (1024, 1024));
    assert_eq!(made.train[0].drives[0][1023], 3.2615);
    assert!((made.test[0].outputs[0][0] - 0.049728).abs() < 1e-12);
}
