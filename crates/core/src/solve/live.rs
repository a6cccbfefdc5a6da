//! A run that is played in pieces, for an operator who watches it and interferes.
//!
//! [`run`](super::run()) plays all phases at once. A [`LiveRun`] plays the same phases with the same steps, so its
//! samples have the same bits, but returns to the caller whenever that is wanted. In between, parameters can be set,
//! probes moved, and the machine moved to a [`Checkpoint`].

use super::error::RunError;
use super::fast_path::Halt;
use super::machine::Machine;
use super::operation::Operation;
use super::player::{OperatePhase, Player, has_initial_condition_first};
use super::recorder::{EndCondition, Watch, WatchedPoints};
use super::run::prepare_player;
use super::settings::RunSettings;
use crate::document::Phase;
use crate::ir::{Program, Register};
use crate::kernel::Backend;
use crate::trace::Trace;

/// A run that is played in pieces.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::ir::Program;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_core::solve::{LiveRun, LiveState, RunSettings, run};
///
/// // dx/dt = -x, from 50 V
/// let decay = ElementBuilder::new("integrator").cords("x1", ["A1"]).set("initial", 50);
/// let patch = PatchBuilder::new("decay").element("A1", decay).run(1.0, 1e-3).build()?;
/// let circuit = Circuit::new(&patch)?;
/// let program = Program::new(&circuit)?;
/// let settings = RunSettings::of(&circuit)?;
/// let mut live = LiveRun::new(&program, &settings)?;
/// live.watch(&["A1"], 0.01, f64::INFINITY)?;
/// let (mut time, mut volts) = (0.0, Vec::new());
/// while live.advance(time, u64::MAX)? != LiveState::Finished {
///     volts.extend(live.take_samples().tracks.remove(0).volts);
///     time += 0.125;
/// }
/// volts.extend(live.take_samples().tracks.remove(0).volts);
/// assert_eq!(volts, run(&program, &settings)?.tracks[0].volts);
/// assert_eq!(live.points().iter().last().map(|(time, _)| time), Some(1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct LiveRun<'p> {
    /// The machine, and the record of the run.
    player: Player<'p, 'static>,
    /// The phases that are left.
    queue: PhaseQueue,
    /// The phase in which the machine operates; `None` between phases.
    operating: Option<Operating<'p>>,
    /// The backend of the machine.
    backend: Backend,
}

/// What a live run does after an advance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LiveState {
    /// The machine operates. It has reached the time or taken the steps of the advance.
    Operating,
    /// A phase has ended, and another one follows.
    BetweenPhases,
    /// All phases have been played.
    Finished,
}

/// A phase in which the machine operates, and the position in it.
#[derive(Debug, Clone, Copy)]
struct Operating<'p> {
    /// The phase.
    phase: OperatePhase<'p>,
    /// The steps that are left.
    operation: Operation,
}

/// Number of copies of a voltage or state in the buffers of a machine: at the stages and ends of steps.
const NUMBERS_PER_VOLTAGE: usize = 12;

/// A machine in the middle of a run, to which the run can return.
#[derive(Clone)]
pub struct Checkpoint<'p> {
    /// The machine.
    machine: Machine<'p>,
    /// The phases that were left.
    queue: PhaseQueue,
    /// The phase in which it operated.
    operating: Option<Operating<'p>>,
    /// Seconds in hold before.
    hold_time: f64,
    /// The change of mode that ends the phase.
    end_condition: Option<EndCondition>,
    /// Whether an overload had ended the repetition.
    is_held: bool,
}

impl Checkpoint<'_> {
    /// The time by the recorder's clock, in seconds.
    pub fn clock(&self) -> f64 {
        self.machine.time() + self.hold_time
    }

    /// An estimate of its size in bytes. Delays need most of it.
    pub fn bytes(&self) -> usize {
        let state = &self.machine.solver.state;
        let numbers = NUMBERS_PER_VOLTAGE * (state.voltages.len() + state.states.len());
        self.machine.delay_bytes() + numbers * size_of::<f64>()
    }
}

impl<'p> LiveRun<'p> {
    /// A run that has not begun. Its machine is in initial condition.
    ///
    /// # Errors
    /// Those of [`run`](super::run()) that come before the first step.
    pub fn new(program: &'p Program, settings: &RunSettings) -> Result<Self, RunError> {
        let player = prepare_player(program, settings, None)?;
        let mut queue = PhaseQueue::new(&settings.phases);
        if !has_initial_condition_first(&settings.phases) {
            queue.put_first(Phase::InitialCondition);
        }
        Ok(LiveRun { player, queue, operating: None, backend: settings.backend })
    }

    /// Continues the run: the present phase up to a time of the recorder's clock, and at most `most` steps; or the next
    /// phase. One call plays at most one phase.
    ///
    /// # Errors
    /// If the run has to stop.
    pub fn advance(&mut self, clock: f64, most: u64) -> Result<LiveState, RunError> {
        if self.operating.is_none() {
            let Some(phase) = self.queue.next() else { return Ok(LiveState::Finished) };
            let state = self.begin(&phase)?;
            if state != LiveState::Operating {
                return Ok(state);
            }
        }
        self.operate(clock, most)
    }

    /// Continues the phase in which the machine operates, up to a time of the recorder's clock.
    ///
    /// # Errors
    /// If the run has to stop.
    fn operate(&mut self, clock: f64, most: u64) -> Result<LiveState, RunError> {
        let Some(mut operating) = self.operating.take() else { return Ok(LiveState::BetweenPhases) };
        let Player { machine, recorder, .. } = &mut self.player;
        let time = clock - recorder.hold_time;
        match machine.continue_up_to(&mut operating.operation, time, most, recorder) {
            Ok(false) => {
                self.operating = Some(operating);
                Ok(LiveState::Operating)
            }
            Ok(true) => self.end_operating(operating, Ok(())),
            Err(error) => self.end_operating(operating, Err(error)),
        }
    }

    /// Plays a phase, or begins it if the machine operates in it.
    ///
    /// # Errors
    /// If the phase cannot be played.
    fn begin(&mut self, phase: &Phase) -> Result<LiveState, RunError> {
        let player = &mut self.player;
        match phase {
            Phase::Operate { time, until } => {
                if let Some(phase) = player.begin_operating(*time, until.as_ref())? {
                    player.recorder.watch_present(&player.machine.solver);
                    let operation = player.machine.begin_operation(phase.time)?;
                    self.operating = Some(Operating { phase, operation });
                    return Ok(LiveState::Operating);
                }
                Ok(LiveState::BetweenPhases)
            }
            phase => {
                player.play(phase)?;
                player.recorder.watch_present(&player.machine.solver);
                Ok(LiveState::BetweenPhases)
            }
        }
    }

    /// Ends the phase in which the machine operated.
    ///
    /// # Errors
    /// The error of the steps.
    fn end_operating(
        &mut self,
        operating: Operating<'p>,
        outcome: Result<(), RunError>,
    ) -> Result<LiveState, RunError> {
        let Player { machine, recorder, .. } = &mut self.player;
        let outcome = outcome.and_then(|()| machine.end_operation(operating.operation, recorder));
        self.player.end_operating(operating.phase, outcome)?;
        Ok(LiveState::BetweenPhases)
    }

    /// Replaces the phases that are left, and ends the present one.
    ///
    /// # Errors
    /// If a voltage is not a number, or a loop does not have exactly one solution.
    pub fn replace_phases(&mut self, phases: &[Phase]) -> Result<(), RunError> {
        self.leave_fast_path()?;
        self.queue = PhaseQueue::new(phases);
        match self.operating.take() {
            Some(operating) => self.player.end_operating(operating.phase, Ok(())),
            None => Ok(()),
        }
    }

    /// Whether all phases have been played.
    pub fn is_finished(&self) -> bool {
        self.operating.is_none() && self.queue.is_empty()
    }

    /// The time by the recorder's clock in seconds: problem time and the time in hold since the last initial condition.
    pub fn clock(&self) -> f64 {
        self.player.recorder.clock(self.player.machine.time())
    }

    /// Whether the machine is in the middle of a phase in which it operates.
    pub fn is_operating(&self) -> bool {
        self.operating.is_some()
    }

    /// Whether an overload has ended the repetition. Phases that take time are then skipped until the next initial
    /// condition.
    pub fn is_held(&self) -> bool {
        self.player.is_held
    }

    /// The machine at the present instant, with all its voltages.
    ///
    /// # Errors
    /// If a voltage is not a number, or a loop does not have exactly one solution.
    pub fn machine(&mut self) -> Result<&Machine<'p>, RunError> {
        self.leave_fast_path()?;
        Ok(&self.player.machine)
    }

    /// Sets parameters at the present instant, as [`Machine::set_parameters`] does.
    ///
    /// # Errors
    /// As for [`Machine::set_parameters`]. Nothing is changed then.
    pub fn set_parameters(
        &mut self,
        changes: impl IntoIterator<Item = (impl AsRef<str>, f64)>,
    ) -> Result<(), RunError> {
        self.leave_fast_path()?;
        let Player { machine, recorder, .. } = &mut self.player;
        machine.set_parameters(changes)?;
        recorder.invalidate_sample();
        recorder.adopt_scales(&machine.solver);
        recorder.watch_present(&machine.solver);
        Ok(())
    }

    /// Watches outputs from now on. The points are at most `longest` seconds apart, and usually at least eight times
    /// closer if steps are short. Within steps that are longer they are also at most `largest` volts apart, as far as 64
    /// points in a step permit. Points that were not read are dropped.
    ///
    /// # Errors
    /// If the program has no such output.
    pub fn watch(&mut self, outputs: &[impl AsRef<str>], longest: f64, largest: f64) -> Result<(), RunError> {
        self.leave_fast_path()?;
        let program = self.player.machine.solver.setup.program;
        let register = |name: &str| -> Result<Register, RunError> {
            let element = program.element(name).ok_or_else(|| RunError::UnknownElement(name.to_owned()))?;
            Ok(program.lowered.elements[element].register)
        };
        let registers: Result<Vec<_>, _> = outputs.iter().map(|name| register(name.as_ref())).collect();
        let Player { machine, recorder, .. } = &mut self.player;
        recorder.watch = Some(Watch::new(registers?, longest, largest));
        machine.fast_path.restart(self.backend, recorder.registers());
        recorder.watch_present(&machine.solver);
        Ok(())
    }

    /// The points of the watched outputs. The caller clears them after reading.
    pub fn points(&mut self) -> &mut WatchedPoints {
        let watch = self
            .player
            .recorder
            .watch
            .get_or_insert_with(|| Watch::new(Vec::new(), f64::INFINITY, f64::INFINITY));
        &mut watch.points
    }

    /// The samples since the last call, of the signals that the settings record. Records of phases and repetitions that
    /// have ended are dropped.
    pub fn take_samples(&mut self) -> Trace {
        self.player.recorder.take_samples()
    }

    /// The present instant, to which [`LiveRun::return_to`] returns.
    ///
    /// # Errors
    /// As for [`LiveRun::machine`].
    pub fn checkpoint(&mut self) -> Result<Checkpoint<'p>, RunError> {
        self.leave_fast_path()?;
        let Player { machine, recorder, is_held, .. } = &self.player;
        let mut machine = machine.clone();
        // The kernels are large, and a run that returns has to begin with new ones.
        machine.fast_path.restart(self.backend, recorder.registers());
        Ok(Checkpoint {
            machine,
            queue: self.queue.clone(),
            operating: self.operating,
            hold_time: recorder.hold_time,
            end_condition: recorder.end_condition,
            is_held: *is_held,
        })
    }

    /// Returns to another instant of the same run, which may be later. The parameters are those of that instant.
    pub fn return_to(&mut self, checkpoint: &Checkpoint<'p>) {
        let Player { machine, recorder, is_held, .. } = &mut self.player;
        machine.clone_from(&checkpoint.machine);
        machine.fast_path.restart(self.backend, recorder.registers());
        (self.queue, self.operating) = (checkpoint.queue.clone(), checkpoint.operating);
        *is_held = checkpoint.is_held;
        recorder.end_condition = checkpoint.end_condition;
        recorder.move_to(&machine.solver, &machine.lamps, checkpoint.hold_time);
        recorder.watch_present(&machine.solver);
    }

    /// Continues another run, usually of a program with other cords, from its present instant. States of elements that
    /// both programs have are taken over. The phases that are left are those of the other run.
    ///
    /// # Errors
    /// If the voltages cannot be evaluated with these states.
    pub fn continue_from(&mut self, other: &mut LiveRun<'_>) -> Result<(), RunError> {
        other.leave_fast_path()?;
        let Player { machine, recorder, is_held, .. } = &mut self.player;
        machine.take_over(&other.player.machine)?;
        self.queue = other.queue.clone();
        *is_held = other.player.is_held;
        recorder.move_to(&machine.solver, &machine.lamps, other.player.recorder.hold_time);
        if let Some(operating) = &other.operating {
            let phase = operating.phase.rest_without_relay(operating.operation.time_left(machine.time()));
            let operation = machine.begin_operation(phase.time)?;
            self.operating = Some(Operating { phase, operation });
        }
        recorder.watch_present(&machine.solver);
        Ok(())
    }

    /// Takes the state from the kernel, so that the machine has all voltages of the present instant.
    ///
    /// # Errors
    /// If a voltage is not a number, or a loop does not have exactly one solution.
    fn leave_fast_path(&mut self) -> Result<(), RunError> {
        let Some(operating) = &mut self.operating else { return Ok(()) };
        let Some(active) = operating.operation.active.take() else { return Ok(()) };
        let Player { machine, recorder, .. } = &mut self.player;
        machine.leave_fast_path(active, Halt::Unsupported, recorder)
    }
}

/// The phases of a run that are left.
#[derive(Debug, Clone)]
struct PhaseQueue {
    /// Lists of phases, the outermost first. Each inner one is a repetition in the one before.
    levels: Vec<Level>,
}

/// A list of phases that is played several times.
#[derive(Debug, Clone)]
struct Level {
    /// The phases.
    phases: Vec<Phase>,
    /// Index of the next phase.
    next: usize,
    /// How often the list is played after the present time.
    times_left: u64,
}

impl PhaseQueue {
    /// All phases of a run.
    fn new(phases: &[Phase]) -> Self {
        PhaseQueue { levels: vec![Level { phases: phases.to_vec(), next: 0, times_left: 0 }] }
    }

    /// Whether no phase is left.
    fn is_empty(&self) -> bool {
        self.levels.iter().all(|level| level.times_left == 0 && level.next >= level.phases.len())
    }

    /// Adds a phase before the others.
    fn put_first(&mut self, phase: Phase) {
        self.levels[0].phases.insert(0, phase);
    }

    /// Removes and returns the next phase, which is not a repetition.
    fn next(&mut self) -> Option<Phase> {
        loop {
            let level = self.levels.last_mut()?;
            let Some(phase) = level.phases.get(level.next) else {
                if level.times_left == 0 {
                    self.levels.pop();
                } else {
                    (level.next, level.times_left) = (0, level.times_left - 1);
                }
                continue;
            };
            level.next += 1;
            match phase.clone() {
                Phase::Repeat { times: 0, .. } => {}
                Phase::Repeat { times, phases } => {
                    self.levels.push(Level { phases, next: 0, times_left: times - 1 });
                }
                phase => return Some(phase),
            }
        }
    }
}
