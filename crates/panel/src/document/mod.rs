//! The patch of a session as a user edits it: text, loose cords and history.
//!
//! [`Document::apply`] carries out one command. Only what a document cannot express is refused: an unknown name, a
//! value outside its range, a second cord in a jack for one. Wrong wiring is allowed, and the checker reports it at the
//! jack. After every edit the text is read again, so that all positions of the patch are positions in its text.
//!
//! `cords`, `elements`, `settings` and `replacement` make the edits, `history` keeps the steps and `snapshot` saves them.

mod cords;
mod elements;
mod history;
mod kinds;
mod replacement;
mod settings;
mod snapshot;

use std::collections::HashMap;
use std::sync::Arc;

use patchcord_core::document::suggestion;
use patchcord_core::machines;
use patchcord_core::patch::{EditError, Patch, PatchEditor, TableAccess};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::command::{Command, CordEnd, Mode};
use crate::event::Place;
use crate::limits;
use cords::CordEnds;
use history::{Direction, History, State, Step, StepKind};

pub use kinds::prefix;

/// The patch, its loose cords and its history.
#[derive(Debug)]
pub struct Document {
    /// The patch. All its positions are positions in its text.
    patch: Patch,
    /// The text of the patch, which steps of the history share.
    text: Arc<str>,
    /// Cords with a loose end.
    loose: Vec<Loose>,
    /// Number of the next loose cord.
    next_loose: u64,
    /// A number that grows with every change of the patch or its loose cords.
    revision: u64,
    /// The steps that can be reverted and repeated.
    history: History,
    /// The jack of each element from which a cord was pulled last.
    pulled: HashMap<String, String>,
}

/// A cord with a loose end.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
pub struct Loose {
    /// Its number.
    pub id: u64,
    /// The end that is plugged in.
    pub end: CordEnd,
    /// Place of the loose end on the panel, in units of the page.
    pub at: [f64; 2],
}

/// What the machine has to do after a change.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// It sets a parameter, without compiling the patch again.
    Parameter {
        /// Name of the parameter.
        name: String,
        /// Its value in the declared unit.
        value: f64,
    },
    /// It compiles the patch again.
    Patch,
    /// Nothing: only loose cords have changed.
    Panel,
    /// It changes to this mode.
    Mode(Mode),
}

/// Why a command has no effect.
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// What is wrong and what to do.
    pub message: String,
    /// The jack, element, setting or parameter that the message is about.
    pub place: Option<Box<Place>>,
}

impl Refusal {
    /// A refusal that is not about a place.
    pub(crate) fn new(message: impl Into<String>) -> Refusal {
        Refusal { message: message.into(), place: None }
    }

    /// A refusal of a name that is not among the known ones, with the nearest of them or a list.
    fn unknown(message: String, name: &str, known: &[&str]) -> Refusal {
        match suggestion(name, known) {
            Some(hint) => Refusal::new(format!("{message}: {hint}")),
            None => Refusal::new(message),
        }
    }

    /// The same refusal at a place.
    pub(crate) fn at(self, place: Place) -> Refusal {
        Refusal { place: Some(Box::new(place)), ..self }
    }
}

impl From<EditError> for Refusal {
    fn from(error: EditError) -> Refusal {
        match error {
            EditError::InvalidDocument(report) => Refusal::new(report.plain()),
            error => Refusal::new(error.to_string()),
        }
    }
}

/// A change that has been checked, before it is carried out.
pub(crate) struct Edited {
    /// The new patch; `None` if it stays.
    patch: Option<Patch>,
    /// The new loose cords; `None` if they stay.
    loose: Option<Vec<Loose>>,
    /// What undo and redo call the change: "turn m".
    label: String,
    /// The kind of the step.
    kind: StepKind,
}

impl Edited {
    /// A change of the patch alone.
    fn patch(patch: Patch, label: String) -> Edited {
        Edited { patch: Some(patch), loose: None, label, kind: StepKind::Patch }
    }
}

/// Length of the run of an empty patch, in problem seconds.
const EMPTY_RUN: u32 = 10;

impl Document {
    /// Reads a patch, with the tables that `table_access` permits. Faults inside the patch are findings of the checker.
    ///
    /// # Errors
    /// If the text is not a patch at all, or above the limits. The message is the printed report.
    pub fn open(name: &str, text: &str, table_access: &TableAccess) -> Result<Document, Refusal> {
        Ok(Document::of(parsed(name, text, table_access)?))
    }

    /// A patch without elements for a machine; without limits if the machine is unknown. It runs 10 s in steps of 1 ms.
    ///
    /// # Panics
    /// Never: the text is a patch.
    pub fn empty(machine: Option<&str>, table_access: &TableAccess) -> Document {
        let machine = machine.and_then(machines::find).unwrap_or(machines::DEFAULT_MACHINE);
        let text = format!(
            "{{\n  \"patchcord\": 1,\n  \"title\": \"Untitled\",\n  \"machine\": \"{}\",\n  \"elements\": {{}},\n  \
             \"run\": {{\"for\": {EMPTY_RUN}, \"step\": 0.001}}\n}}\n",
            machine.name
        );
        let patch = Patch::parse_with(table_access.clone(), "untitled.json", &text);
        Document::of(patch.expect("the text is a patch"))
    }

    /// The document of a patch that has just been read.
    fn of(patch: Patch) -> Document {
        Document {
            text: Arc::from(patch.text()),
            patch,
            loose: Vec::new(),
            next_loose: 1,
            revision: 1,
            history: History::default(),
            pulled: HashMap::new(),
        }
    }

    /// The patch. All its positions are positions in its text.
    pub fn patch(&self) -> &Patch {
        &self.patch
    }

    /// The cords with a loose end.
    pub fn loose(&self) -> &[Loose] {
        &self.loose
    }

    /// The jack of each element from which a cord was pulled last.
    pub fn pulled_jacks(&self) -> &HashMap<String, String> {
        &self.pulled
    }

    /// A number that grows with every change of the patch and of its loose cords.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Carries out a command that edits the patch.
    ///
    /// # Errors
    /// If a document cannot express the result, or if the command is not an edit. The document then stays as it was.
    pub fn apply(&mut self, command: &Command) -> Result<Change, Refusal> {
        let edited = self.edited(command)?;
        Ok(self.commit(edited))
    }

    /// Checks a command and makes its change, which [`Document::commit`] carries out.
    ///
    /// # Errors
    /// As for [`Document::apply`].
    pub(crate) fn edited(&self, command: &Command) -> Result<Edited, Refusal> {
        match command {
            Command::Replace { text } => replacement::replace(self, text),
            Command::Parameter { name, value } => settings::parameter(self, name, *value),
            Command::Setting { element, setting, value } => settings::setting(self, element, setting, value),
            Command::TimeScale { value } => settings::time_scale(self, *value),
            Command::Plug { element, jack, from } => cords::plug(self, CordEnds { element, jack, from }),
            Command::Unplug { element, jack, from } => cords::unplug(self, CordEnds { element, jack, from }),
            Command::MoveCord { element, jack, from, to } => {
                cords::move_cord(self, CordEnds { element, jack, from }, to)
            }
            Command::LooseCord { end, at, replaces } => {
                cords::put_loose(self, end, *at, replaces.as_ref().map(CordEnds::of))
            }
            Command::PlugLoose { id, to } => cords::plug_loose(self, *id, to),
            Command::MoveLoose { id, at } => cords::move_loose(self, *id, *at),
            Command::RemoveLoose { id } => cords::remove_loose(self, *id),
            Command::ClearCords => cords::clear(self),
            Command::AddElement { kind, name } => elements::add(self, kind, name.as_deref()),
            Command::RemoveElement { name } => elements::remove(self, name),
            _ => Err(Refusal::new("this command does not edit the patch")),
        }
    }

    /// Carries out a change and adds it to the history. A change without effect is no step.
    pub(crate) fn commit(&mut self, edited: Edited) -> Change {
        let Edited { patch, loose, label, kind } = edited;
        let before = self.state();
        if let Some(patch) = patch.filter(|patch| *patch.text() != *self.text) {
            self.text = Arc::from(patch.text());
            self.take_patch(patch);
        }
        if let Some(loose) = loose {
            self.next_loose =
                loose.iter().map(|cord| cord.id.saturating_add(1)).fold(self.next_loose, u64::max);
            self.loose = loose;
        }
        let change = self.change(&kind, Direction::Redo);
        if before != self.state() {
            self.revision += 1;
            self.history.push(Step { label, kind, state: before });
        }
        change
    }

    /// Takes another patch, and notes the jacks that it leaves without a cord.
    fn take_patch(&mut self, patch: Patch) {
        cords::note_pulled(&self.patch, &patch, &mut self.pulled);
        self.patch = patch;
    }

    /// Records a change of the mode as a step of the history.
    pub fn record_mode(&mut self, before: Mode, after: Mode) {
        if before != after {
            let label = format!("change to {}", mode_name(after));
            self.history.push(Step { label, kind: StepKind::Mode { before, after }, state: self.state() });
        }
    }

    /// Reverts the last step.
    ///
    /// # Errors
    /// If there is none.
    pub fn undo(&mut self) -> Result<Change, Refusal> {
        self.travel(Direction::Undo)
    }

    /// Repeats the step that was reverted last.
    ///
    /// # Errors
    /// If there is none.
    pub fn redo(&mut self) -> Result<Change, Refusal> {
        self.travel(Direction::Redo)
    }

    /// Moves by one step of the history.
    fn travel(&mut self, direction: Direction) -> Result<Change, Refusal> {
        let step = self.history.next(direction).cloned();
        let step = step.ok_or_else(|| Refusal::new(format!("there is nothing to {}", direction.verb())))?;
        let before = self.state();
        if step.state.text != self.text {
            self.take_patch(parsed(self.patch.file(), &step.state.text, self.patch.table_access())?);
        }
        (self.text, self.loose) = (step.state.text, step.state.loose);
        if before != self.state() {
            self.revision += 1;
        }
        self.history.pass(direction, before);
        Ok(self.change(&step.kind, direction))
    }

    /// What undo reverts: "turn m". `None` if there is nothing.
    pub fn undo_label(&self) -> Option<&str> {
        self.history.next(Direction::Undo).map(|step| step.label.as_str())
    }

    /// What redo repeats. `None` if there is nothing.
    pub fn redo_label(&self) -> Option<&str> {
        self.history.next(Direction::Redo).map(|step| step.label.as_str())
    }

    /// The document as data, with its history.
    pub fn snapshot(&self) -> Value {
        snapshot::save(self)
    }

    /// The document of a snapshot, with the tables that `table_access` permits.
    ///
    /// # Errors
    /// If the data are not a snapshot, or its text is not a patch.
    pub fn restore(snapshot: &Value, table_access: &TableAccess) -> Result<Document, Refusal> {
        snapshot::restore(snapshot, table_access)
    }

    /// The present state for the history.
    fn state(&self) -> State {
        State { text: Arc::clone(&self.text), loose: self.loose.clone() }
    }

    /// What the machine has to do after a step of this kind, which has been carried out in this direction.
    fn change(&self, kind: &StepKind, direction: Direction) -> Change {
        match kind {
            StepKind::Parameter(name) => match self.patch.parameters.get(name) {
                Some(parameter) => Change::Parameter { name: name.clone(), value: parameter.value },
                None => Change::Patch,
            },
            StepKind::Setting { .. } | StepKind::Patch => Change::Patch,
            StepKind::Panel => Change::Panel,
            StepKind::Mode { before, after } => Change::Mode(match direction {
                Direction::Undo => *before,
                Direction::Redo => *after,
            }),
        }
    }

    /// The patch with the edits of an editor, read again from its text.
    fn reread(&self, editor: PatchEditor) -> Result<Patch, Refusal> {
        let file = self.patch.file();
        parsed(file, editor.finish(file)?.text(), self.patch.table_access())
    }
}

/// Reads a patch from a text.
///
/// # Errors
/// If it is not a patch, or above the limits.
fn parsed(file: &str, text: &str, table_access: &TableAccess) -> Result<Patch, Refusal> {
    limits::check_text(text).map_err(Refusal::new)?;
    let patch = Patch::parse_with(table_access.clone(), file, text);
    let patch = patch.map_err(|report| Refusal::new(report.plain()))?;
    limits::check_patch(&patch).map_err(Refusal::new)?;
    Ok(patch)
}

/// The name of a mode in words: "pot set".
fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::PotSet => "pot set",
        Mode::ProblemCheck => "problem check",
        Mode::InitialCondition => "initial condition",
        Mode::Operate => "operate",
        Mode::Hold => "hold",
        Mode::Repetitive => "repetitive operation",
        Mode::Single => "a single sweep",
    }
}

#[cfg(test)]
mod tests;
