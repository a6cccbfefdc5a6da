//! Loops without an integrator: finds the voltages of their tears.
//!
//! A solution of a loop is a set of voltages at which every tear equals its recomputed output. A loop must have exactly
//! one. If it has none or several, the patch is refused or the run stops.
//!
//! `uniqueness` tries to prove from the slopes of the recomputed outputs that there is only one solution. Then `newton`
//! finds it, starting at the last solution, or `path` if that fails in a straight loop. Otherwise all solutions are
//! counted: `pieces` enumerates the linear pieces of a straight loop, and `curved` searches with intervals.

mod bounds;
mod curved;
mod definite;
mod forms;
mod interval;
mod matrix;
mod newton;
mod p_matrix;
mod path;
mod pieces;
mod report;
mod shape;
mod singular;
mod uniqueness;

use super::number::Number;
use super::op::{Op, Register, Sources};
use super::parts::{Loop, Tear};
use super::{Program, evaluate::Scratch};
use crate::machines::REFERENCE;
use newton::Newton;
use uniqueness::Uniqueness;

pub(crate) use matrix::close_slopes;
pub(crate) use report::{describe_solutions, remedy};

/// A loop that was not solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoopFault {
    /// Index of the loop.
    pub index: usize,
    /// What was found instead of one solution.
    pub solutions: Solutions,
}

/// The voltages that solve a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Solutions {
    /// The number of solutions. The voltages of one tear in the first of them, in volts and in ascending order.
    Counted { count: usize, tear: usize, first: [f64; MAX_LISTED] },
    /// A continuous range of voltages.
    Range,
    /// A voltage in the loop is not a number.
    NotANumber,
    /// The loop has more pieces than the search examines.
    TooManyPieces,
    /// Rounding prevents a solution. The recomputed output of the tear differs from it by this many volts.
    Inexact { tear: usize, volts: f64 },
}

/// Number of solutions that messages list.
const MAX_LISTED: usize = 4;
/// Solutions that differ by less than this in every tear, in volts, count as one.
const SOLUTION_SPACING: f64 = 1e-6;
/// Largest permitted difference, in volts, between an output and the law of its element. For an open amplifier it
/// applies to the sum of the inputs.
const LAW_TOLERANCE: f64 = 1e-9;

/// A loop, and the voltages around it.
#[derive(Clone, Copy)]
struct Problem<'a> {
    /// The program that contains the loop.
    program: &'a Program,
    /// The loop.
    entry: &'a Loop,
    /// The coefficients of the program.
    coefficients: &'a [f64],
    /// The voltages of all registers before the first tear.
    outside: &'a [f64],
}

impl Problem<'_> {
    /// Number of tears.
    fn order(&self) -> usize {
        self.entry.tears.len()
    }

    /// Evaluates the operations of the loop. `inside` has an entry for every tear, already set, and then one for every
    /// operation. Registers before the loop are constant.
    fn evaluate<N: Number>(&self, inside: &mut [N]) {
        self.evaluate_with(inside, |register| N::constant(self.outside[register]), |_| None);
    }

    /// Evaluates the operations of the loop with these values of the registers before it. `assumed` gives the results
    /// of operations that are not computed, by their index counted from the first tear.
    fn evaluate_with<N: Number>(
        &self,
        inside: &mut [N],
        outside: impl Fn(usize) -> N,
        assumed: impl Fn(usize) -> Option<N>,
    ) {
        let begin = self.outside.len();
        for at in self.entry.operations.clone() {
            if let Some(value) = assumed(at - begin) {
                inside[at - begin] = value;
                continue;
            }
            let get = |register: Register| match register.index().checked_sub(begin) {
                Some(inner) => inside[inner],
                None => outside(register.index()),
            };
            inside[at - begin] = self.apply(self.program.lowered.body[at], get);
        }
    }

    /// The result of an operation of the loop. `get` gives the values of its operands.
    #[inline]
    fn apply<N: Number>(&self, op: Op, get: impl Fn(Register) -> N) -> N {
        match op {
            Op::Table(table, abscissa) => get(abscissa).table(&self.program.tables[table as usize]),
            op => op.apply(&Sources::none(), get),
        }
    }

    /// Evaluates the operations of the loop at these voltages of the tears.
    fn evaluate_at(&self, tears: &[f64], inside: &mut [f64]) {
        inside[..tears.len()].copy_from_slice(tears);
        self.evaluate(inside);
    }

    /// The value of a register. Registers before the loop are constant.
    fn get<N: Number>(&self, inside: &[N], register: Register) -> N {
        match self.outside.get(register.index()) {
            Some(outside) => N::constant(*outside),
            None => inside[register.index() - self.outside.len()],
        }
    }

    /// The amplification of a tear: 1 if it is not an open amplifier.
    fn amplification(&self, tear: &Tear) -> f64 {
        tear.amplification.map_or(1.0, |index| self.coefficients[index as usize])
    }

    /// The voltages that the loop reads from the rest of the program.
    fn inputs(&self) -> impl Iterator<Item = f64> {
        self.entry.inputs.iter().map(|input| self.outside[input.index()])
    }

    /// Checks that every tear equals its recomputed output. All other members follow from the tears by their laws.
    ///
    /// # Errors
    /// If a voltage is not a number, or one differs by more than [`LAW_TOLERANCE`].
    fn check_laws(&self, inside: &[f64]) -> Result<(), Solutions> {
        for (position, tear) in self.entry.tears.iter().enumerate() {
            let volts = (self.get(inside, tear.result) - inside[position]).abs();
            if volts.is_nan() {
                return Err(Solutions::NotANumber);
            }
            if volts > LAW_TOLERANCE * self.amplification(tear) {
                return Err(Solutions::Inexact { tear: position, volts });
            }
        }
        Ok(())
    }
}

/// Solves a loop and writes all its voltages. `registers` must have the voltages before the loop. If there is not
/// exactly one solution, the voltages are NaN and the fault is added to the scratch.
pub(super) fn solve(
    program: &Program,
    index: usize,
    coefficients: &[f64],
    registers: &mut [f64],
    scratch: &mut Scratch,
) {
    let entry = &program.lowered.loops[index];
    let (outside, rest) = registers.split_at_mut(entry.tears[0].register.index());
    let inside = &mut rest[..entry.tears.len() + entry.operations.len()];
    let problem = Problem { program, entry, coefficients, outside };
    let memory = &mut scratch.loops[index];
    if let Err(solutions) = memory.solve(&problem, inside) {
        memory.is_solved = false;
        scratch.faults.push(LoopFault { index, solutions });
        inside.fill(f64::NAN);
    }
}

/// What is kept of a loop between evaluations. It saves time and never changes the solution.
#[derive(Debug, Clone)]
pub(crate) struct LoopMemory {
    /// Whether the last evaluation found a solution.
    is_solved: bool,
    /// Voltages of the tears in the last solution, or where the search for the next one begins.
    tears: Vec<f64>,
    /// The inputs of the loop at the last solution.
    inputs: Vec<f64>,
    /// What is known about the number of solutions.
    uniqueness: Uniqueness,
    /// The iteration that finds a solution.
    newton: Newton,
}

impl LoopMemory {
    /// The memory of a loop that was not solved yet.
    pub(super) fn new(entry: &Loop) -> Self {
        let (order, span) = (entry.tears.len(), entry.tears.len() + entry.operations.len());
        LoopMemory {
            is_solved: false,
            tears: vec![0.0; order],
            inputs: vec![0.0; entry.inputs.len()],
            uniqueness: Uniqueness::new(entry),
            newton: Newton::new(order, span),
        }
    }

    /// Forgets the last solution, so that the next search begins at 0 V.
    pub(super) fn forget(&mut self) {
        self.is_solved = false;
        self.tears.fill(0.0);
        self.newton.forget();
    }

    /// Solves the loop.
    fn solve(&mut self, problem: &Problem<'_>, inside: &mut [f64]) -> Result<(), Solutions> {
        if self.is_solved && problem.inputs().eq(self.inputs.iter().copied()) {
            problem.evaluate_at(&self.tears, inside);
            return Ok(());
        }
        self.inputs.iter_mut().zip(problem.inputs()).for_each(|(input, volts)| *input = volts);
        if self.inputs.iter().any(|volts| volts.is_nan()) {
            return Err(Solutions::NotANumber);
        }
        let is_unique = self.uniqueness.is_proven(problem);
        if !is_unique || !self.newton.follow(problem, &mut self.tears, inside) {
            self.tears = search(problem, is_unique)?;
            self.newton.refine(problem, &mut self.tears, inside);
        }
        problem.check_laws(inside)?;
        self.is_solved = true;
        Ok(())
    }
}

/// The tears of the only solution, found by a search over all voltages. `is_unique` is whether there can be only one.
///
/// # Errors
/// If there is none, or more than one, or if the search does not end.
fn search(problem: &Problem<'_>, is_unique: bool) -> Result<Vec<f64>, Solutions> {
    if !problem.entry.is_straight {
        return curved::solutions(problem)?.only();
    }
    match is_unique.then(|| path::solution(problem)).flatten() {
        Some(tears) => Ok(tears),
        None => pieces::solutions(problem)?.only(),
    }
}

/// The solutions found so far. Each has the voltages of all tears.
#[derive(Debug, Default)]
struct SolutionSet(Vec<Vec<f64>>);

impl SolutionSet {
    /// Adds a solution, unless it was found already.
    fn add(&mut self, tears: Vec<f64>) {
        let is_known = |known: &Vec<f64>| {
            known.iter().zip(&tears).all(|(known, found)| (known - found).abs() <= SOLUTION_SPACING)
        };
        if !self.0.iter().any(is_known) {
            self.0.push(tears);
        }
    }

    /// The only solution.
    ///
    /// # Errors
    /// If there is none, or more than one. The error lists the tear that distinguishes most solutions.
    fn only(mut self) -> Result<Vec<f64>, Solutions> {
        if self.0.len() == 1 {
            return Ok(self.0.remove(0));
        }
        let order = self.0.first().map_or(0, Vec::len);
        let listed = |tear: usize| {
            let mut volts: Vec<f64> = self.0.iter().map(|tears| tears[tear]).collect();
            volts.sort_by(f64::total_cmp);
            volts
        };
        let distinct = |tear: &usize| {
            let volts = listed(*tear);
            volts.windows(2).filter(|pair| pair[1] - pair[0] > SOLUTION_SPACING).count()
        };
        let tear = (0..order).rev().max_by_key(distinct).unwrap_or(0);
        let mut first = [f64::NAN; MAX_LISTED];
        first.iter_mut().zip(listed(tear)).for_each(|(entry, volts)| *entry = volts);
        Err(Solutions::Counted { count: self.0.len(), tear, first })
    }
}

/// Limits a voltage to the range of an amplifier.
fn clamped(volts: f64) -> f64 {
    volts.clamp(-REFERENCE, REFERENCE)
}
