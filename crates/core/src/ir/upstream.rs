//! Finds which delay lines feed which others.
//!
//! A discontinuity that comes out of a delay line is a discontinuity of every delay line that it reaches. The search
//! follows operations, states, sampled values and loops, but stops at other delay lines: these pass the discontinuity
//! on themselves.

use std::collections::HashMap;

use super::Program;
use super::op::{Op, Register};

impl Program {
    /// Notes for every delay line the lines that are upstream of its input. Each search visits only what the line
    /// reaches. The work for lines that do not feed each other is in proportion to their number.
    pub(crate) fn find_upstream(&mut self) {
        if self.lowered.delays.is_empty() {
            return;
        }
        let dependents = self.dependents();
        let mut outputs: Vec<Vec<usize>> = vec![Vec::new(); self.lowered.delays.len()];
        for (at, op) in self.lowered.body.iter().enumerate() {
            if let Op::Delayed(line) = *op {
                outputs[line as usize].push(at);
            }
        }
        let mut lines_at: HashMap<usize, Vec<usize>> = HashMap::new();
        for (line, delay) in self.lowered.delays.iter().enumerate() {
            lines_at.entry(delay.input.index()).or_default().push(line);
        }
        // The line whose search reached each register last.
        let mut reached_by: Vec<Option<usize>> = vec![None; self.lowered.body.len()];
        for (line, mut open) in outputs.into_iter().enumerate() {
            while let Some(at) = open.pop() {
                if reached_by[at].replace(line) == Some(line) {
                    continue;
                }
                for downstream in lines_at.get(&at).into_iter().flatten() {
                    self.lowered_mut().delays[*downstream].upstream.push(line);
                }
                open.extend(&dependents[at]);
            }
        }
    }

    /// For every register, the registers that depend on it directly, also through states, sampled values and tears.
    /// Modes are not followed: a change of mode is a discontinuity in its own right.
    fn dependents(&self) -> Vec<Vec<usize>> {
        let mut dependents: Vec<Vec<usize>> = vec![Vec::new(); self.lowered.body.len()];
        let mut add = |on: Register, at: usize| dependents[on.index()].push(at);
        for (at, op) in self.lowered.body.iter().enumerate() {
            op.operands().for_each(|operand| add(operand, at));
            match *op {
                Op::State(index) => {
                    let state = &self.lowered.states[index as usize];
                    [state.rate].into_iter().chain(state.limits).for_each(|source| add(source, at));
                }
                Op::Sampled(index) => add(self.lowered.sampled[index as usize].next, at),
                _ => {}
            }
        }
        for tear in self.lowered.loops.iter().flat_map(|entry| &entry.tears) {
            add(tear.result, tear.register.index());
        }
        dependents
    }
}

#[cfg(test)]
mod tests {
    use crate::circuit::Circuit;
    use crate::ir::Program;
    use crate::patch::{ElementBuilder, Patch, PatchBuilder};

    fn upstream(patch: &Patch) -> Vec<Vec<usize>> {
        let program = Program::new(&Circuit::new(patch).unwrap()).unwrap();
        program.lowered.delays.iter().map(|delay| delay.upstream.clone()).collect()
    }

    #[test]
    fn discontinuities_pass_integrators_along_cords() {
        // One delay line with a drive as its input, and one with feedback from its own output through an integrator.
        let patch = Patch::read("tests/patches/delay-line.json").unwrap();
        assert_eq!(upstream(&patch), [vec![], vec![1]]);
        let delay = |from: &str| ElementBuilder::new("delay").cord("in", from).set("delay", 0.1);
        let patch = PatchBuilder::new("in series")
            .scale("volt", 1, "V")
            .drive("u", "volt", ElementBuilder::new("sine").set("amplitude", 10).set("frequency", 1))
            .element("D1", delay("u"))
            .element("A1", ElementBuilder::new("integrator").cords("x1", ["D1"]))
            .element("D2", delay("A1"))
            .element("D3", delay("D2"))
            .run(1.0, 1e-3)
            .build()
            .unwrap();
        // A discontinuity that passes through a line counts as that line's own.
        assert_eq!(upstream(&patch), [vec![], vec![0], vec![1]]);
    }
}
