//! Storage oscilloscopes: controls, traces against time, X-Y curves, trigger.
//!
//! A [`Scope`] gets every step of the engine as a point. Against time, a screen has [`COLUMNS`] columns, each with the
//! minimum and the maximum of the straight lines between points. A memory of the run has the same in finer buckets, for
//! pictures with another time base. An X-Y curve is thinned to the ends of chords. The curve of the present run is kept
//! in both displays.
//!
//! A scope has only the present trace. It is a new *generation*, and the last frame of a generation has the complete
//! trace. So the client keeps the traces that ended: the last one to the right of the beam, and all of them if the
//! control `store` is set. It removes them when the user erases the screen or changes the controls.

mod check;
mod curve;
mod envelope;
mod traces;

use std::{array, mem};

use serde::{Deserialize, Serialize};

use curve::Curve;
use envelope::Envelope;
use traces::{Timing, Traces};

/// Number of scopes of a panel.
pub const SCOPES: usize = 2;
/// Number of channels of a scope.
pub const CHANNELS: usize = 2;
/// Divisions of the screen from left to right.
pub const DIVISIONS_ACROSS: f64 = 10.0;
/// Columns of the screen from left to right.
pub const COLUMNS: usize = 1000;

/// Number of buckets of the memory of a run. They double their length when the run is longer.
const BUCKETS: usize = 1 << 15;
/// Number of points from left to right that make a smooth picture.
const POINTS_ACROSS: f64 = 2000.0;
/// Largest distance in volts between an X-Y curve and the points that it is made from. That of a very long curve is
/// five times as large.
const TOLERANCE: f64 = 0.02;
/// The same in divisions, for a magnified curve.
const TOLERANCE_IN_DIVISIONS: f64 = 0.001;

/// All controls of a scope.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ScopeControls {
    /// Whether it shows channels against time or channel 2 against channel 1.
    pub display: Display,
    /// The channels.
    pub channels: [Channel; CHANNELS],
    /// Seconds per division. 0 selects a tenth of the sweep.
    pub seconds_per_division: f64,
    /// When a trace against time begins.
    pub trigger: Trigger,
    /// Whether new traces are added to those that are stored, instead of replacing them.
    pub store: bool,
    /// Seconds after which a stored trace has faded, on the screen; 0 if it does not fade.
    pub persistence: f64,
}

/// What a scope shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Display {
    /// Channels against time.
    Time,
    /// Channel 2 upwards against channel 1 to the right.
    Plane,
}

/// A channel of a scope.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Name of the output at its probe; absent if it is free.
    pub output: Option<String>,
    /// Volts of the machine per division.
    pub volts_per_division: f64,
    /// Volts at the centre of the screen.
    pub centre: f64,
    /// Whether the trace is inverted.
    pub inverted: bool,
}

/// When a trace begins.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Trigger {
    /// How traces follow each other.
    pub mode: TriggerMode,
    /// The channel that triggers, 0 or 1.
    pub channel: usize,
    /// The level in volts.
    pub level: f64,
    /// Whether the trace begins when the voltage rises through the level; otherwise when it falls.
    pub rising: bool,
}

/// How traces follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TriggerMode {
    /// A trace begins with each run of the machine, and with each new screen of a longer run.
    Run,
    /// A trace begins whenever the channel passes the level.
    Level,
    /// One trace begins when the channel passes the level. Then the scope waits for `erase`.
    SingleShot,
}

/// The voltages of an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Sample {
    /// Time in seconds.
    time: f64,
    /// The voltages of the channels; NaN if a channel is free.
    volts: [f64; CHANNELS],
}

impl Sample {
    /// The voltages on the straight line to another sample, at this share of it.
    fn towards(&self, other: &Sample, share: f64) -> [f64; CHANNELS] {
        array::from_fn(|channel| self.volts[channel] + (other.volts[channel] - self.volts[channel]) * share)
    }
}

/// A storage oscilloscope.
#[derive(Debug, Clone)]
pub struct Scope {
    /// The controls.
    controls: ScopeControls,
    /// Length of a sweep in problem seconds.
    sweep: f64,
    /// Whether time has not moved since the initial condition. The pictures of the run before are shown until it does.
    is_at_start: bool,
    /// The last point; absent before the first one of a run.
    last: Option<Sample>,
    /// The time up to which the memory has the run; absent before the first run.
    end: Option<f64>,
    /// The time to which the machine was moved back, until the run continues from there.
    moved_to: Option<f64>,
    /// The memory of the run.
    memory: Envelope,
    /// The traces against time.
    traces: Traces,
    /// The X-Y curve.
    curve: Curve,
}

impl Default for Scope {
    fn default() -> Self {
        Self::new()
    }
}

impl Scope {
    /// A scope with free channels, against time, with 25 volts per division, which shows ±100 V, triggered by the run.
    pub fn new() -> Scope {
        let channel = Channel { output: None, volts_per_division: 25.0, centre: 0.0, inverted: false };
        let trigger = Trigger { mode: TriggerMode::Run, channel: 0, level: 0.0, rising: true };
        let sweep = 1.0;
        let traces = Traces::new(Timing { trigger: &trigger, screen: sweep });
        let controls = ScopeControls {
            display: Display::Time,
            channels: [channel.clone(), channel],
            seconds_per_division: 0.0,
            trigger,
            store: false,
            persistence: 0.0,
        };
        Scope {
            controls,
            sweep,
            is_at_start: true,
            last: None,
            end: None,
            moved_to: None,
            memory: Envelope::new(BUCKETS, 0.0, sweep / BUCKETS as f64),
            traces,
            curve: Curve::new(TOLERANCE),
        }
    }

    /// The controls.
    pub fn controls(&self) -> &ScopeControls {
        &self.controls
    }

    /// Sets the controls. The picture shows what is known of the present run. A channel with another probe begins
    /// empty.
    ///
    /// # Errors
    ///
    /// A message for the user if a control has a value that is not permitted. Then no control changes.
    pub fn set_controls(&mut self, controls: ScopeControls) -> Result<(), String> {
        check::check(&controls)?;
        let screen_before = self.screen();
        let before = mem::replace(&mut self.controls, controls);
        for (channel, old) in before.channels.iter().enumerate() {
            if old.output != self.controls.channels[channel].output {
                self.clear_channel(channel);
            }
        }
        self.curve.set_tolerance(self.tolerance());
        if before.display != self.controls.display {
            let generation = self.traces.generation().max(self.curve.generation()).wrapping_add(1);
            self.traces.set_generation(generation);
            self.curve.set_generation(generation);
        }
        let trigger = &self.controls.trigger;
        let is_run = trigger.mode == TriggerMode::Run;
        // With the run as trigger, the level has no effect.
        let has_other_trigger =
            *trigger != before.trigger && (!is_run || before.trigger.mode != TriggerMode::Run);
        let timing = Timing { trigger, screen: self.screen() };
        if timing.screen != screen_before || (has_other_trigger && is_run) {
            self.traces.redraw(&self.memory, self.end, timing);
            self.show_screen();
        }
        if has_other_trigger && !is_run {
            self.traces.wait();
        }
        Ok(())
    }

    /// Removes what is known of a channel, because its probe was moved.
    fn clear_channel(&mut self, channel: usize) {
        self.memory.clear_channel(channel);
        self.traces.clear_channel(channel);
        self.curve.erase();
        if let Some(last) = &mut self.last {
            last.volts[channel] = f64::NAN;
        }
    }

    /// Erases the traces. A single trace can begin again.
    pub fn erase(&mut self) {
        self.memory.clear();
        self.curve.erase();
        let timing = Timing { trigger: &self.controls.trigger, screen: self.screen() };
        self.traces.erase(timing);
    }

    /// The machine is at its initial condition, and time begins at 0. `sweep` is the length of a sweep in problem
    /// seconds; if it is too short for buckets, or infinite, that of the run before stays. The traces of the run before
    /// remain until time moves.
    pub fn begin_run(&mut self, sweep: f64) {
        // Buckets of a length of 0 would be doubled without end.
        if sweep > 0.0 && (sweep / BUCKETS as f64).is_normal() {
            self.sweep = sweep;
        }
        self.is_at_start = true;
        (self.last, self.moved_to) = (None, None);
    }

    /// Shows the screen that has this time of the present run, to which the machine was moved. What the run did later stays
    /// on the screen and in the memory, until a [`point`](Self::point) continues the run from here.
    pub fn show(&mut self, time: f64) {
        self.moved_to = Some(time);
        self.show_screen();
    }

    /// Shows the screen with the time to which the machine was moved, if it was.
    fn show_screen(&mut self) {
        let timing = Timing { trigger: &self.controls.trigger, screen: self.screen() };
        if let (Some(time), Some(end), false) = (self.moved_to, self.end, self.is_at_start) {
            self.traces.show(&self.memory, time, end, timing);
        }
    }

    /// Adds a point of the present run. Voltages of free channels are NaN. A point with the time of the one before is a
    /// jump. At the initial condition, only the last point counts. An earlier time moves the run back to it.
    pub fn point(&mut self, time: f64, volts: [f64; CHANNELS]) {
        if !time.is_finite() {
            return;
        }
        let to = Sample { time, volts };
        self.moved_to = None;
        match self.last.replace(to) {
            Some(from) if time > from.time => self.add_line(&from, &to),
            Some(_) if self.is_at_start => {}
            Some(from) if time < from.time => self.move_back(&to),
            Some(from) => self.add_line(&from, &to),
            None => {}
        }
    }

    /// Adds the straight line between two points of the present run.
    fn add_line(&mut self, from: &Sample, to: &Sample) {
        let timing = Timing { trigger: &self.controls.trigger, screen: self.screen() };
        if mem::take(&mut self.is_at_start) {
            self.memory.reset(0.0, self.sweep / BUCKETS as f64);
            self.traces.begin_run(timing);
            self.curve.begin_run();
            self.curve.add(from);
        }
        self.memory.grow_to(to.time);
        self.memory.add_line(from, to);
        self.end = Some(to.time);
        self.traces.add_line(from, to, timing);
        self.curve.add(to);
    }

    /// Continues the run from an earlier point.
    fn move_back(&mut self, to: &Sample) {
        let timing = Timing { trigger: &self.controls.trigger, screen: self.screen() };
        self.memory.cut(to.time);
        self.end = Some(to.time);
        self.traces.cut(&self.memory, to.time, timing);
        self.curve.cut(to.time);
        self.curve.add(to);
    }

    /// Length of a screen in seconds.
    fn screen(&self) -> f64 {
        match self.controls.seconds_per_division {
            0.0 => self.sweep,
            seconds => seconds * DIVISIONS_ACROSS,
        }
    }

    /// Largest distance in volts between an X-Y curve and the points that it is made from.
    fn tolerance(&self) -> f64 {
        let scale = self.controls.channels.iter().map(|channel| channel.volts_per_division);
        scale.map(|volts| volts * TOLERANCE_IN_DIVISIONS).fold(TOLERANCE, f64::min)
    }

    /// The bits of the channels in use: 1 for channel 0, 2 for channel 1.
    fn channels_in_use(&self) -> u32 {
        let channels = self.controls.channels.iter().enumerate();
        channels.map(|(index, channel)| u32::from(channel.output.is_some()) << index).sum()
    }

    /// The largest time between points, in seconds, with which the picture is smooth. In the X-Y display it depends on
    /// the sweep only; see [`needs_curve`](Self::needs_curve).
    pub fn resolution(&self) -> f64 {
        let width = if self.needs_curve() { self.sweep } else { self.screen() };
        width / POINTS_ACROSS
    }

    /// Whether the scope needs points within a step when a voltage moves by more than 0.5 V: in the X-Y display.
    pub fn needs_curve(&self) -> bool {
        self.controls.display == Display::Plane
    }

    /// Appends its part of a frame.
    pub fn encode(&mut self, out: &mut Vec<u8>) {
        let channels = self.channels_in_use();
        match self.controls.display {
            Display::Time => {
                out.extend_from_slice(&0_u32.to_le_bytes());
                self.traces.encode(channels, out);
            }
            Display::Plane => {
                out.extend_from_slice(&1_u32.to_le_bytes());
                self.curve.encode(channels.count_ones() as usize == CHANNELS, out);
            }
        }
    }
}

#[cfg(test)]
mod tests;
