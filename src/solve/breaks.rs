//! Instants at which voltages jump or turn a corner: no step reaches across one.

use super::machine::Machine;

/// The error of a cubic through four points in a row, as a share of their fourth difference: at most this.
const CUBIC: f64 = 1.0 / 24.0;
/// A stretch is cut into so many pieces at most.
const MOST_PIECES: f64 = 1000.0;
/// Share of a step within which instants are the same.
pub(super) const SAME: f64 = 1e-9;

impl Machine<'_> {
    pub(super) fn remember_delays(&mut self) {
        self.remember_within();
        for (line, delay) in self.lines.iter_mut().zip(&self.program.delays) {
            line.put(self.time, self.registers[delay.input.index()]);
        }
        self.beside(|own, machine| own.remember_delays(machine));
    }

    /// Puts points within the last stretch into the delay lines, where a tolerance is set.
    fn remember_within(&mut self) {
        let (begin, length, pieces) = (self.last.time, self.time - self.last.time, self.pieces());
        for piece in 1..pieces {
            let time = begin + length * f64::from(piece) / f64::from(pieces);
            self.look_back(time);
            for (line, delay) in self.lines.iter_mut().zip(&self.program.delays) {
                line.put(time, self.trial_registers[delay.input.index()]);
            }
            self.beside(|own, machine| own.remember_within(machine, time));
        }
    }

    /// Into how many pieces the last stretch is cut, so that no cubic through their ends errs by more than the tolerance
    /// allows in a delay: by the fourth difference of its quarters.
    fn pieces(&mut self) -> u32 {
        let Some(control) = self.control.filter(|_| !self.lines.is_empty()) else { return 1 };
        let (begin, length) = (self.last.time, self.time - self.last.time);
        for (bend, delay) in self.bends.iter_mut().zip(&self.program.delays) {
            *bend = self.last.registers[delay.input.index()] + self.registers[delay.input.index()];
        }
        for (share, weight) in [(0.25, -4.0), (0.5, 6.0), (0.75, -4.0)] {
            self.look_back(begin + share * length);
            for (bend, delay) in self.bends.iter_mut().zip(&self.program.delays) {
                *bend += weight * self.trial_registers[delay.input.index()];
            }
        }
        let errors = self.bends.iter().map(|bend| CUBIC * bend.abs());
        let excesses = errors.zip(&self.lines).map(|(error, line)| error / control.allowed(line.delay()));
        let pieces = 4.0 * excesses.fold(0.0, f64::max).powf(0.25);
        pieces.ceil().clamp(4.0, MOST_PIECES) as u32
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
    /// instant at which a level jumps.
    pub(super) fn end_of_stretch(&self, target: f64) -> f64 {
        self.end_before(target, self.program.corners.times())
    }

    /// The end of a flight, which goes on over corners of tables that fall on the ends of its steps.
    pub(super) fn end_of_flight(&self) -> f64 {
        self.end_before(f64::INFINITY, &self.stray_corners)
    }

    fn end_before(&self, target: f64, corners: &[f64]) -> f64 {
        let tables = &self.program.tables;
        let jumps = self.level_sources.iter().map(|source| source.next(tables));
        let corner = self.next_of(corners);
        let before = jumps.chain(corner).filter(|time| *time < target - SAME * self.step);
        let echoes = self.lines.iter().filter_map(|line| line.echo_before(target));
        echoes.chain(before).fold(target, f64::min)
    }

    fn next_of(&self, corners: &[f64]) -> Option<f64> {
        let next = corners.partition_point(|corner| *corner <= self.time + SAME * self.step);
        corners.get(next).copied()
    }

    fn is_at_corner(&self) -> bool {
        let corners = self.program.corners.times();
        let next = corners.partition_point(|corner| *corner < self.time - SAME * self.step);
        corners.get(next).is_some_and(|corner| *corner <= self.time + SAME * self.step)
    }

    /// Takes note of what breaks here: corners of tables, jumps of levels, and the echoes that come out of delay
    /// lines. Tells whether any voltage may have jumped.
    pub(super) fn meet_breaks(&mut self) -> bool {
        if self.is_at_corner() {
            self.remember_break(0);
        }
        let heard = self.lines.iter_mut().filter_map(|line| line.echoes_by(self.time)).min();
        let jumped = self.jump_by(self.time + SAME * self.step);
        if heard.is_some() || jumped {
            self.evaluate();
            self.remember_break(if jumped { 0 } else { heard.map_or(0, |echoes| echoes + 1) });
        }
        heard.is_some() || jumped
    }
}
