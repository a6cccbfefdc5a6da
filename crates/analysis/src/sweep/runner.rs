//! Computes the runs of a sweep: from parameter values to rows.
//!
//! A runner keeps compiled programs and only sets their parameters for each run, so nothing is parsed or compiled
//! again. Several runs are computed together if the solver is faster that way.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::Sweep;
use super::row::SweepRow;
use crate::instruments::unmet_condition;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, BLOCK_SAMPLES, RunError, RunSettings};
use patchcord_core::trace::{StepWarning, Trace};

/// The reason for a missing result if the solver panics.
const INTERNAL_ERROR: &str = "internal error; the message is on standard error";

/// Computes runs of a sweep with its own copies of the program.
#[derive(Debug)]
pub struct SweepRunner<'s> {
    /// The sweep with its plan, settings and measures.
    sweep: &'s Sweep,
    /// One program per run that is computed at the same time. Grows on demand.
    programs: Vec<Program>,
}

impl<'s> SweepRunner<'s> {
    /// A runner without programs; the first run copies one.
    pub(super) fn new(sweep: &'s Sweep) -> Self {
        SweepRunner { sweep, programs: Vec::new() }
    }

    /// Computes and measures one run. `values` are those of the varied parameters, in declared units. The result
    /// depends on nothing else. A failed run gives a row with an error code.
    ///
    /// Values outside the range of a parameter also give a row with an error code.
    pub fn row(&mut self, values: &[f64]) -> SweepRow {
        self.rows(&[values.to_vec()]).pop().unwrap_or_default()
    }

    /// Computes and measures several runs: one row per set of values, in order.
    pub fn rows(&mut self, values: &[Vec<f64>]) -> Vec<SweepRow> {
        let computed = catch_unwind(AssertUnwindSafe(|| self.compute(values)));
        let rows = computed.unwrap_or_else(|_| match values {
            [_] => vec![self.failed_row("panic", INTERNAL_ERROR.to_owned())],
            // Computing them one by one identifies the run that panics.
            _ => values.iter().map(|values| self.row(values)).collect(),
        });
        rows.into_iter().zip(values).map(|(row, values)| SweepRow { values: values.clone(), ..row }).collect()
    }

    /// Computes one run once more with checks of its steps. Returns the warning that they are too long; `None` if they
    /// are short enough.
    ///
    /// # Errors
    /// If the run fails or the solver panics. The error is the reason.
    pub(super) fn step_warning(&mut self, values: &[f64]) -> Result<Option<StepWarning>, String> {
        let outcome = catch_unwind(AssertUnwindSafe(|| self.run_with_checks(values)));
        let outcome = outcome.map_err(|_| INTERNAL_ERROR.to_owned())?;
        outcome.map(|trace| trace.step_warning).map_err(|error| error.to_string())
    }

    /// The trace of one run with checks of its steps. May panic.
    ///
    /// # Errors
    /// If the values are invalid or the run stops.
    fn run_with_checks(&mut self, values: &[f64]) -> Result<Trace, RunError> {
        self.set_parameters(&mut 0, values)?;
        solve::run(&self.programs[0], &self.settings_with_checks()).map_err(|stopped| stopped.error)
    }

    /// The settings of a run whose steps are checked. If the measures need no signal, the outputs of the integrators and
    /// lags are compared.
    fn settings_with_checks(&self) -> RunSettings {
        let settings = self.sweep.settings.clone().with_step_checks().with_blocks(BLOCK_SAMPLES);
        if settings.record.is_empty() { settings.with_signals(self.sweep.program.states()) } else { settings }
    }

    /// The rows without parameter values. May panic.
    fn compute(&mut self, values: &[Vec<f64>]) -> Vec<SweepRow> {
        let outcomes = self.run(values);
        let row = |outcome: Result<Trace, RunError>| match outcome {
            Ok(trace) => self.measured_row(&trace),
            Err(error) => self.failed_row(error.code(), error.to_string()),
        };
        outcomes.into_iter().map(row).collect()
    }

    /// The traces of all runs, in order.
    fn run(&mut self, values: &[Vec<f64>]) -> Vec<Result<Trace, RunError>> {
        let settings: Vec<_> =
            values.iter().scan(0, |next, values| Some(self.set_parameters(next, values))).collect();
        let count = settings.iter().filter(|setting| setting.is_ok()).count();
        let mut ended = solve::run_batch(&self.programs[..count], &self.sweep.settings).into_iter();
        let outcome = |setting: Result<(), RunError>| match setting {
            Ok(()) => Some(ended.next()?.map_err(|stopped| stopped.error)),
            Err(error) => Some(Err(error)),
        };
        settings.into_iter().filter_map(outcome).collect()
    }

    /// Sets the parameters of program number `next` and increments `next`. If the values are invalid, `next` stays the
    /// same, so the following run uses this program.
    fn set_parameters(&mut self, next: &mut usize, values: &[f64]) -> Result<(), RunError> {
        if *next == self.programs.len() {
            self.programs.push(self.sweep.program.clone());
        }
        let changes: Vec<_> = self.sweep.plan.names().zip(values.iter().copied()).collect();
        self.programs[*next].set_parameters(changes)?;
        *next += 1;
        Ok(())
    }

    /// The row of a completed run: one cell per column, and a note for each value that cannot be read.
    fn measured_row(&self, trace: &Trace) -> SweepRow {
        let mut row = SweepRow::default();
        for measure in &self.sweep.measures {
            for (column, cell) in measure.columns().into_iter().zip(measure.read(trace)) {
                match cell {
                    Ok(cell) => row.cells.push(Some(cell)),
                    Err(reason) => {
                        row.notes.push(format!("{}: {reason}", column.name));
                        row.cells.push(None);
                    }
                }
            }
        }
        let overload = trace.overloads().next();
        row.notes.extend(
            overload.map(|first| format!("overload of {} at t = {:.6} s", first.element, first.time)),
        );
        row.notes.extend(trace.phase_records.iter().filter_map(unmet_condition));
        row
    }

    /// The row of a failed run: empty cells, the error code and the message.
    fn failed_row(&self, code: &'static str, reason: String) -> SweepRow {
        let cells = self.sweep.measures.iter().map(|measure| measure.columns().len()).sum();
        SweepRow { cells: vec![None; cells], error: Some(code), notes: vec![reason], ..SweepRow::default() }
    }
}
