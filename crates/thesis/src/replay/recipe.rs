//! Runs of the shipped circuits with settings of their own, and the patches that say them.

use std::collections::HashMap;
use std::ops::Deref;
use std::sync::LazyLock;

use serde_json::{Value, json};

use crate::slideway::scaling::Scales;
use patchcord_analysis::instruments::{
    Cell, Criterion, CriticalVelocity, Display, Measure, NoCriticalVelocity, critical_velocity,
    parameter_line,
};
use patchcord_core::circuit::Circuit;
use patchcord_core::ir::{Probe, Program};
use patchcord_core::patch::{Edit, Patch};
use patchcord_core::solve::{self, RunSettings};
use patchcord_core::trace::Trace;
use patchcord_draw::picture;
use patchcord_draw::plot::Picture;

/// Whatever keeps a figure from being made.
pub(super) type Problem = Box<dyn std::error::Error + Send + Sync>;

/// The shipped circuits that figures and checks begin from: name and document.
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

/// The same as patches, by name.
static PATCHES: LazyLock<HashMap<&str, Patch>> = LazyLock::new(|| {
    let read = |(name, text): &(&'static str, &str)| {
        (*name, Patch::parse(name, text).expect("a shipped circuit is a document"))
    };
    CIRCUITS.iter().map(read).collect()
});

/// The integrator of position error, in the circuits that small disturbances and noise come into.
const POSITION_INTEGRATORS: [(&str, &str); 4] =
    [("fig-8-11", "A1"), ("fig-8-14", "A1"), ("fig-8-16", "A6"), ("fig-8-16-lag-last", "A6")];

/// So many runs of a sweep are made side by side.
const ABREAST: usize = 16;

/// A circuit, and what is changed in it.
#[derive(Debug, Clone)]
pub(super) struct Recipe {
    circuit: &'static str,
    changes: Vec<Change>,
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
    /// A shipped circuit as it is.
    pub fn of(circuit: &'static str) -> Recipe {
        Recipe { circuit, changes: Vec::new(), pictures: Vec::new() }
    }

    /// A parameter, in its unit.
    pub fn set(mut self, parameter: &str, value: f64) -> Recipe {
        self.changes.push(Change::Parameter(parameter.to_owned(), value));
        self
    }

    /// Several parameters, each in its unit.
    pub fn with(self, parameters: &[(&str, f64)]) -> Recipe {
        parameters.iter().fold(self, |recipe, (name, value)| recipe.set(name, *value))
    }

    /// How long it runs, in seconds.
    pub fn lasting(self, seconds: f64) -> Recipe {
        self.edit("run/for", seconds)
    }

    /// Time between samples, in seconds.
    pub fn every(self, seconds: f64) -> Recipe {
        self.edit("run/every", seconds)
    }

    /// What is recorded, instead of what the circuit records.
    pub fn recording(self, signals: &[&str]) -> Recipe {
        self.edit("record", json!(signals))
    }

    /// The machine set to slide steadily at `v_start` below VcL, but for the velocity, which is so many times that: a small
    /// disturbance of a circuit whose friction falls with the square.
    pub fn sliding(self, times: f64) -> Recipe {
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

    /// The integrator of position error, with the velocity command among what it adds; a name that no circuit has where it is not
    /// told, so that what is built on it is refused.
    fn position_integrator(&self) -> &'static str {
        let found = POSITION_INTEGRATORS.iter().find(|(circuit, _)| *circuit == self.circuit);
        found.map_or("position-integrator", |(_, integrator)| integrator)
    }

    /// Scales so many times as large, of length, velocity and acceleration: for motion that goes beyond the machine in those of the
    /// study. No gain changes but those of the pots.
    pub fn scaled(self, times: f64) -> Recipe {
        let Scales { position, velocity, acceleration, .. } = Scales::B;
        [("position", position), ("velocity", velocity), ("acceleration", acceleration)]
            .into_iter()
            .fold(self, |recipe, (name, scale)| {
                recipe.edit(&format!("scales/{name}/per_volt"), times * scale)
            })
    }

    /// Noise on the velocity command: a number drawn every 5 ms, so large, rms in m/s. What is drawn more often the table hardly sees,
    /// as its natural frequency is some 50 Hz.
    pub fn noisy(self, rms: f64) -> Recipe {
        if rms == 0.0 {
            return self;
        }
        let noise = json!({"kind": "noise", "scale": "velocity", "rms": rms, "every": 5e-3, "seed": 1});
        let inputs = format!("elements/{}/in/x10", self.position_integrator());
        self.edit("drives/rough", noise).edit(&inputs, json!(["v_i", "A3", "rough"]))
    }

    /// The command goes up to a velocity in m/s and comes back, at a rate in m/s2.
    pub fn there_and_back(self, highest: f64, rate: f64) -> Recipe {
        let turn = highest / rate;
        self.set("v_rate", rate).set("v_turn", turn).lasting(2.0 * turn)
    }

    /// The command stands still, at a velocity in m/s.
    pub fn steady(self, velocity: f64) -> Recipe {
        self.set("v_start", velocity).set("v_rate", 0.0)
    }

    /// One more picture, instead of those of the circuit.
    pub fn picture(mut self, title: &str, x: &str, y: &[&str]) -> Recipe {
        self.pictures.push(json!({"title": title, "x": x, "y": y}));
        self
    }

    /// Anything else, at the end of a path of keys.
    pub fn edit(mut self, path: &str, value: impl Into<Value>) -> Recipe {
        self.changes.push(Change::Put(Edit::new(path, value)));
        self
    }

    /// The patch that says it all, under a name and a title.
    pub fn patch(&self, name: &str, title: &str) -> Result<Patch, Problem> {
        let circuit =
            PATCHES.get(self.circuit).ok_or_else(|| format!("there is no circuit {}", self.circuit))?;
        let mut editor = circuit.edit();
        for change in &self.changes {
            match change {
                Change::Parameter(name, value) => editor.set_parameter(name, *value)?,
                Change::Put(Edit { path, value }) => {
                    let path: Vec<&str> = path.iter().map(String::as_str).collect();
                    editor.put(&path, value.clone());
                }
            }
        }
        editor.set_title(title);
        if !self.pictures.is_empty() {
            editor.put(&["pictures"], self.pictures.clone());
        }
        Ok(editor.finish(&format!("{name}.json"))?)
    }

    /// What it is set to, in a line; without the parameters that are varied.
    pub fn settings(&self, varied: &[&str]) -> Result<String, Problem> {
        let line = parameter_line(&self.circuit("settings", "")?);
        let is_varied = |setting: &&str| varied.iter().any(|name| setting.split(' ').next() == Some(name));
        Ok(line.split(", ").filter(|setting| !is_varied(setting)).collect::<Vec<_>>().join(", "))
    }

    /// The circuit of that patch.
    pub fn circuit(&self, name: &str, title: &str) -> Result<Circuit, Problem> {
        Ok(Circuit::new(&self.patch(name, title)?, &[])?)
    }

    /// Runs it for each row of values of some parameters, side by side, and reads each run.
    ///
    /// # Errors
    /// A run that cannot be made, or what `read` refuses, with the values of that run.
    pub fn each<T>(
        &self,
        vary: &[&str],
        rows: &[Vec<f64>],
        read: impl Fn(&Record) -> Result<T, Problem>,
    ) -> Result<Vec<T>, Problem> {
        let circuit = self.circuit("sweep", "")?;
        let (program, settings) = (Program::new(&circuit)?, RunSettings::of(&circuit)?);
        let mut found = Vec::with_capacity(rows.len());
        for rows in rows.chunks(ABREAST) {
            let programs = rows.iter().map(|row| turned(&program, vary, row));
            let programs = programs.collect::<Result<Vec<_>, _>>()?;
            for (row, outcome) in rows.iter().zip(solve::run_abreast(&programs, &settings)) {
                let read = outcome
                    .map_err(|stopped| stopped.error.into())
                    .and_then(|trace| read(&Record::new(&program, trace)));
                found.push(read.map_err(|problem| format!("{} = {row:?}: {problem}", vary.join(", ")))?);
            }
        }
        Ok(found)
    }

    /// The same for values of one parameter: each value with what is read.
    pub fn along<T>(
        &self,
        parameter: &str,
        values: &[f64],
        read: impl Fn(&Record) -> Result<T, Problem>,
    ) -> Result<Vec<(f64, T)>, Problem> {
        let rows: Vec<_> = values.iter().map(|value| vec![*value]).collect();
        Ok(values.iter().copied().zip(self.each(&[parameter], &rows, read)?).collect())
    }

    /// Runs it, under a name and a title.
    pub fn run(&self, name: &str, title: &str) -> Result<Replayed, Problem> {
        let circuit = self.circuit(name, title)?;
        let program = Program::new(&circuit)?;
        let trace = solve::run(&program, &RunSettings::of(&circuit)?).map_err(|stopped| stopped.error)?;
        Ok(Replayed { record: Record::new(&program, trace), circuit })
    }
}

/// How far apart a signal of two runs gets at most, in its unit.
pub(super) fn apart([one, other]: [Recipe; 2], signal: &str) -> Result<f64, Problem> {
    let [one, other] = [one, other].map(|recipe| recipe.run("one", "")?.values(signal));
    Ok(one?.iter().zip(&other?).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max))
}

/// A program with other values of some parameters.
fn turned(program: &Program, vary: &[&str], values: &[f64]) -> Result<Program, Problem> {
    let mut program = program.clone();
    program.set_parameters(vary.iter().copied().zip(values.iter().copied()))?;
    Ok(program)
}

/// A run that was made, with the circuit that was run.
#[derive(Debug)]
pub(super) struct Replayed {
    circuit: Circuit,
    record: Record,
}

impl Replayed {
    /// The patch that was run.
    pub fn patch(&self) -> &Patch {
        self.circuit.patch()
    }

    /// What it was set to, in a line.
    pub fn settings(&self) -> String {
        parameter_line(&self.circuit)
    }

    /// The pictures that the patch asks for.
    pub fn pictures(&self) -> Result<Vec<Picture>, Problem> {
        let specs = &self.patch().pictures;
        let drawn = specs.iter().map(|spec| picture(&self.trace, spec, Some(self.settings())));
        Ok(drawn.collect::<Result<_, _>>()?)
    }
}

impl Replayed {
    /// It, where no amplifier was overloaded.
    pub fn within_range(self) -> Result<Replayed, Problem> {
        self.check_range()?;
        Ok(self)
    }
}

impl Deref for Replayed {
    type Target = Record;

    fn deref(&self) -> &Record {
        &self.record
    }
}

/// What was recorded of a run.
#[derive(Debug)]
pub(super) struct Record {
    signals: Vec<Probe>,
    pub trace: Trace,
}

impl Record {
    fn new(program: &Program, trace: Trace) -> Record {
        Record { signals: program.signals().to_vec(), trace }
    }

    /// The samples of a signal in its unit; "t" is time.
    pub fn values(&self, signal: &str) -> Result<Vec<f64>, Problem> {
        if signal == "t" {
            return Ok(self.trace.time.clone());
        }
        self.trace.values(signal).ok_or_else(|| format!("{signal} is not recorded").into())
    }

    /// One signal against another, both divided by what stands for 1 on its axis.
    pub fn points(&self, along: (&str, f64), up: (&str, f64)) -> Result<Vec<(f64, f64)>, Problem> {
        let [along_values, up_values] = [self.values(along.0)?, self.values(up.0)?];
        Ok(along_values.iter().zip(&up_values).map(|(x, y)| (x / along.1, y / up.1)).collect())
    }

    /// The critical velocities of its profile, in m/s, by the usual criterion: swings above 0.25 mm/s within 0.04 s are oscillation.
    ///
    /// # Errors
    /// Where an amplifier was overloaded.
    pub fn critical(&self) -> Result<CriticalVelocity, Problem> {
        self.critical_by(Criterion::USUAL)
    }

    /// The same by another criterion.
    pub fn critical_by(&self, criterion: Criterion) -> Result<CriticalVelocity, Problem> {
        self.check_range()?;
        let (command, velocity) = (self.values("v_i")?, self.values("v_o")?);
        Ok(critical_velocity(&self.trace.time, &command, &velocity, criterion))
    }

    /// The number that a measure reads off it, the first where it reads several.
    ///
    /// # Errors
    /// Where it reads none, with the reason, and where an amplifier was overloaded.
    pub fn measure(&self, text: &str) -> Result<f64, Problem> {
        self.check_range()?;
        let cells = Measure::parse(text, &self.signals)?.read(&self.trace);
        match cells.into_iter().next() {
            Some(Ok(Cell::Number(number))) => Ok(number),
            Some(Err(reason)) => Err(format!("{text}: {reason}").into()),
            _ => Err(format!("{text} is no number").into()),
        }
    }

    /// An overloaded amplifier stands for nothing: no number is read off such a run.
    fn check_range(&self) -> Result<(), Problem> {
        self.overloads().map_or(Ok(()), |overload| Err(overload.into()))
    }

    /// The lamps that lit, in a sentence; nothing where none did.
    pub fn overloads(&self) -> Option<String> {
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

/// A critical velocity, in words: the reason where there is none.
pub(super) fn velocity_told(velocity: Result<f64, NoCriticalVelocity>) -> String {
    velocity.map_or_else(|none| none.to_string(), |velocity| Display::new("m/s", velocity).text(velocity))
}
