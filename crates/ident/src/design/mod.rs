//! Design of experiments: the weakest effects that data can show, and the experiment that discriminates between two
//! effects.

pub mod detectability;
pub mod discriminating_experiment;
pub(crate) mod drive_proposal;
