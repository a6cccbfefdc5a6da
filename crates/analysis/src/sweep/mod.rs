//! Sweeps: one run for every combination of parameters, on all cores, a row of measures for each.
//!
//! The rows are the same to the bit whatever the number of threads, and whether or not the sweep was killed and gone
//! on with in between.

mod bench;
mod error;
mod fingerprint;
mod journal;
mod pace;
mod plan;
mod row;
mod table;

pub use bench::Bench;
pub use error::{JournalError, PlanError};
pub use plan::{Axis, Plan};
pub use row::Row;

use std::io;
use std::path::Path;

use crate::instruments::{Column, Measure};
use crate::pool;
use fingerprint::{canonical_rows, canonical_run, canonical_tables, of_text};
use journal::{Journal, fingerprint_line, first_line};
use pace::Pace;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_core::solve::LANES;
use patchcord_core::solve::{Backend, Phase, RunError, RunSettings};
use patchcord_core::trace::number;

/// Which runs are made, how, and what is measured of each.
#[derive(Debug)]
pub struct Sweep {
    patch: Patch,
    program: Program,
    settings: RunSettings,
    plan: Plan,
    measures: Vec<Measure>,
}

/// Why there is no sweep.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// Nothing is measured.
    #[error("nothing is measured")]
    NoMeasure,
    /// Two columns would have the same name.
    #[error("two columns would be called {0}: measure it once, or name the parameter otherwise")]
    SameColumn(String),
    /// A measure of samples that rise in time, of runs in which two stand at one instant.
    #[error("{0} cannot be read of a run within which a phase waits for a relay or sets a parameter")]
    Phases(String),
    /// The settings make no run.
    #[error(transparent)]
    Run(#[from] RunError),
}

/// What was done by one call.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tally {
    /// Rows that stood there already.
    pub kept: u64,
    /// Rows written.
    pub written: u64,
    /// Rows among all these of runs that failed.
    pub failed: u64,
    /// Rows among them of other runs of which something could not be read, or in which something was overloaded.
    pub noted: u64,
}

impl Tally {
    fn add(&mut self, row: &Row) {
        self.written += 1;
        self.count([row.error.is_some(), !row.notes.is_empty()]);
    }

    /// Counts a run by whether it failed, and whether there is a note on it.
    fn count(&mut self, [failed, noted]: [bool; 2]) {
        self.failed += u64::from(failed);
        self.noted += u64::from(noted && !failed);
    }
}

/// So many runs for each thread may wait in memory for a slower one before them.
const AHEAD: u64 = 64;
/// What is recorded of all runs that a thread makes side by side comes to no more numbers, unless that of one does.
const MOST_NUMBERS: f64 = 1e7;

/// The last two columns: the code of what went wrong, and in words why cells are empty and what to know of the rest.
const LAST_COLUMNS: [&str; 2] = ["error", "note"];

impl Sweep {
    /// A sweep of the runs of a plan. `program` is made from `patch`, perhaps with other parameters. Only the signals that the
    /// measures read are recorded, whatever the settings say.
    ///
    /// # Errors
    /// When nothing is measured, a measure cannot be read of such runs, two columns would have the same name, or the
    /// settings make no run.
    pub fn new(
        patch: &Patch,
        program: Program,
        settings: RunSettings,
        plan: Plan,
        measures: Vec<Measure>,
    ) -> Result<Sweep, SweepError> {
        if measures.is_empty() {
            return Err(SweepError::NoMeasure);
        }
        if let Some(measure) = measures.iter().find(|measure| measure.is_sampled() && jumps(&settings.phases))
        {
            return Err(SweepError::Phases(measure.text()));
        }
        let mut record: Vec<String> = Vec::new();
        for signal in measures.iter().flat_map(Measure::signals) {
            if !record.iter().any(|recorded| recorded == signal) {
                record.push(signal.to_owned());
            }
        }
        let settings = RunSettings { record, sensitivities: Vec::new(), lamps: true, ..settings };
        settings.check()?;
        let sweep = Sweep { patch: patch.clone(), program, settings, plan, measures };
        let names = sweep.column_names();
        match names.iter().enumerate().find(|(at, name)| names[..*at].contains(name)) {
            Some((_, twice)) => Err(SweepError::SameColumn(twice.clone())),
            None => Ok(sweep),
        }
    }

    /// How it is run.
    pub fn settings(&self) -> &RunSettings {
        &self.settings
    }

    /// Its plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The columns: the parameters varied, and what is measured. Behind them stand "error" and "note".
    pub fn columns(&self) -> Vec<Column> {
        let unit = |name: &str| {
            let slot = self.program.parameters().iter().find(|slot| slot.name == name);
            slot.map_or_else(String::new, |slot| slot.unit.clone())
        };
        let varied = self.plan.names().map(|name| Column { name: name.to_owned(), unit: unit(name) });
        varied.chain(self.measures.iter().flat_map(Measure::columns)).collect()
    }

    fn column_names(&self) -> Vec<String> {
        let last = LAST_COLUMNS.map(str::to_owned);
        self.columns().into_iter().map(|column| column.name).chain(last).collect()
    }

    /// A bench on which its runs are made, one after the other.
    pub fn bench(&self) -> Bench<'_> {
        Bench::new(self)
    }

    /// What stands above the rows: comment lines that tell of which sweep they are, units, and the names of the
    /// columns.
    pub fn head(&self) -> String {
        let name = Path::new(self.patch.file()).file_name().unwrap_or_default().to_string_lossy();
        let mut lines = vec![first_line(), format!("patch: {name}")];
        lines.extend(self.plan.texts().iter().map(|axis| format!("vary: {axis}")));
        lines.push(format!("with: {}", self.kept_parameters()));
        lines.push(format!("run: {}", self.run_told()));
        lines.extend(self.backend_told());
        lines.extend(self.measures.iter().map(|measure| format!("measure: {}", measure.text())));
        lines.extend(self.fingerprints());
        let units = self.columns().into_iter().filter(|column| !column.unit.is_empty());
        lines.extend(units.map(|column| format!("{}: {}", column.name, column.unit)));
        let one_line =
            |line: String| format!("# {}\n", line.split_whitespace().collect::<Vec<_>>().join(" "));
        lines.into_iter().map(one_line).collect::<String>() + &row::csv_line(&self.column_names())
    }

    /// The parameters that are not varied, in their declared units.
    fn kept_parameters(&self) -> String {
        let kept =
            self.program.parameters().iter().filter(|slot| self.plan.names().all(|name| name != slot.name));
        let told = kept.map(|slot| format!("{}={}", slot.name, number(slot.value / slot.per_unit)));
        told.collect::<Vec<_>>().join(",")
    }

    fn run_told(&self) -> String {
        let RunSettings { step, tolerance, every, .. } = &self.settings;
        let step = match tolerance {
            Some(tolerance) => format!("tolerance {}", number(*tolerance)),
            None => format!("step {} s", number(*step)),
        };
        let length = match self.settings.phases.as_slice() {
            [Phase::InitialCondition, Phase::Operate { time, until: None }] => {
                format!("for {} s", number(*time))
            }
            _ => format!("phases, {} s at most", number(self.settings.whole())),
        };
        format!("{length}, {step}, recorded every {} s", number(*every))
    }

    /// All backends but the reference give the same bits, and with a tolerance all do.
    fn backend_told(&self) -> Option<String> {
        let RunSettings { backend, tolerance, .. } = self.settings;
        let decides = backend == Backend::Reference && tolerance.is_none();
        decides.then(|| format!("backend: {backend}"))
    }

    /// Fingerprints of everything that the rows depend on and that no other line of the head contains.
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

    /// Makes all runs on so many threads, and writes head and rows. `progress` is told what [`Sweep::append_to`] tells it.
    ///
    /// # Errors
    /// When the writer refuses.
    pub fn write(
        &self,
        out: &mut dyn io::Write,
        threads: usize,
        progress: &mut dyn FnMut(u64),
    ) -> io::Result<Tally> {
        out.write_all(self.head().as_bytes())?;
        let none = Tally::default();
        self.rows_behind(none, threads, progress, |line| {
            out.write_all(line.as_bytes()).and_then(|()| out.flush())
        })
    }

    /// Makes the runs that a file does not hold yet, on so many threads, and appends their rows; makes the file where
    /// there is none. `progress` is told how many rows there are: at the beginning, with every row, and every second that brings
    /// none.
    ///
    /// # Errors
    /// When the file is of another sweep or cannot be written. What was there is then as it was.
    pub fn append_to(
        &self,
        path: &Path,
        threads: usize,
        progress: &mut dyn FnMut(u64),
    ) -> Result<Tally, JournalError> {
        let beginning = |run| row::beginning(&self.plan.values(run));
        let mut there = Tally::default();
        let look = |line: &[u8]| there.count(row::error_and_note(line));
        let mut journal = Journal::open(path, &self.head(), self.plan.runs(), beginning, look)?;
        there.kept = journal.rows;
        self.rows_behind(there, threads, progress, |line| journal.append(line))
    }

    /// How many runs a thread makes side by side at most; the first it makes alone.
    fn abreast(&self, left: u64, threads: u64) -> u64 {
        if !self.settings.go_abreast(&self.program) {
            return 1;
        }
        let room = (MOST_NUMBERS / self.settings.numbers()) as u64;
        evenly(left.saturating_sub(threads), threads, room.clamp(1, LANES as u64))
    }

    /// Makes the runs behind those that are there, and gives their rows to the writer in order.
    fn rows_behind<E>(
        &self,
        there: Tally,
        threads: usize,
        progress: &mut dyn FnMut(u64),
        mut write: impl FnMut(&str) -> Result<(), E>,
    ) -> Result<Tally, E> {
        let first = there.kept;
        let left = self.plan.runs().saturating_sub(first);
        let threads = (threads.max(1) as u64).min(left.max(1));
        let abreast = self.abreast(left, threads);
        let benches = (0..threads).map(|_| (self.bench(), Pace::new(abreast))).collect();
        let mut tally = there;
        progress(first);
        pool::in_order(
            0..left,
            AHEAD,
            benches,
            |(_, pace)| pace.runs(),
            |(bench, pace), runs| {
                let count = runs.end - runs.start;
                let values: Vec<_> = runs.map(|run| self.plan.values(first + run)).collect();
                pace.make(count, || bench.rows(&values))
            },
            |row: Option<Row>| {
                row.iter().try_for_each(|row| {
                    tally.add(row);
                    write(&row.line())
                })?;
                progress(first + tally.written);
                Ok(())
            },
        )?;
        Ok(tally)
    }
}

/// How many runs make a group, so many at most, that every thread gets as many groups.
fn evenly(runs: u64, threads: u64, most: u64) -> u64 {
    let groups = runs.div_ceil(most).next_multiple_of(threads);
    runs.div_ceil(groups.max(1)).max(1)
}

/// Whether a relay or a hand ends a phase within the last run, where the record then has two samples.
fn jumps(phases: &[Phase]) -> bool {
    let (mut ran, mut jumps) = (false, false);
    let mut look = |phase: &Phase| match phase {
        Phase::InitialCondition => (ran, jumps) = (false, false),
        Phase::Operate { until, .. } => (ran, jumps) = (true, jumps || until.is_some()),
        Phase::Hold { .. } => ran = true,
        Phase::Set { .. } => jumps |= ran,
        Phase::Repeat { .. } => (),
    };
    phases.iter().for_each(|phase| phase.for_each(&mut look));
    jumps
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_are_shared_out_evenly() {
        let shares = [(1000, 2), (100, 2), (20, 4), (3, 8), (0, 1), (1_000_000, 64)];
        assert_eq!(shares.map(|(runs, threads)| evenly(runs, threads, 16)), [16, 13, 5, 1, 1, 16]);
    }
}
