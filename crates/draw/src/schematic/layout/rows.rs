//! Folds a wide drawing into rows, like a line of text.

use std::collections::BTreeMap;

use super::align::NODE_GAP;
use super::layers::{Edge, assign, forward_edges};
use super::{Graph, Node, components};

/// The row and layer of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cell {
    /// The row, from the top down.
    pub row: usize,
    /// The layer in the row, from left to right.
    pub layer: usize,
}

/// The minimum width of a drawing that is folded.
const MIN_FOLDED_WIDTH: f64 = 1250.0;

/// The desired ratio of width to height of a sheet.
const ASPECT: f64 = 1.9;

/// The estimated width of a channel.
const CHANNEL_WIDTH: f64 = 40.0;

/// The estimated height of a row gap.
const ROW_GAP_HEIGHT: f64 = 90.0;

/// The cost of the squared relative deviation of a row from the mean width, in cut nets.
const WIDTH_COST: f64 = 10.0;

/// The cost of a cut between a pot and its readers; the cut of any other net costs 1.
const POT_CUT_COST: f64 = 2.0;

/// Returns the cell of each node. Every component of the graph has separate rows.
///
/// The nodes are assigned to layers twice: once to choose the rows, and again within each row without the connections
/// to other rows.
pub(super) fn fold(graph: &Graph, rank: &[usize]) -> Vec<Cell> {
    let components = components::of_nodes(graph);
    let mut edges = forward_edges(graph, rank);
    edges.retain(|(from, to)| components[*from] == components[*to]);
    let layers = assign(graph, rank, &edges);
    let mut rows = vec![0; graph.nodes.len()];
    let mut count = 0;
    for component in 0..=components.iter().max().copied().unwrap_or(0) {
        let nodes: Vec<usize> = (0..rows.len()).filter(|node| components[*node] == component).collect();
        let row_of_layer = row_of_layers(graph, &nodes, &layers, &edges);
        nodes.iter().for_each(|node| rows[*node] = count + row_of_layer[layers[*node]]);
        count += row_of_layer.last().map_or(0, |last| last + 1);
    }
    edges.retain(|(from, to)| rows[*from] == rows[*to]);
    let in_row = assign(graph, rank, &edges);
    let mut first = vec![usize::MAX; count];
    rows.iter().zip(&in_row).for_each(|(row, layer)| first[*row] = first[*row].min(*layer));
    rows.iter().zip(&in_row).map(|(row, layer)| Cell { row: *row, layer: layer - first[*row] }).collect()
}

/// Returns a lower bound of the height: that of the highest layer.
pub(super) fn min_height(graph: &Graph, cells: &[Cell]) -> f64 {
    let mut layers: BTreeMap<Cell, f64> = BTreeMap::new();
    for (node, cell) in graph.nodes.iter().zip(cells) {
        *layers.entry(*cell).or_insert(-NODE_GAP) += node.area.height() + NODE_GAP;
    }
    layers.into_values().fold(0.0, f64::max)
}

/// Returns the row of each layer of one component.
fn row_of_layers(graph: &Graph, nodes: &[usize], layers: &[usize], edges: &[Edge]) -> Vec<usize> {
    let count = nodes.iter().map(|node| layers[*node] + 1).max().unwrap_or(0);
    let (mut widths, mut heights) = (vec![0.0_f64; count], vec![0.0; count]);
    for node in nodes {
        let (area, layer) = (&graph.nodes[*node].area, layers[*node]);
        widths[layer] = widths[layer].max(area.width());
        heights[layer] += area.height() + NODE_GAP;
    }
    widths.iter_mut().for_each(|width| *width += CHANNEL_WIDTH);
    let whole: f64 = widths.iter().sum();
    let highest = heights.iter().fold(1.0, |highest: f64, height| highest.max(*height));
    let rows = (whole / (ASPECT * (highest + ROW_GAP_HEIGHT))).sqrt().round().max(1.0);
    if whole < MIN_FOLDED_WIDTH || rows < 2.0 {
        return vec![0; count];
    }
    let cut = cut_costs(graph, nodes, layers, edges, count);
    divide(&widths, &cut, rows as usize)
}

/// Returns, for each layer, the cost of the nets that cross its right side.
fn cut_costs(graph: &Graph, nodes: &[usize], layers: &[usize], edges: &[Edge], count: usize) -> Vec<f64> {
    let mut last = layers.to_vec();
    for (from, to) in edges {
        last[*from] = last[*from].max(layers[*to]);
    }
    let mut cut = vec![0.0; count];
    for node in nodes {
        let cost = if graph.nodes[*node].prefers_right { POT_CUT_COST } else { 1.0 };
        cut[layers[*node]..last[*node]].iter_mut().for_each(|nets| *nets += cost);
    }
    cut
}

/// Divides layers into rows of similar width so that few nets are cut, by dynamic programming.
///
/// `widths` and `cut` have one entry per layer; `cut` is the cost of a row that ends after the layer. The result is the
/// row of each layer. With n layers the time grows as n^2 x rows.
fn divide(widths: &[f64], cut: &[f64], rows: usize) -> Vec<usize> {
    let mean = widths.iter().sum::<f64>() / rows as f64;
    let (count, mut best) = (widths.len(), vec![vec![(f64::INFINITY, 0); widths.len() + 1]; rows + 1]);
    best[0][0].0 = 0.0;
    for row in 1..=rows {
        for end in 1..=count {
            let mut width = 0.0;
            for begin in (0..end).rev() {
                width += widths[begin];
                let deviation = WIDTH_COST * (width / mean - 1.0).powi(2);
                let cuts = if begin > 0 { cut[begin - 1] } else { 0.0 };
                let cost = best[row - 1][begin].0 + deviation + cuts;
                if cost < best[row][end].0 {
                    best[row][end] = (cost, begin);
                }
            }
        }
    }
    let (mut of_layer, mut end) = (vec![0; count], count);
    for row in (1..=rows).rev() {
        let begin = best[row][end].1;
        of_layer[begin..end].fill(row - 1);
        end = begin;
    }
    of_layer
}

impl Node {
    /// Returns the height of the node above or below its anchor.
    pub(super) fn reach(&self, above: bool) -> f64 {
        if above { -self.area.top } else { self.area.bottom }
    }
}
