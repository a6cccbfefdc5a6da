//! Where what comes out of delay lines goes.

use super::Program;
use super::op::Op;

impl Program {
    /// Notes of every delay line whose echoes come to its input.
    pub(crate) fn find_echoes(&mut self) {
        for index in 0..self.delays.len() {
            let moved = self.moved_by(Op::Delayed(index as u32));
            for delay in &mut self.delays {
                if moved[delay.input.index()] {
                    delay.hears.push(index);
                }
            }
        }
    }

    /// The registers that depend on a source, also through states, kept values and loops. What changes modes is no echo, but
    /// an event of its own.
    fn moved_by(&self, source: Op) -> Vec<bool> {
        let mut sources = vec![source];
        loop {
            let moved = self.moving(|op| sources.contains(&op));
            let states = self.states.iter().enumerate().filter(|(_, state)| {
                moved[state.rate.index()] || state.limits.iter().any(|limit| moved[limit.index()])
            });
            let kept = self.kept.iter().enumerate().filter(|(_, kept)| moved[kept.next.index()]);
            let loops = self.loops.iter().enumerate().filter(|(_, own)| moved[own.result.index()]);
            let states = states.map(|(index, _)| Op::State(index as u32));
            let kept = kept.map(|(index, _)| Op::Kept(index as u32));
            let loops = loops.map(|(index, _)| Op::Tear(index as u32));
            let found: Vec<Op> = [source].into_iter().chain(states).chain(kept).chain(loops).collect();
            if found.len() == sources.len() {
                return moved;
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

    fn hears(patch: &Patch) -> Vec<Vec<usize>> {
        let program = Program::new(&Circuit::new(patch, &[]).unwrap()).unwrap();
        program.delays.iter().map(|delay| delay.hears.clone()).collect()
    }

    #[test]
    fn echoes_come_back_through_integrators_only_where_a_cord_leads() {
        // A line of a drive, and one that its own output comes back to by an integrator.
        let patch = Patch::read("tests/patches/delay-line.json".as_ref()).unwrap();
        assert_eq!(hears(&patch), [vec![], vec![1]]);
        let delay = |from: &str| ElementBuilder::new("delay").cord("in", from).set("delay", 0.1);
        let patch = PatchBuilder::new("one behind the other")
            .scale("volt", 1, "V")
            .drive("u", "volt", ElementBuilder::new("sine").set("amplitude", 10).set("frequency", 1))
            .element("D1", delay("u"))
            .element("A1", ElementBuilder::new("integrator").cords("x1", ["D1"]))
            .element("D2", delay("A1"))
            .element("D3", delay("D2"))
            .run(1.0, 1e-3)
            .build()
            .unwrap();
        // What comes through a line comes as that line's echo.
        assert_eq!(hears(&patch), [vec![], vec![0], vec![1]]);
    }
}
