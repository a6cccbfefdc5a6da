//! What shows beside a patch as it was fitted.

use super::Limit;
use super::cleared::{Both, Cleared};
use super::half::{Change, Half};
use super::tried::Tried;
use crate::candidate::Candidate;
use crate::directions::product;
use crate::fit::Point;
use crate::model::{Model, ModelError};
use crate::parameter_values::ParameterValues;
use crate::problem::Problem;
use crate::round::{Bar, CONFIRMED};
use crate::score::expected;
use crate::stage::{Stage, Version};

/// So many choices of an effect's other parameters are tried.
const VARIANTS: usize = 3;

/// What a patch does beside its records, and in which directions its fit follows.
pub(super) struct Ground<'a> {
    problem: &'a Problem,
    before: &'a Stage,
    bar: Bar,
    pub(super) train: Half<'a>,
    pub(super) test: Half<'a>,
    /// The same with no states beside those of the patch.
    usual: Cleared,
}

impl<'a> Ground<'a> {
    pub(super) fn of(
        problem: &'a Problem,
        before: &'a Stage,
        bar: Bar,
        steps: u32,
    ) -> Result<Option<Ground<'a>>, ModelError> {
        let version = Version { steps, ..before.version.clone() };
        let train = Half::of(problem, &version, &problem.train, &before.train.point)?;
        let test = Half::of(problem, &version, &problem.test, &before.test.point)?;
        Ok(train.zip(test).map(|(train, test)| {
            let usual = Cleared::of([&train, &test], version.fit.len(), [&[], &[]]);
            Ground { problem, before, bar, train, test, usual }
        }))
    }

    /// The least strength at which an effect would have been seen, whatever its other parameters.
    pub(super) fn limit(&self, candidate: &Candidate, version: &Version) -> Result<Limit, ModelError> {
        let models = [
            self.problem.model(version, &self.problem.train, &self.problem.outputs)?,
            self.problem.model(version, &self.problem.test, &self.problem.outputs)?,
        ];
        let numbers = version.fit.len() - self.before.version.fit.len();
        let need = self.need(numbers);
        let found = variants(candidate).into_iter().filter_map(|rest| {
            let without = self.without(&models, candidate, &rest);
            let tried = Tried { ground: self, models: &models, candidate, rest: &rest, need, without };
            tried.least().map(|(value, share)| (value, share, rest.clone()))
        });
        let least = found.min_by(|a, b| a.1.total_cmp(&b.1));
        let brought = &candidate.graft.parameters;
        let beside = least.iter().flat_map(|(_, _, rest)| brought[1..].iter().zip(rest));
        Ok(Limit {
            effect: candidate.effect.clone(),
            junction: candidate.junction.clone(),
            reads: candidate.reads.clone(),
            parameter: brought[0].of.clone(),
            unit: brought[0].unit.clone(),
            value: least.as_ref().map(|least| least.0),
            share: least.as_ref().map_or(f64::INFINITY, |least| least.1),
            beside: ParameterValues(
                beside.map(|(own, value)| (own.of.clone(), *value, own.unit.clone())).collect(),
            ),
        })
    }

    /// Of both halves, by record, what there is without an effect whose other parameters are told.
    fn without(
        &self,
        models: &[Model; 2],
        candidate: &Candidate,
        rest: &[f64],
    ) -> [Vec<Option<Vec<f64>>>; 2] {
        let none = candidate.none.map(|none| [&[none], rest].concat());
        let halves = [&self.train, &self.test];
        [0, 1].map(|half| halves[half].without(&models[half], none.as_deref(), candidate.graft.free.len()))
    }

    /// The sum of squares over noise that a trial with so many numbers more must take away.
    fn need(&self, numbers: usize) -> f64 {
        let samples = self.before.train.count as f64 / self.bar.memory;
        self.bar.needed + numbers as f64 * libm::log(samples)
    }

    /// What parameters, initial voltages and offsets do not follow of a change, to first order.
    pub(super) fn left(&self, [train, test]: &[Change; 2]) -> Both {
        let own;
        let cleared = match train.states.iter().all(Vec::is_empty) {
            true => &self.usual,
            false => {
                let fit = self.before.version.fit.len();
                own = Cleared::of([&self.train, &self.test], fit, [&train.states, &test.states]);
                &own
            }
        };
        let spans = [&self.train.spans[..], &self.test.spans[..]];
        cleared.without(spans, [train.outputs.clone(), test.outputs.clone()])
    }

    /// What they do not follow when they are fitted in full; nothing where the patch cannot be run so.
    pub(super) fn left_in_full(&self, [train, test]: &[Change; 2]) -> Option<Both> {
        let trained = self.train.fitted(train, self.train.point)?;
        let begun = Point { initial: self.test.point.initial.clone(), ..trained.point.clone() };
        let held = self.test.settled(test, &begun)?;
        Some([self.train.apart(train, &trained), self.test.apart(test, &held)])
    }

    /// By what factor such tracks are more than the search needs to take them for an effect, in squares.
    pub(super) fn margin(&self, [train, test]: &Both, need: f64) -> f64 {
        let shown = product(train, train) / (self.bar.variance() * need);
        let confirmed = expected(&self.test.tracks(test), self.bar.variance());
        let apart = (confirmed.ratio() / CONFIRMED).powi(2);
        shown.min(apart.max(confirmed.sum / (self.bar.variance() * self.bar.needed)))
    }
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
