//! The recorder: samples voltages on a separate time grid while the machine operates and holds.
//!
//! The recorder's clock counts the time of the machine and the time in hold. A sample within a step is interpolated, so
//! recording never changes the steps. For every signal the recorder also keeps the minimum and the maximum, which need
//! not be at a sample.

use std::ops::Range;

use super::error::RunError;
use super::fast_path::KernelRun;
use super::lamps::Lamps;
use super::observer::StepObserver;
use super::run::RunSettings;
use super::state::Solver;
use crate::grid::{Grid, SAME};
use crate::ir::{Probe, Program, Register};
use crate::kernel::Steps;
use crate::trace::{Deed, Ending, Mark, Sweep, Trace, Track, Work};

/// Samples voltages on a separate time grid. Its clock also runs while the machine holds.
pub(super) struct Recorder<'a> {
    /// The record so far.
    pub trace: Trace,
    /// Called with the seconds recorded so far, summed over all runs.
    progress: &'a mut dyn FnMut(f64),
    /// Seconds recorded before the present sweep.
    before: f64,
    /// The recorded signals.
    probes: Vec<Probe>,
    grid: Grid,
    /// Index of the next sample in the grid of the present sweep.
    next: u64,
    /// Time of the next sample by the recorder's clock.
    next_time: f64,
    /// Seconds that the present sweep was held: the recorder's clock minus problem time.
    held: f64,
    /// Whether a sweep has begun since the last initial condition.
    running: bool,
    /// Whether the last sample shows the present voltages.
    is_fresh: bool,
    /// The seconds that the sweep had been held when a lamp lit, by element; `None` for a lamp that is off.
    lit: Vec<Option<f64>>,
    /// Whether the machine goes into hold when a lamp lights.
    hold_on_overload: bool,
    /// The change of a relay that ends the present phase; `None` if no relay does.
    pub watch: Option<Watch>,
    /// Every voltage just before the last changes of mode, while a relay is watched.
    unswitched: Vec<f64>,
    /// The recorded derivatives just before the last changes of mode.
    unswitched_derivatives: Vec<f64>,
}

/// The instant that a sample shows.
#[derive(Clone, Copy)]
enum Instant {
    /// The present.
    Now,
    /// The instant that the solver interpolated last.
    Interpolated,
}

/// A mode whose change ends a phase.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    /// Index of the mode.
    pub mode: usize,
    /// Value of the mode when it was read last.
    pub last: f64,
    /// The value that the mode must take; `None` for any value other than `last`.
    pub wanted: Option<f64>,
    /// Whether the change has come.
    pub is_met: bool,
}

impl Watch {
    /// Reads the mode after a step.
    fn read(&mut self, modes: &[f64]) {
        let value = modes[self.mode];
        self.is_met |= value != self.last && self.wanted.is_none_or(|wanted| wanted == value);
        self.last = value;
    }
}

impl<'a> Recorder<'a> {
    /// A recorder of the signals that the settings name.
    ///
    /// # Errors
    /// If a signal is unknown.
    pub fn new(
        program: &Program,
        solver: &Solver<'_>,
        settings: &RunSettings,
        progress: &'a mut dyn FnMut(f64),
    ) -> Result<Self, RunError> {
        let probes: Result<Vec<_>, _> = settings.record.iter().map(|name| find(program, name)).collect();
        let probes = probes?;
        let mut tracks: Vec<_> = probes.iter().map(|probe| track(probe, solver)).collect();
        let derivatives = tracks.iter().flat_map(|track| derivatives(track, solver, settings));
        let derivatives: Vec<_> = derivatives.collect();
        let count = derivatives.len();
        tracks.extend(derivatives);
        Ok(Recorder {
            trace: Trace { tracks, ..Trace::default() },
            progress,
            before: 0.0,
            probes,
            grid: Grid::new(settings.every),
            next: 0,
            next_time: 0.0,
            held: 0.0,
            running: false,
            is_fresh: false,
            lit: vec![None; program.elements.len()],
            hold_on_overload: settings.hold_on_overload,
            watch: None,
            unswitched: vec![0.0; solver.state.voltages.len()],
            unswitched_derivatives: vec![0.0; count],
        })
    }

    /// The registers of the recorded voltages.
    pub fn registers(&self) -> Vec<Register> {
        self.probes.iter().map(|probe| probe.register).collect()
    }

    /// The recorder's clock at a problem time: seconds since the sweep began.
    fn clock(&self, time: f64) -> f64 {
        time + self.held
    }

    /// Seconds recorded up to a problem time, summed over all runs.
    pub fn recorded(&self, time: f64) -> f64 {
        self.before + if self.running { self.clock(time) } else { 0.0 }
    }

    /// Begins a sweep if none has begun, and records the present voltages unless the last sample shows them.
    pub fn show(&mut self, solver: &Solver<'_>, lamps: &Lamps) {
        if !self.running {
            self.trace.sweeps.push(Sweep { first: self.trace.time.len(), ..Sweep::default() });
            (self.held, self.running, self.is_fresh) = (0.0, true, false);
            self.wait_for(1);
            // A lamp that is lit now was already lit in initial condition.
            self.lit = lamps.lit.iter().map(|lamp| lamp.map(|_| 0.0)).collect();
        }
        if !self.is_fresh {
            self.write(self.clock(solver.state.time), solver, Instant::Now);
            self.is_fresh = true;
        }
    }

    /// Records the present voltages before a change by hand, if the sweep continues after it.
    pub fn show_end(&mut self, solver: &Solver<'_>, lamps: &Lamps, is_held: bool) {
        if self.running && !is_held {
            self.show(solver, lamps);
        }
    }

    /// Records that a phase begins at a problem time. A phase that takes time begins at the last sample, any other
    /// phase before the next sample.
    pub fn mark(&mut self, time: f64, phase: Deed) {
        let takes_time = matches!(phase, Deed::Operate { .. } | Deed::Hold);
        let begin = if self.running { self.clock(time) } else { 0.0 };
        self.trace.marks.push(Mark {
            phase,
            sweep: self.trace.sweeps.len() - usize::from(self.running),
            begin,
            end: begin,
            problem_time: time,
            sample: self.trace.len() - usize::from(takes_time),
            ended: Ending::Time,
        });
    }

    /// Records that the phase ended at a problem time, and which lamps are lit.
    pub fn mark_end(&mut self, time: f64, lamps: &Lamps, ended: Ending) {
        let end = if self.running { self.clock(time) } else { 0.0 };
        if let Some(mark) = self.trace.marks.last_mut() {
            (mark.end, mark.ended) = (end, ended);
        }
        for (lit, lamp) in self.lit.iter_mut().zip(&lamps.lit) {
            *lit = lit.or(lamp.map(|_| self.held));
        }
    }

    /// Notes that a change was made by hand, so the last sample does not show the present voltages.
    pub fn invalidate_sample(&mut self) {
        self.is_fresh = false;
    }

    /// Records a machine that is held for a time in seconds. All samples show the same voltages.
    pub fn hold(&mut self, solver: &Solver<'_>, time: f64) {
        let end = self.clock(solver.state.time) + time;
        self.is_fresh = false;
        while let Some(time) = self.next_before(end * (1.0 + SAME)) {
            self.write(time, solver, Instant::Now);
            self.wait_for(self.next + 1);
            self.is_fresh = time > end * (1.0 - SAME);
        }
        self.held += time;
        self.report_progress(solver.state.time);
    }

    /// Calls `progress` with the seconds recorded up to a problem time.
    fn report_progress(&mut self, time: f64) {
        let recorded = self.recorded(time);
        (self.progress)(recorded);
    }

    /// Ends the sweep, if one has begun: adds its end, its overloads and its work to the record. `held` is whether an
    /// overload ended it.
    pub fn end(&mut self, solver: &Solver<'_>, lamps: &Lamps, work: Work, held: bool) {
        if !std::mem::take(&mut self.running) {
            return;
        }
        let program = solver.setup.program;
        let end = self.clock(solver.state.time);
        if let Some(sweep) = self.trace.sweeps.last_mut() {
            sweep.overloads = lamps.history(program);
            for overload in &mut sweep.overloads {
                let lit = program.element(&overload.element).and_then(|element| self.lit[element]);
                overload.time += lit.unwrap_or(self.held);
            }
            (sweep.end, sweep.work, sweep.held) = (end, work, held);
        }
        self.before += end;
    }

    /// A recorded signal whose scale changed since the record began; `None` if there is none.
    pub fn rescaled(&self, solver: &Solver<'_>) -> Option<&str> {
        let pairs = self.trace.tracks.iter().zip(&self.probes);
        let mut changed = pairs.filter(|(track, probe)| track.per_volt != per_volt(probe, solver));
        changed.next().map(|(track, _)| track.name.as_str())
    }

    /// The time of the next sample by the recorder's clock, if it is before `end`.
    fn next_before(&self, end: f64) -> Option<f64> {
        (self.next_time < end).then_some(self.next_time)
    }

    /// Moves on to the sample of this index.
    fn wait_for(&mut self, next: u64) {
        (self.next, self.next_time) = (next, self.grid.time(next));
    }

    /// Writes a sample at a time of the recorder's clock.
    fn write(&mut self, time: f64, solver: &Solver<'_>, instant: Instant) {
        let run = self.trace.sweeps.len() - 1;
        self.trace.time.push(time);
        let values = values(&self.probes, solver, instant);
        self.trace.tracks.iter_mut().zip(values).for_each(|(track, value)| track.record(run, time, value));
    }

    /// Writes a sample of the voltages just before the last changes of mode.
    fn write_unswitched(&mut self, time: f64) {
        let run = self.trace.sweeps.len() - 1;
        self.trace.time.push(time);
        let voltages = self.probes.iter().map(|probe| self.unswitched[probe.register.index()]);
        let values = voltages.chain(self.unswitched_derivatives.iter().copied());
        self.trace.tracks.iter_mut().zip(values).for_each(|(track, value)| track.record(run, time, value));
    }

    /// Writes a sample of the voltages of a kernel, and moves on to the next sample.
    fn write_voltages(&mut self, time: f64, voltages: impl Iterator<Item = f64>) {
        self.trace.time.push(time);
        self.trace.tracks.iter_mut().zip(voltages).for_each(|(track, volts)| track.volts.push(volts));
        self.wait_for(self.next + 1);
    }

    /// The time at which a step ends, by the recorder's clock.
    fn end_of(&self, steps: Steps, step: u64) -> f64 {
        steps.end_of(step) + self.held
    }

    /// All of some steps if a sample comes before their end, else an empty range.
    fn steps_with_samples(&self, steps: Steps) -> Range<u64> {
        let comes = steps.count > 0 && self.next_time < self.end_of(steps, steps.count - 1) * (1.0 + SAME);
        0..if comes { steps.count } else { 0 }
    }

    /// Updates extrema by the voltages that a kernel evaluated within a step. Those at the ends of steps are read when
    /// the kernel run ends.
    fn see_within(&mut self, time: f64, run: &KernelRun) {
        let sweep = self.trace.sweeps.len() - 1;
        let values = self.trace.tracks.iter_mut().zip(run.voltages());
        values.for_each(|(track, volts)| track.see(sweep, time, volts));
    }

    /// The time of the sample that is due at a problem time; `None` if no sample is due.
    pub fn due(&self, time: f64) -> Option<f64> {
        self.next_before(self.clock(time) * (1.0 + SAME))
    }

    /// Writes the sample at the end of a kernel's step, if it is due. The kernel has evaluated its voltages.
    pub fn sample_kernel(&mut self, time: f64, run: &KernelRun) {
        let due = self.due(time);
        if let Some(time) = due {
            self.write_voltages(time, run.voltages());
        }
        self.is_fresh = due.is_some();
        self.report_progress(time);
    }

    /// Updates extrema of signals within the last step.
    fn see_extrema(&mut self, solver: &mut Solver<'_>) {
        let run = self.trace.sweeps.len() - 1;
        for (track, probe) in self.trace.tracks.iter_mut().zip(&self.probes) {
            let Some(course) = track.courses.get(run) else { continue };
            let extrema = solver.extrema_beyond(probe.register, [course.least.volts, course.most.volts]);
            extrema.into_iter().flatten().for_each(|(time, volts)| track.see(run, time + self.held, volts));
        }
    }

    /// Updates extrema by the present voltages.
    fn see(&mut self, solver: &Solver<'_>) {
        let (run, time) = (self.trace.sweeps.len() - 1, self.clock(solver.state.time));
        let values = values(&self.probes, solver, Instant::Now);
        self.trace.tracks.iter_mut().zip(values).for_each(|(track, value)| track.see(run, time, value));
    }
}

impl StepObserver for Recorder<'_> {
    /// Writes the samples within the step, and updates extrema by the step and its end before modes change.
    fn step_accepted(&mut self, solver: &mut Solver<'_>) {
        while let Some(time) = self.next_before(self.clock(solver.state.time) * (1.0 - SAME)) {
            solver.interpolate(time - self.held);
            self.write(time, solver, Instant::Interpolated);
            self.wait_for(self.next + 1);
        }
        self.see_extrema(solver);
        self.see(solver);
        self.before_jump(solver);
    }

    /// Keeps the voltages before relays switch.
    fn before_jump(&mut self, solver: &Solver<'_>) {
        if self.watch.is_some() {
            self.unswitched.copy_from_slice(&solver.state.voltages);
            let derivatives = values(&self.probes, solver, Instant::Now).skip(self.probes.len());
            self.unswitched_derivatives.iter_mut().zip(derivatives).for_each(|(place, value)| *place = value);
        }
    }

    /// Writes the sample at the end of the step, after relays have switched. If that ends the phase, the voltages
    /// before are written, too.
    fn step_ended(&mut self, solver: &Solver<'_>) {
        let due = self.due(solver.state.time);
        if let Some(watch) = &mut self.watch {
            watch.read(&solver.state.modes);
        }
        if self.is_phase_over() {
            self.write_unswitched(due.unwrap_or(self.clock(solver.state.time)));
        }
        self.see(solver);
        self.is_fresh = due.is_some();
        if let Some(time) = due {
            self.write(time, solver, Instant::Now);
            self.wait_for(self.next + 1);
        }
        self.report_progress(solver.state.time);
    }

    fn next_sample(&self) -> f64 {
        self.next_time - self.held
    }

    /// Writes the samples within the kernel's last step.
    fn kernel_reached_jump(&mut self, time: f64, tables: &[Vec<[f64; 2]>], run: &mut KernelRun) {
        while let Some(sample) = self.next_before(self.clock(time) * (1.0 - SAME)) {
            run.interpolate(tables, sample - self.held);
            self.see_within(sample, run);
            self.write_voltages(sample, run.voltages());
        }
    }

    /// Writes the samples within the kernel's last step and at its end.
    fn kernel_stepped(&mut self, time: f64, tables: &[Vec<[f64; 2]>], run: &mut KernelRun) {
        self.kernel_reached_jump(time, tables, run);
        if self.due(time).is_some() {
            run.show(tables);
        }
        self.sample_kernel(time, run);
    }

    /// Writes the samples at the ends of the kernel's steps.
    fn kernel_stepped_recording(&mut self, time: f64, run: &KernelRun, steps: Steps) {
        self.is_fresh = false;
        for step in self.steps_with_samples(steps) {
            self.is_fresh = self.next_time < self.end_of(steps, step) * (1.0 + SAME);
            if self.is_fresh {
                self.write_voltages(self.next_time, run.voltages_after(step));
            }
        }
        self.report_progress(time);
    }

    fn steps_before_inner_sample(&self, steps: Steps) -> u64 {
        let (mut next, mut time) = (self.next, self.next_time);
        for step in self.steps_with_samples(steps) {
            let end = self.end_of(steps, step);
            if time < end * (1.0 - SAME) {
                return step;
            }
            if time < end * (1.0 + SAME) {
                next += 1;
                time = self.grid.time(next);
            }
        }
        steps.count
    }

    /// Updates extrema by those of the kernel run.
    fn left_fast_path(&mut self, run: &KernelRun) {
        let sweep = self.trace.sweeps.len() - 1;
        for (track, (extremes, last)) in self.trace.tracks.iter_mut().zip(run.extremes().zip(run.voltages()))
        {
            let met = extremes.into_iter().flatten().filter(|(at, _)| at.is_finite());
            met.for_each(|(at, volts)| track.see(sweep, at + self.held, volts));
            track.see(sweep, run.time() + self.held, last);
        }
    }

    fn should_stop(&self, lamps: &Lamps) -> bool {
        self.hold_on_overload && lamps.is_any_lit()
    }

    fn is_phase_over(&self) -> bool {
        self.watch.is_some_and(|watch| watch.is_met)
    }
}

/// The signal of this name.
fn find(program: &Program, name: &str) -> Result<Probe, RunError> {
    let found = program.signals.iter().find(|probe| probe.name == name).cloned();
    found.ok_or_else(|| RunError::UnknownSignal(name.to_owned()))
}

/// An empty track of a signal.
fn track(probe: &Probe, solver: &Solver<'_>) -> Track {
    Track::new(&probe.name, &probe.unit, per_volt(probe, solver))
}

/// Empty tracks of the derivatives of a signal, one for every parameter of the settings.
fn derivatives(track: &Track, solver: &Solver<'_>, settings: &RunSettings) -> Vec<Track> {
    let by = |name: &String| {
        let slot = solver.setup.program.parameters.iter().find(|slot| slot.name == *name)?;
        Some(track.differentiated(name, slot.value / slot.per_unit, &slot.unit))
    };
    settings.sensitivities.iter().filter_map(by).collect()
}

/// The values of all tracks in their order: the voltages of the signals, then the derivatives of each signal.
fn values(probes: &[Probe], solver: &Solver<'_>, instant: Instant) -> impl Iterator<Item = f64> {
    let is_now = matches!(instant, Instant::Now);
    let registers = if is_now { &solver.state.voltages } else { &solver.buffers.voltages };
    let voltages = probes.iter().map(|probe| registers[probe.register.index()]);
    let derivatives = solver.sensitivities.iter().flat_map(move |own| {
        let of = move |probe| (0..own.count()).map(move |place| own.derivative(place, probe, solver, is_now));
        probes.iter().flat_map(of)
    });
    voltages.chain(derivatives)
}

/// The value of one volt of a signal, in the unit of the signal.
fn per_volt(probe: &Probe, solver: &Solver<'_>) -> f64 {
    probe.per_volt.map_or(1.0, |index| solver.state.coefficient(index) / probe.per_unit)
}
