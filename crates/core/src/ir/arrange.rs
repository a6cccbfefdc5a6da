//! The order of the body: first what stays the same within a step, then what the rates depend on, last what only the
//! ends of steps are asked for.

use super::Program;
use super::op::{Op, Register};

/// Where the parts of a body begin; the first begins at 0.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Parts {
    /// What moves within a step, and the rates depend on.
    pub moving: usize,
    /// What no rate depends on, and no loop: guards, lamps, what is recorded.
    pub watched: usize,
}

/// Which part an operation belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Still,
    Moving,
    Watched,
}

impl Program {
    /// Puts the body in order, and gives the old place of every operation.
    pub(crate) fn arrange(&mut self) -> Vec<usize> {
        let parts = self.parts();
        let mut order: Vec<usize> = (0..self.body.len()).collect();
        // Within a part the order stays: operands come first, loops stay in one piece.
        order.sort_by_key(|at| parts[*at]);
        self.parts = Parts {
            moving: order.partition_point(|at| parts[*at] < Part::Moving),
            watched: order.partition_point(|at| parts[*at] < Part::Watched),
        };
        let mut places = vec![Register(0); order.len()];
        order.iter().enumerate().for_each(|(new, old)| places[*old] = Register(new as u32));
        self.body = order.iter().map(|at| self.body[*at]).collect();
        self.renumber(|register| places[register.index()]);
        order
    }

    fn parts(&self) -> Vec<Part> {
        let moving = self
            .moving(|op| matches!(op, Op::State(_) | Op::Time | Op::Delayed(_) | Op::Kept(_) | Op::Tear(_)));
        // Loops are looked at in every stage: one that cannot be solved there stops the run.
        let rates = self.states.iter().map(|state| state.rate);
        let needed = self.needed_for(rates.chain(self.loops.iter().map(|entry| entry.tear)));
        let part = |(moves, needed)| match (moves, needed) {
            (false, _) => Part::Still,
            (true, true) => Part::Moving,
            (true, false) => Part::Watched,
        };
        moving.into_iter().zip(needed).map(part).collect()
    }

    /// The registers whose voltages move, where those of some sources do.
    pub(crate) fn moving(&self, is_source: impl Fn(Op) -> bool) -> Vec<bool> {
        let mut moving: Vec<bool> = Vec::with_capacity(self.body.len());
        for op in &self.body {
            moving.push(is_source(*op) || op.operands().any(|operand| moving[operand.index()]));
        }
        moving
    }

    /// The registers that some registers depend on. Of a loop, all that stands in it.
    pub(crate) fn needed_for(&self, registers: impl Iterator<Item = Register>) -> Vec<bool> {
        let mut needed = vec![false; self.body.len()];
        let mut open: Vec<Register> = registers.collect();
        while let Some(register) = open.pop() {
            if std::mem::replace(&mut needed[register.index()], true) {
                continue;
            }
            let op = self.body[register.index()];
            open.extend(op.operands());
            if let Op::Tear(index) = op {
                let entry = &self.loops[index as usize];
                open.extend((entry.tear.0..=entry.result.0).map(Register));
            }
        }
        needed
    }

    /// Gives every register of the body, wherever one is kept, another number.
    fn renumber(&mut self, to: impl Fn(Register) -> Register) {
        let renumbered = |register: &mut Register| *register = to(*register);
        self.body.iter_mut().for_each(|op| *op = op.with_operands(&to));
        self.elements.iter_mut().for_each(|outlet| renumbered(&mut outlet.register));
        self.drives.iter_mut().for_each(renumbered);
        for state in &mut self.states {
            [&mut state.rate, &mut state.demand].into_iter().chain(&mut state.limits).for_each(renumbered);
        }
        for transition in self.modes.iter_mut().flat_map(|mode| &mut mode.transitions) {
            renumbered(&mut transition.guard.register);
            transition.reset.iter_mut().for_each(|reset| renumbered(&mut reset.to));
        }
        self.delays.iter_mut().for_each(|delay| renumbered(&mut delay.input));
        self.kept.iter_mut().for_each(|kept| renumbered(&mut kept.next));
        for entry in &mut self.loops {
            [&mut entry.tear, &mut entry.result].into_iter().for_each(renumbered);
        }
        for lamp in &mut self.lamps {
            [&mut lamp.demand, &mut lamp.output].into_iter().for_each(renumbered);
        }
        self.signals.iter_mut().for_each(|probe| renumbered(&mut probe.register));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::circuit::Circuit;
    use crate::patch::Patch;

    fn program(file: &str) -> Program {
        let patch = Patch::read(file.as_ref()).unwrap();
        Program::new(&Circuit::new(&patch, &[]).unwrap()).unwrap()
    }

    #[test]
    fn every_operation_stands_behind_what_it_reads_and_in_its_part() {
        for file in
            ["../../patches/thesis/fig-8-16.json", "tests/patches/loop-lag.json", "tests/patches/memory.json"]
        {
            let program = program(file);
            let Parts { moving, watched } = program.parts;
            assert!(
                0 < moving && moving < watched && watched < program.body.len(),
                "{file}: {:?}",
                program.parts
            );
            for (at, op) in program.body.iter().enumerate() {
                assert!(op.operands().all(|operand| operand.index() < at), "{file}: {op:?} at {at}");
                let is_source = matches!(op, Op::State(_) | Op::Time | Op::Kept(_) | Op::Tear(_));
                assert!(!is_source || at >= moving, "{file}: {op:?} at {at}");
            }
            assert!(program.states.iter().all(|state| state.rate.index() < watched), "{file}");
        }
    }
}
