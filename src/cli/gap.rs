//! `patchcord gap`

use std::path::PathBuf;
use std::thread;

use clap::Args;
use serde_json::json;

use super::failure::{Failure, tell_report};
use super::files::check_not;
use super::gap_files::{Folder, embed};
use super::numbers::{seed, threads};
use super::progress::Bar;
use super::{effects, gap_check, gap_report, say, say_json};
use patchcord::ident::Experiment;
use patchcord::ident::design::detectability::Visible;
use patchcord::ident::effects::Library;
use patchcord::ident::effects::places::Places;
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::report::Report;
use patchcord::ident::report::document::ExperimentDocument;
use patchcord::ident::search::progress::{Part, Progress};
use patchcord::ident::search::{Means, Outcome};

#[derive(Args)]
pub(super) struct Arguments {
    /// Experiment file (JSON): a patch, what was measured, what may be fitted; docs/gap.md shows one
    experiment: PathBuf,
    /// Only check the data (sampling, gaps, noise, steps of the recorder, how fast columns move), tell where effects would be tried,
    /// and from which strength on these data could show them
    #[arg(long, conflicts_with = "out")]
    check: bool,
    /// Write into this folder the report (report.html, report.json), the patch as fitted (fitted.json) and with what is missing in
    /// it (augmented.json); where that has no name, with its force as a curve instead (recovered.json); where the data cannot tell
    /// two effects apart, the drive that would, with what either predicts (separate.csv)
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Take the effects of this folder as well: every .json file in it
    #[arg(long, value_name = "DIR")]
    effects: Option<PathBuf>,
    /// Draw the points from which the patch is fitted by this number
    #[arg(long, value_name = "NUMBER", default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// How many effects are tried at the same time; as many as there are cores where it is not given
    #[arg(long, value_name = "NUMBER", value_parser = threads, allow_negative_numbers = true)]
    threads: Option<usize>,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

pub(super) fn gap(arguments: &Arguments) -> Result<(), Failure> {
    carried_out(arguments).map_err(|failure| failure.told_as_json(arguments.json))
}

fn carried_out(arguments: &Arguments) -> Result<(), Failure> {
    let experiment = Experiment::read(&arguments.experiment)?;
    tell_report(&experiment.warnings);
    if let (Some(effects), Some(out)) = (&arguments.effects, &arguments.out) {
        check_not("the folder of effects", effects, [out].into_iter())?;
    }
    let library = effects::known(arguments.effects.as_deref())?;
    if arguments.check {
        return checked(arguments, &experiment, &library);
    }
    let folder = arguments.out.as_deref().map(|folder| Folder::prepare(folder, &experiment)).transpose()?;
    let (problem, outcome) = searched(arguments, &experiment, &library)?;
    let report = Report::new(&experiment, &problem, &outcome);
    let mut document = report.json();
    document["doubts"] = report.doubts().into();
    document["experiment"] = json!(ExperimentDocument::of(&experiment, &problem, arguments.seed));
    let done = match folder {
        Some(folder) => folder.write(&report, &library, &mut document).map(|done| format!("\n{done}")),
        None => embed(&report, &mut document).map(|()| String::new()),
    };
    // What a search of minutes found is told, whether or not there is room for its files.
    if arguments.json {
        say_json(&document)?;
        return done.map(|_| ());
    }
    say(&gap_report::told(&report))?;
    say(&done?)
}

/// What a search is doing, in words.
fn doing(at: Progress) -> String {
    match at.part {
        Part::Base => "fitting the patch as it is".to_owned(),
        Part::Quick => format!("effects looked at quickly, round {}", at.round),
        Part::Full => format!("of the best gone through with, round {}", at.round),
        Part::Growing => format!("of the best fitted step by step, round {}", at.round),
        Part::Where => "looking for where and when something is missing".to_owned(),
    }
}

fn tell(bar: &mut Bar, at: Progress) {
    let words = doing(at);
    match at.all {
        0 => bar.busy(&words),
        all => {
            bar.turn_to(&words);
            bar.done(at.done, all);
        }
    }
}

fn means<'a>(arguments: &Arguments, library: &'a Library) -> Means<'a> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    Means { library, threads: arguments.threads.unwrap_or(cores), seed: arguments.seed }
}

fn not_run(experiment: &Experiment) -> Failure {
    Failure::data(format!(
        "{} cannot be run beside the data from any of the points tried: look at its scales and at the ranges of what is fitted, or let runs begin anew, by \"pieces\" in the experiment",
        experiment.patch.file()
    ))
}

/// Tells what the data are like before the patch is fitted, and then what they could show beside it.
fn checked(arguments: &Arguments, experiment: &Experiment, library: &Library) -> Result<(), Failure> {
    let places = Places::of(&experiment.patch, &experiment.drives, library)?;
    if arguments.json {
        let visible = visible(arguments, experiment, library)?;
        return say_json(&gap_check::document(experiment, &places, &visible));
    }
    say(&gap_check::told(experiment, &places))?;
    say(&gap_check::shows(&visible(arguments, experiment, library)?, experiment, library))
}

fn visible(arguments: &Arguments, experiment: &Experiment, library: &Library) -> Result<Visible, Failure> {
    let problem = Problem::of(experiment)?;
    let mut bar = Bar::new("effects");
    bar.iter_mut().for_each(|bar| bar.busy("fitting the patch, to see what the data could show beside it"));
    let Means { library, threads, seed } = means(arguments, library);
    let found = patchcord::ident::design::detectability::visible_effects(
        &problem,
        &experiment.patch,
        &experiment.fit,
        library,
        threads,
        seed,
    );
    found?.ok_or_else(|| not_run(experiment))
}

fn searched(
    arguments: &Arguments,
    experiment: &Experiment,
    library: &Library,
) -> Result<(Problem, Outcome), Failure> {
    let with = means(arguments, library);
    let problem = Problem::of(experiment)?;
    let mut bar = Bar::new("effects");
    let progress = |at: Progress| bar.iter_mut().for_each(|bar| tell(bar, at));
    let found =
        patchcord::ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, progress)?;
    let outcome = found.ok_or_else(|| not_run(experiment))?;
    Ok((problem, outcome))
}
