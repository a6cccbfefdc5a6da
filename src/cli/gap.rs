//! `patchcord gap`
//!
//! The command either checks the data (`--check`) or searches. A search with `--out` writes the report and the patches;
//! without it the JSON document contains the patches themselves.

use std::path::PathBuf;
use std::thread;

use clap::Args;
use serde_json::json;

use super::failure::{Failure, eprint_report};
use super::files::check_distinct_from;
use super::gap_files::{Folder, embed};
use super::numbers::{seed, threads};
use super::progress::ProgressBar;
use super::{effects, gap_check, gap_report, print, print_json};
use patchcord::ident::Experiment;
use patchcord::ident::design::detectability::Detectability;
use patchcord::ident::effects::Library;
use patchcord::ident::effects::effect_sites::EffectSites;
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::report::Report;
use patchcord::ident::report::document::ExperimentDocument;
use patchcord::ident::search::progress::{Progress, SearchPhase};
use patchcord::ident::search::{Outcome, SearchSettings};

#[derive(Args)]
pub(super) struct Arguments {
    /// Experiment file (JSON): the patch, the measured data, the parameters to fit; docs/gap.md shows an example
    experiment: PathBuf,
    /// Only check the data (sampling, missing samples, noise, resolution, bandwidth), list the places for effects, and
    /// compute the weakest detectable effects
    #[arg(long, conflicts_with = "out")]
    check: bool,
    /// Write these files into this folder: the report (report.html, report.json), the fitted patch (fitted.json) and
    /// the patch with the missing effect (augmented.json); if the effect is unknown, the patch with its force as a
    /// curve (recovered.json); if two effects cannot be distinguished, a drive that distinguishes them (separate.csv)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Add the effects in this folder: every .json file in it
    #[arg(long, value_name = "DIR")]
    effects: Option<PathBuf>,
    /// Seed for the random starting points of the fit
    #[arg(long, value_name = "NUMBER", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Number of threads (default: number of cores)
    #[arg(long, value_name = "NUMBER", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// The JSON form of a failure is selected here.
pub(super) fn gap(arguments: &Arguments) -> Result<(), Failure> {
    execute(arguments).map_err(|failure| failure.with_json_output(arguments.json))
}

/// Warnings about the data are printed before the search, because it may take minutes.
fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let experiment = Experiment::read(&arguments.experiment)?;
    eprint_report(&experiment.warnings);
    if let (Some(effects), Some(out)) = (&arguments.effects, &arguments.out) {
        check_distinct_from("the folder of effects", effects, [out].into_iter())?;
    }
    let library = effects::effect_library(arguments.effects.as_deref())?;
    if arguments.check {
        return check_data(arguments, &experiment, &library);
    }
    let folder = arguments.out.as_deref().map(|folder| Folder::prepare(folder, &experiment)).transpose()?;
    let (problem, outcome) = run_search(arguments, &experiment, &library)?;
    let report = Report::new(&experiment, &problem, &outcome);
    let mut document = report.json();
    document["doubts"] = report.doubts().into();
    document["experiment"] = json!(ExperimentDocument::of(&experiment, &problem, arguments.seed));
    let files = match folder {
        Some(folder) => folder.write(&report, &library, &mut document).map(|files| format!("\n{files}")),
        None => embed(&report, &mut document).map(|()| String::new()),
    };
    // A search takes minutes, so its result is printed even if the files cannot be written.
    if arguments.json {
        print_json(&document)?;
        return files.map(|_| ());
    }
    print(&gap_report::text(&report))?;
    print(&files?)
}

/// The current part of a search in words.
fn part_text(at: Progress) -> String {
    match at.phase {
        SearchPhase::Base => "fitting the patch".to_owned(),
        SearchPhase::Quick => format!("effects tried quickly, round {}", at.round),
        SearchPhase::Full => format!("best effects fitted, round {}", at.round),
        SearchPhase::Growing => format!("best effects fitted step by step, round {}", at.round),
        SearchPhase::Localisation => "locating the missing effect".to_owned(),
    }
}

/// Shows the progress of a search.
///
/// Work that cannot be counted is shown as text.
fn show(bar: &mut ProgressBar, at: Progress) {
    let words = part_text(at);
    match at.total {
        0 => bar.busy(&words),
        all => {
            bar.switch_to(&words);
            bar.done(at.done, all);
        }
    }
}

/// Library, threads and seed of a search.
fn means<'a>(arguments: &Arguments, library: &'a Library) -> SearchSettings<'a> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    SearchSettings { library, threads: arguments.threads.unwrap_or(cores), seed: arguments.seed }
}

/// The failure if no starting point gives a run.
fn no_run_failure(experiment: &Experiment) -> Failure {
    Failure::data(format!(
        "{} cannot be run with the data from any of the starting points: check its scales \
         and the ranges of the fitted parameters, or divide the records with \"pieces\" in the experiment",
        experiment.patch.file()
    ))
}

/// Reports on the data before the slow fit, and then on the weakest detectable effects.
fn check_data(arguments: &Arguments, experiment: &Experiment, library: &Library) -> Result<(), Failure> {
    let places = EffectSites::of(&experiment.patch, &experiment.drives, library)?;
    if arguments.json {
        let visible = visible(arguments, experiment, library)?;
        return print_json(&gap_check::document(experiment, &places, &visible));
    }
    print(&gap_check::text(experiment, &places))?;
    print(&gap_check::limits_text(&visible(arguments, experiment, library)?, experiment, library))
}

/// Computes the weakest detectable effects.
///
/// # Errors
/// If the patch cannot be run with the data from any start.
fn visible(
    arguments: &Arguments,
    experiment: &Experiment,
    library: &Library,
) -> Result<Detectability, Failure> {
    let problem = Problem::of(experiment)?;
    let mut bar = ProgressBar::new("effects");
    bar.busy("fitting the patch to compute the weakest detectable effects");
    let SearchSettings { library, threads, seed } = means(arguments, library);
    let found = patchcord::ident::design::detectability::detectable_effects(
        &problem,
        &experiment.patch,
        &experiment.fit,
        library,
        threads,
        seed,
    );
    found?.ok_or_else(|| no_run_failure(experiment))
}

/// Runs the search with a progress bar.
fn run_search(
    arguments: &Arguments,
    experiment: &Experiment,
    library: &Library,
) -> Result<(Problem, Outcome), Failure> {
    let with = means(arguments, library);
    let problem = Problem::of(experiment)?;
    let mut bar = ProgressBar::new("effects");
    let progress = |at: Progress| show(&mut bar, at);
    let found =
        patchcord::ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, progress)?;
    let outcome = found.ok_or_else(|| no_run_failure(experiment))?;
    Ok((problem, outcome))
}
