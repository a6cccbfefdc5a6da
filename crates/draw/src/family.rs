//! Families of curves: what tells the runs of a trace from each other.

use indexmap::IndexMap;

use patchcord_analysis::instruments::Display;
use patchcord_core::trace::{Deed, Trace};

/// In a larger family nothing could be told apart.
const LARGEST: usize = 50;

/// For every run the index of its last sample, and the parameters that are not the same in all runs, with what they
/// were while time went on; runs after each other that are told alike have one label, at the last of them. Nothing
/// where all are the same.
pub(super) fn labels(trace: &Trace) -> Vec<(usize, String)> {
    if trace.sweeps.len() > LARGEST {
        return Vec::new();
    }
    let runs = runs(trace);
    let differs = |name: &str| runs.iter().any(|run| run.get(name) != runs[0].get(name));
    let label = |run: &IndexMap<&str, Course<'_>>| {
        let told = run.iter().filter(|(name, _)| differs(name)).map(|(name, course)| course.told(name));
        told.collect::<Vec<_>>().join(", ")
    };
    let ends = trace.sweeps.iter().skip(1).map(|sweep| sweep.first).chain([trace.len()]);
    let labels: Vec<_> = ends.zip(runs.iter().map(label)).enumerate().collect();
    let alike = labels.chunk_by(|(_, one), (_, next)| one.1 == next.1);
    alike.filter(|runs| !runs[0].1.1.is_empty()).filter_map(label_of).collect()
}

/// The label of runs that are told alike.
fn label_of(runs: &[(usize, (usize, String))]) -> Option<(usize, String)> {
    let (first, (last, (end, label))) = (runs.first()?.0 + 1, runs.last()?);
    let which = if runs.len() > 1 { format!(", runs {first} to {}", last + 1) } else { String::new() };
    Some((end.saturating_sub(1), format!("{label}{which}")))
}

/// The values of a parameter in a run, one after the other, in its unit.
#[derive(Debug, PartialEq)]
struct Course<'t> {
    unit: &'t str,
    values: Vec<f64>,
}

impl Course<'_> {
    /// "k = 10, then 20 N/m".
    fn told(&self, name: &str) -> String {
        let largest = self.values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let display = Display::new(self.unit, largest);
        let numbers: Vec<_> = self.values.iter().map(|value| display.number(*value)).collect();
        format!("{name} = {} {}", numbers.join(", then "), display.unit).trim_end().to_owned()
    }
}

/// The parameters that phases set, as they stood in every run while time went on.
fn runs(trace: &Trace) -> Vec<IndexMap<&str, Course<'_>>> {
    let mut now: IndexMap<&str, (&str, f64)> = IndexMap::new();
    for new in trace.marks.iter().flat_map(|mark| mark.phase.new_values()) {
        now.entry(&new.parameter).or_insert((&new.unit, new.before));
    }
    let mut runs: Vec<IndexMap<&str, Course<'_>>> = Vec::new();
    for mark in &trace.marks {
        for new in mark.phase.new_values() {
            now.insert(&new.parameter, (&new.unit, new.value));
        }
        if !matches!(mark.phase, Deed::Operate { .. } | Deed::Hold) {
            continue;
        }
        runs.resize_with(runs.len().max(mark.sweep + 1), IndexMap::new);
        for (name, (unit, value)) in &now {
            let course = runs[mark.sweep].entry(*name).or_insert(Course { unit, values: Vec::new() });
            if course.values.last() != Some(value) {
                course.values.push(*value);
            }
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use patchcord_core::trace::{Ending, Mark, NewValue, Sweep};

    const OPERATE: Deed = Deed::Operate { until: None };

    fn set(name: &str, before: f64, value: f64) -> Deed {
        let unit = "N/m".to_owned();
        Deed::Set(vec![NewValue { parameter: name.to_owned(), before, value, unit }])
    }

    /// Runs of ten samples, each with these phases.
    fn trace(runs: &[&[Deed]]) -> Trace {
        let marks = runs.iter().enumerate().flat_map(|(sweep, deeds)| {
            deeds.iter().map(move |deed| Mark {
                phase: deed.clone(),
                sweep,
                begin: 0.0,
                end: 0.0,
                problem_time: 0.0,
                sample: 10 * sweep,
                ended: Ending::Time,
            })
        });
        Trace {
            time: vec![0.0; 10 * runs.len()],
            sweeps: (0..runs.len()).map(|run| Sweep { first: 10 * run, ..Sweep::default() }).collect(),
            marks: marks.collect(),
            ..Trace::default()
        }
    }

    #[test]
    fn runs_are_told_by_what_differs_between_them() {
        let runs: [&[Deed]; 3] = [
            &[Deed::InitialCondition, OPERATE, set("k", 10.0, 20.0), set("c", 1.0, 5.0), OPERATE],
            &[Deed::InitialCondition, set("c", 5.0, 1.0), OPERATE],
            &[Deed::InitialCondition, set("k", 20.0, 40.0), OPERATE],
        ];
        let told = [
            (9, "k = 10, then 20 N/m, c = 1, then 5 N/m"),
            (19, "k = 20 N/m, c = 1 N/m"),
            (29, "k = 40 N/m, c = 1 N/m"),
        ];
        assert_eq!(labels(&trace(&runs)), told.map(|(sample, label)| (sample, label.to_owned())));
    }

    #[test]
    fn runs_that_are_told_alike_have_one_label() {
        let corrected = |to: f64| [Deed::InitialCondition, OPERATE, set("k", 10.0, to)];
        let [first, close, closer] = [20.0, 20.001, 20.000_1].map(corrected);
        let told = [(9, "k = 10 N/m"), (39, "k = 20 N/m, runs 2 to 4")];
        let told = told.map(|(sample, label)| (sample, label.to_owned()));
        assert_eq!(labels(&trace(&[&first, &close, &closer, &closer])), told);
    }

    #[test]
    fn runs_that_are_all_the_same_need_no_label() {
        let run: &[Deed] = &[Deed::InitialCondition, set("k", 10.0, 10.0), OPERATE];
        assert_eq!(labels(&trace(&[run, run])), []);
        assert_eq!(labels(&trace(&[])), []);
        let plain: &[Deed] = &[Deed::InitialCondition, OPERATE];
        assert_eq!(labels(&trace(&[plain; 3])), []);
    }
}
