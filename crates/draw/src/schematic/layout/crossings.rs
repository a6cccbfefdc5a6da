//! Orders the items of each layer so that few nets cross.
//!
//! Layers are sorted by the mean position of their neighbours (barycentre method), and neighbours are
//! exchanged if that saves crossings. The best order of all sweeps, from two initial orders, is kept.

use std::cmp::Ordering;

use super::Graph;
use super::wires::{ItemKind, LayerRow, LayeredSheet, Pin, PinKind};

/// The maximum number of sweeps over the layers, each in both directions.
const SWEEPS: usize = 14;

/// Orders the items of every row, and the inputs that may be exchanged.
pub(super) fn reduce(graph: &Graph, rank: &[usize], sheet: &mut LayeredSheet) {
    for row in 0..sheet.rows.len() {
        let mut best: Option<(usize, Vec<Vec<usize>>)> = None;
        for reversed in [false, true] {
            set_initial_order(rank, &mut sheet.rows[row], reversed);
            let mut sorter = Sorter::new(graph, sheet, row);
            sorter.sort();
            let crossings = sorter.all_crossings();
            if best.as_ref().is_none_or(|(lowest, _)| crossings < *lowest) {
                best = Some((crossings, sheet.rows[row].layers.clone()));
            }
        }
        if let Some((_, layers)) = best {
            sheet.rows[row].layers = layers;
        }
        Sorter::new(graph, sheet, row).exchange_inputs();
    }
}

/// Sets the initial order, which is that of reading or its reverse.
fn set_initial_order(rank: &[usize], row: &mut LayerRow, reversed: bool) {
    let LayerRow { items, layers, .. } = row;
    let key = |item: &usize| match items[*item].kind {
        ItemKind::Node(node) => (0, rank[node] as isize * if reversed { -1 } else { 1 }),
        ItemKind::PassThrough(net) => (1, net as isize),
    };
    layers.iter_mut().for_each(|layer| layer.sort_by_key(key));
}

/// Orders the items of the layers of one row.
struct Sorter<'a> {
    /// The graph, for the number of outputs and of exchangeable inputs.
    graph: &'a Graph,
    /// The row whose layers are ordered.
    row: &'a mut LayerRow,
    /// For each node and input, the index of the jack that it uses.
    input_slots: &'a mut [Vec<usize>],
    /// For each item of the row, its position in its layer.
    positions: Vec<f64>,
}

/// The positions of a net on the two sides of a channel, counted in items.
type Strand = (f64, f64);

impl<'a> Sorter<'a> {
    /// Returns a sorter that starts from the present order of the layers.
    fn new(graph: &'a Graph, sheet: &'a mut LayeredSheet, row: usize) -> Sorter<'a> {
        let LayeredSheet { rows, input_slots } = sheet;
        let positions = vec![0.0; rows[row].items.len()];
        let mut sorter = Sorter { graph, row: &mut rows[row], input_slots, positions };
        sorter.update_positions();
        sorter
    }

    /// Updates the positions of all items after their layers have changed.
    fn update_positions(&mut self) {
        (0..self.row.layers.len()).for_each(|layer| self.update_positions_of(layer));
    }

    /// Updates the positions of the items of one layer.
    fn update_positions_of(&mut self, layer: usize) {
        for (position, item) in self.row.layers[layer].iter().enumerate() {
            self.positions[*item] = position as f64;
        }
    }

    /// Orders all layers by repeated sweeps and keeps the best order.
    ///
    /// A sweep sorts each layer by its left neighbours, then by its right neighbours, and then exchanges
    /// neighbours. It may increase the number of crossings, so the best order need not be the last one.
    fn sort(&mut self) {
        let mut best = (usize::MAX, self.row.layers.clone());
        for _ in 0..self.row.rounds(SWEEPS) {
            let layers = self.row.layers.len();
            (1..layers).for_each(|layer| self.sort_by_neighbours(layer, layer));
            (0..layers).rev().for_each(|layer| self.sort_by_neighbours(layer, layer + 1));
            self.exchange_inputs();
            (0..layers).for_each(|layer| self.swap_neighbours(layer));
            let crossings = self.all_crossings();
            if crossings < best.0 {
                best = (crossings, self.row.layers.clone());
            }
        }
        self.row.layers = best.1;
        self.update_positions();
        self.exchange_inputs();
    }

    /// Returns the position of a pin: that of its item plus a fraction for its input or output.
    fn pin_position(&self, pin: Pin) -> f64 {
        let fraction = match (self.row.items[pin.item].kind, pin.kind) {
            (ItemKind::Node(node), PinKind::Input(input)) => {
                (self.input_slots[node][input] as f64 + 1.0) / (self.input_slots[node].len() as f64 + 1.0)
            }
            (ItemKind::Node(node), PinKind::Output(output)) => {
                (output as f64 + 1.0) / (self.graph.nodes[node].outputs.len() as f64 + 1.0)
            }
            _ => 0.5,
        };
        self.positions[pin.item] + fraction
    }

    /// Returns the strands of a channel with the items at their ends.
    ///
    /// A row gap has a position before the first or after the last item of a layer.
    fn strands(&self, channel: usize) -> Vec<(Strand, Option<usize>, Option<usize>)> {
        let end = |layer: Option<&Vec<usize>>| layer.map_or(1.0, |layer| layer.len() as f64 + 1.0);
        let left_end = end(channel.checked_sub(1).and_then(|left| self.row.layers.get(left)));
        let right_end = end(self.row.layers.get(channel));
        let mut strands = Vec::new();
        for trunk in &self.row.channels[channel] {
            let row_gaps = [(trunk.up, -1.0, -1.0), (trunk.down, left_end, right_end)];
            let row_gaps = row_gaps.into_iter().filter(|(used, ..)| *used);
            match trunk.left {
                Some(left) => {
                    let from = self.pin_position(left);
                    let to = trunk.right.iter();
                    strands.extend(
                        to.map(|to| ((from, self.pin_position(*to)), Some(left.item), Some(to.item))),
                    );
                    strands.extend(row_gaps.map(|(_, _, to)| ((from, to), Some(left.item), None)));
                }
                None => {
                    for (_, from, _) in row_gaps {
                        let to = trunk.right.iter();
                        strands.extend(to.map(|to| ((from, self.pin_position(*to)), None, Some(to.item))));
                    }
                }
            }
        }
        strands
    }

    /// Returns the positions at the far ends of the strands in a channel, for each item of a layer.
    fn far_positions(&self, layer: usize, channel: usize) -> Vec<Vec<f64>> {
        let mut ends = vec![Vec::new(); self.row.layers[layer].len()];
        for ((from, to), left, right) in self.strands(channel) {
            let (item, other) = if channel == layer { (right, from) } else { (left, to) };
            if let Some(item) = item {
                ends[self.positions[item] as usize].push(other);
            }
        }
        ends
    }

    /// Sorts a layer by the mean position of the items that are connected through a channel.
    fn sort_by_neighbours(&mut self, layer: usize, channel: usize) {
        let ends = self.far_positions(layer, channel);
        let mean = |item: &usize| match &ends[self.positions[*item] as usize] {
            ends if ends.is_empty() => self.positions[*item] + 0.5,
            ends => ends.iter().sum::<f64>() / ends.len() as f64,
        };
        let mut keyed: Vec<(f64, usize)> =
            self.row.layers[layer].iter().map(|item| (mean(item), *item)).collect();
        keyed.sort_by(|a, b| compare(a.0, b.0));
        self.row.layers[layer] = keyed.into_iter().map(|(_, item)| item).collect();
        self.update_positions_of(layer);
    }

    /// Exchanges neighbours in a layer if that saves crossings of their own strands.
    fn swap_neighbours(&mut self, layer: usize) {
        let mut sides = [layer, layer + 1].map(|channel| self.far_positions(layer, channel));
        sides.iter_mut().flatten().for_each(|ends| ends.sort_by(|a, b| compare(*a, *b)));
        let crossings = |upper: usize, lower: usize| -> usize {
            sides.iter().map(|ends| crossings_of(&ends[upper], &ends[lower])).sum()
        };
        let previous = self.row.layers[layer].clone();
        let mut order: Vec<usize> = (0..previous.len()).collect();
        for lower in 1..order.len() {
            let (one, other) = (order[lower - 1], order[lower]);
            if crossings(other, one) < crossings(one, other) {
                order.swap(lower - 1, lower);
            }
        }
        self.row.layers[layer] = order.into_iter().map(|position| previous[position]).collect();
        self.update_positions_of(layer);
    }

    /// Returns the number of crossings in all channels of the row.
    fn all_crossings(&self) -> usize {
        let strands =
            |channel| self.strands(channel).into_iter().map(|(strand, ..)| strand).collect::<Vec<_>>();
        (0..self.row.channels.len()).map(|channel| crossings_among(strands(channel))).sum()
    }

    /// Orders exchangeable inputs by the positions of their sources.
    fn exchange_inputs(&mut self) {
        let mut sources: Vec<Vec<f64>> =
            self.input_slots.iter().map(|input_slots| vec![0.0; input_slots.len()]).collect();
        for channel in &self.row.channels {
            for trunk in channel {
                let row_gap = if trunk.up { -1.0 } else { f64::INFINITY };
                let from = trunk.left.map_or(row_gap, |left| self.pin_position(left));
                for pin in &trunk.right {
                    if let (ItemKind::Node(node), PinKind::Input(input)) =
                        (self.row.items[pin.item].kind, pin.kind)
                    {
                        sources[node][input] = from;
                    }
                }
            }
        }
        for item in &self.row.items {
            if let ItemKind::Node(node) = item.kind {
                let mut order: Vec<usize> = (0..self.graph.nodes[node].exchangeable).collect();
                order.sort_by(|a, b| compare(sources[node][*a], sources[node][*b]));
                order.iter().enumerate().for_each(|(slot, input)| self.input_slots[node][*input] = slot);
            }
        }
    }
}

/// Returns the number of crossings of the strands of a channel.
///
/// Two strands cross if one starts above the other and ends below it.
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

/// Returns the number of crossings of the strands of two neighbours from their sorted far ends.
fn crossings_of(upper: &[f64], lower: &[f64]) -> usize {
    upper.iter().map(|end| lower.partition_point(|other| other < end)).sum()
}

/// Compares two positions. Positions are never NaN.
fn compare(one: f64, other: f64) -> Ordering {
    one.partial_cmp(&other).unwrap_or(Ordering::Equal)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts the crossings of all pairs of strands one by one.
    fn pairs(strands: &[Strand]) -> usize {
        let crosses = |one: &Strand, other: &Strand| (one.0 - other.0) * (one.1 - other.1) < 0.0;
        let later = |(index, one)| strands[index + 1..].iter().filter(|other| crosses(one, other)).count();
        strands.iter().enumerate().map(later).sum()
    }

    #[test]
    fn crossings_are_those_of_all_pairs() {
        let position = |index: usize, by: usize| (index * by % 7) as f64;
        for count in 0..20 {
            let strands: Vec<Strand> =
                (0..count).map(|index| (position(index, 11), position(index, 17))).collect();
            assert_eq!(crossings_among(strands.clone()), pairs(&strands));
        }
        assert_eq!(crossings_of(&[1.0, 2.0, 5.0], &[0.0, 2.0, 3.0]), 5);
    }
}
