//! The way to other times of a run, and what is kept of the run meanwhile.

use std::collections::BTreeMap;

use patchcord_panel::frame::{Frame, decode};
use patchcord_panel::{Session, SessionOptions};
use serde_json::{Value, json};

use crate::client::{Client, event, refusal, text};

/// The machine in an event after a command.
fn machine(client: &mut Client, command: Value) -> Value {
    event(&client.send(command), "machine").clone()
}

/// Moves the machine to a time of its run, and returns the frame there.
fn scrub(client: &mut Client, time: f64) -> Frame {
    let machine = machine(client, json!({"command": "scrub", "time": time}));
    assert_eq!((&machine["mode"], &machine["stopped"]), (&json!("hold"), &Value::Null));
    client.advance(0.0)
}

/// The time of a frame, and the voltmeter there.
fn reading(frame: &Frame) -> (f64, f64) {
    (frame.header.time, frame.header.meter.unwrap())
}

#[test]
fn the_machine_goes_back_in_its_run() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("operate");
    let mut velocities = Vec::new();
    for _ in 0..20 {
        let frame = client.advance(0.1);
        velocities.push(client.volts(&frame, "A1"));
    }
    let events = client.send(json!({"command": "scrub", "time": 0.5}));
    assert_eq!(event(&events, "machine")["mode"], "hold");
    let frame = client.advance(0.0);
    assert!((frame.header.time - 0.5).abs() < 1.1e-3, "{}", frame.header.time);
    assert!((client.volts(&frame, "A1") - velocities[4]).abs() < 0.6);
    client.mode("operate");
    let frame = client.advance(0.1);
    assert!((client.volts(&frame, "A1") - velocities[5]).abs() < 0.6);
    assert!(refusal(&client.send(json!({"command": "scrub", "time": 50}))).contains("moved back"));
}

#[test]
fn the_way_back_in_a_long_run_takes_several_advances() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("operate");
    client.send(json!({"command": "speed", "factor": 1000}));
    for _ in 0..2 {
        client.advance(1.0);
    }
    // Checkpoints are longer apart than the phases of operation. The host has no time after the first 200 steps.
    let request = json!({"id": 1, "commands": [{"command": "scrub", "time": 1321.0}]}).to_string();
    let answer = client.0.request(&request, &mut || true);
    assert!(!answer.text.contains("refused"), "{}", answer.text);
    let first =
        client.0.request(r#"{"id": 2, "commands": [{"command": "advance", "seconds": 0}]}"#, &mut || true);
    let first = decode(&first.frame.unwrap()).unwrap();
    assert!(first.header.moves && first.header.time < 1320.0, "{:?}", first.header);
    let last = client.advance(0.0);
    assert!((last.header.time - 1321.0).abs() < 1.1e-3, "{}", last.header.time);
    assert!(!client.advance(0.1).header.moves);
    // The machine is at rest there with the parameters of now.
    client.send(json!({"command": "scrub", "time": 1000.0}));
    client.send(json!({"command": "scrub", "time": 500.0}));
    client.send(json!({"command": "parameter", "name": "k", "value": 50}));
    assert_eq!(client.advance(0.0).header.time, client.advance(0.1).header.time);
}

#[test]
fn the_later_part_of_a_run_stays_until_the_run_continues() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    assert_eq!(machine(&mut client, json!({"command": "hello"}))["oldest"], Value::Null);
    let begun = event(&client.mode("operate"), "machine").clone();
    assert_eq!((&begun["oldest"], &begun["latest"]), (&json!(0.0), &Value::Null));
    let passed: Vec<(f64, f64)> = (0..20).map(|_| reading(&client.advance(0.1))).collect();
    let latest = passed[19].0;
    // Back, forward again, to the end, and to the beginning.
    for (time, volts) in [passed[4], passed[14], passed[19], passed[0]] {
        assert_eq!(reading(&scrub(&mut client, time)), (time, volts));
        let held = machine(&mut client, json!({"command": "hello"}));
        assert_eq!((&held["latest"], &held["oldest"]), (&json!(latest), &json!(0.0)));
    }
    assert!(refusal(&client.send(json!({"command": "scrub", "time": latest + 1.0}))).contains("moved back"));
    // What does not continue the run keeps its later part.
    client.mode("hold");
    client.send(json!({"command": "pause", "paused": true}));
    client.send(json!({"command": "pause", "paused": false}));
    assert_eq!(reading(&scrub(&mut client, latest)), passed[19]);
    assert_eq!(reading(&scrub(&mut client, passed[9].0)), passed[9]);
    let continued = event(&client.mode("operate"), "machine").clone();
    assert_eq!((&continued["latest"], &continued["oldest"]), (&Value::Null, &json!(0.0)));
    client.advance(0.1);
    assert!(refusal(&client.send(json!({"command": "scrub", "time": latest}))).contains("moved back"));
}

#[test]
fn a_change_of_a_parameter_or_of_the_patch_forgets_the_later_part() {
    let changes = [
        json!({"command": "parameter", "name": "m", "value": 2}),
        json!({"command": "unplug", "element": "A1", "jack": "x10", "from": "P1"}),
        json!({"command": "mode", "mode": "initial-condition"}),
    ];
    for change in changes {
        let mut client = Client::with("lessons/mass-and-spring.json");
        client.mode("operate");
        (0..10).for_each(|_| drop(client.advance(0.1)));
        scrub(&mut client, 0.5);
        assert_eq!(machine(&mut client, change.clone())["latest"], Value::Null, "{change}");
        assert!(!refusal(&client.send(json!({"command": "scrub", "time": 0.9}))).is_empty(), "{change}");
    }
}

#[test]
fn a_refused_change_keeps_the_later_part() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    client.mode("operate");
    let latest = client.advance(0.5).header.time;
    scrub(&mut client, 0.2);
    refusal(&client.send(json!({"command": "parameter", "name": "m", "value": 40})));
    assert_eq!(machine(&mut client, json!({"command": "hello"}))["latest"], json!(latest));
}

/// The voltmeter at the instants after each of `count` advances by `step`, by the bits of the time.
fn instants(client: &mut Client, count: usize, step: f64) -> BTreeMap<u64, u64> {
    let readings = (0..count).map(|_| reading(&client.advance(step)));
    readings.map(|(time, volts)| (time.to_bits(), volts.to_bits())).collect()
}

/// Checks that almost all instants are also among the expected ones, and that the voltages there have the same bits.
fn assert_same(found: &BTreeMap<u64, u64>, expected: &BTreeMap<u64, u64>, what: &str) {
    let common: Vec<_> = found.iter().filter(|(time, _)| expected.contains_key(*time)).collect();
    assert!(common.len() + 5 > found.len() && found.len() > 8, "{what}: {} of {}", common.len(), found.len());
    for (time, volts) in common {
        let (time, volts) = (f64::from_bits(*time), f64::from_bits(*volts));
        assert_eq!(volts, f64::from_bits(expected[&time.to_bits()]), "{what}: {time} s");
    }
}

/// A client of a patch whose voltmeter is at an output, with a sweep if it is not that of the patch.
fn client_of(text: &str, output: &str, sweep: Option<f64>) -> Client {
    let mut client = Client(Session::new(SessionOptions::default()));
    client.send(json!({"command": "open", "name": "p.json", "text": text}));
    client.send(json!({"command": "meter", "output": output}));
    client.send(json!({"command": "sweep", "seconds": sweep}));
    client
}

/// Checks that a machine that was moved to other times continues with the same bits as one that was not.
fn assert_continues(text: &str, output: &str, step: f64, sweep: Option<f64>) {
    let mut client = client_of(text, output, sweep);
    client.mode("operate");
    let expected = instants(&mut client, 180, step);
    let mut client = client_of(text, output, sweep);
    client.mode("operate");
    let mut latest = 0.0;
    for _ in 0..12 {
        latest = client.advance(10.0 * step).header.time;
    }
    for time in [40.0 * step, 80.0 * step, latest] {
        scrub(&mut client, time);
    }
    client.mode("operate");
    assert_same(&instants(&mut client, 50, step), &expected, &format!("{output} from the end"));
    scrub(&mut client, 110.0 * step);
    scrub(&mut client, 50.0 * step);
    client.mode("operate");
    assert_same(&instants(&mut client, 100, step), &expected, &format!("{output} from the middle"));
}

#[test]
fn a_machine_that_was_moved_continues_with_the_same_bits() {
    for (file, output, step) in [
        ("lessons/mass-and-spring.json", "A1", 1e-3),
        ("lessons/driven-oscillator.json", "A1", 2e-3),
        ("lessons/stick-slip.json", "A1", 1e-3),
        ("thesis/fig-8-16.json", "A2", 2e-5),
    ] {
        assert_continues(&text(file), output, step, None);
    }
    // The run has several phases of operation.
    assert_continues(&text("lessons/driven-oscillator.json"), "A1", 2e-3, Some(0.11));
    let adaptive = r#"{"patchcord": 1, "elements": {
        "A1": {"kind": "integrator", "in": {"x1": ["A2"]}, "initial": 80},
        "A2": {"kind": "integrator", "in": {"x1": ["B1"]}}, "B1": {"kind": "inverter", "in": "A1"}},
        "run": {"for": 200, "step": 0.01, "tolerance": 1e-6}, "record": ["A1"]}"#;
    // Every step takes longer than an advance.
    assert_continues(adaptive, "A1", 0.1, None);
}

#[test]
fn a_run_is_repeated_with_the_phases_that_were_played() {
    // In a single sweep, the machine would hold from 0.2 s on. The user lets it operate instead.
    let text = r#"{"patchcord": 1, "elements": {"A1": {"kind": "integrator", "in": {"x1": ["A1"]}, "initial": 50}},
        "run": {"step": 0.001, "phases": [{"operate": 0.2}, {"hold": 5}, {"operate": 0.2}]}, "record": ["A1"]}"#;
    let mut client = client_of(text, "A1", None);
    client.mode("single");
    let begun = reading(&client.advance(0.05));
    client.advance(0.05);
    client.mode("operate");
    let passed: Vec<_> = (0..3).map(|_| reading(&client.advance(0.1))).collect();
    assert!((passed[1].1 - 50.0 * (-0.3_f64).exp()).abs() < 0.1, "{passed:?}");
    for (time, volts) in [passed[1], begun, passed[2], passed[0]] {
        assert_eq!(reading(&scrub(&mut client, time)), (time, volts));
    }
    // From a time of the single sweep, the machine also operates beyond its first phase.
    scrub(&mut client, begun.0);
    client.mode("operate");
    let (time, volts) = reading(&client.advance(0.5));
    assert!(time > 0.5 && (volts - 50.0 * (-time).exp()).abs() < 1e-6, "{volts} V at {time} s");
}

#[test]
fn a_machine_that_was_moved_back_has_the_parameters_of_now() {
    let mut client = Client::with("lessons/mass-and-spring.json");
    let share = |client: &mut Client, frame: &Frame| client.volts(frame, "P1") / client.volts(frame, "B1");
    client.mode("operate");
    let early = client.advance(0.2);
    client.advance(0.2);
    // P1 is k / m * (1/10) / 10.
    client.send(json!({"command": "parameter", "name": "k", "value": 10}));
    client.advance(0.2);
    let frame = scrub(&mut client, early.header.time);
    assert!((share(&mut client, &frame) - 0.1).abs() < 1e-6);
    // The integrators have their voltages with the parameters of then.
    assert_eq!(client.volts(&frame, "A1"), client.volts(&early, "A1"));
    // From here, the run has the parameter of now, also when it is repeated.
    client.mode("operate");
    let passed: Vec<_> = (0..3).map(|_| reading(&client.advance(0.1))).collect();
    assert_eq!(reading(&scrub(&mut client, passed[1].0)), passed[1]);
    assert_eq!(reading(&scrub(&mut client, passed[2].0)), passed[2]);
    // The same from the beginning.
    scrub(&mut client, 0.0);
    client.mode("operate");
    let passed: Vec<_> = (0..3).map(|_| reading(&client.advance(0.05))).collect();
    let w = f64::sqrt(10.0);
    for (time, volts) in &passed {
        assert!((volts - 80.0 * (w * time).cos()).abs() < 1e-3, "{volts} V at {time} s");
    }
    assert_eq!(reading(&scrub(&mut client, passed[1].0)), passed[1]);
}
