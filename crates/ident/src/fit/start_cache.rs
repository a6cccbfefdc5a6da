//! Caches of the first results from starts, so that a fit with more effort does not compute them again.

use crate::fit::estimate::{Estimate, FitState};
use crate::fit::levenberg_marquardt::FitProblem;

/// Results from starts of fits to the same records.
#[derive(Debug, Clone, Default)]
pub(crate) struct StartCache {
    /// Starts with their sums of squares. Infinite if the model cannot be run there.
    chi2: Vec<(Estimate, f64)>,
    /// Starts with the state after one iteration. `None` if the model cannot be run there.
    first_iterations: Vec<(Estimate, Option<FitState>)>,
}

impl FitProblem<'_> {
    /// The `count` estimates with the least sums of squares, the best first.
    ///
    /// An estimate is excluded if its sum of squares equals that of one in `others`: the effect does not act there, and
    /// the derivatives are zero.
    pub(crate) fn nearest_starts<'p>(
        &self,
        estimates: &'p [Estimate],
        others: &[Estimate],
        count: usize,
        cache: &mut StartCache,
    ) -> impl Iterator<Item = &'p Estimate> + use<'p> {
        let other_chi2 = self.cached_chi2(others, cache);
        let chi2 = self.cached_chi2(estimates, cache);
        let is_new = |index: &usize| chi2[*index].is_finite() && !other_chi2.contains(&chi2[*index]);
        let mut order: Vec<usize> = (0..estimates.len()).filter(is_new).collect();
        order.sort_by(|a, b| chi2[*a].total_cmp(&chi2[*b]));
        order.into_iter().take(count).map(|index| &estimates[index])
    }

    /// The sums of squares of several estimates, from the cache as far as possible. New ones are added to it.
    fn cached_chi2(&self, estimates: &[Estimate], cache: &mut StartCache) -> Vec<f64> {
        let is_new = |estimate: &&Estimate| lookup(&cache.chi2, estimate).is_none();
        let new: Vec<Estimate> = estimates.iter().filter(is_new).cloned().collect();
        let new_chi2 = self.chi2_of_estimates(&new);
        cache.chi2.extend(new.into_iter().zip(new_chi2));
        estimates.iter().filter_map(|estimate| lookup(&cache.chi2, estimate)).collect()
    }

    /// The states after one iteration from several starts, from the cache as far as possible. Starts from which the
    /// model cannot be run are left out.
    pub(crate) fn first_iterations<'p>(
        &self,
        starts: impl Iterator<Item = &'p Estimate>,
        cache: &mut StartCache,
    ) -> Vec<FitState> {
        let one_iteration = FitProblem { max_iterations: 1, ..*self };
        let mut states = Vec::new();
        for start in starts {
            let state = lookup(&cache.first_iterations, start).unwrap_or_else(|| {
                let state = one_iteration.optimise(start);
                cache.first_iterations.push((start.clone(), state.clone()));
                state
            });
            states.extend(state);
        }
        states
    }
}

/// The cached value of an estimate, if there is one.
fn lookup<T: Clone>(entries: &[(Estimate, T)], estimate: &Estimate) -> Option<T> {
    entries.iter().find(|(cached, _)| cached == estimate).map(|(_, value)| value.clone())
}

/// The caches of the fits of one variant, one for each set of records.
#[derive(Debug, Clone, Default)]
pub(crate) struct StartCaches {
    /// For all training records, whole.
    pub(crate) whole: StartCache,
    /// For the pieces of the training records.
    pub(crate) pieces: StartCache,
    /// For the subsample of the training records.
    pub(crate) subsample: StartCache,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Experiment;
    use crate::fit::base_fit::fit_base;
    use crate::fit::problem::Problem;

    #[test]
    fn cached_results_are_not_computed_again() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/hidden/nothing/experiment.json");
        let experiment = Experiment::read(path).unwrap_or_else(|error| panic!("{error}"));
        let problem = Problem::of(&experiment).unwrap();
        let fitted = fit_base(&problem, &experiment.patch, &experiment.fit, 1).unwrap().unwrap();
        let model = problem.model(&fitted.variant, &problem.train, &problem.outputs).unwrap();
        let (fit_problem, optimum) =
            (problem.fit_problem(&model, &problem.train, true), &fitted.train.estimate);
        let shifted = Estimate {
            parameters: optimum.parameters.iter().map(|value| 1.01 * value).collect(),
            ..optimum.clone()
        };
        let starts = [optimum.clone(), shifted];
        // Impossible values, which can only come from the cache.
        let cached_state = FitState { estimate: optimum.clone(), chi2: -1.0, is_finished: true };
        let mut cache = StartCache {
            chi2: vec![(optimum.clone(), -2.0)],
            first_iterations: vec![(optimum.clone(), Some(cached_state))],
        };
        for _ in 0..2 {
            let chi2 = fit_problem.cached_chi2(&starts, &mut cache);
            assert_eq!(chi2, [-2.0, fit_problem.chi2_of_estimates(&starts)[1]]);
            let states = fit_problem.first_iterations(starts.iter(), &mut cache);
            let computed = FitProblem { max_iterations: 1, ..fit_problem }.optimise(&starts[1]).unwrap();
            assert_eq!([states[0].chi2, states[1].chi2], [-1.0, computed.chi2]);
            assert!(computed.chi2 < chi2[1]);
            assert_eq!((cache.chi2.len(), cache.first_iterations.len()), (2, 2));
        }
    }
}
