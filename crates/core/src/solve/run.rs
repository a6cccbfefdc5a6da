//! A complete run: its settings, their check, and the record.
//!
//! [`prepare`] checks everything and makes a machine with its recorder. A [`Player`] then plays the phases, and the
//! recorder returns the trace. Programs that differ only in their parameters can run together as a [`Batch`], with the
//! same results to the bit.

use super::batch::Batch;
use super::error::{RunError, StoppedRun, TimeSetting};
use super::levels::check_noise;
use super::machine::Machine;
use super::player::{self, Player};
use super::recorder::Recorder;
use crate::document::{MIN_TOLERANCE, Phase, RunExtent};
use crate::grid::SAME_INSTANT;
use crate::ir::Program;
use crate::kernel::{Backend, Kernel, LANES};
use crate::trace::Trace;

/// The settings of a run. Times are in problem seconds.
///
/// `RunSettings::of(&circuit)` takes them from the patch. The methods change one setting each. A struct update such as
/// `RunSettings { every: 0.1, ..settings }` does the same.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?.with_duration(2.0).with_sample_interval(0.5);
/// assert_eq!((settings.duration(), settings.step), (2.0, 1e-3));
/// let trace = run(&program, &settings.with_signals(["A1"]))?;
/// assert_eq!(trace.time, [0.0, 0.5, 1.0, 1.5, 2.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RunSettings {
    /// The phases in their order. A run always begins in initial condition, even if the first phase does not say so.
    pub phases: Vec<Phase>,
    /// Length of the solver's steps, above 0 and at most [`duration`](Self::duration). Shorter steps are slower and
    /// more accurate: the error decreases with the fourth power of the step if the circuit is smooth. With a tolerance,
    /// this is the first step tried.
    pub step: f64,
    /// The tolerance to which the length of steps adapts; `None` for equal steps. It bounds the sum of the errors of
    /// the steps from one initial condition to the next, in any state, in machine units of 100 V. It is at least
    /// [`MIN_TOLERANCE`]. If the motion amplifies errors, as stick-slip does, the result is less accurate.
    pub tolerance: Option<f64>,
    /// Time between recorded samples, above 0 and at most [`duration`](Self::duration). Recording never changes
    /// the steps.
    pub every: f64,
    /// Whether the machine goes into hold as soon as a lamp lights. Phases that take time are then skipped until the
    /// next initial condition.
    pub hold_on_overload: bool,
    /// Whether overload lamps can light. With `hold_on_overload` they always can. Without lamps the trace lists no
    /// overload, and runs in which voltages exceed ±100 V are faster.
    pub lamps: bool,
    /// Names of the signals to record, in the order of the tracks. Elements and drives are signals, too.
    pub record: Vec<String>,
    /// Names of the parameters by which the derivatives of all these signals are also recorded. Their tracks follow the
    /// tracks of the signals: all parameters of the first signal, then those of the next.
    pub sensitivities: Vec<String>,
    /// The backend that takes the steps. Runs with a tolerance or derivatives, and programs with loops, always use the
    /// reference.
    pub backend: Backend,
}

impl RunSettings {
    /// The same settings with other phases.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{Phase, RunSettings, run};
    ///
    /// // dx/dt = -k x, from 50 V
    /// # let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
    /// # let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
    /// # let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
    /// # let patch = patch.element("A1", decay).element("P1", pot).run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let phases = [Phase::operate(0.5), Phase::set("k", 0.0), Phase::operate(0.5)];
    /// let trace = run(&program, &RunSettings::of(&circuit)?.with_phases(phases))?;
    /// // The initial condition comes first, also if no phase says so.
    /// assert_eq!(trace.phase_records.len(), 4);
    /// let last = trace.values("A1").and_then(|values| values.last().copied()).unwrap();
    /// assert!((last - 50.0 * (-0.25f64).exp()).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_phases(self, phases: impl IntoIterator<Item = Phase>) -> Self {
        RunSettings { phases: phases.into_iter().collect(), ..self }
    }

    /// The same settings with equal steps of this length, in problem seconds.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::RunSettings;
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let settings = RunSettings::of(&Circuit::new(&patch)?)?.with_tolerance(1e-6);
    /// assert_eq!(settings.tolerance, Some(1e-6));
    /// let settings = settings.with_step(0.01);
    /// assert_eq!((settings.step, settings.tolerance), (0.01, None));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_step(self, step: f64) -> Self {
        RunSettings { step, tolerance: None, ..self }
    }

    /// The same settings with steps that adapt to a tolerance, in machine units of 100 V.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?.with_tolerance(1e-9))?;
    /// let last = trace.values("A1").and_then(|values| values.last().copied()).unwrap();
    /// assert!((last - 50.0 * (-1.0f64).exp()).abs() < 1e-4);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        RunSettings { tolerance: Some(tolerance), ..self }
    }

    /// The same settings with another time between recorded samples, in problem seconds.
    pub fn with_sample_interval(self, every: f64) -> Self {
        RunSettings { every, ..self }
    }

    /// The same settings with other signals to record.
    pub fn with_signals(self, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        RunSettings { record: names.into_iter().map(Into::into).collect(), ..self }
    }

    /// The same settings with derivatives by these parameters.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // x = x0 exp(-t), so dx/dx0 = exp(-t)
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", "x0");
    /// let patch = PatchBuilder::new("decay").parameter("x0", 50.0, "V", [-100.0, 100.0]);
    /// let patch = patch.element("A1", decay).run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?.with_sensitivities(["x0"]))?;
    /// let last = trace.derivative("A1", "x0").and_then(|track| track.values().last()).unwrap();
    /// assert!((last - (-1.0f64).exp()).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_sensitivities(self, parameters: impl IntoIterator<Item = impl Into<String>>) -> Self {
        RunSettings { sensitivities: parameters.into_iter().map(Into::into).collect(), ..self }
    }

    /// The same settings with hold on overload.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // The demand of S1 is -1000 t and exceeds 100 V at t = 0.1 s.
    /// # let ramp = ElementBuilder::new("integrator").cords("x1", ["-100"]);
    /// # let summer = ElementBuilder::new("summer").cords("x10", ["A1"]);
    /// # let patch = PatchBuilder::new("overload").element("A1", ramp).element("S1", summer);
    /// # let patch = patch.run(0.5, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let settings = RunSettings::of(&circuit)?;
    /// let held = run(&program, &settings.clone().with_hold_on_overload())?;
    /// assert!(held.sweeps[0].held && held.sweeps[0].end < 0.2);
    /// let dark = run(&program, &settings.without_lamps())?;
    /// assert_eq!((dark.sweeps[0].held, dark.overloads().count()), (false, 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_hold_on_overload(self) -> Self {
        RunSettings { hold_on_overload: true, ..self }
    }

    /// The same settings without overload lamps.
    pub fn without_lamps(self) -> Self {
        RunSettings { lamps: false, ..self }
    }

    /// The same settings with another backend.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{Backend, RunSettings, run};
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let settings = RunSettings::of(&circuit)?;
    /// let interpreted = run(&program, &settings.clone().with_backend(Backend::Interpreter))?;
    /// let native = run(&program, &settings.with_backend(Backend::Native))?;
    /// assert_eq!(interpreted.values("A1"), native.values("A1"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_backend(self, backend: Backend) -> Self {
        RunSettings { backend, ..self }
    }

    /// The same settings with new phases: one initial condition, and operation over a time in problem seconds.
    pub fn with_duration(self, duration: f64) -> Self {
        RunSettings { phases: vec![Phase::InitialCondition, Phase::operate(duration)], ..self }
    }

    /// The same settings with all phases repeated (repetitive operation).
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let settings = RunSettings::of(&circuit)?.repeated(3);
    /// assert_eq!((settings.duration(), settings.total_duration()), (1.0, 3.0));
    /// assert_eq!(run(&program, &settings)?.sweeps.len(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn repeated(self, times: u64) -> Self {
        RunSettings { phases: vec![Phase::Repeat { times, phases: self.phases }], ..self }
    }

    /// The length of the longest sweep: the time in seconds between two initial conditions, or from one to the end of
    /// the run. The time in hold counts, too.
    pub fn duration(&self) -> f64 {
        RunExtent::of(&self.phases).longest_sweep
    }

    /// The longest time in seconds of the complete run by the recorder's clock, with holds and repetitions. The run is
    /// shorter if a relay or an overload ends a phase earlier.
    pub fn total_duration(&self) -> f64 {
        RunExtent::of(&self.phases).record_time
    }

    /// Whether [`run_batch`] takes the steps of a program with these settings in lanes. That needs equal steps, no
    /// derivatives, a backend with lanes, and a program with kernels.
    pub fn is_batchable(&self, program: &Program) -> bool {
        let has_equal_steps = self.tolerance.is_none() && self.sensitivities.is_empty();
        has_equal_steps && self.backend.can_use_lanes() && Kernel::is_supported(program)
    }

    /// Checks the times, the phases, the tolerance and the size of the run. Names are checked by [`check()`].
    ///
    /// # Errors
    /// If a time is not positive, the step or the time between samples is longer than the run, no phase takes time, a
    /// repetition is empty, or the run would take too many steps or too much memory.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::RunSettings;
    ///
    /// // dx/dt = -x, from 50 V
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
    /// let settings = RunSettings::of(&Circuit::new(&patch)?)?.with_sample_interval(2.0);
    /// let error = settings.check().unwrap_err();
    /// assert_eq!(error.to_string(), "the time between samples is 2 s, longer than the run of 1 s");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check(&self) -> Result<(), RunError> {
        self.phases.iter().try_for_each(check_phase)?;
        let intervals = [(TimeSetting::Step, self.step), (TimeSetting::Every, self.every)];
        intervals.into_iter().try_for_each(|(which, value)| check_time(which, value))?;
        let extent = RunExtent::of(&self.phases);
        if extent.record_time == 0.0 {
            return Err(RunError::NoTime);
        }
        for (which, value) in intervals {
            if value > extent.longest_sweep * (1.0 + SAME_INSTANT) {
                return Err(RunError::LongerThanRun { which, value, duration: extent.longest_sweep });
            }
        }
        self.tolerance.map_or(Ok(()), check_tolerance)?;
        self.check_size(extent)
    }

    /// Checks the number of steps and of recorded numbers.
    ///
    /// # Errors
    /// If they exceed [`MAX_STEPS`] or [`MAX_NUMBERS`].
    fn check_size(&self, extent: RunExtent) -> Result<(), RunError> {
        let steps = extent.operate_time / self.step;
        if self.tolerance.is_none() && steps > MAX_STEPS {
            return Err(RunError::TooManySteps { steps, most: MAX_STEPS });
        }
        let numbers = self.recorded_numbers();
        if numbers > MAX_NUMBERS {
            return Err(RunError::TooManyNumbers { numbers, most: MAX_NUMBERS });
        }
        Ok(())
    }

    /// An upper limit of the numbers that the run records, with repetitions: one time and one value per track for every
    /// sample, and a constant amount for every phase, change and sweep.
    pub fn recorded_numbers(&self) -> f64 {
        let extent = RunExtent::of(&self.phases);
        // Every phase may write a sample at its beginning and one at its end.
        let rows = (extent.record_time / self.every).floor() + 2.0 * extent.phase_count;
        let phase_records = (extent.phase_count + extent.change_count) * NUMBERS_PER_PHASE_RECORD;
        // Every phase may also begin a sweep.
        let tracks = self.record.len() * (1 + self.sensitivities.len());
        let extremes = extent.phase_count * tracks as f64 * NUMBERS_PER_EXTREMES;
        rows * (tracks + 1) as f64 + phase_records + extremes
    }
}

/// Checks that a tolerance is finite and at least [`MIN_TOLERANCE`].
///
/// # Errors
/// If it is not.
pub(super) fn check_tolerance(value: f64) -> Result<(), RunError> {
    let is_valid = value >= MIN_TOLERANCE && value.is_finite();
    if is_valid { Ok(()) } else { Err(RunError::NotATolerance { value, least: MIN_TOLERANCE }) }
}

/// Checks that a time is positive and finite.
fn check_time(which: TimeSetting, value: f64) -> Result<(), RunError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(RunError::NotATime { which, value }) }
}

/// Checks the times of a phase, and that a repetition is not empty.
fn check_phase(phase: &Phase) -> Result<(), RunError> {
    match phase {
        Phase::Operate { time, .. } => check_time(TimeSetting::Duration, *time),
        Phase::Hold { time } => check_time(TimeSetting::Hold, *time),
        Phase::Repeat { times, phases } if *times == 0 || phases.is_empty() => Err(RunError::EmptyRepeat),
        Phase::Repeat { phases, .. } => phases.iter().try_for_each(check_phase),
        Phase::InitialCondition | Phase::Set { .. } => Ok(()),
    }
}

/// Largest number of steps of a run, over all phases and repetitions. At a million steps a second they take 2.8 hours,
/// so more steps are a mistake in the settings.
pub(super) const MAX_STEPS: f64 = 1e10;
/// Largest number of numbers that a run records. They take 8 bytes each, and as much again while they are written to a
/// file: 3.2 GB together.
const MAX_NUMBERS: f64 = 2e8;
/// Memory of the record of a phase, and of every change in it, in numbers of 8 bytes.
const NUMBERS_PER_PHASE_RECORD: f64 = 16.0;
/// Memory of the extremes of a signal in a sweep, in numbers: first and last voltage, and two extremes with their
/// times.
const NUMBERS_PER_EXTREMES: f64 = 6.0;

/// Runs a program through its phases and records it.
///
/// # Errors
/// If the settings are invalid ([`RunSettings::check`]), a name is unknown, or the run has to stop. The error contains
/// the record up to then.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let trace = run(&program, &RunSettings::of(&circuit)?)?;
/// let last = trace.values("A1").and_then(|values| values.last().copied()).unwrap();
/// assert!((last - 50.0 * (-1.0f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run(program: &Program, settings: &RunSettings) -> Result<Trace, StoppedRun> {
    run_with_progress(program, settings, &mut |_| ())
}

/// Runs a program, and calls `progress` after every step or block of steps with the seconds recorded so far, summed
/// over all sweeps. [`RunSettings::total_duration`] is the largest value.
///
/// # Errors
/// As for [`run`].
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run_with_progress};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?;
/// let mut seconds = 0.0;
/// run_with_progress(&program, &settings, &mut |recorded| seconds = recorded)?;
/// assert!(seconds > 0.0 && seconds <= settings.total_duration() + 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_with_progress(
    program: &Program,
    settings: &RunSettings,
    progress: &mut dyn FnMut(f64),
) -> Result<Trace, StoppedRun> {
    let mut player = prepare(program, settings, progress)?;
    let outcome = player.run(&settings.phases);
    result_of(player, outcome)
}

/// Runs several programs and returns their results in the same order. Each result is the same, to the bit, as that of
/// [`run`]. Programs that differ only in their parameters take their steps together, up to [`LANES`] at a time, if
/// [`RunSettings::is_batchable`].
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, run, run_batch};
///
/// // dx/dt = -k x, from 50 V
/// # let pot = ElementBuilder::new("pot").cord("in", "A1").set("setting", "k");
/// # let decay = ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50);
/// # let patch = PatchBuilder::new("dx/dt = -k x").parameter("k", 0.5, "1", [0.0, 1.0]);
/// # let patch = patch.element("A1", decay).element("P1", pot).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let mut programs = vec![program; 3];
/// for (program, k) in programs.iter_mut().zip([0.1, 0.2, 0.4]) {
///     program.set_parameters([("k", k)])?;
/// }
/// let settings = RunSettings::of(&circuit)?;
/// for (program, trace) in programs.iter().zip(run_batch(&programs, &settings)) {
///     assert_eq!(trace?.values("A1"), run(program, &settings)?.values("A1"));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_batch(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, StoppedRun>> {
    if programs.len() < 2 || !programs.iter().all(|program| settings.is_batchable(program)) {
        return programs.iter().map(|program| run(program, settings)).collect();
    }
    programs.chunks(LANES).flat_map(|programs| run_chunk(programs, settings)).collect()
}

/// Runs at most [`LANES`] programs as a batch. The results are in the order of the programs; those that could not begin
/// are not members of the batch.
fn run_chunk(programs: &[Program], settings: &RunSettings) -> Vec<Result<Trace, StoppedRun>> {
    let mut progress = vec![|_: f64| (); programs.len()];
    let mut players = Vec::new();
    let pairs = programs.iter().zip(&mut progress);
    let preparations = pairs
        .map(|(program, progress)| prepare(program, settings, progress).map(|player| players.push(player)));
    let preparations: Vec<Result<(), RunError>> = preparations.collect();
    let mut batch = Batch::new(players, settings.backend);
    batch.run(&settings.phases);
    let mut results = batch.into_players().map(|(player, outcome)| result_of(player, outcome));
    let outcomes = preparations.into_iter().filter_map(|preparation| match preparation {
        Ok(()) => results.next(),
        Err(error) => Some(Err(error.into())),
    });
    outcomes.collect()
}

/// The result of a run: the trace, or the error with the trace up to it.
fn result_of(player: Player<'_, '_>, outcome: Result<(), RunError>) -> Result<Trace, StoppedRun> {
    let trace = player.finish();
    match outcome {
        Ok(()) => Ok(trace),
        Err(error) => Err(StoppedRun { error, trace: Box::new(trace) }),
    }
}

/// Runs a program up to a time by the recorder's clock, in seconds summed over all sweeps. Returns the machine and the
/// time reached, which is earlier if the phases or an overload end the run before. `progress` is called as by
/// [`run_with_progress`].
///
/// # Errors
/// If the settings are invalid, a name is unknown, or the run has to stop.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, machine_after};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?;
/// let (machine, reached) = machine_after(&program, &settings, 0.5, &mut |_| ())?;
/// assert!((reached - 0.5).abs() < 1e-9);
/// assert!((machine.voltage("A1")? - 50.0 * (-0.5f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn machine_after<'p>(
    program: &'p Program,
    settings: &RunSettings,
    seconds: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<(Machine<'p>, f64), RunError> {
    let mut player = prepare(program, settings, progress)?.with_end(seconds);
    player.run(&settings.phases)?;
    Ok(player.into_machine())
}

/// Checks that a run can begin, without running it.
///
/// # Errors
/// The errors of [`run`] that come before the first step.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{RunSettings, check};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?;
/// assert!(check(&program, &settings).is_ok());
/// let error = check(&program, &settings.with_signals(["x"])).unwrap_err();
/// assert_eq!(error.code(), "unknown-signal");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn check(program: &Program, settings: &RunSettings) -> Result<(), RunError> {
    prepare(program, settings, &mut |_| ()).map(|_| ())
}

/// Makes a player with a machine in initial condition and its recorder. The tolerance of the run is divided by its
/// duration, because [`Machine::adaptive`] takes it per problem second.
///
/// # Errors
/// The errors of [`run`] that come before the first step.
pub(super) fn prepare<'p, 'w>(
    program: &'p Program,
    settings: &RunSettings,
    progress: &'w mut dyn FnMut(f64),
) -> Result<Player<'p, 'w>, RunError> {
    settings.check()?;
    player::check(program, &settings.phases)?;
    let mut machine = match settings.tolerance {
        Some(tolerance) => Machine::adaptive(program, tolerance / settings.duration(), settings.step)?,
        None => Machine::new(program, settings.step)?,
    };
    if !settings.sensitivities.is_empty() {
        machine.differentiate(&settings.sensitivities.iter().map(String::as_str).collect::<Vec<_>>())?;
    }
    let operated = RunExtent::of(&settings.phases).operate_time;
    check_noise(program, &machine.solver.state.level_sources, operated)?;
    let recorder = Recorder::new(program, &machine.solver, settings, progress)?;
    machine.fast_path.restart(settings.backend, recorder.registers());
    machine.lamps.is_on = settings.lamps || settings.hold_on_overload;
    Ok(Player::new(machine, recorder, operated))
}
