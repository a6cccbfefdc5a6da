//! What shows beside a patch as it was fitted.

use crate::design::detectability::cleared::{Both, Cleared};
use crate::design::detectability::half::{Change, Half};
use crate::fit::estimate::Point;
use crate::fit::fitted_model::Stage;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::statistics::acceptance::{Bar, CONFIRMED};
use crate::statistics::block_comparison::expected;
use crate::statistics::directions::product;

/// What a patch does beside its records, and in which directions its fit follows.
pub(super) struct Ground<'a> {
    pub(crate) problem: &'a Problem,
    pub(crate) before: &'a Stage,
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
        let version = before.version.with_steps(steps);
        let train = Half::of(problem, &version, &problem.train, &before.train.point)?;
        let test = Half::of(problem, &version, &problem.test, &before.test.point)?;
        Ok(train.zip(test).map(|(train, test)| {
            let usual = Cleared::of([&train, &test], version.fit.len(), [&[], &[]]);
            Ground { problem, before, bar, train, test, usual }
        }))
    }

    /// The sum of squares over noise that a trial with so many numbers more must take away.
    pub(crate) fn need(&self, numbers: usize) -> f64 {
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
