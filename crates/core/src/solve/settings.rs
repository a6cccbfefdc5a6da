//! The settings of a run, and the methods that change one setting each.
//!
//! `settings_check` checks the settings before a run, `settings_blocks` has the setting for long runs, and
//! `settings_curves` the one for curves. The settings for the run plan of a patch are made outside this module, because
//! the solver does not depend on circuits.

use super::settings_check::MAX_STEPS;
use crate::document::{Phase, RunExtent};
use crate::ir::Program;
use crate::kernel::{Backend, Kernel};

/// The settings of a run. Times are in problem seconds.
///
/// `RunSettings::of(&circuit)` takes them from the patch, and [`RunSettings::from_phases`] makes them without one. The
/// methods `with_...` and `without_lamps` return the settings with one of them changed. The fields are there to be
/// read.
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
#[non_exhaustive]
pub struct RunSettings {
    /// The phases in their order. A run always begins in initial condition, even if the first phase does not say so.
    pub phases: Vec<Phase>,
    /// Length of the solver's steps, above 0 and at most [`duration`](Self::duration). Shorter steps are slower and
    /// more accurate: the error decreases with the fourth power of the step if the circuit is smooth. With a tolerance,
    /// this is the first step tried.
    pub step: f64,
    /// The tolerance to which the length of steps adapts; `None` for equal steps. It bounds the sum of the errors of
    /// the steps from one initial condition to the next, in any state, in machine units of 100 V. It is from
    /// [`MIN_TOLERANCE`](super::MIN_TOLERANCE) to [`MAX_TOLERANCE`](super::MAX_TOLERANCE). If the motion amplifies
    /// errors, as stick-slip does, the result is less accurate.
    pub tolerance: Option<f64>,
    /// Largest number of steps, 1e10 at first: of the whole run for equal steps, and with a tolerance from one initial
    /// condition to the next.
    pub max_steps: f64,
    /// Time between recorded samples, above 0 and at most [`duration`](Self::duration). The end of every phase that
    /// takes time is recorded in any case. Recording never changes the steps.
    pub every: f64,
    /// Whether the machine goes into hold as soon as a lamp lights. Phases that take time are then skipped until the
    /// next initial condition.
    pub hold_on_overload: bool,
    /// Whether overload lamps can light. With `hold_on_overload` they always can. Without lamps the trace lists no
    /// overload, and runs in which voltages exceed ±100 V are faster.
    pub has_lamps: bool,
    /// Whether the run checks at some equal steps if they are short enough. The result is
    /// [`Trace::step_warning`](crate::trace::Trace::step_warning).
    pub checks_steps: bool,
    /// Whether the run finds the largest output of every amplifier. The result is
    /// [`Trace::amplifier_peaks`](crate::trace::Trace::amplifier_peaks).
    pub finds_amplifier_peaks: bool,
    /// Number of samples that the trace has at most; `None` if it keeps all. See [`with_blocks`](Self::with_blocks).
    pub block_samples: Option<usize>,
    /// Names of the signals to record, in the order of the tracks. Elements and drives are signals, too.
    pub record: Vec<String>,
    /// The curves of signals against each other that the trace has, each as the names of the signals to the right and
    /// upwards. See [`with_curves`](Self::with_curves).
    pub curves: Vec<(String, String)>,
    /// Names of the parameters by which the derivatives of all these signals are also recorded. Their tracks follow the
    /// tracks of the signals: all parameters of the first signal, then those of the next.
    pub sensitivities: Vec<String>,
    /// The backend that takes the steps. Runs with a tolerance or derivatives, and programs with loops, always use the
    /// reference.
    pub backend: Backend,
}

impl RunSettings {
    /// Settings for phases in equal steps, in problem seconds. Every step is recorded. No signal and no derivative is
    /// recorded until [`RunSettings::with_signals`] and [`RunSettings::with_sensitivities`] name them. Lamps can light,
    /// and the machine does not hold when one does.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::solve::{Phase, RunSettings};
    ///
    /// let settings = RunSettings::from_phases([Phase::InitialCondition, Phase::operate(2.0)], 1e-3);
    /// assert_eq!((settings.duration(), settings.step, settings.every), (2.0, 1e-3, 1e-3));
    /// assert!(settings.record.is_empty() && settings.has_lamps && !settings.hold_on_overload);
    /// ```
    pub fn from_phases(phases: impl IntoIterator<Item = Phase>, step: f64) -> Self {
        RunSettings {
            phases: phases.into_iter().collect(),
            step,
            tolerance: None,
            max_steps: MAX_STEPS,
            every: step,
            hold_on_overload: false,
            has_lamps: true,
            checks_steps: false,
            finds_amplifier_peaks: false,
            block_samples: None,
            record: Vec::new(),
            curves: Vec::new(),
            sensitivities: Vec::new(),
            backend: Backend::default(),
        }
    }

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
    /// let last = trace.values("A1").and_then(|values| values.last().copied()).ok_or("A1 is not recorded")?;
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
    /// let last = trace.values("A1").and_then(|values| values.last().copied()).ok_or("A1 is not recorded")?;
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

    /// The same settings with other signals to record, by the names of signals, elements and drives.
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
    /// let last = trace.derivative("A1", "x0").and_then(|track| track.values().last()).ok_or("no derivative")?;
    /// assert!((last - (-1.0f64).exp()).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_sensitivities(self, parameters: impl IntoIterator<Item = impl Into<String>>) -> Self {
        RunSettings { sensitivities: parameters.into_iter().map(Into::into).collect(), ..self }
    }

    /// The same settings with hold on overload: the machine goes into hold as soon as a lamp lights.
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
    /// assert!(held.repetitions[0].is_held && held.repetitions[0].end < 0.2);
    /// let dark = run(&program, &settings.without_lamps())?;
    /// assert_eq!((dark.repetitions[0].is_held, dark.overloads().count()), (false, 0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_hold_on_overload(self) -> Self {
        RunSettings { hold_on_overload: true, ..self }
    }

    /// The same settings with overload lamps, which is the default.
    pub fn with_lamps(self) -> Self {
        RunSettings { has_lamps: true, ..self }
    }

    /// The same settings with checks of the equal steps. They take a few per cent of the time of a long run. If they
    /// find a reason, the run is repeated with half the step for comparison.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    /// use patchcord_core::trace::StepCause;
    ///
    /// // dx/dt = -1000 x, from 50 V: steps of 3 ms are too long.
    /// let decay = ElementBuilder::new("integrator").cords("x1000", ["A1"]).set("initial", 50);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).run(0.1, 3e-3).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?.with_step_checks())?;
    /// let warning = trace.step_warning.ok_or("no warning")?;
    /// assert_eq!((warning.cause, warning.recommended), (StepCause::Unstable("A1".to_owned()), 2e-4));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_step_checks(self) -> Self {
        RunSettings { checks_steps: true, ..self }
    }

    /// The same settings with the largest output of every amplifier, recorded or not. It takes about one per cent of the
    /// time of a long run.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::circuit::Circuit;
    /// use patchcord_core::ir::Program;
    /// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
    /// use patchcord_core::solve::{RunSettings, run};
    ///
    /// // dx/dt = -x, from 2 V. The summer S is not recorded.
    /// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 2);
    /// let summer = ElementBuilder::new("summer").cords("x10", ["A1"]);
    /// let patch = PatchBuilder::new("decay").element("A1", decay).element("S", summer);
    /// let patch = patch.run(1.0, 1e-3).record(["A1"]).build()?;
    /// let circuit = Circuit::new(&patch)?;
    /// let program = Program::new(&circuit)?;
    /// let trace = run(&program, &RunSettings::of(&circuit)?.with_amplifier_peaks())?;
    /// let peaks: Vec<_> = trace.amplifier_peaks.iter().map(|peak| (&peak.element[..], peak.volts)).collect();
    /// assert_eq!(peaks, [("A1", 2.0), ("S", 20.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_amplifier_peaks(self) -> Self {
        RunSettings { finds_amplifier_peaks: true, ..self }
    }

    /// The same settings without overload lamps.
    pub fn without_lamps(self) -> Self {
        RunSettings { has_lamps: false, ..self }
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
    /// assert_eq!(run(&program, &settings)?.repetitions.len(), 3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn repeated(self, times: u64) -> Self {
        RunSettings { phases: vec![Phase::Repeat { times, phases: self.phases }], ..self }
    }

    /// The length of the longest repetition: the time in seconds between two initial conditions, or from one to the end
    /// of the run. The time in hold counts, too.
    pub fn duration(&self) -> f64 {
        RunExtent::of(&self.phases).longest_repetition
    }

    /// The longest time in seconds of the complete run by the recorder's clock, with holds and repetitions. The run is
    /// shorter if a relay or an overload ends a phase earlier.
    pub fn total_duration(&self) -> f64 {
        RunExtent::of(&self.phases).record_time
    }

    /// Whether [`run_batch`](super::run_batch) takes the steps of a program with these settings in lanes. That needs
    /// equal steps without checks, no derivatives, no peaks of amplifiers, no curves, a backend with lanes, and a program
    /// with kernels.
    pub fn is_batchable(&self, program: &Program) -> bool {
        let has_equal_steps = self.tolerance.is_none() && !self.checks_steps && !self.finds_amplifier_peaks;
        let has_only_samples = self.sensitivities.is_empty() && self.curves.is_empty();
        has_equal_steps && has_only_samples && self.backend.can_use_lanes() && Kernel::is_supported(program)
    }
}
