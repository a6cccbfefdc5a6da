//! The ranges of the quantities of all problems agree with the solutions of SciPy.

use std::fs;
use std::path::Path;

use patchcord_core::circuit::Circuit;
use patchcord_core::patch::Problem;
use patchcord_expr::Unit;
use serde_json::Value;

use crate::peaks::ranges;
use crate::plan::plan;
use crate::testing::problem_files::{problem_files, reference};

/// Largest difference of a peak, as a share of it.
const TOLERANCE: f64 = 2e-5;

/// The differences of the peaks of a problem from those of its reference, as lines of text. Also the number of compared
/// quantities.
fn differences(path: &Path) -> (usize, Vec<String>) {
    let name = path.display().to_string();
    let problem = Problem::parse(&name, &fs::read_to_string(path).unwrap());
    let problem = problem.unwrap_or_else(|report| panic!("{report}"));
    let circuit = Circuit::new(&problem.patch).unwrap_or_else(|report| panic!("{report}"));
    let plan = plan(&problem, &circuit).unwrap_or_else(|findings| panic!("{name}: {findings:?}"));
    let ranges = ranges(&plan, &problem, &circuit).unwrap_or_else(|finding| panic!("{name}: {finding:?}"));
    let reference = reference(path);
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
    let found: Vec<(usize, Vec<String>)> = problem_files().iter().map(|path| differences(path)).collect();
    let all: Vec<&String> = found.iter().flat_map(|(_, differences)| differences).collect();
    assert!(all.is_empty(), "{all:#?}");
    assert!(found.len() >= 40 && found.iter().map(|(count, _)| count).sum::<usize>() >= 150);
}
