//! Proves that a loop has at most one solution, from bounds of the slopes of its recomputed outputs.
//!
//! The slopes are those of the outputs before their limits, while all tears vary over their whole range. A proof holds
//! for a range of inputs, so most evaluations need none. The first attempt assumes nothing of the inputs that vary
//! within a step, and the last one takes the present inputs.

use super::Problem;
use super::bounds::Bounds;
use super::interval::Interval;
use super::p_matrix::is_p_matrix;
use crate::ir::number::Number as _;
use crate::ir::parts::Loop;
use crate::machines::REFERENCE;

/// The ranges of the inputs for which a proof is attempted, in volts on both sides of the present ones.
const MARGINS: [f64; 3] = [f64::INFINITY, 5.0, 0.0];

/// What is known about the number of solutions of a loop.
#[derive(Debug, Clone)]
pub(super) struct Uniqueness {
    /// Bounds of the inputs for which one solution was proven, in the order of the inputs. Empty before the first
    /// proof.
    proven: Vec<Interval>,
    /// Bounds of the tears and operations.
    bounds: Vec<Bounds>,
    /// Bounds of the slopes of y - a(y), by rows.
    entries: Vec<Interval>,
}

impl Uniqueness {
    /// Nothing is known.
    pub(super) fn new(entry: &Loop) -> Self {
        let order = entry.tears.len();
        Uniqueness {
            proven: Vec::with_capacity(entry.inputs.len()),
            bounds: vec![Bounds::constant(0.0); order + entry.operations.len()],
            entries: vec![Interval::constant(0.0); order * order],
        }
    }

    /// Whether the loop has at most one solution. `false` if it is not known.
    pub(super) fn is_proven(&mut self, problem: &Problem<'_>) -> bool {
        let is_covered = self.proven.len() == problem.entry.inputs.len()
            && problem
                .inputs()
                .zip(&self.proven)
                .all(|(volts, proven)| proven.low <= volts && volts <= proven.high);
        is_covered || MARGINS.into_iter().any(|margin| self.prove(problem, margin))
    }

    /// Tries to prove that there is at most one solution for inputs within a margin, in volts, of the present ones. The
    /// margin applies to inputs that vary within a step.
    fn prove(&mut self, problem: &Problem<'_>, margin: f64) -> bool {
        let moving = problem.program.lowered.sections.moving;
        let bounds = |register: usize| {
            let volts = problem.outside[register];
            let margin = if register < moving { 0.0 } else { margin };
            Interval::new(volts - margin, volts + margin)
        };
        self.proven.clear();
        let is_proven = self.is_proven_with(problem, bounds);
        if is_proven {
            self.proven.extend(problem.entry.inputs.iter().map(|input| bounds(input.index())));
        }
        is_proven
    }

    /// Whether the loop has at most one solution for inputs within these bounds.
    fn is_proven_with(&mut self, problem: &Problem<'_>, input: impl Fn(usize) -> Interval) -> bool {
        let order = problem.order();
        for column in 0..order {
            self.evaluate(problem, column, &input);
            for (row, tear) in problem.entry.tears.iter().enumerate() {
                let register = tear.demanded().index();
                let slope = match register.checked_sub(problem.outside.len()) {
                    Some(at) => self.bounds[at].slope,
                    None => Interval::constant(0.0),
                };
                let own = Interval::constant(if row == column { 1.0 } else { 0.0 });
                self.entries[row * order + column] = own.subtract(slope);
            }
        }
        is_p_matrix(&self.entries, order)
    }

    /// Bounds of all operations while one tear moves and the others are anywhere.
    fn evaluate(&mut self, problem: &Problem<'_>, moving: usize, input: &impl Fn(usize) -> Interval) {
        let range = Interval::new(-REFERENCE, REFERENCE);
        self.bounds[..problem.order()].fill(Bounds::fixed(range));
        self.bounds[moving] = Bounds::moving(range);
        problem.evaluate_with(&mut self.bounds, |register| Bounds::fixed(input(register)));
    }
}
