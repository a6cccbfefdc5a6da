//! Drive signals that are proposed for a discriminating experiment.
//!
//! A proposal has one of four shapes, an amplitude and a period. The limits of its drive follow from the training
//! records: a drive that always had one sign keeps it, unless it is allowed to reverse.

use crate::data::record::Record;
use crate::fit::problem::Problem;
use crate::statistics::descriptive::extremes;
use patchcord_core::machines::REFERENCE;

/// Amplitudes that are tried, as multiples of the largest excursion of the drive in the training records.
const AMPLITUDES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
/// Number of periods that are tried. They form a geometric sequence from the length of the record down.
const PERIOD_COUNT: i32 = 8;
/// Shortest period that is tried, in samples.
const SHORTEST_PERIOD: f64 = 10.0;
/// Time of a step, as a fraction of the record.
const STEP_TIME_FRACTION: f64 = 0.1;

/// The shape of a drive signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// It jumps to the amplitude after a tenth of the record, and stays there.
    Step,
    /// It rises and falls at a constant rate.
    Ramps,
    /// A sine.
    Sine,
    /// A quarter of the period at the positive amplitude, a quarter at rest, a quarter at the negative amplitude, a
    /// quarter at rest.
    Reversals,
}

impl Shape {
    /// The shapes with a period.
    const PERIODIC: [Shape; 3] = [Shape::Ramps, Shape::Sine, Shape::Reversals];

    /// The name of the shape in reports and documents.
    pub fn as_str(self) -> &'static str {
        match self {
            Shape::Step => "step",
            Shape::Ramps => "ramps",
            Shape::Sine => "sine",
            Shape::Reversals => "reversals",
        }
    }

    /// The value, from -1 to 1, at this time in periods. The period of a step is the time before it.
    fn at(self, periods: f64) -> f64 {
        let phase = periods.fract();
        match self {
            Shape::Step => f64::from(u8::from(periods >= 1.0)),
            Shape::Sine => libm::sin(std::f64::consts::TAU * phase),
            Shape::Ramps if phase < 0.25 => 4.0 * phase,
            Shape::Ramps if phase < 0.75 => 2.0 - 4.0 * phase,
            Shape::Ramps => 4.0 * phase - 4.0,
            Shape::Reversals => [1.0, 0.0, -1.0, 0.0][(4.0 * phase) as usize % 4],
        }
    }
}

/// A proposed drive signal.
#[derive(Debug, Clone, Copy)]
pub(super) struct DriveProposal {
    /// Index of the drive among those that the data feed.
    pub drive: usize,
    /// The shape of the signal.
    pub shape: Shape,
    /// Amplitude to either side of the rest value, in the unit of the drive.
    pub amplitude: f64,
    /// Period in seconds. For a step, it is the time before the step.
    pub period: f64,
}

/// The rest value of a drive and its limits, in the unit of the drive.
#[derive(Debug, Clone, Copy)]
pub(super) struct DriveLimits {
    /// The value from which the signal departs.
    pub rest: f64,
    /// Largest excursion from the rest value in the training records.
    excursion: f64,
    /// Least and largest value that the machine unit and the sign of the drive permit.
    allowed: [f64; 2],
}

/// All samples of a drive in the training records.
fn drive_values(problem: &Problem, drive: usize) -> impl Iterator<Item = f64> + '_ {
    problem.train.iter().flat_map(move |record| &record.drives[drive]).copied()
}

/// Whether a drive has both signs in the training records.
pub(super) fn has_both_signs(problem: &Problem, drive: usize) -> bool {
    let [least, most] = extremes(drive_values(problem, drive));
    least < 0.0 && most > 0.0
}

impl DriveLimits {
    /// The limits of a drive. With both signs, or if it can be reversed, it rests at zero and may use the full machine
    /// unit. With one sign it rests at its mean and keeps the sign.
    pub(super) fn of(problem: &Problem, drive: usize, can_reverse: bool) -> DriveLimits {
        let [least, most] = extremes(drive_values(problem, drive));
        let full = REFERENCE * problem.drives[drive].per_volt.abs();
        let (rest, allowed) = if can_reverse || has_both_signs(problem, drive) {
            (0.0, [-full, full])
        } else {
            let mean =
                drive_values(problem, drive).sum::<f64>() / drive_values(problem, drive).count() as f64;
            (mean, if least < 0.0 { [-full, 0.0] } else { [0.0, full] })
        };
        DriveLimits { rest, excursion: (most - rest).max(rest - least), allowed }
    }

    /// Signals of every shape, amplitude and period that stay in the allowed range. `longest` is the longest training
    /// record.
    pub(super) fn proposals(self, drive: usize, longest: &Record) -> Vec<DriveProposal> {
        let length = longest.duration();
        let shortest = (SHORTEST_PERIOD * longest.interval).min(length);
        let period = |index: i32| {
            length * libm::pow(shortest / length, f64::from(index) / f64::from(PERIOD_COUNT - 1))
        };
        let periodic = Shape::PERIODIC
            .into_iter()
            .flat_map(|shape| (0..PERIOD_COUNT).map(move |index| (shape, period(index))));
        let shapes: Vec<(Shape, f64)> =
            [(Shape::Step, STEP_TIME_FRACTION * length)].into_iter().chain(periodic).collect();
        let proposals = AMPLITUDES.into_iter().flat_map(|multiple| {
            let amplitude = multiple * self.excursion;
            shapes.iter().map(move |(shape, period)| DriveProposal {
                drive,
                shape: *shape,
                amplitude,
                period: *period,
            })
        });
        let is_allowed = |proposal: &DriveProposal| {
            let below = if proposal.shape == Shape::Step { 0.0 } else { proposal.amplitude };
            self.rest - below >= self.allowed[0] && self.rest + proposal.amplitude <= self.allowed[1]
        };
        proposals.filter(is_allowed).collect()
    }
}

impl DriveProposal {
    /// A record with this signal and all other drives at rest, with the length and the sampling interval of `like`.
    pub(super) fn record(self, like: &Record, limits: &[DriveLimits]) -> Record {
        let value = |drive: usize, sample: usize| {
            let time = sample as f64 * like.interval;
            let excursion =
                if drive == self.drive { self.amplitude * self.shape.at(time / self.period) } else { 0.0 };
            limits[drive].rest + excursion
        };
        let drive = |drive: usize| (0..like.len()).map(|sample| value(drive, sample)).collect();
        Record {
            name: String::new(),
            begin: 0.0,
            start_in_file: 0.0,
            jitter: 0.0,
            drives: (0..limits.len()).map(drive).collect(),
            ..like.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periodic_shapes_reach_both_ends_and_have_zero_mean() {
        for shape in Shape::PERIODIC {
            let values: Vec<f64> = (0..100).map(|index| shape.at(0.005 + 0.03 * f64::from(index))).collect();
            let ends = values
                .iter()
                .fold([0.0_f64; 2], |[least, most], value| [least.min(*value), most.max(*value)]);
            assert!(ends[0] < -0.95 && ends[1] > 0.95, "{shape:?} {ends:?}");
            assert!(values.iter().sum::<f64>().abs() < 4.0, "{shape:?}");
        }
        assert_eq!([0.5, 1.0, 7.3].map(|periods| Shape::Step.at(periods)), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_drive_of_one_sign_keeps_its_sign() {
        let record = Record {
            name: String::new(),
            begin: 0.0,
            start_in_file: 0.0,
            interval: 0.1,
            jitter: 0.0,
            drives: vec![vec![0.0; 200]],
            outputs: vec![vec![0.0; 200]],
        };
        let pump = DriveLimits { rest: 4.0, excursion: 3.0, allowed: [0.0, 10.0] };
        let proposals = pump.proposals(0, &record);
        assert!(proposals.iter().any(|proposal| proposal.shape == Shape::Step && proposal.amplitude == 6.0));
        for proposal in &proposals {
            let drive = proposal.record(&record, &[pump]).drives.remove(0);
            assert_eq!(drive.len(), 200);
            assert!(drive.iter().all(|value| (0.0..=10.0).contains(value)), "{proposal:?}");
        }
        let sines = proposals.iter().filter(|proposal| proposal.shape == Shape::Sine);
        let periods: Vec<f64> = sines.map(|proposal| proposal.period).collect();
        let [longest, shortest] = [periods[0], periods[7]];
        assert!((longest - 19.9).abs() < 1e-9 && (shortest - 1.0).abs() < 1e-9, "{periods:?}");
    }
}
