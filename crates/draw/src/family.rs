//! Labels for a family of curves: the parameters that distinguish the runs of a trace.

use indexmap::IndexMap;

use crate::picture_data::PointSource;
use patchcord_analysis::format::QuantityFormat;
use patchcord_core::trace::{PhaseKind, Trace};

/// The maximum number of labelled runs; labels of more runs would not be readable.
const MAX_RUNS: usize = 50;

/// Returns the labels of the runs, each with the index of the last point of its run.
///
/// A label contains the parameters that differ between runs, with their values in operate and hold:
/// `k = 10, then 20 N/m`. Consecutive runs with the same label share one, at the last of them. The list
/// is empty if all runs are equal or if there are more than [`MAX_RUNS`].
pub(super) fn labels(trace: &Trace, points: &PointSource<'_>) -> Vec<(usize, String)> {
    if trace.repetitions.len() > MAX_RUNS {
        return Vec::new();
    }
    let runs = runs(trace);
    let differs = |name: &str| runs.iter().any(|run| run.get(name) != runs[0].get(name));
    let label = |run: &IndexMap<&str, ValueSequence<'_>>| {
        let texts = run.iter().filter(|(name, _)| differs(name)).map(|(name, values)| values.label(name));
        texts.collect::<Vec<_>>().join(", ")
    };
    let ends = points.begins.iter().skip(1).copied().chain([points.time.len()]);
    let labels: Vec<_> = ends.zip(runs.iter().map(label)).enumerate().collect();
    let groups = labels.chunk_by(|(_, one), (_, next)| one.1 == next.1);
    groups.filter(|runs| !runs[0].1.1.is_empty()).filter_map(label_of).collect()
}

/// Returns the common label of consecutive runs; `runs` are their indices, ends and labels.
fn label_of(runs: &[(usize, (usize, String))]) -> Option<(usize, String)> {
    let (first, (last, (end, label))) = (runs.first()?.0 + 1, runs.last()?);
    let suffix = if runs.len() > 1 { format!(", runs {first} to {}", last + 1) } else { String::new() };
    Some((end.saturating_sub(1), format!("{label}{suffix}")))
}

/// The values of a parameter in a run, one after the other, in its unit.
#[derive(Debug, PartialEq)]
struct ValueSequence<'t> {
    /// The text of the unit in which the patch declares the parameter.
    unit: &'t str,
    /// The values in order of time; consecutive equal values are listed once.
    values: Vec<f64>,
}

impl ValueSequence<'_> {
    /// Formats the values: `k = 10, then 20 N/m`.
    fn label(&self, name: &str) -> String {
        let largest = self.values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let display = QuantityFormat::new(self.unit, largest);
        let numbers: Vec<_> = self.values.iter().map(|value| display.number(*value)).collect();
        format!("{name} = {} {}", numbers.join(", then "), display.unit).trim_end().to_owned()
    }
}

/// Returns, for each run, the values of the parameters that phases set.
///
/// Only values in operate and hold count, because time advances only then.
fn runs(trace: &Trace) -> Vec<IndexMap<&str, ValueSequence<'_>>> {
    let mut now: IndexMap<&str, (&str, f64)> = IndexMap::new();
    for new in trace.phase_records.iter().flat_map(|record| record.phase.new_values()) {
        now.entry(&new.parameter).or_insert((&new.unit, new.before));
    }
    let mut runs: Vec<IndexMap<&str, ValueSequence<'_>>> = Vec::new();
    for record in &trace.phase_records {
        for new in record.phase.new_values() {
            now.insert(&new.parameter, (&new.unit, new.value));
        }
        if !matches!(record.phase, PhaseKind::Operate { .. } | PhaseKind::Hold) {
            continue;
        }
        runs.resize_with(runs.len().max(record.repetition + 1), IndexMap::new);
        for (name, (unit, value)) in &now {
            let values =
                runs[record.repetition].entry(*name).or_insert(ValueSequence { unit, values: Vec::new() });
            if values.values.last() != Some(value) {
                values.values.push(*value);
            }
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::trace::{NewValue, PhaseEnd, PhaseRecord, Repetition};

    const OPERATE: PhaseKind = PhaseKind::Operate { until: None };

    fn set(name: &str, before: f64, value: f64) -> PhaseKind {
        let unit = "N/m".to_owned();
        PhaseKind::Set(vec![NewValue { parameter: name.to_owned(), before, value, unit }])
    }

    /// Runs of ten samples, each with these phases.
    fn trace(runs: &[&[PhaseKind]]) -> Trace {
        let records = runs.iter().enumerate().flat_map(|(repetition, phases)| {
            phases.iter().map(move |phase| PhaseRecord {
                phase: phase.clone(),
                repetition,
                begin: 0.0,
                end: 0.0,
                problem_time: 0.0,
                sample: 10 * repetition,
                ended: PhaseEnd::Time,
            })
        });
        Trace {
            time: vec![0.0; 10 * runs.len()],
            repetitions: (0..runs.len())
                .map(|run| Repetition { first: 10 * run, ..Repetition::default() })
                .collect(),
            phase_records: records.collect(),
            ..Trace::default()
        }
    }

    /// The labels of the samples of a trace.
    fn labels_of(trace: &Trace) -> Vec<(usize, String)> {
        let begins = trace.repetitions.iter().map(|repetition| repetition.first).collect();
        labels(trace, &PointSource { first: 0, time: trace.time.as_slice().into(), begins })
    }

    #[test]
    fn labels_contain_what_differs_between_runs() {
        let runs: [&[PhaseKind]; 3] = [
            &[PhaseKind::InitialCondition, OPERATE, set("k", 10.0, 20.0), set("c", 1.0, 5.0), OPERATE],
            &[PhaseKind::InitialCondition, set("c", 5.0, 1.0), OPERATE],
            &[PhaseKind::InitialCondition, set("k", 20.0, 40.0), OPERATE],
        ];
        let expected = [
            (9, "k = 10, then 20 N/m, c = 1, then 5 N/m"),
            (19, "k = 20 N/m, c = 1 N/m"),
            (29, "k = 40 N/m, c = 1 N/m"),
        ];
        assert_eq!(labels_of(&trace(&runs)), expected.map(|(sample, label)| (sample, label.to_owned())));
    }

    #[test]
    fn equal_labels_are_merged() {
        let corrected = |to: f64| [PhaseKind::InitialCondition, OPERATE, set("k", 10.0, to)];
        let [first, close, closer] = [20.0, 20.001, 20.000_1].map(corrected);
        let expected = [(9, "k = 10 N/m"), (39, "k = 20 N/m, runs 2 to 4")];
        let expected = expected.map(|(sample, label)| (sample, label.to_owned()));
        assert_eq!(labels_of(&trace(&[&first, &close, &closer, &closer])), expected);
    }

    #[test]
    fn equal_runs_have_no_label() {
        let run: &[PhaseKind] = &[PhaseKind::InitialCondition, set("k", 10.0, 10.0), OPERATE];
        assert_eq!(labels_of(&trace(&[run, run])), []);
        assert_eq!(labels_of(&trace(&[])), []);
        let plain: &[PhaseKind] = &[PhaseKind::InitialCondition, OPERATE];
        assert_eq!(labels_of(&trace(&[plain; 3])), []);
    }
}
