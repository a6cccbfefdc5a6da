//! The weakest effects that data would have shown.
//!
//! An effect of some strength is run beside the patch as it was fitted. What it changes in the outputs, less all that parameters,
//! initial voltages and offsets follow when they are fitted again (to first order), is what the search has to find it by: as
//! much as its score asks for in training, and as its confirmation asks for in the data that are held back. What would show so is
//! fitted in full: parameters may follow further than to first order.

use std::ops::Range;

use serde_json::{Map, Value, json};

use super::candidate::Candidate;
use super::directions::{NEW, clear, less, orthonormal, product, scale, subtract};
use super::fit::{Fitted, Point, Task, stacked};
use super::held::FIRST_HELD;
use super::model::{Choice, Course, Model, ModelError};
use super::record::Record;
use super::round::{CONFIRMED, Round, Trial, unit};
use super::score::expected;
use super::stage::{Problem, Version};
use crate::instruments::number;
use crate::patch::behind;
use crate::pool;

/// The weakest effect of a kind, at a place, that data would have shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Limit {
    /// Name of the effect.
    pub effect: String,
    /// The element that it acts on.
    pub junction: String,
    /// What it reads beside it, where there is a choice.
    pub reads: Vec<String>,
    /// Whether what parameters follow of it was found by a full fit, not to first order only.
    pub in_full: bool,
    /// The parameter that says how strong it is.
    pub parameter: String,
    /// Its unit.
    pub unit: String,
    /// Its value from which on the effect would have been seen; nothing where none in its range would.
    pub value: Option<f64>,
    /// The same as a share of the way from no effect to the end of the range: what limits are compared by.
    pub share: f64,
    /// What other parameters were taken to be there: name, value, unit.
    pub beside: Vec<(String, f64, String)>,
}

/// Strengths that are tried on either side of none, as shares of the way to the end of the range.
const STRENGTHS: [f64; 11] = [6e-5, 2.5e-4, 1e-3, 4e-3, 0.016, 0.06, 0.25, 0.5, 0.8, 0.93, 1.0];
/// So many choices of an effect's other parameters are tried.
const VARIANTS: usize = 3;
/// Where the margin grows with more than such a power of the strength,
const STEEP: f64 = 4.0;
/// so often more strengths are tried,
const FINER: usize = 2;
/// which make so many parts of the way.
const BETWEEN: u32 = 5;
/// By so many volts initial voltages of an effect are moved for derivatives.
const NUDGE: f64 = 1e-3;

impl Problem {
    /// The weakest effects that would have been seen of all that a round tried, those that show best first, worked out on so
    /// many threads.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub fn limits(&self, round: &Round, threads: usize) -> Result<Vec<Limit>, ModelError> {
        let mut grounds: Vec<(u32, Ground<'_>)> = Vec::new();
        for trial in &round.trials {
            let steps = trial.stage.version.steps;
            if grounds.iter().all(|own| own.0 != steps) {
                grounds.extend(Ground::of(self, round, steps)?.map(|ground| (steps, ground)));
            }
        }
        let of = |trial: &Trial| {
            let ground = grounds.iter().find(|own| own.0 == trial.stage.version.steps);
            ground.map(|(_, ground)| ground.limit(trial)).transpose()
        };
        let found = pool::each(&round.trials, threads, of, |_| ());
        let found: Vec<Option<Limit>> = found.into_iter().collect::<Result<_, _>>()?;
        let mut limits: Vec<Limit> = Vec::new();
        for limit in found.into_iter().flatten() {
            match limits.iter_mut().find(|own| own.is_of(&limit)) {
                Some(own) if limit.share < own.share => *own = limit,
                Some(_) => (),
                None => limits.push(limit),
            }
        }
        limits.sort_by(|a, b| {
            a.share.total_cmp(&b.share).then_with(|| (&a.effect, &a.junction).cmp(&(&b.effect, &b.junction)))
        });
        Ok(limits)
    }
}

impl Limit {
    /// Whether both are of the same effect, place and parameter.
    fn is_of(&self, other: &Limit) -> bool {
        let is_there = self.junction == other.junction && self.reads == other.reads;
        is_there && self.effect == other.effect && self.parameter == other.parameter
    }

    /// The same in words; nothing where the data could not show the effect at all.
    pub fn sentence(&self) -> Option<String> {
        let (effect, junction) = (&self.effect, &self.junction);
        let told = self.told()?;
        Some(format!(
            "the weakest {effect} at {junction} that would have shown has {} = {told}",
            self.parameter
        ))
    }

    /// Its value with its unit.
    pub fn told(&self) -> Option<String> {
        self.value.map(|value| format!("{}{}", number(value), behind(&self.unit)))
    }

    /// The other parameters with which that is so.
    pub fn beside(&self) -> String {
        let each = self.beside.iter();
        let each = each.map(|(name, value, unit)| format!("{name} = {}{}", number(*value), behind(unit)));
        each.collect::<Vec<_>>().join(", ")
    }

    /// Whether the data could show the effect at all.
    pub fn is_seen(&self) -> bool {
        self.value.is_some()
    }

    /// The same as a JSON document.
    pub fn document(&self) -> Value {
        let mut document = json!({
            "name": self.effect, "junction": self.junction, "reads": self.reads, "in_full": self.in_full,
            "parameter": self.parameter, "seen": self.is_seen(),
        });
        if let Some(value) = self.value {
            document["value"] = json!(value);
            document["unit"] = json!(self.unit);
            let beside = self.beside.iter();
            let beside =
                beside.map(|(name, value, unit)| (name.clone(), json!({"value": value, "unit": unit})));
            document["with"] = beside.collect::<Map<_, _>>().into();
        }
        document
    }
}

/// The best place of every effect, those that show best first.
pub fn best_places(limits: &[Limit]) -> Vec<&Limit> {
    let mut best: Vec<&Limit> = Vec::new();
    for limit in limits {
        if best.iter().all(|own| own.effect != limit.effect) {
            best.push(limit);
        }
    }
    best
}

/// What a patch does beside its records, and in which directions its fit follows.
struct Ground<'a> {
    problem: &'a Problem,
    round: &'a Round,
    train: Half<'a>,
    test: Half<'a>,
    /// The same with no states beside those of the patch.
    usual: Cleared,
}

/// Some records one behind the other, of each all outputs, over the noise; 0 where there is no datum.
struct Half<'a> {
    problem: &'a Problem,
    model: Model,
    records: &'a [Record],
    point: &'a Point,
    spans: Vec<Range<usize>>,
    /// What the patch does.
    here: Vec<f64>,
    /// By record, what its initial voltages do.
    states: Vec<Vec<Vec<f64>>>,
    /// What knobs do, then declared offsets.
    common: Vec<Vec<f64>>,
}

/// Tracks over the records to train on and over those that are held back.
type Both = [Vec<f64>; 2];

/// Directions that a fit follows, of length 1 and at right angles.
struct Cleared {
    /// By record, those of initial voltages: in training, and in what is held back.
    states: [Vec<Vec<Vec<f64>>>; 2],
    /// Those that training finds, with what follows from them for what is held back.
    common: Vec<Both>,
    /// Those of declared offsets, which are found again in what is held back.
    offsets: Vec<Vec<f64>>,
}

/// What an effect of some strength changes, and what its own initial voltages do, by record.
#[derive(Default)]
struct Change {
    outputs: Vec<f64>,
    states: Vec<Vec<Vec<f64>>>,
}

impl<'a> Ground<'a> {
    fn of(problem: &'a Problem, round: &'a Round, steps: u32) -> Result<Option<Ground<'a>>, ModelError> {
        let before = &round.before;
        let version = Version { steps, ..before.version.clone() };
        let train = Half::of(problem, &version, &problem.train, &before.train.point)?;
        let test = Half::of(problem, &version, &problem.test, &before.test.point)?;
        Ok(train.zip(test).map(|(train, test)| {
            let usual = Cleared::of([&train, &test], version.fit.len(), [&[], &[]]);
            Ground { problem, round, train, test, usual }
        }))
    }

    /// The least strength at which an effect would have been seen, whatever its other parameters.
    fn limit(&self, trial: &Trial) -> Result<Limit, ModelError> {
        let version = &trial.stage.version;
        let models = [
            self.problem.model(version, &self.problem.train, &self.problem.outputs)?,
            self.problem.model(version, &self.problem.test, &self.problem.outputs)?,
        ];
        let numbers = version.fit.len() - self.round.before.version.fit.len();
        let need = self.need(numbers);
        let found = variants(&trial.candidate).into_iter().filter_map(|rest| {
            let tried = Tried { ground: self, models: &models, trial, rest: &rest, need };
            tried.least().map(|(value, share)| (value, share, rest.clone()))
        });
        let least = found.min_by(|a, b| a.1.total_cmp(&b.1));
        let brought = &trial.candidate.graft.parameters;
        let beside = least.iter().flat_map(|(_, _, rest)| brought[1..].iter().zip(rest));
        Ok(Limit {
            effect: trial.candidate.effect.clone(),
            junction: trial.candidate.junction.clone(),
            reads: trial.candidate.reads.clone(),
            in_full: self.in_full(),
            parameter: brought[0].of.clone(),
            unit: brought[0].unit.clone(),
            value: least.as_ref().map(|least| least.0),
            share: least.as_ref().map_or(f64::INFINITY, |least| least.1),
            beside: beside.map(|(own, value)| (own.of.clone(), *value, own.unit.clone())).collect(),
        })
    }

    /// Whether a change is fitted in full: not beside a patch that lacks what was found, where that takes long and tells little.
    fn in_full(&self) -> bool {
        !self.round.taken
    }

    /// The variance of the noise, with how long it remembers.
    fn noise(&self) -> f64 {
        let (noise, memory) = unit(self.round.trials.iter().map(|trial| &trial.stage));
        noise * memory
    }

    /// The sum of squares over noise that a trial with so many numbers more must take away.
    fn need(&self, numbers: usize) -> f64 {
        let (_, memory) = unit(self.round.trials.iter().map(|trial| &trial.stage));
        let samples = self.round.before.train.count as f64 / memory;
        self.round.needed + numbers as f64 * samples.ln()
    }

    /// What parameters, initial voltages and offsets do not follow of a change, to first order.
    fn left(&self, [train, test]: &[Change; 2]) -> Both {
        let own;
        let cleared = match train.states.iter().all(Vec::is_empty) {
            true => &self.usual,
            false => {
                let fit = self.round.before.version.fit.len();
                own = Cleared::of([&self.train, &self.test], fit, [&train.states, &test.states]);
                &own
            }
        };
        let spans = [&self.train.spans[..], &self.test.spans[..]];
        cleared.without(spans, [train.outputs.clone(), test.outputs.clone()])
    }

    /// What they do not follow when they are fitted in full; nothing where the patch cannot be run so.
    fn left_in_full(&self, [train, test]: &[Change; 2]) -> Option<Both> {
        let trained = self.train.fitted(train, self.train.point)?;
        let begun = Point { initial: self.test.point.initial.clone(), ..trained.point.clone() };
        let held = self.test.settled(test, &begun)?;
        Some([self.train.apart(train, &trained), self.test.apart(test, &held)])
    }

    /// By what factor such tracks are more than the search needs to take them for an effect, in squares.
    fn margin(&self, [train, test]: &Both, need: f64) -> f64 {
        let shown = product(train, train) / (self.noise() * need);
        let confirmed = expected(&self.test.tracks(test), self.noise());
        let apart = (confirmed.ratio() / CONFIRMED).powi(2);
        shown.min(apart.max(confirmed.sum / (self.noise() * self.round.needed)))
    }
}

impl<'a> Half<'a> {
    fn of(
        problem: &'a Problem,
        version: &Version,
        records: &'a [Record],
        point: &'a Point,
    ) -> Result<Option<Half<'a>>, ModelError> {
        let model = problem.model(version, records, &problem.outputs)?;
        let task = problem.task(&model, records, true);
        let at = task.shares(point);
        let free: Vec<usize> = (0..task.common()).filter(|index| task.is_free(*index)).collect();
        let mut half = Half {
            problem,
            model: model.clone(),
            records,
            point,
            spans: Vec::new(),
            here: Vec::new(),
            states: Vec::new(),
            common: vec![Vec::new(); free.len()],
        };
        for (record, data) in records.iter().enumerate() {
            let Some(course) = model.run(record, &[task.choice(&at, record)]).pop().flatten() else {
                return Ok(None);
            };
            let responses = task.responses(&at, record, &course);
            let of = |index: usize| half.there(record, stacked(&responses, index, data.len()).into_iter());
            let states = task.states_of(record).map(of).collect();
            let common: Vec<Vec<f64>> = free.iter().map(|index| of(*index)).collect();
            let here = half.over_noise(record, &course);
            half.spans.push(half.here.len()..half.here.len() + here.len());
            half.here.extend(here);
            half.states.push(states);
            half.common.iter_mut().zip(common).for_each(|(all, own)| all.extend(own));
        }
        Ok(Some(half))
    }

    /// The outputs of a record one behind the other, 0 where there is no datum.
    fn there(&self, record: usize, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let data = self.records[record].outputs.iter().flatten();
        data.zip(values).map(|(datum, value)| if datum.is_nan() { 0.0 } else { value }).collect()
    }

    fn over_noise(&self, record: usize, course: &Course) -> Vec<f64> {
        let tracks = course.iter().zip(&self.problem.sigma);
        self.there(record, tracks.flat_map(|(track, sigma)| track.iter().map(move |own| own / sigma)))
    }

    /// The tracks that lie one behind the other: by record, of every output.
    fn tracks<'t>(&self, all: &'t [f64]) -> Vec<Vec<&'t [f64]>> {
        let tracks = self.spans.iter().zip(self.records);
        tracks.map(|(span, record)| all[span.clone()].chunks(record.len().max(1)).collect()).collect()
    }

    /// The records as they would be with a change, without noise.
    fn with(&self, change: &Change) -> Vec<Record> {
        let all: Vec<f64> =
            self.here.iter().zip(&change.outputs).map(|(here, change)| here + change).collect();
        let records = self.records.iter().zip(self.tracks(&all));
        let with = |(record, tracks): (&Record, Vec<&[f64]>)| {
            let outputs = record.outputs.iter().zip(tracks).zip(&self.problem.sigma);
            let outputs = outputs.map(|((data, track), sigma)| {
                let data = data.iter().zip(track);
                data.map(|(datum, value)| if datum.is_nan() { *datum } else { value * sigma }).collect()
            });
            Record { outputs: outputs.collect(), ..record.clone() }
        };
        records.map(with).collect()
    }

    /// The records with a change, fitted from a point on; nothing where the patch cannot be run so.
    fn fitted(&self, change: &Change, from: &Point) -> Option<Fitted> {
        self.problem.task(&self.model, &self.with(change), true).fit(from)
    }

    /// The same with initial voltages alone found, as at a first look.
    fn settled(&self, change: &Change, from: &Point) -> Option<Fitted> {
        let records = self.with(change);
        let task = Task { most_rounds: FIRST_HELD, ..self.problem.task(&self.model, &records, false) };
        task.told(&task.settled(from)?)
    }

    /// What a fit leaves of a change that the effect's own initial voltages do not follow.
    fn apart(&self, change: &Change, fitted: &Fitted) -> Vec<f64> {
        let records = fitted.residuals.iter().enumerate();
        let mut left: Vec<f64> =
            records.flat_map(|(record, own)| self.there(record, own.iter().flatten().copied())).collect();
        let states: Vec<_> = change.states.iter().map(|own| orthonormal(own.iter().cloned())).collect();
        clear_states(&states, &self.spans, &mut left);
        left
    }

    /// By how much an initial voltage of an effect is moved, from none on, to where it may be.
    fn nudge(&self, model: &Model, place: usize) -> f64 {
        let [_, high] = model.initial[self.point.initial[0].len() + place].range;
        if high < NUDGE { -NUDGE } else { NUDGE }
    }

    /// What changes with each of some strengths, beside none where that is one.
    fn changes(
        &self,
        model: &Model,
        strengths: &[Vec<f64>],
        none: Option<Vec<f64>>,
        own_states: usize,
    ) -> Vec<Option<Change>> {
        let mut changes: Vec<Option<Change>> = strengths.iter().map(|_| Some(Change::default())).collect();
        let wired = |record: usize, brought: &Vec<f64>, moved: Option<usize>| {
            let mut own = vec![0.0; own_states];
            moved.into_iter().for_each(|place| own[place] += self.nudge(model, place));
            Choice {
                knobs: [self.point.knobs.as_slice(), brought].concat(),
                initial: [self.point.initial[record].as_slice(), &own].concat(),
            }
        };
        for record in 0..self.records.len() {
            let none = none.iter().map(|none| wired(record, none, None));
            let lanes = strengths.iter().flat_map(|strength| {
                let moved = [None].into_iter().chain((0..own_states).map(Some));
                moved.map(move |moved| wired(record, strength, moved))
            });
            let choices: Vec<Choice> = none.chain(lanes).collect();
            let mut courses = model.run(record, &choices).into_iter();
            let here = match choices.len() > strengths.len() * (1 + own_states) {
                true => courses.next().flatten().map(|course| self.over_noise(record, &course)),
                false => Some(self.here[self.spans[record].clone()].to_vec()),
            };
            let mut next = || courses.next().flatten().map(|course| self.over_noise(record, &course));
            for change in &mut changes {
                let with = next();
                let moved: Vec<_> = (0..own_states).map(|_| next()).collect();
                let told = change.take().zip(here.as_ref().zip(with));
                *change = told.map(|(mut change, (here, with))| {
                    change.states.push(moved.into_iter().flatten().map(|own| less(&own, &with)).collect());
                    change.outputs.extend(less(&with, here));
                    change
                });
            }
        }
        changes
    }
}

impl Cleared {
    /// What halves follow, `fit` knobs being fitted, with further initial voltages by record.
    fn of(halves: [&Half<'_>; 2], fit: usize, more: [&[Vec<Vec<f64>>]; 2]) -> Cleared {
        let states = [0, 1].map(|half| {
            let own = halves[half].states.iter().enumerate();
            let with = |(record, own): (usize, &Vec<Vec<f64>>)| {
                let more = more[half].get(record).into_iter().flatten();
                orthonormal(own.iter().chain(more).cloned())
            };
            own.map(with).collect::<Vec<_>>()
        });
        let mut cleared = Cleared { states, common: Vec::new(), offsets: Vec::new() };
        let spans = halves.map(|half| half.spans.as_slice());
        for (train, test) in halves[0].common.iter().zip(&halves[1].common) {
            let was = product(train, train).sqrt();
            let [mut train, mut test] = cleared.without(spans, [train.clone(), test.clone()]);
            let length = product(&train, &train).sqrt();
            if length > NEW * was {
                [&mut train, &mut test].into_iter().for_each(|track| scale(track, 1.0 / length));
                cleared.common.push([train, test]);
            }
        }
        let offsets = halves[1].common[fit..].iter().map(|offset| {
            let mut offset = offset.clone();
            clear_states(&cleared.states[1], spans[1], &mut offset);
            offset
        });
        cleared.offsets = orthonormal(offsets);
        cleared
    }

    /// What is left of tracks.
    fn without(&self, spans: [&[Range<usize>]; 2], [mut train, mut test]: Both) -> Both {
        clear_states(&self.states[0], spans[0], &mut train);
        clear_states(&self.states[1], spans[1], &mut test);
        for [direction, follows] in &self.common {
            let share = product(direction, &train);
            subtract(&mut train, share, direction);
            subtract(&mut test, share, follows);
        }
        clear(&self.offsets, &mut test);
        [train, test]
    }
}

/// An effect with all but its strength chosen.
struct Tried<'a> {
    ground: &'a Ground<'a>,
    models: &'a [Model; 2],
    trial: &'a Trial,
    rest: &'a [f64],
    need: f64,
}

impl Tried<'_> {
    /// The strength from which on the effect would have been seen, whatever its sign if it would with both, and its share of the range.
    fn least(&self) -> Option<(f64, f64)> {
        let brought = &self.trial.candidate.graft.parameters[0];
        let none = self.trial.candidate.none;
        let home = none.unwrap_or(0.0);
        let ends: Vec<f64> = match none {
            Some(none) => brought.range.into_iter().filter(|end| *end != none).collect(),
            None => vec![brought.range[1]],
        };
        let most = ends.iter().map(|end| (end - home).abs()).fold(0.0, f64::max);
        let seen: Vec<f64> = ends.iter().filter_map(|end| self.on_one_side(home, *end)).collect();
        let far = seen.iter().copied().max_by(|a, b| (a - home).abs().total_cmp(&(b - home).abs()))?;
        let value = if seen.len() > 1 { home + (far - home).abs() } else { far };
        Some((value, (far - home).abs() / most))
    }

    /// The same between no effect and an end of its range.
    fn on_one_side(&self, home: f64, end: f64) -> Option<f64> {
        let candidate = &self.trial.candidate;
        // Where no effect lies outside the range, the weakest is that at its beginning.
        let weakest = candidate.none.map_or(candidate.graft.parameters[0].range[0] / end, |_| 0.0);
        let stronger = STRENGTHS.into_iter().filter(|share| *share > weakest);
        let shares: Vec<f64> =
            Some(weakest).filter(|share| *share > 0.0).into_iter().chain(stronger).collect();
        let mut margins = self.margins(home, end, &shares);
        for _ in 0..FINER {
            let Some([below, above]) = steep(&margins) else { break };
            let between = (1..BETWEEN).map(|place| f64::from(place) / f64::from(BETWEEN));
            let shares: Vec<f64> = between.map(|part| below.0 + part * (above.0 - below.0)).collect();
            let inner = self.margins(home, end, &shares);
            margins = [below].into_iter().chain(inner).chain([above]).collect();
        }
        let share = reaches_one(&margins, candidate.none.is_some())?;
        Some(home + share * (end - home))
    }

    /// Shares of the way to the end of a range and their margins, up to the first that shows.
    fn margins(&self, home: f64, end: f64, shares: &[f64]) -> Vec<Margin> {
        let candidate = &self.trial.candidate;
        let with = |strength: f64| [&[strength], self.rest].concat();
        let strengths: Vec<Vec<f64>> = shares.iter().map(|share| with(home + share * (end - home))).collect();
        let none = candidate.none.map(with);
        let states = candidate.graft.free.len();
        let halves = [&self.ground.train, &self.ground.test];
        let [train, test] =
            [0, 1].map(|half| halves[half].changes(&self.models[half], &strengths, none.clone(), states));
        let mut margins = Vec::new();
        for ((share, train), test) in shares.iter().zip(train).zip(test) {
            let (Some(train), Some(test)) = (train, test) else { continue };
            let margin = self.margin(&[train, test]);
            margins.push((*share, margin));
            if margin >= 1.0 {
                break;
            }
        }
        margins
    }

    /// The margin of what a strength changes: to first order, and in full where it would show so.
    fn margin(&self, changes: &[Change; 2]) -> f64 {
        let margin = self.ground.margin(&self.ground.left(changes), self.need);
        if margin < 1.0 || !self.ground.in_full() {
            return margin;
        }
        let in_full = self.ground.left_in_full(changes);
        in_full.map_or(margin, |left| self.ground.margin(&left, self.need))
    }
}

/// A share of the way to the end of a range, and the margin there.
type Margin = (f64, f64);

/// The first strength that shows, behind the one before it.
fn first_that_shows(margins: &[Margin]) -> Option<(Option<Margin>, Margin)> {
    let place = margins.iter().position(|(_, margin)| *margin >= 1.0)?;
    Some((place.checked_sub(1).map(|before| margins[before]), margins[place]))
}

/// The first strength that shows and the one before it, where the margin grows far more steeply than with the square of the strength.
fn steep(margins: &[Margin]) -> Option<[Margin; 2]> {
    let (before, above) = first_that_shows(margins)?;
    let below = before?;
    let is_steep = below.1 <= 0.0 || (above.1 / below.1).ln() > STEEP * (above.0 / below.0).ln();
    is_steep.then_some([below, above])
}

/// Where a margin that grows with the square of a share, or faster, comes to 1; `goes_on` says whether it does so below the first.
fn reaches_one(margins: &[Margin], goes_on: bool) -> Option<f64> {
    let (below, (share, margin)) = first_that_shows(margins)?;
    Some(match below {
        None if goes_on => share / margin.sqrt(),
        None => share,
        Some((_, less)) if less <= 0.0 => share,
        Some((before, less)) => before * (share / before).powf(less.ln() / (less / margin).ln()),
    })
}

/// Values of all parameters but the first, as fits begin with them; what has the unit of the first is another strength, and left
/// out where it can be.
fn variants(candidate: &Candidate) -> Vec<Vec<f64>> {
    let brought = &candidate.graft.parameters;
    let mut variants: Vec<Vec<f64>> = Vec::new();
    for start in &candidate.starts {
        let value = |place: usize| match brought[place].unit == brought[0].unit {
            true => 0.0_f64.clamp(brought[place].range[0], brought[place].range[1]),
            false => start[place],
        };
        let rest: Vec<f64> = (1..brought.len()).map(value).collect();
        if !variants.contains(&rest) {
            variants.push(rest);
        }
    }
    variants.truncate(VARIANTS);
    variants
}

fn clear_states(states: &[Vec<Vec<f64>>], spans: &[Range<usize>], track: &mut [f64]) {
    states.iter().zip(spans).for_each(|(basis, span)| clear(basis, &mut track[span.clone()]));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_the_margin_jumps_more_strengths_are_tried() {
        assert_eq!(steep(&[(0.1, 0.25), (0.4, 4.0)]), None);
        assert_eq!(steep(&[(0.1, 0.0), (0.2, 0.1), (0.4, 9.0)]), Some([(0.2, 0.1), (0.4, 9.0)]));
        assert_eq!(steep(&[(0.1, 0.0), (0.2, 16.0)]), Some([(0.1, 0.0), (0.2, 16.0)]));
        assert_eq!(steep(&[(0.1, 16.0)]), None);
    }

    #[test]
    fn between_two_strengths_the_margin_grows_by_a_power() {
        assert_eq!(
            reaches_one(&[(0.1, 0.25), (0.4, 4.0)], true).map(|share| (share * 1e9).round()),
            Some(2e8)
        );
        // Twice as much as is needed at the weakest: less would do, where there may be less.
        assert_eq!(reaches_one(&[(0.1, 4.0), (0.2, 16.0)], true), Some(0.05));
        assert_eq!(reaches_one(&[(0.1, 4.0), (0.2, 16.0)], false), Some(0.1));
        // A stop that is not met does nothing.
        assert_eq!(reaches_one(&[(0.1, 0.0), (0.2, 16.0)], true), Some(0.2));
        assert_eq!(reaches_one(&[(0.1, 0.1), (0.2, 0.4)], true), None);
    }
}
