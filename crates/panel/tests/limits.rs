//! Limits of a session: which files it reads, how much it takes, and that every request comes to an end.

use std::path::Path;

use patchcord_panel::frame::{Frame, decode};
use patchcord_panel::limits::{
    MAX_COMMANDS, MAX_ELEMENTS, MAX_LOOSE_CORDS, MAX_PATCH_BYTES, MAX_REQUEST_BYTES,
};
use patchcord_panel::{Session, SessionOptions};
use serde_json::{Value, json};

use crate::client::event;

/// A session that has opened a patch.
fn opened(text: &str) -> Session {
    let mut session = Session::new(SessionOptions::default());
    send(&mut session, json!({"command": "open", "name": "p.json", "text": text}));
    session
}

/// Sends a command, and returns the events.
fn send(session: &mut Session, command: Value) -> Vec<Value> {
    events(session, &json!({"id": 1, "commands": [command]}).to_string())
}

/// Sends a request, and returns the events.
fn events(session: &mut Session, request: &str) -> Vec<Value> {
    let answer = session.request(request, &mut || false);
    let response: Value = serde_json::from_str(&answer.text).unwrap();
    response["events"].as_array().unwrap().clone()
}

/// Advances the clock, and returns the frame.
fn advance(session: &mut Session, seconds: f64) -> Frame {
    let request = json!({"id": 1, "commands": [{"command": "advance", "seconds": seconds}]}).to_string();
    decode(&session.request(&request, &mut || false).frame.unwrap()).unwrap()
}

/// Selects a mode.
fn mode(session: &mut Session, mode: &str) {
    send(session, json!({"command": "mode", "mode": mode}));
}

/// The message with which a command is refused.
fn refusal(session: &mut Session, command: Value) -> String {
    event(&send(session, command), "refused")["message"].as_str().unwrap().to_owned()
}

/// The text of the patch.
fn text(session: &mut Session) -> Value {
    event(&send(session, json!({"command": "text"})), "text")["text"].clone()
}

/// A patch whose drive has its table in a file.
fn with_table(file: &str) -> String {
    json!({
        "patchcord": 1, "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "drives": {"u": {"kind": "table", "scale": "volt", "points": {"csv": file}}},
        "elements": {"A1": {"kind": "summer", "in": {"x1": ["u"]}}}, "run": {"for": 1, "step": 0.01}
    })
    .to_string()
}

/// All messages of the checker.
fn messages(events: &[Value]) -> String {
    event(events, "findings")["findings"].to_string()
}

#[test]
fn tables_are_read_below_the_folder_only() {
    let patches = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../patches");
    let absolute = patches.join("../Cargo.toml").display().to_string();
    let mut session = Session::new(SessionOptions { folder: Some(patches) });
    for file in ["../Cargo.toml", "lessons/../../Cargo.toml", "/etc/hostname", &absolute] {
        // The name of the patch does not decide where tables are.
        for name in ["p.json", "/etc/p.json", "../p.json"] {
            let open = json!({"command": "open", "name": name, "text": with_table(file)});
            let report = messages(&send(&mut session, open));
            assert!(report.contains("is not below the folder"), "{file}: {report}");
            let plug = json!({"command": "plug", "element": "A1", "jack": "x1", "from": "+100"});
            let report = messages(&send(&mut session, plug));
            assert!(report.contains("is not below the folder"), "{file}: {report}");
            let report = messages(&send(&mut session, json!({"command": "undo"})));
            assert!(report.contains("is not below the folder"), "{file}: {report}");
        }
    }
    let open = json!({"command": "open", "name": "/etc/p.json", "text": with_table("missing.csv")});
    assert!(messages(&send(&mut session, open)).contains("there is no file"));
}

#[test]
fn without_a_folder_no_table_is_read() {
    let mut session = opened(&with_table("Cargo.toml"));
    let report = messages(&send(&mut session, json!({"command": "hello"})));
    assert!(report.contains("tables in files cannot be read here"), "{report}");
    let snapshot = event(&send(&mut session, json!({"command": "snapshot"})), "snapshot")["snapshot"].clone();
    let report = messages(&send(&mut session, json!({"command": "restore", "snapshot": snapshot})));
    assert!(report.contains("tables in files cannot be read here"), "{report}");
}

#[test]
fn requests_above_the_limits_are_refused() {
    let mut session = opened(&decay("\"for\": 1, \"step\": 0.001"));
    let before = text(&mut session);
    let refused = |events: &[Value]| event(events, "refused")["message"].as_str().unwrap().to_owned();
    let commands = vec![json!({"command": "clear-cords"}); MAX_COMMANDS + 1];
    let request = json!({"id": 1, "commands": commands}).to_string();
    assert_eq!(refused(&events(&mut session, &request)), "a request has at most 100 commands, got 101");
    let large = " ".repeat(MAX_REQUEST_BYTES + 1);
    assert_eq!(refused(&events(&mut session, &large)), "the request has more than 12 MB");
    let name = "x".repeat(1001);
    for command in [
        json!({"command": "remove-element", "name": name}),
        json!({"command": name}),
        json!({"command": "loose-cord", "end": {"output": name}, "at": [0, 0]}),
        json!({"command": "move-cord", "element": "A1", "jack": "x1", "from": "A1", "to": {"element": name, "jack": "x1"}}),
    ] {
        let message = refusal(&mut session, command);
        assert!(message.contains("a name in a command has more than 1000 characters"), "{message}");
    }
    assert_eq!(text(&mut session), before);
}

/// The decay of an integrator from 50 V, with these settings of the run.
fn decay(run: &str) -> String {
    format!(
        r#"{{"patchcord": 1, "elements": {{"A1": {{"kind": "integrator", "in": {{"x1": ["A1"]}}, "initial": 50}}}},
            "run": {{{run}}}, "record": ["A1"]}}"#
    )
}

#[test]
fn patches_above_the_limits_are_refused() {
    let mut session = opened(&decay("\"for\": 1, \"step\": 0.001"));
    let before = text(&mut session);
    let open = |text: String| json!({"command": "open", "name": "p.json", "text": text});
    let long = format!("{{\"patchcord\": 1, \"note\": \"{}\"}}", "x".repeat(MAX_PATCH_BYTES));
    let message = refusal(&mut session, open(long));
    assert!(message.starts_with("the patch would have more than 1 MB"), "{message}");
    let pots = (0..=MAX_ELEMENTS)
        .map(|index| (format!("P{index}"), json!({"kind": "pot", "in": "+100", "setting": 0.5})));
    let elements: serde_json::Map<String, Value> = pots.collect();
    let message = refusal(&mut session, open(json!({"patchcord": 1, "elements": elements}).to_string()));
    assert!(message.starts_with("the patch has 2001 elements"), "{message}");
    // A value that makes the text too long.
    send(&mut session, json!({"command": "add-element", "kind": "function-generator", "name": "F1"}));
    let points = vec![json!([0.25, 0.25]); 100_000];
    let set = json!({"command": "setting", "element": "F1", "setting": "points", "value": points});
    assert!(refusal(&mut session, set).starts_with("the patch would have more than 1 MB"));
    send(&mut session, json!({"command": "undo"}));
    assert_eq!(text(&mut session), before);
}

#[test]
fn there_are_at_most_200_loose_cords_and_each_has_a_place() {
    let mut session = opened(&decay("\"for\": 1, \"step\": 0.001"));
    let drop_end = json!({"command": "loose-cord", "end": {"output": "A1"}, "at": [1, 2]});
    let far = serde_json::from_str(r#"{"command": "loose-cord", "end": {"output": "A1"}, "at": [1, 1e999]}"#);
    assert!(refusal(&mut session, far.unwrap()).contains("must have a place"));
    for _ in 0..MAX_LOOSE_CORDS {
        assert_eq!(event(&send(&mut session, drop_end.clone()), "patch")["event"], "patch");
    }
    assert!(refusal(&mut session, drop_end).starts_with("there are 200 loose cords"));
}

#[test]
fn a_run_that_is_too_long_is_refused() {
    for run in ["\"for\": 100, \"step\": 1e-6", "\"for\": 100, \"step\": 1e-5, \"every\": 1e-5"] {
        let message = refusal(&mut opened(&decay(run)), json!({"command": "run"}));
        assert!(message.contains("use patchcord run"), "{run}: {message}");
    }
    // Each step of a large patch takes longer.
    let pots =
        (0..397).map(|index| (format!("P{index}"), json!({"kind": "pot", "in": "+100", "setting": 0.5})));
    let elements: serde_json::Map<String, Value> = pots.collect();
    let run = json!({"for": 1.5, "step": 1e-6, "every": 0.5});
    let patch = json!({"patchcord": 1, "elements": elements, "run": run, "record": ["P0"]});
    let message = refusal(&mut opened(&patch.to_string()), json!({"command": "run"}));
    // With the three references there are 400 elements.
    assert!(message.ends_with("at most 1e6 are allowed on the panel: use patchcord run"), "{message}");
}

#[test]
fn numbers_out_of_range_are_refused_with_the_range() {
    let mut session = opened(&decay("\"for\": 1, \"step\": 0.001"));
    let cases = [
        (json!({"command": "speed", "factor": -1}), "the speed factor must be from 1e-6 to 1000000, not -1"),
        (json!({"command": "rate", "hertz": 50.0000001}), "the rate must be from 0.01 to 50, not 50.0000001"),
        (
            json!({"command": "advance", "seconds": 1e300}),
            "the time to advance must be from 0 to 1, not 1e300",
        ),
        (
            json!({"command": "sweep", "seconds": 1e-4}),
            "a sweep of 0.0001 s is shorter than the step of 0.001 s",
        ),
    ];
    for (command, message) in cases {
        assert_eq!(refusal(&mut session, command), message);
    }
}

#[test]
fn a_snapshot_with_values_that_are_not_permitted_changes_nothing() {
    let mut session = opened(&decay("\"for\": 1, \"step\": 0.001"));
    let snapshot = event(&send(&mut session, json!({"command": "snapshot"})), "snapshot")["snapshot"].clone();
    let before = send(&mut session, json!({"command": "hello"}));
    let loose = json!({"id": 1, "end": {"output": "A1"}, "at": [0, 0]});
    let step = json!({"label": "s", "kind": "patch", "state": {"text": 0, "loose": []}});
    let wrong = [
        ("/speed", json!(-1)),
        ("/sweep", json!(1e-300)),
        ("/sweep", json!(1e-4)),
        ("/rate", json!(1e300)),
        ("/mode", json!("fly")),
        ("/null_meter/divider", json!(1.5)),
        ("/scopes/1/channels/0/volts_per_division", json!(0)),
        ("/document/texts/0", json!("[]")),
        ("/document/present/loose", json!([loose, loose])),
        ("/document/done", json!(vec![step; 101])),
    ];
    for (path, value) in wrong {
        let mut changed = snapshot.clone();
        *changed.pointer_mut(path).unwrap_or_else(|| panic!("{path}")) = value;
        let message = refusal(&mut session, json!({"command": "restore", "snapshot": changed}));
        assert!(!message.is_empty(), "{path}");
        assert_eq!(send(&mut session, json!({"command": "hello"})), before, "{path}");
    }
}

#[test]
fn an_overload_that_holds_the_machine_ends_the_advance() {
    let run = r#""run": {"for": 1, "step": 0.001, "hold_on_overload": true}, "record": ["A1"]}"#;
    let elements = r#"{"patchcord": 1, "elements": {"A1": {"kind": "integrator", "in": {"x10": ["+100"]}}"#;
    let mut session = opened(&format!("{elements}}}, {run}"));
    mode(&mut session, "operate");
    let frame = advance(&mut session, 0.5);
    // -1000 V/s reaches -100 V after 0.1 s.
    assert_eq!((frame.header.mode, frame.overload), (4, true));
    assert!((frame.header.time - 0.1).abs() < 0.01, "{}", frame.header.time);
    // Here the lamp is lit before any time has passed.
    let summer = r#", "A2": {"kind": "summer", "in": {"x10": ["+100"]}}"#;
    let mut session = opened(&format!("{elements}{summer}}}, {run}"));
    for name in ["operate", "repetitive", "single"] {
        mode(&mut session, name);
        assert!(advance(&mut session, 0.5).header.time < 0.01, "{name}");
    }
}

#[test]
fn a_run_with_millions_of_initial_conditions_begins_at_once() {
    let many = r#"{"repeat": 1000000, "phases": [{"initial_condition": true}]}"#;
    let mut session = opened(&decay(&format!("\"step\": 0.001, \"phases\": [{many}, {{\"operate\": 1}}]")));
    mode(&mut session, "single");
    assert_eq!(advance(&mut session, 0.01).header.time, 0.0);
}

#[test]
fn operating_after_repetitive_operation_never_goes_back() {
    let mut session = opened(&decay("\"for\": 1, \"step\": 0.001, \"repeat\": 5"));
    mode(&mut session, "repetitive");
    let held = advance(&mut session, 0.5).header.time;
    mode(&mut session, "hold");
    mode(&mut session, "operate");
    let frame = advance(&mut session, 1.0);
    assert!((frame.header.time - held - 1.0).abs() < 2e-3, "{held} {}", frame.header.time);
}

#[test]
fn a_parameter_that_corrects_the_patch_starts_the_machine() {
    let text = r#"{"patchcord": 1, "parameters": {"a": {"value": 1.5, "unit": "1", "range": [0, 2]}},
        "elements": {"P1": {"kind": "pot", "in": "+100", "setting": "a"}}, "record": ["P1"]}"#;
    let mut session = opened(text);
    let events = send(&mut session, json!({"command": "parameter", "name": "a", "value": 0.5}));
    assert_eq!(event(&events, "patch")["runs"], true);
    mode(&mut session, "operate");
    let frame = advance(&mut session, 0.1);
    assert!(frame.header.moves && (frame.header.time - 0.1).abs() < 2e-3);
    let outputs = event(&events, "patch")["outputs"].as_array().unwrap();
    let index = outputs.iter().position(|output| output["name"] == "P1").unwrap();
    assert_eq!(frame.volts[index], 50.0);
}

#[test]
fn a_run_that_cannot_begin_has_its_reason_in_every_mode() {
    // A run has at most 1e10 steps.
    let mut session = opened(&decay("\"for\": 1e9, \"step\": 0.001"));
    for name in ["initial-condition", "operate", "single"] {
        mode(&mut session, name);
        let events = send(&mut session, json!({"command": "hello"}));
        let stopped = event(&events, "machine")["stopped"].as_str().unwrap().to_owned();
        assert!(stopped.contains("1e12 steps"), "{name}: {stopped}");
        assert!(!advance(&mut session, 0.1).header.moves, "{name}");
    }
    send(&mut session, json!({"command": "sweep", "seconds": 0.5}));
    mode(&mut session, "operate");
    let header = advance(&mut session, 0.1).header;
    assert!(header.moves && !header.stopped && header.time > 0.0, "{header:?}");
}

#[test]
fn a_machine_that_cannot_continue_begins_again_in_initial_condition() {
    let text = r#"{"patchcord": 1, "machine": "unlimited", "elements": {
        "D": {"kind": "integrator", "in": {"x1": ["+100"]}, "initial": 50},
        "M": {"kind": "multiplier", "mode": "product", "a": "A5", "b": "+100"},
        "A5": {"kind": "open-amplifier", "in": {"x0.1": ["+100"], "x1": ["M"]}}},
        "record": ["A5"], "run": {"for": 1, "step": 0.01}}"#;
    let mut session = opened(text);
    mode(&mut session, "operate");
    // D falls by 100 V/s to -20 V. A loop that divides by it then has several solutions.
    advance(&mut session, 0.7);
    let to = json!({"output": "D"});
    let divide = json!({"command": "move-cord", "element": "M", "jack": "b", "from": "+100", "to": to});
    let events = send(&mut session, divide);
    let stopped = event(&events, "machine")["stopped"].as_str().unwrap().to_owned();
    assert!(stopped.contains("3 solutions"), "{stopped}");
    assert!(!advance(&mut session, 0.1).header.moves);
    mode(&mut session, "initial-condition");
    mode(&mut session, "operate");
    let header = advance(&mut session, 0.1).header;
    assert!(header.moves && !header.stopped && (header.time - 0.1).abs() < 0.011, "{header:?}");
}

#[test]
fn going_back_too_far_is_refused_and_the_machine_can_still_go_back() {
    let mut session = opened(&decay("\"for\": 4, \"step\": 0.001"));
    mode(&mut session, "operate");
    advance(&mut session, 0.5);
    // A changed patch continues with another machine, which cannot go back before the change.
    send(&mut session, json!({"command": "plug", "element": "A1", "jack": "x1", "from": "ground"}));
    for _ in 0..5 {
        advance(&mut session, 0.2);
    }
    let message = refusal(&mut session, json!({"command": "scrub", "time": 0.1}));
    assert!(message.contains("can be moved back"), "{message}");
    for (time, text) in [(-1.0, "-1"), (1e300, "1e300")] {
        let message = refusal(&mut session, json!({"command": "scrub", "time": time}));
        assert!(message.ends_with(&format!(" s of its run, not to {text} s")), "{message}");
    }
    send(&mut session, json!({"command": "scrub", "time": 1.2}));
    let time = advance(&mut session, 0.0).header.time;
    assert!((time - 1.2).abs() < 2e-3, "{time}");
}

#[test]
fn delays_that_need_too_much_memory_stop_the_machine() {
    let delays =
        (0..100).map(|index| (format!("D{index}"), json!({"kind": "delay", "in": "+100", "delay": 1000})));
    let elements: serde_json::Map<String, Value> = delays.collect();
    let patch = json!({"patchcord": 1, "elements": elements, "run": {"for": 100, "step": 0.001}});
    let mut session = opened(&patch.to_string());
    mode(&mut session, "operate");
    send(&mut session, json!({"command": "speed", "factor": 24}));
    let frame = advance(&mut session, 1.0);
    assert!(frame.header.stopped, "{}", frame.header.time);
    let events = send(&mut session, json!({"command": "hello"}));
    let stopped = event(&events, "machine")["stopped"].as_str().unwrap().to_owned();
    assert!(stopped.starts_with("the delays store more than 50 MB"), "{stopped}");
}

#[test]
fn large_events_are_in_an_answer_once() {
    let mut session = opened(&decay("\"for\": 1, \"step\": 0.001"));
    let commands = ["text", "hello", "snapshot", "text", "hello", "snapshot", "undo", "undo"];
    let commands: Vec<Value> = commands.iter().map(|name| json!({"command": name})).collect();
    let events = events(&mut session, &json!({"id": 1, "commands": commands}).to_string());
    let count = |name: &str| events.iter().filter(|event| event["event"] == name).count();
    let names = ["text", "hello", "patch", "snapshot", "machine", "refused"];
    assert_eq!(names.map(count), [1, 1, 1, 1, 1, 2]);
}
