//! The interpreter: the reference with which every other backend is compared.

use std::ops::Range;

use super::Program;
use super::interval::Interval;
use super::linear_piece::LinearPiece;
use super::loops::{LoopFault, closing_slope, solve_tear};
use super::number::{Dual, Number};
use super::op::{Op, Sources};

/// Buffers for an evaluation, so that a step allocates no memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    /// Registers for the search along linear pieces; empty if the program has no loops.
    pub pieces: Vec<LinearPiece>,
    /// Registers for the search with intervals; empty if the program has no loops.
    pub intervals: Vec<Interval>,
    /// The loops that could not be solved in the last evaluation.
    pub faults: Vec<LoopFault>,
}

impl Scratch {
    /// A scratch of the size that the program needs.
    pub(crate) fn new(program: &Program) -> Self {
        let length = if program.lowered.loops.is_empty() { 0 } else { program.lowered.body.len() };
        Scratch {
            pieces: vec![LinearPiece::constant(0.0); length],
            intervals: vec![Interval::constant(0.0); length],
            faults: Vec::new(),
        }
    }
}

/// A number type that can also solve loops.
pub(crate) trait Evaluation: Number {
    /// The value of the tear that solves a loop. If there is not exactly one, the fault is added to the scratch.
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, Self>,
        registers: &mut [Self],
        scratch: &mut Scratch,
    ) -> Self;
}

/// Plain numbers: the tear is the solution itself.
impl Evaluation for f64 {
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, f64>,
        registers: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64 {
        solve_tear(program, index, from, registers, scratch)
    }
}

/// Dual numbers: the tear also has a slope. The result of the loop is linear in it, so two evaluations of the loop give
/// the slope.
impl Evaluation for Dual {
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, Dual>,
        registers: &mut [Dual],
        scratch: &mut Scratch,
    ) -> Dual {
        let solution = solution(program, index, from, registers, scratch);
        let entry = &program.lowered.loops[index];
        let slope = closing_slope(|slope| {
            registers[entry.tear.index()] = Dual::new(solution, slope);
            let body = entry.tear.index() + 1..entry.result.index() + 1;
            program.evaluate_range(body, from, registers, scratch);
            registers[entry.result.index()].slope
        });
        Dual::new(solution, slope)
    }
}

/// The value of the tear that solves a loop, from the values without their slopes.
fn solution(
    program: &Program,
    index: usize,
    from: &Sources<'_, Dual>,
    registers: &[Dual],
    scratch: &mut Scratch,
) -> f64 {
    let values = |duals: &[Dual]| duals.iter().map(|dual| dual.value).collect::<Vec<f64>>();
    let [parameters, coefficients, states, delayed, sampled, levels] =
        [from.parameters, from.coefficients, from.states, from.delayed, from.sampled, from.levels]
            .map(values);
    let plain = Sources {
        parameters: &parameters,
        coefficients: &coefficients,
        states: &states,
        modes: from.modes,
        time: from.time.value,
        tables: from.tables,
        delayed: &delayed,
        sampled: &sampled,
        levels: &levels,
    };
    solve_tear(program, index, &plain, &values(registers), scratch)
}

impl Program {
    /// Evaluates every register of the body.
    pub(crate) fn evaluate<N: Evaluation>(
        &self,
        from: &Sources<'_, N>,
        registers: &mut [N],
        scratch: &mut Scratch,
    ) {
        self.evaluate_range(0..self.lowered.body.len(), from, registers, scratch);
    }

    /// Evaluates a range of the body. The registers before it must already have their values.
    pub(crate) fn evaluate_range<N: Evaluation>(
        &self,
        range: Range<usize>,
        from: &Sources<'_, N>,
        registers: &mut [N],
        scratch: &mut Scratch,
    ) {
        for at in range {
            registers[at] = match self.lowered.body[at] {
                Op::Tear(index) => N::close(self, index as usize, from, registers, scratch),
                op => op.apply(from, |register| registers[register.index()]),
            };
        }
    }

    /// The coefficients for these parameters (in SI).
    pub(crate) fn prepare<N: Number>(&self, parameters: &[N]) -> Vec<N> {
        let from = Sources { parameters, ..Sources::none() };
        let mut registers = Vec::with_capacity(self.lowered.prologue.len());
        for op in &self.lowered.prologue {
            let value = op.apply(&from, |register| registers[register.index()]);
            registers.push(value);
        }
        self.lowered.coefficients.iter().map(|coefficient| registers[coefficient.register.index()]).collect()
    }
}
