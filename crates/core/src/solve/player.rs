//! The player: plays the phases of a run on a machine with a recorder.
//!
//! Phases are initial condition, operation, hold, changes of parameters and repetitions of these. The record contains
//! the beginning and the end of each phase, and the reason why it ended. A batch plays the same phases, but takes the
//! steps of an operation itself, between [`Player::begin_operating`] and [`Player::end_operating`].

use super::error::RunError;
use super::levels::check_step_count;
use super::machine::{Machine, MachineMode};
use super::observer::StepObserver as _;
use super::recorder::{EndCondition, Recorder};
use super::step_check::StepDoubt;
use crate::document::{ParameterChange, Phase, SwitchCondition};
use crate::grid::SAME_INSTANT;
use crate::ir::{Program, RunScope, Switch};
use crate::trace::{NewValue, PhaseEnd, PhaseKind, Trace};
use patchcord_expr::FormulaDimension;

/// A machine, its recorder, and their position in the run.
pub(super) struct Player<'p, 'w> {
    /// The machine on which the phases are played.
    pub machine: Machine<'p>,
    /// The observer of the machine.
    pub recorder: Recorder<'w>,
    /// Upper limit of the time that the machine will still operate, in problem seconds, with all repetitions. It limits
    /// the number of steps.
    operating_time_left: f64,
    /// The time by the recorder's clock, in seconds summed over all repetitions, at which the player stops; infinity to
    /// play all phases.
    end: f64,
    /// Whether an overload ended the repetition. Phases that take time are then skipped until the next initial
    /// condition.
    pub is_held: bool,
}

/// A phase in which the machine operates.
#[derive(Debug, Clone, Copy)]
pub(super) struct OperatePhase<'p> {
    /// The longest time that the phase lasts, in problem seconds.
    pub time: f64,
    /// The relay that may end the phase earlier; `None` if the phase does not wait for one.
    relay: Option<&'p Switch>,
}

impl OperatePhase<'_> {
    /// The rest of the phase on a machine with another program: it lasts `time` problem seconds, and no relay ends it.
    pub(super) fn rest_without_relay<'q>(self, time: f64) -> OperatePhase<'q> {
        OperatePhase { time, relay: None }
    }
}

impl<'p, 'w> Player<'p, 'w> {
    /// A player of a run that operates for at most `operating_time_left` problem seconds.
    pub(super) fn new(machine: Machine<'p>, recorder: Recorder<'w>, operating_time_left: f64) -> Self {
        Player { machine, recorder, operating_time_left, end: f64::INFINITY, is_held: false }
    }

    /// The same player that stops at a time by the recorder's clock, in seconds summed over all repetitions, and leaves
    /// the machine in the state of that time.
    pub(super) fn with_end(self, end: f64) -> Self {
        Player { end, ..self }
    }

    /// Plays all phases. A run always begins in initial condition, even if its first phase is another one.
    ///
    /// # Errors
    /// As for [`Player::play`].
    pub(super) fn run(&mut self, phases: &[Phase]) -> Result<(), RunError> {
        if !has_initial_condition_first(phases) {
            self.play(&Phase::InitialCondition)?;
        }
        self.play_all(phases)
    }

    /// Ends the last repetition, passes the last samples on, and returns the record and the doubt about its steps.
    pub(super) fn finish(mut self) -> (Trace, Option<StepDoubt>) {
        self.recorder.end_repetition(&self.machine, self.is_held);
        self.recorder.flush();
        let (registers, doubt) = (self.recorder.registers(), self.recorder.step_doubt);
        let mut trace = self.recorder.into_trace();
        if let Some(peaks) = &self.machine.amplifier_peaks {
            let recorded = registers.into_iter().zip(&trace.tracks);
            trace.amplifier_peaks = peaks.with_recorded(self.machine.solver.setup.program, recorded);
        }
        let works = trace.repetitions.iter().map(|repetition| repetition.work);
        let crossed_events = works.map(|work| work.changes + work.crossings).sum();
        let Machine { solver, step_check, .. } = &self.machine;
        match step_check.as_ref().filter(|check| check.is_interrupted(crossed_events)) {
            Some(check) => (trace, Some(check.interrupted(&solver.setup, doubt))),
            None => (trace, doubt),
        }
    }

    /// The machine, and the time by the recorder's clock in seconds, summed over all repetitions.
    pub(super) fn into_machine(self) -> (Machine<'p>, f64) {
        let recorded = self.recorded();
        (self.machine, recorded)
    }

    /// The seconds recorded so far, summed over all repetitions.
    fn recorded(&self) -> f64 {
        self.recorder.recorded(self.machine.time())
    }

    /// Seconds by the recorder's clock until the player stops; infinity to play all phases.
    fn remaining(&self) -> f64 {
        self.end - self.recorded()
    }

    /// Whether the run is cancelled, or the player has reached the time at which it stops, apart from rounding.
    fn is_over(&self) -> bool {
        self.recorder.is_cancelled || self.remaining() <= SAME_INSTANT * self.recorded()
    }

    /// Plays phases in their order, up to the first error.
    fn play_all(&mut self, phases: &[Phase]) -> Result<(), RunError> {
        phases.iter().try_for_each(|phase| self.play(phase))
    }

    /// Plays one phase. After the end of the run, and in hold after an overload, phases are skipped.
    ///
    /// # Errors
    /// If a step fails, a name is unknown, or a parameter cannot be set.
    pub(super) fn play(&mut self, phase: &Phase) -> Result<(), RunError> {
        match phase {
            Phase::Operate { time, until } => self.operate(*time, until.as_ref()),
            _ if self.is_over() => Ok(()),
            Phase::InitialCondition => self.initial_condition(),
            Phase::Set { changes } => self.set(changes),
            Phase::Repeat { times, phases } => self.repeat(*times, phases),
            Phase::Hold { .. } if self.is_held => Ok(()),
            Phase::Hold { time } => self.hold(time.min(self.remaining())),
        }
    }

    /// Plays phases several times (repetitive operation).
    fn repeat(&mut self, times: u64, phases: &[Phase]) -> Result<(), RunError> {
        for _ in 0..times {
            if self.is_over() {
                break;
            }
            self.play_all(phases)?;
        }
        Ok(())
    }

    /// Calls `body`, which plays a phase, and records the beginning and the end of the phase.
    ///
    /// # Errors
    /// The error of `body`. The phase then ends with [`PhaseEnd::Stopped`].
    fn play_recorded(
        &mut self,
        phase: PhaseKind,
        body: impl FnOnce(&mut Self) -> Result<PhaseEnd, RunError>,
    ) -> Result<(), RunError> {
        self.recorder.begin_phase(self.machine.time(), phase);
        let outcome = body(self);
        self.end_phase(outcome.clone().unwrap_or(PhaseEnd::Stopped));
        outcome.map(drop)
    }

    /// Records the end of the present phase.
    fn end_phase(&mut self, reason: PhaseEnd) {
        self.recorder.end_phase(self.machine.time(), &self.machine.lamps, reason);
    }

    /// Records the present voltages at the beginning or the end of a phase, unless the last sample has them.
    fn sample_present(&mut self) {
        self.recorder.sample_present(&self.machine.solver, &self.machine.lamps);
        self.recorder.watch_phase_limit(&self.machine.solver);
    }

    /// Ends the repetition and puts the machine into initial condition.
    fn initial_condition(&mut self) -> Result<(), RunError> {
        self.recorder.end_repetition(&self.machine, self.is_held);
        self.is_held = false;
        let outcome = self.machine.initial_condition();
        self.recorder.invalidate_sample();
        self.play_recorded(PhaseKind::InitialCondition, |_| outcome.map(|()| PhaseEnd::Time))
    }

    /// Operates for a time in problem seconds, or until a relay switches if that is earlier.
    fn operate(&mut self, time: f64, until: Option<&SwitchCondition>) -> Result<(), RunError> {
        let Some(phase) = self.begin_operating(time, until)? else { return Ok(()) };
        let outcome = self.machine.operate_observed(phase.time, &mut self.recorder);
        self.end_operating(phase, outcome)
    }

    /// Begins a phase in which the machine operates for a time in problem seconds; `None` if the phase is skipped,
    /// because the player has stopped or an overload has ended the repetition.
    ///
    /// # Errors
    /// If the relay of `until` or its position is unknown.
    pub(super) fn begin_operating(
        &mut self,
        time: f64,
        until: Option<&SwitchCondition>,
    ) -> Result<Option<OperatePhase<'p>>, RunError> {
        self.operating_time_left -= time;
        if self.is_over() || self.is_held {
            return Ok(None);
        }
        let time = time.min(self.remaining());
        self.sample_present();
        let program = self.machine.solver.setup.program;
        let relay = until.map(|until| find_relay(program, until)).transpose()?;
        self.recorder.end_condition = relay.map(|(relay, target)| EndCondition {
            mode: relay.mode,
            last: self.machine.solver.state.modes[relay.mode],
            target,
            is_met: false,
        });
        let relay_names = |until: &SwitchCondition| {
            (until.relay.value.clone(), until.becomes.as_ref().map(|position| position.value.clone()))
        };
        self.recorder.begin_phase(self.machine.time(), PhaseKind::Operate { until: until.map(relay_names) });
        Ok(Some(OperatePhase { time, relay: relay.map(|(relay, _)| relay) }))
    }

    /// Ends the phase after the machine has operated with this outcome, and records its end.
    ///
    /// # Errors
    /// The error of the outcome.
    pub(super) fn end_operating(
        &mut self,
        phase: OperatePhase<'p>,
        outcome: Result<(), RunError>,
    ) -> Result<(), RunError> {
        let end_condition = self.recorder.end_condition.take().filter(|end_condition| end_condition.is_met);
        let switched =
            phase.relay.zip(end_condition).map(|(relay, end_condition)| position_name(relay, end_condition));
        let reason = outcome.map(|()| self.end_reason(switched));
        self.end_phase(reason.clone().unwrap_or(PhaseEnd::Stopped));
        reason.map(drop)
    }

    /// Why an operation ended: by time, by an overload, or by a relay, whose new position is `switched`. Records the
    /// voltages at the end.
    fn end_reason(&mut self, switched: Option<String>) -> PhaseEnd {
        if let Some(position) = switched {
            if let Some(sensitivities) = &mut self.machine.solver.sensitivities {
                sensitivities.end_phase();
            }
            self.sample_present();
            return PhaseEnd::Switched(position);
        }
        self.recorder.sample_end(&self.machine.solver);
        if self.recorder.is_cancelled {
            return PhaseEnd::Stopped;
        }
        if self.machine.mode() != MachineMode::Hold {
            return PhaseEnd::Time;
        }
        self.is_held = true;
        PhaseEnd::Overload
    }

    /// Holds the machine for a time in seconds. If a lamp is lit and the run holds on overload, the repetition ends
    /// instead.
    fn hold(&mut self, time: f64) -> Result<(), RunError> {
        self.sample_present();
        self.machine.hold();
        self.play_recorded(PhaseKind::Hold, |player| {
            if player.recorder.should_stop(&player.machine.lamps) {
                player.is_held = true;
                return Ok(PhaseEnd::Overload);
            }
            player.machine.solver.enter_phase();
            player.recorder.record_hold(&player.machine.solver, time);
            player.machine.solver.leave_event()?;
            player.recorder.sample_end(&player.machine.solver);
            Ok(PhaseEnd::Time)
        })
    }

    /// Sets parameters to the values of their formulas, which are all evaluated before the first change.
    ///
    /// # Errors
    /// If a formula has no value, a parameter cannot have its value, noise becomes too fine or pulses too fast, or the
    /// scale of a recorded signal changes.
    fn set(&mut self, changes: &[ParameterChange]) -> Result<(), RunError> {
        self.recorder.sample_before_change(&self.machine.solver, &self.machine.lamps, self.is_held);
        let values: Result<Vec<_>, _> = changes.iter().map(|change| self.new_value(change)).collect();
        let recorded_values = values.as_ref().cloned().unwrap_or_default();
        self.machine.solver.enter_phase();
        let slopes: Vec<_> = changes.iter().map(|change| self.slopes(change)).collect();
        self.play_recorded(PhaseKind::Set(recorded_values), |player| {
            let values = values?;
            let pairs = values.iter().map(|new| (new.parameter.as_str(), new.value));
            player.machine.set_with_slopes(pairs, Some(&slopes))?;
            player.check_remaining_steps()?;
            let solver = &player.machine.solver;
            player.recorder.invalidate_sample();
            match player.recorder.rescaled(solver) {
                Some(signal) => Err(RunError::Rescaled { signal: signal.to_owned() }),
                None => Ok(PhaseEnd::Time),
            }
        })
    }

    /// Checks that the rest of the run does not take too many steps with the present settings of the drives.
    ///
    /// # Errors
    /// If it does.
    fn check_remaining_steps(&self) -> Result<(), RunError> {
        let (solver, length) = (&self.machine.solver, self.operating_time_left);
        let equal_steps = self.machine.equal_steps_in(length);
        let max = self.machine.max_steps;
        check_step_count(solver.setup.program, &solver.state.level_sources, length, equal_steps, max)
    }

    /// The present parameters, scales and signals, which formulas of a phase can name.
    fn scope(&self) -> RunScope<'_> {
        let state = &self.machine.solver.state;
        RunScope {
            program: self.machine.solver.setup.program,
            parameters: &state.parameters,
            coefficients: &state.coefficients,
            registers: Some(&state.voltages),
        }
    }

    /// The derivatives of the new value of a parameter in SI units, one for every parameter by which derivatives are
    /// computed.
    fn slopes(&self, change: &ParameterChange) -> Vec<f64> {
        let sensitivities = self.machine.solver.sensitivities.as_ref();
        sensitivities.map_or(Vec::new(), |sensitivities| {
            sensitivities.slopes_of_formula(&self.scope(), &change.to.value)
        })
    }

    /// The value to which a change sets its parameter and the value before, both in the declared unit.
    ///
    /// # Errors
    /// If the parameter is unknown, or the formula has no value.
    fn new_value(&self, change: &ParameterChange) -> Result<NewValue, RunError> {
        let (solver, scope) = (&self.machine.solver, self.scope());
        let (name, formula) = (&change.parameter.value, &change.to.value);
        let program = solver.setup.program;
        let index = program.parameter_index(name)?;
        let value = scope.value_for(index, formula);
        let value = value.map_err(|error| bad_formula(change, error.message))?;
        let declared = &program.parameters[index].declared;
        let before = solver.state.parameters[index] / declared.per_unit;
        Ok(NewValue { parameter: name.clone(), value, before, unit: declared.unit.clone() })
    }
}

/// Whether the first phase, or the first phase of a repetition in its place, is the initial condition.
pub(super) fn has_initial_condition_first(phases: &[Phase]) -> bool {
    match phases.first() {
        Some(Phase::InitialCondition) => true,
        Some(Phase::Repeat { phases, .. }) => has_initial_condition_first(phases),
        _ => false,
    }
}

/// The relay that ends a phase, and the value that its mode must take; `None` for any change.
///
/// # Errors
/// If the element or the position is unknown, or the element does not switch.
fn find_relay<'p>(
    program: &'p Program,
    until: &SwitchCondition,
) -> Result<(&'p Switch, Option<f64>), RunError> {
    let name = &until.relay.value;
    let element = program.element(name).ok_or_else(|| RunError::UnknownElement(name.clone()))?;
    let relay = program.lowered.switches.iter().find(|switch| switch.element == element);
    let relay = relay.ok_or_else(|| RunError::NotARelay(name.clone()))?;
    let Some(becomes) = &until.becomes else { return Ok((relay, None)) };
    match relay.positions.iter().position(|position| *position == becomes.value) {
        Some(index) => Ok((relay, Some(index as f64))),
        None => Err(RunError::UnknownPosition {
            relay: name.clone(),
            position: becomes.value.clone(),
            known: relay.positions.join(" or "),
        }),
    }
}

/// The name of the position into which the relay of an end condition switched.
fn position_name(relay: &Switch, end_condition: EndCondition) -> String {
    relay.positions.get(end_condition.last as usize).copied().unwrap_or_default().to_owned()
}

/// Checks before a run that a program has all relays, positions and parameters that phases name, and that the units of
/// formulas fit.
///
/// # Errors
/// If a parameter, relay or position is unknown, or the unit of a formula does not fit its parameter.
pub(super) fn check(program: &Program, phases: &[Phase]) -> Result<(), RunError> {
    let mut outcome = Ok(());
    let mut check_phase = |phase: &Phase| {
        if outcome.is_ok() {
            outcome = match phase {
                Phase::Operate { until: Some(until), .. } => find_relay(program, until).map(drop),
                Phase::Set { changes } => changes.iter().try_for_each(|change| check_change(program, change)),
                _ => Ok(()),
            };
        }
    };
    phases.iter().for_each(|phase| phase.for_each(&mut check_phase));
    outcome
}

/// Checks the name of the parameter that a change sets, and the unit of its formula.
///
/// # Errors
/// If the parameter or a name in the formula is unknown, or the units do not fit.
fn check_change(program: &Program, change: &ParameterChange) -> Result<(), RunError> {
    let index = program.parameter_index(&change.parameter.value)?;
    let scope = RunScope { program, parameters: &[], coefficients: &[], registers: None };
    let dimension = change.to.value.dimension(&scope);
    let dimension = dimension.map_err(|error| bad_formula(change, error.message))?;
    let expected = program.parameters[index].declared.dimension;
    match dimension {
        FormulaDimension::Of(unit) if unit != expected => {
            Err(bad_formula(change, format!("the formula gives {unit}, but the parameter needs {expected}")))
        }
        _ => Ok(()),
    }
}

/// The error of a formula that gives no value for its parameter.
fn bad_formula(change: &ParameterChange, message: String) -> RunError {
    let (parameter, formula) = (change.parameter.value.clone(), change.to.value.text().to_owned());
    RunError::BadFormula { parameter, formula, message }
}
