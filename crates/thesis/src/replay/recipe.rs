//! Runs of the shipped circuits with changed settings.
//!
//! A [`Recipe`] is the name of a shipped circuit with a list of edits. It becomes a patch, a circuit, a run, or a
//! sweep of runs. The patch is complete, so a reader can repeat the run with it.
//!
//! The order of the edits matters where they touch the same value: a later one replaces an earlier one. Errors appear
//! when the patch is made, not when an edit is added.

use std::collections::HashMap;
use std::sync::LazyLock;

use serde_json::Value;

use super::run_record::{ReplayedRun, RunRecord};
use super::series;
use crate::slideway::scaling::Scales;
use patchcord_analysis::instruments::parameter_line;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::json_value;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, ElementBuilder, Patch, PictureEntry};
use patchcord_core::solve::{self, RunSettings};

/// Any error that prevents a figure or a check from being computed.
pub(super) type BoxError = Box<dyn std::error::Error + Send + Sync>;

/// The shipped circuits that figures and checks start from: name and patch.
const CIRCUITS: &[(&str, &str)] = &[
    ("nakashima", include_str!("../../../../patches/others/nakashima.json")),
    ("singh", include_str!("../../../../patches/others/singh.json")),
    ("fig-4-07", include_str!("../../../../patches/thesis/fig-4-07.json")),
    ("fig-8-04", include_str!("../../../../patches/thesis/fig-8-04.json")),
    ("fig-8-05", include_str!("../../../../patches/thesis/fig-8-05.json")),
    ("fig-8-06", include_str!("../../../../patches/thesis/fig-8-06.json")),
    ("fig-8-07", include_str!("../../../../patches/thesis/fig-8-07.json")),
    ("fig-8-09", include_str!("../../../../patches/thesis/fig-8-09.json")),
    ("fig-8-11", include_str!("../../../../patches/thesis/fig-8-11.json")),
    ("fig-8-14", include_str!("../../../../patches/thesis/fig-8-14.json")),
    ("fig-8-15", include_str!("../../../../patches/thesis/fig-8-15.json")),
    ("fig-8-16", include_str!("../../../../patches/thesis/fig-8-16.json")),
    ("fig-8-16-lag-last", include_str!("../../../../patches/thesis/fig-8-16-lag-last.json")),
    ("fig-8-17", include_str!("../../../../patches/thesis/fig-8-17.json")),
];

/// The shipped circuits as patches, by name. Each is read once.
static PATCHES: LazyLock<HashMap<&str, Patch>> = LazyLock::new(|| {
    let read = |(name, text): &(&'static str, &str)| {
        (*name, Patch::parse(name, text).expect("a shipped circuit is a valid document"))
    };
    CIRCUITS.iter().map(read).collect()
});

/// The element that integrates the position error, by circuit. Disturbances and noise are added at its input. Only
/// these circuits accept them.
const POSITION_INTEGRATORS: [(&str, &str); 4] =
    [("fig-8-11", "A1"), ("fig-8-14", "A1"), ("fig-8-16", "A6"), ("fig-8-16-lag-last", "A6")];

/// Number of runs that are integrated together as one batch. Runs of a batch share one compiled program.
const RUNS_PER_BATCH: usize = 16;

/// A shipped circuit, and the edits to it.
#[derive(Debug, Clone)]
pub(super) struct Recipe {
    /// Name of the shipped circuit, one of [`CIRCUITS`].
    circuit: &'static str,
    /// The edits, in the order in which they were added.
    changes: Vec<Change>,
    /// The pictures. If there are none, those of the circuit stay.
    pictures: Vec<PictureEntry>,
}

/// A change of a circuit.
#[derive(Debug, Clone)]
enum Change {
    /// The value of a parameter, in its unit.
    Parameter(String, f64),
    /// An element that is added, or that replaces the element with its name.
    Element(String, ElementBuilder),
    /// A drive that is added, or that replaces the drive with its name.
    Drive(String, ElementBuilder),
    /// A value at the end of a path of keys.
    Value(Edit),
}

impl Recipe {
    /// Makes the recipe of a shipped circuit without changes.
    pub(super) fn new(circuit: &'static str) -> Recipe {
        Recipe { circuit, changes: Vec::new(), pictures: Vec::new() }
    }

    /// Sets a parameter, in its unit.
    pub(super) fn set(mut self, parameter: &str, value: f64) -> Recipe {
        self.changes.push(Change::Parameter(parameter.to_owned(), value));
        self
    }

    /// Sets several parameters, each in its unit.
    pub(super) fn set_all(self, parameters: &[(&str, f64)]) -> Recipe {
        parameters.iter().fold(self, |recipe, (name, value)| recipe.set(name, *value))
    }

    /// Sets the duration of the run, in seconds.
    pub(super) fn run_time(self, seconds: f64) -> Recipe {
        self.edit("run/for", seconds)
    }

    /// Sets the time between samples, in seconds.
    pub(super) fn sample_interval(self, seconds: f64) -> Recipe {
        self.edit("run/every", seconds)
    }

    /// Records these signals, instead of those of the circuit.
    pub(super) fn record(self, signals: &[&str]) -> Recipe {
        self.edit("record", signals)
    }

    /// Starts the machine in steady sliding at `v_start`, which must be below VcL, with `times` the velocity. For
    /// `times` near 1 that is a small disturbance of a circuit whose friction falls with the square of velocity.
    pub(super) fn disturbed_sliding(self, times: f64) -> Recipe {
        let error = "-(Fs * (1 - v_start / VcL)^2 + f * v_start) / K / position";
        let integrator = self.position_integrator();
        let recipe = self
            .edit(&format!("elements/{integrator}/initial"), error)
            .edit("elements/A3/initial", format!("-{times} * v_start / velocity"));
        match recipe.circuit {
            "fig-8-14" => recipe,
            _ => recipe.edit("elements/A1/initial", "100 * (1 - v_start / VcL)"),
        }
    }

    /// Returns the element that integrates the position error. For a circuit that is not listed it returns a name
    /// that no circuit has, so that edits of it are refused.
    fn position_integrator(&self) -> &'static str {
        let found = POSITION_INTEGRATORS.iter().find(|(circuit, _)| *circuit == self.circuit);
        found.map_or("position-integrator", |(_, integrator)| integrator)
    }

    /// Multiplies the scales of position, velocity and acceleration by `times`, for motion that exceeds the machine
    /// range of the thesis. Only the pots change, not the gains of the inputs.
    pub(super) fn scale_by(self, times: f64) -> Recipe {
        let Scales { position, velocity, acceleration, .. } = Scales::B;
        [("position", position), ("velocity", velocity), ("acceleration", acceleration)]
            .into_iter()
            .fold(self, |recipe, (name, scale)| {
                recipe.edit(&format!("scales/{name}/per_volt"), times * scale)
            })
    }

    /// Adds noise to the velocity command: a random number every 5 ms, with `rms` in m/s. Faster noise would hardly
    /// move the table, whose natural frequency is about 50 Hz. The seed is fixed.
    pub(super) fn command_noise(self, rms: f64) -> Recipe {
        if rms == 0.0 {
            return self;
        }
        let noise = ElementBuilder::new("noise").set("scale", "velocity").set("rms", rms);
        let noise = noise.set("every", 5e-3).set("seed", 1);
        let inputs = format!("elements/{}/in/x10", self.position_integrator());
        self.drive("rough", noise).edit(&inputs, ["v_i", "A3", "rough"])
    }

    /// Raises the command from 0 to `highest` in m/s and lowers it to 0 again, at `rate` in m/s2.
    pub(super) fn triangle_command(self, highest: f64, rate: f64) -> Recipe {
        let turn = highest / rate;
        self.set("v_rate", rate).set("v_turn", turn).run_time(2.0 * turn)
    }

    /// Keeps the command constant, at a velocity in m/s.
    pub(super) fn steady_command(self, velocity: f64) -> Recipe {
        self.set("v_start", velocity).set("v_rate", 0.0)
    }

    /// Adds a picture. Pictures that are added replace those of the circuit. Each axis has the range of its own values,
    /// as in the figures of the thesis.
    pub(super) fn add_picture(mut self, title: &str, x: &str, y: &[&str]) -> Recipe {
        self.pictures.push(PictureEntry::new(title, x, y).with_own_ranges());
        self
    }

    /// Adds an element, or replaces the element with this name.
    pub(super) fn element(mut self, name: &str, element: ElementBuilder) -> Recipe {
        self.changes.push(Change::Element(name.to_owned(), element));
        self
    }

    /// Adds a drive, or replaces the drive with this name.
    pub(super) fn drive(mut self, name: &str, drive: ElementBuilder) -> Recipe {
        self.changes.push(Change::Drive(name.to_owned(), drive));
        self
    }

    /// Replaces all cords into an element by cords into one of its summing inputs.
    pub(super) fn cords(self, element: &str, jack: &str, from: &[&str]) -> Recipe {
        self.edit(&format!("elements/{element}/in"), Value::from_iter([(jack, from)]))
    }

    /// Adds an edit: the value at the end of a path of keys, such as "run/for".
    pub(super) fn edit(mut self, path: &str, value: impl Into<Value>) -> Recipe {
        self.changes.push(Change::Value(Edit::new(path, value)));
        self
    }

    /// Returns the complete patch, with a name and a title.
    ///
    /// # Errors
    /// If there is no such circuit, or if a change does not fit it.
    pub(super) fn patch(&self, name: &str, title: &str) -> Result<Patch, BoxError> {
        let circuit =
            PATCHES.get(self.circuit).ok_or_else(|| format!("there is no circuit {}", self.circuit))?;
        let mut editor = circuit.edit();
        for change in &self.changes {
            match change {
                Change::Parameter(name, value) => editor.set_parameter(name, *value)?,
                Change::Element(name, element) => editor.put_element(name, element.clone()),
                Change::Drive(name, drive) => editor.put_drive(name, drive.clone()),
                Change::Value(edit) => editor.put(edit.path(), edit.value().clone()),
            }
        }
        editor.set_title(title);
        if !self.pictures.is_empty() {
            editor.put(["pictures"], json_value(&self.pictures));
        }
        Ok(editor.finish(&format!("{name}.json"))?)
    }

    /// Returns the parameters with their values in one line, without those that are varied.
    ///
    /// # Errors
    /// If there is no such circuit, or if a change does not fit it.
    pub(super) fn settings(&self, varied: &[&str]) -> Result<String, BoxError> {
        let line = parameter_line(&self.circuit("settings", "")?);
        let is_varied = |setting: &&str| varied.iter().any(|name| setting.split(' ').next() == Some(name));
        Ok(line.split(", ").filter(|setting| !is_varied(setting)).collect::<Vec<_>>().join(", "))
    }

    /// Returns the circuit of the patch.
    ///
    /// # Errors
    /// If there is no such circuit, or if the patch with the changes has a fault.
    pub(super) fn circuit(&self, name: &str, title: &str) -> Result<Circuit, BoxError> {
        Ok(Circuit::new(&self.patch(name, title)?)?)
    }

    /// Runs the circuit for each row of values of the parameters `vary`, in batches, and reads each run. Results have
    /// the order of the rows.
    ///
    /// # Errors
    /// If a run fails or `read` fails. The error states the values of that run.
    pub(super) fn run_rows<T>(
        &self,
        vary: &[&str],
        rows: &[Vec<f64>],
        read: impl Fn(&RunRecord) -> Result<T, BoxError>,
    ) -> Result<Vec<T>, BoxError> {
        let circuit = self.circuit("sweep", "")?;
        let (program, settings) = (Program::new(&circuit)?, RunSettings::of(&circuit)?);
        let mut found = Vec::with_capacity(rows.len());
        for rows in rows.chunks(RUNS_PER_BATCH) {
            let programs = rows.iter().map(|row| with_parameter_values(&program, vary, row));
            let programs = programs.collect::<Result<Vec<_>, _>>()?;
            for (row, outcome) in rows.iter().zip(solve::run_batch(&programs, &settings)) {
                let result = outcome
                    .map_err(|stopped| stopped.error.into())
                    .and_then(|trace| read(&RunRecord::new(&program, trace)));
                found.push(result.map_err(|problem| format!("{} = {row:?}: {problem}", vary.join(", ")))?);
            }
        }
        Ok(found)
    }

    /// Runs the circuit for each value of one parameter. Returns each value with the result of `read`.
    ///
    /// # Errors
    /// If a run fails or `read` fails. The error states the values of that run.
    pub(super) fn run_values<T>(
        &self,
        parameter: &str,
        values: &[f64],
        read: impl Fn(&RunRecord) -> Result<T, BoxError>,
    ) -> Result<Vec<(f64, T)>, BoxError> {
        let rows: Vec<_> = values.iter().map(|value| vec![*value]).collect();
        Ok(values.iter().copied().zip(self.run_rows(&[parameter], &rows, read)?).collect())
    }

    /// Runs the circuit once, with a name and a title for its patch. The record has samples only.
    ///
    /// # Errors
    /// If there is no such circuit, if the patch has a fault, or if the run stops early.
    pub(super) fn run(&self, name: &str, title: &str) -> Result<ReplayedRun, BoxError> {
        let circuit = self.circuit(name, title)?;
        let settings = RunSettings::of(&circuit)?;
        run_circuit(circuit, &settings)
    }

    /// Runs the circuit once, with a name and a title for its patch. The record also has the curves of its pictures.
    ///
    /// # Errors
    /// As for [`Recipe::run`].
    pub(super) fn run_for_pictures(&self, name: &str, title: &str) -> Result<ReplayedRun, BoxError> {
        let circuit = self.circuit(name, title)?;
        let settings = RunSettings::of(&circuit)?.with_curves(circuit.drawn_curves());
        run_circuit(circuit, &settings)
    }
}

/// Runs a circuit with these settings.
///
/// # Errors
/// If the circuit has no program, or if the run stops early.
fn run_circuit(circuit: Circuit, settings: &RunSettings) -> Result<ReplayedRun, BoxError> {
    let program = Program::new(&circuit)?;
    let trace = solve::run(&program, settings).map_err(|stopped| stopped.error)?;
    Ok(ReplayedRun::new(circuit, RunRecord::new(&program, trace)))
}

/// Returns the largest difference between the samples of one signal in two runs, in the unit of the signal.
///
/// Both runs must record the signal at the same times.
pub(super) fn max_run_difference([one, other]: [Recipe; 2], signal: &str) -> Result<f64, BoxError> {
    let [one, other] = [one, other].map(|recipe| recipe.run("one", "")?.record.values(signal));
    Ok(series::max_difference(&one?, &other?))
}

/// Returns a copy of a program with other values of some parameters.
fn with_parameter_values(program: &Program, vary: &[&str], values: &[f64]) -> Result<Program, BoxError> {
    let mut program = program.clone();
    program.set_parameters(vary.iter().copied().zip(values.iter().copied()))?;
    Ok(program)
}
