//! Random sequences of commands: valid ones, and ones with names and values that do not fit.

use std::fs;
use std::path::Path;

use patchcord_panel::frame::{Frame, decode};
use patchcord_panel::{Session, SessionOptions};
use proptest::prelude::*;
use serde_json::{Value, json};

/// Number of the mode operate in a frame.
const OPERATE: u8 = 3;
/// Number of commands that [`command`] knows.
const COMMANDS: u8 = 29;
/// The texts of numbers, also of those that no f64 can represent.
const NUMBERS: [&str; 16] = [
    "0", "1", "-1", "0.5", "0.02", "3", "10", "50", "1e-9", "1e9", "1e300", "-1e300", "1e999", "-1e999",
    "5e-324", "-0.0",
];
/// Names that a patch usually does not have.
const JUNK: [&str; 8] =
    ["", "A99", "a \"quoted\" name", "\u{e9}\u{1d6fc}", "a.b.c", "\n\u{0}", "+100", "../../etc"];
/// The modes.
const MODES: [&str; 8] =
    ["pot-set", "problem-check", "initial-condition", "operate", "hold", "repetitive", "single", "fly"];
/// Commands without names and values of the patch.
const QUESTIONS: [&str; 6] = [
    "\"clear-cords\"",
    "\"open-file\", \"name\": \"../../etc/hostname.json\"",
    "\"hello\"",
    "\"advise\"",
    "\"static-check\", \"seed\": 1",
    "\"static-check\", \"seed\": null",
];
/// Texts that replace the patch, as JSON: patches, one with a fault, and one that is not a patch.
const TEXTS: [&str; 4] = [
    r#""{\"patchcord\": 1, \"elements\": {\"A1\": {\"kind\": \"integrator\", \"in\": {\"x1\": [\"A1\"]}}}}""#,
    r#""{\"patchcord\": 1, \"elements\": {}, \"run\": {\"for\": 20, \"step\": 2}}""#,
    r#""{\"patchcord\": 1, \"elements\": {\"A1\": {\"kind\": \"pot\"}}}""#,
    r#""not a patch""#,
];
/// Kinds of elements.
const KINDS: [&str; 6] = ["integrator", "pot", "sine", "delay", "relay", "no-such-kind"];

/// The names in a patch.
struct Names {
    /// Elements, drives and instances, each with its jacks and its settings.
    elements: Vec<(String, Vec<String>, Vec<String>)>,
    /// The outputs.
    outputs: Vec<String>,
    /// The parameters.
    parameters: Vec<String>,
}

/// Random numbers that select one of several things each.
struct Choices<'c>(std::slice::Iter<'c, u16>);

impl Choices<'_> {
    /// The next number, below a limit.
    fn below(&mut self, limit: usize) -> usize {
        self.0.next().map_or(0, |number| usize::from(*number) % limit.max(1))
    }

    /// One of several texts.
    fn one<'t>(&mut self, texts: &[&'t str]) -> &'t str {
        texts[self.below(texts.len())]
    }

    /// A number.
    fn number(&mut self) -> &'static str {
        self.one(&NUMBERS)
    }

    /// One of several names, or sometimes junk; as JSON.
    fn name(&mut self, names: &[String]) -> String {
        let index = self.below(names.len() + names.len() / 8 + 1);
        let name = names.get(index).map_or_else(|| self.one(&JUNK), String::as_str);
        Value::from(name).to_string()
    }

    /// An element with one of its jacks and one of its settings; as JSON.
    fn element(&mut self, names: &Names) -> [String; 3] {
        let index = self.below(names.elements.len());
        let Some((element, jacks, settings)) = names.elements.get(index) else {
            return ["\"A1\"", "\"x1\"", "\"initial\""].map(str::to_owned);
        };
        [self.name(std::slice::from_ref(element)), self.name(jacks), self.name(settings)]
    }

    /// An end of a cord; as JSON.
    fn end(&mut self, names: &Names) -> String {
        let [element, jack, _] = self.element(names);
        match self.below(2) {
            0 => format!(r#"{{"element": {element}, "jack": {jack}}}"#),
            _ => format!(r#"{{"output": {}}}"#, self.name(&names.outputs)),
        }
    }

    /// The value of a setting; as JSON.
    fn value(&mut self) -> String {
        match self.below(4) {
            0 => self
                .one(&["null", "true", "\"k *\"", "[[0, 0], [1, 1]]", "[[1, 0], [0, 1e999]]", "{}"])
                .to_owned(),
            _ => self.number().to_owned(),
        }
    }
}

/// A command as JSON, without the braces around it.
fn command(kind: u8, numbers: &[u16], names: &Names) -> String {
    let mut pick = Choices(numbers.iter());
    let [element, jack, setting] = pick.element(names);
    let (from, flag) = (pick.name(&names.outputs), pick.one(&["true", "false"]));
    let cord = format!(r#""element": {element}, "jack": {jack}, "from": {from}"#);
    let optional = |pick: &mut Choices<'_>| match pick.below(4) {
        0 => "null",
        _ => pick.number(),
    };
    match kind {
        0 => format!(r#""mode", "mode": "{}""#, pick.one(&MODES)),
        1 => format!(r#""speed", "factor": {}"#, optional(&mut pick)),
        2 => format!(r#""pause", "paused": {flag}"#),
        3 => format!(r#""sweep", "seconds": {}"#, optional(&mut pick)),
        4 => format!(r#""rate", "hertz": {}"#, optional(&mut pick)),
        5 => format!(r#""scrub", "time": {}"#, pick.number()),
        6..=8 => format!(r#""advance", "seconds": {}"#, pick.number()),
        9 => format!(r#""parameter", "name": {}, "value": {}"#, pick.name(&names.parameters), pick.number()),
        10 | 11 => {
            format!(r#""setting", "element": {element}, "setting": {setting}, "value": {}"#, pick.value())
        }
        12 => format!(r#""time-scale", "value": {}"#, pick.number()),
        13 => format!(r#""plug", {cord}"#),
        14 => format!(r#""unplug", {cord}"#),
        15 => format!(r#""move-cord", {cord}, "to": {}"#, pick.end(names)),
        16 => format!(r#""loose-cord", "end": {}, "at": [{}, 0]"#, pick.end(names), pick.number()),
        17 => format!(r#""plug-loose", "id": {}, "to": {}"#, pick.below(3), pick.end(names)),
        18 => format!(r#""remove-loose", "id": {}"#, pick.below(3)),
        19 => pick.one(&QUESTIONS).to_owned(),
        20 => format!(r#""add-element", "kind": "{}", "name": null"#, pick.one(&KINDS)),
        21 => format!(r#""remove-element", "name": {element}"#),
        22 => pick.one(&["\"undo\"", "\"redo\""]).to_owned(),
        23 => scope(&mut pick, &from),
        24 => format!(r#""meter", "output": {from}"#),
        25 => format!(r#""null-meter", "output": {from}, "divider": {}"#, pick.number()),
        26 => format!(r#""move-loose", "id": {}, "at": [{}, 0]"#, pick.below(3), pick.number()),
        27 => format!(r#""replace", "text": {}"#, pick.one(&TEXTS)),
        _ => format!(r#""views", "schematic": {flag}, "equations": {flag}"#),
    }
}

/// A command that sets the controls of a scope, or erases one.
fn scope(pick: &mut Choices<'_>, output: &str) -> String {
    if pick.below(4) == 0 {
        return format!(r#""erase", "scope": {}"#, pick.below(3));
    }
    let channel = |output: &str| {
        format!(r#"{{"output": {output}, "volts_per_division": 20, "centre": 0, "inverted": false}}"#)
    };
    let [first, second] = [channel(output), channel("\"A1\"")];
    let (display, mode) = (pick.one(&["time", "plane"]), pick.one(&["run", "level", "single-shot"]));
    format!(
        r#""scope", "scope": {}, "controls": {{"display": "{display}", "channels": [{first}, {second}],
            "seconds_per_division": {}, "store": true, "persistence": 0,
            "trigger": {{"mode": "{mode}", "channel": {}, "level": 0, "rising": true}}}}"#,
        pick.below(3),
        pick.number(),
        pick.below(3)
    )
}

/// A session and what its client knows.
struct Panel {
    /// The session.
    session: Session,
    /// The last command, for messages.
    last: String,
}

impl Panel {
    /// A session with a shipped patch.
    fn with(file: &str) -> Panel {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../patches").join(file);
        let mut panel = Panel { session: Session::new(SessionOptions::default()), last: String::new() };
        let open = json!({"command": "open", "name": file, "text": fs::read_to_string(path).unwrap()});
        panel.request(&format!(r#"{{"id": 1, "commands": [{open}]}}"#));
        panel
    }

    /// Sends a request, and returns the events and the frame, which are valid. The host has time for some hundreds of
    /// steps.
    fn request(&mut self, request: &str) -> (Vec<Value>, Option<Frame>) {
        self.last = request.to_owned();
        let mut questions = 0;
        let answer = self.session.request(request, &mut || {
            questions += 1;
            questions > 5
        });
        let response: Value = serde_json::from_str(&answer.text).unwrap();
        check_numbers(&response, request);
        assert_eq!(response["frame"], answer.frame.is_some(), "{request}");
        let frame =
            answer.frame.map(|bytes| decode(&bytes).unwrap_or_else(|error| panic!("{request}: {error}")));
        (response["events"].as_array().unwrap().clone(), frame)
    }

    /// Sends a command, which is JSON from its name on.
    fn send(&mut self, command: &str) -> (Vec<Value>, Option<Frame>) {
        self.request(&format!(r#"{{"id": 1, "commands": [{{"command": {command}}}]}}"#))
    }

    /// The present frame.
    fn frame(&mut self) -> Frame {
        self.send(r#""advance", "seconds": 0"#).1.unwrap()
    }

    /// The text of the patch.
    fn text(&mut self) -> String {
        let (events, _) = self.send("\"text\"");
        find(&events, "text").unwrap()["text"].as_str().unwrap().to_owned()
    }

    /// The names in the patch.
    fn names(&mut self) -> Names {
        let (events, _) = self.send("\"hello\"");
        let patch = find(&events, "patch").unwrap();
        let names = |list: &Value| -> Vec<String> {
            list.as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap().to_owned()).collect()
        };
        let elements = patch["elements"].as_array().unwrap().iter();
        let parts = |one: &Value| {
            (one["name"].as_str().unwrap().to_owned(), names(&one["jacks"]), names(&one["settings"]))
        };
        Names {
            elements: elements.map(parts).collect(),
            outputs: names(&patch["outputs"]),
            parameters: names(&patch["parameters"]),
        }
    }

    /// Sends a command and checks what every command guarantees.
    fn check(&mut self, command: &str) {
        let (before, text) = (self.frame().header, self.text());
        let (events, frame) = self.send(command);
        let sent = self.last.clone();
        if find(&events, "refused").is_some() {
            assert_eq!(self.text(), text, "{sent}");
            assert_eq!(self.frame().header.revision, before.revision, "{sent}");
        }
        if let Some(frame) = frame
            && before.mode == OPERATE
        {
            assert!(frame.header.time >= before.time, "{sent}: {} after {}", frame.header.time, before.time);
        }
        let (events, _) = self.send("\"hello\"");
        let revision = find(&events, "patch").unwrap()["revision"].as_u64();
        let outputs = find(&events, "patch").unwrap()["outputs"].as_array().unwrap().len();
        let frame = self.frame();
        assert_eq!(
            (Some(u64::from(frame.header.revision)), frame.volts.len()),
            (revision, outputs),
            "{sent}"
        );
    }

    /// Replaces the session by one from its snapshot, which has the same text.
    fn restore(&mut self) {
        let text = self.text();
        let (events, _) = self.send("\"snapshot\"");
        let snapshot = find(&events, "snapshot").unwrap()["snapshot"].to_string();
        self.session = Session::new(SessionOptions::default());
        let (events, _) = self.send(&format!(r#""restore", "snapshot": {snapshot}"#));
        assert!(find(&events, "refused").is_none(), "{events:?}");
        assert_eq!(self.text(), text);
    }

    /// Reverts all steps.
    fn undo_all(&mut self) {
        for _ in 0..200 {
            if find(&self.send("\"undo\"").0, "refused").is_some() {
                return;
            }
        }
        panic!("the history has no beginning");
    }
}

/// The last event of a name.
fn find<'e>(events: &'e [Value], name: &str) -> Option<&'e Value> {
    events.iter().rfind(|event| event["event"] == name)
}

/// Checks that all numbers are finite.
fn check_numbers(value: &Value, request: &str) {
    match value {
        Value::Number(number) => assert!(number.as_f64().is_some_and(f64::is_finite), "{request}: {number}"),
        Value::Array(items) => items.iter().for_each(|item| check_numbers(item, request)),
        Value::Object(fields) => fields.values().for_each(|field| check_numbers(field, request)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// Sends random commands to a session with a shipped patch, and reverts them all.
fn check_commands(file: &str, commands: &[(u8, Vec<u16>)]) {
    let mut panel = Panel::with(file);
    let (first, mut names) = (panel.text(), panel.names());
    for (index, (kind, numbers)) in commands.iter().enumerate() {
        panel.check(&command(*kind, numbers, &names));
        names = panel.names();
        if index == commands.len() / 2 {
            panel.restore();
        }
    }
    panel.undo_all();
    assert_eq!(panel.text(), first);
}

/// A sequence of commands.
fn commands() -> impl Strategy<Value = Vec<(u8, Vec<u16>)>> {
    prop::collection::vec((0..COMMANDS, prop::collection::vec(any::<u16>(), 16)), 1..24)
}

proptest! {
    // Each case compiles the patch some hundred times.
    #![proptest_config(ProptestConfig { cases: 6, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_mass_on_a_spring_takes_any_commands(sequence in commands()) {
        check_commands("lessons/mass-and-spring.json", &sequence);
    }

    #[test]
    fn a_ball_in_a_box_takes_any_commands(sequence in commands()) {
        check_commands("lessons/bouncing-ball.json", &sequence);
    }

    #[test]
    fn a_circuit_with_macros_takes_any_commands(sequence in commands()) {
        check_commands("thesis/fig-4-07.json", &sequence);
    }

    #[test]
    fn a_friction_circuit_takes_any_commands(sequence in commands()) {
        check_commands("thesis/fig-8-16.json", &sequence);
    }
}
