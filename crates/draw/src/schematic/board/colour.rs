//! The colours of the cords.
//!
//! All cords of one output (a net) have the same colour. Nets are coloured one after the other, the net
//! with the fewest remaining colours first. Each gets the colour that is not yet at its modules and is
//! least used close to its cords.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::{Cord, Module};
use crate::plot::Ink;
use crate::schematic::layout::Point;

/// The side of the cells in which cords count as close to each other.
const CELL: f64 = 32.0;
/// The weight of the ends of a cord; its other points have the weight 1.
const END_WEIGHT: f64 = 100.0;

/// The weight of a net in each cell.
type CellWeights = BTreeMap<(i64, i64), f64>;

/// The cords of one output.
struct CordNet {
    /// The indices of its cords, in ascending order.
    cords: Vec<usize>,
    /// The modules at both ends of the cords.
    modules: BTreeSet<usize>,
    /// The weights of the cells on and next to the cords.
    weights: CellWeights,
}

/// The colours that are assigned already.
struct UsedColours {
    /// For each module, the colours at it as bits.
    at_module: Vec<u32>,
    /// For each cell, the sum of the weights of each colour.
    in_cell: BTreeMap<(i64, i64), [f64; Ink::CORD_COLOURS]>,
    /// For each colour, the number of nets.
    count: [usize; Ink::CORD_COLOURS],
}

/// Assigns a colour to each cord.
pub(super) fn colour(cords: &mut [Cord], modules: &[Module]) {
    let mut nets = nets(cords, modules);
    let mut used = UsedColours {
        at_module: vec![0; modules.len()],
        in_cell: BTreeMap::new(),
        count: [0; Ink::CORD_COLOURS],
    };
    let priority = |net: &CordNet, used: &UsedColours| {
        (
            used.colours_at_modules(net).count_ones(),
            net.modules.len(),
            net.weights.len(),
            Reverse(net.cords[0]),
        )
    };
    while let Some(next) = (0..nets.len()).max_by_key(|index| priority(&nets[*index], &used)) {
        let net = nets.swap_remove(next);
        let colour = used.assign(&net);
        net.cords.iter().for_each(|index| cords[*index].colour = colour);
    }
}

impl UsedColours {
    /// Returns the colours of other nets at the modules of a net, as bits.
    fn colours_at_modules(&self, net: &CordNet) -> u32 {
        net.modules.iter().fold(0, |colours, module| colours | self.at_module[*module])
    }

    /// Chooses the best colour for a net and records it.
    fn assign(&mut self, net: &CordNet) -> usize {
        let at_modules = self.colours_at_modules(net);
        let weight_nearby = |colour: usize| -> f64 {
            net.weights
                .iter()
                .filter_map(|(cell, weight)| Some(weight * self.in_cell.get(cell)?[colour]))
                .sum()
        };
        let is_at_modules = |colour: usize| at_modules >> colour & 1;
        let better = |one: &usize, other: &usize| {
            let (one, other) = (*one, *other);
            let by_position = is_at_modules(one)
                .cmp(&is_at_modules(other))
                .then(weight_nearby(one).total_cmp(&weight_nearby(other)));
            by_position.then(self.count[one].cmp(&self.count[other]))
        };
        let colour = (0..Ink::CORD_COLOURS).min_by(better).unwrap_or_default();
        self.count[colour] += 1;
        net.modules.iter().for_each(|module| self.at_module[*module] |= 1 << colour);
        let cells = net.weights.iter();
        cells.for_each(|(cell, weight)| self.in_cell.entry(*cell).or_default()[colour] += weight);
        colour
    }
}

/// Groups the cords by output.
fn nets(cords: &[Cord], modules: &[Module]) -> Vec<CordNet> {
    let mut outputs: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, cord) in cords.iter().enumerate() {
        outputs.entry(&cord.from).or_default().push(index);
    }
    let net = |indices: Vec<usize>| {
        let ends = indices.iter().flat_map(|index| cords[*index].ends);
        let modules = ends.filter_map(|end| modules.iter().position(|module| module.contains(end)));
        CordNet {
            modules: modules.collect(),
            weights: cell_weights(indices.iter().map(|index| &cords[*index])),
            cords: indices,
        }
    };
    outputs.into_values().map(net).collect()
}

/// Returns the weights of the cells on and next to cords.
fn cell_weights<'a>(cords: impl Iterator<Item = &'a Cord>) -> CellWeights {
    let mut weights = CellWeights::new();
    for cord in cords {
        let points =
            cord.points.iter().map(|at| (at, 1.0)).chain(cord.ends.iter().map(|at| (at, END_WEIGHT)));
        for (at, weight) in points {
            for cell in cells(*at) {
                let stored = weights.entry(cell).or_default();
                *stored = stored.max(weight);
            }
        }
    }
    weights
}

/// Returns the four cells nearest to a point.
///
/// A cord near the edge of a cell therefore also counts in the neighbouring cell.
fn cells((x, y): Point) -> impl Iterator<Item = (i64, i64)> {
    let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)];
    corners
        .into_iter()
        .map(move |(across, down)| ((x / CELL + across).floor() as i64, (y / CELL + down).floor() as i64))
}
