//! The records that are held back: only the voltages with which integrators begin are found there, and declared offsets.

use super::begun::Begun;
use super::effort::{Effort, Starts};
use super::fit::{Fitted, MOST_ROUNDS, Point, Task};
use super::model::ModelError;
use super::problem::Problem;
use super::record::Record;
use super::stage::{Stage, Version};

/// So often the derivatives are worked out in a first look at what was held back.
pub(super) const FIRST_HELD: usize = 2;

/// A patch that leaves so much more of what was held back than of what it was fitted to may have begun there in the wrong place, as
/// may one that leaves noise there, and more than that of what was held back.
const LOST: f64 = 1.5;
/// Voltages from which each state may begin.
const VOLTS: [f64; 10] = [-80.0, -30.0, -10.0, -3.0, -1.0, 1.0, 3.0, 10.0, 30.0, 80.0];

impl Problem {
    /// The same knobs on the records that are held back: only initial voltages and declared offsets are found there, from where the
    /// patch stands and from where another fit came to.
    pub(super) fn held(
        &self,
        version: &Version,
        at: &Point,
        from: Option<&[Vec<f64>]>,
        effort: Effort,
    ) -> Result<Option<Fitted>, ModelError> {
        let model = self.model(version, &self.test, &self.outputs)?;
        let first = Point::of(&model, self.outputs.len());
        let first = Point { knobs: at.knobs.clone(), offsets: at.offsets.clone(), ..first };
        let before = from.map(|initial| Point { initial: filled(initial, &first.initial), ..first.clone() });
        let most_rounds = if effort.is_thorough { MOST_ROUNDS } else { FIRST_HELD };
        // Pieces begin as was measured: from there one fit is enough.
        let starts = if effort.is_thorough && !self.is_cut { 2 } else { 1 };
        let task = Task { most_rounds, ..self.task(&model, &self.test, false) };
        let starts = before.into_iter().chain([first]).take(starts);
        Ok(Fitted::best_of(starts.filter_map(|point| task.told(&task.settled(&point)?))))
    }

    /// A stage that may have begun there in the wrong place, begun from many; nothing where that is not better.
    ///
    /// # Errors
    /// When the patch cannot be run beside the records.
    pub(super) fn found_again(&self, stage: &Stage) -> Result<Option<Stage>, ModelError> {
        // Pieces begin as was measured, and do not last.
        if self.is_cut || !self.is_lost(stage) {
            return Ok(None);
        }
        let begins = self.test.iter().zip(&stage.test.point.initial);
        let begins = begins.map(|(record, initial)| self.begin(stage, record, initial));
        let initial = begins.collect::<Result<Vec<_>, _>>()?;
        let again = self.held(&stage.version, &stage.train.point, Some(&initial), Effort::FULL)?;
        let better = again.filter(|again| again.chi2 < stage.test.chi2);
        Ok(better.map(|test| Stage { test, ..stage.clone() }))
    }

    /// Whether a stage may have begun in the wrong place in the records that are held back.
    fn is_lost(&self, stage: &Stage) -> bool {
        let is_explained = !stage.leaves_structure();
        let leaves_more = stage.test.over_noise() >= LOST * stage.train.over_noise().max(1.0);
        leaves_more || is_explained && self.has_changed(stage)
    }

    /// The voltages with which a record begins, by its beginning first; those known before where no others are better.
    fn begin(&self, stage: &Stage, record: &Record, known: &[f64]) -> Result<Vec<f64>, ModelError> {
        let record = std::slice::from_ref(record);
        let model = self.model(&stage.version, record, &self.outputs)?;
        let task = self.task(&model, record, false);
        let at = |initial: Vec<f64>| Point { initial: vec![initial], ..stage.train.point.clone() };
        let moved = |state: usize| {
            let [low, high] = model.initial[state].range;
            let allowed = VOLTS.into_iter().filter(move |volts| (low..=high).contains(volts));
            allowed.map(move |volts| {
                let mut initial = known.to_vec();
                initial[state] = volts;
                initial
            })
        };
        let starts = Starts {
            sure: vec![at(known.to_vec())],
            others: (0..known.len()).flat_map(moved).map(at).collect(),
            ..Starts::default()
        };
        let best = Effort::FROM_ANYWHERE.best(&task, &starts, &mut Begun::default());
        Ok(best.map_or_else(|| known.to_vec(), |best| best.initial[0].clone()))
    }
}

/// Initial voltages of fewer states, with those of the rest behind them.
fn filled(some: &[Vec<f64>], all: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let pairs = some.iter().zip(all);
    pairs.map(|(some, all)| some.iter().chain(&all[some.len()..]).copied().collect()).collect()
}
