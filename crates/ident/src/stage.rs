//! A patch fitted to the training records and held against the others: where the search stands, and every attempt to go on.

use std::sync::OnceLock;

use serde_json::json;

use super::attached::Attached;
use super::begun::Begun;
use super::candidate::Candidate;
use super::effort::{Effort, Starts};
use super::fit::{Fitted, Ladder, Point, Task};
use super::graft::Brought;
use super::intervals::Known;
use super::model::{Course, ModelError, share};
use super::peaks::Peaks;
use super::problem::Problem;
use super::record::Record;
use super::score::{colour, memory};
use super::starts::scattered;
use super::unrest::NotWhite;
use patchcord_core::circuit::Circuit;
use patchcord_core::patch::{Edit, EditError, Patch};

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
    /// How long a fit takes beside that of others: the runs for all derivatives, in steps.
    pub(super) fn work(&self) -> usize {
        (self.fit.len() + self.free.len() + 1) * self.steps as usize
    }

    /// The ranges of what is fitted.
    pub(super) fn ranges(&self) -> impl Iterator<Item = Option<(f64, f64)>> + '_ {
        self.fit.iter().map(|name| self.patch.parameters.get(name)?.range)
    }

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
    /// The same knobs on the other records: initial voltages and declared offsets are found there.
    pub test: Fitted,
    /// How far what is left in training is from white: [`colour`].
    pub colour: f64,
    /// How long it remembers: [`memory`].
    pub memory: f64,
    /// Where the fit to the pieces came to; nothing where what it began with left so little that it was not needed.
    pub in_pieces: Option<Point>,
    /// What is known of the points from which it was fitted.
    pub(super) seen: Seen,
    /// Whether it was gone through with, or looked at quickly only.
    pub gone_through: bool,
    /// How well each value that is fitted is known; nothing before [`Problem::with_errors`].
    pub known: Vec<Known>,
    /// What [`Problem::not_white`] says of it, once that was asked.
    pub(super) not_white: OnceLock<Option<NotWhite>>,
}

impl Stage {
    fn new(
        version: Version,
        [train, test]: [Fitted; 2],
        in_pieces: Option<Point>,
        seen: Seen,
        gone_through: bool,
    ) -> Stage {
        let (colour, memory) = (colour(&train.residuals), memory(&train));
        let (known, not_white) = (Vec::new(), OnceLock::new());
        Stage { version, train, test, colour, memory, in_pieces, seen, gone_through, known, not_white }
    }

    /// What no noise explains, in sigmas rms.
    pub fn gap(&self) -> f64 {
        self.train.unexplained().sqrt()
    }

    /// Whether what is left is more than noise.
    pub fn leaves_structure(&self) -> bool {
        self.colour > COLOURED
    }

    /// The share of what another leaves, in squares over the noise, that this one does not.
    pub fn closed(&self, without: &Stage) -> f64 {
        1.0 - self.train.unexplained() / without.train.unexplained()
    }

    /// The places of what is fitted best at an end of its range.
    pub(super) fn at_end(&self) -> impl Iterator<Item = usize> + '_ {
        self.within(self.version.ranges(), |[below, above]| below.abs().min(above.abs()) <= AT_END)
    }

    /// The places of what lies beyond these ranges.
    pub(super) fn beyond_of<'s>(
        &'s self,
        ranges: &'s [Option<(f64, f64)>],
    ) -> impl Iterator<Item = usize> + 's {
        self.within(ranges.iter().copied(), |[below, above]| below.min(above) < -AT_END)
    }

    /// The places of what lies so far inside the two ends of its range, in shares of that.
    fn within<'s>(
        &'s self,
        ranges: impl Iterator<Item = Option<(f64, f64)>> + 's,
        is_so: impl Fn([f64; 2]) -> bool + 's,
    ) -> impl Iterator<Item = usize> + 's {
        let fitted = ranges.zip(&self.train.point.knobs).enumerate();
        fitted.filter_map(move |(place, (range, value))| {
            let (low, high) = range?;
            let inside = share([low, high], *value);
            is_so([inside, 1.0 - inside]).then_some(place)
        })
    }

    /// The places of what is fitted best at an end of its range, and was not where it was fitted before.
    pub(super) fn newly_at_end<'s>(&'s self, before: &'s Stage) -> impl Iterator<Item = usize> + 's {
        let own = self.at_end().filter(|place| *place < before.version.fit.len());
        own.filter(|place| before.at_end().all(|other| other != *place))
    }

    /// Whether an effect is as strong as it may be.
    pub(super) fn is_strongest(&self, effect: &Candidate) -> bool {
        let strength = effect.graft.parameters.first();
        let is_it = |place: usize| {
            strength.is_some_and(|own| own.name == self.version.fit[place])
                && Some(self.train.point.knobs[place]) != effect.none
        };
        self.at_end().any(is_it)
    }

    /// Whether the gap is so large that fits may have lost their way.
    pub fn is_far(&self) -> bool {
        self.train.over_noise() >= FAR
    }

    /// The parameters that an effect brought, their values, and how well these are known.
    pub(super) fn brought<'s>(
        &'s self,
        effect: &'s Candidate,
    ) -> impl Iterator<Item = (&'s Brought, f64, Known)> {
        effect.graft.parameters.iter().filter_map(|own| {
            let place = self.version.fit.iter().position(|name| *name == own.name)?;
            Some((own, self.train.point.knobs[place], self.known(place)))
        })
    }

    /// How well what is fitted at a place is known; not at all where that was not worked out.
    pub fn known(&self, place: usize) -> Known {
        self.known.get(place).copied().unwrap_or(Known::NOT)
    }
}

/// Why an effect is not tried at a place.
#[derive(Debug, thiserror::Error)]
pub enum Untried {
    /// There is nothing to find its size by.
    #[error("there is nothing to measure it by: what it acts on stays at zero, or no frequency stands out")]
    Idle,
    /// No fit can begin.
    #[error("the patch with it can be run from none of its starts")]
    NotRun,
    /// The patch with it is none.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// What is asked of a trial.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// How much is done.
    pub effort: Effort,
    /// Below what the sum of squares is to come.
    pub wanted: f64,
    /// Where the same trial came to with less effort.
    pub before: Option<&'a Stage>,
    /// Values of its parameters known from elsewhere, if there are any.
    pub known: Option<&'a [f64]>,
}

/// What is known of points from which records were fitted: whole, in pieces, and a few of many.
#[derive(Debug, Clone, Default)]
pub(super) struct Seen {
    whole: Begun,
    pieces: Begun,
    few: Begun,
}

/// From where a stage is fitted.
#[derive(Debug, Clone)]
struct Beginning<'a> {
    /// Points for the records whole.
    starts: Starts,
    /// Points for their pieces, where those are fitted first.
    in_pieces: Option<Starts>,
    /// The initial voltages of the records that are held back, as an earlier fit found them.
    held: Option<&'a [Vec<f64>]>,
    /// What is known of some of the points.
    seen: Seen,
    effort: Effort,
}

impl Beginning<'_> {
    fn points(others: Vec<Point>) -> Self {
        let starts = Starts { others, ..Starts::default() };
        Beginning { starts, in_pieces: None, held: None, seen: Seen::default(), effort: Effort::FULL }
    }
}

/// What is nearer to the end of a range, by this share of it, is at it.
const AT_END: f64 = 1e-6;
/// Residuals further than this from white noise are not noise.
pub(super) const COLOURED: f64 = 4.0;
/// Where the gap is less than so many sigmas rms, fits find their way without pieces.
const FAR: f64 = 5.0;

/// A fit whose sum of squares is below this share of another's has found what that did not.
const BETTER: f64 = 0.99;

/// Looks at many records begin with so many samples of them,
const GLANCED_AT: usize = 4000;
/// and finds in so many rounds how all of them begin.
const NEARLY: usize = 4;

impl Problem {
    /// Fits a patch from several points on, so that the sum of squares comes below what is wanted; nothing where it can be run
    /// from none of them.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records at all.
    fn stage(&self, version: Version, from: Beginning<'_>, wanted: f64) -> Result<Option<Stage>, ModelError> {
        let mut seen = from.seen;
        let pieces = from.in_pieces.map(|own| self.in_pieces(&version, &own, from.effort, &mut seen.pieces));
        let in_pieces = pieces.transpose()?.flatten();
        let model = self.model(&version, &self.train, &self.outputs)?;
        let task = Task { wanted, ..self.task(&model, &self.train, true) };
        let mut starts = from.starts;
        let joined = in_pieces.as_ref().map(|point| self.joined_up(point));
        let led = self.at_a_glance(&version, &task, &starts, from.effort, &mut seen)?;
        let best = led.and_then(|(all, led)| {
            let sure = led.into_iter().chain(joined.clone()).collect();
            all.best(&task, &Starts { sure, ..Starts::default() }, &mut seen.whole)
        });
        let best = best.or_else(|| {
            starts.sure.extend(joined);
            from.effort.best(&task, &starts, &mut seen.whole)
        });
        let Some(train) = best.and_then(|point| task.told(&point)) else { return Ok(None) };
        let test = self.held(&version, &train.point, from.held, from.effort)?;
        Ok(test.map(|test| Stage::new(version, [train, test], in_pieces, seen, from.effort.is_thorough)))
    }

    /// Fits a patch to the pieces: where it comes to from the best of several points.
    fn in_pieces(
        &self,
        version: &Version,
        starts: &Starts,
        effort: Effort,
        begun: &mut Begun,
    ) -> Result<Option<Point>, ModelError> {
        let model = self.model(version, &self.pieces, &self.outputs)?;
        let task = self.task(&model, &self.pieces, true);
        Ok(effort.best(&task, starts, begun))
    }

    /// From where all of many records are gone on with, and how: from where a few of them lead, and from what these may lead
    /// astray from. Nothing where the records are few, or there is nothing to choose between.
    fn at_a_glance(
        &self,
        version: &Version,
        all: &Task<'_>,
        starts: &Starts,
        effort: Effort,
        seen: &mut Seen,
    ) -> Result<Option<(Effort, Vec<Point>)>, ModelError> {
        let places = glance(&self.train);
        let is_open = starts.sure.iter().chain(&starts.found).chain(&starts.others).count() > 1;
        let split = effort.split().filter(|_| is_open && places.len() < self.train.len());
        let Some([few, rest]) = split else { return Ok(None) };
        let nearly = Task { most_rounds: NEARLY, dampings: Ladder::ONE, ..*all };
        let glanced = self.glanced(version, &places, starts, few, &mut seen.few)?;
        let mut led: Vec<Point> = glanced.iter().filter_map(|point| nearly.settled(point)).collect();
        match effort.is_thorough {
            true => led.extend(all.nearest(&starts.others, &starts.sure, 1, &mut seen.whole).cloned()),
            false => led.extend(starts.sure.first().cloned()),
        }
        led.extend(starts.found.clone());
        Ok(Some((rest, led)))
    }

    /// Where a patch fitted to a few of the records comes to, the best first; the others begin where they did before.
    fn glanced(
        &self,
        version: &Version,
        places: &[usize],
        starts: &Starts,
        effort: Effort,
        begun: &mut Begun,
    ) -> Result<Vec<Point>, ModelError> {
        let records: Vec<Record> = places.iter().map(|place| self.train[*place].clone()).collect();
        let model = self.model(version, &records, &self.outputs)?;
        let few = |point: &Point| {
            let initial = places.iter().map(|place| point.initial[*place].clone());
            Point { initial: initial.collect(), ..point.clone() }
        };
        let all = |points: &[Point]| points.iter().map(few).collect();
        let some = Starts {
            sure: all(&starts.sure),
            found: starts.found.as_ref().map(few),
            others: all(&starts.others),
        };
        let mut points = starts.sure.iter().chain(&starts.found).chain(&starts.others);
        let Some(first) = points.next() else { return Ok(Vec::new()) };
        let ahead = effort.ahead(&self.task(&model, &records, true), &some, begun).into_iter();
        let whole = ahead.map(|own| {
            let mut initial = first.initial.clone();
            places.iter().zip(own.initial).for_each(|(place, begins)| initial[*place] = begins);
            Point { initial, ..own }
        });
        Ok(whole.collect())
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
        let task = self.task(&model, &self.train, true);
        let points = [first.clone()].into_iter().chain(scattered(&model, &first, seed));
        let settled = points.filter_map(|point| task.settled(&point));
        let starts: Vec<Point> = settled.chain([first.clone()]).collect();
        let from = Beginning::points(starts);
        let Some(mut stage) = self.stage(version, from, f64::INFINITY)? else { return Ok(None) };
        if !self.is_cut && stage.is_far() {
            stage = self.over_pieces(stage)?;
        }
        let finished = self.finished(&stage)?;
        Ok(Some(finished.unwrap_or(stage)))
    }

    /// A stage with steps that are fine enough where it came to, and begun in the right place where it is held back; nothing where
    /// it has and is.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn finished(&self, stage: &Stage) -> Result<Option<Stage>, ModelError> {
        let refined = self.refined(stage)?;
        let again = self.found_again(refined.as_ref().unwrap_or(stage))?;
        Ok(again.or(refined))
    }

    /// A stage whose gap is large, fitted from its pieces on, too.
    fn over_pieces(&self, stage: Stage) -> Result<Stage, ModelError> {
        let model = self.model(&stage.version, &self.pieces, &self.outputs)?;
        let first = Point { knobs: stage.train.point.knobs.clone(), ..Point::of(&model, self.outputs.len()) };
        let Some(settled) = self.task(&model, &self.pieces, true).settled(&first) else { return Ok(stage) };
        let from = Beginning {
            in_pieces: Some(Starts { sure: vec![settled], ..Starts::default() }),
            held: Some(&stage.test.point.initial),
            ..Beginning::points(vec![stage.train.point.clone()])
        };
        let again = self.stage(stage.version.clone(), from, f64::INFINITY)?;
        Ok(again.filter(|again| again.train.chi2 < stage.train.chi2).unwrap_or(stage))
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
        let again = self.again(stage, stage.version.clone(), start)?;
        Ok(again.filter(|again| again.train.chi2 < BETTER * stage.train.chi2))
    }

    /// A stage in another version, fitted from a point on.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records at all.
    pub(super) fn again(
        &self,
        stage: &Stage,
        version: Version,
        start: Point,
    ) -> Result<Option<Stage>, ModelError> {
        let from = Beginning { held: Some(&stage.test.point.initial), ..Beginning::points(vec![start]) };
        let again = self.stage(version, from, f64::INFINITY)?;
        Ok(again.map(|again| Stage { in_pieces: stage.in_pieces.clone(), ..again }))
    }

    /// The names of all signals and drives of a stage, and of every training record what they do, as it is fitted.
    pub(super) fn courses(&self, stage: &Stage) -> Result<(Vec<String>, Vec<Course>), ModelError> {
        let circuit = Circuit::new(&stage.version.patch, &[])?;
        let patch = circuit.patch();
        let names = patch.signals.keys().chain(patch.drives.keys()).cloned().collect::<Vec<_>>();
        let model = self.model(&stage.version, &self.train, &names)?;
        let courses = (0..self.train.len()).map(|record| {
            model.run(record, &[stage.train.point.choice(record)]).pop().flatten().unwrap_or_default()
        });
        let courses = courses.collect();
        Ok((names, courses))
    }

    /// Wires one more effect into a stage: as a candidate, and as the version of the patch that is fitted.
    ///
    /// # Errors
    /// When the effect does not fit.
    pub(super) fn wired(
        &self,
        stage: &Stage,
        attached: &Attached<'_>,
        peaks: &Peaks,
    ) -> Result<(Candidate, Version), Untried> {
        let largest = peaks.at(&attached.place);
        let candidate = Candidate::new(attached, &stage.version.patch, &largest, &peaks.spectrum);
        let candidate = candidate.map_err(ModelError::from)?.ok_or(Untried::Idle)?;
        let graft = &candidate.graft;
        let brought = graft.parameters.iter().map(|parameter| parameter.name.clone());
        let version = Version {
            patch: graft.patch.clone(),
            fit: stage.version.fit.iter().cloned().chain(brought).collect(),
            free: stage.version.free.iter().chain(&graft.free).cloned().collect(),
            steps: stage.version.steps.max(candidate.steps(peaks.interval)),
        };
        Ok((candidate, version))
    }

    /// Wires one more effect into a stage, and fits everything anew, as long as there is hope to come to what is wanted.
    ///
    /// # Errors
    /// When the effect does not fit, or the patch with it cannot be run beside the records.
    pub fn attempt(
        &self,
        stage: &Stage,
        attached: &Attached<'_>,
        peaks: &Peaks,
        asked: Asked<'_>,
    ) -> Result<(Candidate, Stage), Untried> {
        let (candidate, version) = self.wired(stage, attached, peaks)?;
        let free = candidate.graft.free.len();
        let begun = |home: &Point, before: Option<&Point>| {
            let with = |start: &Vec<f64>| Point {
                knobs: [home.knobs.as_slice(), start].concat(),
                initial: home.initial.iter().map(|own| [own.as_slice(), &vec![0.0; free]].concat()).collect(),
                offsets: home.offsets.clone(),
            };
            let beside = before.into_iter().flat_map(|before| {
                let (others, own) = before.knobs.split_at(home.knobs.len());
                let moved = candidate.beside(own).into_iter();
                moved.map(move |own| Point { knobs: [others, &own].concat(), ..before.clone() })
            });
            let known = asked.known.map(|known| with(&candidate.within(known)));
            Starts {
                sure: candidate.without.iter().map(with).collect(),
                found: before.cloned().or(known),
                others: candidate.starts.iter().map(with).chain(beside).collect(),
            }
        };
        let from = Beginning {
            starts: begun(&stage.train.point, asked.before.map(|before| &before.train.point)),
            in_pieces: stage
                .in_pieces
                .as_ref()
                .map(|home| begun(home, asked.before.and_then(|before| before.in_pieces.as_ref()))),
            held: Some(&stage.test.point.initial),
            seen: asked.before.map(|before| before.seen.clone()).unwrap_or_default(),
            effort: asked.effort,
        };
        let stage = self.stage(version, from, asked.wanted)?.ok_or(Untried::NotRun)?;
        Ok((candidate, stage))
    }
}

/// The places of records, all or a few of many, from which a first look takes its data.
pub(super) fn glance(records: &[Record]) -> Vec<usize> {
    let (count, samples) = (records.len(), records.iter().map(Record::len).sum::<usize>());
    let few = (GLANCED_AT * count / samples.max(1)).max(1).min(count);
    (0..few).map(|place| place * count / few).collect()
}
