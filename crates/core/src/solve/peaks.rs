//! The peaks and dips of voltages within a stretch, by the curve of the states.

use super::machine::Machine;
use super::turn::Turn;
use crate::ir::Register;

/// A turn is known when its place is, to this share of the stretch: its voltage is flat there.
const FOUND: f64 = 1e-4;
/// A turn lies within this share of the stretch of where the samples say.
const ABOUT: f64 = 0.3;
/// Voltages that swing by less, in volts, do not turn.
const STILL: f64 = 1e-9;
/// The share of the longer part that a search tries next where it knows no better (golden section).
const GOLDEN: f64 = 0.381_966_011_250_105;
const MOST_LOOKS: usize = 40;

impl Machine<'_> {
    /// The peak of a voltage above one value and its dip below another within the last stretch, each with its time. Only
    /// steps with a tolerance show them.
    pub(super) fn turns_beyond(&mut self, at: Register, [low, high]: [f64; 2]) -> [Option<(f64, f64)>; 2] {
        let mut found = [None; 2];
        let ends = [&self.last.registers, &self.registers].map(Vec::as_slice);
        let samples = self.samples(ends, |voltages| voltages[at.index()]);
        let Some(samples) = samples.filter(|samples| samples.swing() > STILL && self.last.time < self.time)
        else {
            return found;
        };
        for (place, turn) in found.iter_mut().zip(samples.turns()) {
            let beyond = samples.beyond(&turn);
            if if turn.is_peak { beyond > high } else { beyond < low } {
                *place = Some(self.followed(at, turn));
            }
        }
        found
    }

    /// Where a voltage turns on the curve of the states, near where the samples say.
    fn followed(&mut self, at: Register, turn: Turn) -> (f64, f64) {
        let (begin, length) = (self.last.time, self.time - self.last.time);
        let sign = if turn.is_peak { -1.0 } else { 1.0 };
        let mut look = |share: f64| {
            self.look_back(begin + share * length);
            sign * self.trial_registers[at.index()]
        };
        let ends = [(turn.share - ABOUT).max(0.0), (turn.share + ABOUT).min(1.0)];
        let mut search = Search::new(ends, turn.share, look(turn.share));
        for _ in 0..MOST_LOOKS {
            let Some(share) = search.next() else { break };
            search.take(share, look(share));
        }
        (begin + search.best.0 * length, sign * search.best.1)
    }
}

/// The search for the least value of a function (Brent 1973): by parabolas through the three best places, kept safe by the
/// golden section.
struct Search {
    ends: [f64; 2],
    /// The best places and their values.
    best: (f64, f64),
    second: (f64, f64),
    third: (f64, f64),
    /// The last two moves.
    moves: [f64; 2],
}

impl Search {
    fn new(ends: [f64; 2], place: f64, value: f64) -> Self {
        let first = (place, value);
        Search { ends, best: first, second: first, third: first, moves: [0.0; 2] }
    }

    /// The place to look at next; nothing once the least value is known.
    fn next(&mut self) -> Option<f64> {
        let ([low, high], (place, _)) = (self.ends, self.best);
        let middle = 0.5 * (low + high);
        if (place - middle).abs() + 0.5 * (high - low) <= 2.0 * FOUND {
            return None;
        }
        let vertex = self.vertex().filter(|by| {
            by.abs() < 0.5 * self.moves[0].abs() && low + FOUND < place + by && place + by < high - FOUND
        });
        self.moves = match vertex {
            Some(by) => [self.moves[1], by],
            None => {
                let longer = if place < middle { high - place } else { low - place };
                [longer, GOLDEN * longer]
            }
        };
        let by = self.moves[1];
        Some(place + if by.abs() < FOUND { FOUND.copysign(by) } else { by })
    }

    /// How far the vertex of the parabola through the three best places is.
    fn vertex(&self) -> Option<f64> {
        let [(x, at), (near, by_near), (far, by_far)] = [self.best, self.second, self.third];
        let (one, other) = ((x - near) * (at - by_far), (x - far) * (at - by_near));
        let by = -0.5 * ((x - far) * other - (x - near) * one) / (other - one);
        by.is_finite().then_some(by)
    }

    fn take(&mut self, place: f64, value: f64) {
        let (worse, is_better) = if value <= self.best.1 { (self.best.0, true) } else { (place, false) };
        // The worse of the two bounds the search on its side of the better one.
        let better = if is_better { place } else { self.best.0 };
        self.ends[usize::from(worse > better)] = worse;
        if is_better {
            (self.third, self.second, self.best) = (self.second, self.best, (place, value));
        } else if value <= self.second.1 || self.second.0 == self.best.0 {
            (self.third, self.second) = (self.second, (place, value));
        } else if value <= self.third.1 || self.third.0 == self.best.0 || self.third.0 == self.second.0 {
            self.third = (place, value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a search finds the least value of a function, and after how many looks.
    fn found(function: impl Fn(f64) -> f64, from: f64) -> (f64, usize) {
        let mut search = Search::new([0.0, 1.0], from, function(from));
        let mut looks = 1;
        while let Some(place) = search.next() {
            search.take(place, function(place));
            looks += 1;
        }
        (search.best.0, looks)
    }

    #[test]
    fn the_least_value_is_found_where_it_is_flat_at_a_corner_and_at_an_end() {
        for least in [0.0, 0.123, 0.5, 0.9] {
            let (place, looks) = found(|x| (x - least).powi(2) * (3.0 + x), 0.45);
            assert!((place - least).abs() < 3.0 * FOUND && looks < 25, "{place} of {least} after {looks}");
            let (place, looks) = found(|x| (x - least).abs() * (3.0 + x), 0.45);
            assert!(
                (place - least).abs() < 3.0 * FOUND && looks < MOST_LOOKS,
                "{place} of {least} after {looks}"
            );
        }
    }
}
