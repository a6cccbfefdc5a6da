//! Sorts the body into four sections.
//!
//! Operations that are constant within a step come first, then those on which rates depend. Those follow on which only
//! events depend, and last those that are needed only at the ends of steps. So a stage of the integration method
//! evaluates only the second section, and a stage that is checked for events the third as well.

use std::ops::Range;

use super::Program;
use super::op::{Op, Register};

/// Where the sections of a body begin. The first section begins at 0.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sections {
    /// Start of the operations that vary within a step and affect a rate or a loop.
    pub moving: usize,
    /// Start of the operations that no rate and no loop depends on, but a guard or a kink does.
    pub checked: usize,
    /// Start of the operations that are needed only at the ends of steps: lamps and recorded signals.
    pub watched: usize,
}

/// The section to which an operation belongs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Section {
    /// Constant within a step.
    Fixed,
    /// Varies within a step and affects a rate or a loop.
    Moving,
    /// Varies within a step and affects an event, but neither a rate nor a loop.
    Checked,
    /// Varies within a step and affects none of them.
    Watched,
}

impl Program {
    /// Sorts the body into sections. Returns the old index of every operation, in the new order.
    pub(crate) fn arrange(&mut self) -> Vec<usize> {
        let sections = self.sections();
        let mut order: Vec<usize> = (0..self.lowered.body.len()).collect();
        // The sort is stable. So operands stay in front of their users, and loops stay contiguous.
        order.sort_by_key(|at| sections[*at]);
        let dependent = self.free_loops(&mut order);
        self.lowered_mut().sections = Sections {
            moving: order.partition_point(|at| sections[*at] < Section::Moving),
            checked: order.partition_point(|at| sections[*at] < Section::Checked),
            watched: order.partition_point(|at| sections[*at] < Section::Watched),
        };
        let mut new_registers = vec![Register(0); order.len()];
        order.iter().enumerate().for_each(|(new, old)| new_registers[*old] = Register(new as u32));
        self.lowered_mut().body = order.iter().map(|at| self.lowered.body[*at]).collect();
        self.renumber(|register| new_registers[register.index()]);
        for (entry, count) in self.lowered_mut().loops.iter_mut().zip(dependent) {
            let begin = entry.tears[0].register.index() + entry.tears.len();
            entry.operations = begin..begin + count;
        }
        order
    }

    /// Moves the operations of loops that depend on no tear in front of the tears, so that solving a loop does not
    /// repeat them. Returns the number of the other operations of every loop. The order is sorted by section, so the
    /// operations of a loop are contiguous.
    fn free_loops(&self, order: &mut [usize]) -> Vec<usize> {
        let mut position = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, old)| position[*old] = new);
        let mut counts = Vec::with_capacity(self.lowered.loops.len());
        for entry in &self.lowered.loops {
            let first = entry.tears[0].register.index();
            let depends = self.depends_on_tears(first, entry.operations.clone());
            let begin = position[first];
            let is_inside = |at: &&usize| (first..entry.operations.end).contains(*at);
            let before = order[..begin].iter().rev().take_while(is_inside).count();
            let after = order[begin..].iter().take_while(is_inside).count();
            order[begin - before..begin + after].sort_by_key(|at| depends[*at - first]);
            counts.push(depends.iter().filter(|depends| **depends).count() - entry.tears.len());
        }
        counts
    }

    /// For the tears of a loop, of which the first is `first`, and for the operations after them: whether they depend
    /// on a tear.
    fn depends_on_tears(&self, first: usize, operations: Range<usize>) -> Vec<bool> {
        let mut depends = vec![true; operations.start - first];
        for at in operations {
            let is_inside = |operand: Register| operand.index() >= first && depends[operand.index() - first];
            depends.push(self.lowered.body[at].operands().any(is_inside));
        }
        depends
    }

    /// The section of every operation.
    fn sections(&self) -> Vec<Section> {
        let moving = self.moving(|op| {
            matches!(op, Op::State(_) | Op::Time | Op::Delayed(_) | Op::Sampled(_) | Op::Tear { .. })
        });
        // Loops are solved in every stage: a loop without a solution stops the run there.
        let rates = self.lowered.states.iter().map(|state| state.rate);
        let needed =
            self.needed_for(rates.chain(self.lowered.loops.iter().map(|entry| entry.tears[0].register)));
        let checked = self.needed_for(self.guards().chain(self.sampled_inputs()));
        let section = |((moves, needed), checked)| match (moves, needed, checked) {
            (false, ..) => Section::Fixed,
            (true, true, _) => Section::Moving,
            (true, false, true) => Section::Checked,
            (true, false, false) => Section::Watched,
        };
        moving.into_iter().zip(needed).zip(checked).map(section).collect()
    }

    /// For every register, whether it depends on one of the sources.
    pub(crate) fn moving(&self, is_source: impl Fn(Op) -> bool) -> Vec<bool> {
        let mut moving: Vec<bool> = Vec::with_capacity(self.lowered.body.len());
        for op in &self.lowered.body {
            moving.push(is_source(*op) || op.operands().any(|operand| moving[operand.index()]));
        }
        moving
    }

    /// For every register, whether it varies within a step. A sampled value is constant until the end of its step.
    pub(crate) fn varying(&self) -> Vec<bool> {
        self.moving(|op| matches!(op, Op::State(_) | Op::Time | Op::Delayed(_) | Op::Tear { .. }))
    }

    /// For every register, whether one of the given registers depends on it. If an operation of a loop is needed, the
    /// whole loop is.
    pub(crate) fn needed_for(&self, registers: impl Iterator<Item = Register>) -> Vec<bool> {
        let mut needed = vec![false; self.lowered.body.len()];
        let mut are_loops_needed = vec![false; self.lowered.loops.len()];
        let mut open: Vec<Register> = registers.collect();
        while let Some(register) = open.pop() {
            if std::mem::replace(&mut needed[register.index()], true) {
                continue;
            }
            let op = self.lowered.body[register.index()];
            open.extend(op.operands());
            if let Op::Tear { index, .. } = op
                && !std::mem::replace(&mut are_loops_needed[index as usize], true)
            {
                let entry = &self.lowered.loops[index as usize];
                open.extend(entry.tears.iter().map(|tear| tear.register));
                open.extend(entry.operations.clone().map(|at| Register(at as u32)));
            }
        }
        needed
    }

    /// Renumbers every register of the body, wherever the program stores one.
    fn renumber(&mut self, to: impl Fn(Register) -> Register) {
        let renumbered = |register: &mut Register| *register = to(*register);
        self.lowered_mut().body.iter_mut().for_each(|op| *op = op.with_operands(&to));
        self.lowered_mut().elements.iter_mut().for_each(|output| renumbered(&mut output.register));
        self.lowered_mut().drives.iter_mut().for_each(renumbered);
        for state in &mut self.lowered_mut().states {
            [&mut state.rate, &mut state.demand].into_iter().chain(&mut state.limits).for_each(renumbered);
        }
        for transition in self.lowered_mut().modes.iter_mut().flat_map(|mode| &mut mode.transitions) {
            renumbered(&mut transition.guard.register);
            transition.reset.iter_mut().for_each(|reset| renumbered(&mut reset.to));
        }
        self.lowered_mut().delays.iter_mut().for_each(|delay| renumbered(&mut delay.input));
        for sampled in &mut self.lowered_mut().sampled {
            [&mut sampled.next].into_iter().chain(&mut sampled.follows).for_each(renumbered);
        }
        for entry in &mut self.lowered_mut().loops {
            for tear in &mut entry.tears {
                [&mut tear.register, &mut tear.result]
                    .into_iter()
                    .chain(&mut tear.demand)
                    .for_each(renumbered);
            }
        }
        for lamp in &mut self.lowered_mut().lamps {
            [&mut lamp.demand, &mut lamp.output].into_iter().for_each(renumbered);
        }
        self.lowered_mut().signals.iter_mut().for_each(|signal| renumbered(&mut signal.register));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::patch::Patch;

    fn program(file: &str) -> Program {
        let patch = Patch::read(file).unwrap();
        Program::new(&Circuit::new(&patch).unwrap()).unwrap()
    }

    #[test]
    fn every_operation_follows_its_operands_and_is_in_its_section() {
        for file in
            ["../../patches/thesis/fig-8-16.json", "tests/patches/loop-lag.json", "tests/patches/memory.json"]
        {
            let program = program(file);
            let Sections { moving, checked, watched } = program.lowered.sections;
            assert!(
                0 < moving && moving < checked && checked <= watched && watched <= program.lowered.body.len(),
                "{file}: {:?}",
                program.lowered.sections
            );
            for (at, op) in program.lowered.body.iter().enumerate() {
                assert!(op.operands().all(|operand| operand.index() < at), "{file}: {op:?} at {at}");
                let is_source = matches!(op, Op::State(_) | Op::Time | Op::Sampled(_) | Op::Tear { .. });
                assert!(!is_source || at >= moving, "{file}: {op:?} at {at}");
            }
            assert!(program.lowered.states.iter().all(|state| state.rate.index() < checked), "{file}");
        }
    }
}
