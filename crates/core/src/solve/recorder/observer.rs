//! The recorder as the observer of a machine: it writes the samples that are due after each step.
//!
//! On the fast path it reads the voltages of the kernel, otherwise those of the solver.

use super::{Instant, Recorder, Watch, track_values};
use crate::grid::SAME_INSTANT;
use crate::kernel::Steps;
use crate::solve::fast_path::KernelRun;
use crate::solve::lamps::Lamps;
use crate::solve::observer::StepObserver;
use crate::solve::state::Solver;

impl StepObserver for Recorder<'_> {
    /// Writes the samples within the step, and updates the extremes by the step and its end before modes change.
    fn step_accepted(&mut self, solver: &mut Solver<'_>) {
        if let Some(watch) = &mut self.watch {
            watch.add_step(solver, self.hold_time);
        }
        while let Some(time) = self.next_before(self.clock(solver.state.time) * (1.0 - SAME_INSTANT)) {
            solver.interpolate(time - self.hold_time);
            self.write_sample(time, solver, Instant::Interpolated);
            self.set_next_sample(self.next_index + 1);
        }
        self.observe_extrema(solver);
        self.observe_present(solver);
        self.before_jump(solver);
    }

    /// Keeps the voltages before relays switch, if a relay may end the phase.
    fn before_jump(&mut self, solver: &Solver<'_>) {
        self.watch_present(solver);
        if self.end_condition.is_some() {
            self.voltages_before_switching.copy_from_slice(&solver.state.voltages);
            let derivatives = track_values(&self.signals, solver, Instant::Present).skip(self.signals.len());
            self.derivatives_before_switching
                .iter_mut()
                .zip(derivatives)
                .for_each(|(slope, value)| *slope = value);
        }
    }

    /// Writes the sample at the end of the step, after relays have switched. If a relay ends the phase, a sample of the
    /// voltages before it switched comes first.
    fn step_ended(&mut self, solver: &Solver<'_>) {
        self.watch_present(solver);
        let due = self.due_sample(solver.state.time);
        if let Some(end_condition) = &mut self.end_condition {
            end_condition.read(&solver.state.modes);
        }
        if self.is_phase_over() {
            self.write_sample_before_switching(due.unwrap_or(self.clock(solver.state.time)));
        }
        self.observe_present(solver);
        self.is_fresh = due.is_some();
        if let Some(time) = due {
            self.write_sample(time, solver, Instant::Present);
            self.set_next_sample(self.next_index + 1);
        }
        self.report_progress(solver.state.time);
    }

    fn next_sample(&self) -> f64 {
        let next_point = |watch: &Watch| watch.next_point(self.step, self.hold_time);
        let watched = self.watch.as_ref().map_or(f64::INFINITY, next_point);
        watched.min(self.next_time - self.hold_time)
    }

    /// Writes the samples within the kernel's last step, and adds its watched points.
    fn kernel_reached_jump(&mut self, time: f64, tables: &[Vec<[f64; 2]>], run: &mut KernelRun) {
        if let Some(watch) = &mut self.watch {
            watch.add_kernel_step((time, self.hold_time), self.step, tables, run, self.signals.len());
        }
        while let Some(sample) = self.next_before(self.clock(time) * (1.0 - SAME_INSTANT)) {
            run.interpolate(tables, sample - self.hold_time);
            self.observe_within(sample, run);
            self.write_kernel_sample(sample, run.voltages());
        }
    }

    /// Writes the samples within the kernel's last step and the one at its end.
    fn kernel_stepped(&mut self, time: f64, tables: &[Vec<[f64; 2]>], run: &mut KernelRun) {
        self.kernel_reached_jump(time, tables, run);
        if self.due_sample(time).is_some() {
            run.evaluate_present(tables);
        }
        self.sample_kernel(time, run);
    }

    /// Adds a corner to the curves.
    fn kernel_at_corner(&mut self, time: f64, tables: &[Vec<[f64; 2]>], run: &mut KernelRun) {
        if let Some(watch) = self.watch.as_mut().filter(|watch| watch.needs_events()) {
            run.evaluate_present(tables);
            watch.add_event(time + self.hold_time, run, self.signals.len());
        }
    }

    /// Writes the samples at the ends of the kernel's steps.
    fn kernel_stepped_recording(&mut self, time: f64, run: &KernelRun, steps: Steps) {
        if let Some(watch) = &mut self.watch {
            watch.add_kernel_steps(steps, self.hold_time, run, self.signals.len());
        }
        self.is_fresh = false;
        for step in self.steps_with_samples(steps) {
            self.is_fresh = self.next_time < self.end_of(steps, step) * (1.0 + SAME_INSTANT);
            if self.is_fresh {
                self.write_kernel_sample(self.next_time, run.voltages_after(step));
            }
        }
        self.report_progress(time);
    }

    /// The steps end with the next point of curves, from whose voltages the distance to the point after it follows.
    fn steps_before_inner_sample(&self, steps: Steps) -> u64 {
        let mut steps = steps;
        if let Some(watch) = &self.watch {
            if watch.looks_within(self.step) {
                return 0;
            }
            steps.count = watch.steps_to_point(steps, self.hold_time);
        }
        let (mut index, mut time) = (self.next_index, self.next_time);
        for step in self.steps_with_samples(steps) {
            let end = self.end_of(steps, step);
            if time < end * (1.0 - SAME_INSTANT) {
                return step;
            }
            if time < end * (1.0 + SAME_INSTANT) {
                index += 1;
                time = self.grid.time(index);
            }
        }
        steps.count
    }

    /// Updates the extremes by those of the kernel run, and by its last voltages. Curves get the last voltages, too,
    /// because the kernel is left for an event.
    fn left_fast_path(&mut self, run: &KernelRun) {
        if let Some(watch) = self.watch.as_mut().filter(|watch| watch.needs_events()) {
            watch.add_event(run.time() + self.hold_time, run, self.signals.len());
        }
        let repetition = self.trace.repetitions.len() - 1;
        for (track, (extremes, last)) in self.trace.tracks.iter_mut().zip(run.extremes().zip(run.voltages()))
        {
            let reached = extremes.into_iter().flatten().filter(|(time, _)| time.is_finite());
            reached.for_each(|(time, volts)| track.observe(repetition, time + self.hold_time, volts));
            track.observe(repetition, run.time() + self.hold_time, last);
        }
    }

    fn should_stop(&self, lamps: &Lamps) -> bool {
        self.is_cancelled || self.hold_on_overload && lamps.is_any_lit()
    }

    fn is_cancelled(&self) -> bool {
        self.is_cancelled
    }

    fn is_phase_over(&self) -> bool {
        self.end_condition.is_some_and(|end_condition| end_condition.is_met)
    }
}
