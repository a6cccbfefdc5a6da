//! A patch as a model of records: fed with their drives, begun where its parameters say, read at their samples.

use crate::data::drive_timing::RECORD_START;
use crate::data::experiment::{Feed, put_tables};
use crate::data::interpolation::points;
use crate::data::record::Record;
use crate::effects::graft::own_name;
use patchcord_core::circuit::Circuit;
use patchcord_core::document::{Phase, Report};
use patchcord_core::ir::Program;
use patchcord_core::patch::{EditError, ParameterBuilder, Patch};
use patchcord_core::solve;
use patchcord_core::solve::{
    Backend, DriveTableError, LEAST_TOLERANCE, Machine, RunError, RunSettings, run_abreast,
};
use patchcord_core::trace::{Overload, Trace};

/// Ranges above 0 whose ends differ by more than this factor are gone through by factors.
const WIDE: f64 = 20.0;

/// So many programs with tables of their own are held at once.
const TABLED: usize = 16;

/// A value that can be turned while a model is fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Knob {
    /// The parameter of the patch.
    pub name: String,
    /// Where it stands in the patch.
    pub value: f64,
    /// Least and largest value.
    pub range: [f64; 2],
}

impl Knob {
    /// A parameter of a patch that has a range.
    fn of(patch: &Patch, name: &str) -> Option<Knob> {
        let parameter = patch.parameters.get(name)?;
        let (low, high) = parameter.range?;
        Some(Knob { name: name.to_owned(), value: parameter.value, range: [low, high] })
    }

    /// A value as a share of the way from the least to the largest.
    pub(crate) fn share(&self, value: f64) -> f64 {
        share(self.range, value)
    }

    /// The value at a share of the way.
    pub(crate) fn at(&self, share: f64) -> f64 {
        let [low, high] = self.range;
        let value =
            if is_wide(self.range) { low * libm::pow(high / low, share) } else { low + share * (high - low) };
        value.clamp(low, high)
    }

    /// The derivative of the value by its share of the way.
    pub(crate) fn slope(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        if is_wide(self.range) { value * libm::log(high / low) } else { high - low }
    }
}

/// A value as a share of the way through a range: by factors where that is wide.
pub(crate) fn share(range: [f64; 2], value: f64) -> f64 {
    let [low, high] = range;
    if is_wide(range) { libm::log(value / low) / libm::log(high / low) } else { (value - low) / (high - low) }
}

fn is_wide([low, high]: [f64; 2]) -> bool {
    low > 0.0 && high > WIDE * low
}

/// A patch lowered for fitting: drives that records feed are tables, and every initial voltage is a parameter. All models of one
/// patch are made from one such program, so that they share the code of its kernels.
#[derive(Debug)]
pub struct FitProgram {
    program: Program,
    /// The initial voltages of the integrators and lags of the patch, as parameters of the program.
    initial: Vec<Knob>,
    drives: Vec<Feed>,
}

impl FitProgram {
    /// Lowers a patch; `drives` name what records feed.
    ///
    /// # Errors
    /// When the patch is wrong, or has no such drive.
    pub fn new(patch: &Patch, drives: &[Feed]) -> Result<FitProgram, ModelError> {
        let (prepared, initial) = prepared(patch, drives)?;
        let program = Program::new(&Circuit::new(&prepared, &[])?)?;
        Ok(FitProgram { program, initial, drives: drives.to_vec() })
    }

    /// Whether records feed these drives, held as they say.
    pub(crate) fn is_for(&self, drives: &[Feed]) -> bool {
        let mut pairs = self.drives.iter().zip(drives);
        self.drives.len() == drives.len()
            && pairs.all(|(own, other)| own.drive == other.drive && own.hold == other.hold)
    }
}

/// A patch ready to be run beside records.
#[derive(Debug, Clone)]
pub struct Model {
    /// Of every record the program with its drives.
    programs: Vec<Program>,
    /// How each is run.
    settings: Vec<RunSettings>,
    /// What is fitted.
    pub knobs: Vec<Knob>,
    /// The initial voltages of integrators and lags, by record free.
    pub initial: Vec<Knob>,
    /// Names of the signals compared with data.
    outputs: Vec<String>,
    samples: Vec<usize>,
}

/// Why a patch is no model.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// It cannot be changed so.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// It is wrong.
    #[error(transparent)]
    Patch(#[from] Box<Report>),
    /// It cannot be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A record cannot feed it.
    #[error(transparent)]
    Feed(#[from] DriveTableError),
}

/// What a run gives: of every output its values at the samples.
pub type Course = Vec<Vec<f64>>;

impl Model {
    /// A patch as a model of records; `lowered` is its program, `fit` what may be turned, `free` the parameters that are initial
    /// voltages, `outputs` what is read. Each sample takes so many steps.
    ///
    /// # Errors
    /// When a record cannot feed the program.
    pub fn new(
        lowered: &FitProgram,
        patch: &Patch,
        records: &[Record],
        fit: &[String],
        free: &[String],
        outputs: &[String],
        steps: u32,
    ) -> Result<Model, ModelError> {
        let mut initial = lowered.initial.clone();
        initial.extend(free.iter().filter_map(|name| Knob::of(patch, name)));
        let programs = records.iter().map(|record| fed(&lowered.program, record, &lowered.drives));
        Ok(Model {
            programs: programs.collect::<Result<_, _>>()?,
            settings: records.iter().map(|record| plan(record, outputs, steps)).collect(),
            knobs: fit.iter().filter_map(|name| Knob::of(patch, name)).collect(),
            initial,
            outputs: outputs.to_vec(),
            samples: records.iter().map(Record::len).collect(),
        })
    }

    /// The same beside one of its records.
    pub(crate) fn alone(&self, record: usize) -> Model {
        Model {
            programs: vec![self.programs[record].clone()],
            settings: vec![self.settings[record].clone()],
            knobs: self.knobs.clone(),
            initial: self.initial.clone(),
            outputs: self.outputs.clone(),
            samples: vec![self.samples[record]],
        }
    }

    /// The same beside the beginnings of its records.
    pub(crate) fn beside(&self, beginnings: &[Record]) -> Model {
        let settings = self.settings.iter().zip(beginnings);
        let settings = settings.map(|(own, record)| RunSettings { phases: phases(record), ..own.clone() });
        Model {
            settings: settings.collect(),
            samples: beginnings.iter().map(Record::len).collect(),
            ..self.clone()
        }
    }

    /// How many records there are.
    pub fn records(&self) -> usize {
        self.programs.len()
    }

    /// Whether runs side by side take less time than one after the other.
    pub fn goes_abreast(&self) -> bool {
        self.programs.iter().zip(&self.settings).all(|(program, settings)| settings.go_abreast(program))
    }

    /// Runs one record with several choices of knobs and initial voltages, side by side; nothing where a run had to stop.
    pub fn run(&self, record: usize, choices: &[Choice]) -> Vec<Option<Course>> {
        self.run_each(record, &self.settings[record], choices.iter().map(|choice| (choice, None)), |_| true)
    }

    /// The same, and nothing where an amplifier is overloaded.
    pub(crate) fn run_within_range(&self, record: usize, choices: &[Choice]) -> Vec<Option<Course>> {
        let is_within = |trace: &Trace| trace.overloads().next().is_none();
        let settings = self.with_lamps(record);
        self.run_each(record, &settings, choices.iter().map(|choice| (choice, None)), is_within)
    }

    /// The same with points of a table for each choice.
    pub(crate) fn run_tabled(
        &self,
        record: usize,
        table: Table<'_>,
        choices: &[(Choice, Vec<[f64; 2]>)],
    ) -> Vec<Option<Course>> {
        let runs = choices.chunks(TABLED).flat_map(|some| {
            let some = some.iter().map(|(choice, points)| (choice, Some((table, points.as_slice()))));
            self.run_each(record, &self.settings[record], some, |_| true)
        });
        runs.collect()
    }

    /// The first overload of a record's run; nothing where there is none, or no run.
    pub(crate) fn overload(&self, record: usize, choice: &Choice) -> Option<Overload> {
        let own = self.set_to(record, choice, None)?;
        run_abreast(&[own], &self.with_lamps(record)).pop()?.ok()?.overloads().next().cloned()
    }

    fn with_lamps(&self, record: usize) -> RunSettings {
        RunSettings { lamps: true, ..self.settings[record].clone() }
    }

    fn run_each<'c>(
        &self,
        record: usize,
        settings: &RunSettings,
        choices: impl Iterator<Item = (&'c Choice, Option<(Table<'c>, &'c [[f64; 2]])>)>,
        counts: impl Fn(&Trace) -> bool,
    ) -> Vec<Option<Course>> {
        let mut ready = Vec::new();
        let set = choices.map(|(choice, tabled)| {
            let own = self.set_to(record, choice, tabled);
            let is_set = own.is_some();
            ready.extend(own);
            is_set
        });
        let set: Vec<bool> = set.collect();
        let mut ended = run_abreast(&ready, settings).into_iter();
        let course = |trace: Trace| self.course(record, &trace).filter(|_| counts(&trace));
        set.into_iter().map(|is_set| is_set.then(|| ended.next()?.ok().and_then(course)).flatten()).collect()
    }

    /// The program of a record with these values; nothing where it cannot have them.
    fn set_to(
        &self,
        record: usize,
        choice: &Choice,
        tabled: Option<(Table<'_>, &[[f64; 2]])>,
    ) -> Option<Program> {
        let mut own = self.programs[record].clone();
        let knobs = self.knobs.iter().zip(&choice.knobs);
        let initial = self.initial.iter().zip(&choice.initial);
        let changes: Vec<_> =
            knobs.chain(initial).map(|(knob, value)| (knob.name.as_str(), *value)).collect();
        let is_tabled = tabled.is_none_or(|(table, points)| table.put(&mut own, points));
        (is_tabled && own.set_parameters(changes).is_ok()).then_some(own)
    }

    fn course(&self, record: usize, trace: &Trace) -> Option<Course> {
        let count = self.samples[record];
        let values = |name: &String| {
            let values: Vec<f64> = trace.track(name)?.values().take(count).collect();
            let is_whole = values.len() == count && values.iter().all(|value| value.is_finite());
            is_whole.then_some(values)
        };
        self.outputs.iter().map(values).collect()
    }
}

/// A table of a patch that runs give other points.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Table<'a> {
    /// That of a drive: time in seconds, value in the unit of its scale.
    Drive(&'a str),
    /// That of a function generator, in volts; its inputs stay.
    Curve(&'a str),
}

impl Table<'_> {
    fn put(self, program: &mut Program, points: &[[f64; 2]]) -> bool {
        match self {
            Table::Drive(drive) => solve::set_drive_table(program, drive, points.to_vec()).is_ok(),
            Table::Curve(element) => {
                let outputs: Vec<f64> = points.iter().map(|point| point[1]).collect();
                solve::set_curve(program, element, &outputs)
            }
        }
    }
}

/// Values of what can be turned, in declared units and volts.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Of the knobs.
    pub knobs: Vec<f64>,
    /// Of the initial voltages.
    pub initial: Vec<f64>,
}

/// The integrators and lags of a patch, those inside macros left out, and the voltages with which they begin.
fn states(patch: &Patch) -> Result<Vec<(String, f64)>, ModelError> {
    let program = Program::new(&Circuit::new(patch, &[])?)?;
    // Nothing is run, so there is no step that a lag could be too short for.
    let machine = Machine::adaptive(&program, LEAST_TOLERANCE, 1.0)?;
    let all = program.states().into_iter().zip(machine.states());
    let own = all.filter(|(element, _)| !element.contains('.'));
    Ok(own.map(|(element, volts)| (element.to_owned(), *volts)).collect())
}

/// The same patch with a parameter for every initial voltage, and with tables in place of the drives that records feed.
fn prepared(patch: &Patch, drives: &[Feed]) -> Result<(Patch, Vec<Knob>), ModelError> {
    let mut editor = patch.edit();
    let mut knobs = Vec::new();
    for (element, value) in states(patch)? {
        let word: String =
            element.chars().map(|letter| if letter.is_ascii_alphanumeric() { letter } else { '_' }).collect();
        let taken = |name: &str| {
            editor.patch().parameters.contains_key(name) || editor.patch().scales.contains_key(name)
        };
        let name = own_name(&format!("initial_{word}"), taken);
        editor.put_parameter(&name, ParameterBuilder::new(value, "1").range([-100, 100]));
        editor.set_initial(&element, name.as_str())?;
        knobs.push(Knob { name, value, range: [-100.0, 100.0] });
    }
    put_tables(&mut editor, drives)?;
    Ok((editor.finish(patch.file())?, knobs))
}

/// The same patch with initial voltages as they were found: of its integrators and lags, then of the parameters that are such
/// voltages.
///
/// # Errors
/// When the patch is no circuit.
pub(crate) fn begun(patch: &Patch, free: &[String], initial: &[f64]) -> Result<Patch, ModelError> {
    let states = states(patch)?;
    let mut editor = patch.edit();
    for ((element, _), volts) in states.iter().zip(initial) {
        editor.set_initial(element, *volts)?;
    }
    for (name, volts) in free.iter().zip(initial.iter().skip(states.len())) {
        editor.set_parameter(name, *volts)?;
    }
    Ok(editor.finish(patch.file())?)
}

/// The program with the drives of a record.
fn fed(program: &Program, record: &Record, drives: &[Feed]) -> Result<Program, ModelError> {
    let mut own = program.clone();
    for (feed, values) in drives.iter().zip(&record.drives) {
        solve::set_drive_table(&mut own, &feed.drive, points(values, record.interval, feed.hold))?;
    }
    if own.parameter(RECORD_START).is_some() {
        own.set_parameters([(RECORD_START, record.since)]).map_err(RunError::from)?;
    }
    Ok(own)
}

/// From the first sample of a record to its last.
fn phases(record: &Record) -> Vec<Phase> {
    vec![Phase::InitialCondition, Phase::operate(record.duration())]
}

fn plan(record: &Record, outputs: &[String], steps: u32) -> RunSettings {
    RunSettings {
        phases: phases(record),
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
    fn how_a_patch_begins_does_not_depend_on_how_quick_its_lags_are() {
        let text = r#"{"patchcord": 1,
            "elements": {"L1": {"kind": "lag", "in": {"x1": ["L1"]}, "time": 1e-6, "initial": 5}},
            "run": {"for": 1e-5, "step": 1e-7}}"#;
        let patch = Patch::parse("quick.json", text).unwrap();
        assert_eq!(states(&patch).unwrap(), [("L1".to_owned(), 5.0)]);
    }

    #[test]
    fn a_wide_range_is_gone_through_by_factors() {
        assert!((share([1.0, 1e8], 50.0) - 50f64.ln() / 1e8f64.ln()).abs() < 1e-12);
        assert!((share([1e-3, 1e4], 1e-4) + 1.0 / 7.0).abs() < 1e-12);
        assert!((share([0.0, 1e4], 5e3) - 0.5).abs() < 1e-12);
    }
}
