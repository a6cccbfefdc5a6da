//! Symbols and cords with their places.

use super::layout::{Graph, Layout, Net as Wire, Node, Point, Route, layout};
use super::shapes::{self, Art, CORD};
use super::sheet::DrawError;
use super::symbol::{Source, Symbol};
use crate::plot::{Area, Drawing, Ink, Label, Stroke};

/// Symbols with their places, and nets with their lines, in pixels from the upper left corner of the sheet.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Diagram {
    /// The symbols: input ports, drives, elements and instances in the order of the document, output ports.
    pub symbols: Vec<PlacedSymbol>,
    /// The nets, in the order of the outputs that drive them.
    pub nets: Vec<Net>,
}

/// A symbol in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSymbol {
    /// What is drawn; its jacks from the top down.
    pub symbol: Symbol,
    /// Its anchor.
    pub at: Point,
    /// Its room, texts included.
    pub area: Area,
    /// Where cords arrive, jack by jack.
    pub inputs: Vec<Point>,
    /// Where cords leave, outlet by outlet.
    pub outputs: Vec<Point>,
    marks: Vec<Stroke>,
}

/// A cord from an output to every jack that it is plugged into.
#[derive(Debug, Clone, PartialEq)]
pub struct Net {
    /// Index of the symbol that drives it.
    pub from: usize,
    /// Which of the symbol's outlets it comes from.
    pub outlet: usize,
    /// Symbols and jacks that read it.
    pub to: Vec<(usize, usize)>,
    /// Its lines.
    pub route: Route,
}

/// Symbols laid out, but not yet on a sheet.
pub(super) struct Plan {
    symbols: Vec<Symbol>,
    graph: Graph,
    layout: Layout,
}

impl Plan {
    pub fn new(symbols: Vec<Symbol>) -> Result<Plan, DrawError> {
        let graph = graph(&symbols);
        let layout = layout(&graph, Drawing::LONGEST).map_err(|height| DrawError::TooTall { height })?;
        Ok(Plan { layout, graph, symbols })
    }

    pub fn symbols(&self) -> &[Symbol] {
        &self.symbols
    }

    /// Width and height.
    pub fn size(&self) -> (f64, f64) {
        self.layout.size
    }

    /// Everything at its place, the upper left corner at `by`.
    pub fn placed(self, by: Point) -> Diagram {
        let shift = |at: Point| (at.0 + by.0, at.1 + by.1);
        let Plan { symbols, graph, layout } = self;
        let placed = symbols.into_iter().zip(&layout.slots).zip(&layout.places);
        let symbols = placed.map(|((symbol, slots), at)| PlacedSymbol::new(symbol, slots, shift(*at)));
        let nets = graph.nets.into_iter().zip(layout.routes).map(|(net, route)| Net {
            from: net.from,
            outlet: net.outlet,
            to: net.to.iter().map(|(node, input)| (*node, layout.slots[*node][*input])).collect(),
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
    pub(super) fn draw(&self, marks: &mut Vec<Stroke>) {
        self.nets.iter().for_each(|net| net.draw(marks));
        marks.extend(self.symbols.iter().flat_map(|symbol| symbol.marks.iter().cloned()));
    }
}

impl PlacedSymbol {
    fn new(mut symbol: Symbol, slots: &[usize], at: Point) -> PlacedSymbol {
        let mut jacks = symbol.jacks.clone();
        symbol.jacks.into_iter().zip(slots).for_each(|(jack, slot)| jacks[*slot] = jack);
        symbol.jacks = jacks;
        let art = shapes::draw(&symbol);
        let shift = |place: Point| (place.0 + at.0, place.1 + at.1);
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
            marks: art.marks.into_iter().map(|mark| mark.moved(at)).collect(),
        }
    }

    /// The texts of the symbol.
    pub fn labels(&self) -> impl Iterator<Item = &Label> {
        self.marks.iter().filter_map(|mark| match mark {
            Stroke::Text(label) => Some(label),
            _ => None,
        })
    }
}

impl Net {
    fn draw(&self, marks: &mut Vec<Stroke>) {
        for line in &self.route.lines {
            marks.push(Stroke::Line { points: line.to_vec(), width: CORD, ink: Ink::Wire });
        }
        for dot in &self.route.dots {
            marks.push(Stroke::Disc { centre: *dot, radius: 3.0, ink: Ink::Wire });
        }
        for tip in &self.route.arrows {
            let corners = vec![(tip.0 - 4.0, tip.1), (tip.0 + 4.0, tip.1 - 3.5), (tip.0 + 4.0, tip.1 + 3.5)];
            marks.push(Stroke::Area { corners, ink: Ink::Wire });
        }
    }
}

/// What is laid out: boxes as large as their symbols.
fn graph(symbols: &[Symbol]) -> Graph {
    let nodes = symbols.iter().map(|symbol| node(symbol, shapes::draw(symbol))).collect();
    let starts = |wanted: fn(&Symbol) -> bool| {
        symbols.iter().enumerate().filter(move |(_, symbol)| wanted(symbol)).map(|(index, _)| index)
    };
    let sources = starts(|symbol| symbol.shape == "port-in" || symbol.shape.starts_with("drive-"));
    let integrators = starts(|symbol| symbol.shape == "integrator");
    Graph { nodes, nets: wires(symbols), starts: sources.chain(integrators).collect() }
}

/// The nets of all outlets that something is plugged into.
fn wires(symbols: &[Symbol]) -> Vec<Wire> {
    let mut readers: Vec<Vec<Vec<(usize, usize)>>> =
        symbols.iter().map(|symbol| vec![Vec::new(); symbol.outlets.len()]).collect();
    for (index, symbol) in symbols.iter().enumerate() {
        for (input, jack) in symbol.jacks.iter().enumerate() {
            if let Source::Output(from, outlet) = jack.from {
                readers[from][outlet].push((index, input));
            }
        }
    }
    let outlets = readers.into_iter().enumerate().flat_map(|(from, outlets)| {
        outlets.into_iter().enumerate().map(move |(outlet, to)| Wire { from, outlet, to })
    });
    outlets.filter(|wire| !wire.to.is_empty()).collect()
}

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
        free: shapes::exchangeable(symbol),
        leans_right: symbol.shape == "potentiometer",
    }
}
