//! Rows: a drawing much wider than high is folded like a line of text.

use std::collections::BTreeMap;

use super::align::APART;
use super::layers::{Edge, assign, forward_edges};
use super::{Graph, Node, parts};

/// Row and layer of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cell {
    pub row: usize,
    pub layer: usize,
}

/// A drawing is not folded below this width.
const NARROW: f64 = 1250.0;

/// Width against height that a sheet should have.
const ASPECT: f64 = 1.9;

/// Room for cords that a layer takes beside its nodes.
const CHANNEL: f64 = 40.0;

/// Height that cords between rows take.
const STREET: f64 = 90.0;

/// What a row of other than its fair width costs, in cords that go from row to row.
const UNEVEN: f64 = 10.0;

/// What it costs to part a pot from what it feeds.
const TORN: f64 = 2.0;

/// The cell of every node; every part of the circuit has rows of its own.
pub(super) fn fold(graph: &Graph, rank: &[usize]) -> Vec<Cell> {
    let parts = parts::of(graph);
    let mut edges = forward_edges(graph, rank);
    edges.retain(|(from, to)| parts[*from] == parts[*to]);
    let layers = assign(graph, rank, &edges);
    let mut rows = vec![0; graph.nodes.len()];
    let mut count = 0;
    for part in 0..=parts.iter().max().copied().unwrap_or(0) {
        let nodes: Vec<usize> = (0..rows.len()).filter(|node| parts[*node] == part).collect();
        let row_of_layer = row_of_layers(graph, &nodes, &layers, &edges);
        nodes.iter().for_each(|node| rows[*node] = count + row_of_layer[layers[*node]]);
        count += row_of_layer.last().map_or(0, |last| last + 1);
    }
    edges.retain(|(from, to)| rows[*from] == rows[*to]);
    let within = assign(graph, rank, &edges);
    let mut first = vec![usize::MAX; count];
    rows.iter().zip(&within).for_each(|(row, layer)| first[*row] = first[*row].min(*layer));
    rows.iter().zip(&within).map(|(row, layer)| Cell { row: *row, layer: layer - first[*row] }).collect()
}

/// No sheet is lower than its fullest layer.
pub(super) fn least_height(graph: &Graph, cells: &[Cell]) -> f64 {
    let mut layers: BTreeMap<Cell, f64> = BTreeMap::new();
    for (node, cell) in graph.nodes.iter().zip(cells) {
        *layers.entry(*cell).or_insert(-APART) += node.area.height() + APART;
    }
    layers.into_values().fold(0.0, f64::max)
}

fn row_of_layers(graph: &Graph, nodes: &[usize], layers: &[usize], edges: &[Edge]) -> Vec<usize> {
    let count = nodes.iter().map(|node| layers[*node] + 1).max().unwrap_or(0);
    let (mut widths, mut heights) = (vec![0.0_f64; count], vec![0.0; count]);
    for node in nodes {
        let (area, layer) = (&graph.nodes[*node].area, layers[*node]);
        widths[layer] = widths[layer].max(area.width());
        heights[layer] += area.height() + APART;
    }
    widths.iter_mut().for_each(|width| *width += CHANNEL);
    let whole: f64 = widths.iter().sum();
    let highest = heights.iter().fold(1.0, |most: f64, height| most.max(*height));
    let rows = (whole / (ASPECT * (highest + STREET))).sqrt().round().max(1.0);
    if whole < NARROW || rows < 2.0 {
        return vec![0; count];
    }
    let cut = cords_cut(graph, nodes, layers, edges, count);
    divide(&widths, &cut, rows as usize)
}

/// For every layer, the nets that go forward over its right side.
fn cords_cut(graph: &Graph, nodes: &[usize], layers: &[usize], edges: &[Edge], count: usize) -> Vec<f64> {
    let mut last = layers.to_vec();
    for (from, to) in edges {
        last[*from] = last[*from].max(layers[*to]);
    }
    let mut cut = vec![0.0; count];
    for node in nodes {
        let cost = if graph.nodes[*node].leans_right { TORN } else { 1.0 };
        cut[layers[*node]..last[*node]].iter_mut().for_each(|nets| *nets += cost);
    }
    cut
}

/// Divides layers into rows of nearly equal width where few cords are cut.
fn divide(widths: &[f64], cut: &[f64], rows: usize) -> Vec<usize> {
    let fair = widths.iter().sum::<f64>() / rows as f64;
    let (count, mut best) = (widths.len(), vec![vec![(f64::INFINITY, 0); widths.len() + 1]; rows + 1]);
    best[0][0].0 = 0.0;
    for row in 1..=rows {
        for end in 1..=count {
            let mut width = 0.0;
            for begin in (0..end).rev() {
                width += widths[begin];
                let uneven = UNEVEN * (width / fair - 1.0).powi(2);
                let cords = if begin > 0 { cut[begin - 1] } else { 0.0 };
                let cost = best[row - 1][begin].0 + uneven + cords;
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
    /// Height of the room of the node above or below its anchor.
    pub(super) fn reach(&self, above: bool) -> f64 {
        if above { -self.area.top } else { self.area.bottom }
    }
}
