//! Straight loops as affine forms: every operation is an affine form of the tears in each of its pieces.
//!
//! A piece is one choice of a limit, a diode or a table. It has tests, which are affine forms that must not be negative
//! in it.

use super::Problem;
use crate::ir::number::segment_after;
use crate::ir::op::{Op, Register};

/// The affine forms of the tears and operations of a loop. A form has a coefficient for every tear, and last the
/// constant.
pub(super) struct Forms<'a> {
    /// The loop.
    problem: &'a Problem<'a>,
    /// The forms one after another, those of the tears first.
    entries: Vec<f64>,
}

/// A form that must not be negative in a piece.
pub(super) struct Test {
    /// The form.
    pub form: Vec<f64>,
    /// The piece where it is negative.
    pub beyond: usize,
}

impl<'a> Forms<'a> {
    /// The forms of the tears. Those of the operations are not known yet.
    pub(super) fn new(problem: &'a Problem<'a>) -> Self {
        let (order, span) = (problem.order(), problem.order() + problem.entry.operations.len());
        let mut entries = vec![0.0; span * (order + 1)];
        (0..order).for_each(|tear| entries[tear * (order + 1) + tear] = 1.0);
        Forms { problem, entries }
    }

    /// The operation with this index, counted from the first tear.
    pub(super) fn op(&self, at: usize) -> Op {
        self.problem.program.lowered.body[self.problem.outside.len() + at]
    }

    /// Sets the form of an operation.
    pub(super) fn set(&mut self, at: usize, form: &[f64]) {
        let width = form.len();
        self.entries[at * width..(at + 1) * width].copy_from_slice(form);
    }

    /// The form of a register.
    pub(super) fn get(&self, register: Register) -> Vec<f64> {
        let width = self.problem.order() + 1;
        match register.index().checked_sub(self.problem.outside.len()) {
            Some(at) => self.entries[at * width..(at + 1) * width].to_vec(),
            None => {
                let mut form = vec![0.0; width];
                form[width - 1] = self.problem.outside[register.index()];
                form
            }
        }
    }

    /// The form a - b.
    pub(super) fn difference(&self, a: Register, b: Register) -> Vec<f64> {
        combined(&self.get(a), -1.0, &self.get(b))
    }

    /// The form of which the sign decides between the pieces 0 (not negative) and 1; `None` if the operation has one
    /// piece or is a table.
    pub(super) fn sign_test(&self, op: Op) -> Option<Vec<f64>> {
        match op {
            Op::Minimum(a, b) | Op::Maximum(a, b) => Some(self.difference(a, b)),
            Op::Absolute(a) => Some(self.get(a)),
            _ => None,
        }
    }

    /// The form of an operation in one of its pieces. Segment n of a table begins at point n - 1.
    pub(super) fn piece(&self, op: Op, piece: usize) -> Vec<f64> {
        let constant = self.problem.order();
        match op {
            Op::Add(a, b) => combined(&self.get(a), 1.0, &self.get(b)),
            Op::Subtract(a, b) => self.difference(a, b),
            Op::Multiply(a, b) => product(self.get(a), self.get(b)),
            Op::Divide(a, b) => {
                let divisor = self.get(b)[constant];
                self.get(a).iter().map(|term| term / divisor).collect()
            }
            Op::Minimum(a, b) => self.get(if piece == 0 { b } else { a }),
            Op::Maximum(a, b) => self.get(if piece == 0 { a } else { b }),
            Op::Absolute(a) if piece == 0 => self.get(a),
            Op::Absolute(a) => scaled(&self.get(a), -1.0),
            Op::Select { left, right, then, otherwise } => {
                let test = self.difference(left, right)[constant];
                self.get(if test >= 0.0 { then } else { otherwise })
            }
            Op::Table(table, at) => {
                let (value, slope, origin) =
                    segment_after(&self.problem.program.tables[table as usize], piece);
                let mut form = scaled(&self.get(at), slope);
                form[constant] += value - slope * origin;
                form
            }
            _ => vec![f64::NAN; constant + 1],
        }
    }

    /// The tests of an operation in one of its pieces.
    pub(super) fn tests(&self, op: Op, piece: usize) -> Vec<Test> {
        if let Some(test) = self.sign_test(op) {
            let form = if piece == 0 { test } else { scaled(&test, -1.0) };
            return vec![Test { form, beyond: 1 - piece }];
        }
        let Op::Table(table, at) = op else { return Vec::new() };
        let points = &self.problem.program.tables[table as usize];
        let (abscissa, constant) = (self.get(at), self.problem.order());
        let mut tests = Vec::new();
        if piece > 0 {
            let mut form = abscissa.clone();
            form[constant] -= points[piece - 1][0];
            tests.push(Test { form, beyond: piece - 1 });
        }
        if piece < points.len() {
            let mut form = scaled(&abscissa, -1.0);
            form[constant] += points[piece][0];
            tests.push(Test { form, beyond: piece + 1 });
        }
        tests
    }

    /// The linear equations of the tears by rows, and their right-hand sides: every tear equals its recomputed output.
    pub(super) fn equations(&self) -> (Vec<f64>, Vec<f64>) {
        let order = self.problem.order();
        let (mut rows, mut sides) = (Vec::with_capacity(order * order), Vec::with_capacity(order));
        for (position, tear) in self.problem.entry.tears.iter().enumerate() {
            let form = self.get(tear.result);
            rows.extend((0..order).map(|column| if column == position { 1.0 } else { 0.0 } - form[column]));
            sides.push(form[order]);
        }
        (rows, sides)
    }
}

/// The value of an affine form.
pub(super) fn value(form: &[f64], tears: &[f64]) -> f64 {
    form[tears.len()] + form.iter().zip(tears).map(|(slope, tear)| slope * tear).sum::<f64>()
}

/// a + factor b.
fn combined(a: &[f64], factor: f64, b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
}

/// factor form.
fn scaled(form: &[f64], factor: f64) -> Vec<f64> {
    form.iter().map(|term| factor * term).collect()
}

/// The product of two forms, of which one is a constant.
fn product(a: Vec<f64>, b: Vec<f64>) -> Vec<f64> {
    let order = a.len() - 1;
    let is_constant = a[..order].iter().all(|slope| *slope == 0.0);
    if is_constant { scaled(&b, a[order]) } else { scaled(&a, b[order]) }
}
