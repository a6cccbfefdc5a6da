//! Makes the lines of the nets.
//!
//! The trunks of all channels and the lines of all row gaps are collected and merged for each net. A dot is
//! added at each branch, and an arrow to each net that runs back.

use super::coordinates::{BEYOND_ROW, ColumnPositions, PITCH, RowPositions, row_gap_lines};
use super::tracks::ChannelLine;
use super::wires::{ItemKind, LayeredSheet, Pin, PinKind, Trunk};
use super::{Graph, Point, Route};

/// Makes the lines of the nets from the positions of rows, layers and tracks.
pub(super) struct RouteBuilder<'a> {
    /// The nodes and nets.
    pub graph: &'a Graph,
    /// The trunks and the heights of the pins.
    pub sheet: &'a LayeredSheet,
    /// The horizontal positions of each row.
    pub columns: &'a [ColumnPositions],
    /// The vertical positions of the rows.
    pub row_positions: &'a RowPositions,
    /// The anchors of the nodes.
    pub positions: &'a [Point],
}

impl RouteBuilder<'_> {
    /// Returns the complete routes of all nets.
    ///
    /// The lines of all channels and row gaps are collected first and then merged, so that dots are only where
    /// the lines branch. The arrows are added last, because they avoid the vertical lines of all nets.
    pub(super) fn routes(&self) -> Vec<Route> {
        let mut routes = vec![Route::default(); self.graph.nets.len()];
        for (index, row) in self.sheet.rows.iter().enumerate() {
            for (channel, trunks) in row.channels.iter().enumerate() {
                for (trunk, x) in trunks.iter().zip(&self.columns[index].trunks[channel]) {
                    self.trunk(index, channel, trunk, *x, &mut routes[trunk.net].lines);
                }
            }
        }
        for row_gap in 0..self.row_positions.row_gaps.len() {
            self.row_gap(row_gap, &mut routes);
        }
        for route in &mut routes {
            route.lines = merge_lines(&route.lines);
            route.dots = dots(&route.lines);
        }
        let verticals: Vec<[Point; 2]> = routes.iter().flat_map(|route| &route.lines).copied().collect();
        let verticals: Vec<_> = verticals.into_iter().filter(|[a, b]| a.0 == b.0).collect();
        (0..self.row_positions.row_gaps.len())
            .for_each(|row_gap| self.arrows(row_gap, &verticals, &mut routes));
        routes
    }

    /// Adds the vertical line of a trunk and the horizontal lines to its pins.
    fn trunk(&self, row: usize, channel: usize, trunk: &Trunk, x: f64, lines: &mut Vec<[Point; 2]>) {
        let top = self.row_positions.rows[row];
        let height = |pin: Pin| top + self.sheet.height(self.graph, row, pin);
        let mut heights: Vec<f64> = trunk.pins().map(height).collect();
        let row_gap = |row_gap: usize| self.height_in_row_gap(row_gap, trunk.net);
        heights.extend(
            [(trunk.up, row), (trunk.down, row + 1)]
                .iter()
                .filter(|(is_used, _)| *is_used)
                .filter_map(|(_, at)| row_gap(*at)),
        );
        let (low, high) = heights
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(*y), high.max(*y)));
        if low < high {
            lines.push([(x, low), (x, high)]);
        }
        for (pin, layer) in trunk
            .left
            .iter()
            .map(|pin| (*pin, channel.wrapping_sub(1)))
            .chain(trunk.right.iter().map(|pin| (*pin, channel)))
        {
            let from = self.pin_x(row, layer, pin);
            lines.push([(from.min(x), height(pin)), (from.max(x), height(pin))]);
        }
    }

    /// Returns the x of a pin; a net that passes through a layer has its pin at the anchor of the layer.
    fn pin_x(&self, row: usize, layer: usize, pin: Pin) -> f64 {
        let middle = self.columns[row].layers.get(layer).copied().unwrap_or(0.0);
        let ItemKind::Node(node) = self.sheet.rows[row].items[pin.item].kind else { return middle };
        let jack = match pin.kind {
            PinKind::Input(input) => self.graph.nodes[node].inputs[self.sheet.input_slots[node][input]],
            PinKind::Output(output) => self.graph.nodes[node].outputs[output],
            PinKind::PassThrough => return middle,
        };
        self.positions[node].0 + jack.0
    }

    /// Returns the height of the line of a net in a row gap; `None` if the net does not use it.
    fn height_in_row_gap(&self, row_gap: usize, net: usize) -> Option<f64> {
        self.row_positions.row_gaps[row_gap].iter().find(|(other, _)| *other == net).map(|(_, y)| *y)
    }

    /// Adds the horizontal line of each net in a row gap, between its leftmost and rightmost trunks.
    fn row_gap(&self, row_gap: usize, routes: &mut [Route]) {
        let (nets, channel_lines) = row_gap_lines(self.sheet, self.columns, row_gap);
        for (net, line) in nets.into_iter().zip(channel_lines) {
            let (left, right) = line.ends();
            let Some(y) = self.height_in_row_gap(row_gap, net).filter(|_| left < right) else { continue };
            routes[net].lines.push([(left, y), (right, y)]);
        }
    }

    /// Adds arrows to nets that run back in a row gap, away from lines that cross them.
    fn arrows(&self, row_gap: usize, verticals: &[[Point; 2]], routes: &mut [Route]) {
        let (nets, channel_lines) = row_gap_lines(self.sheet, self.columns, row_gap);
        for (net, line) in nets.into_iter().zip(channel_lines) {
            let Some(y) = self.height_in_row_gap(row_gap, net) else { continue };
            let here = verticals.iter().filter(|[top, bottom]| (top.1..=bottom.1).contains(&y));
            let crossing: Vec<f64> = here.map(|[top, _]| top.0).collect();
            let from = self.positions[self.graph.nets[net].from].0;
            routes[net].arrows.extend(arrow_position(&line, from, &crossing).map(|x| (x, y)));
        }
    }
}

/// The minimum distance from an arrow to a line that crosses its net.
const ARROW_CLEARANCE: f64 = 7.0;

/// Returns the position of the arrow of a net; `None` if there is no suitable position.
///
/// It is near the middle of the longest section that runs back.
fn arrow_position(line: &ChannelLine, source: f64, crossing: &[f64]) -> Option<f64> {
    let mut connections: Vec<f64> =
        line.before.iter().chain(&line.after).copied().filter(|x| *x <= source + BEYOND_ROW).collect();
    connections.sort_by(f64::total_cmp);
    let from = connections.iter().copied().filter(|x| *x > source).fold(f64::INFINITY, f64::min);
    let mut back: Vec<_> = connections.windows(2).filter(|pair| pair[1] <= from).collect();
    back.sort_by(|a, b| (b[1] - b[0]).total_cmp(&(a[1] - a[0])));
    let long = back.into_iter().filter(|pair| pair[1] - pair[0] > 4.0 * PITCH);
    let is_clear = |x: &f64| crossing.iter().all(|other| (x - other).abs() >= ARROW_CLEARANCE);
    let mut near = long.flat_map(|pair| {
        let (middle, far) = ((pair[0] + pair[1]) / 2.0, (pair[1] - pair[0]) / 2.0);
        (0..far as i32).flat_map(move |step| [middle - f64::from(step), middle + f64::from(step)])
    });
    near.find(is_clear)
}

/// Merges lines that overlap or touch in the same direction.
fn merge_lines(lines: &[[Point; 2]]) -> Vec<[Point; 2]> {
    let horizontal = lines.iter().filter(|[a, b]| a.1 == b.1 && a.0 != b.0).map(|[a, b]| (a.1, a.0, b.0));
    let vertical = lines.iter().filter(|[a, b]| a.0 == b.0 && a.1 != b.1).map(|[a, b]| (a.0, a.1, b.1));
    let horizontal =
        merge_sections(horizontal.collect()).into_iter().map(|(y, from, to)| [(from, y), (to, y)]);
    let vertical = merge_sections(vertical.collect()).into_iter().map(|(x, from, to)| [(x, from), (x, to)]);
    horizontal.chain(vertical).collect()
}

/// A section of a horizontal or vertical line: its constant coordinate, its start and its end.
type Section = (f64, f64, f64);

/// Merges sections with the same constant coordinate that overlap or touch.
fn merge_sections(mut sections: Vec<Section>) -> Vec<Section> {
    sections.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut whole: Vec<Section> = Vec::new();
    for section in sections {
        match whole.last_mut() {
            Some(last) if last.0 == section.0 && section.1 <= last.2 => last.2 = last.2.max(section.2),
            _ => whole.push(section),
        }
    }
    whole
}

/// Returns the points at which lines of a net meet in three or four directions.
fn dots(lines: &[[Point; 2]]) -> Vec<Point> {
    let mut dots = Vec::new();
    let is_horizontal = |line: &&[Point; 2]| line[0].1 == line[1].1;
    for horizontal in lines.iter().filter(is_horizontal) {
        for vertical in lines.iter().filter(|line| !is_horizontal(line)) {
            let at = (vertical[0].0, horizontal[0].1);
            let directions =
                [at.0 > horizontal[0].0, at.0 < horizontal[1].0, at.1 > vertical[0].1, at.1 < vertical[1].1];
            let touches = (horizontal[0].0..=horizontal[1].0).contains(&at.0)
                && (vertical[0].1..=vertical[1].1).contains(&at.1);
            if touches && directions.iter().filter(|has_line| **has_line).count() > 2 {
                dots.push(at);
            }
        }
    }
    dots
}
