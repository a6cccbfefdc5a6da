//! The recorder: writes down voltages on a time grid of its own while the machine runs and holds.

use std::ops::Range;

use super::error::RunError;
use super::glide::Flight;
use super::machine::{Machine, Witness};
use super::run::RunSettings;
use crate::grid::{Grid, SAME};
use crate::ir::{Probe, Program, Register};
use crate::kernel::Steps;
use crate::trace::{Deed, Ending, Mark, Sweep, Trace, Track};

/// Writes down voltages on a time grid of its own. Its clock runs on while the machine holds.
pub(super) struct Recorder<'a> {
    pub trace: Trace,
    progress: &'a mut dyn FnMut(f64),
    /// Time recorded before this sweep.
    before: f64,
    probes: Vec<Probe>,
    grid: Grid,
    next: u64,
    /// When that is.
    next_time: f64,
    /// Its clock less problem time: how long this sweep was held.
    held: f64,
    /// Whether a sweep has begun since the last initial condition.
    running: bool,
    /// Whether the last sample shows the machine as it is now.
    is_fresh: bool,
    /// How long the sweep had been held when a lamp lit, by element.
    lit: Vec<Option<f64>>,
    hold_on_overload: bool,
    /// The switching that ends the present phase.
    pub watch: Option<Watch>,
    /// Every voltage before the relays of the last instant switched, while there is a watch.
    unswitched: Vec<f64>,
    /// The derivatives of that instant, as they are recorded.
    unswitched_derivatives: Vec<f64>,
}

/// The instant that is written down.
#[derive(Clone, Copy)]
enum Instant {
    /// As the machine stands.
    Now,
    /// As it stood where it was last looked back at.
    Then,
}

/// A mode that is waited for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Watch {
    pub mode: usize,
    /// Its value when it was last looked at.
    pub last: f64,
    /// The value that it must go to; any other than `last` without one.
    pub wanted: Option<f64>,
    pub is_met: bool,
}

impl Watch {
    fn look(&mut self, modes: &[f64]) {
        let value = modes[self.mode];
        self.is_met |= value != self.last && self.wanted.is_none_or(|wanted| wanted == value);
        self.last = value;
    }
}

impl<'a> Recorder<'a> {
    pub fn new(
        program: &Program,
        machine: &Machine<'_>,
        settings: &RunSettings,
        progress: &'a mut dyn FnMut(f64),
    ) -> Result<Self, RunError> {
        let probes: Result<Vec<_>, _> = settings.record.iter().map(|name| find(program, name)).collect();
        let probes = probes?;
        let mut tracks: Vec<_> = probes.iter().map(|probe| track(probe, machine)).collect();
        let derivatives = tracks.iter().flat_map(|track| derivatives(track, machine, settings));
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
            unswitched: vec![0.0; machine.registers.len()],
            unswitched_derivatives: vec![0.0; count],
        })
    }

    /// Where what is recorded stands.
    pub fn registers(&self) -> Vec<Register> {
        self.probes.iter().map(|probe| probe.register).collect()
    }

    /// Its clock: seconds since the sweep began.
    fn clock(&self, machine: &Machine<'_>) -> f64 {
        machine.time() + self.held
    }

    /// Seconds recorded so far, all runs added up.
    pub fn recorded(&self, machine: &Machine<'_>) -> f64 {
        self.before + if self.running { self.clock(machine) } else { 0.0 }
    }

    /// Begins a sweep if none has begun, and writes down how the machine stands where nothing shows it.
    pub fn show(&mut self, machine: &Machine<'_>) {
        if !self.running {
            self.trace.sweeps.push(Sweep { first: self.trace.time.len(), ..Sweep::default() });
            (self.held, self.running, self.is_fresh) = (0.0, true, false);
            self.wait_for(1);
            // What is lit already lit in initial condition.
            self.lit = machine.lamps.iter().map(|lamp| lamp.map(|_| 0.0)).collect();
        }
        if !self.is_fresh {
            self.write(self.clock(machine), machine, Instant::Now);
            self.is_fresh = true;
        }
    }

    /// Writes down how the machine stands before a hand changes something, where the sweep goes on after it.
    pub fn show_end(&mut self, machine: &Machine<'_>, is_held: bool) {
        if self.running && !is_held {
            self.show(machine);
        }
    }

    /// Takes note that a phase begins. One that takes time begins at the last sample, any other before the next.
    pub fn mark(&mut self, machine: &Machine<'_>, phase: Deed) {
        let takes_time = matches!(phase, Deed::Operate { .. } | Deed::Hold);
        let begin = if self.running { self.clock(machine) } else { 0.0 };
        self.trace.marks.push(Mark {
            phase,
            sweep: self.trace.sweeps.len() - usize::from(self.running),
            begin,
            end: begin,
            problem_time: machine.time(),
            sample: self.trace.len() - usize::from(takes_time),
            ended: Ending::Time,
        });
    }

    /// Takes note that the phase ended.
    pub fn mark_end(&mut self, machine: &Machine<'_>, ended: Ending) {
        let end = if self.running { self.clock(machine) } else { 0.0 };
        if let Some(mark) = self.trace.marks.last_mut() {
            (mark.end, mark.ended) = (end, ended);
        }
        for (lit, lamp) in self.lit.iter_mut().zip(&machine.lamps) {
            *lit = lit.or(lamp.map(|_| self.held));
        }
    }

    /// Takes note that a hand has changed something: the last sample does not show it.
    pub fn changed(&mut self) {
        self.is_fresh = false;
    }

    /// Records a machine that stands still.
    pub fn hold(&mut self, machine: &Machine<'_>, time: f64) {
        let end = self.clock(machine) + time;
        self.is_fresh = false;
        while let Some(time) = self.next_before(end * (1.0 + SAME)) {
            self.write(time, machine, Instant::Now);
            self.wait_for(self.next + 1);
            self.is_fresh = time > end * (1.0 - SAME);
        }
        self.held += time;
        self.tell_progress(machine);
    }

    fn tell_progress(&mut self, machine: &Machine<'_>) {
        let recorded = self.recorded(machine);
        (self.progress)(recorded);
    }

    /// Ends the sweep, if one has begun.
    pub fn end(&mut self, machine: &Machine<'_>, held: bool) {
        if !std::mem::take(&mut self.running) {
            return;
        }
        let end = self.clock(machine);
        if let Some(sweep) = self.trace.sweeps.last_mut() {
            sweep.overloads = machine.overloads();
            for overload in &mut sweep.overloads {
                let lit = machine.program.element(&overload.element).and_then(|element| self.lit[element]);
                overload.time += lit.unwrap_or(self.held);
            }
            (sweep.end, sweep.work, sweep.held) = (end, machine.work(), held);
        }
        self.before += end;
    }

    /// A recorded signal whose scale is not what it was when the record began.
    pub fn rescaled(&self, machine: &Machine<'_>) -> Option<&str> {
        let pairs = self.trace.tracks.iter().zip(&self.probes);
        let mut changed = pairs.filter(|(track, probe)| track.per_volt != per_volt(probe, machine));
        changed.next().map(|(track, _)| track.name.as_str())
    }

    /// The next instant of the grid, if it comes before a time.
    fn next_before(&self, end: f64) -> Option<f64> {
        (self.next_time < end).then_some(self.next_time)
    }

    fn wait_for(&mut self, next: u64) {
        (self.next, self.next_time) = (next, self.grid.time(next));
    }

    fn write(&mut self, time: f64, machine: &Machine<'_>, instant: Instant) {
        let run = self.trace.sweeps.len() - 1;
        self.trace.time.push(time);
        let values = values(&self.probes, machine, instant);
        self.trace.tracks.iter_mut().zip(values).for_each(|(track, value)| track.record(run, time, value));
    }

    /// Writes down the last instant as it was before relays switched.
    fn write_unswitched(&mut self, time: f64) {
        let run = self.trace.sweeps.len() - 1;
        self.trace.time.push(time);
        let voltages = self.probes.iter().map(|probe| self.unswitched[probe.register.index()]);
        let values = voltages.chain(self.unswitched_derivatives.iter().copied());
        self.trace.tracks.iter_mut().zip(values).for_each(|(track, value)| track.record(run, time, value));
    }

    /// Writes down what was seen in a flight.
    fn write_seen(&mut self, time: f64, seen: impl Iterator<Item = f64>) {
        self.trace.time.push(time);
        self.trace.tracks.iter_mut().zip(seen).for_each(|(track, volts)| track.volts.push(volts));
        self.wait_for(self.next + 1);
    }

    /// When a step ends, by its clock.
    fn end_of(&self, steps: Steps, step: u64) -> f64 {
        steps.end_of(step) + self.held
    }

    /// All of some steps, where the next instant of its grid comes before their end; else none.
    fn steps_with_samples(&self, steps: Steps) -> Range<u64> {
        let comes = steps.count > 0 && self.next_time < self.end_of(steps, steps.count - 1) * (1.0 + SAME);
        0..if comes { steps.count } else { 0 }
    }

    /// Takes note of what a flight has worked out within a step; how far its steps went is seen when it ends.
    fn see_within(&mut self, time: f64, flight: &Flight) {
        let run = self.trace.sweeps.len() - 1;
        let values = self.trace.tracks.iter_mut().zip(flight.seen());
        values.for_each(|(track, volts)| track.see(run, time, volts));
    }

    /// The instant of the grid that the machine has come to, if it has.
    pub fn due(&self, machine: &Machine<'_>) -> Option<f64> {
        self.next_before(self.clock(machine) * (1.0 + SAME))
    }

    /// Writes down the instant at the end of a quiet step, if it is due, as the flight has worked it out.
    pub fn glided_to(&mut self, machine: &Machine<'_>, flight: &Flight) {
        let due = self.due(machine);
        if let Some(time) = due {
            self.write_seen(time, flight.seen());
        }
        self.is_fresh = due.is_some();
        self.tell_progress(machine);
    }

    /// Takes note of where signals went further within the last stretch than ever before.
    fn see_turns(&mut self, machine: &mut Machine<'_>) {
        let run = self.trace.sweeps.len() - 1;
        for (track, probe) in self.trace.tracks.iter_mut().zip(&self.probes) {
            let Some(course) = track.courses.get(run) else { continue };
            let turns = machine.turns_beyond(probe.register, [course.least.volts, course.most.volts]);
            turns.into_iter().flatten().for_each(|(time, volts)| track.see(run, time + self.held, volts));
        }
    }

    /// Takes note of the voltages of now.
    fn see(&mut self, machine: &Machine<'_>) {
        let (run, time) = (self.trace.sweeps.len() - 1, self.clock(machine));
        let values = values(&self.probes, machine, Instant::Now);
        self.trace.tracks.iter_mut().zip(values).for_each(|(track, value)| track.see(run, time, value));
    }
}

impl Witness for Recorder<'_> {
    /// Writes down the instants of the grid inside a stretch, and sees its end as it is before relays switch.
    fn stretch(&mut self, machine: &mut Machine<'_>) {
        while let Some(time) = self.next_before(self.clock(machine) * (1.0 - SAME)) {
            machine.look_back(time - self.held);
            self.write(time, machine, Instant::Then);
            self.wait_for(self.next + 1);
        }
        self.see_turns(machine);
        self.see(machine);
        self.before_jump(machine);
    }

    /// Keeps what there is before relays switch.
    fn before_jump(&mut self, machine: &Machine<'_>) {
        if self.watch.is_some() {
            self.unswitched.copy_from_slice(&machine.registers);
            let derivatives = values(&self.probes, machine, Instant::Now).skip(self.probes.len());
            self.unswitched_derivatives.iter_mut().zip(derivatives).for_each(|(place, value)| *place = value);
        }
    }

    /// Writes down the instant at its end, as it is after relays have switched; where that ends the phase, as it was
    /// before too.
    fn arrival(&mut self, machine: &Machine<'_>) {
        let due = self.due(machine);
        if let Some(watch) = &mut self.watch {
            watch.look(&machine.modes);
        }
        if self.has_met() {
            self.write_unswitched(due.unwrap_or(self.clock(machine)));
        }
        self.see(machine);
        self.is_fresh = due.is_some();
        if let Some(time) = due {
            self.write(time, machine, Instant::Now);
            self.wait_for(self.next + 1);
        }
        self.tell_progress(machine);
    }

    fn next_sample(&self) -> f64 {
        self.next_time - self.held
    }

    /// Writes down the instants of the grid within the last quiet stretch.
    fn glided_up_to(&mut self, machine: &Machine<'_>, flight: &mut Flight) {
        while let Some(time) = self.next_before(self.clock(machine) * (1.0 - SAME)) {
            flight.look_back(&machine.program.tables, time - self.held);
            self.see_within(time, flight);
            self.write_seen(time, flight.seen());
        }
    }

    /// The same, and at its end.
    fn glided(&mut self, machine: &Machine<'_>, flight: &mut Flight) {
        self.glided_up_to(machine, flight);
        let tables = &machine.program.tables;
        if self.due(machine).is_some() {
            flight.show(tables);
        }
        self.glided_to(machine, flight);
    }

    /// Writes down the instants of the grid at the ends of steps.
    fn glided_along(&mut self, machine: &Machine<'_>, flight: &Flight, steps: Steps) {
        self.is_fresh = false;
        for step in self.steps_with_samples(steps) {
            self.is_fresh = self.next_time < self.end_of(steps, step) * (1.0 + SAME);
            if self.is_fresh {
                self.write_seen(self.next_time, flight.seen_after(step));
            }
        }
        self.tell_progress(machine);
    }

    fn steps_before_stray(&self, steps: Steps) -> u64 {
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

    /// Sees what the quiet stretches went through.
    fn landed(&mut self, flight: &Flight) {
        let run = self.trace.sweeps.len() - 1;
        for (track, (extremes, last)) in
            self.trace.tracks.iter_mut().zip(flight.extremes().zip(flight.seen()))
        {
            let met = extremes.into_iter().flatten().filter(|(at, _)| at.is_finite());
            met.for_each(|(at, volts)| track.see(run, at + self.held, volts));
            track.see(run, flight.time() + self.held, last);
        }
    }

    fn has_seen_enough(&self, machine: &Machine<'_>) -> bool {
        self.hold_on_overload && machine.is_overloaded()
    }

    fn has_met(&self) -> bool {
        self.watch.is_some_and(|watch| watch.is_met)
    }
}

fn find(program: &Program, name: &str) -> Result<Probe, RunError> {
    let found = program.signals.iter().find(|probe| probe.name == name).cloned();
    found.ok_or_else(|| RunError::UnknownSignal(name.to_owned()))
}

fn track(probe: &Probe, machine: &Machine<'_>) -> Track {
    Track::new(&probe.name, &probe.unit, per_volt(probe, machine))
}

/// The tracks of the derivatives of a signal, by every parameter asked for.
fn derivatives(track: &Track, machine: &Machine<'_>, settings: &RunSettings) -> Vec<Track> {
    let by = |name: &String| {
        let slot = machine.program.parameters.iter().find(|slot| slot.name == *name)?;
        Some(track.differentiated(name, slot.value / slot.per_unit, &slot.unit))
    };
    settings.sensitivities.iter().filter_map(by).collect()
}

/// What all tracks show: the voltages of the signals, then the derivatives of each.
fn values(probes: &[Probe], machine: &Machine<'_>, instant: Instant) -> impl Iterator<Item = f64> {
    let is_now = matches!(instant, Instant::Now);
    let registers = if is_now { &machine.registers } else { &machine.trial_registers };
    let voltages = probes.iter().map(|probe| registers[probe.register.index()]);
    let derivatives = machine.sensitivities.iter().flat_map(move |own| {
        let of =
            move |probe| (0..own.count()).map(move |place| own.derivative(place, probe, machine, is_now));
        probes.iter().flat_map(of)
    });
    voltages.chain(derivatives)
}

/// A signal's value of one volt, in its unit.
fn per_volt(probe: &Probe, machine: &Machine<'_>) -> f64 {
    probe.per_volt.map_or(1.0, |index| machine.coefficient(index) / probe.per_unit)
}
