//! Measured against simulated: where a patch and data disagree, and which effect is missing.
//!
//! An [`Experiment`] is a patch and what was measured on the thing that it stands for. [`Experiment::read`] brings both
//! together: columns of CSV files in the units of the patch, evenly sampled, cut into a part to fit to and a part to test on.

mod document;
mod examine;
mod experiment;
mod fittable;
mod measured;
mod motion;
mod parts;
mod record;
mod subject;
mod together;

pub use document::Hold;
pub use examine::{Examined, Noise, NoiseKind, SHARES, examine};
pub use experiment::{Experiment, ExperimentError, Feed, LEAST_SAMPLES, Output};
pub use record::Record;
