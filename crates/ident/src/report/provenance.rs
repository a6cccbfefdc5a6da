//! The patches that a search writes.
//!
//! They have fitted values and the initial voltages of the first training record. A note in front of the patch's own
//! note has the source, the changes and the residuals. Paths of table files are adapted to the new folder.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use serde_json::Value;

use crate::data::drive_timing::RECORD_START;
use crate::data::experiment::Experiment;
use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::FittedModel;
use crate::fit::model::{ModelError, with_initial_voltages};
use crate::localise::localisation::Localisation;
use crate::report::labels::candidate_label;
use crate::report::values::{interval_text, number_text, percent_text, residual_texts};
use crate::search::outcome::Outcome;
use crate::search::round::Round;
use patchcord_core::document::unit_suffix;
use patchcord_core::patch::Patch;

/// The original patch with every parameter at its fitted value. `file` is the path of the new patch.
///
/// # Errors
/// If an edit is refused. All edits are of entries that the patch has.
pub fn fitted_patch(outcome: &Outcome, experiment: &Experiment, file: &str) -> Result<Patch, ModelError> {
    let changes = format!("fitted; {}", residual_text(&outcome.base));
    finish_patch(&patch_at_estimate(&outcome.base)?, experiment, &changes, file)
}

/// The patch with the named effects at their fitted values. None if no effect is named.
///
/// # Errors
/// If an edit is refused. All edits are of entries that the patch has.
pub fn augmented_patch(
    outcome: &Outcome,
    experiment: &Experiment,
    file: &str,
) -> Result<Option<Patch>, ModelError> {
    if !outcome.verdict.has_names() {
        return Ok(None);
    }
    let model = outcome.reported_model();
    let [before, after] = [&outcome.base, model].map(residual_text);
    let changes = format!("with {}. Before: {before} After: {after}", effects_text(outcome));
    finish_patch(&patch_at_estimate(model)?, experiment, &changes, file).map(Some)
}

/// The patch with the force that explains the gap best. None unless the verdict is an unknown effect.
///
/// # Errors
/// If an edit is refused. All edits are of entries that the patch has.
pub fn recovered_patch(
    outcome: &Outcome,
    experiment: &Experiment,
    file: &str,
) -> Result<Option<Patch>, ModelError> {
    let Some(force) = outcome.unknown_force() else { return Ok(None) };
    let (description, before) = (force_text(force), residual_text(&outcome.base));
    let explains = force.wired_curve().map_or(force.explained_fraction, |curve| curve.explained_fraction);
    let share = percent_text(100.0 * explains);
    let changes = format!(
        "with a force {description}. Before: {before} The force explains {share} of the gap in the training data."
    );
    finish_patch(&force.recovered, experiment, &changes, file).map(Some)
}

/// The added effects with their parameters, separated by "; and ".
fn effects_text(outcome: &Outcome) -> String {
    let taken = outcome.effects.iter().zip(&outcome.rounds);
    taken.map(|(effect, round)| effect_text(outcome, effect, round)).collect::<Vec<_>>().join("; and ")
}

/// An effect with its site, its best rival and its parameters with their intervals.
///
/// Example: "leak at I2, k = 0.2 1/s (95 %: 0.19 ... 0.21)". A rival follows the label in parentheses.
fn effect_text(outcome: &Outcome, effect: &Candidate, round: &Round) -> String {
    let parameters = outcome.final_model.effect_parameters(effect).map(|(parameter, value, uncertainty)| {
        let (value, interval) = (number_text(uncertainty, value), interval_text(uncertainty));
        format!("{} = {value}{} (95 %: {interval})", parameter.name, unit_suffix(&parameter.unit))
    });
    let parameters: Vec<String> = parameters.collect();
    let rival = round
        .rival()
        .map(|rival| format!(" (or {}: the data cannot distinguish them)", candidate_label(&rival.candidate)))
        .unwrap_or_default();
    format!("{}{rival}, {}", candidate_label(effect), parameters.join(", "))
}

/// The patch of a model with its fitted parameters and the initial voltages of the first training record.
fn patch_at_estimate(model: &FittedModel) -> Result<Patch, ModelError> {
    let patch =
        model.variant.patch_with_values(model.variant.patch().file(), &model.train.estimate.parameters)?;
    with_initial_voltages(&patch, &model.variant.initial_states, &model.train.estimate.initial[0])
}

/// A patch with the path `file`, the clock of the first record, and a note with its source and `changes`.
///
/// The steps are: the note, the start of the record if the patch depends on it, the paths of tables, and the check of
/// the finished document.
fn finish_patch(
    patch: &Patch,
    experiment: &Experiment,
    changes: &str,
    file: &str,
) -> Result<Patch, ModelError> {
    let original = if patch.note.is_empty() { String::new() } else { format!("\n\n{}", patch.note) };
    let (source, data) = (&experiment.patch_name, training_files(experiment));
    let note = format!("Made by patchcord gap from {source} and {data}: {changes}{original}");
    let mut editor = patch.edit();
    editor.set_note(&note);
    if patch.parameters.contains_key(RECORD_START) {
        let since = experiment.train.first().map_or(0.0, |record| record.start_in_file);
        editor.set_parameter(RECORD_START, since)?;
    }
    // Table files are relative to the folder of the patch, which may change.
    for (path, csv) in relocated_tables(patch, file) {
        editor.put(&path, csv);
    }
    Ok(editor.finish(file)?)
}

/// The table references of a patch with their paths relative to the folder of `file`. Absolute paths, which stay as
/// they are, and paths that do not exist are left out.
fn relocated_tables<'p>(patch: &'p Patch, file: &str) -> Vec<(Vec<&'p str>, String)> {
    table_references(patch)
        .filter_map(|(path, csv)| Some((path, relocated(patch.file(), csv, file)?)))
        .collect()
}

/// The references of a patch to table files: the path of the entry in the document, and the path of the file.
///
/// Tables occur in drives, in elements, and in elements of macros. Each path leads to the key `csv`, for example
/// drives, F, points, csv.
fn table_references(patch: &Patch) -> impl Iterator<Item = (Vec<&str>, &str)> {
    let all = patch.value();
    let inside =
        members(&all["macros"]).map(|(name, body)| (vec!["macros", name, "elements"], &body["elements"]));
    let sections = ["drives", "elements"].map(|section| (vec![section], &all[section]));
    sections.into_iter().chain(inside).flat_map(|(section, entries)| {
        file_settings(entries)
            .map(move |[name, key, csv]| ([section.as_slice(), &[name, key, "csv"]].concat(), csv))
    })
}

/// The settings of elements or drives that are tables in files: element, setting, path of the file.
fn file_settings(entries: &Value) -> impl Iterator<Item = [&str; 3]> {
    let settings = members(entries).flat_map(|(name, entry)| {
        members(entry).filter(|(key, _)| *key != "in").map(move |(key, setting)| (name, key, setting))
    });
    settings.filter_map(|(name, key, setting)| Some([name, key, setting.get("csv")?.as_str()?]))
}

/// The members of a JSON object. Empty for other values.
fn members(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

/// The path `name`, which is relative to the folder of `from_file`, relative to the folder of `to_file`. None if it is
/// absolute, if a folder does not exist, or if the path is not valid UTF-8.
///
/// Both folders are resolved without links first, so that the number of ".." is right.
fn relocated(from_file: &str, name: &str, to_file: &str) -> Option<String> {
    if Path::new(name).is_absolute() {
        return None;
    }
    let folder = |file: &str| Path::new(".").join(Path::new(file).parent()?).canonicalize().ok();
    let (base, target) = (folder(to_file)?, folder(from_file)?.join(name));
    let shared = base.components().zip(target.components()).take_while(|(one, other)| one == other).count();
    let up = base.components().skip(shared).map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(target.components().skip(shared)).collect();
    Some(path.to_str()?.to_owned())
}

/// The files of the training records, separated by commas, each once.
fn training_files(experiment: &Experiment) -> String {
    let mut names: Vec<&str> = experiment.train.iter().map(|record| record.name.as_str()).collect();
    // A file may occur again after other files.
    let mut seen = HashSet::new();
    names.retain(|name| seen.insert(*name));
    names.join(", ")
}

/// The residual of a model in the training and validation data, as a sentence.
fn residual_text(model: &FittedModel) -> String {
    let [train, validation] = residual_texts(model);
    format!(
        "the residual is {train} times the noise in the training data and {validation} in the validation data."
    )
}

/// Where a force acts, and how it is represented in the patch.
fn force_text(force: &Localisation) -> String {
    match force.wired_curve() {
        Some(curve) => format!("at {}, a function of {}", force.junction, curve.regressor),
        None => format!("at {}, a table over the time of the first record", force.junction),
    }
}
