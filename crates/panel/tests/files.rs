//! Patches in files below the folder of a session.

use std::fs;
use std::path::Path;

use patchcord_panel::limits::MAX_PATCH_BYTES;
use patchcord_panel::{Session, SessionOptions};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::client::{Client, event, refusal};

/// A patch whose only drive is 50 V, from a table.
fn with_points(points: &Value) -> String {
    json!({
        "patchcord": 1, "title": "A table", "scales": {"volt": {"per_volt": 1, "unit": "V"}},
        "drives": {"u": {"kind": "table", "scale": "volt", "points": points}},
        "elements": {"A1": {"kind": "summer", "in": {"x1": ["u"]}}}, "run": {"for": 1, "step": 0.01}
    })
    .to_string()
}

/// A folder with a secret patch, and in it the folder "start" with patches and tables.
fn folders() -> (TempDir, Client) {
    let all = tempfile::tempdir().unwrap();
    let start = all.path().join("start");
    fs::create_dir_all(start.join("tasks")).unwrap();
    let [in_file, lost] = ["u.csv", "v.csv"].map(|csv| with_points(&json!({ "csv": csv })));
    for (name, text) in [
        ("secret.json", "{\"patchcord\": 1, \"title\": \"secret\"}"),
        ("start/own.json", in_file.as_str()),
        ("start/u.csv", "t,u\n0,50\n1,50\n"),
        ("start/tasks/pump.json", in_file.as_str()),
        ("start/tasks/u.csv", "t,u\n0,20\n1,20\n"),
        ("start/tasks/plain.json", "{\"patchcord\": 1}\r\n"),
        ("start/tasks/lost.json", lost.as_str()),
        ("start/faulty.json", "{\"patchcord\": 1,}"),
        ("start/notes.txt", "{\"patchcord\": 1}"),
    ] {
        fs::write(all.path().join(name), text).unwrap();
    }
    (all, Client(Session::new(SessionOptions { folder: Some(start) })))
}

/// Opens a file and asks for the text of the patch. Returns the events.
fn open(client: &mut Client, name: &str) -> Vec<Value> {
    let mut events = client.send(json!({"command": "open-file", "name": name}));
    events.extend(client.send(json!({"command": "text"})));
    events
}

/// The name and the text of the patch among the events, after a file was opened.
fn opened(events: &[Value]) -> (&str, &str) {
    assert!(!events.iter().any(|event| event["event"] == "refused"), "{events:?}");
    let text = event(events, "text");
    (text["name"].as_str().unwrap(), text["text"].as_str().unwrap())
}

/// The message with which a file is refused. The patch on the panel stays.
fn refused(client: &mut Client, name: &str) -> String {
    let before = client.send(json!({"command": "text"}));
    let events = open(client, name);
    assert_eq!(event(&events, "text"), event(&before, "text"), "{name}");
    refusal(&events)
}

/// The voltage of the summer at the end of a run.
fn final_volts(client: &mut Client) -> f64 {
    let events = client.send(json!({"command": "run"}));
    let csv = event(&events, "table")["csv"].as_str().unwrap();
    let lines = csv.lines().filter(|line| !line.starts_with('#'));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let column = rows[0].iter().position(|name| *name == "A1").unwrap();
    rows.last().unwrap()[column].parse().unwrap()
}

#[test]
fn a_patch_in_the_folder_is_opened_with_its_tables() {
    let (all, mut client) = folders();
    let text = fs::read_to_string(all.path().join("start/own.json")).unwrap();
    for name in ["own.json", "./own.json"] {
        let events = open(&mut client, name);
        assert_eq!(event(&events, "patch")["title"], "A table");
        // The reference to the table stays, so that the saved file is the same one.
        assert_eq!(opened(&events), ("own.json", text.as_str()));
        assert_eq!(final_volts(&mut client), -50.0, "{name}");
    }
}

#[test]
fn a_patch_in_a_folder_below_has_its_own_tables() {
    let (_all, mut client) = folders();
    let events = open(&mut client, "tasks/pump.json");
    let (name, text) = opened(&events);
    assert_eq!((name, text), ("pump.json", with_points(&json!([[0.0, 20.0], [1.0, 20.0]])).as_str()));
    assert_eq!(final_volts(&mut client), -20.0);
    for name in ["tasks/../own.json", "../start/own.json"] {
        assert_eq!(opened(&open(&mut client, name)).0, "own.json");
        assert_eq!(final_volts(&mut client), -50.0, "{name}");
    }
    // Without tables the text is that of the file.
    assert_eq!(opened(&open(&mut client, "tasks/plain.json")), ("plain.json", "{\"patchcord\": 1}\r\n"));
    let message = refused(&mut client, "tasks/lost.json");
    assert!(message.contains("there is no file") && message.contains("v.csv"), "{message}");
}

#[test]
fn files_outside_of_the_folder_are_refused_whether_they_exist_or_not() {
    let (all, mut client) = folders();
    let absolute = all.path().join("secret.json").display().to_string();
    for name in
        ["../secret.json", "tasks/../../secret.json", "../missing.json", "/etc/missing.json", &absolute]
    {
        let message = refused(&mut client, name);
        let expected = format!("{name} is not below the folder of the panel: open it with \"Open\"");
        assert_eq!(message, expected);
    }
}

#[cfg(unix)]
#[test]
fn links_are_resolved_and_pipes_are_refused_without_waiting() {
    use std::os::unix::fs::symlink;
    let (all, mut client) = folders();
    let start = all.path().join("start");
    symlink(all.path().join("secret.json"), start.join("link.json")).unwrap();
    symlink(all.path(), start.join("up")).unwrap();
    symlink("tasks/plain.json", start.join("inside.json")).unwrap();
    symlink(start.join("own.json"), all.path().join("back.json")).unwrap();
    for name in ["link.json", "up/secret.json", "up/back.json"] {
        assert!(refused(&mut client, name).contains("is not below the folder of the panel"), "{name}");
    }
    assert_eq!(opened(&open(&mut client, "inside.json")).1, "{\"patchcord\": 1}\r\n");
    assert!(std::process::Command::new("mkfifo").arg(start.join("pipe.json")).status().unwrap().success());
    assert!(refused(&mut client, "pipe.json").contains("it is a pipe, not a regular file"));
}

#[test]
fn what_is_no_patch_is_refused_with_the_reason() {
    let (all, mut client) = folders();
    let start = all.path().join("start");
    fs::create_dir(start.join("folder.json")).unwrap();
    fs::write(start.join("binary.json"), [0xff, 0xfe]).unwrap();
    let spaces = " ".repeat(MAX_PATCH_BYTES);
    for name in ["start/long.json", "start/tasks/long.json"] {
        fs::write(all.path().join(name), format!("{{\"patchcord\": 1}}{spaces}")).unwrap();
    }
    for (name, expected) in [
        ("missing.json", "there is no file missing.json in the folder of the panel: check the name"),
        ("notes.txt", "notes.txt is not opened: the name of a patch must end in .json"),
        ("", " is not opened: the name of a patch must end in .json"),
        ("faulty.json", "remove the last comma"),
        ("folder.json", "it is a folder"),
        ("binary.json", "the file is not UTF-8 text"),
        ("long.json", "the patch would have more than 1 MB"),
        ("tasks/long.json", "the patch would have more than 1 MB"),
        ("nul\u{0}.json", "cannot read"),
    ] {
        let message = refused(&mut client, name);
        assert!(message.contains(expected), "{name}: {message}");
    }
}

#[test]
fn a_session_without_a_folder_opens_no_file() {
    let mut client = Client(Session::new(SessionOptions::default()));
    for name in ["Cargo.toml", "own.json", "/etc/own.json"] {
        assert!(refused(&mut client, name).contains("this panel reads no files"), "{name}");
    }
    assert!(Path::new("Cargo.toml").exists());
}
