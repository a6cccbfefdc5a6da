//! The trace: what was recorded, in volts, with scales to physical units and the overload history.

mod csv;

pub use self::csv::CsvError;

use crate::solve::{Overload, Work};

/// A recorded run, or several of them one after the other (repetitive operation).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// Problem time of every sample, in seconds; begins anew at 0 with every sweep.
    pub time: Vec<f64>,
    /// The recorded signals.
    pub tracks: Vec<Track>,
    /// The runs that make up the trace.
    pub sweeps: Vec<Sweep>,
}

/// One recorded signal.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Name of the signal.
    pub name: String,
    /// Text of its unit; "V" where it has no scale.
    pub unit: String,
    /// Value of one volt in that unit.
    pub per_volt: f64,
    /// Voltage of every sample.
    pub volts: Vec<f64>,
}

/// One run from initial condition.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sweep {
    /// Index of its first sample.
    pub first: usize,
    /// When it ended, in problem seconds.
    pub end: f64,
    /// What it took.
    pub work: Work,
    /// Whether an overload put the machine into hold.
    pub held: bool,
    /// The lamps that lit, in their order.
    pub overloads: Vec<Overload>,
}

impl Track {
    /// The samples in physical units.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + Clone + '_ {
        self.volts.iter().map(|volts| volts * self.per_volt)
    }
}

impl Trace {
    /// The track of a signal.
    pub fn track(&self, name: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.name == name)
    }

    /// The samples of a signal in physical units.
    pub fn values(&self, name: &str) -> Option<Vec<f64>> {
        self.track(name).map(|track| track.values().collect())
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
