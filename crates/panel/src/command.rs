//! The commands of a client: everything that a user can do at the panel.
//!
//! A client sends a [`Request`] as JSON. A command that is refused has no effect, and its event says why. Names of
//! commands and fields are part of the protocol, which docs/panel-protocol.md documents.

use patchcord_core::document::{self, RequestCommand};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::limits::MAX_NAME_CHARACTERS;

/// The version of the protocol. A client and a session of different versions do not work together.
pub const PROTOCOL_VERSION: u32 = 1;

/// A request of a panel.
pub type Request = document::Request<Command>;

impl RequestCommand for Command {
    fn check_fields(fields: &Map<String, Value>) -> Result<(), String> {
        if fields.iter().any(has_long_name) {
            return Err(format!("a name in a command has more than {MAX_NAME_CHARACTERS} characters"));
        }
        Ok(())
    }
}

/// Whether a field is, or contains, a text that is too long for a name. Patches, snapshots and values of settings have
/// limits of their own.
fn has_long_name((key, value): (&String, &Value)) -> bool {
    match value {
        _ if ["text", "snapshot", "value"].contains(&key.as_str()) => false,
        Value::String(text) => text.chars().nth(MAX_NAME_CHARACTERS).is_some(),
        Value::Object(fields) => fields.iter().any(has_long_name),
        // The lists in commands have numbers, or the channels of a scope.
        Value::Array(items) => items.iter().any(|item| has_long_name((key, item))),
        Value::Null | Value::Bool(_) | Value::Number(_) => false,
    }
}

/// The modes of the machine that a user can select.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mode {
    /// Every pot shows its setting as a share of 100 V, and all other outputs are at 0 V.
    PotSet,
    /// Integrators are at their initial conditions, as in [`Mode::InitialCondition`]. The command `static-check` compares
    /// every output with the equations.
    ProblemCheck,
    /// Integrators are at their initial conditions.
    InitialCondition,
    /// Integrators integrate.
    Operate,
    /// Integrators keep their outputs.
    Hold,
    /// Initial condition and operation alternate.
    Repetitive,
    /// The run of the patch, once. Then the machine is in hold.
    Single,
}

/// An end of a cord at the panel.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(untagged, try_from = "EndFields")]
pub enum CordEnd {
    /// An input jack.
    Input {
        /// Name of the element.
        element: String,
        /// Name of the jack, such as "x10" or "in".
        jack: String,
    },
    /// An output jack.
    Output {
        /// Name of the element, drive or reference.
        output: String,
    },
}

/// The fields of both kinds of ends. Code that tries one kind after the other is larger, and its errors name no field.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EndFields {
    /// Name of the element with the input.
    element: Option<String>,
    /// Name of the jack.
    jack: Option<String>,
    /// Name of the output.
    output: Option<String>,
}

impl TryFrom<EndFields> for CordEnd {
    type Error = &'static str;

    fn try_from(fields: EndFields) -> Result<CordEnd, &'static str> {
        match (fields.element, fields.jack, fields.output) {
            (Some(element), Some(jack), None) => Ok(CordEnd::Input { element, jack }),
            (None, None, Some(output)) => Ok(CordEnd::Output { output }),
            _ => Err("an end of a cord has either \"element\" and \"jack\", or \"output\""),
        }
    }
}

/// One action of a user, or a question of the page.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Command {
    /// Asks for everything. The answer begins with the event `hello`.
    Hello,
    /// Replaces the patch by this text. The history begins again.
    Open {
        /// Name of the file, for messages.
        name: String,
        /// The JSON document.
        text: String,
    },
    /// Replaces the patch by that of a file below the folder of the host. The history begins again.
    OpenFile {
        /// Its path from the folder, which ends in ".json".
        name: String,
    },
    /// Replaces the patch by an empty one.
    New {
        /// Name of the machine; that of the present patch if absent.
        machine: Option<String>,
    },
    /// Replaces the text of the patch as one step of the history. The machine continues with its states.
    Replace {
        /// The JSON document.
        text: String,
    },
    /// Asks for the text of the patch. The answer is the event `text`.
    Text,
    /// Asks for the session as data: patch, history, mode, scopes. The answer is the event `snapshot`.
    Snapshot,
    /// Replaces the session by one from an event `snapshot`.
    Restore {
        /// The content of the event.
        snapshot: Value,
    },

    /// Selects the mode of the machine.
    Mode {
        /// The mode.
        mode: Mode,
    },
    /// Sets how fast the machine runs, relative to problem time.
    Speed {
        /// The factor, from 1e-6 to 1e6; as fast as possible if absent.
        factor: Option<f64>,
    },
    /// Stops or continues the clock of the panel. The mode of the machine stays.
    Pause {
        /// Whether the clock stands.
        paused: bool,
    },
    /// Sets the length of a sweep of repetitive operation.
    Sweep {
        /// Length in problem seconds; that of the patch's run if absent.
        seconds: Option<f64>,
    },
    /// Sets the rate of repetitive operation, which also sets the speed.
    Rate {
        /// Sweeps per second of the panel's clock, from 0.01 to 50; by the speed if absent.
        hertz: Option<f64>,
    },
    /// Moves the machine to an earlier time of its present run, or forward again up to its end, and holds it there. The
    /// part after this time is forgotten when the run continues, or when a parameter or the patch changes.
    Scrub {
        /// Problem time in seconds.
        time: f64,
    },
    /// Advances the clock of the panel. The answer is a frame.
    Advance {
        /// Seconds since the last advance, from 0 to 1.
        seconds: f64,
    },

    /// Sets a parameter, also while the machine runs. Consecutive changes of one parameter are one step of the history.
    Parameter {
        /// Its name.
        name: String,
        /// Its value in the declared unit.
        value: f64,
    },
    /// Sets a setting of an element: a pot, an initial condition, a key switch.
    Setting {
        /// Name of the element or drive.
        element: String,
        /// Name of the setting, such as "setting" or "limit.upper".
        setting: String,
        /// A number, a formula, true, false or a word; null removes the setting.
        value: Value,
    },
    /// Sets the time scale: machine seconds per problem second.
    TimeScale {
        /// The time scale.
        value: f64,
    },

    /// Plugs a cord in. If both ends are outputs or both are inputs, it is refused.
    Plug {
        /// Name of the element with the input.
        element: String,
        /// Name of the jack.
        jack: String,
        /// Name of the output.
        from: String,
    },
    /// Pulls a cord out and removes it.
    Unplug {
        /// Name of the element with the input.
        element: String,
        /// Name of the jack.
        jack: String,
        /// Name of the output.
        from: String,
    },
    /// Moves one end of a cord to another jack.
    MoveCord {
        /// Name of the element with the input.
        element: String,
        /// Name of the jack.
        jack: String,
        /// Name of the output.
        from: String,
        /// The jack to which one end moves: an input moves the input end, an output moves the output end.
        to: CordEnd,
    },
    /// Puts a cord on the panel with one end plugged in and the other one loose.
    LooseCord {
        /// The end that is plugged in.
        end: CordEnd,
        /// Place of the loose end on the panel, in units of the page.
        at: [f64; 2],
        /// The cord whose other end is dropped; absent for a new cord.
        #[serde(default)]
        replaces: Option<CordName>,
    },
    /// Plugs the loose end of a cord in.
    PlugLoose {
        /// Number of the loose cord.
        id: u64,
        /// The jack.
        to: CordEnd,
    },
    /// Moves the loose end of a cord to another place on the panel.
    MoveLoose {
        /// Number of the loose cord.
        id: u64,
        /// Place of the loose end, in units of the page.
        at: [f64; 2],
    },
    /// Removes a loose cord.
    RemoveLoose {
        /// Number of the loose cord.
        id: u64,
    },
    /// Removes all cords. Elements and settings stay.
    ClearCords,
    /// Adds an element.
    AddElement {
        /// Its kind.
        kind: String,
        /// Its name; the next free name of the kind if absent.
        name: Option<String>,
    },
    /// Removes an element, a drive or an instance, with its cords and the signals that are read there.
    RemoveElement {
        /// Its name.
        name: String,
    },
    /// Reverts the last step of the history.
    Undo,
    /// Repeats the step that was reverted last.
    Redo,

    /// Sets the controls of a scope. The session keeps them.
    Scope {
        /// 0 or 1.
        scope: usize,
        /// All controls.
        controls: crate::scope::ScopeControls,
    },
    /// Erases the traces of a scope.
    Erase {
        /// 0 or 1.
        scope: usize,
    },
    /// Connects the voltmeter.
    Meter {
        /// Name of the output; the meter is disconnected if absent.
        output: Option<String>,
    },
    /// Connects the null meter: it shows the output minus a share of the reference.
    NullMeter {
        /// Name of the output; the meter is disconnected if absent.
        output: Option<String>,
        /// The reference divider, from -1 to 1.
        divider: f64,
    },
    /// Says which views the page shows. Events for other views are not sent.
    Views {
        /// Whether the schematic is shown.
        schematic: bool,
        /// Whether the equations are shown.
        equations: bool,
    },
    /// Searches for corrections of equations that the wiring does not solve. The answer is the event `findings`. It can
    /// take seconds.
    Advise,
    /// Compares every output and derivative with the equations. The answer is the event `static-check`.
    StaticCheck {
        /// The seed of random test values; the initial condition if absent.
        seed: Option<u64>,
    },
    /// Runs the patch from its beginning as `patchcord run` does. The answer is the event `table`.
    Run,
}

/// A cord, named by its ends.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CordName {
    /// Name of the element with the input.
    pub element: String,
    /// Name of the jack.
    pub jack: String,
    /// Name of the output.
    pub from: String,
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Reads a loose cord with this end.
    fn with_end(end: &Value) -> Result<Command, String> {
        let object = json!({"command": "loose-cord", "end": end, "at": [1, 2.5]});
        document::read_variant(object.as_object().unwrap().clone(), "command")
    }

    #[test]
    fn an_end_of_a_cord_is_an_input_or_an_output() {
        let ends = [
            CordEnd::Input { element: "A1".to_owned(), jack: "x10".to_owned() },
            CordEnd::Output { output: "P1".to_owned() },
        ];
        for end in ends {
            let read = with_end(&serde_json::to_value(&end).unwrap());
            assert_eq!(read, Ok(Command::LooseCord { end, at: [1.0, 2.5], replaces: None }));
        }
        for wrong in [
            json!({}),
            json!({"element": "A1"}),
            json!({"element": "A1", "output": "P1"}),
            json!({"element": "A1", "jack": "x1", "output": "P1"}),
        ] {
            let message = with_end(&wrong).unwrap_err();
            let expected = "an end of a cord has either \"element\" and \"jack\", or \"output\"";
            assert_eq!(message, format!("command \"loose-cord\": {expected}"));
        }
        let message = with_end(&json!({"element": "A1", "jack": "x1", "cord": 1})).unwrap_err();
        assert!(message.contains("unknown field `cord`"), "{message}");
    }
}
