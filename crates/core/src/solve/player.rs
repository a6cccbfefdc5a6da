//! The player: takes a machine and its recorder through the phases of a run.
//!
//! Phases are initial condition, operation, hold, changes of parameters and repetitions of these. Each phase is marked
//! in the record with its beginning, its end and the reason why it ended. A batch plays the same phases, but takes the
//! steps of an operation itself ([`Player::begin_operating`], [`Player::end_operating`]).

use super::error::RunError;
use super::levels::check_noise;
use super::machine::{Machine, MachineMode};
use super::observer::StepObserver as _;
use super::recorder::{Recorder, Watch};
use crate::document::{Change, Phase, Until};
use crate::grid::SAME;
use crate::ir::{Program, Standing, Switch};
use crate::trace::{Deed, Ending, NewValue, Trace};
use patchcord_expr::FormulaMeasure;

/// A machine, its recorder, and their position in the run.
pub(super) struct Player<'p, 'w> {
    pub machine: Machine<'p>,
    /// The observer of the machine.
    pub recorder: Recorder<'w>,
    /// The time in seconds that the machine still operates, at most.
    left: f64,
    /// The time by the recorder's clock, summed over all runs, at which the player stops; infinity to play all phases.
    end: f64,
    /// Whether an overload ended the sweep. Phases that take time are then skipped until the next initial condition.
    is_held: bool,
}

/// A phase in which the machine operates.
pub(super) struct Operating<'p> {
    /// The longest time that the phase lasts, in seconds.
    pub time: f64,
    /// The relay that may end the phase earlier.
    relay: Option<&'p Switch>,
}

impl<'p, 'w> Player<'p, 'w> {
    /// A player of a run that operates for at most `left` seconds.
    pub fn new(machine: Machine<'p>, recorder: Recorder<'w>, left: f64) -> Self {
        Player { machine, recorder, left, end: f64::INFINITY, is_held: false }
    }

    /// The same player that stops after some seconds by the recorder's clock, and leaves the machine as it is then.
    pub fn ending_at(self, end: f64) -> Self {
        Player { end, ..self }
    }

    /// Plays all phases. A run always begins in initial condition, even if its first phase does not say so.
    pub fn run(&mut self, phases: &[Phase]) -> Result<(), RunError> {
        if !begins_in_initial_condition(phases) {
            self.play(&Phase::InitialCondition)?;
        }
        self.play_all(phases)
    }

    /// Ends the record and returns it.
    pub fn finish(mut self) -> Trace {
        let Machine { solver, lamps, work, .. } = &self.machine;
        self.recorder.end(solver, lamps, *work, self.is_held);
        self.recorder.trace
    }

    /// The machine, and the time by the recorder's clock in seconds, summed over all runs.
    pub fn into_machine(self) -> (Machine<'p>, f64) {
        let recorded = self.recorded();
        (self.machine, recorded)
    }

    /// The seconds recorded so far, summed over all runs.
    fn recorded(&self) -> f64 {
        self.recorder.recorded(self.machine.time())
    }

    /// Seconds until the player stops.
    fn rest(&self) -> f64 {
        self.end - self.recorded()
    }

    /// Whether the player stops here, apart from rounding.
    fn is_over(&self) -> bool {
        self.rest() <= SAME * self.recorded()
    }

    /// Plays phases in their order.
    fn play_all(&mut self, phases: &[Phase]) -> Result<(), RunError> {
        phases.iter().try_for_each(|phase| self.play(phase))
    }

    /// Plays one phase. After the end of the run, and in hold after an overload, phases are skipped.
    ///
    /// # Errors
    /// If the machine fails, or the phase cannot be carried out.
    pub fn play(&mut self, phase: &Phase) -> Result<(), RunError> {
        match phase {
            Phase::Operate { time, until } => self.operate(*time, until.as_ref()),
            _ if self.is_over() => Ok(()),
            Phase::InitialCondition => self.initial_condition(),
            Phase::Set { changes } => self.set(changes),
            Phase::Repeat { times, phases } => self.repeat(*times, phases),
            Phase::Hold { .. } if self.is_held => Ok(()),
            Phase::Hold { time } => self.hold(time.min(self.rest())),
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

    /// Plays a phase and records its beginning and its end.
    fn marked(
        &mut self,
        phase: Deed,
        act: impl FnOnce(&mut Self) -> Result<Ending, RunError>,
    ) -> Result<(), RunError> {
        self.recorder.mark(self.machine.time(), phase);
        let outcome = act(self);
        self.mark_end(outcome.clone().unwrap_or(Ending::Stopped));
        outcome.map(drop)
    }

    /// Records the end of the present phase.
    fn mark_end(&mut self, ended: Ending) {
        self.recorder.mark_end(self.machine.time(), &self.machine.lamps, ended);
    }

    /// Records the present voltages, unless the last sample shows them.
    fn show(&mut self) {
        self.recorder.show(&self.machine.solver, &self.machine.lamps);
    }

    /// Ends the sweep and puts the machine into initial condition.
    fn initial_condition(&mut self) -> Result<(), RunError> {
        let Machine { solver, lamps, work, .. } = &self.machine;
        self.recorder.end(solver, lamps, *work, self.is_held);
        self.is_held = false;
        let outcome = self.machine.initial_condition();
        self.recorder.invalidate_sample();
        self.marked(Deed::InitialCondition, |_| outcome.map(|()| Ending::Time))
    }

    /// Operates for a time in seconds, or until a relay switches.
    fn operate(&mut self, time: f64, until: Option<&Until>) -> Result<(), RunError> {
        let Some(operating) = self.begin_operating(time, until)? else { return Ok(()) };
        let outcome = self.machine.operate_observed(operating.time, &mut self.recorder);
        self.end_operating(operating, outcome)
    }

    /// Begins a phase in which the machine operates; `None` if the phase is skipped.
    pub fn begin_operating(
        &mut self,
        time: f64,
        until: Option<&Until>,
    ) -> Result<Option<Operating<'p>>, RunError> {
        self.left -= time;
        if self.is_over() || self.is_held {
            return Ok(None);
        }
        let time = time.min(self.rest());
        self.show();
        let program = self.machine.solver.setup.program;
        let relay = until.map(|until| relay(program, until)).transpose()?;
        self.recorder.watch = relay.map(|(relay, wanted)| Watch {
            mode: relay.mode,
            last: self.machine.solver.state.modes[relay.mode],
            wanted,
            is_met: false,
        });
        let named = |until: &Until| {
            (until.relay.value.clone(), until.becomes.as_ref().map(|position| position.value.clone()))
        };
        self.recorder.mark(self.machine.time(), Deed::Operate { until: until.map(named) });
        Ok(Some(Operating { time, relay: relay.map(|(relay, _)| relay) }))
    }

    /// Ends the phase after the machine has operated with this outcome.
    pub fn end_operating(
        &mut self,
        operating: Operating<'p>,
        outcome: Result<(), RunError>,
    ) -> Result<(), RunError> {
        let watch = self.recorder.watch.take().filter(|watch| watch.is_met);
        let switched = operating.relay.zip(watch).map(|(relay, watch)| position(relay, watch));
        let ending = outcome.map(|()| self.ending(switched));
        self.mark_end(ending.clone().unwrap_or(Ending::Stopped));
        ending.map(drop)
    }

    /// Why operation ended: by time, by an overload, or by the relay that switched to this position.
    fn ending(&mut self, switched: Option<String>) -> Ending {
        match switched {
            Some(position) => {
                if let Some(own) = &mut self.machine.solver.sensitivities {
                    own.end_phase();
                }
                self.show();
                Ending::Switched(position)
            }
            None if self.machine.mode() == MachineMode::Hold => {
                self.is_held = true;
                Ending::Overload
            }
            None => Ending::Time,
        }
    }

    /// Holds the machine for a time in seconds. An overload may end the sweep instead.
    fn hold(&mut self, time: f64) -> Result<(), RunError> {
        self.show();
        self.machine.hold();
        self.marked(Deed::Hold, |player| {
            if player.recorder.should_stop(&player.machine.lamps) {
                player.is_held = true;
                return Ok(Ending::Overload);
            }
            player.machine.solver.enter_phase();
            player.recorder.hold(&player.machine.solver, time);
            player.machine.solver.leave_event()?;
            Ok(Ending::Time)
        })
    }

    /// Sets parameters to the values of their formulas, which are all evaluated before the first change.
    ///
    /// # Errors
    /// If a formula has no value, a parameter cannot have its value, noise becomes too fine, or the scale of a recorded
    /// signal changes.
    fn set(&mut self, changes: &[Change]) -> Result<(), RunError> {
        self.recorder.show_end(&self.machine.solver, &self.machine.lamps, self.is_held);
        let values: Result<Vec<_>, _> = changes.iter().map(|change| self.new_value(change)).collect();
        let listed = values.as_ref().cloned().unwrap_or_default();
        self.machine.solver.enter_phase();
        let slopes: Vec<_> = changes.iter().map(|change| self.slopes(change)).collect();
        self.marked(Deed::Set(listed), |player| {
            let values = values?;
            let pairs: Vec<_> = values.iter().map(|new| (new.parameter.as_str(), new.value)).collect();
            player.machine.set_with_slopes(&pairs, Some(&slopes))?;
            let solver = &player.machine.solver;
            check_noise(solver.setup.program, &solver.state.level_sources, player.left)?;
            player.recorder.invalidate_sample();
            match player.recorder.rescaled(solver) {
                Some(signal) => Err(RunError::Rescaled { signal: signal.to_owned() }),
                None => Ok(Ending::Time),
            }
        })
    }

    /// The present values that formulas of the run can name.
    fn standing(&self) -> Standing<'_> {
        let state = &self.machine.solver.state;
        Standing {
            program: self.machine.solver.setup.program,
            parameters: &state.parameters,
            coefficients: &state.coefficients,
            registers: Some(&state.voltages),
        }
    }

    /// The slopes of the new value of a parameter, one for every parameter by which derivatives are carried along.
    fn slopes(&self, change: &Change) -> Vec<f64> {
        let own = self.machine.solver.sensitivities.as_ref();
        own.map_or(Vec::new(), |own| own.slopes_of_formula(&self.standing(), &change.to.value))
    }

    /// The value to which a change sets its parameter, in the declared unit, and the value before.
    fn new_value(&self, change: &Change) -> Result<NewValue, RunError> {
        let (solver, standing) = (&self.machine.solver, self.standing());
        let (name, formula) = (&change.parameter.value, &change.to.value);
        let program = solver.setup.program;
        let index = program.parameter_index(name)?;
        let value = standing.value_for(index, formula);
        let value = value.map_err(|error| bad_formula(change, error.message))?;
        let slot = &program.parameters[index];
        let before = solver.state.parameters[index] / slot.per_unit;
        Ok(NewValue { parameter: name.clone(), value, before, unit: slot.unit.clone() })
    }
}

/// Whether the first phase, also within repetitions, is the initial condition.
pub(super) fn begins_in_initial_condition(phases: &[Phase]) -> bool {
    match phases.first() {
        Some(Phase::InitialCondition) => true,
        Some(Phase::Repeat { phases, .. }) => begins_in_initial_condition(phases),
        _ => false,
    }
}

/// The relay that ends a phase, and the value that its mode must take; `None` for any change.
fn relay<'p>(program: &'p Program, until: &Until) -> Result<(&'p Switch, Option<f64>), RunError> {
    let name = &until.relay.value;
    let element = program.element(name).ok_or_else(|| RunError::UnknownElement(name.clone()))?;
    let relay = program.switches.iter().find(|switch| switch.element == element);
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

/// The name of the position in which a watched relay is.
fn position(relay: &Switch, watch: Watch) -> String {
    relay.positions.get(watch.last as usize).copied().unwrap_or_default().to_owned()
}

/// Checks that a program has everything that phases name, in fitting units.
///
/// # Errors
/// If a parameter, relay or position is unknown, or the unit of a formula does not fit its parameter.
pub(super) fn check(program: &Program, phases: &[Phase]) -> Result<(), RunError> {
    let mut outcome = Ok(());
    let mut each = |phase: &Phase| {
        if outcome.is_ok() {
            outcome = match phase {
                Phase::Operate { until: Some(until), .. } => relay(program, until).map(drop),
                Phase::Set { changes } => changes.iter().try_for_each(|change| check_change(program, change)),
                _ => Ok(()),
            };
        }
    };
    phases.iter().for_each(|phase| phase.for_each(&mut each));
    outcome
}

/// Checks the name of the parameter that a change sets, and the unit of its formula.
fn check_change(program: &Program, change: &Change) -> Result<(), RunError> {
    let index = program.parameter_index(&change.parameter.value)?;
    let standing = Standing { program, parameters: &[], coefficients: &[], registers: None };
    let measure = change.to.value.dimension(&standing);
    let measure = measure.map_err(|error| bad_formula(change, error.message))?;
    let wanted = program.parameters[index].dimension;
    match measure {
        FormulaMeasure::Of(found) if found != wanted => {
            Err(bad_formula(change, format!("it is in {found}, and {wanted} is wanted")))
        }
        _ => Ok(()),
    }
}

/// The error of a formula that gives no value for its parameter.
fn bad_formula(change: &Change, message: String) -> RunError {
    let (parameter, formula) = (change.parameter.value.clone(), change.to.value.text().to_owned());
    RunError::BadFormula { parameter, formula, message }
}
