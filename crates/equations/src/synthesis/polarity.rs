//! The polarities of all outputs, chosen so that few inverters are necessary.
//!
//! Every summing amplifier inverts. An output with the value q of a node is +q or -q, and a user that needs the other
//! sign needs an inverter, which all users share. A local search begins with four assignments: all outputs positive, all
//! negative, alternating, and one that follows the cords from node to node. In each it reverses one output, an output
//! together with one of its sources, or the factors of a product, if the number of inverters falls. It stops if no change
//! helps. If there are few polarities, all assignments are then tried, so the number of inverters is the smallest one. Of
//! equal numbers of inverters, the one with more positive quantities is better.

/// At most this number of rounds of changes are tried.
const MOST_ROUNDS: usize = 50;
/// Up to this number of polarities, all assignments are tried.
const MOST_EXACT: usize = 16;

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
    let changes = changes(nodes);
    let searched = starts.map(|start| improved(nodes, start, &changes));
    let best = searched.min_by_key(Search::cost);
    let best = best.unwrap_or_else(|| Search::new(nodes, all_positive(nodes)));
    best_of_all(nodes, &best).unwrap_or(best.polarities)
}

/// The number of inverters that an assignment needs, counted without the search.
#[cfg(test)]
pub(super) fn inverter_count(nodes: &[PolarityNode], polarities: &Polarities) -> usize {
    let mut inverted = vec![false; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for need in &node.needs {
            let (own, first_factor) = (polarities.outputs[index], polarities.first_factors[index]);
            need.for_each(own, first_factor, &mut |source, polarity| {
                inverted[source] |= polarity != polarities.outputs[source] && !nodes[source].has_both;
            });
        }
    }
    inverted.into_iter().filter(|is_inverted| *is_inverted).count()
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

/// An assignment after all changes that make it better.
fn improved<'n>(nodes: &'n [PolarityNode], start: Polarities, changes: &[Change]) -> Search<'n> {
    let mut search = Search::new(nodes, start);
    for _ in 0..MOST_ROUNDS {
        let before = search.cost();
        for change in changes {
            let best = search.cost();
            search.make(change);
            if search.cost() >= best {
                search.make(change);
            }
        }
        if search.cost() == before {
            break;
        }
    }
    search
}

/// The best of all assignments. `None` if none is better than the one that was found, or if there are too many.
fn best_of_all(nodes: &[PolarityNode], found: &Search<'_>) -> Option<Polarities> {
    let free = (0..nodes.len()).filter(|index| nodes[*index].is_free);
    let products = (0..nodes.len()).filter(|index| nodes[*index].is_product());
    let outputs = free.map(|index| Change { outputs: vec![index], first_factors: Vec::new() });
    let factors = products.map(|index| Change { outputs: Vec::new(), first_factors: vec![index] });
    let changes: Vec<Change> = outputs.chain(factors).collect();
    if changes.len() > MOST_EXACT {
        return None;
    }
    let mut search = Search::new(nodes, found.polarities.clone());
    let (mut least, mut best) = (found.cost(), None);
    // In the Gray code, each assignment differs from the last one in one polarity.
    for step in 1..1_u32 << changes.len() {
        search.make(&changes[step.trailing_zeros() as usize]);
        if search.cost() < least {
            (least, best) = (search.cost(), Some(search.polarities.clone()));
        }
    }
    best
}

/// An assignment whose cost is known after every change.
struct Search<'n> {
    /// The nodes.
    nodes: &'n [PolarityNode],
    /// The assignment.
    polarities: Polarities,
    /// For each node, how many needs there are for its positive and for its negative polarity.
    needs: Vec<[u32; 2]>,
    /// The number of inverters.
    inverters: usize,
    /// The number of negative quantities.
    negatives: usize,
}

impl<'n> Search<'n> {
    /// The search at an assignment.
    fn new(nodes: &'n [PolarityNode], polarities: Polarities) -> Self {
        let negative =
            nodes.iter().zip(&polarities.outputs).filter(|(node, sign)| node.is_named && **sign < 0);
        let negatives = negative.count();
        let needs = vec![[0; 2]; nodes.len()];
        let mut search = Search { nodes, polarities, needs, inverters: 0, negatives };
        (0..nodes.len()).for_each(|index| search.add_needs(index));
        search
    }

    /// The quality of the assignment.
    fn cost(&self) -> Cost {
        (self.inverters, self.negatives)
    }

    /// Makes a change, or takes it back.
    fn make(&mut self, change: &Change) {
        change.outputs.iter().for_each(|index| self.reverse_output(*index));
        for index in &change.first_factors {
            self.remove_needs(*index);
            self.polarities.first_factors[*index] *= -1;
            self.add_needs(*index);
        }
    }

    /// Reverses the output of a node.
    fn reverse_output(&mut self, index: usize) {
        self.remove_needs(index);
        let was_inverted = self.is_inverted(index);
        let output = &mut self.polarities.outputs[index];
        *output *= -1;
        if self.nodes[index].is_named {
            self.negatives = if *output < 0 { self.negatives + 1 } else { self.negatives - 1 };
        }
        self.count_inverter(index, was_inverted);
        self.add_needs(index);
    }

    /// Adds what a node needs from others.
    fn add_needs(&mut self, index: usize) {
        self.for_each_need(index, &mut |search, source, side| {
            let was_inverted = search.is_inverted(source);
            search.needs[source][side] += 1;
            search.count_inverter(source, was_inverted);
        });
    }

    /// Removes what a node needs from others.
    fn remove_needs(&mut self, index: usize) {
        self.for_each_need(index, &mut |search, source, side| {
            let was_inverted = search.is_inverted(source);
            search.needs[source][side] -= 1;
            search.count_inverter(source, was_inverted);
        });
    }

    /// Calls a function with each output that a node needs, and with 0 if it needs the positive polarity, otherwise 1.
    fn for_each_need(&mut self, index: usize, call: &mut dyn FnMut(&mut Self, usize, usize)) {
        let nodes = self.nodes;
        let (own, first) = (self.polarities.outputs[index], self.polarities.first_factors[index]);
        for need in &nodes[index].needs {
            need.for_each(own, first, &mut |source, polarity| call(self, source, side(polarity)));
        }
    }

    /// Whether a node needs an inverter.
    fn is_inverted(&self, index: usize) -> bool {
        let other = 1 - side(self.polarities.outputs[index]);
        !self.nodes[index].has_both && self.needs[index][other] > 0
    }

    /// Counts the inverter of a node after a change.
    fn count_inverter(&mut self, index: usize, was_inverted: bool) {
        match (was_inverted, self.is_inverted(index)) {
            (false, true) => self.inverters += 1,
            (true, false) => self.inverters -= 1,
            _ => {}
        }
    }
}

/// The place of a polarity in a pair: 0 for the positive one.
fn side(polarity: i8) -> usize {
    usize::from(polarity < 0)
}

/// A change of an assignment: the outputs and the first factors whose polarities are reversed. It is its own inverse.
struct Change {
    /// The nodes whose outputs are reversed.
    outputs: Vec<usize>,
    /// The products whose first factors are reversed.
    first_factors: Vec<usize>,
}

/// The changes that the search tries: one output or an output and one of its sources, each with and without the first
/// factor of a product.
fn changes(nodes: &[PolarityNode]) -> Vec<Change> {
    let mut changes = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
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
        if node.is_product() {
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

impl PolarityNode {
    /// Whether the node is a product.
    fn is_product(&self) -> bool {
        self.needs.iter().any(|need| matches!(need, Need::Factors { .. }))
    }
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
