//! Symbols and nets with their positions.
//!
//! Each symbol is drawn once to get its size and the positions of its jacks. The layout positions the
//! symbols and routes the nets. Then each symbol is drawn again with its jacks in the order of the layout.

use super::layout::{Graph, GraphNet, Layout, Node, Point, Route, layout};
use super::shapes::{self, Art, CORD};
use super::sheet::DrawError;
use super::symbol::{CordSource, Symbol};
use crate::plot::{Area, Drawing, Ink, Label, Primitive};

/// Symbols with positions and nets with lines.
///
/// Positions are in pixels from the upper left corner of the sheet.
///
/// # Examples
///
/// ```
/// use patchcord_core::circuit::Circuit;
/// use patchcord_core::patch::{ElementBuilder, PatchBuilder};
/// use patchcord_draw::schematic::Schematic;
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let patch = PatchBuilder::new("Decay")
///     .element("A1", ElementBuilder::new("integrator").cords("x1", ["P1"]).set("initial", 50))
///     .element("P1", ElementBuilder::new("pot").cord("in", "A1").set("setting", 0.5))
///     .run(1.0, 1e-3)
///     .build()?;
/// let diagram = Schematic::new(&Circuit::new(&patch)?, "", "", &|_| None)?.main;
///
/// // The output of A1 drives jack 0 of P1.
/// let net = &diagram.nets[0];
/// assert_eq!(diagram.symbols[net.from].symbol.name, "A1");
/// assert_eq!(net.to, [(1, 0)]);
/// assert_eq!(diagram.symbols[1].symbol.jacks[0].input, "in");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Diagram {
    /// The symbols: input ports, drives, elements and instances in the order of the document, output ports.
    pub symbols: Vec<PlacedSymbol>,
    /// The nets, in the order of the outputs that drive them.
    pub nets: Vec<Net>,
}

/// A symbol with its position.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSymbol {
    /// The symbol; its jacks are in order from the top down.
    pub symbol: Symbol,
    /// The anchor, which is the origin of the primitives of the symbol.
    pub at: Point,
    /// The area of the symbol, including its texts.
    pub area: Area,
    /// The ends of the cords at the input jacks, in their order.
    pub inputs: Vec<Point>,
    /// The starts of the cords at the outputs, in their order.
    pub outputs: Vec<Point>,
    /// The primitives at their positions on the sheet.
    pub(super) primitives: Vec<Primitive>,
}

/// A net: an output and every jack that is connected to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Net {
    /// The index of the symbol with the output.
    pub from: usize,
    /// The index of the output of that symbol.
    pub output: usize,
    /// The connected inputs: indices of the symbol and of the jack.
    pub to: Vec<(usize, usize)>,
    /// The lines.
    pub route: Route,
}

/// Symbols and their layout, without a position on the sheet.
pub(super) struct Plan {
    /// The symbols, with their jacks in the order of the document.
    symbols: Vec<Symbol>,
    /// Their boxes and nets, which are the input of the layout.
    graph: Graph,
    /// The positions, relative to the upper left corner of the diagram.
    layout: Layout,
}

impl Plan {
    /// Lays out symbols.
    ///
    /// # Errors
    ///
    /// If the layout is higher than a drawing may be.
    pub(super) fn new(symbols: Vec<Symbol>) -> Result<Plan, DrawError> {
        let graph = graph(&symbols);
        let layout = layout(&graph, Drawing::MAX_SIDE).map_err(|height| DrawError::TooTall { height })?;
        Ok(Plan { layout, graph, symbols })
    }

    /// Returns the symbols in the order of the view.
    pub(super) fn symbols(&self) -> &[Symbol] {
        &self.symbols
    }

    /// Returns width and height.
    pub(super) fn size(&self) -> (f64, f64) {
        self.layout.size
    }

    /// Returns the diagram with its upper left corner at `by`.
    pub(super) fn placed(self, by: Point) -> Diagram {
        let shift = |at: Point| (at.0 + by.0, at.1 + by.1);
        let Plan { symbols, graph, layout } = self;
        let placed = symbols.into_iter().zip(&layout.input_slots).zip(&layout.positions);
        let symbols =
            placed.map(|((symbol, input_slots), at)| PlacedSymbol::new(symbol, input_slots, shift(*at)));
        let nets = graph.nets.into_iter().zip(layout.routes).map(|(net, route)| Net {
            from: net.from,
            output: net.output,
            to: net.to.iter().map(|(node, input)| (*node, layout.input_slots[*node][*input])).collect(),
            route: Route {
                lines: route.lines.iter().map(|line| line.map(shift)).collect(),
                dots: route.dots.into_iter().map(shift).collect(),
                arrows: route.arrows.into_iter().map(shift).collect(),
            },
        });
        Diagram { symbols: symbols.collect(), nets: nets.collect() }
    }
}

impl Diagram {
    /// Adds the primitives of the diagram: the nets first, the symbols in front of them.
    pub(super) fn draw(&self, primitives: &mut Vec<Primitive>) {
        self.nets.iter().for_each(|net| net.draw(primitives));
        primitives.extend(self.symbols.iter().flat_map(|symbol| symbol.primitives.iter().cloned()));
    }
}

impl PlacedSymbol {
    /// Places a symbol with its anchor at `at`.
    ///
    /// `input_slots[n]` is the position from the top down that the layout chose for jack n. The symbol is drawn
    /// again with its jacks in this order, because the gains are written next to the jacks.
    fn new(mut symbol: Symbol, input_slots: &[usize], at: Point) -> PlacedSymbol {
        let mut jacks = symbol.jacks.clone();
        symbol.jacks.into_iter().zip(input_slots).for_each(|(jack, input_slot)| jacks[*input_slot] = jack);
        symbol.jacks = jacks;
        let art = shapes::draw(&symbol);
        let shift = |point: Point| (point.0 + at.0, point.1 + at.1);
        let area = art.area();
        let area = Area {
            left: area.left + at.0,
            top: area.top + at.1,
            right: area.right + at.0,
            bottom: area.bottom + at.1,
        };
        PlacedSymbol {
            symbol,
            at,
            area,
            inputs: art.inputs.iter().copied().map(shift).collect(),
            outputs: art.outputs.iter().copied().map(shift).collect(),
            primitives: art.primitives.into_iter().map(|primitive| primitive.moved(at)).collect(),
        }
    }

    /// Returns the texts of the symbol.
    pub fn labels(&self) -> impl Iterator<Item = &Label> {
        self.primitives.iter().filter_map(Primitive::label)
    }
}

impl Net {
    /// Adds the lines of the net, a dot at each branch, and arrows on the lines that run back.
    fn draw(&self, primitives: &mut Vec<Primitive>) {
        for line in &self.route.lines {
            primitives.push(Primitive::Line { points: line.to_vec(), width: CORD, ink: Ink::Wire });
        }
        for dot in &self.route.dots {
            primitives.push(Primitive::Disc { centre: *dot, radius: 3.0, ink: Ink::Wire });
        }
        for tip in &self.route.arrows {
            let corners = vec![(tip.0 - 4.0, tip.1), (tip.0 + 4.0, tip.1 - 3.5), (tip.0 + 4.0, tip.1 + 3.5)];
            primitives.push(Primitive::Area { corners, ink: Ink::Wire });
        }
    }
}

/// Returns the graph for the layout: boxes as large as their symbols, and nets.
///
/// The order of reading starts at ports and drives, then at integrators.
fn graph(symbols: &[Symbol]) -> Graph {
    let nodes = symbols.iter().map(|symbol| node(symbol, shapes::draw(symbol))).collect();
    let starts = |matches: fn(&Symbol) -> bool| {
        symbols.iter().enumerate().filter(move |(_, symbol)| matches(symbol)).map(|(index, _)| index)
    };
    let sources = starts(|symbol| symbol.shape == "port-in" || symbol.shape.starts_with("drive-"));
    let integrators = starts(|symbol| symbol.shape == "integrator");
    Graph { nodes, nets: graph_nets(symbols), starts: sources.chain(integrators).collect() }
}

/// Returns the nets of all outputs that are connected.
fn graph_nets(symbols: &[Symbol]) -> Vec<GraphNet> {
    let mut readers: Vec<Vec<Vec<(usize, usize)>>> =
        symbols.iter().map(|symbol| vec![Vec::new(); symbol.outputs.len()]).collect();
    for (index, symbol) in symbols.iter().enumerate() {
        for (input, jack) in symbol.jacks.iter().enumerate() {
            if let CordSource::Output(from, output) = jack.from {
                readers[from][output].push((index, input));
            }
        }
    }
    let outputs = readers.into_iter().enumerate().flat_map(|(from, outputs)| {
        outputs.into_iter().enumerate().map(move |(output, to)| GraphNet { from, output, to })
    });
    outputs.filter(|net| !net.to.is_empty()).collect()
}

/// Returns the box of a symbol, with its area rounded outward to whole pixels.
fn node(symbol: &Symbol, art: Art) -> Node {
    let area = art.area();
    Node {
        area: Area {
            left: area.left.floor(),
            top: area.top.floor(),
            right: area.right.ceil(),
            bottom: area.bottom.ceil(),
        },
        inputs: art.inputs,
        outputs: art.outputs,
        exchangeable: shapes::exchangeable(symbol),
        prefers_right: symbol.shape == "potentiometer",
    }
}
