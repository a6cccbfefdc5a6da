//! Families of curves: what tells the runs of a trace from each other.

use indexmap::IndexMap;

use super::log::new_value;
use crate::trace::{Deed, NewValue, Trace};

/// In a larger family nothing could be told apart.
const LARGEST: usize = 50;

/// For every run the index of its last sample, and the parameters, as they stood at its beginning, that are not the
/// same in all runs. Nothing where they are.
pub(super) fn labels(trace: &Trace) -> Vec<(usize, String)> {
    if trace.sweeps.len() > LARGEST {
        return Vec::new();
    }
    let starts = starts(trace);
    let differs = |name: &str| starts.iter().any(|start| start[name].value != starts[0][name].value);
    let label = |start: &IndexMap<&str, NewValue>| {
        let told = start.values().filter(|new| differs(&new.parameter)).map(new_value);
        told.collect::<Vec<_>>().join(", ")
    };
    let ends = trace.sweeps.iter().skip(1).map(|sweep| sweep.first).chain([trace.len()]);
    let labels = ends.zip(&starts).map(|(end, start)| (end.saturating_sub(1), label(start)));
    labels.filter(|(_, label)| !label.is_empty()).collect()
}

/// The parameters that phases set, as they stood at the beginning of every run.
fn starts(trace: &Trace) -> Vec<IndexMap<&str, NewValue>> {
    let mut now: IndexMap<&str, NewValue> = IndexMap::new();
    for new in trace.marks.iter().flat_map(|mark| mark.phase.new_values()) {
        let before = NewValue { value: new.before, ..new.clone() };
        now.entry(&new.parameter).or_insert(before);
    }
    let mut starts = Vec::new();
    for mark in &trace.marks {
        for new in mark.phase.new_values() {
            now.insert(&new.parameter, new.clone());
        }
        let takes_time = matches!(mark.phase, Deed::Operate { .. } | Deed::Hold);
        if takes_time && mark.sweep == starts.len() {
            starts.push(now.clone());
        }
    }
    starts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{Ending, Mark, Sweep};

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
        let told = [(9, "k = 10 N/m"), (19, "k = 20 N/m"), (29, "k = 40 N/m")];
        assert_eq!(labels(&trace(&runs)), told.map(|(sample, label)| (sample, label.to_owned())));
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
