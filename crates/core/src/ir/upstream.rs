//! Finds which delay lines feed which others.
//!
//! A discontinuity that comes out of a delay line is a discontinuity of every delay line that it reaches. The search
//! follows operations, states, sampled values and loops, but stops at other delay lines: these pass the discontinuity
//! on themselves.

use super::Program;
use super::op::Op;

impl Program {
    /// Notes for every delay line the lines that are upstream of its input.
    pub(crate) fn find_upstream(&mut self) {
        for index in 0..self.lowered.delays.len() {
            let dependent = self.dependents_of(Op::Delayed(index as u32));
            for delay in &mut self.lowered_mut().delays {
                if dependent[delay.input.index()] {
                    delay.upstream.push(index);
                }
            }
        }
    }

    /// The registers that depend on a source, also through states, sampled values and loops. Modes are not followed: a
    /// change of mode is a discontinuity in its own right.
    fn dependents_of(&self, source: Op) -> Vec<bool> {
        let mut sources = vec![source];
        loop {
            let dependent = self.moving(|op| sources.contains(&op));
            let states = self.lowered.states.iter().enumerate().filter(|(_, state)| {
                dependent[state.rate.index()] || state.limits.iter().any(|limit| dependent[limit.index()])
            });
            let sampled = self
                .lowered
                .sampled
                .iter()
                .enumerate()
                .filter(|(_, sampled)| dependent[sampled.next.index()]);
            let tears = self.lowered.loops.iter().flat_map(|entry| &entry.tears);
            let tears = tears.filter(|tear| dependent[tear.result.index()]);
            let states = states.map(|(index, _)| Op::State(index as u32));
            let sampled = sampled.map(|(index, _)| Op::Sampled(index as u32));
            let tears = tears.map(|tear| self.lowered.body[tear.register.index()]);
            let found: Vec<Op> = [source].into_iter().chain(states).chain(sampled).chain(tears).collect();
            if found.len() == sources.len() {
                return dependent;
            }
            sources = found;
        }
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
