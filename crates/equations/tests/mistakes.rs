//! Single mistakes in correct patches are detected, and the first change corrects them.
//!
//! The benchmark `mistakes` makes random mistakes of the same kinds.

use std::collections::HashSet;

use patchcord_core::circuit::Circuit;
use patchcord_core::ir::Program;
use patchcord_core::patch::{Edit, Patch};
use patchcord_equations::{Agreement, compare_equations, equation_findings, find_fixes, findings_with_fixes};
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
    first: String,
}

/// A mistake with one wrong value.
fn one(kind: &'static str, patch: &'static str, path: &'static str, value: Value, first: &str) -> Mistake {
    Mistake { kind, patch, wrong: vec![(path, value)], first: first.to_owned() }
}

/// Two cords from each other's outputs.
fn swap(patch: &'static str, wrong: [(&'static str, &str); 2], first: &str) -> Mistake {
    let wrong = Vec::from(wrong.map(|(path, source)| (path, json!(source))));
    Mistake { kind: "swapped cords", patch, wrong, first: first.to_owned() }
}

/// Further equations of a patch: its initial values, and its motion with friction.
fn further_equations(patch: &str) -> Vec<&'static str> {
    match patch {
        "patches/lessons/lorenz" => vec!["x(0) = x0", "y(0) = y0", "z(0) = z0"],
        "patches/lessons/mass-and-spring" => vec!["x(0) = x0", "v(0) = 0"],
        "patches/lessons/predator-and-prey" => vec!["hares(0) = x0", "lynxes(0) = y0"],
        "patches/lessons/two-phase-oscillator" => vec!["cosine(0) = start", "sine(0) = 0"],
        "patches/thesis/fig-8-16-coulomb" => {
            vec!["M v_o' = spring_force - f v_o - friction_level sign(v_o)"]
        }
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
    let pumped = "patches/lessons/mathieu";
    let friction = "patches/thesis/fig-8-14";
    let own_cord = json!({"x100": ["P3", "P4"]});
    let equal_cords = json!(["B3", "B3"]);
    let exchange = |one: &str, other: &str| format!("exchange the outputs of the cords {one} and {other}");
    vec![
        one("sign", spring, "elements/P1/in", json!("A2"), "plug B1 into P1 in place of A2"),
        one("sign", lorenz, "elements/P2/in", json!("A2"), "plug B2 into P2 in place of A2"),
        one("sign", hares, "elements/P3/in", json!("M1"), "plug B2 into P3 in place of M1"),
        one("sign", phases, "elements/P3/in", json!("A1"), "plug B1 into P3 in place of A1"),
        one("sign", driven, "elements/PK/in", json!("A2"), "plug B1 into PK in place of A2"),
        one("sign", friction, "elements/U/in", equal_cords, "plug A3 into U in place of B3"),
        swap(
            spring,
            [("elements/P2/in", "M2"), ("elements/P3/in", "M1")],
            &exchange("from M2 to P2", "from M1 to P3"),
        ),
        swap(
            hares,
            [("elements/P2/in", "A2"), ("elements/P4/in", "M1")],
            &exchange("from A2 to P2", "from M1 to P4"),
        ),
        swap(
            prey,
            [("elements/PB/in", "A2"), ("elements/PC/in", "M1")],
            &exchange("from A2 to PB", "from M1 to PC"),
        ),
        // Both cords are in one equation, so that no single one corrects anything.
        swap(
            lorenz,
            [("elements/P1/in", "B2"), ("elements/P2/in", "A1")],
            &exchange("from B2 to P1", "from A1 to P2"),
        ),
        one("missing cord", spring, "elements/B2/in", json!({"x1": ["P2"]}), "plug P3 into x10 of B2"),
        one("missing cord", slide, "elements/A4/in", json!({"x1": ["A5"]}), "plug PA4 into x1 of A4"),
        one("missing cord", slide, "elements/A1/in", json!({"x100": ["A3"]}), "plug v_i into x100 of A1"),
        one("missing cord", lorenz, "elements/A2/in", own_cord, "plug A2 into x1 of A2"),
        one("moved cord", pumped, "elements/M1/b", json!("pump"), "plug A2 into a of M1 in place of pump"),
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
    let phases = "patches/lessons/two-phase-oscillator";
    let braked = "patches/thesis/fig-8-16-coulomb";
    let brake = json!({"x1000": ["PA3"], "brake_x100": ["PB"]});
    let first_brake = "plug PB into brake_x1000 of A3 in place of brake_x100";
    let energy = json!("50 * m * velocity^2 / energy");
    let stiffness = json!("K * position / force / 100");
    let incomplete = json!("rho / 100 * flow");
    let inverse = json!("flow * difference / profile");
    let first_energy = "set P3 to \"5 * m * velocity^2 / energy\"";
    let first_stiffness = "set PC6 to \"K * position / force / 10\"";
    let first_incomplete = "set P3 to \"rho / 100 * flow / difference\"";
    let first_inverse = "set P4 to \"flow * profile / difference\"";
    // The frequency is 1 at present, so the equation is solved for its present value only.
    let present = json!("2 * pi / 10");
    let first_present = "set P1 to \"2 * pi / 10 * f\"";
    vec![
        one("gain", spring, "elements/A1/in", json!({"x1": ["P1"]}), "plug P1 into x10 of A1 in place of x1"),
        one("gain", lorenz, "elements/A2/in", fast, "plug A2 into x1 of A2 in place of x10"),
        one("gain", prey, "elements/A2/in", slow, "plug PD into x10 of A2 in place of x1"),
        one("gain", braked, "elements/A3/in", brake, first_brake),
        one("pot formula", spring, "elements/P3/setting", energy, first_energy),
        one("pot formula", slide, "elements/PC6/setting", stiffness, first_stiffness),
        one("pot formula", lorenz, "elements/P3/setting", incomplete, first_incomplete),
        one("pot formula", lorenz, "elements/P4/setting", inverse, first_inverse),
        one("pot formula", lorenz, "elements/P1/setting", json!("rho / 100"), "set P1 to \"sigma / 100\""),
        one("pot formula", phases, "elements/P1/setting", present, first_present),
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
    let first_lynxes = "give A2 the initial value \"y0 / lynxes\"";
    let lorenz = "patches/lessons/lorenz";
    let first_profile = "give A3 the initial value \"z0 / profile\"";
    let first_velocity = "let 1 V of the scale velocity be 10 mm/s";
    let [velocity, volt, length] = ["m/s", "kV", "mm"].map(Value::from);
    vec![
        one("initial value", spring, "elements/A2/initial", position, first_position),
        one("initial value", spring, "elements/A2/initial", json!(0), first_position),
        one("initial value", phases, "elements/A1/initial", cosine, first_cosine),
        one("initial value", hares, "elements/A2/initial", lynxes, first_lynxes),
        one("initial value", lorenz, "elements/A3/initial", json!("y0 / profile"), first_profile),
        one("initial value", lorenz, "elements/A3/initial", json!(0), first_profile),
        one("scale", spring, "scales/velocity/per_volt", json!(20), first_velocity),
        one("time scale", spring, "time_scale", json!(10), "set time_scale to 1"),
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
    let equations: Vec<String> =
        stated.chain(further_equations(name).into_iter().map(str::to_owned)).collect();
    patch.with_edits(patch.file(), &[Edit::at(["equations"], json!(equations))]).unwrap()
}

/// All mistakes.
fn mistakes() -> Vec<Mistake> {
    [wrong_cords(), wrong_coefficients(), wrong_scales()].concat()
}

/// A correct patch with a mistake.
fn wrong_patch(correct: &Patch, mistake: &Mistake) -> Patch {
    let edits: Vec<Edit> = mistake.wrong.iter().map(|(path, value)| Edit::new(path, value.clone())).collect();
    correct.with_edits(correct.file(), &edits).unwrap()
}

/// The changes that are found for a wrong patch, the likeliest first.
fn changes(patch: &Patch) -> Vec<String> {
    let (circuit, program) = compiled(patch);
    let fixes = find_fixes(&circuit, &program, &compare_equations(&circuit, &program));
    fixes.into_iter().map(|fix| fix.description).collect()
}

#[test]
fn the_first_change_corrects_every_kind_of_mistake() {
    let mistakes = mistakes();
    let kinds: HashSet<&str> = mistakes.iter().map(|mistake| mistake.kind).collect();
    assert_eq!((kinds.len(), mistakes.len()), (10, 39));
    let (mut examined, mut failures) = (HashSet::new(), Vec::new());
    for mistake in mistakes {
        let patch = correct_patch(mistake.patch);
        if examined.insert(mistake.patch) {
            let (circuit, program) = compiled(&patch);
            let findings = equation_findings(&circuit, &program, &compare_equations(&circuit, &program));
            assert!(findings.is_empty(), "{}: {}", mistake.patch, findings[0].message);
        }
        let found = changes(&wrong_patch(&patch, &mistake));
        let Mistake { kind, patch: name, wrong, first } = mistake;
        if found.first() != Some(&first) {
            failures.push(format!("{kind} in {name}, {wrong:?}:\n  expected {first}\n  found {found:?}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The number of changes that a diagnostic lists.
fn listed_changes(advice: &str) -> usize {
    advice.split_once("corrects it: ").map_or(0, |(_, changes)| changes.split("; or ").count())
}

#[test]
fn every_listed_change_corrects_its_equations_and_keeps_the_others() {
    let mut most_listed = 0;
    for mistake in mistakes() {
        let wrong = wrong_patch(&correct_patch(mistake.patch), &mistake);
        let (circuit, program) = compiled(&wrong);
        let before = compare_equations(&circuit, &program);
        let fixes = find_fixes(&circuit, &program, &before);
        let findings = findings_with_fixes(&circuit, &before, &fixes);
        let listed = findings.iter().map(|finding| listed_changes(finding.advice()));
        most_listed = listed.fold(most_listed, usize::max);
        for fix in &fixes {
            let (circuit, program) = compiled(&wrong.with_edits(wrong.file(), &fix.edits).unwrap());
            let after = compare_equations(&circuit, &program);
            let kept = before.iter().filter(|compared| compared.agreement.is_solved());
            for index in kept.map(|compared| compared.index).chain(fix.solves.iter().copied()) {
                let agreement = &after[index].agreement;
                let is_solved = agreement.is_solved() || matches!(agreement, Agreement::SolvedAt(_));
                assert!(is_solved, "{}, {}: {agreement:?}", mistake.patch, fix.description);
            }
        }
    }
    assert_eq!(most_listed, 3);
}

/// The changes that are found for a patch with one wrong value.
fn changes_after(patch: &str, path: &str, value: Value) -> Vec<String> {
    let patch = correct_patch(patch);
    changes(&patch.with_edits(patch.file(), &[Edit::new(path, value)]).unwrap())
}

#[test]
fn a_pot_that_is_10_times_too_small_comes_before_the_gain_behind_it() {
    let found =
        changes_after("patches/lessons/projectile", "elements/P2/setting", json!("velocity / distance / 10"));
    assert_eq!(found, ["set P2 to \"velocity / distance\"", "plug P2 into x10 of A2 in place of x1"]);
}

#[test]
fn changes_of_two_inputs_of_a_multiplier_name_the_inputs() {
    let found = changes_after("patches/lessons/mathieu", "elements/M1/b", json!("pump"));
    assert_eq!(
        found[..2],
        ["plug A2 into a of M1 in place of pump", "plug A2 into b of M1 in place of pump"]
    );
}

#[test]
fn a_loop_by_a_wrong_cord_is_opened() {
    // PA5 depends on B4 through B5, PC6, A5 and DZ, so the loop has no integrator, and the equation is undecided.
    let found = changes_after("patches/thesis/fig-8-14", "elements/B4/in", json!({"x1": ["PA5"]}));
    assert_eq!(found[0], "plug x_i into B4 in place of PA5");
}

#[test]
fn the_feedback_of_an_open_amplifier_is_added() {
    let found = changes_after("patches/lessons/projectile", "elements/A5/in", json!({"x1": ["B1"]}));
    assert_eq!(found[0], "plug M2 into x1 of A5");
}
