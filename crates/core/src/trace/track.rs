//! One recorded signal: its samples, its extremes and its scale.
//!
//! The recorder appends samples at the recording interval. In addition, it passes every step's voltages to
//! [`Track::observe`], so that the extremes also include peaks between two samples.

use crate::document::{derivative_name, derivative_unit};

/// One recorded signal.
///
/// # Examples
///
/// ```
/// use patchcord_core::trace::Track;
///
/// let mut track = Track::new("x", "mm", 2.0);
/// track.record(0, 0.0, 1.5);
/// track.record(0, 0.1, -4.0);
/// assert_eq!(track.values().collect::<Vec<_>>(), [3.0, -8.0]);
/// let least = track.extremes[0].least;
/// assert_eq!((least.time, least.volts), (0.1, -4.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Name of the signal.
    pub name: String,
    /// Text of its unit; "V" if it has no scale.
    pub unit: String,
    /// Value of one volt in that unit.
    pub per_volt: f64,
    /// Voltage of every sample, in volts.
    pub volts: Vec<f64>,
    /// The extremes in every run, including the voltages between the samples. Empty if no voltage was observed.
    pub extremes: Vec<SignalExtremes>,
    /// Set if the track is the derivative of another one. `volts` are then values in `unit`, and `per_volt` is 1.
    pub derivative: Option<Derivative>,
}

/// The signal and the parameter of a derivative.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivative {
    /// Name of the signal that is differentiated. The trace also has a track for it.
    pub signal: String,
    /// Name of the parameter.
    pub parameter: String,
    /// The parameter's value at the beginning of the run, in its declared unit.
    pub value: f64,
    /// Text of the declared unit.
    pub unit: String,
}

/// First, last, least and largest voltage of a signal in one run. Every step is included, recorded or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignalExtremes {
    /// First voltage, in volts.
    pub start: f64,
    /// Last voltage, in volts.
    pub end: f64,
    /// Least voltage, and the time at which it first occurred.
    pub least: Extremum,
    /// Largest voltage, and the time at which it first occurred.
    pub most: Extremum,
}

/// A voltage and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremum {
    /// Time in seconds of the recorder's clock.
    pub time: f64,
    /// Voltage in volts.
    pub volts: f64,
}

impl Track {
    /// A track without samples.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, per_volt: f64) -> Self {
        let (volts, extremes) = (Vec::new(), Vec::new());
        Track { name: name.into(), unit: unit.into(), per_volt, volts, extremes, derivative: None }
    }

    /// A track without samples for the derivative of this signal with respect to a parameter.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::trace::Track;
    ///
    /// let track = Track::new("x", "V", 1.0).differentiated("k", 0.5, "1");
    /// assert_eq!((track.name.as_str(), track.unit.as_str()), ("d x / d k", "V"));
    /// assert_eq!(track.derivative.map(|derivative| derivative.parameter).as_deref(), Some("k"));
    /// ```
    pub fn differentiated(&self, parameter: impl Into<String>, value: f64, unit: impl Into<String>) -> Self {
        let (parameter, unit, signal) = (parameter.into(), unit.into(), self.name.clone());
        let track = Track::new(derivative_name(&signal, &parameter), derivative_unit(&self.unit, &unit), 1.0);
        Track { derivative: Some(Derivative { signal, parameter, value, unit }), ..track }
    }

    /// The samples in physical units.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + Clone + '_ {
        self.volts.iter().map(|volts| volts * self.per_volt)
    }

    /// Appends a sample of a run. Runs count from 0 and start in order.
    pub fn record(&mut self, run: usize, time: f64, volts: f64) {
        self.volts.push(volts);
        self.observe(run, time, volts);
    }

    /// Includes a voltage in the extremes without recording a sample.
    ///
    /// # Examples
    ///
    /// ```
    /// use patchcord_core::trace::Track;
    ///
    /// let mut track = Track::new("x", "V", 1.0);
    /// track.record(0, 0.0, 1.0);
    /// track.observe(0, 0.05, 9.0);
    /// track.record(0, 0.1, 2.0);
    /// assert_eq!(track.volts, [1.0, 2.0]);
    /// assert_eq!(track.extremes[0].most.volts, 9.0);
    /// ```
    pub fn observe(&mut self, run: usize, time: f64, volts: f64) {
        let at = Extremum { time, volts };
        match self.extremes.get_mut(run) {
            Some(extremes) => extremes.extend(at),
            None => self.extremes.push(SignalExtremes { start: volts, end: volts, least: at, most: at }),
        }
    }
}

impl SignalExtremes {
    /// Includes a voltage. It becomes the last one.
    fn extend(&mut self, at: Extremum) {
        self.end = at.volts;
        // Voltages may arrive out of order in time: of several equal extremes, the earliest counts.
        let is_earlier = |than: Extremum| at.volts == than.volts && at.time < than.time;
        if at.volts < self.least.volts || is_earlier(self.least) {
            self.least = at;
        }
        if at.volts > self.most.volts || is_earlier(self.most) {
            self.most = at;
        }
    }
}
