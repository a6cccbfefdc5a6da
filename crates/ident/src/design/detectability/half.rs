//! A patch beside some of the records, and what an effect changes there.

use std::ops::Range;

use crate::data::record::Record;
use crate::fit::estimate::{Fitted, Point};
use crate::fit::fitted_model::Version;
use crate::fit::levenberg_marquardt::{Task, stacked};
use crate::fit::model::{Choice, Course, Model, ModelError};
use crate::fit::problem::Problem;
use crate::fit::validation::FIRST_HELD;
use crate::statistics::directions::{clear, less, orthonormal};

/// By so many volts initial voltages of an effect are moved for derivatives.
const NUDGE: f64 = 1e-3;

/// Some records one behind the other, of each all outputs, over the noise; 0 where there is no datum.
pub(super) struct Half<'a> {
    problem: &'a Problem,
    model: Model,
    records: &'a [Record],
    pub(super) point: &'a Point,
    pub(super) spans: Vec<Range<usize>>,
    /// What the patch does.
    here: Vec<f64>,
    /// By record, what its initial voltages do.
    pub(super) states: Vec<Vec<Vec<f64>>>,
    /// What knobs do, then declared offsets.
    pub(super) common: Vec<Vec<f64>>,
}

/// What an effect of some strength changes, and what its own initial voltages do, by record.
#[derive(Default)]
pub(super) struct Change {
    pub(super) outputs: Vec<f64>,
    pub(super) states: Vec<Vec<Vec<f64>>>,
}

impl<'a> Half<'a> {
    pub(super) fn of(
        problem: &'a Problem,
        version: &Version,
        records: &'a [Record],
        point: &'a Point,
    ) -> Result<Option<Half<'a>>, ModelError> {
        let model = problem.model(version, records, &problem.outputs)?;
        let mut half = Half {
            problem,
            model,
            records,
            point,
            spans: Vec::new(),
            here: Vec::new(),
            states: Vec::new(),
            common: Vec::new(),
        };
        let task = problem.task(&half.model, records, true);
        let at = task.shares(point);
        let free: Vec<usize> = (0..task.common()).filter(|index| task.is_free(*index)).collect();
        half.common = vec![Vec::new(); free.len()];
        for (record, data) in records.iter().enumerate() {
            let Some(course) = half.model.run(record, &[task.choice(&at, record)]).pop().flatten() else {
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
    pub(super) fn tracks<'t>(&self, all: &'t [f64]) -> Vec<Vec<&'t [f64]>> {
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
    pub(super) fn fitted(&self, change: &Change, from: &Point) -> Option<Fitted> {
        self.problem.task(&self.model, &self.with(change), true).fit(from)
    }

    /// The same with initial voltages alone found, as at a first look.
    pub(super) fn settled(&self, change: &Change, from: &Point) -> Option<Fitted> {
        let records = self.with(change);
        let task = Task { most_rounds: FIRST_HELD, ..self.problem.task(&self.model, &records, false) };
        task.told(&task.settled(from)?)
    }

    /// What a fit leaves of a change that the effect's own initial voltages do not follow.
    pub(super) fn apart(&self, change: &Change, fitted: &Fitted) -> Vec<f64> {
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

    /// A record with what an effect brings, its own initial voltages at none.
    fn wired(&self, record: usize, brought: &[f64], own_states: usize) -> Choice {
        Choice {
            knobs: [self.point.knobs.as_slice(), brought].concat(),
            initial: [self.point.initial[record].as_slice(), &vec![0.0; own_states]].concat(),
        }
    }

    /// By record, what the patch does with an effect of no strength; what it does as it is where there is no such. Nothing where it
    /// cannot be run so.
    pub(super) fn without(
        &self,
        model: &Model,
        none: Option<&[f64]>,
        own_states: usize,
    ) -> Vec<Option<Vec<f64>>> {
        let at_none = |record: usize, none: &[f64]| {
            let course = model.run(record, &[self.wired(record, none, own_states)]).pop().flatten()?;
            Some(self.over_noise(record, &course))
        };
        let by_record = self.spans.iter().enumerate().map(|(record, span)| match none {
            Some(none) => at_none(record, none),
            None => Some(self.here[span.clone()].to_vec()),
        });
        by_record.collect()
    }

    /// What changes with each of some strengths, beside what there is without.
    pub(super) fn changes(
        &self,
        model: &Model,
        strengths: &[Vec<f64>],
        without: &[Option<Vec<f64>>],
        own_states: usize,
    ) -> Vec<Option<Change>> {
        let mut changes: Vec<Option<Change>> = strengths.iter().map(|_| Some(Change::default())).collect();
        let first_own = self.point.initial[0].len();
        for (record, here) in without.iter().enumerate() {
            let lanes = strengths.iter().flat_map(|strength| {
                let moved = [None].into_iter().chain((0..own_states).map(Some));
                moved.map(move |moved| {
                    let mut own = self.wired(record, strength, own_states);
                    moved
                        .into_iter()
                        .for_each(|place| own.initial[first_own + place] += self.nudge(model, place));
                    own
                })
            });
            let mut courses = model.run(record, &lanes.collect::<Vec<_>>()).into_iter();
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

pub(super) fn clear_states(states: &[Vec<Vec<f64>>], spans: &[Range<usize>], track: &mut [f64]) {
    states.iter().zip(spans).for_each(|(basis, span)| clear(basis, &mut track[span.clone()]));
}
