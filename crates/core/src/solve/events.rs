//! Events: changes of mode and crossings of kinks. A step ends at the first event in it.
//!
//! [`Machine::step_to`] advances time. It tries a step, locates the first event in it, checks the error and accepts the
//! step up to the event. [`Machine::handle_events`] then makes the jumps and changes of mode that are due at its end.
//! Events are counted, because time would not advance if a mode changed without end (chatter).

use std::mem;
use std::sync::Arc;

use super::buffers::{Crossed, StepBuffers};
use super::cord_chains::is_in_feedback;
use super::discontinuities::{next_before, propagate};
use super::error::RunError;
use super::event_location::{EventFunction, first_event};
use super::grazing;
use super::machine::Machine;
use super::observer::StepObserver;
use super::runge_kutta;
use super::state::{Setup, Solver, SolverState};
use crate::ir::{ChatterRemedy, Guard, KINK_TOLERANCE, Kink, KinkCrossing, Program, Transition};
use crate::trace::WorkCounters;

/// Number of changes of one mode, or of crossings of one kink, in a counting span above which it chatters. The counting
/// span is one of the equal steps, or the share [`CHATTER_SPAN_SHARE`] of the first step tried if steps adapt.
const MAX_EVENTS_PER_SPAN: u32 = 1000;
/// Largest number of lengths that are tried to end a step at a turning point. Each is closer to it by orders of magnitude,
/// unless the errors of a loop decide its place.
const MAX_TURN_TRIES: u32 = 8;
/// Least length to which a step is shortened because of a hint, as a share of the first step tried.
const LEAST_LENGTH_BEFORE_HINT: f64 = 1e-6;
/// Distance, in volts, by which a voltage that leaves a corner counts as past it.
const DEPARTURE: f64 = 2.5 * KINK_TOLERANCE;
/// Length of the counting span for chatter if steps adapt, as a share of the first step tried.
const CHATTER_SPAN_SHARE: f64 = 0.01;

/// An event at which a step has to end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// A change of mode, with the guard that causes it.
    ModeChange(Guard),
    /// A crossing of the kink with this index in [`Setup::kinks`].
    Kink(usize, KinkCrossing),
}

impl Event {
    /// The voltage by which the event is passed, in volts; negative before the event.
    fn value(self, voltages: &[f64]) -> f64 {
        match self {
            Event::ModeChange(guard) => guard.value(voltages),
            Event::Kink(_, crossing) => crossing.value(voltages),
        }
    }
}

/// Counts of events, by which chatter is detected, and the corners at which a kernel has to stop in the present phase.
#[derive(Debug, Clone)]
pub(super) struct EventState {
    /// Number of changes of every mode since `counted_since`, in the order of `Program::modes`.
    pub changes: Vec<u32>,
    /// Number of crossings of every kink since `counted_since`, in the order of [`Setup::kinks`].
    pub crossings: Vec<u32>,
    /// Number of instants since the initial condition at which a level or the output of a delay line jumped.
    pub jumps: u64,
    /// The beginning of the counting span, in problem seconds.
    counted_since: f64,
    /// Corners of tables at which no equal step of the present phase ends, in problem seconds, ascending.
    pub corners_off_grid: Arc<[f64]>,
}

impl EventState {
    /// The counts of a program, all 0.
    pub(super) fn new(program: &Program) -> Self {
        EventState {
            changes: vec![0; program.lowered.modes.len()],
            crossings: vec![0; program.lowered.kinks.len() + program.lowered.guard_kinks.len()],
            jumps: 0,
            counted_since: 0.0,
            corners_off_grid: Arc::default(),
        }
    }

    /// Resets the counting span and the number of jumps for a new initial condition.
    pub(super) fn reset(&mut self) {
        (self.counted_since, self.jumps) = (0.0, 0);
    }

    /// Begins a new counting span at a problem time if `span` seconds have passed since the last began. With `None`
    /// every call begins one.
    pub(super) fn begin_counting(&mut self, time: f64, span: Option<f64>) {
        if span.is_none_or(|span| time - self.counted_since >= span) {
            self.counted_since = time;
            self.changes.fill(0);
            self.crossings.fill(0);
        }
    }
}

/// A tried step of the solver, in which events are located.
struct StepTrial<'a, 'p> {
    /// The solver; its state stays at the present while steps are tried.
    solver: &'a mut Solver<'p>,
    /// Counts the evaluations of all tries.
    work: &'a mut WorkCounters,
}

impl EventFunction for StepTrial<'_, '_> {
    type Event = Event;

    fn evaluate(&mut self, length: f64) {
        let Solver { setup, state, delay_lines, buffers, .. } = &mut *self.solver;
        self.work.evaluations += runge_kutta::evaluations(setup.method);
        runge_kutta::try_step(setup, state, delay_lines, buffers, length);
        self.work.evaluations += mem::take(&mut buffers.hint_evaluations);
    }

    fn event(&self) -> Option<Event> {
        let Solver { setup, state, buffers, .. } = &*self.solver;
        event_at(setup, state, buffers, &buffers.voltages)
    }

    fn has_hint(&self) -> bool {
        self.solver.buffers.hint.is_some()
    }

    fn hint_share(&self) -> f64 {
        self.solver.buffers.hint.map_or(1.0, |hint| hint.share)
    }

    fn present_value(&self, event: Event) -> f64 {
        event.value(&self.solver.state.voltages)
    }

    fn value(&self, event: Event) -> f64 {
        event.value(&self.solver.buffers.voltages)
    }

    fn tolerance(&self, event: Event) -> f64 {
        if matches!(event, Event::Kink(..)) { KINK_TOLERANCE } else { 0.0 }
    }
}

impl<'p> Machine<'p> {
    /// A step to be tried from the present.
    fn step_trial(&mut self) -> StepTrial<'_, 'p> {
        StepTrial { solver: &mut self.solver, work: &mut self.work }
    }

    /// Begins a new counting span for events if the present one is over.
    pub(super) fn begin_counting(&mut self) {
        let setup = &self.solver.setup;
        let span = setup.is_adaptive.then_some(CHATTER_SPAN_SHARE * setup.step);
        self.events.begin_counting(self.solver.state.time, span);
    }

    /// Advances to a problem time in a new counting span, and handles every event before it. With step control it takes
    /// one step only.
    ///
    /// # Errors
    /// As for [`Machine::step_to`].
    pub(super) fn advance(&mut self, target: f64, observer: &mut impl StepObserver) -> Result<(), RunError> {
        self.begin_counting();
        self.step_to(target, None, observer)
    }

    /// Advances to a problem time within the present counting span. `mode_change` is the time in seconds until a change
    /// of mode that a kernel has located, if any.
    ///
    /// Each pass tries a step to the next discontinuity, shortens it to the first event, checks its error, accepts it
    /// and handles the events at its end. A step that is rejected is tried again with a shorter target.
    ///
    /// # Errors
    /// If a voltage is not a number, a loop is not solved, a mode chatters, or the step becomes too short.
    pub(super) fn step_to(
        &mut self,
        mut target: f64,
        mut mode_change: Option<f64>,
        observer: &mut impl StepObserver,
    ) -> Result<(), RunError> {
        if let Some(seconds) = mode_change
            && self.step_to_mode_change(seconds, target, observer)?
        {
            mode_change = None;
        }
        let (mut turn, mut turns) = (f64::INFINITY, 0);
        while self.solver.state.time < target && !observer.is_phase_over() {
            let Solver { setup, state, delay_lines, .. } = &self.solver;
            let end = next_before(setup, state, delay_lines, target).min(turn);
            let length = end - state.time;
            self.step_trial().evaluate(length);
            if let Some(control) = &mut self.control
                && let Some(shorter) = control.limit_angles(&self.solver, &mut self.work, length)?
            {
                target = self.solver.state.time + shorter;
                continue;
            }
            if turns < MAX_TURN_TRIES
                && let Some(shorter) = self.length_to_turn(length, turns > 0)
            {
                (turn, turns) = (self.solver.state.time + shorter, turns + 1);
                continue;
            }
            let expected_share = mode_change.take().map(|seconds| seconds / length);
            let (share, event) = first_event(&mut self.step_trial(), length, expected_share);
            if let Some(shorter) = self.length_before_hint(share * length) {
                self.work.rejections += 1;
                target = self.solver.state.time + shorter;
                continue;
            }
            if let Some(control) = &mut self.control
                && let Some(shorter) = control.reject(&self.solver, &mut self.work, share * length)?
            {
                target = self.solver.state.time + shorter;
                continue;
            }
            (turn, turns) = (f64::INFINITY, 0);
            let time = if share >= 1.0 { end } else { self.solver.state.time + share * length };
            self.accept_step(time, observer)?;
            if let Some(Event::Kink(kink, crossing)) = event {
                let (time, is_rising) = (self.solver.state.time, crossing.is_rising);
                self.solver.buffers.crossed = Some(Crossed { kink, is_rising, time });
                cross_kink(&mut self.solver, &mut self.events, &mut self.work, kink)?;
            }
            self.handle_events(observer)?;
            if self.solver.setup.is_adaptive {
                break;
            }
        }
        Ok(())
    }

    /// A shorter length, in problem seconds, of a step with a certain hint that no tried step confirmed; `None` if there is
    /// no such hint. A step over the corner of a stiff circuit is wrong at its end, so it may not show the event. A step
    /// that begins near the event does.
    fn length_before_hint(&self, length: f64) -> Option<f64> {
        let Solver { setup, buffers, .. } = &self.solver;
        let shorter = 0.5 * buffers.hint.filter(|hint| hint.is_certain)?.share * length;
        (shorter > LEAST_LENGTH_BEFORE_HINT * setup.step).then_some(shorter)
    }

    /// Takes one step of `length` seconds to the change of mode that a kernel found before `target`, and makes the
    /// change. Returns false and takes no step if the change is not due there.
    ///
    /// # Errors
    /// If the step or the change fails.
    fn step_to_mode_change(
        &mut self,
        length: f64,
        target: f64,
        observer: &mut impl StepObserver,
    ) -> Result<bool, RunError> {
        let mut trial = self.step_trial();
        trial.evaluate(length);
        let is_due = matches!(trial.event(), Some(Event::ModeChange(_))) && !trial.has_hint();
        if is_due {
            let time = self.solver.state.time;
            let is_whole = length >= target - time;
            self.accept_step(if is_whole { target } else { time + length }, observer)?;
            self.handle_events(observer)?;
        }
        Ok(is_due)
    }

    /// Handles the discontinuities and changes of mode that are due at the end of a step, and calls the observer.
    ///
    /// # Errors
    /// If a mode chatters, a voltage is not a number, or an event has no derivative.
    pub(super) fn handle_events(&mut self, observer: &mut impl StepObserver) -> Result<(), RunError> {
        self.solver.enter_event()?;
        let jumped = propagate(&mut self.solver, &mut self.work);
        self.events.jumps += u64::from(jumped);
        if settle_modes(&mut self.solver, &mut self.events, &mut self.work)? || jumped {
            self.solver.sample_values();
            self.check_present()?;
        }
        self.solver.leave_event()?;
        observer.step_ended(&self.solver);
        Ok(())
    }
}

/// Makes every change of mode that is due, and those that follow from it, until no change is due. All voltages are
/// evaluated after each round of changes. Returns whether any mode changed.
///
/// # Errors
/// If a mode chatters.
pub(super) fn settle_modes(
    solver: &mut Solver<'_>,
    events: &mut EventState,
    work: &mut WorkCounters,
) -> Result<bool, RunError> {
    let before = work.changes;
    loop {
        let (mut has_changed, mut chattering_mode) = (false, None);
        let Solver { setup, state, sensitivities, .. } = &mut *solver;
        let program = setup.program;
        program.change_modes(&state.voltages, &mut state.modes, &mut state.states, |mode, transition| {
            has_changed = true;
            if let Some(sensitivities) = sensitivities.as_deref_mut() {
                sensitivities.change_mode(program, &state.voltages, mode, transition);
            }
            events.changes[mode] += 1;
            work.changes += 1;
            if events.changes[mode] > MAX_EVENTS_PER_SPAN {
                chattering_mode = Some(&program.lowered.modes[mode]);
            }
        });
        if let Some(mode) = chattering_mode {
            return Err(chatter(&solver.setup, solver.state.time, mode.element, mode.chatter_remedy));
        }
        if !has_changed {
            return Ok(work.changes > before);
        }
        solver.evaluate(work);
        solver.record_discontinuity();
    }
}

/// The transitions that are possible from the present modes, in the order of `Program::modes`.
pub(super) fn open_transitions<'a>(
    program: &'a Program,
    modes: &'a [f64],
) -> impl Iterator<Item = &'a Transition> {
    let pairs = program.lowered.modes.iter().zip(modes);
    pairs
        .flat_map(|(mode, value)| mode.transitions.iter().filter(move |transition| transition.from == *value))
}

/// An event between the present and these voltages, which are those of a stage or of the end of the tried step; `None` if
/// there is none. Changes of mode come before kinks.
pub(super) fn event_at(
    setup: &Setup<'_>,
    state: &SolverState,
    buffers: &StepBuffers,
    voltages: &[f64],
) -> Option<Event> {
    let mut guards = open_transitions(setup.program, &state.modes).map(|transition| transition.guard);
    let due = guards.find(|guard| guard.is_due(voltages)).map(Event::ModeChange);
    due.or_else(|| kink_crossed(setup, state, buffers, voltages))
}

/// The first kink, by index, that is crossed between the present and these voltages. A voltage that begins on a corner,
/// as after a crossing, crosses it if it leaves to the other side first.
pub(super) fn kink_crossed(
    setup: &Setup<'_>,
    state: &SolverState,
    buffers: &StepBuffers,
    voltages: &[f64],
) -> Option<Event> {
    let tables = &setup.program.tables;
    setup.kinks().enumerate().find_map(|(index, kink)| {
        let [from, to] = [&state.voltages, voltages].map(|voltages| kink.value(voltages));
        let departs =
            kink.is_on_corner(tables, from) && departs_from(setup, state, buffers, (index, kink), [from, to]);
        let begin = if departs { from - DEPARTURE.copysign(to - from) } else { from };
        Some(Event::Kink(index, kink.crossed(tables, begin, to)?))
    })
}

/// Whether a voltage that begins the tried step on a corner, with the value `from`, goes to one side of it before it
/// reaches `to` on the other. If the step before has crossed the corner, the voltage continues in this direction.
fn departs_from(
    setup: &Setup<'_>,
    state: &SolverState,
    buffers: &StepBuffers,
    (index, kink): (usize, &Kink),
    [from, to]: [f64; 2],
) -> bool {
    match buffers.crossed {
        Some(crossed) if crossed.kink == index && crossed.time == state.time => {
            crossed.is_rising != (to > from)
        }
        _ => grazing::turns_back(setup, state, buffers, kink, [from, to]),
    }
}

/// Counts the crossing of the kink with this index, and records in the delay lines that their inputs may have a corner
/// at the present instant.
///
/// # Errors
/// If the kink is crossed so often that its element chatters.
fn cross_kink(
    solver: &mut Solver<'_>,
    events: &mut EventState,
    work: &mut WorkCounters,
    index: usize,
) -> Result<(), RunError> {
    work.crossings += 1;
    events.crossings[index] += 1;
    if let Some(kink) =
        solver.setup.kinks().nth(index).filter(|_| events.crossings[index] > MAX_EVENTS_PER_SPAN)
    {
        return Err(chatter(&solver.setup, solver.state.time, kink.element, ChatterRemedy::Input));
    }
    solver.record_discontinuity();
    Ok(())
}

/// The error of an element, given by its index, that chatters at a problem time, with advice that fits the element and
/// the kind of steps.
fn chatter(setup: &Setup<'_>, time: f64, element: usize, remedy: ChatterRemedy) -> RunError {
    let within = if setup.is_adaptive { CHATTER_SPAN_SHARE * setup.step } else { setup.step };
    // Without feedback, an element with one threshold only follows its input.
    let follows_input =
        remedy == ChatterRemedy::TwoThresholds && !is_in_feedback(&setup.program.lowered.readers, element);
    let remedy = if follows_input { ChatterRemedy::Input } else { remedy };
    let advice = match (remedy, setup.is_adaptive) {
        (ChatterRemedy::Rest, _) => "give it a larger \"rest\": a rebound below it ends at the stop",
        (ChatterRemedy::TwoThresholds, _) => {
            "use a \"relay\" with hysteresis, \"drop_out\" below \"pull_in\", or put a \"delay\" into the loop"
        }
        (ChatterRemedy::Hysteresis, false) => "give it hysteresis, or choose a shorter step",
        (ChatterRemedy::Hysteresis, true) => "give it hysteresis",
        (ChatterRemedy::Input, false) => "find out why its input oscillates, or choose a shorter step",
        (ChatterRemedy::Input, true) => "find out why its input oscillates",
    };
    let element = setup.program.name(element).to_owned();
    RunError::Chatter { element, max: MAX_EVENTS_PER_SPAN as usize, within, time, advice }
}
