//! Runs of the shipped circuits with changed settings.
//!
//! A [`Recipe`] is the name of a shipped circuit with a list of edits. It becomes a patch, a circuit, a run, or a
//! sweep of runs. The patch is complete, so a reader can repeat the run with it.
//!
//! The order of the edits matters where they touch the same value: a later one replaces an earlier one. Errors appear
//! when the patch is made, not when an edit is added. A run with an overloaded amplifier does not obey the equations,
//! so every reading of a number refuses it.

use std::collections::HashMap;
use std::sync::LazyLock;

use serde_json::{Value, json};

use crate::slideway::scaling::Scales;
use patchcord_analysis::format::QuantityFormat;
use patchcord_analysis::instruments::{
    Criterion, CriticalVelocity, Measure, MeasureValue, NoCriticalVelocity, critical_velocity, parameter_line,
};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Program, SignalInfo};
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;
use patchcord_draw::picture;
use patchcord_draw::plot::Picture;

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

/// Number of runs of a sweep that are integrated together as one batch.
///
/// Runs of a batch share one compiled program and are integrated side by side.
const RUNS_PER_BATCH: usize = 16;

/// A shipped circuit, and the edits to it.
#[derive(Debug, Clone)]
pub(super) struct Recipe {
    /// Name of the shipped circuit, one of [`CIRCUITS`].
    circuit: &'static str,
    /// The edits, in the order in which they were added.
    changes: Vec<Change>,
    /// The pictures as the patch document writes them. If there are none, those of the circuit stay.
    pictures: Vec<Value>,
}

/// A change of a circuit.
#[derive(Debug, Clone)]
enum Change {
    /// A parameter, in its unit.
    Parameter(String, f64),
    /// A value at the end of a path of keys.
    Put(Edit),
}

impl Recipe {
    /// Makes the recipe of a shipped circuit without changes.
    pub fn new(circuit: &'static str) -> Recipe {
        Recipe { circuit, changes: Vec::new(), pictures: Vec::new() }
    }

    /// Sets a parameter, in its unit.
    pub fn set(mut self, parameter: &str, value: f64) -> Recipe {
        self.changes.push(Change::Parameter(parameter.to_owned(), value));
        self
    }

    /// Sets several parameters, each in its unit.
    pub fn set_all(self, parameters: &[(&str, f64)]) -> Recipe {
        parameters.iter().fold(self, |recipe, (name, value)| recipe.set(name, *value))
    }

    /// Sets the duration of the run, in seconds.
    pub fn run_time(self, seconds: f64) -> Recipe {
        self.edit("run/for", seconds)
    }

    /// Sets the time between samples, in seconds.
    pub fn sample_interval(self, seconds: f64) -> Recipe {
        self.edit("run/every", seconds)
    }

    /// Records these signals, instead of those of the circuit.
    pub fn record(self, signals: &[&str]) -> Recipe {
        self.edit("record", json!(signals))
    }

    /// Starts the machine in steady sliding at `v_start`, which must be below VcL, but with `times` the velocity.
    /// That is a small disturbance of a circuit whose friction falls with the square of velocity.
    pub fn disturbed_sliding(self, times: f64) -> Recipe {
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
    /// range of the study. Only the pots change, not the gains of the inputs.
    pub fn scale_by(self, times: f64) -> Recipe {
        let Scales { position, velocity, acceleration, .. } = Scales::B;
        [("position", position), ("velocity", velocity), ("acceleration", acceleration)]
            .into_iter()
            .fold(self, |recipe, (name, scale)| {
                recipe.edit(&format!("scales/{name}/per_volt"), times * scale)
            })
    }

    /// Adds noise to the velocity command: a random number every 5 ms, with `rms` in m/s. Faster noise would hardly
    /// move the table, whose natural frequency is about 50 Hz. The seed is fixed.
    pub fn command_noise(self, rms: f64) -> Recipe {
        if rms == 0.0 {
            return self;
        }
        let noise = json!({"kind": "noise", "scale": "velocity", "rms": rms, "every": 5e-3, "seed": 1});
        let inputs = format!("elements/{}/in/x10", self.position_integrator());
        self.edit("drives/rough", noise).edit(&inputs, json!(["v_i", "A3", "rough"]))
    }

    /// Raises the command from 0 to `highest` in m/s and lowers it to 0 again, at `rate` in m/s2.
    pub fn triangle_command(self, highest: f64, rate: f64) -> Recipe {
        let turn = highest / rate;
        self.set("v_rate", rate).set("v_turn", turn).run_time(2.0 * turn)
    }

    /// Keeps the command constant, at a velocity in m/s.
    pub fn steady_command(self, velocity: f64) -> Recipe {
        self.set("v_start", velocity).set("v_rate", 0.0)
    }

    /// Adds a picture. Pictures that are added replace those of the circuit.
    pub fn add_picture(mut self, title: &str, x: &str, y: &[&str]) -> Recipe {
        self.pictures.push(json!({"title": title, "x": x, "y": y}));
        self
    }

    /// Adds an edit: the value at the end of a path of keys, such as "run/for".
    pub fn edit(mut self, path: &str, value: impl Into<Value>) -> Recipe {
        self.changes.push(Change::Put(Edit::new(path, value)));
        self
    }

    /// Returns the complete patch, with a name and a title.
    ///
    /// # Errors
    /// If there is no such circuit, or if a change does not fit it.
    pub fn patch(&self, name: &str, title: &str) -> Result<Patch, BoxError> {
        let circuit =
            PATCHES.get(self.circuit).ok_or_else(|| format!("there is no circuit {}", self.circuit))?;
        let mut editor = circuit.edit();
        for change in &self.changes {
            match change {
                Change::Parameter(name, value) => editor.set_parameter(name, *value)?,
                Change::Put(edit) => {
                    let path: Vec<&str> = edit.path().iter().map(String::as_str).collect();
                    editor.put(&path, edit.value().clone());
                }
            }
        }
        editor.set_title(title);
        if !self.pictures.is_empty() {
            editor.put(&["pictures"], self.pictures.clone());
        }
        Ok(editor.finish(&format!("{name}.json"))?)
    }

    /// Returns the parameters with their values in one line, without those that are varied.
    pub fn settings(&self, varied: &[&str]) -> Result<String, BoxError> {
        let line = parameter_line(&self.circuit("settings", "")?);
        let is_varied = |setting: &&str| varied.iter().any(|name| setting.split(' ').next() == Some(name));
        Ok(line.split(", ").filter(|setting| !is_varied(setting)).collect::<Vec<_>>().join(", "))
    }

    /// Returns the circuit of the patch.
    pub fn circuit(&self, name: &str, title: &str) -> Result<Circuit, BoxError> {
        Ok(Circuit::new(&self.patch(name, title)?)?)
    }

    /// Runs the circuit for each row of values of the parameters `vary`, in batches, and reads each run. Results have
    /// the order of the rows.
    ///
    /// # Errors
    /// If a run fails or `read` fails. The error states the values of that run.
    pub fn run_rows<T>(
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
                let read = outcome
                    .map_err(|stopped| stopped.error.into())
                    .and_then(|trace| read(&RunRecord::new(&program, trace)));
                found.push(read.map_err(|problem| format!("{} = {row:?}: {problem}", vary.join(", ")))?);
            }
        }
        Ok(found)
    }

    /// Runs the circuit for each value of one parameter. Returns each value with the result of `read`.
    pub fn run_values<T>(
        &self,
        parameter: &str,
        values: &[f64],
        read: impl Fn(&RunRecord) -> Result<T, BoxError>,
    ) -> Result<Vec<(f64, T)>, BoxError> {
        let rows: Vec<_> = values.iter().map(|value| vec![*value]).collect();
        Ok(values.iter().copied().zip(self.run_rows(&[parameter], &rows, read)?).collect())
    }

    /// Runs the circuit once, with a name and a title for its patch.
    pub fn run(&self, name: &str, title: &str) -> Result<ReplayedRun, BoxError> {
        let circuit = self.circuit(name, title)?;
        let program = Program::new(&circuit)?;
        let trace = solve::run(&program, &RunSettings::of(&circuit)?).map_err(|stopped| stopped.error)?;
        Ok(ReplayedRun { record: RunRecord::new(&program, trace), circuit })
    }
}

/// Returns the largest difference between the samples of one signal in two runs, in the unit of the signal.
///
/// Both runs must record the signal at the same times.
pub(super) fn max_difference([one, other]: [Recipe; 2], signal: &str) -> Result<f64, BoxError> {
    let [one, other] = [one, other].map(|recipe| recipe.run("one", "")?.record.values(signal));
    Ok(one?.iter().zip(&other?).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max))
}

/// Returns a copy of a program with other values of some parameters.
fn with_parameter_values(program: &Program, vary: &[&str], values: &[f64]) -> Result<Program, BoxError> {
    let mut program = program.clone();
    program.set_parameters(vary.iter().copied().zip(values.iter().copied()))?;
    Ok(program)
}

/// A finished run with its circuit.
#[derive(Debug)]
pub(super) struct ReplayedRun {
    circuit: Circuit,
    /// The recorded signals.
    pub record: RunRecord,
}

impl ReplayedRun {
    /// The patch that was run.
    pub fn patch(&self) -> &Patch {
        self.circuit.patch()
    }

    /// Returns the parameters with their values in one line.
    pub fn settings(&self) -> String {
        parameter_line(&self.circuit)
    }

    /// Draws the pictures that the patch specifies, with the settings as a note.
    pub fn pictures(&self) -> Result<Vec<Picture>, BoxError> {
        let specs = &self.patch().pictures;
        let drawn = specs.iter().map(|spec| picture(&self.record.trace, spec, Some(self.settings())));
        Ok(drawn.collect::<Result<_, _>>()?)
    }
}

impl ReplayedRun {
    /// Returns the run.
    ///
    /// # Errors
    /// If an amplifier was overloaded.
    pub fn without_overload(self) -> Result<ReplayedRun, BoxError> {
        self.record.reject_overload()?;
        Ok(self)
    }
}

/// The recorded signals of a run.
#[derive(Debug)]
pub(super) struct RunRecord {
    /// Names and units of the signals, in the order of the program.
    signals: Vec<SignalInfo>,
    /// The samples, and the overloads.
    pub trace: Trace,
}

impl RunRecord {
    /// Keeps the signals of a program together with the trace, so that measures can be parsed by name.
    fn new(program: &Program, trace: Trace) -> RunRecord {
        RunRecord { signals: program.signals().to_vec(), trace }
    }

    /// Returns the samples of a signal in its unit. "t" is time, in s.
    pub fn values(&self, signal: &str) -> Result<Vec<f64>, BoxError> {
        if signal == "t" {
            return Ok(self.trace.time.clone());
        }
        self.trace.values(signal).ok_or_else(|| format!("{signal} is not recorded").into())
    }

    /// Returns the points of one signal against another. Each signal is divided by the number next to its name, which
    /// is the unit of its axis.
    pub fn points(&self, along: (&str, f64), up: (&str, f64)) -> Result<Vec<(f64, f64)>, BoxError> {
        let [along_values, up_values] = [self.values(along.0)?, self.values(up.0)?];
        Ok(along_values.iter().zip(&up_values).map(|(x, y)| (x / along.1, y / up.1)).collect())
    }

    /// Returns the critical velocities of the profile in m/s, by the usual criterion: swings above 0.25 mm/s within
    /// 0.04 s are oscillation.
    ///
    /// # Errors
    /// If an amplifier was overloaded.
    pub fn critical_velocity(&self) -> Result<CriticalVelocity, BoxError> {
        self.critical_velocity_by(Criterion::USUAL)
    }

    /// Returns the critical velocities of the profile in m/s, by another criterion.
    ///
    /// The velocity command is `v_i` and the output velocity `v_o`; both must be recorded.
    ///
    /// # Errors
    /// If an amplifier was overloaded.
    pub fn critical_velocity_by(&self, criterion: Criterion) -> Result<CriticalVelocity, BoxError> {
        self.reject_overload()?;
        let (command, velocity) = (self.values("v_i")?, self.values("v_o")?);
        Ok(critical_velocity(&self.trace.time, &command, &velocity, criterion))
    }

    /// Returns the number that a measure reads, such as "frequency:v_o,last=1". If it reads several, the first is
    /// returned.
    ///
    /// # Errors
    /// If the measure reads no number, or if an amplifier was overloaded. The error states the reason.
    pub fn measure(&self, text: &str) -> Result<f64, BoxError> {
        self.reject_overload()?;
        let cells = Measure::parse(text, &self.signals)?.read(&self.trace);
        match cells.into_iter().next() {
            Some(Ok(MeasureValue::Number(number))) => Ok(number),
            Some(Err(reason)) => Err(format!("{text}: {reason}").into()),
            _ => Err(format!("{text} is not a number").into()),
        }
    }

    /// Refuses runs with an overloaded amplifier. Their signals do not obey the equations, so no number may be read
    /// from them.
    fn reject_overload(&self) -> Result<(), BoxError> {
        self.overload_text().map_or(Ok(()), |overload| Err(overload.into()))
    }

    /// Describes the overload lamps that lit. `None` if there was no overload.
    pub fn overload_text(&self) -> Option<String> {
        let first = self.trace.overloads().next()?;
        let more = match self.trace.overloads().count() - 1 {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        Some(format!(
            "overload: {} from {:.3} s on, up to {:.0} V{more}",
            first.element, first.time, first.peak
        ))
    }
}

/// Formats a critical velocity, or the reason why there is none.
pub(super) fn format_critical_velocity(velocity: Result<f64, NoCriticalVelocity>) -> String {
    velocity
        .map_or_else(|none| none.to_string(), |velocity| QuantityFormat::new("m/s", velocity).text(velocity))
}
