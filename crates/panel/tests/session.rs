//! Sessions: what a client sees after its commands.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{LiveRun, RunSettings};
use patchcord_panel::frame::decode;
use patchcord_panel::{Session, SessionOptions};
use serde_json::{Value, json};

use crate::client::{Client, event, refusal, text};

#[test]
fn the_machine_follows_the_clock_and_has_the_voltages_of_a_run() {
    let mut client = Client::with("thesis/fig-8-16.json");
    client.mode("operate");
    let mut frame = client.advance(0.0);
    for _ in 0..60 {
        frame = client.advance(1.0 / 60.0);
    }
    assert!((frame.header.time - 1.0).abs() < 3e-5, "{}", frame.header.time);
    let patch = Patch::parse("p.json", &text("thesis/fig-8-16.json")).unwrap();
    let circuit = Circuit::new(&patch).unwrap();
    let program = Program::new(&circuit).unwrap();
    let mut run = LiveRun::new(&program, &RunSettings::of(&circuit).unwrap()).unwrap();
    while run.clock() < frame.header.time - 1e-6 {
        run.advance(frame.header.time, u64::MAX).unwrap();
    }
    for element in ["A1", "A2", "A4"] {
        let expected = run.machine().unwrap().voltage(element).unwrap();
        assert_eq!(client.volts(&frame, element), f64::from(expected as f32), "{element}");
    }
}

#[test]
fn a_turned_parameter_acts_at_once_and_undo_turns_it_back_without_a_reset() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("operate");
    let before = client.advance(0.5).header.time;
    let events = client.send(json!({"command": "parameter", "name": "m", "value": 4}));
    assert_eq!(event(&events, "parameter")["value"], 4.0);
    let (events, _) = client.request(json!({"command": "advance", "seconds": 0.2}));
    assert!(events.iter().all(|event| event["event"] != "patch"), "{events:?}");
    let (events, frame) = client.request(json!({"command": "advance", "seconds": 0.1}));
    let patch = event(&events, "patch");
    assert_eq!((&patch["parameters"][0]["value"], &patch["undo"]), (&json!(4.0), &json!("turn m")));
    // P1 is k/m times scales: 40 / 4 * (1/10) / 10.
    let pot = patch["elements"].as_array().unwrap().iter().find(|element| element["name"] == "P1").unwrap();
    assert!((pot["settings"][0]["value"].as_f64().unwrap() - 0.1).abs() < 1e-12);
    assert!((frame.unwrap().header.time - before - 0.3).abs() < 2e-3);
    let events = client.send(json!({"command": "undo"}));
    assert_eq!(event(&events, "parameter")["value"], 1.0);
    assert!(client.advance(0.1).header.time > before + 0.3);
    let refused = client.send(json!({"command": "parameter", "name": "m", "value": 40}));
    assert!(refusal(&refused).contains("m"), "{refused:?}");
}

#[test]
fn a_cord_that_is_pulled_out_is_a_finding_and_the_machine_runs_on_with_0_v() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("operate");
    client.advance(0.3);
    let frame = client.advance(0.2);
    let (time, velocity) = (frame.header.time, client.volts(&frame, "A1"));
    let events = client.send(json!({"command": "unplug", "element": "A1", "jack": "x10", "from": "P1"}));
    let findings = event(&events, "findings")["findings"].as_array().unwrap().clone();
    let fault = findings.iter().find(|finding| finding["code"] == "no-driver").unwrap();
    assert_eq!((&fault["place"]["element"], &fault["place"]["jack"]), (&json!("A1"), &json!("x10")));
    assert!(fault["hint"].as_str().unwrap().starts_with("plug a cord in"), "{fault}");
    assert_eq!(event(&events, "patch")["runs"], true);
    let frame = client.advance(0.5);
    assert!((frame.header.time - time - 0.5).abs() < 2e-3);
    assert_eq!(client.volts(&frame, "A1"), velocity);
    let events = client.send(json!({"command": "undo"}));
    assert!(
        event(&events, "findings")["findings"]
            .as_array()
            .unwrap()
            .iter()
            .all(|one| one["severity"] != "error")
    );
    let frame = client.advance(0.2);
    assert!(client.volts(&frame, "A1") != velocity && frame.header.time > time + 0.6);
}

#[test]
fn a_single_sweep_ends_in_hold_and_repetitive_operation_counts() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("single");
    (0..5).for_each(|_| drop(client.advance(1.0)));
    let frame = client.advance(1.0);
    assert_eq!((frame.header.mode, frame.header.time), (4, 3.0));
    client.mode("repetitive");
    client.send(json!({"command": "rate", "hertz": 50}));
    let frame = client.advance(1.0);
    assert!((48..=51).contains(&frame.header.repetitions), "{}", frame.header.repetitions);
    assert_eq!(frame.header.mode, 5);
}

#[test]
fn pot_set_shows_settings_and_the_null_meter_compares() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("pot-set");
    client.send(json!({"command": "meter", "output": "P1"}));
    client.send(json!({"command": "null-meter", "output": "P1", "divider": 0.39}));
    let frame = client.advance(0.0);
    // P1 is 40 / 1 * (1/10) / 10 = 0.4.
    assert!((frame.header.meter.unwrap() - 40.0).abs() < 1e-9);
    assert!((frame.header.null_meter.unwrap() - 1.0).abs() < 1e-9);
}

#[test]
fn the_session_remembers_its_meters() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    let events = client.send(json!({"command": "hello"}));
    let (machine, patch) = (event(&events, "machine"), event(&events, "patch"));
    // The voltmeter begins at the first signal.
    assert_eq!(machine["meter"], patch["signals"][0]["at"]);
    assert_eq!(machine["null_meter"], json!({"output": null, "divider": 0.0}));
    assert_eq!(events.iter().filter(|event| event["event"] == "machine").count(), 1);
    client.send(json!({"command": "meter", "output": "P2"}));
    let connect = json!({"command": "null-meter", "output": "P1", "divider": 0.25});
    let connected = json!({"output": "P1", "divider": 0.25});
    assert_eq!(event(&client.send(connect), "machine")["null_meter"], connected);
    let events = client.send(json!({"command": "snapshot"}));
    let snapshot = event(&events, "snapshot")["snapshot"].clone();
    let mut other = Client(Session::new(SessionOptions::default()));
    let events = other.send(json!({"command": "restore", "snapshot": snapshot}));
    let machine = event(&events, "machine");
    assert_eq!((&machine["meter"], &machine["null_meter"]), (&json!("P2"), &connected));
    // Without its output a meter is disconnected.
    let events = other.send(json!({"command": "remove-element", "name": "P2"}));
    assert_eq!(event(&events, "machine")["meter"], Value::Null);
    assert_eq!(other.advance(0.0).header.meter, None);
    let events = other.send(json!({"command": "undo"}));
    assert_eq!(event(&events, "machine")["meter"], "P2");
    // A snapshot of an earlier version has no null meter.
    let mut earlier = snapshot;
    earlier.as_object_mut().unwrap().remove("null_meter");
    let events = other.send(json!({"command": "restore", "snapshot": earlier}));
    assert_eq!(event(&events, "machine")["null_meter"]["output"], Value::Null);
}

#[test]
fn another_text_is_a_step_and_the_machine_continues() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("operate");
    client.advance(0.3);
    let frame = client.advance(0.2);
    let (time, position) = (frame.header.time, client.volts(&frame, "A2"));
    let before = text("lessons/mass-and-spring.json");
    // The cord of the spring is missing, so the velocity stays.
    let after = before.replace("\"x10\": [\"P1\"]", "\"x10\": [\"ground\"]");
    assert_ne!(before, after);
    let events = client.send(json!({"command": "replace", "text": after}));
    let patch = event(&events, "patch");
    assert_eq!((&patch["undo"], &patch["runs"]), (&json!("replace the text of the patch"), &json!(true)));
    let frame = client.advance(0.0);
    assert!((frame.header.time - time).abs() < 1.1e-3);
    assert!((client.volts(&frame, "A2") - position).abs() < 1.0);
    let velocity = client.volts(&frame, "A1");
    let frame = client.advance(0.2);
    assert!((frame.header.time - time - 0.2).abs() < 2e-3);
    assert_eq!(client.volts(&frame, "A1"), velocity);
    let events = client.send(json!({"command": "undo"}));
    assert_eq!(event(&events, "patch")["redo"], "replace the text of the patch");
    let frame = client.advance(0.2);
    assert!((frame.header.time - time - 0.4).abs() < 3e-3 && client.volts(&frame, "A1") != velocity);
    let refused = client.send(json!({"command": "replace", "text": "{"}));
    assert!(refusal(&refused).contains("mass-and-spring.json"), "{refused:?}");
    // A sweep shorter than the step of the new patch becomes that of the patch.
    client.send(json!({"command": "sweep", "seconds": 0.01}));
    let slow = r#"{"patchcord": 1, "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A1"]}}},
        "run": {"for": 20, "step": 0.02}}"#;
    let events = client.send(json!({"command": "replace", "text": slow}));
    let machine = event(&events, "machine");
    assert_eq!((&machine["sweep"], &machine["stopped"]), (&json!(20.0), &Value::Null));
}

#[test]
fn another_sweep_keeps_the_turned_parameters() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.send(json!({"command": "parameter", "name": "m", "value": 4}));
    let events = client.send(json!({"command": "sweep", "seconds": 0.5}));
    assert_eq!(event(&events, "machine")["sweep"], 0.5);
    assert_eq!(event(&events, "patch")["parameters"][0]["value"], 4.0);
    client.mode("pot-set");
    let frame = client.advance(0.0);
    // P1 is 40 / 4 * (1/10) / 10.
    assert!((client.volts(&frame, "P1") - 10.0).abs() < 1e-5);
    let events = client.send(json!({"command": "sweep", "seconds": 0.25}));
    assert!(events.iter().all(|event| event["event"] != "patch"), "{events:?}");
}

#[test]
fn a_patch_with_faults_does_not_show_the_machine_before_it() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.send(json!({"command": "views", "schematic": true, "equations": true}));
    client.mode("operate");
    client.advance(0.3);
    client.advance(0.2);
    let open = json!({"command": "open", "name": "p.json", "text": r#"{"patchcord": 1,
        "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A1", "A9"]}, "initial": 50}}, "record": ["A1"]}"#});
    let events = client.send(open);
    assert_eq!(event(&events, "patch")["runs"], false);
    let [drawing, equations] =
        [&event(&events, "schematic")["drawing"], &event(&events, "equations")["equations"]];
    assert_eq!((drawing, equations), (&Value::Null, &json!([])));
    for name in ["schematic", "equations"] {
        let message = event(&events, name)["message"].as_str().unwrap();
        assert!(message.ends_with("again when the patch has no faults"), "{message}");
    }
    let frame = client.advance(0.1);
    assert!(frame.header.time == 0.0 && client.volts(&frame, "A1").is_nan());
    let events = client.send(json!({"command": "unplug", "element": "A1", "jack": "x1", "from": "A9"}));
    assert_eq!(event(&events, "equations")["message"], Value::Null);
    let frame = client.advance(0.1);
    assert_eq!((frame.header.time, client.volts(&frame, "A1")), (0.0, 50.0));
}

#[test]
fn the_run_of_a_session_is_that_of_the_command() {
    let file = "lessons/mass-and-spring.json";
    let mut client = Client::with(file);
    let events = client.send(json!({"command": "run"}));
    let circuit = Circuit::new(&Patch::parse("p.json", &text(file)).unwrap()).unwrap();
    let trace =
        patchcord_core::solve::run(&Program::new(&circuit).unwrap(), &RunSettings::of(&circuit).unwrap());
    let mut expected = Vec::new();
    trace.unwrap().write_csv(&mut expected).unwrap();
    assert_eq!(event(&events, "table")["csv"].as_str().unwrap().as_bytes(), expected);
}

#[test]
fn a_session_continues_from_its_snapshot() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.send(json!({"command": "parameter", "name": "m", "value": 2}));
    client.mode("repetitive");
    let events = client.send(json!({"command": "snapshot"}));
    let snapshot = event(&events, "snapshot")["snapshot"].clone();
    let mut other = Client(Session::new(SessionOptions::default()));
    let events = other.send(json!({"command": "restore", "snapshot": snapshot}));
    assert_eq!(event(&events, "machine")["mode"], "repetitive");
    assert_eq!(event(&events, "patch")["parameters"][0]["value"], 2.0);
    other.send(json!({"command": "undo"}));
    let events = other.send(json!({"command": "undo"}));
    assert_eq!(event(&events, "parameter")["value"], 1.0);
}

#[test]
fn a_change_of_the_mode_is_a_step_that_the_view_of_the_patch_names() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    let events = client.mode("hold");
    assert_eq!(event(&events, "patch")["undo"], "change to hold");
    let events = client.mode("hold");
    assert!(events.iter().all(|event| event["event"] != "patch"), "{events:?}");
    let events = client.send(json!({"command": "undo"}));
    assert_eq!(event(&events, "patch")["undo"], Value::Null);
    assert_eq!(event(&events, "patch")["redo"], "change to hold");
}

#[test]
fn wrong_requests_are_refused_and_change_nothing() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    let before = client.patch();
    for wrong in
        ["", "{}", "[1]", r#"{"id": 1, "commands": [{"command": "fly"}]}"#, r#"{"id": 1, "commands": 3}"#]
    {
        let answer = client.0.request(wrong, &mut || false);
        assert!(answer.text.contains("refused") && answer.frame.is_none(), "{wrong}: {}", answer.text);
    }
    for wrong in [
        json!({"command": "speed", "factor": -1}),
        json!({"command": "advance", "seconds": 1e9}),
        json!({"command": "sweep", "seconds": 1e-9}),
        json!({"command": "meter", "output": "A99"}),
        json!({"command": "erase", "scope": 7}),
        json!({"command": "open", "name": "x", "text": "not a patch"}),
        json!({"command": "plug", "element": "A99", "jack": "x1", "from": "A1"}),
        json!({"command": "redo"}),
        json!({"command": "restore", "snapshot": {}}),
    ] {
        assert!(!refusal(&client.send(wrong.clone())).is_empty(), "{wrong}");
    }
    assert_eq!(client.patch(), before);
}

#[test]
fn an_equation_that_is_not_solved_is_a_finding_and_advice_corrects_it() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    // The first mistake of every beginner: the sign of the spring.
    let events = client.send(
        json!({"command": "move-cord", "element": "P1", "jack": "in", "from": "B1", "to": {"output": "A2"}}),
    );
    let findings = &event(&events, "findings")["findings"];
    let fault = findings.as_array().unwrap().iter().find(|one| one["code"] == "equation-not-solved").unwrap();
    assert!(fault["message"].as_str().unwrap().contains("the sign of"), "{fault}");
    let events = client.send(json!({"command": "advise"}));
    let findings = event(&events, "findings")["findings"].to_string();
    assert!(findings.contains("plug B1 into P1 in place of A2"), "{findings}");
    client.mode("problem-check");
    let events = client.send(json!({"command": "static-check"}));
    let table = event(&events, "static-check");
    let rows = table["rows"].as_array().unwrap();
    assert_eq!(table["compared"], true);
    // m x'' = -k x at 80 mm: -3200 mm/s^2, and a volt is 10 mm/s.
    let rate = rows.iter().find(|row| row["element"] == "A1" && row["order"] == 1).unwrap();
    let [expected, wired] = ["expected", "wired"].map(|key| rate[key].as_f64().unwrap());
    assert!((expected + 320.0).abs() < 1e-9 && (wired - 320.0).abs() < 1e-9, "{rate}");
    assert_eq!(rate["differs"], true);
}
