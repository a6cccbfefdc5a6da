//! The search for polarities.

use super::super::polarity::{Need, Polarities, PolarityNode, choose_polarities, inverter_count};

/// A free node with these needs.
fn free(needs: &[Need]) -> PolarityNode {
    PolarityNode { needs: needs.to_vec(), is_free: true, ..PolarityNode::default() }
}

/// The need of an inverting amplifier for a term with a sign.
fn term(source: usize, sign: i8) -> Need {
    Need::Own { source, sign: -sign }
}

/// The number of inverters that the search finds.
fn inverters(nodes: &[PolarityNode]) -> usize {
    let found = choose_polarities(nodes);
    assert!(nodes.iter().zip(&found.outputs).all(|(node, sign)| node.is_free || *sign == 1));
    inverter_count(nodes, &found)
}

#[test]
fn an_oscillator_needs_one_inverter() {
    assert_eq!(inverters(&[free(&[term(1, 1)]), free(&[term(0, -1)])]), 1);
    // A growing exponential x'' = x needs none: both integrators invert.
    assert_eq!(inverters(&[free(&[term(1, 1)]), free(&[term(0, 1)])]), 0);
}

#[test]
fn neighbours_of_a_rod_alternate() {
    let cells = 300;
    let neighbours = |cell: usize| {
        let left = cell.checked_sub(1).map(|left| term(left, 1));
        let right = (cell + 1 < cells).then(|| term(cell + 1, 1));
        [Some(term(cell, -1)), left, right].into_iter().flatten().collect::<Vec<Need>>()
    };
    let rod: Vec<PolarityNode> = (0..cells).map(|cell| free(&neighbours(cell))).collect();
    assert_eq!(inverters(&rod), 0);
}

#[test]
fn a_drive_is_positive_and_the_reference_has_both_polarities() {
    let drive = PolarityNode::default();
    let reference = PolarityNode { has_both: true, ..PolarityNode::default() };
    // y = drive + 1 can be negative.
    assert_eq!(inverters(&[drive.clone(), reference.clone(), free(&[term(0, 1), term(1, 1)])]), 0);
    // A root needs the negative of its radicand.
    let root = PolarityNode { needs: vec![Need::Fixed { source: 0, sign: -1 }], ..PolarityNode::default() };
    assert_eq!(inverters(&[drive, root.clone()]), 1);
    assert_eq!(inverters(&[reference, root]), 0);
}

#[test]
fn a_square_is_negative_only_with_both_polarities_of_its_factor() {
    let square = |sources| Need::Factors { sources, signs: [1, 1] };
    // y = -x^2 with x positive: the square is positive, and so is the input of the sum.
    let nodes = [PolarityNode::default(), free(&[square([0, 0])]), free(&[term(1, -1)])];
    assert_eq!(inverters(&nodes), 0);
    let needs_negative =
        PolarityNode { needs: vec![Need::Fixed { source: 1, sign: -1 }], ..nodes[0].clone() };
    let nodes = [nodes[0].clone(), nodes[1].clone(), needs_negative];
    assert_eq!(inverters(&nodes), 1);
}

#[test]
fn an_absolute_value_needs_an_inverter() {
    assert_eq!(inverters(&[free(&[]), free(&[Need::Both { source: 0 }])]), 1);
}

/// A number from 0 to below `count`, the same on every machine.
fn number(state: &mut u64, count: usize) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize % count
}

/// A random graph of summers and multipliers.
fn random_graph(seed: u64, size: usize) -> Vec<PolarityNode> {
    let mut state = seed;
    let sign = |state: &mut u64| if number(state, 2) == 0 { 1 } else { -1 };
    let mut nodes = Vec::new();
    for _ in 0..size {
        let mut needs = Vec::new();
        for _ in 0..1 + number(&mut state, 3) {
            needs.push(term(number(&mut state, size), sign(&mut state)));
        }
        if number(&mut state, 4) == 0 {
            let sources = [number(&mut state, size), number(&mut state, size)];
            needs = vec![Need::Factors { sources, signs: [sign(&mut state), sign(&mut state)] }];
        }
        nodes.push(PolarityNode { is_free: number(&mut state, 8) > 0, ..free(&needs) });
    }
    nodes
}

/// The smallest number of inverters of a graph of 6 nodes, from all assignments.
fn fewest_inverters(nodes: &[PolarityNode]) -> usize {
    let counts = (0..1u32 << 12).map(|bits| {
        let sign = |index: usize| if (bits >> index) & 1 == 0 { 1 } else { -1 };
        let outputs = (0..6).map(|index| if nodes[index].is_free { sign(index) } else { 1 }).collect();
        let first_factors = (6..12).map(sign).collect();
        inverter_count(nodes, &Polarities { outputs, first_factors })
    });
    counts.min().unwrap()
}

#[test]
fn small_graphs_have_the_fewest_inverters() {
    for seed in 0..60 {
        let nodes = random_graph(seed, 6);
        assert_eq!(inverters(&nodes), fewest_inverters(&nodes), "graph {seed}");
    }
}

#[test]
fn large_graphs_have_no_more_inverters_than_outputs_and_than_with_positive_outputs() {
    for seed in 0..20 {
        let nodes = random_graph(seed, 50);
        let positive = Polarities { outputs: vec![1; nodes.len()], first_factors: vec![1; nodes.len()] };
        let most = inverter_count(&nodes, &positive).min(nodes.len());
        assert!(inverters(&nodes) <= most, "graph {seed}");
    }
}

#[test]
fn the_search_gives_the_same_polarities_each_time() {
    let nodes = random_graph(7, 100);
    assert_eq!(choose_polarities(&nodes), choose_polarities(&nodes));
}
