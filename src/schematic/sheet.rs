//! The schematic as data, and as a drawing.

use super::describe;
use super::heading::{self, Heading};
use super::layout::{Graph, Layout, Net as Wire, Node, Point, Route, layout};
use super::lists::{self, List};
use super::shapes::{self, Art, CORD};
use super::symbol::{Source, Symbol};
use crate::circuit::Circuit;
use crate::plot::{Area, Drawing, Ink, Label, Stroke};

/// Symbols with their places, and nets with their lines, in pixels from the upper left corner of the sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Schematic {
    heading: Heading,
    /// The symbols, drives first, in the order of the document.
    pub symbols: Vec<PlacedSymbol>,
    /// The nets, in the order of the symbols that drive them.
    pub nets: Vec<Net>,
    /// Lists below the drawing.
    pub lists: Vec<List>,
    /// Width and height of the drawing without heading and lists.
    size: (f64, f64),
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
    /// Where its cord leaves.
    pub output: Point,
    marks: Vec<Stroke>,
}

/// A cord from an output to every jack that it is plugged into.
#[derive(Debug, Clone, PartialEq)]
pub struct Net {
    /// Index of the symbol that drives it.
    pub from: usize,
    /// Symbols and jacks that read it.
    pub to: Vec<(usize, usize)>,
    /// Its lines.
    pub route: Route,
}

/// Why there is no schematic.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DrawError {
    /// More symbols than a person could find their way in.
    #[error("{count} elements and drives are too many for one sheet: {most} can be drawn", most = Schematic::MOST)]
    TooMany {
        /// How many there are.
        count: usize,
    },
}

impl DrawError {
    /// Refuses more symbols than a sheet takes.
    pub(super) fn check(count: usize) -> Result<(), DrawError> {
        if count > Schematic::MOST { Err(DrawError::TooMany { count }) } else { Ok(()) }
    }
}

/// Room around everything.
const MARGIN: f64 = 28.0;

impl Schematic {
    /// The most elements and drives that are drawn on a sheet.
    pub const MOST: usize = 2000;

    /// The schematic of a circuit. `volts` tells the voltages to be written at outputs, `note` is small print.
    ///
    /// # Errors
    /// When the circuit has more than [`Schematic::MOST`] elements and drives.
    pub fn new(
        circuit: &Circuit,
        note: String,
        volts: &dyn Fn(&str) -> Option<f64>,
    ) -> Result<Schematic, DrawError> {
        let symbols = describe::symbols(circuit, volts);
        DrawError::check(symbols.len())?;
        let lists = describe::lists(circuit, &symbols);
        let graph = graph(&symbols);
        let layout = layout(&graph);
        let patch = circuit.patch();
        let width = heading::width(layout.size.0, &patch.title);
        let heading = Heading::new(&patch.title, &[&patch.source, &note], width);
        let size = (width, layout.size.1);
        let mut schematic = Schematic { heading, symbols: vec![], nets: vec![], lists, size };
        schematic.place(symbols, graph, layout);
        Ok(schematic)
    }

    fn place(&mut self, symbols: Vec<Symbol>, graph: Graph, layout: Layout) {
        let by = (MARGIN, MARGIN + self.heading.height());
        let shift = |at: Point| (at.0 + by.0, at.1 + by.1);
        let placed = symbols.into_iter().zip(&layout.slots).zip(&layout.places);
        self.symbols =
            placed.map(|((symbol, slots), at)| PlacedSymbol::new(symbol, slots, shift(*at))).collect();
        let nets = graph.nets.into_iter().zip(layout.routes);
        self.nets = nets
            .map(|(net, route)| Net {
                from: net.from,
                to: net.to.iter().map(|(node, input)| (*node, layout.slots[*node][*input])).collect(),
                route: Route {
                    lines: route.lines.iter().map(|line| line.map(shift)).collect(),
                    dots: route.dots.into_iter().map(shift).collect(),
                    arrows: route.arrows.into_iter().map(shift).collect(),
                },
            })
            .collect();
    }

    /// The drawing of the schematic.
    pub fn drawing(&self) -> Drawing {
        let inside = self.size.0;
        let mut marks = self.heading.draw((MARGIN, MARGIN));
        self.nets.iter().for_each(|net| net.draw(&mut marks));
        marks.extend(self.symbols.iter().flat_map(|symbol| symbol.marks.iter().cloned()));
        let top = MARGIN + self.heading.height() + self.size.1 + 34.0;
        let (listed, bottom) = lists::draw(&self.lists, (MARGIN, top), inside);
        if !listed.is_empty() {
            let y = top - 20.0;
            marks.push(Stroke::Line {
                points: vec![(MARGIN, y), (MARGIN + inside, y)],
                width: 1.0,
                ink: Ink::Faint,
            });
        }
        marks.extend(listed);
        Drawing { width: inside + 2.0 * MARGIN, height: bottom + MARGIN / 2.0, marks }
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
            output: shift(art.output),
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
    let mut readers = vec![Vec::new(); symbols.len()];
    for (index, symbol) in symbols.iter().enumerate() {
        for (input, jack) in symbol.jacks.iter().enumerate() {
            if let Source::Output(from) = jack.from {
                readers[from].push((index, input));
            }
        }
    }
    let nets = readers.into_iter().enumerate().map(|(from, to)| Wire { from, to });
    let is_start = |wanted: fn(&Symbol) -> bool| {
        symbols.iter().enumerate().filter(move |(_, symbol)| wanted(symbol)).map(|(index, _)| index)
    };
    let drives = is_start(|symbol| symbol.shape.starts_with("drive-"));
    let integrators = is_start(|symbol| symbol.shape == "integrator");
    Graph {
        nodes,
        nets: nets.filter(|net| !net.to.is_empty()).collect(),
        starts: drives.chain(integrators).collect(),
    }
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
        output: art.output,
        free: shapes::exchangeable(symbol),
        leans_right: symbol.shape == "potentiometer",
    }
}
