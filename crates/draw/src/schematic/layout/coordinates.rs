//! Converts rows, layers and trunks into positions and lines.
//!
//! Channels and row gaps get their widths from the number of tracks in them. Then the lines of each net
//! are routed and merged, and dots and arrows are added.

use super::tracks::{self, ChannelLine};
use super::wires::{ItemKind, LayerRow, LayeredSheet, Pin, PinKind, Trunk};
use super::{Graph, Layout, Point, Route};

/// The distance of parallel nets.
const PITCH: f64 = 10.0;

/// The gap next to the outermost net of a channel or row gap.
const EDGE_GAP: f64 = 12.0;

/// The height of a row gap without nets.
const EMPTY_ROW_GAP: f64 = 24.0;

/// The horizontal positions of a row.
struct ColumnPositions {
    /// The x of the anchors of each layer.
    layers: Vec<f64>,
    /// The x of each trunk of each channel.
    trunks: Vec<Vec<f64>>,
    /// The right edge of the last channel.
    width: f64,
}

/// The vertical positions of the rows and row gaps.
struct RowPositions {
    /// The upper edge of each row.
    rows: Vec<f64>,
    /// For each row gap, its nets with their heights.
    row_gaps: Vec<Vec<(usize, f64)>>,
    /// The lower edge of the last row gap.
    height: f64,
}

/// Returns the positions of all nodes and the lines of all nets.
pub(super) fn assign(graph: &Graph, sheet: &LayeredSheet) -> Layout {
    let columns: Vec<ColumnPositions> = (0..sheet.rows.len()).map(|row| columns(graph, sheet, row)).collect();
    let row_positions = row_positions(graph, sheet, &columns);
    let mut positions = vec![(0.0, 0.0); graph.nodes.len()];
    for (index, row) in sheet.rows.iter().enumerate() {
        for (layer, items) in row.layers.iter().enumerate() {
            for item in items {
                if let ItemKind::Node(node) = row.items[*item].kind {
                    positions[node] =
                        (columns[index].layers[layer], row_positions.rows[index] + row.items[*item].y);
                }
            }
        }
    }
    let builder = RouteBuilder {
        graph,
        sheet,
        columns: &columns,
        row_positions: &row_positions,
        positions: &positions,
    };
    let routes = (0..graph.nets.len()).map(|_| Route::default()).collect();
    let routes = builder.routes(routes);
    let width = columns.iter().map(|columns| columns.width).fold(0.0, f64::max);
    Layout { positions, input_slots: sheet.input_slots.clone(), routes, size: (width, row_positions.height) }
}

/// Returns the trunks of a channel as lines for the assignment of tracks.
fn channel_lines(graph: &Graph, sheet: &LayeredSheet, row: usize, channel: usize) -> Vec<ChannelLine> {
    let height = |pin: &Pin| sheet.height(graph, row, *pin);
    let line = |trunk: &Trunk| ChannelLine {
        before: trunk.left.iter().map(height).collect(),
        after: trunk.right.iter().map(height).collect(),
        reach: [(trunk.up, -BEYOND_ROW), (trunk.down, BEYOND_ROW)]
            .iter()
            .filter(|(is_used, _)| *is_used)
            .map(|(_, at)| *at)
            .collect(),
    };
    sheet.rows[row].channels[channel].iter().map(line).collect()
}

/// A position beyond the ends of every row.
const BEYOND_ROW: f64 = 1e9;

/// Returns the width to the left and to the right of the anchors of a layer.
fn extent(graph: &Graph, row: &LayerRow, layer: usize) -> (f64, f64) {
    let nodes = row.layers[layer].iter().filter_map(|item| match row.items[*item].kind {
        ItemKind::Node(node) => Some(graph.nodes[node].area),
        ItemKind::PassThrough(_) => None,
    });
    nodes.fold((0.0, 0.0), |(left, right), area| (f64::max(left, -area.left), f64::max(right, area.right)))
}

/// Returns the horizontal positions of a row.
///
/// The tracks of neighbouring rows are shifted by half a pitch. A trunk from above and one from below are
/// therefore never at the same x in a row gap.
fn columns(graph: &Graph, sheet: &LayeredSheet, row: usize) -> ColumnPositions {
    let shift = if row % 2 == 1 { PITCH / 2.0 } else { 0.0 };
    let mut columns = ColumnPositions { layers: Vec::new(), trunks: Vec::new(), width: 0.0 };
    let mut x = 0.0;
    for channel in 0..sheet.rows[row].channels.len() {
        let channel_lines = channel_lines(graph, sheet, row, channel);
        let (tracks, count) = tracks::assign(&channel_lines);
        let first = ((x + EDGE_GAP - shift) / PITCH).ceil() * PITCH + shift;
        let position = |(line, track): (&ChannelLine, usize)| {
            if line.is_straight() { x } else { first + track as f64 * PITCH }
        };
        columns.trunks.push(channel_lines.iter().zip(tracks).map(position).collect());
        x = if count == 0 { x + EDGE_GAP } else { first + (count - 1) as f64 * PITCH + EDGE_GAP };
        if channel < sheet.rows[row].layers.len() {
            let (left, right) = extent(graph, &sheet.rows[row], channel);
            columns.layers.push((x + left).ceil());
            x = (x + left).ceil() + right.ceil();
        }
    }
    columns.width = x;
    columns
}

/// Returns the nets of a row that continue to the row gap above or below, with the x of their trunks.
fn leaving<'a>(
    row: &'a LayerRow,
    columns: &'a ColumnPositions,
    below: bool,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let all = row.channels.iter().zip(&columns.trunks);
    let all = all.flat_map(|(trunks, positions)| trunks.iter().zip(positions));
    all.filter(move |(trunk, _)| if below { trunk.down } else { trunk.up }).map(|(trunk, x)| (trunk.net, *x))
}

/// Returns the vertical positions of all rows and row gaps.
///
/// Row gap n is above row n, and the last one is below the last row. The first and the last row gap have no
/// height if no net uses them.
fn row_positions(graph: &Graph, sheet: &LayeredSheet, columns: &[ColumnPositions]) -> RowPositions {
    let mut row_positions = RowPositions { rows: Vec::new(), row_gaps: Vec::new(), height: 0.0 };
    let mut y = 0.0;
    for row_gap in 0..=sheet.rows.len() {
        let (nets, channel_lines) = row_gap_lines(sheet, columns, row_gap);
        let (tracks, count) = tracks::assign(&channel_lines);
        let heights = nets.iter().zip(tracks).map(|(net, track)| (*net, y + EDGE_GAP + track as f64 * PITCH));
        row_positions.row_gaps.push(heights.collect());
        y += match count {
            0 if row_gap == 0 || row_gap == sheet.rows.len() => 0.0,
            0 => EMPTY_ROW_GAP,
            count => 2.0 * EDGE_GAP + (count - 1) as f64 * PITCH,
        };
        if let Some(row) = sheet.rows.get(row_gap) {
            row_positions.rows.push(y);
            y += row_height(graph, row);
        }
    }
    row_positions.height = y;
    row_positions
}

/// Returns the lower edge of the lowest item of a row, below the top of the row.
fn row_height(graph: &Graph, row: &LayerRow) -> f64 {
    let bottom = |item: &super::wires::Item| match item.kind {
        ItemKind::Node(node) => item.y + graph.nodes[node].area.bottom,
        ItemKind::PassThrough(_) => item.y,
    };
    row.items.iter().map(bottom).fold(0.0, f64::max).ceil()
}

/// Returns the nets of a row gap and their lines for the assignment of tracks.
fn row_gap_lines(
    sheet: &LayeredSheet,
    columns: &[ColumnPositions],
    row_gap: usize,
) -> (Vec<usize>, Vec<ChannelLine>) {
    let mut channel_lines: std::collections::BTreeMap<usize, ChannelLine> = std::collections::BTreeMap::new();
    if let Some(above) = row_gap.checked_sub(1) {
        for (net, x) in leaving(&sheet.rows[above], &columns[above], true) {
            channel_lines.entry(net).or_default().before.push(x);
        }
    }
    if let Some(row) = sheet.rows.get(row_gap) {
        for (net, x) in leaving(row, &columns[row_gap], false) {
            channel_lines.entry(net).or_default().after.push(x);
        }
    }
    channel_lines.into_iter().unzip()
}

/// Makes the lines of the nets from the positions of rows, layers and tracks.
struct RouteBuilder<'a> {
    /// The nodes and nets.
    graph: &'a Graph,
    /// The trunks and the heights of the pins.
    sheet: &'a LayeredSheet,
    /// The horizontal positions of each row.
    columns: &'a [ColumnPositions],
    /// The vertical positions of the rows.
    row_positions: &'a RowPositions,
    /// The anchors of the nodes.
    positions: &'a [Point],
}

impl RouteBuilder<'_> {
    /// Returns the complete routes of all nets.
    ///
    /// The lines of all channels and row gaps are collected first and then merged, so that dots are only where
    /// the lines branch. The arrows are added last, because they avoid the vertical lines of all nets.
    fn routes(&self, mut routes: Vec<Route>) -> Vec<Route> {
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
