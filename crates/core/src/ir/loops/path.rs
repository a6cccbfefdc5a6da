//! Straight loops: follows a path to the solution of a loop that has only one (J. Katzenelson, Bell System Technical
//! Journal 44, 1965).
//!
//! Newton's method can jump between the linear pieces of a loop without end. Here a step ends where it leaves its
//! piece, and the next one begins in the piece beyond. All differences between the tears and their recomputed outputs
//! then decrease in proportion. The proof that there is one solution gives the linear systems determinants of the same
//! sign while the tears are within ±100 V, so the path does not turn back there.

use std::ops::ControlFlow;

use super::Problem;
use super::forms::{Forms, value};
use super::matrix::Factors;

/// Maximum number of pieces of a path, for every operation of the loop.
const PIECES_PER_OPERATION: usize = 20;
/// The fractional parts of multiples of this number are irregular. So a path does not begin at the corners of several
/// pieces at once.
const IRREGULAR: f64 = 0.618_033_988_749_895;

/// The solution of a straight loop that has only one. `None` if the path does not reach it: it has too many pieces, the
/// linear system of a piece is singular, or a voltage is not finite.
pub(super) fn solution(problem: &Problem<'_>) -> Option<Vec<f64>> {
    let mut path = Path::new(problem);
    for _ in 0..PIECES_PER_OPERATION * problem.entry.operations.len() {
        if let ControlFlow::Break(found) = path.advance() {
            return found;
        }
    }
    None
}

/// A point on the path, and the piece of every operation there.
struct Path<'a> {
    /// The affine forms of the present pieces.
    forms: Forms<'a>,
    /// The present voltages of the tears.
    tears: Vec<f64>,
    /// The present piece of every tear and operation.
    pieces: Vec<usize>,
}

impl<'a> Path<'a> {
    /// The path at its beginning, close to 0 V.
    fn new(problem: &'a Problem<'a>) -> Self {
        let span = problem.order() + problem.entry.operations.len();
        let tears = (1..=problem.order()).map(|index| (IRREGULAR * index as f64).fract()).collect();
        let mut path = Path { forms: Forms::new(problem), tears, pieces: vec![0; span] };
        for at in problem.order()..span {
            let op = path.forms.op(at);
            // The pieces are passed in one direction, so the loop ends.
            while let Some(test) =
                path.forms.tests(op, path.pieces[at]).iter().find(|test| value(&test.form, &path.tears) < 0.0)
            {
                path.pieces[at] = test.beyond;
            }
            path.update(at);
        }
        path
    }

    /// Computes the form of an operation in its present piece.
    fn update(&mut self, at: usize) {
        let form = self.forms.piece(self.forms.op(at), self.pieces[at]);
        self.forms.set(at, &form);
    }

    /// Moves to the end of the present piece. Breaks with the solution if it is in the piece, or with `None` if the
    /// piece has none.
    fn advance(&mut self) -> ControlFlow<Option<Vec<f64>>> {
        let order = self.tears.len();
        (order..self.pieces.len()).for_each(|at| self.update(at));
        let (rows, mut end) = self.forms.equations();
        let Some(factors) = Factors::new(&rows, order) else { return ControlFlow::Break(None) };
        factors.solve(&mut end);
        if end.iter().any(|volts| !volts.is_finite()) {
            return ControlFlow::Break(None);
        }
        let Some((share, at, beyond)) = self.first_crossing(&end) else {
            return ControlFlow::Break(Some(end));
        };
        self.tears.iter_mut().zip(&end).for_each(|(tear, end)| *tear += share * (end - *tear));
        self.pieces[at] = beyond;
        ControlFlow::Continue(())
    }

    /// The first test that becomes negative on the way to `end`: the share of the way, the operation, and its piece
    /// beyond.
    fn first_crossing(&self, end: &[f64]) -> Option<(f64, usize, usize)> {
        let mut first: Option<(f64, usize, usize)> = None;
        for at in self.tears.len()..self.pieces.len() {
            for test in self.forms.tests(self.forms.op(at), self.pieces[at]) {
                let (now, then) = (value(&test.form, &self.tears), value(&test.form, end));
                // Rounding leaves a test that was just crossed at about 0, and it increases.
                if then >= 0.0 || then >= now {
                    continue;
                }
                let share = now.max(0.0) / (now - then);
                if first.is_none_or(|(least, ..)| share < least) {
                    first = Some((share, at, test.beyond));
                }
            }
        }
        first
    }
}
