//! Measured against simulated: where a patch and data disagree, and which effect is missing.
//!
//! An [`Experiment`] is a patch and what was measured on the thing that it stands for. [`Experiment::read`] brings both
//! together: columns of CSV files in the units of the patch, evenly sampled, cut into a part to fit to and a part to test on.
//! What a patch may lack stands in a [`Library`](effect::Library); [`site`] finds where there is room for it, [`graft`] wires it
//! in, [`model`] runs the patch beside the records, [`fit`] turns its parameters, and [`search`] does all that for every
//! effect and judges what came of it.

pub mod attached;
mod begun;
mod between;
pub mod beyond;
pub mod blind;
pub mod candidate;
mod clock;
mod come;
pub mod correlation;
mod dice;
mod directions;
mod document;
pub mod effect;
pub mod effort;
mod examine;
mod experiment;
pub mod fit;
mod fittable;
pub mod graft;
mod held;
pub mod intervals;
pub mod limits;
mod measured;
pub mod mistold;
pub mod model;
mod motion;
mod normal;
mod overload;
pub mod page;
pub mod parameter_values;
mod parts;
pub mod peaks;
pub mod places;
mod probe;
pub mod problem;
pub mod progress;
mod provenance;
pub mod reach;
mod record;
pub mod report;
pub mod round;
pub mod runaway;
pub mod score;
pub mod search;
mod sentence;
pub mod separate;
mod settled;
pub mod site;
pub mod stage;
pub mod starts;
mod statistics;
mod steps;
mod subject;
mod together;
mod trying;
pub mod unrest;
pub mod way;
pub mod whereabouts;

pub use document::Hold;
pub use examine::{Column, Examined, Noise, NoiseKind, SHARES, columns, examine};
pub use experiment::{Experiment, ExperimentError, Feed, LEAST_SAMPLES, Output};
pub use provenance::table_files;
pub use record::Record;
