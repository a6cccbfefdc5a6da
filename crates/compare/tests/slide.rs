//! A table that a motor pushes: a column feeds a drive, and the sensor of the position has an offset.
//!
//! The data are those of 2 kg and 3 N s/m, with noise of 0.2 mm.

use patchcord_compare::Comparison;
use serde_json::{Value, json};

use crate::files::{begin, compared, comparison, event, events, example, numbers, rms};

/// The patch, with a mass of up to 4 kg.
fn patch() -> String {
    let text = example("slide.json");
    let wider = text.replace("[0.1, 1.6]", "[0.1, 4]");
    assert_ne!(text, wider);
    wider
}

/// The output of the experiment in docs/gap.md, with or without an offset of the sensor.
fn changes(offset: bool) -> Value {
    json!({"outputs": {"x": {"column": "position", "sigma": 0.2, "unit": "mm", "offset": offset}}})
}

/// The curves with the true mass and the true friction.
fn at_true_values(comparison: &mut Comparison) -> Value {
    let parameters = json!({"command": "simulate", "parameters": {"M": 2, "f": 3}});
    let curves = event(comparison, &parameters);
    assert_eq!((&curves["event"], &curves["overload"]), (&json!("curves"), &Value::Null));
    curves["outputs"][0].clone()
}

#[test]
fn columns_are_found_by_their_dimension() {
    let columns = event(&mut comparison(), &begin(&patch(), &example("slide.csv")));
    // F_step is read by the drive alone, which the column replaces. x_0 has no range.
    let expected =
        json!({"time": "t", "drives": {"F": "force"}, "outputs": {"x": "position"}, "fit": ["M", "f"]});
    assert_eq!(columns["experiment"], expected);
    assert_eq!(columns["drives"], json!([{"name": "F", "unit": "N"}]));
}

#[test]
fn the_column_drives_the_simulation() {
    let (mut comparison, _) = compared(&patch(), &example("slide.csv"), &changes(false));
    let output = at_true_values(&mut comparison);
    assert_eq!((&output["unit"], &output["noise"]), (&json!("m"), &json!(0.0002)));
    // An independent simulation in the units of the problem gives 0.2026 mm.
    assert!((output["rms"].as_f64().unwrap() - 0.000_202_6).abs() < 3e-6, "{}", output["rms"]);
    assert_eq!(output["offset"], Value::Null);
}

#[test]
fn the_offset_of_a_sensor_is_subtracted() {
    let data = example("slide.csv");
    let (mut comparison, _) = compared(&patch(), &data, &changes(true));
    let output = at_true_values(&mut comparison);
    let residual = numbers(&output, "residual");
    assert!((residual.iter().sum::<f64>() / residual.len() as f64).abs() < 1e-8);
    assert!((output["rms"].as_f64().unwrap() - rms(&residual)).abs() < 1e-7);
    let offset = output["offset"].as_f64().unwrap();
    assert!(offset.abs() < 1e-4, "{offset}");

    // The same data, 10 mm higher.
    let shifted: Vec<String> = data.lines().map(shifted).collect();
    let (mut comparison, _) = compared(&patch(), &shifted.join("\n"), &changes(true));
    let other = at_true_values(&mut comparison);
    assert!((other["offset"].as_f64().unwrap() - offset - 0.01).abs() < 1e-6, "{}", other["offset"]);
    assert!((other["rms"].as_f64().unwrap() - output["rms"].as_f64().unwrap()).abs() < 1e-8);
}

/// A row of the data with a position that is 10 mm higher. Other lines stay.
fn shifted(line: &str) -> String {
    let Some((row, position)) = line.rsplit_once(',') else { return line.to_owned() };
    match position.parse::<f64>() {
        Ok(position) => format!("{row},{:.2}", position + 10.0),
        Err(_) => line.to_owned(),
    }
}

/// With the values of the patch, 0.4 kg and 0.6 N s/m, the velocity exceeds 1 m/s, which is 100 V.
#[test]
fn an_overload_is_reported_with_the_curves() {
    let (_, events) = compared(&patch(), &example("slide.csv"), &changes(false));
    let overload = events[1]["overload"].as_str().unwrap();
    assert!(overload.starts_with("with measured.csv, the amplifier A1 overloads at t = "), "{overload}");
    assert!(overload.contains("turn the parameters back, or change its scale"), "{overload}");
    assert!(events[1]["outputs"][0]["rms"].as_f64().unwrap() > 0.1);
}

#[test]
fn the_fit_finds_mass_and_friction() {
    let (mut comparison, _) = compared(&patch(), &example("slide.csv"), &changes(true));
    let fitted = events(&mut comparison, &json!({"command": "fit"}));
    let [mass, friction] = ["M", "f"].map(|name| fitted[0]["parameters"][name].as_f64().unwrap());
    assert!((mass - 2.0).abs() < 0.01 && (friction - 3.0).abs() < 0.01, "{mass} {friction}");
    assert!(fitted[1]["outputs"][0]["rms"].as_f64().unwrap() < 0.0005, "{}", fitted[1]["outputs"][0]["rms"]);
}
