//! Chooses the rows of a sweep whose equal steps are checked, and keeps the worst warning.
//!
//! The run of such a row is computed once more with checks of its steps. The rows are spread evenly over the sweep. Their
//! choice depends on nothing except the number of rows.

use std::convert::Infallible;

use super::{Sweep, SweepSummary};
use crate::parallel;
use patchcord_core::low_discrepancy::golden_place;
use patchcord_core::trace::StepWarning;

/// The warning that the equal steps of a row are too long.
#[derive(Debug, Clone, PartialEq)]
pub struct RowStepWarning {
    /// Values of the varied parameters in this row, in their declared units, in the order of the plan.
    pub values: Vec<f64>,
    /// The warning.
    pub warning: StepWarning,
}

/// The warning about the steps of a row, `None` if they are short enough, or the reason why the check failed.
type CheckOutcome = Result<Option<StepWarning>, String>;

/// Number of rows for which one is checked, so that the checks of many rows take a small share of the time. The check of
/// a row takes as long as its run. It takes three times as long if the run is compared with one of half the step.
const ROWS_PER_CHECK: u64 = 64;
/// Largest number of rows that are checked.
const MAX_CHECKED_ROWS: u64 = 8;

/// The rows that are checked among this number of rows, counted from 0, in ascending order. Each is at another place of
/// an equal part of the rows. The places have no period that agrees with that of the axis that changes fastest.
fn checked_rows(rows: u64) -> Vec<u64> {
    let count = (rows / ROWS_PER_CHECK).clamp(1, MAX_CHECKED_ROWS).min(rows);
    let part_length = rows as f64 / count.max(1) as f64;
    let row = |part: u64| ((part as f64 + golden_place(part + 1)) * part_length) as u64;
    (0..count).map(row).collect()
}

impl Sweep {
    /// The rows whose steps are checked among the remaining rows, counted from the first of these. Steps that adapt to a
    /// tolerance need no check.
    pub(super) fn rows_to_check(&self, remaining: u64) -> Vec<u64> {
        if self.settings.tolerance.is_some() { Vec::new() } else { checked_rows(remaining) }
    }

    /// Checks the steps of runs on `threads` threads, and adds the results to a summary in their order. `rows` are the
    /// values of the varied parameters. `progress` is called after every check, and every second without one.
    pub(super) fn check_steps(
        &self,
        rows: &[Vec<f64>],
        threads: usize,
        summary: &mut SweepSummary,
        progress: &mut dyn FnMut(),
    ) {
        let threads = threads.min(rows.len()).max(1);
        let runners: Vec<_> = (0..threads).map(|_| self.runner()).collect();
        let Ok(()) = parallel::run_in_order(
            0..rows.len() as u64,
            MAX_CHECKED_ROWS,
            threads,
            runners,
            |_| 1,
            |runner, range| {
                let check = |row: u64| (row as usize, runner.step_warning(&rows[row as usize]));
                range.map(check).collect()
            },
            |result: Option<(usize, CheckOutcome)>| {
                if let Some((row, outcome)) = result {
                    summary.add_check(&rows[row], outcome);
                }
                progress();
                Ok::<(), Infallible>(())
            },
        );
    }
}

impl SweepSummary {
    /// Adds the outcome of a check of the row with these values.
    fn add_check(&mut self, values: &[f64], outcome: CheckOutcome) {
        match outcome {
            Ok(Some(warning)) => self.add_step_warning(values, warning),
            Ok(None) => (),
            Err(reason) => self.failed_checks.push(reason),
        }
    }

    /// Keeps the warning of a row if it is worse than those of the rows before: if its recommended step is shorter.
    fn add_step_warning(&mut self, values: &[f64], warning: StepWarning) {
        let worst = self.step_warning.as_ref().map(|worst| worst.warning.recommended);
        if worst.is_none_or(|worst| warning.recommended < worst) {
            self.step_warning = Some(RowStepWarning { values: values.to_vec(), warning });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::trace::StepCause;

    /// A warning that recommends a step.
    fn warning(recommended: f64) -> StepWarning {
        let (signal, unit) = ("x".to_owned(), "V".to_owned());
        let (cause, step, compared_step) = (StepCause::Inaccurate, 1.0, 0.5);
        StepWarning { signal, error: 1.0, unit, time: 0.0, cause, step, compared_step, recommended }
    }

    #[test]
    fn the_worst_warning_and_all_failures_are_kept() {
        let mut summary = SweepSummary::default();
        let outcomes = [Ok(None), Ok(Some(warning(0.1))), Err("one".to_owned()), Ok(Some(warning(0.05)))];
        let outcomes = outcomes.into_iter().chain([Ok(Some(warning(0.5))), Err("two".to_owned())]);
        for (row, outcome) in outcomes.enumerate() {
            summary.add_check(&[row as f64], outcome);
        }
        assert_eq!(summary.step_warning, Some(RowStepWarning { values: vec![3.0], warning: warning(0.05) }));
        assert_eq!(summary.failed_checks, ["one", "two"]);
    }

    #[test]
    fn checked_rows_are_spread_over_the_sweep() {
        let cases: [(u64, &[u64]); 6] = [
            (0, &[]),
            (1, &[0]),
            (2, &[1]),
            (127, &[78]),
            (128, &[39, 79]),
            (512, &[39, 79, 182, 222, 261, 365, 404, 508]),
        ];
        for (rows, expected) in cases {
            assert_eq!(checked_rows(rows), expected, "{rows}");
        }
        let many = checked_rows(1_000_000_000);
        assert!(many.len() == 8 && many.is_sorted() && many[7] < 1_000_000_000, "{many:?}");
    }
}
