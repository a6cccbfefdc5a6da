//! What a patch is held against: records to fit and to confirm with, and the noise of what they hold.

use super::clock::begun_anew;
use super::examine::{NoiseKind, examine, noise_of};
use super::experiment::{Experiment, Feed};
use super::fit::{Ladder, MOST_ROUNDS, Point, SETTLED_SHARE, Task};
use super::model::{Model, ModelError};
use super::record::Record;
use super::stage::Version;
use super::statistics::ends;

/// What a patch is held against.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Drives that the records feed.
    pub drives: Vec<Feed>,
    /// Standard deviation of the noise of each.
    pub drive_sigma: Vec<f64>,
    /// Signals that they hold.
    pub outputs: Vec<String>,
    /// Standard deviation of the noise of each.
    pub sigma: Vec<f64>,
    /// Which of them may stand off by a constant.
    pub offset: Vec<bool>,
    /// Records to fit.
    pub train: Vec<Record>,
    /// The same cut into pieces, over which errors cannot grow far.
    pub pieces: Vec<Record>,
    /// Into how many of these each record is cut, if it is long enough.
    pub(super) cuts: usize,
    /// Records to confirm with.
    pub test: Vec<Record>,
    /// Whether the records are pieces already, as the experiment asks.
    pub is_cut: bool,
    /// Steps of the solver from sample to sample, for the patch as it is.
    pub steps: u32,
}

/// Into so many pieces a record is cut,
const PIECES: usize = 16;
/// none of them shorter than so many samples.
const LEAST_PIECE: usize = 40;

/// Where a column shows no noise, this share of its range counts as such: what the digits of a recorder leave.
const LEAST_NOISE: f64 = 1e-6;
/// A drive moves by so many times the noise of its column at least, rms.
const LEAST_MOTION: f64 = 5.0;

impl Problem {
    /// What an experiment asks for; noise that it does not tell is estimated without a model.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn of(experiment: &Experiment) -> Result<Problem, ModelError> {
        let cut = |records: &[Record]| match experiment.pieces {
            Some(seconds) => records.iter().flat_map(|record| record.pieces_of(seconds)).collect(),
            None => records.to_vec(),
        };
        let records = &experiment.train;
        let sigma = experiment.outputs.iter().enumerate();
        let sigma = sigma.map(|(place, output)| {
            output.sigma.unwrap_or_else(|| largest(noise, records, place).max(least_noise(records, place)))
        });
        let drive_sigma = experiment.drives.iter().enumerate();
        let drive_sigma = drive_sigma
            .map(|(place, feed)| feed.sigma.unwrap_or_else(|| largest(drive_noise, records, place)));
        // A drive of the patch would begin anew with every piece.
        let mut own =
            begun_anew(&experiment.patch, |name| experiment.drives.iter().any(|feed| feed.drive == name));
        let cuts = if own.next().is_some() { 1 } else { PIECES };
        let mut problem = Problem {
            drives: experiment.drives.clone(),
            drive_sigma: drive_sigma.collect(),
            outputs: experiment.outputs.iter().map(|output| output.signal.clone()).collect(),
            sigma: sigma.collect(),
            offset: experiment.outputs.iter().map(|output| output.offset).collect(),
            train: cut(&experiment.train),
            pieces: in_pieces(&experiment.train, cuts),
            cuts,
            test: cut(&experiment.test),
            is_cut: experiment.pieces.is_some(),
            steps: 1,
        };
        problem.steps = problem.steps(&experiment.patch, &experiment.fit)?;
        Ok(problem)
    }

    /// An output of a record as a patch makes it that leaves this of the record.
    pub(super) fn made(&self, record: &Record, left: &[Vec<f64>], output: usize) -> Vec<f64> {
        let sigma = self.sigma[output];
        record.outputs[output].iter().zip(&left[output]).map(|(datum, left)| datum - sigma * left).collect()
    }

    pub(super) fn model(
        &self,
        version: &Version,
        records: &[Record],
        outputs: &[String],
    ) -> Result<Model, ModelError> {
        Model::new(&version.patch, records, &self.drives, &version.fit, &version.free, outputs, version.steps)
    }

    pub(super) fn task<'a>(&'a self, model: &'a Model, records: &'a [Record], turns: bool) -> Task<'a> {
        let (sigma, offset) = (&self.sigma, &self.offset);
        Task {
            model,
            records,
            sigma,
            offset,
            turns,
            held: None,
            wanted: f64::INFINITY,
            most_rounds: MOST_ROUNDS,
            settled: SETTLED_SHARE,
            dampings: if model.goes_abreast() { Ladder::MANY } else { Ladder::ONE },
        }
    }

    /// A point of the pieces as one of the records whole.
    pub(super) fn joined_up(&self, point: &Point) -> Point {
        let mut first = 0;
        let initial = self.train.iter().map(|record| {
            let own = point.initial[first].clone();
            first += record.pieces(self.cuts, LEAST_PIECE).len();
            own
        });
        Point { initial: initial.collect(), ..point.clone() }
    }
}

/// Records each cut into so many pieces, if it is long enough: over these errors cannot grow far.
pub(super) fn in_pieces(records: &[Record], cuts: usize) -> Vec<Record> {
    records.iter().flat_map(|record| record.pieces(cuts, LEAST_PIECE)).collect()
}

/// The ends between which an output lies.
pub(super) fn ends_of(records: &[Record], output: usize) -> [f64; 2] {
    ends(records.iter().flat_map(|record| &record.outputs[output]).copied())
}

/// The white noise of a drive in a record; what comes to as much as it moves by is no noise of its column but what it drives with.
fn drive_noise(record: &Record, drive: usize) -> f64 {
    let is = examine(&record.drives[drive], record.interval);
    let noise =
        is.noise.filter(|noise| noise.kind == NoiseKind::White && is.rms > LEAST_MOTION * noise.sigma);
    noise.map_or(0.0, |noise| noise.sigma)
}

/// The noise of an output in a record; 0 where that is too short to tell.
fn noise(record: &Record, output: usize) -> f64 {
    noise_of(&record.outputs[output]).map_or(0.0, |noise| noise.sigma)
}

/// The largest of what is estimated of a column in each of several records.
fn largest(estimate: fn(&Record, usize) -> f64, records: &[Record], place: usize) -> f64 {
    records.iter().map(|record| estimate(record, place)).fold(0.0, f64::max)
}

impl Experiment {
    /// Whether an output shows noise in training, or the experiment tells some; where not, a millionth of its range counts as such.
    pub fn shows_noise(&self, output: usize) -> bool {
        let records = &self.train;
        self.outputs[output].sigma.is_some() || largest(noise, records, output) > least_noise(records, output)
    }
}

/// What counts as noise of an output at least, in its unit.
fn least_noise(records: &[Record], output: usize) -> f64 {
    let [least, most] = ends_of(records, output);
    LEAST_NOISE * (most - least)
}
