//! The layout of a graph of boxes and nets: layers from left to right, feedback below.
//!
//! The method is that of layered drawings (Sugiyama, Tagawa and Toda 1981) with channel routing:
//!
//! 1. `order`, `components`, `layers` and `rows` assign each node to a row and a layer. Unconnected
//!    parts of a circuit get separate rows, and a very wide drawing is folded into several rows.
//! 2. `wires` assigns the nets to channels and row gaps. A channel is the vertical space between two
//!    layers, and a row gap is the horizontal space between two rows.
//! 3. `crossings` orders the nodes of each layer, and `align` sets their heights with `medians`.
//! 4. `tracks` and `coordinates` give each net a separate track and set all positions.
//! 5. `routes` makes the lines of the nets with their dots and arrows.
//!
//! Nets that run back, or to another row, use the row gaps. No two nets share a track.

mod align;
mod components;
mod coordinates;
mod crossings;
mod layers;
mod medians;
mod order;
mod routes;
mod rows;
mod tracks;
mod wires;

use crate::plot::Area;

/// A position on the sheet, in pixels from its upper left corner.
pub type Point = (f64, f64);

/// A box with jacks. Positions are relative to its anchor.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// The area, including texts.
    pub area: Area,
    /// The positions of the inputs.
    pub inputs: Vec<Point>,
    /// The positions of the outputs; each has at most one net.
    pub outputs: Vec<Point>,
    /// The number of leading inputs that may be exchanged with each other.
    pub exchangeable: usize,
    /// Whether the node is placed next to its readers instead of next to its sources.
    pub prefers_right: bool,
}

/// An output and the inputs that are connected to it.
#[derive(Debug, Clone)]
pub(crate) struct GraphNet {
    /// The node with the output.
    pub from: usize,
    /// The index of the output of that node.
    pub output: usize,
    /// The node and the input of each reader.
    pub to: Vec<(usize, usize)>,
}

/// The graph to be laid out.
#[derive(Debug, Clone, Default)]
pub(crate) struct Graph {
    /// The nodes.
    pub nodes: Vec<Node>,
    /// The nets, at most one for each output.
    pub nets: Vec<GraphNet>,
    /// The nodes at which the order of reading starts, in order of preference.
    pub starts: Vec<usize>,
}

/// The positions of nodes and nets.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// The anchor of each node.
    pub positions: Vec<Point>,
    /// For each node and input, the index of the jack that it uses among the inputs of the node.
    pub input_slots: Vec<Vec<usize>>,
    /// The lines of each net.
    pub routes: Vec<Route>,
    /// Width and height.
    pub size: (f64, f64),
}

/// The lines of a net.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Route {
    /// Horizontal and vertical lines; they do not overlap.
    pub lines: Vec<[Point; 2]>,
    /// The points where three or more lines meet.
    pub dots: Vec<Point>,
    /// The positions of arrows on lines that run back.
    pub arrows: Vec<Point>,
}

/// Lays out a graph.
///
/// # Errors
///
/// If the layout would be higher than `max_height`. The error is a lower bound of the height, which is
/// checked before the layout starts.
pub(crate) fn layout(graph: &Graph, max_height: f64) -> Result<Layout, f64> {
    let rank = order::ranks(graph);
    let cells = rows::fold(graph, &rank);
    let min_height = rows::min_height(graph, &cells);
    if min_height > max_height {
        return Err(min_height);
    }
    let mut sheet = wires::LayeredSheet::new(graph, &cells);
    crossings::reduce(graph, &rank, &mut sheet);
    align::align(graph, &mut sheet);
    Ok(coordinates::assign(graph, &sheet))
}
