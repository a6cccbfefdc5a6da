//! Events: changes of mode and kinks. They are located within a step, stepped to and carried out.
//!
//! [`Machine::step_to`] advances time: it tries a step, locates the first event in it, checks the error and accepts the
//! step up to the event. [`Machine::handle_events`] then carries out what is due at its end. Events are counted,
//! because a mode that changes without end (chatter) would stop the clock.

use std::sync::Arc;

use super::discontinuities::{next_before, propagate};
use super::error::RunError;
use super::event_location::{EventFunction, first_event};
use super::machine::Machine;
use super::observer::StepObserver;
use super::runge_kutta;
use super::state::{Setup, Solver, SolverState};
use crate::ir::{Calm, Crossing, Guard, ON_THE_KINK, Program, Transition};
use crate::trace::Work;

/// A mode that changes, or a kink that is crossed, more often than this within the counting span chatters. The span is
/// one of equal steps, or the share [`CHATTER_SPAN`] of the first step tried if steps adapt.
const MAX_CHANGES: u32 = 1000;
/// The counting span for chatter if steps adapt, as a share of the first step tried.
const CHATTER_SPAN: f64 = 0.01;

/// An event that a step must not reach across.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// A change of mode.
    Change(Guard),
    /// A crossing of the kink of this index.
    Kink(usize, Crossing),
}

impl Event {
    /// The voltage by which the event is passed; negative before the event.
    fn value(self, voltages: &[f64]) -> f64 {
        match self {
            Event::Change(guard) => guard.excess(voltages),
            Event::Kink(_, crossing) => crossing.excess(voltages),
        }
    }
}

/// Counts of events, by which chatter is detected, and the corners at which the present phase has to stop.
#[derive(Debug, Clone)]
pub(super) struct EventState {
    /// Changes of every mode since `counted_since`.
    pub changes: Vec<u32>,
    /// Crossings of every kink since then.
    pub crossings: Vec<u32>,
    /// The beginning of the counting span, in problem seconds.
    counted_since: f64,
    /// Corners of tables at which no equal step of the present phase ends, in problem seconds, ascending.
    pub corners_off_grid: Arc<[f64]>,
}

impl EventState {
    /// No events of a program.
    pub fn new(program: &Program) -> Self {
        EventState {
            changes: vec![0; program.modes.len()],
            crossings: vec![0; program.kinks.len() + program.guard_kinks.len()],
            counted_since: 0.0,
            corners_off_grid: Arc::default(),
        }
    }

    /// Resets the counting span for a new initial condition.
    pub fn reset(&mut self) {
        self.counted_since = 0.0;
    }

    /// Begins a new counting span if the present one is over. With `None` every call begins one.
    pub fn begin_counting(&mut self, time: f64, span: Option<f64>) {
        if span.is_none_or(|span| time - self.counted_since >= span) {
            self.counted_since = time;
            self.changes.fill(0);
            self.crossings.fill(0);
        }
    }
}

/// A tried step of the solver, in which events are located.
struct StepTrial<'a, 'p> {
    solver: &'a mut Solver<'p>,
    /// Counts the evaluations of all tries.
    work: &'a mut Work,
}

impl EventFunction for StepTrial<'_, '_> {
    type Event = Event;

    fn evaluate(&mut self, length: f64) {
        let Solver { setup, state, delay_lines, buffers, .. } = &mut *self.solver;
        self.work.evaluations += runge_kutta::evaluations(setup.method);
        runge_kutta::try_step(setup, state, delay_lines, buffers, length);
    }

    fn event(&self) -> Option<Event> {
        event_at(&self.solver.setup, &self.solver.state, &self.solver.buffers.voltages)
    }

    fn has_hint(&self) -> bool {
        self.solver.buffers.hint.is_some()
    }

    fn hint_share(&self) -> f64 {
        self.solver.buffers.hint.unwrap_or(1.0)
    }

    fn present_value(&self, event: Event) -> f64 {
        event.value(&self.solver.state.voltages)
    }

    fn value(&self, event: Event) -> f64 {
        event.value(&self.solver.buffers.voltages)
    }

    fn tolerance(&self, event: Event) -> f64 {
        if matches!(event, Event::Kink(..)) { ON_THE_KINK } else { 0.0 }
    }
}

impl<'p> Machine<'p> {
    /// A step that is tried from the present.
    fn step_trial(&mut self) -> StepTrial<'_, 'p> {
        StepTrial { solver: &mut self.solver, work: &mut self.work }
    }

    /// Begins a new counting span for events if the present one is over.
    pub(super) fn begin_counting(&mut self) {
        let setup = &self.solver.setup;
        let span = setup.is_adaptive.then_some(CHATTER_SPAN * setup.step);
        self.events.begin_counting(self.solver.state.time, span);
    }

    /// Advances to a problem time, and stops at every event on the way. With step control it takes one step only.
    pub(super) fn advance(&mut self, target: f64, observer: &mut impl StepObserver) -> Result<(), RunError> {
        self.begin_counting();
        self.step_to(target, None, observer)
    }

    /// Advances to a problem time within the present counting span. `change` is the time until a change of mode that is
    /// already known approximately, in seconds.
    ///
    /// Each pass tries a step to the next discontinuity, shortens it to the first event, checks its error, accepts it
    /// and carries out the events at its end. A step that is rejected is tried again with a shorter target.
    ///
    /// # Errors
    /// If a voltage is not a number, a loop is not solved, a mode chatters, or the step becomes too short.
    pub(super) fn step_to(
        &mut self,
        mut target: f64,
        mut change: Option<f64>,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        if let Some(later) = change
            && self.step_to_change(later, target, observer)?
        {
            change = None;
        }
        while self.solver.state.time < target && !observer.is_phase_over() {
            let Solver { setup, state, delay_lines, .. } = &self.solver;
            let end = next_before(setup, state, delay_lines, target);
            let length = end - state.time;
            self.step_trial().evaluate(length);
            if let Some(control) = &mut self.control
                && let Some(shorter) = control.limit_angles(&self.solver, &mut self.work, length)?
            {
                target = self.solver.state.time + shorter;
                continue;
            }
            let near = change.take().map(|later| later / length);
            let (share, met) = first_event(&mut self.step_trial(), length, near);
            if let Some(control) = &mut self.control
                && let Some(shorter) = control.reject(&self.solver, &mut self.work, share * length)?
            {
                target = self.solver.state.time + shorter;
                continue;
            }
            let time = if share >= 1.0 { end } else { self.solver.state.time + share * length };
            self.accept_step(time, observer)?;
            if let Some(Event::Kink(kink, _)) = met {
                cross_kink(&mut self.solver, &mut self.events, &mut self.work, kink)?;
            }
            self.handle_events(observer)?;
            if self.solver.setup.is_adaptive {
                break;
            }
        }
        Ok(())
    }

    /// Takes one step to the change of mode that a kernel found on the way to `target`, and carries it out. Returns
    /// false and takes no step if the change is not due there.
    fn step_to_change(
        &mut self,
        length: f64,
        target: f64,
        observer: &mut impl StepObserver,
    ) -> Result<bool, RunError> {
        let mut trial = self.step_trial();
        trial.evaluate(length);
        let is_due = matches!(trial.event(), Some(Event::Change(_))) && !trial.has_hint();
        if is_due {
            let time = self.solver.state.time;
            let is_whole = length >= target - time;
            self.accept_step(if is_whole { target } else { time + length }, observer)?;
            self.handle_events(observer)?;
        }
        Ok(is_due)
    }

    /// Carries out the discontinuities and changes of mode that are due at the end of a step, and shows the result to
    /// the observer.
    ///
    /// # Errors
    /// If a mode chatters, a voltage is not a number, or an event has no derivative.
    pub(super) fn handle_events(&mut self, observer: &mut impl StepObserver) -> Result<(), RunError> {
        self.solver.enter_event()?;
        let jumped = propagate(&mut self.solver, &mut self.work);
        if settle_modes(&mut self.solver, &mut self.events, &mut self.work)? || jumped {
            self.solver.sample_values();
            self.check_present()?;
        }
        self.solver.leave_event()?;
        observer.step_ended(&self.solver);
        Ok(())
    }
}

/// Carries out every change of mode that is due, and those that follow from it, until no change is due. Returns whether
/// any mode changed.
///
/// # Errors
/// If a mode chatters.
pub(super) fn settle_modes(
    solver: &mut Solver<'_>,
    events: &mut EventState,
    work: &mut Work,
) -> Result<bool, RunError> {
    let before = work.changes;
    loop {
        let (mut any, mut chatters) = (false, None);
        let Solver { setup, state, sensitivities, .. } = &mut *solver;
        let program = setup.program;
        program.change_modes(&state.voltages, &mut state.modes, &mut state.states, |mode, transition| {
            any = true;
            if let Some(own) = sensitivities.as_deref_mut() {
                own.change_mode(program, &state.voltages, mode, transition);
            }
            events.changes[mode] += 1;
            work.changes += 1;
            if events.changes[mode] > MAX_CHANGES {
                chatters = Some(&program.modes[mode]);
            }
        });
        if let Some(mode) = chatters {
            return Err(chatter(&solver.setup, solver.state.time, mode.element, mode.calmed_by));
        }
        if !any {
            return Ok(work.changes > before);
        }
        solver.evaluate(work);
        solver.record_discontinuity();
    }
}

/// The transitions that are possible from the present modes.
pub(super) fn open_transitions<'a>(
    program: &'a Program,
    modes: &'a [f64],
) -> impl Iterator<Item = &'a Transition> {
    let pairs = program.modes.iter().zip(modes);
    pairs.flat_map(|(mode, value)| mode.transitions.iter().filter(move |open| open.from == *value))
}

/// An event on the way from the present to these voltages; `None` if there is none. Changes of mode come before kinks.
pub(super) fn event_at(setup: &Setup<'_>, state: &SolverState, voltages: &[f64]) -> Option<Event> {
    let mut guards = open_transitions(setup.program, &state.modes).map(|open| open.guard);
    let due = guards.find(|guard| guard.holds(voltages)).map(Event::Change);
    due.or_else(|| kink_crossed(setup, &state.voltages, voltages))
}

/// The first kink that is crossed between two sets of voltages.
fn kink_crossed(setup: &Setup<'_>, from: &[f64], to: &[f64]) -> Option<Event> {
    setup.kinks().enumerate().find_map(|(index, kink)| {
        let [from, to] = [from, to].map(|voltages| kink.value(voltages));
        Some(Event::Kink(index, kink.crossed(&setup.program.tables, from, to)?))
    })
}

/// Counts the crossing of a kink, and records that voltages turn a corner at the present instant.
///
/// # Errors
/// If the kink is crossed so often that its element chatters.
fn cross_kink(
    solver: &mut Solver<'_>,
    events: &mut EventState,
    work: &mut Work,
    index: usize,
) -> Result<(), RunError> {
    work.crossings += 1;
    events.crossings[index] += 1;
    if let Some(kink) = solver.setup.kinks().nth(index).filter(|_| events.crossings[index] > MAX_CHANGES) {
        return Err(chatter(&solver.setup, solver.state.time, kink.element, Calm::Drive));
    }
    solver.record_discontinuity();
    Ok(())
}

/// The error of an element that chatters at a problem time.
fn chatter(setup: &Setup<'_>, time: f64, element: usize, remedy: Calm) -> RunError {
    let element = setup.program.name(element).to_owned();
    let within = if setup.is_adaptive { CHATTER_SPAN * setup.step } else { setup.step };
    let advice = match (remedy, setup.is_adaptive) {
        (Calm::Rest, _) => "give it a larger \"rest\": what is thrown back below it stays at the stop",
        (Calm::Hysteresis, false) => "give it hysteresis, or take a shorter step",
        (Calm::Hysteresis, true) => "give it hysteresis",
        (Calm::Drive, false) => "look for what drives it to and fro, or take a shorter step",
        (Calm::Drive, true) => "look for what drives it to and fro",
    };
    RunError::Chatter { element, most: MAX_CHANGES as usize, within, time, advice }
}
