//! `patchcord gap`

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::thread;

use clap::Args;
use serde_json::Value;

use super::failure::{Failure, tell_report};
use super::files::{prepare, put};
use super::progress::Bar;
use super::{effects, gap_check, gap_report, say, say_json};
use patchcord::gap::Experiment;
use patchcord::gap::effect::Library;
use patchcord::gap::page::{self, Told};
use patchcord::gap::search::{Means, Outcome};
use patchcord::gap::stage::Problem;

#[derive(Args)]
pub(super) struct Arguments {
    /// Experiment file (JSON): a patch, what was measured, what may be fitted; docs/gap.md shows one
    experiment: PathBuf,
    /// Only check the data: sampling, gaps, noise, steps of the recorder, how fast columns move
    #[arg(long, conflicts_with_all = ["out", "effects", "seed", "threads"])]
    check: bool,
    /// Write the patch with what was missing (augmented.json) and the report (report.html, report.json) into this folder; where it
    /// has no name, the patch with its force as a curve (recovered.json), too
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Take the effects of this folder as well: every .json file in it
    #[arg(long, value_name = "DIR")]
    effects: Option<PathBuf>,
    /// Draw the points from which the patch is fitted by this number
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    seed: u64,
    /// How many effects are tried at the same time; as many as there are cores where it is not given
    #[arg(long, value_name = "NUMBER")]
    threads: Option<NonZeroUsize>,
    /// Print one JSON document on standard output, and nothing else there
    #[arg(long)]
    json: bool,
}

/// The files that a search leaves.
const AUGMENTED: &str = "augmented.json";
const REPORT: &str = "report.json";
const PAGE: &str = "report.html";
const RECOVERED: &str = "recovered.json";

pub(super) fn gap(arguments: &Arguments) -> Result<(), Failure> {
    carried_out(arguments).map_err(|failure| failure.told_as_json(arguments.json))
}

fn carried_out(arguments: &Arguments) -> Result<(), Failure> {
    let experiment = Experiment::read(&arguments.experiment)?;
    tell_report(&experiment.warnings);
    if arguments.check {
        return match arguments.json {
            true => say_json(&gap_check::document(&experiment)),
            false => say(&gap_check::told(&experiment)),
        };
    }
    let files = [AUGMENTED, REPORT, PAGE, RECOVERED];
    let paths = arguments.out.as_ref().map(|folder| files.map(|file| folder.join(file)));
    prepare(arguments.out.as_deref(), paths.iter().flatten())?;
    let library = effects::known(arguments.effects.as_deref())?;
    let (problem, outcome) = searched(arguments, &experiment, &library)?;
    let mut document = outcome.document(&problem);
    let mut wrote: Vec<&PathBuf> = Vec::new();
    if let Some([augmented, report, page, recovered]) = &paths {
        let patch = outcome.patch(AUGMENTED).map_err(|error| Failure::data(error.to_string()))?;
        put(augmented, patch.text().as_bytes())?;
        document["patch"] = Value::from(augmented.display().to_string());
        wrote.extend([augmented, report, page]);
        if let Some(patch) = outcome.recovered() {
            put(recovered, patch.text().as_bytes())?;
            document["recovered"] = Value::from(recovered.display().to_string());
            wrote.push(recovered);
        }
        put(report, format!("{document:#}\n").as_bytes())?;
        let told = Told { experiment: &experiment, problem: &problem, outcome: &outcome, library: &library };
        put(page, page::page(&told).map_err(|error| Failure::data(error.to_string()))?.as_bytes())?;
    }
    if arguments.json {
        return say_json(&document);
    }
    let wrote = wrote.into_iter().map(|path| format!("wrote {}\n", path.display()));
    say(&format!("{}{}", gap_report::told(&experiment, &problem, &outcome), wrote.collect::<String>()))
}

fn searched(
    arguments: &Arguments,
    experiment: &Experiment,
    library: &Library,
) -> Result<(Problem, Outcome), Failure> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let with = Means { library, threads: arguments.threads.map_or(cores, usize::from), seed: arguments.seed };
    let failed = |error: patchcord::gap::model::ModelError| Failure::data(error.to_string());
    let problem = Problem::of(experiment).map_err(failed)?;
    let mut bar = Bar::new("effects tried");
    let tell = |done: u64, all: u64| bar.iter_mut().for_each(|bar| bar.done(done, all));
    let found = problem.search(&experiment.patch, &experiment.fit, &with, tell).map_err(failed)?;
    let outcome = found.ok_or_else(|| {
        Failure::data(format!(
            "{} cannot be run beside the data from any of the points tried: look at its scales and at the ranges of what is fitted",
            experiment.patch.file()
        ))
    })?;
    Ok((problem, outcome))
}
