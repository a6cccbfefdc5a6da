//! Discontinuities at known instants: a table has a corner, a level jumps, or an earlier jump or corner of its input
//! arrives at the output of a delay line.
//!
//! Every step ends at the next discontinuity ([`next_before`]). There [`propagate`] handles it and puts it into the
//! delay lines downstream. The delay lines are filled here, too: after every step, and within long adaptive steps.

use super::state::{Setup, Solver, SolverState};
use super::step_control::StepControl;
use crate::delay_line::{self, DelayLine};
use crate::trace::WorkCounters;

/// Largest error of a cubic through four successive points, as a share of their fourth difference: the value of
/// s (s - 1) (s - 2) (s - 3) / 24 is at most 1/24 in magnitude between the points.
const CUBIC_ERROR_SHARE: f64 = 1.0 / 24.0;
/// Largest number of pieces of one step, and so of points that one step puts into a delay line.
const MAX_PIECES_PER_STEP: f64 = 1000.0;
/// Difference below which two instants count as the same, as a share of the step.
pub(super) const INSTANT_TOLERANCE: f64 = 1e-9;

impl Solver<'_> {
    /// Puts the inputs over the last step into the delay lines: at its end and, with step control, also within it.
    pub(super) fn record_delay_inputs(&mut self, control: Option<&StepControl>) {
        record_within(self, control);
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.lowered.delays) {
            line.put(state.time, state.voltages[delay.input.index()]);
        }
        if let Some(sensitivities) = sensitivities {
            sensitivities.record_delay_inputs(setup.program, state.time);
        }
    }

    /// Records in the delay lines that their inputs may have a jump or a corner at the present instant.
    pub(super) fn record_discontinuity(&mut self) {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.lowered.delays) {
            line.put_discontinuity(state.time, state.voltages[delay.input.index()], 0);
        }
        if let Some(sensitivities) = sensitivities {
            sensitivities.record_discontinuity(setup.program, state.time);
        }
    }
}

/// Puts the inputs at instants within the last step into the delay lines, so that interpolation between them meets the
/// tolerance. Equal steps are short enough to need none.
fn record_within(solver: &mut Solver<'_>, control: Option<&StepControl>) {
    let (begin, length) = (solver.buffers.last.time, solver.state.time - solver.buffers.last.time);
    let count = match control {
        Some(control) if !solver.delay_lines.is_empty() => piece_count(solver, control),
        _ => 1,
    };
    for piece in 1..count {
        let time = begin + length * f64::from(piece) / f64::from(count);
        solver.interpolate(time);
        let Solver { setup, delay_lines, buffers, sensitivities, .. } = &mut *solver;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.lowered.delays) {
            line.put(time, buffers.voltages[delay.input.index()]);
        }
        if let Some(sensitivities) = sensitivities {
            sensitivities.record_within(setup.program, time);
        }
    }
}

/// The number of pieces (4 ... 1000) into which the last step is cut. The error of a cubic through their ends is then
/// at most the error that the tolerance allows over a delay. The error follows from the fourth difference of the
/// quarters of the step, and decreases with the fourth power of the number of pieces.
fn piece_count(solver: &mut Solver<'_>, control: &StepControl) -> u32 {
    let program = solver.setup.program;
    let (begin, length) = (solver.buffers.last.time, solver.state.time - solver.buffers.last.time);
    let (state, buffers) = (&solver.state, &mut solver.buffers);
    for (difference, delay) in buffers.fourth_differences.iter_mut().zip(&program.lowered.delays) {
        *difference = buffers.last.voltages[delay.input.index()] + state.voltages[delay.input.index()];
    }
    for (share, weight) in [(0.25, -4.0), (0.5, 6.0), (0.75, -4.0)] {
        solver.interpolate(begin + share * length);
        let buffers = &mut solver.buffers;
        for (difference, delay) in buffers.fourth_differences.iter_mut().zip(&program.lowered.delays) {
            *difference += weight * buffers.voltages[delay.input.index()];
        }
    }
    let errors =
        solver.buffers.fourth_differences.iter().map(|difference| CUBIC_ERROR_SHARE * difference.abs());
    let pairs = errors.zip(&solver.delay_lines);
    let excesses = pairs.map(|(error, line)| error / control.allowed_error(line.delay()));
    let count = 4.0 * excesses.fold(0.0, f64::max).powf(0.25);
    count.ceil().clamp(4.0, MAX_PIECES_PER_STEP) as u32
}

/// The end of the next step towards a problem time: the first discontinuity before `target`, else `target`.
pub(super) fn next_before(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &[DelayLine],
    target: f64,
) -> f64 {
    let arrivals = delay_lines.iter().filter_map(|line| line.next_arrival_before(target));
    arrivals.fold(next_level_or_corner(setup, state, target, setup.program.corners.times()), f64::min)
}

/// The problem time at which a kernel has to stop; infinity if none is known. A kernel crosses corners at the ends of
/// equal steps and corners in delay lines by itself, so `corners` lists only the corners within steps, ascending.
pub(super) fn end_of_kernel_run(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &[DelayLine],
    corners: &[f64],
) -> f64 {
    let jumps = delay_lines.iter().filter_map(DelayLine::next_jump);
    jumps.fold(next_level_or_corner(setup, state, f64::INFINITY, corners), f64::min)
}

/// The first jump of a level or corner of a table before `target`, else `target`. `corners` ascend.
fn next_level_or_corner(setup: &Setup<'_>, state: &SolverState, target: f64, corners: &[f64]) -> f64 {
    let tables = &setup.program.tables;
    let jumps = state.level_sources.iter().map(|source| source.next(tables));
    let instants = jumps
        .chain(next_corner(corners, state.time, setup.step))
        .filter(|time| *time < target - INSTANT_TOLERANCE * setup.step);
    instants.fold(target, f64::min)
}

/// The first corner after a problem time; `None` after the last. `corners` ascend.
pub(super) fn next_corner(corners: &[f64], time: f64, step: f64) -> Option<f64> {
    let next = corners.partition_point(|corner| *corner <= time + INSTANT_TOLERANCE * step);
    corners.get(next).copied()
}

/// Whether a table has a corner at this problem time.
fn is_at_corner(setup: &Setup<'_>, time: f64) -> bool {
    let corners = setup.program.corners.times();
    let next = corners.partition_point(|corner| *corner < time - INSTANT_TOLERANCE * setup.step);
    corners.get(next).is_some_and(|corner| *corner <= time + INSTANT_TOLERANCE * setup.step)
}

/// Handles the discontinuities at the present instant, and records them in the delay lines downstream: corners of
/// tables, jumps of levels, and jumps and corners that arrive from delay lines. Returns whether any voltage may have
/// jumped. In that case all voltages have been evaluated again.
pub(super) fn propagate(solver: &mut Solver<'_>, work: &mut WorkCounters) -> bool {
    let (program, time) = (solver.setup.program, solver.state.time);
    if is_at_corner(&solver.setup, time) {
        solver.record_discontinuity();
    }
    let arrived = delay_line::take_all_arrivals(&mut solver.delay_lines, time);
    let level_jumped =
        solver.state.change_levels(&program.tables, time + INSTANT_TOLERANCE * solver.setup.step);
    // Derivatives also jump where a corner arrives.
    let may_have_jumped =
        level_jumped || arrived.is_some_and(|jumps| jumps || solver.sensitivities.is_some());
    if may_have_jumped {
        solver.evaluate(work);
    }
    if level_jumped {
        solver.record_discontinuity();
    } else if arrived.is_some() {
        let Solver { state, delay_lines, sensitivities, .. } = solver;
        let inputs = program.lowered.delays.iter().map(|delay| state.voltages[delay.input.index()]);
        delay_line::propagate(delay_lines, time, inputs);
        if let Some(sensitivities) = sensitivities {
            sensitivities.record_discontinuity(program, time);
        }
    }
    may_have_jumped
}
