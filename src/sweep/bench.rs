//! The bench on which the runs of a sweep are made: from parameters to a row.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::Sweep;
use super::row::Row;
use crate::instruments::missed;
use crate::program::Program;
use crate::solve::{self, RunError};
use crate::trace::Trace;

/// A program of its own, on which the pots are turned for every run: nothing is read or lowered anew.
#[derive(Debug)]
pub struct Bench<'s> {
    sweep: &'s Sweep,
    program: Program,
}

impl<'s> Bench<'s> {
    pub(super) fn new(sweep: &'s Sweep) -> Self {
        Bench { sweep, program: sweep.program.clone() }
    }

    /// Makes a run with these values of the parameters that are varied, in their declared units, and measures it. It
    /// depends on nothing else, and gives a row whatever happens.
    pub fn row(&mut self, values: &[f64]) -> Row {
        let outcome = catch_unwind(AssertUnwindSafe(|| self.run(values).map(|trace| self.measured(&trace))));
        let row = match outcome {
            Ok(Ok(row)) => row,
            Ok(Err(error)) => self.failed(error.code(), error.to_string()),
            Err(_) => {
                self.failed("panic", "a fault of this program itself, told on standard error".to_owned())
            }
        };
        Row { values: values.to_vec(), ..row }
    }

    fn run(&mut self, values: &[f64]) -> Result<Trace, RunError> {
        let changes: Vec<_> = self.sweep.plan.names().zip(values.iter().copied()).collect();
        solve::preset(&mut self.program, &changes)?;
        solve::run(&self.program, &self.sweep.settings).map_err(|stopped| stopped.error)
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
