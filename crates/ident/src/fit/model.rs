//! A patch as a model of records: it is fed with their drives and read at their samples.
//!
//! A [`FitProgram`] is a patch compiled for fitting: drives that records feed are tables, and initial voltages are
//! parameters. A [`Model`] is that program with the drives of each record. [`Model::run`] returns the outputs for
//! several sets of values in one batch. After a cancellation all runs fail.

mod fit_parameter;
mod fit_program;

use crate::data::drive_timing::RECORD_START;
use crate::data::experiment::MeasuredDrive;
use crate::data::interpolation::table_points;
use crate::data::record::Record;
use crate::fit::cancellation::Cancellation;
use patchcord_core::document::{Phase, Report};
use patchcord_core::ir::Program;
use patchcord_core::patch::{EditError, Patch};
use patchcord_core::solve::{self, DriveTableError, RunError, RunSettings, run_batch};
use patchcord_core::trace::{Overload, Trace};

pub use fit_parameter::FitParameter;
pub(crate) use fit_parameter::range_fraction;
pub use fit_program::FitProgram;
pub(crate) use fit_program::with_initial_voltages;

/// The number of programs with different tables that are in memory at the same time.
const TABLE_BATCH: usize = 16;

/// A patch that is ready to be run along records.
#[derive(Debug, Clone)]
pub struct Model {
    /// For every record the program with the record's drives.
    programs: Vec<Program>,
    /// For every record the settings of its runs.
    settings: Vec<RunSettings>,
    /// The fitted parameters.
    pub parameters: Vec<FitParameter>,
    /// The initial voltages of integrators and lags, and parameters that are such voltages. They are fitted for each
    /// record separately.
    pub initial: Vec<FitParameter>,
    /// Names of the signals that runs return.
    outputs: Vec<String>,
    /// For every record the number of samples.
    sample_counts: Vec<usize>,
    /// Ends all runs.
    cancellation: Cancellation,
}

/// Why a patch cannot be a model of the records.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// A change of the patch failed.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The patch is invalid.
    #[error(transparent)]
    Patch(#[from] Box<Report>),
    /// The patch cannot be compiled or run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A record cannot feed a drive.
    #[error(transparent)]
    DriveTable(#[from] DriveTableError),
    /// The flag of `Problem::with_cancel` was set.
    #[error("cancelled")]
    Cancelled,
}

/// The outputs of one run: for every output its values at the samples, in the unit of the output.
pub type OutputTrajectory = Vec<Vec<f64>>;

/// A record, simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRecord {
    /// For every output of the experiment its values at the samples of the record, in the unit of the output. If the
    /// run stops early, the later values are NaN.
    pub outputs: OutputTrajectory,
    /// The first overload, with its time in seconds from the first sample of the record. None if no amplifier is
    /// overloaded.
    pub overload: Option<Overload>,
    /// Why the run stopped early. None if it is complete.
    pub stopped: Option<RunError>,
}

impl Model {
    /// A model of `records`.
    ///
    /// `program` is compiled from `patch`. `fit` names the fitted parameters. `initial_states` names the parameters
    /// that are initial voltages. `outputs` names the signals that runs return. The solver makes `steps` steps per
    /// sample.
    ///
    /// # Errors
    /// If a record cannot feed the program.
    pub fn new(
        program: &FitProgram,
        patch: &Patch,
        records: &[Record],
        fit: &[String],
        initial_states: &[String],
        outputs: &[String],
        steps: u32,
    ) -> Result<Model, ModelError> {
        let mut initial = program.initial.clone();
        initial.extend(initial_states.iter().filter_map(|name| FitParameter::of(patch, name)));
        let programs =
            records.iter().map(|record| program_for_record(&program.program, record, &program.drives));
        Ok(Model {
            programs: programs.collect::<Result<_, _>>()?,
            settings: records.iter().map(|record| run_settings(record, outputs, steps)).collect(),
            parameters: fit.iter().filter_map(|name| FitParameter::of(patch, name)).collect(),
            initial,
            outputs: outputs.to_vec(),
            sample_counts: records.iter().map(Record::len).collect(),
            cancellation: Cancellation::default(),
        })
    }

    /// The same model, whose runs a cancellation ends.
    pub(super) fn with_cancellation(self, cancellation: &Cancellation) -> Model {
        Model { cancellation: cancellation.clone(), ..self }
    }

    /// The same model for one of its records.
    pub(crate) fn for_record(&self, record: usize) -> Model {
        Model {
            programs: vec![self.programs[record].clone()],
            settings: vec![self.settings[record].clone()],
            parameters: self.parameters.clone(),
            initial: self.initial.clone(),
            outputs: self.outputs.clone(),
            sample_counts: vec![self.sample_counts[record]],
            cancellation: self.cancellation.clone(),
        }
    }

    /// The same model for the beginnings of its records.
    pub(crate) fn for_beginnings(&self, beginnings: &[Record]) -> Model {
        let settings = self.settings.iter().zip(beginnings);
        let settings = settings.map(|(whole, record)| whole.clone().with_phases(record_phases(record)));
        Model {
            settings: settings.collect(),
            sample_counts: beginnings.iter().map(Record::len).collect(),
            ..self.clone()
        }
    }

    /// The number of records.
    pub fn record_count(&self) -> usize {
        self.programs.len()
    }

    /// Whether a batch of runs takes less time than the same runs one after the other.
    pub fn is_faster_batched(&self) -> bool {
        self.programs.iter().zip(&self.settings).all(|(program, settings)| settings.is_batchable(program))
    }

    /// Runs one record with several sets of values, in one batch. `None` for a run that stopped early or has values
    /// that are not finite, and for all runs after a cancellation.
    pub fn run(&self, record: usize, values: &[RunValues]) -> Vec<Option<OutputTrajectory>> {
        self.run_batch(record, &self.settings[record], values.iter().map(|values| (values, None)), |_| true)
    }

    /// Like [`run`](Self::run), but also `None` for a run in which an amplifier is overloaded.
    pub(crate) fn run_without_overload(
        &self,
        record: usize,
        values: &[RunValues],
    ) -> Vec<Option<OutputTrajectory>> {
        let has_no_overload = |trace: &Trace| trace.overloads().next().is_none();
        let settings = self.settings_with_lamps(record);
        self.run_batch(record, &settings, values.iter().map(|values| (values, None)), has_no_overload)
    }

    /// Like [`run`](Self::run), with other points of one table for each set of values.
    pub(crate) fn run_with_tables(
        &self,
        record: usize,
        table: ReplacedTable<'_>,
        values: &[(RunValues, Vec<[f64; 2]>)],
    ) -> Vec<Option<OutputTrajectory>> {
        let runs = values.chunks(TABLE_BATCH).flat_map(|batch| {
            let batch = batch.iter().map(|(values, points)| (values, Some((table, points.as_slice()))));
            self.run_batch(record, &self.settings[record], batch, |_| true)
        });
        runs.collect()
    }

    /// Runs one record with changed parameters: names and values in declared units.
    ///
    /// # Errors
    /// If a parameter is unknown or outside its range, or the run cannot begin.
    pub(super) fn simulate(
        &self,
        record: usize,
        changes: &[(String, f64)],
    ) -> Result<SimulatedRecord, ModelError> {
        let mut program = self.programs[record].clone();
        let changes = changes.iter().map(|(name, value)| (name, *value));
        program.set_parameters(changes).map_err(RunError::from)?;
        let (trace, stopped) = match solve::run(&program, &self.settings_with_lamps(record)) {
            Ok(trace) => (trace, None),
            Err(stopped) if stopped.trace.is_empty() => return Err(stopped.error.into()),
            Err(stopped) => (*stopped.trace, Some(stopped.error)),
        };
        let output_values = |name: &String| {
            let mut values = trace.values(name).unwrap_or_default();
            values.resize(self.sample_counts[record], f64::NAN);
            values
        };
        let outputs = self.outputs.iter().map(output_values).collect();
        Ok(SimulatedRecord { outputs, overload: trace.overloads().next().cloned(), stopped })
    }

    /// The first overload of a run along one record. `None` if there is no overload or the run fails.
    pub(crate) fn first_overload(&self, record: usize, values: &RunValues) -> Option<Overload> {
        if self.cancellation.is_requested() {
            return None;
        }
        let program = self.program_with_values(record, values, None)?;
        run_batch(&[program], &self.settings_with_lamps(record)).pop()?.ok()?.overloads().next().cloned()
    }

    /// The settings of a record's runs, with recording of overloads.
    fn settings_with_lamps(&self, record: usize) -> RunSettings {
        self.settings[record].clone().with_lamps()
    }

    /// Runs one record with several sets of values, each with optional points of a table. `None` for a run that fails
    /// or whose trace `is_accepted` rejects.
    fn run_batch<'c>(
        &self,
        record: usize,
        settings: &RunSettings,
        values: impl Iterator<Item = (&'c RunValues, Option<(ReplacedTable<'c>, &'c [[f64; 2]])>)>,
        is_accepted: impl Fn(&Trace) -> bool,
    ) -> Vec<Option<OutputTrajectory>> {
        let mut programs = Vec::new();
        let is_cancelled = self.cancellation.is_requested();
        let is_valid = values.map(|(values, table)| {
            let program = if is_cancelled { None } else { self.program_with_values(record, values, table) };
            let is_valid = program.is_some();
            programs.extend(program);
            is_valid
        });
        let is_valid: Vec<bool> = is_valid.collect();
        let mut traces = run_batch(&programs, settings).into_iter();
        let trajectory = |trace: Trace| self.trajectory(record, &trace).filter(|_| is_accepted(&trace));
        is_valid
            .into_iter()
            .map(|is_valid| is_valid.then(|| traces.next()?.ok().and_then(trajectory)).flatten())
            .collect()
    }

    /// The program of a record with these values and, if given, these points of a table. `None` if the program rejects
    /// them.
    fn program_with_values(
        &self,
        record: usize,
        values: &RunValues,
        table: Option<(ReplacedTable<'_>, &[[f64; 2]])>,
    ) -> Option<Program> {
        let mut program = self.programs[record].clone();
        let parameters = self.parameters.iter().zip(&values.parameters);
        let initial = self.initial.iter().zip(&values.initial);
        let changes: Vec<_> =
            parameters.chain(initial).map(|(parameter, value)| (parameter.name.as_str(), *value)).collect();
        let is_table_set = table.is_none_or(|(table, points)| table.set_points(&mut program, points));
        (is_table_set && program.set_parameters(changes).is_ok()).then_some(program)
    }

    /// The outputs of a run at the samples of its record. `None` if the trace is too short or a value is not finite.
    fn trajectory(&self, record: usize, trace: &Trace) -> Option<OutputTrajectory> {
        let count = self.sample_counts[record];
        let output_values = |name: &String| {
            let values: Vec<f64> = trace.track(name)?.values().take(count).collect();
            let is_complete = values.len() == count && values.iter().all(|value| value.is_finite());
            is_complete.then_some(values)
        };
        self.outputs.iter().map(output_values).collect()
    }
}

/// A table of the patch whose points differ from run to run.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ReplacedTable<'a> {
    /// The table of the drive with this name: time in seconds, value in the unit of the drive's scale.
    Drive(&'a str),
    /// The table of the function generator with this name, in V. Only the outputs of the points are replaced.
    Curve(&'a str),
}

impl ReplacedTable<'_> {
    /// Sets the points of the table in a program. False if the program rejects them.
    fn set_points(self, program: &mut Program, points: &[[f64; 2]]) -> bool {
        match self {
            ReplacedTable::Drive(drive) => solve::set_drive_table(program, drive, points.to_vec()).is_ok(),
            ReplacedTable::Curve(element) => {
                let outputs: Vec<f64> = points.iter().map(|point| point[1]).collect();
                solve::set_curve(program, element, &outputs).is_ok()
            }
        }
    }
}

/// The values that one run along a record needs.
#[derive(Debug, Clone, PartialEq)]
pub struct RunValues {
    /// Values of the fitted parameters, in declared units, in the order of [`Model::parameters`].
    pub parameters: Vec<f64>,
    /// Initial voltages, in V, in the order of [`Model::initial`].
    pub initial: Vec<f64>,
}

/// The program with the drives and the start time of a record.
fn program_for_record(
    program: &Program,
    record: &Record,
    drives: &[MeasuredDrive],
) -> Result<Program, ModelError> {
    let mut fed = program.clone();
    for (drive, values) in drives.iter().zip(&record.drives) {
        solve::set_drive_table(&mut fed, &drive.drive, table_points(values, record.interval, drive.hold))?;
    }
    if fed.parameter(RECORD_START).is_some() {
        fed.set_parameters([(RECORD_START, record.start_in_file)]).map_err(RunError::from)?;
    }
    Ok(fed)
}

/// The phases of a run from the first sample of a record to the last.
fn record_phases(record: &Record) -> Vec<Phase> {
    vec![Phase::InitialCondition, Phase::operate(record.duration())]
}

/// The settings of a run along a record: fixed steps, `steps` per sample, and one recorded value per sample.
fn run_settings(record: &Record, outputs: &[String], steps: u32) -> RunSettings {
    RunSettings::from_phases(record_phases(record), record.interval / f64::from(steps))
        .with_sample_interval(record.interval)
        .without_lamps()
        .with_signals(outputs)
}
