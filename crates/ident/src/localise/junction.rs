//! The localisation of one junction: the input over time, the curves that may describe it, and the best curve wired in.
//!
//! First the input over time is estimated, with few knots and, if residuals remain, with more. From its normal
//! equations a curve over each regressor follows without further runs. Of the most likely curves at most two are wired
//! in as function generators and fitted again, because a curve acts back on its own regressor. The first that also
//! explains the validation records is reported.

use crate::data::record::Record;
use crate::effects::sites::{Junction, ScaledSignal, Sites};
use crate::fit::estimate::{Estimate, FitResult};
use crate::fit::fitted_model::{FittedModel, ModelVariant};
use crate::fit::levenberg_marquardt::FitProblem;
use crate::fit::model::{ModelError, ReplacedTable, with_initial_voltages};
use crate::fit::problem::Problem;
use crate::fit::schedule::Effort;
use crate::fit::validation::validate;
use crate::localise::evidence::InputPosterior;
use crate::localise::localisation::{EstimatedInput, InputCurve, Localisation};
use crate::localise::recovered::{function_basis, with_function, with_table};
use crate::localise::regressor::Regressor;
use crate::localise::unknown_input::{
    InputBasis, InputFit, InputProblem, InputStart, PERTURBATION, interpolated,
};
use patchcord_core::patch::Patch;

/// The number of knots of an input over time, over all records. The second is used if the first leaves residuals.
const TIME_KNOTS: [usize; 2] = [160, 400];
/// The number of knots of a curve. The second is used if its evidence is clearly larger.
const CURVE_KNOTS: [usize; 2] = [24, 72];
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
/// Fraction that a wired curve must explain of the validation records' excess. Otherwise its evidence must exceed that
/// of the input over time.
const MIN_HELD_OUT: f64 = 0.7;
/// Fraction that a curve must explain of the training records' excess.
const MIN_EXPLAINED: f64 = 0.5;
/// If a wired curve leaves more than this multiple of the excess that it left without feedback, its fit starts again
/// from a coarse curve.
const RESTART_RATIO: f64 = 1.1;
/// If it still leaves more than this multiple, and explains less than [`PHASE_LOCKED_FRACTION`], it counts as diverged.
const DIVERGED_RATIO: f64 = 2.0;
/// Fraction that a curve explains if the model moves in phase with the data.
const PHASE_LOCKED_FRACTION: f64 = 0.8;
/// Fractions of the records from which a diverged curve is fitted in turn.
const RECORD_FRACTIONS: [f64; 6] = [0.1, 0.2, 0.35, 0.55, 0.75, 1.0];
/// Largest number of curves that are wired in. Each takes as long as the input over time.
const MAX_WIRED_CURVES: usize = 2;
/// Least difference of evidence by which a later regressor, more knots, or a curve for each direction is preferred. It
/// is a likelihood ratio of 2e4.
const DECISIVE_EVIDENCE: f64 = 10.0;

/// A curve over a regressor, with the nuisance parameters that belong to it.
struct CandidateCurve {
    /// The curve.
    curve: InputCurve,
    /// Parameters, initial voltages and offsets.
    estimate: Estimate,
}

/// The posterior of a curve over a regressor, or of one for each direction.
struct CurvePosterior {
    /// The number of knots that was requested.
    knot_count: usize,
    /// The knots, including those about zero.
    knots: Vec<f64>,
    /// The posterior of the values at the knots: of one curve, or of the rising and then the falling one.
    posterior: InputPosterior,
}

impl CurvePosterior {
    /// Regressor, input and standard error at every knot. `first` is the index of the curve's first coefficient.
    fn points(&self, first: usize) -> Vec<[f64; 3]> {
        let point = |(index, knot): (usize, &f64)| {
            let variance = self.posterior.covariance[(first + index, first + index)];
            [*knot, self.posterior.coefficients[first + index], variance.max(0.0).sqrt()]
        };
        self.knots.iter().enumerate().map(point).collect()
    }
}

/// A curve that was wired in as a function generator and fitted.
struct WiredCurve {
    /// The patch with the function generator.
    patch: Patch,
    /// The fit to the training records, with feedback.
    fit: InputFit,
    /// The fit of initial voltages and offsets to the validation records.
    validation: FitResult,
}

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
    pub fn localise(&self) -> Result<Option<Localisation>, ModelError> {
        let (patch, drive) = with_table(self.fitted.variant.patch(), self.junction, &[[0.0, 0.0]])?;
        let variant = self.variant(patch);
        let model = self.problem.model(&variant, &self.problem.train, &self.problem.outputs)?;
        let fit_problem = self.problem.fit_problem(&model, &self.problem.train, true);
        let table = ReplacedTable::Drive(&drive);
        let bases = TIME_KNOTS.map(|knots| time_basis(&self.problem.train, knots));
        let Some((basis, fit)) = self.input_over_time(fit_problem, table, &bases) else { return Ok(None) };
        let input_problem = self.input_problem(fit_problem, table, basis);
        let records = 0..self.problem.train.len();
        let inputs: Vec<Vec<[f64; 2]>> =
            records.map(|record| basis.points(record, &fit.coefficients)).collect();
        let regressors = self.regressors(&variant, &drive, &inputs, &fit.estimate)?;
        let candidates = regressors
            .iter()
            .filter_map(|regressor| self.candidate_curve(&input_problem, regressor, &fit, &inputs));
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
                InputProblem { nuisance_spread, ..self.input_problem(fit_problem, table, basis) }
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
    fn noise_chi2(&self) -> f64 {
        NOISE_CHI2_PER_DATUM * self.fitted.train.data_count as f64
    }

    /// A patch with the fitted parameters, and the initial voltages of the first record.
    fn recovered_patch(&self, patch: &Patch, fit: &InputFit) -> Result<Patch, ModelError> {
        let variant = self.variant(patch.clone());
        let fitted = variant.patch_with_values(patch.file(), &fit.estimate.parameters)?;
        with_initial_voltages(&fitted, &self.fitted.variant.initial_states, &fit.estimate.initial[0])
    }

    /// The variant of the fitted model with another patch.
    fn variant(&self, patch: Patch) -> ModelVariant {
        self.fitted.variant.with_patch(patch)
    }

    /// The estimation problem of the input with a basis.
    fn input_problem<'s>(
        &'s self,
        fit_problem: FitProblem<'s>,
        table: ReplacedTable<'s>,
        basis: &'s InputBasis,
    ) -> InputProblem<'s> {
        let (reference, baseline_chi2) = (&self.fitted.train.estimate, self.fitted.train.chi2);
        InputProblem {
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
    fn explained_fraction(&self, chi2: f64) -> f64 {
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
    fn intervals(&self) -> Vec<f64> {
        self.problem.train.iter().map(|record| record.interval).collect()
    }

    /// The input as a curve over a regressor. `None` if the regressor is constant.
    fn candidate_curve(
        &self,
        input_problem: &InputProblem<'_>,
        regressor: &Regressor,
        fit: &InputFit,
        inputs: &[Vec<[f64; 2]>],
    ) -> Option<CandidateCurve> {
        let posterior = |knot_count, by_direction| {
            self.curve_posterior(input_problem.basis, regressor, fit, knot_count, by_direction)
        };
        let is_decisive = |other: &CurvePosterior, simple: &CurvePosterior| {
            other.posterior.evidence > simple.posterior.evidence + DECISIVE_EVIDENCE
        };
        let [few, many] = CURVE_KNOTS;
        let coarse = posterior(few, false)?;
        let fine = posterior(many, false).filter(|fine| is_decisive(fine, &coarse));
        let single = fine.unwrap_or(coarse);
        let double = posterior(single.knot_count, true).filter(|double| is_decisive(double, &single));
        let curve = InputCurve {
            regressor: regressor.name.clone(),
            unit: regressor.unit.clone(),
            points: single.points(0),
            by_direction: double.map(|double| [double.points(0), double.points(double.knots.len())]),
            explained_fraction: self.explained_fraction(single.posterior.chi2),
            evidence: single.posterior.evidence,
            held_out: None,
            scatter: self.scatter(regressor, inputs),
        };
        let estimate = input_problem.nuisance_estimate(fit, &single.posterior);
        Some(CandidateCurve { curve, estimate })
    }

    /// The posterior of a curve with about `knot_count` knots, or of one for each direction of the regressor.
    fn curve_posterior(
        &self,
        basis: &InputBasis,
        regressor: &Regressor,
        fit: &InputFit,
        knot_count: usize,
        by_direction: bool,
    ) -> Option<CurvePosterior> {
        let knots = regressor.knots(knot_count)?;
        let weights = regressor.curve_weights(basis, &knots, by_direction, &self.intervals());
        let groups = vec![knots.len(); weights.ncols() / knots.len()];
        let posterior = fit.equations.in_basis(&weights, groups).solve()?;
        Some(CurvePosterior { knot_count, posterior, knots })
    }

    /// Pairs of regressor and input at the knots of the input over time.
    fn scatter(&self, regressor: &Regressor, inputs: &[Vec<[f64; 2]>]) -> Vec<[f64; 2]> {
        let records = inputs.iter().zip(self.intervals()).enumerate();
        let points = records.flat_map(|(record, (points, interval))| {
            points.iter().map(move |[time, input]| [regressor.value_at(record, *time, interval), *input])
        });
        points.collect()
    }

    /// The curve that describes the input: its index, and the wired curve if it could be wired in.
    ///
    /// The most likely curves are wired in. The first that explains the validation records wins. A curve that cannot be
    /// wired in wins if it is more likely than the input over time.
    fn best_curve(
        &self,
        candidates: &mut [CandidateCurve],
        regressors: &[Regressor],
        over_time: &InputFit,
    ) -> Option<(usize, Option<WiredCurve>)> {
        let is_explaining = |index: &usize| candidates[*index].curve.explained_fraction > MIN_EXPLAINED;
        let mut open: Vec<usize> = (0..candidates.len()).filter(is_explaining).collect();
        for _ in 0..MAX_WIRED_CURVES {
            let more_likely = |best: usize, other: usize| {
                let [best_evidence, evidence] = [best, other].map(|index| candidates[index].curve.evidence);
                if evidence > best_evidence + DECISIVE_EVIDENCE { other } else { best }
            };
            let Some(index) = open.iter().copied().reduce(more_likely) else { break };
            open.retain(|other| *other != index);
            let CandidateCurve { curve, estimate } = &mut candidates[index];
            let regressor = regressors.iter().find(|regressor| regressor.name == curve.regressor);
            let signal = regressor.and_then(|regressor| regressor.signal.as_ref());
            // A curve beyond the range of the machine cannot be wired in.
            let wired = signal.and_then(|signal| self.wired_curve(signal, curve, estimate).ok().flatten());
            let Some(wired) = wired else {
                if curve.evidence > over_time.evidence {
                    return Some((index, None));
                }
                continue;
            };
            let held_out = explained_fraction(&self.fitted.test, wired.validation.chi2);
            curve.held_out = Some(held_out);
            if held_out > MIN_HELD_OUT || (held_out > 0.0 && curve.evidence > over_time.evidence) {
                // The curves by direction remain those of the input over time.
                curve.explained_fraction = self.explained_fraction(wired.fit.chi2);
                let values = wired.fit.coefficients.iter().zip(&wired.fit.errors);
                let points = curve.points.iter_mut().zip(values);
                points.for_each(|(point, (value, error))| *point = [point[0], *value, *error]);
                return Some((index, Some(wired)));
            }
        }
        None
    }

    /// Whether a wired curve leaves more than `ratio` times the excess that it left without feedback.
    fn leaves_more(&self, wired: &InputFit, curve: &InputCurve, ratio: f64) -> bool {
        let leaves_excess = wired.chi2 > self.noise_chi2();
        leaves_excess && 1.0 - self.explained_fraction(wired.chi2) > ratio * (1.0 - curve.explained_fraction)
    }

    /// Whether the model with a wired curve is out of phase with the data: it leaves far more than expected, and much.
    fn is_diverged(&self, wired: &InputFit, curve: &InputCurve) -> bool {
        self.leaves_more(wired, curve, DIVERGED_RATIO)
            && self.explained_fraction(wired.chi2) < PHASE_LOCKED_FRACTION
    }

    /// Wires a curve in as a function generator of a signal, and fits it again with its feedback. `None` if no fit
    /// succeeds or the validation records cannot be run.
    ///
    /// The fit starts from the curve. If that leaves too much, it also starts from a coarse curve, and then from
    /// growing beginnings of the records. The least sum of squares wins.
    fn wired_curve(
        &self,
        signal: &ScaledSignal,
        curve: &InputCurve,
        estimate: &Estimate,
    ) -> Result<Option<WiredCurve>, ModelError> {
        let column = |index: usize| curve.points.iter().map(|point| point[index]).collect::<Vec<f64>>();
        let (knots, values) = (column(0), column(1));
        let basis = function_basis(&knots, self.junction, signal, self.problem.train.len());
        let wire = |values: &[f64]| {
            let points = basis.points(0, values);
            with_function(self.fitted.variant.patch(), self.junction, signal, &points)
        };
        let (patch, element) = wire(&values)?;
        let variant = self.variant(patch);
        let model = self.problem.model(&variant, &self.problem.train, &self.problem.outputs)?;
        let fit_problem = self.problem.fit_problem(&model, &self.problem.train, true);
        let input_problem = self.input_problem(fit_problem, ReplacedTable::Curve(&element), &basis);
        let from_curve = InputStart { estimate, coefficients: Some(&values) };
        let from_zero = InputStart { estimate: &self.fitted.train.estimate, coefficients: None };
        let mut fit = input_problem.solve(&from_curve);
        let by_chi2 = |a: &InputFit, b: &InputFit| a.chi2.total_cmp(&b.chi2);
        if fit.as_ref().is_none_or(|fit| self.leaves_more(fit, curve, RESTART_RATIO)) {
            let kept = outline(&knots);
            let coarse_basis = basis.coarsened(&kept);
            let coarse = InputProblem { basis: &coarse_basis, ..input_problem }.solve(&from_zero);
            let coarse =
                coarse.map(|fit| (interpolated(&kept, &fit.coefficients, knots.len()), fit.estimate));
            let start = coarse
                .as_ref()
                .map(|(coefficients, estimate)| InputStart { estimate, coefficients: Some(coefficients) });
            fit = fit.into_iter().chain(input_problem.solve(&start.unwrap_or(from_zero))).min_by(by_chi2);
        }
        if fit.as_ref().is_none_or(|fit| self.is_diverged(fit, curve)) {
            fit = fit.into_iter().chain(input_problem.solve_progressively(&RECORD_FRACTIONS)).min_by(by_chi2);
        }
        let Some(fit) = fit else { return Ok(None) };
        let (patch, _) = wire(&fit.coefficients)?;
        let variant = self.variant(patch);
        let validation = validate(
            self.problem,
            &variant,
            &fit.estimate,
            Some(&self.fitted.test.estimate.initial),
            Effort::FULL,
        )?;
        Ok(validation.map(|validation| WiredCurve { patch: variant.patch().clone(), fit, validation }))
    }
}

/// Indices of the knots of a coarse curve: the ends, those about zero, and one between each of these.
fn outline(knots: &[f64]) -> Vec<usize> {
    let last = knots.len() - 1;
    let zero = knots.partition_point(|knot| *knot < 0.0).clamp(1, last);
    let mut kept = vec![0, (zero - 1) / 2, zero - 1, zero, (zero + last) / 2, last];
    kept.dedup();
    kept
}

/// The fraction of a fit's excess of reduced chi-squared that another sum of squares of the same data explains.
fn explained_fraction(baseline: &FitResult, chi2: f64) -> f64 {
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
