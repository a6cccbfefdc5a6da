//! The events of a comparison: what a client has to show after a command.

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

/// The events of a request, in order.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Response {
    /// The number of the request; absent if the request could not be read.
    pub id: Option<u64>,
    /// The events.
    pub events: Vec<Event>,
    /// Whether a frame follows, as in the responses of a panel. It never does.
    pub frame: bool,
    /// Whether more responses to the same request follow. A final response does not have this key.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub partial: bool,
}

/// What has changed, or the answer to a question.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The data were read. A user can select columns.
    Columns(ColumnsView),
    /// The experiment was read, and the patch is compared with the data.
    Comparison {
        /// Warnings about the experiment and its data, a text each.
        warnings: Vec<String>,
        /// The text of the experiment file. With it, with the patch and with the data, `patchcord gap` gives the same
        /// result.
        experiment: String,
    },
    /// Measured and simulated outputs.
    Curves {
        /// The outputs, in the order of the experiment.
        outputs: Vec<OutputCurves>,
        /// The amplifier that is overloaded first, and what to do; absent if there is none. The curves are those of the
        /// overloaded machine.
        overload: Option<String>,
    },
    /// The parameters were fitted.
    Fitted {
        /// The fitted values by name, in declared units.
        parameters: BTreeMap<String, f64>,
    },
    /// The search continues. Only partial responses have it.
    Progress(ProgressView),
    /// The search is complete.
    Found(Box<FoundView>),
    /// A command was refused.
    Refused {
        /// What is wrong and what to do, a line for each fault.
        message: String,
    },
}

/// What a user can select.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnsView {
    /// The name of the data file.
    pub file: String,
    /// The number of its rows.
    pub rows: usize,
    /// Its columns, in its order.
    pub columns: Vec<ColumnView>,
    /// The signals of the patch.
    pub signals: Vec<SignalView>,
    /// The drives of the patch.
    pub drives: Vec<SignalView>,
    /// The parameters that have a range.
    pub parameters: Vec<ParameterView>,
    /// The suggested experiment as a document, without the keys "patch" and "data".
    pub experiment: Map<String, Value>,
    /// What the suggestion lacks, and what to do, a text each.
    pub notes: Vec<String>,
}

/// A column of the data.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ColumnView {
    /// Its name.
    pub name: String,
    /// Its unit in the file; absent if the file does not give it.
    pub unit: Option<String>,
    /// Its least value.
    pub least: f64,
    /// Its largest value.
    pub most: f64,
}

/// A signal or a drive of the patch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SignalView {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
}

/// A parameter of the patch.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterView {
    /// Its name.
    pub name: String,
    /// The unit of its value and its range.
    pub unit: String,
    /// Its value.
    pub value: f64,
    /// The least permitted value.
    pub low: f64,
    /// The largest permitted value.
    pub high: f64,
}

/// The curves of an output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputCurves {
    /// The name of the signal.
    pub signal: String,
    /// The unit of all its values.
    pub unit: String,
    /// The training records, then the validation records.
    pub records: Vec<RecordCurves>,
    /// Root mean square of the residual over all records; absent if there is no datum.
    pub rms: Option<f64>,
    /// Standard deviation of the noise; absent if it is not known.
    pub noise: Option<f64>,
    /// The mean difference that was subtracted from the residual, because the sensor has an unknown offset; absent if
    /// it has none.
    pub offset: Option<f64>,
}

/// The curves of an output in a record. All lists have the same length. A missing sample is not a number, which is null
/// in JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RecordCurves {
    /// The name of the record: its file.
    pub name: String,
    /// Whether the record is for validation.
    pub test: bool,
    /// The times in seconds, by the clock of the file.
    pub time: Vec<f64>,
    /// The data.
    pub measured: Vec<f64>,
    /// What the patch does.
    pub simulated: Vec<f64>,
    /// The data minus the simulation and minus the offset.
    pub residual: Vec<f64>,
}

/// How far a search is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProgressView {
    /// The number of the effect that is searched for, from 1; 0 outside rounds.
    pub round: usize,
    /// The phase in words.
    pub phase: String,
    /// The number of completed trials of this phase.
    pub done: u64,
    /// The number of trials of this phase; 0 if the phase does not count trials.
    pub total: u64,
    /// The effects that are in the patch now.
    pub added: Vec<String>,
    /// The best effect of this round so far; absent before the first trial.
    pub best: Option<String>,
    /// The candidates that were rejected since the last event.
    pub rejected: Vec<RejectedView>,
}

/// A candidate that was rejected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RejectedView {
    /// The effect at its site.
    pub effect: String,
    /// Root mean square of its residual in units of the noise; absent if the patch with it cannot be run or fitted.
    pub rms: Option<f64>,
}

/// The outcome of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FoundView {
    /// The verdict as a word: "named", "ambiguous", "nothing-missing", "unknown-effect" or "cannot-judge".
    pub verdict: &'static str,
    /// The verdict as a sentence without a full stop.
    pub sentence: String,
    /// Doubts about the result, a sentence each.
    pub doubts: Vec<String>,
    /// Root mean square of the training residual in units of the noise, of the fitted patch as it is.
    pub before: f64,
    /// The same of the reported model.
    pub after: f64,
    /// The fitted parameters of the reported model.
    pub parameters: Vec<FittedParameter>,
    /// The patch with what is missing; absent if nothing was found.
    pub patch: Option<FoundPatch>,
    /// The text of the original patch with fitted values.
    pub fitted: String,
    /// The report as an HTML page.
    pub report: String,
}

/// A fitted parameter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The lower end of its 95 % interval; infinite, which is null in JSON, if the data do not limit it.
    pub low: f64,
    /// The upper end of its 95 % interval, likewise.
    pub high: f64,
    /// Its unit.
    pub unit: String,
    /// What it belongs to: an effect at its site, or "the patch".
    pub of: String,
}

/// A patch with new elements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FoundPatch {
    /// Its text.
    pub text: String,
    /// The names of the elements and drives that the original patch does not have.
    pub elements: Vec<String>,
}
