//! Valid experiments: records, split into training and validation data, units, holds and missing rows.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use proptest::prelude::*;
use serde_json::{Value, json};
use tempfile::TempDir;

use patchcord_expr::Unit;
use patchcord_ident::report::experiment_summary::ExperimentSummary;
use patchcord_ident::{Experiment, Hold, Problem, Record};

/// A new folder that contains base.json, the patch of these tests.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::copy("tests/base.json", folder.path().join("base.json")).unwrap();
    folder
}

/// Writes a file into the folder.
fn write_file(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap();
}

/// Reads an experiment on base.json and data.csv. `changes` adds keys or replaces them.
fn read(folder: &TempDir, changes: &Value) -> Experiment {
    let mut document =
        json!({"patch": "base.json", "data": "data.csv", "drives": {"F": "F"}, "outputs": {"x": "x"}});
    for (key, value) in changes.as_object().unwrap() {
        document[key] = value.clone();
    }
    let text = document.to_string();
    Experiment::parse_in(folder.path(), "e.json", &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// A table of time, force, velocity and position.
///
/// The time of row n is n times `interval`. Force and velocity are 0.01 n, the position is 0.03 n.
fn table(rows: impl Iterator<Item = usize>, interval: f64) -> String {
    let mut text = "t,F,v,x\n".to_owned();
    for row in rows {
        let (time, row) = (row as f64 * interval, 1e-2 * row as f64);
        writeln!(text, "{time},{row},{row},{}", 3.0 * row).unwrap();
    }
    text
}

/// First and last time of a record in s, rounded to 1 us.
fn time_range(record: &Record) -> (f64, f64) {
    let rounded = |time: f64| (1e6 * time).round() / 1e6;
    (rounded(record.begin), rounded(record.begin + record.duration()))
}

/// Results name files as the experiment names them, not with the folder of the caller.
#[test]
fn results_name_the_patch_as_the_experiment_does() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..80, 0.1));
    let experiment = read(&folder, &json!({}));
    assert_eq!(experiment.patch_name, "base.json");
    assert_eq!(experiment.patch.file(), folder.path().join("base.json").display().to_string());
    let problem = Problem::of(&experiment).unwrap();
    let summary = serde_json::to_value(ExperimentSummary::of(&experiment, &problem, 1)).unwrap();
    assert_eq!((&summary["patch"], &summary["train"][0]["data"]), (&json!("base.json"), &json!("data.csv")));
    assert!(!summary.to_string().contains(&folder.path().display().to_string()), "{summary}");
}

#[test]
fn without_ranges_the_first_three_quarters_of_a_record_are_training_data() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..80, 0.1));
    let experiment = read(&folder, &json!({}));
    assert_eq!(experiment.warnings.to_string(), "");
    let [train, test] = [&experiment.train, &experiment.validation].map(|records| &records[0]);
    assert_eq!((time_range(train), time_range(test)), ((0.0, 5.9), (6.0, 7.9)));
    assert_eq!((train.len(), test.len(), train.missing(), train.drives.len()), (60, 20, 0, 1));
    assert!((train.interval - 0.1).abs() < 1e-12);
    assert!((test.drives[0][0] - 0.6).abs() < 1e-12 && (test.outputs[0][0] - 1.8).abs() < 1e-12);
    assert_eq!(
        experiment.fit,
        ["M", "f"],
        "by default, parameters are fitted that have a range and that not only the drive reads"
    );
    let [drive, output] = [
        (&experiment.drives[0].drive, &experiment.drives[0].unit),
        (&experiment.outputs[0].signal, &experiment.outputs[0].unit),
    ];
    assert_eq!((drive.0.as_str(), drive.1.text(), output.0.as_str(), output.1.text()), ("F", "N", "x", "m"));
    assert_eq!(
        (experiment.drives[0].hold, experiment.outputs[0].has_offset, experiment.outputs[0].sigma),
        (Hold::Linear, false, None)
    );
}

/// The position is in mm in the file and in m in the patch.
#[test]
fn units_in_the_names_of_columns_are_converted() {
    let folder = folder();
    let data = table(0..80, 100.0).replacen("t,F,v,x", "t (ms),F [N],v,x [mm]", 1);
    write_file(&folder, "data.csv", &data);
    let document = json!({"outputs": {"x": {"column": "x", "sigma": 1, "unit": "mm"}}});
    let experiment = read(&folder, &document);
    assert_eq!(time_range(&experiment.train[0]), (0.0, 5.9));
    assert!((experiment.validation[0].outputs[0][0] - 1.8e-3).abs() < 1e-12);
    assert!((experiment.outputs[0].sigma.unwrap() - 1e-3).abs() < 1e-15);
}

#[test]
fn a_time_whose_name_may_contain_a_unit_gives_a_warning() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..80, 0.1).replacen("t,", "t_ms,", 1));
    let codes = |time: Value| {
        let findings = read(&folder, &json!({"time": time})).warnings.findings;
        findings.iter().map(|finding| finding.code.as_str()).collect::<Vec<_>>()
    };
    assert_eq!(codes(json!("t_ms")), ["unclear-unit"]);
    assert!(codes(json!({"column": "t_ms", "unit": "s"})).is_empty());
}

#[test]
fn a_time_in_full_is_converted_without_a_warning() {
    let folder = folder();
    for (header, step) in
        [("t (seconds)", 0.1), ("t {sec}", 0.1), ("t<msec>", 100.0), ("t [mins]", 0.1 / 60.0)]
    {
        write_file(&folder, "data.csv", &table(0..80, step).replacen("t,", &format!("{header},"), 1));
        let experiment = read(&folder, &json!({"time": "t"}));
        assert!(experiment.warnings.findings.is_empty(), "{header}: {}", experiment.warnings);
        let (begin, end) = time_range(&experiment.train[0]);
        assert!(begin == 0.0 && (end - 5.9).abs() < 1e-9, "{header}: {begin} {end}");
    }
}

#[test]
fn a_time_in_days_gives_a_warning_with_the_right_advice() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..80, 0.1).replacen("t,", "t (days),", 1));
    let warnings = read(&folder, &json!({"time": "t (days)"})).warnings;
    let hints: Vec<_> = warnings.findings.iter().map(|finding| finding.hint.as_deref()).collect();
    assert!(matches!(hints[..], [Some(hint)] if hint.starts_with("a day is 24 h; ")), "{hints:?}");
}

#[test]
fn ranges_select_training_and_test_data() {
    let folder = folder();
    ["data.csv", "again.csv"].into_iter().for_each(|file| write_file(&folder, file, &table(0..80, 0.1)));
    let split = |changes: Value| {
        let experiment = read(&folder, &changes);
        assert_eq!(experiment.warnings.to_string(), "");
        let ranges = |records: &[Record]| records.iter().map(time_range).collect::<Vec<_>>();
        (ranges(&experiment.train), ranges(&experiment.validation))
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
        assert_eq!(split(changes.clone()), (train, test), "{changes}");
    }
}

/// Before the test range are 20 sample times, but only 8 rows, which are not enough to train on.
#[test]
fn training_data_are_after_the_test_range_if_too_few_rows_are_before_it() {
    let folder = folder();
    write_file(&folder, "data.csv", &table((0..4).chain(16..60), 0.1));
    let experiment = read(&folder, &json!({"test": [2, 4]}));
    assert_eq!(time_range(&experiment.train[0]), (4.1, 5.9));
    assert_eq!(time_range(&experiment.validation[0]), (2.0, 4.0));
}

#[test]
fn with_a_separate_test_file_the_whole_record_is_training_data() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..40, 0.1));
    write_file(&folder, "other.csv", &table(10..60, 0.1).replace("t,F,v,x", "t,F,v,position"));
    let test = json!({"data": "other.csv", "range": [2, 4], "columns": {"x": "position"}});
    let experiment = read(&folder, &json!({"test": test}));
    assert_eq!((experiment.train[0].len(), time_range(&experiment.validation[0])), (40, (2.0, 4.0)));
    assert_eq!(experiment.validation[0].name, "other.csv (position)");
}

#[test]
fn two_records_may_be_columns_of_one_file() {
    let folder = folder();
    let rows: String = (0..40)
        .map(|row| {
            format!("0.{row:02},{},{},{},0.1,\n", 0.02 * f64::from(row), 3 * row, row % 10 * (row % 10))
        })
        .collect();
    write_file(&folder, "data.csv", &format!("\"uEst\",\"uVal\",\"yEst\",\"yVal\",\"Ts\",\n{rows}"));
    let experiment = read(
        &folder,
        &json!({
            "time": {"interval": 100, "unit": "ms"},
            "drives": {"F": {"column": "uEst", "hold": "previous"}},
            "outputs": {"x": {"column": "yEst", "unit": "cm", "sigma": 0.5, "offset": true}},
            "test": {"data": "data.csv", "columns": {"uEst": "uVal", "yEst": "yVal"}},
        }),
    );
    let [train, test] = [&experiment.train[0], &experiment.validation[0]];
    assert_eq!((train.len(), test.len(), train.interval, train.begin), (40, 40, 0.1, 0.0));
    assert_eq!(
        (train.drives[0][3], train.outputs[0][3], test.drives[0][3], test.outputs[0][3]),
        (0.03, 0.09, 0.06, 0.09)
    );
    assert_eq!((experiment.drives[0].hold, experiment.outputs[0].has_offset), (Hold::Previous, true));
    assert!((experiment.outputs[0].sigma.unwrap() - 5e-3).abs() < 1e-15);
    assert!(experiment.warnings.findings.is_empty(), "{}", experiment.warnings);
}

#[test]
fn missing_rows_are_reported_and_drives_are_interpolated() {
    let folder = folder();
    write_file(&folder, "data.csv", &table((0..80).filter(|row| !(10..13).contains(row)), 0.1));
    let experiment = read(&folder, &json!({}));
    let train = &experiment.train[0];
    assert_eq!((train.len(), train.missing(), experiment.warnings.warning_count()), (60, 3, 1));
    assert!(train.outputs[0][10..13].iter().all(|sample| sample.is_nan()));
    assert!((train.drives[0][11] - 0.11).abs() < 1e-12, "a drive is interpolated linearly");
    // A gap outside all ranges causes no warning.
    write_file(&folder, "hole.csv", &table((0..120).filter(|row| !(60..63).contains(row)), 0.1));
    let ranges = [[0.0, 5.9], [6.3, 11.9]].map(|range| json!({"data": "hole.csv", "range": range}));
    let experiment = read(&folder, &json!({"data": ranges}));
    assert_eq!(experiment.warnings.to_string(), "");
    assert_eq!(experiment.train.iter().map(Record::missing).sum::<usize>(), 0);
}

#[test]
fn times_rounded_to_milliseconds_are_accepted_as_equidistant() {
    let folder = folder();
    let rows: String =
        (0..80).map(|row| format!("{:.3},0.{row:02},0.{row:02}\n", 1000.0 + row as f64 / 30.0)).collect();
    write_file(&folder, "data.csv", &format!("t,F,x\n{rows}"));
    let experiment = read(&folder, &json!({}));
    let train = &experiment.train[0];
    assert_eq!((train.len(), train.missing()), (60, 0));
    // Both end times are rounded to 1 ms, over 79 intervals.
    let tolerance = 1e-3 / 79.0;
    assert!((train.interval - 1.0 / 30.0).abs() < tolerance, "{}", train.interval);
    assert!((0.01..0.03).contains(&train.jitter), "{}", train.jitter);
}

#[test]
fn an_output_keeps_the_factor_of_its_signal() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..80, 0.1));
    let held = json!({"F": {"column": "F", "hold": "previous"}});
    let experiment = read(&folder, &json!({"drives": held, "outputs": {"v": "v"}}));
    assert_eq!((experiment.outputs[0].per_volt, experiment.drives[0].per_volt), (-0.01, 0.1));
    assert_eq!(experiment.drives[0].hold, Hold::Previous);
}

#[test]
fn an_experiment_may_have_no_drives() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..80, 0.1));
    let experiment = read(&folder, &json!({"drives": {}, "fit": ["F_step"]}));
    assert!(experiment.drives.is_empty() && experiment.train[0].drives.is_empty());
    assert_eq!(experiment.fit, ["F_step"]);
}

#[test]
fn an_output_in_volts_may_be_an_element_without_a_signal() {
    let folder = folder();
    write_file(&folder, "data.csv", &table(0..80, 0.1));
    let experiment = read(&folder, &json!({"outputs": {"A2": {"column": "x", "unit": "mV"}}}));
    assert_eq!((experiment.outputs[0].unit.text(), experiment.outputs[0].per_volt), ("V", 1.0));
    assert!((experiment.train[0].outputs[0][10] - 3e-4).abs() < 1e-15);
}

/// A table of t in ms, F and x with this line ending, quote around names, and byte-order mark.
fn csv_text(rows: &[[f64; 3]], line_end: &str, quote: &str, mark: &str) -> String {
    let mut text =
        format!("{mark}# t: ms{line_end}{quote}t{quote},{quote}F{quote},{quote}x{quote}{line_end}");
    for [time, force, position] in rows {
        write!(text, "{time:?},{force:?},{position:?}{line_end}").unwrap();
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 32, failure_persistence: None, ..Default::default() })]

    #[test]
    fn every_written_value_is_read_unchanged(
        numbers in prop::collection::vec((-9.0..9.0f64, -4.0..4.0f64), 40..100),
        interval in 0.001..100.0f64,
        begin in -1e3..1e3f64,
        line_end in "\r?\n",
        quote in "\"?",
        mark in "\u{feff}?",
    ) {
        let folder = folder();
        let rows: Vec<_> = numbers.iter().enumerate().map(|(row, (force, position))| {
            [begin + row as f64 * interval, *force, *position]
        }).collect();
        write_file(&folder, "data.csv", &csv_text(&rows, &line_end, &quote, &mark));
        let experiment = read(&folder, &json!({}));
        let samples = |column: &dyn Fn(&Record) -> Vec<f64>| {
            [column(&experiment.train[0]), column(&experiment.validation[0])].concat()
        };
        let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<_>>();
        prop_assert_eq!(samples(&|record| record.drives[0].clone()), column(1));
        prop_assert_eq!(samples(&|record| record.outputs[0].clone()), column(2));
        prop_assert!((experiment.train[0].interval - 1e-3 * interval).abs() < 1e-9 * interval);
        prop_assert!((experiment.train[0].begin - 1e-3 * begin).abs() < 1e-12 * begin.abs());
    }

    #[test]
    fn columns_are_converted_to_the_unit_of_the_patch(unit in "(m|k|µ|c|)m", in_file: bool, numbers in prop::collection::vec(-4.0..4.0f64, 80)) {
        let folder = folder();
        let metres = Unit::parse(&unit).unwrap().factor();
        let rows: String = numbers.iter().enumerate().map(|(row, x)| format!("{row},0.{row:02},{:?}\n", x / metres)).collect();
        let comment = if in_file { format!("# x: {unit}\n") } else { String::new() };
        write_file(&folder, "data.csv", &format!("{comment}t,F,x\n{rows}"));
        let output = if in_file { json!("x") } else { json!({"column": "x", "unit": unit}) };
        let experiment = read(&folder, &json!({"outputs": {"x": output}}));
        for (read, expected) in experiment.train[0].outputs[0].iter().zip(&numbers) {
            prop_assert!((read - expected).abs() <= 4e-16 * expected.abs() + 1e-300, "{} {}", read, expected);
        }
    }
}

/// The data set is not part of the repository. Without it the test passes and prints a note.
#[test]
fn the_tanks_benchmark_is_read_if_its_file_is_present() {
    let tanks = Path::new("../shared/data/cascaded_tanks/dataBenchmark.csv");
    let Ok(text) = fs::read_to_string(tanks) else {
        eprintln!("{} is not present", tanks.display());
        return;
    };
    let folder = folder();
    write_file(&folder, "data.csv", &text);
    let experiment = read(
        &folder,
        &json!({
            "time": {"interval": 4},
            "drives": {"F": "uEst"},
            "outputs": {"x": {"column": "yEst", "unit": "cm"}},
            "test": {"data": "data.csv", "columns": {"uEst": "uVal", "yEst": "yVal"}},
        }),
    );
    assert_eq!((experiment.train[0].len(), experiment.validation[0].len()), (1024, 1024));
    assert_eq!(experiment.train[0].drives[0][1023], 3.2615);
    assert!((experiment.validation[0].outputs[0][0] - 0.049728).abs() < 1e-12);
}
