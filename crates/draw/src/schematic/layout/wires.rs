//! Assigns the nets to channels and row gaps.
//!
//! A net has at most one trunk, a vertical line, in each channel. It passes through the layers between
//! its output and the last input to the right. Inputs further left, or in other rows, are connected
//! through row gaps.

use std::collections::BTreeMap;

use super::rows::Cell;
use super::{Graph, GraphNet};

/// The nodes and nets of all rows.
#[derive(Debug)]
pub(super) struct LayeredSheet {
    /// The rows from the top down.
    pub rows: Vec<LayerRow>,
    /// For each node and input, the index of the jack that it uses among the inputs of the node.
    pub input_slots: Vec<Vec<usize>>,
}

/// A row: layers and the channels between them.
///
/// Channel n is to the left of layer n. The last channel is to the right of the last layer.
#[derive(Debug, Default)]
pub(super) struct LayerRow {
    /// The items of all layers.
    pub items: Vec<Item>,
    /// For each layer, the indices of its items from the top down.
    pub layers: Vec<Vec<usize>>,
    /// For each channel, the trunks in it.
    pub channels: Vec<Vec<Trunk>>,
}

/// A node, or a net that passes through a layer.
#[derive(Debug)]
pub(super) struct Item {
    /// What the item is.
    pub kind: ItemKind,
    /// The height of the anchor below the top of the row.
    pub y: f64,
}

/// The kind of an item.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ItemKind {
    /// A node, by its index.
    Node(usize),
    /// A net, by its index.
    PassThrough(usize),
}

/// The vertical line of a net in a channel.
#[derive(Debug, Clone)]
pub(super) struct Trunk {
    /// The index of the net.
    pub net: usize,
    /// The pin in the layer to the left that drives the trunk; `None` if it is driven from a row gap.
    pub left: Option<Pin>,
    /// The pins in the layer to the right.
    pub right: Vec<Pin>,
    /// Whether the trunk continues to the row gap above the row.
    pub up: bool,
    /// Whether the trunk continues to the row gap below the row.
    pub down: bool,
}

/// The connection of a net to an item.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pin {
    /// The index of the item in its row.
    pub item: usize,
    /// The point of the item at which the net is connected.
    pub kind: PinKind,
}

/// The kind of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PinKind {
    /// An output of a node.
    Output(usize),
    /// An input of a node.
    Input(usize),
    /// The point at which a net passes through a layer.
    PassThrough,
}

/// The number of items above which a row gets fewer rounds of improvement.
const LARGE_ROW: usize = 20_000;

impl LayerRow {
    /// Returns the number of rounds of improvement: at most `max`, fewer for a large row, at least 2.
    pub(super) fn rounds(&self, max: usize) -> usize {
        (max * LARGE_ROW / self.items.len().max(LARGE_ROW)).max(2)
    }
}

impl LayeredSheet {
    /// Assigns all nodes and nets. The heights of the items are 0 until they are aligned.
    pub(super) fn new(graph: &Graph, cells: &[Cell]) -> LayeredSheet {
        let count = cells.iter().map(|cell| cell.row + 1).max().unwrap_or(0);
        let mut builder = SheetBuilder {
            cells,
            rows: (0..count).map(|row| empty_row(cells, row)).collect(),
            trunks: BTreeMap::new(),
            items: BTreeMap::new(),
        };
        for (node, cell) in cells.iter().enumerate() {
            builder.item(*cell, ItemKind::Node(node));
        }
        for (index, net) in graph.nets.iter().enumerate() {
            builder.add_net(index, net);
        }
        let input_slots = graph.nodes.iter().map(|node| (0..node.inputs.len()).collect()).collect();
        LayeredSheet { rows: builder.finished(), input_slots }
    }

    /// Returns the height of a pin below the anchor of its item; negative if above.
    pub(super) fn offset(&self, graph: &Graph, row: usize, pin: Pin) -> f64 {
        let ItemKind::Node(node) = self.rows[row].items[pin.item].kind else { return 0.0 };
        match pin.kind {
            PinKind::Output(output) => graph.nodes[node].outputs[output].1,
            PinKind::Input(input) => graph.nodes[node].inputs[self.input_slots[node][input]].1,
            PinKind::PassThrough => 0.0,
        }
    }

    /// Returns the height of a pin below the top of its row.
    pub(super) fn height(&self, graph: &Graph, row: usize, pin: Pin) -> f64 {
        self.rows[row].items[pin.item].y + self.offset(graph, row, pin)
    }
}

impl Trunk {
    /// Returns all pins of the trunk.
    pub(super) fn pins(&self) -> impl Iterator<Item = Pin> + '_ {
        self.left.iter().chain(&self.right).copied()
    }

    /// Returns the pin to the left with each pin to the right; nothing if a row gap drives the trunk.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (Pin, Pin)> + '_ {
        self.left.iter().flat_map(|left| self.right.iter().map(move |right| (*left, *right)))
    }
}

/// Returns a row with the layers that its cells need, without items.
fn empty_row(cells: &[Cell], row: usize) -> LayerRow {
    let layers = cells.iter().filter(|cell| cell.row == row).map(|cell| cell.layer + 1).max().unwrap_or(0);
    LayerRow { items: Vec::new(), layers: vec![Vec::new(); layers], channels: vec![Vec::new(); layers + 1] }
}

/// Converts nets into trunks. Each net has one trunk in a channel.
struct SheetBuilder<'a> {
    /// The row and layer of each node.
    cells: &'a [Cell],
    /// The rows; their channels are empty until the end.
    rows: Vec<LayerRow>,
    /// The trunks by row, channel and net.
    trunks: BTreeMap<(usize, usize, usize), Trunk>,
    /// The items by cell and kind.
    items: BTreeMap<(Cell, ItemKind), usize>,
}

impl SheetBuilder<'_> {
    /// Returns the item of a cell, which is added if it is new.
    fn item(&mut self, cell: Cell, kind: ItemKind) -> usize {
        let row = &mut self.rows[cell.row];
        *self.items.entry((cell, kind)).or_insert_with(|| {
            row.items.push(Item { kind, y: 0.0 });
            row.layers[cell.layer].push(row.items.len() - 1);
            row.items.len() - 1
        })
    }

    /// Returns the trunk of a net in a channel, which is added if it is new.
    fn trunk(&mut self, row: usize, channel: usize, net: usize) -> &mut Trunk {
        let empty = Trunk { net, left: None, right: Vec::new(), up: false, down: false };
        self.trunks.entry((row, channel, net)).or_insert(empty)
    }

    /// Adds a net to its channels, layers and row gaps.
    fn add_net(&mut self, index: usize, net: &GraphNet) {
        let source = self.cells[net.from];
        let from =
            Pin { item: self.item(source, ItemKind::Node(net.from)), kind: PinKind::Output(net.output) };
        self.trunk(source.row, source.layer + 1, index).left = Some(from);
        let is_forward = |cell: Cell| cell.row == source.row && cell.layer > source.layer;
        let forward = net.to.iter().map(|(node, _)| self.cells[*node]).filter(|cell| is_forward(*cell));
        let last = forward.map(|cell| cell.layer).max().unwrap_or(0);
        for layer in source.layer + 1..last {
            self.pass(index, Cell { row: source.row, layer });
        }
        for (node, input) in &net.to {
            let cell = self.cells[*node];
            let pin = Pin { item: self.item(cell, ItemKind::Node(*node)), kind: PinKind::Input(*input) };
            self.trunk(cell.row, cell.layer, index).right.push(pin);
            if !is_forward(cell) {
                self.through_row_gaps(index, source, cell);
            }
        }
    }

    /// Passes a net through a layer.
    fn pass(&mut self, net: usize, cell: Cell) {
        let through = Pin { item: self.item(cell, ItemKind::PassThrough(net)), kind: PinKind::PassThrough };
        self.trunk(cell.row, cell.layer, net).right.push(through);
        self.trunk(cell.row, cell.layer + 1, net).left = Some(through);
    }

    /// Connects source and target through the row gaps between their rows.
    ///
    /// Within a row, the gap below the row is used.
    fn through_row_gaps(&mut self, net: usize, source: Cell, target: Cell) {
        let below = target.row >= source.row;
        self.leave(net, source.row, source.layer + 1, below);
        let between = if below { source.row + 1..target.row } else { target.row + 1..source.row };
        for row in between {
            let channel = target.layer.min(self.rows[row].layers.len());
            self.leave(net, row, channel, true);
            self.leave(net, row, channel, false);
        }
        self.leave(net, target.row, target.layer, target.row <= source.row);
    }

    /// Continues the trunk of a net to the row gap below or above.
    fn leave(&mut self, net: usize, row: usize, channel: usize, below: bool) {
        let trunk = self.trunk(row, channel, net);
        trunk.down |= below;
        trunk.up |= !below;
    }

    /// Returns the rows with the trunks in their channels.
    fn finished(mut self) -> Vec<LayerRow> {
        for ((row, channel, _), trunk) in self.trunks {
            self.rows[row].channels[channel].push(trunk);
        }
        self.rows
    }
}
