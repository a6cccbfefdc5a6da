//! Output error: the knobs, initial voltages and offsets with which a model comes nearest to its records, by the method of
//! Levenberg and Marquardt within ranges, on derivatives by differences of runs made side by side.

use std::ops::Range;

use nalgebra::DVector;

use crate::data::record::Record;
use crate::fit::estimate::{Fitted, Point, Reached};
use crate::fit::model::{Choice, Course, Model};
use crate::fit::normal_equations::{Column, Normal};
use patchcord_analysis::spare;
use patchcord_core::machines::REFERENCE;

/// What is fitted to what.
#[derive(Debug, Clone, Copy)]
pub struct Task<'a> {
    /// The model.
    pub model: &'a Model,
    /// The records, as many as the model was made for.
    pub records: &'a [Record],
    /// The standard deviation of the noise of every output, in its unit.
    pub sigma: &'a [f64],
    /// Which outputs may stand off by a constant.
    pub offset: &'a [bool],
    /// Whether the knobs are turned; initial voltages are found in any case.
    pub turns: bool,
    /// A knob that is not, all the same.
    pub held: Option<usize>,
    /// A fit that will not bring the sum of squares below this is given up.
    pub wanted: f64,
    /// So often the derivatives are worked out at most.
    pub most_rounds: usize,
    /// A fit has ended when a round lowers the sum of squares by less than this share of it, or by less than matters.
    pub settled: f64,
    /// The dampings of steps that are tried.
    pub dampings: Ladder,
}

/// Dampings of steps, tried from the weakest on until one is better.
#[derive(Debug, Clone, Copy)]
pub struct Ladder {
    /// Those that are tried side by side, as shares of the last that was better.
    side_by_side: &'static [f64],
    /// All of them so many times as much, where none is better,
    higher: f64,
    /// and so many times altogether.
    rungs: usize,
}

impl Ladder {
    /// Side by side, where what is sought may be far.
    pub const MANY: Ladder = Ladder { side_by_side: &[0.1, 1.0, 10.0, 100.0], higher: 1e4, rungs: 3 };
    /// One after the other, where the way is short, or runs side by side take as long.
    pub const ONE: Ladder = Ladder { side_by_side: &[0.3], higher: 3.0, rungs: 16 };
}

/// So often the derivatives are worked out at most, unless a task says otherwise.
pub const MOST_ROUNDS: usize = 40;
/// So often they are worked out before a fit may be given up.
const FIRST_ROUNDS: usize = 4;
/// What does not matter: so much of the sum of squares, or, where more than noise is left, of what is left by a sample.
const SETTLED: f64 = 0.01;
/// Where fits end unless a task says otherwise.
pub const SETTLED_SHARE: f64 = 1e-6;
/// The derivatives of so many records are worked out before they are gathered: they take room.
pub(crate) const AT_ONCE: usize = 8;
/// By this share of its range, or of 100 V, a coordinate is moved for a derivative.
pub(crate) const NUDGE: f64 = 1e-6;
/// A coordinate that would change the squares by less than this, all its way, is left where it is.
const LEAST_FELT: f64 = 1.0;
/// Where so many data come on every number that is fitted, it does not matter which of these are felt.
const MANY_DATA: usize = 100;

impl Task<'_> {
    /// Fits from a point on; nothing where the model cannot be run there.
    pub fn fit(&self, from: &Point) -> Option<Fitted> {
        self.told(&self.reached(from)?.point)
    }

    /// A point with its initial voltages found and its knobs left alone; nothing where the model cannot be run there.
    pub(crate) fn settled(&self, from: &Point) -> Option<Point> {
        let still = Task { turns: false, ..*self };
        // Offsets hold for all records; where there are none, every record is on its own.
        if self.offset.contains(&true) {
            return still.reached(from).map(|reached| reached.point);
        }
        let initial = spare::each(self.records.len(), |record| still.begins(from, record));
        Some(Point { initial: initial.into_iter().collect::<Option<_>>()?, ..from.clone() })
    }

    /// The initial voltages of a record, found without the others.
    fn begins(&self, from: &Point, record: usize) -> Option<Vec<f64>> {
        let (model, records) = (self.model.alone(record), &self.records[record..=record]);
        let alone = Task { model: &model, records, ..*self };
        let from = Point { initial: vec![from.initial[record].clone()], ..from.clone() };
        alone.reached(&from)?.point.initial.pop()
    }

    /// Where a fit comes to from a point on; nothing where the model cannot be run there.
    pub fn reached(&self, from: &Point) -> Option<Reached> {
        let mut at = self.shares(from);
        let mut courses = self.courses(std::slice::from_ref(&at)).pop()??;
        let mut chi2 = self.chi2(&at, &courses);
        let mut damping = 1e-3;
        let mut has_ended = false;
        for round in 1..=self.most_rounds {
            let normal = self.normal(&at, &courses);
            let Some((next, reached, lower, used)) = self.step(&at, chi2, &normal, damping) else {
                has_ended = true;
                break;
            };
            let gain = chi2 - lower;
            (at, courses, chi2, damping) = (next, reached, lower, used / 3.0);
            has_ended = gain < self.negligible(chi2) || self.is_hopeless(chi2, gain, round);
            if has_ended {
                break;
            }
        }
        Some(Reached { point: self.point(&at), chi2, has_ended })
    }

    /// By what a round must lower such a sum of squares to be worth another.
    fn negligible(&self, chi2: f64) -> f64 {
        let samples: usize = self.records.iter().map(Record::len).sum();
        let each = chi2 / (samples * self.sigma.len()).max(1) as f64;
        (SETTLED * each.max(1.0)).max(self.settled * chi2)
    }

    /// Whether a fit that goes on as in its last round will not come to what is wanted.
    fn is_hopeless(&self, chi2: f64, gain: f64, rounds: usize) -> bool {
        let left = MOST_ROUNDS.saturating_sub(rounds);
        rounds >= FIRST_ROUNDS && chi2 - gain * left as f64 > self.wanted
    }

    /// The sums of squares at several points; infinite where the model cannot be run.
    pub(crate) fn look(&self, points: &[Point]) -> Vec<f64> {
        let shares: Vec<_> = points.iter().map(|point| self.shares(point)).collect();
        let courses = self.courses(&shares);
        let pairs = shares.iter().zip(&courses);
        pairs
            .map(|(at, courses)| courses.as_ref().map_or(f64::INFINITY, |courses| self.chi2(at, courses)))
            .collect()
    }

    fn turned(&self) -> usize {
        if self.turns { self.model.knobs.len() } else { 0 }
    }

    /// How many coordinates come before those of the records.
    pub(crate) fn common(&self) -> usize {
        self.model.knobs.len() + self.sigma.len()
    }

    /// Knobs as shares of their ways, offsets in sigmas, then the initial voltages of every record in machine units.
    pub(crate) fn shares(&self, point: &Point) -> DVector<f64> {
        let knobs = self.model.knobs.iter().zip(&point.knobs).map(|(knob, value)| knob.share(*value));
        let offsets = point.offsets.iter().zip(self.sigma).map(|(offset, sigma)| offset / sigma);
        let initial = point.initial.iter().flatten().map(|volts| volts / REFERENCE);
        DVector::from_vec(knobs.chain(offsets).chain(initial).collect())
    }

    pub(crate) fn point(&self, at: &DVector<f64>) -> Point {
        let knobs = self.model.knobs.iter().zip(at.iter()).map(|(knob, share)| knob.at(*share));
        let offsets = self.sigma.iter().enumerate();
        let offsets = offsets.map(|(output, sigma)| at[self.model.knobs.len() + output] * sigma);
        Point {
            knobs: knobs.collect(),
            offsets: offsets.collect(),
            initial: (0..self.records.len()).map(|record| self.initial(at, record)).collect(),
        }
    }

    /// The coordinates of the initial voltages of a record.
    pub(crate) fn states_of(&self, record: usize) -> Range<usize> {
        let (first, count) = (self.common(), self.model.initial.len());
        first + record * count..first + (record + 1) * count
    }

    fn initial(&self, at: &DVector<f64>, record: usize) -> Vec<f64> {
        self.states_of(record).map(|index| REFERENCE * at[index]).collect()
    }

    pub(crate) fn choice(&self, at: &DVector<f64>, record: usize) -> Choice {
        let knobs = self.model.knobs.iter().zip(at.iter()).map(|(knob, share)| knob.at(*share));
        Choice { knobs: knobs.collect(), initial: self.initial(at, record) }
    }

    /// What the model does at several points: of every record; nothing where one of them cannot be run.
    pub(crate) fn courses(&self, points: &[DVector<f64>]) -> Vec<Option<Vec<Course>>> {
        let mut all = vec![Some(Vec::new()); points.len()];
        let runs = spare::each(self.records.len(), |record| {
            let choices: Vec<_> = points.iter().map(|at| self.choice(at, record)).collect();
            self.model.run(record, &choices)
        });
        for run in runs {
            for (courses, course) in all.iter_mut().zip(run) {
                *courses = courses.take().zip(course).map(|(mut courses, course)| {
                    courses.push(course);
                    courses
                });
            }
        }
        all
    }

    /// Data less model over sigma; NaN where there is no datum.
    pub(crate) fn residual(
        &self,
        at: &DVector<f64>,
        record: usize,
        output: usize,
        course: &Course,
    ) -> Vec<f64> {
        let offset = at[self.model.knobs.len() + output];
        let pairs = self.records[record].outputs[output].iter().zip(&course[output]);
        pairs.map(|(datum, value)| (datum - value) / self.sigma[output] - offset).collect()
    }

    pub(crate) fn chi2(&self, at: &DVector<f64>, courses: &[Course]) -> f64 {
        let mut sum = 0.0;
        for (record, course) in courses.iter().enumerate() {
            for output in 0..self.sigma.len() {
                let residual = self.residual(at, record, output, course);
                sum +=
                    residual.iter().filter(|value| !value.is_nan()).map(|value| value * value).sum::<f64>();
            }
        }
        sum
    }

    /// Which coordinates are found at all.
    pub(crate) fn is_free(&self, index: usize) -> bool {
        let knobs = self.model.knobs.len();
        match index {
            index if index < knobs => self.turns && self.held != Some(index),
            index if index < self.common() => self.offset[index - knobs],
            _ => true,
        }
    }

    /// Least and largest share of a coordinate.
    pub(crate) fn bounds(&self, index: usize) -> [f64; 2] {
        match index {
            index if index < self.model.knobs.len() => [0.0, 1.0],
            index if index < self.common() => [f64::NEG_INFINITY, f64::INFINITY],
            _ => {
                let states = &self.model.initial;
                states[(index - self.common()) % states.len()].range.map(|volts| volts / REFERENCE)
            }
        }
    }

    /// The derivatives of every residual, gathered into normal matrix and gradient.
    fn normal(&self, at: &DVector<f64>, courses: &[Course]) -> Normal {
        let (mut normal, nudges) = (Normal::empty(at.len()), self.nudges(at));
        let told = |record: usize| self.told_by(at, record, &courses[record], &nudges);
        spare::each_of(courses.len(), AT_ONCE, told, |outputs| {
            outputs.iter().for_each(|(columns, residual)| normal.add(columns, residual));
        });
        normal
    }

    /// Of every output of a record the derivatives of its residuals, each behind its coordinate, and these residuals.
    pub(crate) fn told_by(
        &self,
        at: &DVector<f64>,
        record: usize,
        course: &Course,
        nudges: &[f64],
    ) -> Vec<(Vec<Column>, Vec<f64>)> {
        let responses = self.responses_over(at, record, course, nudges).into_iter().enumerate();
        responses.map(|(output, columns)| (columns, self.residual(at, record, output, course))).collect()
    }

    /// Of every output of a record the derivatives of its residuals, each behind the coordinate that is moved.
    pub(crate) fn responses(&self, at: &DVector<f64>, record: usize, course: &Course) -> Vec<Vec<Column>> {
        self.responses_over(at, record, course, &self.nudges(at))
    }

    /// The same by so large moves of each.
    fn responses_over(
        &self,
        at: &DVector<f64>,
        record: usize,
        course: &Course,
        nudges: &[f64],
    ) -> Vec<Vec<Column>> {
        let moved: Vec<usize> = (0..self.turned()).chain(self.states_of(record)).collect();
        let choices = moved.iter().map(|index| self.choice(&nudged(at, *index, nudges[*index]), record));
        let beside = self.model.run(record, &choices.collect::<Vec<_>>());
        let of_output = |output: usize| {
            let mut columns: Vec<Column> = Vec::new();
            for (index, other) in moved.iter().zip(&beside) {
                // Where a neighbour cannot be run, that coordinate stays.
                let Some(other) = other else { continue };
                let scale = -1.0 / (nudges[*index] * self.sigma[output]);
                let pairs = other[output].iter().zip(&course[output]);
                columns.push((*index, pairs.map(|(there, here)| (there - here) * scale).collect()));
            }
            if self.offset[output] {
                columns.push((self.model.knobs.len() + output, vec![-1.0; course[output].len()]));
            }
            columns
        };
        (0..self.sigma.len()).map(of_output).collect()
    }

    /// By how much every coordinate is moved for a derivative, away from the end of its way.
    pub(crate) fn nudges(&self, at: &DVector<f64>) -> Vec<f64> {
        (0..at.len()).map(|index| self.nudge(at, index, NUDGE)).collect()
    }

    /// A move of such a size, away from the end of its way.
    pub(crate) fn nudge(&self, at: &DVector<f64>, index: usize, size: f64) -> f64 {
        let [_, high] = self.bounds(index);
        if at[index] + size > high { -size } else { size }
    }

    /// The best of several steps, damped more and less: where to, what the model does there, the sum of squares and the
    /// damping; nothing where none is better.
    fn step(
        &self,
        at: &DVector<f64>,
        chi2: f64,
        normal: &Normal,
        damping: f64,
    ) -> Option<(DVector<f64>, Vec<Course>, f64, f64)> {
        let mut damping = damping;
        for _ in 0..self.dampings.rungs {
            let tried: Vec<f64> = self.dampings.side_by_side.iter().map(|factor| factor * damping).collect();
            let points: Vec<_> = tried.iter().map(|damping| self.damped(at, normal, *damping)).collect();
            let courses = self.courses(&points);
            let mut best: Option<(DVector<f64>, Vec<Course>, f64, f64)> = None;
            for ((point, courses), damping) in points.into_iter().zip(courses).zip(&tried) {
                let Some(courses) = courses else { continue };
                let lower = self.chi2(&point, &courses);
                if lower < best.as_ref().map_or(chi2, |best| best.2) {
                    best = Some((point, courses, lower, *damping));
                }
            }
            if best.is_some() {
                return best;
            }
            damping *= self.dampings.higher;
        }
        None
    }

    /// A step within the bounds: what would leave them stays there, and the rest goes without it.
    fn damped(&self, at: &DVector<f64>, normal: &Normal, damping: f64) -> DVector<f64> {
        let mut free = self.felt(normal);
        let mut to = at.clone();
        loop {
            let step = normal.solved(&free, damping);
            let leaves = |(place, index): (usize, &usize)| {
                let [low, high] = self.bounds(*index);
                let next = at[*index] + step[place];
                (next < low && at[*index] <= low) || (next > high && at[*index] >= high)
            };
            let stuck: Vec<usize> =
                free.iter().enumerate().filter(|own| leaves(*own)).map(|(_, index)| *index).collect();
            if stuck.is_empty() {
                for (place, index) in free.iter().enumerate() {
                    let [low, high] = self.bounds(*index);
                    to[*index] = (at[*index] + step[place]).clamp(low, high);
                }
                return to;
            }
            free.retain(|index| !stuck.contains(index));
        }
    }

    /// The coordinates that are found, and change what is left.
    fn felt(&self, normal: &Normal) -> Vec<usize> {
        let is_felt = |index: &usize| normal.matrix[(*index, *index)] > LEAST_FELT;
        (0..normal.gradient.len()).filter(|index| self.is_free(*index)).filter(is_felt).collect()
    }

    /// How many numbers are found from so many data.
    fn free(&self, at: &DVector<f64>, courses: &[Course], count: usize) -> usize {
        let free = (0..at.len()).filter(|index| self.is_free(*index)).count();
        if count >= MANY_DATA * free { free } else { self.felt(&self.normal(at, courses)).len() }
    }

    /// What is to be told of a point that was fitted; nothing where the model cannot be run there.
    pub fn told(&self, point: &Point) -> Option<Fitted> {
        let at = self.shares(point);
        let courses = self.courses(std::slice::from_ref(&at)).pop()??;
        let chi2 = self.chi2(&at, &courses);
        let residuals = courses.iter().enumerate().map(|(record, course)| {
            (0..self.sigma.len()).map(|output| self.residual(&at, record, output, course)).collect::<Vec<_>>()
        });
        let residuals: Vec<Vec<Vec<f64>>> = residuals.collect();
        let count = residuals.iter().flatten().flatten().filter(|value| !value.is_nan()).count();
        let free = self.free(&at, &courses, count);
        Some(Fitted { point: point.clone(), chi2, residuals, count, free })
    }
}

/// What a coordinate does to all outputs, one behind the other, by their responses to all that may be moved.
pub(crate) fn stacked(responses: &[Vec<Column>], index: usize, samples: usize) -> Vec<f64> {
    let own = |columns: &Vec<Column>| {
        let found = columns.iter().find(|column| column.0 == index);
        found.map_or_else(|| vec![0.0; samples], |column| column.1.clone())
    };
    responses.iter().flat_map(own).collect()
}

/// A point with one coordinate moved.
pub(crate) fn nudged(at: &DVector<f64>, index: usize, by: f64) -> DVector<f64> {
    let mut to = at.clone();
    to[index] += by;
    to
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::model::FitProgram;
    use patchcord_core::patch::Patch;

    /// An integrator that stays where it begins, at -50 ... 0 V, upside down.
    const STANDING: &str = r#"{
  "patchcord": 1,
  "parameters": {"begin": {"value": -30, "unit": "1", "range": [-50, 0]}},
  "elements": {"L1": {"kind": "held"}, "B1": {"kind": "inverter", "in": "L1.out"}},
  "macros": {"held": {"outputs": {"out": "A1"}, "elements": {
    "A1": {"kind": "integrator", "in": {"x1": ["ground"]}, "initial": "begin"}
  }}}
}"#;

    /// The voltage that is found, from another on, where B1 was measured at so many volts.
    fn found(from: f64, measured: f64) -> f64 {
        let patch = Patch::parse("standing.json", STANDING).unwrap_or_else(|report| panic!("{report}"));
        let records = [Record {
            name: String::new(),
            begin: 0.0,
            since: 0.0,
            interval: 0.1,
            jitter: 0.0,
            drives: Vec::new(),
            outputs: vec![vec![measured; 12]],
        }];
        let [free, outputs] = ["begin", "B1"].map(|name| [name.to_owned()]);
        let lowered = FitProgram::new(&patch, &[]).unwrap();
        let model = Model::new(&lowered, &patch, &records, &[], &free, &outputs, 1).unwrap();
        let task = Task {
            model: &model,
            records: &records,
            sigma: &[1.0],
            offset: &[false],
            turns: true,
            held: None,
            wanted: f64::INFINITY,
            most_rounds: MOST_ROUNDS,
            settled: SETTLED_SHARE,
            dampings: Ladder::ONE,
        };
        let from = Point { knobs: Vec::new(), initial: vec![vec![from]], offsets: vec![0.0] };
        task.fit(&from).unwrap().point.initial[0][0]
    }

    #[test]
    fn initial_voltages_are_found_within_their_ranges() {
        for from in [-50.0, -30.0, 0.0] {
            for (measured, wanted) in [(20.0, -20.0), (-10.0, 0.0), (70.0, -50.0)] {
                let found = found(from, measured);
                assert!((found - wanted).abs() < 1e-6, "{found} from {from} on, {wanted} is right");
            }
        }
    }
}
