//! The machine in its modes, and the clock of the panel.
//!
//! The clock advances only by [`Bench::advance`]. The machine follows it by the speed factor, as far as the host gives
//! time to compute. Whatever it cannot compute in time is dropped, and the frame says by what factor it is slower.

use std::sync::Arc;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::solve::{LiveState, Machine, Phase, RunError, RunSettings};

use super::live_machine::{Live, LiveMachine, live_machine};
use crate::command::Mode;
use crate::compiled::Compiled;
use crate::limits::MAX_DELAY_BYTES;
use crate::scope::Scope;
use crate::wiring::Output;

/// Length of the run of a patch that gives none, in problem seconds.
const DEFAULT_SWEEP: f64 = 10.0;
/// Steps of a sweep if the patch gives no step.
const DEFAULT_STEPS: f64 = 10_000.0;
/// Number of steps after which the host is asked whether there is time for more.
const STEPS_BETWEEN_QUESTIONS: u64 = 200;
/// Largest number of consecutive phases that take no time in one advance. An overload can end every sweep at its
/// beginning, and a run can have millions of initial conditions.
const MAX_IDLE_PHASES: usize = 1000;
/// Largest change of a voltage between two points of an X-Y curve, in volts, if steps are long.
const CURVE_VOLTS: f64 = 0.5;

/// The outputs of a patch by their names at the panel, and the elements behind them.
#[derive(Debug, Clone, Default)]
pub(super) struct Probes(pub Vec<Output>);

impl Probes {
    /// The element behind an output.
    pub(super) fn element(&self, output: &str) -> Option<&str> {
        self.0.iter().find(|known| known.name == output).map(|known| known.element.as_str())
    }
}

/// The controls of the machine that a user sets, apart from the patch.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Controls {
    /// The mode.
    pub mode: Mode,
    /// Problem seconds per second of the clock; `None` for as fast as possible.
    pub speed: Option<f64>,
    /// Whether the clock stands.
    pub paused: bool,
    /// Length of a sweep in problem seconds; `None` for that of the patch.
    pub sweep: Option<f64>,
    /// Sweeps per second of the clock; `None` if the speed decides.
    pub rate: Option<f64>,
}

impl Default for Controls {
    fn default() -> Self {
        Controls { mode: Mode::InitialCondition, speed: Some(1.0), paused: false, sweep: None, rate: None }
    }
}

/// The way back to an earlier time. A checkpoint before it was restored, and the run is repeated from there.
struct WayBack {
    /// The time by the recorder's clock, in seconds.
    goal: f64,
    /// The parameters that the machine gets there.
    parameters: Vec<(String, f64)>,
}

/// The machine, its controls and its clock.
pub(super) struct Bench {
    /// The controls.
    pub controls: Controls,
    /// The machine; `None` if no patch has compiled yet.
    machine: Option<LiveMachine>,
    /// The phases of the patch's run; `None` if it gives no duration.
    plan: Option<Vec<Phase>>,
    /// Length of the longest repetition in the plan, in problem seconds.
    plan_length: Option<f64>,
    /// Whether the present patch does not compile. The machine keeps its state and waits.
    pub is_blocked: bool,
    /// Why the machine stopped.
    pub stopped: Option<String>,
    /// The mode for which the machine plays its phases; `None` before the first one and after the machine went back.
    plays: Option<Mode>,
    /// The way back to an earlier time, if the machine is on it.
    way_back: Option<WayBack>,
    /// Problem seconds by which the machine is ahead of the clock, because it was held or took a step across it;
    /// negative if it is behind by less than a step.
    ahead: f64,
    /// The time of the last point that the scopes got; infinity if the next one begins a run.
    last_point: f64,
    /// Repetitions since repetitive operation began.
    pub repetitions: u32,
    /// Problem time covered by the last advance, relative to what it should have covered.
    pub factor: f64,
    /// The outputs that the scopes watch, two for each.
    watched: Vec<Option<String>>,
}

impl Bench {
    /// A bench without a machine.
    pub(super) fn new() -> Self {
        Bench {
            controls: Controls::default(),
            machine: None,
            plan: None,
            plan_length: None,
            is_blocked: true,
            stopped: None,
            plays: None,
            way_back: None,
            ahead: 0.0,
            last_point: f64::INFINITY,
            repetitions: 0,
            factor: 1.0,
            watched: Vec::new(),
        }
    }

    /// Whether the machine can move: there is one, its patch is the present one, and it did not stop.
    pub(super) fn is_ready(&self) -> bool {
        self.machine.is_some() && !self.is_blocked && self.stopped.is_none()
    }

    /// Takes another patch. With `None`, which stands for a patch that does not compile, the machine waits. Otherwise it
    /// continues with the states of the present one, unless `resets`, or if there is none that runs.
    pub(super) fn set_patch(
        &mut self,
        compiled: Option<&Compiled>,
        resets: bool,
        probes: &Probes,
        scopes: &mut [Scope],
    ) {
        let Some(Compiled { circuit, program }) = compiled else {
            self.is_blocked = true;
            return;
        };
        self.end_way_back(scopes);
        self.is_blocked = false;
        self.plan = circuit.run_plan().all_phases();
        self.plan_length = circuit.run_plan().longest_repetition();
        let old = self.machine.take().filter(|_| !resets && self.stopped.is_none());
        let resets = resets || old.is_none();
        self.stopped = None;
        match continued(program, &run_settings(circuit, self.controls.sweep), old) {
            Ok(machine) => self.machine = Some(machine),
            Err(error) => self.stopped = Some(error.to_string()),
        }
        self.watch(probes, scopes);
        if resets {
            self.begin_mode(scopes);
        }
    }

    /// Length of a sweep in problem seconds.
    pub(super) fn sweep(&self) -> f64 {
        self.controls.sweep.or(self.plan_length).unwrap_or(DEFAULT_SWEEP)
    }

    /// The phases of one sweep: those of the patch, unless the user has set another length.
    fn sweep_phases(&self) -> Vec<Phase> {
        match (self.controls.sweep, &self.plan) {
            (None, Some(phases)) => phases.clone(),
            _ => vec![Phase::InitialCondition, Phase::operate(self.sweep())],
        }
    }

    /// Selects a mode and begins it.
    pub(super) fn set_mode(&mut self, mode: Mode, scopes: &mut [Scope]) {
        self.end_way_back(scopes);
        let before = self.controls.mode;
        self.controls.mode = mode;
        if self.stopped.is_some() && !matches!(mode, Mode::Hold | Mode::Operate) {
            self.stopped = None;
        }
        let continues = matches!(before, Mode::Operate | Mode::Hold | Mode::Repetitive | Mode::Single);
        match mode {
            Mode::Hold => {}
            Mode::Operate if continues => {
                if self.plays != Some(Mode::Operate) {
                    self.play_phases(&[Phase::operate(self.sweep())]);
                }
            }
            _ => self.begin_mode(scopes),
        }
    }

    /// Begins the mode from initial condition.
    fn begin_mode(&mut self, scopes: &mut [Scope]) {
        let phases = match self.controls.mode {
            Mode::Repetitive | Mode::Single => self.sweep_phases(),
            Mode::Operate => vec![Phase::InitialCondition, Phase::operate(self.sweep())],
            Mode::Hold | Mode::PotSet | Mode::ProblemCheck | Mode::InitialCondition => {
                vec![Phase::InitialCondition]
            }
        };
        (self.repetitions, self.ahead, self.last_point) = (0, 0.0, f64::INFINITY);
        self.play_phases(&phases);
        self.with_live(|live| {
            live.forget_checkpoints();
            Ok(())
        });
        self.follow(0.0, scopes, &mut || false);
    }

    /// Replaces the phases that the machine plays, and drops the records of those that it has played.
    fn play_phases(&mut self, phases: &[Phase]) {
        self.plays = Some(self.controls.mode);
        self.with_live(|live| {
            live.run.replace_phases(phases)?;
            live.run.take_samples();
            Ok(())
        });
    }

    /// Calls a function on the machine, if there is one. An error stops the machine.
    fn with_live<T>(&mut self, action: impl FnOnce(&mut Live<'_>) -> Result<T, RunError>) -> Option<T> {
        let machine = self.machine.as_mut()?;
        match machine.with_dependent_mut(|_, live| action(live)) {
            Ok(value) => Some(value),
            Err(error) => {
                self.stopped = Some(error.to_string());
                None
            }
        }
    }

    /// Reads the machine at the present instant.
    pub(super) fn read<T>(&mut self, reading: impl FnOnce(&Machine<'_>) -> T) -> Option<T> {
        self.with_live(|live| live.run.machine().map(reading))
    }

    /// The recorder's clock in seconds.
    pub(super) fn clock(&mut self) -> f64 {
        self.with_live(|live| Ok(live.run.clock())).unwrap_or(0.0)
    }

    /// The earliest time to which the machine can be moved back, in seconds; its present time if it cannot.
    pub(super) fn oldest(&mut self) -> f64 {
        self.with_live(|live| Ok(live.oldest().unwrap_or(live.run.clock()))).unwrap_or(0.0)
    }

    /// Sets a parameter at the present instant.
    ///
    /// # Errors
    /// The message if the machine refuses it. Nothing is changed then.
    pub(super) fn set_parameter(
        &mut self,
        name: &str,
        value: f64,
        scopes: &mut [Scope],
    ) -> Result<(), String> {
        self.end_way_back(scopes);
        let Some(machine) = &mut self.machine else { return Ok(()) };
        machine.with_dependent_mut(|_, live| {
            live.run.set_parameters([(name, value)]).map_err(|error| error.to_string())
        })?;
        self.with_live(|live| live.note_change());
        Ok(())
    }

    /// Moves the machine back to an earlier time of its run, and holds it there. `parameters` are those that it gets
    /// there. If the host has no time for the whole way, the next advances continue it.
    ///
    /// # Errors
    /// The message if the time is not within the run, or if the machine waits for a patch without faults.
    pub(super) fn scrub(
        &mut self,
        time: f64,
        parameters: Vec<(String, f64)>,
        scopes: &mut [Scope],
        must_stop: &mut dyn FnMut() -> bool,
    ) -> Result<(), String> {
        if self.is_blocked {
            return Err("the patch has faults: correct them before the machine goes back".to_owned());
        }
        let clock = self.clock();
        let goal = self.with_live(|live| Ok(if time <= clock { live.return_before(time) } else { None }));
        let Some(goal) = goal.flatten() else {
            let oldest = self.oldest();
            return Err(format!(
                "the machine can be moved back to {oldest} ... {clock} s of its run, not to {time} s"
            ));
        };
        (self.stopped, self.controls.mode, self.plays) = (None, Mode::Hold, None);
        self.way_back = Some(WayBack { goal, parameters });
        self.follow_way_back(scopes, must_stop);
        Ok(())
    }

    /// Follows the way back as far as the host gives time.
    fn follow_way_back(&mut self, scopes: &mut [Scope], must_stop: &mut dyn FnMut() -> bool) {
        let Some(goal) = self.way_back.as_ref().map(|way| way.goal) else { return };
        let further = Phase::operate(self.sweep());
        let arrives = self.with_live(|live| play_up_to(live, goal, &further, must_stop));
        if arrives != Some(false) {
            self.end_way_back(scopes);
        }
    }

    /// Ends the way back at the present instant, if the machine is on one: it gets the present parameters, and the scopes
    /// go back to this point.
    fn end_way_back(&mut self, scopes: &mut [Scope]) {
        let (Some(way), Some(machine)) = (self.way_back.take(), &mut self.machine) else { return };
        let watched = &self.watched;
        let outcome = machine.with_dependent_mut(|_, live| {
            live.run.set_parameters(way.parameters.iter().map(|(name, value)| (name, *value)))?;
            if let Some((time, volts)) = live.run.points().iter().last() {
                pass_point(time, volts, watched, scopes);
            }
            live.run.points().clear();
            live.note_change()
        });
        if let Err(error) = outcome {
            self.stopped = Some(error.to_string());
        }
        (self.ahead, self.last_point) = (0.0, self.clock());
    }

    /// Connects the probes of the scopes.
    pub(super) fn watch(&mut self, probes: &Probes, scopes: &[Scope]) {
        let channels = scopes.iter().flat_map(|scope| scope.controls().channels.iter());
        let element = |output: &Option<String>| probes.element(output.as_deref()?).map(str::to_owned);
        self.watched = channels.map(|channel| element(&channel.output)).collect();
        let resolution = scopes.iter().map(Scope::resolution).fold(f64::INFINITY, f64::min);
        let needs_curve = scopes.iter().any(Scope::needs_curve);
        let largest = if needs_curve { CURVE_VOLTS } else { f64::INFINITY };
        let Some(machine) = &mut self.machine else { return };
        let outputs = machine.borrow_owner().element_outputs();
        let is_there = |name: &String| outputs.iter().any(|output| output.name == *name);
        self.watched.iter_mut().for_each(|name| *name = name.take().filter(is_there));
        let names: Vec<String> = self.watched.iter().flatten().cloned().collect();
        self.with_live(|live| live.run.watch(&names, resolution, largest));
    }

    /// Whether the mode lets problem time advance.
    fn moves(&self) -> bool {
        matches!(self.controls.mode, Mode::Operate | Mode::Repetitive | Mode::Single)
    }

    /// Whether problem time advances with the clock, or the machine is on its way back.
    pub(super) fn is_moving(&self) -> bool {
        let follows_clock = self.moves() && !self.controls.paused;
        (follows_clock || self.way_back.is_some()) && self.is_ready()
    }

    /// Problem seconds in a number of seconds of the clock; infinity for as many as possible.
    fn problem_seconds(&self, seconds: f64) -> f64 {
        let speed = match (self.controls.mode, self.controls.rate) {
            (Mode::Repetitive, Some(rate)) => Some(rate * self.sweep()),
            _ => self.controls.speed,
        };
        // The sweep of a patch may be as long as numbers permit.
        speed.map_or(f64::INFINITY, |speed| seconds * speed.min(f64::MAX))
    }

    /// Advances the clock by seconds. `must_stop` says whether the host has no more time.
    pub(super) fn advance(
        &mut self,
        seconds: f64,
        scopes: &mut [Scope],
        must_stop: &mut dyn FnMut() -> bool,
    ) {
        self.factor = 1.0;
        if !self.is_moving() {
            return;
        }
        if self.way_back.is_some() {
            return self.follow_way_back(scopes, must_stop);
        }
        let asked = self.problem_seconds(seconds);
        let done = self.follow(asked, scopes, must_stop);
        let expected = if asked.is_finite() { asked } else { seconds };
        if expected > 0.0 {
            self.factor = done / expected;
        }
        self.check_memory();
    }

    /// Stops a machine whose delays have stored more than is permitted.
    fn check_memory(&mut self) {
        if self.read(|machine| machine.delay_bytes()).is_some_and(|bytes| bytes > MAX_DELAY_BYTES) {
            let megabytes = MAX_DELAY_BYTES / 1_000_000;
            self.stopped = Some(format!(
                "the delays store more than {megabytes} MB: use shorter delays, fewer of them, or longer steps"
            ));
        }
    }

    /// Lets the machine follow the clock by problem seconds, which may be infinite. Returns those that it covered.
    fn follow(&mut self, asked: f64, scopes: &mut [Scope], must_stop: &mut dyn FnMut() -> bool) -> f64 {
        let (mut left, mut done, mut idle_phases) = (asked - self.ahead, 0.0, 0);
        while self.stopped.is_none() && self.has_phase_to_play(left) {
            let before = self.clock();
            let outcome = self.with_live(|live| live.run.advance(before + left, STEPS_BETWEEN_QUESTIONS));
            let after = self.clock();
            self.pass_points(scopes);
            if after < before {
                self.begin_repetition();
            } else {
                (left, done) = (left - (after - before), done + (after - before));
                // The time that is left is shorter than a step, or the machine is ahead.
                if left <= 0.0 || outcome == Some(LiveState::Operating) && after == before {
                    break;
                }
            }
            idle_phases = if after == before { idle_phases + 1 } else { 0 };
            if must_stop() || idle_phases == MAX_IDLE_PHASES {
                left = 0.0;
                break;
            }
        }
        self.ahead = if left.is_finite() { -left } else { 0.0 };
        done.min(asked)
    }

    /// Whether the machine has something to play while `left` problem seconds are left: a phase without a duration, or
    /// one in which it operates. Modes without end get new phases. After an overload that holds the machine, the mode is
    /// hold.
    fn has_phase_to_play(&mut self, left: f64) -> bool {
        let position =
            self.with_live(|live| Ok((live.run.is_finished(), live.run.is_operating(), live.run.is_held())));
        let Some((is_finished, is_operating, is_held)) = position else { return false };
        if !is_finished {
            return left > 0.0 || !is_operating;
        }
        let phases = match self.controls.mode {
            Mode::Operate if !is_held => vec![Phase::operate(self.sweep())],
            Mode::Repetitive => self.sweep_phases(),
            Mode::Operate | Mode::Single => {
                self.controls.mode = Mode::Hold;
                return false;
            }
            _ => return false,
        };
        if left > 0.0 {
            self.play_phases(&phases);
        }
        left > 0.0
    }

    /// Notes that the machine was put into initial condition.
    fn begin_repetition(&mut self) {
        if self.controls.mode == Mode::Repetitive {
            self.repetitions = self.repetitions.wrapping_add(1);
        }
        self.with_live(|live| {
            live.forget_checkpoints();
            live.run.take_samples();
            Ok(())
        });
    }

    /// Passes the watched points on to the scopes. A point at an earlier time than the last begins a run. In modes in
    /// which the machine does not move, the points are dropped.
    fn pass_points(&mut self, scopes: &mut [Scope]) {
        let (moves, sweep, mut last) = (self.moves(), self.sweep(), self.last_point);
        let keeps_checkpoints = moves && self.controls.mode != Mode::Repetitive;
        let watched = &self.watched;
        let Some(machine) = &mut self.machine else { return };
        let outcome = machine.with_dependent_mut(|_, live| {
            for (time, volts) in live.run.points().iter().filter(|_| moves) {
                if time < last {
                    scopes.iter_mut().for_each(|scope| scope.begin_run(sweep));
                }
                last = time;
                pass_point(time, volts, watched, scopes);
            }
            live.run.points().clear();
            if keeps_checkpoints { live.keep_checkpoint(false) } else { Ok(()) }
        });
        self.last_point = last;
        if let Err(error) = outcome {
            self.stopped = Some(error.to_string());
        }
    }
}

/// Passes one point on. `watched` has the names at the probes, two for each scope; `volts` has the voltages of those that
/// are connected.
fn pass_point(time: f64, volts: &[f64], watched: &[Option<String>], scopes: &mut [Scope]) {
    let mut volts = volts.iter().copied();
    for (scope, probes) in scopes.iter_mut().zip(watched.chunks(2)) {
        let mut channels = [f64::NAN; 2];
        for (channel, probe) in channels.iter_mut().zip(probes) {
            if probe.is_some() {
                *channel = volts.next().unwrap_or(f64::NAN);
            }
        }
        scope.point(time, channels);
    }
}

/// Plays a run up to a time by the recorder's clock, within a step, and keeps the last points only. `further` is the
/// phase that operation without end has after each other one. Returns whether the run arrives there before the host has
/// no more time.
///
/// # Errors
/// If the run has to stop.
fn play_up_to(
    live: &mut Live<'_>,
    clock: f64,
    further: &Phase,
    must_stop: &mut dyn FnMut() -> bool,
) -> Result<bool, RunError> {
    loop {
        let before = live.run.clock();
        if before >= clock || live.run.is_held() {
            return Ok(true);
        }
        if live.run.is_finished() {
            live.run.replace_phases(std::slice::from_ref(further))?;
        }
        live.run.points().clear();
        let state = live.run.advance(clock, STEPS_BETWEEN_QUESTIONS)?;
        if state == LiveState::Operating && live.run.clock() == before {
            return Ok(true);
        }
        if must_stop() {
            return Ok(false);
        }
    }
}

/// A machine in initial condition, or one that continues the run of another machine.
///
/// # Errors
/// If the times of the patch are not valid, or the voltages cannot be evaluated.
fn continued(
    program: &Arc<Program>,
    settings: &RunSettings,
    old: Option<LiveMachine>,
) -> Result<LiveMachine, RunError> {
    let mut machine = live_machine(program, settings)?;
    if let Some(mut old) = old {
        machine.with_dependent_mut(|_, new| {
            old.with_dependent_mut(|_, old| new.run.continue_from(&mut old.run))
        })?;
    }
    Ok(machine)
}

/// The settings of a live run of a patch. A patch without times gets usual ones, so that it can be tried while it is
/// built.
fn run_settings(circuit: &Circuit, sweep: Option<f64>) -> RunSettings {
    let plan = circuit.run_plan();
    let usual = || {
        let phases = plan.all_phases();
        let phases = phases.unwrap_or_else(|| vec![Phase::InitialCondition, Phase::operate(DEFAULT_SWEEP)]);
        let settings = RunSettings::from_phases(phases, 1.0);
        let step = plan.step.as_ref().map_or(settings.duration() / DEFAULT_STEPS, |step| step.value);
        settings.with_step(step)
    };
    let settings = RunSettings::of(circuit).unwrap_or_else(|_| usual());
    let settings = match sweep {
        Some(sweep) => settings.with_duration(sweep),
        None => settings,
    };
    let nothing: [String; 0] = [];
    let every = settings.duration();
    settings.with_signals(nothing.clone()).with_sensitivities(nothing).with_sample_interval(every)
}
