//! The gap search on what others measured: `cargo bench --bench measured` searches every experiment of patches/measured whose
//! data are there, and writes what came of it into docs/measured.md; `-- NAME ...` searches some and writes nothing.

mod velocity;

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;
use std::{fs, thread};

use patchcord::ident::Experiment;
use patchcord::ident::effects::Library;
use patchcord::ident::fit::fitted_model::Stage;
use patchcord::ident::fit::problem::Problem;
use patchcord::ident::report::sentence::verdict_sentence;
use patchcord::ident::report::values::assignment_text;
use patchcord::ident::search::{Means, Outcome};
use patchcord::output;

const FOLDER: &str = "patches/measured";
const PAGE: &str = "docs/measured.md";
/// What stands on the page behind this comes from here.
const HEADING: &str = "## What the search says of them\n";
const INTRO: &str = "
From `cargo bench --bench measured`. Of a slide it tells the error in velocity, of the tanks the rms of what is left: of the
data it was fitted to, and of the test. *Rejected* are laws that others have proposed for them, with what they leave
in place of what was named first.

| experiment | what is said | as fitted | before | after | rejected | time |
|---|---|---|---|---|---|---|
";
/// What others have proposed.
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
            rows.push(row(&name, path)?);
            println!("{}", rows[rows.len() - 1]);
        }
    }
    if chosen.is_empty() {
        write(&rows)?;
    }
    Ok(())
}

/// What is said of an experiment.
fn row(name: &str, path: &Path) -> Result<String, Box<dyn Error>> {
    let experiment = Experiment::read(path).map_err(|error| error.to_string())?;
    let library = Library::shipped();
    let threads = thread::available_parallelism().map_or(1, usize::from);
    let with = Means { library: &library, threads, seed: 1 };
    let began = Instant::now();
    let problem = Problem::of(&experiment)?;
    let found =
        patchcord::ident::search::search(&problem, &experiment.patch, &experiment.fit, &with, |_| ())?;
    let found = found.ok_or(format!("{name} cannot be run"))?;
    let seconds = began.elapsed().as_secs_f64();
    let [before, after] = [&found.base, found.told()].map(|stage| told(&experiment, &problem, stage));
    let rejected = rejected(&found, |stage| told(&experiment, &problem, stage));
    Ok(format!(
        "| {name} | {} | {} | {before} | {after} | {rejected} | {seconds:.0} s |",
        verdict_sentence(&found),
        values(&found)
    ))
}

/// What was proposed and is not named, with what it leaves.
fn rejected(found: &Outcome, told: impl Fn(&Stage) -> String) -> String {
    let first = found.rounds.iter().find(|round| round.taken);
    let tried = |name: &&str| {
        let own = first?.trials.iter().find(|trial| trial.candidate.effect == *name)?;
        let is_named = found.effects.iter().any(|effect| effect.effect == *name);
        (!is_named).then(|| format!("{}: {}", own.named(), told(&own.stage)))
    };
    PROPOSED.iter().filter_map(tried).collect::<Vec<_>>().join("; ")
}

/// What was fitted in the end.
fn values(found: &Outcome) -> String {
    let stage = found.told();
    let all = (0..stage.version.fit.len()).map(|place| assignment_text(stage, place));
    all.collect::<Vec<_>>().join(", ")
}

/// What a patch leaves of what it was fitted to, and of the test: of a slide the error in velocity, else rms in the unit of
/// the output.
fn told(experiment: &Experiment, problem: &Problem, stage: &Stage) -> String {
    let mut text = String::new();
    let knobs = (stage.version.fit.as_slice(), stage.train.point.knobs.as_slice());
    let parts = [(&experiment.train, &stage.train), (&experiment.test, &stage.test)];
    for (place, (records, fitted)) in parts.into_iter().enumerate() {
        let own = match stage.version.patch().signals.contains_key("v") {
            true => velocity::error(experiment, stage.version.patch(), knobs, &records[0])
                .map(|share| format!("{:.2} %", 100.0 * share)),
            false => {
                Some(format!("{:.3} {}", fitted.over_noise() * problem.sigma[0], experiment.outputs[0].unit))
            }
        };
        let comma = if place == 0 { "" } else { " / " };
        let _ = write!(text, "{comma}{}", own.unwrap_or_else(|| "not run".to_owned()));
    }
    text
}

fn write(rows: &[String]) -> Result<(), Box<dyn Error>> {
    let text = fs::read_to_string(PAGE)?;
    let before = text.split_once(HEADING).map_or(text.as_str(), |(before, _)| before).trim_end();
    let page = format!("{before}\n\n{HEADING}{INTRO}{}\n", rows.join("\n"));
    Ok(output::write_whole(Path::new(PAGE), page.as_bytes())?)
}
