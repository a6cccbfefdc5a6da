//! A patch as a model of records: it is fed with their drives and read at their samples.
//!
//! A [`FitProgram`] is a patch compiled for fitting: drives that records feed are tables, and initial voltages are
//! parameters. A [`Model`] is that program with the drives of each record. [`Model::run`] returns the outputs for
//! several sets of values in one batch.

use crate::data::drive_timing::RECORD_START;
use crate::data::experiment::{MeasuredDrive, replace_with_tables};
use crate::data::interpolation::table_points;
use crate::data::record::Record;
use crate::effects::graft::unused_name;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Phase, Report};
use patchcord_core::ir::Program;
use patchcord_core::patch::{EditError, ParameterBuilder, Patch};
use patchcord_core::solve;
use patchcord_core::solve::{
    Backend, DriveTableError, MIN_TOLERANCE, Machine, RunError, RunSettings, run_batch,
};
use patchcord_core::trace::{Overload, Trace};

/// A positive range whose ends differ by more than this factor has a logarithmic coordinate.
const LOGARITHMIC_RATIO: f64 = 20.0;

/// The number of programs with different tables that are in memory at the same time.
const TABLE_BATCH: usize = 16;

/// A value that a fit can change: a parameter of the patch with a range.
#[derive(Debug, Clone, PartialEq)]
pub struct FitParameter {
    /// Name of the parameter in the patch.
    pub name: String,
    /// Its value in the patch, in its declared unit. Initial voltages are in V.
    pub value: f64,
    /// The least and the largest value, in the same unit.
    pub range: [f64; 2],
}

impl FitParameter {
    /// The parameter `name` of a patch. `None` if the patch has no such parameter or the parameter has no range.
    fn of(patch: &Patch, name: &str) -> Option<FitParameter> {
        let parameter = patch.parameters.get(name)?;
        let (low, high) = parameter.range?;
        Some(FitParameter { name: name.to_owned(), value: parameter.value, range: [low, high] })
    }

    /// The position of a value in the range: 0 at the least value, 1 at the largest. See [`range_fraction`].
    pub(crate) fn fraction(&self, value: f64) -> f64 {
        range_fraction(self.range, value)
    }

    /// The value at a position in the range; the inverse of [`fraction`](Self::fraction), within the range.
    pub(crate) fn value_at(&self, fraction: f64) -> f64 {
        let [low, high] = self.range;
        let value = if is_logarithmic(self.range) {
            low * libm::pow(high / low, fraction)
        } else {
            low + fraction * (high - low)
        };
        value.clamp(low, high)
    }

    /// The derivative of the value with respect to its position in the range.
    pub(crate) fn slope(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if is_logarithmic(self.range) { value * libm::log(high / low) } else { high - low }
    }
}

/// The position of a value in a range, 0 to 1: ln(value / low) / ln(high / low) if the range is logarithmic, otherwise
/// (value - low) / (high - low). Values outside the range give numbers below 0 or above 1.
pub(crate) fn range_fraction(range: [f64; 2], value: f64) -> f64 {
    let [low, high] = range;
    if is_logarithmic(range) {
        libm::log(value / low) / libm::log(high / low)
    } else {
        (value - low) / (high - low)
    }
}

/// Whether a range is positive and wider than [`LOGARITHMIC_RATIO`].
fn is_logarithmic([low, high]: [f64; 2]) -> bool {
    low > 0.0 && high > LOGARITHMIC_RATIO * low
}

/// A patch compiled for fitting: drives that records feed are tables, and every initial voltage is a parameter.
///
/// All models of one patch are made from one such program, so that they share the code of its kernels.
#[derive(Debug)]
pub struct FitProgram {
    /// The compiled patch, without the data of any record.
    program: Program,
    /// The initial voltages of the integrators and lags of the patch, as parameters of the program.
    initial: Vec<FitParameter>,
    /// The drives that records feed.
    drives: Vec<MeasuredDrive>,
}

impl FitProgram {
    /// Compiles a patch. `drives` specifies the drives that records feed.
    ///
    /// # Errors
    /// If the patch is invalid or has no such drive.
    pub fn new(patch: &Patch, drives: &[MeasuredDrive]) -> Result<FitProgram, ModelError> {
        let (prepared, initial) = prepare_patch(patch, drives)?;
        let program = Program::new(&Circuit::new(&prepared)?)?;
        Ok(FitProgram { program, initial, drives: drives.to_vec() })
    }

    /// Whether the program was compiled for the same drives with the same interpolation.
    pub(crate) fn has_drives(&self, drives: &[MeasuredDrive]) -> bool {
        let mut pairs = self.drives.iter().zip(drives);
        self.drives.len() == drives.len()
            && pairs.all(|(own, other)| own.drive == other.drive && own.hold == other.hold)
    }
}

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
}

/// Why a patch cannot be a model of the records.
#[derive(Debug, thiserror::Error)]
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
    MeasuredDrive(#[from] DriveTableError),
}

/// The outputs of one run: for every output its values at the samples, in the unit of the output.
pub type OutputTrajectory = Vec<Vec<f64>>;

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
        })
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
        }
    }

    /// The same model for the beginnings of its records.
    pub(crate) fn for_beginnings(&self, beginnings: &[Record]) -> Model {
        let settings = self.settings.iter().zip(beginnings);
        let settings =
            settings.map(|(whole, record)| RunSettings { phases: record_phases(record), ..whole.clone() });
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
    /// that are not finite.
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

    /// The first overload of a run along one record. `None` if there is no overload or the run fails.
    pub(crate) fn first_overload(&self, record: usize, values: &RunValues) -> Option<Overload> {
        let program = self.program_with_values(record, values, None)?;
        run_batch(&[program], &self.settings_with_lamps(record)).pop()?.ok()?.overloads().next().cloned()
    }

    /// The settings of a record's runs, with recording of overloads.
    fn settings_with_lamps(&self, record: usize) -> RunSettings {
        RunSettings { lamps: true, ..self.settings[record].clone() }
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
        let is_valid = values.map(|(values, table)| {
            let program = self.program_with_values(record, values, table);
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
                solve::set_curve(program, element, &outputs)
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

/// The integrators and lags of a patch, except those in macros, with their initial voltages in V.
fn initial_voltages(patch: &Patch) -> Result<Vec<(String, f64)>, ModelError> {
    let program = Program::new(&Circuit::new(patch)?)?;
    // The machine is never run. The adaptive one has no step that could be too long for a lag.
    let machine = Machine::adaptive(&program, MIN_TOLERANCE, 1.0)?;
    let states = program.states().into_iter().zip(machine.states());
    let outside_macros = states.filter(|(element, _)| !element.contains('.'));
    Ok(outside_macros.map(|(element, volts)| (element.to_owned(), *volts)).collect())
}

/// The patch with a parameter for every initial voltage and a table for every drive that records feed, and these
/// parameters. Each is named "initial_" and the element and ranges from -100 to 100 V.
fn prepare_patch(patch: &Patch, drives: &[MeasuredDrive]) -> Result<(Patch, Vec<FitParameter>), ModelError> {
    let mut editor = patch.edit();
    let mut initial = Vec::new();
    for (element, value) in initial_voltages(patch)? {
        let word: String =
            element.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
        let is_taken = |name: &str| {
            editor.patch().parameters.contains_key(name) || editor.patch().scales.contains_key(name)
        };
        let name = unused_name(&format!("initial_{word}"), is_taken);
        editor.put_parameter(&name, ParameterBuilder::new(value, "1").range([-100, 100]));
        editor.set_initial(&element, name.as_str())?;
        initial.push(FitParameter { name, value, range: [-100.0, 100.0] });
    }
    replace_with_tables(&mut editor, drives)?;
    Ok((editor.finish(patch.file())?, initial))
}

/// The patch with fitted initial voltages, in V. `initial` contains first those of its integrators and lags, then those
/// of the parameters `initial_states`.
///
/// # Errors
/// If the patch is invalid or a value is not finite.
pub(crate) fn with_initial_voltages(
    patch: &Patch,
    initial_states: &[String],
    initial: &[f64],
) -> Result<Patch, ModelError> {
    let states = initial_voltages(patch)?;
    let mut editor = patch.edit();
    for ((element, _), volts) in states.iter().zip(initial) {
        editor.set_initial(element, *volts)?;
    }
    for (name, volts) in initial_states.iter().zip(initial.iter().skip(states.len())) {
        editor.set_parameter(name, *volts)?;
    }
    Ok(editor.finish(patch.file())?)
}

/// The program with the drives and the start time of a record.
fn program_for_record(
    program: &Program,
    record: &Record,
    drives: &[MeasuredDrive],
) -> Result<Program, ModelError> {
    let mut fed = program.clone();
    for (feed, values) in drives.iter().zip(&record.drives) {
        solve::set_drive_table(&mut fed, &feed.drive, table_points(values, record.interval, feed.hold))?;
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
    RunSettings {
        phases: record_phases(record),
        step: record.interval / f64::from(steps),
        tolerance: None,
        every: record.interval,
        hold_on_overload: false,
        lamps: false,
        record: outputs.to_vec(),
        sensitivities: Vec::new(),
        backend: Backend::default(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn initial_voltages_of_a_lag_do_not_depend_on_its_time_constant() {
        let text = r#"{"patchcord": 1,
            "elements": {"L1": {"kind": "lag", "in": {"x1": ["L1"]}, "time": 1e-6, "initial": 5}},
            "run": {"for": 1e-5, "step": 1e-7}}"#;
        let patch = Patch::parse("quick.json", text).unwrap();
        assert_eq!(initial_voltages(&patch).unwrap(), [("L1".to_owned(), 5.0)]);
    }

    #[test]
    fn a_wide_positive_range_has_a_logarithmic_coordinate() {
        assert!((range_fraction([1.0, 1e8], 50.0) - 50f64.ln() / 1e8f64.ln()).abs() < 1e-12);
        assert!((range_fraction([1e-3, 1e4], 1e-4) + 1.0 / 7.0).abs() < 1e-12);
        assert!((range_fraction([0.0, 1e4], 5e3) - 0.5).abs() < 1e-12);
    }
}
