//! A session: one user at one panel. It carries out requests and reports what changed.
//!
//! `requests` reads requests and writes answers, `carry_out` carries out their commands, and `checks` checks numbers.
//! `current_patch` lets the machine follow the patch, `bench` is the machine with its clock, and `reading` reads it.
//! `events` makes the events, `saved` the snapshots, and `files` opens files.

mod bench;
mod carry_out;
mod checks;
mod current_patch;
mod events;
mod files;
mod live_machine;
mod reading;
mod requests;
mod saved;

use std::path::PathBuf;

use patchcord_core::document::{Report, read_request};
use patchcord_core::patch::TableAccess;

use self::bench::{Bench, Probes};
use crate::command::Command;
use crate::compiled::Compiled;
use crate::document::{Document, Refusal};
use crate::event::{Event, MachineState, NullMeter};
use crate::limits::{MAX_COMMANDS, MAX_REQUEST_BYTES};
use crate::scope::{SCOPES, Scope};

/// The settings of a session that a host chooses.
#[derive(Debug, Clone, Default)]
pub struct SessionOptions {
    /// The folder below which patches and their tables are read, and to which their paths are relative. Without it, no
    /// files are read.
    pub folder: Option<PathBuf>,
}

/// The answer to a request.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// A [`Response`](crate::event::Response) as JSON.
    pub text: String,
    /// The frame, if the request advanced the clock.
    pub frame: Option<Vec<u8>>,
}

/// A panel with its machine: a state machine without a clock of its own.
///
/// # Examples
///
/// ```
/// use patchcord_panel::{Session, SessionOptions};
///
/// let mut session = Session::new(SessionOptions::default());
/// let answer = session.request(r#"{"id": 1, "commands": [{"command": "undo"}]}"#, &mut || false);
/// assert!(answer.text.contains(r#""event":"refused""#) && answer.frame.is_none());
/// let answer = session.request(r#"{"id": 2, "commands": [{"command": "advance", "seconds": 0.02}]}"#, &mut || false);
/// assert!(answer.frame.is_some());
/// ```
pub struct Session {
    /// The settings of the host.
    options: SessionOptions,
    /// The patch and its history.
    document: Document,
    /// What the checker reports about the patch.
    report: Report,
    /// The patch compiled; `None` if it has faults other than open inputs.
    compiled: Option<Compiled>,
    /// The outputs, in the order of the voltages of a frame.
    probes: Probes,
    /// Seconds since a parameter was set last; `None` if the patch was compiled since then.
    turned: Option<f64>,
    /// The machine.
    bench: Bench,
    /// The scopes.
    scopes: Vec<Scope>,
    /// The output at the voltmeter.
    meter: Option<String>,
    /// The null meter.
    null_meter: NullMeter,
    /// Whether the page shows the schematic and the equations.
    shows: Shown,
    /// The state of the machine that the client knows; `None` if the next answer has to contain it.
    known: Option<MachineState>,
}

/// The views that the page shows.
#[derive(Debug, Clone, Copy, Default)]
struct Shown {
    /// Whether it shows the schematic.
    schematic: bool,
    /// Whether it shows the equations.
    equations: bool,
}

impl Session {
    /// A session with an empty patch.
    pub fn new(options: SessionOptions) -> Self {
        let document = Document::empty(None, &table_access(&options));
        let report = Report::new("", "", Vec::new());
        let mut session = Session {
            options,
            document,
            report,
            compiled: None,
            probes: Probes::default(),
            turned: None,
            bench: Bench::new(),
            scopes: (0..SCOPES).map(|_| Scope::new()).collect(),
            meter: None,
            null_meter: NullMeter::default(),
            shows: Shown::default(),
            known: None,
        };
        current_patch::use_patch(&mut session, true);
        session
    }

    /// Carries out a request, which is a [`Request`](crate::command::Request) as JSON. `must_stop` is asked from time to
    /// time while the machine moves, and says whether the host has no more time.
    pub fn request(&mut self, text: &str, must_stop: &mut dyn FnMut() -> bool) -> Answer {
        let request = match read_request::<Command>(text, MAX_REQUEST_BYTES, MAX_COMMANDS) {
            Ok(request) => request,
            Err(message) => {
                return requests::answer(None, vec![Event::Refused { message, place: None }], None);
            }
        };
        let mut events = Vec::new();
        for command in &request.commands {
            let known = events.len();
            if let Err(Refusal { message, place }) =
                carry_out::carry_out(self, command, must_stop, &mut events)
            {
                events.push(Event::Refused { message, place: place.map(|place| *place) });
            }
            requests::drop_replaced(&mut events, known);
        }
        let overloads = reading::overloads(self);
        let advances = request.commands.iter().any(|command| matches!(command, Command::Advance { .. }));
        let frame = advances.then(|| reading::frame(self, &overloads));
        let state = reading::machine_state(self, overloads);
        if self.known.as_ref().is_none_or(|known| requests::differs(known, &state)) {
            events.push(Event::Machine(state.clone()));
            self.known = Some(state);
        }
        requests::answer(Some(request.id), events, frame)
    }
}

/// The tables that the host permits.
fn table_access(options: &SessionOptions) -> TableAccess {
    options.folder.clone().map_or(TableAccess::None, TableAccess::Below)
}
