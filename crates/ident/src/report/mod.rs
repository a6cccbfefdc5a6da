//! Reports of a search: sentences, the JSON document, the HTML page, and the resulting patches.
//!
//! This folder makes all texts and documents for readers and programs. Other folders only compute results. Each file
//! has the sentences and the documents for one kind of result. A [`Report`] combines the outcome of a search with its
//! experiment and its problem, and gives access to everything.
//!
//! Where a result appears:
//!
//! * `patchcord gap` prints [`Report::sentence`], tables, [`Report::doubts`] and the round sentences.
//! * `report.json` is [`Report::json`], to which the command line adds the patches or the paths of their files.
//! * `report.html` is [`Report::page`]. It uses the same sentences as the terminal.
//! * `fitted.json`, `augmented.json` and `recovered.json` are patches ([`provenance`]), `separate.csv` is the table of
//!   [`discriminating_experiment`].
//! * `patchcord gap --check` prints a [`CheckReport`](check::CheckReport), which needs no search.
//!
//! Keys of JSON documents and verdict words are stable, because scripts read them. Some keys are older than the names
//! in the code, such as `tells` for "is decisive".

pub mod check;
pub mod check_document;
pub mod detection_limits;
pub mod discriminating_experiment;
pub mod document;
pub mod doubts;
pub mod effect_page;
pub mod effect_sites;
pub mod experiment_summary;
pub mod fit_quality;
pub mod labels;
pub mod localisation;
mod page;
pub mod progress;
pub mod provenance;
pub mod ranges;
pub mod reasons;
pub mod rounds;
pub mod search_log;
pub mod sentence;
pub mod values;

use serde_json::Value;

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
use patchcord_core::document::json_value;
use patchcord_core::patch::Patch;
use patchcord_draw::plot::PlotError;

/// The files next to a page to which it has links.
const FILES: [&str; 4] = ["fitted.json", "augmented.json", "recovered.json", "separate.csv"];

/// The outcome of a search, with the experiment and the problem that it belongs to.
///
/// # Examples
///
/// A search takes some seconds, so this example is only compiled:
///
/// ```no_run
/// use patchcord_ident::{Experiment, Library, Problem, Report, SearchSettings, search};
///
/// let experiment = Experiment::read("../../examples/05_missing_effect/spring.experiment.json")?;
/// let (problem, library) = (Problem::of(&experiment)?, Library::shipped());
/// let outcome = search(&experiment, &problem, &SearchSettings::new(&library), |_| ())?;
/// let outcome = outcome.ok_or("the patch cannot be run from any start")?;
///
/// let report = Report::new(&experiment, &problem, &outcome);
/// std::fs::write("report.html", report.page(&library)?)?;
/// std::fs::write("report.json", report.json().to_string())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Report<'a> {
    /// The experiment that was searched.
    pub experiment: &'a Experiment,
    /// The records of the experiment, with their noise.
    pub problem: &'a Problem,
    /// The outcome of the search.
    pub outcome: &'a Outcome,
}

impl<'a> Report<'a> {
    /// The report of an outcome.
    pub fn new(experiment: &'a Experiment, problem: &'a Problem, outcome: &'a Outcome) -> Report<'a> {
        Report { experiment, problem, outcome }
    }

    /// The verdict as a sentence without a full stop.
    ///
    /// Examples: "viscous-friction at A1 is missing", "no missing effect is detectable in these data", "inconclusive:
    /// ...".
    pub fn sentence(&self) -> String {
        verdict_sentence(self.outcome)
    }

    /// Doubts about the result, a sentence each. Empty if there are none.
    pub fn doubts(&self) -> Vec<String> {
        doubts(self.outcome, self.experiment)
    }

    /// The complete result as a document, with the doubts and the experiment.
    pub fn document(&self) -> SearchDocument {
        SearchDocument::of(self.experiment, self.problem, self.outcome)
    }

    /// The same as a JSON value, for callers that add members or look some up.
    pub fn json(&self) -> Value {
        json_value(&self.document())
    }

    /// The original patch with fitted values. `file` is the path of the new patch.
    ///
    /// # Errors
    /// If an edit is refused. All edits are of entries that the patch has.
    pub fn fitted(&self, file: &str) -> Result<Patch, ModelError> {
        fitted_patch(self.outcome, self.experiment, file)
    }

    /// The patch with the named effects. `file` is its path. None if no effect is named.
    ///
    /// # Errors
    /// If an edit is refused. All edits are of entries that the patch has.
    pub fn augmented(&self, file: &str) -> Result<Option<Patch>, ModelError> {
        augmented_patch(self.outcome, self.experiment, file)
    }

    /// The patch with the force that explains the gap best. `file` is its path. None unless the verdict is an unknown
    /// effect.
    ///
    /// # Errors
    /// If an edit is refused. All edits are of entries that the patch has.
    pub fn recovered(&self, file: &str) -> Result<Option<Patch>, ModelError> {
        recovered_patch(self.outcome, self.experiment, file)
    }

    /// The experiment that distinguishes two effects, as CSV text; None if the verdict needs none or none was found.
    pub fn discriminating_csv(&self) -> Option<String> {
        let experiment = self.outcome.discriminating_experiment.as_ref();
        experiment.map(|experiment| experiment_csv(experiment, &self.experiment.outputs))
    }

    /// The report as one HTML page; `library` has the effects that were tried.
    ///
    /// # Errors
    /// If a picture cannot be drawn.
    pub fn page(&self, library: &Library) -> Result<String, PlotError> {
        page::page(self, library)
    }

    /// The same page for a reader who has no other files: the names of files are no links.
    ///
    /// # Errors
    /// As for [`Report::page`].
    pub fn single_page(&self, library: &Library) -> Result<String, PlotError> {
        let link = |file: &str| format!("<a href=\"{file}\">{file}</a>");
        Ok(FILES.iter().fold(self.page(library)?, |page, file| page.replace(&link(file), file)))
    }
}
