//! The recorder: samples voltages on a separate time grid while the machine operates and holds.
//!
//! The recorder's clock is the problem time plus the time in hold. It begins at 0 in every repetition. A repetition
//! lasts from one initial condition to the next. A sample within a step is interpolated, so recording never changes the
//! steps. Every phase that takes time begins and ends with a sample, also if these instants are not on the grid. For
//! every signal the recorder also keeps the minimum and the maximum of each repetition, which may be between samples.

mod blocks;
mod curve_follower;
mod observer;
mod watch;

pub(super) use watch::Watch;
pub use watch::WatchedPoints;

use std::ops::{ControlFlow, Range};

use self::curve_follower::{FollowedSignal, follow};
use super::error::RunError;
use super::fast_path::KernelRun;
use super::lamps::Lamps;
use super::machine::Machine;
use super::settings::RunSettings;
use super::state::Solver;
use super::step_check::StepDoubt;
use crate::grid::{Grid, RATE_TOLERANCE, SAME_INSTANT};
use crate::ir::{Program, Register, SignalInfo};
use crate::kernel::Steps;
use crate::trace::{PhaseEnd, PhaseKind, PhaseRecord, Repetition, Trace, Track};

/// Largest distance of the end of a phase from the last sample at which both are one sample, as a share of the time
/// between samples.
const SAME_SAMPLE_SHARE: f64 = 1e-6;

/// Takes the samples of a block. On `Break` the run ends.
pub(super) type BlockConsumer<'a> = dyn FnMut(&Trace) -> ControlFlow<()> + 'a;

/// Samples the signals of a run, and records its repetitions and phases. It is the observer of the machine.
pub(super) struct Recorder<'a> {
    /// The record so far, without the samples that were flushed.
    pub trace: Trace,
    /// Takes the samples of each block; `None` if they are dropped or stay in the record.
    pub consumer: Option<&'a mut BlockConsumer<'a>>,
    /// Whether the consumer has stopped the run. It takes no more samples.
    pub is_cancelled: bool,
    /// Number of samples of a block; `None` if the samples stay in the record.
    block_samples: Option<usize>,
    /// Number of samples that were flushed.
    flushed: usize,
    /// Called with the seconds recorded so far, summed over all repetitions.
    progress: Option<&'a mut dyn FnMut(f64)>,
    /// The outputs that are watched at every step, or for curves; `None` if there are none.
    pub watch: Option<Watch>,
    /// The signals of the curves.
    followed: Vec<FollowedSignal>,
    /// Length of equal steps in problem seconds.
    step: f64,
    /// Seconds recorded before the present repetition.
    recorded_before: f64,
    /// The recorded signals, in the order of their tracks.
    signals: Vec<SignalInfo>,
    /// The instants of the samples.
    grid: Grid,
    /// Index of the next sample in the grid of the present repetition.
    next_index: u64,
    /// Time of the next sample by the recorder's clock, in seconds.
    next_time: f64,
    /// Time of the last sample by the recorder's clock, in seconds.
    last_time: f64,
    /// Seconds that the present repetition has been in hold: the recorder's clock minus problem time.
    pub hold_time: f64,
    /// Whether a repetition has begun since the last initial condition.
    is_in_repetition: bool,
    /// Whether the last sample has the present voltages.
    is_fresh: bool,
    /// The value of `hold_time` when the lamp of each element lit; `None` for a lamp that is off. The time of an
    /// overload by the recorder's clock follows from it.
    hold_time_when_lit: Vec<Option<f64>>,
    /// Whether the machine goes into hold when a lamp lights.
    hold_on_overload: bool,
    /// The doubt about the steps of all repetitions so far; `None` if there is none.
    pub step_doubt: Option<StepDoubt>,
    /// The change of mode that ends the present phase; `None` if no relay ends it.
    pub end_condition: Option<EndCondition>,
    /// Every voltage just before the last changes of mode. It is updated only if there is an end condition.
    voltages_before_switching: Vec<f64>,
    /// The recorded derivatives just before the last changes of mode, in the order of their tracks.
    derivatives_before_switching: Vec<f64>,
}

/// The instant whose voltages a sample contains.
#[derive(Clone, Copy)]
enum Instant {
    /// The present.
    Present,
    /// The instant at which the solver interpolated last.
    Interpolated,
}

/// The change of a mode that ends a phase.
#[derive(Debug, Clone, Copy)]
pub(super) struct EndCondition {
    /// Index of the mode in `Program::modes`.
    pub mode: usize,
    /// Value of the mode after the last step, or at the beginning of the phase.
    pub last: f64,
    /// The value that the mode must take; `None` for any value other than `last`.
    pub target: Option<f64>,
    /// Whether the change has occurred.
    pub is_met: bool,
}

impl EndCondition {
    /// Reads the modes after a step, and notes whether the change has occurred.
    fn read(&mut self, modes: &[f64]) {
        let value = modes[self.mode];
        self.is_met |= value != self.last && self.target.is_none_or(|target| target == value);
        self.last = value;
    }
}

impl<'a> Recorder<'a> {
    /// A recorder of the signals that the settings name, with empty tracks. The solver is in initial condition and
    /// computes the derivatives that the settings name.
    ///
    /// # Errors
    /// If a signal is unknown.
    pub(super) fn new(
        program: &Program,
        solver: &Solver<'_>,
        settings: &RunSettings,
        progress: Option<&'a mut dyn FnMut(f64)>,
    ) -> Result<Self, RunError> {
        let signals: Result<Vec<_>, _> =
            settings.record.iter().map(|name| find_signal(program, name)).collect();
        let signals = signals?;
        let mut tracks: Vec<_> = signals.iter().map(|signal| empty_track(signal, solver)).collect();
        let derivatives = tracks.iter().flat_map(|track| derivative_tracks(track, solver, settings));
        let derivatives: Vec<_> = derivatives.collect();
        let count = derivatives.len();
        tracks.extend(derivatives);
        let (followed, watch) = follow(program, solver, settings)?;
        Ok(Recorder {
            trace: Trace { tracks, ..Trace::default() },
            consumer: None,
            is_cancelled: false,
            block_samples: settings.block_samples,
            flushed: 0,
            progress,
            watch,
            followed,
            step: settings.step,
            recorded_before: 0.0,
            signals,
            grid: Grid::new(settings.every),
            next_index: 0,
            next_time: 0.0,
            last_time: 0.0,
            hold_time: 0.0,
            is_in_repetition: false,
            is_fresh: false,
            hold_time_when_lit: vec![None; program.lowered.elements.len()],
            hold_on_overload: settings.hold_on_overload,
            step_doubt: None,
            end_condition: None,
            voltages_before_switching: vec![0.0; solver.state.voltages.len()],
            derivatives_before_switching: vec![0.0; count],
        })
    }

    /// The registers of the recorded voltages, in the order of the tracks, and then those of the watched outputs.
    pub(super) fn registers(&self) -> Vec<Register> {
        let watched = self.watch.iter().flat_map(Watch::registers);
        self.signals.iter().map(|signal| signal.register).chain(watched).collect()
    }

    /// Adds the present voltages to the watched points.
    pub(super) fn watch_present(&mut self, solver: &Solver<'_>) {
        if let Some(watch) = &mut self.watch {
            watch.add_present(solver, self.hold_time);
        }
    }

    /// Adds the present voltages to the watched points, because a phase begins or ends.
    pub(super) fn watch_phase_limit(&mut self, solver: &Solver<'_>) {
        if let Some(watch) = &mut self.watch {
            watch.add_phase_limit(solver, self.hold_time);
        }
    }

    /// The record, with its curves.
    pub(super) fn into_trace(self) -> Trace {
        Trace { curves: self.watch.map_or(Vec::new(), Watch::into_curves), ..self.trace }
    }

    /// The recorder's clock at a problem time: seconds since the repetition began.
    pub(super) fn clock(&self, time: f64) -> f64 {
        time + self.hold_time
    }

    /// Seconds recorded up to a problem time of the present repetition, summed over all repetitions.
    pub(super) fn recorded(&self, time: f64) -> f64 {
        self.recorded_before + if self.is_in_repetition { self.clock(time) } else { 0.0 }
    }

    /// Records the present voltages, unless the last sample has them. If no repetition has begun, one begins with this
    /// sample.
    pub(super) fn sample_present(&mut self, solver: &Solver<'_>, lamps: &Lamps) {
        if !self.is_in_repetition {
            let first = self.sample_count();
            self.trace.repetitions.push(Repetition { first, ..Repetition::default() });
            (self.hold_time, self.is_in_repetition, self.is_fresh) = (0.0, true, false);
            self.set_next_sample(1);
            self.watch.iter_mut().for_each(Watch::begin_repetition);
            // A lamp that is lit now was lit in initial condition.
            self.hold_time_when_lit = lamps.lit.iter().map(|lamp| lamp.map(|_| 0.0)).collect();
        }
        if !self.is_fresh {
            self.write_sample(self.clock(solver.state.time), solver, Instant::Present);
            self.is_fresh = true;
        }
    }

    /// Records the present voltages at the end of a phase that takes time, unless the last sample is of this instant
    /// within the tolerance of the grid. The extremes have these voltages already.
    pub(super) fn sample_end(&mut self, solver: &Solver<'_>) {
        let end = self.clock(solver.state.time);
        if self.last_time < end - self.end_tolerance(end) {
            self.push_time(end);
            let values = track_values(&self.signals, solver, Instant::Present);
            self.trace.tracks.iter_mut().zip(values).for_each(|(track, value)| track.volts.push(value));
            self.is_fresh = true;
            self.flush_full_block();
        }
    }

    /// Seconds after the last sample up to which the end of a phase is the same instant. It is the tolerance of the grid,
    /// but at most a small share of the time between samples.
    fn end_tolerance(&self, end: f64) -> f64 {
        let of_grid = (RATE_TOLERANCE * end).min(SAME_SAMPLE_SHARE * self.grid.time(1));
        of_grid.max(SAME_INSTANT * end)
    }

    /// Records the present voltages before a phase changes parameters, if the repetition continues after it.
    pub(super) fn sample_before_change(&mut self, solver: &Solver<'_>, lamps: &Lamps, is_held: bool) {
        if self.is_in_repetition && !is_held {
            self.sample_present(solver, lamps);
        }
    }

    /// Records that a phase begins at a problem time. The first sample of a phase that takes time is the last one
    /// written; that of any other phase is the next one.
    pub(super) fn begin_phase(&mut self, time: f64, phase: PhaseKind) {
        let takes_time = matches!(phase, PhaseKind::Operate { .. } | PhaseKind::Hold);
        let begin = if self.is_in_repetition { self.clock(time) } else { 0.0 };
        let sample = self.sample_count() - usize::from(takes_time);
        self.trace.phase_records.push(PhaseRecord {
            phase,
            repetition: self.trace.repetitions.len() - usize::from(self.is_in_repetition),
            begin,
            end: begin,
            problem_time: time,
            sample,
            ended: PhaseEnd::Time,
        });
    }

    /// Records that the present phase ended at a problem time, and which lamps are lit.
    pub(super) fn end_phase(&mut self, time: f64, lamps: &Lamps, ended: PhaseEnd) {
        let end = if self.is_in_repetition { self.clock(time) } else { 0.0 };
        if let Some(record) = self.trace.phase_records.last_mut() {
            (record.end, record.ended) = (end, ended);
        }
        for (hold_time, lamp) in self.hold_time_when_lit.iter_mut().zip(&lamps.lit) {
            *hold_time = hold_time.or(lamp.map(|_| self.hold_time));
        }
    }

    /// Notes that the present voltages have changed without a step, so the last sample does not have them.
    pub(super) fn invalidate_sample(&mut self) {
        self.is_fresh = false;
    }

    /// Records a machine that is in hold for a time in seconds. All samples have the same voltages.
    pub(super) fn record_hold(&mut self, solver: &Solver<'_>, time: f64) {
        let end = self.clock(solver.state.time) + time;
        self.is_fresh = false;
        while let Some(time) = self.next_before(end * (1.0 + SAME_INSTANT)) {
            self.write_sample(time, solver, Instant::Present);
            self.set_next_sample(self.next_index + 1);
            self.is_fresh = time > end * (1.0 - SAME_INSTANT);
        }
        self.hold_time += time;
        self.report_progress(solver.state.time);
    }

    /// Calls `progress` with the seconds recorded up to a problem time.
    fn report_progress(&mut self, time: f64) {
        let recorded = self.recorded(time);
        if let Some(progress) = &mut self.progress {
            progress(recorded);
        }
    }

    /// Ends the repetition, if one has begun: adds its end, its overloads and its work to the record. `is_held` is
    /// whether an overload ended it.
    pub(super) fn end_repetition(&mut self, machine: &Machine<'_>, is_held: bool) {
        if !std::mem::take(&mut self.is_in_repetition) {
            return;
        }
        let Machine { solver, lamps, work, step_check, .. } = machine;
        let doubt = step_check.as_ref().and_then(|check| check.doubt(&solver.setup, lamps.is_any_lit()));
        self.step_doubt = StepDoubt::worse(self.step_doubt, doubt);
        let program = solver.setup.program;
        let end = self.clock(solver.state.time);
        if let Some(repetition) = self.trace.repetitions.last_mut() {
            repetition.overloads = lamps.history(program);
            for overload in &mut repetition.overloads {
                let hold_time =
                    program.element(&overload.element).and_then(|element| self.hold_time_when_lit[element]);
                overload.time += hold_time.unwrap_or(self.hold_time);
            }
            (repetition.end, repetition.work, repetition.is_held) = (end, *work, is_held);
        }
        self.recorded_before += end;
    }

    /// Adopts the present scales of the recorded signals. Samples before the change are in the old ones.
    pub(super) fn adopt_scales(&mut self, solver: &Solver<'_>) {
        let pairs = self.trace.tracks.iter_mut().zip(&self.signals);
        pairs.for_each(|(track, signal)| track.per_volt = per_volt(signal, solver));
    }

    /// Continues at a time of the recorder's clock, after the machine was moved there without steps.
    pub(super) fn move_to(&mut self, solver: &Solver<'_>, lamps: &Lamps, hold_time: f64) {
        self.sample_present(solver, lamps);
        self.hold_time = hold_time;
        let clock = self.clock(solver.state.time);
        self.set_next_sample(self.grid.steps_in(clock) + 1);
        (self.last_time, self.is_fresh) = (clock, false);
    }

    /// The samples since the last call. They are no longer in the record, and nor are phases and repetitions that have
    /// ended.
    pub(super) fn take_samples(&mut self) -> Trace {
        let ended = self.trace.repetitions.len().saturating_sub(1);
        self.trace.repetitions.drain(..ended);
        for track in &mut self.trace.tracks {
            track.extremes.drain(..ended.min(track.extremes.len()));
        }
        self.trace.phase_records.drain(..self.trace.phase_records.len().saturating_sub(1));
        let taken = Trace { time: std::mem::take(&mut self.trace.time), ..Trace::default() };
        self.flushed += taken.len();
        let tracks = self.trace.tracks.iter_mut().map(|track| {
            let volts = std::mem::take(&mut track.volts);
            Track { volts, extremes: Vec::new(), ..track.clone() }
        });
        Trace { tracks: tracks.collect(), ..taken }
    }

    /// Name of a recorded signal, or of one in a curve, whose scale has changed since the record began; `None` if there
    /// is none.
    pub(super) fn rescaled(&self, solver: &Solver<'_>) -> Option<&str> {
        let recorded = self.trace.tracks.iter().zip(&self.signals);
        let recorded = recorded.map(|(track, signal)| (track.per_volt, signal));
        let followed = self.followed.iter().map(|followed| (followed.per_volt, &followed.signal));
        let mut changed =
            recorded.chain(followed).filter(|(before, signal)| *before != per_volt(signal, solver));
        changed.next().map(|(_, signal)| signal.name.as_str())
    }

    /// The time of the next sample by the recorder's clock; `None` if it is not before `end`, or if the run is cancelled.
    fn next_before(&self, end: f64) -> Option<f64> {
        (self.next_time < end && !self.is_cancelled).then_some(self.next_time)
    }

    /// Sets the index of the next sample in the grid.
    fn set_next_sample(&mut self, index: u64) {
        (self.next_index, self.next_time) = (index, self.grid.time(index));
    }

    /// Writes the time of a sample by the recorder's clock.
    fn push_time(&mut self, time: f64) {
        self.trace.time.push(time);
        self.last_time = time;
    }

    /// Writes a sample of all tracks at a time of the recorder's clock.
    fn write_sample(&mut self, time: f64, solver: &Solver<'_>, instant: Instant) {
        let repetition = self.trace.repetitions.len() - 1;
        self.push_time(time);
        let values = track_values(&self.signals, solver, instant);
        self.trace
            .tracks
            .iter_mut()
            .zip(values)
            .for_each(|(track, value)| track.record(repetition, time, value));
        self.flush_full_block();
    }

    /// Writes a sample of the voltages just before the last changes of mode, at a time of the recorder's clock.
    fn write_sample_before_switching(&mut self, time: f64) {
        let repetition = self.trace.repetitions.len() - 1;
        self.push_time(time);
        let voltages =
            self.signals.iter().map(|signal| self.voltages_before_switching[signal.register.index()]);
        let values = voltages.chain(self.derivatives_before_switching.iter().copied());
        self.trace
            .tracks
            .iter_mut()
            .zip(values)
            .for_each(|(track, value)| track.record(repetition, time, value));
        self.flush_full_block();
    }

    /// Writes a sample of the voltages of a kernel, in the order of the tracks, and advances to the next sample.
    fn write_kernel_sample(&mut self, time: f64, voltages: impl Iterator<Item = f64>) {
        self.push_time(time);
        self.trace.tracks.iter_mut().zip(voltages).for_each(|(track, volts)| track.volts.push(volts));
        self.set_next_sample(self.next_index + 1);
        self.flush_full_block();
    }

    /// The time by the recorder's clock at which one of some steps ends. Steps count from 0.
    fn end_of(&self, steps: Steps, step: u64) -> f64 {
        steps.end_of(step) + self.hold_time
    }

    /// The indices of all steps if a sample is due before their end, else an empty range.
    fn steps_with_samples(&self, steps: Steps) -> Range<u64> {
        let is_sample_due =
            steps.count > 0 && self.next_time < self.end_of(steps, steps.count - 1) * (1.0 + SAME_INSTANT);
        0..if is_sample_due { steps.count } else { 0 }
    }

    /// Updates the extremes by the voltages that a kernel evaluated within a step, at a time of the recorder's clock.
    /// The kernel itself tracks the voltages at the ends of steps (`StepObserver::left_fast_path`).
    fn observe_within(&mut self, time: f64, run: &KernelRun) {
        let repetition = self.trace.repetitions.len() - 1;
        let values = self.trace.tracks.iter_mut().zip(run.voltages());
        values.for_each(|(track, volts)| track.observe(repetition, time, volts));
    }

    /// The time by the recorder's clock of the sample that is due at a problem time; `None` if no sample is due.
    pub(super) fn due_sample(&self, time: f64) -> Option<f64> {
        self.next_before(self.clock(time) * (1.0 + SAME_INSTANT))
    }

    /// Writes the sample at the end of a kernel's step, if it is due at this problem time. The caller has evaluated the
    /// recorded voltages.
    pub(super) fn sample_kernel(&mut self, time: f64, run: &KernelRun) {
        let due = self.due_sample(time);
        if let Some(time) = due {
            self.write_kernel_sample(time, run.voltages());
        }
        self.is_fresh = due.is_some();
        self.report_progress(time);
    }

    /// Updates the extremes of all signals by the extrema within the last step.
    fn observe_extrema(&mut self, solver: &mut Solver<'_>) {
        let repetition = self.trace.repetitions.len() - 1;
        for (track, signal) in self.trace.tracks.iter_mut().zip(&self.signals) {
            let Some(extremes) = track.extremes.get(repetition) else { continue };
            let extrema =
                solver.extrema_outside(signal.register, [extremes.least.volts, extremes.most.volts]);
            extrema
                .into_iter()
                .flatten()
                .for_each(|(time, volts)| track.observe(repetition, time + self.hold_time, volts));
        }
    }

    /// Updates the extremes of all tracks by the present values.
    fn observe_present(&mut self, solver: &Solver<'_>) {
        let (repetition, time) = (self.trace.repetitions.len() - 1, self.clock(solver.state.time));
        let values = track_values(&self.signals, solver, Instant::Present);
        self.trace
            .tracks
            .iter_mut()
            .zip(values)
            .for_each(|(track, value)| track.observe(repetition, time, value));
    }
}

/// The signal of this name.
///
/// # Errors
/// If there is none.
fn find_signal(program: &Program, name: &str) -> Result<SignalInfo, RunError> {
    program.recordable_signal(name).cloned().ok_or_else(|| RunError::UnknownSignal(name.to_owned()))
}

/// An empty track of a signal.
fn empty_track(signal: &SignalInfo, solver: &Solver<'_>) -> Track {
    Track::new(&signal.name, &signal.unit, per_volt(signal, solver))
}

/// Empty tracks of the derivatives of a signal, one for every parameter of the settings, in their order.
fn derivative_tracks(track: &Track, solver: &Solver<'_>, settings: &RunSettings) -> Vec<Track> {
    let derivative_track = |name: &String| {
        let program = solver.setup.program;
        let parameter = &program.parameters[program.parameter(name)?];
        let value = parameter.value / parameter.declared.per_unit;
        Some(track.differentiated(name, value, &parameter.declared.unit))
    };
    settings.sensitivities.iter().filter_map(derivative_track).collect()
}

/// The values of all tracks in their order: the voltages of all signals, then the derivatives of the first signal by
/// every parameter, then those of the second signal, and so on.
fn track_values(signals: &[SignalInfo], solver: &Solver<'_>, instant: Instant) -> impl Iterator<Item = f64> {
    let is_present = matches!(instant, Instant::Present);
    let registers = if is_present { &solver.state.voltages } else { &solver.buffers.voltages };
    let voltages = signals.iter().map(|signal| registers[signal.register.index()]);
    let derivatives = solver.sensitivities.iter().flat_map(move |sensitivities| {
        let of_signal = move |signal| {
            (0..sensitivities.count())
                .map(move |index| sensitivities.derivative(index, signal, solver, is_present))
        };
        signals.iter().flat_map(of_signal)
    });
    voltages.chain(derivatives)
}

/// The value of one volt of a signal, in the unit of the signal.
fn per_volt(signal: &SignalInfo, solver: &Solver<'_>) -> f64 {
    signal.per_volt.map_or(1.0, |index| solver.state.coefficient(index) / signal.per_unit)
}
