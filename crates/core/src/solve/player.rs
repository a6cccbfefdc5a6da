//! Goes through the phases of a run with a machine and a recorder.

use super::error::RunError;
use super::machine::{Machine, MachineMode, Witness};
use super::recorder::{Recorder, Watch};
use crate::document::{Change, Phase, Until};
use crate::grid::SAME;
use crate::ir::{Program, Standing, Switch};
use crate::trace::{Deed, Ending, NewValue, Trace};
use patchcord_expr::FormulaMeasure;

/// A machine, the recorder beside it, and where in the run they are.
pub(super) struct Player<'p, 'w> {
    pub machine: Machine<'p>,
    pub recorder: Recorder<'w>,
    /// Seconds still to be operated, at most.
    left: f64,
    /// By the recorder's clock, all runs added up, when it is over; with infinity, at the end of its phases.
    end: f64,
    /// Whether an overload ended the sweep: what takes time is passed over until the next initial condition.
    is_held: bool,
}

/// A phase in which the machine operates.
pub(super) struct Operating<'p> {
    /// For so many seconds at most.
    pub time: f64,
    /// The relay that may end it before.
    relay: Option<&'p Switch>,
}

impl<'p, 'w> Player<'p, 'w> {
    /// A player of a run that operates for so many seconds at most.
    pub fn new(machine: Machine<'p>, recorder: Recorder<'w>, left: f64) -> Self {
        Player { machine, recorder, left, end: f64::INFINITY, is_held: false }
    }

    /// The same player, who leaves everything as it stands after so many seconds by the recorder's clock.
    pub fn ending_at(self, end: f64) -> Self {
        Player { end, ..self }
    }

    /// Goes through a whole run; it begins in initial condition whether it says so or not.
    pub fn run(&mut self, phases: &[Phase]) -> Result<(), RunError> {
        if !begins_in_initial_condition(phases) {
            self.one(&Phase::InitialCondition)?;
        }
        self.all(phases)
    }

    /// What was recorded.
    pub fn finish(mut self) -> Trace {
        self.recorder.end(&self.machine, self.is_held);
        self.recorder.trace
    }

    /// The machine as it stands, and when by the recorder's clock, all runs added up.
    pub fn into_machine(self) -> (Machine<'p>, f64) {
        let clock = self.recorder.recorded(&self.machine);
        (self.machine, clock)
    }

    /// Seconds until it is over.
    fn rest(&self) -> f64 {
        self.end - self.recorder.recorded(&self.machine)
    }

    fn is_over(&self) -> bool {
        self.rest() <= SAME * self.recorder.recorded(&self.machine)
    }

    fn all(&mut self, phases: &[Phase]) -> Result<(), RunError> {
        phases.iter().try_for_each(|phase| self.one(phase))
    }

    /// Goes through one phase.
    pub fn one(&mut self, phase: &Phase) -> Result<(), RunError> {
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

    fn repeat(&mut self, times: u64, phases: &[Phase]) -> Result<(), RunError> {
        for _ in 0..times {
            if self.is_over() {
                break;
            }
            self.all(phases)?;
        }
        Ok(())
    }

    /// Goes through a phase between its marks.
    fn marked(
        &mut self,
        deed: Deed,
        act: impl FnOnce(&mut Self) -> Result<Ending, RunError>,
    ) -> Result<(), RunError> {
        self.recorder.mark(&self.machine, deed);
        let outcome = act(self);
        self.recorder.mark_end(&self.machine, outcome.clone().unwrap_or(Ending::Stopped));
        outcome.map(drop)
    }

    fn initial_condition(&mut self) -> Result<(), RunError> {
        self.recorder.end(&self.machine, self.is_held);
        self.is_held = false;
        let outcome = self.machine.initial_condition();
        self.recorder.changed();
        self.marked(Deed::InitialCondition, |_| outcome.map(|()| Ending::Time))
    }

    fn operate(&mut self, time: f64, until: Option<&Until>) -> Result<(), RunError> {
        let Some(operating) = self.begin_operating(time, until)? else { return Ok(()) };
        let outcome = self.machine.operate_with(operating.time, &mut self.recorder);
        self.end_operating(operating, outcome)
    }

    /// Begins a phase in which the machine operates; nothing where it is passed over.
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
        self.recorder.show(&self.machine);
        let program = self.machine.program;
        let relay = until.map(|until| relay(program, until)).transpose()?;
        self.recorder.watch = relay.map(|(relay, wanted)| Watch {
            mode: relay.mode,
            last: self.machine.modes[relay.mode],
            wanted,
            is_met: false,
        });
        let named = |until: &Until| {
            (until.relay.value.clone(), until.becomes.as_ref().map(|position| position.value.clone()))
        };
        self.recorder.mark(&self.machine, Deed::Operate { until: until.map(named) });
        Ok(Some(Operating { time, relay: relay.map(|(relay, _)| relay) }))
    }

    /// Ends it when the machine has operated.
    pub fn end_operating(
        &mut self,
        operating: Operating<'p>,
        outcome: Result<(), RunError>,
    ) -> Result<(), RunError> {
        let watch = self.recorder.watch.take().filter(|watch| watch.is_met);
        let switched = operating.relay.zip(watch).map(|(relay, watch)| position(relay, watch));
        let ending = outcome.map(|()| self.ending(switched));
        self.recorder.mark_end(&self.machine, ending.clone().unwrap_or(Ending::Stopped));
        ending.map(drop)
    }

    /// Why operating ended, by its clock or before.
    fn ending(&mut self, switched: Option<String>) -> Ending {
        match switched {
            Some(position) => {
                self.machine.end_phase();
                self.recorder.show(&self.machine);
                Ending::Switched(position)
            }
            None if self.machine.mode() == MachineMode::Hold => {
                self.is_held = true;
                Ending::Overload
            }
            None => Ending::Time,
        }
    }

    fn hold(&mut self, time: f64) -> Result<(), RunError> {
        self.recorder.show(&self.machine);
        self.machine.hold();
        self.marked(Deed::Hold, |player| {
            if player.recorder.has_seen_enough(&player.machine) {
                player.is_held = true;
                return Ok(Ending::Overload);
            }
            player.machine.enter_phase();
            player.recorder.hold(&player.machine, time);
            player.machine.leave_event()?;
            Ok(Ending::Time)
        })
    }

    fn set(&mut self, changes: &[Change]) -> Result<(), RunError> {
        self.recorder.show_end(&self.machine, self.is_held);
        let values: Result<Vec<_>, _> = changes.iter().map(|change| self.new_value(change)).collect();
        let told = values.as_ref().cloned().unwrap_or_default();
        self.machine.enter_phase();
        let slopes: Vec<_> = changes.iter().map(|change| self.slopes(change)).collect();
        self.marked(Deed::Set(told), |player| {
            let values = values?;
            let pairs: Vec<_> = values.iter().map(|new| (new.parameter.as_str(), new.value)).collect();
            player.machine.turn(&pairs, Some(&slopes))?;
            player.machine.check_noise(player.left)?;
            player.recorder.changed();
            match player.recorder.rescaled(&player.machine) {
                Some(signal) => Err(RunError::Rescaled { signal: signal.to_owned() }),
                None => Ok(Ending::Time),
            }
        })
    }

    /// What the formulas of the run see now.
    fn standing(&self) -> Standing<'_> {
        let machine = &self.machine;
        Standing {
            program: machine.program,
            parameters: &machine.parameters,
            coefficients: &machine.coefficients,
            registers: Some(&machine.registers),
        }
    }

    /// The slopes of what a change sets its parameter to, by those along which derivatives are carried.
    fn slopes(&self, change: &Change) -> Vec<f64> {
        let own = self.machine.sensitivities.as_ref();
        own.map_or(Vec::new(), |own| own.of_formula(&self.standing(), &change.to.value))
    }

    fn new_value(&self, change: &Change) -> Result<NewValue, RunError> {
        let (machine, standing) = (&self.machine, self.standing());
        let (name, formula) = (&change.parameter.value, &change.to.value);
        let index =
            machine.program.parameter(name).ok_or_else(|| RunError::UnknownParameter(name.clone()))?;
        let value = standing.value_for(index, formula);
        let value = value.map_err(|error| bad_formula(change, error.message))?;
        let slot = &machine.program.parameters[index];
        let before = machine.parameters[index] / slot.per_unit;
        Ok(NewValue { parameter: name.clone(), value, before, unit: slot.unit.clone() })
    }
}

/// Whether the first thing done is to go into initial condition.
pub(super) fn begins_in_initial_condition(phases: &[Phase]) -> bool {
    match phases.first() {
        Some(Phase::InitialCondition) => true,
        Some(Phase::Repeat { phases, .. }) => begins_in_initial_condition(phases),
        _ => false,
    }
}

/// The relay that ends a phase, and the value of its mode that is waited for.
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

fn position(relay: &Switch, watch: Watch) -> String {
    relay.positions.get(watch.last as usize).copied().unwrap_or_default().to_owned()
}

/// Whether a program has everything that phases name, in fitting units.
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

fn check_change(program: &Program, change: &Change) -> Result<(), RunError> {
    let name = &change.parameter.value;
    let index = program.parameter(name).ok_or_else(|| RunError::UnknownParameter(name.clone()))?;
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

fn bad_formula(change: &Change, message: String) -> RunError {
    let (parameter, formula) = (change.parameter.value.clone(), change.to.value.text().to_owned());
    RunError::BadFormula { parameter, formula, message }
}
