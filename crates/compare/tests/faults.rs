//! Faults of requests, patches, data and experiments: each is refused with a message that says what to do.

use patchcord_compare::limits::{MAX_CELLS, MAX_REQUEST_BYTES};
use serde_json::{Value, json};

use crate::files::{begin, compare, compared, comparison, event, events, example, refusal, turn};

/// Twelve rows with the function `row` of their number.
fn table(head: &str, row: impl Fn(u32) -> String) -> String {
    format!("{head}\n{}", (0..12).map(|number| row(number) + "\n").collect::<String>())
}

/// The refusal of an experiment on the spring with these data.
fn refused(data: &str, experiment: &Value) -> String {
    let mut comparison = comparison();
    let columns = event(&mut comparison, &begin(&example("spring.json"), data));
    assert_eq!(columns["event"], "columns", "{columns}");
    refusal(&mut comparison, &compare(experiment))
}

#[test]
fn commands_need_data_and_an_experiment() {
    let mut comparison = comparison();
    let patch = json!({"command": "patch", "name": "p.json", "text": example("spring.json")});
    for command in [
        &patch,
        &compare(&json!({})),
        &turn("k", 5.0),
        &json!({"command": "fit"}),
        &json!({"command": "search"}),
    ] {
        assert_eq!(refusal(&mut comparison, command), "there are no measured data: open a data file first");
    }
    event(&mut comparison, &begin(&example("spring.json"), &example("measured.csv")));
    let message = refusal(&mut comparison, &turn("k", 5.0));
    assert_eq!(message, "nothing is compared yet: select the columns first");
    // Without an experiment a rewired patch has other signals to select.
    assert_eq!(event(&mut comparison, &patch)["event"], "columns");
}

#[test]
fn requests_are_checked() {
    let mut comparison = comparison();
    let mut message = |text: &str| {
        let response: Value = serde_json::from_str(&comparison.request(text, &mut |_: &str| ())).unwrap();
        assert_eq!(response["id"], Value::Null);
        response["events"][0]["message"].as_str().unwrap().to_owned()
    };
    assert!(message("{").starts_with("the request cannot be read"));
    assert!(message(r#"{"id": 1, "commands": [{"command": "fly"}]}"#).contains("unknown variant `fly`"));
    let missing = message(r#"{"id": 1, "commands": [{"command": "begin"}]}"#);
    assert!(missing.contains("command \"begin\": missing field `patch`"), "{missing}");
    assert!(message(r#"{"id": 1, "commands": [{"command": "fit", "seed": 1}]}"#).contains("command \"fit\""));
    assert_eq!(message(&" ".repeat(MAX_REQUEST_BYTES + 1)), "the request has more than 20 MB");
    let many = format!(r#"{{"id": 1, "commands": [{}]}}"#, vec![r#"{"command": "fit"}"#; 21].join(","));
    assert_eq!(message(&many), "a request has at most 20 commands, got 21");
}

#[test]
fn data_without_times_need_an_interval() {
    let data = table("a,x", |row| format!("{},{}", row % 2, (f64::from(row) * 0.7).cos() * 50.0));
    let mut comparison = comparison();
    let columns = event(&mut comparison, &begin(&example("spring.json"), &data));
    let notes = columns["notes"].as_array().unwrap();
    assert!(notes.len() == 1 && notes[0].as_str().unwrap().starts_with("no column increases"), "{notes:?}");
    assert_eq!(columns["experiment"]["time"], Value::Null);
    let message = refused(&data, &json!({"outputs": {"x": "x"}, "fit": ["k"]}));
    assert!(message.contains("measured.csv") && message.contains('t'), "{message}");
}

#[test]
fn words_in_place_of_numbers_have_their_line() {
    let data = table("t,x", |row| match row {
        4 => "0.4,broken".to_owned(),
        _ => format!("{},{row}", 0.1 * f64::from(row)),
    });
    let message = refused(&data, &json!({"outputs": {"x": "x"}, "fit": ["k"]}));
    assert!(message.contains("line 6 of measured.csv") && message.contains("broken"), "{message}");
}

#[test]
fn data_that_are_no_table_are_refused() {
    let mut comparison = comparison();
    for data in ["", "t,x\n", "t;x\n0;1\n1;2\n"] {
        let message = refusal(&mut comparison, &begin(&example("spring.json"), data));
        assert!(message.contains("measured.csv"), "{message}");
    }
    let many = "1,".repeat(MAX_CELLS + 1);
    let message = refusal(&mut comparison, &begin(&example("spring.json"), &many));
    assert!(message.starts_with("measured.csv has about 1000001 cells"), "{message}");
}

#[test]
fn unknown_names_have_a_suggestion() {
    let data = example("measured.csv");
    let message = refused(&data, &json!({"outputs": {"w": "x"}, "fit": ["k"]}));
    assert!(message.contains("has no signal w") && message.contains("(at \"w\")"), "{message}");
    let message = refused(&data, &json!({"outputs": {"x": "x"}, "fit": ["q"]}));
    assert!(message.contains("has no parameter q"), "{message}");
    let message = refused(&data, &json!({"outputs": {"x": "x"}, "data": "other.csv"}));
    assert_eq!(message, "the experiment of a comparison has no key \"data\": the opened file is used");
}

#[test]
fn a_refused_experiment_does_not_end_the_comparison() {
    let (mut comparison, _) =
        compared(&example("spring.json"), &example("measured.csv"), &json!({"fit": ["k"]}));
    let before = event(&mut comparison, &turn("k", 20.0));
    refusal(&mut comparison, &compare(&json!({"outputs": {"w": "x"}})));
    assert_eq!(
        refusal(&mut comparison, &turn("k", 1000.0)),
        "k = 1000 N/m is outside its range 1 ... 100 N/m"
    );
    assert_eq!(refusal(&mut comparison, &turn("q", 1.0)), "the patch has no parameter q");
    let nothing = json!({"command": "simulate", "parameters": {}});
    assert_eq!(event(&mut comparison, &nothing), before);
    let (mut comparison, _) =
        compared(&example("spring.json"), &example("measured.csv"), &json!({"fit": []}));
    let message = refusal(&mut comparison, &json!({"command": "fit"}));
    assert_eq!(message, "no parameter is selected: select the parameters to fit");
}

#[test]
fn nothing_is_compared_with_a_faulty_patch() {
    let text = example("spring.json");
    let (mut comparison, begun) = compared(&text, &example("measured.csv"), &json!({"fit": ["k"]}));
    let patch = |text: &str| json!({"command": "patch", "name": "p.json", "text": text});
    event(&mut comparison, &turn("k", 20.0));
    let message = refusal(&mut comparison, &patch(&text.replace("\"x10\": [\"A1\"]", "\"x10\": [\"A9\"]")));
    assert!(message.contains("A2 is driven by A9, which is not in the patch"), "{message}");
    assert_eq!(refusal(&mut comparison, &turn("k", 30.0)), "the patch has faults: correct them first");
    let message = refusal(&mut comparison, &patch("{\"patchcord\": 1,}"));
    assert!(message.contains("(p.json, line 1)"), "{message}");
    assert_eq!(refusal(&mut comparison, &turn("k", 30.0)), "the patch has faults: correct them first");
    // The experiment stays, and the values are those of the new text.
    assert_eq!(events(&mut comparison, &patch(&text)), begun);
}
