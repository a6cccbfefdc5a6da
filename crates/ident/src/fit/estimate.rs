//! Estimates: points from which fits begin, and what they come to.

use crate::fit::model::{Choice, Knob, Model};
use crate::statistics::descriptive::mean;

/// A point from which a fit begins, or at which it ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Values of the knobs, in declared units.
    pub knobs: Vec<f64>,
    /// Of every record, the initial voltages.
    pub initial: Vec<Vec<f64>>,
    /// By how much every output stands off, in its unit.
    pub offsets: Vec<f64>,
}

/// What a fit came to.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Where.
    pub point: Point,
    /// The sum of the squares of the residuals.
    pub chi2: f64,
    /// Data less model over sigma: by record, output and sample; NaN where there is no datum.
    pub residuals: Vec<Vec<Vec<f64>>>,
    /// How many data there are.
    pub count: usize,
    /// How many numbers were fitted that the data tell of.
    pub free: usize,
}

/// Where a fit has come to.
#[derive(Debug, Clone)]
pub struct Reached {
    /// Where.
    pub point: Point,
    /// The sum of the squares of the residuals.
    pub chi2: f64,
    /// Whether going on would come to nothing better, or not to what is wanted.
    pub has_ended: bool,
}

impl Fitted {
    /// The sum of squares of the residuals over their degrees of freedom: 1 on average where the model is right.
    pub fn reduced(&self) -> f64 {
        self.reduced_of(self.chi2)
    }

    /// What no noise explains of that: nothing, or next to it, where the model is right.
    pub fn unexplained(&self) -> f64 {
        self.unexplained_of(self.chi2)
    }

    /// The same of another sum of squares of these data.
    pub(crate) fn unexplained_of(&self, chi2: f64) -> f64 {
        (self.reduced_of(chi2) - 1.0).max(NEXT_TO_NOTHING)
    }

    fn reduced_of(&self, chi2: f64) -> f64 {
        chi2 / self.count.saturating_sub(self.free).max(1) as f64
    }

    /// What is left, rms over the noise.
    pub fn over_noise(&self) -> f64 {
        (self.chi2 / self.count as f64).sqrt()
    }

    /// The one that leaves least.
    pub fn best_of(fits: impl Iterator<Item = Fitted>) -> Option<Fitted> {
        fits.min_by(|a, b| a.chi2.total_cmp(&b.chi2))
    }
}

/// What is left unexplained counts as no less than this.
const NEXT_TO_NOTHING: f64 = 1e-6;

impl Point {
    /// Where the patch stands.
    pub fn of(model: &Model, offsets: usize) -> Point {
        let values = |knobs: &[Knob]| knobs.iter().map(|knob| knob.value).collect::<Vec<_>>();
        Point {
            knobs: values(&model.knobs),
            initial: vec![values(&model.initial); model.records()],
            offsets: vec![0.0; offsets],
        }
    }

    /// What is turned to it for a run beside a record.
    pub(crate) fn choice(&self, record: usize) -> Choice {
        Choice { knobs: self.knobs.clone(), initial: self.initial[record].clone() }
    }
}

/// What is left of an output, rms over its noise.
pub(crate) fn over_sigma(fitted: &Fitted, output: usize) -> f64 {
    mean(&squares(&fitted.residuals, output)).sqrt()
}

/// What is left of an output in squares over the noise, sample by sample.
pub(crate) fn squares(residuals: &[Vec<Vec<f64>>], output: usize) -> Vec<f64> {
    let tracks = residuals.iter().flat_map(|record| record[output].iter());
    tracks.filter(|own| !own.is_nan()).map(|own| own * own).collect()
}
