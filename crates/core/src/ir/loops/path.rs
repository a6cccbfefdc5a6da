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
use crate::low_discrepancy::golden_place;

/// Maximum number of pieces of a path, for every operation of the loop.
const PIECES_PER_OPERATION: usize = 20;

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
    /// The path at its beginning, close to 0 V. The voltages there are irregular, so the path does not begin at the
    /// corners of several pieces at once.
    fn new(problem: &'a Problem<'a>) -> Self {
        let span = problem.order() + problem.entry.operations.len();
        let tears = (1..=problem.order()).map(|index| golden_place(index as u64)).collect();
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

#[cfg(test)]
mod tests {
    use super::super::{Problem, pieces};
    use super::*;
    use crate::circuit::Circuit;
    use crate::ir::Program;
    use crate::ir::op::Sources;
    use crate::patch::{ElementBuilder, PatchBuilder};

    /// Follows the path of the only loop in a patch, and checks the laws at its end. If `is_small`, an enumeration must
    /// find the same voltages and no others.
    fn check(builder: PatchBuilder, is_small: bool) {
        let circuit = Circuit::new(&builder.build().unwrap()).unwrap_or_else(|report| panic!("{report}"));
        let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
        let parameters: Vec<f64> = program.parameters.iter().map(|parameter| parameter.value).collect();
        let coefficients = program.prepare(&parameters);
        let from = Sources { coefficients: &coefficients, ..Sources::none() };
        let entry = &program.lowered.loops[0];
        let mut outside: Vec<f64> = Vec::new();
        for op in &program.lowered.body[..entry.tears[0].register.index()] {
            outside.push(op.apply(&from, |register| outside[register.index()]));
        }
        let problem = Problem { program: &program, entry, coefficients: &coefficients, outside: &outside };
        let tears = solution(&problem).expect("a path to the solution");
        let mut inside = vec![0.0; problem.order() + entry.operations.len()];
        problem.evaluate_at(&tears, &mut inside);
        problem.check_laws(&inside).unwrap_or_else(|fault| panic!("{fault:?} at {tears:?}"));
        if is_small {
            let counted = pieces::solutions(&problem).and_then(|all| all.only()).unwrap();
            assert!(tears.iter().zip(&counted).all(|(a, b)| (a - b).abs() < 1e-9), "{tears:?} {counted:?}");
        }
    }

    fn summer() -> ElementBuilder {
        ElementBuilder::new("summer")
    }

    #[test]
    fn a_matrix_with_large_entries_off_its_diagonal_is_solved() {
        // Entry (i, j) is 0.9^|i - j|. The sides are chosen so that some outputs are at their limits.
        let order = 16;
        let builder = (0..order).fold(PatchBuilder::new("matrix"), |builder, row: i32| {
            let others = (0..order).filter(|column| *column != row);
            let sum = others.fold(summer(), |sum, column| {
                sum.cords(&format!("x{}", 0.9f64.powi((row - column).abs())), [format!("S{column}")])
            });
            let reference = if row % 3 == 0 { "-100" } else { "+100" };
            builder.element(&format!("S{row}"), sum.cords(&format!("x{}", 1 + row % 5), [reference]))
        });
        check(builder, false);
    }

    #[test]
    fn amplifiers_that_reach_their_limits_together_are_solved() {
        // Both demand -200 V minus 0.6 times the other output.
        let amplifier = |other: &str| summer().cords("x0.6", [other]).cords("x2", ["+100"]);
        let builder = PatchBuilder::new("pair").element("A", amplifier("B")).element("B", amplifier("A"));
        check(builder, true);
    }

    #[test]
    fn a_table_in_the_loop_is_followed_over_its_segments() {
        let points = serde_json::json!([[-100, -20], [-40, -10], [0, 5], [30, 60], [100, 70]]);
        for drive in ["x0.9", "x0.4", "x0.05"] {
            let table =
                ElementBuilder::new("function-generator").cord("in", "A").set("points", points.clone());
            let builder = PatchBuilder::new("table")
                .element("A", summer().cords("x0.5", ["F", "A"]).cords(drive, ["-100"]))
                .element("F", table);
            check(builder, true);
        }
    }
}
