//! Measured against simulated: where a patch and data disagree, and which effect is missing.
//!
//! An [`Experiment`] is a patch and what was measured on the thing that it stands for. [`Experiment::read`] brings both
//! together: columns of CSV files in the units of the patch, evenly sampled, cut into a part to fit to and a part to test on.
//! What a patch may lack stands in a [`Library`](effects::Library); [`effects::sites`] finds where there is room for it, [`effects::graft`] wires it
//! in, [`fit::model`] runs the patch beside the records, [`fit`] turns its parameters, and [`search`] does all that for every
//! effect and judges what came of it. All sentences and documents about that are made in [`report`]: nothing below knows it.

mod data;
pub mod design;
pub mod effects;
pub mod fit;
pub mod localise;
pub mod report;
pub mod residuals;
pub mod search;
pub mod statistics;

pub use data::columns::{Column, columns};
pub use data::document::Hold;
pub use data::examine::{Examined, Noise, NoiseKind, SHARES, examine};
pub use data::experiment::{Experiment, Feed, Output};
pub use data::experiment_file::ExperimentError;
pub use data::record::{LEAST_SAMPLES, Record};
pub use report::provenance::table_files;
