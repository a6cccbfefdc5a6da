//! Single mistakes in correct patches are detected, and the first change corrects them.
//!
//! The benchmark `mistakes` makes random mistakes of the same kinds.

use std::collections::HashSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_equations::{Agreement, compare_equations, equation_findings, find_fixes};
use serde_json::{Value, json};

use crate::files::repository_path;

/// A mistake in a correct patch.
#[derive(Clone)]
struct Mistake {
    /// Its kind.
    kind: &'static str,
    /// The file of the correct patch, without its ending.
    patch: &'static str,
    /// The wrong values, each with its path in the document.
    wrong: Vec<(&'static str, Value)>,
    /// The first change that is found.
    first: &'static str,
}

/// A mistake with one wrong value.
fn one(
    kind: &'static str,
    patch: &'static str,
    path: &'static str,
    value: Value,
    first: &'static str,
) -> Mistake {
    Mistake { kind, patch, wrong: vec![(path, value)], first }
}

/// Two cords from each other's outputs.
fn swap(patch: &'static str, wrong: [(&'static str, &str); 2], first: &'static str) -> Mistake {
    let wrong = Vec::from(wrong.map(|(path, source)| (path, json!(source))));
    Mistake { kind: "swapped cords", patch, wrong, first }
}

/// The initial values of a patch, as equations.
fn initial_values(patch: &str) -> Vec<&'static str> {
    match patch {
        "patches/lessons/lorenz" => vec!["x(0) = x0", "y(0) = y0", "z(0) = z0"],
        "patches/lessons/mass-and-spring" => vec!["x(0) = x0", "v(0) = 0"],
        "patches/lessons/predator-and-prey" => vec!["hares(0) = x0", "lynxes(0) = y0"],
        "patches/lessons/two-phase-oscillator" => vec!["cosine(0) = start", "sine(0) = 0"],
        _ => Vec::new(),
    }
}

/// Mistakes in cords.
fn wrong_cords() -> Vec<Mistake> {
    let spring = "patches/lessons/mass-and-spring";
    let lorenz = "patches/lessons/lorenz";
    let hares = "patches/lessons/predator-and-prey";
    let phases = "patches/lessons/two-phase-oscillator";
    let slide = "patches/thesis/fig-8-04";
    let driven = "crates/equations/tests/patches/traps/a2";
    let prey = "crates/equations/tests/patches/traps/lv3";
    vec![
        one("sign", spring, "elements/P1/in", json!("A2"), "plug B1 into P1 in place of A2"),
        one("sign", lorenz, "elements/P2/in", json!("A2"), "plug B2 into P2 in place of A2"),
        one("sign", hares, "elements/P3/in", json!("M1"), "plug B2 into P3 in place of M1"),
        one("sign", phases, "elements/P3/in", json!("A1"), "plug B1 into P3 in place of A1"),
        one("sign", driven, "elements/PK/in", json!("A2"), "plug B1 into PK in place of A2"),
        swap(spring, [("elements/P2/in", "M2"), ("elements/P3/in", "M1")], "plug M1 into P2 in place of M2"),
        swap(hares, [("elements/P2/in", "A2"), ("elements/P4/in", "M1")], "plug M1 into P2 in place of A2"),
        swap(prey, [("elements/PB/in", "A2"), ("elements/PC/in", "M1")], "plug M1 into PB in place of A2"),
        one("missing cord", spring, "elements/B2/in", json!({"x1": ["P2"]}), "plug P3 into x10 of B2"),
        one("missing cord", slide, "elements/A4/in", json!({"x1": ["A5"]}), "plug PA4 into x1 of A4"),
        one("missing cord", slide, "elements/A1/in", json!({"x100": ["A3"]}), "plug v_i into x100 of A1"),
        one("moved cord", spring, "elements/M2/b", json!("B1"), "plug A1 into M2 in place of B1"),
        one("moved cord", phases, "elements/P1/in", json!("A1"), "plug A2 into P1 in place of A1"),
        one("moved cord", prey, "elements/PC/in", json!("M1"), "plug A2 into PC in place of M1"),
    ]
}

/// Mistakes in gains and in formulas of pots.
fn wrong_coefficients() -> Vec<Mistake> {
    let spring = "patches/lessons/mass-and-spring";
    let lorenz = "patches/lessons/lorenz";
    let slide = "patches/thesis/fig-8-04";
    let prey = "crates/equations/tests/patches/traps/lv3";
    let slow = json!({"x1": ["PC", "PD"]});
    let fast = json!({"x100": ["P3", "P4"], "x10": ["A2"]});
    let energy = json!("50 * m * velocity^2 / energy");
    let stiffness = json!("K * position / force / 100");
    let incomplete = json!("rho / 100 * flow");
    let first_energy = "set P3 to \"(50 * m * velocity^2 / energy) / 10\"";
    let first_stiffness = "set PC6 to \"K * position / force / 10\"";
    let first_incomplete = "set P3 to \"(rho / 100 * flow) / difference\"";
    vec![
        one("gain", spring, "elements/A1/in", json!({"x1": ["P1"]}), "plug P1 into x10 of A1 in place of x1"),
        one("gain", lorenz, "elements/A2/in", fast, "plug A2 into x1 of A2 in place of x10"),
        one("gain", prey, "elements/A2/in", slow, "plug PD into x10 of A2 in place of x1"),
        one("pot formula", spring, "elements/P3/setting", energy, first_energy),
        one("pot formula", slide, "elements/PC6/setting", stiffness, first_stiffness),
        one("pot formula", lorenz, "elements/P3/setting", incomplete, first_incomplete),
    ]
}

/// Mistakes in initial values and scales.
fn wrong_scales() -> Vec<Mistake> {
    let spring = "patches/lessons/mass-and-spring";
    let hares = "patches/lessons/predator-and-prey";
    let phases = "patches/lessons/two-phase-oscillator";
    let driven = "patches/lessons/driven-oscillator";
    let slide = "patches/thesis/fig-8-04";
    let [position, cosine, lynxes] = ["x0 / position", "-start", "10 * y0 / lynxes"].map(Value::from);
    let first_position = "give A2 the initial value \"-x0 / position\"";
    let first_cosine = "give A1 the initial value \"start\"";
    let first_lynxes = "give A2 the initial value \"(10 * y0 / lynxes) / 10\"";
    let [velocity, volt, length] = ["m/s", "kV", "mm"].map(Value::from);
    vec![
        one("initial value", spring, "elements/A2/initial", position, first_position),
        one("initial value", phases, "elements/A1/initial", cosine, first_cosine),
        one("initial value", hares, "elements/A2/initial", lynxes, first_lynxes),
        one("unit", driven, "scales/velocity/unit", velocity, "give the scale velocity the unit mm/s"),
        one("unit", phases, "scales/volt/unit", volt, "give the scale volt the unit V"),
        one("unit", slide, "scales/position/unit", length, "give the scale position the unit m"),
    ]
}

/// The circuit and the program of a patch.
fn compiled(patch: &Patch) -> (Circuit, Program) {
    let circuit = Circuit::new(patch).unwrap_or_else(|report| panic!("{report}"));
    let program = Program::new(&circuit).unwrap_or_else(|report| panic!("{report}"));
    (circuit, program)
}

/// A correct patch, with equations for its initial values.
fn correct_patch(name: &str) -> Patch {
    let patch = Patch::read(repository_path(&format!("{name}.json"))).unwrap();
    let stated = patch.equations.iter().map(|placed| placed.value.text().to_owned());
    let equations: Vec<String> = stated.chain(initial_values(name).into_iter().map(str::to_owned)).collect();
    patch.with_edits(patch.file(), &[Edit::at(["equations"], json!(equations))]).unwrap()
}

/// The first change that is found for a wrong patch. `None` if the wiring solves all equations, or if there is no change.
fn first_change(patch: &Patch) -> Option<String> {
    let (circuit, program) = compiled(patch);
    let compared = compare_equations(&circuit, &program).into_iter();
    let (unsolved, solved): (Vec<_>, Vec<_>) =
        compared.partition(|compared| matches!(compared.agreement, Agreement::Different { .. }));
    let [unsolved, solved] = [unsolved, solved]
        .map(|equations| equations.into_iter().map(|compared| compared.index).collect::<Vec<_>>());
    let fixes = find_fixes(&circuit, &program, &unsolved, &solved);
    fixes.into_iter().next().map(|fix| fix.description)
}

#[test]
fn the_first_change_corrects_every_kind_of_mistake() {
    let mistakes = [wrong_cords(), wrong_coefficients(), wrong_scales()].concat();
    let kinds: HashSet<&str> = mistakes.iter().map(|mistake| mistake.kind).collect();
    assert_eq!((kinds.len(), mistakes.len()), (8, 26));
    let (mut examined, mut failures) = (HashSet::new(), Vec::new());
    for Mistake { kind, patch: name, wrong, first } in mistakes {
        let patch = correct_patch(name);
        if examined.insert(name) {
            let (circuit, program) = compiled(&patch);
            let findings = equation_findings(&circuit, &program, &compare_equations(&circuit, &program));
            assert!(findings.is_empty(), "{name}: {}", findings[0].message);
        }
        let edits: Vec<Edit> = wrong.iter().map(|(path, value)| Edit::new(path, value.clone())).collect();
        let found = first_change(&patch.with_edits(patch.file(), &edits).unwrap());
        if found.as_deref() != Some(first) {
            failures.push(format!("{kind} in {name}, {wrong:?}:\n  expected {first}\n  found {found:?}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
