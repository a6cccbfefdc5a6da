//! The effort of a fit from several starts: the number of starts, the rungs of successive halving, and the subsample.
//!
//! Successive halving fits from all starts for a few iterations and continues only with the best, in several rungs.
//! If there are many records, the first rungs use a subsample of the records. If the motion oscillates or sticks, the
//! fitted fraction of each record grows from rung to rung. Otherwise a fit may follow the wrong period.

use crate::data::record::Record;
use crate::fit::estimate::{Estimate, FitState};
use crate::fit::levenberg_marquardt::{FitProblem, MAX_ITERATIONS};
use crate::fit::model::Model;
use crate::fit::start_cache::StartCache;

/// The effort that is made to fit one variant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// The largest number of optional starts; required starts are not counted.
    optional_starts: usize,
    /// The rungs of successive halving, in order.
    rungs: &'static [Rung],
    /// How a subsample of the records is used if there are many records. `None` if it is not used.
    subsample: Option<Subsample>,
    /// Whether the fit is more than a first look. Then the validation converges and uses two starts. With many records
    /// the best optional start is tried on all of them, not a start without the effect.
    pub(crate) is_thorough: bool,
}

/// How a subsample of the records is used.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Subsample {
    /// The number of rungs, from the first, that are fitted to the subsample.
    rungs: usize,
    /// The rungs that are then fitted to all records, from the survivors of the subsample.
    all_records: &'static [Rung],
}

/// One rung of successive halving: some iterations from several starts, of which the best survive.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Rung {
    /// The largest number of iterations from each start.
    iterations: usize,
    /// The number of unfinished fits that survive. Finished fits that are better than these survive, too.
    survivors: usize,
    /// The fraction of every record that is fitted, from its beginning; 1 is the whole record.
    fraction: f64,
}

impl Rung {
    /// A rung with the given iterations, survivors and fraction of the records.
    const fn new(iterations: usize, survivors: usize, fraction: f64) -> Rung {
        Rung { iterations, survivors, fraction }
    }
}

impl Effort {
    /// A quick look: it is sufficient to decide whether a full fit is worthwhile.
    pub const QUICK: Effort = Effort {
        optional_starts: 1,
        rungs: &[Rung::new(1, 1, 1.0), Rung::new(4, 1, 1.0)],
        subsample: Some(Subsample { rungs: 2, all_records: &[Rung::new(1, 1, 1.0)] }),
        is_thorough: false,
    };
    /// A full fit, whose result is compared with others.
    pub const FULL: Effort = Effort {
        optional_starts: 4,
        rungs: &[Rung::new(1, 3, 1.0), Rung::new(4, 2, 1.0), Rung::new(MAX_ITERATIONS, 1, 1.0)],
        subsample: Some(Subsample {
            rungs: 2,
            all_records: &[Rung::new(2, 1, 1.0), Rung::new(MAX_ITERATIONS, 1, 1.0)],
        }),
        is_thorough: true,
    };
    /// A full fit to growing fractions of the records, for motion that oscillates or sticks. A fit to whole records
    /// would keep in step with the wrong period.
    pub const GROWING: Effort = Effort {
        optional_starts: 4,
        rungs: &[
            Rung::new(1, 4, 1.0),
            Rung::new(MAX_ITERATIONS, 4, 0.35),
            Rung::new(MAX_ITERATIONS, 4, 0.65),
            Rung::new(MAX_ITERATIONS, 1, 1.0),
        ],
        subsample: None,
        is_thorough: true,
    };
    /// A full fit for a record with unknown initial voltages. It fits the first tenth of the record first.
    pub(crate) const UNKNOWN_INITIAL: Effort = Effort {
        optional_starts: 6,
        rungs: &[
            Rung::new(4, 4, 0.1),
            Rung::new(MAX_ITERATIONS, 3, 0.35),
            Rung::new(MAX_ITERATIONS, 2, 0.65),
            Rung::new(MAX_ITERATIONS, 1, 1.0),
        ],
        subsample: None,
        is_thorough: true,
    };
}

/// Relative decrease of the sum of squares at which a fit to a part of the records has converged. It is larger than
/// [`CONVERGENCE_RATIO`](crate::fit::levenberg_marquardt::CONVERGENCE_RATIO), because a fit to more data follows.
const PARTIAL_CONVERGENCE_RATIO: f64 = 3e-4;

/// The starts of a fit.
#[derive(Debug, Clone, Default)]
pub(crate) struct Starts {
    /// Starts that are always used, such as those without any effect, one for each shape of the effect.
    pub required: Vec<Estimate>,
    /// The result of an earlier fit, which is always used.
    pub previous: Option<Estimate>,
    /// Starts of which only those with the least sums of squares are used.
    pub optional: Vec<Estimate>,
}

impl Effort {
    /// The effort for a subsample of the records and the effort for all records after it. `None` if this effort uses
    /// all records from the first rung.
    pub(crate) fn split(self) -> Option<[Effort; 2]> {
        self.subsample.map(|Subsample { rungs, all_records }| {
            let subsample_effort = Effort { rungs: &self.rungs[..rungs], ..self };
            [subsample_effort, Effort { rungs: all_records, ..self }]
                .map(|effort| Effort { subsample: None, ..effort })
        })
    }

    /// The best fit from several starts. `None` if the model cannot be run from any of them.
    pub(crate) fn best(
        self,
        fit_problem: &FitProblem<'_>,
        starts: &Starts,
        cache: &mut StartCache,
    ) -> Option<Estimate> {
        self.survivors(fit_problem, starts, cache).into_iter().next()
    }

    /// The fits that survive the last rung, the best first.
    ///
    /// `cache` keeps the first results from each start, so that a later fit with more effort does not repeat them.
    pub(crate) fn survivors(
        self,
        fit_problem: &FitProblem<'_>,
        starts: &Starts,
        cache: &mut StartCache,
    ) -> Vec<Estimate> {
        let unfitted = |estimate: Estimate| FitState { estimate, chi2: f64::INFINITY, is_finished: false };
        let first_beginnings =
            self.rungs.first().and_then(|rung| RecordBeginnings::new(fit_problem, rung.fraction));
        let first_problem =
            first_beginnings.as_ref().map_or(*fit_problem, |beginnings| beginnings.fit_problem(fit_problem));
        let always = starts.required.iter().chain(&starts.previous);
        let nearest =
            first_problem.nearest_starts(&starts.optional, &starts.required, self.optional_starts, cache);
        let mut survivors: Vec<FitState> = always.chain(nearest).cloned().map(unfitted).collect();
        let mut last_fraction = 1.0;
        for rung in self.rungs {
            let beginnings = RecordBeginnings::new(fit_problem, rung.fraction);
            let rung_problem =
                beginnings.as_ref().map_or(*fit_problem, |beginnings| beginnings.fit_problem(fit_problem));
            let rung_problem = FitProblem { max_iterations: rung.iterations, ..rung_problem };
            let advance = |state: FitState| match state.is_finished && rung.fraction == last_fraction {
                true => Some(state),
                false => rung_problem.optimise(&state.estimate),
            };
            survivors = match rung.iterations == 1 {
                true => rung_problem.first_iterations(survivors.iter().map(|state| &state.estimate), cache),
                false => survivors.into_iter().filter_map(advance).collect(),
            };
            survivors.sort_by(|a, b| a.chi2.total_cmp(&b.chi2));
            // A finished fit does not displace others: if the effect does not act, such as a stop that is never
            // reached, the fit cannot move.
            let mut remaining = rung.survivors;
            survivors.retain(|state| {
                let survives = remaining > 0;
                remaining -= usize::from(survives && !state.is_finished);
                survives
            });
            last_fraction = rung.fraction;
        }
        survivors.into_iter().map(|state| state.estimate).collect()
    }
}

/// The beginnings of records, and a model that runs only along these.
pub(crate) struct RecordBeginnings {
    /// The model of the shortened records.
    model: Model,
    /// The shortened records.
    records: Vec<Record>,
}

impl RecordBeginnings {
    /// The first `fraction` of every record of a problem. `None` if that is the whole record.
    pub(crate) fn new(fit_problem: &FitProblem<'_>, fraction: f64) -> Option<RecordBeginnings> {
        (fraction < 1.0).then(|| {
            let records: Vec<Record> =
                fit_problem.records.iter().map(|record| record.truncated(fraction)).collect();
            RecordBeginnings { model: fit_problem.model.for_beginnings(&records), records }
        })
    }

    /// The problem of fitting only these beginnings, without a target and with looser convergence.
    pub(crate) fn fit_problem<'b>(&'b self, whole: &FitProblem<'b>) -> FitProblem<'b> {
        let (model, records) = (&self.model, self.records.as_slice());
        FitProblem {
            model,
            records,
            target_chi2: f64::INFINITY,
            convergence_ratio: PARTIAL_CONVERGENCE_RATIO,
            ..*whole
        }
    }
}
