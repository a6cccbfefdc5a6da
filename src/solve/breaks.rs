//! Instants at which voltages jump or turn a corner: no step reaches across one.

use super::machine::Machine;
use super::noise_source::NoiseSource;

/// Share of a step within which instants are the same.
const SAME: f64 = 1e-9;

impl Machine<'_> {
    pub(super) fn remember_delays(&mut self) {
        for (line, delay) in self.lines.iter_mut().zip(&self.program.delays) {
            line.put(self.time, self.registers[delay.input.index()]);
        }
        self.beside(|own, machine| own.remember_delays(machine));
    }

    /// The same at an instant at which voltages jump or turn a corner: their echo will do so too. `echoes`
    /// tells how often it has echoed so far.
    pub(super) fn remember_break(&mut self, echoes: u8) {
        for (line, delay) in self.lines.iter_mut().zip(&self.program.delays) {
            line.put_break(self.time, self.registers[delay.input.index()], echoes);
        }
        self.beside(|own, machine| own.remember_break(machine));
    }

    /// The end of a stretch on the way to a time: no stretch goes across an echo, the corner of a table, or an
    /// instant at which noise jumps.
    pub(super) fn end_of_stretch(&self, target: f64) -> f64 {
        let jumps = self.noises.iter().map(NoiseSource::next);
        let before = jumps.chain(self.next_corner()).filter(|time| *time < target - SAME * self.step);
        let echoes = self.lines.iter().filter_map(|line| line.echo_before(target));
        echoes.chain(before).fold(target, f64::min)
    }

    fn next_corner(&self) -> Option<f64> {
        let corners = &self.program.corners;
        let next = corners.partition_point(|corner| *corner <= self.time + SAME * self.step);
        corners.get(next).copied()
    }

    fn is_at_corner(&self) -> bool {
        let corners = &self.program.corners;
        let next = corners.partition_point(|corner| *corner < self.time - SAME * self.step);
        corners.get(next).is_some_and(|corner| *corner <= self.time + SAME * self.step)
    }

    /// Takes note of what breaks here: corners of tables, jumps of noise, and the echoes that come out of delay
    /// lines. Tells whether any voltage may have jumped.
    pub(super) fn meet_breaks(&mut self) -> bool {
        if self.is_at_corner() {
            self.remember_break(0);
        }
        let heard = self.lines.iter_mut().filter_map(|line| line.echoes_by(self.time)).min();
        let drawn = self.draw_by(self.time + SAME * self.step);
        if heard.is_some() || drawn {
            self.evaluate();
            self.remember_break(if drawn { 0 } else { heard.map_or(0, |echoes| echoes + 1) });
        }
        heard.is_some() || drawn
    }
}
