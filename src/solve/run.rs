//! A whole run: initial condition, operate, recorded; once, or again and again.

use super::error::RunError;
use super::grid::Grid;
use super::machine::{Machine, Witness};
use crate::circuit::Circuit;
use crate::machines::REFERENCE;
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
        let need = |value: Option<f64>, key: &str, option: &str| {
            value.ok_or_else(|| {
                RunError::Plan(format!("the patch's \"run\" has no \"{key}\": give one with {option}"))
            })
        };
        let step = need(plan.step.as_ref().map(|placed| placed.value), "step", "--step")?;
        Ok(RunSettings {
            duration: need(plan.duration.as_ref().map(|placed| placed.value), "for", "--for")?,
            step,
            every: plan.every.as_ref().map_or(step, |placed| placed.value),
            repeat: plan.repeat.as_ref().map_or(1, |placed| placed.value as usize),
            hold_on_overload: plan.hold_on_overload,
            record: circuit.recorded(),
        })
    }

    fn check(&self) -> Result<(), RunError> {
        for (name, value) in [("--for", self.duration), ("--step", self.step), ("--every", self.every)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(RunError::Plan(format!("{name} takes a time above 0 s, not {value}")));
            }
        }
        let rows = self.duration / self.every * self.repeat as f64;
        if self.duration / self.step > MOST_STEPS || rows > MOST_ROWS {
            let message =
                format!("a run of {} s would take more steps or rows than can be kept", self.duration);
            return Err(RunError::Plan(message));
        }
        Ok(())
    }
}

/// More steps than this are a slip of the pen.
const MOST_STEPS: f64 = 1e12;
/// More rows than this do not fit into memory.
const MOST_ROWS: f64 = 1e9;

/// Runs a program from initial condition and records it.
///
/// # Errors
/// When the settings make no run, a signal is not known, or the run had to stop; what was recorded until
/// then is in the error where a voltage was not a number.
pub fn run(program: &Program, settings: &RunSettings) -> Result<Trace, RunError> {
    settings.check()?;
    let mut machine = Machine::new(program, settings.step)?;
    let mut recorder = Recorder::new(program, &machine, settings)?;
    for _ in 0..settings.repeat.max(1) {
        machine.initial_condition()?;
        recorder.begin(&machine);
        let outcome = machine.operate_with(settings.duration, &mut recorder);
        recorder.end(&machine);
        if let Err(error) = outcome {
            return Err(with_trace(error, recorder.trace));
        }
    }
    Ok(recorder.trace)
}

fn with_trace(error: RunError, trace: Trace) -> RunError {
    match error {
        RunError::NotANumber { element, time, .. } => {
            RunError::NotANumber { element, time, trace: Some(Box::new(trace)) }
        }
        other => other,
    }
}

/// Writes down voltages on a time grid of its own.
struct Recorder {
    trace: Trace,
    probes: Vec<Probe>,
    grid: Grid,
    next: u64,
    last: u64,
    hold_on_overload: bool,
}

impl Recorder {
    fn new(program: &Program, machine: &Machine<'_>, settings: &RunSettings) -> Result<Self, RunError> {
        let probes: Result<Vec<_>, _> = settings.record.iter().map(|name| find(program, name)).collect();
        let probes = probes?;
        let tracks = probes.iter().map(|probe| track(probe, machine)).collect();
        let grid = Grid::new(settings.every);
        let last = grid.steps_in(settings.duration);
        let (trace, hold_on_overload) = (Trace { tracks, ..Trace::default() }, settings.hold_on_overload);
        Ok(Recorder { trace, probes, grid, next: 0, last, hold_on_overload })
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
    }

    /// The next instant of the grid, if it comes before a time.
    fn next_before(&self, end: f64) -> Option<f64> {
        let time = self.grid.time(self.next);
        (self.next <= self.last && time < end).then_some(time)
    }

    fn write(&mut self, time: f64, voltage: impl Fn(usize) -> f64) {
        self.trace.time.push(time);
        for (track, probe) in self.trace.tracks.iter_mut().zip(&self.probes) {
            track.volts.push(voltage(probe.register.index()));
        }
    }
}

impl Witness for Recorder {
    /// Writes down the instants of the grid inside a stretch.
    fn stretch(&mut self, machine: &mut Machine<'_>) {
        while let Some(time) = self.next_before(machine.time() * (1.0 - SAME)) {
            machine.look_back(time);
            self.write(time, |register| machine.trial_registers[register]);
            self.next += 1;
        }
    }

    /// Writes down the instant at its end, as it is after relays have switched.
    fn arrival(&mut self, machine: &Machine<'_>) {
        if let Some(time) = self.next_before(machine.time() * (1.0 + SAME)) {
            self.write(time, |register| machine.registers[register]);
            self.next += 1;
        }
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
            *trial = value.clamp(-REFERENCE, REFERENCE);
        }
        self.evaluate_trial(time);
    }
}

fn find(program: &Program, name: &str) -> Result<Probe, RunError> {
    let found = program.signals.iter().find(|probe| probe.name == name).cloned();
    found.ok_or_else(|| RunError::Plan(format!("there is no signal {name} to record")))
}

fn track(probe: &Probe, machine: &Machine<'_>) -> Track {
    let per_volt = probe.per_volt.map_or(1.0, |index| machine.coefficient(index) / probe.per_unit);
    Track { name: probe.name.clone(), unit: probe.unit.clone(), per_volt, volts: Vec::new() }
}
