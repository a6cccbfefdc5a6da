//! A client of a session: it sends commands, and reads events and frames.

use std::fs;
use std::path::Path;

use patchcord_panel::frame::{Frame, decode};
use patchcord_panel::{Session, SessionOptions};
use serde_json::{Value, json};

/// The text of a shipped patch.
pub(crate) fn text(file: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../patches").join(file)).unwrap()
}

/// A client of a session.
pub(crate) struct Client(pub Session);

impl Client {
    /// A client that has opened a shipped patch.
    pub(crate) fn with(file: &str) -> Client {
        let mut client = Client(Session::new(SessionOptions::default()));
        client.send(json!({"command": "open", "name": file, "text": text(file)}));
        client
    }

    /// Sends a command, and returns the events.
    pub(crate) fn send(&mut self, command: Value) -> Vec<Value> {
        self.request(command).0
    }

    /// Sends a command, and returns the events and the frame.
    pub(crate) fn request(&mut self, command: Value) -> (Vec<Value>, Option<Frame>) {
        let request = json!({"id": 1, "commands": [command]}).to_string();
        let answer = self.0.request(&request, &mut || false);
        let response: Value = serde_json::from_str(&answer.text).unwrap();
        assert_eq!(response["frame"], answer.frame.is_some());
        let events = response["events"].as_array().unwrap().clone();
        (events, answer.frame.map(|bytes| decode(&bytes).unwrap()))
    }

    /// Advances the clock, and returns the frame.
    pub(crate) fn advance(&mut self, seconds: f64) -> Frame {
        self.request(json!({"command": "advance", "seconds": seconds})).1.unwrap()
    }

    /// Selects a mode.
    pub(crate) fn mode(&mut self, mode: &str) -> Vec<Value> {
        self.send(json!({"command": "mode", "mode": mode}))
    }

    /// The event `patch` after a question.
    pub(crate) fn patch(&mut self) -> Value {
        let events = self.send(json!({"command": "hello"}));
        event(&events, "patch").clone()
    }

    /// The voltage of an output in a frame.
    pub(crate) fn volts(&mut self, frame: &Frame, output: &str) -> f64 {
        let patch = self.patch();
        let outputs = patch["outputs"].as_array().unwrap();
        let index = outputs.iter().position(|known| known["name"] == output).unwrap();
        f64::from(frame.volts[index])
    }
}

/// The last event of a name.
pub(crate) fn event<'e>(events: &'e [Value], name: &str) -> &'e Value {
    let found = events.iter().rfind(|event| event["event"] == name);
    found.unwrap_or_else(|| panic!("no event {name} in {events:?}"))
}

/// The message of the refusal among the events.
pub(crate) fn refusal(events: &[Value]) -> String {
    event(events, "refused")["message"].as_str().unwrap().to_owned()
}
