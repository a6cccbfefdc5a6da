//! The order of items in their layers, so that few cords cross.

use std::cmp::Ordering;

use super::Graph;
use super::wires::{Jack, Pin, Row, Sheet, What};

/// Sweeps over the layers, each in both directions.
const SWEEPS: usize = 14;

/// Orders every row, and with it the inputs that may be exchanged.
pub(super) fn reduce(graph: &Graph, rank: &[usize], sheet: &mut Sheet) {
    for row in 0..sheet.rows.len() {
        let mut best: Option<(usize, Vec<Vec<usize>>)> = None;
        for turned in [false, true] {
            begin(rank, &mut sheet.rows[row], turned);
            let mut sorter = Sorter { graph, row: &mut sheet.rows[row], slots: &mut sheet.slots };
            sorter.sort();
            let crossings = sorter.all_crossings();
            if best.as_ref().is_none_or(|(least, _)| crossings < *least) {
                best = Some((crossings, sheet.rows[row].layers.clone()));
            }
        }
        if let Some((_, layers)) = best {
            sheet.rows[row].layers = layers;
        }
        Sorter { graph, row: &mut sheet.rows[row], slots: &mut sheet.slots }.exchange_inputs();
    }
}

/// The first order: that of reading.
fn begin(rank: &[usize], row: &mut Row, turned: bool) {
    let Row { items, layers, .. } = row;
    let key = |item: &usize| match items[*item].what {
        What::Node(node) => (0, rank[node] as isize * if turned { -1 } else { 1 }),
        What::Through(net) => (1, net as isize),
    };
    layers.iter_mut().for_each(|layer| layer.sort_by_key(key));
}

struct Sorter<'a> {
    graph: &'a Graph,
    row: &'a mut Row,
    slots: &'a mut [Vec<usize>],
}

/// Places of a net on the two sides of a channel, counted in items.
type Strand = (f64, f64);

impl Sorter<'_> {
    fn sort(&mut self) {
        let mut best = (usize::MAX, self.row.layers.clone());
        for _ in 0..SWEEPS {
            let layers = self.row.layers.len();
            (1..layers).for_each(|layer| self.by_neighbours(layer, layer, false));
            (0..layers).rev().for_each(|layer| self.by_neighbours(layer, layer + 1, true));
            self.exchange_inputs();
            self.swap_neighbours();
            let crossings = self.all_crossings();
            if crossings < best.0 {
                best = (crossings, self.row.layers.clone());
            }
        }
        self.row.layers = best.1;
        self.exchange_inputs();
    }

    /// Places of all items of the row.
    fn places(&self) -> Vec<f64> {
        let mut places = vec![0.0; self.row.items.len()];
        for layer in &self.row.layers {
            for (place, item) in layer.iter().enumerate() {
                places[*item] = place as f64;
            }
        }
        places
    }

    /// Place of a pin: that of its item and a little for which input it is.
    fn place(&self, places: &[f64], pin: Pin) -> f64 {
        let share = match (self.row.items[pin.item].what, pin.jack) {
            (What::Node(node), Jack::Input(input)) => {
                (self.slots[node][input] as f64 + 1.0) / (self.slots[node].len() as f64 + 1.0)
            }
            (What::Node(node), Jack::Output(outlet)) => {
                (outlet as f64 + 1.0) / (self.graph.nodes[node].outputs.len() as f64 + 1.0)
            }
            _ => 0.5,
        };
        places[pin.item] + share
    }

    /// The strands of a channel. Streets lie beyond the first and the last item of a layer.
    fn strands(&self, places: &[f64], channel: usize) -> Vec<(Strand, Option<usize>, Option<usize>)> {
        let end = |layer: Option<&Vec<usize>>| layer.map_or(1.0, |layer| layer.len() as f64 + 1.0);
        let left_end = end(channel.checked_sub(1).and_then(|left| self.row.layers.get(left)));
        let right_end = end(self.row.layers.get(channel));
        let mut strands = Vec::new();
        for trunk in &self.row.channels[channel] {
            let streets = [(trunk.up, -1.0, -1.0), (trunk.down, left_end, right_end)];
            let streets = streets.into_iter().filter(|(used, ..)| *used);
            match trunk.left {
                Some(left) => {
                    let from = self.place(places, left);
                    let to = trunk.right.iter();
                    strands.extend(
                        to.map(|to| ((from, self.place(places, *to)), Some(left.item), Some(to.item))),
                    );
                    strands.extend(streets.map(|(_, _, to)| ((from, to), Some(left.item), None)));
                }
                None => {
                    for (_, from, _) in streets {
                        let to = trunk.right.iter();
                        strands.extend(to.map(|to| ((from, self.place(places, *to)), None, Some(to.item))));
                    }
                }
            }
        }
        strands
    }

    /// Sorts a layer by the mean place of what its items are joined to over one of its channels.
    fn by_neighbours(&mut self, layer: usize, channel: usize, is_left: bool) {
        let places = self.places();
        let mut sums = vec![(0.0, 0.0); self.row.items.len()];
        for ((from, to), left, right) in self.strands(&places, channel) {
            let (item, other) = if is_left { (left, to) } else { (right, from) };
            if let Some(item) = item {
                sums[item].0 += other;
                sums[item].1 += 1.0;
            }
        }
        let mean = |item: &usize| match sums[*item] {
            (_, 0.0) => places[*item] + 0.5,
            (sum, count) => sum / count,
        };
        self.row.layers[layer].sort_by(|a, b| compare(mean(a), mean(b)));
    }

    /// Exchanges neighbours in a layer as long as that saves crossings.
    fn swap_neighbours(&mut self) {
        for layer in 0..self.row.layers.len() {
            let mut crossings = self.crossings_at(layer);
            for upper in 1..self.row.layers[layer].len() {
                self.row.layers[layer].swap(upper - 1, upper);
                let swapped = self.crossings_at(layer);
                if swapped < crossings {
                    crossings = swapped;
                } else {
                    self.row.layers[layer].swap(upper - 1, upper);
                }
            }
        }
    }

    fn crossings_at(&self, layer: usize) -> usize {
        let places = self.places();
        self.crossings(&places, layer) + self.crossings(&places, layer + 1)
    }

    fn all_crossings(&self) -> usize {
        let places = self.places();
        (0..self.row.channels.len()).map(|channel| self.crossings(&places, channel)).sum()
    }

    fn crossings(&self, places: &[f64], channel: usize) -> usize {
        let strands = self.strands(places, channel);
        let crosses = |one: &Strand, other: &Strand| (one.0 - other.0) * (one.1 - other.1) < 0.0;
        let later = |index: usize| strands[index + 1..].iter();
        let one = |(index, (one, ..)): (usize, &(Strand, _, _))| {
            later(index).filter(|(other, ..)| crosses(one, other)).count()
        };
        strands.iter().enumerate().map(one).sum()
    }

    /// Inputs that may be exchanged stand in the order of what they come from.
    fn exchange_inputs(&mut self) {
        let places = self.places();
        let mut sources: Vec<Vec<f64>> = self.slots.iter().map(|slots| vec![0.0; slots.len()]).collect();
        for channel in &self.row.channels {
            for trunk in channel {
                let street = if trunk.up { -1.0 } else { f64::INFINITY };
                let from = trunk.left.map_or(street, |left| self.place(&places, left));
                for pin in &trunk.right {
                    if let (What::Node(node), Jack::Input(input)) = (self.row.items[pin.item].what, pin.jack)
                    {
                        sources[node][input] = from;
                    }
                }
            }
        }
        for item in &self.row.items {
            if let What::Node(node) = item.what {
                let mut order: Vec<usize> = (0..self.graph.nodes[node].free).collect();
                order.sort_by(|a, b| compare(sources[node][*a], sources[node][*b]));
                order.iter().enumerate().for_each(|(slot, input)| self.slots[node][*input] = slot);
            }
        }
    }
}

fn compare(one: f64, other: f64) -> Ordering {
    one.partial_cmp(&other).unwrap_or(Ordering::Equal)
}
