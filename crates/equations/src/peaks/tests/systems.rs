//! The ranges of the quantities of all problems agree with the solutions of SciPy.

use std::fs;
use std::path::{Path, PathBuf};

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Problem;
use patchcord_expr::Unit;
use serde_json::Value;

use crate::peaks::ranges;
use crate::plan::plan;

/// Largest difference of a peak, as a share of it.
const TOLERANCE: f64 = 1e-3;

/// The problems in `tests/systems`, in the order of their names.
fn problems() -> Vec<PathBuf> {
    let paths = fs::read_dir("tests/systems").unwrap().map(|entry| entry.unwrap().path());
    let is_problem = |path: &PathBuf| {
        let name = path.to_string_lossy();
        name.ends_with(".json") && !name.ends_with(".reference.json")
    };
    let mut problems: Vec<PathBuf> = paths.filter(is_problem).collect();
    problems.sort();
    problems
}

/// The differences of the peaks of a problem from those of its reference, as lines of text. Also the number of compared
/// quantities.
fn differences(path: &Path) -> (usize, Vec<String>) {
    let name = path.display().to_string();
    let problem = Problem::parse(&name, &fs::read_to_string(path).unwrap());
    let problem = problem.unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
    let plan = plan(&problem, &circuit).unwrap_or_else(|findings| panic!("{name}: {findings:?}"));
    let ranges = ranges(&plan, &problem, &circuit).unwrap_or_else(|finding| panic!("{name}: {finding:?}"));
    let reference = fs::read_to_string(path.with_extension("reference.json")).unwrap();
    let reference: Value = serde_json::from_str(&reference).unwrap();
    let quantities = reference["quantities"].as_object().unwrap();
    let difference = |(quantity, entry): (&String, &Value)| {
        let unit = Unit::parse(entry["unit"].as_str().unwrap()).unwrap();
        let peak = unit.to_si(entry["peak"].as_f64().unwrap());
        let planned = plan.quantities.iter().find(|planned| planned.name == *quantity);
        let Some(planned) = planned else { return Some(format!("{name}: {quantity} is not planned")) };
        let [low, high] = ranges.nodes[planned.node.0 as usize];
        let is_near = (low.abs().max(high.abs()) - peak).abs() <= TOLERANCE * peak;
        (!is_near).then(|| format!("{name}: {quantity} is {low} ... {high}, but its peak is {peak}"))
    };
    (quantities.len(), quantities.iter().filter_map(difference).collect())
}

#[test]
fn all_problems_have_the_peaks_of_scipy() {
    let found: Vec<(usize, Vec<String>)> = problems().iter().map(|path| differences(path)).collect();
    let all: Vec<&String> = found.iter().flat_map(|(_, differences)| differences).collect();
    assert!(all.is_empty(), "{all:#?}");
    assert!(found.len() >= 40 && found.iter().map(|(count, _)| count).sum::<usize>() >= 150);
}
