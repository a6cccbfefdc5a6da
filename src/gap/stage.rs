//! A patch fitted to the training records and held against the others: where the search stands, and every attempt to go on.

use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng as _, SeedableRng as _};
use serde_json::json;

use super::candidate::Candidate;
use super::examine::{examine, peaks};
use super::experiment::{Experiment, Feed};
use super::fit::{Fitted, MOST_ROUNDS, Point, Task};
use super::graft::{Attached, Place, Role};
use super::model::{Choice, Model, ModelError};
use super::reach::Largest;
use super::record::Record;
use super::score::{colour, memory};
use crate::circuit::Circuit;
use crate::patch::{Edit, EditError, Patch, Unit};

/// What a patch is held against.
#[derive(Debug, Clone)]
pub struct Problem {
    /// Drives that the records feed.
    pub drives: Vec<Feed>,
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
    /// Records to confirm with.
    pub test: Vec<Record>,
    /// Whether the records are pieces already, as the experiment asks.
    pub is_cut: bool,
    /// Steps of the solver from sample to sample, for the patch as it is.
    pub steps: u32,
}

/// A patch with what may be turned in it.
#[derive(Debug, Clone)]
pub struct Version {
    /// The patch.
    pub patch: Patch,
    /// Parameters that are fitted.
    pub fit: Vec<String>,
    /// Parameters that are initial voltages.
    pub free: Vec<String>,
    /// Steps of the solver from sample to sample.
    pub steps: u32,
}

impl Version {
    /// The patch with what is fitted at these values, as one of a file.
    ///
    /// # Errors
    /// None that is known: what is edited stands in the patch.
    pub fn at(&self, file: &str, knobs: &[f64]) -> Result<Patch, EditError> {
        let edits = self.fit.iter().zip(knobs).map(|(name, value)| Edit {
            path: ["parameters", name, "value"].map(str::to_owned).to_vec(),
            value: json!(value),
        });
        self.patch.edited(file, &edits.collect::<Vec<_>>())
    }
}

/// A patch fitted.
#[derive(Debug, Clone)]
pub struct Stage {
    /// The patch, with its parameters as they stood.
    pub version: Version,
    /// The best fit to the training records.
    pub train: Fitted,
    /// The same knobs on the other records: initial voltages are found there.
    pub test: Fitted,
    /// How far what is left in training is from white: [`colour`].
    pub colour: f64,
    /// How long it remembers: [`memory`].
    pub memory: f64,
    /// Where the fit to the pieces came to; nothing where the gap is so small that it was not needed.
    pub in_pieces: Option<Point>,
}

impl Stage {
    fn new(version: Version, train: Fitted, test: Fitted, in_pieces: Option<Point>) -> Stage {
        let (colour, memory) = (colour(&train), memory(&train));
        Stage { version, train, test, colour, memory, in_pieces }
    }

    /// Whether the gap is so large that fits may have lost their way.
    pub fn is_far(&self) -> bool {
        self.train.over_noise() >= FAR
    }

    /// The standard error of what is fitted at a place, as wide as what is left, and how long that remembers, makes it.
    pub fn error(&self, place: usize) -> f64 {
        self.train.errors[place] * (self.train.reduced().max(1.0) * self.memory).sqrt()
    }
}

/// How much is done to fit a stage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// So many of the points from which fits could begin are gone on from,
    starts: usize,
    /// and so often the derivatives are worked out for each.
    rounds: usize,
    /// Shares of the records, from their beginnings, that are fitted one after the other before all of them.
    shares: &'static [f64],
}

impl Effort {
    /// Enough to see whether more is worth while.
    pub const QUICK: Effort = Effort { starts: 1, rounds: 5, shares: &[] };
    /// Enough to be held against others.
    pub const FULL: Effort = Effort { starts: 4, rounds: MOST_ROUNDS, shares: &[] };
    /// Where motion swings or sticks: what is fitted to all of it at once keeps step with the wrong swing.
    pub const GROWING: Effort = Effort { starts: 4, rounds: MOST_ROUNDS, shares: &[0.35, 0.65] };
}

/// From where a stage is fitted.
#[derive(Debug, Clone)]
struct From<'a> {
    /// Points for the records whole.
    starts: Vec<Point>,
    /// Points for their pieces.
    in_pieces: Vec<Point>,
    /// The initial voltages of the records that are held back, as an earlier fit found them.
    held: Option<&'a [Vec<f64>]>,
    effort: Effort,
}

impl From<'_> {
    fn starts(starts: Vec<Point>) -> Self {
        From { starts, in_pieces: Vec::new(), held: None, effort: Effort::FULL }
    }
}

/// Into so many pieces a record is cut,
const PIECES: usize = 16;
/// none of them shorter than so many samples.
const LEAST_PIECE: usize = 40;
/// Where the gap is less than so many sigmas rms, fits find their way without pieces.
const FAR: f64 = 5.0;

/// The solver may err by this share of the noise, rms.
const FINE: f64 = 0.1;
/// No sample takes more steps than this.
const MOST_STEPS: u32 = 64;

/// Where a column shows no noise, this share of its range counts as such: what the digits of a recorder leave.
const LEAST_NOISE: f64 = 1e-6;

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
        let sigma = experiment.outputs.iter().enumerate().map(|(place, output)| {
            output.sigma.unwrap_or_else(|| {
                let estimates = experiment.train.iter().map(|record| noise(record, place));
                estimates.fold(0.0, f64::max)
            })
        });
        let mut problem = Problem {
            drives: experiment.drives.clone(),
            outputs: experiment.outputs.iter().map(|output| output.signal.clone()).collect(),
            sigma: sigma.collect(),
            offset: experiment.outputs.iter().map(|output| output.offset).collect(),
            train: cut(&experiment.train),
            pieces: experiment.train.iter().flat_map(|record| record.pieces(PIECES, LEAST_PIECE)).collect(),
            test: cut(&experiment.test),
            is_cut: experiment.pieces.is_some(),
            steps: 1,
        };
        problem.steps = problem.fine_enough(&experiment.patch, &experiment.fit)?;
        Ok(problem)
    }

    /// Steps a sample with which the solver errs by less than a tenth of the noise, beside twice as many.
    fn fine_enough(&self, patch: &Patch, fit: &[String]) -> Result<u32, ModelError> {
        let run = |steps: u32| {
            let version = Version { patch: patch.clone(), fit: fit.to_vec(), free: Vec::new(), steps };
            let model = self.model(&version, &self.train, &self.outputs)?;
            let at = Point::of(&model, 0);
            let choice = Choice { knobs: at.knobs, initial: at.initial[0].clone() };
            Ok::<_, ModelError>(model.run(0, &[choice]).pop().flatten())
        };
        let mut coarse = run(1)?;
        for steps in [1, 2, 4, 8, 16, 32] {
            let fine = run(2 * steps)?;
            if let Some((coarse, fine)) = coarse.as_ref().zip(fine.as_ref()) {
                let pairs = coarse.iter().zip(fine).zip(&self.sigma);
                let errs = pairs.map(|((coarse, fine), sigma)| rms_difference(coarse, fine) / sigma);
                if errs.fold(0.0, f64::max) < FINE {
                    return Ok(steps);
                }
            }
            coarse = fine;
        }
        Ok(MOST_STEPS)
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
            wanted: f64::INFINITY,
            most_rounds: MOST_ROUNDS,
            until: 1.0,
        }
    }

    /// Fits a patch from several points on, so that the sum of squares comes below what is wanted; nothing where it can be run
    /// from none of them.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records at all.
    fn stage(&self, version: Version, from: From<'_>, wanted: f64) -> Result<Option<Stage>, ModelError> {
        let in_pieces = self.in_pieces(&version, &from.in_pieces, from.effort)?;
        let model = self.model(&version, &self.train, &self.outputs)?;
        let most_rounds = from.effort.rounds;
        let task = Task { wanted, most_rounds, ..self.task(&model, &self.train, true) };
        let whole = in_pieces.as_ref().map(|point| self.joined_up(point));
        let grown = |start: &Point, until: f64| {
            let part = Task { until, wanted: f64::INFINITY, ..task };
            part.fit(start).map(|fitted| fitted.point)
        };
        let fit = |start: &Point| {
            let mut shares = from.effort.shares.iter();
            task.fit(&shares.try_fold(start.clone(), |at, until| grown(&at, *until))?)
        };
        let fits = whole.iter().chain(task.nearest(&from.starts, from.effort.starts)).filter_map(fit);
        let Some(train) = Fitted::best_of(fits) else { return Ok(None) };
        let test = self.held(&version, &train.point, from.held)?;
        Ok(test.map(|test| Stage::new(version, train, test, in_pieces)))
    }

    /// Fits a patch to the pieces: where it comes to from the best of several points.
    fn in_pieces(
        &self,
        version: &Version,
        starts: &[Point],
        effort: Effort,
    ) -> Result<Option<Point>, ModelError> {
        if starts.is_empty() {
            return Ok(None);
        }
        let model = self.model(version, &self.pieces, &self.outputs)?;
        let task = Task { most_rounds: effort.rounds, ..self.task(&model, &self.pieces, true) };
        let fits = task.nearest(starts, effort.starts).filter_map(|start| task.fit(start));
        Ok(Fitted::best_of(fits).map(|fitted| fitted.point))
    }

    /// A point of the pieces as one of the records whole.
    fn joined_up(&self, point: &Point) -> Point {
        let mut first = 0;
        let initial = self.train.iter().map(|record| {
            let own = point.initial[first].clone();
            first += record.pieces(PIECES, LEAST_PIECE).len();
            own
        });
        Point { initial: initial.collect(), ..point.clone() }
    }

    /// The same knobs on the records that are held back: only initial voltages are found there, from where the patch stands and from
    /// where another fit came to.
    pub(super) fn held(
        &self,
        version: &Version,
        at: &Point,
        from: Option<&[Vec<f64>]>,
    ) -> Result<Option<Fitted>, ModelError> {
        let model = self.model(version, &self.test, &self.outputs)?;
        let first = Point::of(&model, self.outputs.len());
        let first = Point { knobs: at.knobs.clone(), offsets: at.offsets.clone(), ..first };
        let before = from.map(|initial| Point { initial: filled(initial, &first.initial), ..first.clone() });
        let task = self.task(&model, &self.test, false);
        let fits = before.into_iter().chain([first]).filter_map(|point| task.fit(&point));
        Ok(Fitted::best_of(fits))
    }

    /// The first stage: a patch as it is, fitted from where it stands and from points scattered over the ranges of what is fitted.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records at all.
    pub fn base(&self, patch: &Patch, fit: &[String], seed: u64) -> Result<Option<Stage>, ModelError> {
        let version =
            Version { patch: patch.clone(), fit: fit.to_vec(), free: Vec::new(), steps: self.steps };
        let model = self.model(&version, &self.train, &self.outputs)?;
        let first = Point::of(&model, self.outputs.len());
        let settle = Task { turns: false, ..self.task(&model, &self.train, true) };
        let scattered = scattered(&model, seed).into_iter().map(|knobs| Point { knobs, ..first.clone() });
        let points: Vec<Point> = [first.clone()].into_iter().chain(scattered).collect();
        let settled = points.iter().filter_map(|point| settle.fit(point)).map(|fitted| fitted.point);
        let starts: Vec<Point> = settled.chain([first.clone()]).collect();
        let from = From::starts(starts);
        let Some(stage) = self.stage(version, from, f64::INFINITY)? else { return Ok(None) };
        if self.is_cut || !stage.is_far() {
            return Ok(Some(stage));
        }
        self.over_pieces(stage).map(Some)
    }

    /// A stage whose gap is large, fitted from its pieces on, too.
    fn over_pieces(&self, stage: Stage) -> Result<Stage, ModelError> {
        let model = self.model(&stage.version, &self.pieces, &self.outputs)?;
        let first = Point { knobs: stage.train.point.knobs.clone(), ..Point::of(&model, self.outputs.len()) };
        let settle = Task { turns: false, ..self.task(&model, &self.pieces, true) };
        let Some(settled) = settle.fit(&first) else { return Ok(stage) };
        let from = From {
            in_pieces: vec![settled.point],
            held: Some(&stage.test.point.initial),
            ..From::starts(vec![stage.train.point.clone()])
        };
        let again = self.stage(stage.version.clone(), from, f64::INFINITY)?;
        Ok(again.unwrap_or(stage))
    }

    /// The same patch fitted from where a trial with one more effect came to, if that is better.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records at all.
    pub fn once_more(&self, stage: &Stage, trial: &Stage) -> Result<Option<Stage>, ModelError> {
        let (own, other) = (&stage.train.point, &trial.train.point);
        let start = Point {
            knobs: other.knobs[..own.knobs.len()].to_vec(),
            initial: own
                .initial
                .iter()
                .zip(&other.initial)
                .map(|(own, other)| other[..own.len()].to_vec())
                .collect(),
            offsets: other.offsets.clone(),
        };
        let from = From { held: Some(&stage.test.point.initial), ..From::starts(vec![start]) };
        let again = self.stage(stage.version.clone(), from, f64::INFINITY)?;
        let again = again.map(|again| Stage { in_pieces: stage.in_pieces.clone(), ..again });
        Ok(again.filter(|again| again.train.chi2 < BETTER * stage.train.chi2))
    }

    /// The largest values of what the signals and drives of a stage come to in training.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn peaks(&self, stage: &Stage) -> Result<Peaks, ModelError> {
        let circuit = Circuit::new(&stage.version.patch, &[])?;
        let patch = circuit.patch();
        let names = patch.signals.keys().chain(patch.drives.keys()).cloned().collect::<Vec<_>>();
        let model = self.model(&stage.version, &self.train, &names)?;
        let mut ends = vec![[f64::INFINITY, f64::NEG_INFINITY]; names.len()];
        for (record, initial) in stage.train.point.initial.iter().enumerate() {
            let choice = Choice { knobs: stage.train.point.knobs.clone(), initial: initial.clone() };
            let course = model.run(record, &[choice]).pop().flatten().unwrap_or_default();
            for (ends, track) in ends.iter_mut().zip(&course) {
                *ends = widened(*ends, track);
            }
        }
        // What was measured is known without a model.
        for (output, name) in self.outputs.iter().enumerate() {
            let Some(place) = names.iter().position(|own| own == name) else { continue };
            let data = self.train.iter().map(|record| &record.outputs[output]);
            ends[place] = data.fold([f64::INFINITY, f64::NEG_INFINITY], |ends, own| widened(ends, own));
        }
        let interval = self.train.iter().map(|record| record.interval).fold(f64::INFINITY, f64::min);
        let length =
            self.train.iter().map(|record| record.interval * record.len() as f64).fold(0.0, f64::max);
        let left = stage.train.residuals.iter().flatten();
        let spectrum = left.flat_map(|track| peaks(track, interval, FREQUENCIES)).collect();
        Ok(Peaks { names, ends, interval, length, spectrum })
    }

    /// Wires one more effect into a stage, and fits everything anew; nothing where the effect does not fit.
    ///
    /// # Errors
    /// When the patch with it cannot be run beside the records.
    pub fn attempt(
        &self,
        stage: &Stage,
        attached: &Attached<'_>,
        peaks: &Peaks,
        effort: Effort,
    ) -> Result<Option<(Candidate, Stage)>, ModelError> {
        let largest = peaks.at(&attached.place);
        let Some(candidate) = Candidate::new(attached, &stage.version.patch, &largest, &peaks.spectrum)?
        else {
            return Ok(None);
        };
        let graft = &candidate.graft;
        let brought = graft.parameters.iter().map(|parameter| parameter.name.clone());
        let version = Version {
            patch: graft.patch.clone(),
            fit: stage.version.fit.iter().cloned().chain(brought).collect(),
            free: stage.version.free.iter().chain(&graft.free).cloned().collect(),
            steps: stage.version.steps.max(candidate.steps(peaks.interval)),
        };
        let begun = |before: &Point| {
            let with = |start: &Vec<f64>| Point {
                knobs: [before.knobs.as_slice(), start].concat(),
                initial: before
                    .initial
                    .iter()
                    .map(|own| [own.as_slice(), &vec![0.0; graft.free.len()]].concat())
                    .collect(),
                offsets: before.offsets.clone(),
            };
            candidate.starts.iter().map(with).collect::<Vec<_>>()
        };
        let from = From {
            starts: begun(&stage.train.point),
            in_pieces: stage.in_pieces.as_ref().map(begun).unwrap_or_default(),
            held: Some(&stage.test.point.initial),
            effort,
        };
        Ok(self.stage(version, from, stage.train.chi2)?.map(|stage| (candidate, stage)))
    }
}

/// The least and the largest values of signals and drives, in their units.
#[derive(Debug, Clone)]
pub struct Peaks {
    names: Vec<String>,
    /// Least and largest value.
    ends: Vec<[f64; 2]>,
    interval: f64,
    length: f64,
    /// The frequencies of which what is left is full, in Hz.
    pub spectrum: Vec<f64>,
}

/// A fit whose sum of squares is below this share of another's has found what that did not.
const BETTER: f64 = 0.99;
/// So many points are scattered over the ranges.
const SCATTERED: usize = 4;

/// Values of the knobs over their ranges, by chance.
fn scattered(model: &Model, seed: u64) -> Vec<Vec<f64>> {
    let mut dice = ChaCha8Rng::seed_from_u64(seed);
    let mut draw = || f64::from(dice.next_u32()) / f64::from(u32::MAX);
    (0..SCATTERED).map(|_| model.knobs.iter().map(|knob| knob.at(0.1 + 0.8 * draw())).collect()).collect()
}

/// So many frequencies are tried of every output.
const FREQUENCIES: usize = 3;

impl Peaks {
    fn of(&self, name: &str) -> Option<[f64; 2]> {
        let place = self.names.iter().position(|own| own == name)?;
        Some(self.ends[place])
    }

    /// What the reaches of effects name at a place.
    fn at(&self, place: &Place<'_>) -> Vec<Largest> {
        let ends = |role: Role<'_>| match role {
            Role::Read(reading) => self.of(&reading.signal),
            // As fast as would cross its range in a twentieth of the record.
            Role::Rate(junction) => {
                self.of(&junction.own.signal).map(|own| own.map(|end| 20.0 * end / self.length))
            }
        };
        let roles = place
            .roles()
            .into_iter()
            .filter_map(|(name, role)| Some(Largest::of(name, role.unit().clone(), ends(role)?)));
        let times = [("sample", self.interval), ("record", self.length)].into_iter();
        let times =
            times.filter_map(|(name, value)| Some(Largest::of(name, Unit::parse("s").ok()?, [0.0, value])));
        roles.chain(times).collect()
    }
}

/// Two ends, moved out so far that a track lies between them.
fn widened(ends: [f64; 2], track: &[f64]) -> [f64; 2] {
    let there = track.iter().filter(|value| !value.is_nan());
    there.fold(ends, |[least, most], value| [least.min(*value), most.max(*value)])
}

/// The noise of an output in a record.
fn noise(record: &Record, output: usize) -> f64 {
    let is = examine(&record.outputs[output], record.interval);
    let least = LEAST_NOISE * (is.most - is.least);
    is.noise.map_or(least, |noise| noise.sigma.max(least))
}

fn rms_difference(left: &[f64], right: &[f64]) -> f64 {
    let sum: f64 = left.iter().zip(right).map(|(left, right)| (left - right).powi(2)).sum();
    (sum / left.len().max(1) as f64).sqrt()
}

/// Initial voltages of fewer states, with those of the rest behind them.
fn filled(some: &[Vec<f64>], all: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let pairs = some.iter().zip(all);
    pairs.map(|(some, all)| some.iter().chain(&all[some.len()..]).copied().collect()).collect()
}
