//! Converts rows and layers into positions.
//!
//! Channels and row gaps get their widths from the number of tracks in them. The widths give the positions
//! of the nodes, and the tracks those of the lines. `routes` then makes the lines of each net.

use std::collections::BTreeMap;

use super::routes::RouteBuilder;
use super::tracks::{self, ChannelLine};
use super::wires::{Item, ItemKind, LayerRow, LayeredSheet, Pin, Trunk};
use super::{Graph, Layout};

/// The distance of parallel nets.
pub(super) const PITCH: f64 = 10.0;

/// The gap next to the outermost net of a channel or row gap.
const EDGE_GAP: f64 = 12.0;

/// The height of a row gap without nets.
const EMPTY_ROW_GAP: f64 = 24.0;

/// The horizontal positions of a row.
pub(super) struct ColumnPositions {
    /// The x of the anchors of each layer.
    pub layers: Vec<f64>,
    /// The x of each trunk of each channel.
    pub trunks: Vec<Vec<f64>>,
    /// The right edge of the last channel.
    width: f64,
}

/// The vertical positions of the rows and row gaps.
pub(super) struct RowPositions {
    /// The upper edge of each row.
    pub rows: Vec<f64>,
    /// For each row gap, its nets with their heights.
    pub row_gaps: Vec<Vec<(usize, f64)>>,
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
    let routes = builder.routes();
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
pub(super) const BEYOND_ROW: f64 = 1e9;

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
    let bottom = |item: &Item| match item.kind {
        ItemKind::Node(node) => item.y + graph.nodes[node].area.bottom,
        ItemKind::PassThrough(_) => item.y,
    };
    row.items.iter().map(bottom).fold(0.0, f64::max).ceil()
}

/// Returns the nets of a row gap and their lines for the assignment of tracks.
pub(super) fn row_gap_lines(
    sheet: &LayeredSheet,
    columns: &[ColumnPositions],
    row_gap: usize,
) -> (Vec<usize>, Vec<ChannelLine>) {
    let mut channel_lines: BTreeMap<usize, ChannelLine> = BTreeMap::new();
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
