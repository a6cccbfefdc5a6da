//! Sets the heights of the items in their layers so that the nets are as straight as possible.
//!
//! Each item has preferred heights, at which its nets are straight. Layer by layer, the heights are set to
//! the weighted medians of the preferred heights, in the given order and with minimum gaps. Rows are then
//! made as low as possible.

use super::Graph;
use super::medians::{Preference, ascending_medians};
use super::wires::{ItemKind, LayeredSheet, Pin, Trunk};

/// The minimum gap between two nodes of a layer.
pub(super) const NODE_GAP: f64 = 16.0;

/// The minimum gap between a node and a net that passes through its layer.
const NODE_NET_GAP: f64 = 10.0;

/// The minimum gap between two nets that pass through a layer.
const NET_GAP: f64 = 16.0;

/// The minimum distance of the horizontal lines of different nets in a channel.
const MIN_LINE_DISTANCE: f64 = 6.0;

/// The maximum number of passes over all layers, each in both directions.
const PASSES: usize = 10;

/// The cost of the height of a row, relative to the length of its vertical lines.
const HEIGHT_COST: f64 = 2.0;

/// The weights of straight nets, by the number of ends at which the net passes through a layer: 0, 1 or 2.
const WEIGHTS: [f64; 3] = [1.0, 2.0, 8.0];

/// The weight of the present height of an item without nets to the side in question.
const PRESENT_HEIGHT_WEIGHT: f64 = 1e-3;

/// Sets the height of every item.
pub(super) fn align(graph: &Graph, sheet: &mut LayeredSheet) {
    for row in 0..sheet.rows.len() {
        let mut aligner = Aligner::new(graph, sheet, row);
        aligner.stack();
        let layers = aligner.sheet.rows[row].layers.len();
        let mut best = (f64::INFINITY, Vec::new());
        for _ in 0..aligner.sheet.rows[row].rounds(PASSES) {
            (0..layers).for_each(|layer| aligner.straighten(layer, true, false));
            (0..layers).rev().for_each(|layer| aligner.straighten(layer, false, true));
            (0..layers).for_each(|layer| aligner.straighten(layer, true, true));
            aligner.compact();
            let cost = aligner.cost();
            if cost < best.0 {
                best = (cost, aligner.heights());
            }
        }
        (0..best.1.len()).for_each(|item| aligner.set_y(item, best.1[item]));
        for layer in 0..layers {
            aligner.straighten(layer, true, false);
            aligner.separate_nets(layer);
        }
        aligner.move_to_top();
    }
}

/// Sets the heights of the items of one row.
struct Aligner<'a> {
    /// The graph, for the areas and jacks of its nodes.
    graph: &'a Graph,
    /// The sheet with the heights that are changed.
    sheet: &'a mut LayeredSheet,
    /// The index of the row.
    row: usize,
    /// For each item of the row, its position in its layer.
    positions: Vec<usize>,
}

impl<'a> Aligner<'a> {
    /// Returns an aligner for a row whose layers are ordered already.
    fn new(graph: &'a Graph, sheet: &'a mut LayeredSheet, row: usize) -> Aligner<'a> {
        let mut positions = vec![0; sheet.rows[row].items.len()];
        for layer in &sheet.rows[row].layers {
            layer.iter().enumerate().for_each(|(position, item)| positions[*item] = position);
        }
        Aligner { graph, sheet, row, positions }
    }

    /// Returns the extent of an item above or below its anchor.
    fn reach(&self, item: usize, above: bool) -> f64 {
        match self.sheet.rows[self.row].items[item].kind {
            ItemKind::Node(node) => self.graph.nodes[node].reach(above),
            ItemKind::PassThrough(_) => 0.0,
        }
    }

    /// Whether an item is a node; otherwise it is a net that passes through.
    fn is_node(&self, item: usize) -> bool {
        matches!(self.sheet.rows[self.row].items[item].kind, ItemKind::Node(_))
    }

    /// Returns the minimum distance of the anchors of two neighbours in a layer.
    fn distance(&self, upper: usize, lower: usize) -> f64 {
        let gap = match (self.is_node(upper), self.is_node(lower)) {
            (true, true) => NODE_GAP,
            (false, false) => NET_GAP,
            _ => NODE_NET_GAP,
        };
        (self.reach(upper, false) + gap + self.reach(lower, true)).ceil()
    }

    /// Returns the height of the anchor of an item; y points down.
    fn y(&self, item: usize) -> f64 {
        self.sheet.rows[self.row].items[item].y
    }

    /// Sets the height of the anchor of an item.
    fn set_y(&mut self, item: usize, y: f64) {
        self.sheet.rows[self.row].items[item].y = y;
    }

    /// Returns the items of a layer from the top down.
    fn layer(&self, layer: usize) -> Vec<usize> {
        self.sheet.rows[self.row].layers[layer].clone()
    }

    /// Returns the minimum distances of the anchors of a layer from that of its first item.
    fn min_offsets(&self, items: &[usize]) -> Vec<f64> {
        let mut below = 0.0;
        let mut min_offsets = vec![0.0; items.len()];
        for (index, pair) in items.windows(2).enumerate() {
            below += self.distance(pair[0], pair[1]);
            min_offsets[index + 1] = below;
        }
        min_offsets
    }

    /// Returns the heights of all items of the row, in their order.
    fn heights(&self) -> Vec<f64> {
        self.sheet.rows[self.row].items.iter().map(|item| item.y).collect()
    }

    /// Returns the upper edge of the highest item of the row.
    fn top(&self) -> f64 {
        let items = 0..self.sheet.rows[self.row].items.len();
        items.map(|item| self.y(item) - self.reach(item, true)).fold(f64::INFINITY, f64::min)
    }

    /// Returns the cost of the current heights: of the row height and of all vertical lines.
    fn cost(&self) -> f64 {
        let top = self.top();
        let items = 0..self.sheet.rows[self.row].items.len();
        let bottom = items.map(|item| self.y(item) + self.reach(item, false)).fold(top, f64::max);
        let length = |trunk: &Trunk| {
            let pins = trunk.pins().map(|pin| self.sheet.height(self.graph, self.row, pin));
            let row_gaps =
                [(trunk.up, top), (trunk.down, bottom)].into_iter().filter(|(is_used, _)| *is_used);
            let ends = pins.chain(row_gaps.map(|(_, y)| y));
            let (low, high) = ends.fold((bottom, top), |(low, high), y| (low.min(y), high.max(y)));
            high - low
        };
        let trunks = self.sheet.rows[self.row].channels.iter().flatten();
        HEIGHT_COST * (bottom - top) + trunks.map(length).sum::<f64>()
    }

    /// Closes gaps across the whole row.
    ///
    /// Everything below a level moves up if all layers have free space there. No straight net that crosses
    /// the level is bent.
    fn compact(&mut self) {
        let nodes = (0..self.heights().len()).filter(|item| self.is_node(*item));
        let mut levels: Vec<f64> = nodes.map(|item| self.y(item)).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        let straight = self.straight_pairs();
        for level in levels.into_iter().rev() {
            let is_cut = |(upper, lower): &(f64, f64)| *upper <= level && *lower > level;
            if straight.iter().any(is_cut) {
                continue;
            }
            let slack = self.slack_below(level);
            if slack.is_finite() && slack > 0.0 {
                let below = (0..self.heights().len()).filter(|item| self.y(*item) > level);
                let moved: Vec<_> = below.map(|item| (item, self.y(item) - slack)).collect();
                moved.into_iter().for_each(|(item, y)| self.set_y(item, y));
            }
        }
    }

    /// Returns the anchors of each pair of items that a straight net connects, the upper one first.
    fn straight_pairs(&self) -> Vec<(f64, f64)> {
        let height = |pin: Pin| self.sheet.height(self.graph, self.row, pin);
        let pairs = self.sheet.rows[self.row].channels.iter().flatten().flat_map(Trunk::pairs);
        let straight = pairs.filter(|(left, right)| height(*left) == height(*right));
        let anchors = straight.map(|(left, right)| (self.y(left.item), self.y(right.item)));
        anchors.map(|(left, right)| (left.min(right), left.max(right))).collect()
    }

    /// Returns the distance by which everything below a level can move up.
    fn slack_below(&self, level: f64) -> f64 {
        let layers = 0..self.sheet.rows[self.row].layers.len();
        let pairs = layers.flat_map(|layer| {
            let items = self.layer(layer);
            items.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>()
        });
        let across = pairs.filter(|(upper, lower)| self.y(*upper) <= level && self.y(*lower) > level);
        let slack = across.map(|(upper, lower)| self.y(lower) - self.y(upper) - self.distance(upper, lower));
        slack.fold(f64::INFINITY, f64::min).floor()
    }

    /// Sets initial heights: the items of each layer without gaps, with the middle of each layer at height 0.
    fn stack(&mut self) {
        for layer in 0..self.sheet.rows[self.row].layers.len() {
            let items = self.layer(layer);
            let min_offsets = self.min_offsets(&items);
            let middle = min_offsets.last().map_or(0.0, |last| (last / 2.0).round());
            items.iter().zip(min_offsets).for_each(|(item, y)| self.set_y(*item, y - middle));
        }
    }

    /// Moves the items of a layer to where their nets to the left, to the right or both are straight.
    ///
    /// An item without such nets prefers its present height with a very small weight.
    fn straighten(&mut self, layer: usize, to_left: bool, to_right: bool) {
        let items = self.layer(layer);
        let preferences = self.preferences(layer, to_left, to_right);
        let min_offsets = self.min_offsets(&items);
        let reduced = items.iter().zip(&min_offsets).zip(preferences).map(|((item, offset), mut heights)| {
            if heights.is_empty() {
                heights.push((self.y(*item), PRESENT_HEIGHT_WEIGHT));
            }
            heights.iter().map(|(y, weight)| (y - offset, *weight)).collect()
        });
        let heights = ascending_medians(reduced.collect());
        for ((item, offset), y) in items.iter().zip(&min_offsets).zip(heights) {
            self.set_y(*item, (y + offset).round());
        }
    }

    /// Returns the preferred heights of the items of a layer in order.
    fn preferences(&self, layer: usize, to_left: bool, to_right: bool) -> Vec<Vec<Preference>> {
        let row = &self.sheet.rows[self.row];
        let mut preferences = vec![Vec::new(); row.layers[layer].len()];
        let mut prefer = |mover: Pin, other: Pin| {
            let straight = self.sheet.height(self.graph, self.row, other)
                - self.sheet.offset(self.graph, self.row, mover);
            let through = [mover, other].iter().filter(|pin| !self.is_node(pin.item)).count();
            preferences[self.positions[mover.item]].push((straight, WEIGHTS[through]));
        };
        let channels = [(to_left, layer), (to_right, layer + 1)];
        for (_, channel) in channels.into_iter().filter(|(is_used, _)| *is_used) {
            for (left, right) in row.channels[channel].iter().flat_map(Trunk::pairs) {
                if channel == layer { prefer(right, left) } else { prefer(left, right) }
            }
        }
        preferences
    }

    /// Moves items so that lines of different nets into and out of a channel are not at the same height.
    ///
    /// An item moves by the smallest whole number of pixels at which its nets are clear of those from the left.
    fn separate_nets(&mut self, layer: usize) {
        let taken: Vec<(f64, usize)> = self.sheet.rows[self.row].channels[layer]
            .iter()
            .filter_map(|trunk| Some((self.sheet.height(self.graph, self.row, trunk.left?), trunk.net)))
            .collect();
        let arriving = self.arriving(layer);
        let mut above: Option<usize> = None;
        for (item, arriving) in self.layer(layer).into_iter().zip(arriving) {
            let min = above.map_or(f64::NEG_INFINITY, |above| self.y(above) + self.distance(above, item));
            let is_clear = |y: f64| {
                arriving.iter().all(|(offset, net)| {
                    taken
                        .iter()
                        .all(|(at, other)| net == other || (at - y - offset).abs() >= MIN_LINE_DISTANCE)
                })
            };
            let wanted = self.y(item).max(min);
            let near = (0..).flat_map(|far| [wanted + f64::from(far), wanted - f64::from(far)]);
            let found = near.filter(|y| *y >= min).find(|y| is_clear(*y));
            self.set_y(item, found.unwrap_or(wanted));
            above = Some(item);
        }
    }

    /// Returns the nets into each item of a layer, with their heights relative to its anchor.
    fn arriving(&self, layer: usize) -> Vec<Vec<(f64, usize)>> {
        let row = &self.sheet.rows[self.row];
        let mut arriving = vec![Vec::new(); row.layers[layer].len()];
        for trunk in &row.channels[layer] {
            for pin in &trunk.right {
                let offset = self.sheet.offset(self.graph, self.row, *pin);
                arriving[self.positions[pin.item]].push((offset, trunk.net));
            }
        }
        arriving
    }

    /// Moves all items by the same distance, so that the highest one is at the top of the row.
    fn move_to_top(&mut self) {
        let top = self.top();
        let items = 0..self.sheet.rows[self.row].items.len();
        items.for_each(|item| self.set_y(item, self.y(item) - top.floor()));
    }
}
