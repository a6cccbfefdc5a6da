//! The trace: what was recorded, in volts, with scales to physical units and the overload history.

mod csv;
mod mark;
mod track;

pub use self::csv::CsvError;
pub use self::csv::number;
pub use self::mark::{Deed, Ending, Mark, NewValue};
pub use self::track::{Course, Derivative, Moment, Track};

/// A recorded run, or several of them one after the other (repetitive operation).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// Time of every sample by the recorder's clock, in seconds: problem time and what was held until then. Begins
    /// anew at 0 with every sweep. All times of a trace are by this clock.
    pub time: Vec<f64>,
    /// The recorded signals.
    pub tracks: Vec<Track>,
    /// The runs that make up the trace.
    pub sweeps: Vec<Sweep>,
    /// The phases of the runs, in their order.
    pub marks: Vec<Mark>,
}

/// One run from initial condition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sweep {
    /// Index of its first sample.
    pub first: usize,
    /// When it ended, in seconds.
    pub end: f64,
    /// What it took.
    pub work: Work,
    /// Whether an overload put the machine into hold.
    pub held: bool,
    /// The lamps that lit, in their order.
    pub overloads: Vec<Overload>,
}

/// What a run took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Steps, those shortened to meet a change of mode or a kink counted too.
    pub steps: u64,
    /// Changes of mode of elements and drives: what the command line calls switchings.
    pub changes: u64,
    /// Kinks stepped to: where the curve of a diode, a limit or a table turns a corner.
    pub crossings: u64,
    /// Steps that were not right to the tolerance, and were tried again shorter.
    pub rejections: u64,
    /// How often the circuit was worked out; what recording looks at is not counted.
    pub evaluations: u64,
}

/// An overload lamp that lit. Lamps stay lit until the next initial condition.
#[derive(Debug, Clone, PartialEq)]
pub struct Overload {
    /// The amplifier.
    pub element: String,
    /// When it was first asked for more than 100 V, in seconds.
    pub time: f64,
    /// The largest voltage, without sign, that it was asked for.
    pub peak: f64,
    /// The overload that caused it: the earliest among the amplifiers from which a chain of cords leads here.
    pub caused_by: Option<String>,
}

impl Trace {
    /// The track of a signal.
    pub fn track(&self, name: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.name == name)
    }

    /// The track of the derivative of a signal by a parameter.
    pub fn derivative(&self, signal: &str, parameter: &str) -> Option<&Track> {
        let is_it = |of: &Derivative| of.signal == signal && of.parameter == parameter;
        self.tracks.iter().find(|track| track.derivative.as_ref().is_some_and(is_it))
    }

    /// The samples of a signal in physical units.
    pub fn values(&self, name: &str) -> Option<Vec<f64>> {
        self.track(name).map(|track| track.values().collect())
    }

    /// The same run with nothing recorded of it.
    pub fn without_tracks(&self) -> Trace {
        let (time, sweeps, marks) = (self.time.clone(), self.sweeps.clone(), self.marks.clone());
        Trace { time, tracks: Vec::new(), sweeps, marks }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time.len()
    }

    /// Whether nothing was recorded.
    pub fn is_empty(&self) -> bool {
        self.time.is_empty()
    }

    /// Every overload of every sweep.
    pub fn overloads(&self) -> impl Iterator<Item = &Overload> {
        self.sweeps.iter().flat_map(|sweep| &sweep.overloads)
    }

    /// The sweep that a sample belongs to, counted from 0.
    pub fn sweep_of(&self, sample: usize) -> usize {
        self.sweeps.partition_point(|sweep| sweep.first <= sample).saturating_sub(1)
    }
}
