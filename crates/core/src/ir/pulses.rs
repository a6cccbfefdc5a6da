//! Rectangular pulses at known instants: the drives `square` and `pulse`.
//!
//! An *edge* is an instant at which a pulse begins or ends. Edge 2 k is the rise of pulse k, and edge 2 k + 1 is its
//! fall. The solver ends a step at every edge. The instants follow from coefficients, so they have derivatives by
//! parameters.

use std::f64::consts::TAU;

use super::number::{Dual, Number};
use patchcord_expr::Function;

/// A source of rectangular pulses: 1 within a pulse, 0 outside.
#[derive(Debug, Clone)]
pub struct Pulses {
    /// Index of the drive.
    pub element: usize,
    /// The pulses, with an index of a coefficient for each setting.
    pub train: PulseTrain<u32>,
}

/// Pulses of equal width. `V` is the type of a setting: an index of a coefficient, a number, or a number with its
/// slope.
#[derive(Debug, Clone, Copy)]
pub enum PulseTrain<V> {
    /// Pulses without beginning and end.
    Wave {
        /// Pulses per problem second.
        frequency: V,
        /// Width of a pulse as a share (0 ... 1) of its period.
        duty: V,
        /// Phase at t = 0 in radians. A pulse begins at the phase 0.
        phase: V,
    },
    /// One pulse, or pulses that repeat without end.
    Train {
        /// Problem time at which the first pulse begins, in seconds.
        begin: V,
        /// Width of a pulse in problem seconds.
        width: V,
        /// Problem seconds between two rises; `None` if there is only one pulse.
        period: Option<V>,
    },
}

impl<V> PulseTrain<V> {
    /// The same pulses with other values of the settings.
    fn map<W>(self, value: impl Fn(V) -> W) -> PulseTrain<W> {
        match self {
            PulseTrain::Wave { frequency, duty, phase } => {
                PulseTrain::Wave { frequency: value(frequency), duty: value(duty), phase: value(phase) }
            }
            PulseTrain::Train { begin, width, period } => {
                PulseTrain::Train { begin: value(begin), width: value(width), period: period.map(value) }
            }
        }
    }
}

/// The problem time of an edge in seconds; infinity after the last edge.
fn edge_time<N: Number>(train: PulseTrain<N>, edge: u64) -> N {
    let (pulse, is_fall) = (N::constant((edge / 2) as f64), edge % 2 == 1);
    match train {
        PulseTrain::Wave { frequency, duty, phase } => {
            let turns = phase.divide(N::constant(TAU));
            let start = turns.subtract(N::call(Function::Floor, turns, turns));
            let cycles = if is_fall { pulse.add(duty) } else { pulse };
            cycles.subtract(start).divide(frequency)
        }
        PulseTrain::Train { begin, width, period } => {
            let rise = match period {
                Some(period) => begin.add(pulse.multiply(period)),
                None if edge < 2 => begin,
                None => N::constant(f64::INFINITY),
            };
            if is_fall { rise.add(width) } else { rise }
        }
    }
}

impl PulseTrain<f64> {
    /// The problem time of an edge in seconds; infinity after the last edge.
    pub(crate) fn time(self, edge: u64) -> f64 {
        edge_time(self, edge)
    }

    /// The number of edges up to a problem time in seconds.
    pub(crate) fn edges_until(self, time: f64) -> u64 {
        // A negative number of pulses becomes 0.
        let pulses = ((time - self.time(0)) / self.period()) as u64;
        let mut edges = pulses.saturating_mul(2);
        // Rounding may put the time into a neighbouring pulse.
        while edges > 0 && self.time(edges - 1) > time {
            edges -= 1;
        }
        while edges < u64::MAX && self.time(edges) <= time {
            edges += 1;
        }
        edges
    }

    /// Edges per problem second; 0 for a single pulse.
    pub(crate) fn rate(self) -> f64 {
        2.0 / self.period()
    }

    /// Problem seconds between two rises; infinity for a single pulse.
    fn period(self) -> f64 {
        match self {
            PulseTrain::Wave { frequency, .. } => 1.0 / frequency,
            PulseTrain::Train { period, .. } => period.unwrap_or(f64::INFINITY),
        }
    }
}

/// The value of pulses after this number of edges: 1 within a pulse, 0 outside.
pub(crate) fn pulse_value(edges: u64) -> f64 {
    if edges % 2 == 1 { 1.0 } else { 0.0 }
}

impl Pulses {
    /// The pulses with the present values of their settings.
    pub(crate) fn at(&self, coefficients: &[f64]) -> PulseTrain<f64> {
        self.train.map(|index| coefficients[index as usize])
    }

    /// The slope of the instant of an edge, in problem seconds. `slopes` are those of the coefficients.
    pub(crate) fn shift(&self, edge: u64, coefficients: &[f64], slopes: &[f64]) -> f64 {
        let setting = |index: u32| Dual::new(coefficients[index as usize], slopes[index as usize]);
        edge_time(self.train.map(setting), edge).slope
    }

    /// Whether an edge is at t = 0 and has a slope: with another value of the parameter it would be elsewhere. Edges at
    /// most `tolerance` seconds from 0 count as edges at 0.
    pub(crate) fn has_shifting_edge_at_start(
        &self,
        coefficients: &[f64],
        slopes: &[f64],
        tolerance: f64,
    ) -> bool {
        let train = self.at(coefficients);
        let last = train.edges_until(tolerance).checked_sub(1);
        last.is_some_and(|edge| {
            train.time(edge) >= -tolerance && self.shift(edge, coefficients, slopes) != 0.0
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn edges_are_counted_at_and_between_their_instants() {
        let wave: PulseTrain<f64> = PulseTrain::Wave { frequency: 10.0, duty: 0.25, phase: 0.0 };
        for pulse in 0..1000_u64 {
            let rise = pulse as f64 / 10.0;
            assert_eq!((wave.time(2 * pulse), wave.edges_until(rise)), (rise, 2 * pulse + 1));
            assert_eq!(wave.edges_until(rise.next_down()), 2 * pulse, "before the rise at {rise}");
            assert_eq!(wave.edges_until(wave.time(2 * pulse + 1)), 2 * pulse + 2);
        }
    }

    #[test]
    fn edges_of_short_periods_are_counted_long_after_the_start() {
        let train: PulseTrain<f64> = PulseTrain::Train { begin: 1e6, width: 2.5e-6, period: Some(1e-5) };
        for pulse in [0, 1, 1_000_000, 10_000_000] {
            let (rise, fall) = (train.time(2 * pulse), train.time(2 * pulse + 1));
            assert_eq!(train.edges_until(rise.next_down()), 2 * pulse, "before the rise at {rise}");
            assert_eq!((train.edges_until(rise), train.edges_until(fall)), (2 * pulse + 1, 2 * pulse + 2));
        }
        assert!((train.rate() - 2e5).abs() < 1e-9, "{}", train.rate());
        assert_eq!(train.edges_until(f64::MAX), u64::MAX, "the largest number");
    }

    #[test]
    fn a_phase_moves_the_edges_forward() {
        let wave = |phase: f64| PulseTrain::Wave { frequency: 2.0, duty: 0.5, phase };
        assert_eq!(wave(TAU / 4.0).time(1), 0.125);
        assert_eq!(wave(-TAU / 4.0).edges_until(0.0), 2, "the phase -90 degrees is between two pulses");
        assert_eq!(wave(-TAU / 4.0).time(2), 0.125);
        assert_eq!(pulse_value(wave(0.0).edges_until(0.0)), 1.0);
    }

    #[test]
    fn a_single_pulse_has_two_edges() {
        let pulse: PulseTrain<f64> = PulseTrain::Train { begin: 0.5, width: 0.25, period: None };
        assert_eq!([0.0, 0.5, 0.7, 0.75, 1e9].map(|time| pulse.edges_until(time)), [0, 1, 1, 2, 2]);
        assert_eq!((pulse.time(2), pulse.rate()), (f64::INFINITY, 0.0));
    }

    #[test]
    fn instants_have_slopes() {
        let train = PulseTrain::Train { begin: 0, width: 1, period: Some(2) };
        let pulses = Pulses { element: 0, train };
        assert_eq!(pulses.shift(7, &[0.0, 0.1, 0.5], &[10.0, 100.0, 1.0]), 113.0);
        let wave = Pulses { element: 0, train: PulseTrain::Wave { frequency: 0, duty: 1, phase: 2 } };
        // The third rise is at 3 / f, so its slope by f is -3 / f^2.
        assert_eq!(wave.shift(6, &[2.0, 0.5, 0.0], &[1.0, 0.0, 0.0]), -0.75);
        assert!(wave.has_shifting_edge_at_start(&[2.0, 0.5, 0.0], &[0.0, 0.0, 1.0], 0.0));
        assert!(!wave.has_shifting_edge_at_start(&[2.0, 0.5, 0.0], &[1.0, 1.0, 0.0], 0.0));
        // The phases shift the first edge to 1e-12 s after t = 0, and before it.
        for phase in [-4e-12 * PI, 4e-12 * PI] {
            let is_at_start = |tolerance: f64| {
                wave.has_shifting_edge_at_start(&[2.0, 0.5, phase], &[0.0, 0.0, 1.0], tolerance)
            };
            assert_eq!([2e-12, 0.5e-12].map(is_at_start), [true, false], "{phase}");
        }
    }
}
