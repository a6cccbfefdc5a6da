//! Reports of a search: sentences, the JSON document, the page, and the patches that it leaves.
//!
//! Every text and document for a reader or a program is made here, from the results of the folders below: each file has the
//! sentences and the documents of one kind of result. A [`Report`] joins the outcome of a search with its experiment and its
//! problem and gives the whole.

pub mod detection_limits;
pub mod discriminating_experiment;
pub mod document;
pub mod doubts;
pub mod effect_page;
pub mod fit_quality;
pub mod localisation;
mod page;
pub mod places;
pub mod provenance;
pub mod ranges;
pub mod reasons;
pub mod rounds;
pub mod search_log;
pub mod sentence;
pub mod values;

use serde_json::{Value, json};

use crate::data::experiment::Experiment;
use crate::effects::Library;
use crate::fit::model::ModelError;
use crate::fit::problem::Problem;
use crate::report::discriminating_experiment::experiment_csv;
use crate::report::document::SearchDocument;
use crate::report::doubts::doubts;
use crate::report::provenance::{augmented_patch, fitted_patch, recovered_patch};
use crate::report::sentence::verdict_sentence;
use crate::search::outcome::Outcome;
use patchcord_core::patch::Patch;
use patchcord_draw::plot::PlotError;

/// The outcome of a search, with the experiment and the problem that it belongs to.
#[derive(Debug, Clone, Copy)]
pub struct Report<'a> {
    /// The experiment that was searched.
    pub experiment: &'a Experiment,
    /// The records of the experiment, with their noise.
    pub problem: &'a Problem,
    /// What the search found.
    pub outcome: &'a Outcome,
}

impl<'a> Report<'a> {
    /// The report of an outcome.
    pub fn new(experiment: &'a Experiment, problem: &'a Problem, outcome: &'a Outcome) -> Report<'a> {
        Report { experiment, problem, outcome }
    }

    /// The verdict in a sentence.
    pub fn sentence(&self) -> String {
        verdict_sentence(self.outcome)
    }

    /// What the reader should doubt, a sentence each.
    pub fn doubts(&self) -> Vec<String> {
        doubts(self.outcome, self.experiment)
    }

    /// Everything that was found, as a document.
    pub fn document(&self) -> SearchDocument {
        SearchDocument::of(self.problem, self.outcome)
    }

    /// The same as a JSON value, for callers that add members or look some up.
    pub fn json(&self) -> Value {
        json!(self.document())
    }

    /// The patch as it was, fitted, as one of this file.
    ///
    /// # Errors
    /// If an edit is refused. All edits are of entries that the patch has.
    pub fn fitted(&self, file: &str) -> Result<Patch, ModelError> {
        fitted_patch(self.outcome, self.experiment, file)
    }

    /// The patch with the effects that are named, as one of this file; None if none is named.
    ///
    /// # Errors
    /// If an edit is refused. All edits are of entries that the patch has.
    pub fn augmented(&self, file: &str) -> Result<Option<Patch>, ModelError> {
        augmented_patch(self.outcome, self.experiment, file)
    }

    /// The patch with the force that closes its gap best, as one of this file; None unless something is missing that has no name.
    ///
    /// # Errors
    /// If an edit is refused. All edits are of entries that the patch has.
    pub fn recovered(&self, file: &str) -> Result<Option<Patch>, ModelError> {
        recovered_patch(self.outcome, self.experiment, file)
    }

    /// The experiment that distinguishes two effects, as CSV text; None if the verdict needs none or none was found.
    pub fn discriminating_csv(&self) -> Option<String> {
        self.outcome.separating.as_ref().map(|own| experiment_csv(own, &self.experiment.outputs))
    }

    /// The report as one HTML page; `library` has the effects that were tried.
    ///
    /// # Errors
    /// If a picture cannot be drawn.
    pub fn page(&self, library: &Library) -> Result<String, PlotError> {
        page::page(self, library)
    }
}
