//! The polarities of all outputs, chosen so that few inverters are necessary.
//!
//! Every summing amplifier inverts. An output with the value q of a node is +q or -q, and a user that needs the other
//! sign needs an inverter, which all users share. This is a local search. It begins with four assignments: all outputs
//! positive, all negative, alternating, and one that follows the cords from node to node. In each it reverses one output,
//! an output together with one of its sources, or the factors of a product, if the number of inverters falls. It stops if
//! no change helps. Of equal numbers of inverters, the one with more positive quantities is better.

/// At most this number of rounds of changes are tried.
const MOST_ROUNDS: usize = 50;

/// What a node needs from the output of another node. A sign is 1 or -1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Need {
    /// The polarity of the node times a sign.
    Own {
        /// The other node.
        source: usize,
        /// The sign.
        sign: i8,
    },
    /// This polarity.
    Fixed {
        /// The other node.
        source: usize,
        /// The polarity.
        sign: i8,
    },
    /// Both polarities.
    Both {
        /// The other node.
        source: usize,
    },
    /// Two polarities whose product is that of the node, each times a sign.
    Factors {
        /// The other nodes, which can be the same.
        sources: [usize; 2],
        /// The sign of each.
        signs: [i8; 2],
    },
}

/// A node in the search.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct PolarityNode {
    /// What it needs from others.
    pub needs: Vec<Need>,
    /// Whether its polarity can be negative.
    pub is_free: bool,
    /// Whether both polarities exist without an inverter, as of the reference voltage.
    pub has_both: bool,
    /// Whether it is a quantity for a reader.
    pub is_named: bool,
}

/// The polarities of all nodes: 1 or -1.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Polarities {
    /// The polarity of the output of each node.
    pub outputs: Vec<i8>,
    /// The polarity with which each product uses its first factor.
    pub first_factors: Vec<i8>,
}

/// The quality of an assignment: the number of inverters, and then the number of negative quantities.
type Cost = (usize, usize);

/// The polarities with the fewest inverters that the search finds.
pub(super) fn choose_polarities(nodes: &[PolarityNode]) -> Polarities {
    let negative = assignment(nodes, &|_| -1);
    let alternating = assignment(nodes, &|index| if index % 2 == 0 { 1 } else { -1 });
    let starts = [all_positive(nodes), along_cords(nodes), negative, alternating].into_iter();
    let searched = starts.map(|start| improved(nodes, start));
    let best = searched.min_by_key(|(_, cost)| *cost);
    best.map_or_else(|| all_positive(nodes), |(polarities, _)| polarities)
}

/// Number of inverters that an assignment needs.
#[cfg(test)]
pub(super) fn inverter_count(nodes: &[PolarityNode], polarities: &Polarities) -> usize {
    cost(nodes, polarities, &mut vec![false; nodes.len()]).0
}

/// The assignment in which every polarity is positive.
fn all_positive(nodes: &[PolarityNode]) -> Polarities {
    assignment(nodes, &|_| 1)
}

/// An assignment with these polarities of the free outputs, by index.
fn assignment(nodes: &[PolarityNode], sign: &dyn Fn(usize) -> i8) -> Polarities {
    let outputs = nodes.iter().enumerate().map(|(index, node)| if node.is_free { sign(index) } else { 1 });
    Polarities { outputs: outputs.collect(), first_factors: vec![1; nodes.len()] }
}

/// An assignment that follows the cords: each node gets the polarity that its first reached neighbour needs.
fn along_cords(nodes: &[PolarityNode]) -> Polarities {
    let mut neighbours: Vec<Vec<(usize, i8)>> = vec![Vec::new(); nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for need in &node.needs {
            if let Need::Own { source, sign } = *need {
                neighbours[index].push((source, sign));
                neighbours[source].push((index, sign));
            }
        }
    }
    let mut polarities = all_positive(nodes);
    let mut is_reached: Vec<bool> = nodes.iter().map(|node| !node.is_free || node.has_both).collect();
    let starts = |is_free: bool| {
        (0..nodes.len()).filter(move |index| nodes[*index].is_free == is_free && !nodes[*index].has_both)
    };
    for start in starts(false).chain(starts(true)) {
        is_reached[start] = true;
        let mut open = vec![start];
        while let Some(index) = open.pop() {
            for (neighbour, sign) in &neighbours[index] {
                if !std::mem::replace(&mut is_reached[*neighbour], true) {
                    polarities.outputs[*neighbour] = polarities.outputs[index] * sign;
                    open.push(*neighbour);
                }
            }
        }
    }
    polarities
}

/// An assignment after all changes that make it better, with its cost.
fn improved(nodes: &[PolarityNode], mut polarities: Polarities) -> (Polarities, Cost) {
    let mut inverted = vec![false; nodes.len()];
    let mut best = cost(nodes, &polarities, &mut inverted);
    let changes = changes(nodes);
    for _ in 0..MOST_ROUNDS {
        let before = best;
        for change in &changes {
            change.apply(&mut polarities);
            let changed = cost(nodes, &polarities, &mut inverted);
            if changed < best {
                best = changed;
            } else {
                change.apply(&mut polarities);
            }
        }
        if best == before {
            break;
        }
    }
    (polarities, best)
}

/// A change of an assignment: the outputs and the first factors whose polarities are reversed. It is its own inverse.
struct Change {
    /// The nodes whose outputs are reversed.
    outputs: Vec<usize>,
    /// The products whose first factors are reversed.
    first_factors: Vec<usize>,
}

impl Change {
    /// Makes the change, or takes it back.
    fn apply(&self, polarities: &mut Polarities) {
        self.outputs.iter().for_each(|index| polarities.outputs[*index] *= -1);
        self.first_factors.iter().for_each(|index| polarities.first_factors[*index] *= -1);
    }
}

/// The changes that the search tries: one output or an output and one of its sources, each with and without the first
/// factor of a product.
fn changes(nodes: &[PolarityNode]) -> Vec<Change> {
    let mut changes = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
        let is_product = node.needs.iter().any(|need| matches!(need, Need::Factors { .. }));
        let own: Vec<usize> = node.is_free.then_some(index).into_iter().collect();
        let sources = node.needs.iter().flat_map(Need::sources);
        let others: Vec<usize> =
            sources.filter(|source| nodes[*source].is_free && *source != index).collect();
        let mut push = |outputs: Vec<usize>, first_factors: Vec<usize>| {
            if !outputs.is_empty() || !first_factors.is_empty() {
                changes.push(Change { outputs, first_factors });
            }
        };
        push(own.clone(), Vec::new());
        for source in &others {
            push([own.as_slice(), &[*source]].concat(), Vec::new());
        }
        if is_product {
            push(Vec::new(), vec![index]);
            push(own.clone(), vec![index]);
            for source in &others {
                push(vec![*source], vec![index]);
                push([own.as_slice(), &[*source]].concat(), vec![index]);
            }
        }
    }
    changes
}

impl Need {
    /// The nodes whose outputs are needed.
    fn sources(&self) -> Vec<usize> {
        match *self {
            Need::Own { source, .. } | Need::Fixed { source, .. } | Need::Both { source } => vec![source],
            Need::Factors { sources, .. } => sources.to_vec(),
        }
    }

    /// Calls a function with each output that a node needs and the polarity that it needs, for the polarities of the node
    /// and of its first factor.
    fn for_each(&self, own: i8, first_factor: i8, call: &mut dyn FnMut(usize, i8)) {
        match *self {
            Need::Own { source, sign } => call(source, own * sign),
            Need::Fixed { source, sign } => call(source, sign),
            Need::Both { source } => [1, -1].into_iter().for_each(|sign| call(source, sign)),
            Need::Factors { sources, signs } => {
                call(sources[0], first_factor * signs[0]);
                call(sources[1], own * first_factor * signs[1]);
            }
        }
    }
}

/// The cost of an assignment. `inverted` is overwritten; it has an entry for each node.
fn cost(nodes: &[PolarityNode], polarities: &Polarities, inverted: &mut [bool]) -> Cost {
    inverted.fill(false);
    for (index, node) in nodes.iter().enumerate() {
        for need in &node.needs {
            let (own, first_factor) = (polarities.outputs[index], polarities.first_factors[index]);
            need.for_each(own, first_factor, &mut |source, polarity| {
                inverted[source] |= polarity != polarities.outputs[source] && !nodes[source].has_both;
            });
        }
    }
    let inverters = inverted.iter().filter(|is_inverted| **is_inverted).count();
    let negatives = nodes.iter().zip(&polarities.outputs).filter(|(node, sign)| node.is_named && **sign < 0);
    (inverters, negatives.count())
}
