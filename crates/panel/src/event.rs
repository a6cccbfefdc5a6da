//! The events of a session: what a client has to show after a command.
//!
//! A [`Response`] is JSON. Voltages and traces change too often for JSON; they are in frames (`frame`).

mod machine;

use serde::Serialize;
use serde_json::Value;

use crate::command::CordEnd;
use crate::scope::ScopeControls;
pub use machine::{MachineState, NullMeter, OverloadView};

/// The events of a request, in order.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Response {
    /// The number of the request; absent if the request could not be read.
    pub id: Option<u64>,
    /// The events.
    pub events: Vec<Event>,
    /// Whether a frame follows.
    pub frame: bool,
}

/// What has changed, or the answer to a question.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The first event of a session.
    Hello {
        /// The version of the protocol.
        protocol: u32,
        /// The kinds of elements that can be added, in the order of the registry.
        kinds: Vec<KindView>,
        /// The machines.
        machines: Vec<MachineView>,
    },
    /// The patch has changed. Everything about it is here.
    Patch(Box<PatchView>),
    /// A parameter has another value. The event `patch` with everything that follows from it comes later, when no
    /// parameter is turned.
    Parameter {
        /// Its name.
        name: String,
        /// Its value in the declared unit.
        value: f64,
    },
    /// The findings of the checker about the present patch; empty if there is nothing to report.
    Findings {
        /// The findings, in the order of the text.
        findings: Vec<Finding>,
    },
    /// The mode or the clock has changed otherwise than by a frame.
    Machine(MachineState),
    /// The controls of the scopes have changed.
    Scopes {
        /// The controls of both scopes.
        scopes: Vec<ScopeControls>,
    },
    /// The schematic, as `Schematic::to_live_json` has it.
    Schematic {
        /// The drawing; absent if the patch cannot be drawn.
        drawing: Option<Value>,
        /// Why it cannot be drawn.
        message: Option<String>,
    },
    /// The equations that the wiring solves.
    Equations(EquationsView),
    /// The text of the patch.
    Text {
        /// Name of the file.
        name: String,
        /// The document.
        text: String,
    },
    /// The session as data.
    Snapshot {
        /// The content for the command `restore`.
        snapshot: Value,
    },
    /// Every output and derivative compared with the equations.
    StaticCheck {
        /// Whether the patch states equations. Without them there is nothing to compare with.
        compared: bool,
        /// The rows, in the order of the signal flow.
        rows: Vec<CheckRow>,
    },
    /// The samples of a complete run, as `patchcord run --csv` writes them.
    Table {
        /// The text of the CSV file.
        csv: String,
        /// Overloaded amplifiers, in the order in which their lamps lit.
        overloads: Vec<String>,
    },
    /// A command was refused.
    Refused {
        /// What is wrong and what to do.
        message: String,
        /// The jack, element or cord that the message is about.
        place: Option<Place>,
    },
}

/// The patch as the page shows it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PatchView {
    /// A number that grows with every change.
    pub revision: u64,
    /// Name of the file.
    pub file: String,
    /// Its title.
    pub title: String,
    /// Its source.
    pub source: String,
    /// Its note.
    pub note: String,
    /// Name of its machine.
    pub machine: String,
    /// Machine seconds per problem second.
    pub time_scale: f64,
    /// Length of its run in problem seconds; absent if the patch does not give it.
    pub duration: Option<f64>,
    /// Step of the solver in problem seconds; absent if it adapts.
    pub step: Option<f64>,
    /// Its parameters.
    pub parameters: Vec<ParameterView>,
    /// Drives, elements and macro instances, in the order of the document.
    pub elements: Vec<ElementView>,
    /// The names of all outputs, in the order of the voltages of a frame: references, drives, elements.
    pub outputs: Vec<OutputView>,
    /// The signals.
    pub signals: Vec<SignalView>,
    /// Cords with a loose end.
    pub loose: Vec<LooseView>,
    /// Parts of the machine in use and available.
    pub parts: Vec<PartView>,
    /// What undo reverts; absent if there is nothing.
    pub undo: Option<String>,
    /// What redo repeats; absent if there is nothing.
    pub redo: Option<String>,
    /// Whether the machine can run. It also runs with open inputs, which are at 0 V.
    pub runs: bool,
}

/// A parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterView {
    /// Its name.
    pub name: String,
    /// Its value in `unit`.
    pub value: f64,
    /// Its unit.
    pub unit: String,
    /// Least and largest value, in `unit`; absent if every value is permitted.
    pub range: Option<[f64; 2]>,
    /// Its description.
    pub description: String,
}

/// An element, a drive or a macro instance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ElementView {
    /// Its name.
    pub name: String,
    /// Its kind, or the name of the macro.
    pub kind: String,
    /// "element", "drive" or "instance".
    pub family: &'static str,
    /// Its note.
    pub note: String,
    /// Its input jacks with their cords, in the order of the kind. Summing inputs have one entry for each gain in use
    /// and for each gain of the machine.
    pub jacks: Vec<JackView>,
    /// The names of its outputs. Only an instance may have several.
    pub outputs: Vec<String>,
    /// Its settings.
    pub settings: Vec<SettingView>,
    /// Whether it has an overload lamp.
    pub lamp: bool,
    /// The keys of the machine's parts that it uses, each with the names of the parts.
    pub parts: Vec<(String, Vec<String>)>,
}

/// An input jack.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JackView {
    /// Its name, as a cord of a document has it: "x10", "in".
    pub name: String,
    /// Its label at the panel: "10", "in", "+VB".
    pub label: String,
    /// Its purpose.
    pub description: String,
    /// Whether something must be plugged in.
    pub required: bool,
    /// How many cords it takes; absent if any number.
    pub most: Option<usize>,
    /// The outputs that are plugged in, one for each cord.
    pub cords: Vec<String>,
}

/// A setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SettingView {
    /// Its name: "setting", "limit.upper".
    pub name: String,
    /// Its effect.
    pub description: String,
    /// Its unit in words.
    pub unit: String,
    /// "number", "flag", "choice" or "points".
    pub form: &'static str,
    /// Its value as a number; for a flag 0 or 1, for a choice the index of the word. Absent if it has none or if the
    /// patch cannot be evaluated.
    pub value: Option<f64>,
    /// The text in the document: a number, a formula, a word; absent if the document omits it.
    pub text: Option<String>,
    /// Least and largest value.
    pub range: Option<[f64; 2]>,
    /// The words of a choice.
    pub words: Vec<String>,
    /// The parameters on which it depends.
    pub parameters: Vec<String>,
}

/// An output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputView {
    /// Its name: "A1", "+100", "L1.out".
    pub name: String,
    /// The quantity that the voltage stands for, if a signal or a drive gives it.
    pub signal: Option<String>,
    /// Unit of the quantity; "V" without a signal.
    pub unit: String,
    /// Value of one volt in the unit.
    pub per_volt: f64,
}

/// A signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SignalView {
    /// Its name.
    pub name: String,
    /// Name of the output.
    pub at: String,
    /// Its unit.
    pub unit: String,
    /// Value of one volt in the unit.
    pub per_volt: f64,
}

/// A cord with a loose end.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LooseView {
    /// Its number.
    pub id: u64,
    /// The end that is plugged in.
    pub end: CordEnd,
    /// Place of the loose end.
    pub at: [f64; 2],
}

/// A kind of part of the machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartView {
    /// Its key: "summers".
    pub key: String,
    /// How many the patch uses.
    pub used: usize,
    /// How many the machine has; absent if any number.
    pub available: Option<usize>,
}

/// A kind of element.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KindView {
    /// Its name.
    pub name: String,
    /// A description in one line.
    pub summary: String,
    /// Its law.
    pub law: String,
    /// The keys of the parts that it needs.
    pub parts: Vec<String>,
    /// The usual first letters of the names of such elements: "A" for integrators.
    pub prefix: String,
}

/// A machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MachineView {
    /// Its name.
    pub name: String,
    /// A description in one line.
    pub title: String,
    /// Its parts with their number; absent if any number.
    pub parts: Option<Vec<(String, usize)>>,
    /// Gains of summing inputs; empty if every gain is permitted.
    pub summer_gains: Vec<f64>,
    /// Gains of integrating inputs; empty if every gain is permitted.
    pub integrator_gains: Vec<f64>,
}

/// A finding of the checker.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// The code, such as "no-driver".
    pub code: String,
    /// "error" or "warning".
    pub severity: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub hint: String,
    /// Where at the panel; absent if it is about the whole patch.
    pub place: Option<Place>,
    /// Line in the text, from 1.
    pub line: Option<usize>,
    /// Column in the text, from 1.
    pub column: Option<usize>,
}

/// A place at the panel. Absent fields are not part of it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct Place {
    /// Name of the element, drive or instance.
    pub element: Option<String>,
    /// Name of its jack.
    pub jack: Option<String>,
    /// Name of the output of the cord in this jack.
    pub from: Option<String>,
    /// Name of the setting.
    pub setting: Option<String>,
    /// Name of the parameter.
    pub parameter: Option<String>,
}

/// A row of a static check: the output of an element, or the derivative of an integrator or a lag.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckRow {
    /// Name of the element.
    pub element: String,
    /// Its kind.
    pub kind: String,
    /// 0 for an output in volts, 1 for a derivative in volts per machine second.
    pub order: usize,
    /// The quantity with its unit, such as "x' in mm/s"; absent if there is no signal.
    pub quantity: Option<String>,
    /// The expected value in volts, or volts per machine second; absent if there is none.
    pub expected: Option<f64>,
    /// The value in the wiring.
    pub wired: f64,
    /// Whether the two differ.
    pub differs: bool,
    /// Why they are not compared; absent if they are, or if there is no expected value.
    pub not_compared: Option<String>,
    /// Whether the output demands more than 100 V.
    pub overloaded: bool,
}

/// The equations that the wiring solves.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct EquationsView {
    /// One entry for each equation, with the names that occur in it.
    pub equations: Vec<EquationView>,
    /// The equations that the patch states.
    pub stated: Vec<String>,
    /// Values at the start, drives, modes, tables and remarks, as text.
    pub more: String,
    /// The equations in LaTeX.
    pub latex: String,
    /// Why there are none; absent if there are.
    pub message: Option<String>,
}

/// An equation in plain text.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct EquationView {
    /// The text.
    pub text: String,
    /// The quantities in it that are signals, drives, elements or parameters.
    pub names: Vec<String>,
}
