//! Loops that are coupled: several unknown voltages are solved together.

use crate::common::random::SplitMix64;
use crate::common::{built, circuit, element, run_for, source, voltage, volts};
use patchcord_core::ir::Program;
use patchcord_core::patch::PatchBuilder;

/// The voltages of elements in initial condition.
fn solved<const COUNT: usize>(builder: PatchBuilder, elements: [&str; COUNT]) -> [f64; COUNT] {
    let program = built(builder);
    let machine = run_for(&program, 1e-3, 0.0);
    elements.map(|element| voltage(&machine, element))
}

/// Checks voltages to a nanovolt.
fn assert_near(found: &[f64], expected: &[f64]) {
    let is_near = found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-9);
    assert!(is_near && found.len() == expected.len(), "{found:?} instead of {expected:?}");
}

/// The report of a patch that is refused.
fn refusal(builder: PatchBuilder) -> String {
    let patch = builder.build().unwrap();
    Program::new(&circuit(&patch, &[])).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn two_equations_with_inverters_are_solved() {
    // 2 A - B = 10 and 2 B - 2 A = -20.
    let builder = volts("coupled")
        .element("A", element("summer").cords("x1", ["A", "MB"]).cords("x0.1", ["-100"]))
        .element("B", element("summer").cords("x1", ["B"]).cords("x2", ["MA"]).cords("x0.2", ["+100"]))
        .element("MA", element("inverter").cord("in", "A"))
        .element("MB", element("inverter").cord("in", "B"));
    assert_near(&solved(builder, ["A", "B"]), &[0.0, -10.0]);
}

#[test]
fn without_a_source_all_voltages_are_zero() {
    let builder = volts("no source")
        .element("A", element("summer").cords("x0.6", ["B"]).cords("x0.3", ["A"]))
        .element("B", element("summer").cords("x2", ["A"]).cords("x0.8", ["B"]));
    assert_near(&solved(builder, ["A", "B"]), &[0.0, 0.0]);
}

#[test]
fn equations_with_positive_feedback_in_one_of_them_are_solved() {
    // 3 A = B and B / 2 = -A - 10.
    let builder = volts("positive feedback")
        .element("A", element("summer").cords("x2", ["A"]).cords("x1", ["MB"]))
        .element("B", element("summer").cords("x1", ["A"]).cords("x0.5", ["MB"]).cords("x0.1", ["+100"]))
        .element("MB", element("inverter").cord("in", "B"));
    assert_near(&solved(builder, ["A", "B"]), &[-4.0, -12.0]);
}

#[test]
fn a_pair_that_latches_is_refused_with_its_three_solutions() {
    let pair = |gain: &str| {
        volts("latch")
            .element("A", element("summer").cords("x1", ["A"]).cords(gain, ["B"]).cords("x0.1", ["+100"]))
            .element("B", element("summer").cords("x1", ["B"]).cords(gain, ["A"]).cords("x0.2", ["+100"]))
    };
    let report = refusal(pair("x3"));
    assert!(report.contains("3 solutions: A at -100 V, -8 V, 100 V"), "{report}");
    // Below a gain of 2 the pair does not latch: 2 A + g B = -10 and 2 B + g A = -20.
    let g = 1.5f64;
    let expected = [(-20.0 + 20.0 * g) / (4.0 - g * g), (-40.0 + 10.0 * g) / (4.0 - g * g)];
    assert_near(&solved(pair("x1.5"), ["A", "B"]), &expected);
}

#[test]
fn open_amplifiers_with_local_and_overall_feedback_are_solved() {
    // C = -20 (D + FB), O = -2 C and FB = -O, up to the finite amplification a: C / 20 + D + FB = -C / a.
    for drive in [-40.0, -3.0, 0.0, 17.0, 40.0] {
        let builder = source(volts("two stages"), "D", drive)
            .element("C", element("open-amplifier").cords("x1", ["D", "FB"]).cords("x0.05", ["C"]))
            .element("O", element("open-amplifier").cords("x1", ["C"]).cords("x0.5", ["O"]))
            .element("FB", element("inverter").cord("in", "O"));
        let stage = |feedback: f64| 1.0 / (feedback + 1e-6);
        let (first, second) = (stage(0.05), stage(0.5));
        let c = -first * drive / (1.0 + first * second);
        assert_near(&solved(builder, ["C", "O"]), &[c, -second * c]);
    }
}

#[test]
fn accelerations_of_three_coupled_inertias_are_solved() {
    // M a = f with M = [[2, 1, 1], [1, 2, 1], [1, 1, 2]] and f = (30, -50, 20) V.
    let row = |gain: &str, reference: &str| {
        element("summer").cords("x1", ["A0", "A1", "A2"]).cords(gain, [reference])
    };
    let builder = volts("inertias")
        .element("A0", row("x0.3", "-100"))
        .element("A1", row("x0.5", "+100"))
        .element("A2", row("x0.2", "-100"));
    assert_near(&solved(builder, ["A0", "A1", "A2"]), &[30.0, -50.0, 20.0]);
}

/// A patch that solves matrix x solution = right-hand side, with one summer per row. A summer feeds itself back unless
/// its entry of the diagonal is 1.
fn system(matrix: &[Vec<f64>], solution: &[f64]) -> PatchBuilder {
    let name = |index: usize| format!("S{index}");
    let mut builder = volts("system");
    for (row, entries) in matrix.iter().enumerate() {
        let mut summer = element("summer");
        let mut side = 0.0;
        for (column, entry) in entries.iter().enumerate() {
            // The summer adds its own output once.
            let gain = if row == column { entry - 1.0 } else { *entry };
            side += entry * solution[column];
            // Rounding may leave a gain that is below the least one of a summer.
            if gain.abs() < 1e-12 {
                continue;
            }
            let from = if gain < 0.0 { format!("N{column}") } else { name(column) };
            summer = summer.cords(&format!("x{}", gain.abs()), [from]);
        }
        let reference = if side > 0.0 { "-100" } else { "+100" };
        summer = summer.cords(&format!("x{}", side.abs() / 100.0), [reference]);
        builder = builder
            .element(&name(row), summer)
            .element(&format!("N{row}"), element("inverter").cord("in", &name(row)));
    }
    builder
}

/// Checks the voltages of a system against its solution.
fn check_system(matrix: &[Vec<f64>], solution: &[f64]) {
    let program = built(system(matrix, solution));
    let machine = run_for(&program, 1e-3, 0.0);
    for (index, expected) in solution.iter().enumerate() {
        let found = voltage(&machine, &format!("S{index}"));
        assert!((found - expected).abs() < 1e-9, "S{index}: {found} instead of {expected}");
    }
}

#[test]
fn a_random_mass_matrix_of_twenty_inertias_is_solved() {
    let mut random = SplitMix64(20);
    let order = 20;
    let factor: Vec<Vec<f64>> =
        (0..order).map(|_| (0..order).map(|_| random.uniform(-0.6, 0.6)).collect()).collect();
    // 1 + F F^T is symmetric and positive definite.
    let product = |i: usize, j: usize| (0..order).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
    let matrix: Vec<Vec<f64>> = (0..order)
        .map(|i| (0..order).map(|j| product(i, j) + if i == j { 1.0 } else { 0.0 }).collect())
        .collect();
    let solution: Vec<f64> = (0..order).map(|_| random.uniform(-90.0, 90.0)).collect();
    check_system(&matrix, &solution);
}

#[test]
fn matrices_with_a_unit_diagonal_are_solved() {
    let mut random = SplitMix64(11);
    let chain = |row: usize, column: usize| match row.abs_diff(column) {
        0 => 1.0,
        1 => 0.49,
        _ => 0.0,
    };
    let power = |row: usize, column: usize| 0.9f64.powi(row.abs_diff(column) as i32);
    for (order, entry) in [(10, &chain as &dyn Fn(usize, usize) -> f64), (60, &chain), (20, &power)] {
        let matrix: Vec<Vec<f64>> =
            (0..order).map(|row| (0..order).map(|column| entry(row, column)).collect()).collect();
        for _ in 0..5 {
            let solution: Vec<f64> = (0..order).map(|_| random.uniform(-90.0, 90.0)).collect();
            check_system(&matrix, &solution);
        }
    }
}

#[test]
fn random_correlation_matrices_are_solved_also_with_outputs_at_their_limits() {
    let mut random = SplitMix64(12);
    for order in [5, 10, 20] {
        let factor: Vec<Vec<f64>> =
            (0..order).map(|_| (0..2 * order).map(|_| random.uniform(-1.0, 1.0)).collect()).collect();
        let product = |i: usize, j: usize| factor[i].iter().zip(&factor[j]).map(|(a, b)| a * b).sum::<f64>();
        let correlation = |i: usize, j: usize| {
            if i == j { 1.0 } else { product(i, j) / (product(i, i) * product(j, j)).sqrt() }
        };
        let matrix: Vec<Vec<f64>> =
            (0..order).map(|i| (0..order).map(|j| correlation(i, j)).collect()).collect();
        for _ in 0..5 {
            let solution: Vec<f64> = (0..order).map(|_| random.uniform(-90.0, 90.0)).collect();
            check_system(&matrix, &solution);
            // With right-hand sides of an unlimited solution up to 300 V, some outputs are at their limits.
            let demanded: Vec<f64> = (0..order).map(|_| random.uniform(-300.0, 300.0)).collect();
            check_limited_system(&matrix, &demanded);
        }
    }
}

/// A symmetric positive definite matrix F F^T / order + 0.01.
fn mass_matrix(random: &mut SplitMix64, order: usize) -> Vec<Vec<f64>> {
    let factor: Vec<Vec<f64>> =
        (0..order).map(|_| (0..order).map(|_| random.uniform(-1.0, 1.0)).collect()).collect();
    let product = |i: usize, j: usize| factor[i].iter().zip(&factor[j]).map(|(a, b)| a * b).sum::<f64>();
    let entry = |i: usize, j: usize| product(i, j) / order as f64 + if i == j { 0.01 } else { 0.0 };
    (0..order).map(|i| (0..order).map(|j| entry(i, j)).collect()).collect()
}

/// An antisymmetric matrix of whole numbers from -10 to 10, without 0.
fn antisymmetric_matrix(random: &mut SplitMix64, order: usize) -> Vec<Vec<f64>> {
    let mut matrix = vec![vec![0.0; order]; order];
    for (row, column) in (0..order).flat_map(|row| (0..row).map(move |column| (row, column))) {
        let entry = (1 + random.below(10)) as f64 * random.choose(&[1.0, -1.0]);
        (matrix[row][column], matrix[column][row]) = (entry, -entry);
    }
    matrix
}

/// The matrix with every row multiplied by a factor.
fn with_scaled_rows(mut matrix: Vec<Vec<f64>>, factor: impl Fn(usize, f64) -> f64) -> Vec<Vec<f64>> {
    for (index, row) in matrix.iter_mut().enumerate() {
        let factor = factor(index, row[index]);
        row.iter_mut().for_each(|entry| *entry *= factor);
    }
    matrix
}

/// Checks a system with random voltages, and with some outputs at their limits.
fn check_random_solutions(random: &mut SplitMix64, matrix: &[Vec<f64>]) {
    let voltages = |random: &mut SplitMix64, highest: f64| -> Vec<f64> {
        (0..matrix.len()).map(|_| random.uniform(-highest, highest)).collect()
    };
    check_system(matrix, &voltages(random, 90.0));
    check_limited_system(matrix, &voltages(random, 300.0));
}

#[test]
fn mass_matrices_with_scaled_rows_are_solved() {
    let mut random = SplitMix64(13);
    for order in [5, 16, 30] {
        let matrix = mass_matrix(&mut random, order);
        // Each summer is solved for its own output: the diagonal is 1.
        let unit = with_scaled_rows(matrix.clone(), |_, own| 1.0 / own);
        check_random_solutions(&mut random, &unit);
        let factors: Vec<f64> = (0..order).map(|_| random.log_uniform(0.3, 10.0)).collect();
        check_random_solutions(&mut random, &with_scaled_rows(matrix, |row, _| factors[row]));
    }
}

#[test]
fn antisymmetric_matrices_plus_one_are_solved() {
    let mut random = SplitMix64(14);
    for order in [12, 20, 40] {
        let mut matrix = antisymmetric_matrix(&mut random, order);
        (0..order).for_each(|index| matrix[index][index] = 1.0);
        check_random_solutions(&mut random, &matrix);
    }
}

#[test]
fn mass_matrices_with_gyroscopic_terms_and_scaled_rows_are_solved() {
    let mut random = SplitMix64(15);
    for order in [10, 16, 30] {
        let (mut matrix, gyroscopic) =
            (mass_matrix(&mut random, order), antisymmetric_matrix(&mut random, order));
        for (row, terms) in matrix.iter_mut().zip(&gyroscopic) {
            row.iter_mut().zip(terms).for_each(|(entry, term)| *entry += 0.05 * term);
        }
        let factors: Vec<f64> = (0..order).map(|_| random.log_uniform(0.3, 3.0)).collect();
        check_random_solutions(&mut random, &with_scaled_rows(matrix, |row, _| factors[row]));
    }
}

#[test]
fn matrices_with_a_negative_determinant_are_refused_also_with_scaled_rows() {
    // A + 3 B = -19 V and 3 A + B = 7 V have the solution (5 V, -8 V). Both ends are solutions too.
    let pair = with_scaled_rows(vec![vec![1.0, 3.0], vec![3.0, 1.0]], |row, _| [0.5, 2.0][row]);
    let report = refusal(system(&pair, &[5.0, -8.0]));
    assert!(report.contains("3 solutions"), "{report}");
    // 1 - 1.5 u u^T with a unit vector u has an eigenvalue of -0.5.
    let mut random = SplitMix64(16);
    let order = 12;
    let direction: Vec<f64> = (0..order).map(|_| random.uniform(0.5, 1.0)).collect();
    let square: f64 = direction.iter().map(|entry| entry * entry).sum();
    let entry =
        |i: usize, j: usize| (if i == j { 1.0 } else { 0.0 }) - 1.5 * direction[i] * direction[j] / square;
    let matrix: Vec<Vec<f64>> = (0..order).map(|i| (0..order).map(|j| entry(i, j)).collect()).collect();
    let factors: Vec<f64> = (0..order).map(|_| random.log_uniform(0.3, 3.0)).collect();
    let scaled = with_scaled_rows(matrix, |row, _| factors[row]);
    let report = refusal(system(&scaled, &[10.0; 12]));
    assert!(report.contains("solutions: "), "{report}");
}

#[test]
fn a_curved_loop_with_many_unknowns_is_refused_quickly() {
    // Every summer adds all others, and one of them a product. The search would begin with 3^19 boxes.
    let order = 20;
    let name = |index: usize| format!("S{index}");
    let builder = (0..order).fold(volts("curved"), |builder, row| {
        let others: Vec<String> = (0..order).filter(|other| *other != row).map(name).collect();
        let sum = element("summer").cords("x1", others);
        builder.element(&name(row), if row == 2 { sum.cords("x1", ["Q"]) } else { sum })
    });
    let product = element("multiplier").set("mode", "product").cord("a", "S0").cord("b", "S1");
    let report = refusal(builder.element("Q", product));
    assert!(report.contains("more pieces than the search examines"), "{report}");
}

/// Checks that the voltages of a system whose unlimited solution is `demanded` satisfy the law of every summer.
fn check_limited_system(matrix: &[Vec<f64>], demanded: &[f64]) {
    let program = built(system(matrix, demanded));
    let machine = run_for(&program, 1e-3, 0.0);
    let found: Vec<f64> = (0..matrix.len()).map(|row| voltage(&machine, &format!("S{row}"))).collect();
    for (row, entries) in matrix.iter().enumerate() {
        let side: f64 = entries.iter().zip(demanded).map(|(entry, volts)| entry * volts).sum();
        let others: f64 =
            (0..matrix.len()).filter(|other| *other != row).map(|other| entries[other] * found[other]).sum();
        // (entry - 1) x output + others = side - output, up to the limit.
        let demand = (side - others - (entries[row] - 1.0) * found[row]).clamp(-100.0, 100.0);
        assert!((found[row] - demand).abs() < 1e-9, "S{row}: {} instead of {demand}", found[row]);
    }
}

#[test]
fn a_random_dominant_system_of_forty_equations_is_solved() {
    let mut random = SplitMix64(40);
    let order = 40;
    let mut matrix: Vec<Vec<f64>> =
        (0..order).map(|_| (0..order).map(|_| random.uniform(-1.0, 1.0)).collect()).collect();
    for (index, row) in matrix.iter_mut().enumerate() {
        row[index] = 1.0 + row.iter().map(|entry| entry.abs()).sum::<f64>();
    }
    let solution: Vec<f64> = (0..order).map(|_| random.uniform(-90.0, 90.0)).collect();
    check_system(&matrix, &solution);
}

#[test]
fn a_resistor_ladder_falls_linearly() {
    // Each node is the mean of its neighbours; the ends are at 100 V and at 0 V.
    let nodes = 60;
    let builder = (1..=nodes).fold(volts("ladder"), |builder, node| {
        let before = if node == 1 { "-100".to_owned() } else { format!("N{}", node - 1) };
        let after = if node == nodes { "ground".to_owned() } else { format!("N{}", node + 1) };
        builder
            .element(&format!("S{node}"), element("summer").cords("x0.5", [before, after]))
            .element(&format!("N{node}"), element("inverter").cord("in", &format!("S{node}")))
    });
    let program = built(builder);
    let machine = run_for(&program, 1e-3, 0.0);
    for node in 1..=nodes {
        let expected = 100.0 * (1.0 - node as f64 / (nodes + 1) as f64);
        let found = voltage(&machine, &format!("S{node}"));
        assert!((found - expected).abs() < 1e-9, "node {node}: {found} instead of {expected}");
    }
}

#[test]
fn twenty_thousand_separate_loops_are_analysed() {
    let count = 20_000;
    // A = 10 - B / 2 and B = -A / 2.
    let builder = (0..count).fold(volts("pairs"), |builder, pair| {
        let [a, b] = ["A", "B"].map(|name| format!("{name}{pair}"));
        builder
            .element(&a, element("summer").cords("x0.5", [&b]).cords("x0.1", ["-100"]))
            .element(&b, element("summer").cords("x0.5", [&a]))
    });
    let program = built(builder);
    assert_eq!(program.loops().len(), count);
    assert!(program.loops().iter().all(|entry| entry.members.len() == 2 && entry.openers().count() == 1));
}
