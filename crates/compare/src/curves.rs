//! The curves of a simulation: data, simulation and residual of every output, thinned for a picture.
//!
//! A long record has more samples than a picture has columns. Its curves have the minimum and the maximum of every
//! column, so that no peak is lost.

use std::ops::Range;

use patchcord_expr::round_significant;
use patchcord_ident::{Experiment, Problem, Record};

use crate::event::{OutputCurves, RecordCurves};
use crate::limits::MAX_CURVE_POINTS;
use crate::whole_runs::Outputs;

/// Digits of values. A picture shows fewer.
const DIGITS: usize = 5;
/// Digits of times. A record may begin late, so its times need more digits than its values.
const TIME_DIGITS: usize = 10;

/// The curves of all outputs. `simulated` has one entry for each record: training, then validation.
pub(crate) fn curves(experiment: &Experiment, problem: &Problem, simulated: &[Outputs]) -> Vec<OutputCurves> {
    let count = experiment.outputs.len();
    (0..count).map(|output| output_curves(experiment, problem, simulated, output)).collect()
}

/// The curves of one output.
fn output_curves(
    experiment: &Experiment,
    problem: &Problem,
    simulated: &[Outputs],
    output: usize,
) -> OutputCurves {
    let measured = &experiment.outputs[output];
    let records = || experiment.train.iter().chain(&experiment.validation).zip(simulated);
    let difference = |(record, simulated): (&Record, &Outputs)| -> Vec<f64> {
        let pairs = record.outputs[output].iter().zip(&simulated[output]);
        pairs.map(|(datum, value)| datum - value).collect()
    };
    let mut residuals: Vec<Vec<f64>> = records().map(difference).collect();
    let offset = measured.has_offset.then(|| mean(residuals.iter().flatten().copied())).flatten();
    if let Some(offset) = offset {
        residuals.iter_mut().flatten().for_each(|residual| *residual -= offset);
    }
    let mean_square = mean(residuals.iter().flatten().map(|residual| residual * residual));
    let each = records().zip(&residuals).enumerate();
    let record_curves = each.map(|(index, ((record, simulated), residual))| {
        let series = [&record.outputs[output], &simulated[output], residual];
        record_curves(record, index >= experiment.train.len(), series)
    });
    OutputCurves {
        signal: measured.signal.clone(),
        unit: measured.unit.text().to_owned(),
        records: record_curves.collect(),
        rms: mean_square.map(|square| rounded(square.sqrt())),
        noise: experiment.has_known_noise(output).then(|| rounded(problem.sigma[output])),
        offset: offset.map(rounded),
    }
}

/// The curves of an output in a record. `series` are the data, the simulation and the residual.
fn record_curves(record: &Record, test: bool, series: [&Vec<f64>; 3]) -> RecordCurves {
    let count = record.len();
    let time = |sample: usize| round_significant(record.begin + sample as f64 * record.interval, TIME_DIGITS);
    let (curves, time): ([Vec<f64>; 3], Vec<f64>) = if count <= MAX_CURVE_POINTS {
        let all = series.map(|samples| samples.iter().copied().map(rounded).collect());
        (all, (0..count).map(time).collect())
    } else {
        let columns = || picture_columns(count);
        let thinned = series.map(|samples| columns().flat_map(|range| extremes(&samples[range])).collect());
        (thinned, columns().flat_map(|range| [time(range.start), time(range.end - 1)]).collect())
    };
    let [measured, simulated, residual] = curves;
    RecordCurves { name: record.name.clone(), test, time, measured, simulated, residual }
}

/// The samples of each column of a picture. Every column has at least two samples, because there are more than
/// [`MAX_CURVE_POINTS`].
fn picture_columns(count: usize) -> impl Iterator<Item = Range<usize>> {
    let columns = MAX_CURVE_POINTS / 2;
    (0..columns).map(move |column| column * count / columns..(column + 1) * count / columns)
}

/// The least and the largest of some samples, in the order of time. Both are not a number if all samples are missing.
fn extremes(samples: &[f64]) -> [f64; 2] {
    let present = || samples.iter().enumerate().filter(|(_, sample)| !sample.is_nan());
    let least = present().min_by(|a, b| a.1.total_cmp(b.1));
    let most = present().max_by(|a, b| a.1.total_cmp(b.1));
    let (Some((first, least)), Some((last, most))) = (least, most) else { return [f64::NAN; 2] };
    let in_order = if first <= last { [*least, *most] } else { [*most, *least] };
    in_order.map(rounded)
}

/// The mean of the numbers that are not missing. None if there are none.
fn mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_u32);
    for number in numbers.filter(|number| !number.is_nan()) {
        (sum, count) = (sum + number, count + 1);
    }
    (count > 0).then(|| sum / f64::from(count))
}

/// A value with the digits of a picture.
fn rounded(value: f64) -> f64 {
    round_significant(value, DIGITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record of one output at these samples, every half second from 10 s.
    fn record(samples: Vec<f64>) -> Record {
        Record {
            name: "a.csv".to_owned(),
            begin: 10.0,
            start_in_file: 0.0,
            interval: 0.5,
            jitter: 0.0,
            drives: Vec::new(),
            outputs: vec![samples],
        }
    }

    #[test]
    fn a_short_record_keeps_its_samples() {
        let (data, model, residual) = (vec![1.0, f64::NAN, 3.0], vec![0.5; 3], vec![0.5, f64::NAN, 2.5]);
        let curves = record_curves(&record(data.clone()), true, [&data, &model, &residual]);
        assert_eq!((curves.time, curves.simulated), (vec![10.0, 10.5, 11.0], vec![0.5; 3]));
        assert!(curves.test && curves.name == "a.csv");
        assert!(curves.measured[1].is_nan() && curves.residual[1].is_nan());
        assert_eq!(curves.residual[2], 2.5);
    }

    #[test]
    fn a_long_record_keeps_its_peaks() {
        let mut data: Vec<f64> = (0..10_000).map(|sample| (f64::from(sample) * 0.01).sin()).collect();
        (data[4567], data[4568], data[7004]) = (50.0, -50.0, f64::NAN);
        let curves = record_curves(&record(data.clone()), false, [&data, &data, &data]);
        assert_eq!((curves.time.len(), curves.measured.len()), (2000, 2000));
        let peak = curves.measured.iter().position(|value| *value == 50.0).unwrap();
        assert_eq!(curves.measured[peak + 1], -50.0, "the order of time");
        // Sample 4567 is in column 456, which has the samples 4560 to 4569.
        assert_eq!((peak, curves.time[peak], curves.time[peak + 1]), (912, 2290.0, 2294.5));
        assert!(curves.time.is_sorted() && curves.measured.iter().all(|value| value.is_finite()));
    }

    #[test]
    fn a_column_without_data_is_missing() {
        let data = vec![f64::NAN; 4000];
        let curves = record_curves(&record(data.clone()), false, [&data, &data, &data]);
        assert!(curves.measured.len() == 2000 && curves.measured.iter().all(|value| value.is_nan()));
        assert_eq!(mean(data.into_iter()), None);
    }

    #[test]
    fn means_ignore_missing_samples() {
        assert_eq!(mean([1.0, f64::NAN, 2.0].into_iter()), Some(1.5));
        assert_eq!(rounded(1.0 / 3.0), 0.33333);
    }
}
