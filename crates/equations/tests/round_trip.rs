//! Problems are scaled to patches whose wiring solves the equations of the problem.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Patch, Problem};
use patchcord_equations::{Agreement, ScaleOptions, compare_equations, scale_problem};
use serde_json::Value;

use crate::files::{json_files_in, repository_path};
use crate::problem_files::{problem_file, problem_files};
use crate::scale::scaled;

/// The equations of a patch with their agreement. `None` if its wiring has no circuit or no program.
fn agreements(patch: &Patch) -> Option<Vec<(String, Agreement)>> {
    let circuit = Circuit::new(patch).ok()?;
    let program = Program::new(&circuit).ok()?;
    let compared = compare_equations(&circuit, &program).into_iter().map(|compared| {
        let equation = circuit.equations()[compared.index].value.text().to_owned();
        (equation, compared.agreement)
    });
    Some(compared.collect())
}

/// The name of a file without its ending.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap().to_string_lossy().into_owned()
}

/// Well-known systems, in addition to those of the lessons.
const WELL_KNOWN: [&str; 12] = [
    "chua",
    "coupled-pendulums",
    "duffing",
    "heat-30",
    "hindmarsh-rose",
    "kepler",
    "mathieu",
    "pid-anti-windup",
    "quarter-car",
    "roessler",
    "sir",
    "slideway",
];

#[test]
fn the_lessons_and_well_known_systems_are_among_the_problems() {
    let problems: HashSet<String> = problem_files().iter().map(|path| stem(path)).collect();
    let lessons: Vec<PathBuf> = json_files_in(&repository_path("patches/lessons"));
    assert!(lessons.len() >= 13, "{lessons:?}");
    let required = lessons.iter().map(|path| stem(path)).chain(WELL_KNOWN.map(str::to_owned));
    let missing: Vec<String> = required.filter(|name| !problems.contains(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// The equations of a problem that a patch does not state. Those with a table are left out, because only a problem has
/// tables.
fn unstated(problem: &Path, stated: &HashSet<&str>) -> Vec<String> {
    let problem = Problem::read(problem).unwrap_or_else(|error| panic!("{error}"));
    let has_table =
        |equation: &str| problem.tables.keys().any(|table| equation.contains(&format!("{table}(")));
    let equations = problem.patch.equations.iter().map(|placed| placed.value.text());
    let unstated = equations.filter(|equation| !has_table(equation) && !stated.contains(equation));
    unstated.map(str::to_owned).collect()
}

#[test]
fn the_patch_of_every_problem_solves_its_equations() {
    let (mut problem_count, mut equation_count, mut numerical_count) = (0, 0, 0);
    for path in problem_files() {
        let problem = stem(&path);
        let compared = agreements(&scaled(&path).patch).unwrap();
        let stated: HashSet<&str> = compared.iter().map(|(equation, _)| equation.as_str()).collect();
        assert_eq!(unstated(&path, &stated), Vec::<String>::new(), "{problem}");
        for (equation, agreement) in &compared {
            assert!(agreement.is_solved(), "{problem}: {equation}: {agreement:?}");
            equation_count += 1;
            numerical_count += usize::from(matches!(agreement, Agreement::SolvedNumerically(_)));
        }
        problem_count += 1;
    }
    assert!(problem_count >= 62 && equation_count > 150, "{problem_count} {equation_count}");
    assert!(numerical_count >= 3, "{numerical_count}");
}

/// The inputs of the open amplifiers of a patch, each with the name of the amplifier.
fn open_inputs(patch: &Value) -> Vec<(String, String)> {
    let elements = patch["elements"].as_object().unwrap().iter();
    let open = elements.filter(|(_, element)| element["kind"] == "open-amplifier");
    let inputs = open.flat_map(|(name, element)| {
        let inputs = element["in"].as_object().unwrap().keys();
        inputs.map(move |input| (name.clone(), input.clone()))
    });
    inputs.collect()
}

/// Moves the first cord of an input to another gain: from x10 to x1, and from others to x10.
fn move_cord(patch: &mut Value, amplifier: &str, input: &str) {
    let cords = &mut patch["elements"][amplifier]["in"];
    let moved = cords[input].as_array_mut().unwrap().remove(0);
    if cords[input].as_array().unwrap().is_empty() {
        cords.as_object_mut().unwrap().shift_remove(input);
    }
    let other = if input == "x10" { "x1" } else { "x10" };
    match cords[other].as_array_mut() {
        Some(others) => others.push(moved),
        None => cords[other] = Value::from(vec![moved]),
    }
}

/// The angle of the dog's course is the solution of an open amplifier.
#[test]
fn a_wrong_gain_of_an_open_amplifier_is_never_accepted() {
    let patch = scaled(&problem_file("pursuit")).patch.value().clone();
    let inputs = open_inputs(&patch);
    assert!(inputs.len() >= 2, "{inputs:?}");
    let mut different = 0;
    for (amplifier, input) in inputs {
        let mut wrong = patch.clone();
        move_cord(&mut wrong, &amplifier, &input);
        let wrong = Patch::from_value("wrong.json", &wrong).unwrap_or_else(|report| panic!("{report}"));
        // A loop without a solution is an error of its own.
        let Some(agreements) = agreements(&wrong) else { continue };
        assert!(!agreements.iter().all(|(_, agreement)| agreement.is_solved()), "{amplifier} {input}");
        let is_different =
            |(_, agreement): &(String, Agreement)| matches!(agreement, Agreement::Different { .. });
        different += usize::from(agreements.iter().any(is_different));
    }
    assert!(different > 0);
}

/// A problem with six quotients in an equation.
const QUOTIENTS: &str = r#"{"patchcord": 1,
  "parameters": {"a": {"value": 1, "unit": "1"}, "b": {"value": 2, "unit": "1"}, "c": {"value": 1.5, "unit": "1"},
                 "k": {"value": 1.1, "unit": "1"}, "h": {"value": 1.3, "unit": "1"}},
  "quantities": {"x": {"unit": "1", "initial": 1}, "y": {"unit": "1", "initial": 0.5},
                 "z": {"unit": "1", "initial": 0.3}},
  "equations": ["x' = a x y/(k + x) - b y z/(h + y) + c z x/(k + z) - a x z/(h + x + y) + b x/(k + y + z) - c x/(h + z) - x",
                "y' = x - 2 y", "z' = y - z"],
  "run": {"for": 5, "step": 0.01}}"#;

/// The normal form of the equation is one long sum over six divisors.
#[test]
fn a_wrong_term_among_quotients_is_named() {
    let problem = Problem::parse("quotients.json", QUOTIENTS).unwrap_or_else(|report| panic!("{report}"));
    let scaled = scale_problem(&problem, &ScaleOptions::default()).unwrap_or_else(|error| panic!("{error}"));
    let solved = agreements(&scaled.patch).unwrap();
    assert!(solved.iter().all(|(_, agreement)| agreement.is_solved()), "{solved:?}");
    let mut wrong = scaled.patch.value().clone();
    let elements = wrong["elements"].as_object_mut().unwrap().values_mut();
    let mut dividends = elements.filter(|element| {
        element["kind"] == "pot" && element["note"].as_str().is_some_and(|note| note.ends_with("b y z"))
    });
    let setting = &mut dividends.next().unwrap()["setting"];
    *setting = format!("0.5 * {}", setting.as_str().unwrap()).into();
    let wrong = Patch::from_value("wrong.json", &wrong).unwrap_or_else(|report| panic!("{report}"));
    let (_, agreement) = agreements(&wrong).unwrap().remove(0);
    let Agreement::Different { differences, .. } = agreement else { panic!("{agreement:?}") };
    assert_eq!(differences, ["the term -b y z/(y + h) is 2 times too small"]);
}
