//! Heights of items in their layers: cords as straight as the room allows.

use super::Graph;
use super::wires::{Pin, Sheet, What};

/// Room between two nodes of a layer.
pub(super) const APART: f64 = 16.0;

/// Room between a node and a cord that passes it.
const BESIDE: f64 = 10.0;

/// Room between two cords that pass side by side.
const SIDE_BY_SIDE: f64 = 16.0;

/// Level cords of different nets in a channel are never nearer than this.
const CLEAR: f64 = 6.0;

/// Passes over all layers, each in both directions.
const PASSES: usize = 10;

/// What a row's height costs beside the length of its cords.
const TALL: f64 = 2.0;

/// How much straight cords between nodes, between a node and a layer, and through layers are worth.
const WORTH: [f64; 3] = [1.0, 2.0, 8.0];

/// A height that an item would like to have, and how much.
type Wish = (f64, f64);

/// Gives every item its height.
pub(super) fn align(graph: &Graph, sheet: &mut Sheet) {
    for row in 0..sheet.rows.len() {
        let mut aligner = Aligner::new(graph, sheet, row);
        aligner.stack();
        let layers = aligner.sheet.rows[row].layers.len();
        let mut best = (f64::INFINITY, Vec::new());
        for _ in 0..aligner.sheet.rows[row].rounds(PASSES) {
            (0..layers).for_each(|layer| aligner.settle(layer, true, false));
            (0..layers).rev().for_each(|layer| aligner.settle(layer, false, true));
            (0..layers).for_each(|layer| aligner.settle(layer, true, true));
            aligner.squeeze();
            let cost = aligner.cost();
            if cost < best.0 {
                best = (cost, aligner.heights());
            }
        }
        (0..best.1.len()).for_each(|item| aligner.set_y(item, best.1[item]));
        for layer in 0..layers {
            aligner.settle(layer, true, false);
            aligner.keep_clear(layer);
        }
        aligner.begin_at_0();
    }
}

struct Aligner<'a> {
    graph: &'a Graph,
    sheet: &'a mut Sheet,
    row: usize,
    /// Places of all items of the row in their layers.
    places: Vec<usize>,
}

impl<'a> Aligner<'a> {
    fn new(graph: &'a Graph, sheet: &'a mut Sheet, row: usize) -> Aligner<'a> {
        let mut places = vec![0; sheet.rows[row].items.len()];
        for layer in &sheet.rows[row].layers {
            layer.iter().enumerate().for_each(|(place, item)| places[*item] = place);
        }
        Aligner { graph, sheet, row, places }
    }

    /// Room that an item takes above or below its anchor.
    fn reach(&self, item: usize, above: bool) -> f64 {
        match self.sheet.rows[self.row].items[item].what {
            What::Node(node) => self.graph.nodes[node].reach(above),
            What::Through(_) => 0.0,
        }
    }

    fn is_node(&self, item: usize) -> bool {
        matches!(self.sheet.rows[self.row].items[item].what, What::Node(_))
    }

    /// Least distance of the anchors of two neighbours in a layer.
    fn distance(&self, upper: usize, lower: usize) -> f64 {
        let gap = match (self.is_node(upper), self.is_node(lower)) {
            (true, true) => APART,
            (false, false) => SIDE_BY_SIDE,
            _ => BESIDE,
        };
        (self.reach(upper, false) + gap + self.reach(lower, true)).ceil()
    }

    fn y(&self, item: usize) -> f64 {
        self.sheet.rows[self.row].items[item].y
    }

    fn set_y(&mut self, item: usize, y: f64) {
        self.sheet.rows[self.row].items[item].y = y;
    }

    fn layer(&self, layer: usize) -> Vec<usize> {
        self.sheet.rows[self.row].layers[layer].clone()
    }

    /// Distances of the anchors of a layer from that of its first item, as close as they can be.
    fn closest(&self, items: &[usize]) -> Vec<f64> {
        let mut below = 0.0;
        let mut closest = vec![0.0; items.len()];
        for (index, pair) in items.windows(2).enumerate() {
            below += self.distance(pair[0], pair[1]);
            closest[index + 1] = below;
        }
        closest
    }

    fn heights(&self) -> Vec<f64> {
        self.sheet.rows[self.row].items.iter().map(|item| item.y).collect()
    }

    /// Height of the row, and how long its upright lines are together.
    fn cost(&self) -> f64 {
        let items = 0..self.sheet.rows[self.row].items.len();
        let top =
            items.clone().map(|item| self.y(item) - self.reach(item, true)).fold(f64::INFINITY, f64::min);
        let bottom = items.map(|item| self.y(item) + self.reach(item, false)).fold(top, f64::max);
        let length = |trunk: &super::wires::Trunk| {
            let pins = trunk.pins().map(|pin| self.sheet.height(self.graph, self.row, pin));
            let streets = [(trunk.up, top), (trunk.down, bottom)].into_iter().filter(|(goes, _)| *goes);
            let ends = pins.chain(streets.map(|(_, y)| y));
            let (low, high) = ends.fold((bottom, top), |(low, high), y| (low.min(y), high.max(y)));
            high - low
        };
        let trunks = self.sheet.rows[self.row].channels.iter().flatten();
        TALL * (bottom - top) + trunks.map(length).sum::<f64>()
    }

    /// Draws the row together where a level line across it finds room in every layer that has items on both sides
    /// of it, and cuts no straight cord.
    fn squeeze(&mut self) {
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
            let room = self.room_below(level);
            if room.is_finite() && room > 0.0 {
                let below = (0..self.heights().len()).filter(|item| self.y(*item) > level);
                let moved: Vec<_> = below.map(|item| (item, self.y(item) - room)).collect();
                moved.into_iter().for_each(|(item, y)| self.set_y(item, y));
            }
        }
    }

    /// Anchors of items that a straight cord joins, the upper one first.
    fn straight_pairs(&self) -> Vec<(f64, f64)> {
        let height = |pin: &Pin| self.sheet.height(self.graph, self.row, *pin);
        let trunks = self.sheet.rows[self.row].channels.iter().flatten();
        let pairs = trunks.flat_map(|trunk| {
            trunk.left.iter().flat_map(|left| trunk.right.iter().map(move |right| (left, right)))
        });
        let straight = pairs.filter(|(left, right)| height(left) == height(right));
        let anchors = straight.map(|(left, right)| (self.y(left.item), self.y(right.item)));
        anchors.map(|(left, right)| (left.min(right), left.max(right))).collect()
    }

    /// By how much everything below a level can move up before it meets what stands above.
    fn room_below(&self, level: f64) -> f64 {
        let layers = 0..self.sheet.rows[self.row].layers.len();
        let pairs = layers.flat_map(|layer| {
            let items = self.layer(layer);
            items.windows(2).map(|pair| (pair[0], pair[1])).collect::<Vec<_>>()
        });
        let across = pairs.filter(|(upper, lower)| self.y(*upper) <= level && self.y(*lower) > level);
        let room = across.map(|(upper, lower)| self.y(lower) - self.y(upper) - self.distance(upper, lower));
        room.fold(f64::INFINITY, f64::min).floor()
    }

    fn stack(&mut self) {
        for layer in 0..self.sheet.rows[self.row].layers.len() {
            let items = self.layer(layer);
            let closest = self.closest(&items);
            let middle = closest.last().map_or(0.0, |last| (last / 2.0).round());
            items.iter().zip(closest).for_each(|(item, y)| self.set_y(*item, y - middle));
        }
    }

    /// Moves the items of a layer to where their cords to the left, to the right or both are straight.
    fn settle(&mut self, layer: usize, to_left: bool, to_right: bool) {
        let items = self.layer(layer);
        let wishes = self.wishes(layer, to_left, to_right);
        let closest = self.closest(&items);
        let reduced = items.iter().zip(&closest).zip(wishes).map(|((item, closest), mut own)| {
            if own.is_empty() {
                own.push((self.y(*item), 1e-3));
            }
            own.iter().map(|(y, worth)| (y - closest, *worth)).collect()
        });
        let heights = in_order(reduced.collect());
        for ((item, closest), y) in items.iter().zip(&closest).zip(heights) {
            self.set_y(*item, (y + closest).round());
        }
    }

    /// What the items of a layer would like, in their order.
    fn wishes(&self, layer: usize, to_left: bool, to_right: bool) -> Vec<Vec<Wish>> {
        let row = &self.sheet.rows[self.row];
        let mut wishes = vec![Vec::new(); row.layers[layer].len()];
        let mut wish = |mover: Pin, other: Pin| {
            let straight = self.sheet.height(self.graph, self.row, other)
                - self.sheet.offset(self.graph, self.row, mover);
            let through = [mover, other].iter().filter(|pin| !self.is_node(pin.item)).count();
            wishes[self.places[mover.item]].push((straight, WORTH[through]));
        };
        let channels = [(to_left, layer), (to_right, layer + 1)];
        for (_, channel) in channels.into_iter().filter(|(wanted, _)| *wanted) {
            for trunk in &row.channels[channel] {
                for (left, right) in
                    trunk.left.iter().flat_map(|left| trunk.right.iter().map(move |right| (left, right)))
                {
                    if channel == layer { wish(*right, *left) } else { wish(*left, *right) }
                }
            }
        }
        wishes
    }

    /// Moves items on so that no cord into them is in line with one of another net that leaves the layer before.
    fn keep_clear(&mut self, layer: usize) {
        let taken: Vec<(f64, usize)> = self.sheet.rows[self.row].channels[layer]
            .iter()
            .filter_map(|trunk| Some((self.sheet.height(self.graph, self.row, trunk.left?), trunk.net)))
            .collect();
        let arriving = self.arriving(layer);
        let mut above: Option<usize> = None;
        for (item, arriving) in self.layer(layer).into_iter().zip(arriving) {
            let least = above.map_or(f64::NEG_INFINITY, |above| self.y(above) + self.distance(above, item));
            let is_clear = |y: f64| {
                arriving.iter().all(|(offset, net)| {
                    taken.iter().all(|(at, other)| net == other || (at - y - offset).abs() >= CLEAR)
                })
            };
            let wanted = self.y(item).max(least);
            let near = (0..).flat_map(|far| [wanted + f64::from(far), wanted - f64::from(far)]);
            let found = near.filter(|y| *y >= least).find(|y| is_clear(*y));
            self.set_y(item, found.unwrap_or(wanted));
            above = Some(item);
        }
    }

    /// For every item of a layer, in order, heights of the cords into it from its anchor, and their nets.
    fn arriving(&self, layer: usize) -> Vec<Vec<(f64, usize)>> {
        let row = &self.sheet.rows[self.row];
        let mut arriving = vec![Vec::new(); row.layers[layer].len()];
        for trunk in &row.channels[layer] {
            for pin in &trunk.right {
                let offset = self.sheet.offset(self.graph, self.row, *pin);
                arriving[self.places[pin.item]].push((offset, trunk.net));
            }
        }
        arriving
    }

    fn begin_at_0(&mut self) {
        let items = 0..self.sheet.rows[self.row].items.len();
        let top =
            items.clone().map(|item| self.y(item) - self.reach(item, true)).fold(f64::INFINITY, f64::min);
        items.for_each(|item| self.set_y(item, self.y(item) - top.floor()));
    }
}

/// Rising heights that come as near as they can to what is wished for, by the sum of distances: neighbours that
/// would pass each other move as one block, to the median of their wishes.
fn in_order(wishes: Vec<Vec<Wish>>) -> Vec<f64> {
    let mut blocks: Vec<(Vec<Wish>, usize, f64)> = Vec::new();
    for mut own in wishes {
        let mut count = 1;
        let mut height = median(&mut own);
        while let Some((mut upper, many, _)) = blocks.pop_if(|(.., above)| *above > height) {
            upper.append(&mut own);
            own = upper;
            count += many;
            height = median(&mut own);
        }
        blocks.push((own, count, height));
    }
    blocks.into_iter().flat_map(|(_, count, height)| std::iter::repeat_n(height, count)).collect()
}

/// The lower weighted median.
fn median(wishes: &mut [Wish]) -> f64 {
    wishes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = wishes.iter().map(|(_, worth)| worth).sum::<f64>() / 2.0;
    let mut sum = 0.0;
    let found = wishes.iter().find(|(_, worth)| {
        sum += worth;
        sum >= half
    });
    found.map_or(0.0, |(height, _)| *height)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_stand_at_the_median_of_their_wishes() {
        let wish = |heights: &[f64]| heights.iter().map(|height| (*height, 1.0)).collect::<Vec<_>>();
        assert_eq!(in_order(vec![wish(&[1.0]), wish(&[5.0])]), [1.0, 5.0]);
        assert_eq!(in_order(vec![wish(&[5.0, 5.0]), wish(&[1.0])]), [5.0, 5.0]);
        let heights = in_order(vec![wish(&[3.0]), wish(&[9.0]), wish(&[2.0, 2.0, 2.0]), wish(&[10.0])]);
        assert_eq!(heights, [2.0, 2.0, 2.0, 10.0]);
    }
}
