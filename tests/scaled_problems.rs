//! Random problems become patches that solve their equations, or are refused.

use patchcord::equations::{Agreement, ScaleOptions, ScaledProblem, compare_equations, scale_problem};
use patchcord::patch::Problem;
use patchcord::{Circuit, Program, RunSettings, run};

use crate::common::random::SplitMix64;
use crate::fuzz::random_problem::random_problem;

/// The number of problems.
const PROBLEMS: u64 = 120;
/// The least share of problems that become patches.
const SCALED_SHARE: u64 = 60;

/// What is wrong with a patch.
fn faults(scaled: &ScaledProblem) -> Vec<String> {
    let circuit = match Circuit::new(&scaled.patch) {
        Ok(circuit) => circuit,
        Err(report) => return vec![report.to_string()],
    };
    let program = Program::new(&circuit).unwrap();
    let mut faults = Vec::new();
    for compared in compare_equations(&circuit, &program) {
        if matches!(compared.agreement, Agreement::Different { .. } | Agreement::SolvedAt(_)) {
            let equation = circuit.equations()[compared.index].value.text();
            faults.push(format!("{equation}: {:?}", compared.agreement));
        }
    }
    let trace = run(&program, &RunSettings::of(&circuit).unwrap()).unwrap();
    faults.extend(trace.overloads().map(|overload| format!("{} overloads", overload.element)));
    faults
}

#[test]
fn random_problems_become_patches_that_solve_them() {
    let (mut scaled_count, mut found) = (0, Vec::new());
    for seed in 0..PROBLEMS {
        let text = random_problem(&mut SplitMix64(seed)).json();
        let problem =
            Problem::parse("random.json", &text).unwrap_or_else(|report| panic!("{report}\n{text}"));
        match scale_problem(&problem, &ScaleOptions::default()) {
            Err(error) => println!("{seed}: {error}"),
            Ok(scaled) => {
                scaled_count += 1;
                found.extend(faults(&scaled).into_iter().map(|fault| format!("{seed}: {fault}\n{text}")));
            }
        }
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
    assert!(100 * scaled_count > SCALED_SHARE * PROBLEMS, "{scaled_count}");
}
