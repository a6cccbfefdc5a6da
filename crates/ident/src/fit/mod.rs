//! Parameter estimation: fits a patch to measured records and finds how accurately the fitted values are known.
//!
//! [`problem`] holds the records and their noise. [`model`] runs the patch along the records. [`levenberg_marquardt`]
//! minimises the sum of squared residuals from one start. [`schedule`] and `estimation` choose among several starts.
//! [`base_fit`] fits the patch as it is, and [`extended_model`] fits it with one more effect. `validation` applies the
//! fitted parameters to the records that were held back. [`intervals`] computes standard errors and confidence
//! intervals. [`simulation`] runs the patch without a fit. `cancellation` ends the runs of a search.

pub mod base_fit;
pub(crate) mod cancellation;
pub mod coloured_residual;
pub mod estimate;
pub(crate) mod estimation;
pub mod extended_model;
pub mod fitted_model;
pub mod intervals;
pub mod levenberg_marquardt;
pub mod model;
pub(crate) mod normal_equations;
pub mod overload;
pub mod parameter_values;
pub mod problem;
pub(crate) mod problem_setup;
pub mod schedule;
pub mod signal_extents;
pub mod simulation;
pub(crate) mod start_cache;
pub mod starts;
pub mod step_size;
pub(crate) mod trajectories;
pub mod uncertainty;
pub(crate) mod validation;
