//! Sweeps: one run for every combination of parameter values, on all cores, with one row of measures per run.
//!
//! `plan` and `axis_file` define the parameter values of each run, and `spacing` computes those of a range. `runner`
//! computes runs, in groups whose size `group_size` chooses. `step_check` chooses the rows whose steps are checked. `row`
//! formats the results and `journal` appends them to a CSV file. `fingerprint` identifies the inputs, so that an
//! interrupted sweep is only continued with the same inputs. The rows are identical, bit for bit, for any number of
//! threads and after any interruption.

mod axis_file;
mod error;
mod fingerprint;
mod group_size;
mod journal;
mod plan;
mod row;
mod runner;
mod spacing;
mod step_check;

pub use error::{JournalError, PlanError};
pub use plan::{Axis, Plan};
pub use row::SweepRow;
pub use runner::SweepRunner;
pub use step_check::RowStepWarning;

use std::io;
use std::path::Path;

use crate::instruments::{Measure, MeasureColumn};
use crate::parallel;
use fingerprint::{canonical_rows, canonical_run, canonical_tables, of_text};
use group_size::GroupSizer;
use journal::{Journal, fingerprint_line, first_line};
use patchcord_core::document::escape_controls;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::{Backend, LANES, Phase, RunError, RunSettings};
use patchcord_core::trace::format_exact;
use row::RowFormat;

/// A sweep: the runs, their settings, and the measures of each run.
///
/// # Examples
///
/// ```
/// use patchcord_analysis::instruments::Measure;
/// use patchcord_analysis::sweep::{Axis, Plan, Sweep};
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::RunSettings;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// // dx/dt = -k x, from x = 50 V
/// let integrator = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
/// let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
/// let patch = PatchBuilder::new("Decay").parameter("k", 0.5, "1", [0.0, 1.0]).run(1.0, 1e-3).record(["A1"]);
/// let patch = patch.element("A1", integrator).element("P1", pot).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
///
/// let plan = Plan::new([Axis::parse("k=0,1")?], &program)?;
/// let measures = [Measure::parse("voltmeter:A1", program.signals())?];
/// let sweep = Sweep::new(&patch, program, RunSettings::of(&circuit)?, plan, measures)?;
/// let mut csv = Vec::new();
/// let summary = sweep.write(&mut csv, 1, &mut |_| ())?;
/// assert_eq!((summary.written, summary.failed), (2, 0));
/// let csv = String::from_utf8(csv)?;
/// let rows: Vec<&str> = csv.lines().filter(|line| !line.starts_with('#')).collect();
/// assert_eq!(rows[..2], ["k,voltmeter:A1,error,note", "0,50,,"]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Sweep {
    /// The patch, for the name of its file and for the fingerprints.
    patch: Patch,
    /// The compiled patch, with the values of the parameters that are not varied.
    program: Program,
    /// The settings of each run. They record only the signals that the measures need.
    settings: RunSettings,
    /// The parameter values of each run.
    plan: Plan,
    /// The measures in the order of their columns.
    measures: Vec<Measure>,
}

/// Why a sweep is invalid.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The sweep has no measure.
    #[error("no measure is specified")]
    NoMeasure,
    /// Two columns have the same name. The field is the name.
    #[error("two columns are named {0}: remove the duplicate measure, or rename the parameter")]
    DuplicateColumn(String),
    /// A measure uses samples, but a run has two samples at the same time. The field is the measure.
    #[error("{0} cannot be read if a phase within a run waits for a relay or sets a parameter")]
    Phases(String),
    /// The run settings are invalid.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// The number of rows that one call found and wrote, and the warning about their steps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SweepSummary {
    /// Rows that the file already had.
    pub kept: u64,
    /// Rows that were written.
    pub written: u64,
    /// Rows, kept or written, of runs that failed.
    pub failed: u64,
    /// Rows, kept or written, of other runs with a note: a value could not be read, or an amplifier was overloaded.
    pub noted: u64,
    /// Set if the equal steps are too long for one of the rows that were written and checked: the warning with the
    /// shortest recommended step. One of 64 rows is checked, at least 1 and at most 8. Steps that adapt to a tolerance
    /// need no check.
    pub step_warning: Option<RowStepWarning>,
    /// The reason of every check that failed, in the order of the rows.
    pub failed_checks: Vec<String>,
}

impl SweepSummary {
    /// Counts a row that was written.
    fn add(&mut self, row: &SweepRow) {
        self.written += 1;
        self.count([row.error.is_some(), !row.notes.is_empty()]);
    }

    /// Counts a row by whether its run failed and whether it has a note.
    fn count(&mut self, [failed, noted]: [bool; 2]) {
        self.failed += u64::from(failed);
        self.noted += u64::from(noted && !failed);
    }
}

/// The largest number of results per worker that wait in memory for a slower run.
const MAX_WAITING: u64 = 64;
/// Workers per thread. While one waits for its next runs, the thread continues with the other.
const WORKERS_PER_THREAD: u64 = 2;
/// The largest number of recorded values that the runs of one group hold in memory. A single run may exceed it.
const MAX_RECORDED: f64 = 1e7;

/// The last two columns: the error code of a failed run, and the reasons for missing values and other warnings.
const LAST_COLUMNS: [&str; 2] = ["error", "note"];

impl Sweep {
    /// Creates a sweep. `program` is compiled from `patch`, possibly with other parameter values. Only the signals that
    /// the measures need are recorded, whatever the settings specify. The settings need no checks of the steps and no
    /// blocks, and both are ignored.
    ///
    /// # Errors
    /// If there is no measure, a measure does not suit such runs, two columns have the same name, or the settings are
    /// invalid.
    pub fn new(
        patch: &Patch,
        program: Program,
        mut settings: RunSettings,
        plan: Plan,
        measures: impl IntoIterator<Item = Measure>,
    ) -> Result<Sweep, SweepError> {
        let measures: Vec<Measure> = measures.into_iter().collect();
        if measures.is_empty() {
            return Err(SweepError::NoMeasure);
        }
        if let Some(measure) =
            measures.iter().find(|measure| measure.is_sampled() && has_double_samples(&settings.phases))
        {
            return Err(SweepError::Phases(measure.text()));
        }
        let mut record: Vec<String> = Vec::new();
        for signal in measures.iter().flat_map(Measure::signals) {
            if !record.iter().any(|recorded| recorded == signal) {
                record.push(signal.to_owned());
            }
        }
        settings.record = record;
        settings.sensitivities = Vec::new();
        settings.has_lamps = true;
        (settings.checks_steps, settings.block_samples) = (false, None);
        settings.check()?;
        let sweep = Sweep { patch: patch.clone(), program, settings, plan, measures };
        let names = sweep.column_names();
        match names.iter().enumerate().find(|(index, name)| names[..*index].contains(name)) {
            Some((_, duplicate)) => Err(SweepError::DuplicateColumn(duplicate.clone())),
            None => Ok(sweep),
        }
    }

    /// The settings of each run.
    pub fn settings(&self) -> &RunSettings {
        &self.settings
    }

    /// The plan of the sweep.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The columns of varied parameters and measures. The columns "error" and "note" follow them in the file.
    pub fn columns(&self) -> Vec<MeasureColumn> {
        let unit = |name: &str| {
            plan::parameter(&self.program, name)
                .map_or_else(|_| String::new(), |parameter| parameter.declared.unit.clone())
        };
        let varied = self.plan.names().map(|name| MeasureColumn { name: name.to_owned(), unit: unit(name) });
        varied.chain(self.measures.iter().flat_map(Measure::columns)).collect()
    }

    /// The names of all columns, including "error" and "note".
    fn column_names(&self) -> Vec<String> {
        let last = LAST_COLUMNS.map(str::to_owned);
        self.columns().into_iter().map(|column| column.name).chain(last).collect()
    }

    /// A runner that computes single runs of this sweep.
    pub fn runner(&self) -> SweepRunner<'_> {
        SweepRunner::new(self)
    }

    /// The head of the file: comment lines that identify the sweep, units, and the names of the columns.
    pub fn head(&self) -> String {
        let name = Path::new(self.patch.file()).file_name().unwrap_or_default().to_string_lossy();
        let mut lines = vec![first_line(), format!("patch: {name}")];
        lines.extend(self.plan.texts().iter().map(|axis| format!("vary: {axis}")));
        lines.push(format!("with: {}", self.constant_parameters()));
        lines.push(format!("run: {}", self.run_text()));
        lines.extend(self.backend_text());
        lines.extend(self.measures.iter().map(|measure| format!("measure: {}", measure.text())));
        lines.extend(self.fingerprints());
        let units = self.columns().into_iter().filter(|column| !column.unit.is_empty());
        lines.extend(units.map(|column| format!("{}: {}", column.name, column.unit)));
        let one_line = |line: String| {
            let words: Vec<&str> = line.split_whitespace().collect();
            format!("# {}\n", escape_controls(&words.join(" ")))
        };
        lines.into_iter().map(one_line).collect::<String>() + &row::csv_line(&self.column_names())
    }

    /// The parameters that are not varied, in their declared units.
    fn constant_parameters(&self) -> String {
        let constant = self
            .program
            .parameters()
            .iter()
            .filter(|parameter| self.plan.names().all(|name| name != parameter.declared.name));
        let texts = constant.map(|parameter| {
            let declared = &parameter.declared;
            format!("{}={}", declared.name, format_exact(parameter.value / declared.per_unit))
        });
        texts.collect::<Vec<_>>().join(",")
    }

    /// Length, step and recording interval of the runs.
    fn run_text(&self) -> String {
        let RunSettings { step, tolerance, every, .. } = &self.settings;
        let step = match tolerance {
            Some(tolerance) => format!("tolerance {}", format_exact(*tolerance)),
            None => format!("step {} s", format_exact(*step)),
        };
        let length = match self.settings.phases.as_slice() {
            [Phase::InitialCondition, Phase::Operate { time, until: None }] => {
                format!("for {} s", format_exact(*time))
            }
            _ => format!("phases, {} s at most", format_exact(self.settings.total_duration())),
        };
        format!("{length}, {step}, recorded every {} s", format_exact(*every))
    }

    /// The backend if it affects the rows. Only the reference backend with a fixed step gives different bits.
    fn backend_text(&self) -> Option<String> {
        let RunSettings { backend, tolerance, .. } = self.settings;
        let affects_rows = backend == Backend::Reference && tolerance.is_none();
        affects_rows.then(|| format!("backend: {backend}"))
    }

    /// Fingerprints of all inputs that affect the rows and that no other line of the head contains.
    fn fingerprints(&self) -> impl Iterator<Item = String> {
        let varied: Vec<&str> = self.plan.names().collect();
        let prints = [
            ("the patch", Some(canonical_run(&self.patch, &self.program, &self.settings, &varied))),
            ("the patch's tables", canonical_tables(&self.patch)),
            ("the file of rows", canonical_rows(self.plan.rows())),
        ];
        let text = |(of, text): (&str, Option<String>)| Some(fingerprint_line(of, &of_text(&text?)));
        prints.into_iter().filter_map(text)
    }

    /// Computes all runs on `threads` threads, and writes head and rows. For `progress` see [`Sweep::append_to`].
    ///
    /// # Errors
    /// If the writer returns an error.
    pub fn write(
        &self,
        out: &mut dyn io::Write,
        threads: usize,
        progress: &mut dyn FnMut(u64),
    ) -> io::Result<SweepSummary> {
        out.write_all(self.head().as_bytes())?;
        let none = SweepSummary::default();
        self.compute_remaining(none, threads, progress, |line| {
            out.write_all(line.as_bytes()).and_then(|()| out.flush())
        })
    }

    /// Computes the runs that a file does not have yet on `threads` threads, and appends their rows. Creates the file
    /// if it does not exist. `progress` receives the number of rows: at the start, after every row, and every second
    /// without a row.
    ///
    /// # Errors
    /// If the file belongs to another sweep, has a row that no sweep has written, cannot be written, or is changed by
    /// others during the sweep. The existing rows are then unchanged.
    pub fn append_to(
        &self,
        path: impl AsRef<Path>,
        threads: usize,
        progress: &mut dyn FnMut(u64),
    ) -> Result<SweepSummary, JournalError> {
        let beginning = |run| row::beginning(&self.plan.values(run));
        let mut existing = SweepSummary::default();
        let format = RowFormat::new(self.column_names(), &self.measures, &self.program);
        let inspect = |line: &[u8]| format.check(line).map(|found| existing.count(found));
        let mut journal = Journal::open(path.as_ref(), &self.head(), self.plan.runs(), beginning, inspect)?;
        existing.kept = journal.rows;
        let summary = self.compute_remaining(existing, threads, progress, |line| journal.append(line))?;
        journal.check_unchanged()?;
        Ok(summary)
    }

    /// The largest number of runs that a thread computes together. Its first run is computed alone.
    fn largest_group(&self, remaining: u64, threads: u64) -> u64 {
        if !self.settings.is_batchable(&self.program) {
            return 1;
        }
        let limit = (MAX_RECORDED / self.settings.recorded_numbers()) as u64;
        even_group(remaining.saturating_sub(threads), threads, limit.clamp(1, LANES as u64))
    }

    /// Computes the runs after the existing rows, and passes their rows to `write` in order. The steps of some of these
    /// runs are checked at the end, so that an interruption of the checks loses no row.
    fn compute_remaining<E>(
        &self,
        existing: SweepSummary,
        threads: usize,
        progress: &mut dyn FnMut(u64),
        mut write: impl FnMut(&str) -> Result<(), E>,
    ) -> Result<SweepSummary, E> {
        let first = existing.kept;
        let remaining = self.plan.runs().saturating_sub(first);
        let threads = (threads.max(1) as u64).min(remaining.max(1));
        let group = self.largest_group(remaining, threads);
        let workers =
            (0..threads * WORKERS_PER_THREAD).map(|_| (self.runner(), GroupSizer::new(group))).collect();
        let checked = self.rows_to_check(remaining);
        let (mut summary, mut values_to_check) = (existing, Vec::new());
        progress(first);
        parallel::run_in_order(
            0..remaining,
            MAX_WAITING,
            threads as usize,
            workers,
            |(_, sizer)| sizer.size(),
            |(runner, sizer), runs| {
                let values: Vec<_> = runs.clone().map(|run| self.plan.values(first + run)).collect();
                sizer.timed(runs.end - runs.start, || runner.rows(&values))
            },
            |result: Option<SweepRow>| {
                if let Some(row) = result {
                    if row.error.is_none() && checked.contains(&summary.written) {
                        values_to_check.push(row.values.clone());
                    }
                    summary.add(&row);
                    write(&row.line())?;
                }
                progress(first + summary.written);
                Ok(())
            },
        )?;
        let rows = first + summary.written;
        self.check_steps(&values_to_check, threads as usize, &mut summary, &mut || progress(rows));
        Ok(summary)
    }
}

/// The group size, at most `max`, that gives every thread the same number of groups.
fn even_group(runs: u64, threads: u64, max: u64) -> u64 {
    let groups = runs.div_ceil(max).next_multiple_of(threads);
    runs.div_ceil(groups.max(1)).max(1)
}

/// Whether a relay ends a phase, or a parameter is set, within the last run. The record then has two samples at that
/// time.
fn has_double_samples(phases: &[Phase]) -> bool {
    let (mut is_running, mut found) = (false, false);
    let mut inspect = |phase: &Phase| match phase {
        Phase::InitialCondition => (is_running, found) = (false, false),
        Phase::Operate { until, .. } => (is_running, found) = (true, found || until.is_some()),
        Phase::Hold { .. } => is_running = true,
        Phase::Set { .. } => found |= is_running,
        Phase::Repeat { .. } => (),
    };
    phases.iter().for_each(|phase| phase.for_each(&mut inspect));
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_of_even_size() {
        let shares = [(1000, 2), (100, 2), (20, 4), (3, 8), (0, 1), (1_000_000, 64)];
        assert_eq!(shares.map(|(runs, threads)| even_group(runs, threads, 16)), [16, 13, 5, 1, 1, 16]);
    }
}
