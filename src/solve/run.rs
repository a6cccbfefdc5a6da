//! A whole run: initial condition, operate, recorded; once, or again and again.

use super::error::{RunError, Stopped, TimeSetting};
use super::grid::Grid;
use super::machine::{Machine, Witness};
use crate::circuit::Circuit;
use crate::patch::RunPlan;
use crate::program::{Probe, Program};
use crate::trace::{Sweep, Trace, Track};

/// How to run. Times are in problem seconds.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSettings {
    /// Length of a run, above 0. Longer shows more.
    pub duration: f64,
    /// Step of the solver, above 0. Shorter is more accurate (order 4 where the circuit is smooth) and slower.
    pub step: f64,
    /// Time between recorded samples, above 0. Recording never changes the steps.
    pub every: f64,
    /// Number of runs from initial condition, at least 1 (repetitive operation).
    pub repeat: usize,
    /// Whether the machine goes into hold as soon as a lamp lights.
    pub hold_on_overload: bool,
    /// Names of the signals to record, in order.
    pub record: Vec<String>,
}

impl RunSettings {
    /// What the patch asks for.
    ///
    /// # Errors
    /// When the patch does not say how long to run or with which step.
    pub fn of(circuit: &Circuit) -> Result<RunSettings, RunError> {
        RunSettings::new(circuit.run_plan(), circuit)
    }

    /// What a plan asks for; recorded is what the patch records and what its pictures show.
    ///
    /// # Errors
    /// When the plan does not say how long to run or with which step.
    pub fn new(plan: &RunPlan, circuit: &Circuit) -> Result<RunSettings, RunError> {
        let (Some(duration), Some(step)) = (&plan.duration, &plan.step) else { return Err(missing(plan)) };
        Ok(RunSettings {
            duration: duration.value,
            step: step.value,
            every: plan.every.as_ref().map_or(step.value, |placed| placed.value),
            repeat: plan.repeat.as_ref().map_or(1, |placed| placed.value as usize),
            hold_on_overload: plan.hold_on_overload,
            record: circuit.recorded(),
        })
    }

    /// Whether a run can be made of the settings.
    ///
    /// # Errors
    /// When a time is none, the step or the time between samples is longer than the run, or the run would
    /// take more steps or more memory than can be had.
    pub fn check(&self) -> Result<(), RunError> {
        let parts = [(TimeSetting::Step, self.step), (TimeSetting::Every, self.every)];
        for (which, value) in [(TimeSetting::Duration, self.duration)].into_iter().chain(parts) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RunError::NotATime { which, value });
            }
        }
        for (which, value) in parts {
            if value > self.duration * (1.0 + SAME) {
                return Err(RunError::LongerThanRun { which, value, duration: self.duration });
            }
        }
        self.check_size()
    }

    fn check_size(&self) -> Result<(), RunError> {
        let repeat = self.repeat.max(1) as f64;
        let steps = self.duration / self.step * repeat;
        if steps > MOST_STEPS {
            return Err(RunError::TooManySteps { steps, most: MOST_STEPS });
        }
        let rows = ((self.duration / self.every).floor() + 1.0) * repeat;
        let numbers = rows * (self.record.len() + 1) as f64;
        if numbers > MOST_NUMBERS {
            return Err(RunError::TooManyNumbers { numbers, most: MOST_NUMBERS });
        }
        Ok(())
    }
}

fn missing(plan: &RunPlan) -> RunError {
    let times = [(TimeSetting::Duration, &plan.duration), (TimeSetting::Step, &plan.step)];
    RunError::Missing(times.iter().filter(|(_, given)| given.is_none()).map(|(which, _)| *which).collect())
}

/// More steps than this, a day's work, are a slip of the pen.
const MOST_STEPS: f64 = 1e11;
/// The numbers of a trace take 8 bytes each, and as much again while they are written.
const MOST_NUMBERS: f64 = 2e8;

/// Runs a program from initial condition and records it.
///
/// # Errors
/// When the settings make no run, a signal is not known, or the run had to stop; what was recorded until
/// then comes with the error.
pub fn run(program: &Program, settings: &RunSettings) -> Result<Trace, Stopped> {
    run_watched(program, settings, &mut |_| ())
}

/// The same, telling after every step how many seconds of problem time have been run, repetitions added up.
///
/// # Errors
/// Those of [`run`].
pub fn run_watched(
    program: &Program,
    settings: &RunSettings,
    progress: &mut dyn FnMut(f64),
) -> Result<Trace, Stopped> {
    settings.check()?;
    let mut machine = Machine::new(program, settings.step)?;
    let mut recorder = Recorder::new(program, &machine, settings, progress)?;
    for _ in 0..settings.repeat.max(1) {
        if let Err(error) = sweep(&mut machine, &mut recorder, settings.duration) {
            return Err(Stopped { error, trace: Box::new(recorder.trace) });
        }
    }
    Ok(recorder.trace)
}

fn sweep(machine: &mut Machine<'_>, recorder: &mut Recorder<'_>, duration: f64) -> Result<(), RunError> {
    machine.initial_condition()?;
    recorder.begin(machine);
    let outcome = machine.operate_with(duration, recorder);
    recorder.end(machine);
    outcome
}

/// Writes down voltages on a time grid of its own.
struct Recorder<'a> {
    trace: Trace,
    progress: &'a mut dyn FnMut(f64),
    /// Time run before this sweep.
    before: f64,
    probes: Vec<Probe>,
    grid: Grid,
    next: u64,
    last: u64,
    hold_on_overload: bool,
}

impl<'a> Recorder<'a> {
    fn new(
        program: &Program,
        machine: &Machine<'_>,
        settings: &RunSettings,
        progress: &'a mut dyn FnMut(f64),
    ) -> Result<Self, RunError> {
        let probes: Result<Vec<_>, _> = settings.record.iter().map(|name| find(program, name)).collect();
        let probes = probes?;
        let tracks = probes.iter().map(|probe| track(probe, machine)).collect();
        let grid = Grid::new(settings.every);
        let last = grid.steps_in(settings.duration);
        let trace = Trace { tracks, ..Trace::default() };
        let hold_on_overload = settings.hold_on_overload;
        Ok(Recorder { trace, progress, before: 0.0, probes, grid, next: 0, last, hold_on_overload })
    }

    fn begin(&mut self, machine: &Machine<'_>) {
        self.trace.sweeps.push(Sweep { first: self.trace.time.len(), ..Sweep::default() });
        self.next = 0;
        self.write(0.0, |register| machine.registers[register]);
        self.next = 1;
    }

    fn end(&mut self, machine: &Machine<'_>) {
        if let Some(sweep) = self.trace.sweeps.last_mut() {
            sweep.overloads = machine.overloads();
            sweep.end = machine.time();
            sweep.work = machine.work();
            sweep.held = machine.mode() == super::MachineMode::Hold;
        }
        self.before += machine.time();
    }

    /// The next instant of the grid, if it comes before a time.
    fn next_before(&self, end: f64) -> Option<f64> {
        let time = self.grid.time(self.next);
        (self.next <= self.last && time < end).then_some(time)
    }

    fn write(&mut self, time: f64, voltage: impl Fn(usize) -> f64) {
        self.trace.time.push(time);
        for (track, probe) in self.trace.tracks.iter_mut().zip(&self.probes) {
            track.record(time, voltage(probe.register.index()));
        }
    }

    /// Takes note of the voltages of now.
    fn see(&mut self, machine: &Machine<'_>) {
        for (track, probe) in self.trace.tracks.iter_mut().zip(&self.probes) {
            track.see(machine.time(), machine.registers[probe.register.index()]);
        }
    }
}

impl Witness for Recorder<'_> {
    /// Writes down the instants of the grid inside a stretch, and sees its end as it is before relays switch.
    fn stretch(&mut self, machine: &mut Machine<'_>) {
        while let Some(time) = self.next_before(machine.time() * (1.0 - SAME)) {
            machine.look_back(time);
            self.write(time, |register| machine.trial_registers[register]);
            self.next += 1;
        }
        self.see(machine);
    }

    /// Writes down the instant at its end, as it is after relays have switched.
    fn arrival(&mut self, machine: &Machine<'_>) {
        self.see(machine);
        if let Some(time) = self.next_before(machine.time() * (1.0 + SAME)) {
            self.write(time, |register| machine.registers[register]);
            self.next += 1;
        }
        (self.progress)(self.before + machine.time());
    }

    fn has_seen_enough(&self, machine: &Machine<'_>) -> bool {
        self.hold_on_overload && machine.is_overloaded()
    }
}

/// Times that differ by less than this share of themselves are the same instant.
const SAME: f64 = 1e-12;

impl Machine<'_> {
    /// Works out the voltages of an instant within the last stretch, by the cubic through the states and
    /// rates at its ends (Hermite).
    fn look_back(&mut self, time: f64) {
        let length = self.time - self.last.time;
        let share = (time - self.last.time) / length;
        let rest = 1.0 - share;
        let [from_state, from_rate] = [(1.0 + 2.0 * share) * rest * rest, share * rest * rest * length];
        let [to_state, to_rate] = [share * share * (3.0 - 2.0 * share), -share * share * rest * length];
        for (index, trial) in self.trial.iter_mut().enumerate() {
            let value = from_state * self.last.states[index]
                + from_rate * self.last.rates[index]
                + to_state * self.states[index]
                + to_rate * self.rates[0][index];
            let [low, high] = self.program.states[index].limits.map(|limit| self.registers[limit.index()]);
            *trial = if value < low {
                low
            } else if value > high {
                high
            } else {
                value
            };
        }
        self.evaluate_trial(time);
    }
}

fn find(program: &Program, name: &str) -> Result<Probe, RunError> {
    let found = program.signals.iter().find(|probe| probe.name == name).cloned();
    found.ok_or_else(|| RunError::UnknownSignal(name.to_owned()))
}

fn track(probe: &Probe, machine: &Machine<'_>) -> Track {
    let per_volt = probe.per_volt.map_or(1.0, |index| machine.coefficient(index) / probe.per_unit);
    Track::new(&probe.name, &probe.unit, per_volt)
}
