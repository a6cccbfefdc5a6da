//! Runs of the shipped circuits with settings of their own, and the patches that say them.

use serde_json::{Value, json};

use crate::circuit::Circuit;
use crate::instruments::{Cell, Display, Measure, parameter_line, picture};
use crate::patch::{Edit, Patch};
use crate::plot::Picture;
use crate::program::Program;
use crate::solve::{self, RunSettings};
use crate::sweep::{Axis, Plan, Row, Sweep};
use crate::trace::Trace;

/// Whatever keeps a figure from being made.
pub(super) type Problem = Box<dyn std::error::Error + Send + Sync>;

/// The shipped circuits that figures and checks begin from: name and document.
const CIRCUITS: &[(&str, &str)] = &[
    ("nakashima", include_str!("../../patches/others/nakashima.json")),
    ("singh", include_str!("../../patches/others/singh.json")),
    ("fig-4-07", include_str!("../../patches/thesis/fig-4-07.json")),
    ("fig-8-04", include_str!("../../patches/thesis/fig-8-04.json")),
    ("fig-8-05", include_str!("../../patches/thesis/fig-8-05.json")),
    ("fig-8-06", include_str!("../../patches/thesis/fig-8-06.json")),
    ("fig-8-07", include_str!("../../patches/thesis/fig-8-07.json")),
    ("fig-8-09", include_str!("../../patches/thesis/fig-8-09.json")),
    ("fig-8-11", include_str!("../../patches/thesis/fig-8-11.json")),
    ("fig-8-14", include_str!("../../patches/thesis/fig-8-14.json")),
    ("fig-8-15", include_str!("../../patches/thesis/fig-8-15.json")),
    ("fig-8-16", include_str!("../../patches/thesis/fig-8-16.json")),
    ("fig-8-16-lag-last", include_str!("../../patches/thesis/fig-8-16-lag-last.json")),
    ("fig-8-17", include_str!("../../patches/thesis/fig-8-17.json")),
];

/// So many runs of a sweep are made side by side.
const ABREAST: usize = 16;

/// A circuit, and what is changed in it.
#[derive(Debug, Clone)]
pub(super) struct Recipe {
    circuit: &'static str,
    edits: Vec<Edit>,
    pictures: Vec<Value>,
}

impl Recipe {
    /// A shipped circuit as it is.
    pub fn of(circuit: &'static str) -> Recipe {
        Recipe { circuit, edits: Vec::new(), pictures: Vec::new() }
    }

    /// A parameter, in its unit.
    pub fn set(self, parameter: &str, value: f64) -> Recipe {
        self.edit(&format!("parameters/{parameter}/value"), value)
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

    /// The machine set to slide steadily at `v_start` below VcL, but for the velocity, which is so many times that: what the final
    /// circuit makes of a small disturbance.
    pub fn sliding(self, times: f64) -> Recipe {
        let error = "-(Fs * (1 - v_start / VcL)^2 + f * v_start) / K / position";
        self.edit("elements/A6/initial", error)
            .edit("elements/A3/initial", format!("-{times} * v_start / velocity"))
            .edit("elements/A1/initial", "100 * (1 - v_start / VcL)")
    }

    /// One more picture, instead of those of the circuit.
    pub fn picture(mut self, title: &str, x: &str, y: &[&str]) -> Recipe {
        self.pictures.push(json!({"title": title, "x": x, "y": y}));
        self
    }

    /// Anything else, at the end of a path of keys.
    pub fn edit(mut self, path: &str, value: impl Into<Value>) -> Recipe {
        self.edits.push(Edit::new(path, value));
        self
    }

    /// The patch that says it all, under a name and a title.
    pub fn patch(&self, name: &str, title: &str) -> Result<Patch, Problem> {
        let found = CIRCUITS.iter().find(|(circuit, _)| *circuit == self.circuit);
        let (_, text) = found.ok_or_else(|| format!("there is no circuit {}", self.circuit))?;
        let mut edits = self.edits.clone();
        edits.push(Edit::new("title", title));
        if !self.pictures.is_empty() {
            edits.push(Edit::new("pictures", self.pictures.clone()));
        }
        Ok(Patch::parse(self.circuit, text)?.edited(&format!("{name}.json"), &edits)?)
    }

    /// The circuit of that patch.
    pub fn circuit(&self, name: &str, title: &str) -> Result<Circuit, Problem> {
        Ok(Circuit::new(&self.patch(name, title)?, &[])?)
    }

    /// What measures read off a run for each combination of values, `"Tc=0.0065,0.01"` each.
    pub fn sweep(&self, vary: &[String], measures: &[&str]) -> Result<Vec<Row>, Problem> {
        let axes = vary.iter().map(|text| Axis::parse(text)).collect::<Result<_, _>>()?;
        self.swept(axes, |plan| (0..plan.runs()).map(|run| plan.values(run)).collect(), measures)
    }

    /// The same for rows of values of some parameters.
    pub fn sweep_rows(
        &self,
        vary: &[&str],
        rows: Vec<Vec<f64>>,
        measures: &[&str],
    ) -> Result<Vec<Row>, Problem> {
        let first = rows.first().ok_or("no row is given")?;
        let axis = |(name, value): (&&str, &f64)| Axis::parse(&format!("{name}={value}"));
        let axes = vary.iter().zip(first).map(axis).collect::<Result<_, _>>()?;
        self.swept(axes, |_| rows, measures)
    }

    /// Runs go side by side.
    fn swept(
        &self,
        axes: Vec<Axis>,
        values: impl FnOnce(&Plan) -> Vec<Vec<f64>>,
        measures: &[&str],
    ) -> Result<Vec<Row>, Problem> {
        let circuit = self.circuit("sweep", "")?;
        let (program, settings) = (Program::new(&circuit)?, RunSettings::of(&circuit)?);
        let parsed = measures.iter().map(|text| Measure::parse(text, program.signals()));
        let parsed = parsed.collect::<Result<_, _>>()?;
        let plan = Plan::new(axes, &program)?;
        let sweep = Sweep::new("", program, settings, plan, parsed)?;
        let (values, mut bench) = (values(sweep.plan()), sweep.bench());
        let rows: Vec<Row> = values.chunks(ABREAST).flat_map(|values| bench.rows(values)).collect();
        match rows.iter().find(|row| row.error.is_some()) {
            Some(failed) => Err(format!("{:?}: {}", failed.values, failed.notes.join("; ")).into()),
            None => Ok(rows),
        }
    }

    /// Runs it, under a name and a title.
    pub fn run(&self, name: &str, title: &str) -> Result<Replayed, Problem> {
        let circuit = self.circuit(name, title)?;
        let program = Program::new(&circuit)?;
        let trace = solve::run(&program, &RunSettings::of(&circuit)?).map_err(|stopped| stopped.error)?;
        Ok(Replayed { circuit, program, trace })
    }
}

/// A run that was made.
#[derive(Debug)]
pub(super) struct Replayed {
    circuit: Circuit,
    program: Program,
    pub trace: Trace,
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

    /// The samples of a signal in its unit; "t" is time.
    pub fn values(&self, signal: &str) -> Result<Vec<f64>, Problem> {
        if signal == "t" {
            return Ok(self.trace.time.clone());
        }
        self.trace.values(signal).ok_or_else(|| format!("{signal} is not recorded").into())
    }

    /// The pictures that the patch asks for.
    pub fn pictures(&self) -> Result<Vec<Picture>, Problem> {
        let specs = &self.patch().pictures;
        let drawn = specs.iter().map(|spec| picture(&self.trace, spec, Some(self.settings())));
        Ok(drawn.collect::<Result<_, _>>()?)
    }

    /// One signal against another, both divided by what stands for 1 on its axis.
    pub fn points(&self, along: (&str, f64), up: (&str, f64)) -> Result<Vec<(f64, f64)>, Problem> {
        let [along_values, up_values] = [self.values(along.0)?, self.values(up.0)?];
        Ok(along_values.iter().zip(&up_values).map(|(x, y)| (x / along.1, y / up.1)).collect())
    }

    /// The critical velocities of its profile: swings above 0.25 mm/s within 0.04 s are oscillation.
    pub fn critical(&self) -> Result<Critical, Problem> {
        let read = self.measure("critical_velocity")?;
        Ok(Critical { rising: read[0], falling: read[1] })
    }

    /// What a measure reads off it, a number a column; nothing where it reads nothing.
    pub fn measure(&self, text: &str) -> Result<Vec<Option<f64>>, Problem> {
        let cells = Measure::parse(text, self.program.signals())?.read(&self.trace);
        Ok(cells.into_iter().map(|cell| cell.ok().and_then(number)).collect())
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

/// Critical velocities in m/s: the command at which oscillation ends while it rises, and begins while it falls.
#[derive(Debug, Clone, Copy)]
pub(super) struct Critical {
    pub rising: Option<f64>,
    pub falling: Option<f64>,
}

impl Critical {
    /// The rising one, in words.
    pub fn rising_told(&self) -> String {
        self.rising.map_or_else(|| "no rising command".to_owned(), told)
    }

    /// The falling one, in words.
    pub fn falling_told(&self) -> String {
        self.falling.map_or_else(|| "no falling command".to_owned(), told)
    }
}

/// A velocity, in words.
fn told(velocity: f64) -> String {
    Display::new("m/s", velocity).text(velocity)
}

/// The first number that was measured of a run of a sweep.
pub(super) fn first_number(row: &Row) -> Option<f64> {
    row.cells.first()?.clone().and_then(number)
}

/// The number in a cell.
pub(super) fn number(cell: Cell) -> Option<f64> {
    match cell {
        Cell::Number(number) => Some(number),
        Cell::Name(_) | Cell::Empty => None,
    }
}
