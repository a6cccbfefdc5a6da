//! The bench on which the runs of a sweep are made: from parameters to a row.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::Sweep;
use super::row::Row;
use crate::instruments::missed;
use patchcord_core::ir::Program;
use patchcord_core::solve::{self, RunError};
use patchcord_core::trace::Trace;

/// Programs of its own, on which the pots are turned for every run: nothing is read or lowered anew.
#[derive(Debug)]
pub struct Bench<'s> {
    sweep: &'s Sweep,
    /// One for each of the runs that are made side by side.
    programs: Vec<Program>,
}

impl<'s> Bench<'s> {
    pub(super) fn new(sweep: &'s Sweep) -> Self {
        Bench { sweep, programs: Vec::new() }
    }

    /// Makes a run with these values of the parameters that are varied, in their declared units, and measures it. It
    /// depends on nothing else, and gives a row whatever happens.
    pub fn row(&mut self, values: &[f64]) -> Row {
        self.rows(&[values.to_vec()]).pop().unwrap_or_default()
    }

    /// Makes several runs, and gives the row of each; side by side where that is quicker.
    pub fn rows(&mut self, values: &[Vec<f64>]) -> Vec<Row> {
        let made = catch_unwind(AssertUnwindSafe(|| self.made(values)));
        let rows = made.unwrap_or_else(|_| match values {
            [_] => vec![
                self.failed("panic", "a fault of this program itself, told on standard error".to_owned()),
            ],
            // Which of them broke off is seen when they are made alone.
            _ => values.iter().map(|values| self.row(values)).collect(),
        });
        rows.into_iter().zip(values).map(|(row, values)| Row { values: values.clone(), ..row }).collect()
    }

    fn made(&mut self, values: &[Vec<f64>]) -> Vec<Row> {
        let outcomes = self.run(values);
        let row = |outcome: Result<Trace, RunError>| match outcome {
            Ok(trace) => self.measured(&trace),
            Err(error) => self.failed(error.code(), error.to_string()),
        };
        outcomes.into_iter().map(row).collect()
    }

    fn run(&mut self, values: &[Vec<f64>]) -> Vec<Result<Trace, RunError>> {
        let set: Vec<_> =
            values.iter().scan(0, |place, values| Some(self.set_parameters(place, values))).collect();
        let count = set.iter().filter(|set| set.is_ok()).count();
        let mut ended = solve::run_abreast(&self.programs[..count], &self.sweep.settings).into_iter();
        let outcome = |set: Result<(), RunError>| match set {
            Ok(()) => Some(ended.next()?.map_err(|stopped| stopped.error)),
            Err(error) => Some(Err(error)),
        };
        set.into_iter().filter_map(outcome).collect()
    }

    /// Sets the parameters of the program at `place`, and moves `place` to the next program. If the parameters cannot have
    /// these values, `place` stays, and the next run takes that program.
    fn set_parameters(&mut self, place: &mut usize, values: &[f64]) -> Result<(), RunError> {
        if *place == self.programs.len() {
            self.programs.push(self.sweep.program.clone());
        }
        let changes: Vec<_> = self.sweep.plan.names().zip(values.iter().copied()).collect();
        self.programs[*place].set_parameters(changes)?;
        *place += 1;
        Ok(())
    }

    fn measured(&self, trace: &Trace) -> Row {
        let mut row = Row::default();
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
        let lit = trace.overloads().next();
        row.notes.extend(lit.map(|lit| format!("overload of {} at t = {:.6} s", lit.element, lit.time)));
        row.notes.extend(trace.marks.iter().filter_map(missed));
        row
    }

    fn failed(&self, code: &'static str, reason: String) -> Row {
        let cells = self.sweep.measures.iter().map(|measure| measure.columns().len()).sum();
        Row { cells: vec![None; cells], error: Some(code), notes: vec![reason], ..Row::default() }
    }
}
