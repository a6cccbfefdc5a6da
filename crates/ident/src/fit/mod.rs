//! Fits: a patch as a model of records, its parameters and initial states estimated, and how well they are known.

pub mod base_fit;
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
pub mod peaks;
pub mod problem;
pub(crate) mod problem_setup;
pub mod schedule;
pub(crate) mod start_cache;
pub mod starts;
pub mod step_size;
pub(crate) mod trajectories;
pub mod uncertainty;
pub(crate) mod validation;
