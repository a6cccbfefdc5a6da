//! Instants at which voltages jump or turn a corner: no step reaches across one.

use super::machine::Machine;
use crate::delay_line::{self, DelayLine};

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

    /// The same at an instant at which voltages jump or turn a corner: their echo will do so too.
    pub(super) fn remember_break(&mut self) {
        for (line, delay) in self.lines.iter_mut().zip(&self.program.delays) {
            line.put_break(self.time, self.registers[delay.input.index()], 0);
        }
        self.beside(|own, machine| own.remember_break(machine));
    }

    /// The end of a stretch on the way to a time: no stretch goes across an echo, the corner of a table, or an
    /// instant at which a level jumps.
    pub(super) fn end_of_stretch(&self, target: f64) -> f64 {
        let echoes = self.lines.iter().filter_map(|line| line.echo_before(target));
        echoes.fold(self.end_before(target, self.program.corners.times()), f64::min)
    }

    /// The end of a flight, which goes on over corners of tables that fall on the ends of its steps, and over the echoes of
    /// corners.
    pub(super) fn end_of_flight(&self) -> f64 {
        let jumps = self.lines.iter().filter_map(DelayLine::next_jump);
        jumps.fold(self.end_before(f64::INFINITY, &self.stray_corners), f64::min)
    }

    fn end_before(&self, target: f64, corners: &[f64]) -> f64 {
        let tables = &self.program.tables;
        let jumps = self.level_sources.iter().map(|source| source.next(tables));
        let before = jumps.chain(self.next_of(corners)).filter(|time| *time < target - SAME * self.step);
        before.fold(target, f64::min)
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
            self.remember_break();
        }
        let heard = delay_line::hear(&mut self.lines, self.time);
        let jumped = self.jump_by(self.time + SAME * self.step);
        // Derivatives jump where corners come out, too.
        let moved = jumped || heard.is_some_and(|jumps| jumps || self.sensitivities.is_some());
        if moved {
            self.evaluate();
        }
        if jumped {
            self.remember_break();
        } else if heard.is_some() {
            let inputs = self.program.delays.iter().map(|delay| self.registers[delay.input.index()]);
            delay_line::pass_on(&mut self.lines, self.time, inputs);
            self.beside(|own, machine| own.remember_break(machine));
        }
        moved
    }
}
