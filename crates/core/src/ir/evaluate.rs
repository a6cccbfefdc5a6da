//! The interpreter: the reference that every other backend is held against.

use std::ops::Range;

use super::Program;
use super::loops::{LoopFault, closing_slope, solve_tear};
use super::number::{Dual, Number};
use super::op::{Op, Sources};
use super::piece::Piece;
use super::range::Range as Stretch;

/// Room for what an evaluation needs besides registers, so that none is made in a step.
#[derive(Debug, Clone, Default)]
pub(crate) struct Scratch {
    pub pieces: Vec<Piece>,
    pub ranges: Vec<Stretch>,
    /// The loops that could not be solved.
    pub faults: Vec<LoopFault>,
}

impl Scratch {
    pub fn new(program: &Program) -> Self {
        let room = if program.loops.is_empty() { 0 } else { program.body.len() };
        Scratch {
            pieces: vec![Piece::constant(0.0); room],
            ranges: vec![Stretch::constant(0.0); room],
            faults: Vec::new(),
        }
    }
}

/// A number that can also open loops.
pub(crate) trait Evaluation: Number {
    /// The tear's value that closes a loop; sets the scratch's fault where there is not exactly one.
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, Self>,
        registers: &mut [Self],
        scratch: &mut Scratch,
    ) -> Self;
}

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

impl Evaluation for Dual {
    fn close(
        program: &Program,
        index: usize,
        from: &Sources<'_, Dual>,
        registers: &mut [Dual],
        scratch: &mut Scratch,
    ) -> Dual {
        let solution = solution(program, index, from, registers, scratch);
        let entry = &program.loops[index];
        let slope = closing_slope(|slope| {
            registers[entry.tear.index()] = Dual::new(solution, slope);
            let body = entry.tear.index() + 1..entry.result.index() + 1;
            program.evaluate_range(body, from, registers, scratch);
            registers[entry.result.index()].slope
        });
        Dual::new(solution, slope)
    }
}

/// The tear's value that closes a loop, from the values alone.
fn solution(
    program: &Program,
    index: usize,
    from: &Sources<'_, Dual>,
    registers: &[Dual],
    scratch: &mut Scratch,
) -> f64 {
    let values = |duals: &[Dual]| duals.iter().map(|dual| dual.value).collect::<Vec<f64>>();
    let [parameters, coefficients, states, delayed, kept, levels] =
        [from.parameters, from.coefficients, from.states, from.delayed, from.kept, from.levels].map(values);
    let plain = Sources {
        parameters: &parameters,
        coefficients: &coefficients,
        states: &states,
        modes: from.modes,
        time: from.time.value,
        tables: from.tables,
        delayed: &delayed,
        kept: &kept,
        levels: &levels,
    };
    solve_tear(program, index, &plain, &values(registers), scratch)
}

impl Program {
    /// Works out every register of the body.
    pub(crate) fn evaluate<N: Evaluation>(
        &self,
        from: &Sources<'_, N>,
        registers: &mut [N],
        scratch: &mut Scratch,
    ) {
        self.evaluate_range(0..self.body.len(), from, registers, scratch);
    }

    /// Works out the registers of a range of the body; what stands before it stands in them already.
    pub(crate) fn evaluate_range<N: Evaluation>(
        &self,
        range: Range<usize>,
        from: &Sources<'_, N>,
        registers: &mut [N],
        scratch: &mut Scratch,
    ) {
        for at in range {
            registers[at] = match self.body[at] {
                Op::Tear(index) => N::close(self, index as usize, from, registers, scratch),
                op => op.apply(from, |register| registers[register.index()]),
            };
        }
    }

    /// Works out the coefficients from the parameters (in SI).
    pub(crate) fn prepare<N: Number>(&self, parameters: &[N]) -> Vec<N> {
        let from = Sources { parameters, ..Sources::none() };
        let mut registers = Vec::with_capacity(self.prologue.len());
        for op in &self.prologue {
            let value = op.apply(&from, |register| registers[register.index()]);
            registers.push(value);
        }
        self.coefficients.iter().map(|coefficient| registers[coefficient.register.index()]).collect()
    }
}
