//! One recorded signal.

use crate::document::{derivative_name, derivative_unit};

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
    /// What it went through in every run, between the samples too; nothing where it was never seen.
    pub courses: Vec<Course>,
    /// What it is the derivative of, where it is one; its volts are then values in its unit.
    pub derivative: Option<Derivative>,
}

/// Of what a track is the derivative, and by what.
#[derive(Debug, Clone, PartialEq)]
pub struct Derivative {
    /// Name of the signal, of which there is a track as well.
    pub signal: String,
    /// Name of the parameter.
    pub parameter: String,
    /// The parameter's value at the beginning of the run, in its declared unit.
    pub value: f64,
    /// Text of that unit.
    pub unit: String,
}

/// What a signal went through in a run: watched at every step, recorded there or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Course {
    /// First voltage.
    pub start: f64,
    /// Last voltage.
    pub end: f64,
    /// Least voltage, and when it was met first.
    pub least: Moment,
    /// Largest voltage, and when it was met first.
    pub most: Moment,
}

/// A voltage at an instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// In seconds.
    pub time: f64,
    /// In volts.
    pub volts: f64,
}

impl Track {
    /// A track on which nothing is recorded yet.
    pub fn new(name: impl Into<String>, unit: impl Into<String>, per_volt: f64) -> Self {
        let (volts, courses) = (Vec::new(), Vec::new());
        Track { name: name.into(), unit: unit.into(), per_volt, volts, courses, derivative: None }
    }

    /// The track of a derivative of this one, on which nothing is recorded yet.
    pub fn differentiated(&self, parameter: impl Into<String>, value: f64, unit: impl Into<String>) -> Self {
        let (parameter, unit, signal) = (parameter.into(), unit.into(), self.name.clone());
        let track = Track::new(derivative_name(&signal, &parameter), derivative_unit(&self.unit, &unit), 1.0);
        Track { derivative: Some(Derivative { signal, parameter, value, unit }), ..track }
    }

    /// The samples in physical units.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + Clone + '_ {
        self.volts.iter().map(|volts| volts * self.per_volt)
    }

    /// Writes a sample of a run down; runs are counted from 0 and begun in their order.
    pub fn record(&mut self, run: usize, time: f64, volts: f64) {
        self.volts.push(volts);
        self.see(run, time, volts);
    }

    /// Takes note of a voltage without recording it.
    pub fn see(&mut self, run: usize, time: f64, volts: f64) {
        let moment = Moment { time, volts };
        match self.courses.get_mut(run) {
            Some(course) => course.goes_on(moment),
            None => self.courses.push(Course { start: volts, end: volts, least: moment, most: moment }),
        }
    }
}

impl Course {
    fn goes_on(&mut self, moment: Moment) {
        self.end = moment.volts;
        // Moments may be told later than others that came after them: the first of several that are alike counts.
        let is_earlier = |than: Moment| moment.volts == than.volts && moment.time < than.time;
        if moment.volts < self.least.volts || is_earlier(self.least) {
            self.least = moment;
        }
        if moment.volts > self.most.volts || is_earlier(self.most) {
            self.most = moment;
        }
    }
}
