//! The identification problem: the records to fit, the records to validate with, and the noise of both.
//!
//! A [`Problem`] contains everything about the data that a fit needs and nothing about the patch. It makes the
//! [`Model`] and the [`FitProblem`] of any variant of the patch, so that all variants are fitted to the same data.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use crate::data::experiment::MeasuredDrive;
use crate::data::record::Record;
use crate::fit::cancellation::Cancellation;
use crate::fit::estimate::Estimate;
use crate::fit::fitted_model::ModelVariant;
use crate::fit::levenberg_marquardt::{CONVERGENCE_RATIO, DampingSchedule, FitProblem, MAX_ITERATIONS};
use crate::fit::model::{Model, ModelError};

/// The data that a patch is compared with.
///
/// # Examples
///
/// ```
/// use patchcord_ident::{Experiment, Problem};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let problem = Problem::of(&experiment)?;
/// assert_eq!(problem.outputs, ["x"]);
///
/// // The experiment does not specify the noise of x. It is 0.5 mm rms, and it is estimated from the samples.
/// assert!((0.35..0.7).contains(&problem.sigma[0]));
/// assert!(problem.drives.is_empty() && !problem.is_cut);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Problem {
    /// The drives that the records feed.
    pub drives: Vec<MeasuredDrive>,
    /// Standard deviation of the noise of each drive, in the unit of the drive. 0 if the drive has no noise.
    pub drive_sigma: Vec<f64>,
    /// Names of the signals that the records contain.
    pub outputs: Vec<String>,
    /// Standard deviation of the noise of each output, in the unit of the output. All residuals are divided by it.
    pub sigma: Vec<f64>,
    /// Whether each output may differ from the model by a constant, which is then fitted.
    pub has_offset: Vec<bool>,
    /// The training records: all parameters are fitted to them.
    pub train: Vec<Record>,
    /// The training records cut into pieces. Each piece has its own initial voltages, so that errors grow less.
    pub pieces: Vec<Record>,
    /// The number of pieces per training record, if the record is long enough.
    pub(crate) pieces_per_record: usize,
    /// The validation records: only initial voltages and offsets are fitted to them.
    pub validation: Vec<Record>,
    /// Whether `train` and `validation` are already cut into pieces, as the experiment specifies.
    pub is_cut: bool,
    /// Solver steps per sample that are sufficient for the patch as it is.
    pub steps: u32,
    /// Ends the runs of all models of this problem.
    pub(crate) cancellation: Cancellation,
}

/// The least number of samples of a piece. A record with fewer than twice as many samples is not cut.
const MIN_PIECE_SAMPLES: usize = 40;

impl Problem {
    /// The same problem with a flag that cancels its fits and searches. When the flag becomes true, they end after the
    /// present run of the patch with [`ModelError::Cancelled`].
    ///
    /// # Examples
    ///
    /// ```no_run
    /// use std::sync::Arc;
    /// use std::sync::atomic::{AtomicBool, Ordering};
    ///
    /// use patchcord_ident::{Experiment, Library, ModelError, Problem, SearchSettings, search};
    ///
    /// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
    /// let cancel = Arc::new(AtomicBool::new(false));
    /// let (problem, library) = (Problem::of(&experiment)?.with_cancel(&cancel), Library::shipped());
    /// // The search is cancelled after its first trial.
    /// let outcome = search(&experiment, &problem, &SearchSettings::new(&library), |progress| {
    ///     cancel.fetch_or(progress.trial.is_some(), Ordering::Relaxed);
    /// });
    /// assert!(matches!(outcome, Err(ModelError::Cancelled)));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_cancel(self, flag: &Arc<AtomicBool>) -> Problem {
        Problem { cancellation: Cancellation::by(flag), ..self }
    }

    /// The values of one output in the model: data - sigma * residual. NaN if a datum is missing.
    pub(crate) fn model_output(&self, record: &Record, residuals: &[Vec<f64>], output: usize) -> Vec<f64> {
        let sigma = self.sigma[output];
        record.outputs[output]
            .iter()
            .zip(&residuals[output])
            .map(|(datum, residual)| datum - sigma * residual)
            .collect()
    }

    /// The model of a variant: it runs along `records` and returns the signals `outputs`.
    ///
    /// # Errors
    /// If the patch cannot be compiled, a record cannot feed it, or the fit or search is cancelled.
    pub(crate) fn model(
        &self,
        variant: &ModelVariant,
        records: &[Record],
        outputs: &[String],
    ) -> Result<Model, ModelError> {
        self.cancellation.check()?;
        let program = variant.fit_program(&self.drives)?;
        let model = Model::new(
            &program,
            variant.patch(),
            records,
            &variant.fit,
            &variant.initial_states,
            outputs,
            variant.steps,
        )?;
        Ok(model.with_cancellation(&self.cancellation))
    }

    /// The least-squares problem of a model and its records, with default settings.
    ///
    /// If `fits_parameters` is false, only initial voltages and offsets are fitted.
    pub(crate) fn fit_problem<'a>(
        &'a self,
        model: &'a Model,
        records: &'a [Record],
        fits_parameters: bool,
    ) -> FitProblem<'a> {
        let (sigma, has_offset) = (&self.sigma, &self.has_offset);
        FitProblem {
            model,
            records,
            sigma,
            has_offset,
            fits_parameters,
            fixed_parameter: None,
            target_chi2: f64::INFINITY,
            max_iterations: MAX_ITERATIONS,
            convergence_ratio: CONVERGENCE_RATIO,
            damping_schedule: if model.is_faster_batched() {
                DampingSchedule::PARALLEL
            } else {
                DampingSchedule::SEQUENTIAL
            },
        }
    }

    /// Converts an estimate for the pieces to one for the whole records: each record begins as its first piece does.
    pub(crate) fn join_pieces(&self, estimate: &Estimate) -> Estimate {
        let mut first_piece = 0;
        let initial = self.train.iter().map(|record| {
            let voltages = estimate.initial[first_piece].clone();
            first_piece += record.split(self.pieces_per_record, MIN_PIECE_SAMPLES).len();
            voltages
        });
        Estimate { initial: initial.collect(), ..estimate.clone() }
    }
}

/// Cuts each record into `count` pieces, or fewer if a piece would be shorter than [`MIN_PIECE_SAMPLES`].
pub(crate) fn cut_records(records: &[Record], count: usize) -> Vec<Record> {
    records.iter().flat_map(|record| record.split(count, MIN_PIECE_SAMPLES)).collect()
}
