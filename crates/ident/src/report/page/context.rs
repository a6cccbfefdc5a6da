//! What a page is made of.

use crate::data::experiment::Experiment;
use crate::effects::Library;
use crate::fit::problem::Problem;
use crate::search::outcome::Outcome;

/// What a page is made of.
#[derive(Debug, Clone, Copy)]
pub struct Told<'a> {
    /// What was asked.
    pub experiment: &'a Experiment,
    /// What the patch was held against.
    pub problem: &'a Problem,
    /// What was found.
    pub outcome: &'a Outcome,
    /// The effects that were tried.
    pub library: &'a Library,
}
