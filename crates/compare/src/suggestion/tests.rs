//! Unit tests of `suggestion`.

use serde_json::json;

use super::*;

/// A column that moves.
fn column(name: &str, unit: Option<&str>, is_rising: bool) -> DataColumn {
    DataColumn { name: name.to_owned(), unit: unit.map(str::to_owned), least: 0.0, most: 1.0, is_rising }
}

/// A drive, or a signal.
fn target(name: &str, unit: &str, is_drive: bool) -> Target {
    Target { name: name.to_owned(), unit: Unit::parse(unit).unwrap(), is_drive }
}

/// The suggested experiment as JSON.
fn suggested(columns: &[DataColumn], targets: &[Target]) -> Value {
    suggest(columns, targets).experiment.into()
}

#[test]
fn columns_belong_to_the_signal_of_the_same_name() {
    let targets = [target("F", "N", true), target("v", "m/s", false), target("x", "m", false)];
    let columns = [
        column("t", None, true),
        column("X (mm)", Some("mm"), false),
        column("f_N", None, false),
        column("v", None, false),
    ];
    let expected = json!({"time": "t", "drives": {"F": "f_N"}, "outputs": {"x": "X (mm)", "v": "v"}});
    assert_eq!(suggested(&columns, &targets), expected);
}

#[test]
fn a_column_of_another_dimension_does_not_belong_to_the_signal_of_its_name() {
    let targets = [target("x", "m", false), target("v", "m/s", false)];
    let columns = [column("t", None, true), column("x", Some("m/s"), false)];
    assert_eq!(suggested(&columns, &targets)["outputs"], json!({"v": "x"}));
}

#[test]
fn the_only_column_of_a_dimension_belongs_to_the_only_signal_of_it() {
    let targets = [target("F", "N", true), target("v", "m/s", false), target("x", "m", false)];
    let [force, position] = [column("force", Some("N"), false), column("position", Some("mm"), false)];
    let columns = [column("t", Some("s"), true), force, position.clone()];
    let expected = json!({"time": "t", "drives": {"F": "force"}, "outputs": {"x": "position"}});
    assert_eq!(suggested(&columns, &targets), expected);
    // With two columns in metres, nobody knows which one is x.
    let columns = [column("t", Some("s"), true), position, column("height", Some("cm"), false)];
    let suggestion = suggest(&columns, &targets);
    assert_eq!(suggestion.experiment["outputs"], json!({}));
    assert!(suggestion.notes[0].starts_with("no column has the name"), "{:?}", suggestion.notes);
}

#[test]
fn the_time_is_found_by_its_name_or_because_it_increases() {
    let time = |columns: &[DataColumn]| suggested(columns, &[])["time"].clone();
    let count = || column("count", Some("1"), true);
    assert_eq!(time(&[count(), column("Zeit [ms]", Some("ms"), true)]), json!("Zeit [ms]"));
    assert_eq!(time(&[count(), column("time_s", None, true)]), json!("time_s"));
    assert_eq!(time(&[column("x", None, false), column("elapsed", None, true)]), json!("elapsed"));
    // A length is no time.
    assert_eq!(time(&[column("s", Some("mm"), true)]), Value::Null);
    let notes = suggest(&[column("x", None, false)], &[]).notes;
    assert!(notes[0].starts_with("no column increases"), "{notes:?}");
}

#[test]
fn a_constant_column_is_not_used() {
    let constant = DataColumn { least: 1.0, most: 1.0, ..column("x", None, false) };
    let text = DataColumn { least: f64::NAN, most: f64::NAN, ..column("v", None, false) };
    let columns = [column("t", None, true), constant, text];
    let targets = [target("x", "m", false), target("v", "m/s", false)];
    assert_eq!(suggested(&columns, &targets)["outputs"], json!({}));
}

#[test]
fn names_lose_the_unit_at_their_end() {
    let cases = [
        ("X (mm)", "x"),
        ("x_mm", "x"),
        ("Force N", "force"),
        ("x_1", "x_1"),
        ("v_max", "v_max"),
        ("mm", "mm"),
    ];
    for (name, bare) in cases {
        assert_eq!(bare_name(name), bare);
    }
}
