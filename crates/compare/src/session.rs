//! A comparison: one user with a patch and a file of measured data. It carries out requests.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use patchcord_core::circuit::Circuit;
use patchcord_core::document::{parameter_in_si, read_request};
use patchcord_core::patch::{Patch, TableAccess};
use patchcord_ident::report::reasons::no_run_sentence;
use patchcord_ident::{Experiment, Library, Problem, SearchSettings, fit_base};
use serde_json::{Map, Value};

use crate::columns::columns_event;
use crate::command::{Command, NamedText};
use crate::curves::curves;
use crate::event::{Event, Response};
use crate::experiment::{base_name, experiment_text, read_experiment};
use crate::found::found;
use crate::limits::{MAX_COMMANDS, MAX_REQUEST_BYTES, check_data, check_patch, check_patch_text};
use crate::message::{experiment_texts, model_message, patch_message};
use crate::searching::run_search;
use crate::whole_runs::WholeRuns;

/// Seed of the random starts of fits, unless the client gives one.
const SEED: u64 = 1;

/// The settings of a comparison that a host chooses.
#[derive(Debug, Clone, Default)]
pub struct ComparisonOptions {
    /// The folder below which tables of patches are read, and to which their paths are relative. Without it, no files are
    /// read.
    pub folder: Option<PathBuf>,
    /// Number of threads of a search; that of the cores if absent.
    pub threads: Option<usize>,
    /// If it is true, a fit or a search ends soon, and the next one does not begin. The host sets it when its client
    /// closes the connection.
    pub cancel: Arc<AtomicBool>,
}

/// A comparison of a patch with measured data: a state machine without a clock of its own.
///
/// # Examples
///
/// ```
/// use patchcord_compare::{Comparison, ComparisonOptions};
///
/// let mut comparison = Comparison::new(ComparisonOptions::default());
/// let response = comparison.request(r#"{"id": 1, "commands": [{"command": "fit"}]}"#, &mut |_| ());
/// assert!(response.contains(r#""event":"refused""#));
/// ```
#[derive(Debug)]
pub struct Comparison {
    /// The settings of the host.
    options: ComparisonOptions,
    /// The patch; None if there is none yet, or if the present one has faults.
    patch: Option<Patch>,
    /// The data; None if there are none yet.
    data: Option<NamedText>,
    /// The values of the parameters that were set since the patch was read.
    values: BTreeMap<String, f64>,
    /// The last experiment that was accepted, as a document without the keys "patch" and "data".
    document: Option<Map<String, Value>>,
    /// The experiment that is compared; None if there is none, or if the patch was replaced by one that it does not suit.
    compared: Option<Compared>,
}

/// An experiment that is ready to be simulated.
#[derive(Debug)]
struct Compared {
    /// The experiment.
    experiment: Experiment,
    /// The noise of its data, and the steps of the solver.
    problem: Problem,
    /// The patch, compiled for the records.
    runs: WholeRuns,
}

impl Comparison {
    /// A comparison without a patch and without data.
    pub fn new(options: ComparisonOptions) -> Self {
        let (patch, data, document, compared) = (None, None, None, None);
        Comparison { options, patch, data, values: BTreeMap::new(), document, compared }
    }

    /// Carries out a request, which is a [`Request`](crate::command::Request) as JSON. `report` takes partial responses
    /// while a search runs. The final [`Response`] is returned. Both are JSON.
    pub fn request(&mut self, text: &str, report: &mut (dyn FnMut(&str) + Send)) -> String {
        let request = match read_request::<Command>(text, MAX_REQUEST_BYTES, MAX_COMMANDS) {
            Ok(request) => request,
            Err(message) => return response(None, vec![Event::Refused { message }], false),
        };
        let id = Some(request.id);
        let mut partial = |event: Event| report(&response(id, vec![event], true));
        let mut events = Vec::new();
        for command in request.commands {
            if let Err(message) = self.carry_out(command, &mut partial, &mut events) {
                events.push(Event::Refused { message });
            }
        }
        response(id, events, false)
    }

    /// Carries out one command and adds its events. `partial` takes those that cannot wait.
    ///
    /// # Errors
    /// The message if the command is refused.
    fn carry_out(
        &mut self,
        command: Command,
        partial: &mut (dyn FnMut(Event) + Send),
        events: &mut Vec<Event>,
    ) -> Result<(), String> {
        match command {
            Command::Begin { patch, data } => events.push(self.begin(&patch, data)?),
            Command::Patch { name, text } => self.replace_patch(&NamedText { name, text }, events)?,
            Command::Compare { experiment } => self.compare(experiment, events)?,
            Command::Simulate { parameters } => events.push(self.simulate(parameters)?),
            Command::Fit => self.fit(events)?,
            Command::Search { seed } => events.push(self.search(seed.unwrap_or(SEED), partial)?),
        }
        Ok(())
    }

    /// Begins a comparison.
    ///
    /// # Errors
    /// The message if the patch or the data have faults. Nothing is changed then.
    fn begin(&mut self, patch: &NamedText, data: NamedText) -> Result<Event, String> {
        check_data(&data)?;
        let patch = self.read_patch(patch)?;
        let data = NamedText { name: base_name(&data.name).to_owned(), text: data.text };
        let event = columns_event(&patch, &data)?;
        (self.patch, self.data) = (Some(patch), Some(data));
        (self.document, self.compared) = (None, None);
        self.values.clear();
        Ok(event)
    }

    /// Replaces the patch, and compares it if an experiment was accepted before.
    ///
    /// # Errors
    /// The message if there are no data, the patch has faults, or the experiment does not suit it. Nothing is compared
    /// then, because the result would not be that of the present patch.
    fn replace_patch(&mut self, patch: &NamedText, events: &mut Vec<Event>) -> Result<(), String> {
        let data = self.data.as_ref().ok_or_else(no_data)?;
        (self.patch, self.compared) = (None, None);
        self.values.clear();
        let patch = self.read_patch(patch)?;
        match self.document.clone() {
            None => {
                events.push(columns_event(&patch, data)?);
                self.patch = Some(patch);
                Ok(())
            }
            Some(document) => {
                self.patch = Some(patch);
                self.compare(document, events)
            }
        }
    }

    /// Reads a patch without faults.
    ///
    /// # Errors
    /// The message if the patch has faults or is too large.
    fn read_patch(&self, patch: &NamedText) -> Result<Patch, String> {
        check_patch_text(patch)?;
        let access = self.options.folder.clone().map_or(TableAccess::None, TableAccess::Below);
        let patch = Patch::parse_with(access, &patch.name, &patch.text);
        let patch = patch.map_err(|report| patch_message(&report))?;
        check_patch(&patch)?;
        Circuit::new(&patch).map_err(|report| patch_message(&report))?;
        Ok(patch)
    }

    /// Compares the patch with the data according to an experiment.
    ///
    /// # Errors
    /// The message if the experiment has faults, or if the patch cannot be run. An earlier comparison continues then. If
    /// only a run stops, the experiment is accepted, because other values can correct the run.
    fn compare(&mut self, document: Map<String, Value>, events: &mut Vec<Event>) -> Result<(), String> {
        let (patch, data) = self.files()?;
        let text = experiment_text(&document, patch, data)?;
        let experiment = read_experiment(patch, data, &text)?;
        let warnings = experiment_texts(&experiment.warnings);
        let compared = Compared::new(experiment)?;
        let outcome = compared.curves_event(&self.values);
        (self.document, self.compared) = (Some(document), Some(compared));
        events.push(Event::Comparison { warnings, experiment: text });
        events.push(outcome?);
        Ok(())
    }

    /// Sets parameters and simulates.
    ///
    /// # Errors
    /// The message if a parameter is unknown or out of range, which changes nothing, or if the run stops. The values stay
    /// in this case, because the knobs of the client have them.
    fn simulate(&mut self, parameters: BTreeMap<String, f64>) -> Result<Event, String> {
        let compared = self.compared()?;
        for (name, value) in &parameters {
            check_parameter(&compared.experiment.patch, name, *value)?;
        }
        self.values.extend(parameters);
        self.compared()?.curves_event(&self.values)
    }

    /// Fits the parameters of the experiment from their present values.
    ///
    /// # Errors
    /// The message if there is nothing to fit, if the patch cannot be run, or if the fit is cancelled. The values stay
    /// then.
    fn fit(&mut self, events: &mut Vec<Event>) -> Result<(), String> {
        let (experiment, problem) = self.at_present_values()?;
        if experiment.fit.is_empty() {
            return Err("no parameter is selected: select the parameters to fit".to_owned());
        }
        let fitted = fit_base(&problem, &experiment.patch, &experiment.fit, SEED);
        let fitted = fitted.map_err(|error| model_message(&error))?;
        let fitted = fitted.ok_or_else(|| no_run_sentence(experiment.patch.file()))?;
        let values = &fitted.train.estimate.parameters;
        let parameters: BTreeMap<String, f64> =
            experiment.fit.iter().cloned().zip(values.iter().copied()).collect();
        self.values.extend(parameters.clone());
        events.push(Event::Fitted { parameters });
        events.push(self.compared()?.curves_event(&self.values)?);
        Ok(())
    }

    /// Searches for missing effects, from the present values of the parameters.
    ///
    /// # Errors
    /// The message if the patch cannot be run, or if the search is cancelled.
    fn search(&self, seed: u64, partial: &mut (dyn FnMut(Event) + Send)) -> Result<Event, String> {
        let (experiment, problem) = self.at_present_values()?;
        let library = Library::shipped();
        let settings = SearchSettings::new(&library).with_seed(seed);
        let settings = self.options.threads.map_or(settings, |threads| settings.with_threads(threads));
        let outcome = run_search(&experiment, &problem, &settings, partial);
        let outcome = outcome.map_err(|error| model_message(&error))?;
        let outcome = outcome.ok_or_else(|| no_run_sentence(experiment.patch.file()))?;
        Ok(Event::Found(Box::new(found(&experiment, &problem, &outcome, &library)?)))
    }

    /// The patch and the data.
    ///
    /// # Errors
    /// The message if one is missing.
    fn files(&self) -> Result<(&Patch, &NamedText), String> {
        let data = self.data.as_ref().ok_or_else(no_data)?;
        let patch = self.patch.as_ref().ok_or("the patch has faults: correct them first")?;
        Ok((patch, data))
    }

    /// What is compared.
    ///
    /// # Errors
    /// The message if nothing is.
    fn compared(&self) -> Result<&Compared, String> {
        self.files()?;
        self.compared.as_ref().ok_or_else(|| "nothing is compared yet: select the columns first".to_owned())
    }

    /// The experiment with the present values of the parameters in its patch, as if the user had saved both, and its
    /// problem, whose fits the host can cancel.
    ///
    /// # Errors
    /// The message if nothing is compared, or if the experiment has faults with these values.
    fn at_present_values(&self) -> Result<(Experiment, Problem), String> {
        let original = &self.compared()?.experiment;
        let (_, data) = self.files()?;
        let mut editor = original.patch.edit();
        for (name, value) in &self.values {
            editor.set_parameter(name, *value).map_err(|error| error.to_string())?;
        }
        let patch = editor.finish(original.patch.file()).map_err(|error| error.to_string())?;
        let document = self.document.clone().unwrap_or_default();
        let experiment = read_experiment(&patch, data, &experiment_text(&document, &patch, data)?)?;
        let problem = Problem::of(&experiment).map_err(|error| model_message(&error))?;
        Ok((experiment, problem.with_cancel(&self.options.cancel)))
    }
}

impl Compared {
    /// Prepares an experiment.
    ///
    /// # Errors
    /// The message if its patch cannot be run along the records.
    fn new(experiment: Experiment) -> Result<Compared, String> {
        let problem = Problem::of(&experiment).map_err(|error| model_message(&error))?;
        let runs = WholeRuns::new(&experiment, &problem).map_err(|error| model_message(&error))?;
        Ok(Compared { experiment, problem, runs })
    }

    /// The event with the curves of the patch with these values of parameters.
    ///
    /// # Errors
    /// The message if a run fails.
    fn curves_event(&self, values: &BTreeMap<String, f64>) -> Result<Event, String> {
        let values: Vec<(String, f64)> = values.iter().map(|(name, value)| (name.clone(), *value)).collect();
        let (simulated, overload) = self.runs.simulate(&values)?;
        Ok(Event::Curves { outputs: curves(&self.experiment, &self.problem, &simulated), overload })
    }
}

/// The text of a response.
fn response(id: Option<u64>, events: Vec<Event>, partial: bool) -> String {
    let response = Response { id, events, frame: false, partial };
    // All keys are texts and all numbers are finite or null, so this cannot fail.
    serde_json::to_string(&response).unwrap_or_default()
}

/// The refusal of a command that needs data.
fn no_data() -> String {
    "there are no measured data: open a data file first".to_owned()
}

/// Checks the value of a parameter.
///
/// # Errors
/// The message if the patch has no such parameter, or if the value is outside its range.
fn check_parameter(patch: &Patch, name: &str, value: f64) -> Result<(), String> {
    let parameter = patch.parameters.get(name).ok_or_else(|| format!("the patch has no parameter {name}"))?;
    let unit = (parameter.unit.text(), parameter.unit.factor());
    parameter_in_si(name, value, unit, parameter.range).map(|_| ()).map_err(|error| error.to_string())
}
