//! The localisation of one junction: the input over time, the curves that may describe it, and the best curve wired in.
//!
//! First the input over time is estimated, with few knots and, if residuals remain, with more. From its normal
//! equations a curve over each regressor follows without further runs (`candidate_curve`). Of the most likely curves at
//! most two are wired in as function generators and fitted again, because a curve acts back on its own regressor
//! (`wired_curve`). The first that also explains the validation records is reported.

use crate::data::record::Record;
use crate::effects::sites::{Junction, ScaledSignal, Sites};
use crate::fit::estimate::{Estimate, FitResult};
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::levenberg_marquardt::FitProblem;
use crate::fit::model::{ModelError, ReplacedTable, with_initial_voltages};
use crate::fit::problem::Problem;
use crate::localise::candidate_curve::CandidateCurve;
use crate::localise::input_basis::InputBasis;
use crate::localise::localisation::{EstimatedInput, Localisation};
use crate::localise::recovered::with_table;
use crate::localise::regressor::Regressor;
use crate::localise::unknown_input::{InputEstimation, InputFit, InputStart, PERTURBATION};
use patchcord_core::patch::Patch;

/// The number of knots of an input over time, over all records. The second is used if the first leaves residuals.
const TIME_KNOTS: [usize; 2] = [160, 400];
/// Mean square of the residuals, in units of sigma squared, up to which they count as noise.
const NOISE_CHI2_PER_DATUM: f64 = 1.1;
/// Prior standard deviations of the nuisance parameters, as fractions of their ranges. The next is used if the
/// estimation with the one before fails.
const NUISANCE_SPREADS: [f64; 3] = [0.1, 0.01, 1e-4];
/// Least number of samples between two knots of an input over time.
const MIN_SAMPLES_PER_KNOT: usize = 3;

/// Number of standard errors by which an input differs from zero significantly. It acts only in windows with such a
/// value.
const SIGNIFICANT_ERRORS: f64 = 3.0;
/// Least magnitude within a window, as a share of the largest. Smaller values can be errors of other parameters.
const MIN_SHARE_OF_LARGEST: f64 = 0.2;

/// The localisation of one junction of a fitted model.
pub(super) struct JunctionAnalysis<'a> {
    /// The records and the noise.
    pub problem: &'a Problem,
    /// The fitted model without an input.
    pub fitted: &'a FittedModel,
    /// The sites of its patch.
    pub sites: &'a Sites,
    /// The junction, one of these sites.
    pub junction: &'a Junction,
}

impl JunctionAnalysis<'_> {
    /// Localises. `None` if no input at this junction is better than none.
    ///
    /// # Errors
    /// If a patch with a force at this junction cannot be compiled or run.
    pub(super) fn localise(&self) -> Result<Option<Localisation>, ModelError> {
        let (patch, drive) = with_table(self.fitted.variant.patch(), self.junction, &[[0.0, 0.0]])?;
        let variant = self.variant(patch);
        let model = self.problem.model(&variant, &self.problem.train, &self.problem.outputs)?;
        let fit_problem = self.problem.fit_problem(&model, &self.problem.train, true);
        let table = ReplacedTable::Drive(&drive);
        let bases = TIME_KNOTS.map(|knots| time_basis(&self.problem.train, knots));
        let Some((basis, fit)) = self.input_over_time(fit_problem, table, &bases) else { return Ok(None) };
        let input_estimation = self.input_estimation(fit_problem, table, basis);
        let records = 0..self.problem.train.len();
        let inputs: Vec<Vec<[f64; 2]>> =
            records.map(|record| basis.points(record, &fit.coefficients)).collect();
        let regressors = self.regressors(&variant, &drive, &inputs, &fit.estimate)?;
        let candidates = regressors
            .iter()
            .filter_map(|regressor| self.candidate_curve(&input_estimation, regressor, &fit, &inputs));
        let mut candidates: Vec<CandidateCurve> = candidates.collect();
        let best = self.best_curve(&mut candidates, &regressors, &fit);
        let recovered = match &best {
            Some((_, Some(wired))) => self.recovered_patch(&wired.patch, &wired.fit)?,
            _ => {
                let (patch, _) = with_table(self.fitted.variant.patch(), self.junction, &inputs[0])?;
                self.recovered_patch(&patch, &fit)?
            }
        };
        Ok(Some(Localisation {
            junction: self.junction.integrator.clone(),
            unit: self.junction.sum.unit.text().to_owned(),
            explained_fraction: self.explained_fraction(fit.chi2),
            evidence: fit.evidence,
            effective_parameters: fit.effective_parameters,
            prior: fit.prior,
            inputs: self.estimated_inputs(basis, &fit),
            best_curve: best.map(|(best, _)| best),
            curves: candidates.into_iter().map(|candidate| candidate.curve).collect(),
            recovered,
        }))
    }

    /// The input over time, with its basis. Further bases are tried while residuals remain; the largest evidence wins.
    fn input_over_time<'s>(
        &self,
        fit_problem: FitProblem<'_>,
        table: ReplacedTable<'_>,
        bases: &'s [InputBasis],
    ) -> Option<(&'s InputBasis, InputFit)> {
        let start = InputStart { estimate: &self.fitted.train.estimate, coefficients: None };
        let mut best: Option<(&InputBasis, InputFit)> = None;
        for basis in bases {
            let fit = NUISANCE_SPREADS.into_iter().find_map(|nuisance_spread| {
                InputEstimation { nuisance_spread, ..self.input_estimation(fit_problem, table, basis) }
                    .solve(&start)
            });
            let is_better = |fit: &InputFit| best.as_ref().is_none_or(|best| fit.evidence > best.1.evidence);
            if let Some(fit) = fit.filter(is_better) {
                best = Some((basis, fit));
            }
            if best.as_ref().is_some_and(|best| best.1.chi2 < self.noise_chi2()) {
                break;
            }
        }
        best
    }

    /// The sum of squares of the training records up to which residuals count as noise.
    pub(super) fn noise_chi2(&self) -> f64 {
        NOISE_CHI2_PER_DATUM * self.fitted.train.data_count as f64
    }

    /// A patch with the fitted parameters, and the initial voltages of the first record.
    fn recovered_patch(&self, patch: &Patch, fit: &InputFit) -> Result<Patch, ModelError> {
        let variant = self.variant(patch.clone());
        let fitted = variant.patch_with_values(patch.file(), &fit.estimate.parameters)?;
        with_initial_voltages(&fitted, &self.fitted.variant.initial_states, &fit.estimate.initial[0])
    }

    /// The variant of the fitted model with another patch.
    pub(super) fn variant(&self, patch: Patch) -> ModelVariant {
        self.fitted.variant.with_patch(patch)
    }

    /// The estimation problem of the input with a basis.
    pub(super) fn input_estimation<'s>(
        &'s self,
        fit_problem: FitProblem<'s>,
        table: ReplacedTable<'s>,
        basis: &'s InputBasis,
    ) -> InputEstimation<'s> {
        let (reference, baseline_chi2) = (&self.fitted.train.estimate, self.fitted.train.chi2);
        InputEstimation {
            fit_problem,
            table,
            perturbation: PERTURBATION * self.junction.sum.per_volt,
            basis,
            reference,
            baseline_chi2,
            has_feedback: matches!(table, ReplacedTable::Curve(_)),
            nuisance_spread: NUISANCE_SPREADS[0],
        }
    }

    /// The fraction of the training records' excess that a sum of squares explains.
    pub(super) fn explained_fraction(&self, chi2: f64) -> f64 {
        explained_fraction(&self.fitted.train, chi2)
    }

    /// The input over time in every record, with standard errors and windows.
    fn estimated_inputs(&self, basis: &InputBasis, fit: &InputFit) -> Vec<EstimatedInput> {
        let mut errors = fit.errors.iter().zip(&fit.conditional_errors);
        let records = self.problem.train.iter().enumerate();
        let input = |(index, record): (usize, &Record)| {
            let points = basis.points(index, &fit.coefficients).into_iter().zip(errors.by_ref());
            let points: Vec<[f64; 4]> = points
                .map(|([time, value], (error, conditional))| {
                    [record.begin + time, value, *error, *conditional]
                })
                .collect();
            EstimatedInput { data: record.name.clone(), windows: windows(&points), points }
        };
        records.map(input).collect()
    }

    /// The signals on which the input may depend, without repetition. Earlier ones are preferred.
    fn regressor_signals(&self) -> Vec<&ScaledSignal> {
        let output = &self.junction.output;
        let other_outputs = self.sites.junctions.iter().map(|other| &other.output);
        let all = [output].into_iter().chain(&self.junction.positions).chain(&self.sites.drives);
        let mut signals: Vec<&ScaledSignal> = Vec::new();
        for signal in all.chain(other_outputs) {
            if signals.iter().all(|listed| listed.signal != signal.signal) {
                signals.push(signal);
            }
        }
        signals
    }

    /// The regressors with their trajectories, from runs with the input over time. Empty if a run fails.
    fn regressors(
        &self,
        variant: &ModelVariant,
        drive: &str,
        inputs: &[Vec<[f64; 2]>],
        estimate: &Estimate,
    ) -> Result<Vec<Regressor>, ModelError> {
        let signals = self.regressor_signals();
        let names: Vec<String> = signals.iter().map(|signal| signal.signal.clone()).collect();
        let model = self.problem.model(variant, &self.problem.train, &names)?;
        let mut trajectories = vec![Vec::new(); names.len()];
        for (record, input) in inputs.iter().enumerate() {
            let values = [(estimate.run_values(record), input.clone())];
            let run = model.run_with_tables(record, ReplacedTable::Drive(drive), &values);
            let Some(run) = run.into_iter().flatten().next() else { return Ok(Vec::new()) };
            trajectories.iter_mut().zip(run).for_each(|(all, trajectory)| all.push(trajectory));
        }
        let regressor = |(signal, trajectories): (&&ScaledSignal, Vec<Vec<f64>>)| Regressor {
            name: signal.signal.clone(),
            unit: signal.unit.text().to_owned(),
            signal: Some((*signal).clone()),
            trajectories,
            may_jump: signal.signal == self.junction.output.signal,
        };
        let mut regressors: Vec<Regressor> = signals.iter().zip(trajectories).map(regressor).collect();
        let is_motion = self.junction.is_motion;
        let rest = is_motion.then(|| Regressor::time_at_rest(&regressors[0], &self.intervals())).flatten();
        regressors.extend(rest);
        Ok(regressors)
    }

    /// The sampling intervals of the training records, in seconds.
    pub(super) fn intervals(&self) -> Vec<f64> {
        self.problem.train.iter().map(|record| record.interval).collect()
    }
}

/// The fraction of a fit's excess of reduced chi-squared that another sum of squares of the same data explains.
pub(super) fn explained_fraction(baseline: &FitResult, chi2: f64) -> f64 {
    1.0 - baseline.excess_reduced_chi2_of(chi2) / baseline.excess_reduced_chi2()
}

/// The basis of an input over time: about `knots` knots at equal distances of a whole number of samples, over all
/// records. Each record is a group, and each knot has a coefficient.
fn time_basis(records: &[Record], knots: usize) -> InputBasis {
    let samples: usize = records.iter().map(Record::len).sum();
    let every = samples.div_ceil(knots).max(MIN_SAMPLES_PER_KNOT);
    let mut groups: Vec<usize> = Vec::new();
    let points = |record: &Record| {
        let count = (record.len() - 1).div_ceil(every) + 1;
        let first: usize = groups.iter().sum();
        groups.push(count);
        let time = |knot: usize| (knot * every) as f64 * record.interval;
        (0..count).map(|knot| (time(knot), vec![(first + knot, 1.0)])).collect()
    };
    let records = records.iter().map(points).collect();
    InputBasis { groups, records }
}

/// The intervals of time in which an input acts. In a window it has one sign and exceeds one standard error and a share
/// of its largest magnitude. At one point at least it exceeds three standard errors. The errors are the conditional
/// ones.
fn windows(points: &[[f64; 4]]) -> Vec<[f64; 2]> {
    let largest = points.iter().fold(0.0, |most: f64, point| most.max(point[1].abs()));
    let mut windows = Vec::new();
    let mut from = 0;
    while from < points.len() {
        let sign = points[from][1].signum();
        let is_inside =
            |[_, input, _, error]: &&[f64; 4]| sign * input > error.max(MIN_SHARE_OF_LARGEST * largest);
        let length = points[from..].iter().take_while(is_inside).count();
        let window = &points[from..from + length];
        if window.iter().any(|[_, input, _, error]| input.abs() > SIGNIFICANT_ERRORS * error) {
            windows.push([window[0][0], window[length - 1][0]]);
        }
        from += length.max(1);
    }
    windows
}
