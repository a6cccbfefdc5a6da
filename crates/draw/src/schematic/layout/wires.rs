//! Which channels and streets every net uses.

use std::collections::BTreeMap;

use super::rows::Cell;
use super::{Graph, Net};

/// Everything on the sheet by rows.
#[derive(Debug)]
pub(super) struct Sheet {
    pub rows: Vec<Row>,
    /// For every node and input, its place among the node's inputs.
    pub slots: Vec<Vec<usize>>,
}

/// Layers and the channels between them; channel n is left of layer n, the last one right of all.
#[derive(Debug, Default)]
pub(super) struct Row {
    pub items: Vec<Item>,
    /// Indices of items, top down.
    pub layers: Vec<Vec<usize>>,
    pub channels: Vec<Vec<Trunk>>,
}

/// A node, or a net on its way through a layer.
#[derive(Debug)]
pub(super) struct Item {
    pub what: What,
    /// Of the anchor, from the top of the row.
    pub y: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum What {
    Node(usize),
    Through(usize),
}

/// The upright line of a net in a channel.
#[derive(Debug, Clone)]
pub(super) struct Trunk {
    pub net: usize,
    /// What it comes from in the layer at its left.
    pub left: Option<Pin>,
    /// What it goes to in the layer at its right.
    pub right: Vec<Pin>,
    /// Whether it goes on to the street above the row.
    pub up: bool,
    /// Whether it goes on to the street below the row.
    pub down: bool,
}

/// Where a net touches an item.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pin {
    pub item: usize,
    pub jack: Jack,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Jack {
    Output(usize),
    Input(usize),
    Through,
}

/// A row with more items is gone through less often.
const MANY: usize = 20_000;

impl Row {
    /// How often a row is gone through to better it, of so many times; a very large one twice.
    pub fn rounds(&self, most: usize) -> usize {
        (most * MANY / self.items.len().max(MANY)).max(2)
    }
}

impl Sheet {
    pub fn new(graph: &Graph, cells: &[Cell]) -> Sheet {
        let count = cells.iter().map(|cell| cell.row + 1).max().unwrap_or(0);
        let mut weaver = Weaver {
            cells,
            rows: (0..count).map(|row| empty_row(cells, row)).collect(),
            trunks: BTreeMap::new(),
            items: BTreeMap::new(),
        };
        for (node, cell) in cells.iter().enumerate() {
            weaver.item(*cell, What::Node(node));
        }
        for (index, net) in graph.nets.iter().enumerate() {
            weaver.weave(index, net);
        }
        let slots = graph.nodes.iter().map(|node| (0..node.inputs.len()).collect()).collect();
        Sheet { rows: weaver.finished(), slots }
    }

    /// Height of a pin above or below the anchor of its item.
    pub fn offset(&self, graph: &Graph, row: usize, pin: Pin) -> f64 {
        let What::Node(node) = self.rows[row].items[pin.item].what else { return 0.0 };
        match pin.jack {
            Jack::Output(outlet) => graph.nodes[node].outputs[outlet].1,
            Jack::Input(input) => graph.nodes[node].inputs[self.slots[node][input]].1,
            Jack::Through => 0.0,
        }
    }

    /// Height of a pin from the top of its row.
    pub fn height(&self, graph: &Graph, row: usize, pin: Pin) -> f64 {
        self.rows[row].items[pin.item].y + self.offset(graph, row, pin)
    }
}

impl Trunk {
    /// Heights of everything that it touches within its row.
    pub fn pins(&self) -> impl Iterator<Item = Pin> + '_ {
        self.left.iter().chain(&self.right).copied()
    }
}

fn empty_row(cells: &[Cell], row: usize) -> Row {
    let layers = cells.iter().filter(|cell| cell.row == row).map(|cell| cell.layer + 1).max().unwrap_or(0);
    Row { items: Vec::new(), layers: vec![Vec::new(); layers], channels: vec![Vec::new(); layers + 1] }
}

/// Makes trunks out of nets; those of one net in one channel are one.
struct Weaver<'a> {
    cells: &'a [Cell],
    rows: Vec<Row>,
    /// By row, channel and net.
    trunks: BTreeMap<(usize, usize, usize), Trunk>,
    items: BTreeMap<(Cell, What), usize>,
}

impl Weaver<'_> {
    /// The item in a cell, made if it is not there yet.
    fn item(&mut self, cell: Cell, what: What) -> usize {
        let row = &mut self.rows[cell.row];
        *self.items.entry((cell, what)).or_insert_with(|| {
            row.items.push(Item { what, y: 0.0 });
            row.layers[cell.layer].push(row.items.len() - 1);
            row.items.len() - 1
        })
    }

    fn trunk(&mut self, row: usize, channel: usize, net: usize) -> &mut Trunk {
        let empty = Trunk { net, left: None, right: Vec::new(), up: false, down: false };
        self.trunks.entry((row, channel, net)).or_insert(empty)
    }

    fn weave(&mut self, index: usize, net: &Net) {
        let source = self.cells[net.from];
        let from = Pin { item: self.item(source, What::Node(net.from)), jack: Jack::Output(net.outlet) };
        self.trunk(source.row, source.layer + 1, index).left = Some(from);
        let is_ahead = |cell: Cell| cell.row == source.row && cell.layer > source.layer;
        let ahead = net.to.iter().map(|(node, _)| self.cells[*node]).filter(|cell| is_ahead(*cell));
        let last = ahead.map(|cell| cell.layer).max().unwrap_or(0);
        for layer in source.layer + 1..last {
            self.pass(index, Cell { row: source.row, layer });
        }
        for (node, input) in &net.to {
            let cell = self.cells[*node];
            let pin = Pin { item: self.item(cell, What::Node(*node)), jack: Jack::Input(*input) };
            self.trunk(cell.row, cell.layer, index).right.push(pin);
            if !is_ahead(cell) {
                self.by_street(index, source, cell);
            }
        }
    }

    /// A net on its way through a layer.
    fn pass(&mut self, net: usize, cell: Cell) {
        let through = Pin { item: self.item(cell, What::Through(net)), jack: Jack::Through };
        self.trunk(cell.row, cell.layer, net).right.push(through);
        self.trunk(cell.row, cell.layer + 1, net).left = Some(through);
    }

    /// Joins source and target by the streets between their rows; within a row, by the one below.
    fn by_street(&mut self, net: usize, source: Cell, target: Cell) {
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

    fn leave(&mut self, net: usize, row: usize, channel: usize, below: bool) {
        let trunk = self.trunk(row, channel, net);
        trunk.down |= below;
        trunk.up |= !below;
    }

    fn finished(mut self) -> Vec<Row> {
        for ((row, channel, _), trunk) in self.trunks {
            self.rows[row].channels[channel].push(trunk);
        }
        self.rows
    }
}
