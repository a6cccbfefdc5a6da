//! Known discontinuities: instants at which a table has a corner, a level jumps, or a delay line puts out an earlier
//! jump or corner of its input. No step reaches across one of them.
//!
//! Steps end at the next discontinuity ([`next_before`]). There [`propagate`] carries it out and passes it on to the
//! delay lines behind it. The delay lines are filled here, too: after every step, and within long adaptive steps.

use super::state::{Setup, Solver, SolverState};
use super::step_control::StepControl;
use crate::delay_line::{self, DelayLine};
use crate::trace::Work;

/// The error of a cubic through four successive points is at most this share of their fourth difference.
const CUBIC_ERROR: f64 = 1.0 / 24.0;
/// At most this many points of one step are put into a delay line.
const MAX_PIECES: f64 = 1000.0;
/// Two instants are the same if they differ by less than this share of a step.
pub(super) const INSTANT_TOLERANCE: f64 = 1e-9;

impl Solver<'_> {
    /// Puts the last step into the delay lines: its end, and with step control also instants within it.
    pub fn record_delay_inputs(&mut self, control: Option<&StepControl>) {
        record_within(self, control);
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.delays) {
            line.put(state.time, state.voltages[delay.input.index()]);
        }
        if let Some(own) = sensitivities {
            own.record_delay_inputs(setup.program, state.time);
        }
    }

    /// Records in the delay lines that their inputs may jump or turn a corner at the present instant.
    pub fn record_discontinuity(&mut self) {
        let Solver { setup, state, delay_lines, sensitivities, .. } = self;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.delays) {
            line.put_break(state.time, state.voltages[delay.input.index()], 0);
        }
        if let Some(own) = sensitivities {
            own.record_discontinuity(setup.program, state.time);
        }
    }
}

/// Puts instants within the last step into the delay lines, so that interpolation there meets the tolerance. Equal
/// steps are short enough without.
fn record_within(solver: &mut Solver<'_>, control: Option<&StepControl>) {
    let (begin, length) = (solver.buffers.last.time, solver.state.time - solver.buffers.last.time);
    let pieces = match control {
        Some(control) if !solver.delay_lines.is_empty() => pieces(solver, control),
        _ => 1,
    };
    for piece in 1..pieces {
        let time = begin + length * f64::from(piece) / f64::from(pieces);
        solver.interpolate(time);
        let Solver { setup, delay_lines, buffers, sensitivities, .. } = &mut *solver;
        for (line, delay) in delay_lines.iter_mut().zip(&setup.program.delays) {
            line.put(time, buffers.voltages[delay.input.index()]);
        }
        if let Some(own) = sensitivities {
            own.record_within(setup.program, time);
        }
    }
}

/// The number of pieces into which the last step is cut, so that no cubic through their ends errs by more than the
/// tolerance allows in a delay. The error follows from the fourth difference of the quarters of the step.
fn pieces(solver: &mut Solver<'_>, control: &StepControl) -> u32 {
    let program = solver.setup.program;
    let (begin, length) = (solver.buffers.last.time, solver.state.time - solver.buffers.last.time);
    let (state, buffers) = (&solver.state, &mut solver.buffers);
    for (difference, delay) in buffers.fourth_differences.iter_mut().zip(&program.delays) {
        *difference = buffers.last.voltages[delay.input.index()] + state.voltages[delay.input.index()];
    }
    for (share, weight) in [(0.25, -4.0), (0.5, 6.0), (0.75, -4.0)] {
        solver.interpolate(begin + share * length);
        let buffers = &mut solver.buffers;
        for (difference, delay) in buffers.fourth_differences.iter_mut().zip(&program.delays) {
            *difference += weight * buffers.voltages[delay.input.index()];
        }
    }
    let errors = solver.buffers.fourth_differences.iter().map(|difference| CUBIC_ERROR * difference.abs());
    let pairs = errors.zip(&solver.delay_lines);
    let excesses = pairs.map(|(error, line)| error / control.allowed_error(line.delay()));
    let pieces = 4.0 * excesses.fold(0.0, f64::max).powf(0.25);
    pieces.ceil().clamp(4.0, MAX_PIECES) as u32
}

/// The end of the next step on the way to a time: the first discontinuity before `target`, else `target`.
pub(super) fn next_before(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &[DelayLine],
    target: f64,
) -> f64 {
    let echoes = delay_lines.iter().filter_map(|line| line.echo_before(target));
    echoes.fold(next_level_or_corner(setup, state, target, setup.program.corners.times()), f64::min)
}

/// The time at which a kernel has to stop. A kernel crosses corners at the ends of equal steps and echoes of corners by
/// itself, so `corners` lists only the other corners.
pub(super) fn end_of_kernel_run(
    setup: &Setup<'_>,
    state: &SolverState,
    delay_lines: &[DelayLine],
    corners: &[f64],
) -> f64 {
    let jumps = delay_lines.iter().filter_map(DelayLine::next_jump);
    jumps.fold(next_level_or_corner(setup, state, f64::INFINITY, corners), f64::min)
}

/// The first jump of a level or corner of a table before `target`, else `target`.
fn next_level_or_corner(setup: &Setup<'_>, state: &SolverState, target: f64, corners: &[f64]) -> f64 {
    let tables = &setup.program.tables;
    let jumps = state.level_sources.iter().map(|source| source.next(tables));
    let before = jumps
        .chain(next_corner(corners, state.time, setup.step))
        .filter(|time| *time < target - INSTANT_TOLERANCE * setup.step);
    before.fold(target, f64::min)
}

/// The first corner after a time. `corners` ascend.
fn next_corner(corners: &[f64], time: f64, step: f64) -> Option<f64> {
    let next = corners.partition_point(|corner| *corner <= time + INSTANT_TOLERANCE * step);
    corners.get(next).copied()
}

/// Whether a table has a corner at this time.
fn is_at_corner(setup: &Setup<'_>, time: f64) -> bool {
    let corners = setup.program.corners.times();
    let next = corners.partition_point(|corner| *corner < time - INSTANT_TOLERANCE * setup.step);
    corners.get(next).is_some_and(|corner| *corner <= time + INSTANT_TOLERANCE * setup.step)
}

/// Carries out the discontinuities at the present instant and passes them on to the delay lines: corners of tables,
/// jumps of levels, and the echoes that delay lines put out. Returns whether any voltage may have jumped; all voltages
/// are evaluated again then.
pub(super) fn propagate(solver: &mut Solver<'_>, work: &mut Work) -> bool {
    let (program, time) = (solver.setup.program, solver.state.time);
    if is_at_corner(&solver.setup, time) {
        solver.record_discontinuity();
    }
    let arrived = delay_line::hear(&mut solver.delay_lines, time);
    let jumped = solver.state.change_levels(&program.tables, time + INSTANT_TOLERANCE * solver.setup.step);
    // Derivatives also jump at the echo of a corner.
    let moved = jumped || arrived.is_some_and(|jumps| jumps || solver.sensitivities.is_some());
    if moved {
        solver.evaluate(work);
    }
    if jumped {
        solver.record_discontinuity();
    } else if arrived.is_some() {
        let Solver { state, delay_lines, sensitivities, .. } = solver;
        let inputs = program.delays.iter().map(|delay| state.voltages[delay.input.index()]);
        delay_line::pass_on(delay_lines, time, inputs);
        if let Some(own) = sensitivities {
            own.record_discontinuity(program, time);
        }
    }
    moved
}
