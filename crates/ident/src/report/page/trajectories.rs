//! Pictures of measured and simulated outputs, and of residuals.
//!
//! Every output has four pictures: the trajectories and the residual, each for training and for validation. Several
//! models can be drawn in the same picture, for example before and after the search.

use crate::data::record::Record;
use crate::fit::estimate::FitResult;
use crate::fit::fitted_model::FittedModel;
use crate::fit::problem::Problem;
use crate::report::Report;
use crate::report::page::html_parts;
use maud::Markup;
use patchcord_draw::plot::{Axis, Channel, Picture, PlotError};

/// For every output: pictures of the measured and simulated trajectories and of the residual, in training and in
/// validation. `models` are labelled.
pub(super) fn pictures(report: &Report<'_>, models: &[(&str, &FittedModel)]) -> Result<Markup, PlotError> {
    let outputs = (0..report.problem.outputs.len()).flat_map(|output| [(output, false), (output, true)]);
    html_parts::pictures(outputs.flat_map(|(output, is_validation)| {
        [
            output_picture(report, output, models, is_validation),
            residual_picture(report, output, models, is_validation),
        ]
    }))
}

/// An output as measured and as simulated by each model, in its unit.
///
/// The trajectory of a model is datum minus residual times noise, so it has no value where a datum is missing.
fn output_picture(
    report: &Report<'_>,
    output: usize,
    models: &[(&str, &FittedModel)],
    is_validation: bool,
) -> Picture {
    let name = &report.problem.outputs[output];
    let records = records(report.problem, is_validation);
    let measured: Vec<&[f64]> = records.iter().map(|record| record.outputs[output].as_slice()).collect();
    let mut channels = vec![Channel::line("measured", points_over_time(records, &measured))];
    for (label, model) in models {
        let pairs = records.iter().zip(&fitted(model, is_validation).residuals);
        let simulated: Vec<Vec<f64>> =
            pairs.map(|(record, residual)| report.problem.model_output(record, residual, output)).collect();
        channels.push(Channel::line(*label, points_over_time(records, &simulated)));
    }
    let unit = report.experiment.outputs[output].unit.text();
    picture(format!("{name}, {}", part_name(is_validation)), (name, unit), channels)
}

/// The residual of an output for each model, over the noise.
fn residual_picture(
    report: &Report<'_>,
    output: usize,
    models: &[(&str, &FittedModel)],
    is_validation: bool,
) -> Picture {
    let records = records(report.problem, is_validation);
    let channels = models.iter().map(|(label, model)| {
        let residuals: Vec<&[f64]> =
            fitted(model, is_validation).residuals.iter().map(|record| record[output].as_slice()).collect();
        Channel::line(*label, points_over_time(records, &residuals))
    });
    let title = format!("residual of {}, {}", report.problem.outputs[output], part_name(is_validation));
    picture(title, ("measured - simulated", "noise"), channels.collect())
}

/// The training records, or the validation records if `is_validation`.
fn records(problem: &Problem, is_validation: bool) -> &[Record] {
    if is_validation { &problem.validation } else { &problem.train }
}

/// The fit of a model to the training records, or to the validation records if `is_validation`.
fn fitted(model: &FittedModel, is_validation: bool) -> &FitResult {
    if is_validation { &model.validation } else { &model.train }
}

/// The name of the part in titles of pictures.
fn part_name(is_validation: bool) -> &'static str {
    if is_validation { "validation" } else { "training" }
}

/// The points of tracks over time. A point that is not a number lifts the pen between records.
fn points_over_time(records: &[Record], tracks: &[impl AsRef<[f64]>]) -> Vec<(f64, f64)> {
    let mut points = Vec::new();
    for (record, track) in records.iter().zip(tracks) {
        let time = |sample: usize| record.begin + sample as f64 * record.interval;
        points.extend(track.as_ref().iter().enumerate().map(|(sample, value)| (time(sample), *value)));
        points.push((time(record.len()), f64::NAN));
    }
    points
}

/// A picture over time with axes that fit the channels.
fn picture(title: String, (label, unit): (&str, &str), channels: Vec<Channel>) -> Picture {
    let finite = || channels.iter().flat_map(|channel| &channel.points).filter(|point| point.1.is_finite());
    let horizontal = Axis::fit_tight("t", "s", finite().map(|point| point.0), Axis::HORIZONTAL_DIVISIONS);
    let vertical = Axis::fit(label, unit, finite().map(|point| point.1), Axis::VERTICAL_DIVISIONS);
    Picture { channels, ..Picture::new(title, horizontal, vertical) }
}
