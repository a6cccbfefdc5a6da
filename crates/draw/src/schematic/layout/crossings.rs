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
            let mut sorter = Sorter::new(graph, sheet, row);
            sorter.sort();
            let crossings = sorter.all_crossings();
            if best.as_ref().is_none_or(|(least, _)| crossings < *least) {
                best = Some((crossings, sheet.rows[row].layers.clone()));
            }
        }
        if let Some((_, layers)) = best {
            sheet.rows[row].layers = layers;
        }
        Sorter::new(graph, sheet, row).exchange_inputs();
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
    /// Places of all items of the row in their layers.
    places: Vec<f64>,
}

/// Places of a net on the two sides of a channel, counted in items.
type Strand = (f64, f64);

impl<'a> Sorter<'a> {
    fn new(graph: &'a Graph, sheet: &'a mut Sheet, row: usize) -> Sorter<'a> {
        let Sheet { rows, slots } = sheet;
        let places = vec![0.0; rows[row].items.len()];
        let mut sorter = Sorter { graph, row: &mut rows[row], slots, places };
        sorter.count_places();
        sorter
    }

    fn count_places(&mut self) {
        (0..self.row.layers.len()).for_each(|layer| self.count_places_of(layer));
    }

    fn count_places_of(&mut self, layer: usize) {
        for (place, item) in self.row.layers[layer].iter().enumerate() {
            self.places[*item] = place as f64;
        }
    }

    fn sort(&mut self) {
        let mut best = (usize::MAX, self.row.layers.clone());
        for _ in 0..self.row.rounds(SWEEPS) {
            let layers = self.row.layers.len();
            (1..layers).for_each(|layer| self.by_neighbours(layer, layer));
            (0..layers).rev().for_each(|layer| self.by_neighbours(layer, layer + 1));
            self.exchange_inputs();
            (0..layers).for_each(|layer| self.swap_neighbours(layer));
            let crossings = self.all_crossings();
            if crossings < best.0 {
                best = (crossings, self.row.layers.clone());
            }
        }
        self.row.layers = best.1;
        self.count_places();
        self.exchange_inputs();
    }

    /// Place of a pin: that of its item and a little for which input it is.
    fn place(&self, pin: Pin) -> f64 {
        let share = match (self.row.items[pin.item].what, pin.jack) {
            (What::Node(node), Jack::Input(input)) => {
                (self.slots[node][input] as f64 + 1.0) / (self.slots[node].len() as f64 + 1.0)
            }
            (What::Node(node), Jack::Output(outlet)) => {
                (outlet as f64 + 1.0) / (self.graph.nodes[node].outputs.len() as f64 + 1.0)
            }
            _ => 0.5,
        };
        self.places[pin.item] + share
    }

    /// The strands of a channel. Streets lie beyond the first and the last item of a layer.
    fn strands(&self, channel: usize) -> Vec<(Strand, Option<usize>, Option<usize>)> {
        let end = |layer: Option<&Vec<usize>>| layer.map_or(1.0, |layer| layer.len() as f64 + 1.0);
        let left_end = end(channel.checked_sub(1).and_then(|left| self.row.layers.get(left)));
        let right_end = end(self.row.layers.get(channel));
        let mut strands = Vec::new();
        for trunk in &self.row.channels[channel] {
            let streets = [(trunk.up, -1.0, -1.0), (trunk.down, left_end, right_end)];
            let streets = streets.into_iter().filter(|(used, ..)| *used);
            match trunk.left {
                Some(left) => {
                    let from = self.place(left);
                    let to = trunk.right.iter();
                    strands.extend(to.map(|to| ((from, self.place(*to)), Some(left.item), Some(to.item))));
                    strands.extend(streets.map(|(_, _, to)| ((from, to), Some(left.item), None)));
                }
                None => {
                    for (_, from, _) in streets {
                        let to = trunk.right.iter();
                        strands.extend(to.map(|to| ((from, self.place(*to)), None, Some(to.item))));
                    }
                }
            }
        }
        strands
    }

    /// For every item of a layer, in order, where its strands over one of the layer's channels lead.
    fn far_ends(&self, layer: usize, channel: usize) -> Vec<Vec<f64>> {
        let mut ends = vec![Vec::new(); self.row.layers[layer].len()];
        for ((from, to), left, right) in self.strands(channel) {
            let (item, other) = if channel == layer { (right, from) } else { (left, to) };
            if let Some(item) = item {
                ends[self.places[item] as usize].push(other);
            }
        }
        ends
    }

    /// Sorts a layer by the mean place of what its items are joined to over one of its channels.
    fn by_neighbours(&mut self, layer: usize, channel: usize) {
        let ends = self.far_ends(layer, channel);
        let mean = |item: &usize| match &ends[self.places[*item] as usize] {
            ends if ends.is_empty() => self.places[*item] + 0.5,
            ends => ends.iter().sum::<f64>() / ends.len() as f64,
        };
        let mut keyed: Vec<(f64, usize)> =
            self.row.layers[layer].iter().map(|item| (mean(item), *item)).collect();
        keyed.sort_by(|a, b| compare(a.0, b.0));
        self.row.layers[layer] = keyed.into_iter().map(|(_, item)| item).collect();
        self.count_places_of(layer);
    }

    /// Exchanges neighbours in a layer where that saves crossings: only their own strands count.
    fn swap_neighbours(&mut self, layer: usize) {
        let mut sides = [layer, layer + 1].map(|channel| self.far_ends(layer, channel));
        sides.iter_mut().flatten().for_each(|ends| ends.sort_by(|a, b| compare(*a, *b)));
        let crossings = |upper: usize, lower: usize| -> usize {
            sides.iter().map(|ends| crossings_of(&ends[upper], &ends[lower])).sum()
        };
        let was = self.row.layers[layer].clone();
        let mut order: Vec<usize> = (0..was.len()).collect();
        for lower in 1..order.len() {
            let (one, other) = (order[lower - 1], order[lower]);
            if crossings(other, one) < crossings(one, other) {
                order.swap(lower - 1, lower);
            }
        }
        self.row.layers[layer] = order.into_iter().map(|place| was[place]).collect();
        self.count_places_of(layer);
    }

    fn all_crossings(&self) -> usize {
        let strands =
            |channel| self.strands(channel).into_iter().map(|(strand, ..)| strand).collect::<Vec<_>>();
        (0..self.row.channels.len()).map(|channel| crossings_among(strands(channel))).sum()
    }

    /// Inputs that may be exchanged stand in the order of what they come from.
    fn exchange_inputs(&mut self) {
        let mut sources: Vec<Vec<f64>> = self.slots.iter().map(|slots| vec![0.0; slots.len()]).collect();
        for channel in &self.row.channels {
            for trunk in channel {
                let street = if trunk.up { -1.0 } else { f64::INFINITY };
                let from = trunk.left.map_or(street, |left| self.place(left));
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

/// Crossings of the strands of a channel: such as begin above others and end below them.
fn crossings_among(mut strands: Vec<Strand>) -> usize {
    strands.sort_by(|a, b| compare(a.0, b.0).then(compare(a.1, b.1)));
    let mut ends: Vec<f64> = Vec::with_capacity(strands.len());
    let mut crossings = 0;
    for (_, to) in strands {
        let above = ends.partition_point(|end| *end <= to);
        crossings += ends.len() - above;
        ends.insert(above, to);
    }
    crossings
}

/// Crossings of the strands of two neighbours, by where they lead, in order.
fn crossings_of(upper: &[f64], lower: &[f64]) -> usize {
    upper.iter().map(|end| lower.partition_point(|other| other < end)).sum()
}

fn compare(one: f64, other: f64) -> Ordering {
    one.partial_cmp(&other).unwrap_or(Ordering::Equal)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every pair of strands, looked at one by one.
    fn pairs(strands: &[Strand]) -> usize {
        let crosses = |one: &Strand, other: &Strand| (one.0 - other.0) * (one.1 - other.1) < 0.0;
        let later = |(index, one)| strands[index + 1..].iter().filter(|other| crosses(one, other)).count();
        strands.iter().enumerate().map(later).sum()
    }

    #[test]
    fn crossings_are_those_of_all_pairs() {
        let place = |index: usize, by: usize| (index * by % 7) as f64;
        for count in 0..20 {
            let strands: Vec<Strand> = (0..count).map(|index| (place(index, 11), place(index, 17))).collect();
            assert_eq!(crossings_among(strands.clone()), pairs(&strands));
        }
        assert_eq!(crossings_of(&[1.0, 2.0, 5.0], &[0.0, 2.0, 3.0]), 5);
    }
}
