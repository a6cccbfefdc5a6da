//! The outcome of a search for a client: the verdict in words, the fitted values, and the patch with what is missing.

use patchcord_core::patch::Patch;
use patchcord_ident::report::values::owner;
use patchcord_ident::{Experiment, Library, Outcome, Problem, Report};

use crate::event::{FittedParameter, FoundPatch, FoundView};
use crate::message::model_message;

/// The outcome of a search. `library` has the effects that were tried.
///
/// # Errors
/// The message if a patch or the report cannot be made.
pub(crate) fn found(
    experiment: &Experiment,
    problem: &Problem,
    outcome: &Outcome,
    library: &Library,
) -> Result<FoundView, String> {
    let report = Report::new(experiment, problem, outcome);
    let fitted = report.fitted(experiment.patch.file()).map_err(|error| model_message(&error))?;
    let extended = extended_patch(&report)?;
    Ok(FoundView {
        verdict: outcome.verdict.as_str(),
        sentence: report.sentence(),
        doubts: report.doubts(),
        before: outcome.base.train.normalised_rms(),
        after: outcome.reported_model().train.normalised_rms(),
        parameters: parameters(outcome),
        patch: extended.map(|patch| FoundPatch {
            text: patch.text().to_owned(),
            elements: new_names(&experiment.patch, &patch),
        }),
        fitted: fitted.text().to_owned(),
        report: report.single_page(library).map_err(|error| error.to_string())?,
    })
}

/// The patch with what is missing: with the named effects, or with an unknown force as a curve. None if nothing was
/// found.
///
/// # Errors
/// The message if the patch cannot be made.
fn extended_patch(report: &Report<'_>) -> Result<Option<Patch>, String> {
    let file = report.experiment.patch.file();
    let augmented = report.augmented(file).map_err(|error| model_message(&error))?;
    match augmented {
        Some(patch) => Ok(Some(patch)),
        None => report.recovered(file).map_err(|error| model_message(&error)),
    }
}

/// The fitted parameters of the reported model.
fn parameters(outcome: &Outcome) -> Vec<FittedParameter> {
    let model = outcome.reported_model();
    let values = model.variant.fit.iter().zip(&model.train.estimate.parameters).enumerate();
    let parameters = values.map(|(index, (name, value))| {
        let [low, high] = model.uncertainty(index).interval;
        let (unit, of) = (model.unit(index).to_owned(), owner(outcome, name));
        FittedParameter { name: name.clone(), value: *value, low, high, unit, of }
    });
    parameters.collect()
}

/// The names of the elements and drives of a patch that another one does not have.
fn new_names(before: &Patch, after: &Patch) -> Vec<String> {
    let added = |name: &&String| !before.elements.contains_key(*name) && !before.drives.contains_key(*name);
    after.elements.keys().chain(after.drives.keys()).filter(added).cloned().collect()
}
