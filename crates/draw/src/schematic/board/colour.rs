//! Colours of cords: those from one output alike, those that meet at a module or run near each other different.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::{Cord, Module};
use crate::plot::Ink;
use crate::schematic::layout::Point;

/// Side of the cells in which cords count as near each other, and how much more than their ways their ends count.
const NEAR: f64 = 32.0;
const ENDS: f64 = 100.0;

/// Cells with how much a net counts in each.
type Room = BTreeMap<(i64, i64), f64>;

/// The cords of one output.
struct Net {
    cords: Vec<usize>,
    /// The modules that they come from and go to.
    modules: BTreeSet<usize>,
    /// The cells on and beside them.
    room: Room,
}

/// Colours that nets have already: by module as bits, by cell as what they count, and how often each.
struct Taken {
    at_module: Vec<u32>,
    in_cell: BTreeMap<(i64, i64), [f64; Ink::CORDS]>,
    used: [usize; Ink::CORDS],
}

/// Colours cords; the nets that have the fewest colours left come first.
pub(super) fn colour(cords: &mut [Cord], modules: &[Module]) {
    let mut nets = nets(cords, modules);
    let mut taken =
        Taken { at_module: vec![0; modules.len()], in_cell: BTreeMap::new(), used: [0; Ink::CORDS] };
    let urgent = |net: &Net, taken: &Taken| {
        (taken.met(net).count_ones(), net.modules.len(), net.room.len(), Reverse(net.cords[0]))
    };
    while let Some(next) = (0..nets.len()).max_by_key(|index| urgent(&nets[*index], &taken)) {
        let net = nets.swap_remove(next);
        let colour = taken.give(&net);
        net.cords.iter().for_each(|index| cords[*index].colour = colour);
    }
}

impl Taken {
    /// The colours of the nets that a net meets at a module, as bits.
    fn met(&self, net: &Net) -> u32 {
        net.modules.iter().fold(0, |met, module| met | self.at_module[*module])
    }

    /// Takes the best colour for a net.
    fn give(&mut self, net: &Net) -> usize {
        let met = self.met(net);
        let near = |colour: usize| -> f64 {
            net.room.iter().filter_map(|(cell, weight)| Some(weight * self.in_cell.get(cell)?[colour])).sum()
        };
        let meets = |colour: usize| met >> colour & 1;
        let better = |one: &usize, other: &usize| {
            let (one, other) = (*one, *other);
            let by_place = meets(one).cmp(&meets(other)).then(near(one).total_cmp(&near(other)));
            by_place.then(self.used[one].cmp(&self.used[other]))
        };
        let colour = (0..Ink::CORDS).min_by(better).unwrap_or_default();
        self.used[colour] += 1;
        net.modules.iter().for_each(|module| self.at_module[*module] |= 1 << colour);
        let cells = net.room.iter();
        cells.for_each(|(cell, weight)| self.in_cell.entry(*cell).or_default()[colour] += weight);
        colour
    }
}

fn nets(cords: &[Cord], modules: &[Module]) -> Vec<Net> {
    let mut outputs: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, cord) in cords.iter().enumerate() {
        outputs.entry(&cord.from).or_default().push(index);
    }
    let net = |own: Vec<usize>| {
        let ends = own.iter().flat_map(|index| cords[*index].ends);
        let modules = ends.filter_map(|end| modules.iter().position(|module| module.holds(end)));
        Net { modules: modules.collect(), room: room(own.iter().map(|index| &cords[*index])), cords: own }
    };
    outputs.into_values().map(net).collect()
}

/// The cells on and beside cords, each with how much it counts.
fn room<'a>(cords: impl Iterator<Item = &'a Cord>) -> Room {
    let mut room = Room::new();
    for cord in cords {
        let way = cord.points.iter().map(|at| (at, 1.0)).chain(cord.ends.iter().map(|at| (at, ENDS)));
        for (at, weight) in way {
            for cell in cells(*at) {
                let held = room.entry(cell).or_default();
                *held = held.max(weight);
            }
        }
    }
    room
}

/// The four cells nearest to a point.
fn cells((x, y): Point) -> impl Iterator<Item = (i64, i64)> {
    let corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)];
    corners
        .into_iter()
        .map(move |(across, down)| ((x / NEAR + across).floor() as i64, (y / NEAR + down).floor() as i64))
}
