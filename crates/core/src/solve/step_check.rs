//! Checks during a run whether its equal steps are short enough.
//!
//! At some steps, which `check_plan` spreads evenly over the run, the step is also taken in two halves. The difference
//! gives the error of the step. The stages give the largest rate at which the circuit responds: if it is too large for
//! the step, the method is unstable and errors grow. The run itself is not changed.
//!
//! A short episode can begin with an event: a change of mode, a jump, or a phase. So steps after events are checked in
//! addition.

use super::buffers::StepBuffers;
use super::check_plan::CheckPlan;
use super::evaluate::{Scope, trial};
use super::events::{event_at, kink_crossed};
use super::runge_kutta::try_step;
use super::state::{Setup, Solver, SolverState, read_rates};
use super::turns::length_to_turn;
use crate::delay_line::DelayLine;

/// Up to this number of events the step after each is checked. Then half of this number is checked until the number of
/// events doubles.
const EXAMINED_EVENTS: u64 = 32;
/// If more than one in this many planned checks meets an event, the errors of the run are not known. Then the run is
/// compared with another, which takes long if there are many events.
const UNKNOWN_SHARE: u64 = 20;
/// Largest number of changes of mode and crossings of kinks in a run for this comparison.
const MAX_COMPARED_EVENTS: u64 = 1000;
/// The product of a decay rate and the step above which the classical method of order 4 is unstable.
const STABILITY_LIMIT: f64 = 2.785;
/// The product that the recommended step has, well within the limit.
const RECOMMENDED_PRODUCT: f64 = 1.4;
/// Advance of an angle in one step, in periods, above which the steps may not show the oscillation.
const LARGEST_ADVANCE: f64 = 0.25;
/// The advance that the recommended step has, in periods.
const RECOMMENDED_ADVANCE: f64 = 0.02;
/// The inverse of the golden ratio, which is no ratio of small numbers.
const GOLDEN_SHARE: f64 = 0.618_033_988_749_895;
/// Share of the step with which a run is compared if events end most of its steps: half the golden ratio. With half the
/// step, the events could end the same steps.
const INTERRUPTED_SHARE: f64 = 0.5 * GOLDEN_SHARE;
/// Least share of the step with which a run is compared: a twentieth of the golden ratio, which is no ratio of small
/// numbers, so that an oscillation that one step does not show is seen in the other.
const LEAST_COMPARED_SHARE: f64 = 0.05 * GOLDEN_SHARE;
/// Error of one step, in volts, below which an unstable method does no harm.
const HARMLESS_ERROR: f64 = 1e-4;
/// Change of a state in one step, in volts, below which an unstable method does no harm at an event.
const HARMLESS_CHANGE: f64 = 1e-2;
/// If the method is unstable at one in this many checks with events, the steps are in doubt.
const UNSTABLE_SHARE: u64 = 5;
/// Estimated error of a run, in volts, above which its step is too long: 0.1 % of 100 V.
const LARGEST_ERROR: f64 = 0.1;
/// The same for a run with few changes of mode: a small error of a voltage near a threshold is a large error of
/// the time of a change.
const LARGEST_ERROR_WITH_CHANGES: f64 = 3e-3;
/// The error of one step of order 4 after halving it is this share of the difference.
const HALVING_SHARE: f64 = 16.0 / 15.0;
/// Change of the states by the change of the rates in half a step, in volts, up to which rounding decides the response.
const LEAST_CHANGE: f64 = 1e-9;
/// Number of multiplications by the derivatives of the rates over which the growth of a change is the mean. It is even
/// because of oscillations.
const MULTIPLICATIONS: u32 = 4;
/// Largest change of a state, in volts, for which derivatives of the rates are computed.
const SMALL_CHANGE: f64 = 1e-4;

/// The checks of a run.
#[derive(Debug, Clone)]
pub(super) struct StepCheck {
    /// The steps that are checked.
    plan: CheckPlan,
    /// Number of the next step that is checked, counted from 1 in the present phase.
    next: u64,
    /// Number of steps since the last initial condition, including those of the present phase that are still to be taken.
    steps: u64,
    /// Number of planned checks, and of those with a result.
    attempts: u64,
    results: u64,
    /// Sum of the errors of every state over all results of planned checks, in volts.
    sums: Vec<f64>,
    /// The first state of all repetitions at which the method was unstable, whether it did harm or not.
    run_unstable: Option<Unstable>,
    /// Number of planned checks of all repetitions, and of those without a result because of an event.
    run_attempts: u64,
    run_interruptions: u64,
    /// Number of changes of mode and jumps so far.
    event_count: u64,
    /// Number of changes of mode so far.
    changes: u64,
    /// Number of steps of all repetitions that followed an event.
    steps_after_events: u64,
    /// Sum of the errors of every state over the checked steps after events, in volts.
    sums_after_events: Vec<f64>,
    /// Number of checks without a result at which the method was unstable.
    unstable_events: u64,
    /// The state at which the method was unstable first.
    unstable: Option<Unstable>,
    /// The element whose angle advances most in a step, and the advance in periods.
    fastest: (usize, f64),
    /// The state in the middle of a step.
    middle: Option<Box<SolverState>>,
    /// The states at the end of a whole step.
    whole: Vec<f64>,
}

/// A state at which the method is unstable.
#[derive(Debug, Clone, Copy)]
struct Unstable {
    /// Index of the state that changes most.
    state: usize,
    /// The largest product of a response rate and the step so far.
    product: f64,
}

impl Unstable {
    /// The doubt about a step at which the method is unstable. The run is compared with one of this share of the step.
    fn doubt(self, setup: &Setup<'_>, compared_share: f64) -> StepDoubt {
        let element = setup.program.lowered.states[self.state].element;
        let recommended = setup.step * RECOMMENDED_PRODUCT / self.product;
        StepDoubt::Unstable { element, recommended, compared_share }
    }
}

impl StepCheck {
    /// The checks of a run of a program with this number of states. The run takes `run_steps` steps if no phase ends
    /// early.
    pub(super) fn new(states: usize, run_steps: u64) -> Self {
        StepCheck {
            plan: CheckPlan::new(run_steps),
            next: u64::MAX,
            steps: 0,
            attempts: 0,
            results: 0,
            sums: vec![0.0; states],
            run_unstable: None,
            run_attempts: 0,
            run_interruptions: 0,
            event_count: 0,
            changes: 0,
            steps_after_events: 0,
            sums_after_events: vec![0.0; states],
            unstable_events: 0,
            unstable: None,
            fastest: (0, 0.0),
            middle: None,
            whole: vec![0.0; states],
        }
    }

    /// Forgets the results, for a new initial condition.
    pub(super) fn reset(&mut self) {
        let StepCheck { plan, run_unstable, run_attempts, run_interruptions, steps_after_events, .. } = *self;
        let (middle, new) = (self.middle.take(), StepCheck::new(self.sums.len(), 0));
        let whole_run = StepCheck { plan, run_unstable, run_attempts, run_interruptions, ..new };
        *self = StepCheck { steps_after_events, middle, ..whole_run };
    }

    /// Plans the checks of a phase with this number of steps.
    pub(super) fn begin_phase(&mut self, steps: u64) {
        self.plan.begin_phase(steps);
        self.next = self.plan.next();
        self.steps += steps;
        self.note_event(1);
    }

    /// Notes how many changes of mode and jumps there have been since the initial condition, before the step with this
    /// number in the present phase.
    pub(super) fn note_events(&mut self, [changes, jumps]: [u64; 2], next_step: u64) {
        self.changes = changes;
        if changes + jumps > self.event_count {
            self.event_count = changes + jumps;
            self.note_event(next_step);
        }
    }

    /// Notes an event before a step. Checks the step, unless many steps after events were checked.
    fn note_event(&mut self, next_step: u64) {
        self.steps_after_events += 1;
        if is_examined(self.steps_after_events) {
            self.next = self.next.min(next_step);
        }
    }

    /// Number of steps before the next check, if the next step has this number in the present phase.
    pub(super) fn steps_before(&self, next_step: u64) -> u64 {
        self.next.saturating_sub(next_step)
    }

    /// Checks the next step, which has this number in the present phase. The error of a step with a kink in it is not
    /// known, because the solver does not take it as a whole. A step in which a mode changes is checked as if it did not.
    pub(super) fn check(&mut self, solver: &mut Solver<'_>, next_step: u64) {
        let is_planned = self.plan.next() <= next_step;
        self.plan.advance(next_step);
        self.next = self.plan.next();
        self.attempts += u64::from(is_planned);
        self.run_attempts += u64::from(is_planned);
        let Solver { setup, state, delay_lines, buffers, .. } = solver;
        let length = setup.step;
        try_step(setup, state, delay_lines, buffers, length);
        for angle in &setup.program.lowered.angles {
            let periods = angle.periods(&state.voltages, &buffers.voltages);
            if periods > self.fastest.1 {
                self.fastest = (angle.element, periods);
            }
        }
        let meets_event = event_at(setup, state, buffers, &buffers.voltages).is_some();
        let meets_corner = has_corner(setup, state, delay_lines, buffers, length);
        self.whole.copy_from_slice(&buffers.states);
        let response = response(setup, state, delay_lines, buffers, length)
            .filter(|response| response.product > STABILITY_LIMIT);
        if let Some(response) = response {
            note_unstable(&mut self.run_unstable, response);
        }
        if meets_event || meets_corner {
            self.run_interruptions += u64::from(is_planned);
            let harmful = response.filter(|response| is_planned && response.change > HARMLESS_CHANGE);
            if let Some(response) = harmful {
                self.unstable_events += 1;
                note_unstable(&mut self.unstable, response);
            }
        }
        if meets_corner {
            return;
        }
        let middle = self.middle.get_or_insert_with(|| Box::new(state.clone()));
        middle.as_mut().clone_from(state);
        try_step(setup, state, delay_lines, buffers, 0.5 * length);
        if has_corner(setup, state, delay_lines, buffers, 0.5 * length) {
            return;
        }
        move_to_end(setup, middle, buffers, 0.5 * length);
        try_step(setup, middle, delay_lines, buffers, 0.5 * length);
        if has_corner(setup, middle, delay_lines, buffers, 0.5 * length) {
            return;
        }
        let worst = self.add(&buffers.states, is_planned);
        if let Some(response) = response.filter(|_| worst > HARMLESS_ERROR) {
            note_unstable(&mut self.unstable, response);
        }
    }

    /// Adds the errors of a step, from the states at the end of its second half. Returns the largest one in volts.
    fn add(&mut self, halves: &[f64], is_planned: bool) -> f64 {
        self.results += u64::from(is_planned);
        let sums = if is_planned { &mut self.sums } else { &mut self.sums_after_events };
        let mut worst = 0.0;
        for ((sum, halves), whole) in sums.iter_mut().zip(halves).zip(&self.whole) {
            let error = HALVING_SHARE * (halves - whole).abs();
            *sum += error;
            worst = f64::max(worst, error);
        }
        worst
    }

    /// Whether the steps of a run are in doubt because many of its checks met events. `false` if the run has too many
    /// changes of mode and crossings of kinks for a comparison.
    pub(super) fn is_interrupted(&self, crossed_events: u64) -> bool {
        self.run_interruptions * UNKNOWN_SHARE > self.run_attempts && crossed_events <= MAX_COMPARED_EVENTS
    }

    /// The doubt about a run with this doubt whose checks met many events.
    pub(super) fn interrupted(&self, setup: &Setup<'_>, doubt: Option<StepDoubt>) -> StepDoubt {
        match doubt {
            Some(StepDoubt::Unstable { element, recommended, compared_share }) => {
                let compared_share = compared_share.min(INTERRUPTED_SHARE);
                StepDoubt::Unstable { element, recommended, compared_share }
            }
            Some(fast @ StepDoubt::Fast { .. }) => fast,
            _ => self
                .run_unstable
                .map_or(StepDoubt::Interrupted, |unstable| unstable.doubt(setup, INTERRUPTED_SHARE)),
        }
    }

    /// The doubt about the steps of the repetition; `None` if the checks found them short enough. `is_overloaded` is
    /// whether a lamp is lit.
    pub(super) fn doubt(&self, setup: &Setup<'_>, is_overloaded: bool) -> Option<StepDoubt> {
        let share = self.steps as f64 / self.results.max(1) as f64;
        let errors = self.sums.iter().zip(&self.sums_after_events).map(|(sum, after)| sum * share + after);
        let error = errors.fold(0.0, f64::max);
        // Events at a few steps may only be switchings that the solver locates. After an overload the outputs at their
        // limits no longer show the instability that caused it.
        let is_unstable = self.unstable.is_some()
            && (is_overloaded
                || error > LARGEST_ERROR
                || self.unstable_events * UNSTABLE_SHARE >= self.attempts);
        let compared_share = if is_overloaded { LEAST_COMPARED_SHARE } else { 0.5 };
        let unstable =
            self.unstable.filter(|_| is_unstable).map(|unstable| unstable.doubt(setup, compared_share));
        let (element, periods) = self.fastest;
        let recommended = setup.step * RECOMMENDED_ADVANCE / periods;
        let fast = (periods > LARGEST_ADVANCE).then_some(StepDoubt::Fast { element, recommended });
        let has_few_changes = (1..=MAX_COMPARED_EVENTS).contains(&self.changes);
        let most = if has_few_changes { LARGEST_ERROR_WITH_CHANGES } else { LARGEST_ERROR };
        let inaccurate = (error > most).then_some(StepDoubt::Inaccurate);
        StepDoubt::worse(StepDoubt::worse(unstable, fast), inaccurate)
    }
}

/// The doubt that the steps of a run are too long.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum StepDoubt {
    /// The method is stable, but its errors are large.
    Inaccurate,
    /// Events prevented many checks, so that the errors are not known.
    Interrupted,
    /// An angle advances by a large part of a period in a step.
    Fast {
        /// Index of the element whose angle it is.
        element: usize,
        /// A step that would do, in problem seconds.
        recommended: f64,
    },
    /// The method is unstable.
    Unstable {
        /// Index of the element whose state grows.
        element: usize,
        /// A step that would do, in problem seconds.
        recommended: f64,
        /// The step of the run with which the run is compared, as a share of its own.
        compared_share: f64,
    },
}

impl StepDoubt {
    /// The doubt about the step in problem seconds of a run in which the element with this index was overloaded.
    pub(super) fn of_overload(element: usize, step: f64) -> Self {
        let compared_share = LEAST_COMPARED_SHARE;
        StepDoubt::Unstable { element, recommended: compared_share * step, compared_share }
    }

    /// The step of the run with which a run of this step is compared: half of it, unless that would not show an
    /// oscillation either, or would give the same steps between events or the same overload.
    pub(super) fn compared_step(self, step: f64) -> f64 {
        match self {
            StepDoubt::Interrupted => INTERRUPTED_SHARE * step,
            StepDoubt::Fast { recommended, .. } => recommended.max(LEAST_COMPARED_SHARE * step),
            StepDoubt::Unstable { compared_share, .. } => compared_share * step,
            _ => 0.5 * step,
        }
    }

    /// The worse of two doubts: the one with the shorter recommended step.
    pub(super) fn worse(one: Option<Self>, other: Option<Self>) -> Option<Self> {
        let recommended = |doubt: &Self| match doubt {
            StepDoubt::Inaccurate | StepDoubt::Interrupted => f64::INFINITY,
            StepDoubt::Unstable { recommended, .. } | StepDoubt::Fast { recommended, .. } => *recommended,
        };
        let doubts = one.into_iter().chain(other);
        doubts.min_by(|a, b| recommended(a).total_cmp(&recommended(b)))
    }
}

/// Notes that the method is unstable.
fn note_unstable(unstable: &mut Option<Unstable>, response: Response) {
    let Response { state, product, .. } = response;
    let unstable = unstable.get_or_insert(Unstable { state, product });
    unstable.product = unstable.product.max(product);
}

/// Whether the step after an event is checked. Events count from 1.
fn is_examined(event: u64) -> bool {
    let octaves = (event / EXAMINED_EVENTS).checked_ilog2().map_or(0, |octave| octave + 1);
    event.is_multiple_of(1 << octaves)
}

/// Whether the solver would not take the step of this length that was tried from a state as a whole, because of an event
/// in it that is more than a change of mode.
fn has_corner(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    length: f64,
) -> bool {
    buffers.hint.is_some()
        || kink_crossed(setup, state, buffers, &buffers.voltages).is_some()
        || length_to_turn(setup, state, delay_lines, buffers, (length, false)).is_some()
}

/// How the rates respond to a change of the states within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Response {
    /// Index of the state whose rate changes most.
    state: usize,
    /// The product of the response rate and the step.
    product: f64,
    /// The change of the states that it causes in a step, in volts.
    change: f64,
}

/// The response within the step that was tried last. The buffers keep its rates only. `None` if rounding decides it, or
/// if a rate is not finite.
///
/// It is that of small changes from the present states in the middle of the step, because the stages of an unstable step
/// may be beyond a corner.
fn response(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &mut [DelayLine],
    buffers: &mut StepBuffers,
    length: f64,
) -> Option<Response> {
    let [begin, second, third] = [0, 1, 2].map(|stage| buffers.stage_rates[stage].clone());
    let mut rates_from = |change: &[f64], factor: f64| {
        for ((moved, volts), change) in buffers.states.iter_mut().zip(&state.states).zip(change) {
            *moved = volts + factor * change;
        }
        trial(setup.program, state, delay_lines, buffers, state.time + 0.5 * length, Scope::Rates);
        let mut rates = vec![0.0; change.len()];
        read_rates(setup.program, &buffers.voltages, &mut rates);
        rates
    };
    let (change, last) = (difference(&second, &begin), difference(&third, &second));
    let size = length * largest(&change);
    if size <= LEAST_CHANGE || !size.is_finite() {
        return None;
    }
    let base = rates_from(&change, 0.0);
    let growth = growth(&change, |change| {
        let factor = SMALL_CHANGE / largest(change);
        difference(&rates_from(change, factor), &base).iter().map(|rate| rate / factor).collect()
    });
    let state = (0..last.len()).fold(0, |most, at| if last[at].abs() > last[most].abs() { at } else { most });
    Some(Response { state, product: length * growth, change: length * largest(&last) })
}

/// The rate at which a change of the states grows, per second: the mean of several multiplications by the derivatives of
/// the rates, which `derivative` does. Over two of them, an oscillation grows by the square of its angular frequency,
/// whatever the scales of its states are. A chain of as many integrators without feedback does not grow.
fn growth(change: &[f64], mut derivative: impl FnMut(&[f64]) -> Vec<f64>) -> f64 {
    let size = |change: &[f64]| change.iter().map(|change| change * change).sum::<f64>().sqrt();
    let mut last = change.to_vec();
    for _ in 0..MULTIPLICATIONS {
        last = derivative(&last);
        if size(&last) == 0.0 {
            return 0.0;
        }
    }
    (size(&last) / size(change)).powf(1.0 / f64::from(MULTIPLICATIONS))
}

/// The difference of two lists of rates.
fn difference(rates: &[f64], others: &[f64]) -> Vec<f64> {
    rates.iter().zip(others).map(|(rate, other)| rate - other).collect()
}

/// The largest rate, without sign.
fn largest(rates: &[f64]) -> f64 {
    rates.iter().fold(0.0, |largest, rate| f64::max(largest, rate.abs()))
}

/// Moves a copy of the state to the end of the step that was tried from it.
fn move_to_end(setup: &Setup<'_>, state: &mut SolverState, buffers: &StepBuffers, length: f64) {
    state.time += length;
    state.states.copy_from_slice(&buffers.states);
    state.voltages.copy_from_slice(&buffers.voltages);
    read_rates(setup.program, &state.voltages, &mut state.rates);
    state.sample_values(setup.program);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_after_few_events_are_all_checked_and_those_after_many_sparsely() {
        let examined = |events: u64| (1..=events).filter(|event| is_examined(*event)).count() as u64;
        assert_eq!(examined(EXAMINED_EVENTS), EXAMINED_EVENTS);
        assert_eq!(examined(1 << 20), EXAMINED_EVENTS + 15 * EXAMINED_EVENTS / 2);
    }

    /// The growth of a change of the states of x' = J x.
    fn growth_of(matrix: [[f64; 2]; 2], change: [f64; 2]) -> f64 {
        growth(&change, |change| matrix.iter().map(|row| row[0] * change[0] + row[1] * change[1]).collect())
    }

    #[test]
    fn a_change_grows_by_the_decay_rate_or_the_angular_frequency() {
        assert!((growth_of([[0.0, 0.0], [0.0, -1000.0]], [0.0, 1.0]) - 1000.0).abs() < 1e-9);
        assert_eq!(growth_of([[0.0, 0.0], [0.0, 0.0]], [1.0, 1.0]), 0.0);
        // An oscillator of 100 rad/s with gains of 1 and 10,000.
        for change in [[1.0, 0.0], [0.0, 1.0], [0.3, 50.0]] {
            assert!((growth_of([[0.0, 1.0], [-1e4, 0.0]], change) - 100.0).abs() < 1e-9);
        }
        // Two integrators in a chain with a gain of 100.
        assert_eq!(growth_of([[0.0, 0.0], [100.0, 0.0]], [1.0, 1.0]), 0.0);
    }
}
