//! What a search did, step by step, with pictures: one HTML file that needs no other.

use super::effect::Library;
use super::experiment::Experiment;
use super::fit::Fitted;
use super::record::Record;
use super::search::{Outcome, Round, Trial, Verdict};
use super::stage::{Problem, Stage};
use crate::html::{self, escaped};
use crate::instruments::Display;
use crate::plot::{self, Axis, Channel, Format, Picture, PlotError, Size};

/// The size of a picture.
const SIZE: Size = Size { width: 900, height: 420 };

/// What a page is made of.
#[derive(Debug, Clone, Copy)]
pub struct Told<'a> {
    /// What was asked.
    pub experiment: &'a Experiment,
    /// What the patch was held against.
    pub problem: &'a Problem,
    /// What was found.
    pub outcome: &'a Outcome,
    /// The effects that were tried.
    pub library: &'a Library,
}

/// The page.
///
/// # Errors
/// When a picture cannot be drawn.
pub fn page(told: &Told<'_>) -> Result<String, PlotError> {
    let title = match told.experiment.title.as_str() {
        "" => &told.experiment.file,
        title => title,
    };
    let mut body = format!(
        "<header>\n<h1>{}</h1>\n<p class=\"verdict\">{}</p>\n<p>{}</p>\n</header>\n<main>\n",
        escaped(title),
        escaped(&told.outcome.sentence()),
        escaped(&in_short(told))
    );
    body += &measured(told);
    body += &base(told)?;
    for (number, round) in told.outcome.rounds.iter().enumerate() {
        body += &told.round(number + 1, round)?;
    }
    body += &end(told)?;
    body += "</main>\n";
    Ok(html::page(title, &body))
}

fn number(value: f64) -> String {
    Display::new("", 1.0).number(value)
}

/// What is left, rms over the noise.
fn over_noise(fitted: &Fitted) -> String {
    number(fitted.over_noise())
}

fn in_short(told: &Told<'_>) -> String {
    let Outcome { base, .. } = told.outcome;
    let after = told.outcome.told();
    let gap = |stage: &Stage| {
        format!(
            "{} times the noise in training, {} on data held back",
            over_noise(&stage.train),
            over_noise(&stage.test)
        )
    };
    match told.outcome.verdict {
        Verdict::Named | Verdict::Ambiguous => {
            format!(
                "The patch as it was leaves {}. With what is missing it leaves {}.",
                gap(base),
                gap(after)
            )
        }
        Verdict::NothingMissing => format!("What the patch leaves looks like noise: {}.", gap(base)),
        _ => format!("The patch leaves {}, and that does not look like noise.", gap(base)),
    }
}

/// A table of rows under headings; cells that are numbers stand to the right.
fn table(headings: &[&str], rows: impl Iterator<Item = (bool, Vec<String>)>) -> String {
    let head: String = headings.iter().map(|heading| format!("<th>{heading}")).collect();
    let cell = |text: &String| {
        let class = if text.parse::<f64>().is_ok() { " class=\"number\"" } else { "" };
        format!("<td{class}>{text}")
    };
    let row = |(is_first, cells): (bool, Vec<String>)| {
        let class = if is_first { " class=\"first\"" } else { "" };
        format!("<tr{class}>{}</tr>\n", cells.iter().map(cell).collect::<String>())
    };
    format!("<table class=\"narrow\">\n<tr>{head}</tr>\n{}</table>\n", rows.map(row).collect::<String>())
}

fn measured(told: &Told<'_>) -> String {
    let Told { experiment, problem, .. } = told;
    let outputs = experiment.outputs.iter().zip(&problem.sigma).map(|(output, sigma)| {
        let whence = if output.sigma.is_some() { "told" } else { "estimated without a model" };
        let cells =
            [&output.signal, &output.column, &number(*sigma), output.unit.text(), whence].map(escaped_text);
        (false, cells.to_vec())
    });
    let records = [("training", &experiment.train), ("held back", &experiment.test)];
    let records =
        records.into_iter().flat_map(|(used, records)| records.iter().map(move |record| (used, record)));
    let records = records.map(|(used, record)| {
        let ends = format!("{} ... {} s", number(record.begin), number(record.begin + record.duration()));
        let every = format!("every {} s", number(record.interval));
        (false, vec![escaped(&record.name), used.to_owned(), ends, record.len().to_string(), every])
    });
    format!(
        "<section>\n<h2>What was measured</h2>\n{}{}</section>\n",
        table(&["signal", "column", "noise", "unit", "whence"], outputs),
        table(&["file", "for", "from ... to", "samples", ""], records)
    )
}

fn escaped_text(text: impl AsRef<str>) -> String {
    escaped(text.as_ref())
}

/// The parameters of a stage as they were fitted.
fn parameters(stage: &Stage) -> String {
    let rows = stage.version.fit.iter().enumerate().map(|(place, name)| {
        let known = stage.version.patch.parameters.get(name);
        let (unit, what) = known.map_or(("1", ""), |own| (own.unit.text(), own.description.as_str()));
        let [value, error] = [stage.train.point.knobs[place], stage.error(place)].map(number);
        (false, vec![escaped(name), value, error, escaped(unit), escaped(what)])
    });
    table(&["fitted", "value", "standard error", "unit", "what it is"], rows)
}

fn base(told: &Told<'_>) -> Result<String, PlotError> {
    let stage = &told.outcome.base;
    Ok(format!(
        "<section>\n<h2>The patch as it is</h2>\n<p>{} is fitted to the training data: its parameters, and the voltages with which its integrators begin. \
         What it leaves is {} times the noise (rms); on the data held back, where only those voltages are fitted, {}.</p>\n{}{}</section>\n",
        escaped(told.experiment.patch.file()),
        over_noise(&stage.train),
        over_noise(&stage.test),
        parameters(stage),
        told.pictures(&[("the patch as it is", stage)])?
    ))
}

impl Told<'_> {
    fn round(&self, place: usize, round: &Round) -> Result<String, PlotError> {
        let Some(best) = round.trials.first() else { return Ok(String::new()) };
        let mut text = format!(
            "<section>\n<h2>Round {place}: {} effects and places tried</h2>\n<p class=\"reading\">{}</p>\n",
            round.trials.len(),
            escaped(&judged(round, best))
        );
        if let Some(effect) = self.library.get(&best.candidate.effect) {
            let (title, physics, law) = (&effect.title, &effect.physics, &effect.law);
            text += &format!(
                "<p><b>{}</b>. {} <code>{}</code></p>\n",
                escaped(title),
                escaped(physics),
                escaped(law)
            );
        }
        text += &self.pictures(&[("before", &round.before), (&best.named(), &best.stage)])?;
        let most = round.before.train.chi2;
        let rows = round.trials.iter().enumerate().map(|(rank, trial)| {
            let share = 100.0 * (trial.stage.train.chi2 / most).sqrt().min(1.0);
            let bar = format!(
                "<span class=\"lane\"><span class=\"bar\" style=\"width:{share:.1}%\"></span></span>"
            );
            let cells = vec![
                escaped(&trial.candidate.effect),
                escaped(&trial.candidate.junction),
                escaped(&trial.candidate.reads.join(", ")),
                number(trial.score),
                bar,
                over_noise(&trial.stage.train),
                over_noise(&trial.stage.test),
                escaped(&remark(round, rank, trial)),
            ];
            (rank == 0, cells)
        });
        let headings =
            ["effect", "at", "reads", "score", "gap that is left", "training", "held back", "why not"];
        text += &format!(
            "<details open><summary>All of them; a score of {} is needed</summary>\n{}</details>\n</section>\n",
            number(round.needed),
            table(&headings, rows)
        );
        Ok(text)
    }

    /// Pictures of what was measured and of what stages make of it, then of what they leave, of every output.
    fn pictures(&self, stages: &[(&str, &Stage)]) -> Result<String, PlotError> {
        let mut text = "<div class=\"pictures\">\n".to_owned();
        for output in 0..self.problem.outputs.len() {
            for held in [false, true] {
                for picture in [self.courses(output, stages, held), self.left(output, stages, held)] {
                    let drawn = plot::render(&[picture], Format::Svg, SIZE)?;
                    let drawn = String::from_utf8_lossy(&drawn);
                    let from = drawn.find("<svg").unwrap_or_default();
                    text += "<figure>";
                    text += &drawn[from..].replacen("<svg", "<svg class=\"picture\"", 1);
                    text += "</figure>\n";
                }
            }
        }
        Ok(text + "</div>\n")
    }

    /// An output as it was measured, and as stages make it.
    fn courses(&self, output: usize, stages: &[(&str, &Stage)], held: bool) -> Picture {
        let (name, sigma) = (&self.problem.outputs[output], self.problem.sigma[output]);
        let records = self.records(held);
        let measured: Vec<&[f64]> = records.iter().map(|record| record.outputs[output].as_slice()).collect();
        let mut channels = vec![Channel::line("measured", along(records, &measured))];
        for (what, stage) in stages {
            let made: Vec<Vec<f64>> = measured
                .iter()
                .zip(&fitted(stage, held).residuals)
                .map(|(data, left)| {
                    data.iter().zip(&left[output]).map(|(datum, left)| datum - left * sigma).collect()
                })
                .collect();
            channels.push(Channel::line(*what, along(records, &made)));
        }
        let unit = self.experiment.outputs[output].unit.text();
        drawn(format!("{name}, {}", part(held)), (name, unit), channels)
    }

    /// What stages leave of an output, in noise.
    fn left(&self, output: usize, stages: &[(&str, &Stage)], held: bool) -> Picture {
        let records = self.records(held);
        let channels = stages.iter().map(|(what, stage)| {
            let left: Vec<&[f64]> =
                fitted(stage, held).residuals.iter().map(|own| own[output].as_slice()).collect();
            Channel::line(*what, along(records, &left))
        });
        let title = format!("what is left of {}, {}", self.problem.outputs[output], part(held));
        drawn(title, ("measured less patch", "noise"), channels.collect())
    }

    fn records(&self, held: bool) -> &[Record] {
        if held { &self.problem.test } else { &self.problem.train }
    }
}

fn fitted(stage: &Stage, held: bool) -> &Fitted {
    if held { &stage.test } else { &stage.train }
}

fn part(held: bool) -> &'static str {
    if held { "held back" } else { "training" }
}

/// Points over time; the pen is lifted between records.
fn along(records: &[Record], tracks: &[impl AsRef<[f64]>]) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for (record, track) in records.iter().zip(tracks) {
        let time = |sample: usize| record.begin + sample as f64 * record.interval;
        points.extend(track.as_ref().iter().enumerate().map(|(sample, value)| (time(sample), *value)));
        points.push((time(record.len()), f64::NAN));
    }
    points
}

fn drawn(title: String, (label, unit): (&str, &str), channels: Vec<Channel>) -> Picture {
    let there = || channels.iter().flat_map(|channel| &channel.points).filter(|point| point.1.is_finite());
    let horizontal = Axis::snug("t", "s", there().map(|point| point.0), Axis::ACROSS);
    let vertical = Axis::fit(label, unit, there().map(|point| point.1), Axis::UP);
    Picture { channels, ..Picture::new(title, horizontal, vertical) }
}

/// What a round came to.
fn judged(round: &Round, best: &Trial) -> String {
    let held = format!(
        "on the data held back it lowers the sum of squares, in those of the noise, by {} ± {}",
        number(round.confirmed.sum),
        number(round.confirmed.error)
    );
    let score = format!("{} is the best, with a score of {}", best.named(), number(best.score));
    match (round.taken, round.tied) {
        (true, 1) => format!("{score}; {held}. It is taken."),
        (true, tied) => format!(
            "{score}; {held}. It is taken, although the data cannot tell it from {} others.",
            tied - 1
        ),
        (false, _) if best.score <= round.needed => {
            format!(
                "{score}, which is less than the {} that so many trials ask for. None is taken.",
                number(round.needed)
            )
        }
        (false, _) => format!("{score}; but {held}, which is no evidence. None is taken."),
    }
}

/// Why a trial is not the one.
fn remark(round: &Round, rank: usize, trial: &Trial) -> String {
    if rank == 0 {
        return if round.taken { "taken".to_owned() } else { String::new() };
    }
    if round.is_tied(trial) {
        return "the data cannot tell it from the first".to_owned();
    }
    if trial.score <= round.needed {
        return "explains too little".to_owned();
    }
    format!("behind by {} ± {}", number(trial.behind.sum), number(trial.behind.error))
}

fn end(told: &Told<'_>) -> Result<String, PlotError> {
    let (base, last) = (&told.outcome.base, told.outcome.told());
    let mut text = "<section>\n<h2>Before and after</h2>\n".to_owned();
    let rows = [("before", base), ("after", last)].map(|(what, stage)| {
        let cells = [over_noise(&stage.train), over_noise(&stage.test), number(stage.colour)];
        (false, [what.to_owned()].into_iter().chain(cells).collect())
    });
    text += &table(
        &["gap over noise, rms", "training", "held back", "distance from white, in standard deviations"],
        rows.into_iter(),
    );
    if matches!(told.outcome.verdict, Verdict::Named | Verdict::Ambiguous) {
        text += &parameters(last);
        // After one round the same pictures stand there.
        if told.outcome.rounds.iter().filter(|round| round.taken).count() > 1 {
            text += &told.pictures(&[("before", base), ("after", last)])?;
        }
        text += "<p>The patch with what was missing is <a href=\"augmented.json\">augmented.json</a>: \
                 <code>patchcord run augmented.json</code> runs it, <code>patchcord draw augmented.json</code> draws it.</p>\n";
    }
    Ok(text + "</section>\n")
}
