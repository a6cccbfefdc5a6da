//! Straight loops: follows a path to the solution of a loop that has only one (J. Katzenelson, Bell System Technical
//! Journal 44, 1965).
//!
//! Newton's method can jump between the linear pieces of a loop without end. Here a step ends where it leaves its
//! piece, and the next one begins in the piece beyond.
//!
//! An offset is added to the output that is demanded of every tear, before its limit, so that the path begins at a
//! solution. All offsets then decrease in proportion. So a limited tear stays within ±100 V, and its inverter does not
//! reach its limit. There the proof that there is one solution gives the linear systems determinants of the same sign,
//! so the path does not turn back.

use std::ops::ControlFlow;

use super::forms::{Forms, Test, value};
use super::interval::Interval;
use super::matrix::Factors;
use super::{Problem, SOLUTION_SPACING};
use crate::ir::op::{Op, Register};
use crate::low_discrepancy::golden_place;
use crate::machines::REFERENCE;

/// Maximum number of pieces of a path, for every piece of an operation or tear.
const MAX_VISITS: usize = 20;
/// The piece of a tear that equals its demanded output.
const WITHIN: usize = 0;
/// The piece of a tear at +100 V.
const TOP: usize = 1;
/// The piece of a tear at -100 V.
const BOTTOM: usize = 2;

/// The solution of a straight loop that has only one. `None` if the path does not reach it: it has too many pieces, the
/// linear system of a piece is singular, or a voltage is not finite. Or a tear without a limit is outside ±100 V.
pub(super) fn solution(problem: &Problem<'_>) -> Option<Vec<f64>> {
    let mut path = Path::new(problem);
    for _ in 0..MAX_VISITS * path.piece_count() {
        if let ControlFlow::Break(found) = path.advance() {
            return found.filter(|tears| is_solution(problem, tears));
        }
    }
    None
}

/// Whether all tears are near their recomputed outputs.
fn is_solution(problem: &Problem<'_>, tears: &[f64]) -> bool {
    let mut inside = vec![0.0; tears.len() + problem.entry.operations.len()];
    problem.evaluate_at(tears, &mut inside);
    problem.entry.tears.iter().zip(tears).all(|(tear, volts)| {
        let difference = problem.get(&inside, tear.result) - volts;
        difference.abs() <= SOLUTION_SPACING * problem.amplification(tear)
    })
}

/// A point on the path, and the piece of every tear and operation there.
struct Path<'a> {
    /// The loop.
    problem: &'a Problem<'a>,
    /// The affine forms of the present pieces.
    forms: Forms<'a>,
    /// The present voltages of the tears.
    tears: Vec<f64>,
    /// The offsets at the beginning, in volts.
    offsets: Vec<f64>,
    /// The present offsets as a share of those at the beginning.
    share: f64,
    /// The present piece of every tear and operation.
    pieces: Vec<usize>,
    /// The operations that the demanded outputs depend on, counted from the first tear.
    needed: Vec<usize>,
    /// The tears and needed operations whose piece can change.
    choices: Vec<usize>,
}

/// A condition of the present piece of a tear or an operation: a value that must not be negative.
struct Condition {
    /// The tear or operation, counted from the first tear.
    at: usize,
    /// Its piece where the value is negative.
    beyond: usize,
    /// The present value.
    now: f64,
    /// The value at the end of the present step.
    then: f64,
}

impl Condition {
    /// The share of the present step at which the value becomes negative. `None` if it does not.
    fn crossing(&self) -> Option<f64> {
        // Rounding leaves a value that was just crossed at about 0, and it increases.
        let is_crossed = self.then < 0.0 && self.then < self.now;
        is_crossed.then(|| self.now.max(0.0) / (self.now - self.then))
    }
}

impl<'a> Path<'a> {
    /// The path at its beginning, close to 0 V. The voltages there are irregular, so the path does not begin at the
    /// corners of several pieces at once.
    fn new(problem: &'a Problem<'a>) -> Self {
        let order = problem.order();
        let needed = needed_operations(problem);
        let ranges = ranges(problem);
        let mut path = Path {
            problem,
            forms: Forms::new(problem),
            tears: (1..=order).map(|index| golden_place(index as u64)).collect(),
            offsets: vec![0.0; order],
            share: 1.0,
            pieces: vec![WITHIN; order + problem.entry.operations.len()],
            choices: choices(problem, &ranges, &needed),
            needed,
        };
        for index in 0..path.needed.len() {
            let at = path.needed[index];
            path.pieces[at] =
                only_piece(problem, &ranges, path.forms.op(at)).unwrap_or_else(|| path.first_piece(at));
            path.update(at);
        }
        for tear in 0..order {
            path.offsets[tear] = path.tears[tear] - value(&path.demand(tear), &path.tears);
        }
        path
    }

    /// The piece of an operation at the beginning. The pieces of those before it are known.
    fn first_piece(&self, at: usize) -> usize {
        let (op, mut piece) = (self.forms.op(at), 0);
        let is_outside = |test: &&Test| value(&test.form, &self.tears) < 0.0;
        // The pieces are passed in one direction, so the loop ends.
        while let Some(test) = self.forms.tests(op, piece).iter().find(is_outside) {
            piece = test.beyond;
        }
        piece
    }

    /// Number of pieces of all choices.
    fn piece_count(&self) -> usize {
        let count = |at: usize| match at.checked_sub(self.tears.len()).map(|_| self.forms.op(at)) {
            None => 3,
            Some(Op::Table(table, _)) => self.problem.program.tables[table as usize].len() + 1,
            Some(_) => 2,
        };
        // A loop without choices has one piece.
        1 + self.choices.iter().map(|at| count(*at)).sum::<usize>()
    }

    /// Computes the form of an operation in its present piece.
    fn update(&mut self, at: usize) {
        let form = self.forms.piece(self.forms.op(at), self.pieces[at]);
        self.forms.set(at, &form);
    }

    /// The form of the output that is demanded of a tear, without its offset.
    fn demand(&self, tear: usize) -> Vec<f64> {
        self.forms.get(self.problem.entry.tears[tear].demanded())
    }

    /// Moves to the end of the present piece. Breaks with the solution if it is in the piece, or with `None` if the
    /// piece has none.
    fn advance(&mut self) -> ControlFlow<Option<Vec<f64>>> {
        let order = self.tears.len();
        let (rows, mut end) = self.equations();
        let Some(factors) = Factors::new(&rows, order) else { return ControlFlow::Break(None) };
        factors.solve(&mut end);
        if end.iter().any(|volts| !volts.is_finite()) {
            return ControlFlow::Break(None);
        }
        let Some((step, at, beyond)) = self.first_crossing(&end) else {
            return ControlFlow::Break(Some(end));
        };
        self.tears.iter_mut().zip(&end).for_each(|(tear, end)| *tear += step * (end - *tear));
        self.share *= 1.0 - step;
        self.pieces[at] = beyond;
        // The forms do not depend on the pieces of tears. An operation changes only those after it.
        if at >= order {
            let first = self.needed.partition_point(|needed| *needed < at);
            (first..self.needed.len()).for_each(|index| self.update(self.needed[index]));
        }
        ControlFlow::Continue(())
    }

    /// The linear equations of the tears in the present piece by rows, and their right-hand sides, without offsets.
    fn equations(&self) -> (Vec<f64>, Vec<f64>) {
        let order = self.tears.len();
        let (mut rows, mut sides) = (vec![0.0; order * order], vec![0.0; order]);
        for (tear, (row, side)) in rows.chunks_mut(order).zip(&mut sides).enumerate() {
            match self.pieces[tear] {
                TOP => *side = REFERENCE,
                BOTTOM => *side = -REFERENCE,
                _ => {
                    let form = self.demand(tear);
                    row.iter_mut().zip(&form).for_each(|(entry, slope)| *entry = -slope);
                    *side = form[order];
                }
            }
            row[tear] += 1.0;
        }
        (rows, sides)
    }

    /// The first condition that is violated on the way to `end`: the share of the way, the tear or operation, and its
    /// piece beyond.
    fn first_crossing(&self, end: &[f64]) -> Option<(f64, usize, usize)> {
        let conditions = self.choices.iter().flat_map(|at| {
            if *at < end.len() { self.conditions_of_tear(*at, end) } else { self.conditions(*at, end) }
        });
        let crossings =
            conditions.filter_map(|condition| Some((condition.crossing()?, condition.at, condition.beyond)));
        crossings.min_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The conditions of an operation in its present piece.
    fn conditions(&self, at: usize, end: &[f64]) -> Vec<Condition> {
        let tests = self.forms.tests(self.forms.op(at), self.pieces[at]).into_iter();
        let condition = |test: Test| {
            let (now, then) = (value(&test.form, &self.tears), value(&test.form, end));
            Condition { at, beyond: test.beyond, now, then }
        };
        tests.map(condition).collect()
    }

    /// The conditions of a tear in its present piece.
    fn conditions_of_tear(&self, at: usize, end: &[f64]) -> Vec<Condition> {
        let form = self.demand(at);
        let demands = [value(&form, &self.tears) + self.share * self.offsets[at], value(&form, end)];
        let condition = |beyond: usize, sign: f64, constant: f64| {
            let [now, then] = demands.map(|demand| sign * demand + constant);
            Condition { at, beyond, now, then }
        };
        match self.pieces[at] {
            TOP => vec![condition(WITHIN, 1.0, -REFERENCE)],
            BOTTOM => vec![condition(WITHIN, -1.0, -REFERENCE)],
            _ => vec![condition(TOP, -1.0, REFERENCE), condition(BOTTOM, 1.0, REFERENCE)],
        }
    }
}

/// The operations that the demanded outputs of the tears depend on, counted from the first tear and in ascending order.
/// The limits of the tears are not among them.
fn needed_operations(problem: &Problem<'_>) -> Vec<usize> {
    let (order, begin) = (problem.order(), problem.outside.len());
    let inner = |register: Register| register.index().checked_sub(begin);
    let mut is_needed = vec![false; order + problem.entry.operations.len()];
    for at in problem.entry.tears.iter().filter_map(|tear| inner(tear.demanded())) {
        is_needed[at] = true;
    }
    for at in (order..is_needed.len()).rev() {
        if is_needed[at] {
            let op = problem.program.lowered.body[begin + at];
            op.operands().filter_map(inner).for_each(|operand| is_needed[operand] = true);
        }
    }
    (order..is_needed.len()).filter(|at| is_needed[*at]).collect()
}

/// The ranges of all tears and operations while the tears are within ±100 V.
fn ranges(problem: &Problem<'_>) -> Vec<Interval> {
    let span = problem.order() + problem.entry.operations.len();
    let mut ranges = vec![Interval::new(-REFERENCE, REFERENCE); span];
    problem.evaluate(&mut ranges);
    ranges
}

/// The piece of an operation that is the same in its whole range; `None` if its piece can change. An inverter of a tear
/// has one piece: its limit would be reached together with that of the tear.
fn only_piece(problem: &Problem<'_>, ranges: &[Interval], op: Op) -> Option<usize> {
    let range = |register: Register| problem.get(ranges, register);
    let first_if = |is_first: bool, is_second: bool| match (is_first, is_second) {
        (true, _) => Some(0),
        (_, true) => Some(1),
        _ => None,
    };
    match op {
        Op::Minimum(a, b) | Op::Maximum(a, b) => {
            let (a, b) = (range(a), range(b));
            first_if(is_at_most(b.high, a.low), is_at_most(a.high, b.low))
        }
        Op::Absolute(a) => first_if(is_at_most(0.0, range(a).low), is_at_most(range(a).high, 0.0)),
        Op::Table(..) => None,
        _ => Some(0),
    }
}

/// The tears and needed operations whose piece can change while all tears are within ±100 V.
fn choices(problem: &Problem<'_>, ranges: &[Interval], needed: &[usize]) -> Vec<usize> {
    let range = |register: Register| problem.get(ranges, register);
    let is_limited = |tear: &usize| {
        let demand = problem.entry.tears[*tear].demand.map(range);
        demand
            .is_some_and(|demand| !(is_at_most(-REFERENCE, demand.low) && is_at_most(demand.high, REFERENCE)))
    };
    let is_open = |at: &usize| {
        only_piece(problem, ranges, problem.program.lowered.body[problem.outside.len() + at]).is_none()
    };
    (0..problem.order()).filter(is_limited).chain(needed.iter().copied().filter(is_open)).collect()
}

/// Whether a is at most b. `false` if one of them is not a number.
fn is_at_most(a: f64, b: f64) -> bool {
    a <= b
}

#[cfg(test)]
mod tests {
    use std::cmp::Ordering;

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

    /// Equations (1 + S) x = f with an antisymmetric matrix S of whole numbers up to 10. The unlimited solution has
    /// voltages up to `highest`.
    fn antisymmetric(order: usize, highest: f64, has_inverters_first: bool) -> PatchBuilder {
        let size = |row: usize, column: usize| {
            let sign = if (row + column * column).is_multiple_of(3) { -1.0 } else { 1.0 };
            sign * ((7 * row + 11 * column) % 10 + 1) as f64
        };
        let entry = |row: usize, column: usize| match row.cmp(&column) {
            Ordering::Less => size(row, column),
            Ordering::Equal => 1.0,
            Ordering::Greater => -size(column, row),
        };
        let voltage = |row: usize| highest * (2.0 * golden_place(row as u64 + 1) - 1.0);
        let summer_of = |row: usize| {
            let others = (0..order).filter(|column| *column != row);
            let sum = others.fold(summer(), |sum, column| {
                let from = if entry(row, column) < 0.0 { "N" } else { "S" };
                sum.cords(&format!("x{}", entry(row, column).abs()), [format!("{from}{column}")])
            });
            let side: f64 = (0..order).map(|column| entry(row, column) * voltage(column)).sum();
            let reference = if side > 0.0 { "-100" } else { "+100" };
            (format!("S{row}"), sum.cords(&format!("x{}", side.abs() / 100.0), [reference]))
        };
        let inverter =
            |row: usize| (format!("N{row}"), ElementBuilder::new("inverter").cord("in", &format!("S{row}")));
        let summers = (0..order).map(summer_of);
        let inverters = (0..order).map(inverter);
        let elements: Vec<_> = if has_inverters_first {
            inverters.chain(summers).collect()
        } else {
            summers.chain(inverters).collect()
        };
        elements.into_iter().fold(PatchBuilder::new("antisymmetric"), |builder, (name, element)| {
            builder.element(&name, element)
        })
    }

    #[test]
    fn inverters_of_tears_do_not_turn_the_path_back() {
        for (order, highest) in [(12, 90.0), (12, 300.0), (16, 90.0), (16, 300.0)] {
            for has_inverters_first in [false, true] {
                check(antisymmetric(order, highest, has_inverters_first), false);
            }
        }
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
