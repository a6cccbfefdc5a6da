//! The interpreter: the reference with which every other backend is compared.

use std::ops::Range;

use super::Program;
use super::loops::{LoopFault, LoopMemory, close_slopes, solve};
use super::number::{Dual, Number};
use super::op::{Op, Sources};

/// What an evaluation needs in addition to registers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    /// The memory of every loop.
    pub loops: Vec<LoopMemory>,
    /// The loops that could not be solved in the last evaluation.
    pub faults: Vec<LoopFault>,
}

impl Scratch {
    /// A scratch of the size that the program needs.
    pub(crate) fn new(program: &Program) -> Self {
        Scratch { loops: program.lowered.loops.iter().map(LoopMemory::new).collect(), faults: Vec::new() }
    }

    /// Forgets the solutions of loops, so that the next evaluation does not depend on earlier ones.
    pub(crate) fn forget(&mut self) {
        self.loops.iter_mut().for_each(LoopMemory::forget);
        self.faults.clear();
    }
}

/// A number type that can also solve loops.
pub(crate) trait Evaluation: Number {
    /// Solves a loop and writes all its registers. If there is not exactly one solution, the fault is added to the
    /// scratch.
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, Self>,
        registers: &mut [Self],
        scratch: &mut Scratch,
    );
}

/// Plain numbers: the tears are the solution itself.
impl Evaluation for f64 {
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, f64>,
        registers: &mut [f64],
        scratch: &mut Scratch,
    ) {
        solve(program, index, from.coefficients, registers, scratch);
    }
}

/// Dual numbers: the tears also have slopes. The results of the loop are linear in them, so evaluations of the loop
/// with chosen slopes of the tears give the slopes.
impl Evaluation for Dual {
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, Dual>,
        registers: &mut [Dual],
        scratch: &mut Scratch,
    ) {
        let values = |duals: &[Dual]| duals.iter().map(|dual| dual.value).collect::<Vec<f64>>();
        let mut plain = values(registers);
        solve(program, index, &values(from.coefficients), &mut plain, scratch);
        let entry = &program.lowered.loops[index];
        close_slopes(entry.tears.len(), |slopes| {
            for (tear, slope) in entry.tears.iter().zip(&*slopes) {
                let at = tear.register.index();
                registers[at] = Dual::new(plain[at], *slope);
            }
            program.evaluate_range(entry.operations.clone(), from, registers, scratch);
            let results = entry.tears.iter().map(|tear| registers[tear.result.index()].slope);
            slopes.iter_mut().zip(results).for_each(|(slope, result)| *slope = result);
        });
    }
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

    /// Evaluates a range of the body. The registers before it must already have their values. A loop whose first tear
    /// is in the range is evaluated as a whole.
    pub(crate) fn evaluate_range<N: Evaluation>(
        &self,
        range: Range<usize>,
        from: &Sources<'_, N>,
        registers: &mut [N],
        scratch: &mut Scratch,
    ) {
        let mut at = range.start;
        while at < range.end {
            match self.lowered.body[at] {
                Op::Tear { index, .. } => {
                    N::close(self, index as usize, from, registers, scratch);
                    at = self.lowered.loops[index as usize].operations.end;
                }
                op => {
                    registers[at] = op.apply(from, |register| registers[register.index()]);
                    at += 1;
                }
            }
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
