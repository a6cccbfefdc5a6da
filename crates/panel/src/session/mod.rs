//! A session: one user at one panel. It carries out requests and reports what changed.

mod bench;
mod live_machine;
mod saved;

use std::collections::HashSet;
use std::mem::{Discriminant, discriminant};
use std::path::PathBuf;

use patchcord_core::document::Report;
use patchcord_core::patch::{Patch, TableAccess};
use patchcord_core::solve::{RunSettings, run};
use patchcord_draw::schematic::Schematic;
use serde_json::{Value, json};

use self::bench::{Bench, Probes};
use self::saved::Saved;
use crate::command::{Command, Mode, PROTOCOL_VERSION, Request};
use crate::compiled::{Compiled, advise, compile};
use crate::document::{Change, Document, Refusal};
use crate::event::{Event, MachineState, OverloadView, Response};
use crate::frame::{self, FrameHeader};
use crate::limits::{self, MAX_COMMANDS, MAX_REQUEST_BYTES, MAX_TABLE_BYTES};
use crate::places;
use crate::scope::{SCOPES, Scope, ScopeControls};
use crate::view;
use crate::wiring;

/// Voltage at the top of a pot in pot set, in volts.
const POT_SET_VOLTS: f64 = 100.0;

/// The settings of a session that a host chooses.
#[derive(Debug, Clone, Default)]
pub struct SessionOptions {
    /// The folder below which tables of patches are read, and to which their paths are relative. Without it, no files are
    /// read.
    pub folder: Option<PathBuf>,
}

/// The answer to a request.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// A [`Response`] as JSON.
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
    /// What happened to parameters since the patch was compiled.
    turning: Turning,
    /// The machine.
    bench: Bench,
    /// The scopes.
    scopes: Vec<Scope>,
    /// The output at the voltmeter.
    meter: Option<String>,
    /// The output at the null meter, and the reference divider.
    null_meter: Option<(String, f64)>,
    /// Whether the page shows the schematic and the equations.
    shows: Shown,
    /// The overloads and the mode that the client knows.
    known: Option<MachineState>,
}

/// What happened to the parameters since the patch was compiled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Turning {
    /// Nothing.
    No,
    /// A parameter was set since the clock advanced last.
    Now,
    /// A parameter was set, but not since then. The patch has to be compiled again.
    Done,
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
            turning: Turning::No,
            bench: Bench::new(),
            scopes: (0..SCOPES).map(|_| Scope::new()).collect(),
            meter: None,
            null_meter: None,
            shows: Shown::default(),
            known: None,
        };
        session.use_patch(true);
        session
    }

    /// The events with which a client begins: everything there is.
    pub fn hello(&mut self) -> Vec<Event> {
        let mut events = vec![view::hello()];
        events.extend(self.patch_events());
        events.push(self.scopes_event());
        events.push(Event::Machine(self.machine_state()));
        events
    }

    /// Carries out a request, which is a [`Request`] as JSON. `must_stop` is asked from time to time while the machine
    /// moves, and says whether the host has no more time.
    pub fn request(&mut self, text: &str, must_stop: &mut dyn FnMut() -> bool) -> Answer {
        let request = match read_request(text) {
            Ok(request) => request,
            Err(message) => return answer(None, vec![Event::Refused { message, place: None }], None),
        };
        let (mut events, mut frame) = (Vec::new(), None);
        for command in &request.commands {
            let known = events.len();
            match self.carry_out(command, must_stop, &mut events) {
                Ok(()) => {}
                Err(Refusal { message, place }) => {
                    events.push(Event::Refused { message, place: place.map(|place| *place) });
                }
            }
            drop_replaced(&mut events, known);
            if matches!(command, Command::Advance { .. }) {
                frame = Some(self.frame());
            }
        }
        let state = self.machine_state();
        if self.known.as_ref().is_none_or(|known| differs(known, &state)) {
            events.push(Event::Machine(state.clone()));
            self.known = Some(state);
        }
        answer(Some(request.id), events, frame)
    }

    /// Carries out one command and adds its events.
    ///
    /// # Errors
    /// If the command is refused. Nothing is changed then.
    fn carry_out(
        &mut self,
        command: &Command,
        must_stop: &mut dyn FnMut() -> bool,
        events: &mut Vec<Event>,
    ) -> Result<(), Refusal> {
        match command {
            Command::Hello => events.extend(self.hello()),
            Command::Open { name, text } => {
                self.open(Document::open(name, text, &table_access(&self.options))?, events);
            }
            Command::New { machine } => {
                let machine =
                    machine.as_deref().or(self.document.patch().machine.as_ref().map(|name| &*name.value));
                let document = Document::empty(machine, &table_access(&self.options));
                self.open(document, events);
            }
            Command::Text => {
                let patch = self.document.patch();
                events.push(Event::Text { name: patch.file().to_owned(), text: patch.text().to_owned() });
            }
            Command::Snapshot => events.push(Event::Snapshot { snapshot: self.snapshot() }),
            Command::Restore { snapshot } => self.restore(snapshot, events)?,
            Command::Mode { mode } => self.select_mode(*mode, events),
            Command::Speed { factor } => {
                check_speed(*factor)?;
                self.bench.controls.speed = *factor;
            }
            Command::Pause { paused } => self.bench.controls.paused = *paused,
            Command::Sweep { seconds } => self.set_sweep(*seconds)?,
            Command::Rate { hertz } => {
                check_rate(*hertz)?;
                self.bench.controls.rate = *hertz;
            }
            Command::Scrub { time } => {
                within("the time", Some(*time), 0.0, f64::MAX)?;
                let parameters = self.parameters();
                self.bench.scrub(*time, parameters, &mut self.scopes, must_stop).map_err(Refusal::new)?;
            }
            Command::Advance { seconds } => {
                within("the time to advance", Some(*seconds), 0.0, 1.0)?;
                self.finish_turning(events);
                self.bench.advance(*seconds, &mut self.scopes, must_stop);
            }
            Command::Undo => {
                let change = self.document.undo()?;
                self.follow(change, events);
            }
            Command::Redo => {
                let change = self.document.redo()?;
                self.follow(change, events);
            }
            Command::Scope { scope, controls } => {
                self.scope(*scope)?.set_controls(controls.clone()).map_err(Refusal::new)?;
                self.bench.watch(&self.probes, &self.scopes);
                events.push(self.scopes_event());
            }
            Command::Erase { scope } => self.scope(*scope)?.erase(),
            Command::Meter { output } => {
                self.check_output(output.as_deref())?;
                self.meter.clone_from(output);
            }
            Command::NullMeter { output, divider } => {
                within("the reference divider", Some(*divider), -1.0, 1.0)?;
                self.check_output(output.as_deref())?;
                self.null_meter = output.clone().map(|output| (output, *divider));
            }
            Command::Views { schematic, equations } => {
                let before = self.shows;
                self.shows = Shown { schematic: *schematic, equations: *equations };
                if self.shows.schematic && !before.schematic {
                    events.push(self.schematic_event());
                }
                if self.shows.equations && !before.equations {
                    events.extend(self.equations_event());
                }
            }
            Command::Run => events.push(self.run_event()?),
            Command::Advise => {
                if let Some(report) = advise(self.document.patch()) {
                    self.report = report;
                }
                events.push(self.findings_event());
            }
            Command::StaticCheck { seed } => {
                let compiled = self.compiled.as_ref().ok_or_else(faulty)?;
                events.push(
                    view::static_check_event(&compiled.circuit, &compiled.program, *seed)
                        .map_err(Refusal::new)?,
                );
            }
            edit => self.edit(edit, events)?,
        }
        Ok(())
    }

    /// Carries out a command that edits the patch.
    ///
    /// # Errors
    /// If the command is refused by the document, or the value of a parameter by the machine. Nothing is changed then.
    fn edit(&mut self, command: &Command, events: &mut Vec<Event>) -> Result<(), Refusal> {
        let edited = self.document.edited(command)?;
        let mut machine_has_it = false;
        if let Command::Parameter { name, value } = command
            && !self.bench.is_blocked
        {
            self.bench.set_parameter(name, *value, &mut self.scopes).map_err(Refusal::new)?;
            machine_has_it = true;
        }
        match self.document.commit(edited) {
            Change::Parameter { name, value } if machine_has_it => self.note_turned(name, value, events),
            change => self.follow(change, events),
        }
        Ok(())
    }

    /// Notes that the machine has another value of a parameter.
    fn note_turned(&mut self, name: String, value: f64, events: &mut Vec<Event>) {
        self.turning = Turning::Now;
        events.push(Event::Parameter { name, value });
    }

    /// Compiles the patch again after parameters were turned, for the views. The machine has the values already.
    fn finish_turning(&mut self, events: &mut Vec<Event>) {
        match self.turning {
            Turning::No => {}
            Turning::Now => self.turning = Turning::Done,
            Turning::Done => {
                self.compile();
                events.extend(self.patch_events());
            }
        }
    }

    /// Replaces the patch and its history.
    fn open(&mut self, document: Document, events: &mut Vec<Event>) {
        self.document = document;
        (self.meter, self.null_meter) = (None, None);
        self.bench.controls =
            bench::Controls { speed: self.bench.controls.speed, ..bench::Controls::default() };
        self.use_patch(true);
        self.connect_usual_probes();
        events.extend(self.patch_events());
        events.push(self.scopes_event());
    }

    /// Makes the machine do what a change of the document needs.
    fn follow(&mut self, change: Change, events: &mut Vec<Event>) {
        match change {
            Change::Parameter { name, value } => {
                // A machine that waits, or does not take the value, is made again with it.
                if self.bench.is_blocked || self.bench.set_parameter(&name, value, &mut self.scopes).is_err()
                {
                    return self.follow(Change::Patch, events);
                }
                self.note_turned(name, value, events);
            }
            Change::Patch => {
                self.use_patch(false);
                events.extend(self.patch_events());
            }
            Change::Panel => events.push(self.patch_event()),
            Change::Mode(mode) => {
                self.bench.set_mode(mode, &mut self.scopes);
                events.push(self.patch_event());
            }
        }
    }

    /// Compiles the present patch for the machine. Without `resets` the machine continues with its states.
    fn use_patch(&mut self, resets: bool) {
        self.compile();
        self.bench.set_patch(self.compiled.as_ref(), resets, &self.probes, &mut self.scopes);
    }

    /// Compiles the present patch.
    fn compile(&mut self) {
        let patch = self.document.patch();
        (self.report, self.compiled) = compile(patch);
        self.probes = Probes(wiring::outputs(patch));
        self.turning = Turning::No;
    }

    /// Selects a mode. Another mode is a step of the history, which is in the view of the patch.
    fn select_mode(&mut self, mode: Mode, events: &mut Vec<Event>) {
        let before = self.bench.controls.mode;
        self.bench.set_mode(mode, &mut self.scopes);
        if before != mode {
            self.document.record_mode(before, mode);
            events.push(self.patch_event());
        }
    }

    /// Sets the length of a sweep.
    ///
    /// # Errors
    /// As for [`check_sweep`].
    fn set_sweep(&mut self, seconds: Option<f64>) -> Result<(), Refusal> {
        check_sweep(seconds, self.document.patch())?;
        self.bench.controls.sweep = seconds;
        self.use_patch(false);
        self.bench.set_mode(self.bench.controls.mode, &mut self.scopes);
        Ok(())
    }

    /// Puts the probes at the first signals of a patch: the first two at scope 1, and as an X-Y curve at scope 2 what the
    /// patch draws so.
    fn connect_usual_probes(&mut self) {
        let usual = view::usual_scopes(self.document.patch());
        for (scope, controls) in self.scopes.iter_mut().zip(usual) {
            *scope = Scope::new();
            // Controls that name outputs of the patch are valid.
            let _ = scope.set_controls(controls);
        }
        self.bench.watch(&self.probes, &self.scopes);
    }

    /// The scope of this number.
    ///
    /// # Errors
    /// If there is none.
    fn scope(&mut self, number: usize) -> Result<&mut Scope, Refusal> {
        let count = self.scopes.len();
        self.scopes
            .get_mut(number)
            .ok_or_else(|| Refusal::new(format!("there are scopes 0 ... {}", count - 1)))
    }

    /// Checks that the patch has an output of this name.
    ///
    /// # Errors
    /// If it does not.
    fn check_output(&self, output: Option<&str>) -> Result<(), Refusal> {
        let Some(output) = output else { return Ok(()) };
        match self.probes.element(output) {
            Some(_) => Ok(()),
            None => Err(Refusal::new(format!("there is no output {output}"))),
        }
    }

    /// The values of all parameters in their declared units.
    fn parameters(&self) -> Vec<(String, f64)> {
        let parameters = self.document.patch().parameters.iter();
        parameters.map(|(name, parameter)| (name.clone(), parameter.value)).collect()
    }

    /// The event about the patch.
    fn patch_event(&self) -> Event {
        let compiled = self.compiled.as_ref();
        let (circuit, program) = compiled.map(|Compiled { circuit, program }| (circuit, &**program)).unzip();
        Event::Patch(Box::new(view::patch_view(&self.document, circuit, program)))
    }

    /// The events about the patch, its faults, and the views that the page shows.
    fn patch_events(&self) -> Vec<Event> {
        let mut events = vec![self.patch_event(), self.findings_event()];
        if self.shows.schematic {
            events.push(self.schematic_event());
        }
        if self.shows.equations {
            events.extend(self.equations_event());
        }
        events
    }

    /// The event about the findings of the checker.
    fn findings_event(&self) -> Event {
        Event::Findings { findings: places::findings(&self.report, self.document.patch()) }
    }

    /// The event with the schematic.
    fn schematic_event(&self) -> Event {
        let Some(compiled) = &self.compiled else {
            let message = Some("the schematic is drawn again when the patch has no faults".to_owned());
            return Event::Schematic { drawing: None, message };
        };
        match Schematic::new(&compiled.circuit, "", "", &|_| None) {
            Ok(schematic) => Event::Schematic { drawing: Some(schematic.to_live_json()), message: None },
            Err(error) => Event::Schematic { drawing: None, message: Some(error.to_string()) },
        }
    }

    /// The event with the equations.
    fn equations_event(&self) -> Option<Event> {
        let compiled = self.compiled.as_ref()?;
        Some(Event::Equations(view::equations(&compiled.circuit, &compiled.program)))
    }

    /// The event with the controls of the scopes.
    fn scopes_event(&self) -> Event {
        Event::Scopes { scopes: self.scopes.iter().map(|scope| scope.controls().clone()).collect() }
    }

    /// The event with the samples of a complete run.
    ///
    /// # Errors
    /// If the patch cannot run, or if the run or its table are too large.
    fn run_event(&self) -> Result<Event, Refusal> {
        let compiled = compile(self.document.patch()).1;
        let compiled = compiled.ok_or_else(faulty)?;
        let mut settings =
            RunSettings::of(&compiled.circuit).map_err(|error| Refusal::new(error.to_string()))?;
        // The command makes these checks. They evaluate further instants, and the last digits of a loop's solution
        // depend on the solution before it.
        (settings.checks_steps, settings.finds_amplifier_peaks) = (true, true);
        limits::check_run(&settings).map_err(Refusal::new)?;
        let trace =
            run(&compiled.program, &settings).map_err(|stopped| Refusal::new(stopped.error.to_string()))?;
        let mut csv = Vec::new();
        trace.write_csv(&mut csv).map_err(|error| Refusal::new(error.to_string()))?;
        if csv.len() > MAX_TABLE_BYTES {
            return Err(Refusal::new(limits::table_too_large()));
        }
        let overloads = trace.overloads().map(|overload| overload.element.clone()).collect();
        let csv = String::from_utf8(csv).map_err(|error| Refusal::new(error.to_string()))?;
        Ok(Event::Table { csv, overloads })
    }

    /// The session as data.
    fn snapshot(&self) -> Value {
        let scopes: Vec<&ScopeControls> = self.scopes.iter().map(Scope::controls).collect();
        json!({
            "protocol": PROTOCOL_VERSION,
            "document": self.document.snapshot(),
            "mode": self.bench.controls.mode,
            "speed": self.bench.controls.speed,
            "sweep": self.bench.controls.sweep,
            "rate": self.bench.controls.rate,
            "scopes": scopes,
            "meter": self.meter,
        })
    }

    /// Replaces the session by one from a snapshot.
    ///
    /// # Errors
    /// If the snapshot is not one of this version, or has a value that is not permitted. Nothing is changed then.
    fn restore(&mut self, snapshot: &Value, events: &mut Vec<Event>) -> Result<(), Refusal> {
        let Saved { document, mode, speed, sweep, rate, scopes, meter } =
            Saved::read(snapshot, &table_access(&self.options))?;
        self.open(document, &mut Vec::new());
        let controls = &mut self.bench.controls;
        (controls.speed, controls.sweep, controls.rate) = (speed, sweep, rate);
        self.scopes = scopes;
        self.use_patch(true);
        self.bench.set_mode(mode, &mut self.scopes);
        self.meter = meter.filter(|output| self.probes.element(output).is_some());
        events.extend(self.hello());
        Ok(())
    }

    /// The state of the machine and of the clock.
    fn machine_state(&mut self) -> MachineState {
        let overloads = self.bench.read(|machine| machine.overloads()).unwrap_or_default();
        let view = |overload: patchcord_core::solve::Overload| OverloadView {
            element: overload.element,
            time: overload.time,
            caused_by: overload.caused_by,
        };
        let (time, oldest, sweep) = (self.bench.clock(), self.bench.oldest(), self.bench.sweep());
        let controls = &self.bench.controls;
        MachineState {
            mode: controls.mode,
            time,
            speed: controls.speed,
            paused: controls.paused,
            sweep,
            rate: controls.rate,
            overloads: overloads.into_iter().map(view).collect(),
            stopped: self.bench.stopped.clone(),
            oldest,
        }
    }

    /// The voltages of all outputs; in pot set those at the wipers with the reference at the top of every pot. A voltage
    /// that the machine does not have is not a number.
    fn voltages(&mut self) -> Vec<f64> {
        let outputs = &self.probes.0;
        if self.bench.controls.mode == Mode::PotSet {
            let circuit = self.compiled.as_ref().map(|compiled| &compiled.circuit);
            let share = |name: &str| view::pot_setting(circuit?, name);
            let volts = outputs.iter().map(|output| POT_SET_VOLTS * share(&output.element).unwrap_or(0.0));
            return volts.collect();
        }
        let read = self.bench.read(|machine| {
            outputs.iter().map(|output| machine.voltage(&output.element).unwrap_or(f64::NAN)).collect()
        });
        read.unwrap_or_else(|| vec![f64::NAN; outputs.len()])
    }

    /// The present frame.
    fn frame(&mut self) -> Vec<u8> {
        let volts = self.voltages();
        let overloads = self.bench.read(|machine| machine.overloads()).unwrap_or_default();
        let outputs = &self.probes.0;
        let is_lit = |element: &str| overloads.iter().any(|overload| overload.element == element);
        let lamps: Vec<bool> = outputs.iter().map(|output| is_lit(&output.element)).collect();
        let first_lamp = overloads
            .first()
            .and_then(|overload| outputs.iter().position(|output| output.element == overload.element));
        let at = |name: &str| outputs.iter().position(|output| output.name == name).map(|index| volts[index]);
        let null = |(name, divider): &(String, f64)| Some(at(name)? - POT_SET_VOLTS * divider);
        let (meter, null_meter) =
            (self.meter.as_deref().and_then(at), self.null_meter.as_ref().and_then(null));
        let header = FrameHeader {
            revision: self.document.revision() as u32,
            time: self.bench.clock(),
            factor: self.bench.factor,
            mode: self.bench.controls.mode as u8,
            moves: self.bench.is_moving(),
            paused: self.bench.controls.paused,
            stopped: self.bench.stopped.is_some(),
            first_lamp,
            repetitions: self.bench.repetitions,
            meter,
            null_meter,
        };
        frame::encode(&header, &volts, &lamps, &mut self.scopes)
    }
}

/// The tables that the host permits.
fn table_access(options: &SessionOptions) -> TableAccess {
    options.folder.clone().map_or(TableAccess::None, TableAccess::Below)
}

/// Reads a request.
///
/// # Errors
/// The message if it is not a request, or above the limits.
fn read_request(text: &str) -> Result<Request, String> {
    if text.len() > MAX_REQUEST_BYTES {
        return Err(format!("the request has more than {} MB", MAX_REQUEST_BYTES / 1_000_000));
    }
    let request: Request =
        serde_json::from_str(text).map_err(|error| format!("the request cannot be read: {error}"))?;
    if request.commands.len() > MAX_COMMANDS {
        return Err(format!("a request has at most {MAX_COMMANDS} commands, got {}", request.commands.len()));
    }
    Ok(request)
}

/// Removes those of the first `known` events that a later one of the same kind replaces, so that an answer has each
/// large event once. Refusals and parameters do not replace each other.
fn drop_replaced(events: &mut Vec<Event>, known: usize) {
    let is_replaceable = |event: &&Event| !matches!(event, Event::Refused { .. } | Event::Parameter { .. });
    let newer: HashSet<Discriminant<Event>> =
        events[known..].iter().filter(is_replaceable).map(discriminant).collect();
    let mut index = 0;
    events.retain(|event| {
        index += 1;
        index > known || !newer.contains(&discriminant(event))
    });
}

/// Whether a client has to know a new state of the machine. Time advances in frames.
fn differs(known: &MachineState, state: &MachineState) -> bool {
    let MachineState { time, oldest, .. } = known;
    *known != MachineState { time: *time, oldest: *oldest, ..state.clone() }
}

/// The answer to a request.
fn answer(id: Option<u64>, events: Vec<Event>, frame: Option<Vec<u8>>) -> Answer {
    let response = Response { id, events, frame: frame.is_some() };
    // All keys are texts and all numbers are finite or null, so this cannot fail.
    let text = serde_json::to_string(&response).unwrap_or_default();
    Answer { text, frame }
}

/// The refusal of a command that needs a patch without faults.
fn faulty() -> Refusal {
    Refusal::new("the patch has faults; correct them first")
}

/// Checks the length of a sweep.
///
/// # Errors
/// If it is out of range, or shorter than the step of the patch.
fn check_sweep(seconds: Option<f64>, patch: &Patch) -> Result<(), Refusal> {
    within("the length of a sweep", seconds, 1e-9, 1e9)?;
    let step = patch.run.step.as_ref().map(|step| step.value);
    match (seconds, step) {
        (Some(seconds), Some(step)) if seconds < step => {
            Err(Refusal::new(format!("a sweep of {seconds} s is shorter than the step of {step} s")))
        }
        _ => Ok(()),
    }
}

/// Checks the speed factor.
///
/// # Errors
/// If it is out of range.
fn check_speed(factor: Option<f64>) -> Result<(), Refusal> {
    within("the speed factor", factor, 1e-6, 1e6)
}

/// Checks the rate of repetitive operation.
///
/// # Errors
/// If it is out of range.
fn check_rate(hertz: Option<f64>) -> Result<(), Refusal> {
    within("the rate", hertz, 0.01, 50.0)
}

/// Checks that a number is in a range, if there is one.
///
/// # Errors
/// If it is not.
fn within(what: &str, number: Option<f64>, least: f64, most: f64) -> Result<(), Refusal> {
    match number {
        Some(number) if !(least..=most).contains(&number) => {
            Err(Refusal::new(format!("{what} must be from {least} to {most}, got {number}")))
        }
        _ => Ok(()),
    }
}
