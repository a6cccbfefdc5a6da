//! The machine in its modes, and the clock of the panel.
//!
//! The clock advances only by [`Bench::advance`]. The machine follows it by the speed factor, as far as the host gives
//! time to compute. Whatever it cannot compute in time is dropped, and the frame says by what factor it is slower.
//!
//! `phases` plays the phases of a mode, `way_back` moves the machine to another time of its run, and `settings` has the
//! times of a run.

mod phases;
mod settings;
mod way_back;

use patchcord_core::solve::{Machine, Phase, RunError};

use self::settings::run_settings;
use super::live_machine::{Live, LiveMachine, continue_run, live_machine};
use crate::command::Mode;
use crate::compiled::Compiled;
use crate::limits::MAX_DELAY_BYTES;
use crate::scope::Scope;
use crate::wiring::Output;

/// Length of the run of a patch that gives none, in problem seconds.
const DEFAULT_SWEEP: f64 = 10.0;
/// Number of steps after which the host is asked whether there is time for more.
const STEPS_BETWEEN_QUESTIONS: u64 = 200;
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
    /// Whether there is no machine for the present patch: it does not compile, or its run cannot begin. The machine of
    /// the patch before, if there is one, keeps its state and waits.
    pub is_blocked: bool,
    /// Why the machine stopped.
    pub stopped: Option<String>,
    /// The time by the recorder's clock to which the machine is on its way, in seconds; `None` if it is not.
    way_back: Option<f64>,
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
            way_back: None,
            ahead: 0.0,
            last_point: f64::INFINITY,
            repetitions: 0,
            factor: 1.0,
            watched: Vec::new(),
        }
    }

    /// Whether the machine can move: its patch is the present one, and it did not stop.
    pub(super) fn is_ready(&self) -> bool {
        !self.is_blocked && self.stopped.is_none()
    }

    /// Takes another patch. With `None`, which stands for a patch that does not compile, the machine waits. Otherwise it
    /// continues with the states of the present one, unless `resets`, or if there is none that runs. With both, there is
    /// no machine until the patch compiles. A machine that cannot continue stops in initial condition.
    pub(super) fn set_patch(
        &mut self,
        compiled: Option<&Compiled>,
        resets: bool,
        probes: &Probes,
        scopes: &mut [Scope],
    ) {
        let Some(Compiled { circuit, program }) = compiled else {
            self.is_blocked = true;
            if resets {
                (self.machine, self.plan, self.plan_length, self.stopped) = (None, None, None, None);
                self.way_back = None;
                self.begin_mode(scopes);
            }
            return;
        };
        self.forget_later(scopes);
        self.plan = circuit.run_plan().all_phases();
        self.plan_length = circuit.run_plan().longest_repetition();
        let old = self.machine.take().filter(|_| !resets && self.stopped.is_none());
        let resets = resets || old.is_none();
        let outcome = live_machine(program, &run_settings(circuit, self.controls.sweep)).and_then(|new| {
            let machine = self.machine.insert(new);
            old.map_or(Ok(()), |old| continue_run(machine, old))
        });
        self.stopped = outcome.err().map(|error| error.to_string());
        self.is_blocked = self.machine.is_none();
        self.watch(probes, scopes);
        if resets {
            self.begin_mode(scopes);
        }
    }

    /// Length of a sweep in problem seconds.
    pub(super) fn sweep(&self) -> f64 {
        self.controls.sweep.or(self.plan_length).unwrap_or(DEFAULT_SWEEP)
    }

    /// Selects a mode and begins it.
    pub(super) fn set_mode(&mut self, mode: Mode, scopes: &mut [Scope]) {
        self.end_way_back(scopes);
        let before = self.controls.mode;
        self.controls.mode = mode;
        // Without a machine, no mode removes the reason.
        if self.machine.is_some() && !matches!(mode, Mode::Hold | Mode::Operate) {
            self.stopped = None;
        }
        let continues = matches!(before, Mode::Operate | Mode::Hold | Mode::Repetitive | Mode::Single);
        match mode {
            Mode::Hold => {}
            Mode::Operate if continues => {
                self.forget_later(scopes);
                if self.with_live(|live| Ok(live.plays)).flatten() != Some(Mode::Operate) {
                    self.play_phases(&[Phase::operate(self.sweep())]);
                    self.with_live(|live| live.note_change());
                }
            }
            _ => self.begin_mode(scopes),
        }
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

    /// The earliest time to which the machine can be moved back, in seconds; `None` if it cannot.
    pub(super) fn oldest(&mut self) -> Option<f64> {
        self.with_live(|live| Ok(live.oldest())).flatten()
    }

    /// The end of the run in seconds, if the machine was moved back and can be moved forward again.
    pub(super) fn latest(&mut self) -> Option<f64> {
        self.with_live(|live| Ok(live.latest())).flatten()
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
        self.forget_later(scopes);
        self.with_live(|live| live.note_turned(name, value));
        Ok(())
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

    /// Whether problem time advances with the clock, or the machine is on its way to another time.
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
}
