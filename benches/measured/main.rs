//! The gap search on data that others measured.
//!
//! `cargo bench --bench measured` searches every experiment of patches/measured and writes the table of
//! docs/measured.md. `-- NAME ...` searches some experiments and only prints their rows. The measured data must be
//! present.

mod velocity;

use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::time::Instant;

use patchcord::ident::FittedModel;
use patchcord::ident::report::labels::candidate_label;
use patchcord::ident::report::sentence::verdict_sentence;
use patchcord::ident::report::values::assignment_text;
use patchcord::{Experiment, Library, Outcome, Problem, SearchSettings, output, search};

/// Folder of the experiments.
const FOLDER: &str = "patches/measured";
/// The page whose last section is written.
const PAGE: &str = "docs/measured.md";
/// Heading of the section. The text of the page from here on is replaced.
const HEADING: &str = "## Results of the search\n";
/// The text between the heading and the rows of the table.
const INTRO: &str = "
`cargo bench --bench measured` writes this table. *Before* and *after* are the residuals of the base and of the reported
model, each on the training data and on the validation data. For a slide the residual is the error in velocity, for the tanks
the rms residual. *Rejected* are effects that others have proposed for these systems, with the residual of each in place
of the first named effect.

| experiment | verdict | fitted values | before | after | rejected | time |
|---|---|---|---|---|---|---|
";
/// Effects that others have proposed for these systems.
const PROPOSED: [&str; 2] = ["stribeck-friction", "saturation"];

fn main() -> Result<(), Box<dyn Error>> {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let mut files: Vec<_> = fs::read_dir(FOLDER)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|path| path.to_string_lossy().ends_with(".experiment.json"));
    files.sort();
    let mut rows = Vec::new();
    for path in &files {
        let name = path.file_name().unwrap_or_default().to_string_lossy().replace(".experiment.json", "");
        if chosen.is_empty() || chosen.contains(&name) {
            rows.push(search_row(&name, path)?);
            println!("{}", rows[rows.len() - 1]);
        }
    }
    if chosen.is_empty() {
        write_page(&rows)?;
    }
    Ok(())
}

/// Searches an experiment with the shipped library and returns its row of the table.
fn search_row(name: &str, path: &Path) -> Result<String, Box<dyn Error>> {
    let experiment = Experiment::read(path).map_err(|error| error.to_string())?;
    let library = Library::shipped();
    let settings = SearchSettings::new(&library);
    let began = Instant::now();
    let problem = Problem::of(&experiment)?;
    let outcome = search(&experiment, &problem, &settings, |_| ())?;
    let outcome = outcome.ok_or(format!("{name} cannot be run"))?;
    let seconds = began.elapsed().as_secs_f64();
    let residuals = |model: &FittedModel| residuals_text(&experiment, &problem, model);
    let [before, after] = [&outcome.base, outcome.reported_model()].map(residuals);
    let rejected = rejected_text(&outcome, residuals);
    Ok(format!(
        "| {name} | {} | {} | {before} | {after} | {rejected} | {seconds:.0} s |",
        verdict_sentence(&outcome),
        values_text(&outcome)
    ))
}

/// The proposed effects that were tried in the first taken round and not named, with their residuals.
fn rejected_text(outcome: &Outcome, residuals: impl Fn(&FittedModel) -> String) -> String {
    let first = outcome.rounds.iter().find(|round| round.taken);
    let rejected = |name: &&str| {
        let trial = first?.trials.iter().find(|trial| trial.candidate.effect == *name)?;
        let is_named = outcome.effects.iter().any(|effect| effect.effect == *name);
        (!is_named).then(|| format!("{}: {}", candidate_label(&trial.candidate), residuals(&trial.model)))
    };
    PROPOSED.iter().filter_map(rejected).collect::<Vec<_>>().join("; ")
}

/// The fitted values of the reported model.
fn values_text(outcome: &Outcome) -> String {
    let model = outcome.reported_model();
    let values = (0..model.variant.fit.len()).map(|index| assignment_text(model, index));
    values.collect::<Vec<_>>().join(", ")
}

/// The residuals of a model on the training and the validation data, such as "1.49 % / 4.88 %".
///
/// A patch with a signal v is a slide: its residual is the error in velocity. That of another patch is the rms residual
/// in the unit of the output.
fn residuals_text(experiment: &Experiment, problem: &Problem, model: &FittedModel) -> String {
    let mut text = String::new();
    let parameters = (model.variant.fit.as_slice(), model.train.estimate.parameters.as_slice());
    let parts = [(&experiment.train, &model.train), (&experiment.validation, &model.validation)];
    for (index, (records, fitted)) in parts.into_iter().enumerate() {
        let residual = match model.variant.patch().signals.contains_key("v") {
            true => velocity::error(experiment, model.variant.patch(), parameters, &records[0])
                .map(|share| format!("{:.2} %", 100.0 * share)),
            false => {
                let rms = fitted.normalised_rms() * problem.sigma[0];
                Some(format!("{rms:.3} {}", experiment.outputs[0].unit))
            }
        };
        let separator = if index == 0 { "" } else { " / " };
        let _ = write!(text, "{separator}{}", residual.unwrap_or_else(|| "not run".to_owned()));
    }
    text
}

/// Replaces the last section of the page.
fn write_page(rows: &[String]) -> Result<(), Box<dyn Error>> {
    let text = fs::read_to_string(PAGE)?;
    let before = text.split_once(HEADING).map_or(text.as_str(), |(before, _)| before).trim_end();
    let page = format!("{before}\n\n{HEADING}{INTRO}{}\n", rows.join("\n"));
    Ok(output::write_atomic(Path::new(PAGE), page.as_bytes())?)
}
