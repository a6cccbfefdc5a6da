//! Watched outputs: their voltages at the end of every step, and within steps where a straight line would not do.
//!
//! An oscilloscope needs more than samples: the extremes between samples, both sides of a jump, and a curve without
//! corners. Watching never changes the steps. Points within a step come from the interpolation of the solver.
//!
//! A live run collects the points. Another run passes them to its curves, which need fewer of them.

use super::curve_follower::CurveFollower;
use crate::grid::SAME_INSTANT;
use crate::ir::Register;
use crate::kernel::Steps;
use crate::solve::fast_path::KernelRun;
use crate::solve::state::Solver;
use crate::trace::SignalCurve;

/// Largest number of points within a step.
const MAX_POINTS_WITHIN: f64 = 64.0;
/// Least number of points in the largest permitted time between two points. Of shorter steps, not every one needs a
/// point: a kernel then takes several at once.
const POINTS_IN_LONGEST: f64 = 8.0;
/// The same if changes of the voltages are limited, too.
const POINTS_IN_LONGEST_CURVE: f64 = 32.0;

/// The voltages of the watched outputs along a run, in order of time.
///
/// The times are those of the recorder's clock. Two points with the same time are the two sides of a jump.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct WatchedPoints {
    /// Number of watched outputs.
    width: usize,
    /// For every point: its time in seconds, then the voltages in volts.
    numbers: Vec<f64>,
}

impl WatchedPoints {
    /// The points: each with its time in seconds and the voltages of all watched outputs in volts.
    pub fn iter(&self) -> impl Iterator<Item = (f64, &[f64])> {
        self.numbers.chunks_exact(1 + self.width).map(|point| (point[0], &point[1..]))
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.numbers.len() / (1 + self.width)
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.numbers.is_empty()
    }

    /// Removes all points.
    pub fn clear(&mut self) {
        self.numbers.clear();
    }

    /// Adds a point.
    fn push(&mut self, time: f64, volts: &[f64]) {
        self.numbers.push(time);
        self.numbers.extend_from_slice(volts);
    }
}

/// The watched outputs of a run.
#[derive(Debug, Clone)]
pub(in crate::solve) struct Watch {
    /// The registers of the outputs.
    registers: Vec<Register>,
    /// Largest time between two points, in seconds.
    longest: f64,
    /// Largest change of a voltage between two points of a step, in volts; infinity if only the time counts.
    largest: f64,
    /// The points since the caller took them last. It stays empty if curves take the points.
    pub points: WatchedPoints,
    /// The curves that take the points; `None` if they are collected.
    follower: Option<CurveFollower>,
    /// The time of the last point by the recorder's clock; negative infinity if there is none.
    last_time: f64,
    /// The voltages of the last point.
    last: Vec<f64>,
    /// The voltages at the end of a step, while points within it are computed.
    end: Vec<f64>,
}

impl Watch {
    /// Watches registers. The ends of steps are points, unless many steps are shorter than `longest`: then there are
    /// several points in that time. A longer step gets points within it so that two points are at most `longest` seconds
    /// and `largest` volts apart, but not more than [`MAX_POINTS_WITHIN`] and only if the step itself is longer than
    /// `longest`.
    pub(in crate::solve) fn new(registers: Vec<Register>, longest: f64, largest: f64) -> Self {
        let zeros = || vec![0.0; registers.len()];
        let points = WatchedPoints { width: registers.len(), numbers: Vec::new() };
        Watch {
            last: zeros(),
            end: zeros(),
            registers,
            longest,
            largest,
            points,
            follower: None,
            last_time: f64::NEG_INFINITY,
        }
    }

    /// Watches registers for curves, which decide where they need points.
    pub(super) fn following(registers: Vec<Register>, follower: CurveFollower) -> Self {
        Watch { follower: Some(follower), ..Watch::new(registers, f64::INFINITY, f64::INFINITY) }
    }

    /// The curves; none if the points were collected.
    pub(super) fn into_curves(self) -> Vec<SignalCurve> {
        self.follower.map_or(Vec::new(), CurveFollower::into_curves)
    }

    /// Begins a repetition: the next point begins the curves.
    pub(super) fn begin_repetition(&mut self) {
        if let Some(follower) = &mut self.follower {
            follower.begin_repetition();
            self.last_time = f64::NEG_INFINITY;
        }
    }

    /// Adds the present voltages of the solver, at which a phase begins or ends.
    pub(super) fn add_phase_limit(&mut self, solver: &Solver<'_>, hold_time: f64) {
        self.add_present(solver, hold_time);
        self.follower.iter_mut().for_each(CurveFollower::restart);
    }

    /// Whether curves need the voltages that a kernel has at an event.
    pub(super) fn needs_events(&self) -> bool {
        self.follower.is_some()
    }

    /// Adds the voltages of a kernel at an event, at a time of the recorder's clock, unless the last point has this
    /// time. The watched voltages follow the `recorded` ones.
    pub(super) fn add_event(&mut self, time: f64, run: &KernelRun, recorded: usize) {
        if self.last_time != time {
            self.push(time, run.voltages().skip(recorded));
        }
        self.follower.iter_mut().for_each(CurveFollower::restart);
    }

    /// The watched registers.
    pub(in crate::solve) fn registers(&self) -> impl Iterator<Item = Register> + '_ {
        self.registers.iter().copied()
    }

    /// Whether the next step, of this length, needs points within it.
    pub(super) fn looks_within(&self, step: f64) -> bool {
        self.follower
            .as_ref()
            .map_or(step > self.longest * (1.0 + SAME_INSTANT), CurveFollower::is_within_step)
    }

    /// The problem time of the next point, if steps have this length. If there are points within steps, it is within the
    /// next step, which a kernel then takes alone.
    pub(super) fn next_point(&self, step: f64, hold_time: f64) -> f64 {
        let last = self.last_time - hold_time;
        if self.looks_within(step) {
            return last + 0.5 * step;
        }
        if let Some(follower) = &self.follower {
            return follower.next_point(last);
        }
        let points = if self.largest.is_finite() { POINTS_IN_LONGEST_CURVE } else { POINTS_IN_LONGEST };
        last + f64::max(step, self.longest / points)
    }

    /// The number of steps, from the first of these, up to the next point of curves. A kernel stores the voltages of all
    /// other points.
    pub(super) fn steps_to_point(&self, steps: Steps, hold_time: f64) -> u64 {
        match &self.follower {
            Some(follower) => steps.until(follower.next_point(self.last_time - hold_time)),
            None => steps.count,
        }
    }

    /// Whether a point is due at the end of a kernel's step, at a problem time.
    fn is_due(&self, time: f64, hold_time: f64) -> bool {
        self.follower.as_ref().is_none_or(|follower| {
            let next = || follower.next_point(self.last_time - hold_time);
            follower.is_within_step() || time * (1.0 + SAME_INSTANT) >= next()
        })
    }

    /// Adds a point at a time of the recorder's clock.
    fn push(&mut self, time: f64, volts: impl Iterator<Item = f64>) {
        self.last.iter_mut().zip(volts).for_each(|(last, volts)| *last = volts);
        self.pass_on(time);
    }

    /// Adds the last voltages, at a time of the recorder's clock, to the curves or to the points.
    fn pass_on(&mut self, time: f64) {
        self.last_time = time;
        match &mut self.follower {
            Some(follower) => follower.add(time, &self.last),
            None => self.points.push(time, &self.last),
        }
    }

    /// Adds the present voltages of the solver, unless the last point is equal.
    pub(in crate::solve) fn add_present(&mut self, solver: &Solver<'_>, hold_time: f64) {
        let time = solver.state.time + hold_time;
        let voltages = || self.registers.iter().map(|register| solver.state.voltages[register.index()]);
        if self.last_time != time || !voltages().eq(self.last.iter().copied()) {
            self.end.clear();
            self.end.extend(voltages());
            self.push_end(time);
        }
    }

    /// Adds the voltages in `end` as a point at a time of the recorder's clock.
    fn push_end(&mut self, time: f64) {
        std::mem::swap(&mut self.last, &mut self.end);
        self.pass_on(time);
    }

    /// Number of equal parts into which a step of this length is divided, whose ends have these voltages.
    fn parts(&self, length: f64, ends: impl Iterator<Item = (f64, f64)>) -> u32 {
        let parts = match &self.follower {
            Some(follower) => length / follower.seconds() * (1.0 - SAME_INSTANT),
            None if !self.looks_within(length) => 1.0,
            None => {
                let change = ends.map(|(begin, end)| (end - begin).abs()).fold(0.0, f64::max);
                f64::max(length / self.longest, change / self.largest)
            }
        };
        parts.ceil().clamp(1.0, MAX_POINTS_WITHIN) as u32
    }

    /// Adds the points of the step that the solver accepted last: those within it, and its end before modes change.
    pub(super) fn add_step(&mut self, solver: &mut Solver<'_>, hold_time: f64) {
        let (begin, end) = (solver.buffers.last.time, solver.state.time);
        let (first, last) = (&solver.buffers.last.voltages, &solver.state.voltages);
        let ends = self.registers.iter().map(|register| (first[register.index()], last[register.index()]));
        let parts = self.parts(end - begin, ends);
        for part in 1..parts {
            let time = between(begin, end, part, parts);
            solver.interpolate(time);
            self.end.clear();
            self.end.extend(self.registers.iter().map(|register| solver.buffers.voltages[register.index()]));
            self.push_end(time + hold_time);
        }
        self.add_present(solver, hold_time);
    }

    /// Adds the points that are due in a kernel's last step, which ends at this problem time: those within it, and its
    /// end. `step` is the length of the grid. It decides whether there are points within, as in
    /// [`next_point`](Self::next_point): the kernel keeps the begin of a step only then, and a difference of times can be
    /// longer by rounding. The watched voltages follow the `recorded` ones.
    pub(super) fn add_kernel_step(
        &mut self,
        (time, hold_time): (f64, f64),
        step: f64,
        tables: &[Vec<[f64; 2]>],
        run: &mut KernelRun,
        recorded: usize,
    ) {
        if !self.is_due(time, hold_time) {
            return;
        }
        run.evaluate_present(tables);
        let begin = self.last_time - hold_time;
        let parts = match self.looks_within(step) {
            true => self.parts(time - begin, self.last.iter().copied().zip(run.voltages().skip(recorded))),
            false => 1,
        };
        if parts > 1 {
            for part in 1..parts {
                let time = between(begin, time, part, parts);
                run.interpolate(tables, time);
                self.push(time + hold_time, run.voltages().skip(recorded));
            }
            run.evaluate_present(tables);
        }
        self.push(time + hold_time, run.voltages().skip(recorded));
    }

    /// Adds the ends of a kernel's steps at which points are due. The kernel has stored the voltages.
    pub(super) fn add_kernel_steps(
        &mut self,
        steps: Steps,
        hold_time: f64,
        run: &KernelRun,
        recorded: usize,
    ) {
        for step in 0..steps.count {
            let time = steps.end_of(step);
            if self.is_due(time, hold_time) {
                self.push(time + hold_time, run.voltages_after(step).skip(recorded));
            }
        }
    }
}

/// The time after some of equal parts of an interval.
fn between(begin: f64, end: f64, part: u32, parts: u32) -> f64 {
    begin + (end - begin) * f64::from(part) / f64::from(parts)
}
