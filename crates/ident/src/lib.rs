//! System identification for patches: which effect is missing in a patch, according to measured data.
//!
//! An [`Experiment`] is a patch and the data measured on the system that it models. [`Experiment::read`] reads both and
//! gives training and test records in the units of the patch. The rest follows in this order:
//!
//! 1. [`fit`] adjusts the parameters of the patch until its outputs follow the training records.
//! 2. [`residuals`] tests what the fitted patch does not explain: is it only noise, or are a sign, a unit or the time
//!    scale wrong?
//! 3. [`effects`] has a [`Library`](effects::Library) of effects that a patch may lack, such as friction or a delay. It
//!    finds the places where each effect can act, and wires it in there.
//! 4. [`search`] fits every effect at every place and compares the results on all data. It adds the best effect and
//!    repeats this until the residual is noise or no effect is better by more than chance.
//! 5. [`localise`] estimates the unknown input that would explain the residual, if no effect of the library does.
//! 6. [`design`] computes what the data can decide: the smallest effect that they would show, and an experiment that
//!    distinguishes two effects which fit equally well.
//! 7. [`report`] writes texts, pages and JSON documents. No other module formats results.
//!
//! [`statistics`] has the tests and comparisons that these steps share.
//!
//! # Examples
//!
//! A search takes some seconds, so this example is only compiled:
//!
//! ```no_run
//! use patchcord_ident::Experiment;
//! use patchcord_ident::effects::Library;
//! use patchcord_ident::fit::problem::Problem;
//! use patchcord_ident::report::Report;
//! use patchcord_ident::search::{SearchSettings, search};
//!
//! let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
//! let problem = Problem::of(&experiment)?;
//! let library = Library::shipped();
//! let settings = SearchSettings { library: &library, threads: 2, seed: 1 };
//! let outcome = search(&problem, &experiment.patch, &experiment.fit, &settings, |_| ())?;
//! let outcome = outcome.ok_or("the patch cannot be run from any start")?;
//! println!("{}", Report::new(&experiment, &problem, &outcome).sentence());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

mod data;
pub mod design;
pub mod effects;
pub mod fit;
pub mod localise;
pub mod report;
pub mod residuals;
pub mod search;
pub mod statistics;

pub use data::codes;
pub use data::columns::{RecordColumn, record_columns};
pub use data::examine::{ColumnStatistics, Noise, NoiseKind, POWER_FRACTIONS, examine};
pub use data::experiment::{Experiment, MeasuredDrive, MeasuredOutput};
pub use data::experiment_document::Hold;
pub use data::experiment_file::ExperimentError;
pub use data::record::{MIN_RECORD_SAMPLES, Record};
pub use report::provenance::table_files;
