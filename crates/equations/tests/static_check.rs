//! The static check finds no difference in a correct patch, whatever the random test values are.

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::Patch;
use patchcord_equations::{RowSource, StaticCheck, StaticRow, TestValues, static_check};

use crate::files::shipped_files;
use crate::problem_files::problem_files;
use crate::scale::scaled;

/// Seeds of the random test values.
const SEEDS: [u64; 3] = [1, 2, 3];

/// The static checks of a patch at random values. Empty if it states no equations.
fn checks(patch: &Patch) -> Vec<StaticCheck> {
    let circuit = Circuit::new(patch).unwrap_or_else(|report| panic!("{report}"));
    if circuit.equations().is_empty() {
        return Vec::new();
    }
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    let check = |seed: &u64| {
        static_check(&circuit, &program, &TestValues::Random(*seed))
            .unwrap_or_else(|error| panic!("{}, seed {seed}: {error}", patch.file()))
    };
    SEEDS.iter().map(check).collect()
}

/// The differences of checks as texts, and the number of rows that the equations decide about.
fn summary(name: &str, checks: &[StaticCheck]) -> (Vec<String>, usize) {
    let text = |row: &StaticRow| {
        let name_of_row = row.element.clone() + &"'".repeat(row.order);
        format!("{name}: {name_of_row} is {}, expected {:?}", row.wired, row.expected)
    };
    let differences = checks.iter().flat_map(StaticCheck::differences).map(text).collect();
    let decides = |row: &&StaticRow| row.source == RowSource::Equations && row.not_compared.is_none();
    let rows = checks.iter().flat_map(|check| &check.rows);
    (differences, rows.filter(decides).count())
}

#[test]
fn the_patches_of_all_problems_have_no_differences_at_random_values() {
    let (mut faults, mut compared) = (Vec::new(), 0);
    for path in problem_files() {
        let name = path.file_stem().unwrap().to_string_lossy();
        let (differences, rows) = summary(&name, &checks(&scaled(&path).patch));
        faults.extend(differences);
        compared += rows;
    }
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(compared > 450, "{compared}");
}

#[test]
fn shipped_patches_with_equations_have_no_differences_at_random_values() {
    let (mut faults, mut compared) = (Vec::new(), 0);
    for path in shipped_files() {
        let patch = Patch::read(&path).unwrap_or_else(|report| panic!("{report}"));
        let name = path.file_stem().unwrap().to_string_lossy();
        let (differences, rows) = summary(&name, &checks(&patch));
        faults.extend(differences);
        compared += rows;
    }
    assert!(faults.is_empty(), "{faults:#?}");
    assert!(compared > 250, "{compared}");
}
