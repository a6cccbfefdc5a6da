//! Files of the examples, requests, and their events.

use std::fs;
use std::path::Path;

use patchcord_compare::{Comparison, ComparisonOptions};
use serde_json::{Value, json};

/// The text of a file of the repository.
fn text(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)).unwrap()
}

/// The text of a file of the example with missing effects.
pub(crate) fn example(name: &str) -> String {
    text(&format!("examples/05_missing_effect/{name}"))
}

/// A comparison on two threads.
pub(crate) fn comparison() -> Comparison {
    Comparison::new(ComparisonOptions { threads: Some(2), ..ComparisonOptions::default() })
}

/// The request with these commands.
pub(crate) fn request(commands: &[Value]) -> String {
    json!({"id": 7, "commands": commands}).to_string()
}

/// The events that are the answer to a command. Progress is ignored.
pub(crate) fn events(comparison: &mut Comparison, command: &Value) -> Vec<Value> {
    let text = comparison.request(&request(std::slice::from_ref(command)), &mut |_| ());
    let response: Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&response["id"], &response["frame"]), (&json!(7), &json!(false)));
    assert!(response.get("partial").is_none());
    response["events"].as_array().unwrap().clone()
}

/// The only event that is the answer to a command.
pub(crate) fn event(comparison: &mut Comparison, command: &Value) -> Value {
    let events = events(comparison, command);
    assert_eq!(events.len(), 1, "{events:?}");
    events[0].clone()
}

/// The message of the refusal of a command.
pub(crate) fn refusal(comparison: &mut Comparison, command: &Value) -> String {
    let event = event(comparison, command);
    assert_eq!(event["event"], "refused", "{event}");
    event["message"].as_str().unwrap().to_owned()
}

/// The command that begins a comparison with these texts.
pub(crate) fn begin(patch: &str, data: &str) -> Value {
    let patch = json!({"name": "patches/p.json", "text": patch});
    json!({"command": "begin", "patch": patch, "data": {"name": "measured.csv", "text": data}})
}

/// The command that compares according to an experiment.
pub(crate) fn compare(experiment: &Value) -> Value {
    json!({"command": "compare", "experiment": experiment})
}

/// The command that sets one parameter.
pub(crate) fn turn(name: &str, value: f64) -> Value {
    json!({"command": "simulate", "parameters": {name: value}})
}

/// A comparison of a patch with data according to the suggested experiment with these changes. Returns the events of
/// `compare` with it.
pub(crate) fn compared(patch: &str, data: &str, changes: &Value) -> (Comparison, Vec<Value>) {
    let mut comparison = comparison();
    let columns = event(&mut comparison, &begin(patch, data));
    assert_eq!(columns["event"], "columns", "{columns}");
    let mut experiment = columns["experiment"].clone();
    for (key, value) in changes.as_object().unwrap() {
        experiment[key] = value.clone();
    }
    let events = events(&mut comparison, &compare(&experiment));
    (comparison, events)
}

/// A list of numbers of an output, over all records. Missing numbers are NaN.
pub(crate) fn numbers(output: &Value, key: &str) -> Vec<f64> {
    let records = output["records"].as_array().unwrap().iter();
    let lists = records.flat_map(|record| record[key].as_array().unwrap());
    lists.map(|number| number.as_f64().unwrap_or(f64::NAN)).collect()
}

/// The root mean square of numbers, without those that are missing.
pub(crate) fn rms(numbers: &[f64]) -> f64 {
    let present = numbers.iter().filter(|number| !number.is_nan());
    let squares: Vec<f64> = present.map(|number| number * number).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}
