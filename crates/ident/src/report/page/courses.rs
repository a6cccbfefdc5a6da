//! Pictures of what was measured, of what stages make of it, and of what they leave.

use crate::data::record::Record;
use crate::fit::estimate::Fitted;
use crate::fit::fitted_model::Stage;
use crate::fit::problem::Problem;
use crate::report::Report;
use crate::report::page::sheet;
use patchcord_draw::plot::{Axis, Channel, Picture, PlotError};

/// Pictures of what was measured and of what stages make of it, then of what they leave, of every output.
pub(super) fn pictures(report: &Report<'_>, stages: &[(&str, &Stage)]) -> Result<String, PlotError> {
    let outputs = (0..report.problem.outputs.len()).flat_map(|output| [(output, false), (output, true)]);
    sheet::pictures(outputs.flat_map(|(output, held)| {
        [courses(report, output, stages, held), left(report, output, stages, held)]
    }))
}

/// An output as it was measured, and as stages make it.
fn courses(report: &Report<'_>, output: usize, stages: &[(&str, &Stage)], held: bool) -> Picture {
    let name = &report.problem.outputs[output];
    let records = records(report.problem, held);
    let measured: Vec<&[f64]> = records.iter().map(|record| record.outputs[output].as_slice()).collect();
    let mut channels = vec![Channel::line("measured", along(records, &measured))];
    for (what, stage) in stages {
        let each = records.iter().zip(&fitted(stage, held).residuals);
        let made: Vec<Vec<f64>> =
            each.map(|(record, left)| report.problem.made(record, left, output)).collect();
        channels.push(Channel::line(*what, along(records, &made)));
    }
    let unit = report.experiment.outputs[output].unit.text();
    drawn(format!("{name}, {}", part(held)), (name, unit), channels)
}

/// What stages leave of an output, in noise.
fn left(report: &Report<'_>, output: usize, stages: &[(&str, &Stage)], held: bool) -> Picture {
    let records = records(report.problem, held);
    let channels = stages.iter().map(|(what, stage)| {
        let left: Vec<&[f64]> =
            fitted(stage, held).residuals.iter().map(|own| own[output].as_slice()).collect();
        Channel::line(*what, along(records, &left))
    });
    let title = format!("what is left of {}, {}", report.problem.outputs[output], part(held));
    drawn(title, ("measured less patch", "noise"), channels.collect())
}

fn records(problem: &Problem, held: bool) -> &[Record] {
    if held { &problem.test } else { &problem.train }
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
