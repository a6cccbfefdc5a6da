//! Laying out a graph of boxes and nets: layers from left to right, feedback below, cords on tracks of their own.
//!
//! The method is the classical one of layered drawings (Sugiyama, Tagawa, Toda 1981) with channel routing: cords
//! run level through layers and upright in the channels between them; what goes back, or to another row, runs in
//! a street below or above the row. No two nets share a track. Circuits that have but their drives in common stand one
//! below the other.

mod align;
mod crossings;
mod layers;
mod order;
mod parts;
mod rows;
mod tidy;
mod tracks;
mod wires;

use crate::plot::Area;

/// A place on the sheet, in pixels from its upper left corner.
pub type Point = (f64, f64);

/// A box with jacks, measured from its anchor.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// Its room, texts included.
    pub area: Area,
    /// Where cords arrive.
    pub inputs: Vec<Point>,
    /// Where cords leave, one net each.
    pub outputs: Vec<Point>,
    /// So many of the inputs, the first ones, may be exchanged among each other.
    pub free: usize,
    /// Whether it stands before what it feeds rather than behind what feeds it.
    pub leans_right: bool,
}

/// An output and the inputs that read it.
#[derive(Debug, Clone)]
pub(crate) struct Net {
    /// The node that drives it.
    pub from: usize,
    /// Which of the node's outputs it is.
    pub outlet: usize,
    /// Node and input of every reader.
    pub to: Vec<(usize, usize)>,
}

/// What is laid out.
#[derive(Debug, Clone, Default)]
pub(crate) struct Graph {
    /// The boxes.
    pub nodes: Vec<Node>,
    /// Nets, at most one an output.
    pub nets: Vec<Net>,
    /// Nodes at which reading begins, the first one first.
    pub starts: Vec<usize>,
}

/// Where everything stands.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    /// Anchor of every node.
    pub places: Vec<Point>,
    /// For every node and input, the index of the place that it takes among the node's inputs.
    pub slots: Vec<Vec<usize>>,
    /// Lines of every net.
    pub routes: Vec<Route>,
    /// Size of the whole.
    pub size: (f64, f64),
}

/// The lines of a net.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Route {
    /// Level and upright lines, none of them overlapping.
    pub lines: Vec<[Point; 2]>,
    /// Where three or more of them meet.
    pub dots: Vec<Point>,
    /// Places on lines that run back, where a small arrow shows the way of the signal.
    pub arrows: Vec<Point>,
}

/// Lays a graph out, unless it would be higher than `highest`.
///
/// # Errors
/// How high it would be at least, which is known before the work begins.
pub(crate) fn layout(graph: &Graph, highest: f64) -> Result<Layout, f64> {
    let rank = order::ranks(graph);
    let cells = rows::fold(graph, &rank);
    let least = rows::least_height(graph, &cells);
    if least > highest {
        return Err(least);
    }
    let mut sheet = wires::Sheet::new(graph, &cells);
    crossings::reduce(graph, &rank, &mut sheet);
    align::align(graph, &mut sheet);
    Ok(tidy::routed(graph, &sheet))
}
