//! The experiment that would tell two effects apart: of many drives that of which their predictions differ most.
//!
//! Both patches stand at rest, with their parameters as the data left them, and are driven alike. What counts of the difference is
//! what is left when the one is fitted to what the other predicts, whichever of the two comes nearer, or has fewer numbers.

use std::cmp::Ordering;

use crate::data::experiment::Feed;
use crate::data::record::Record;
use crate::fit::estimate::Point;
use crate::fit::fitted_model::Stage;
use crate::fit::levenberg_marquardt::{Task, stacked};
use crate::fit::model::{Choice, Course, Model, ModelError};
use crate::fit::problem::Problem;
use crate::statistics::acceptance::APART;
use crate::statistics::block_comparison::expected;
use crate::statistics::descriptive::ends;
use crate::statistics::directions::{clear, orthonormal, product};
use patchcord_core::machines::REFERENCE;

/// What a drive does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// After a tenth of the record it goes up at once, and stays.
    Step,
    /// Up and down at an even rate.
    Ramps,
    /// A sine.
    Sine,
    /// A quarter of the period forward, a quarter at rest, a quarter backward, a quarter at rest.
    Reversals,
}

impl Shape {
    /// Those that have a period.
    const PERIODIC: [Shape; 3] = [Shape::Ramps, Shape::Sine, Shape::Reversals];

    /// The word for it.
    pub fn as_str(self) -> &'static str {
        match self {
            Shape::Step => "step",
            Shape::Ramps => "ramps",
            Shape::Sine => "sine",
            Shape::Reversals => "reversals",
        }
    }

    /// Its value between -1 and 1 after so many periods; of a step, the period is the time before it.
    fn at(self, periods: f64) -> f64 {
        let part = periods.fract();
        match self {
            Shape::Step => f64::from(u8::from(periods >= 1.0)),
            Shape::Sine => libm::sin(std::f64::consts::TAU * part),
            Shape::Ramps if part < 0.25 => 4.0 * part,
            Shape::Ramps if part < 0.75 => 2.0 - 4.0 * part,
            Shape::Ramps => 4.0 * part - 4.0,
            Shape::Reversals => [1.0, 0.0, -1.0, 0.0][(4.0 * part) as usize % 4],
        }
    }
}

/// A drive that would tell two effects apart, and what both patches make of it.
#[derive(Debug, Clone)]
pub struct Separating {
    /// The effects, each at its place.
    pub from: [String; 2],
    /// The drive.
    pub drive: String,
    /// Its unit.
    pub unit: String,
    /// What it does,
    pub shape: Shape,
    /// how far to either side,
    pub amplitude: f64,
    /// of what,
    pub about: f64,
    /// and how often, in seconds; of a step, after how long.
    pub period: f64,
    /// Whether it goes to the side of zero to which the records never went.
    pub turns: bool,
    /// Of every output, how far the predictions differ: rms over noise.
    pub apart: Vec<f64>,
    /// In how many standard errors of the comparison the one would stand above the other.
    pub errors: f64,
    /// The outputs, in the order of `apart` and of the predictions.
    pub(crate) outputs: Vec<String>,
    /// The drives that the data feed, in the order of the record.
    pub(crate) feeds: Vec<Feed>,
    /// The record that the experiment would make: its drives and times.
    pub(crate) record: Record,
    /// Of either effect, what the patch with it predicts of every output.
    pub(crate) predictions: [Course; 2],
}

/// Amplitudes, over how far the records go from where the drive rests.
const AMPLITUDES: [f64; 4] = [0.25, 0.5, 1.0, 2.0];
/// So many periods, from the length of the record down,
const PERIODS: i32 = 8;
/// to so many samples.
const LEAST_PERIOD: f64 = 10.0;
/// A step comes after this share of the record.
const BEFORE_STEP: f64 = 0.1;
/// So many drives, those with the largest differences, are looked at with everything fitted again to first order,
const FOLLOWED: usize = 16;
/// and so many of them to the end.
const REFITTED: usize = 4;
/// An experiment tells when what it would show is so many times what rivals must be behind.
const WITH_MARGIN: f64 = 1.5;

impl Separating {
    /// Whether the experiment would tell one from the other.
    pub fn tells(&self) -> bool {
        self.errors > WITH_MARGIN * APART
    }
}

/// A drive that is tried.
#[derive(Debug, Clone, Copy)]
struct Tried {
    /// Which of the fed drives.
    drive: usize,
    shape: Shape,
    amplitude: f64,
    period: f64,
}

/// How a drive rests, and how far it may go from there.
#[derive(Debug, Clone, Copy)]
struct Resting {
    about: f64,
    most: f64,
    /// Least and largest value that the machine and its sign allow it.
    allowed: [f64; 2],
}

/// How far two predictions differ when the one is fitted to the other.
struct Apart {
    rms: Vec<f64>,
    errors: f64,
}

/// A drive, by its place, with what both patches make of it.
struct Run {
    place: usize,
    predictions: [Course; 2],
}

/// One of two effects that data cannot tell apart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rival<'a> {
    /// The effect and where it acts.
    pub name: &'a str,
    /// The patch with it, fitted.
    pub stage: &'a Stage,
}

/// The drive that best tells two effects apart; nothing where no drive can be run. Drives keep the sign that they had, unless
/// none tells so. `noise` is the variance of what counts as noise, with how long it remembers.
///
/// # Errors
/// When the patches cannot be run.
pub(crate) fn discriminating_experiment(
    problem: &Problem,
    rivals: [Rival<'_>; 2],
    noise: f64,
) -> Result<Option<Separating>, ModelError> {
    let alike = best_drive(problem, rivals, noise, false)?;
    if alike.as_ref().is_some_and(Separating::tells)
        || (0..problem.drives.len()).all(|own| goes_both_ways(problem, own))
    {
        return Ok(alike);
    }
    let turned = best_drive(problem, rivals, noise, true)?.filter(Separating::tells);
    Ok(turned.or(alike))
}

/// The same, of drives that keep their sign or may turn.
fn best_drive(
    problem: &Problem,
    rivals: [Rival<'_>; 2],
    noise: f64,
    turns: bool,
) -> Result<Option<Separating>, ModelError> {
    let Some(longest) = problem.train.iter().max_by_key(|record| record.len()) else { return Ok(None) };
    let resting: Vec<Resting> =
        (0..problem.drives.len()).map(|drive| resting_of(problem, drive, turns)).collect();
    let tried: Vec<Tried> =
        resting.iter().enumerate().flat_map(|(drive, own)| own.tried(drive, longest)).collect();
    let records: Vec<Record> = tried.iter().map(|own| own.record(longest, &resting)).collect();
    let comparison = Comparison { problem, rivals, records: &records, noise };
    let best = comparison.best(farthest_predictions(problem, rivals, &records)?)?;
    Ok(best.map(|(apart, Run { place, predictions })| {
        let Tried { drive, shape, amplitude, period } = tried[place];
        Separating {
            from: rivals.map(|own| own.name.to_owned()),
            drive: problem.drives[drive].drive.clone(),
            unit: problem.drives[drive].unit.text().to_owned(),
            shape,
            amplitude,
            about: resting[drive].about,
            period,
            turns: turns && !goes_both_ways(problem, drive),
            apart: apart.rms,
            errors: apart.errors,
            outputs: problem.outputs.clone(),
            feeds: problem.drives.clone(),
            record: records[place].clone(),
            predictions,
        }
    }))
}

fn drive_values(problem: &Problem, drive: usize) -> impl Iterator<Item = f64> + '_ {
    problem.train.iter().flat_map(move |record| &record.drives[drive]).copied()
}

/// Whether a drive has been on both sides of zero.
fn goes_both_ways(problem: &Problem, drive: usize) -> bool {
    let [least, most] = ends(drive_values(problem, drive));
    least < 0.0 && most > 0.0
}

/// A drive that has been on both sides of zero, or may go there, rests there, another at its mean; that one keeps its sign.
fn resting_of(problem: &Problem, drive: usize, turns: bool) -> Resting {
    let [least, most] = ends(drive_values(problem, drive));
    let full = REFERENCE * problem.drives[drive].per_volt.abs();
    let (about, allowed) = if turns || goes_both_ways(problem, drive) {
        (0.0, [-full, full])
    } else {
        let mean = drive_values(problem, drive).sum::<f64>() / drive_values(problem, drive).count() as f64;
        (mean, if least < 0.0 { [-full, 0.0] } else { [0.0, full] })
    };
    Resting { about, most: (most - about).max(about - least), allowed }
}

/// Of drives that both patches can be run with, those whose predictions differ most.
fn farthest_predictions(
    problem: &Problem,
    rivals: [Rival<'_>; 2],
    records: &[Record],
) -> Result<Vec<Run>, ModelError> {
    let [one, other] =
        [predictions_of(problem, rivals[0], records)?, predictions_of(problem, rivals[1], records)?];
    let both = one.into_iter().zip(other).enumerate();
    let mut runs: Vec<(f64, Run)> = both
        .filter_map(|(place, (one, other))| {
            let predictions = [one?, other?];
            Some((squared_difference(problem, &predictions), Run { place, predictions }))
        })
        .collect();
    runs.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(runs.into_iter().take(FOLLOWED).map(|(_, run)| run).collect())
}

/// What a rival makes of drives, from rest; nothing where it cannot be run or an amplifier is overloaded.
fn predictions_of(
    problem: &Problem,
    rival: Rival<'_>,
    records: &[Record],
) -> Result<Vec<Option<Course>>, ModelError> {
    let model = problem.model(&rival.stage.version, records, &problem.outputs)?;
    let point = at_rest(rival, &model);
    let choice = Choice { knobs: point.knobs, initial: model.initial.iter().map(|own| own.value).collect() };
    let choices = [choice];
    Ok((0..records.len()).map(|record| model.run_within_range(record, &choices).pop().flatten()).collect())
}

/// The sum of squares of the differences, over the noise.
fn squared_difference(problem: &Problem, [one, other]: &[Course; 2]) -> f64 {
    let tracks = one.iter().zip(other).zip(&problem.sigma);
    tracks
        .map(|((one, other), sigma)| {
            one.iter().zip(other).map(|(a, b)| ((a - b) / sigma).powi(2)).sum::<f64>()
        })
        .sum()
}

/// Two rivals under many drives.
struct Comparison<'a> {
    problem: &'a Problem,
    rivals: [Rival<'a>; 2],
    records: &'a [Record],
    /// The variance of the noise, with how long it remembers.
    noise: f64,
}

impl Comparison<'_> {
    /// The run of which most is left when either trial is fitted to the other.
    fn best(&self, runs: Vec<Run>) -> Result<Option<(Apart, Run)>, ModelError> {
        let apart = |run: Run, fits: bool| Ok((self.apart_at_least(&run, fits)?, run));
        let farthest =
            |found: &mut Vec<(Apart, Run)>| found.sort_by(|a, b| b.0.errors.total_cmp(&a.0.errors));
        let mut followed: Vec<(Apart, Run)> =
            runs.into_iter().map(|run| apart(run, false)).collect::<Result<_, ModelError>>()?;
        farthest(&mut followed);
        let nearest = followed.into_iter().take(REFITTED).map(|(_, run)| apart(run, true));
        let mut fitted: Vec<(Apart, Run)> = nearest.collect::<Result<_, ModelError>>()?;
        farthest(&mut fitted);
        Ok(fitted.into_iter().next())
    }

    /// How far the predictions differ when that one is fitted to the other which comes nearer; of two of which one has fewer numbers
    /// that one: the other may hold it as a case of its own, and then has to be worth its numbers.
    fn apart_at_least(&self, run: &Run, fits: bool) -> Result<Apart, ModelError> {
        let numbers = self.rivals.map(|own| own.stage.version.fit.len());
        match numbers[0].cmp(&numbers[1]) {
            Ordering::Less => self.apart(run, 0, fits),
            Ordering::Greater => self.apart(run, 1, fits),
            Ordering::Equal => {
                let [one, other] = [self.apart(run, 0, fits)?, self.apart(run, 1, fits)?];
                Ok(if one.errors < other.errors { one } else { other })
            }
        }
    }

    /// What one trial leaves of the prediction of the other when it is fitted to it: to first order, or to the end.
    fn apart(&self, run: &Run, own: usize, fits: bool) -> Result<Apart, ModelError> {
        let (rival, outputs) = (self.rivals[own], run.predictions[1 - own].clone());
        let records = [Record { outputs, ..self.records[run.place].clone() }];
        let model = self.problem.model(&rival.stage.version, &records, &self.problem.outputs)?;
        let task = self.problem.task(&model, &records, true);
        let rest = at_rest(rival, &model);
        let fitted = if fits { task.fit(&rest) } else { None };
        let left = fitted.map_or_else(
            || followed(&task, &rest, &run.predictions[own]),
            |fitted| fitted.residuals.into_iter().flatten().flatten().collect(),
        );
        let tracks: Vec<&[f64]> = left.chunks(records[0].len()).collect();
        let rms = |track: &&[f64]| (product(track, track) / track.len() as f64).sqrt();
        Ok(Apart { rms: tracks.iter().map(rms).collect(), errors: expected(&[tracks], self.noise).ratio() })
    }
}

/// What a course leaves of the data when everything that is fitted follows to first order.
fn followed(task: &Task<'_>, from: &Point, course: &Course) -> Vec<f64> {
    let at = task.shares(from);
    let mut left: Vec<f64> =
        (0..course.len()).flat_map(|output| task.residual(&at, 0, output, course)).collect();
    let responses = task.responses(&at, 0, course);
    let free = (0..at.len()).filter(|index| task.is_free(*index));
    let columns = free.map(|index| stacked(&responses, index, task.records[0].len()));
    clear(&orthonormal(columns), &mut left);
    left
}

/// The parameters of a rival, with the initial voltages of its patch.
fn at_rest(rival: Rival<'_>, model: &Model) -> Point {
    Point {
        knobs: rival.stage.train.point.knobs.clone(),
        ..Point::of(model, rival.stage.train.point.offsets.len())
    }
}

impl Resting {
    /// Drives of every shape, size and period that keep within what is allowed.
    fn tried(self, drive: usize, longest: &Record) -> Vec<Tried> {
        let length = longest.duration();
        let shortest = (LEAST_PERIOD * longest.interval).min(length);
        let period =
            |place: i32| length * libm::pow(shortest / length, f64::from(place) / f64::from(PERIODS - 1));
        let periodic = Shape::PERIODIC
            .into_iter()
            .flat_map(|shape| (0..PERIODS).map(move |place| (shape, period(place))));
        let shapes: Vec<(Shape, f64)> =
            [(Shape::Step, BEFORE_STEP * length)].into_iter().chain(periodic).collect();
        let tried = AMPLITUDES.into_iter().flat_map(|share| {
            let amplitude = share * self.most;
            shapes.iter().map(move |(shape, period)| Tried {
                drive,
                shape: *shape,
                amplitude,
                period: *period,
            })
        });
        let is_allowed = |own: &Tried| {
            let least = if own.shape == Shape::Step { 0.0 } else { own.amplitude };
            self.about - least >= self.allowed[0] && self.about + own.amplitude <= self.allowed[1]
        };
        tried.filter(is_allowed).collect()
    }
}

impl Tried {
    /// The drive over a record as long and as finely sampled as another, the other drives at rest.
    fn record(self, like: &Record, resting: &[Resting]) -> Record {
        let value = |drive: usize, sample: usize| {
            let time = sample as f64 * like.interval;
            let moved =
                if drive == self.drive { self.amplitude * self.shape.at(time / self.period) } else { 0.0 };
            resting[drive].about + moved
        };
        let drive = |drive: usize| (0..like.len()).map(|sample| value(drive, sample)).collect();
        Record {
            name: String::new(),
            begin: 0.0,
            since: 0.0,
            jitter: 0.0,
            drives: (0..resting.len()).map(drive).collect(),
            ..like.clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_go_to_both_sides_and_come_back() {
        for shape in Shape::PERIODIC {
            let values: Vec<f64> = (0..100).map(|place| shape.at(0.005 + 0.03 * f64::from(place))).collect();
            let ends =
                values.iter().fold([0.0_f64; 2], |[least, most], own| [least.min(*own), most.max(*own)]);
            assert!(ends[0] < -0.95 && ends[1] > 0.95, "{shape:?} {ends:?}");
            assert!(values.iter().sum::<f64>().abs() < 4.0, "{shape:?}");
        }
        assert_eq!([0.5, 1.0, 7.3].map(|periods| Shape::Step.at(periods)), [0.0, 1.0, 1.0]);
    }

    #[test]
    fn a_drive_of_one_sign_keeps_it() {
        let record = Record {
            name: String::new(),
            begin: 0.0,
            since: 0.0,
            interval: 0.1,
            jitter: 0.0,
            drives: vec![vec![0.0; 200]],
            outputs: vec![vec![0.0; 200]],
        };
        let pump = Resting { about: 4.0, most: 3.0, allowed: [0.0, 10.0] };
        let tried = pump.tried(0, &record);
        assert!(tried.iter().any(|own| own.shape == Shape::Step && own.amplitude == 6.0));
        for own in &tried {
            let drive = own.record(&record, &[pump]).drives.remove(0);
            assert_eq!(drive.len(), 200);
            assert!(drive.iter().all(|value| (0.0..=10.0).contains(value)), "{own:?}");
        }
        let periods: Vec<f64> =
            tried.iter().filter(|own| own.shape == Shape::Sine).map(|own| own.period).collect();
        let [longest, shortest] = [periods[0], periods[7]];
        assert!((longest - 19.9).abs() < 1e-9 && (shortest - 1.0).abs() < 1e-9, "{periods:?}");
    }
}
