//! The patches that a search leaves: with fitted values, with integrators that begin as the training data do, and with a note
//! that tells where all that comes from.

use std::collections::HashSet;
use std::path::{Component, Path, PathBuf};

use serde_json::Value;

use crate::data::drive_timing::RECORD_START;
use crate::data::experiment::Experiment;
use crate::effects::candidate::Candidate;
use crate::fit::fitted_model::Stage;
use crate::fit::model::{ModelError, begun};
use crate::localise::force::Whereabouts;
use crate::report::values::{interval_text, number_text};
use crate::search::outcome::Outcome;
use crate::search::round::Round;
use patchcord_analysis::instruments::number;
use patchcord_core::document::behind;
use patchcord_core::patch::Patch;

/// The patch as it was, with every parameter at its fitted value.
///
/// # Errors
/// If an edit is refused. All edits are of entries that the patch has.
pub fn fitted_patch(outcome: &Outcome, experiment: &Experiment, file: &str) -> Result<Patch, ModelError> {
    let told = format!("fitted. {}", left(&outcome.base));
    finished(&standing(&outcome.base)?, experiment, &told, file)
}

/// The patch with the effects that are named, at their fitted values; `None` if none is named.
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
    let stages = [&outcome.base, outcome.told()].map(left);
    let told = format!("with {}. Before: {} After: {}", effects_text(outcome), stages[0], stages[1]);
    finished(&standing(outcome.told())?, experiment, &told, file).map(Some)
}

/// The patch with the force that closes its gap best; `None` unless something is missing that has no name.
///
/// # Errors
/// If an edit is refused. All edits are of entries that the patch has.
pub fn recovered_patch(
    outcome: &Outcome,
    experiment: &Experiment,
    file: &str,
) -> Result<Option<Patch>, ModelError> {
    let Some(found) = outcome.unnamed() else { return Ok(None) };
    let (force, before) = (force(found), left(&outcome.base));
    let closes = found.wired().map_or(found.explains, |curve| curve.explains);
    let share = number(100.0 * closes);
    let told =
        format!("with a force {force}. Before: {before} The force closes {share} % of that in training.");
    finished(&found.recovered, experiment, &told, file).map(Some)
}

/// The effects that were taken, with their parameters.
fn effects_text(outcome: &Outcome) -> String {
    let taken = outcome.effects.iter().zip(&outcome.rounds);
    taken.map(|(own, round)| effect_text(outcome, own, round)).collect::<Vec<_>>().join("; and ")
}

fn effect_text(outcome: &Outcome, own: &Candidate, round: &Round) -> String {
    let parameters = outcome.last.brought(own).map(|(own, value, known)| {
        let (value, between) = (number_text(known, value), interval_text(known));
        format!("{} = {value}{} (95 %: {between})", own.name, behind(&own.unit))
    });
    let parameters: Vec<String> = parameters.collect();
    let or = round.rival().map(|rival| format!(" (or {}: the data cannot tell)", rival.named()));
    let or = or.unwrap_or_default();
    format!("{}{or}, {}", own.named(), parameters.join(", "))
}

/// The patch of a stage as it was fitted: parameters, and the voltages with which the first record begins.
fn standing(stage: &Stage) -> Result<Patch, ModelError> {
    let at = stage.version.at(stage.version.patch().file(), &stage.train.point.knobs)?;
    begun(&at, &stage.version.free, &stage.train.point.initial[0])
}

/// A patch as one of a file, with a note of where it comes from in front of its own, and the clock of the first record.
fn finished(patch: &Patch, experiment: &Experiment, told: &str, file: &str) -> Result<Patch, ModelError> {
    let own = if patch.note.is_empty() { String::new() } else { format!("\n\n{}", patch.note) };
    let (from, data) = (experiment.patch.file(), data(experiment));
    let note = format!("Made by patchcord gap of {from} beside {data}: {told}{own}");
    let mut editor = patch.edit();
    editor.set_note(&note);
    if patch.parameters.contains_key(RECORD_START) {
        let since = experiment.train.first().map_or(0.0, |record| record.since);
        editor.set_parameter(RECORD_START, since)?;
    }
    // Their files are then looked for from the folder of the new file.
    for (path, csv) in tables(patch, file) {
        editor.put(&path, csv);
    }
    Ok(editor.finish(file)?)
}

/// The files that hold tables of a patch.
pub fn table_files(patch: &Patch) -> Vec<PathBuf> {
    let folder = Path::new(patch.file()).parent().unwrap_or(Path::new(""));
    tables_named(patch).map(|(_, csv)| folder.join(csv)).collect()
}

/// Where a patch names files with tables from its folder, their names from that of another file.
fn tables<'p>(patch: &'p Patch, file: &str) -> Vec<(Vec<&'p str>, String)> {
    tables_named(patch).filter_map(|(path, csv)| Some((path, renamed(patch.file(), csv, file)?))).collect()
}

/// The places where a patch names files with tables, and these.
fn tables_named(patch: &Patch) -> impl Iterator<Item = (Vec<&str>, &str)> {
    let all = patch.value();
    let inside =
        members(&all["macros"]).map(|(name, own)| (vec!["macros", name, "elements"], &own["elements"]));
    let sections = ["drives", "elements"].map(|section| (vec![section], &all[section]));
    sections.into_iter().chain(inside).flat_map(|(section, entries)| {
        in_files(entries)
            .map(move |[name, key, csv]| ([section.as_slice(), &[name, key, "csv"]].concat(), csv))
    })
}

/// The settings of elements or drives that are tables in files: element, setting, file.
fn in_files(entries: &Value) -> impl Iterator<Item = [&str; 3]> {
    let settings = members(entries).flat_map(|(name, entry)| {
        members(entry).filter(|(key, _)| *key != "in").map(move |(key, setting)| (name, key, setting))
    });
    settings.filter_map(|(name, key, setting)| Some([name, key, setting.get("csv")?.as_str()?]))
}

fn members(value: &Value) -> impl Iterator<Item = (&String, &Value)> {
    value.as_object().into_iter().flatten()
}

/// The name of a file beside one as it is from the folder of another; nothing where there is no way from one to the other.
fn renamed(beside: &str, name: &str, other: &str) -> Option<String> {
    let folder = |file: &str| Path::new(".").join(Path::new(file).parent()?).canonicalize().ok();
    let (from, to) = (folder(other)?, folder(beside)?.join(name));
    let shared = from.components().zip(to.components()).take_while(|(one, other)| one == other).count();
    let up = from.components().skip(shared).map(|_| Component::ParentDir);
    let way: PathBuf = up.chain(to.components().skip(shared)).collect();
    Some(way.to_str()?.to_owned())
}

/// The files that were trained on, each once.
fn data(experiment: &Experiment) -> String {
    let mut names: Vec<&str> = experiment.train.iter().map(|record| record.name.as_str()).collect();
    // One file may be several records, with others between.
    let mut seen = HashSet::new();
    names.retain(|name| seen.insert(*name));
    names.join(", ")
}

/// What a stage leaves, in words.
fn left(stage: &Stage) -> String {
    let [train, test] = [&stage.train, &stage.test].map(|fitted| number(fitted.over_noise()));
    format!("{train} times the noise is left in training, {test} on the data held back.")
}

fn force(found: &Whereabouts) -> String {
    match found.wired() {
        Some(curve) => format!("at {}, a function of {}", found.junction, curve.against),
        None => format!("at {}, a table over the time of the first record", found.junction),
    }
}
