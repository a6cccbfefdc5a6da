//! `patchcord gap`
//!
//! The command either checks the data (`--check`) or searches. A search with `--out` writes the report and the patches;
//! without it the JSON document contains the patches themselves.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{Failure, eprint_report};
use super::gap_files::{Folder, embed};
use super::numbers::{seed, threads};
use super::outputs::Outputs;
use super::progress::ProgressBar;
use super::standard_streams::check_input;
use super::{effects, gap_check, gap_report, print, print_json};
use patchcord::document::escape_controls;
use patchcord::ident::Experiment;
use patchcord::ident::design::detectability::{Detectability, detectable_effects};
use patchcord::ident::effects::Library;
use patchcord::ident::effects::effect_sites::EffectSites;
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::report::Report;
use patchcord::ident::report::check_document::CheckDocument;
use patchcord::ident::report::progress::{findings_text, phase_text};
use patchcord::ident::report::reasons::no_run_sentence;
use patchcord::ident::search::progress::Progress;
use patchcord::ident::search::{Outcome, SearchSettings, search};

#[derive(Args)]
pub(super) struct Arguments {
    /// Experiment file (JSON): the patch, the measured data, the parameters to fit; docs/gap.md shows an example
    experiment: PathBuf,
    /// Do not search. Check the data (sampling, missing samples, noise, resolution, bandwidth), list the places where
    /// effects can be wired in, and compute the weakest effects that the data would show
    #[arg(long, conflicts_with = "out")]
    check: bool,
    /// Write into this folder the report (report.html, report.json), the fitted patch (fitted.json), and the patch with
    /// the missing effect (augmented.json). If the effect is unknown, recovered.json is the patch with its force as a
    /// curve. If two effects cannot be distinguished, separate.csv is a drive that distinguishes them
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also use the effects of this folder: one in each .json file
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

/// Warnings about the data are printed before the search, because it may take minutes.
pub(super) fn gap(arguments: &Arguments) -> Result<(), Failure> {
    check_input(&arguments.experiment)?;
    let experiment = Experiment::read(&arguments.experiment)?;
    eprint_report(&experiment.warnings);
    let outputs = arguments.outputs(&experiment);
    outputs.check(&arguments.out)?;
    let library = effects::effect_library(arguments.effects.as_deref())?;
    let outputs = outputs.reading("an effect", library.files());
    if arguments.check {
        return check_data(arguments, &experiment, &library);
    }
    let folder = arguments.out.as_deref().map(|folder| Folder::prepare(folder, outputs)).transpose()?;
    let (problem, outcome) = run_search(arguments, &experiment, &library)?;
    let report = Report::new(&experiment, &problem, &outcome);
    let mut document = report.json();
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

impl Arguments {
    /// The outputs of a search. Effects are added when they have been read.
    fn outputs(&self, experiment: &Experiment) -> Outputs {
        Outputs::of_patch(Path::new(experiment.patch.file()), &experiment.patch)
            .reading("the experiment", [&self.experiment])
            .reading("a record", &experiment.files)
            .reading("the folder of effects", &self.effects)
    }
}

/// Shows the progress of a search and what it has found so far.
///
/// Work that cannot be counted is shown as text.
fn show(bar: &ProgressBar, progress: &Progress) {
    let text = phase_text(progress.phase, progress.round);
    bar.set_note(escape_controls(&findings_text(&progress.added, progress.best.as_ref())));
    match progress.total {
        0 => bar.busy(&text),
        total => {
            bar.switch_to(&text);
            bar.done(progress.done, total);
        }
    }
}

/// The settings of a search, with a thread for each core unless the arguments specify their number.
fn search_settings<'a>(arguments: &Arguments, library: &'a Library) -> SearchSettings<'a> {
    let settings = SearchSettings::new(library).with_seed(arguments.seed);
    arguments.threads.map_or(settings, |threads| settings.with_threads(threads))
}

/// The failure if no starting point gives a run.
fn no_run_failure(experiment: &Experiment) -> Failure {
    Failure::data(no_run_sentence(experiment.patch.file()))
}

/// Reports on the data before the slow fit, and then on the weakest detectable effects.
fn check_data(arguments: &Arguments, experiment: &Experiment, library: &Library) -> Result<(), Failure> {
    let sites = EffectSites::of(&experiment.patch, &experiment.drives, library)?;
    if arguments.json {
        let detectability = detectability(arguments, experiment, library)?;
        return print_json(&CheckDocument::of(experiment, &sites, &detectability).json());
    }
    print(&gap_check::text(experiment, &sites))?;
    let detectability = detectability(arguments, experiment, library)?;
    print(&gap_check::limits_text(experiment, &sites, &detectability, library))
}

/// Computes the weakest detectable effects.
///
/// # Errors
/// If the patch cannot be run with the data from any start.
fn detectability(
    arguments: &Arguments,
    experiment: &Experiment,
    library: &Library,
) -> Result<Detectability, Failure> {
    let problem = Problem::of(experiment)?;
    let _bar = ProgressBar::new("gap", "fitting the patch to compute the weakest detectable effects");
    let SearchSettings { library, threads, seed, .. } = search_settings(arguments, library);
    let found = detectable_effects(experiment, &problem, library, threads, seed)?;
    found.ok_or_else(|| no_run_failure(experiment))
}

/// Runs the search and reports its progress.
fn run_search(
    arguments: &Arguments,
    experiment: &Experiment,
    library: &Library,
) -> Result<(Problem, Outcome), Failure> {
    let settings = search_settings(arguments, library);
    let problem = Problem::of(experiment)?;
    let bar = ProgressBar::with_phases("gap", "fitting the patch");
    let found = search(experiment, &problem, &settings, |progress| show(&bar, &progress))?;
    let outcome = found.ok_or_else(|| no_run_failure(experiment))?;
    Ok((problem, outcome))
}
